"""How charts look: colours and markers, series of rows, levels and brackets."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from runningbond.results import Outcome
from runningbond.scene import Array

from .style import CHART_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOOKS = tuple(zip(CHART_COLOURS, "os^Dv", strict=True))  # colour and marker, one after another
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


def ticks(axes: "Axes", values: Sequence[float], form: str = "{:g}") -> None:
    """Ticks of a logarithmic x axis at these values alone, written out."""
    axes.set_xticks(values, [form.format(value) for value in values])
    axes.minorticks_off()


def bracket(axes: "Axes", x: float, row: Row, colour: str, **style: Any) -> None:
    """A bracket of λ as an upright bar, hollow where it is no collapse."""
    bar: dict[str, Any] = {"color": colour, "lw": 4, "solid_capstyle": "butt"} | style
    hollow = row["status"] != "collapse"
    if hollow:
        axes.plot([x, x], [row["λ lower"], row["λ upper"]], **bar | {"solid_capstyle": "projecting"})
        bar |= {"color": "white", "lw": bar["lw"] / 2}
    axes.plot([x, x], [row["λ lower"], row["λ upper"]], **bar)


def floor(axes: "Axes", least: float) -> None:
    """A band at the end of an axis, where what is smaller is drawn, at a level that is said to be so much or less."""
    axes.axhspan(least / 2, 1.6 * least, color="0.93", lw=0, zorder=0)
    axes.annotate("or less", (0.99, least), xycoords=("axes fraction", "data"), ha="right", va="center", fontsize=8)


def mark(axes: "Axes", x: float, outcome: Outcome, colour: str, marker: str) -> None:
    """A bar for the bracket and a mark on it; both hollow where no collapse load was found, and at 0 without any."""
    from matplotlib.patches import Rectangle

    loads = [value for value in (outcome.lower, outcome.multiplier, outcome.upper) if value is not None] or [0.0]
    found = outcome.multiplier is not None
    axes.add_patch(
        Rectangle((x - 0.025, loads[0]), 0.05, loads[-1] - loads[0], fc=colour if found else "white", ec=colour)
    )
    look = {"mfc": colour, "mew": 0.8, "mec": "white"} if found and marker != "_" else {"mfc": "white"}
    place = loads[-1] if outcome.multiplier is None else outcome.multiplier
    axes.plot(x, place, marker, color=colour, ms=6, ls="none", clip_on=False, **look)


def in_units(unit: float) -> tuple[Callable[[ArrayLike], Array], Callable[[ArrayLike], Array]]:
    """From values to ratios to a unit, and back, as a second axis needs them."""
    return lambda value: np.asarray(value, float) / unit, lambda ratio: np.asarray(ratio, float) * unit
