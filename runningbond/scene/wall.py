"""The scene: a wall with its joints, materials, supports and loads, complete and checked."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .arrays import Array, Indices, Mask, frozen
from .blocks import Blocks
from .bond import Bond
from .cracks import cut_in_half
from .errors import SceneError
from .forces import Forces
from .loads import Action, Load
from .materials import BlockMaterial, JointMaterial
from .ranges import ABOVE_ZERO, one_of
from .segments import Joints, find_joints
from .supports import NO_PINS, SUPPORT_KINDS, Pins, SupportKind, corner_pins, first_course

SAME_COLUMN = 1e-9
"""Difference, in sizes of the wall, below which blocks stand in one column: far below the contact tolerance."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything a model needs to know.

    Parameters
    ----------
    title
        What tables and pictures call it.
    blocks
        Blocks of the wall and, last, the ground where there is one.
    fixed : (nb,) bool
        Blocks that do not move: the ground, or a fixed first course.
    wall : (nb,) bool
        Blocks of the wall: all but the ground.
    pins
        Points held in one direction.
    joints
        Joints with at least one movable side.
    thickness
        Out-of-plane thickness [m].
    block, joint
        Materials.
    load
        Dead and live load.
    bond
        Nominal block where the wall is bonded on a lattice, None for a drawing.
    inner_joint
        Material of the potential cracks inside blocks; None where blocks do not crack.
    """

    title: str
    blocks: Blocks
    fixed: Mask
    wall: Mask
    pins: Pins
    joints: Joints
    thickness: float
    block: BlockMaterial
    joint: JointMaterial
    load: Load
    bond: Bond | None = None
    inner_joint: JointMaterial | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "fixed", frozen(self.fixed, np.bool_))
        object.__setattr__(self, "wall", frozen(self.wall, np.bool_))
        object.__setattr__(self, "thickness", ABOVE_ZERO.take("wall.thickness", self.thickness))

    @cached_property
    def mass(self) -> Array:
        """Mass of each block, ``(nb,)`` [kg]."""
        return self.block.density * self.thickness * self.blocks.area

    @property
    def joint_materials(self) -> tuple[JointMaterial, ...]:
        """Materials of the joints, to which `material_of_joint` refers."""
        return (self.joint,) if self.inner_joint is None else (self.joint, self.inner_joint)

    @property
    def material_of_joint(self) -> Indices:
        """Material of each joint, ``(nj,)``."""
        return self.joints.inner.astype(np.int64)

    @cached_property
    def dead_forces(self) -> Forces:
        """Forces of the blocks' weight and of all dead loads."""
        return self._sum(Forces.on(self, self.load.gravity), self.load.dead)

    @cached_property
    def live_forces(self) -> Forces:
        """Forces of all live loads at λ = 1."""
        return self._sum(Forces.on(self), self.load.live)

    def _sum(self, forces: Forces, loads: Sequence[Action]) -> Forces:
        total = sum((load.forces(self) for load in loads), forces)
        loose = ~self.fixed[total.block]
        return replace(total, block=total.block[loose], at=total.at[loose], force=total.force[loose])

    @cached_property
    def control_point(self) -> tuple[Indices, Array, Array]:
        """Blocks, point and direction at which displacements are read: those of the first live load."""
        return self.load.live[0].control(self)

    @cached_property
    def column_by_column(self) -> Indices:
        """Blocks from left to right and, within a column, from the bottom up; columns of alternate courses apart.

        Where they are numbered so, joints of one kind come in long runs, in which one joint's blocks follow the
        last one's; where the two kinds of columns are as high, runs go on from one column to the next.
        """
        low, high = self.blocks.extent(self.wall)
        pitch = self.bond.width if self.bond else float((high - low)[0])
        x, y = (self.blocks.centroid - low).T
        column = np.rint(x / (SAME_COLUMN * (high - low).max()))
        return np.lexsort((y, column, np.rint(4 * x / pitch) % 4))

    @property
    def block_size(self) -> float:
        """Smaller side of the blocks [m]: the height of the lowest, or the nominal width of a bonded wall's."""
        return min(self.lowest_block, self.bond.width) if self.bond else self.lowest_block

    @property
    def block_sizes(self) -> Array:
        """Size of each block [m], ``(nb,)``: its smaller side, and not less than that of the wall's blocks.

        A large block on small ones leans, and settles, by more than a small one's share before it falls.
        """
        low, high = self.blocks.boxes
        return np.asarray(np.maximum((high - low).min(axis=1), self.block_size))

    @property
    def lowest_block(self) -> float:
        """Smallest height of a movable block [m]."""
        low, high = self.blocks.boxes
        return float((high - low)[~self.fixed, 1].min())


def build_scene(
    title: str,
    polygons: Sequence[Array],
    *,
    thickness: float,
    block: BlockMaterial,
    joint: JointMaterial,
    load: Load,
    support: SupportKind = "base",
    ground: Array | None = None,
    bond: Bond | None = None,
    inner_joint: JointMaterial | None = None,
) -> Scene:
    """Join blocks into a wall, put it on its support, and check that it can be analysed.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks of the wall [m], convex and counter-clockwise.
    ground : (n, 2) float, optional
        Outline of the ground; without it a flat strip is laid under the lowest course where the
        support needs one.
    inner_joint
        Material of a potential crack on the vertical axis of every block; in a bonded wall, of every block wider
        than half the nominal one.

    Raises
    ------
    SceneError
        For blocks that are not convex, overlap or touch nothing that is held, for an inset that
        leaves no joint, and for a load that nothing takes up.
    """
    one_of("support.kind", support, SUPPORT_KINDS)
    if ground is not None and support in ("corners", "pinned-corners"):
        raise SceneError("support.kind", 'a drawing brings its ground; use "base" or "fixed-first-course"', support)
    if inner_joint and joint.elasticity and not inner_joint.elasticity:
        raise SceneError("inner_joint.mortar", "is missing; joint has a stiffness, and models that need it need both")
    wall_blocks = Blocks.from_polygons(polygons)
    wall_blocks.check()
    owner = np.arange(len(polygons))
    if inner_joint is not None:
        polygons, owner = cut_in_half(polygons, 0.75 * bond.width if bond else 0.0)
        wall_blocks = Blocks.from_polygons(polygons)
    if ground is None and support == "base":
        ground = _strip_below(wall_blocks)
    outlines = [*polygons] if ground is None else [*polygons, ground]
    blocks = Blocks.from_polygons(outlines)
    blocks.check()
    wall = np.arange(len(blocks)) < len(polygons)

    fixed = ~wall
    pins = NO_PINS
    if support == "fixed-first-course":
        fixed = fixed | first_course(blocks, wall)
    elif support in ("corners", "pinned-corners"):
        pins = corner_pins(blocks, wall, roller=support == "corners")

    joints = find_joints(blocks)
    part_of = np.append(owner, np.full(len(outlines) - len(polygons), -1))[joints.block]
    movable = ~fixed[joints.block].all(axis=1)
    inner = (part_of[:, 0] == part_of[:, 1]) & movable
    order = np.concatenate([np.flatnonzero(movable & ~inner), np.flatnonzero(inner)])
    scene = Scene(
        title,
        blocks,
        fixed,
        wall,
        pins,
        Joints(joints.block[order], joints.ends[order], inner[order]),
        thickness,
        block,
        joint,
        load,
        bond,
        inner_joint,
    )
    _check(scene)
    return scene


def _strip_below(blocks: Blocks) -> Array:
    """Ground that reaches the wall's size beyond it on either side, so that a toppling wall lands on it."""
    low, high = blocks.extent()
    reach = max(high - low)
    depth = 0.1 * reach
    left, right, top = low[0] - reach, high[0] + reach, low[1]
    return np.array([[left, top - depth], [right, top - depth], [right, top], [left, top]])


def _check(scene: Scene) -> None:
    if scene.fixed.all():
        raise SceneError("support.kind", "holds every block; give the wall more than one course", "fixed-first-course")
    _refuse_floating_blocks(scene)
    for name, material, chosen in (
        ("joint.inset", scene.joint, ~scene.joints.inner),
        ("inner_joint.inset", scene.inner_joint, scene.joints.inner),
    ):
        length = scene.joints.length[chosen]
        if material is not None and len(length) and 2 * material.inset >= length.min():
            raise SceneError(
                name, f"must be less than half the shortest joint, {length.min():.4g} m long", material.inset
            )
    for key, load in scene.load.named():
        load.check(scene, key)
        forces = load.forces(scene)
        size = sum(float(np.abs(part).sum()) for part in (forces.acceleration, forces.moment, forces.force))
        if not 0 < size < np.inf:
            raise SceneError(key, "must put finite forces on the blocks, not all of them zero", load)


def _refuse_floating_blocks(scene: Scene) -> None:
    """Every movable block hangs together with something that is held."""
    n = len(scene.blocks)
    a, b = scene.joints.block.T
    _, component = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(n, n)), directed=False)
    held = np.union1d(np.flatnonzero(scene.fixed), scene.pins.block)
    floating = ~np.isin(component, component[held])
    if floating.any():
        raise SceneError(
            scene.blocks.name(int(np.argmax(floating))),
            "is a floating block: nothing joins it to the support",
        )
