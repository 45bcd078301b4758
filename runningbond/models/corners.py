"""Corners that touch another block without a joint, and what a mechanism at small displacements does with them.

A joint lies between two sides that share a segment. A corner in a notch, or on a side that it does not share a segment
with, is held by contact at a point only. Such points are found at finite displacements; at small ones blocks pass.
"""

import numpy as np
import shapely

from runningbond.results import Outcome
from runningbond.results.mechanism import MAX_OVERLAP, carried, fastest_corner
from runningbond.scene import Array, Indices, Scene

PARALLEL = 1e-3
"""Sine of the angle between a joint and a side up to which the joint lies on that side."""


def passes_corners(scene: Scene, outcome: Outcome, *, associated: bool) -> str:
    """Note on the corner that passes farthest into a block without a joint; empty if none does.

    If the flow rule is `associated`, contacts would open by tan φ times their slip, and bounds rely on that.
    """
    motion = outcome.motion
    if not len(motion) or not motion.any() or outcome.moved is not None:
        return ""
    corner, side = corners_without_joints(scene)
    if not len(corner):
        return ""
    blocks = scene.blocks
    at, block, other = blocks.vertices[corner], blocks.owner[corner], blocks.owner[side]
    jump = carried(blocks, block, at, motion) - carried(blocks, other, at, motion)
    x, y = _directions(blocks.vertices[np.column_stack([side, blocks.successor[side]])]).T
    opening = jump[:, 0] * y - jump[:, 1] * x
    if associated:
        friction = min(material.friction for material in scene.materials_of_joints)
        opening = opening - friction * np.abs(jump[:, 0] * x + jump[:, 1] * y)
    worst = int(np.argmin(opening))
    if opening[worst] >= -MAX_OVERLAP * fastest_corner(blocks, motion):
        return ""
    where = f"({at[worst, 0]:.4g}, {at[worst, 1]:.4g})"
    return f"the corner at {where} m passes into a block that it touches without a joint: the wall may bear more"


def corners_without_joints(scene: Scene) -> tuple[Indices, Indices]:
    """Corners, and the sides of other blocks that they touch without a joint there; two ``(n,)``.

    A corner touches a side between its ends, or in the notch at a re-entrant one.
    """
    blocks, joints, owner = scene.blocks, scene.joints, scene.blocks.owner
    ends = np.column_stack([np.arange(len(owner)), blocks.successor])
    corners, reach = shapely.STRtree(shapely.points(blocks.vertices)), blocks.tolerance
    sides = blocks.vertices[ends]
    side, corner = corners.query(shapely.linestrings(sides), predicate="dwithin", distance=reach)
    away = np.hypot(*np.moveaxis(sides[side] - blocks.vertices[corner][:, None], 2, 0))
    between = ((away > reach) | blocks.reentrant[ends[side]]).all(axis=1) & (owner[corner] != owner[side])
    between &= ~blocks.reentrant[corner] & ~(scene.fixed[owner[corner]] & scene.fixed[owner[side]])
    side, corner = side[between], corner[between]
    points = shapely.points(blocks.vertices[corner])
    near, joint = shapely.STRtree(shapely.linestrings(joints.ends)).query(points, predicate="dwithin", distance=reach)
    (x, y), (u, v) = _directions(sides[side[near]]).T, _directions(joints.ends[joint]).T
    of_both = np.sort(joints.block[joint]) == np.sort(owner[np.column_stack([corner, side])][near])
    jointed = near[of_both.all(axis=1) & (np.abs(x * v - y * u) <= PARALLEL)]
    alone = ~np.isin(np.arange(len(corner)), jointed)
    return corner[alone], side[alone]


def _directions(segments: Array) -> Array:
    """Unit vectors ``(n, 2)`` along segments ``(n, 2, 2)``."""
    run = segments[:, 1] - segments[:, 0]
    return np.asarray(run / np.hypot(*run.T)[:, None])
