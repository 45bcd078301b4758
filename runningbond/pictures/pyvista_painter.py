"""Walls painted by PyVista, into an off-screen image or a window."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from runningbond.scene import Array, Indices

from .deformed_shape import DeformedShape, Extent, outline, usual_side
from .joint_state import JointState
from .style import CRUSHED, EDGE, OUTLINE, STATE_COLOURS, tint
from .vtk_safety import import_pyvista, uninterrupted_imports, vtk_errors_raised

Image: TypeAlias = NDArray[np.uint8]

WIDTHS = {JointState.SLIDE: 3.0, JointState.OPEN: 3.4, JointState.DEBONDED: 3.0}
"""Widths of the joints' lines, in pixels of an image of the reference's size."""

CROSS = 0.09
"""Half the width of a cross where a joint is crushed, in sides of the smaller blocks."""

FINE, FAINTEST = 12.0, 0.25
"""Pixels of a block's height below which lines give way to what they lie on, and the least opacity of a joint's."""

LEAST = 1.5
"""Pixels in width below which VTK drops a line that runs along the border of two columns of pixels."""

REFERENCE = 1000
"""Pixels of a side of an image in which lines have the widths above."""


class Painter:
    """Paints walls, one after another, with one square off-screen window whose sides have so many pixels."""

    def __init__(self, pixels: int = REFERENCE) -> None:
        self._pyvista = import_pyvista("Plotter")
        self.pixels = pixels
        self._window: Any = None

    def paint(self, shape: DeformedShape, extent: Extent) -> Image:
        """Paint a wall, ``(pixels, pixels, 3)``; the image shows the square around an extent."""
        left, right, *_ = square_around(extent)
        block = usual_side(shape.scene) * self.pixels / (right - left)
        with vtk_errors_raised():
            plotter = self._cleared()
            fill_plotter(plotter, shape, self.pixels / REFERENCE, min(block / FINE, 1.0))
            look_at(plotter, extent)
            plotter.render()  # a screenshot alone would be of what was there before
            return np.array(plotter.screenshot(return_img=True, transparent_background=False))

    def close(self) -> None:
        """Close the window."""
        if self._window is not None:
            self._window.close()
        self._window = None

    def _cleared(self) -> Any:
        if self._window is None:
            with uninterrupted_imports():
                self._window = self._pyvista.Plotter(off_screen=True, window_size=[self.pixels, self.pixels])
            self._window.enable_anti_aliasing("msaa", multi_samples=8)
            self._window.set_background("white")
        self._window.clear()
        return self._window


def square_around(extent: Extent) -> Extent:
    """The square about the middle of an extent that shows all of it."""
    left, right, bottom, top = extent
    x, y, half = (left + right) / 2, (bottom + top) / 2, max(right - left, top - bottom) / 2
    return x - half, x + half, y - half, y + half


def look_at(plotter: Any, extent: Extent) -> None:
    """Look at a part of the plane straight from above, parallel lines staying parallel."""
    left, right, bottom, top = square_around(extent)
    x, y = (left + right) / 2, (bottom + top) / 2
    camera = plotter.camera
    camera.position, camera.focal_point, camera.up = (x, y, 100.0), (x, y, 0.0), (0.0, 1.0, 0.0)
    camera.parallel_projection = True
    camera.parallel_scale = (top - bottom) / 2
    camera.clipping_range = (1.0, 200.0)


def fill_plotter(plotter: Any, shape: DeformedShape, width: float, strength: float = 1.0) -> None:
    """Put the blocks of the wall, its joints and its undeformed outline into a window, what is in front last.

    Lines are `width` times as wide as in an image of the reference's size. Those of blocks are as much thinner and
    fainter as their strength is less than 1.
    """
    flat = {"lighting": False, "show_scalar_bar": False, "reset_camera": False, "render": False}
    for ring in outline(shape.scene):
        ends = np.arange(len(ring) - 1)[:, None] + [0, 1]
        plotter.add_mesh(_lines(ring, ends, 0.0), color=OUTLINE, line_width=1.6 * width, **flat)

    wall = _polygons(shape.placed, shape.first, 1.0)
    wall.cell_data["colour"] = np.rint(255 * shape.block_colours()).astype(np.uint8)
    plotter.add_mesh(wall, scalars="colour", rgb=True, **flat)
    edges = _lines(shape.placed, shape.edges, 1.5)
    plotter.add_mesh(edges, color=EDGE, **_thin(0.8 * width, strength), **flat)

    for level, (state, colour) in enumerate(STATE_COLOURS.items()):
        own = shape.drawn_state == state
        corners, between = (shape.placed_faces[which].reshape(-1, 2) for which in (own, own & ~shape.parted))
        if len(between):
            gaps = _polygons(between, np.arange(0, len(between) + 1, 4), 2.0 + level)
            plotter.add_mesh(gaps, color=tint(state), **flat)
        if len(corners):
            faces = _lines(corners, np.arange(len(corners)).reshape(-1, 2), 2.5 + level)
            thin = _thin(WIDTHS[state] * width * strength, max(strength, FAINTEST))
            plotter.add_mesh(faces, color=colour, **thin, **flat)
    if len(shape.crosses):
        ends = shape.crossed_lines(CROSS * usual_side(shape.scene)).reshape(-1, 2)
        crosses = _lines(ends, np.arange(len(ends)).reshape(-1, 2), 8.0)
        plotter.add_mesh(crosses, color=CRUSHED, line_width=3.4 * width, **flat)


def _thin(width: float, opacity: float) -> dict[str, float]:
    """How a line of a width in pixels is drawn: one that would be lost between pixels is wider, and fainter."""
    return {"line_width": max(width, LEAST), "opacity": opacity * min(1.0, width / LEAST)}


def _polygons(points: Array, first: Indices, height: float) -> Any:
    """Polygons, one after another, at a height above the plane: what is higher is in front."""
    return _cells(points, height, faces=np.insert(np.arange(len(points)), first[:-1], np.diff(first)))


def _lines(points: Array, ends: NDArray[Any], height: float) -> Any:
    """Lines between points of the plane, at a height above it."""
    return _cells(points, height, lines=np.insert(ends, 0, 2, axis=1).ravel())


def _cells(points: Array, height: float, **cells: Any) -> Any:
    import pyvista as pv

    return pv.PolyData(np.column_stack([points, np.full(len(points), height)]), **cells)
