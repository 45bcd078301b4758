"""Parts of polygons that were cut, as shapely gives them, and their corners."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from .arrays import Array

STRAIGHT = 1e-9
"""Sine of the turn below which a corner is none."""


def polygonal_parts(shape: Any) -> list[Any]:
    """Polygons of a geometry, from the bottom up and left to right; points and lines where it touched are left out."""
    parts = [part for part in shapely.get_parts(shape) if part.area > 0]
    return sorted(parts, key=lambda part: (part.bounds[1], part.bounds[0]))


def outer_corners(polygon: Any) -> Array:
    """Corners of a polygon, counter-clockwise, ``(n, 2)``; those in the middle of a straight side are left out."""
    ring = np.array(orient(polygon).exterior.coords)[:-1]
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(ring[np.abs(turn) > STRAIGHT * np.hypot(*before.T) * np.hypot(*after.T)])


def without_spikes(ring: Array, width: float) -> tuple[Array, Array]:
    """A ring's corners ``(n, 2)`` without those at which it turns back on itself, as cutting and joining shapes leaves.

    Parameters
    ----------
    width
        Of the widest spike that is taken out, and of the largest distance at which two corners are one [m].

    Returns
    -------
    ring, tips : (m, 2), (k, 2) float
        What is left, three corners at least, and the corners that spikes out of the ring, or slits into it, ended at.
    """
    tips = np.zeros((0, 2))
    while len(ring) > 3:
        before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
        out, back = np.hypot(*before.T), np.hypot(*after.T)
        turn = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
        twice = np.flatnonzero(out <= width)
        if not len(twice):
            # The end of its shorter side is as far from the line of the longer one as the spike is wide.
            spikes = np.flatnonzero(((before * after).sum(axis=1) < 0) & (turn <= width * np.maximum(out, back)))
            if not len(spikes):
                break
            tips = np.vstack([tips, ring[spikes[0]]])
            ring = np.delete(ring, spikes[0], axis=0)
        else:
            ring = np.delete(ring, twice[0], axis=0)
    return ring, tips


def smaller_sides(shapes: Sequence[Any]) -> Array:
    """Smaller side of the smallest rectangle around each polygon, ``(n,)``."""
    boxes = shapely.get_coordinates(shapely.oriented_envelope(shapes)).reshape(-1, 5, 2)
    found: Array = np.hypot(*np.moveaxis(boxes[:, 1:3] - boxes[:, :2], 2, 0)).min(axis=1)
    return found
