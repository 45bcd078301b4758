"""Pictures of walls: what PyVista paints, in a figure that says what is to be seen."""

import io
import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from runningbond.results.outcome import Outcome, number
from runningbond.scene import Scene

from .annotations import SIZE, draw_load, draw_supports, with_signs
from .frame import Stage, State, mechanism_frame
from .moment import Shown
from .painting import DRAWN, FAST, STATE_COLOURS, STILL, Colouring, Painter, View, wall_size

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, TALLEST, DPI = 3.5, 4.2, 300
"""Width of a picture, that of a journal's column, largest height of the wall in it [in], and dots per inch."""

DARK, SMALL = "0.25", 6.5
"""Colour and size of the type [pt] in notes."""

SAYS = {State.SLIDE: "slides", State.OPEN: "opens", State.FAILED: "bond spent"}


def show_mechanism(scene: Scene, outcome: Outcome, colouring: Colouring = "displacement") -> Shown | None:
    """The collapse mechanism of an outcome, or None where it has none."""
    frame = mechanism_frame(scene, outcome)
    return None if frame is None else Shown.of_frame(Stage.of_rigid_blocks(scene), frame, colouring)


def show_undeformed(scene: Scene) -> Shown:
    """The wall as it was built."""
    still = Outcome(scene.title, "", "undecided", motion=np.zeros((len(scene.blocks), 3)))
    frame = mechanism_frame(scene, still)
    assert frame is not None  # it has the motion of as many blocks as the scene
    return Shown.of_frame(Stage.of_rigid_blocks(scene), frame)


def mechanism_picture(shown: Shown, outcome: Outcome, painter: Painter) -> "Figure":
    """Picture of a collapse mechanism."""
    note = f"mechanism; the fastest corner is drawn to move {DRAWN * wall_size(shown.scene):.2g} m"
    title = [outcome.scene, f"{outcome.model}: {'  '.join(multiplier_text(shown.scene, outcome))}"]
    return picture(shown, painter, title, note, shown.view(painter.pixels))


def moment_picture(
    shown: Shown, outcome: Outcome, painter: Painter, view: View | None = None, states: list[State] | None = None
) -> "Figure":
    """Picture of a moment of a run; with a view and a key that are not its own, so that several make a film."""
    name = "P" if newtons(shown.scene) else "λ"
    title = [outcome.scene, f"{outcome.model}: {name} = {number(shown.multiplier)}"]
    note = f"displacements × {float(f'{shown.scale:.3g}'):,.12g}"
    return picture(shown, painter, title, note, view or shown.view(painter.pixels), states)


def picture(
    shown: Shown, painter: Painter, title: list[str], note: str, view: View, states: list[State] | None = None
) -> "Figure":
    """Picture of one moment, with its title, a note on how it is drawn and a key to its colours."""
    from matplotlib.figure import Figure

    heading = textwrap.wrap(title[0], 62) or [""]
    head, foot = 0.14 * (len(heading) + len(title) - 1) + 0.1, 0.36
    left, right, bottom, top = with_signs(shown.scene, view)
    height = min(WIDTH * (top - bottom) / (right - left), TALLEST)
    total = height + head + foot
    figure = Figure(figsize=(WIDTH, total), dpi=DPI)
    axes = figure.add_axes((0, foot / total, 1, height / total))
    draw_wall(axes, shown, painter, view)
    above = 1 - 0.06 / total
    for line in heading:
        figure.text(0.5, above, line, ha="center", va="top", fontsize=SIZE, fontweight="bold")
        above -= 0.14 / total
    for line in title[1:]:
        figure.text(0.5, above, line, ha="center", va="top", fontsize=SIZE)
        above -= 0.14 / total
    figure.text(0.5, 0.03 / total, note, ha="center", va="bottom", fontsize=SMALL, color=DARK)
    figure.legend(
        handles=key(shown.states if states is None else states, shown.colouring),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.13 / total),
        ncols=5,
        frameon=False,
        fontsize=SMALL,
        handlelength=1.4,
        columnspacing=1.2,
        borderpad=0.2,
    )
    return figure


def key(states: Sequence[State] = tuple(STATE_COLOURS), colouring: Colouring = "displacement") -> list[Any]:
    """What the colours of a picture stand for, for a legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    lines = [Line2D([], [], color=STATE_COLOURS[state], lw=1.6, label=SAYS[state]) for state in states]
    if colouring == "course":
        return lines
    ends = ((STILL, "block at rest"), (FAST, "fastest block"))
    return [*lines, *(Patch(facecolor=colour, edgecolor="0.5", lw=0.5, label=label) for colour, label in ends)]


def multiplier_text(scene: Scene, outcome: Outcome) -> tuple[str, str]:
    """Load at collapse, or what there is instead, and its bracket; empty where that adds nothing."""
    name, unit = ("P", " N") if newtons(scene) else ("λ", "")
    low, high = (None if x is None else number(x) for x in (outcome.lower, outcome.upper))
    if outcome.status != "collapse" or outcome.multiplier is None:
        bounds = [f"{name} ≥ {low}{unit}"] * (low is not None) + [f"{name} ≤ {high}{unit}"] * (high is not None)
        return outcome.status, ", ".join(bounds)
    bracket = "" if low is None or high is None or low == high else f"[{low}, {high}]{unit}"
    return f"{name} = {number(outcome.multiplier)}{unit}", bracket


def newtons(scene: Scene) -> bool:
    """Whether λ is a force in newtons: that of a point load of one newton."""
    live = scene.live_forces
    return live.at_points_alone and math.isclose(math.hypot(*live.force.sum(axis=0)), 1.0)


def png(figure: "Figure", dpi: float = DPI) -> bytes:
    """A figure as the content of a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi)
    return buffer.getvalue()


def draw_wall(axes: "Axes", shown: Shown, painter: Painter, view: View, *, signs: bool = True) -> None:
    """Draw a wall into axes of its own, with or without the signs of its supports and loads around it."""
    image = painter.paint(shown.scene, shown.blocks, shown.joints, view, shown.scale, shown.colouring)
    axes.imshow(image, extent=view.extent, interpolation="antialiased", zorder=1)
    left, right, bottom, top = with_signs(shown.scene, view) if signs else view.extent
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.axis("off")
    if signs:
        draw_supports(axes, shown)
        draw_load(axes, shown, "P" if newtons(shown.scene) else "λ")
