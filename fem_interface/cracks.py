"""Potential cracks inside blocks: every triangle becomes a piece, connected to its neighbours by inner joints.

The scene gives the strength and stiffness of inner joints (`Scene.inner_joint`). Rigid blocks crack along their axis
only; the mesh of such a scene has triangle edges along that axis. Here all other edges between triangles become joints
of the same material too. The paper puts such interfaces between all of its triangles (Sec. 5).

A stone also cracks right beside a joint, under the same tractions. Joints are therefore at most as strong as the stone.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, TypeAlias, get_args

import numpy as np
import shapely
from scipy.sparse import coo_array, csr_array

from meshing import WallMesh
from runningbond.joints import joint_stiffness
from runningbond.scene import (
    Action,
    Array,
    Blocks,
    Forces,
    Indices,
    JointMaterial,
    Joints,
    Load,
    Mask,
    Pins,
    Scene,
    SceneError,
)
from runningbond.scene.ranges import one_of

from .joint_elements import edges_between, edges_of, find_edges

Cracks: TypeAlias = Literal["joints", "blocks"]
"""Where a wall may crack: only at its joints, or also between all triangles of its blocks."""

CONGRUENT = 1e-6
"""Rounding unit of triangle corners when congruent triangles are detected, relative to the smallest triangle's size."""

STRENGTH = "friction", "cohesion", "tensile_strength", "fracture_energy_1", "fracture_energy_2", "softening"
CRUSHING = "compressive_strength", "cap_shear", "compressive_fracture_energy", "peak_closure"
"""Fields of a joint's material that describe its failure in tension and shear, and in compression."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """The parts of a wall that cannot crack: its blocks, or their triangles.

    Parameters
    ----------
    scene
        The wall, with the pieces in place of its blocks. A joint between blocks keeps its number and names the pieces
        at its first end only, although it lies on several pieces per side if it has several elements.
    mesh
        The mesh of the pieces.
    owner : (np,) int
        Block that each piece is part of.
    node : (nn,) int
        Node of the whole blocks' mesh that each node coincides with.
    """

    scene: Scene
    mesh: WallMesh
    owner: Indices
    node: Indices

    @property
    def are_blocks(self) -> bool:
        """Whether each piece is a block."""
        return bool((np.diff(self.owner) > 0).all())


def motion_of_blocks(wall: Pieces) -> csr_array:
    """Rigid motion of blocks per rigid motion of their pieces, ``(3 nb, 3 np)``.

    A block's motion is the rigid motion that has the linear and angular momentum of its pieces.
    """
    blocks, owner = wall.scene.blocks, wall.owner
    count = int(owner[-1]) + 1
    area = np.bincount(owner, blocks.area, minlength=count)
    centre = np.column_stack([np.bincount(owner, blocks.area * x, minlength=count) for x in blocks.centroid.T])
    x, y = (blocks.centroid - (centre / area[:, None])[owner]).T
    moment = np.bincount(owner, blocks.polar_moment + blocks.area * (x**2 + y**2), minlength=count)
    part, spin = blocks.area / area[owner], blocks.area / moment[owner]
    own = blocks.polar_moment / moment[owner]
    entries = [(0, 0, part), (1, 1, part), (2, 0, -y * spin), (2, 1, x * spin), (2, 2, own)]
    rows = np.concatenate([3 * owner + i for i, _, _ in entries])
    columns = np.concatenate([3 * np.arange(len(owner)) + j for _, j, _ in entries])
    values = np.concatenate([value for _, _, value in entries])
    return csr_array(coo_array((values, (rows, columns)), shape=(3 * count, 3 * len(owner))))


@dataclass(frozen=True, eq=False)
class PassedOn(Action):
    """A load on a wall's blocks, passed on to their pieces.

    All pieces that touch the point of a force share it equally. Loads along a line are cut where pieces begin and end.
    """

    load: Action
    wall: Scene
    owner: Indices

    def forces(self, scene: Scene) -> Forces:
        """Forces on the pieces."""
        corners = scene.blocks.vertices
        forces = self.load.forces_by_piece(self.wall, np.stack([corners, corners[scene.blocks.successor]], axis=1))
        share = scene.blocks.area / self.wall.blocks.area[self.owner]
        of_block = [self._bearing(scene, block, at) for block, at in zip(forces.block, forces.at, strict=True)]
        count = np.array([len(near) for near in of_block], dtype=np.int64)
        return Forces.on(
            scene,
            forces.acceleration[self.owner],
            share * forces.moment[self.owner],
            block=np.concatenate([np.zeros(0, dtype=np.int64), *of_block]),
            at=np.repeat(forces.at, count, axis=0),
            force=np.repeat(forces.force / np.maximum(count, 1)[:, None], count, axis=0),
        )

    def control(self, scene: Scene) -> tuple[Indices, Array, Array]:
        """The load's control point on whole blocks, with the pieces that touch it."""
        blocks, at, direction = self.load.control(self.wall)
        touching = [self._bearing(scene, block, point) for block, point in zip(blocks, at, strict=True)]
        count = [len(near) for near in touching]
        return np.concatenate(touching), np.repeat(at, count, axis=0), np.repeat(direction, count, axis=0)

    def _bearing(self, scene: Scene, block: int, at: Array) -> Indices:
        """The pieces that carry a force on a block: those that touch its point, or the nearest one if none does."""
        own = np.flatnonzero(self.owner == block)
        touched = np.intersect1d(own, scene.blocks.containing(at))
        return touched if len(touched) else np.array([_nearest(scene.blocks, self.owner, block, at)])


def _nearest(blocks: Blocks, owner: Indices, block: int, at: Array) -> int:
    """The piece of a block that is nearest to a point."""
    own = np.flatnonzero(owner == block)
    return int(own[np.argmin(shapely.distance(shapely.Point(at), blocks.shapes(own)))])


def at_most_as_strong(joint: JointMaterial, stone: JointMaterial) -> JointMaterial:
    """Material of a joint beside which the stone may fail: its stiffness, with the smaller strength of the two.

    The stone's strength, with its softening, replaces the joint's if no traction that the stone bears breaks the joint;
    otherwise the tensile strength is at most the stone's. The smaller compressive strength counts, with its softening.
    Users' own laws stay as they are.
    """
    if joint.law is not None or stone.law is not None:
        return joint
    if _is_weaker(stone, joint):
        strength = {name: getattr(stone, name) for name in STRENGTH}
        joint = replace(joint, **strength)
    elif stone.tension < joint.tension:
        joint = replace(joint, tensile_strength=stone.tension)
    if stone.compressive_strength is not None and stone.compressive_strength < (joint.compressive_strength or np.inf):
        crushing = {name: getattr(stone, name) for name in CRUSHING}
        joint = replace(joint, **crushing)
    return joint


def has_weaker_stone(scene: Scene) -> bool:
    """Whether a joint of a scene is stronger than the stone beside it."""
    stone = scene.inner_joint
    return stone is not None and any(at_most_as_strong(each, stone) is not each for each in scene.materials_of_joints)


def _is_weaker(one: JointMaterial, other: JointMaterial) -> bool:
    """Whether all tractions that one Mohr–Coulomb material bears are less than what another one bears."""
    in_tension = [each.cohesion - one.tension * each.friction for each in (one, other)]
    fits = one.friction <= other.friction and one.tension <= other.tension and in_tension[0] <= in_tension[1]
    return fits and (one.friction, one.cohesion, one.tension) != (other.friction, other.cohesion, other.tension)


def added_compliance(parts: Pieces) -> float:
    """Largest compliance of an inner joint relative to that of the two triangles beside it.

    It is E / (k d), with the joint's stiffness k and the sum d of both triangles' heights over the joint. A block in
    triangles is softer than its material by about this ratio. Joints that are stiff compared with whole blocks may be
    soft compared with small triangles.
    """
    scene, mesh = parts.scene, parts.mesh
    corner = mesh.points[mesh.triangles]
    area = np.abs(np.linalg.det(corner[:, 1:] - corner[:, :1])) / 2
    edge, ends = edges_of(mesh.triangles), mesh.interfaces[scene.joints.inner[mesh.joint]]
    height = np.zeros(len(ends))
    for one, other in (ends.T[:2], ends.T[2:]):
        length = np.hypot(*(mesh.points[one] - mesh.points[other]).T)
        height += 2 * area[edges_between(edge, one, other) // 3] / length
    young = max((each.young or 0.0 for each in scene.block_materials), default=0.0)
    inner = scene.inner_joint
    return 0.0 if inner is None else float(young / (joint_stiffness(inner).normal * height).min(initial=np.inf))


def pieces(scene: Scene, mesh: WallMesh, cracks: Cracks) -> Pieces:
    """Leave blocks whole, or split all movable blocks except a beam into triangles.

    Raises
    ------
    SceneError
        If blocks are to crack and the scene gives no `inner_joint`, or has ties or supports that move.
    """
    one_of("cracks", cracks, get_args(Cracks))
    if cracks == "joints":
        return Pieces(scene, mesh, np.arange(len(scene.blocks)), np.arange(len(mesh.points)))
    if other := [key for key in scene.extras if not key.startswith("beam")]:
        raise SceneError(other[0], 'does not go with cracks = "blocks", in triangles that are not held by it')
    if scene.inner_joint is None:
        raise SceneError("inner_joint", "is missing; cracks inside blocks need its strength and its stiffness")
    return _in_triangles(scene, mesh, scene.inner_joint)


def _in_triangles(scene: Scene, mesh: WallMesh, stone: JointMaterial) -> Pieces:
    number = np.arange(len(scene.blocks))
    whole = scene.fixed | scene.is_beam
    loose = ~whole[mesh.triangle_block]
    parts = np.where(whole, 1, np.bincount(mesh.triangle_block, minlength=len(number)))
    owner, first_piece = np.repeat(number, parts), np.cumsum(parts) - parts
    held = whole[owner]
    # Triangles are sorted by block, so the movable ones are in the order of their pieces.
    piece = first_piece[mesh.triangle_block]
    piece[loose] = np.flatnonzero(~held)
    first_node, node, triangles = _split_nodes(mesh, owner, held, piece)
    points, block = mesh.points[node], np.repeat(np.arange(len(owner)), np.diff(first_node))

    old, new = edges_of(mesh.triangles), edges_of(triangles)
    a0, a1, b1, b0 = mesh.interfaces.T
    between = new[edges_between(old, a0, a1)], new[edges_between(old, b1, b0)]
    # Every edge between two loose triangles, counted once.
    across, there = find_edges(old, old[:, 1], old[:, 0])
    one = np.flatnonzero(there & (np.arange(len(old)) < across) & np.repeat(loose, 3))
    inside = new[one], new[across[one]]
    sides = [np.concatenate(pair) for pair in zip(between, inside, strict=True)]
    joint = np.concatenate([mesh.joint, len(scene.joints) + np.arange(len(inside[0]))])
    outlines = [scene.blocks.polygon(owner[k]) if held[k] else points[first_node[k] :][:3] for k in range(len(owner))]
    blocks = Blocks.from_polygons(outlines)
    _, first = np.unique(joint, return_index=True)
    between_pieces = np.empty((len(scene.joints) + len(inside[0]), 2), dtype=np.int64)
    between_pieces[joint[first]] = np.column_stack([block[side[first, 0]] for side in sides])
    between_pieces[np.flatnonzero(scene.joints.at_corner)] = _at_corners(scene, blocks, owner)
    inner = scene.joint_materials.index(stone)
    limited = tuple(at_most_as_strong(each, stone) for each in scene.joint_materials)
    passed_on = partial(PassedOn, wall=scene, owner=owner)
    parted = replace(
        scene,
        blocks=blocks,
        load=Load(scene.load.gravity, *(tuple(map(passed_on, loads)) for loads in (scene.load.live, scene.load.dead))),
        fixed=scene.fixed[owner],
        beam=scene.beam and replace(scene.beam, block=int(first_piece[scene.beam.block])),
        wall=scene.wall[owner],
        pins=_pins(scene, mesh, block, node, whole),
        joints=Joints(
            between_pieces,
            np.concatenate([scene.joints.ends, points[inside[0]]]),
            np.concatenate([scene.joints.inner, np.ones(len(inside[0]), dtype=bool)]),
            np.concatenate([scene.joints.corner_length, np.zeros(len(inside[0]))]),
        ),
        material_of_block=scene.material_of_block[owner],
        joint_materials=limited,
        material_of_joint=np.append(scene.material_of_joint, np.full(len(inside[0]), inner)),
    )
    shape = _shapes(points, first_node, held)
    interfaces = np.concatenate(sides, axis=1)
    return Pieces(parted, WallMesh(points, first_node, block, shape, triangles, piece, interfaces, joint), owner, node)


def _at_corners(scene: Scene, blocks: Blocks, owner: Indices) -> Indices:
    """Pieces that contacts of single corners hold apart, ``(n, 2)``: of either block the nearest one."""
    single = scene.joints.at_corner
    places = zip(scene.joints.block[single].tolist(), scene.joints.ends[single].mean(axis=1), strict=True)
    found = [[_nearest(blocks, owner, block, at) for block in pair] for pair, at in places]
    return np.reshape(found, (-1, 2)).astype(np.int64)


def _split_nodes(mesh: WallMesh, owner: Indices, held: Mask, piece: Indices) -> tuple[Indices, Indices, Indices]:
    """Give every piece nodes of its own.

    Parameters
    ----------
    owner, held : (np,)
        Block of each piece, and whether the piece is the whole block.
    piece : (nt,) int
        Piece of each triangle.

    Returns
    -------
    (np + 1,) int
        First node of each piece, then the number of nodes.
    (nn,) int
        Node of the old mesh that each new node is a copy of.
    (nt, 3) int
        The triangles, on the new nodes.
    """
    count = np.where(held, np.diff(mesh.first_node)[owner], 3)
    first = np.concatenate([[0], np.cumsum(count)])
    node = np.repeat(mesh.first_node[owner] - first[:-1], count) + np.arange(first[-1])
    triangles = np.where(
        held[piece][:, None],
        mesh.triangles - (mesh.first_node[owner] - first[:-1])[piece][:, None],
        first[piece][:, None] + np.arange(3),
    )
    loose = ~held[piece]
    node[triangles[loose]] = mesh.triangles[loose]
    return first, node, triangles


def _shapes(points: Array, first_node: Indices, held: Mask) -> Indices:
    """Shape number of each piece: equal for triangles congruent node by node; every held piece has its own."""
    corner = points[first_node[:-1][~held][:, None] + np.arange(3)]
    side = corner[:, 1:] - corner[:, :1]
    size = np.sqrt(np.abs(np.linalg.det(side)).min())
    _, shape = np.unique(np.rint(side.reshape(-1, 4) / (CONGRUENT * size)), axis=0, return_inverse=True)
    result = np.empty(len(held), dtype=np.int64)
    result[~held] = shape.ravel()
    result[held] = len(shape) + np.arange(held.sum())
    return result


def _pins(scene: Scene, mesh: WallMesh, block: Indices, node: Indices, whole: Mask) -> Pins:
    """Pins of the pieces: all that meet at a pinned corner are held there; pins of `whole` blocks stay unchanged."""
    result = []
    for k, (owner, point) in enumerate(zip(scene.pins.block, scene.pins.point, strict=True)):
        there = np.flatnonzero(mesh.block[node] == owner)
        near = np.hypot(*(mesh.points[node[there]] - point).T) <= scene.blocks.tolerance
        result += [(k, piece) for piece in np.unique(block[there[near | whole[owner]]])]
    pin, piece = np.array(result, dtype=np.int64).reshape(-1, 2).T
    return Pins(piece, scene.pins.point[pin], scene.pins.direction[pin], scene.pins.turn[pin])
