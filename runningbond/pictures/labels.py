"""Labels of a drawing, each where it hides nothing, neither another label nor an arrow; and numbers of blocks."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import shapely
from shapely.ops import polylabel

from runningbond.scene import Array, Scene

from .style import DARK, SMALL_TYPE, TYPE

GAP, PAD = 2.5, 0.8
"""Distance of a label from what it is about, and air around it [pt]."""

AWAY = 16
"""Steps of half a line that a label may move farther away."""

SMALLER = (1.0, 0.85, 0.7, 0.55, 0.4)
"""Sizes of type to be tried for a number in a block in which it does not fit at its usual size."""


@dataclass(frozen=True, eq=False)
class Spot:
    """A place for a label: a point ``(2,)`` [m], and on which side of it, ``(±1 or 0, ±1 or 0)``."""

    at: Array
    side: tuple[float, float]
    upright: bool = False


@dataclass(frozen=True, eq=False)
class Label:
    """A text and the places where it may stand, the best first."""

    text: str
    spots: Sequence[Spot]
    colour: str = DARK
    size: float = TYPE


@dataclass(frozen=True, eq=False)
class PlacedLabel:
    """A label in its place: the middle of its box ``(2,)``, and half that box's sides ``(2,)`` [m]."""

    label: Label
    middle: Array
    half: Array
    upright: bool

    @property
    def box(self) -> Array:
        """Lower left and upper right corner, ``(2, 2)`` [m]."""
        return np.array([self.middle - self.half, self.middle + self.half])


@cache
def text_size(text: str, size: float) -> tuple[float, float]:
    """Width and height of text in lines [pt]."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font, lines = FontProperties(size=size), text.split("\n")
    width = max(TextToPath().get_text_width_height_descent(line, font, ismath=False)[0] for line in lines)
    return float(width), (1.2 * len(lines) - 0.25) * size


def place_labels(labels: Sequence[Label], obstacles: Array, point: float) -> list[PlacedLabel]:
    """Put labels one after another where they cover least: no label, and as few obstacles as can be.

    Parameters
    ----------
    obstacles : (n, 2, 2) float
        Boxes of what labels had better not hide [m].
    point
        Metres that a point of the type takes in the drawing.
    """
    placed: list[PlacedLabel] = []
    for label in labels:
        ranks, candidates = zip(*_candidates(label, point), strict=True)
        boxes = np.array([one.box for one in candidates])
        taken = np.array([one.box for one in placed]).reshape(-1, 2, 2)
        costs = np.array(ranks) + 1e3 * _covered(boxes, taken) + 30 * _covered(boxes, obstacles)
        placed.append(candidates[int(costs.argmin())])
    return placed


def _candidates(label: Label, point: float) -> list[tuple[float, PlacedLabel]]:
    """Places for a label, and how much worse each is than the first."""
    width, height = text_size(label.text, label.size)
    found = []
    for rank, spot in enumerate(label.spots):
        size = np.array([height, width] if spot.upright else [width, height]) / 2 + PAD
        side = np.array(spot.side)
        for step in range(AWAY):
            away = GAP + step * label.size / 2
            middle = spot.at + point * side * (size + away / max(1.0, float(np.hypot(*side))))
            found.append((0.5 * rank + 1.5 * step, PlacedLabel(label, middle, point * size, spot.upright)))
    return found


def _covered(boxes: Array, others: Array) -> Array:
    """Share of each box ``(k, 2, 2)`` that others ``(n, 2, 2)`` cover, ``(k,)``."""
    sides = np.minimum(boxes[:, None, 1], others[:, 1]) - np.maximum(boxes[:, None, 0], others[:, 0])
    common = np.prod(np.maximum(sides, 0.0), axis=2).sum(axis=1)
    return np.asarray(common / np.prod(boxes[:, 1] - boxes[:, 0], axis=1))


def _box(middle: shapely.Point, half: Array) -> shapely.Polygon:
    return shapely.box(middle.x - half[0], middle.y - half[1], middle.x + half[0], middle.y + half[1])


def block_numbers(scene: Scene, point: float) -> list[PlacedLabel]:
    """The numbers that ``assign`` knows blocks by, in type as large as fits where a point takes so many metres."""
    placed = []
    for number in range(int(scene.part_of.max()) + 1):
        own = np.flatnonzero(scene.part_of == number)
        outline = shapely.union_all([shapely.Polygon(scene.blocks.polygon(int(k))) for k in own])
        middle, (x0, y0, x1, y1) = outline.centroid, outline.bounds
        width, height = text_size(str(number), 1.0)
        size = float(min(0.8 * (x1 - x0) / width / point, 0.75 * (y1 - y0) / height / point, SMALL_TYPE))
        half = np.array([width, height]) / 2 * size * point
        if not outline.contains(_box(middle, half)):  # of an L: in its wider arm, as large as that is
            largest = max(shapely.get_parts(outline), key=shapely.area)  # halves may not meet to the last bit
            middle = polylabel(largest, 1e-2 * (y1 - y0))
            share = next((share for share in SMALLER if outline.contains(_box(middle, share * half))), SMALLER[-1])
            size, half = share * size, share * half
        label = Label(str(number), (), "black", size)
        placed.append(PlacedLabel(label, np.array([middle.x, middle.y]), half, upright=False))
    return placed
