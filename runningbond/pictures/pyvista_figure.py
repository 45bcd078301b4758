"""Figures with a wall painted by PyVista: a mechanism, or one moment of a run."""

from dataclasses import replace
from typing import TYPE_CHECKING

from runningbond.results.outcome import Outcome, number
from runningbond.scene import Scene

from .annotations import annotate, annotated_extent
from .captions import Caption, colour_key, figure_with_room, load_symbol, mechanism_caption, show_extent, wall_title
from .deformed_shape import DeformedShape, Extent, undeformed_shape
from .joint_state import JointState
from .mechanism import mechanism_shape
from .pyvista_painter import Painter, square_around
from .style import Colouring

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def mechanism_figure(
    scene: Scene, outcome: Outcome, painter: Painter, colouring: Colouring = "displacement"
) -> "Figure":
    """Figure of an outcome's mechanism; of the undeformed wall where there is none that the loads drive."""
    mechanism = mechanism_shape(scene, outcome)
    shape = replace(mechanism or undeformed_shape(scene), colouring=colouring)
    caption = mechanism_caption(scene, outcome, colour_key(shape.states, colouring), drawn=mechanism is not None)
    return _figure(shape, painter, caption, shape.extent)


def frame_figure(
    shape: DeformedShape,
    outcome: Outcome,
    painter: Painter,
    extent: Extent | None = None,
    states: list[JointState] | None = None,
) -> "Figure":
    """Figure of one moment of a run; with an extent and a key that are not its own, so that several make a film."""
    load = f"{outcome.model}: {load_symbol(shape.scene)} = {number(shape.multiplier)}"
    note = f"displacements × {float(f'{shape.scale:.3g}'):,.12g}"
    key = colour_key(shape.states if states is None else states, shape.colouring)
    return _figure(shape, painter, Caption(wall_title(outcome.scene), load, [note], key), extent or shape.extent)


def _figure(shape: DeformedShape, painter: Painter, caption: Caption, extent: Extent) -> "Figure":
    figure, axes = figure_with_room(annotated_extent(shape.scene, extent), caption)
    draw_painted(axes, shape, painter, extent)
    caption.write(axes)
    return figure


def draw_painted(
    axes: "Axes", shape: DeformedShape, painter: Painter, extent: Extent, *, annotated: bool = True
) -> None:
    """Draw a painted wall into axes of its own, with or without its supports and loads around it."""
    axes.imshow(painter.paint(shape, extent), extent=square_around(extent), interpolation="antialiased", zorder=1)
    show_extent(axes, annotated_extent(shape.scene, extent) if annotated else extent)
    if annotated:
        annotate(axes, shape)
