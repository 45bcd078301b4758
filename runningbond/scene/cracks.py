"""Blocks that may crack: each is cut in two along its vertical axis, and the cut becomes a joint of its own.

The paper announces such inner interfaces on the blocks' axes of symmetry as its next step (Sec. 7).
"""

from collections.abc import Sequence

import numpy as np
import shapely

from .arrays import Array, Indices


def cut_in_half(polygons: Sequence[Array], widest: float) -> tuple[list[Array], Indices]:
    """Cut polygons at the vertical line through their centroids.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Convex blocks [m], counter-clockwise.
    widest : float
        Width [m] up to which a block is not cut.

    Returns
    -------
    list of (n, 2) float
        The pieces, left before right, in the order of their blocks.
    (n_pieces,) int
        Block that each piece was part of.
    """
    pieces: list[Array] = []
    owner: list[int] = []
    for k, polygon in enumerate(polygons):
        if np.ptp(polygon[:, 0]) <= widest:
            cut = [polygon]
        else:
            middle = shapely.Polygon(polygon).centroid.x
            cut = [_side(polygon, middle, -1.0), _side(polygon, middle, 1.0)]
        pieces += cut
        owner += [k] * len(cut)
    return pieces, np.array(owner)


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
