"""Nodes on the blocks' outlines; every joint is divided equally on both of its sides.

Each side of a block consists of pieces, namely joints and the stretches between them, and each piece is divided into
equal parts. A node lies on the outline of its own block. If a drawing leaves a gap between two blocks that counts as
contact, the two nodes across it are separated by that gap; all other pairs coincide except for rounding.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array, Blocks, Indices, Joints, Mask, Scene


@dataclass(frozen=True, eq=False)
class NodeOutlines:
    """Nodes on the outlines of all blocks, counter-clockwise and one block after another.

    Parameters
    ----------
    points : (n, 2) float
        Nodes [m]; the first of a block is the corner with the smallest 0.3 x + y, the lower left one of a rectangle.
    corner : (n,) bool
        Whether a node is a corner of its block.
    first : (nb + 1,) int
        Block ``i`` owns ``points[first[i]:first[i + 1]]``.
    divisions : (nj,) int
        Number of equal parts of each joint; contacts of single corners are left out.
    start : (nj, 2) int
        Number, within the outlines of block a and block b, of the first node that each outline has on the joint.
    """

    points: Array
    corner: Mask
    first: Indices
    divisions: Indices
    start: Indices

    @property
    def count(self) -> Indices:
        """Nodes on each outline, ``(nb,)``."""
        return np.diff(self.first)


def outlines(scene: Scene, cells: int) -> NodeOutlines:
    """Place nodes on the outlines of all blocks.

    Parameters
    ----------
    scene
        The wall.
    cells
        Number of parts of half a block along the course, and of a block's height. The ground has nodes only at its
        corners and on its joints.
    """
    blocks, joints = scene.blocks, scene.joints.between_sides
    along, length = _edges(blocks)
    # The target length of parts on a joint is the smaller one of its two blocks.
    run = joints.ends[:, 1] - joints.ends[:, 0]
    wanted = [np.where(scene.wall[block], _target(scene, cells, block, run), np.inf) for block in joints.block.T]
    divisions = _parts(joints.length, np.minimum(*wanted))
    edge, reach = _reach(blocks, joints)

    # Joints in the order in which the outlines meet them; each edge ends with an empty piece.
    n_edges, n_sides = len(length), len(edge)
    edge = np.concatenate([edge, np.arange(n_edges)])
    low, high = np.concatenate([reach, np.column_stack([length, length])]).T
    order = np.lexsort((low, edge))
    edge, low, high = edge[order], low[order], high[order]
    before = np.where(np.diff(edge, prepend=-1) == 0, np.roll(high, 1), 0.0)
    is_joint = order < n_sides
    low = np.where(is_joint & (low <= before + blocks.tolerance), before, low)

    owner = blocks.owner[edge]
    target = np.where(scene.wall[owner], _target(scene, cells, owner, along[edge]), np.inf)
    gap_parts = np.where(low > before, _parts(low - before, target), 0)
    joint_parts = np.concatenate([np.repeat(divisions, 2), np.zeros(n_edges, dtype=np.int64)])[order]

    # Pieces alternate: the stretch before a joint, then the joint.
    parts = np.column_stack([gap_parts, joint_parts]).ravel()
    first_of_piece = np.concatenate([[0], np.cumsum(parts)])
    piece = np.repeat(np.arange(len(parts)), parts)
    step = np.arange(len(piece)) - first_of_piece[piece]
    begin, end = np.column_stack([before, low]).ravel(), np.column_stack([low, high]).ravel()
    distance = begin[piece] + step / parts[piece] * (end - begin)[piece]
    on_edge = np.repeat(edge, 2)[piece]
    points = blocks.vertices[on_edge] + distance[:, None] * along[on_edge]
    corner = (begin[piece] == 0) & (step == 0)
    block = blocks.owner[on_edge]
    first = np.concatenate([[0], np.cumsum(np.bincount(block, minlength=len(blocks)))])

    start = np.empty(n_sides, dtype=np.int64)
    start[order[is_joint]] = first_of_piece[1:-1:2][is_joint]
    return _turned(points, corner, first, divisions, start.reshape(-1, 2))


def _turned(points: Array, corner: Mask, first: Indices, divisions: Indices, start: Indices) -> NodeOutlines:
    """Renumber the nodes of each outline to begin at the lower left corner, in whatever order the block was drawn."""
    count = np.diff(first)
    block = np.repeat(np.arange(len(count)), count)
    # No side of a usual block is perpendicular to (0.3, 1), so rounding errors do not decide.
    height = np.where(corner, points @ [0.3, 1.0], np.inf)
    lowest = np.lexsort((height, block))[first[:-1]]

    def turned(node: Indices) -> Indices:
        return np.asarray((node - lowest[block[node]]) % count[block[node]])

    new = np.empty_like(points), np.empty_like(corner)
    place = first[block] + turned(np.arange(len(points)))
    new[0][place], new[1][place] = points, corner
    return NodeOutlines(*new, first, divisions, turned(start))


def _target(scene: Scene, cells: int, block: Indices, along: Array) -> Array:
    """Target length ``(n,)`` [m] of a part on sides of given blocks ``(n,)`` in directions ``(n, 2)``.

    Without a bond a block is treated as two square halves of its area.
    """
    if scene.bond is None:
        return np.asarray(np.sqrt(scene.blocks.area[block] / 2) / cells)
    level = np.abs(along[:, 0]) >= np.abs(along[:, 1])
    return np.where(level, scene.bond.width / 2, scene.bond.height) / cells


def _parts(length: Array, target: Array) -> Indices:
    """Number of parts nearest to a target length; ties are rounded down, whatever the rounding errors."""
    return np.maximum(1, np.floor(length / target + 0.499999)).astype(np.int64)


def _edges(blocks: Blocks) -> tuple[Array, Array]:
    """Direction ``(nv, 2)`` and length ``(nv,)`` [m] of every edge; an edge has the number of its first vertex."""
    vector = blocks.vertices[blocks.successor] - blocks.vertices
    length = np.hypot(*vector.T)
    return vector / length[:, None], length


def _reach(blocks: Blocks, joints: Joints) -> tuple[Indices, Array]:
    """Edge of each side of each joint ``(2 nj,)``, a before b, and the side's range along that edge ``(2 nj, 2)`` [m].

    An end within the contact tolerance of the edge's end is moved to it.
    """
    along, length = _edges(blocks)
    edge = _edges_of_joints(blocks, joints)
    # The outline of b runs against the tangent.
    ends = np.stack([joints.ends, joints.ends[:, ::-1]], axis=1).reshape(-1, 2, 2)
    reach = np.einsum("sei,si->se", ends - blocks.vertices[edge][:, None], along[edge])
    whole = length[edge][:, None]
    return edge, np.where(reach >= whole - blocks.tolerance, whole, reach)


def _edges_of_joints(blocks: Blocks, joints: Joints) -> Indices:
    """Edge on which each joint lies on block a, then on block b, ``(2 nj,)``."""
    block = joints.block.ravel()
    count = np.diff(blocks.first)[block]
    begin = np.concatenate([[0], np.cumsum(count)])
    side = np.repeat(np.arange(len(block)), count)
    edge = blocks.first[block][side] + np.arange(begin[-1]) - begin[side]
    start = blocks.vertices[edge]
    vector = blocks.vertices[blocks.successor[edge]] - start
    offset = joints.ends[side // 2] - start[:, None]
    share = np.einsum("nei,ni->ne", offset, vector) / (vector**2).sum(axis=1)[:, None]
    away = offset - np.clip(share, 0, 1)[:, :, None] * vector[:, None]
    distance = (away**2).sum(axis=2).max(axis=1)
    nearest = np.lexsort((distance, side))[begin[:-1]]
    return np.asarray(edge[nearest])
