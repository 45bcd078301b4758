"""The numbers that ``assign`` knows blocks by."""

import numpy as np
import shapely

from runningbond.scene import Scene

from .labels import Label, PlacedLabel, text_size
from .style import SMALL_TYPE


def block_numbers(scene: Scene, point: float) -> list[PlacedLabel]:
    """The number of each block inside it, in type as large as fits where a point takes so many metres."""
    placed = []
    for number in range(int(scene.part_of.max()) + 1):
        own = np.flatnonzero(scene.part_of == number)
        outline = shapely.union_all([shapely.Polygon(scene.blocks.polygon(int(k))) for k in own])
        middle = outline.centroid if outline.contains(outline.centroid) else outline.representative_point()
        x0, y0, x1, y1 = outline.bounds
        width, height = text_size(str(number), 1.0)
        size = float(min(0.8 * (x1 - x0) / width / point, 0.75 * (y1 - y0) / height / point, SMALL_TYPE))
        half = np.array([width, height]) / 2 * size * point
        label = Label(str(number), (), "black", size)
        placed.append(PlacedLabel(label, np.array([middle.x, middle.y]), half, upright=False))
    return placed
