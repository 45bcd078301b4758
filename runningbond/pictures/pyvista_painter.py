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
"""Widths of joint lines [pixels] in an image of the reference size."""

CROSS_ARM = 0.09
"""Half the width of the cross at a crushed joint end, relative to `usual_side`."""

FINE_BLOCK, MIN_OPACITY = 12.0, 0.25
"""Side of blocks [pixels] below which lines become thinner or fainter, and the smallest opacity of joint lines."""

MIN_WIDTH = 1.5
"""Line width [pixels] below which VTK drops lines that run along the border of two columns of pixels."""

REFERENCE_SIZE = 1000
"""Side of the image [pixels] in which lines have the widths given here."""


class Painter:
    """Paints walls one after another with a single square off-screen window, whose side is given in pixels."""

    def __init__(self, pixels: int = REFERENCE_SIZE) -> None:
        self._pyvista = import_pyvista("Plotter")
        self.pixels = pixels
        self._window: Any = None

    def paint(self, shape: DeformedShape, extent: Extent) -> Image:
        """Paint a wall as an image ``(pixels, pixels, 3)``, which shows the square around an extent."""
        left, right, *_ = square_around(extent)
        block = usual_side(shape.scene) * self.pixels / (right - left)
        with vtk_errors_raised():
            plotter = self._cleared()
            fill_plotter(plotter, shape, self.pixels / REFERENCE_SIZE, min(block / FINE_BLOCK, 1.0))
            look_at(plotter, extent)
            plotter.render()  # a screenshot alone would show the previous content
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
    """Smallest square that contains an extent and has the same centre."""
    left, right, bottom, top = extent
    x, y, half = (left + right) / 2, (bottom + top) / 2, max(right - left, top - bottom) / 2
    return x - half, x + half, y - half, y + half


def look_at(plotter: Any, extent: Extent) -> None:
    """Look at a part of the plane straight from above, in parallel projection."""
    left, right, bottom, top = square_around(extent)
    x, y = (left + right) / 2, (bottom + top) / 2
    camera = plotter.camera
    camera.position, camera.focal_point, camera.up = (x, y, 100.0), (x, y, 0.0), (0.0, 1.0, 0.0)
    camera.parallel_projection = True
    camera.parallel_scale = (top - bottom) / 2
    camera.clipping_range = (1.0, 200.0)


def fill_plotter(plotter: Any, shape: DeformedShape, width: float, strength: float = 1.0) -> None:
    """Add the undeformed outline of a wall, its blocks and its joints to a window, from back to front.

    Lines are `width` times as wide as in an image of the reference size. A `strength` below 1 makes the edges of blocks
    fainter, and the lines of joints thinner and fainter.
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
            thin = _thin(WIDTHS[state] * width * strength, max(strength, MIN_OPACITY))
            plotter.add_mesh(faces, color=colour, **thin, **flat)
    if len(shape.crosses):
        ends = shape.crossed_lines(CROSS_ARM * usual_side(shape.scene)).reshape(-1, 2)
        crosses = _lines(ends, np.arange(len(ends)).reshape(-1, 2), 8.0)
        plotter.add_mesh(crosses, color=CRUSHED, line_width=3.4 * width, **flat)


def _thin(width: float, opacity: float) -> dict[str, float]:
    """Style of a line with a given width in pixels; lines too thin to be rendered are made wider and fainter."""
    return {"line_width": max(width, MIN_WIDTH), "opacity": opacity * min(1.0, width / MIN_WIDTH)}


def _polygons(points: Array, first: Indices, height: float) -> Any:
    """Consecutive polygons at a height above the plane; higher ones are in front."""
    return _cells(points, height, faces=np.insert(np.arange(len(points)), first[:-1], np.diff(first)))


def _lines(points: Array, ends: NDArray[Any], height: float) -> Any:
    """Lines between points of the plane, at a height above it."""
    return _cells(points, height, lines=np.insert(ends, 0, 2, axis=1).ravel())


def _cells(points: Array, height: float, **cells: Any) -> Any:
    import pyvista as pv

    return pv.PolyData(np.column_stack([points, np.full(len(points), height)]), **cells)
