"""Labels of a drawing, placed so that they hide neither other labels nor arrows, and block numbers."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import shapely
from shapely.ops import polylabel

from runningbond.scene import Array, Scene

from .style import DARK, SMALL_TYPE, TYPE

GAP, PAD = 2.5, 0.8
"""Distance of a label from its point, and margin around the label [pt]."""

MAX_STEPS = 16
"""Number of distances tried for a label, each half a line farther away."""

SIZES = (1.0, 0.85, 0.7, 0.55, 0.4)
"""Size factors tried for a number that does not fit into its block at its usual size."""


@dataclass(frozen=True, eq=False)
class Spot:
    """Possible place of a label: a point ``(2,)`` [m] and its side ``(±1 or 0, ±1 or 0)``; `upright`: text runs up."""

    at: Array
    side: tuple[float, float]
    upright: bool = False


@dataclass(frozen=True, eq=False)
class Label:
    """A text and its possible places, the best first."""

    text: str
    spots: Sequence[Spot]
    colour: str = DARK
    size: float = TYPE


@dataclass(frozen=True, eq=False)
class PlacedLabel:
    """A placed label: the centre of its box ``(2,)`` and half the sides of the box ``(2,)`` [m]."""

    label: Label
    middle: Array
    half: Array
    upright: bool

    @property
    def box(self) -> Array:
        """Lower left and upper right corner of the box, ``(2, 2)`` [m]."""
        return np.array([self.middle - self.half, self.middle + self.half])


@cache
def text_size(text: str, size: float) -> tuple[float, float]:
    """Width and height of a text of one or more lines [pt]."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font, lines = FontProperties(size=size), text.split("\n")
    width = max(TextToPath().get_text_width_height_descent(line, font, ismath=False)[0] for line in lines)
    return float(width), (1.2 * len(lines) - 0.25) * size


def place_labels(labels: Sequence[Label], obstacles: Array, point: float) -> list[PlacedLabel]:
    """Place labels one after another where they cover least: no other label, and as few obstacles as possible.

    Parameters
    ----------
    obstacles : (n, 2, 2) float
        Boxes that labels should not hide [m].
    point
        Metres per typographic point in the drawing.
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
    """Possible places for a label, each with its penalty relative to the first."""
    width, height = text_size(label.text, label.size)
    found = []
    for rank, spot in enumerate(label.spots):
        size = np.array([height, width] if spot.upright else [width, height]) / 2 + PAD
        side = np.array(spot.side)
        for step in range(MAX_STEPS):
            away = GAP + step * label.size / 2
            middle = spot.at + point * side * (size + away / max(1.0, float(np.hypot(*side))))
            found.append((0.5 * rank + 1.5 * step, PlacedLabel(label, middle, point * size, spot.upright)))
    return found


def _covered(boxes: Array, others: Array) -> Array:
    """Share of each box ``(k, 2, 2)`` that is covered by other boxes ``(n, 2, 2)``, ``(k,)``."""
    sides = np.minimum(boxes[:, None, 1], others[:, 1]) - np.maximum(boxes[:, None, 0], others[:, 0])
    common = np.prod(np.maximum(sides, 0.0), axis=2).sum(axis=1)
    return np.asarray(common / np.prod(boxes[:, 1] - boxes[:, 0], axis=1))


def _box(middle: shapely.Point, half: Array) -> shapely.Polygon:
    return shapely.box(middle.x - half[0], middle.y - half[1], middle.x + half[0], middle.y + half[1])


def block_numbers(scene: Scene, point: float) -> list[PlacedLabel]:
    """Block numbers as used by ``assign``, in the largest type that fits at a given number of metres per point."""
    placed = []
    for number in range(int(scene.part_of.max()) + 1):
        own = np.flatnonzero(scene.part_of == number)
        outline = shapely.union_all([shapely.Polygon(scene.blocks.polygon(int(k))) for k in own])
        middle, (x0, y0, x1, y1) = outline.centroid, outline.bounds
        width, height = text_size(str(number), 1.0)
        size = float(min(0.8 * (x1 - x0) / width / point, 0.75 * (y1 - y0) / height / point, SMALL_TYPE))
        half = np.array([width, height]) / 2 * size * point
        if not outline.contains(_box(middle, half)):  # L-shaped: number in the wider arm, if need be smaller
            largest = max(shapely.get_parts(outline), key=shapely.area)  # rounding may keep halves apart
            middle = polylabel(largest, 1e-2 * (y1 - y0))
            share = next((share for share in SIZES if outline.contains(_box(middle, share * half))), SIZES[-1])
            size, half = share * size, share * half
        label = Label(str(number), (), "black", size)
        placed.append(PlacedLabel(label, np.array([middle.x, middle.y]), half, upright=False))
    return placed
