"""Blocks and joints painted by PyVista: an image, and the part of the plane that it shows."""

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from runningbond.scene import Array, Indices, Scene

from .frame import State
from .grids import QUAD, Grid
from .vtk_imports import import_pyvista, whole_imports
from .vtk_messages import vtk_errors_raised

Colouring: TypeAlias = Literal["displacement", "course"]
Image: TypeAlias = NDArray[np.uint8]

STILL, FAST = (0.955, 0.945, 0.925), (0.50, 0.66, 0.84)
"""Colours of a block at rest, and of the one that moves fastest."""

COURSES = ((0.93, 0.90, 0.85), (0.80, 0.86, 0.93))
"""Colours of alternate courses."""

HELD = (0.72, 0.72, 0.72)
EDGE, OUTLINE = (0.52, 0.52, 0.52), (0.45, 0.45, 0.45)

STATE_COLOURS: dict[State, str] = {
    State.SLIDE: "#009e73",
    State.OPEN: "#d55e00",
    State.FAILED: "#000000",
}
"""From the palette of Okabe and Ito (2008), which colour-blind readers tell apart."""

WIDTHS = {State.SLIDE: 3.0, State.OPEN: 3.4, State.FAILED: 3.0}
"""Widths of the joints' lines, in pixels of an image of the reference's size."""

FINE, FAINTEST = 12.0, 0.25
"""Pixels of a block's height below which lines give way to what they lie on, and the least opacity of a joint's."""

DRAWN = 0.12
"""How far the fastest corner is drawn to move, in sizes of the wall."""

REFERENCE = 1000
"""Pixels of the longer side of an image in which lines have the widths above."""


@dataclass(frozen=True)
class View:
    """A part of the plane, left, right, bottom and top [m], and the pixels of the longer side of its image."""

    left: float
    right: float
    bottom: float
    top: float
    pixels: int = REFERENCE

    @property
    def longer(self) -> float:
        """Longer side [m]."""
        return max(self.right - self.left, self.top - self.bottom)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the image, in pixels: even ones, so that a square image can be cut to them."""
        width, height = self.right - self.left, self.top - self.bottom
        return round(self.pixels / 2 * width / self.longer) * 2, round(self.pixels / 2 * height / self.longer) * 2

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """The part of the plane that the image shows, to the pixel, as matplotlib wants it."""
        x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
        half_width, half_height = (n / self.pixels * self.longer / 2 for n in self.size)
        return x - half_width, x + half_width, y - half_height, y + half_height


@dataclass(frozen=True, eq=False)
class Cells:
    """Polygons that make up the wall, of a grid of blocks, after some factor times their displacement.

    Parameters
    ----------
    points : (n, 2) float
        Points of the grid, displaced [m].
    corners : (m,) int
        Points of one cell after another, counter-clockwise.
    first : (nc + 1,) int
        Where each cell's corners start.
    data : dict of (nc, …) arrays
        Data of the cells.
    distance : (nc,) float
        How far each has moved, its corners' mean, without the factor [m].
    farthest : float
        How far the corner has moved that has moved farthest, without the factor [m].
    """

    points: Array
    corners: Indices
    first: Indices
    data: dict[str, NDArray[Any]]
    distance: Array
    farthest: float

    @classmethod
    def of_wall(cls, scene: Scene, blocks: Grid, scale: float) -> "Cells":
        """All cells but the ground's."""
        import pyvista as pv

        grid = pv.wrap(blocks)
        of_wall = scene.wall[grid.cell_data["block"]]
        count = np.diff(grid.cell_offsets)
        corners = np.asarray(grid.cell_connectivity)[np.repeat(of_wall, count)]
        first = np.concatenate([[0], np.cumsum(count[of_wall])])
        data = {name: np.asarray(values)[of_wall] for name, values in grid.cell_data.items()}
        displacement = np.asarray(grid.point_data["displacement"])[:, :2]
        moved = np.hypot(*displacement[corners].T)
        mean = np.add.reduceat(moved, first[:-1]) / count[of_wall]
        return cls(
            np.asarray(grid.points)[:, :2] + scale * displacement, corners, first, data, mean, float(moved.max())
        )

    @property
    def edges(self) -> Indices:
        """Points at the ends of every block's edges, ``(m, 2)``: those that no two of its triangles share."""
        following = np.roll(self.corners, -1)
        following[self.first[1:] - 1] = self.corners[self.first[:-1]]
        ends = np.sort(np.column_stack([self.corners, following]), axis=1)
        _, index, count = np.unique(ends @ [len(self.points), 1], return_index=True, return_counts=True)
        return np.asarray(ends[index[count == 1]])


def wall_size(scene: Scene) -> float:
    """Size of a wall: the root of its length times its height [m]."""
    low, high = scene.blocks.extent(scene.wall)
    return float(np.sqrt(np.prod(high - low)))


def wall_view(scene: Scene, blocks: Grid, scale: float, pixels: int = REFERENCE) -> View:
    """What shows the whole wall before and after, with a little air around it."""
    cells = Cells.of_wall(scene, blocks, scale)
    both = np.concatenate([scene.blocks.vertices[scene.wall[scene.blocks.owner]], cells.points[cells.corners]])
    (left, bottom), (right, top) = both.min(axis=0), both.max(axis=0)
    air = 0.03 * max(right - left, top - bottom)
    return View(left - air, right + air, bottom - air, top + air, pixels)


class Painter:
    """Paints walls, one after another, with one square off-screen window, cut to what is to be seen.

    Parameters
    ----------
    pixels
        Sides of the window; an even number.
    """

    def __init__(self, pixels: int = REFERENCE) -> None:
        import_pyvista()
        self.pixels = pixels
        self._window: Any = None

    def paint(
        self,
        scene: Scene,
        blocks: Grid,
        joints: Grid,
        view: View,
        scale: float,
        colouring: Colouring = "displacement",
    ) -> Image:
        """Paint one moment.

        Parameters
        ----------
        scene
            The wall.
        blocks, joints
            Grids of the moment.
        view
            What is to be seen, in as many pixels as the window has.
        scale
            Factor of displacements.
        colouring
            Blocks by how far they have moved, or by course.

        Returns
        -------
        (height, width, 3) uint8
        """
        with vtk_errors_raised():
            plotter = self._cleared()
            block = scene.lowest_block * view.pixels / view.longer
            fill_plotter(
                plotter, scene, blocks, joints, scale, colouring, self.pixels / REFERENCE, min(block / FINE, 1.0)
            )
            look_at(plotter, view)
            plotter.render()  # a screenshot alone would be of what was there before
            square = np.array(plotter.screenshot(return_img=True, transparent_background=False))
        width, height = view.size
        right, down = (self.pixels - width) // 2, (self.pixels - height) // 2
        return square[down : down + height, right : right + width]

    def close(self) -> None:
        """Close the window."""
        if self._window is not None:
            self._window.close()
        self._window = None

    def _cleared(self) -> Any:
        import pyvista as pv

        if self._window is None:
            with whole_imports():
                self._window = pv.Plotter(off_screen=True, window_size=[self.pixels, self.pixels])
            self._window.enable_anti_aliasing("msaa", multi_samples=8)
            self._window.set_background("white")
        self._window.clear()
        return self._window


def look_at(plotter: Any, view: View) -> None:
    """Look at a part of the plane straight from above, parallel lines staying parallel."""
    x, y = (view.left + view.right) / 2, (view.bottom + view.top) / 2
    camera = plotter.camera
    camera.position, camera.focal_point, camera.up = (x, y, 100.0), (x, y, 0.0), (0.0, 1.0, 0.0)
    camera.parallel_projection = True
    camera.parallel_scale = view.longer / 2
    camera.clipping_range = (1.0, 200.0)


def fill_plotter(
    plotter: Any,
    scene: Scene,
    blocks: Grid,
    joints: Grid,
    scale: float,
    colouring: Colouring,
    width: float,
    strength: float = 1.0,
) -> None:
    """Put the blocks of the wall, its joints and its undeformed outline into a window, what is in front last.

    Lines are `width` times as wide as in an image of the reference's size. Those of blocks are as much thinner and
    fainter as their strength is less than 1.
    """
    import pyvista as pv

    flat = {"lighting": False, "show_scalar_bar": False, "reset_camera": False, "render": False}
    points, rings = outline(scene)
    plotter.add_mesh(_lines(points, rings, 0.0), color=OUTLINE, line_width=1.6 * width, **flat)

    cells = Cells.of_wall(scene, blocks, scale)
    wall = _polygons(cells.points, cells.corners, cells.first, 1.0)
    wall.cell_data["colour"] = block_colours(cells, colouring, DRAWN * wall_size(scene) / scale)
    plotter.add_mesh(wall, scalars="colour", rgb=True, **flat)
    edges = _lines(cells.points, cells.edges, 1.5)
    plotter.add_mesh(edges, color=EDGE, line_width=0.8 * width, opacity=strength, **flat)

    pieces = pv.wrap(joints)
    at = np.asarray(pieces.points)[:, :2] + scale * np.asarray(pieces.point_data["displacement"])[:, :2]
    quads = pieces.celltypes == QUAD
    corners, state = pieces.cells_dict[QUAD], pieces.cell_data["state"][quads]
    for level, (kind, colour) in enumerate(STATE_COLOURS.items()):
        those = corners[state == kind]
        if len(those):
            gaps = _polygons(at, those.ravel(), 4 * np.arange(len(those) + 1), 2.0 + level)
            faces = _lines(at, np.concatenate([those[:, :2], those[:, 2:]]), 2.5 + level)
            plotter.add_mesh(gaps, color=tint(colour), **flat)
            thin = {"line_width": WIDTHS[kind] * width * strength, "opacity": max(strength, FAINTEST)}
            plotter.add_mesh(faces, color=colour, **thin, **flat)


def tint(colour: str) -> tuple[float, float, float]:
    """A light shade of a colour ``#rrggbb``."""
    red, green, blue = (1 - 0.45 * (1 - int(colour[i : i + 2], 16) / 255) for i in (1, 3, 5))
    return red, green, blue


def block_colours(cells: Cells, colouring: Colouring, far: float) -> Image:
    """Colour of each cell, ``(nc, 3)``; what has moved by a distance `far` [m] or more has that of the fastest."""
    if colouring == "course":
        colours = np.array(COURSES)[cells.data["course"] % len(COURSES)]
    else:
        share = np.minimum(cells.distance / far, 1.0)
        colours = np.array(STILL) + share[:, None] * (np.array(FAST) - STILL)
    colours[cells.data["held"] > 0] = HELD
    return np.asarray(np.rint(255 * colours), dtype=np.uint8)


def outline(scene: Scene) -> tuple[Array, Indices]:
    """Outline of the undeformed wall, openings and all: points ``(n, 2)`` [m] and the ends of its lines ``(m, 2)``."""
    import shapely

    blocks = scene.blocks
    polygons = [shapely.Polygon(blocks.polygon(int(i))) for i in np.flatnonzero(scene.wall)]
    # What touches in the scene may be as far apart as the tolerance.
    whole = shapely.union_all(shapely.buffer(polygons, blocks.tolerance, join_style="mitre"))
    rings = [np.asarray(ring.coords) for part in shapely.get_parts(whole) for ring in (part.exterior, *part.interiors)]
    last = np.cumsum([len(ring) for ring in rings])
    start = np.setdiff1d(np.arange(last[-1]), last - 1)
    return np.concatenate(rings), np.column_stack([start, start + 1])


def _polygons(points: Array, corners: Indices, first: Indices, height: float) -> Any:
    """Polygons between points of the plane, at a height above it: what is higher is in front."""
    import pyvista as pv

    faces = np.insert(corners, first[:-1], np.diff(first))
    return pv.PolyData(_at(points, height), faces=faces)


def _lines(points: Array, ends: Indices, height: float) -> Any:
    """Lines between points of the plane, at a height above it."""
    import pyvista as pv

    return pv.PolyData(_at(points, height), lines=np.insert(ends, 0, 2, axis=1).ravel())


def _at(points: Array, height: float) -> Array:
    return np.column_stack([points, np.full(len(points), height)])
