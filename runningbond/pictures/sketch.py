"""Drawings around a wall: marks in metres, and labels whose type has a fixed size on paper."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from runningbond.scene import Array

from .deformed_shape import Extent
from .labels import Label, PlacedLabel, Spot, place_labels
from .style import DARK, DEAD, TYPE, UNIT

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Mark:
    """A line, an area or an arrow through points ``(n, 2)`` [m], with a name for what it represents."""

    kind: str
    name: str
    points: Array
    style: dict[str, Any]
    counts: bool = True
    """Whether the drawing reserves room for the whole mark."""


@dataclass(eq=False)
class Sketch:
    """Marks and labels around a wall, collected before they are placed and drawn.

    Parameters
    ----------
    point
        Metres per typographic point in the drawing.
    numbers
        Block numbers, already placed.
    """

    point: float
    numbers: Sequence[PlacedLabel] = ()
    marks: list[Mark] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    dots: list[Array] = field(default_factory=list)

    @property
    def a(self) -> float:
        """Unit of length for the size of marks [m]."""
        return UNIT * self.point

    def line(self, name: str, points: ArrayLike, *, counts: bool = True, **style: Any) -> None:
        """Add a line through points ``(n, 2)`` [m]."""
        self.marks.append(Mark("line", name, np.array(points), {"color": DARK, "lw": 0.9, "zorder": 5} | style, counts))

    def area(self, name: str, points: ArrayLike, *, counts: bool = True, **style: Any) -> None:
        """Add a polygon ``(n, 2)`` [m]."""
        look = {"fc": "white", "ec": DARK, "lw": 0.8, "zorder": 5} | style
        self.marks.append(Mark("area", name, np.array(points), look, counts))

    def disc(self, name: str, middle: ArrayLike, radius: float, **style: Any) -> None:
        """Add a disc with a given centre ``(2,)`` and radius [m]."""
        turn = np.linspace(0, 2 * np.pi, 25)[:-1]
        self.area(name, np.asarray(middle) + radius * np.column_stack([np.cos(turn), np.sin(turn)]), **style)

    def arrow(self, name: str, points: ArrayLike, colour: str, *, both: bool = False) -> None:
        """Add an arrow along a line ``(n, 2)`` [m], with a head at its end or at both ends, hollow for dead loads."""
        head = "-|>" if not both else "<|-|>"
        fill = {"ec": colour, "fc": "white" if colour == DEAD else colour}
        style = {"arrowstyle": f"{head},head_width=0.16,head_length=0.32", "lw": 1.0, "zorder": 6} | fill
        self.marks.append(Mark("arrow", name, np.array(points), style))

    def turn(self, name: str, middle: ArrayLike, radius: float, colour: str, *, clockwise: bool) -> None:
        """Add an arrow along three quarters of a circle around a point ``(2,)`` [m]."""
        angle = np.radians(np.linspace(-45, 225, 40))
        around = np.asarray(middle) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
        self.arrow(name, around[::-1] if clockwise else around, colour)

    def label(self, text: str, spots: list[Spot], colour: str = DARK, size: float = TYPE) -> None:
        """Add a text and its possible places."""
        self.labels.append(Label(text, spots, colour, size))

    def keep_clear(self, points: Array) -> None:
        """Register points ``(n, 2)`` [m] with symbols that labels should not hide."""
        self.dots.append(points)

    def taken(self) -> Array:
        """Boxes of the arrows, and of the labels as they would be placed now, ``(n, 2, 2)`` [m]."""
        arrows = [mark.points for mark in self.marks if mark.kind == "arrow"]
        boxes = [np.array([points.min(axis=0), points.max(axis=0)]) for points in arrows]
        return np.array([*boxes, *(one.box for one in self._labels_now())]).reshape(-1, 2, 2)

    @cached_property
    def placed(self) -> list[PlacedLabel]:
        """The placed labels; use it only after all marks have been added, since it is cached."""
        return self._labels_now()

    def _obstacles(self) -> Array:
        """Boxes around parts of the drawing that labels should not hide, ``(n, 2, 2)`` [m]."""
        pieces = [np.zeros((0, 2, 2)), *(one.box[None] for one in self.numbers)]
        pieces += [np.stack([dots - 0.2 * self.a, dots + 0.2 * self.a], axis=1) for dots in self.dots]
        for mark in self.marks:
            if mark.kind == "area":
                if mark.counts:
                    pieces.append(np.array([[mark.points.min(axis=0), mark.points.max(axis=0)]]))
                continue
            air = (0.25 if mark.kind == "arrow" else 0.05) * self.a
            start, run = mark.points[:-1, None], np.diff(mark.points, axis=0)[:, None]
            # An inclined line is covered by several small boxes, because a single one would be mostly empty.
            share = np.linspace(0, 1, 2 if len(run) > 1 or np.abs(run).min() < 1e-9 * np.abs(run).max() else 9)
            along = start + share[:, None] * run
            ends = np.stack([along[:, :-1], along[:, 1:]], axis=2).reshape(-1, 2, 2)
            pieces.append(np.stack([ends.min(axis=1) - air, ends.max(axis=1) + air], axis=1))
        return np.concatenate(pieces)

    @property
    def extent(self) -> Extent | None:
        """Extent of all marks and labels; None if there are none."""
        return self._around(self.placed)

    def room(self) -> Extent | None:
        """Extent so far, with labels as they would be placed now; None if there is nothing yet."""
        return self._around(self._labels_now())

    def _labels_now(self) -> list[PlacedLabel]:
        return place_labels(self.labels, self._obstacles(), self.point)

    def _around(self, labels: Sequence[PlacedLabel]) -> Extent | None:
        points = [mark.points for mark in self.marks if mark.counts] + [one.box for one in labels]
        if not points:
            return None
        (left, bottom), (right, top) = (pick(np.concatenate(points), axis=0) for pick in (np.min, np.max))
        air = 2 * self.point
        return float(left - air), float(right + air), float(bottom - air), float(top + air)

    def draw(self, axes: "Axes", share: float) -> None:
        """Draw everything into axes that show the extent at its scale, with type and arrow heads scaled by `share`."""
        from matplotlib.lines import Line2D
        from matplotlib.patches import FancyArrowPatch, Polygon
        from matplotlib.path import Path
        from matplotlib.patheffects import withStroke

        for mark in self.marks:
            if mark.kind == "arrow":
                drawn: Any = FancyArrowPatch(
                    path=Path(mark.points), mutation_scale=10 * share, joinstyle="miter", **mark.style
                )
            elif mark.kind == "area":
                drawn = Polygon(mark.points, **mark.style)
            else:
                drawn = Line2D(*mark.points.T, **mark.style)
            drawn.set_label(mark.name)
            axes.add_artist(drawn)
        for one, edge in (*((one, 0.42) for one in self.placed), *((one, 0.14) for one in self.numbers)):
            axes.text(
                float(one.middle[0]),
                float(one.middle[1]),
                one.label.text,
                ha="center",
                va="center",
                rotation=90 if one.upright else 0,
                fontsize=share * one.label.size,
                color=one.label.colour,
                path_effects=[withStroke(linewidth=edge * share * one.label.size, foreground="white")],
                zorder=8,
            )
