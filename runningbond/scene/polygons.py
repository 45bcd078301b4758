"""Parts of polygons that shapely has cut, and their corners."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from .arrays import Array

STRAIGHT = 1e-9
"""Sine of the angle by which an outline turns at a vertex, below which the vertex lies on a straight side."""


def polygonal_parts(shape: Any) -> list[Any]:
    """Polygons of a geometry, from the bottom up and left to right, without points and lines of mere contact."""
    parts = [part for part in shapely.get_parts(shape) if part.area > 0]
    return sorted(parts, key=lambda part: (part.bounds[1], part.bounds[0]))


def outer_corners(polygon: Any) -> Array:
    """Corners of a polygon, counter-clockwise, ``(n, 2)``, without vertices on straight sides."""
    ring = np.array(orient(polygon).exterior.coords)[:-1]
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(ring[np.abs(turn) > STRAIGHT * np.hypot(*before.T) * np.hypot(*after.T)])


def without_spikes(ring: Array, width: float) -> tuple[Array, Array]:
    """Remove corners at which a ring ``(n, 2)`` turns back on itself, as cutting and joining of shapes may leave them.

    Parameters
    ----------
    width
        Width of the widest spike that is removed, and largest distance at which two corners are merged [m].

    Returns
    -------
    ring, tips : (m, 2), (k, 2) float
        The remaining corners, at least three, and the removed tips of spikes out of the ring and of slits into it.
    """
    tips = np.zeros((0, 2))
    while len(ring) > 3:
        before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
        out, back = np.hypot(*before.T), np.hypot(*after.T)
        turn = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
        twice = np.flatnonzero(out <= width)
        if not len(twice):
            # The width of a spike is the distance of the end of its shorter side from the line of its longer one.
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
