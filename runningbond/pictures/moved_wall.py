"""A wall displaced by a ground motion: its displaced blocks over the wall as it was built."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from runningbond.scene import Array, Scene

from .annotations import axes_size, metres_of_point
from .captions import show_extent
from .deformed_shape import DeformedShape, Extent, farthest_motion, scale_note, series_scale
from .flat import line_width, paint_blocks
from .sketch import Sketch
from .style import HELD
from .ties import draw_ties

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_DISTANCE, MARGIN = 1.0, 0.04
"""Distance beside and above a wall up to which fallen blocks are shown, in its larger sides, and margin around all, in
sizes of the wall."""

NEGLIGIBLE = 0.1
"""Motion, relative to the contact tolerance, up to which a wall is drawn without enlargement."""


def moved_shape(scene: Scene, motion: Array) -> DeformedShape:
    """Shape after a motion ``(nb, 3)`` [m, m, rad], at true scale or, if that would not be visible, enlarged.

    A negligible motion is not enlarged, because the elastic deformation of joints would look like a ruin.
    """
    sticking = np.zeros(len(scene.joints), dtype=np.int64)
    shape = DeformedShape.of_rigid_blocks(scene, motion, sticking, 0.0, finite=True)
    farthest = farthest_motion(shape.displacement)
    scale = series_scale(scene.size, farthest) if farthest > NEGLIGIBLE * scene.blocks.tolerance else 1.0
    return replace(shape, scale=scale)


def enlarged(shape: DeformedShape) -> str:
    """Addition to a title with the scale of displacements; empty if they are drawn at true scale."""
    return f", {scale_note(shape)}" if shape.scale > 1 else ""


def draw_moved(axes: "Axes", shape: DeformedShape, extent: Extent) -> None:
    """Draw a displaced wall with its ties into axes that show a part of the plane."""
    from matplotlib.collections import PolyCollection

    scene = shape.scene
    show_extent(axes, extent)
    ground = [scene.blocks.polygon(int(block)) for block in np.flatnonzero(~scene.wall)]
    axes.add_collection(PolyCollection(ground, facecolors=[HELD], edgecolors="none", zorder=0), autolim=False)
    paint_blocks(axes, shape, line_width(scene, extent, axes_size(axes)))
    sketch = Sketch(metres_of_point(extent, axes_size(axes)))
    draw_ties(sketch, shape)
    sketch.draw(axes, 1.0)


def extent_around(shapes: list[DeformedShape]) -> Extent:
    """Extent of all shapes of a wall, except for blocks that have moved far away from it."""
    scene = shapes[0].scene
    (left, bottom), (right, top) = scene.blocks.extent(scene.wall)
    far = MAX_DISTANCE * max(right - left, top - bottom)
    placed = np.concatenate([shape.placed for shape in shapes])
    low = np.maximum(np.minimum([left, bottom], placed.min(axis=0)), [left - far, bottom])
    high = np.minimum(np.maximum([right, top], placed.max(axis=0)), [right + far, top + far])
    air = MARGIN * scene.size
    return float(low[0] - air), float(high[0] + air), float(low[1] - air), float(high[1] + air)
