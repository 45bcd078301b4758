"""Figure of a wall's response to a ground motion: ground, drift, base shear and energies over time, and the wall."""

import textwrap
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from runningbond.response import ENERGIES, Response
from runningbond.scene import Scene

from .annotations import axes_size
from .captions import to_png, to_svg
from .charts import bare
from .deformed_shape import DeformedShape
from .moved_wall import draw_moved, enlarged, extent_around, moved_shape
from .style import CHART_COLOURS, DARK, SMALL_TYPE, TYPE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

WIDE, CHARTS, WALLS, TITLES = 6.4, 6.4, 2.4, 0.3
"""Width of the figure, height of its charts, largest height of its wall drawings, and height of their titles [in]."""

LETTERS = 112
"""Characters per line of the title."""

ENERGY_COLOURS = dict(zip(("kinetic", "stored", "friction", "damped"), (*CHART_COLOURS[:3], "0.9"), strict=True))
"""Colours of kinetic and stored energy, and of the energy dissipated by friction and damping."""


def response_figure(response: Response, scene: Scene) -> "Figure":
    """Draw the response over time, and the wall as it gives way and in its final state."""
    from matplotlib.figure import Figure

    shapes = shapes_of(response, scene)
    left, right, bottom, top = extent = extent_around(list(shapes.values()))
    height = min(TITLES + WIDE / len(shapes) * (top - bottom) / (right - left), WALLS)
    figure = Figure(figsize=(WIDE, CHARTS + height), layout="constrained", dpi=200)
    charts, walls = figure.subfigures(2, 1, squeeze=False, height_ratios=(CHARTS, height)).ravel()
    _draw_charts(charts, response)
    for axes, (name, shape) in zip(np.ravel(walls.subplots(1, len(shapes))), shapes.items(), strict=True):
        draw_moved(axes, shape, extent)
        axes.set_title(f"{name}{enlarged(shape)}", fontsize=SMALL_TYPE + 1)
    verdict = textwrap.wrap(f"λ = {response.scale:g}: {response.message.split(';')[0]}", LETTERS)
    title = "\n".join([*textwrap.wrap(response.scene, LETTERS), *verdict])
    figure.suptitle(title, fontsize=TYPE, parse_math=False)
    return figure


def shapes_of(response: Response, scene: Scene) -> dict[str, DeformedShape]:
    """Shapes of the wall as it gives way, if it fell, and in its final state, by title."""
    states = {"as it gives way": response.shape} if response.verdict == "collapse" else {}
    states |= {f"after {response.time[-1]:.3g} s": response.motion}
    return {name: moved_shape(scene, motion) for name, motion in states.items()}


def _draw_charts(figure: "SubFigure", response: Response) -> None:
    """Draw the ground acceleration, the drift of the top, the base shear and the energies over time."""
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
    parts = [response.energy[:, ENERGIES.index(name)] for name in ENERGY_COLOURS]
    energy.stackplot(
        time, np.maximum(parts, 0.0), colors=ENERGY_COLOURS.values(), labels=ENERGY_COLOURS, lw=0.3, ec="white"
    )
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


@dataclass(frozen=True, eq=False, repr=False)
class DrawnResponse(Response):
    """Result of `Wall.respond`: a response and its wall, shown as a chart in notebooks unless it was not shaken."""

    wall: Scene = field(kw_only=True)

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the wall in its final state into axes, or into a new figure if none are given."""
        if axes is None:
            from matplotlib.pyplot import figure

            axes = figure(layout="constrained").gca()
        shape = moved_shape(self.wall, self.motion)
        draw_moved(axes, shape, extent_around([shape]))
        title = textwrap.wrap(f"{self.line.split(';')[0]}{enlarged(shape)}", int(axes_size(axes)[0] * LETTERS / WIDE))
        axes.set_title("\n".join(title), fontsize=TYPE, parse_math=False)
        return axes

    def _repr_svg_(self) -> str | None:
        return to_svg(response_figure(self, self.wall)).decode() if len(self.time) else None

    def _repr_png_(self) -> bytes | None:
        return to_png(response_figure(self, self.wall)) if len(self.time) else None
