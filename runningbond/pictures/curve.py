"""The pushover curve of one outcome as a chart: load against the displacement of the control point."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from runningbond.results import Outcome
from runningbond.results.reactions import AT_REST
from runningbond.scene import Array, Mask, Scene

from .captions import is_force, load_symbol, multiplier_text, wall_title
from .charts import bare
from .style import CHART_COLOURS, DARK, SMALL_TYPE, TYPE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

(CURVE, _, _, FALL, _), BAND = CHART_COLOURS, "#f2c879"
"""Colours of states at rest, of a fall, and of the bracket."""

LABEL_HEIGHT = 0.08
"""Space kept for the label below the lowest level in charts of settlements, relative to the height above that level."""

MARKER_SPACING = 0.015
"""Least distance of the dots of a curve, relative to the diagonal of the chart: hundreds of rows would merge."""

LINEAR_SHARE = 0.04
"""Displacement at half the peak load, relative to the axis range, below which the axis is made logarithmic."""


def curve_figure(scene: Scene, outcome: Outcome, *, make: "Callable[..., Figure] | None" = None) -> "Figure":
    """Make a figure of a non-empty curve; `make` replaces `Figure`."""
    from matplotlib.figure import Figure

    figure = (make or Figure)(figsize=(5.2, 3.7), layout="constrained", dpi=200)
    draw_curve(figure.add_subplot(), scene, outcome)
    return figure


def draw_curve(axes: "Axes", scene: Scene, outcome: Outcome) -> None:
    """Draw a non-empty curve into axes, with the bracket as a band and the collapse load as a line in it."""
    from matplotlib.patheffects import withStroke

    moved, load = 1e3 * outcome.curve[:, 0], outcome.curve[:, 1]
    if outcome.lower is not None and outcome.upper is not None:
        axes.axhspan(outcome.lower, outcome.upper, color=BAND, lw=0, alpha=0.6)
    if outcome.multiplier is not None:
        axes.axhline(outcome.multiplier, color=DARK, lw=0.8, ls="--")
    answer, bracket = multiplier_text(scene, outcome)
    levels = [x for x in (outcome.lower, outcome.multiplier, outcome.upper) if x is not None] or [load.max()]
    axes.annotate(
        f"{answer}  {bracket}".strip(),
        (0.02, min([*levels, *load]) if scene.settlement else max(levels)),
        (0, -4 if scene.settlement else 4),  # under a settlement, the curve descends to the level
        va="top" if scene.settlement else "baseline",
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        fontsize=TYPE,
        color=DARK,
        zorder=5,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
    )
    _draw_states(axes, scene, outcome)
    if scene.is_led or not _is_in_motion(scene, outcome):  # else it is pushed far, and its fall must stay visible
        _bend(axes, moved, load)
    bottom = min(0.0, 1.12 * load.min())
    top = max(-0.05 * bottom, 1.12 * max(load.max(), *levels)) or 1.0
    if scene.settlement:
        least = min([*levels, *load])
        bottom = min(bottom, least - LABEL_HEIGHT * (top - least))
    axes.set_ylim(bottom, top)
    displacement, load_axis = curve_quantities(scene)
    axes.set_xlabel(f"{displacement} [mm]", fontsize=TYPE + 1)
    axes.set_ylabel(load_axis, fontsize=TYPE + 1)
    axes.set_title("\n".join([*wall_title(outcome.scene), outcome.model]), fontsize=TYPE + 2, parse_math=False)
    axes.tick_params(labelsize=TYPE)
    axes.ticklabel_format(axis="y", useMathText=True)  # × 10⁷, not 1e7
    bare(axes)


def _draw_states(axes: "Axes", scene: Scene, outcome: Outcome) -> None:
    """Draw states at rest and in a fall; under ground motions each state is a separate run, so no line joins them."""
    moved, load = 1e3 * outcome.curve[:, 0], outcome.curve[:, 1]
    rests = _rests(outcome) | _is_in_motion(scene, outcome)
    held, way = ("stands", ".") if scene.history else ("at rest", "-" if _is_in_motion(scene, outcome) else ".-")
    apart = None if scene.history else MARKER_SPACING  # the curve has no line between the scales of a record
    axes.plot(moved[rests], load[rests], way, color=CURVE, lw=1.2, ms=4, markevery=apart, label=held)
    if not rests.all():
        last = np.flatnonzero(~rests)[0]
        if not scene.history:
            axes.plot(moved[last - 1 :], load[last - 1 :], ":", color=FALL, lw=1.0)
        axes.plot(moved[~rests], load[~rests], "x", color=FALL, ms=6, mew=1.5, label="falls")
        axes.legend(frameon=False, fontsize=SMALL_TYPE + 1, loc="lower right")


def _rests(outcome: Outcome) -> Mask:
    """Whether the wall is at rest at each row of a curve."""
    return np.asarray(outcome.curve_columns().get(AT_REST, np.ones(len(outcome.curve))) == 1)


def _is_in_motion(scene: Scene, outcome: Outcome) -> bool:
    """Whether the wall moves with what drives it all the way; a curve of loads ends with the only row of a fall."""
    rests = _rests(outcome)
    return scene.history is None and len(rests) > 2 and not rests[1:].any()


def _bend(axes: "Axes", moved: Array, load: Array) -> None:
    """Make the displacement axis logarithmic beyond a linear part if the rise of the load would be invisible."""
    from matplotlib.ticker import SymmetricalLogLocator

    k = int(np.argmax(load >= load.max() / 2))
    ends = slice(max(k - 1, 0), k + 1)  # load steps may be long: half the peak lies between two states
    half = float(np.abs(np.interp(load.max() / 2, load[ends], moved[ends])))
    if not 0 < half < LINEAR_SHARE * np.ptp(moved) or moved.min() <= -half:  # no log axis for cyclic loading
        return
    linear = float(10.0 ** np.ceil(np.log10(half)))
    axes.set_xscale("symlog", linthresh=linear)
    axes.xaxis.set_major_formatter("{x:g}")
    if moved.max() < 10 * linear:  # otherwise 0 and one power of ten would be the only numbers
        axes.xaxis.set_major_locator(SymmetricalLogLocator(base=10, linthresh=linear, subs=[1, 2, 3, 5]))
    axes.xaxis.set_minor_locator(SymmetricalLogLocator(base=10, linthresh=linear, subs=range(2, 10)))
    axes.axvspan(min(0.0, moved.min()), linear, color="0.93", lw=0, zorder=0)
    for word, place, align in (("linear", -4, "right"), ("logarithmic", 4, "left")):
        spot: dict[str, Any] = {"textcoords": "offset points", "ha": align, "fontsize": SMALL_TYPE}
        axes.annotate(word, (linear, 0.0), (place, 3), **spot)


def curve_quantities(scene: Scene) -> tuple[str, str]:
    """Axis names of a curve: its displacement without a unit, and its load with its unit, if it has one."""
    symbol = load_symbol(scene)
    load = f"load {symbol} [N]" if is_force(scene) else f"load multiplier {symbol}"
    if scene.history:
        return "largest displacement of the top", f"scale {symbol} of the record"
    if scene.settlement:
        return "displacement of the support", f"share {symbol} of the dead load on the support"
    return "displacement of the control point along the live load", load
