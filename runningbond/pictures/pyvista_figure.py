"""Figures with a wall painted by PyVista: a mechanism, or one moment of a run."""

from typing import TYPE_CHECKING

from runningbond.results.outcome import Outcome

from .annotations import annotate, annotated_extent
from .captions import caption, colour_key, figure_with_room, frame_axes, frame_title, mechanism_note, outcome_title
from .deformed_shape import DeformedShape, Extent
from .joint_state import JointState
from .pyvista_painter import Painter, square_around

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def mechanism_figure(shape: DeformedShape, outcome: Outcome, painter: Painter, warning: str = "") -> "Figure":
    """Figure of a collapse mechanism, or of the undeformed wall with a warning that says why none is drawn."""
    scale = "" if shape.scale == 1.0 and warning else mechanism_note(shape.scene)
    note = "\n".join(filter(None, [scale, warning]))
    return _figure(shape, painter, outcome_title(shape.scene, outcome), note, shape.extent, shape.states)


def frame_figure(
    shape: DeformedShape,
    outcome: Outcome,
    painter: Painter,
    extent: Extent | None = None,
    states: list[JointState] | None = None,
) -> "Figure":
    """Figure of one moment of a run; with an extent and a key that are not its own, so that several make a film."""
    note = f"displacements × {float(f'{shape.scale:.3g}'):,.12g}"
    title = frame_title(shape, outcome)
    return _figure(shape, painter, title, note, extent or shape.extent, shape.states if states is None else states)


def _figure(
    shape: DeformedShape, painter: Painter, title: list[str], note: str, extent: Extent, states: list[JointState]
) -> "Figure":
    figure, axes = figure_with_room(annotated_extent(shape.scene, extent), len(title))
    draw_painted(axes, shape, painter, extent)
    caption(axes, title, note, colour_key(states, shape.colouring))
    return figure


def draw_painted(
    axes: "Axes", shape: DeformedShape, painter: Painter, extent: Extent, *, annotated: bool = True
) -> None:
    """Draw a painted wall into axes of its own, with or without its supports and loads around it."""
    axes.imshow(painter.paint(shape, extent), extent=square_around(extent), interpolation="antialiased", zorder=1)
    frame_axes(axes, annotated_extent(shape.scene, extent) if annotated else extent)
    if annotated:
        annotate(axes, shape)
