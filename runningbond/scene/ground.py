"""The strip of ground that is laid below walls described without any."""

import numpy as np

from .arrays import Array
from .blocks import Blocks
from .history import History
from .loads import Load
from .supports import SupportKind

GROUND_REACH = 30.0
"""Reach of moving ground beyond either end of the wall, in its longer side: farther than records make walls slide.

Slip is measured from the ground's corners, so its rounding error grows with the reach: at 10 000, walls with stiff
joints never come to rest.
"""


def strip_reach(kind: SupportKind, load: Load) -> float | None:
    """Reach, in sizes of the wall, of the strip of ground below a wall without one; None if it needs none."""
    if kind != "base":
        return None
    return GROUND_REACH if any(isinstance(live, History) for live in load.live) else 1.0


def strip_below(blocks: Blocks, far: float) -> Array:
    """Ground that extends `far` sizes of the wall beyond either end; one is enough for a toppling wall to land on."""
    low, high = blocks.extent()
    size = max(high - low)
    depth, reach = 0.1 * size, far * size
    left, right, top = low[0] - reach, high[0] + reach, low[1]
    return np.array([[left, top - depth], [right, top - depth], [right, top], [left, top]])
