"""Stand-in for the flat drawings until theirs is here: outlines of blocks, where they are and where they go."""

from typing import TYPE_CHECKING

import numpy as np

from runningbond.results import Outcome
from runningbond.results.mechanism import carried
from runningbond.scene import Array, Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DRAWN = 0.1
"""Motion of the fastest corner of a mechanism, in sizes of the wall."""


def draw_wall(axes: "Axes", scene: Scene) -> None:
    """Draw a wall as it was built."""
    _draw(axes, scene, scene.blocks.vertices)
    axes.set_title(scene.title)


def draw_mechanism(axes: "Axes", scene: Scene, outcome: Outcome) -> None:
    """Draw the mechanism of an outcome, or the wall where it has none."""
    corners, low_high = scene.blocks.vertices, scene.blocks.extent(scene.wall)
    if len(outcome.motion):
        size = float(np.ptp(low_high, axis=0).max())
        corners = corners + DRAWN * size * carried(scene.blocks, scene.blocks.owner, corners, outcome.motion)
    _draw(axes, scene, corners)
    axes.set_title(f"{outcome.scene}: {outcome.model}")


def figure_of(scene: Scene, outcome: Outcome | None = None) -> "Figure":
    """A figure of a wall, or of the mechanism of an outcome."""
    from matplotlib.figure import Figure

    figure = Figure()
    axes = figure.add_subplot()
    if outcome is None:
        draw_wall(axes, scene)
    else:
        draw_mechanism(axes, scene, outcome)
    return figure


def _draw(axes: "Axes", scene: Scene, corners: Array) -> None:
    first = scene.blocks.first
    for block in np.flatnonzero(scene.wall):
        axes.fill(*corners[first[block] : first[block + 1]].T, facecolor="0.9", edgecolor="0.3")
    axes.set_aspect("equal")
    axes.axis("off")
