"""Blocks that may crack: each is cut in two along its vertical axis, and the cut becomes a joint of its own.

The paper announces such inner interfaces on the blocks' axes of symmetry as its next step (Sec. 7).
"""

from collections.abc import Sequence
from itertools import chain

import numpy as np
import shapely

from .arrays import Array, Indices


def cut_in_half(polygons: Sequence[Array], widest: float) -> tuple[list[Array], Indices]:
    """Cut convex polygons ``(n, 2)`` [m] at the vertical line through their centroids, but for those up to a width [m].

    The pieces come left before right in the order of their blocks, and with them the block of each, ``(n_pieces,)``.
    """
    pieces: list[list[Array]] = []
    for polygon in polygons:
        middle = shapely.Polygon(polygon).centroid.x
        is_cut = np.ptp(polygon[:, 0]) > widest
        pieces.append([_side(polygon, middle, sense) for sense in (-1.0, 1.0)] if is_cut else [polygon])
    return list(chain(*pieces)), np.repeat(np.arange(len(pieces)), [len(cut) for cut in pieces])


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
