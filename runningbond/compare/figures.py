"""Charts of a comparison: the paper's Figures 6, 7 and 11, and the multipliers of its Table 2."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from homog import crack_slope, lateral_multiplier
from runningbond.models import Model
from runningbond.pictures.captions import is_force, to_png
from runningbond.pictures.charts import bare, mark
from runningbond.pictures.sheet import csv_lines
from runningbond.pictures.style import CHART_COLOURS, DARK
from runningbond.results import write_atomically
from runningbond.scene import Array

from .published import BARALDI, CONCENTRATED, FERRIS, PublishedCase, cases_of
from .table import Comparison

FRICTION = 0.6
TEXTURES = (("4", 4.0), ("2", 2.0), ("1", 1.0), ("1/4", 0.25))  # label and value of b/a, block width over height
SLENDERNESS = (("0.5", 0.5), ("1", 1.0), ("2", 2.0))
PRINTED = {"FEM/DEM": "P", "DEM": "X", "HOMO": "d"}
TITLES = {
    BARALDI: "Pushover curves of the twelve panels (cf. Baraldi et al., Fig. 7)",
    CONCENTRATED: "Pushover curves under a concentrated load (cf. Baraldi et al., Fig. 11)",
    FERRIS: "Pushover curves of Ferris & Tin-Loi's walls",
}
CURVE_START, SUBDIVISIONS = 0.25, 40  # share of the peak load at which a drawn curve begins; divisions per segment
MULTIPLIERS = (0, 0.66)  # range of the λ axis in charts of the twelve panels
CURVES = {"figure-7": BARALDI, "figure-11": CONCENTRATED, "curves-ferris": FERRIS}
FILES = ("figure-6.csv", *(f"{name}.png" for name in ("figure-6", "table-2", *CURVES)))
"""File names of all charts."""


def figure_6_data() -> tuple[Array, Array]:
    """Slenderness H / L in (0, 3], ``(n,)``, and λ of the homogenised panel for each texture, ``(n, 4)``."""
    slenderness = np.linspace(0, 3, 121)[1:]
    slopes = [crack_slope(ratio, 1.0, FRICTION) for _, ratio in TEXTURES]
    return slenderness, np.array([[lateral_multiplier(float(r), x, FRICTION) for x in slopes] for r in slenderness])


def charts_of(comparison: Comparison) -> dict[str, Figure]:
    """Draw every chart for which a comparison of published walls has data; keys are file names without suffix."""
    charts = {}
    present = [any(comparison.outcome(case.name, x) for x in comparison.models) for case in cases_of(BARALDI)]
    if any(present):
        charts["figure-6"] = _figure_6(comparison, *figure_6_data())
    if all(present):
        charts["table-2"] = table_2(comparison)
    for name, source in CURVES.items():
        models = [x for x in comparison.models if any(len(_curve(comparison, case, x)) for case in cases_of(source))]
        if models:
            charts[name] = _curves(comparison, source, models)
    return charts


def draw_figures(charts: Mapping[str, Figure], folder: Path) -> list[Path]:
    """Write charts, with the data of Figure 6 if it is among them; returns the files written."""
    written = []
    if "figure-6" in charts:
        rows = [["H/L", *(f"lambda b/a = {label}" for label, _ in TEXTURES)]]
        rows += [[f"{r:.6g}", *(f"{x:.8g}" for x in row)] for r, row in zip(*figure_6_data(), strict=True)]
        written.append(folder / "figure-6.csv")
        write_atomically(written[0], csv_lines(rows).encode())
    for name, figure in charts.items():
        written.append(folder / f"{name}.png")
        write_atomically(written[-1], to_png(figure, 160))
    return written


def _figure_6(comparison: Comparison, slenderness: Array, multiplier: Array) -> Figure:
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.add_subplot()
    aside = ("bottom", "center", "top", "center")  # the labels of three curves are close together
    for (label, _), colour, column, side in zip(TEXTURES, CHART_COLOURS[:4], multiplier.T, aside, strict=True):
        axes.plot(slenderness, column, color=colour)
        axes.annotate(f"b/a = {label}", (3.03, column[-1]), va=side, color=DARK, annotation_clip=False)
    for model in (model for model in comparison.models if model.kind == "bound"):
        for i, case in enumerate(cases_of(BARALDI)):
            outcome = comparison.outcome(case.name, model)
            if outcome is not None and outcome.multiplier is not None:
                place, colour = SLENDERNESS[i // 4][1], CHART_COLOURS[i % 4]
                axes.plot(place, outcome.multiplier, model.marker, mfc="none", color=colour)
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
    """Draw the multipliers of Table 2: printed values beside the result of each model."""
    title = "Collapse multipliers of the twelve panels (cf. Baraldi et al., Table 2)"
    figure, columns = panel_figure(title, xlabel="block ratio b/a", ylabel="collapse multiplier λ", xlim=(-0.5, 3.5))
    shifts = np.linspace(-0.41, 0.41, len(PRINTED) + len(comparison.models))
    hollow = False
    for axes, cases in columns:
        for k, case in enumerate(cases):
            if k % 2:
                axes.axvspan(k - 0.5, k + 0.5, color="0.955", lw=0, zorder=0)
            for (label, marker), shift in zip(PRINTED.items(), shifts, strict=False):
                axes.plot(k + shift, case.printed[label], marker, color="0.55", ms=5, ls="none")
            for model, shift in zip(comparison.models, shifts[len(PRINTED) :], strict=True):
                if (outcome := comparison.outcome(case.name, model)) is not None:
                    mark(axes, k + float(shift), outcome, model.colour, model.marker)
                    hollow |= outcome.multiplier is None
        axes.set_xticks(range(4), [label for label, _ in TEXTURES])
        axes.tick_params(axis="x", length=0)
    looks = [(f"printed {label}", "0.55", marker) for label, marker in PRINTED.items()]
    looks += [(model.name, model.colour, model.marker) for model in comparison.models]
    handles = [Line2D([], [], color=c, marker=m, ms=5, mew=1.5, ls="none", label=label) for label, c, m in looks]
    if hollow:
        label = "hollow: no collapse load found, only a bound"
        handles.append(Line2D([], [], color="0.3", marker="o", mfc="white", ms=5, mew=1, ls="none", label=label))
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False, fontsize=9)
    return figure


def _curves(comparison: Comparison, source: str, models: Sequence[Model]) -> Figure:
    """Draw pushover curves of the walls of one source, each with a dot at its end; loads in kN if λ is in newtons.

    The displacement axis is logarithmic, which shows the elastic range as well; curves begin at a share of their peak
    load. For each model that only estimates the multiplier of the twelve panels, a horizontal line is drawn.
    """
    panels, point_load = source == BARALDI, source == CONCENTRATED
    where, load = ("under the load", "load [kN]") if point_load else ("of the upper corner", "load multiplier λ")
    labels = {"xlabel": f"displacement {where} [mm]", "ylabel": load}
    curves = {
        (case.name, model.name): _sampled(_curve(comparison, case, model)) * (1e3, 1e-3 if point_load else 1.0)
        for case in cases_of(source)
        for model in models
    }
    drawn, names = {name for (name, _), curve in curves.items() if len(curve)}, [case.name for case in cases_of(source)]
    title = TITLES[source]
    if panels and len(drawn) < len(names):
        title = title.replace("the twelve panels", f"{len(drawn)} of the twelve panels")
    title = f"{title}\neach begins at a quarter of its peak and ends in a dot"
    starts = [float(curve[0, 0]) for curve in curves.values() if len(curve)]
    shown = min(starts) / 1.2, 1.4 * max(float(curve[-1, 0]) for curve in curves.values() if len(curve))
    estimates = [model for model in comparison.models if panels and model.kind == "estimate"]
    if panels:
        here = [k for k in range(len(SLENDERNESS)) if drawn & set(names[4 * k : 4 * k + 4])]
        figure, columns = panel_figure(title, here, xlim=shown, **labels)
    else:
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        figure.suptitle(title, fontsize=11)
        columns = [(figure.add_subplot(**labels), cases_of(source))]
    for axes, cases in columns:
        for case, colour in zip(cases, CHART_COLOURS, strict=False):
            for model in models:
                moved, multiplier = curves[case.name, model.name].T
                axes.plot(moved, multiplier, ls=model.line, color=colour, lw=1.4)
                axes.plot(moved[-1:], multiplier[-1:], ".", color=colour, ms=4)
            for model in estimates:
                outcome = comparison.outcome(case.name, model)
                if outcome is not None and outcome.multiplier is not None:
                    axes.axhline(outcome.multiplier, color=colour, lw=0.8, ls=model.line)
        axes.set_xscale("log")
        if not panels:
            axes.set(xlim=shown, ylim=(0, None))
            bare(axes)
        _label_decades(axes)
    walls = [f"b/a = {label}" for label, _ in TEXTURES]
    if source == FERRIS:
        walls = [case.name.removeprefix("wall-").upper() for case in cases_of(source)]
    handles = [
        Line2D([], [], color=colour, label=wall)
        for k, (wall, colour) in enumerate(zip(walls, CHART_COLOURS, strict=False))
        if drawn & set(names[k :: len(walls)])
    ]
    widths = [(model, 0.8 if model.kind == "estimate" else 1.4) for model in (*estimates, *models)]
    handles += [Line2D([], [], color="0.3", ls=model.line, lw=width, label=model.name) for model, width in widths]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return figure


def wall_curves(comparison: Comparison, name: str) -> Figure | None:
    """Draw the pushover curves of one wall by all models that follow a loading path; None if there is no curve."""
    found = {x: outcome.curve for x in comparison.models if (outcome := comparison.outcome(name, x)) is not None}
    curves = {model: _sampled(curve) for model, curve in found.items() if len(curve) > 1}
    if not any(map(len, curves.values())):
        return None
    figure, force = Figure(figsize=(6.4, 2.9), layout="constrained"), is_force(comparison.scenes[name])
    axes = figure.add_subplot(xscale="log", xlabel="displacement of the control point [mm]")
    for model, curve in curves.items():
        axes.plot(1e3 * curve[:, 0], curve[:, 1], ls=model.line, color=model.colour, lw=1.4, label=model.name)
        axes.plot(1e3 * curve[-1:, 0], curve[-1:, 1], model.marker, color=model.colour, ms=4)
    _label_decades(axes)
    axes.set(ylim=(0, None), ylabel="load [N]" if force else "load multiplier λ")
    axes.legend(frameon=False, fontsize=8)
    bare(axes)
    return figure


def _label_decades(axes: Axes) -> None:
    """Label the decades of a logarithmic x-axis; if it has one of them or none, also their doubles and halves."""
    low, high = np.log10(axes.get_xlim())
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0,) if np.floor(high) > np.ceil(low) else (1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())


def _curve(comparison: Comparison, case: PublishedCase, model: Model) -> Array:
    """Pushover curve of a wall by a model, ``(n, 2)``; empty if there is none."""
    outcome = comparison.outcome(case.name, model)
    return np.zeros((0, 2)) if outcome is None else outcome.curve


def _sampled(curve: Array) -> Array:
    """Subdivide the segments of a curve; cut off its start, below `CURVE_START` of its peak or without displacement."""
    if len(curve) < 2:
        return curve[:0]
    at = np.arange(len(curve))
    fine = np.linspace(0, len(curve) - 1, SUBDIVISIONS * (len(curve) - 1) + 1)
    dense = np.column_stack([np.interp(fine, at, column) for column in curve.T])
    borne = (dense[:, 1] >= CURVE_START * dense[:, 1].max()) & (dense[:, 0] > 0)
    return dense[int(borne.argmax()) :][dense[int(borne.argmax()) :, 0] > 0]


def panel_figure(
    title: str, shown: Sequence[int] = (0, 1, 2), *, xlabel: str, ylabel: str, xlim: tuple[float, float]
) -> tuple[Figure, list[tuple[Axes, tuple[PublishedCase, ...]]]]:
    """Make a figure for the twelve panels: axes for each slenderness shown, each with its four panels."""
    width = (6.4, 8.5, 11.0)[len(shown) - 1]
    figure, panels = Figure(figsize=(width, 4.5), layout="constrained"), cases_of(BARALDI)
    figure.suptitle(title, fontsize=11)
    columns = []
    for column, k in enumerate(shown):
        axes, named = figure.add_subplot(1, len(shown), column + 1), "" if column else ylabel
        axes.set(title=f"H/L = {SLENDERNESS[k][0]}", xlabel=xlabel, ylabel=named, xlim=xlim, ylim=MULTIPLIERS)
        bare(axes)
        columns.append((axes, panels[4 * k : 4 * k + 4]))
    return figure, columns
