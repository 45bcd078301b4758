"""Blocks that may crack: each is cut in two along its vertical axis, and the cut becomes a potential crack, a joint.

The paper names such inner interfaces on the blocks' axes of symmetry as future work (Sec. 7).
"""

from collections.abc import Sequence
from itertools import chain

import numpy as np
import shapely

from .arrays import Array, Indices
from .polygons import outer_corners, polygonal_parts

WIDTH_TOLERANCE = 1e-6
"""Relative excess over a width up to which a block still counts as of that width: rounding error."""

CORNER_SNAP = 0.01
"""Distance between axis and nearest corner, in block widths, below which the block is cut at the corner."""


def cut_in_half(polygons: Sequence[Array], widest: float) -> tuple[list[Array], Indices]:
    """Cut polygons ``(n, 2)`` [m] that are wider than `widest` [m] at the vertical line through their centroids.

    Returns the pieces, and the number of the block that each piece belongs to, ``(n_pieces,)``. Pieces are in the order
    of their blocks; within a block, those left of the line come first, and each side is listed from the bottom up. A
    polygon that is not convex may fall into more than two pieces.
    """
    # The rest of a block beside an opening may have exactly this width, and exceed it by the rounding error of a sum.
    least = widest * (1 + WIDTH_TOLERANCE)
    pieces = [_halves(polygon) if np.ptp(polygon[:, 0]) > least else [polygon] for polygon in polygons]
    return list(chain(*pieces)), np.repeat(np.arange(len(pieces)), [len(cut) for cut in pieces])


def _halves(polygon: Array) -> list[Array]:
    """Parts of a polygon on either side of its vertical axis, which is moved to a corner if one is near."""
    whole, x = shapely.Polygon(polygon), polygon[:, 0]
    middle, corner = whole.centroid.x, float(x[np.argmin(np.abs(x - whole.centroid.x))])
    middle = corner if abs(corner - middle) < CORNER_SNAP * np.ptp(x) else middle
    (left, low), (right, high) = polygon.min(axis=0) - 1.0, polygon.max(axis=0) + 1.0
    halves = shapely.intersection(whole, shapely.box([left, middle], low, [middle, right], high))
    return [outer_corners(part) for half in halves for part in polygonal_parts(half)]
