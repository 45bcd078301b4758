"""Corners on corners, which touch without a normal, and what a mechanism at small displacements does with them.

A corner of a block that meets a corner of another block at a point slips past it along either of two sides. At finite
displacements this contact is found; at small ones, and in limit analysis, it is left out.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from runningbond.results import Outcome
from runningbond.results.mechanism import MAX_OVERLAP, carried, fastest_corner
from runningbond.scene import Array, Blocks, Indices, Scene
from runningbond.scene.corner_contacts import PARALLEL, can_part, joints_at

from .model import Model

EXACT = 1e-6
"""Overlap relative to the motion of the fastest corner that rounding may leave in mechanisms of limit analysis."""


class Touching(NamedTuple):
    """Corners on corners of other blocks: each array has one row per corner and side that may keep them apart."""

    corner: Indices  # (n,)
    side: Indices  # (n,) by the corner where it starts
    place: Indices  # (n,) contact; blocks stay apart if one of the sides of a contact keeps them apart


def left_out_corner(model: Model, scene: Scene, outcome: Outcome) -> str:
    """Note on the contact of two corners that a mechanism violates most; empty if it violates none.

    Mechanisms of limit analysis are exact, and those of elastic joints may overlap by `MAX_OVERLAP`.
    """
    motion, blocks = outcome.motion, scene.blocks
    if motion.shape != (len(blocks), 3) or not np.isfinite(motion).all() or outcome.moved is not None:
        return ""
    corner, side, place = corners_on_corners(scene)
    if not len(corner):
        return ""
    at, owner = blocks.vertices[corner], blocks.owner
    jump = carried(blocks, owner[corner], at, motion) - carried(blocks, owner[side], at, motion)
    x, y = _between(blocks, side, blocks.successor[side]).T
    most = np.full(place.max() + 1, -np.inf)
    np.maximum.at(most, place, jump[:, 0] * y - jump[:, 1] * x)
    worst = int(np.argmin(most[place]))
    slack = EXACT if model.kind in ("bound", "certificate") else MAX_OVERLAP
    if most[place[worst]] >= -slack * fastest_corner(blocks, motion):
        return ""
    where = f"({at[worst, 0]:.4g}, {at[worst, 1]:.4g})"
    what = f"contact of the corners at {where} m, which touch without a joint, is left out"
    return f"{what}: the {'support may bear less' if scene.settlement else 'wall may bear more'}"


def corners_on_corners(scene: Scene) -> Touching:
    """Convex corners that touch each other without a joint there, and those of their sides that lie between them."""
    blocks, before = scene.blocks, scene.blocks.predecessor
    pairs = cKDTree(blocks.vertices).query_pairs(blocks.tolerance, output_type="ndarray").astype(np.int64)
    first, second = pairs[~blocks.reentrant[pairs].any(axis=1) & can_part(blocks, scene.fixed, *pairs.T)].T
    joined, _ = joints_at(scene.joints, blocks, first, second)
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


def _between(blocks: Blocks, start: Indices, stop: Indices) -> Array:
    """Unit vectors ``(n, 2)`` from corners ``(n,)`` to others."""
    run = blocks.vertices[stop] - blocks.vertices[start]
    return np.asarray(run / np.hypot(*run.T)[:, None])
