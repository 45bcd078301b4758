"""How charts look: colours and markers, series of rows, levels and brackets."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from runningbond.results import Outcome
from runningbond.scene import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#0b559f", "#2a9d8f", "#e9a23b", "#c2410c")
LOOKS = tuple(zip((*COLOURS, "#7c3aed"), "os^Dv", strict=True))  # colour and marker, one after another
Looks: TypeAlias = Mapping[Any, tuple[str, str]]  # colour and marker by the entries of a column
Row: TypeAlias = Mapping[str, Any]  # of a table, by columns


def bare(axes: "Axes") -> None:
    """Take away the frame where nothing is read off it."""
    axes.spines[["top", "right"]].set_visible(False)


def looks_of(names: Sequence[Any]) -> Looks:
    """`LOOKS` by names."""
    return dict(zip(names, LOOKS, strict=False))


def series(
    axes: "Axes",
    rows: Sequence[Row],
    x: str,
    y: str | Callable[[Row], float | None],
    by: str,
    looks: Looks,
    **style: Any,
) -> None:
    """Plot one column of rows over another, a series for each entry of a third; rows without a number are left out."""
    for name, (colour, marker) in looks.items():
        points = [(row[x], y(row) if callable(y) else row.get(y)) for row in rows if row[by] == name]
        points = [point for point in points if point[1] is not None]
        if points:
            axes.plot(*zip(*points, strict=True), **{"marker": marker, "color": colour, "label": str(name)} | style)


def level(axes: "Axes", y: float, text: str, x: float = 0.98, **style: Any) -> None:
    """A dashed line at a level, its name above it at a share of the axes' width."""
    axes.axhline(y, color="0.5", lw=0.9, ls="--", zorder=0)
    where: dict[str, Any] = {"ha": "right", "va": "bottom", "fontsize": 8, "color": "0.4"} | style
    axes.annotate(text, (x, y), xycoords=("axes fraction", "data"), **where)


def bracket(axes: "Axes", x: float, row: Row, colour: str, **style: Any) -> None:
    """A bracket of λ as an upright bar, paler where it is no collapse."""
    paler = 1.0 if row["status"] == "collapse" else 0.4
    bar: dict[str, Any] = {"color": colour, "lw": 4, "alpha": paler, "solid_capstyle": "butt"} | style
    axes.plot([x, x], [row["λ lower"], row["λ upper"]], **bar)


def mark(axes: "Axes", x: float, outcome: Outcome, colour: str, marker: str) -> None:
    """A bar for a bracket and a mark on it; a hollow one, on a thin bar, where no collapse load was found."""
    loads = [value for value in (outcome.lower, outcome.multiplier, outcome.upper) if value is not None] or [0.0]
    place, width, face, edge = outcome.multiplier, 2.5, colour, 1.5
    if place is None:
        place, width, face, edge = loads[-1], 0.8, "white", 1.0
    axes.plot([x, x], [loads[0], loads[-1]], color=colour, lw=width, solid_capstyle="butt")
    axes.plot(x, place, marker, color=colour, mfc=face, ms=5, mew=edge, ls="none", clip_on=False)


def in_units(unit: float) -> tuple[Callable[[ArrayLike], Array], Callable[[ArrayLike], Array]]:
    """From values to ratios to a unit, and back, as a second axis needs them."""
    return lambda value: np.asarray(value, float) / unit, lambda ratio: np.asarray(ratio, float) * unit
