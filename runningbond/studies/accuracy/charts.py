"""Charts of the study: error against cost, growth with the number of blocks, and the price of stiff blocks."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from runningbond.compare.figures import OURS, bare, save
from runningbond.scene import Array

from .findings import CHANGED, exponent, growth, stiffness
from .fits import pareto_front
from .measure import REFERENCE
from .parameters import VARIED
from .rows import Row

FLOOR, MOST = 1e-4, 3.0
"""Error below which all are drawn alike, zero or below the digits that are published, and the end of the axis."""

RIGID, ASIDE = ("limit", "limit-nonassociated", "dem-static", "dem-dynamic"), 1.1
"""Models with three freedoms a block, and the ratio by which they stand apart."""

LEGEND_ROWS = 3

FREE = "homog"
"""Model that is not drawn: a closed form costs nothing."""

DRIVEN = "driven, steps"

MARKS = {
    "": "o",
    "joint rule": "s",
    "cells": "^",
    "modes": "D",
    "mass scaling": "X",
    "tolerance": "P",
    "first step": "v",
    DRIVEN: "*",
}
"""Marks of the knobs; a model as it is has the first one, filled."""

TITLES = {
    "stack-of-5": "stack of five blocks, exact",
    "wall-w1-inset": "wall W1, published to four digits",
    "wall-w3-inset": "wall W3 with its opening, published",
    "panel-02": "panel 2, interval of certified loads",
}


def draw_charts(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Draw every chart that the table has something for."""
    found = []
    for name, draw in CHARTS.items():
        figure = draw(rows)
        if figure is not None:
            save(figure, folder / f"{name}.png")
            found.append(folder / f"{name}.png")
    return found


def error_against_seconds(rows: Sequence[Row]) -> Figure | None:
    """Error against processor seconds, on the second axis in those of the limit program on the same wall."""
    return _errors(rows, "processor seconds", _seconds, _draw_seconds)


def error_against_freedoms(rows: Sequence[Row]) -> Figure | None:
    """Error against degrees of freedom; models with the same number of them stand side by side."""
    return _errors(rows, "degrees of freedom", _freedoms, _draw_freedoms)


def _seconds(row: Row) -> float:
    return row.cpu_s or 0.0


def _freedoms(row: Row) -> float:
    return float(row.dofs or 0)


def _errors(
    rows: Sequence[Row], what: str, cost: Callable[[Row], float], draw: Callable[[Axes, Sequence[Row]], None]
) -> Figure | None:
    judged = [row for row in rows if row.part == "accuracy" and row.error is not None and row.model != FREE]
    judged = [row for row in judged if cost(row) > 0]
    walls = [wall for wall in VARIED if any(row.wall == wall for row in judged)]
    if not walls:
        return None
    figure = Figure(figsize=(11, 9), layout="constrained")
    axes = np.ravel(figure.subplots(2, 2, sharey=True))
    for one in axes[len(walls) :]:
        one.set_visible(False)
    for one, wall in zip(axes, walls, strict=False):
        draw(one, [row for row in judged if row.wall == wall])
        one.set_title(TITLES.get(wall, wall), fontsize=11, loc="left", fontweight="bold")
        one.set_xlabel(what)
        one.set_ylabel("relative error of λ" if one.get_subplotspec().is_first_col() else "")
    _legend(figure, judged)
    return figure


def _draw_seconds(axes: Axes, rows: Sequence[Row]) -> None:
    seconds = [_seconds(row) for row in rows]
    _draw_errors(axes, rows, seconds, seconds)
    unit = next((row.cpu_s for row in rows if row.model == REFERENCE), None)
    if unit is not None:
        ratio = axes.secondary_xaxis("top", functions=_in_units(unit))
        ratio.set_xlabel(f"times the {REFERENCE} program on the same wall", fontsize=9, color="0.35")
        ratio.tick_params(colors="0.35")


def _draw_freedoms(axes: Axes, rows: Sequence[Row]) -> None:
    freedoms = [_freedoms(row) for row in rows]
    place = {model: i - (len(RIGID) - 1) / 2 for i, model in enumerate(RIGID)}
    aside = [x * ASIDE ** place.get(row.model, 0.0) for x, row in zip(freedoms, rows, strict=True)]
    _draw_errors(axes, rows, freedoms, aside)
    ticks: list[int] = []
    for number in sorted({row.dofs or 0 for row in rows}):
        if not ticks or number > 1.35 * ticks[-1]:
            ticks.append(number)
    axes.set_xticks(ticks, [f"{number:,}" for number in ticks])
    axes.minorticks_off()


def _draw_errors(axes: Axes, rows: Sequence[Row], cost: Sequence[float], x: Sequence[float]) -> None:
    """Draw errors at `x`, next to their `cost`, and the front of those that nothing beats."""
    y = [max(row.error or 0.0, FLOOR) for row in rows]
    axes.set(xscale="log", yscale="log", ylim=(FLOOR / 1.8, MOST))
    axes.axhspan(FLOOR / 1.8, FLOOR * 1.25, color="0.93", zorder=0)
    front = pareto_front(cost, y)
    right = 3 * max(x)
    axes.step(
        [x[front[0]], *(x[i] for i in front), right],
        [MOST, *(y[i] for i in front), y[front[-1]]],
        where="post",
        color="0.55",
        lw=1.4,
        zorder=1,
    )
    for i in sorted(range(len(rows)), key=lambda i: rows[i].knob == ""):
        plain = rows[i].knob == ""
        colour = OURS[rows[i].model][0]
        axes.plot(
            x[i],
            y[i],
            MARKS[rows[i].knob],
            color=colour if plain else "none",
            mec="white" if plain else colour,
            ms=11 if plain else 9 if rows[i].knob == DRIVEN else 7,
            mew=0.8 if plain else 1.5,
            zorder=3 if plain else 2,
        )
    axes.set_xlim(min(x) / 2, right)
    axes.grid(which="major", color="0.9", lw=0.7)
    axes.text(
        0.99,
        FLOOR / 1.35,
        "0.01 % or less",
        transform=axes.get_yaxis_transform(),
        ha="right",
        va="center",
        fontsize=8,
        color="0.35",
    )
    _name_settings(axes, rows, x, y)
    bare(axes)


def _name_settings(axes: Axes, rows: Sequence[Row], x: Sequence[float], y: Sequence[float]) -> None:
    """Write beside its mark to what a knob was turned, where that changes the error of the model."""
    plain = {row.model: error for row, error in zip(rows, y, strict=True) if not row.knob}
    for row, cost, error in zip(rows, x, y, strict=True):
        if row.knob and not 1 / CHANGED < error / plain.get(row.model, error) < CHANGED:
            # Above the mark where those of others stand beside it.
            above = row.knob == DRIVEN and row.model != "fem"
            axes.annotate(
                row.setting,
                (cost, error),
                xytext=(-3, 7) if above else (7, 0),
                textcoords="offset points",
                ha="left",
                va="bottom" if above else "center",
                fontsize=8,
                color=OURS[row.model][0],
            )


def _in_units(unit: float) -> tuple[Callable[[ArrayLike], Array], Callable[[ArrayLike], Array]]:
    """From seconds to ratios to a unit, and back."""
    return lambda seconds: np.asarray(seconds, float) / unit, lambda ratio: np.asarray(ratio, float) * unit


def _legend(figure: Figure, rows: Sequence[Row]) -> None:
    models = [model for model in OURS if any(row.model == model for row in rows)]
    knobs = [knob for knob in MARKS if any(row.knob == knob for row in rows)]
    handles = [Line2D([], [], ls="none", marker="o", ms=10, color=OURS[model][0], label=model) for model in models]
    handles += [Line2D([], [], ls="none", label=" ")] * (-len(handles) % LEGEND_ROWS)
    handles += [
        Line2D([], [], ls="none", marker=MARKS[knob], ms=8, mfc="none", mec="0.3", mew=1.4, label=f"{knob} changed")
        for knob in knobs
        if knob
    ]
    handles.append(Line2D([], [], color="0.55", lw=1.4, label="nothing is cheaper and better"))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=-(-len(handles) // LEGEND_ROWS), frameon=False, fontsize=10
    )


def growth_chart(rows: Sequence[Row]) -> Figure | None:
    """Processor seconds against the number of blocks, with fitted slopes."""
    found = growth(rows)
    if not found:
        return None
    figure = Figure(figsize=(8, 6.2), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log")
    for model, own in found.items():
        colour, marker = OURS[model]
        x, y = [row.blocks for row in own], [row.cpu_s or 0.0 for row in own]
        power = exponent(own)
        label = model if power is None else f"{model}: blocks to the power {power:.2f}"
        axes.plot(x, y, marker=marker, color=colour, ms=8, lw=2, label=label)
        axes.vlines(x, [row.cpu_s_min or 0.0 for row in own], [row.cpu_s_max or 0.0 for row in own], color=colour)
    sizes = sorted({row.blocks for own in found.values() for row in own})
    axes.set_xticks(sizes, [str(size) for size in sizes])
    axes.minorticks_off()
    axes.set(xlabel="blocks of a square panel, b/a = 2", ylabel="processor seconds to the collapse load")
    axes.grid(color="0.9", lw=0.7)
    figure.legend(frameon=False, fontsize=10, loc="outside lower center", ncols=2)
    bare(axes)
    smallest = next((row.cpu_s for row in found.get(REFERENCE, ()) if row.blocks == sizes[0]), None)
    if smallest:
        ratio = axes.secondary_yaxis("right", functions=_in_units(smallest))
        ratio.set_ylabel(f"times the {REFERENCE} program on {sizes[0]} blocks", color="0.35")
        ratio.tick_params(colors="0.35")
    return figure


def stiffness_chart(rows: Sequence[Row]) -> Figure | None:
    """Processor seconds a physical second against Young's modulus of the blocks."""
    found = stiffness(rows)
    if not found.scaled:
        return None
    figure = Figure(figsize=(8, 5), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log")
    colour = OURS["fem"][0]
    for own, style, label in (
        (found.unscaled, "s--", "fem, masses as they are"),
        (found.scaled, "D-", "fem, masses of stiff modes scaled"),
    ):
        x = sorted(own)
        axes.plot(
            [young / 1e9 for young in x],
            [own[young].value or 0.0 for young in x],
            style,
            color=colour,
            mfc="white" if style == "s--" else colour,
            ms=8,
            lw=2,
            label=label,
        )
    if found.rigid and found.rigid.value:
        axes.axhline(found.rigid.value, color=OURS["dem-dynamic"][0], lw=2, ls=":", label="dem-dynamic, rigid blocks")
        unit = found.rigid.value
        ratio = axes.secondary_yaxis("right", functions=_in_units(unit))
        ratio.set_ylabel("times rigid blocks", color="0.35")
        ratio.tick_params(colors="0.35")
    blocks = next(iter(found.scaled.values())).blocks
    axes.set(
        xlabel="Young's modulus of the blocks [GPa]", ylabel=f"processor seconds a physical second, {blocks} blocks"
    )
    axes.set_xticks([young / 1e9 for young in sorted(found.scaled)], [f"{y / 1e9:g}" for y in sorted(found.scaled)])
    axes.minorticks_off()
    axes.grid(color="0.9", lw=0.7)
    axes.legend(frameon=False, fontsize=10, loc="upper left")
    bare(axes)
    return figure


CHARTS: dict[str, Callable[[Sequence[Row]], Figure | None]] = {
    "accuracy-seconds": error_against_seconds,
    "accuracy-freedoms": error_against_freedoms,
    "accuracy-growth": growth_chart,
    "accuracy-stiffness": stiffness_chart,
}
"""Charts by the names of their files."""
