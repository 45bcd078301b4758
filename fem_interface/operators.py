"""Operators of blocks of constant-strain triangles, assembled by scikit-fem: stiffness, mass and strains.

Degrees of freedom are ordered by node, x before y: 2i and 2i + 1 are the displacement of node i [m].
"""

import numpy as np
from scipy.sparse import csr_array, vstack
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP0,
    ElementTriP1,
    ElementTriP2,
    ElementTriP3,
    ElementVector,
    LinearForm,
    MeshTri,
    asm,
)
from skfem.helpers import dot, grad
from skfem.models.elasticity import linear_elasticity, plane_stress

from runningbond.scene import Array, Indices

ELEMENTS = {1: ElementTriP1, 2: ElementTriP2, 3: ElementTriP3}
"""Triangle elements by the polynomial degree of their displacement; those of degree 1 have constant strain."""


def stiffness_matrix(
    points: Array, triangles: Indices, young: float, poisson: float, thickness: float, degree: int = 1
) -> csr_array:
    """Plane-stress stiffness of vertices ``(nv, 2)`` [m] and triangles ``(nt, 3)``, ``(2 nn, 2 nn)`` [N/m].

    For constant strain the nodes are the vertices; for higher degrees see `nodes_of_degree`.
    """
    return thickness * elasticity(displacements(points, triangles, degree), np.array([young]), np.array([poisson]))


def mass_matrix(points: Array, triangles: Indices, density: float, thickness: float, degree: int = 1) -> csr_array:
    """Consistent mass of vertices ``(nv, 2)`` [m] and triangles ``(nt, 3)``, ``(2 nn, 2 nn)`` [kg]."""
    return density * thickness * inertia(displacements(points, triangles, degree))


def nodes_of_degree(points: Array, triangles: Indices, degree: int) -> Array:
    """Nodes of triangles with displacements of a polynomial degree, ``(nn, 2)`` [m]; the vertices come first."""
    return np.ascontiguousarray(displacements(points, triangles, degree).doflocs[:, ::2].T)


def displacements(points: Array, triangles: Indices, degree: int) -> Basis:
    """Displacement basis of a polynomial degree on vertices ``(nv, 2)`` [m] and triangles ``(nt, 3)``."""
    return Basis(triangle_mesh(points, triangles), ElementVector(ELEMENTS[degree]()))


def elasticity(basis: Basis, young: Array, poisson: Array) -> csr_array:
    """Plane-stress stiffness for unit thickness [Pa], with moduli [Pa] and Poisson's ratios of each triangle ``(nt,)``.

    Arrays of one entry hold for all triangles.
    """
    return csr_array(asm(linear_elasticity(*plane_stress(young[:, None], poisson[:, None])), basis))


def inertia(basis: Basis) -> csr_array:
    """Consistent mass for unit density and thickness [m²]."""
    return csr_array(asm(BilinearForm(lambda u, v, _: dot(u, v)), basis))


def mean_strains(basis: Basis) -> csr_array:
    """Mean strains ε_x, ε_y and γ_xy of each triangle per nodal displacement, ``(3 nt, 2 nn)`` [1/m]."""
    uniform = basis.with_element(ElementTriP0())
    area = asm(LinearForm(lambda v, _: v), uniform)
    forms = [
        lambda u, v, _: grad(u)[0, 0] * v,
        lambda u, v, _: grad(u)[1, 1] * v,
        lambda u, v, _: (grad(u)[0, 1] + grad(u)[1, 0]) * v,
    ]
    strains = [asm(BilinearForm(form), basis, uniform) / area[:, None] for form in forms]
    order = np.arange(3 * len(area)).reshape(3, -1).T.ravel()
    return csr_array(vstack(strains, format="csr")[order])


def lumped_mass(points: Array, triangles: Indices, density: float, thickness: float) -> Array:
    """Row sums of the consistent mass, ``(2 nn,)`` [kg]: exact in translation, too large in rotation."""
    return np.asarray(mass_matrix(points, triangles, density, thickness).sum(axis=1))


def triangle_mesh(points: Array, triangles: Indices) -> MeshTri:
    """Mesh with vertices ``(nv, 2)`` [m] and triangles ``(nt, 3)``."""
    return MeshTri(np.ascontiguousarray(points.T), np.ascontiguousarray(triangles.T))
