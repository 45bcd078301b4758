"""Figures of the laboratory: one card per wall, and the chart of error against experiment over cost."""

from collections.abc import Sequence
from math import inf
from statistics import median
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from runningbond.pictures.charts import bare
from runningbond.pictures.flat import draw_mechanism
from runningbond.pictures.mechanism import mechanism_shape
from runningbond.scene import Array

from .ladder import LADDER
from .measured import growing
from .predictions import Prediction
from .scores import cycle_ends, cycle_peaks
from .summary import errors_by_hand, kind_of

PUSHED_LEFT = ("SW.200.1",)
"""Shipped walls whose cracks were drawn as pushed to the left, although their records are positive."""

MEASURED = "0.15"
LEAST_ERROR, LEAST_SECONDS = 0.004, 5e-3
"""Lower ends of the chart's axes, at which smaller values are drawn: error, and CPU time [s]."""


DRAWN_BELOW = 1.6
"""Ratio to the measured strength above which a predicted load without a curve is not drawn, only listed in the
table."""


def card(predictions: Sequence[Prediction]) -> Figure:
    """Card of one wall: curves, and beside the cracks drawn after the test the mechanism of the model nearest to it."""
    wall = predictions[0].wall
    drawn = drawn_by(predictions)
    panels = 1 + (drawn is not None) + (wall.cracks is not None)
    figure = Figure(figsize=(5.6 + 3.6 * (panels - 1), 4.3), layout="constrained")
    axes = list(figure.subplots(1, panels, width_ratios=[1.6] + [1.0] * (panels - 1), squeeze=False)[0])
    _curves(axes.pop(0), predictions)
    if drawn is not None and drawn.outcome is not None:
        draw_mechanism(axes.pop(0), drawn.scene, drawn.outcome, _scored(drawn))
    if wall.cracks is not None:
        mirrored = _goes_the_other_way(predictions[0])
        # Pictures without colours are shown in grey, not in the colours of a chart.
        axes[0].imshow(imread(wall.cracks, format="png")[:, :: -1 if mirrored else 1], cmap="gray", vmin=0, vmax=1)
        axes[0].set_title("cracks, as drawn after the test" + (", mirrored" if mirrored else ""), fontsize=9)
        axes[0].axis("off")
    figure.draw_without_rendering()  # first layout: the one of the drawing depends on the height of the wall's axes
    return figure


def _scored(prediction: Prediction) -> str:
    """Strength and status of a prediction as in the table of scores; those of its outcome may be others."""
    strength = "" if prediction.strength is None else f"P = {prediction.strength / 1e3:.1f} kN, "
    return f"{prediction.rung.name}: {strength}{prediction.status}"


def _goes_the_other_way(prediction: Prediction) -> bool:
    """Whether a wall was pushed to the left, as its drawn cracks show, and is predicted to the right."""
    wall, drive = prediction.wall, prediction.scene.drive
    goes_right = drive is None or drive.force[0] > 0
    return goes_right and (wall.is_turned or wall.name in PUSHED_LEFT)


def drawn_by(predictions: Sequence[Prediction]) -> Prediction | None:
    """The prediction whose mechanism is drawn for a wall: the nearest of those that have one; None if there is none."""
    return next((each for each in sorted(predictions, key=_distance) if _can_be_drawn(each)), None)


def _can_be_drawn(prediction: Prediction) -> bool:
    """Whether a prediction has a mechanism, and its loads drive it; others are drawn as the undeformed wall."""
    outcome = prediction.outcome
    if outcome is None or not prediction.mode or prediction.rung.is_by_hand:
        return False
    return mechanism_shape(prediction.scene, outcome) is not None


def _distance(prediction: Prediction) -> tuple[bool, float]:
    """Sort key: error of a prediction against the test; predictions not driven along the test's path come last."""
    return not len(prediction.curve), inf if prediction.error is None else abs(prediction.error)


def _curves(axes: Axes, predictions: Sequence[Prediction]) -> None:
    """Plot the curves, and horizontal lines for predictions of a load only [mm, kN]."""
    wall = predictions[0].wall
    ends = cycle_ends(wall.path)
    if len(wall.curve):
        line = 0.6 if wall.is_cyclic else 1.8
        axes.plot(1e3 * wall.curve[:, 0], wall.curve[:, 1] / 1e3, color=MEASURED, lw=line, label="measured", alpha=0.7)
    elif wall.peak is not None:
        axes.axhline(wall.peak / 1e3, color=MEASURED, lw=1.8, label="measured peak")
    for each in predictions:
        if each.strength is None:
            continue
        look: dict[str, Any] = {"color": each.rung.model.colour, "ls": each.rung.model.line, "label": each.rung.name}
        if not len(each.curve):
            look |= {"rocking": {"ls": ":"}, "sliding": {"ls": "--"}}.get(each.rung.name, {})
            if each.rung.name != "by-hand" and each.strength < DRAWN_BELOW * (wall.peak or each.strength):
                axes.axhline(each.strength / 1e3, lw=0.9, **look)
            continue
        x, y = each.curve.T
        axes.plot(1e3 * x, y / 1e3, lw=0.6 if each.is_to_and_fro else 1.2, **look)
        if wall.is_cyclic and each.is_to_and_fro:
            _envelope(axes, each.curve, ends or _own_ends(each), each.rung.model.colour)
    if wall.is_cyclic and len(wall.curve):
        _envelope(axes, wall.curve, ends, MEASURED, "measured, peaks of its cycles")
    axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    axes.set_ylabel("horizontal force [kN]")
    if len(wall.curve) or any(len(each.curve) and each.strength is not None for each in predictions):
        axes.set_xlabel("displacement at the actuator [mm]")
    else:
        axes.set_xticks([])  # loads alone are the same at all displacements
    axes.set_title(f"{wall.name}" + ("" if wall.is_scored else ", shown, not scored"), fontsize=10)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=4)
    bare(axes)


def _own_ends(prediction: Prediction) -> tuple[float, ...]:
    """Ends of the growing cycles of a prediction without a record, whose curve starts to the positive side."""
    path = prediction.scene.drive_path
    return cycle_ends(growing([float(np.copysign(1.0, path[0])) * goal for goal in path]))


def _envelope(axes: Axes, curve: Array, path: tuple[float, ...], colour: str, label: str | None = None) -> None:
    """Plot the peaks of the cycles, in the order of their displacements."""
    ends = sorted(zip(path, cycle_peaks(curve, path), strict=False))
    axes.plot([1e3 * x for x, _ in ends], [y / 1e3 for _, y in ends], "o-", color=colour, lw=1.4, ms=3, label=label)


def error_over_cost(figure: Figure, predictions: Sequence[Prediction]) -> None:
    """Plot |ΔV| of every scored wall over its CPU time, the median of each model, and the formulas as lines to beat."""
    scored = [each for each in predictions if each.wall.is_scored and each.error is not None]
    kinds = list(dict.fromkeys(map(kind_of, scored))) or ["no"]
    panels = figure.subplots(1, len(kinds), sharey=True, squeeze=False)[0]
    for axes, kind in zip(panels, kinds, strict=True):
        _errors(axes, [each for each in scored if kind_of(each) == kind])
        axes.set(xscale="log", yscale="log", xlabel="CPU seconds", title=f"walls with {kind} joints")
        axes.xaxis.set_minor_formatter(NullFormatter())
    panels[0].set_ylabel("|ΔV|, strength against experiment")
    panels[0].yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
    panels[0].yaxis.set_major_locator(FixedLocator([0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10]))
    panels[0].yaxis.set_minor_locator(NullLocator())
    drawn = {name: mark for axes in panels for mark, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    if drawn:
        names = [name for name in LADDER if name in drawn]
        figure.legend(
            [drawn[name] for name in names],
            names,
            loc="outside lower center",
            ncols=len(names),
            frameon=False,
            fontsize=8,
            title="large: median over all walls, or over those told beside it",
            title_fontsize=8,
        )


def _errors(axes: Axes, scored: Sequence[Prediction]) -> None:
    by_rung: dict[str, list[Prediction]] = {}
    for each in scored:
        by_rung.setdefault(each.rung.name, []).append(each)
    walls = len({each.wall.name for each in scored})
    for name, own in by_rung.items():
        errors = [max(abs(each.error or 0.0), LEAST_ERROR) for each in own]
        model = own[0].rung.model
        if own[0].rung.is_by_hand:
            if name != "by-hand":
                _level(axes, median(errors), f"{name}, by hand")
            continue
        seconds = [max(each.outcome.seconds if each.outcome else 0.0, LEAST_SECONDS) for each in own]
        axes.plot(seconds, errors, model.marker, color=model.colour, ms=4, alpha=0.45, ls="none")
        middle = median(seconds), median(errors)
        axes.plot(*middle, model.marker, color=model.colour, ms=10, mec="black", ls="none", label=name)
        if len(own) < walls:  # not comparable with medians over all walls
            some = f"{len(own)} of {walls} walls"
            axes.annotate(some, middle, (7, 4), textcoords="offset points", fontsize=7, color=model.colour)
    _in_whole_decades(axes)
    if better := errors_by_hand(scored):
        _level(axes, max(median(better.values()), LEAST_ERROR), "the better of both,\nwall by wall", width=1.6)


def _in_whole_decades(axes: Axes) -> None:
    """Widen an axis of seconds that contains fewer than two powers of ten, because only these are labelled."""
    low, high = axes.dataLim.intervalx
    if low > high:  # no point with a time
        return
    first, last = np.floor(np.log10(low)), np.ceil(np.log10(high))
    if np.floor(np.log10(high)) - np.ceil(np.log10(low)) < 1:
        axes.set_xlim(10**first, 10 ** max(last, first + 1))


def _level(axes: Axes, error: float, text: str, width: float = 0.9) -> None:
    """Draw a horizontal line with its name beside the axes, where there are no points."""
    axes.axhline(error, color="0.35", lw=width, ls="--", zorder=0)
    side = "top" if width > 1 else "bottom"
    axes.annotate(
        text,
        (1.01, error),
        (0, 1 if side == "bottom" else -1),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        va=side,
        fontsize=8,
        annotation_clip=False,
        color="0.3",
    )
