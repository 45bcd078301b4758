"""Pushover curves of a comparison: the paper's Figures 7 and 11, every model in one picture."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .figures import COLOURS, TEXTURES, bare, legend_below, panel_figure, save
from .model import Model
from .published import BARALDI, CONCENTRATED, FERRIS, PublishedCase, cases_of
from .table import Comparison


def draw_curves(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw the curves of every group of published walls that a comparison has any of."""
    written = []
    for name, source in (("figure-7", BARALDI), ("figure-11", CONCENTRATED), ("curves-ferris", FERRIS)):
        cases = cases_of(source)
        models = [model for model in comparison.models if any(_has_curve(comparison, case, model) for case in cases)]
        if models:
            draw = _panels if source == BARALDI else _walls
            save(draw(comparison, cases, models), folder / f"{name}.png")
            written.append(folder / f"{name}.png")
    return written


def _panels(comparison: Comparison, cases: Sequence[PublishedCase], models: Sequence[Model]) -> Figure:
    """Curves of the twelve panels, and a level line for each model that only estimates their multiplier."""
    xlabel, ylabel = "displacement of the upper corner [mm]", "load multiplier λ"
    figure, columns = panel_figure(xlabel=xlabel, ylabel=ylabel, xlim=(-0.3, 12))
    estimates = [model for model in comparison.models if model.kind == "estimate"]
    for axes, panels in columns:
        for case, colour in zip(panels, COLOURS, strict=True):
            _draw(axes, comparison, case, models, colour)
            for model in estimates:
                outcome = comparison.outcome(case.name, model)
                if outcome is not None and outcome.multiplier is not None:
                    axes.axhline(outcome.multiplier, color=colour, lw=0.8, ls=model.line)
    _legend(figure, [f"b/a = {label}" for label, _ in TEXTURES], [*estimates, *models])
    return figure


def _walls(comparison: Comparison, cases: Sequence[PublishedCase], models: Sequence[Model]) -> Figure:
    """Curves of the walls of one source in one chart, of loads in kN where λ is a load in newtons."""
    point_load = cases[0].source == CONCENTRATED
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for case, colour in zip(cases, COLOURS, strict=False):
        _draw(axes, comparison, case, models, colour, 1e-3 if point_load else 1.0)
    where, load = ("under the load", "load [kN]") if point_load else ("of the upper corner", "load multiplier λ")
    axes.set(xlabel=f"displacement {where} [mm]", ylabel=load, ylim=(0, None))
    bare(axes)
    names = [case.name.removeprefix("wall-").upper() for case in cases]
    _legend(figure, [f"b/a = {label}" for label, _ in TEXTURES] if point_load else names, models)
    return figure


def _draw(
    axes: Axes,
    comparison: Comparison,
    case: PublishedCase,
    models: Sequence[Model],
    colour: str,
    scale: float = 1.0,
) -> None:
    """Curves of one wall, each with a dot at its end."""
    for model in models:
        if _has_curve(comparison, case, model):
            displacement, load = (comparison.campaign.outcomes[case.name, model.name].curve * (1e3, scale)).T
            axes.plot(displacement, load, ls=model.line, color=colour, lw=1.4)
            axes.plot(displacement[-1], load[-1], ".", color=colour, ms=4)


def _has_curve(comparison: Comparison, case: PublishedCase, model: Model) -> bool:
    outcome = comparison.outcome(case.name, model)
    return outcome is not None and len(outcome.curve) > 0


def _legend(figure: Figure, walls: Sequence[str], models: Sequence[Model]) -> None:
    """What colours stand for, walls, and what lines stand for, models."""
    colours = [Line2D([], [], color=colour, label=wall) for wall, colour in zip(walls, COLOURS, strict=False)]
    lines = [
        Line2D([], [], color="0.3", ls=model.line, lw=0.8 if model.kind == "estimate" else 1.4, label=model.name)
        for model in models
    ]
    legend_below(figure, [*colours, *lines])
