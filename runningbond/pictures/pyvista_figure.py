"""Figures of a wall painted by PyVista: a mechanism, or one moment of a run."""

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Scene

from .annotations import Room, annotate, room_for
from .captions import (
    TALLEST,
    WIDTH,
    Caption,
    colour_key,
    figure_with_room,
    held_key,
    load_text,
    mechanism_caption,
    show_extent,
    wall_title,
)
from .deformed_shape import DeformedShape, Extent, common_extent, scale_note, undeformed_shape
from .mechanism import mechanism_shape
from .pyvista_painter import Painter, square_around
from .style import STATE_COLOURS, Colouring

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def mechanism_figure(
    scene: Scene, outcome: Outcome, painter: Painter, colouring: Colouring = "displacement"
) -> "Figure":
    """Figure of an outcome's mechanism, or of the undeformed wall if there is none that the loads drive."""
    mechanism = mechanism_shape(scene, outcome)
    shape = replace(mechanism or undeformed_shape(scene), colouring=colouring)
    key = colour_key(shape.states, colouring, crushes=len(shape.crosses) > 0)
    caption = mechanism_caption(scene, outcome, key, mechanism)
    return _figure(shape, painter, caption, (shape,))


def frame_figure(
    shape: DeformedShape, title: str, model: str, painter: Painter, film: tuple[DeformedShape, ...] = ()
) -> "Figure":
    """Figure of one moment of a model's run on a wall.

    If the moment is part of a film, the figure has room and a colour key for all moments of the film.
    """
    film = film or (shape,)
    load = f"{model}: {load_text(shape.scene, shape.multiplier)}"
    load += "" if shape.time is None else f", t = {shape.time:.3f} s"
    states = [state for state in STATE_COLOURS if any(state in one.drawn_state for one in film)]
    key = [*colour_key(states, shape.colouring, crushes=any(len(one.crosses) for one in film)), *held_key(shape.scene)]
    return _figure(shape, painter, Caption(wall_title(title), load, [scale_note(shape)], key), film)


def _figure(shape: DeformedShape, painter: Painter, caption: Caption, film: tuple[DeformedShape, ...]) -> "Figure":
    extent, room = _room(film)
    figure, axes = figure_with_room(room.extent, caption)
    draw_painted(axes, shape, painter, extent)
    show_extent(axes, room.extent)
    annotate(axes, shape, room)
    caption.write(axes)
    return figure


@lru_cache(maxsize=1)
def _room(film: tuple[DeformedShape, ...]) -> tuple[Extent, Room]:
    """Extent of all frames of a film, and room for annotations at rest and in the frames that reach farthest."""
    extents, outwards = np.array([one.extent for one in film]), (-1, 1, -1, 1)
    farthest = dict.fromkeys(film[k] for k in (extents * outwards).argmax(axis=0))
    extent = common_extent(film)
    return extent, room_for([*farthest, undeformed_shape(film[0].scene)], extent, (WIDTH, TALLEST))


def draw_painted(axes: "Axes", shape: DeformedShape, painter: Painter, extent: Extent) -> None:
    """Draw a painted wall into axes, with white pixels transparent; supports and loads are drawn separately."""
    image = painter.paint(shape, extent)
    seen = np.dstack([image, np.where((image == 255).all(axis=2), 0, 255).astype(np.uint8)])
    axes.imshow(seen, extent=square_around(extent), interpolation="antialiased", zorder=2.5)
    show_extent(axes, extent)
