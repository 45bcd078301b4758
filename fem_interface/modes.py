"""Modes of one block: rigid motions first, then deformations; mass and stiffness are diagonal in them.

The rigid modes are unit translations and a unit rotation about the centroid. Their coordinates are those of a rigid
block, and with the consistent mass their modal masses are exactly the block's mass and moment of inertia. Deformable
modes are normalised to the block's mass: their coordinate is the block's root mean square displacement [m].
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from runningbond.scene import Array, SceneError, free_motions

from .eigenvectors import eigenvectors, symmetric_eigenvectors
from .mirror_symmetry import facing

ModeCount: TypeAlias = int | Literal["all"]
"""Number of modes of a block: 3 are the rigid ones; 6 add uniform strains; up to 20 add bending, in the softest
polynomial displacements up to third degree; "all" are those of its constant-strain triangles.

With 6 modes a block moves as in discontinuous deformation analysis (`shi1988`), with 20 as in its third-order version
(`koo1996`).
"""

MOST_MODES, BENDING = 20, 10
"""Number of polynomial displacements up to third degree, and the number of modes that bend a brick well enough: its
deflection as a cantilever is 5.5 % too small for 240 × 60 mm and 14.5 % for 240 × 120 mm."""

TIE_TOLERANCE = 1e-6
"""Relative difference of ω² up to which modes count as equally soft as the last one asked for, and are included too: a
square block bends one way as easily as the other."""

DEGENERATE = 1e-9
"""Relative difference of two ω², smaller than `TIE_TOLERANCE`, up to which mixtures of their modes count as modes."""


def degree_of(count: ModeCount, key: str = "modes") -> int:
    """Polynomial degree of the displacements of a number of modes.

    Raises
    ------
    SceneError
        Naming the key, if the number of modes is not possible.
    """
    if count == "all":
        return 1
    if not isinstance(count, int) or (count != 3 and not 6 <= count <= MOST_MODES):
        raise SceneError(key, f'must be 3, a number from 6 to {MOST_MODES}, or "all"', count)
    return 1 if count <= 6 else 3


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of a block: three rigid modes, then deformations.

    Parameters
    ----------
    rigid : (2 nn, 3) float
        Nodal displacements of the translations along x and y and of the rotation about the centroid.
    free : (3, 3) float
        Rigid motion, per coordinate, that satisfies the block's pins; unused columns are zero. The identity without
        pins.
    shape : (2 nn, m) float
        Nodal displacements per coordinate: ``rigid @ free``, then the deformations.
    mass, stiffness : (m,) float
        Modal masses, inf for unused coordinates, and stiffness, zero for rigid modes.
    inert : (m, 2) float
        Modal force per acceleration of the whole block along x and y [kg].
    """

    rigid: Array
    free: Array
    shape: Array
    mass: Array
    stiffness: Array
    inert: Array


def rigid_motions(points: Array, M: Array) -> Array:
    """Two translations and the rotation about the centroid, ``(2 nn, 3)``, of nodes ``(nn, 2)`` [m]."""
    n = len(points)
    R = np.zeros((n, 2, 3))
    R[:, 0, 0] = R[:, 1, 1] = 1
    translations = R.reshape(-1, 3)[:, :2]
    # Relative to the first node, because the origin may be far away.
    x, y = (points - points[0]).T
    momenta = _momenta(translations, M)
    centre = np.einsum("kn,n->k", momenta, np.column_stack([x, y]).ravel()) / momenta[0, ::2].sum()
    R[:, 0, 2], R[:, 1, 2] = centre[1] - y, x - centre[0]
    return R.reshape(-1, 3)


def block_modes(points: Array, K: Array, M: Array, held: Array, count: ModeCount) -> Modes:
    """Modes of a block.

    Parameters
    ----------
    points : (nn, 2) float
        Nodes [m] of triangles whose displacements have the polynomial degree of the modes (`degree_of`).
    K, M : (2 nn, 2 nn) float
        Stiffness [N/m] and consistent mass [kg].
    held : (np, 2 nn) float
        Constraints, one per row: ``held @ displacement`` is zero for every mode.
    count
        Number of modes of an unsupported block; further modes as soft as the last one are included too.
    """
    R = rigid_motions(points, M)
    inertia = np.einsum("kn,nk->k", _momenta(R, M), R)
    free, mass = free_motions(np.einsum("kn,ni->ki", held, R), inertia)
    rigid, stiffness = np.einsum("ni,ij->nj", R, free), np.zeros(3)
    shape = rigid
    if count != 3:
        candidates = np.eye(len(M)) if count == "all" else _softest(points, K, M, count)
        bending, own = _deformations(candidates, rigid[:, np.isfinite(mass)], held, K, M)
        bending = _even_or_odd(points, bending, own, M)
        shape = np.hstack([rigid, np.sqrt(inertia[0]) * bending])
        mass = np.concatenate([mass, np.full(len(own), inertia[0])])
        stiffness = np.concatenate([stiffness, inertia[0] * own])
    inert = np.einsum("nm,ni->mi", shape, _momenta(R[:, :2], M).T)
    if len(held) == 0:
        inert[:] = 0.0  # removes rounding errors
        inert[0, 0] = inert[1, 1] = inertia[0]
    return Modes(R, free, shape, mass, stiffness, inert)


def polynomials(points: Array, degree: int) -> Array:
    """Polynomial displacements up to a degree, at points ``(nn, 2)``, ``(2 nn, (degree + 1)(degree + 2))``."""
    # Centred and scaled, because the origin may be far away and the block's size far from one.
    x, y = ((points - points.mean(axis=0)) / np.ptp(points, axis=0).max()).T
    # Products in extended precision, because a library's powers differ in their last bits between machines.
    of_x, of_y = (np.vander(each.astype(np.longdouble), degree + 1, increasing=True).T.astype(float) for each in (x, y))
    monomials = [of_x[i] * of_y[j] for i in range(degree + 1) for j in range(degree + 1 - i)]
    result = np.zeros((len(points), 2, len(monomials), 2))
    result[:, 0, :, 0] = result[:, 1, :, 1] = np.column_stack(monomials)
    return result.reshape(2 * len(points), -1)


def _softest(points: Array, K: Array, M: Array, count: int) -> Array:
    """Displacements of first degree and the softest others up to third degree, ``(2 nn, n)`` with n ≥ `count`."""
    first = polynomials(points, 1)
    if count == 6:
        return first
    own, further = eigenvectors(K, M, polynomials(points, 3), _momenta(first, M))
    return np.hstack([first, further[:, own <= own[count - 7] * (1 + TIE_TOLERANCE)]])


def _momenta(motions: Array, M: Array) -> Array:
    """Momenta M x of motions ``(n, k)``, one per row; their products with motions orthogonal to x are zero."""
    return np.asarray(np.einsum("nm,mk->kn", M, motions))


def _deformations(candidates: Array, rigid: Array, held: Array, K: Array, M: Array) -> tuple[Array, Array]:
    """Deformations in the span of `candidates` that are orthogonal to the rigid motions and satisfy the pins.

    Returns
    -------
    (2 nn, d) float
        Shapes of the deformations, of unit modal mass, with diagonal stiffness.
    (d,) float
        ω² of each deformation [1/s²].
    """
    inert = _momenta(rigid, M)
    zero = np.vstack([held, inert / np.sqrt((inert**2).sum(axis=1))[:, None]]) if len(inert) else held
    own, shapes = eigenvectors(K, M, candidates / np.sqrt((candidates**2).sum(axis=0)), zero)
    return shapes, own


def _even_or_odd(points: Array, shapes: Array, own: Array, M: Array) -> Array:
    """Shapes that are even or odd about a block's vertical axis, chosen among the mixtures of modes with equal ω².

    Parameters
    ----------
    points : (nn, 2) float
        The nodes [m].
    shapes : (2 nn, d) float
        Shapes that are orthogonal with respect to the mass `M`; returned unchanged if the block has no such axis.
    own : (d,) float
        ω² of each shape [1/s²], in ascending order.
    """
    low, high = facing(points, 0)
    if low.size == 0:
        return shapes
    mirrored = shapes.reshape(len(points), 2, -1).copy()
    mirrored[np.append(low, high)] = mirrored[np.append(high, low)]
    mirrored[:, 0] *= -1
    image, result = mirrored.reshape(shapes.shape), shapes.copy()
    for alike in np.split(np.arange(len(own)), np.flatnonzero(np.diff(own) > DEGENERATE * own[1:]) + 1):
        seen = np.einsum("ni,jn->ij", shapes[:, alike], _momenta(image[:, alike], M))
        _, turn = symmetric_eigenvectors((seen + seen.T) / 2)
        result[:, alike] = np.einsum("ni,ij->nj", shapes[:, alike], turn)
    return result
