"""Blocks that may crack: each is cut in two along its vertical axis, and the cut becomes a joint of its own.

The paper announces such inner interfaces on the blocks' axes of symmetry as its next step (Sec. 7).
"""

from collections.abc import Sequence
from itertools import chain

import numpy as np
import shapely

from .arrays import Array, Indices
from .blocks import Blocks
from .polygons import outer_corners, polygonal_parts

NEAR = 0.01
"""Distance of the axis from a corner, in widths of a block that is not convex, within which it cracks there."""


def cut_in_half(polygons: Sequence[Array], widest: float) -> tuple[list[Array], Indices]:
    """Cut polygons ``(n, 2)`` [m] at the vertical line through their centroids, but for those up to a width [m].

    What is not convex may fall into more than two pieces. Those left of the line come before those right of it, from
    the bottom up, in the order of their blocks, and with them the block of each, ``(n_pieces,)``.
    """
    pieces: list[list[Array]] = []
    convex = Blocks.from_polygons(polygons).convex
    for polygon, is_convex in zip(polygons, convex.tolist(), strict=True):
        middle = shapely.Polygon(polygon).centroid.x
        if np.ptp(polygon[:, 0]) <= widest:
            pieces.append([polygon])
        elif is_convex:
            pieces.append([_side(polygon, middle, sense) for sense in (-1.0, 1.0)])
        else:
            pieces.append(_sides(polygon, middle))
    return list(chain(*pieces)), np.repeat(np.arange(len(pieces)), [len(cut) for cut in pieces])


def _sides(polygon: Array, middle: float) -> list[Array]:
    """Parts of a polygon on either side of a vertical line, which moves to a corner that is near it."""
    x = polygon[:, 0]
    nearest = float(x[np.argmin(np.abs(x - middle))])
    middle = nearest if abs(nearest - middle) < NEAR * np.ptp(x) else middle
    (left, low), (right, high) = polygon.min(axis=0) - 1.0, polygon.max(axis=0) + 1.0
    halves = shapely.box([left, middle], low, [middle, right], high)
    parts = [part for side in shapely.intersection(shapely.Polygon(polygon), halves) for part in polygonal_parts(side)]
    return [outer_corners(part) for part in parts]


def _side(polygon: Array, x: float, sense: float) -> Array:
    """Part of a convex polygon on one side of a vertical line, its corners in the same order."""
    corners: list[Array] = []
    for start, stop in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        before, after = sense * (start[0] - x), sense * (stop[0] - x)
        if before >= 0:
            corners.append(start)
        if before * after < 0:
            share = before / (before - after)
            corners.append(np.array([x, start[1] + share * (stop[1] - start[1])]))
    return np.array(corners)
