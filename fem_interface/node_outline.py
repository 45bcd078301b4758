"""Outlines of deformable blocks: their sides as polygons of the nodes of their mesh."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from runningbond.contacts.materials import ContactMaterials
from runningbond.contacts.outline import Outline
from runningbond.dynamics.rig import check_finite
from runningbond.joints.wall_points import spreads
from runningbond.scene import Array, Indices, Scene, SceneError

from .block_kernels import NodalTables, nodal_tables
from .deformable_sides import OutlineNodes, Sides
from .modal_wall import ModalWall, modal_wall
from .modes import ModeCount
from .templates import nodes_of, rows_of

CELLS, EXCESS = 4, 0.5
"""Cells in half a block whose nodes spread pressures along its joints, and by how much one cell makes a mortared stone
too strong: two make it a quarter of that, four a sixteenth; a toe that crushes is a fifth too strong at most."""


@dataclass(frozen=True, eq=False)
class NodeOutline:
    """Blocks with modes whose sides are polygons of the nodes of their mesh.

    Outline nodes are numbered side by side, the sides as the corners that they start from; each starts a facet.

    Parameters
    ----------
    wall
        The blocks in modal coordinates.
    outline
        Their undeformed outlines.
    node : (no,) int
        Node of the mesh.
    first : (nv + 1,) int
        First outline node of each side, then their number.
    nodes, sides
        The outline nodes and the sides, as the kernels take them.
    tables : list
        Of each template the nodes on its outline, in numbers of its own, and their displacements per deformation;
        no nodes if the blocks do not deform.
    """

    wall: ModalWall
    outline: Outline
    node: Indices
    first: Indices
    nodes: OutlineNodes
    sides: Sides
    tables: list[tuple[Indices, Array]]

    @property
    def scene(self) -> Scene:
        """The wall."""
        return self.wall.scene

    def rigid(self, motion: Array) -> Array:
        """Translations and rotation of each block in a motion ``(nd,)``, ``(3 nb,)``."""
        return np.ascontiguousarray(motion[self.wall.rigid]).ravel()

    def positions(self, motion: Array) -> Array:
        """Where the nodes of the mesh are after a motion ``(nd,)``, ``(nn, 2)`` [m]."""
        mesh, blocks = self.wall.mesh, self.outline.blocks
        deformed = motion.copy()
        deformed[self.wall.rigid] = 0.0
        cosine, sine, x, y = self.outline.placed(self.rigid(motion)).blocks[:, mesh.block]
        px, py = (mesh.points - blocks.centroid[mesh.block] + self.wall.displacement(deformed)).T
        return np.column_stack([x + cosine * px - sine * py, y + sine * px + cosine * py])

    def new_tables(self) -> NodalTables:
        """Displacements of the nodes per deformation, with buffers of their own."""
        wall, rows = self.wall, []
        _, place = wall.places([own for own, _ in self.tables])
        for template, first, (_, table), at in zip(wall.templates, wall.first, self.tables, place, strict=False):
            n, (width, modes) = len(template.blocks), table.shape
            if modes:
                rows.append(((n, modes, width, int(first) + 3 * n, int(at)), table))
        return nodal_tables(rows, int(place[-1]), 1)


def node_outline(scene: Scene, cells: int = 1, modes: ModeCount | None = None) -> NodeOutline:
    """Mesh a scene whose blocks are to move far.

    Raises
    ------
    SceneError
        As of `check_finite`, `ContactMaterials` and `Outline.of`, and for a scene that pushes at a point of a block.
    """
    check_finite(scene)
    ContactMaterials(scene)
    for key, forces in (("load.live", scene.live_forces), ("load.dead", scene.dead_forces)):
        if forces.moment.any() or not scene.is_beam[forces.block].all():
            raise SceneError(key, "finite displacements need loads on the blocks' mass, or on a beam")
    wall, outline = modal_wall(scene, cells, modes), Outline.of(scene)
    on_side = list(_nodes_of_sides(wall))
    node, first = np.concatenate(on_side), np.cumsum([0, *map(len, on_side)])
    tables = list(_tables(wall, np.split(node, first[outline.blocks.first[1:-1]])))
    nodes = _outline_nodes(wall, node, first, tables)
    return NodeOutline(wall, outline, node, first, nodes, _sides(outline, first, nodes.length), tables)


def spread_note(scene: Scene, cells: int) -> str:
    """What a message says of pressures along joints that too few nodes spread; empty where there are none."""
    if cells >= CELLS or not spreads(scene):
        return ""
    few = f"{cells} cell{'s' * (cells > 1)} in half a block"
    excess = f"joints that soften, crush or close bear up to {EXCESS / cells**2:.0%} too much"
    return f"contacts are at nodes: from {few} {excess}, which is not in the bracket; cells = {CELLS} spreads pressures"


def _outline_nodes(wall: ModalWall, node: Indices, first: Indices, tables: list[tuple[Indices, Array]]) -> OutlineNodes:
    blocks, points = wall.scene.blocks, wall.mesh.points[node]
    side = np.repeat(np.arange(len(first) - 1), np.diff(first))
    owner = blocks.owner[side]
    following = np.arange(1, len(node) + 1)
    following[first[1:] - 1] = first[blocks.successor]
    length = np.hypot(*(points[following] - points).T)
    total = np.cumsum(length) - length
    return OutlineNodes(
        wall.rigid.astype(np.int64),
        blocks.centroid.copy(),
        owner.astype(np.int64),
        points - blocks.centroid[owner],
        wall.places([own for own, _ in tables])[0][node],
        following,
        total - total[first[:-1]][side],
        length,
    )


def _sides(outline: Outline, first: Indices, length: Array) -> Sides:
    """The sides, from the first outline node of each and the lengths of the facets."""
    successor = outline.blocks.successor.astype(np.int64)
    inset = np.where(outline.radius > 0, outline.radius * np.tan(outline.exterior / 2), 0.0)
    outer = np.column_stack([first[:-1], first[1:] - 1])
    shares = np.column_stack([inset, -inset[successor]]) / length[outer] + [0.0, 1.0]
    extent = outline.straight + inset + inset[successor]
    return Sides(outer, shares, extent, outline.straight.copy(), successor, inset, outline.radius.copy())


def _tables(wall: ModalWall, of_block: list[Indices]) -> Iterator[tuple[Indices, Array]]:
    for template in wall.templates:
        block, shape = template.blocks[0], template.modes.shape[:, 3:]
        local = np.sort(of_block[block]) - wall.mesh.first_node[block] if shape.size else np.zeros(0, dtype=np.int64)
        yield local, rows_of(shape, local)


def _nodes_of_sides(wall: ModalWall) -> Iterator[Indices]:
    """Nodes of each side from its first corner up to the last but one."""
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
    """Points on a straight line, in its sense, but for its end."""
    run = stop - start
    length = np.hypot(*run)
    along, off = (points - start) @ run / length, (points - start) @ [run[1], -run[0]] / length
    on = np.flatnonzero((np.abs(off) < tolerance) & (along > -tolerance) & (along < length - tolerance))
    return on[np.argsort(along[on])]
