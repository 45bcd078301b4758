"""Contacts of corners that touch a side of another block without sharing a segment with it.

A corner may lie on a side between its ends, or in a notch, where it touches both sides. Corners of two blocks that meet
in a point have no normal, and no contact.
"""

import numpy as np
import shapely

from .arrays import Array, Indices, Mask
from .blocks import Blocks
from .segments import Joints

PARALLEL = 1e-3
"""Sine of the angle between a joint and a side up to which the joint lies on that side."""

LEAST_OVERLAP = 1e-2
"""Least overlap of a leaning side, relative to the shorter one of the two sides."""


def with_corners(joints: Joints, blocks: Blocks, fixed: Mask, whole: Blocks, part_of: Indices) -> Joints:
    """Joints, and after them the contacts of corners of which a block moves.

    `part_of` has the number among `whole` blocks of each block that may be cut from one, ``(nb,)``; −1 for others.
    """
    owner, start = blocks.owner, blocks.vertices
    run = start[blocks.successor] - start
    if (np.abs(run).min(axis=1) <= blocks.tolerance).all():
        return joints  # between level and upright sides corners always lie at ends of joints
    inside = blocks.reentrant | _cut(blocks, whole, part_of)
    corner, side = corners_on_sides(joints, blocks, fixed, inside)
    own = part_of[owner]
    within = (own[corner] == own[side]) & (own[side] >= 0)
    outer = ~within & ~_on_cuts(joints, blocks, start[side] + run[side] / 2)
    corner, side = corner[outer], side[outer]
    if not len(corner):
        return joints
    along = run[side] / np.hypot(*run[side].T)[:, None]
    # The normal points out of block a: along the side if that is a's, against it if the corner is.
    reach = np.where(owner[corner] < owner[side], -0.5, 0.5)[:, None] * blocks.tolerance * along
    return Joints(
        np.concatenate([joints.block, np.sort(owner[np.column_stack([corner, side])], axis=1)]),
        np.concatenate([joints.ends, start[corner][:, None] + np.stack([-reach, reach], axis=1)]),
        np.concatenate([joints.inner, np.zeros(len(corner), dtype=np.bool_)]),
        np.concatenate([joints.corner_length, _bearing(blocks, corner, side, run, along)]),
    )


def _cut(blocks: Blocks, whole: Blocks, part_of: Indices) -> Mask:
    """Vertices ``(nv,)`` of parts of blocks on sides or in notches of the whole block, where it was cut."""
    tree = shapely.STRtree(shapely.points(whole.vertices))
    vertex, near = tree.query(shapely.points(blocks.vertices), predicate="dwithin", distance=blocks.tolerance)
    own = part_of[blocks.owner]
    at_corner = vertex[~whole.reentrant[near] & (whole.owner[near] == own[vertex])]
    return np.asarray((own >= 0) & ~np.isin(np.arange(len(own)), at_corner))


def _on_cuts(joints: Joints, blocks: Blocks, points: Array) -> Mask:
    """Whether points ``(n, 2)`` lie on potential cracks."""
    tree = shapely.STRtree(shapely.linestrings(joints.ends[joints.inner]))
    number, _ = tree.query(shapely.points(points), predicate="dwithin", distance=blocks.tolerance)
    return np.isin(np.arange(len(points)), number)


def _bearing(blocks: Blocks, corner: Indices, side: Indices, run: Array, along: Array) -> Array:
    """Length ``(n,)`` [m] that the contacts of corners on sides stand for: that of the end of a joint.

    As at finite displacements it is half of the overlap, along the side, of the corner's own side that leans less on
    it, and at most a quarter of the shorter one of the two.
    """
    length, own = np.hypot(*run.T), np.column_stack([corner, blocks.predecessor[corner]])
    leans = np.abs(run[own, 0] * along[:, None, 1] - run[own, 1] * along[:, None, 0]) / length[own]
    chosen = np.argmin(leans, axis=1)
    facing = own[np.arange(len(own)), chosen]
    projected = np.where(chosen == 0, 1.0, -1.0) * (run[facing] * along).sum(axis=1)
    at = ((blocks.vertices[corner] - blocks.vertices[side]) * along).sum(axis=1)
    overlap = np.abs(np.clip(at + projected, 0.0, length[side]) - at)
    shorter = np.minimum(length[facing], length[side])
    return np.asarray(np.clip(overlap, LEAST_OVERLAP * shorter, shorter / 2) / 2)


def corners_on_sides(joints: Joints, blocks: Blocks, fixed: Mask, inside: Mask) -> tuple[Indices, Indices]:
    """Corners that touch sides of other blocks without a joint there, and these sides, two ``(n,)``.

    Sides may be touched at an end that is `inside`, ``(nv,)``: in a notch, or where the block was cut.
    """
    owner, corners, reach = blocks.owner, blocks.vertices, blocks.tolerance
    ends = np.column_stack([np.arange(len(owner)), blocks.successor])
    sides = corners[ends]
    tree = shapely.STRtree(shapely.points(corners))
    side, corner = tree.query(shapely.linestrings(sides), predicate="dwithin", distance=reach)
    away = np.hypot(*np.moveaxis(sides[side] - corners[corner][:, None], 2, 0))
    touches = ((away > reach) | inside[ends[side]]).all(axis=1) & ~blocks.reentrant[corner]
    touches &= can_part(blocks, fixed, corner, side)
    side, corner = side[touches], corner[touches]
    # A joint lies on that side if it is between the same blocks, touches the corner and is parallel to the side.
    near, joint = joints_at(joints, blocks, corner, side)
    (x, y), (u, v) = _directions(sides[side[near]]).T, _directions(joints.ends[joint]).T
    alone = ~np.isin(np.arange(len(corner)), near[np.abs(x * v - y * u) <= PARALLEL])
    return corner[alone], side[alone]


def can_part(blocks: Blocks, fixed: Mask, first: Indices, second: Indices) -> Mask:
    """Whether corners or sides ``(n,)`` belong to two blocks of which at least one moves."""
    a, b = blocks.owner[first], blocks.owner[second]
    return np.asarray((a != b) & ~(fixed[a] & fixed[b]))


def joints_at(joints: Joints, blocks: Blocks, corner: Indices, other: Indices) -> tuple[Indices, Indices]:
    """Numbers of corners ``(n,)``, and of the joints that touch them, of the same blocks as them and the `other`."""
    points = shapely.points(blocks.vertices[corner])
    tree = shapely.STRtree(shapely.linestrings(joints.ends))
    near, joint = tree.query(points, predicate="dwithin", distance=blocks.tolerance)
    owners = blocks.owner[np.column_stack([corner, other])][near]
    own = (np.sort(joints.block[joint]) == np.sort(owners)).all(axis=1)
    return near[own], joint[own]


def _directions(segments: Array) -> Array:
    """Unit vectors ``(n, 2)`` along segments ``(n, 2, 2)``."""
    run = segments[:, 1] - segments[:, 0]
    return np.asarray(run / np.hypot(*run.T)[:, None])
