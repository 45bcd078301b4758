"""Stiffness, mass and strains of many different blocks, assembled together, which is far cheaper than one by one."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from meshing import WallMesh
from runningbond.scene import Array

from .operators import displacements, elasticity, inertia, mean_strains

AT_ONCE = 500
"""Number of blocks assembled together; larger groups take more memory and save no time."""


class BlockOperators(NamedTuple):
    """Operators of one block, in the numbering of its own nodes.

    Parameters
    ----------
    nodes : (nn, 2) float
        The nodes [m], vertices first.
    stiffness, mass : (2 nn, 2 nn) float
        Stiffness for unit thickness [Pa]; mass for unit density and thickness [m²].
    strain : (3 nt, 2 nn) sparse
        The operator of `mean_strains`.
    """

    nodes: Array
    stiffness: Array
    mass: Array
    strain: csr_array


def block_operators(
    mesh: WallMesh, blocks: Sequence[int], young: Array, poisson: Array, degree: int
) -> Iterator[BlockOperators]:
    """Operators of blocks, one after the other, on triangles of a polynomial degree.

    Young's moduli ``(n,)`` [Pa] are zero for blocks that do not deform; `poisson` is Poisson's ratio ``(n,)``.
    """
    for start in range(0, len(blocks), AT_ONCE):
        part = slice(start, start + AT_ONCE)
        yield from _assembled(mesh, np.asarray(blocks[part]), young[part], poisson[part], degree)


def _assembled(mesh: WallMesh, blocks: Array, young: Array, poisson: Array, degree: int) -> Iterator[BlockOperators]:
    nodes = [np.arange(mesh.first_node[block], mesh.first_node[block + 1]) for block in blocks]
    own = [np.flatnonzero(mesh.triangle_block == block) for block in blocks]
    number = np.empty(len(mesh.points), dtype=np.int64)
    number[np.concatenate(nodes)] = np.arange(sum(map(len, nodes)))
    of_triangle = np.repeat(np.arange(len(blocks)), [len(each) for each in own])
    basis = displacements(mesh.points[np.concatenate(nodes)], number[mesh.triangles[np.concatenate(own)]], degree)
    K, M = elasticity(basis, young[of_triangle], poisson[of_triangle]), inertia(basis)
    strain = mean_strains(basis)
    for k in range(len(blocks)):
        triangles = np.flatnonzero(of_triangle == k)
        freedom = np.unique(basis.element_dofs[:, triangles])
        rows = (3 * triangles[:, None] + np.arange(3)).ravel()
        stiffness, mass = (A[freedom][:, freedom].toarray() for A in (K, M))
        mean_strain = strain[rows][:, freedom]
        yield BlockOperators(np.ascontiguousarray(basis.doflocs[:, freedom[::2]].T), stiffness, mass, mean_strain)
