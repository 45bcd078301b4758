"""How loads proportional to mass act on a block's mesh: consistently, or lumped at its inner nodes as in the paper."""

from typing import Literal, TypeAlias

import numpy as np

from runningbond.scene import Array, Mask, SceneError

from .cracks import Pieces
from .joint_elements import edges_of

Loads: TypeAlias = Literal["consistent", "inner"]
"""Loads proportional to mass: consistent with the mass, or lumped at nodes inside the blocks (the paper's Sec. 5)."""


def inner_mass(wall: Pieces) -> Array:
    """Mass of each movable block lumped at its inner nodes, ``(nn,)`` [kg]; zero at all other nodes.

    The mass of a node is m_i = A_i (α + β · (x_i − c)), with A_i a third of the area of the triangles around it, and α
    and β such that the block's mass and its centroid c are right. If the block may crack, the pieces that meet at a
    node share its mass in the same way.

    Raises
    ------
    SceneError
        If a block has too few inner nodes.
    """
    mesh = wall.mesh
    owner, count = wall.owner[mesh.block], int(wall.owner[-1]) + 1
    corner = mesh.points[mesh.triangles]
    side = corner[:, 1:] - corner[:, :1]
    area = np.linalg.det(side) / 2
    of_node = np.bincount(mesh.triangles.ravel(), np.repeat(area / 3, 3), minlength=len(mesh.points))
    of_node[_on_outline(wall)] = 0.0

    weight = np.bincount(wall.owner, wall.scene.blocks.area, minlength=count)
    total = np.bincount(wall.owner, wall.scene.mass, minlength=count)
    first = [np.bincount(wall.owner, wall.scene.blocks.area * x, minlength=count) for x in wall.scene.blocks.centroid.T]
    centre = np.column_stack(first) / weight[:, None]
    reach = (mesh.points - centre[owner]) / np.sqrt(weight)[owner, None]
    terms = np.column_stack([np.ones(len(reach)), reach])
    moments = np.zeros((count, 3, 3))
    np.add.at(moments, owner, of_node[:, None, None] * terms[:, :, None] * terms[:, None, :])
    share = np.linalg.pinv(moments / weight[:, None, None], rcond=1e-9, hermitian=True)[:, 0]
    result = of_node / weight[owner] * (terms * share[owner]).sum(axis=1)

    still = np.bincount(wall.owner, wall.scene.fixed, minlength=count) > 0
    held = np.column_stack([np.bincount(owner, result * term, minlength=count) for term in terms.T])
    lost = ~still & (np.abs(held - [1, 0, 0]).max(axis=1) > 1e-9)
    if lost.any():
        piece = int(np.argmax(wall.owner == np.argmax(lost)))
        raise SceneError(
            wall.scene.blocks.name(piece), "has no inner nodes that could bear its load; take more cells a block"
        )
    return np.where(still[owner], 0.0, result * total[owner])


def _on_outline(wall: Pieces) -> Mask:
    """Whether each node lies on the outline of its block, ``(nn,)``: on an edge that belongs to one triangle only."""
    edges = np.sort(edges_of(wall.node[wall.mesh.triangles]), axis=1)
    edge, times = np.unique(edges, axis=0, return_counts=True)
    outer = np.zeros(int(wall.node.max()) + 1, dtype=bool)
    outer[edge[times == 1].ravel()] = True
    return outer[wall.node]
