"""Annotations around a wall (supports, ties, loads with their sizes) and the space they need on paper."""

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

SIZE_FACTORS, MAX_REDUCTION = (1.0, 0.85, 0.7), 1.7
"""Size factors tried in turn for type and arrows, and factor below which the wall's reduction on paper is accepted."""

REDUCTION_LIMIT = 20.0
"""Factor beyond which the wall's drawn size is not reduced further, even if annotations are cut off."""


@dataclass(frozen=True)
class Room:
    """Space for the annotations around a wall in a drawing.

    Parameters
    ----------
    extent
        Part of the plane that the drawing shows.
    point
        Metres in the drawing per nominal point of type, which is drawn smaller by `share`; or somewhat more.
    share
        Size of type and arrows relative to their usual size.
    """

    extent: Extent
    point: float
    share: float


THRUST = "#7b3294"
"""Colour of the forces in joints."""


def sketch_around(shape: DeformedShape, point: float, *, numbers: bool = False, thrust: Array | None = None) -> Sketch:
    """Collect all annotations around a wall, for a given number of metres per typographic point.

    They can include block numbers and lines of thrust ``(n, 2, 2)`` [m]; the latter extend beyond the wall at its base.
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
    """Find space for supports and loads around several shapes of a wall, in a drawing of at most a given size [in].

    Annotations are made smaller if they would leave too little of the drawing to the wall.
    """
    least = metres_of_point(extent, size)
    rooms = (_room(shapes, extent, size, share, numbers, thrust) for share in SIZE_FACTORS)
    for room in rooms:
        if room.point < MAX_REDUCTION * room.share * least:
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
    """Space for annotations of a given relative size, by iteration: a larger extent makes them larger in metres."""
    base = float(shapes[0].scene.blocks.extent(shapes[0].scene.wall)[0][1])
    point = least = metres_of_point(extent, size)
    while True:
        sketches = (sketch_around(shape, share * point, numbers=numbers, thrust=thrust) for shape in shapes)
        extents = [sketch.extent for sketch in sketches]
        floor = (*extent[:2], min(extent[2], base - 1.2 * UNIT * share * point), extent[3])
        shown = around([floor, *(one for one in extents if one)])
        needed = metres_of_point(shown, size)
        if needed <= point * (1 + 1e-12) or point > REDUCTION_LIMIT * least:
            return Room(shown, share * point, share)
        point += max(1.3 * (needed - point), 0.002 * point)


def metres_of_point(extent: Extent, size: tuple[float, float]) -> float:
    """Metres per typographic point if an extent is shown as large as possible in a drawing of a given size [in]."""
    left, right, bottom, top = extent
    return max((right - left) / size[0], (top - bottom) / size[1]) / 72


def annotate(
    axes: "Axes", shape: DeformedShape, room: Room, *, numbers: bool = False, thrust: Array | None = None
) -> None:
    """Draw the supports, ties, loads and lines of thrust of a wall into axes that have room for them."""
    sketch_around(shape, room.point, numbers=numbers, thrust=thrust).draw(axes, room.share)


def axes_size(axes: "Axes") -> tuple[float, float]:
    """Width and height of axes before an aspect ratio is applied [in]."""
    figure = axes.figure
    box = axes.get_position(original=True)
    width, height = figure.get_size_inches() if hasattr(figure, "get_size_inches") else figure.figure.get_size_inches()
    return float(box.width * width), float(box.height * height)
