"""Blocks that may crack: each is cut in two along its vertical axis, and the cut becomes a joint of its own.

The paper announces such inner interfaces on the blocks' axes of symmetry as its next step (Sec. 7).
"""

from collections.abc import Sequence
from itertools import chain

import numpy as np
import shapely

from .arrays import Array, Indices
from .polygons import outer_corners, polygonal_parts

SAME = 1e-6
"""Part of a width by which a block may be wider and still count as of it."""

NEAR = 0.01
"""Distance of the axis from a corner, in widths of its block, within which that cracks there."""


def cut_in_half(polygons: Sequence[Array], widest: float) -> tuple[list[Array], Indices]:
    """Cut polygons ``(n, 2)`` [m] at the vertical line through their centroids, but for those up to a width [m].

    What is not convex may fall into more than two pieces. Those left of the line come before those right of it, from
    the bottom up, in the order of their blocks, and with them the block of each, ``(n_pieces,)``.
    """
    # What an opening leaves of a block may be as wide, and wider by the last bit of a sum of sizes.
    least = widest * (1 + SAME)
    pieces = [_halves(polygon) if np.ptp(polygon[:, 0]) > least else [polygon] for polygon in polygons]
    return list(chain(*pieces)), np.repeat(np.arange(len(pieces)), [len(cut) for cut in pieces])


def _halves(polygon: Array) -> list[Array]:
    """Parts of a polygon on either side of its axis, which moves to a corner that is near it."""
    whole, x = shapely.Polygon(polygon), polygon[:, 0]
    middle, corner = whole.centroid.x, float(x[np.argmin(np.abs(x - whole.centroid.x))])
    middle = corner if abs(corner - middle) < NEAR * np.ptp(x) else middle
    (left, low), (right, high) = polygon.min(axis=0) - 1.0, polygon.max(axis=0) + 1.0
    halves = shapely.intersection(whole, shapely.box([left, middle], low, [middle, right], high))
    return [outer_corners(part) for half in halves for part in polygonal_parts(half)]
