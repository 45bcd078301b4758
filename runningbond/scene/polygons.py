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


def smaller_sides(shapes: Sequence[Any]) -> Array:
    """Smaller side of the smallest rectangle around each polygon, ``(n,)``."""
    boxes = shapely.get_coordinates(shapely.oriented_envelope(shapes)).reshape(-1, 5, 2)
    found: Array = np.hypot(*np.moveaxis(boxes[:, 1:3] - boxes[:, :2], 2, 0)).min(axis=1)
    return found
