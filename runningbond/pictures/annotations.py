"""What engineers draw around a wall: supports, ties, loads with their sizes; and room for all of it on paper."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runningbond.scene import Array

from .deformed_shape import DeformedShape, Extent, around
from .labels import block_numbers
from .loads import LoadDrawing
from .sketch import Sketch
from .style import UNIT
from .supports import draw_beam, draw_scale, draw_supports
from .ties import draw_ties

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHARES, CROWDED = (1.0, 0.85, 0.7), 1.7
"""Sizes of type and arrows to be tried, and how much smaller than alone a wall may be drawn for them."""

HOPELESS = 20.0
"""How much smaller than alone a wall is not drawn, even if what is around it is cut off."""


@dataclass(frozen=True)
class Room:
    """Room for what is around a wall in a drawing.

    Parameters
    ----------
    extent
        What the drawing shows.
    point
        Metres that a point of the type takes in it, or somewhat more.
    share
        How large type and arrows are, as a share of their usual size.
    """

    extent: Extent
    point: float
    share: float


THRUST = "#7b3294"
"""Colour of the forces in joints."""


def sketch_around(shape: DeformedShape, point: float, *, numbers: bool = False, thrust: Array | None = None) -> Sketch:
    """Everything around a wall, where a point of the type takes so many metres.

    With it the numbers of blocks, and lines of thrust ``(n, 2, 2)`` [m], of which those at the base go beyond the wall.
    """
    sketch = Sketch(point, block_numbers(shape.scene, point) if numbers else [])
    sketch.keep_clear(shape.hinges)
    sketch.keep_clear(shape.crosses)
    for line in () if thrust is None else thrust:
        sketch.line("thrust", line, color=THRUST, lw=0.8, zorder=4)
    draw_supports(sketch, shape)
    draw_beam(sketch, shape)
    draw_ties(sketch, shape)
    LoadDrawing(sketch, shape).draw()
    draw_scale(sketch, shape)
    return sketch


def room_for(
    shapes: Sequence[DeformedShape],
    extent: Extent,
    size: tuple[float, float],
    *,
    numbers: bool = False,
    thrust: Array | None = None,
) -> Room:
    """Room for supports and loads around a wall in some shapes, in a drawing at most so wide and high [in].

    What is around the wall is made smaller where it would leave too little of the drawing to the wall.
    """
    least = metres_of_point(extent, size)
    rooms = (_room(shapes, extent, size, share, numbers, thrust) for share in SHARES)
    for room in rooms:
        if room.point < CROWDED * room.share * least:
            return room
    return room


def _room(
    shapes: Sequence[DeformedShape],
    extent: Extent,
    size: tuple[float, float],
    share: float,
    numbers: bool,
    thrust: Array | None,
) -> Room:
    """Room for what is around the wall, which takes the more metres the more is shown."""
    base = float(shapes[0].scene.blocks.extent(shapes[0].scene.wall)[0][1])
    point = least = metres_of_point(extent, size)
    while True:
        sketches = (sketch_around(shape, share * point, numbers=numbers, thrust=thrust) for shape in shapes)
        extents = [sketch.extent for sketch in sketches]
        floor = (*extent[:2], min(extent[2], base - 1.2 * UNIT * share * point), extent[3])
        shown = around([floor, *(one for one in extents if one)])
        needed = metres_of_point(shown, size)
        if needed <= point * (1 + 1e-12) or point > HOPELESS * least:
            return Room(shown, share * point, share)
        point += max(1.3 * (needed - point), 0.002 * point)


def metres_of_point(extent: Extent, size: tuple[float, float]) -> float:
    """Metres that a point takes where an extent is shown as large as can be in so many inches."""
    left, right, bottom, top = extent
    return max((right - left) / size[0], (top - bottom) / size[1]) / 72


def annotate(
    axes: "Axes", shape: DeformedShape, room: Room, *, numbers: bool = False, thrust: Array | None = None
) -> None:
    """Draw the supports of a wall, its ties, its loads and its lines of thrust into axes that have room for them."""
    sketch_around(shape, room.point, numbers=numbers, thrust=thrust).draw(axes, room.share)


def axes_size(axes: "Axes") -> tuple[float, float]:
    """Width and height of axes before they are given an aspect [in]."""
    figure = axes.figure
    box = axes.get_position(original=True)
    width, height = figure.get_size_inches() if hasattr(figure, "get_size_inches") else figure.figure.get_size_inches()
    return float(box.width * width), float(box.height * height)
