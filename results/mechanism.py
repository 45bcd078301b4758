"""Mechanisms: how blocks move at collapse, brought to one size."""

import numpy as np

from scene import Array, Blocks


def fastest_corner_by_one(blocks: Blocks, motion: Array) -> Array:
    """Scale motions ``(nb, 3)`` so that the fastest corner of any block moves by one metre."""
    arm = blocks.vertices - blocks.centroid[blocks.owner]
    u, v, spin = motion[blocks.owner].T
    fastest = float(np.hypot(u - spin * arm[:, 1], v + spin * arm[:, 0]).max())
    return motion / fastest if fastest > 0 else motion
