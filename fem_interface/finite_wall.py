"""A wall at finite displacements: the sides of its blocks as polygons of nodes, and what lies on what."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from runningbond.contacts.contacts import Contacts, Outline, facing_sides, find_contacts, overlaps, resting
from runningbond.scene import Array, Indices, Scene, SceneError

from .element_order import modal_wall
from .modal_wall import ModalWall
from .modes import ModeCount
from .templates import nodes_of


@dataclass(frozen=True, eq=False)
class FiniteWall:
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
    """

    wall: ModalWall
    outline: Outline
    node: Indices
    first: Indices

    @property
    def scene(self) -> Scene:
        """The wall."""
        return self.wall.scene

    @cached_property
    def side(self) -> Indices:
        """Side of each outline node, ``(no,)``."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))

    @cached_property
    def following(self) -> Indices:
        """Next outline node counter-clockwise, ``(no,)``."""
        found = np.arange(1, len(self.node) + 1)
        found[self.first[1:] - 1] = self.first[self.outline.blocks.successor]
        return found

    @cached_property
    def owner(self) -> Indices:
        """Block of each outline node, ``(no,)``."""
        return np.asarray(self.outline.blocks.owner[self.side])

    @cached_property
    def length(self) -> Array:
        """Length of the facet that starts at each outline node, ``(no,)`` [m]."""
        points = self.wall.mesh.points[self.node]
        return np.asarray(np.hypot(*(points[self.following] - points).T))

    @cached_property
    def begin(self) -> Array:
        """Way along its side to each outline node, ``(no,)`` [m]."""
        total = np.cumsum(self.length) - self.length
        return np.asarray(total - total[self.first[:-1]][self.side])

    def rigid(self, motion: Array) -> Array:
        """Translations and rotation of each block in a motion ``(nd,)``, ``(3 nb,)``."""
        return np.asarray(motion[self.wall.rigid].ravel())

    def positions(self, motion: Array) -> Array:
        """Where the nodes of the mesh are after a motion ``(nd,)``, ``(nn, 2)`` [m]."""
        mesh, blocks = self.wall.mesh, self.outline.blocks
        deformed = motion.copy()
        deformed[self.wall.rigid] = 0.0
        cosine, sine, x, y = self.outline.placed(self.rigid(motion))[0][mesh.block].T
        px, py = (mesh.points - blocks.centroid[mesh.block] + self.wall.displacement(deformed)).T
        return np.column_stack([x + cosine * px - sine * py, y + sine * px + cosine * py])

    def deformation(self, motion: Array) -> float:
        """At most how far deformation takes an outline node in a motion ``(nd,)`` [m]."""
        pairs = zip(self._tables, self.wall.split(motion), strict=True)
        far = [float(np.abs(table @ Q[3:]).max(initial=0.0)) for (_, table), Q in pairs]
        return float(np.sqrt(2) * max(far, default=0.0))

    def find(self, motion: Array, margin: float) -> Contacts:
        """Contacts nearer than a margin [m] after a motion ``(nd,)``: ends of facing sides, then nodes inside them."""
        rigid = self.rigid(motion)
        ends = find_contacts(self.outline, rigid, margin)
        corner, _ = resting(self.outline, ends, rigid)
        v, _, _, _, e, f = ends.ends.astype(np.int64).T
        side, low = np.where(corner == v, e, f), (ends.inwards > 0) == (corner == v)
        # The corner inwards is the last of side e and the first of f at the low end, and the other way at the high.
        facet = np.where(low, self.first[side + 1] - 1, self.first[side])
        area = np.minimum(ends.area, self.scene.thickness * self.length[facet] / 2)
        inner = self._inner(rigid, margin)
        return Contacts(
            ends.motion,
            margin,
            np.concatenate([ends.ends, inner.ends]),
            np.concatenate([ends.inwards, inner.inwards]),
            np.concatenate([ends.tilt, inner.tilt]),
            np.concatenate([area, inner.area]),
            np.concatenate([ends.glued, inner.glued]),
        )

    @cached_property
    def undeformed(self) -> Contacts:
        """Contacts of the undeformed wall, glued where they are of its joints."""
        found = self.find(np.zeros(len(self.wall.mass)), self.outline.margin)
        e, f = found.ends[:, 4:].astype(np.int64).T
        return replace(found, glued=overlaps(self.outline, e, f) > 0)

    def _inner(self, rigid: Array, margin: float) -> Contacts:
        """Nodes inside one of two facing sides that are near the other: of block b's, unless that one is held."""
        outline, first = self.outline, self.first
        owner, after = outline.blocks.owner, outline.blocks.successor
        e, f = facing_sides(outline, rigid, margin)
        of_a = outline.held[owner[e]]
        own, other = np.where(of_a, f, e), np.where(of_a, e, f)
        count = np.diff(first)[own] - 1
        pair = np.repeat(np.arange(len(own)), count)
        node = first[own][pair] + 1 + np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
        arcs = outline.placed(rigid)[1]
        at = outline.points(self.owner[node], self.wall.mesh.points[self.node[node]], rigid)
        corners = outline.corners(rigid)
        on = other[pair]
        run = corners[after[on]] - corners[on]
        length = np.hypot(*run.T)
        away = ((at - corners[on]) * arcs[on, 2:]).sum(axis=1)
        along = ((at - corners[on]) * run).sum(axis=1) / length
        opposed = -(arcs[own, 2:] * arcs[other, 2:]).sum(axis=1)[pair] > np.cos(np.pi / 4)
        # Those that are still to come farther from the corners before they bear are near them only.
        inside = np.minimum(along - self._inset[on], length - self._inset[after[on]] - along)
        beyond = np.minimum(self.length[node], self.length[node - 1]) / 2 - inside
        near = opposed & (np.abs(away) < margin) & (beyond < margin)
        node, pair, on = node[near], pair[near], on[near]
        rows = (len(outline.radius) + node, on, of_a[pair], after[on], e[pair], f[pair])
        area = self.scene.thickness * (self.length[node] + self.length[node - 1]) / 2
        still = np.zeros(len(node))
        return Contacts(rigid, margin, np.column_stack(rows).astype(np.uint64), still, still, area, still > 0)

    def geometry(self, contacts: Contacts) -> tuple[Any, ...]:
        """What `gather_deformable` and `scatter_deformable` share, with buffers of its own."""
        outline, n, first = self.outline, len(contacts), self.first
        successor = outline.blocks.successor.astype(np.int64)
        inset = self._inset
        outer = np.column_stack([first[:-1], first[1:] - 1])
        shares = np.column_stack([inset, -inset[successor]]) / self.length[outer] + [0.0, 1.0]
        straight = outline.straight.copy()
        of_nodes, of_sides = (self.begin, self.length), (outer, shares, straight + inset + inset[successor], straight)
        return (
            self._deformable(),
            self._nodes,
            (*of_nodes, *of_sides, successor, inset, outline.radius.copy()),
            contacts.ends.astype(np.int64),
            contacts.inwards.copy(),
            contacts.area.copy(),
            (np.zeros((len(outline.blocks), 4)), np.zeros((len(self.node), 5))),
            np.zeros((len(first) - 1, 4)),
            np.zeros((n, 7)),
            np.zeros((n, 3), dtype=np.int64),
        )

    @cached_property
    def _inset(self) -> Array:
        """Distance from each corner at which its arc touches its sides, ``(nv,)`` [m]."""
        return np.where(self.outline.radius > 0, self.outline.radius * np.tan(self.outline.exterior / 2), 0.0)

    @cached_property
    def _nodes(self) -> tuple[Any, ...]:
        blocks = self.outline.blocks
        arm = self.wall.mesh.points[self.node] - blocks.centroid[self.owner]
        rigid, owner = self.wall.rigid.astype(np.int64), self.owner.astype(np.int64)
        return rigid, blocks.centroid.copy(), owner, arm, self._place, self.following

    @cached_property
    def _tables(self) -> list[tuple[Indices, Array]]:
        """Of each template the nodes whose displacements are kept, and those displacements per deformation.

        The nodes are those on the outline, in the order of the mesh; none if the blocks do not deform.
        """
        mesh = self.wall.mesh
        of_block = np.split(self.node, self.first[self.outline.blocks.first[1:-1]])
        found = []
        for template in self.wall.templates:
            block, shape = template.blocks[0], template.modes.shape[:, 3:]
            modes = shape.shape[1]
            local = np.sort(of_block[block]) - mesh.first_node[block] if modes else np.zeros(0, dtype=np.int64)
            found.append((local, shape.reshape(len(shape) // 2, 2, modes)[local].reshape(2 * len(local), modes)))
        return found

    @cached_property
    def _place(self) -> Indices:
        """Where the displacements of the outline's nodes stand in the kernels' buffer, ``(no, 2)``."""
        mesh = self.wall.mesh
        place = np.full((len(mesh.points), 2), -1)
        at = 0
        for template, (local, _) in zip(self.wall.templates, self._tables, strict=True):
            n = len(template.blocks)
            rows = at + n * np.arange(2 * len(local)).reshape(-1, 2)
            place[mesh.first_node[template.blocks][:, None] + local] = rows + np.arange(n)[:, None, None]
            at += 2 * len(local) * n
        return np.where(place < 0, at, place)[self.node]

    def _deformable(self) -> tuple[Any, ...]:
        """Shapes, tables and new buffers of `block_kernels`, of the deformations alone."""
        shapes, tables = [], [np.zeros((0, 0))]
        at = entry = 0
        for template, first, (_, table) in zip(self.wall.templates, self.wall.first, self._tables, strict=False):
            n, (width, modes) = len(template.blocks), table.shape
            if modes:
                shapes.append((n, modes, width, first + 3 * n, at, entry))
                tables.append(table)
            at, entry = at + width * n, entry + table.size
        return (
            np.array(shapes, dtype=np.int64).reshape(-1, 6),
            np.concatenate([table.ravel() for table in tables]),
            np.concatenate([table.T.ravel() for table in tables]),
            np.array([at]),
            np.zeros(at + 1),
            np.zeros(max((row[0] * row[1] for row in shapes), default=0)),
        )


def finite_wall(scene: Scene, cells: int = 1, modes: ModeCount | None = None) -> FiniteWall:
    """Mesh a scene whose blocks are to move far.

    Raises
    ------
    SceneError
        If the scene pins corners, pushes at a point, has blocks that crack, or glues its joints for ever.
    """
    joint = scene.joint
    if len(scene.pins):
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
    if not (scene.live_forces.on_mass_alone and scene.dead_forces.on_mass_alone):
        raise SceneError("load.live", "finite displacements need a load on the blocks' mass")
    if scene.inner_joint is not None:
        raise SceneError("inner_joint", "finite displacements need blocks that do not crack")
    if joint.cohesion > 0 and (joint.fracture_energy_1 is None or joint.fracture_energy_2 is None):
        raise SceneError("joint", "finite displacements need dry joints, or fracture energies with which they break")
    wall = modal_wall(scene, cells, modes)
    node, first = [], [0]
    for local in _sides(wall):
        node.append(local)
        first.append(first[-1] + len(local))
    return FiniteWall(wall, Outline.of(scene), np.concatenate(node), np.array(first))


def _sides(wall: ModalWall) -> Iterator[Indices]:
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
