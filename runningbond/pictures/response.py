"""The response of a wall to a motion of its ground as a chart: ground, drift, base shear and energies over time."""

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from runningbond.response import ENERGIES, Response

from .captions import to_png, to_svg
from .charts import bare
from .style import CHART_COLOURS, DARK, SMALL_TYPE, TYPE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LETTERS = 112
"""Letters in a line of the title."""

SPENT = dict(zip(("kinetic", "stored", "friction", "damped"), (*CHART_COLOURS[:3], "0.9"), strict=True))
"""What energy becomes, and its colour."""


def response_figure(response: Response) -> "Figure":
    """Draw the acceleration of the ground, the drift of the top, the base shear, and what became of the energy."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 6.4), layout="constrained", dpi=200)
    ground, drift, shear, energy = figure.subplots(4, 1, sharex=True, height_ratios=(1, 1.5, 1, 1.7))
    time = response.time
    lines = (
        (ground, response.ground[:, 0], "ground's\nacceleration [m/s²]"),
        (drift, response.drift, "drift [–]"),
        (shear, response.reaction[:, 0] / 1e3, "base shear [kN]"),
    )
    for axes, values, name in lines:
        axes.plot(time, values, color=DARK, lw=0.9)
        axes.axhline(0.0, color="0.7", lw=0.5, zorder=0)
        axes.set_ylabel(name, fontsize=SMALL_TYPE + 1)
    parts = [response.energy[:, ENERGIES.index(name)] for name in SPENT]
    energy.stackplot(time, np.maximum(parts, 0.0), colors=SPENT.values(), labels=SPENT, lw=0.3, ec="white")
    energy.plot(time, response.energy[:, :2].sum(axis=1), color=DARK, lw=0.9, label="input + weight")
    energy.set_ylabel("energy [J]", fontsize=SMALL_TYPE + 1)
    energy.set_xlabel("time [s]", fontsize=SMALL_TYPE + 1)
    energy.legend(frameon=False, fontsize=SMALL_TYPE, ncols=5, loc="lower left", bbox_to_anchor=(0.0, 0.98))
    for axes in (ground, drift, shear, energy):
        axes.tick_params(labelsize=SMALL_TYPE)
        axes.yaxis.get_offset_text().set_fontsize(SMALL_TYPE)
        bare(axes)
    fallen = np.flatnonzero(response.fallen)
    if len(fallen):
        drift.axvline(time[fallen[0]], color=CHART_COLOURS[3], lw=0.9, ls="--", label="first block falls")
        drift.legend(frameon=False, fontsize=SMALL_TYPE)
    verdict = textwrap.wrap(f"λ = {response.scale:g}: {response.message.split(';')[0]}", LETTERS)
    title = "\n".join([*textwrap.wrap(response.scene, LETTERS), *verdict])
    figure.suptitle(title, fontsize=TYPE, parse_math=False)
    return figure


class DrawnResponse(Response):
    """What `Wall.respond` returns: a response, and its chart in notebooks; none where the wall was not shaken."""

    def _repr_svg_(self) -> str | None:
        return to_svg(response_figure(self)).decode() if len(self.time) else None

    def _repr_png_(self) -> bytes | None:
        return to_png(response_figure(self)) if len(self.time) else None
