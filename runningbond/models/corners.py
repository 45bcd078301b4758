"""Corners that touch another block without a joint, and what a mechanism at small displacements does with them.

A joint lies between two sides that share a segment. A corner in a notch, on another corner, or on a side that it does
not share a segment with, is held by contact at a point only. Such points are found at finite displacements; at small
ones, and in limit analysis, they are left out.
"""

from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import cKDTree

from runningbond.results import Outcome
from runningbond.results.mechanism import MAX_OVERLAP, carried, fastest_corner
from runningbond.scene import Array, Blocks, Indices, Mask, Scene

from .model import Model

PARALLEL = 1e-3
"""Sine of the angle between a joint and a side up to which the joint lies on that side."""

EXACT = 1e-6
"""Overlap relative to the motion of the fastest corner that rounding may leave in mechanisms of limit analysis."""


class Touching(NamedTuple):
    """Corners on sides of other blocks: each array has one row per corner and side."""

    corner: Indices  # (n,)
    side: Indices  # (n,) by the corner where it starts
    place: Indices  # (n,) contact; blocks stay apart if one of the sides of a contact keeps them apart


def left_out_corner(model: Model, scene: Scene, outcome: Outcome) -> str:
    """Note on the contact of a corner that a mechanism violates most; empty if it violates none.

    In the mechanisms of upper bounds, corners on sides must open by tan φ times their slip. Those of proofs are exact,
    and those of elastic joints may overlap by `MAX_OVERLAP`.
    """
    motion, blocks = outcome.motion, scene.blocks
    if motion.shape != (len(blocks), 3) or not np.isfinite(motion).all() or outcome.moved is not None:
        return ""
    on_sides, on_corners = corners_on_sides(scene), corners_on_corners(scene)
    corner, side = (np.concatenate(each) for each in zip(on_sides[:2], on_corners[:2], strict=True))
    place = np.concatenate([on_sides.place, len(on_sides.place) + on_corners.place])
    if not len(corner):
        return ""
    at, owner = blocks.vertices[corner], blocks.owner
    jump = carried(blocks, owner[corner], at, motion) - carried(blocks, owner[side], at, motion)
    x, y = _between(blocks, side, blocks.successor[side]).T
    opening = jump[:, 0] * y - jump[:, 1] * x
    if model.kind == "bound":  # between two corners there is no normal by which slip would open them
        friction = min(material.friction for material in scene.materials_of_joints)
        opening -= np.where(place < len(on_sides.place), friction * np.abs(jump[:, 0] * x + jump[:, 1] * y), 0.0)
    most = np.full(place.max() + 1, -np.inf)
    np.maximum.at(most, place, opening)
    worst = int(np.argmin(most[place]))
    slack = EXACT if model.kind in ("bound", "certificate") else MAX_OVERLAP
    if most[place[worst]] >= -slack * fastest_corner(blocks, motion):
        return ""
    where = f"({at[worst, 0]:.4g}, {at[worst, 1]:.4g})"
    what = f"contact at the corner {where} m, which touches a block without a joint, is left out"
    return f"{what}: the {'support may bear less' if scene.settlement else 'wall may bear more'}"


def corners_on_sides(scene: Scene) -> Touching:
    """Corners that touch sides of other blocks without a joint there, between their ends or in a notch."""
    blocks, joints, owner = scene.blocks, scene.joints, scene.blocks.owner
    ends = np.column_stack([np.arange(len(owner)), blocks.successor])
    corners, reach = shapely.STRtree(shapely.points(blocks.vertices)), blocks.tolerance
    sides = blocks.vertices[ends]
    side, corner = corners.query(shapely.linestrings(sides), predicate="dwithin", distance=reach)
    away = np.hypot(*np.moveaxis(sides[side] - blocks.vertices[corner][:, None], 2, 0))
    between = ((away > reach) | blocks.reentrant[ends[side]]).all(axis=1) & ~blocks.reentrant[corner]
    between &= _can_part(scene, corner, side)
    side, corner = side[between], corner[between]
    # A joint lies on that side if it is between the same blocks, touches the corner and is parallel to the side.
    near, joint = _joints_at(scene, corner, side)
    (x, y), (u, v) = _directions(sides[side[near]]).T, _directions(joints.ends[joint]).T
    alone = ~np.isin(np.arange(len(corner)), near[np.abs(x * v - y * u) <= PARALLEL])
    return Touching(corner[alone], side[alone], np.arange(np.count_nonzero(alone)))


def corners_on_corners(scene: Scene) -> Touching:
    """Convex corners that touch each other without a joint there, and those of their sides that lie between them."""
    blocks = scene.blocks
    before = np.empty_like(blocks.successor)
    before[blocks.successor] = np.arange(len(before))
    pairs = cKDTree(blocks.vertices).query_pairs(blocks.tolerance, output_type="ndarray").astype(np.int64)
    first, second = pairs[~blocks.reentrant[pairs].any(axis=1) & _can_part(scene, *pairs.T)].T
    joined, _ = _joints_at(scene, first, second)
    alone = ~np.isin(np.arange(len(first)), joined)
    first, second = first[alone], second[alone]
    corner = np.concatenate([first, second, first, second])
    side = np.concatenate([second, first, before[second], before[first]])
    place = np.tile(np.arange(len(first)), 4)
    x, y = _between(blocks, side, blocks.successor[side]).T
    outside = np.ones(len(corner), dtype=np.bool_)
    for neighbour in (before[corner], blocks.successor[corner]):
        u, v = _between(blocks, corner, neighbour).T
        outside &= u * y - v * x >= -PARALLEL
    return Touching(corner[outside], side[outside], np.unique(place[outside], return_inverse=True)[1])


def _can_part(scene: Scene, first: Indices, second: Indices) -> Mask:
    """Whether corners or sides ``(n,)`` belong to two blocks of which at least one moves."""
    a, b = scene.blocks.owner[first], scene.blocks.owner[second]
    return np.asarray((a != b) & ~(scene.fixed[a] & scene.fixed[b]))


def _joints_at(scene: Scene, corner: Indices, other: Indices) -> tuple[Indices, Indices]:
    """Numbers of corners ``(n,)``, and of the joints that touch them, of the same blocks as them and the `other`."""
    blocks, joints = scene.blocks, scene.joints
    points = shapely.points(blocks.vertices[corner])
    tree = shapely.STRtree(shapely.linestrings(joints.ends))
    near, joint = tree.query(points, predicate="dwithin", distance=blocks.tolerance)
    owners = blocks.owner[np.column_stack([corner, other])][near]
    own = (np.sort(joints.block[joint]) == np.sort(owners)).all(axis=1)
    return near[own], joint[own]


def _between(blocks: Blocks, start: Indices, stop: Indices) -> Array:
    """Unit vectors ``(n, 2)`` from corners ``(n,)`` to others."""
    return _directions(blocks.vertices[np.column_stack([start, stop])])


def _directions(segments: Array) -> Array:
    """Unit vectors ``(n, 2)`` along segments ``(n, 2, 2)``."""
    run = segments[:, 1] - segments[:, 0]
    return np.asarray(run / np.hypot(*run.T)[:, None])
