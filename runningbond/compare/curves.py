"""Pushover curves of a campaign: the paper's Figures 7 and 11, every model in one picture."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from runningbond.results import Outcome

from .campaign import Campaign
from .figures import COLOURS, SLENDERNESS, TEXTURES, bare, save
from .published import BARALDI, CONCENTRATED, FERRIS, PUBLISHED, PublishedCase

LINES = {"dem-static": "-", "dem-dynamic": ":", "fem": (0, (3, 1, 1, 1))}
"""Models that follow a path, and how their curves are drawn."""


def draw_curves(campaign: Campaign, folder: Path) -> list[Path]:
    """Draw the curves of every group of published walls that a campaign has any of."""
    written = []
    for name, source in (("figure-7", BARALDI), ("figure-11", CONCENTRATED), ("curves-ferris", FERRIS)):
        cases = [case for case in PUBLISHED if case.source == source]
        if any(len(_curve(campaign, case, model)) for case in cases for model in LINES):
            draw = {"figure-7": _figure_7, "figure-11": _figure_11}.get(name, _walls)
            save(draw(campaign, cases), folder / f"{name}.png")
            written.append(folder / f"{name}.png")
    return written


def _figure_7(campaign: Campaign, cases: Sequence[PublishedCase]) -> Figure:
    figure = Figure(figsize=(10, 4.2), layout="constrained")
    for column, (label, _) in enumerate(SLENDERNESS):
        axes = figure.add_subplot(1, 3, column + 1)
        for case, colour in zip(cases[4 * column : 4 * column + 4], COLOURS, strict=True):
            _lines(axes, campaign, case, colour, 1.0)
            homog = campaign.outcomes.get((case.name, "homog"))
            if homog is not None and homog.multiplier is not None:
                axes.axhline(homog.multiplier, color=colour, lw=0.8, ls=(0, (6, 4)))
        axes.set(title=f"H/L = {label}", xlabel="displacement of the upper corner [mm]")
        axes.set(xlim=(-0.3, 12), ylim=(0, 0.66))
        if column == 0:
            axes.set_ylabel("load multiplier λ")
        bare(axes)
    handles = [Line2D([], [], color=c, label=f"b/a = {t}") for (t, _), c in zip(TEXTURES, COLOURS, strict=True)]
    _legend(figure, [*handles, Line2D([], [], color="0.3", lw=0.8, ls=(0, (6, 4)), label="homog")])
    return figure


def _figure_11(campaign: Campaign, cases: Sequence[PublishedCase]) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for case, colour in zip(cases, COLOURS, strict=True):
        _lines(axes, campaign, case, colour, 1e-3)
    axes.set(xlabel="displacement under the load [mm]", ylabel="load [kN]", ylim=(0, None))
    bare(axes)
    handles = [Line2D([], [], color=c, label=f"b/a = {t}") for (t, _), c in zip(TEXTURES, COLOURS, strict=True)]
    _legend(figure, handles)
    return figure


def _walls(campaign: Campaign, cases: Sequence[PublishedCase]) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for case, colour in zip(cases, COLOURS, strict=False):
        _lines(axes, campaign, case, colour, 1.0)
    axes.set(xlabel="displacement of the upper corner [mm]", ylabel="load multiplier λ", ylim=(0, None))
    bare(axes)
    names = (case.name.removeprefix("wall-").upper() for case in cases)
    _legend(figure, [Line2D([], [], color=c, label=n) for n, c in zip(names, COLOURS, strict=False)])
    return figure


def _lines(axes: Axes, campaign: Campaign, case: PublishedCase, colour: str, scale: float) -> None:
    """Curves of one wall, each with a dot at its end."""
    for model, style in LINES.items():
        curve = _curve(campaign, case, model)
        if len(curve):
            axes.plot([1e3 * x for x, _ in curve], [scale * y for _, y in curve], ls=style, color=colour, lw=1.4)
            axes.plot(1e3 * curve[-1][0], scale * curve[-1][1], ".", color=colour, ms=4)


def _curve(campaign: Campaign, case: PublishedCase, model: str) -> list[tuple[float, float]]:
    outcome: Outcome | None = campaign.outcomes.get((case.name, model))
    return [] if outcome is None else [(float(x), float(y)) for x, y in outcome.curve]


def _legend(figure: Figure, handles: list[Line2D]) -> None:
    models = [Line2D([], [], color="0.3", ls=style, label=model) for model, style in LINES.items()]
    figure.legend(handles=[*handles, *models], loc="outside lower center", ncols=4, frameon=False, fontsize=9)
