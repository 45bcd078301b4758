"""Joints between blocks of constant-strain triangles: points on the elements, and jumps there per nodal displacement.

Degrees of freedom are ordered by node, x before y: 2i and 2i + 1 are the displacement of node i [m].
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias, get_args

import numpy as np
from scipy.sparse import coo_array, csr_array
from skfem import ElementTriP1, FacetBasis, MeshTri

from meshing import WallMesh
from runningbond.joints import JointPoints, Rule, wall_inset, wall_rule
from runningbond.joints.wall_points import CORNER_INSET, bearing_thickness
from runningbond.limit.kinematics import Jump
from runningbond.scene import Array, Indices, Mask, Scene, SceneError
from runningbond.scene.ranges import one_of

from .operators import triangle_mesh

PointsOn: TypeAlias = Literal["elements", "joints"]
"""What a quadrature rule is applied to: every joint element, or every whole joint, however many elements it has."""


@dataclass(frozen=True, eq=False)
class JointElements:
    """Points on the joint elements of a mesh, and the interpolation of the elements' nodal displacements to them.

    The points are in the order of `points`: the first point of all elements, then the second of all, and so on. If a
    rule is applied to whole joints, an element is listed once for each point in it, each time with that one point.

    Parameters
    ----------
    element : (ne,) int
        Joint elements of the mesh, in the order used here; contacts of single corners follow with higher numbers.
    nodes : (ne, 4) int
        Nodes a0, a1, b0, b1 of each element: side a along the tangent, and the nodes of b that face them. On the side
        of a single corner both are the corner's node.
    normal : (ne, 2) float
        Unit normal of each element, from a to b.
    weights : (n, ne, 2) float
        Interpolation weights of the elements' two ends in the displacement of each of their n points.
    points
        The joint points.
    """

    element: Indices
    nodes: Indices
    normal: Array
    weights: Array
    points: JointPoints

    @property
    def listing(self) -> Indices:
        """Order that sorts the points by joint, by element and along the tangent, ``(np,)``."""
        along = (self.points.position * self.points.tangent).sum(axis=1)
        return np.lexsort((along, np.tile(self.element, len(self.weights)), self.points.joint))

    @property
    def tangent(self) -> Array:
        """Unit tangent of each element, at a quarter turn from the normal, ``(ne, 2)``."""
        return np.column_stack([-self.normal[:, 1], self.normal[:, 0]])

    def sides(self, displacement: Array) -> Array:
        """Displacements of the points on sides a and b, ``(2, np, 2)`` [m], from those of the nodes ``(nn, 2)``."""
        ends = displacement[self.nodes].reshape(-1, 2, 2, 2)  # element, side, end, axis
        return np.asarray(np.einsum("pek,eskd->sped", self.weights, ends).reshape(2, -1, 2))

    def arranged(self, order: Indices) -> "JointElements":
        """The same elements ``(ne,)`` in another order."""
        points = self.points.part((np.arange(len(self.weights))[:, None] * len(order) + order).ravel())
        weights = self.weights[:, order].copy()
        return JointElements(self.element[order], self.nodes[order], self.normal[order], weights, points)


def joint_elements(
    mesh: WallMesh, scene: Scene, rule: Rule | None = None, points: PointsOn = "elements"
) -> JointElements:
    """Apply a quadrature rule to the joints, whose ends are moved in by their inset.

    Parameters
    ----------
    mesh
        Mesh of the scene.
    scene
        The scene.
    rule
        Quadrature rule; by default that of `wall_rule`.
    points
        What the rule is applied to: each joint element, or each whole joint, which then has the same points as
        between rigid blocks.

    Raises
    ------
    SceneError
        If the inset leaves nothing of a joint's first or last element.
    """
    one_of("points", points, get_args(PointsOn))
    rule = rule or wall_rule(scene)
    inset = wall_inset(scene)
    element, local, share = (_on_elements if points == "elements" else _on_joints)(mesh, scene, rule, inset)
    a0, a1, b1, b0 = mesh.interfaces[element].T
    run = mesh.points[a1] - mesh.points[a0]
    length = np.hypot(*run.T)
    wall = triangle_mesh(mesh.points, mesh.triangles)
    weights, position = _tabulated(wall, a0, a1, local)
    weights_b, position_b = _tabulated(wall, b0, b1, local)
    normal, tangent = _frames(run)
    apart = np.einsum("epx,exd->epd", position - position_b, np.stack([normal, tangent], axis=2))
    if np.abs(apart).max(initial=0.0) > scene.blocks.tolerance * (1 + 1e-9):
        raise ValueError("the two sides of a joint element do not face each other")
    if np.abs(weights - weights_b).max(initial=0.0) > 1e-9:
        raise ValueError("the two sides of a joint element are divided differently")
    joint = mesh.joint[element]
    area = (scene.thickness_of_joints[joint] * length)[:, None] * share
    on_sides = JointRows(element, joint, np.column_stack([a0, a1, b0, b1]), run, weights, position, area)
    pairs = zip(on_sides, _corner_rows(mesh, scene, rule, local.shape[1]), strict=True)
    return _from_rows(mesh, JointRows._make(np.concatenate(pair) for pair in pairs))


class JointRows(NamedTuple):
    """Elements with n points each; arrays have one row per element."""

    element: Indices  # (ne,)
    joint: Indices  # (ne,)
    nodes: Indices  # (ne, 4) as in `JointElements`
    run: Array  # (ne, 2) a vector along the tangent
    weights: Array  # (ne, n, 2)
    position: Array  # (ne, n, 2) [m]
    area: Array  # (ne, n) [m²]


def _frames(run: Array) -> tuple[Array, Array]:
    """Unit normals and tangents ``(n, 2)`` of segments along vectors ``(n, 2)``."""
    tangent = run / np.hypot(*run.T)[:, None]
    return np.column_stack([tangent[:, 1], -tangent[:, 0]]), tangent


def _from_rows(mesh: WallMesh, rows: JointRows) -> JointElements:
    normal, tangent = _frames(rows.run)
    n = rows.area.shape[1]
    points = JointPoints(
        np.tile(rows.joint, n),
        np.tile(mesh.block[rows.nodes[:, [0, 2]]], (n, 1)),
        rows.position.transpose(1, 0, 2).reshape(-1, 2),
        np.tile(normal, (n, 1)),
        np.tile(tangent, (n, 1)),
        rows.area.T.ravel(),
    )
    return JointElements(rows.element, rows.nodes, normal, rows.weights.transpose(1, 0, 2).copy(), points)


def _corner_rows(mesh: WallMesh, scene: Scene, rule: Rule, n: int) -> JointRows:
    """Contacts of single corners, with n points to a row: a node of one block on an edge of the other one."""
    single = np.flatnonzero(scene.joints.at_corner)
    ends = scene.joints.ends[single]
    run, at = ends[:, 1] - ends[:, 0], ends.mean(axis=1)
    a, b = (_outer_edges(mesh, block, at, scene.blocks.tolerance) for block in scene.joints.block[single].T)
    # The corner's own node is both ends, with whatever weights: those of the other block's edge are needed.
    at_node = a.nodes[:, 0] == a.nodes[:, 1]
    weights = np.where(at_node[:, None], b.weights, a.weights)
    area = (bearing_thickness(scene) * scene.joints.corner_length)[single]
    times = len(rule.nodes) // n
    of_row = np.repeat(np.arange(len(single)), times)
    part, along = (np.tile(each, len(single)).reshape(-1, n) for each in (rule.weights / 2, rule.nodes))
    return JointRows(
        len(mesh.interfaces) + np.arange(len(of_row)),
        single[of_row],
        np.column_stack([a.nodes, b.nodes])[of_row],
        run[of_row],
        np.repeat(weights[of_row, None], n, axis=1),
        at[of_row, None] + (0.5 - CORNER_INSET) * along[:, :, None] * run[of_row, None],
        area[of_row, None] * part,
    )


class OuterEdges(NamedTuple):
    """Edges of blocks at points: both nodes of each, or the same node twice, and the nodes' weights there."""

    nodes: Indices  # (n, 2)
    weights: Array  # (n, 2)


def _outer_edges(mesh: WallMesh, block: Indices, at: Array, reach: float) -> OuterEdges:
    """Edges of blocks ``(n,)`` nearest to points ``(n, 2)``; points within `reach` [m] of a node are at that node."""
    edges = edges_of(mesh.triangles)
    edges = edges[~find_edges(edges, edges[:, 1], edges[:, 0])[1]]
    nodes, share = np.empty((len(at), 2), dtype=np.int64), np.empty(len(at))
    for k, point in enumerate(at):
        own = edges[mesh.block[edges[:, 0]] == block[k]]
        start, stop = mesh.points[own.T]
        run = stop - start
        along = np.clip(((point - start) * run).sum(axis=1) / (run**2).sum(axis=1), 0.0, 1.0)
        nearest = np.argmin(np.hypot(*(start + along[:, None] * run - point).T))
        nodes[k], share[k] = own[nearest], along[nearest]
    length = np.hypot(*(mesh.points[nodes[:, 1]] - mesh.points[nodes[:, 0]]).T)
    at_start, at_stop = share * length <= reach, (1 - share) * length <= reach
    nodes[at_start, 1], nodes[at_stop, 0] = nodes[at_start, 0], nodes[at_stop, 1]
    return OuterEdges(nodes, np.column_stack([1 - share, share]))


def _on_elements(mesh: WallMesh, scene: Scene, rule: Rule, inset: Array) -> tuple[Indices, Array, Array]:
    """Apply a rule to every joint element.

    Parameters
    ----------
    inset : (nj,) float
        Distance by which the rule's interval is moved in from the ends of each joint [m].

    Returns
    -------
    (ne,) int
        The elements.
    (ne, n) float
        Points of each element, from 0 at its first end to 1 at its last.
    (ne, n) float
        Length that each point represents, relative to the element's length.
    """
    joint = mesh.joint
    length = np.hypot(*(mesh.points[mesh.interfaces[:, 1]] - mesh.points[mesh.interfaces[:, 0]]).T)
    first = np.diff(joint, prepend=-1) != 0
    last = np.diff(joint, append=-1) != 0
    off = inset[joint] / length
    low, high = np.where(first, off, 0.0), np.where(last, 1 - off, 1.0)
    if (low >= high).any():
        worst = int(np.argmax(low - high))
        name = "inner_joint.inset" if scene.joints.inner[joint[worst]] else "joint.inset"
        raise SceneError(
            name, f"must leave something of a joint element {length[worst]:.4g} m long", float(inset[joint[worst]])
        )
    local = low[:, None] + (high - low)[:, None] * (rule.nodes + 1) / 2
    # The length within the inset is distributed over the whole joint, as for rigid blocks.
    whole, left = (np.bincount(joint, length * part) for part in (np.ones(len(joint)), high - low))
    share = (high - low) * (whole / np.where(left > 0, left, 1.0))[joint]
    return np.arange(len(joint)), local, share[:, None] * rule.weights / 2


def _on_joints(mesh: WallMesh, scene: Scene, rule: Rule, inset: Array) -> tuple[Indices, Array, Array]:
    """Apply a rule to every whole joint; returns as in `_on_elements`, with one row for each point and its element."""
    elements = np.bincount(mesh.joint, minlength=len(scene.joints))
    chosen = elements > 0
    elements, inset, length = elements[chosen], inset[chosen], scene.joints.length[chosen]
    along = 0.5 + (0.5 - inset / length)[:, None] * rule.nodes
    # The elements of a joint are equally long. A point where two of them meet is assigned to the first.
    scaled = along * elements[:, None]
    place = np.clip(np.ceil(scaled - 1e-9).astype(np.int64) - 1, 0, elements[:, None] - 1)
    element = (np.cumsum(elements) - elements)[:, None] + place
    share = elements[:, None] * rule.weights / 2
    return element.ravel(), (scaled - place).reshape(-1, 1), share.reshape(-1, 1)


def _tabulated(wall: MeshTri, first: Indices, last: Indices, local: Array) -> tuple[Array, Array]:
    """Tabulate the displacement's interpolation at points of facets.

    Parameters
    ----------
    first, last : (nf,) int
        Nodes of the facets.
    local : (nf, n) float
        The points of each facet, from 0 at its first node to 1 at its last.

    Returns
    -------
    (nf, n, 2) float
        Interpolation weights of the first and the last node in the displacement at each point.
    (nf, n, 2) float
        Positions of the points [m].
    """
    if len(first) == 0:
        return np.zeros((*local.shape, 2)), np.zeros((*local.shape, 2))
    low, high = np.minimum(first, last), np.maximum(first, last)
    facets = edges_between(wall.facets.T.astype(np.int64), low, high)
    # scikit-fem parametrises a facet from its lower-numbered node to its higher-numbered one.
    running = np.where((first < last)[:, None], local, 1 - local)
    quadrature = (running[None], np.ones(local.shape[1]))
    basis = FacetBasis(wall, ElementTriP1(), facets=facets, quadrature=quadrature)
    weights = np.zeros((*local.shape, 2))
    nodes = wall.t[:, basis.tind]
    for function, node in zip(basis.basis, nodes, strict=True):
        for end, of_end in enumerate((first, last)):
            weights[node == of_end, :, end] = np.asarray(function[0])[node == of_end]
    return weights, np.asarray(basis.global_coordinates()).transpose(1, 2, 0)


def edges_of(triangles: Indices) -> Indices:
    """Edges of triangles ``(nt, 3)``, directed as the triangles' vertices are ordered, ``(3 nt, 2)``."""
    return np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)


def find_edges(edges: Indices, start: Indices, stop: Indices) -> tuple[Indices, Mask]:
    """Numbers of the edges among ``(n, 2)`` from given nodes to others, and whether such edges exist."""
    count = edges.max() + 1
    keys, wanted = edges @ [count, 1], start * count + stop
    order = np.argsort(keys)
    number = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(order) - 1)]
    return number, np.asarray(keys[number] == wanted)


def edges_between(edges: Indices, start: Indices, stop: Indices) -> Indices:
    """Numbers of the edges among ``(n, 2)`` from one end of joint elements to the other."""
    number, there = find_edges(edges, start, stop)
    if not there.all():
        raise ValueError("a joint element does not lie on sides of triangles")
    return number


def nodal_jump(elements: JointElements, nodes: int) -> Jump:
    """Jumps at the points of joint elements per nodal displacement, for a mesh with a number of nodes."""
    n, ne, _ = elements.weights.shape
    rows = np.arange(n * ne)

    def along(direction: Array) -> csr_array:
        parts = []
        for column, (sense, end) in enumerate([(-1.0, 0), (-1.0, 1), (1.0, 0), (1.0, 1)]):
            share = sense * elements.weights[:, :, end]
            node = np.tile(elements.nodes[:, column], n)
            for axis in (0, 1):
                values = (share * direction[:, axis]).ravel()
                parts.append(coo_array((values, (rows, 2 * node + axis)), shape=(n * ne, 2 * nodes)))
        return csr_array(sum(parts[1:], start=csr_array(parts[0])))

    return Jump(along(elements.normal), along(elements.tangent))
