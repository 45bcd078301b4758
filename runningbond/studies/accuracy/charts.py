"""Charts of the study: error against cost, growth with the number of blocks, and the cost of stiff blocks."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from runningbond.models import MODEL_LOOKS
from runningbond.pictures.charts import in_units, ticks
from runningbond.pictures.labels import Label, Spot, place_labels
from runningbond.studies import Chart, Row, Rows
from runningbond.studies.apart import LONGEST, TOO_LONG

from .measure import REFERENCE
from .parameters import VARIED
from .tables import CHANGED, certified_itself, exponent, growth, stiffness
from .walls import all_walls

FLOOR, TOP = 1e-4, 3.0  # smallest error drawn, also for zero, and the end of the axis
RIGID, ASIDE = ("limit", "limit-nonassociated", "dem-static", "dem-dynamic"), 1.1  # rigid blocks; factor between marks

Named: TypeAlias = tuple[float, float, str, str]  # a point of a chart, the name to write beside it, and its colour
NAMES: dict[str, Any] = {"xycoords": "figure points", "textcoords": "figure points", "annotation_clip": False}
NAMES |= {"ha": "center", "va": "center", "fontsize": 8}
NAMES["bbox"] = {"boxstyle": "square,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.85}  # readable over lines
LEGEND_ROWS = 3
DRIVEN = "driven, steps"
VARIATIONS = ("", "joint rule", "cells", "modes", "mass scaling", "tolerance", "first step", DRIVEN)
MARKS = dict(zip(VARIATIONS, "os^DXPv*", strict=True))  # by parameter; an unchanged model has the first, filled
TITLES = {
    "stack-of-5": "stack of five blocks, exact",
    "wall-w1-inset": "wall W1, published to four digits",
    "wall-w3-inset": "wall W3 with its opening, published",
    "panel-02": "panel 2, interval of certified loads",
}


def draw_errors(
    draw: Callable[[Axes, Sequence[Row]], "list[Named]"], cost: str, what: str, figure: Figure, rows: Rows
) -> None:
    """Plot error against a cost, one axes per wall."""
    drawn = [row for row in rows["accuracy"] if row.get(cost) and row["model"] != "homog"]  # homog costs nothing
    judged = [row for row in drawn if row.get("error") is not None and not certified_itself(row)]
    named: list[tuple[Axes, list[Named]]] = []
    for axes, wall in zip(np.ravel(figure.subplots(2, 2, sharey=True)), VARIED, strict=True):
        own = [row for row in judged if row["wall"] == wall]
        if own:
            named.append((axes, draw(axes, own)))
        axes.set_title(TITLES[wall], fontsize=11, loc="left", fontweight="bold")
        axes.set_xlabel(what)
        axes.set_ylabel("relative error of λ" if axes.get_subplotspec().is_first_col() else "")
    _legend(figure, judged)
    figure.draw_without_rendering()  # fixes the positions of the marks
    for axes, points in named:
        _name(axes, points)


def _name(axes: Axes, points: Sequence[Named]) -> None:
    """Write names beside their marks without covering marks or other names; a line leads to a mark that is not near.

    Points without a name only block space.
    """
    point = 72 / axes.figure.dpi
    places = point * axes.transData.transform([(x, y) for x, y, *_ in points])
    marks = np.stack([places - 5, places + 5], axis=1)
    texts = [(at, text, colour) for at, (_, _, text, colour) in zip(places, points, strict=True) if text]
    sides = ((1.0, 0.0), (1.0, 1.0), (1.0, -1.0), (-1.0, 0.0), (-1.0, 1.0), (-1.0, -1.0), (0.0, 1.0))
    labels = [
        Label(text, [Spot(at + 5 * np.sign(side), side) for side in sides], colour, 8) for at, text, colour in texts
    ]
    for (at, _, _), placed in zip(texts, place_labels(labels, marks, 1.0), strict=True):
        near = np.clip(at, *placed.box)
        leads = {"arrowprops": {"arrowstyle": "-", "lw": 0.6, "color": placed.label.colour, "shrinkA": 0, "shrinkB": 4}}
        far: dict[str, Any] = leads if np.hypot(*(near - at)) > 9 else {}
        x, y = map(float, placed.middle)
        name = axes.annotate(placed.label.text, at, (x, y), color=placed.label.colour, **NAMES, **far)
        name.set_in_layout(False)


def _against_seconds(axes: Axes, rows: Sequence[Row]) -> list[Named]:
    """Plot errors against CPU seconds; the second axis is relative to the limit program on the same wall."""
    seconds = [row["cpu_s"] for row in rows]
    named = _draw_errors(axes, rows, seconds, seconds)
    unit = next((row["cpu_s"] for row in rows if row["model"] == REFERENCE), None)
    if unit:
        ratio = axes.secondary_xaxis("top", functions=in_units(unit))
        ratio.set_xlabel(f"times the {REFERENCE} program on the same wall", fontsize=9, color="0.35")
    return named


def _against_freedoms(axes: Axes, rows: Sequence[Row]) -> list[Named]:
    """Plot errors against degrees of freedom; models with equally many are drawn side by side."""
    freedoms = [float(row["dofs"]) for row in rows]
    aside = {model: ASIDE ** (i - (len(RIGID) - 1) / 2) for i, model in enumerate(RIGID)}
    beside = [x * aside.get(row["model"], 1.0) for x, row in zip(freedoms, rows, strict=True)]
    named = _draw_errors(axes, rows, freedoms, beside)
    marked: list[float] = []
    for number in sorted(set(freedoms)):
        if not marked or number > 1.35 * marked[-1]:
            marked.append(number)
    ticks(axes, marked, "{:,.0f}")
    return named


def _draw_errors(axes: Axes, rows: Sequence[Row], cost: Sequence[float], x: Sequence[float]) -> list[Named]:
    """Draw errors at `x`, near their `cost`, and the Pareto front of the costs; returns the points with their names."""
    y, right = [max(row["error"], FLOOR) for row in rows], 3 * max(x)
    axes.set(xscale="log", yscale="log", xlim=(min(x) / 2, right), ylim=(FLOOR / 1.8, TOP))
    axes.axhspan(FLOOR / 1.8, FLOOR * 1.25, color="0.93", zorder=0)
    axes.set_yticks([FLOOR, 1e-3, 1e-2, 0.1, 1.0], ["≤ 0.01 %", "0.1 %", "1 %", "10 %", "100 %"])
    front = pareto_front(cost, y)
    ends = [x[front[0]], *(x[i] for i in front), right], [TOP, *(y[i] for i in front), y[front[-1]]]
    axes.step(*ends, where="post", color="0.55", lw=1.4, zorder=1)
    plain = {row["model"]: error for row, error in zip(rows, y, strict=True) if not row["parameter"]}
    named: list[Named] = []
    for at, error, row in zip(x, y, rows, strict=True):
        (colour, _), driven = MODEL_LOOKS[row["model"]], row["parameter"] == DRIVEN
        hollow: dict[str, Any] = {"color": "none", "mec": colour, "mew": 1.5, "ms": 9 if driven else 7, "zorder": 2}
        filled: dict[str, Any] = {"color": colour, "mec": "white", "mew": 0.8, "ms": 11, "zorder": 3}
        axes.plot(at, error, MARKS[row["parameter"]], **(hollow if row["parameter"] else filled))
        # Only settings that change the error are named.
        changed = row["parameter"] and not 1 / CHANGED < error / plain.get(row["model"], error) < CHANGED
        named.append((at, error, row["setting"] if changed else "", colour))
    axes.grid(which="major", color="0.9", lw=0.7)
    return named


def pareto_front(cost: Sequence[float], error: Sequence[float]) -> list[int]:
    """Points that no other point beats in both cost and error, the cheapest first; the first one of equal points."""
    front: list[int] = []
    for i in sorted(range(len(cost)), key=lambda i: (cost[i], error[i], i)):
        if not front or error[i] < error[front[-1]]:
            front.append(i)
    return front


def _legend(figure: Figure, rows: Sequence[Row]) -> None:
    def mark(marker: str, label: str, **style: Any) -> Line2D:
        return Line2D([], [], ls="none", marker=marker, label=label, **style)

    met = {row["model"] for row in rows} | {row["parameter"] for row in rows}
    handles = [mark("o", model, ms=10, color=look[0]) for model, look in MODEL_LOOKS.items() if model in met]
    handles += [mark("", " ")] * (-len(handles) % LEGEND_ROWS)
    hollow = {"ms": 8, "mfc": "none", "mec": "0.3", "mew": 1.4}
    handles += [mark(marker, f"{name} changed", **hollow) for name, marker in MARKS.items() if name and name in met]
    handles.append(Line2D([], [], color="0.55", lw=1.4, label="nothing is cheaper and better"))
    figure.legend(handles=handles, loc="outside lower center", ncols=-(-len(handles) // LEGEND_ROWS), fontsize=10)


def draw_growth(figure: Figure, rows: Rows) -> None:
    """Plot CPU seconds against the number of blocks, with fitted slopes."""
    axes = figure.add_subplot(xscale="log", yscale="log")
    result = growth(rows)
    sizes = sorted({row["blocks"] for own in result.values() for row in own})
    longer: dict[str, int] = {}  # blocks of the largest wall on which a model took too long
    for row in rows["growth"]:
        if row.get("status") == TOO_LONG:
            longer[row["model"]] = max(longer.get(row["model"], 0), all_walls()[row["wall"]].blocks)
    for model, own in result.items():
        (colour, marker), power = MODEL_LOOKS[model], exponent(own)
        columns = ("blocks", "cpu_s_min", "cpu_s", "cpu_s_max")
        blocks, least, middle, most = ([row[column] for row in own] for column in columns)
        name = model if power is None else f"{model}: {power:.2f}"
        name += f"; more than {LONGEST} s beyond {max(blocks)}" if max(blocks) < longer.get(model, 0) else ""
        axes.plot(blocks, middle, marker=marker, color=colour, ms=8, lw=2, label=name)
        axes.vlines(blocks, least, most, color=colour)
    ticks(axes, sizes)
    axes.set(xlabel="blocks of a square panel, b/a = 2", ylabel="processor seconds to the collapse load")
    axes.grid(color="0.9", lw=0.7)
    figure.legend(fontsize=10, loc="outside lower center", ncols=2, title="processor seconds ∝ blocks to the power")
    if REFERENCE in result:
        smallest = result[REFERENCE][0]
        ratio = axes.secondary_yaxis("right", functions=in_units(smallest["cpu_s"]))
        ratio.set_ylabel(f"times the {REFERENCE} program on {smallest['blocks']} blocks", color="0.35")


def draw_stiffness(figure: Figure, rows: Rows) -> None:
    """Plot CPU seconds per physical second against Young's modulus of the blocks."""
    axes = figure.add_subplot(xscale="log", yscale="log")
    (scaled, plain, rigid), (colour, _) = stiffness(rows), MODEL_LOOKS["fem"]
    looks: dict[str, Any] = {"color": colour, "ms": 8, "lw": 2}
    axes.plot([E / 1e9 for E in plain], [*plain.values()], "s--", mfc="white", label="fem, masses as they are", **looks)
    axes.plot([E / 1e9 for E in scaled], [*scaled.values()], "D-", label="fem, masses of stiff modes scaled", **looks)
    if rigid:
        axes.axhline(rigid, color=MODEL_LOOKS["dem-dynamic"][0], lw=2, ls=":", label="dem-dynamic, rigid blocks")
        axes.secondary_yaxis("right", functions=in_units(rigid)).set_ylabel("times rigid blocks", color="0.35")
    axes.set_xlabel("Young's modulus of the blocks [GPa]")
    axes.set_ylabel(f"processor seconds a physical second, {rows['stiffness'][0].get('blocks')} blocks")
    ticks(axes, [E / 1e9 for E in scaled])
    axes.grid(color="0.9", lw=0.7)
    figure.legend(fontsize=10, loc="outside lower center", ncols=3)


SECONDS = "Error against processor seconds; homog, which costs nothing, is left out"
FREEDOMS = "Error against degrees of freedom; models with as many stand side by side"
CHARTS = (
    Chart(SECONDS, partial(draw_errors, _against_seconds, "cpu_s", "processor seconds"), "accuracy-seconds", (11, 9.4)),
    Chart(
        FREEDOMS, partial(draw_errors, _against_freedoms, "dofs", "degrees of freedom"), "accuracy-freedoms", (11, 9.4)
    ),
    Chart("Growth of cost with the number of blocks", draw_growth, "accuracy-growth", (8, 6.4)),
    Chart("What a physical second costs where blocks are ever stiffer", draw_stiffness, "accuracy-stiffness", (8, 5.2)),
)
