"""What engineers draw around a wall: supports, ties, loads with their sizes; and room for all of it on paper."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .deformed_shape import DeformedShape, Extent
from .loads import LoadDrawing
from .sketch import Sketch
from .style import UNIT
from .supports import draw_beam, draw_supports
from .ties import draw_ties

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROUNDS = 12
"""How often room is made anew: a drawing that shows more is smaller, and its type larger in metres."""


def sketch_around(shape: DeformedShape, point: float) -> Sketch:
    """Everything around a wall, where a point of the type takes so many metres."""
    sketch = Sketch(point)
    draw_supports(sketch, shape)
    draw_beam(sketch, shape)
    draw_ties(sketch, shape)
    LoadDrawing(sketch, shape).draw()
    return sketch


def annotated_extent(shapes: Sequence[DeformedShape], extent: Extent, size: tuple[float, float]) -> Extent:
    """An extent with room for supports and loads of a wall in some shapes, in a drawing at most so wide and high [in]."""
    base = float(shapes[0].scene.blocks.extent(shapes[0].scene.wall)[0][1])
    shown = extent
    for _ in range(ROUNDS):
        point = metres_of_point(shown, size)
        last, shown = shown, (*extent[:2], min(extent[2], base - 1.2 * UNIT * point), extent[3])
        for shape in shapes:
            shown = _both(shown, sketch_around(shape, point).extent or extent)
        if max(abs(a - b) for a, b in zip(last, shown, strict=True)) < 0.3 * point:
            break
    return shown


def metres_of_point(extent: Extent, size: tuple[float, float]) -> float:
    """Metres that a point takes where an extent is shown as large as can be in so many inches."""
    left, right, bottom, top = extent
    return max((right - left) / size[0], (top - bottom) / size[1]) / 72


def _both(one: Extent, other: Extent) -> Extent:
    (a, b, c, d), (e, f, g, h) = one, other
    return min(a, e), max(b, f), min(c, g), max(d, h)


def annotate(axes: "Axes", shape: DeformedShape) -> None:
    """Draw the supports of a wall, its ties and its loads into axes that have room for them."""
    sketch_around(shape, metres_of_point((*axes.get_xlim(), *axes.get_ylim()), axes_size(axes))).draw(axes)


def axes_size(axes: "Axes") -> tuple[float, float]:
    """Width and height of axes before they are given an aspect [in]."""
    figure = axes.figure
    box = axes.get_position(original=True)
    width, height = figure.get_size_inches() if hasattr(figure, "get_size_inches") else figure.figure.get_size_inches()
    return float(box.width * width), float(box.height * height)
