"""Charts of a comparison: the paper's Figure 6, and the multipliers of its Table 2."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from homog import crack_slope, lateral_multiplier
from runningbond.results import Outcome, write_atomically
from runningbond.scene import Array

from .model import Model
from .published import BARALDI, PublishedCase, cases_of
from .table import Comparison

FRICTION = 0.6
TEXTURES = (("4", 4.0), ("2", 2.0), ("1", 1.0), ("1/4", 0.25))
"""Block width to height b/a of the paper's four textures, and what to call it."""
SLENDERNESS = (("0.5", 0.5), ("1", 1.0), ("2", 2.0))
COLOURS = ("#0b559f", "#2a9d8f", "#e9a23b", "#c2410c")
PRINTED = {"FEM/DEM": "P", "DEM": "X", "HOMO": "d"}

MULTIPLIERS = (0, 0.66)
"""Range of the axis of λ of the twelve panels."""


def figure_6_data(points: int = 120) -> tuple[Array, Array]:
    """Multiplier of the homogenised panel against its slenderness.

    Returns
    -------
    slenderness : (points,) float
        H / L from 0 to 3, without 0.
    multiplier : (points, 4) float
        λ of each of `TEXTURES`.
    """
    slenderness = np.linspace(0, 3, points + 1)[1:]
    columns = []
    for _, ratio in TEXTURES:
        slope = crack_slope(ratio, 1.0, FRICTION)
        columns.append([lateral_multiplier(float(r), slope, FRICTION) for r in slenderness])
    return slenderness, np.array(columns).T


def draw_figures(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw every chart that a comparison of published walls has something for, and write the data of Figure 6."""
    panels = cases_of(BARALDI)
    present = [any((case.name, name) in comparison.campaign.outcomes for name in comparison.names) for case in panels]
    if not any(present):
        return []
    slenderness, multiplier = figure_6_data()
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(["H/L", *(f"lambda b/a = {label}" for label, _ in TEXTURES)])
    writer.writerows([f"{r:.6g}", *(f"{x:.8g}" for x in row)] for r, row in zip(slenderness, multiplier, strict=True))
    write_atomically(folder / "figure-6.csv", table.getvalue().encode())
    charts = {"figure-6.png": _figure_6(comparison, slenderness, multiplier)}
    if all(present):
        charts["table-2.png"] = table_2(comparison)
    for name, figure in charts.items():
        save(figure, folder / name)
    return [folder / name for name in ("figure-6.csv", *charts)]


def _figure_6(comparison: Comparison, slenderness: Array, multiplier: Array) -> Figure:
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.add_subplot()
    for (label, _), colour, column in zip(TEXTURES, COLOURS, multiplier.T, strict=True):
        axes.plot(slenderness, column, color=colour)
        axes.annotate(f"b/a = {label}", (3.03, column[-1]), va="center", color=colour, annotation_clip=False)
    for model in (model for model in comparison.models if model.kind == "bound"):
        for i, case in enumerate(cases_of(BARALDI)):
            outcome = comparison.outcome(case.name, model)
            if outcome is not None and outcome.multiplier is not None:
                place = SLENDERNESS[i // 4][1], outcome.multiplier
                axes.plot(*place, model.marker, mfc="none", color=COLOURS[i % 4])
        axes.plot([], [], model.marker, mfc="none", color="0.3", label=model.title)
    axes.axhline(FRICTION, color="0.6", lw=0.8, ls="--")
    axes.annotate("sliding, tan φ", (2.98, FRICTION), ha="right", va="bottom", color="0.4", fontsize=9)
    axes.set(xlabel="slenderness H / L", ylabel="collapse multiplier λ", xlim=(0, 3), ylim=MULTIPLIERS)
    axes.set_title("Homogenised collapse multiplier, tan φ = 0.6 (cf. Baraldi et al., Fig. 6)", fontsize=10)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=9, loc="upper right", bbox_to_anchor=(1, 0.88))
    bare(axes)
    return figure


def table_2(comparison: Comparison) -> Figure:
    """Chart of the multipliers of Table 2: what is printed beside what each model found."""
    figure, columns = panel_figure(xlabel="block ratio b/a", ylabel="collapse multiplier λ", xlim=(-0.5, 3.7))
    hollow = False
    for axes, cases in columns:
        for k, case in enumerate(cases):
            hollow |= _panel_marks(axes, k, case, comparison)
        axes.set_xticks(range(4), [label for label, _ in TEXTURES])
    looks = [(f"printed {label}", "0.62", marker) for label, marker in PRINTED.items()]
    looks += [(model.name, model.colour, model.marker) for model in comparison.models]
    handles = [Line2D([], [], color=c, marker=m, ms=5, mew=1.5, ls="none", label=label) for label, c, m in looks]
    if hollow:
        label = "hollow: a bound only, or none (at 0)"
        handles.append(Line2D([], [], color="0.3", marker="o", mfc="white", ms=5, mew=1, ls="none", label=label))
    legend_below(figure, handles, columns=5)
    return figure


def _panel_marks(axes: Axes, k: int, case: PublishedCase, comparison: Comparison) -> bool:
    """Draw what is printed and what each model found of one panel; whether any of it is hollow."""
    for (label, marker), shift in zip(PRINTED.items(), (-0.3, -0.2, -0.1), strict=True):
        axes.plot(k + shift, case.printed[label], marker, color="0.62", ms=5, ls="none")
    shifts = np.linspace(0.0, min(0.1 * (len(comparison.models) - 1), 0.5), len(comparison.models))
    hollow = False
    for model, shift in zip(comparison.models, shifts, strict=True):
        outcome = comparison.outcome(case.name, model)
        if outcome is not None:
            _mark(axes, k + float(shift), model, outcome)
            hollow |= outcome.multiplier is None
    return hollow


def _mark(axes: Axes, x: float, model: Model, outcome: Outcome) -> None:
    """A bar for the bracket and a mark on it; a hollow one, on a thin bar, where no collapse load was found."""
    known = [value for value in (outcome.lower, outcome.multiplier, outcome.upper) if value is not None] or [0.0]
    found = outcome.multiplier is not None
    axes.plot([x, x], [known[0], known[-1]], color=model.colour, lw=2.5 if found else 0.8, solid_capstyle="butt")
    place = known[-1] if outcome.multiplier is None else outcome.multiplier
    face = model.colour if found else "white"
    edge = 1.5 if found else 1.0
    axes.plot(x, place, model.marker, color=model.colour, mfc=face, ms=5, mew=edge, ls="none", clip_on=False)


def panel_figure(
    *, xlabel: str, ylabel: str, xlim: tuple[float, float]
) -> tuple[Figure, list[tuple[Axes, tuple[PublishedCase, ...]]]]:
    """A figure of the twelve panels: axes for each slenderness, and the four panels that stand there."""
    figure, panels = Figure(figsize=(10, 4.2), layout="constrained"), cases_of(BARALDI)
    columns = []
    for column, (label, _) in enumerate(SLENDERNESS):
        axes = figure.add_subplot(1, 3, column + 1)
        axes.set(title=f"H/L = {label}", xlabel=xlabel, xlim=xlim, ylim=MULTIPLIERS)
        axes.set_ylabel(ylabel if column == 0 else "")
        bare(axes)
        columns.append((axes, panels[4 * column : 4 * column + 4]))
    return figure, columns


def legend_below(figure: Figure, handles: Sequence[Artist], columns: int = 4) -> None:
    """A legend under all axes."""
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, frameon=False, fontsize=9)


def bare(axes: Axes) -> None:
    """Take away the frame where nothing is read off it."""
    axes.spines[["top", "right"]].set_visible(False)


def save(figure: Figure, path: Path) -> None:
    """Write a figure, whole or not at all."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=160)
    write_atomically(path, buffer.getvalue())
