"""A wall in modal coordinates: the coordinates of its blocks, and loads and points' displacements in terms of them."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshing import WallMesh, wall_mesh
from runningbond.dynamics.body_points import rigid_body
from runningbond.joints import Rule, wall_rule
from runningbond.joints.wall_law import row_of_joint
from runningbond.scene import Array, Forces, Indices, Scene

from .cracks import Cracks, Pieces, pieces
from .joint_elements import JointElements, PointsOn, edges_of, joint_elements
from .loads import Loads, inner_mass
from .modes import BENDING, ModeCount
from .templates import Template, nodes_of, templates, triangles_of

RESOLUTION = 1e-9
"""Rounding unit of an element's properties, relative to their size, when elements of one kind are detected."""


@dataclass(frozen=True, eq=False)
class ModalWall:
    """Blocks with modes, connected at the points of joint elements.

    Modal coordinates are ordered by template, then by mode, then by block. Fixed blocks share the last coordinate,
    which never moves.

    Parameters
    ----------
    pieces
        The wall and its mesh. If its blocks may crack, "block" means one of their triangles here.
    templates
        The wall's movable blocks.
    elements
        The wall's joint elements and their points.
    """

    pieces: Pieces
    templates: list[Template]
    elements: JointElements

    @property
    def scene(self) -> Scene:
        """The wall."""
        return self.pieces.scene

    @property
    def mesh(self) -> WallMesh:
        """The wall's mesh."""
        return self.pieces.mesh

    @cached_property
    def first(self) -> Indices:
        """First coordinate of each template, then the coordinate that never moves, ``(n_templates + 1,)``."""
        counts = [len(template.blocks) * len(template.modes.mass) for template in self.templates]
        return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])

    @cached_property
    def place(self) -> Indices:
        """Template of each block and the block's index in it, ``(nb, 2)``; −1 for fixed blocks."""
        place = np.full((len(self.scene.blocks), 2), -1)
        for k, template in enumerate(self.templates):
            place[template.blocks, 0] = k
            place[template.blocks, 1] = np.arange(len(template.blocks))
        return place

    @property
    def mass(self) -> Array:
        """Modal masses, ``(nd,)``; inf for coordinates that never move."""
        return np.concatenate([*(np.repeat(t.modes.mass, len(t.blocks)) for t in self.templates), [np.inf]])

    @property
    def stiffness(self) -> Array:
        """Modal stiffness of the blocks themselves, ``(nd,)`` [N/m]."""
        return np.concatenate([*(np.repeat(t.modes.stiffness, len(t.blocks)) for t in self.templates), [0.0]])

    @cached_property
    def block(self) -> Indices:
        """Block of each coordinate, ``(nd,)``; the last block for the last coordinate, which never moves."""
        each = [np.tile(template.blocks, len(template.modes.mass)) for template in self.templates]
        return np.concatenate([*each, [len(self.scene.blocks) - 1]])

    @cached_property
    def rigid(self) -> Indices:
        """Indices of each block's rigid coordinates, ``(nb, 3)``; the very last coordinate for fixed blocks."""
        result = np.full((len(self.scene.blocks), 3), self.first[-1])
        for template, first in zip(self.templates, self.first, strict=False):
            n = len(template.blocks)
            result[template.blocks] = first + np.arange(n)[:, None] + n * np.arange(3)
        return result

    def displacement(self, motion: Array) -> Array:
        """Displacement of every node, ``(nn, 2)`` [m]."""
        result = np.zeros_like(self.mesh.points)
        for template, Q in zip(self.templates, self.split(motion), strict=True):
            displaced = (template.modes.shape @ Q).reshape(-1, 2, len(template.blocks))
            result[self._nodes(template)] = displaced.transpose(0, 2, 1)
        return result

    def _nodes(self, template: Template) -> Indices:
        """Nodes of a template's blocks, ``(nn, n)``."""
        return self.mesh.first_node[template.blocks] + np.arange(len(template.modes.shape) // 2)[:, None]

    def strain(self, motion: Array) -> Array:
        """Mean strains ε_x, ε_y and γ_xy of each triangle, ``(nt, 3)``; zero in fixed blocks."""
        triangle_block = self.mesh.triangle_block
        order = np.argsort(triangle_block, kind="stable")
        first = np.searchsorted(triangle_block[order], np.arange(len(self.scene.blocks)))
        result = np.zeros((len(triangle_block), 3))
        for template, Q in zip(self.templates, self.split(motion), strict=True):
            triangles = order[first[template.blocks] + np.arange(len(template.strain) // 3)[:, None]]
            result[triangles] = (template.strain @ Q).reshape(-1, 3, len(template.blocks)).transpose(0, 2, 1)
        return result

    def split(self, motion: Array) -> list[Array]:
        """Coordinates of each template's blocks, ``(m, n)`` each."""
        pieces = np.split(motion, self.first[1:])[:-1]
        return [piece.reshape(-1, len(t.blocks)) for piece, t in zip(pieces, self.templates, strict=True)]

    def places(self, block: Indices, row: Indices, counts: list[int]) -> tuple[Indices, Indices]:
        """Indices for the displacements of points of blocks ``(n,)``, given their rows in tables of the templates.

        Parameters
        ----------
        block, row : (n,) int
            Block of each point, and the point's row in the table of that block's template; -1 if it has none.
        counts
            Number of rows of each template's table.

        Returns
        -------
        (n, 2) int
            Index of each point's displacements along x and y, consecutive over the blocks of a template; one after
            the last index for points without a row.
        (n_templates + 1,) int
            First index of each template, then the number of indices.
        """
        blocks = np.array([len(template.blocks) for template in self.templates], dtype=np.int64)
        first = np.concatenate([[0], np.cumsum(2 * blocks * counts, dtype=np.int64)])
        place, there = np.full((len(block), 2), first[-1]), row >= 0
        template, at = self.place[block[there]].T
        rows = 2 * row[there, None] + [0, 1]
        place[there] = (first[template] + at)[:, None] + blocks[template, None] * rows
        return place, first

    @cached_property
    def forces_by_piece(self) -> tuple[Forces, Forces]:
        """Dead and live forces of the scene; loads along lines are distributed to all triangles along them.

        Forces at only two points of a block would bend it too little.
        """
        return self.scene.forces_by_piece(self.mesh.points[edges_of(self.mesh.triangles)])

    def load(self, forces: Forces, loads: Loads = "consistent") -> Array:
        """Modal forces of forces on the blocks, ``(nd,)`` [N]; a moment acts on a block's rotation only."""
        if loads == "consistent":
            each = [t.modes.inert @ forces.acceleration[t.blocks].T for t in self.templates]
        else:
            nodal = inner_mass(self.pieces)[:, None] * forces.acceleration[self.mesh.block]
            each = [
                t.modes.shape.T @ nodal[self._nodes(t)].transpose(0, 2, 1).reshape(-1, len(t.blocks))
                for t in self.templates
            ]
        result = np.concatenate([*(force.ravel() for force in each), [0.0]])
        for t in self.templates:
            result[self.rigid[t.blocks]] += forces.moment[t.blocks, None] * t.modes.free[2]
        for block, at, force in zip(forces.block.tolist(), forces.at, forces.force, strict=True):
            result += self.displacement_row(block, at, force)
        return result

    def displacement_row(self, block: int, at: Array, direction: Array) -> Array:
        """Displacement of a point ``(2,)`` of a movable block along a direction, per coordinate, ``(nd,)``.

        It is interpolated in the triangle that the point is deepest inside of, or least outside of.
        """
        template, row = self.place[block]
        points, triangles = self.mesh.points[nodes_of(self.mesh, block)], triangles_of(self.mesh, block)
        (x1, y1), (x2, y2), (x3, y3) = (points[triangles] - at).transpose(1, 2, 0)
        # Barycentric coordinates: each corner's share is the area between the point and the other two corners.
        areas = np.column_stack([x2 * y3 - x3 * y2, x3 * y1 - x1 * y3, x1 * y2 - x2 * y1])
        shares = areas / areas.sum(axis=1, keepdims=True)
        best = int(np.argmax(shares.min(axis=1)))
        shape = self.templates[template].modes.shape.reshape(len(points), 2, -1)[triangles[best]]
        result = np.zeros(self.first[-1] + 1)
        self.split(result)[template][:, row] = np.einsum("c,x,cxm->m", shares[best], direction, shape)
        return result

    def deformation(self, block: int, at: Array) -> tuple[Indices, Array]:
        """Coordinates ``(m,)`` of a block's deformations, and a point's displacement per coordinate, ``(m, 2)``."""
        if self.place[block, 0] < 0:
            return rigid_body(block, at)
        rows = np.array([self.displacement_row(block, at, axis) for axis in np.eye(2)])
        rows[:, self.rigid[block]] = 0.0
        modes = np.flatnonzero(rows.any(axis=0))
        return modes, rows[:, modes].T

    def control_row(self) -> Array:
        """Displacement of the control point along the live load, ``(nd,)``; see `runningbond.results.Outcome`.

        It is averaged over the points of blocks, and at each point over the pieces there.
        """
        held, at, direction = self.scene.control_point
        places = np.column_stack([self.pieces.owner[held], at])
        _, place, times = np.unique(places, axis=0, return_inverse=True, return_counts=True)
        share = 1 / (times[place.ravel()] * len(times))
        rows = zip(share, held, at, direction, strict=True)
        return np.asarray(sum(part * self.displacement_row(int(block), *point) for part, block, *point in rows))


def element_runs(wall: ModalWall) -> tuple[Indices, Indices]:
    """Runs of equal joint elements, along which kernels access memory contiguously.

    A wall of equal blocks has few kinds of joint elements. Elements of one kind are sorted by their blocks: if element
    e lies between the blocks with indices p and q in their templates, element e + 1 usually lies between p + 1 and
    q + 1.

    Returns
    -------
    (ne,) int
        Joint elements, run by run.
    (nr + 1,) int
        First element of each run in that order, then the number of elements.
    """
    joint = wall.elements
    n, ne, _ = joint.weights.shape
    block = wall.mesh.block[joint.nodes[:, [0, 2]]]
    template, row = wall.place[block].transpose(2, 0, 1)
    held = template < 0
    local = np.where(held[:, [0, 0, 1, 1]], -1, joint.nodes - wall.mesh.first_node[block][:, [0, 0, 1, 1]])
    area = joint.points.area.reshape(n, ne).T
    values = [joint.normal, joint.weights.transpose(1, 0, 2).reshape(ne, 2 * n), area / area.max(initial=1e-300)]
    rounded = np.rint(np.column_stack(values) / RESOLUTION).astype(np.int64)
    material = row_of_joint(wall.scene)[joint.points.joint[:ne]]
    _, kind = np.unique(np.column_stack([material, template, local, rounded]), axis=0, return_inverse=True)
    kind = kind.ravel()
    order = np.lexsort((np.where(held[:, 0], row[:, 1], row[:, 0]), kind))
    follows = (np.diff(row[order], axis=0) == 1) | held[order][1:]
    goes_on = np.zeros(ne, dtype=bool)
    goes_on[1:] = (np.diff(kind[order]) == 0) & follows.all(axis=1)
    return order, np.append(np.flatnonzero(~goes_on), ne)


def modal_wall(
    scene: Scene,
    cells: int = 1,
    modes: ModeCount | None = None,
    rule: Rule | None = None,
    points: PointsOn = "elements",
    cracks: Cracks = "joints",
) -> ModalWall:
    """Mesh a scene, compute its blocks' modes and sort its joint elements into runs; see `fem_interface.model.fem`."""
    parts = pieces(scene, wall_mesh(scene, cells), cracks)
    rule = rule or wall_rule(parts.scene, cells if points == "elements" else 1)
    joints = joint_elements(parts.mesh, parts.scene, rule, points)
    if modes is None:
        modes = BENDING if cracks == "joints" else "all"
    wall = ModalWall(parts, templates(parts.mesh, parts.scene, modes), joints)
    order, _ = element_runs(wall)
    return replace(wall, elements=joints.arranged(order))
