"""Blocks and joints of one frame as VTK grids, and back: films are drawn from the same grids that are written to files.

Names and units are those in docs/paraview.md, the same in every frame.
"""

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from runningbond.contacts.search import ContactForces
from runningbond.results.mechanism import carried, rotated, turned, turned_frames
from runningbond.scene import Array, Blocks, Indices, Scene

from .deformed_shape import DeformedShape, course_numbers, crushed_ends, farthest_motion, outer_edges, series_scale
from .frame import Discretisation, Frame
from .joint_state import joint_states
from .vtk_safety import import_pyvista

Grid: TypeAlias = Any
"""A ``pyvista.UnstructuredGrid``; PyVista is imported only where a grid is made."""

DISPLACEMENT = "displacement [m]"
"""Array of both grids with the vectors by which they are warped."""

SECONDS = "time [s]"
"""Field of both grids with the time under a ground motion."""

GROUND_MARGIN = 0.15
"""Distance around a wall up to which the ground is shown, relative to `Scene.size`."""

VERTEX, LINE, TRIANGLE, POLYGON, QUAD = 1, 3, 5, 7, 9
"""VTK's numbers of cell types."""


class GridBuilder:
    """Builds grids from the frames of one wall."""

    def __init__(self, discretisation: Discretisation) -> None:
        self._scene, self._points = discretisation.scene, discretisation.points
        self._triangles = discretisation.triangles
        self._courses, self._templates = course_numbers(self._scene), _templates(self._scene.blocks)
        (left, low), (right, high) = self._scene.blocks.extent(self._scene.wall)
        air = GROUND_MARGIN * self._scene.size
        self._around = (left - air, low - air), (right + air, high + air)

    def blocks(self, frame: Frame) -> Grid:
        """Grid of the blocks, as polygons or, if they deform, as triangles, with the arrays of ``blocks.pvd``."""
        blocks, triangles = self._scene.blocks, self._triangles
        if triangles is None:
            block, owner = np.arange(len(blocks)), blocks.owner
            points = self._near(blocks.vertices, owner)
            displacement = _moved(blocks, owner, points, frame)
            grid = _grid(points, [(POLYGON, np.arange(len(points)), np.diff(blocks.first))])
        else:
            block, owner = triangles.block, np.empty(len(triangles.points), dtype=np.int64)
            owner[triangles.corners.ravel()] = np.repeat(block, 3)
            points = self._near(triangles.points, owner)
            # The ground is rigid and shown up to other points than its nodes, which may move differently if it turns.
            deforms, rigid = self._scene.wall[owner], _moved(blocks, owner, points, frame)
            displacement = np.where(deforms[:, None], frame.displacement, rigid)
            grid = _grid(points, [(TRIANGLE, triangles.corners.ravel(), np.full(len(block), 3))])
        velocity = carried(blocks, owner, points, frame.velocity)
        if frame.finite:  # lever arms refer to the displaced position
            spin, from_centre = frame.velocity[owner, 2:], displacement - frame.motion[owner, :2]
            velocity += spin * np.column_stack([-from_centre[:, 1], from_centre[:, 0]])
        _add(grid.point_data, {DISPLACEMENT: _in_space(displacement), "velocity [m/s]": _in_space(velocity)})
        course, template, held = self._courses[block], self._templates[block], self._scene.fixed[block]
        _add(grid.cell_data, {"block": block, "template": template, "course": course, "held": held.astype(np.uint8)})
        if len(frame.stress):
            _add(grid.cell_data, _tensors(frame.stress))
        _add(grid.field_data, _moment(frame))
        return grid

    def _near(self, points: Array, owner: Indices) -> Array:
        """Points ``(n, 2)`` of blocks ``(n,)``, with those of the ground clipped to the surroundings of the wall."""
        return np.where(self._scene.wall[owner][:, None], points, np.clip(points, *self._around))

    def joints(self, frame: Frame) -> Grid:
        """Grid of the joints in pieces between neighbouring points, with the arrays of ``joints.pvd``.

        Mid-lines come first, then quadrilaterals between the two sides, then the points of new contacts.
        """
        points, pair, new = self._points, self._pieces(frame.finite), frame.new_contacts
        # Points of a piece: both ends of its mid-line, then the quadrilateral, along side a and back along side b.
        at = pair[:, [0, 1, 0, 1, 1, 0]].ravel()
        n, m = len(pair), len(new)
        corner = 6 * np.arange(n)[:, None]
        lines, quads = corner + np.arange(2), corner + np.arange(2, 6)
        met = _on_block_a(self._scene.blocks, new, frame.motion)
        grid = _grid(
            np.concatenate([points.position[at], met]),
            [
                (LINE, lines.ravel(), np.full(n, 2)),
                (QUAD, quads.ravel(), np.full(n, 4)),
                (VERTEX, 6 * n + np.arange(m), np.ones(m, dtype=np.int64)),
            ],
        )
        known = {DISPLACEMENT: _in_space(new.place - met), "force [N]": _in_space(new.force)}
        for name, values in self._at_pieces(frame, pair, at).items():
            others = known.get(name, np.zeros((m, *values.shape[1:]), dtype=values.dtype))
            _add(grid.point_data, {name: np.concatenate([values, others])})
        piece, none = np.tile(pair[:, 0], 2), np.zeros(m, dtype=np.uint8)
        joint, block = points.joint[piece], np.concatenate([points.block[piece], new.block])
        inner = np.append(self._scene.joints.inner[joint].astype(np.uint8), none)
        state = np.append(np.tile(joint_states(frame.state[pair]), 2).astype(np.uint8), none)
        _add(grid.cell_data, {"joint": np.append(joint, np.full(m, -1)), "inner": inner, "state": state})
        _add(grid.cell_data, {"block a": block[:, 0], "block b": block[:, 1]})
        _add(grid.field_data, _moment(frame))
        return grid

    def _at_pieces(self, frame: Frame, pair: Indices, at: Indices) -> dict[str, Any]:
        """Arrays of the points of pieces, six to a piece, from the joint points there ``(n,)``."""
        points, n = self._points, len(pair)
        still = points.normal, points.tangent
        normal, tangent = turned_frames(points, frame.motion) if frame.finite else still
        jump = frame.opening[:, None] * normal + frame.slip[:, None] * tangent
        traction = frame.normal[:, None] * normal + frame.tangential[:, None] * tangent
        if len(frame.traction):
            traction = frame.traction
        a, b = self._sides(frame)
        share = np.tile([0.5, 0.5, 0.0, 0.0, 1.0, 1.0], n)[:, None]
        # Pieces that meet at a point share its area. Only mid-lines carry it, or sums would count it three times.
        area = (points.area / np.maximum(np.bincount(pair.ravel(), minlength=len(points)), 1))[at]
        area = area * np.tile([1.0, 1.0, 0.0, 0.0, 0.0, 0.0], n)
        return {
            DISPLACEMENT: _in_space(a[at] + share * (b - a)[at]),
            "normal": _in_space(normal[at]),
            "jump [m]": _in_space(jump[at]),
            "opening [m]": frame.opening[at],
            "slip [m]": frame.slip[at],
            "traction [Pa]": _in_space(traction[at]),
            "force [N]": _in_space(area[:, None] * traction[at]),
            "normal stress [Pa]": frame.normal[at],
            "shear stress [Pa]": frame.tangential[at],
            "damage": frame.damage[at],
            "state": frame.state[at].astype(np.uint8),
        }

    def _sides(self, frame: Frame) -> Array:
        """Displacements of the joint points on sides a and b in a frame, ``(2, np, 2)`` [m]."""
        if len(frame.sides):
            return frame.sides
        points = self._points
        return np.array([_moved(self._scene.blocks, side, points.position, frame) for side in points.block.T])

    def _pieces(self, finite: bool) -> Indices:
        """Joint points at the two ends of each piece of a joint, ``(n, 2)``."""
        points = self._points
        along = (points.position * points.tangent).sum(axis=1)
        order = np.lexsort((along, points.joint))
        first, second = order[:-1], order[1:]
        # Elements of a joint share the place where they meet. If displacements are finite, corners are new contacts.
        single = self._scene.joints.at_corner[points.joint[first]] & (not finite)
        apart = (along[second] - along[first] > self._scene.blocks.tolerance) | single
        apart &= points.joint[first] == points.joint[second]
        return np.column_stack([first[apart], second[apart]])


def shape_of_grids(scene: Scene, blocks: Grid, joints: Grid) -> DeformedShape:
    """Deformed shape contained in the two grids of a wall, with displacements scaled to be visible."""
    own = scene.wall[blocks.cell_data["block"]]
    count = np.diff(blocks.cell_offsets)
    corner = np.asarray(blocks.cell_connectivity)[np.repeat(own, count)]
    first = np.concatenate([[0], np.cumsum(count[own])])
    displacement = np.asarray(blocks.point_data[DISPLACEMENT])[corner, :2]
    quads = joints.celltypes == QUAD
    corners = joints.cells_dict[QUAD]
    return DeformedShape(
        scene,
        np.asarray(blocks.points)[corner, :2],
        displacement,
        first,
        np.asarray(blocks.cell_data["block"])[own],
        outer_edges(corner, first),
        np.asarray(joints.points)[corners, :2],
        np.asarray(joints.point_data[DISPLACEMENT])[corners, :2],
        np.asarray(joints.cell_data["state"])[quads],
        float(blocks.field_data["multiplier"][0]),
        series_scale(scene.size, farthest_motion(displacement)),
        motion=_motion_of_supports(scene, blocks) if scene.settlement else np.zeros((0, 3)),
        crushed=crushed_ends(np.asarray(joints.point_data["state"])[corners[:, :2]]),
        time=float(blocks.field_data[SECONDS][0]) if SECONDS in blocks.field_data else None,
    )


def _motion_of_supports(scene: Scene, blocks: Grid) -> Array:
    """Motion ``(nb, 3)`` of the supports in a grid of `GridBuilder.blocks`: the scene's times the share reached."""
    corner, count = np.asarray(blocks.cell_connectivity), np.diff(blocks.cell_offsets)
    block, points = np.repeat(blocks.cell_data["block"], count), np.asarray(blocks.points)[corner, :2]
    whole = carried(scene.blocks, block, points, scene.support_motion)
    moved = np.asarray(blocks.point_data[DISPLACEMENT])[corner, :2]
    return np.asarray((whole * moved).sum() / (whole**2).sum() * scene.support_motion)


def _moved(blocks: Blocks, block: Indices, at: Array, frame: Frame) -> Array:
    """Displacements ``(n, 2)`` [m] of points on rigid blocks in a frame."""
    return (turned if frame.finite else carried)(blocks, block, at, frame.motion)


def _on_block_a(blocks: Blocks, contacts: ContactForces, motion: Array) -> Array:
    """Points ``(n, 2)`` [m] of the undeformed block a that a motion ``(nb, 3)`` brings to the places of contacts."""
    centroid, (u, v, spin) = blocks.centroid[contacts.block[:, 0]], motion[contacts.block[:, 0]].T
    return centroid + rotated(contacts.place - centroid - np.column_stack([u, v]), -spin)


def _templates(blocks: Blocks) -> Indices:
    """Template number of each block, ``(nb,)``, the same for congruent blocks."""
    shape = np.rint((blocks.vertices - blocks.vertices[blocks.first[:-1]][blocks.owner]) / blocks.tolerance)
    seen: dict[bytes, int] = {}
    pieces = np.split(shape, blocks.first[1:-1])
    return np.array([seen.setdefault(piece.tobytes(), len(seen)) for piece in pieces])


def _tensors(stress: Array) -> dict[str, Array]:
    """Stresses ``(n, 3)`` as VTK's symmetric tensors (xx, yy, zz, xy, yz, xz), and the in-plane principal stresses."""
    x, y, shear = stress.T
    none, middle, radius = np.zeros(len(stress)), (x + y) / 2, np.hypot((x - y) / 2, shear)
    tensor = np.column_stack([x, y, none, shear, none, none])
    return {
        "stress [Pa]": tensor,
        "largest principal stress [Pa]": middle + radius,
        "smallest principal stress [Pa]": middle - radius,
    }


def _moment(frame: Frame) -> dict[str, ArrayLike]:
    """Load of a frame and, under a ground motion, its time."""
    moment = {"multiplier": frame.multiplier} | ({} if frame.time is None else {SECONDS: frame.time})
    return {name: [value] for name, value in moment.items()}


def _in_space(vectors: Array) -> Array:
    """Extend vectors of the plane to three components."""
    return np.column_stack([vectors, np.zeros(len(vectors))])


def _grid(points: Array, cells: list[tuple[int, Indices, Indices]]) -> Grid:
    """Grid of points ``(n, 2)`` and cells, given by type, concatenated point indices, and points per cell."""
    pv = import_pyvista("UnstructuredGrid")
    kinds, corners, counts = zip(*cells, strict=True)
    count = np.concatenate(counts)
    first = np.concatenate([[0], np.cumsum(count)])
    connectivity = np.insert(np.concatenate(corners), first[:-1], count)
    types = np.repeat(kinds, [len(of_kind) for of_kind in counts])
    return pv.UnstructuredGrid(connectivity, types.astype(np.uint8), _in_space(points))


def _add(data: Any, arrays: Mapping[str, ArrayLike]) -> None:
    """Add named arrays to a grid's data; integers are stored in four bytes."""
    for name, values in arrays.items():
        array = np.asarray(values)
        data[name] = array.astype(np.int32) if array.dtype == np.int64 else array
