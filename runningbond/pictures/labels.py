"""Labels of a drawing, each put where it hides nothing: neither another label nor an arrow."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from runningbond.scene import Array

from .style import DARK, TYPE

GAP, PAD = 2.5, 0.8
"""Distance of a label from what it is about, and air around it [pt]."""

AWAY = 16
"""Steps of half a line that a label may move farther away."""


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
