"""Mechanisms: how blocks move at collapse, brought to one size."""

import numpy as np

from runningbond.joints import JointPoints
from runningbond.scene import Array, Blocks, Indices


def fastest_corner_by_one(blocks: Blocks, motion: Array) -> Array:
    """Scale motions ``(nb, 3)`` so that the fastest corner of any block moves by one metre."""
    fastest = float(np.hypot(*carried(blocks, blocks.owner, blocks.vertices, motion).T).max())
    return motion / fastest if fastest > 0 else motion


def carried(blocks: Blocks, block: Indices, at: Array, motion: Array) -> Array:
    """Displacements ``(n, 2)`` [m] of points ``(n, 2)`` of blocks ``(n,)`` that move by ``(nb, 3)``, to first order."""
    arm = at - blocks.centroid[block]
    u, v, spin = motion[block].T
    return np.column_stack([u - spin * arm[:, 1], v + spin * arm[:, 0]])


def rigid_jumps(blocks: Blocks, points: JointPoints, motion: Array) -> tuple[Array, Array]:
    """Opening and slip [m] of joint points between rigid blocks that move by ``(nb, 3)``, two ``(np,)``."""
    a, b = (carried(blocks, side, points.position, motion) for side in points.block.T)
    jump = b - a
    return (jump * points.normal).sum(axis=1), (jump * points.tangent).sum(axis=1)
