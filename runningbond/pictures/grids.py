"""Blocks and joints of one moment as VTK grids: what is written to files is what pictures are drawn from.

Names and units are those of docs/paraview.md, and the same at every moment.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from runningbond.results.mechanism import carried
from runningbond.scene import Array, Blocks, Indices

from .frame import Frame, Stage, State
from .vtk_imports import whole_imports

Grid: TypeAlias = Any
"""A ``vtkUnstructuredGrid``; VTK is only imported where one is made."""


@dataclass(frozen=True, eq=False)
class Grids:
    """Makes grids of the moments of one wall."""

    stage: Stage

    def blocks(self, frame: Frame) -> Grid:
        """Blocks, each a polygon, or in triangles where they deform.

        Of points: displacement [m] and velocity [m/s]. Of cells: block number, its template (congruent blocks share
        a number), its course counted from below, and whether it is held; of triangles also the stress
        (σ_x, σ_y, τ_xy) [Pa].
        """
        scene, triangles = self.stage.scene, self.stage.triangles
        blocks = scene.blocks
        velocity = carried(blocks, blocks.owner, blocks.vertices, frame.velocity)
        if triangles is None:
            of_cell = np.arange(len(blocks))
            moved = carried(blocks, blocks.owner, blocks.vertices, frame.motion)
            grid = _grid(blocks.vertices, [(POLYGON, np.arange(len(blocks.vertices)), np.diff(blocks.first))])
        else:
            of_cell, moved = triangles.block, frame.displacement
            owner = np.empty(len(triangles.points), dtype=np.int64)
            owner[triangles.corners.ravel()] = np.repeat(triangles.block, 3)
            velocity = carried(blocks, owner, triangles.points, frame.velocity)
            grid = _grid(triangles.points, [(TRIANGLE, triangles.corners.ravel(), np.full(len(of_cell), 3))])
        _add(grid.GetPointData(), displacement=_in_space(moved), velocity=_in_space(velocity))
        course, template = self._courses[of_cell], self._templates[of_cell]
        _add(grid.GetCellData(), block=of_cell, template=template, course=course, held=scene.fixed[of_cell])
        if len(frame.stress):
            _add(grid.GetCellData(), stress=frame.stress)
        _add(grid.GetFieldData(), multiplier=[frame.multiplier])
        return grid

    def joints(self, frame: Frame) -> Grid:
        """Joints, piece by piece between neighbouring points: mid-lines first, then quadrilaterals from side to side.

        Of points: displacement [m], opening and slip [m], sigma and tau [Pa], damage and state of the joint point.
        Of cells: joint number, whether it is a potential crack in a block, and the state, that of the end with the
        most to show.
        """
        scene, points = self.stage.scene, self.stage.points
        pair = self._pieces
        # Points of a piece: its mid-line's two ends, then around it, a's side along the tangent and b's back.
        at = pair[:, [0, 1, 0, 1, 1, 0]].ravel()
        n = len(pair)
        corner = 6 * np.arange(n)[:, None]
        lines, quads = corner + np.arange(2), corner + np.arange(2, 6)
        grid = _grid(points.position[at], [(LINE, lines.ravel(), np.full(n, 2)), (QUAD, quads.ravel(), np.full(n, 4))])

        jump = frame.opening[:, None] * points.normal + frame.slip[:, None] * points.tangent
        sides = self._sides(frame, jump)
        share = np.tile([0.5, 0.5, 0.0, 0.0, 1.0, 1.0], n)
        moved = sides[at] + share[:, None] * jump[at]
        _add(
            grid.GetPointData(),
            displacement=_in_space(moved),
            opening=frame.opening[at],
            slip=frame.slip[at],
            sigma=frame.normal[at],
            tau=frame.tangential[at],
            damage=frame.damage[at],
            state=frame.state[at].astype(np.uint8),
        )
        state = np.array(TELLING)[np.argsort(TELLING)[frame.state[pair]].max(axis=1, initial=0)]
        joint = points.joint[pair[:, 0]]
        cells = {"joint": joint, "inner": scene.joints.inner[joint], "state": state.astype(np.uint8)}
        _add(grid.GetCellData(), **{name: np.tile(values, 2) for name, values in cells.items()})
        _add(grid.GetFieldData(), multiplier=[frame.multiplier])
        return grid

    def _sides(self, frame: Frame, jump: Array) -> Array:
        """Displacement of block a at each joint point, ``(np, 2)`` [m].

        Of blocks that deform, the rigid parts of both sides and the jump make out what is shared evenly.
        """
        blocks, points = self.stage.scene.blocks, self.stage.points
        a, b = (carried(blocks, side, points.position, frame.motion) for side in points.block.T)
        return np.asarray((a + b - jump) / 2)

    @cached_property
    def _pieces(self) -> Indices:
        """Joint points at the two ends of each piece of a joint, ``(n, 2)``."""
        points = self.stage.points
        along = (points.position * points.tangent).sum(axis=1)
        order = np.lexsort((along, points.joint))
        first, second = order[:-1], order[1:]
        length = along[second] - along[first]
        apart = (points.joint[first] == points.joint[second]) & (length > self.stage.scene.blocks.tolerance)
        return np.column_stack([first[apart], second[apart]])

    @cached_property
    def _courses(self) -> Indices:
        """Course of each block from below, ``(nb,)``, the ground's being −1."""
        blocks, wall = self.stage.scene.blocks, self.stage.scene.wall
        course = np.full(len(blocks), -1)
        height = blocks.centroid[wall, 1]
        levels = np.sort(height)
        starts = np.diff(levels, prepend=-np.inf) > 0.1 * self.stage.scene.lowest_block
        course[wall] = np.searchsorted(levels[starts], height + blocks.tolerance) - 1
        return course

    @cached_property
    def _templates(self) -> Indices:
        """The same number for congruent blocks, ``(nb,)``."""
        return _templates(self.stage.scene.blocks)


TELLING = (State.STICK, State.FAILED, State.SLIDE, State.OPEN)
"""States, that with the most to show last."""

LINE, TRIANGLE, POLYGON, QUAD = 3, 5, 7, 9
"""VTK's numbers for kinds of cells."""


def _templates(blocks: Blocks) -> Indices:
    shape = np.rint((blocks.vertices - blocks.vertices[blocks.first[:-1]][blocks.owner]) / blocks.tolerance)
    seen: dict[bytes, int] = {}
    pieces = np.split(shape, blocks.first[1:-1])
    return np.array([seen.setdefault(piece.tobytes(), len(seen)) for piece in pieces])


def _in_space(vectors: Array) -> Array:
    """Vectors of the plane in space."""
    return np.column_stack([vectors, np.zeros(len(vectors))])


def _grid(points: Array, cells: list[tuple[int, Indices, Indices]]) -> Grid:
    """Grid of points ``(n, 2)`` and cells: their kind, their points in a row, and the number of points of each."""
    with whole_imports():
        from vtkmodules.util import numpy_support
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid

    numbers: Any = numpy_support.numpy_to_vtkIdTypeArray
    grid, places, array = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    places.SetData(_array(_in_space(points)))
    grid.SetPoints(places)
    count = np.concatenate([of_kind for _, _, of_kind in cells])
    offsets = np.concatenate([[0], np.cumsum(count, dtype=np.int64)])
    corners = np.concatenate([of_kind for _, of_kind, _ in cells]).astype(np.int64)
    array.SetData(numbers(offsets, deep=True), numbers(corners, deep=True))
    kinds = np.concatenate([np.full(len(of_kind), kind, dtype=np.uint8) for kind, _, of_kind in cells])
    grid.SetCells(_array(kinds), array)
    return grid


def _add(data: Any, **arrays: ArrayLike) -> None:
    """Add named arrays to a grid's data."""
    for name, values in arrays.items():
        added = _array(values)
        added.SetName(name)
        data.AddArray(added)


def _array(values: ArrayLike) -> Any:
    """A VTK array with a copy of some values; whole numbers take four bytes, yes and no one."""
    from vtkmodules.util import numpy_support

    array: NDArray[Any] = np.asarray(values)
    kind = np.int32 if array.dtype == np.int64 else np.uint8 if array.dtype == np.bool_ else array.dtype
    convert: Any = numpy_support.numpy_to_vtk
    return convert(np.ascontiguousarray(array, dtype=kind), deep=True)
