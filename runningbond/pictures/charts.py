"""Elements of charts: colours and markers, series of table rows, levels and brackets."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from runningbond.results import Outcome
from runningbond.scene import Array

from .style import CHART_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOOKS = tuple(zip(CHART_COLOURS, "os^Dv", strict=True))  # pairs of colour and marker
Looks: TypeAlias = Mapping[Any, tuple[str, str]]  # colour and marker for each entry of a column
Row: TypeAlias = Mapping[str, Any]  # values of a table row by column name


def bare(axes: "Axes") -> None:
    """Remove the top and right sides of the frame, at which no values are read."""
    axes.spines[["top", "right"]].set_visible(False)


def looks_of(names: Sequence[Any]) -> Looks:
    """Assign the entries of `LOOKS` to names, in order; further names get the same colours with other markers."""
    n, (colours, markers) = len(LOOKS), zip(*LOOKS, strict=True)
    return {name: (colours[k % n], markers[(k + k // n) % n]) for k, name in enumerate(names)}


def series(
    axes: "Axes",
    rows: Sequence[Row],
    x: str,
    y: str | Callable[[Row], float | None],
    by: str,
    looks: Looks,
    **style: Any,
) -> None:
    """Plot column `y` of rows over column `x`, one series per entry of column `by`; skip rows without a number."""
    for name, (colour, marker) in looks.items():
        points = [(row[x], y(row) if callable(y) else row.get(y)) for row in rows if row[by] == name]
        points = [point for point in points if point[1] is not None]
        if points:
            axes.plot(*zip(*points, strict=True), **{"marker": marker, "color": colour, "label": str(name)} | style)


def level(axes: "Axes", y: float, text: str, x: float = 0.98, **style: Any) -> None:
    """Draw a dashed line at a level, with its name above it at a fraction of the axes' width."""
    axes.axhline(y, color="0.5", lw=0.9, ls="--", zorder=0)
    where: dict[str, Any] = {"ha": "right", "va": "bottom", "fontsize": 8, "color": "0.4"} | style
    axes.annotate(text, (x, y), xycoords=("axes fraction", "data"), **where)


def ticks(axes: "Axes", values: Sequence[float], form: str = "{:g}") -> None:
    """Set the ticks of a logarithmic x axis at the given values only, written out as numbers."""
    axes.set_xticks(values, [form.format(value) for value in values])
    axes.minorticks_off()


def bracket(axes: "Axes", x: float, row: Row, colour: str, **style: Any) -> None:
    """Draw a bracket of λ as a vertical bar, hollow unless the status is collapse."""
    bar: dict[str, Any] = {"color": colour, "lw": 4, "solid_capstyle": "butt"} | style
    hollow = row["status"] != "collapse"
    if hollow:
        axes.plot([x, x], [row["λ lower"], row["λ upper"]], **bar | {"solid_capstyle": "projecting"})
        bar |= {"color": "white", "lw": bar["lw"] / 2}
    axes.plot([x, x], [row["λ lower"], row["λ upper"]], **bar)


def floor(axes: "Axes", least: float) -> None:
    """Draw a band at the lower end of an axis, labelled "or less", for values that do not exceed `least`."""
    axes.axhspan(least / 2, 1.6 * least, color="0.93", lw=0, zorder=0)
    axes.annotate("or less", (0.99, least), xycoords=("axes fraction", "data"), ha="right", va="center", fontsize=8)


def mark(axes: "Axes", x: float, outcome: Outcome, colour: str, marker: str) -> None:
    """Draw a bar for the bracket with a marker on it; both hollow without a collapse load, and at 0 without bounds."""
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
    """Return the functions from values to multiples of a unit and back, as needed by a secondary axis."""
    return lambda value: np.asarray(value, float) / unit, lambda ratio: np.asarray(ratio, float) * unit
