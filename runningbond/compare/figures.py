"""Charts of a campaign: the paper's Figure 6, and the multipliers of its Table 2."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from homog import crack_slope, lateral_multiplier
from runningbond.results import write_atomically
from runningbond.scene import Array

from .campaign import Campaign
from .published import BARALDI, PUBLISHED, PublishedCase

FRICTION = 0.6
TEXTURES = (("4", 4.0), ("2", 2.0), ("1", 1.0), ("1/4", 0.25))
"""Block width to height b/a of the paper's four textures, and what to call it."""
SLENDERNESS = (("0.5", 0.5), ("1", 1.0), ("2", 2.0))
COLOURS = ("#0b559f", "#2a9d8f", "#e9a23b", "#c2410c")
PRINTED = {"FEM/DEM": "P", "DEM": "X", "HOMO": "d"}
OURS = {
    "homog": ("black", "_"),
    "limit": ("#0b559f", "o"),
    "limit-nonassociated": ("#c2410c", "s"),
    "dem-static": ("#7c3aed", "v"),
    "dem-dynamic": ("#2a9d8f", "^"),
    "fem": ("#be185d", "D"),
}


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


def draw_figures(campaign: Campaign, folder: Path) -> list[Path]:
    """Draw every chart that a campaign of published walls has something for, and write the data of Figure 6."""
    panels = [case for case in PUBLISHED if case.source == BARALDI]
    if not any(cell[0] == case.name for case in panels for cell in campaign.outcomes):
        return []
    slenderness, multiplier = figure_6_data()
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(["H/L", *(f"lambda b/a = {label}" for label, _ in TEXTURES)])
    writer.writerows([f"{r:.6g}", *(f"{x:.8g}" for x in row)] for r, row in zip(slenderness, multiplier, strict=True))
    write_atomically(folder / "figure-6.csv", table.getvalue().encode())
    save(_figure_6(campaign, slenderness, multiplier), folder / "figure-6.png")
    written = [folder / "figure-6.csv", folder / "figure-6.png"]
    if all(any(cell[0] == case.name for cell in campaign.outcomes) for case in panels):
        save(_table_2(campaign, panels), folder / "table-2.png")
        written.append(folder / "table-2.png")
    return written


def _figure_6(campaign: Campaign, slenderness: Array, multiplier: Array) -> Figure:
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.add_subplot()
    for (label, _), colour, column in zip(TEXTURES, COLOURS, multiplier.T, strict=True):
        axes.plot(slenderness, column, color=colour)
        axes.annotate(f"b/a = {label}", (3.03, column[-1]), va="center", color=colour, annotation_clip=False)
    panels = [case for case in PUBLISHED if case.source == BARALDI]
    for i, case in enumerate(panels):
        outcome = campaign.outcomes.get((case.name, "limit"))
        if outcome is not None and outcome.multiplier is not None:
            axes.plot(SLENDERNESS[i // 4][1], outcome.multiplier, "o", mfc="none", color=COLOURS[i % 4])
    axes.plot([], [], "o", mfc="none", color="0.3", label="limit analysis of the blocks")
    axes.axhline(FRICTION, color="0.6", lw=0.8, ls="--")
    axes.annotate("sliding, tan φ", (2.98, FRICTION), ha="right", va="bottom", color="0.4", fontsize=9)
    axes.set(xlabel="slenderness H / L", ylabel="collapse multiplier λ", xlim=(0, 3), ylim=(0, 0.66))
    axes.set_title("Homogenised collapse multiplier, tan φ = 0.6 (cf. Baraldi et al., Fig. 6)", fontsize=10)
    axes.legend(frameon=False, fontsize=9, loc="upper right", bbox_to_anchor=(1, 0.88))
    bare(axes)
    return figure


def _table_2(campaign: Campaign, panels: Sequence[PublishedCase]) -> Figure:
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    for column, (name, _) in enumerate(SLENDERNESS):
        axes = figure.add_subplot(1, 3, column + 1)
        for k, case in enumerate(panels[4 * column : 4 * column + 4]):
            _panel_marks(axes, k, case, campaign)
        axes.set_xticks(range(4), [label for label, _ in TEXTURES])
        axes.set(title=f"H/L = {name}", xlabel="block ratio b/a", ylim=(0, 0.66), xlim=(-0.5, 3.7))
        if column == 0:
            axes.set_ylabel("collapse multiplier λ")
        bare(axes)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(list(unique.values()), list(unique), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return figure


def _panel_marks(axes: Axes, k: int, case: PublishedCase, campaign: Campaign) -> None:
    for (label, marker), shift in zip(PRINTED.items(), (-0.3, -0.2, -0.1), strict=True):
        axes.plot(k + shift, case.printed[label], marker, color="0.62", ms=5, ls="none", label=f"printed {label}")
    for (model, (colour, marker)), shift in zip(OURS.items(), (0.0, 0.1, 0.2, 0.3, 0.4, 0.5), strict=True):
        outcome = campaign.outcomes.get((case.name, model))
        if outcome is None or outcome.multiplier is None:
            continue
        lower = outcome.multiplier if outcome.lower is None else outcome.lower
        upper = outcome.multiplier if outcome.upper is None else outcome.upper
        axes.plot([k + shift] * 2, [lower, upper], color=colour, lw=2.5, solid_capstyle="butt")
        axes.plot(k + shift, outcome.multiplier, marker, color=colour, ms=5, mew=1.5, ls="none", label=model)


def bare(axes: Axes) -> None:
    """Take away the frame where nothing is read off it."""
    axes.spines[["top", "right"]].set_visible(False)


def save(figure: Figure, path: Path) -> None:
    """Write a figure, whole or not at all."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=160)
    write_atomically(path, buffer.getvalue())
