"""Outlines of deformable blocks: their sides as polygons of mesh nodes, and points along the sides.

Contacts are at these points, which are the nodes and, if the pressure distribution along joints matters, others
between the nodes.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runningbond.contacts.materials import ContactMaterials
from runningbond.contacts.outline import Outline
from runningbond.dynamics.displacements import check_finite
from runningbond.joints.points import Rule, lobatto
from runningbond.joints.wall_points import spread_rule, spreads
from runningbond.scene import Array, Indices, Mask, Scene

from .block_kernels import NodalTables, nodal_tables
from .deformable_sides import OutlineNodes, SidePoints, Sides
from .modal_wall import ModalWall, modal_wall
from .modes import ModeCount
from .templates import nodes_of

HALFWAY = 0.5 + 1e-6
"""Part of the distance to the next point by which a point must be inside the corners' arcs to carry load: one half,
plus a margin for rounding."""


@dataclass(frozen=True, eq=False)
class NodeOutline:
    """Blocks with modes whose sides are polygons of mesh nodes.

    Outline nodes are numbered side after side, sides as the corners that they start from; each node starts a facet.

    Parameters
    ----------
    wall
        The blocks in modal coordinates.
    outline
        The blocks' undeformed outlines.
    node : (no,) int
        Mesh node of each outline node.
    row : (no,) int
        Row of each outline node in the table of its block's template; −1 in fixed blocks.
    first : (nv + 1,) int
        First outline node of each side, then the number of outline nodes.
    nodes, points, sides
        The outline nodes, the points along the sides, and the sides, in the form that the kernels use.
    parts : int
        Number of points on each facet.
    gap : (ns,) float
        Distance from each point to the next one of its side, from and to the arcs at the side's ends [m].
    tables : list of (n, 2, m) float
        For each template, the displacements of its outline nodes per deformation mode.
    """

    wall: ModalWall
    outline: Outline
    node: Indices
    row: Indices
    first: Indices
    nodes: OutlineNodes
    points: SidePoints
    sides: Sides
    parts: int
    gap: Array
    tables: list[Array]

    @property
    def scene(self) -> Scene:
        """The wall."""
        return self.wall.scene

    @cached_property
    def places(self) -> tuple[Indices, Array]:
        """Side of each point, and its distance from the start of that side [m], two ``(ns,)``."""
        facet, share, _ = self.points
        side = np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))[facet]
        return side, self.nodes.begin[facet] + share * self.nodes.length[facet]

    @cached_property
    def bearing(self) -> Mask:
        """Which points are half-way to the next one (`HALFWAY`) inside the arcs of their side's corners, ``(ns,)``."""
        side, along = self.places
        near_end, far_end = self.sides.inset[self.sides.ends].T
        inside = np.minimum(along - near_end[side], self.sides.extent[side] - far_end[side] - along)
        return np.asarray(inside > 2 * HALFWAY * self.points.half)

    def rigid(self, motion: Array) -> Array:
        """Translations and rotation of each block in a motion ``(nd,)``, ``(3 nb,)``."""
        return np.ascontiguousarray(motion[self.wall.rigid]).ravel()

    def positions(self, motion: Array) -> Array:
        """Positions of the mesh nodes after a motion ``(nd,)``, ``(nn, 2)`` [m]."""
        mesh, deformed = self.wall.mesh, motion.copy()
        deformed[self.wall.rigid] = 0.0
        arm = mesh.points - self.scene.blocks.centroid[mesh.block] + self.wall.displacement(deformed)
        return self.placed(mesh.block, arm, motion)

    def placed(self, block: Indices, arm: Array, motion: Array) -> Array:
        """Positions of points of blocks ``(n,)`` after a motion ``(nd,)``, ``(n, 2)`` [m].

        The arms ``(n, 2)`` [m] of the points start at the blocks' centroids and are in the blocks' frames.
        """
        cosine, sine, x, y = self.outline.placed(self.rigid(motion)).blocks[:, block]
        px, py = arm.T
        return np.column_stack([x + cosine * px - sine * py, y + sine * px + cosine * py])

    def new_tables(self) -> NodalTables:
        """Displacements of the outline nodes per deformation mode, with new buffers."""
        wall, rows = self.wall, []
        _, first = _places(wall, self.nodes.owner, self.row, self.tables)
        for template, coordinate, at, table in zip(wall.templates, wall.first, first, self.tables, strict=False):
            n, (points, _, modes) = len(template.blocks), table.shape
            if modes:
                flat = table.reshape(2 * points, modes)
                rows.append(((n, modes, 2 * points, int(coordinate) + 3 * n, int(at)), flat))
        return nodal_tables(rows, int(first[-1]), 1)


def node_outline(scene: Scene, cells: int = 1, modes: ModeCount | None = None) -> NodeOutline:
    """Mesh a scene for finite displacements.

    Raises
    ------
    SceneError
        As raised by `check_finite`, `ContactMaterials` and `Outline.of`.
    """
    check_finite(scene)
    ContactMaterials(scene)
    rule = spread_rule(cells) if spreads(scene, finite=True) else lobatto()
    scene = scene.without_corner_contacts()
    wall, outline = modal_wall(scene, cells, modes, rule), Outline.of(scene)
    on_side = list(_nodes_of_sides(wall))
    node, first = np.concatenate(on_side), np.cumsum([0, *map(len, on_side)])
    row, tables = _tables(wall, node)
    nodes = _outline_nodes(wall, node, first, _places(wall, wall.mesh.block[node], row, tables)[0])
    sides = _sides(outline, first, nodes.length)
    points, gap = _points(rule, nodes.length, sides)
    return NodeOutline(wall, outline, node, row, first, nodes, points, sides, len(rule.nodes) - 1, gap, tables)


def _outline_nodes(wall: ModalWall, node: Indices, first: Indices, place: Indices) -> OutlineNodes:
    blocks, position = wall.scene.blocks, wall.mesh.points[node]
    side = np.repeat(np.arange(len(first) - 1), np.diff(first))
    owner = blocks.owner[side]
    following = np.arange(1, first[-1] + 1)
    following[first[1:] - 1] = first[blocks.successor]
    length = np.hypot(*(position[following] - position).T)
    total = np.cumsum(length) - length
    return OutlineNodes(
        wall.rigid.astype(np.int64),
        blocks.centroid.copy(),
        owner.astype(np.int64),
        position - blocks.centroid[owner],
        place,
        following,
        total - total[first[:-1]][side],
        length,
    )


def _points(rule: Rule, length: Array, sides: Sides) -> tuple[SidePoints, Array]:
    """Points of a rule along facets with lengths ``(no,)`` [m], and the `NodeOutline.gap` between them.

    As on joint elements, the rule begins and ends where the arcs of the side's corners do, if these leave some of the
    facet. The end of a facet is the start of the next one.
    """
    arcs = np.zeros((2, len(length)))
    for end in (0, 1):
        arcs[end, sides.outer[:, end]] = np.maximum(0.0, sides.inset[sides.ends[:, end]])
    arcs *= arcs.sum(axis=0) < length
    place = arcs[0][:, None] + np.outer(length - arcs.sum(axis=0), (rule.nodes + 1) / 2)
    gap, parts = np.diff(place).ravel(), len(rule.nodes) - 1
    place[:, 0] = 0.0
    share = (place[:, :-1] / length[:, None]).ravel()
    return SidePoints(np.repeat(np.arange(len(length)), parts), share, np.minimum(gap, np.roll(gap, 1)) / 2), gap


def _sides(outline: Outline, first: Indices, length: Array) -> Sides:
    """The sides, from the first outline node of each side and the lengths of the facets [m]."""
    inset = np.where(outline.radius > 0, outline.radius * np.tan(outline.exterior / 2), 0.0)
    at_end = outline.ends >= len(outline.length)
    inset[outline.ends[at_end]] = -outline.run_on[at_end]
    outer = np.column_stack([first[:-1], first[1:] - 1])
    shares = inset[outline.ends] * [1.0, -1.0] / length[outer] + [0.0, 1.0]
    extent = outline.straight + inset[outline.ends].sum(axis=1)
    return Sides(outer, shares, extent, outline.straight.copy(), outline.ends.copy(), inset, outline.radius.copy())


def _tables(wall: ModalWall, node: Indices) -> tuple[Indices, list[Array]]:
    """Row of each outline node in the table of its block's template, ``(no,)``, and the tables.

    Nodes of fixed blocks have no row.
    """
    mesh, row, tables = wall.mesh, np.full(len(node), -1), []
    block = mesh.block[node]
    local = node - mesh.first_node[block]
    for number, template in enumerate(wall.templates):
        own = np.flatnonzero(wall.place[block, 0] == number)
        chosen, row[own] = np.unique(local[own], return_inverse=True)
        shape = template.modes.shape.reshape(-1, 2, len(template.modes.mass))
        tables.append(shape[chosen, :, 3:])
    return row, tables


def _places(wall: ModalWall, owner: Indices, row: Indices, tables: list[Array]) -> tuple[Indices, Indices]:
    """Indices of outline nodes' displacements as in `ModalWall.places`; blocks that do not deform have none."""
    counts = [len(table) if table.size else 0 for table in tables]
    deforms = np.append(np.array(counts) > 0, False)[wall.place[owner, 0]]  # -1, for fixed blocks, is the last entry
    return wall.places(owner, np.where(deforms, row, -1), counts)


def _nodes_of_sides(wall: ModalWall) -> Iterator[Indices]:
    """Nodes of each side, from its first corner to the node before its last corner."""
    blocks, mesh = wall.scene.blocks, wall.mesh
    seen: dict[tuple[int, bytes], list[Indices]] = {}
    for block in range(len(blocks)):
        own = nodes_of(mesh, block)
        corners = blocks.vertices[blocks.first[block] : blocks.first[block + 1]]
        likeness = np.rint((corners - mesh.points[own.start]) / blocks.tolerance).astype(np.int64).tobytes()
        key = int(mesh.shape[block]), likeness
        if key not in seen:
            seen[key] = [
                _nodes_between(mesh.points[own], start, stop, blocks.tolerance)
                for start, stop in zip(corners, np.roll(corners, -1, axis=0), strict=True)
            ]
        yield from (own.start + local for local in seen[key])


def _nodes_between(points: Array, start: Array, stop: Array, tolerance: float) -> Indices:
    """Points on a straight line, ordered from its start to its stop, without the stop."""
    run = stop - start
    length = np.hypot(*run)
    along, off = (points - start) @ run / length, (points - start) @ [run[1], -run[0]] / length
    on = np.flatnonzero((np.abs(off) < tolerance) & (along > -tolerance) & (along < length - tolerance))
    return on[np.argsort(along[on])]
