"""The scene: a wall with its joints, materials, supports and loads, complete and checked."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .arrays import Array, Indices, Mask, frozen
from .blocks import Blocks
from .bond import Bond
from .cracks import halved
from .errors import SceneError
from .loads import Load, PointLoad
from .materials import BlockMaterial, JointMaterial
from .segments import Joints, find_joints
from .supports import NO_PINS, Pins, SupportKind, corner_pins, first_course

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
    def loaded_blocks(self) -> Indices:
        """Movable blocks that share a point load; empty for a lateral load."""
        live = self.load.live
        if not isinstance(live, PointLoad):
            return np.zeros(0, dtype=np.int64)
        touching = self.blocks.containing(np.array(live.at))
        return touching[~self.fixed[touching]]

    @cached_property
    def control_point(self) -> tuple[Indices, Array, Array]:
        """Blocks whose displacement is averaged at the control point ``(n,)``, the point and a direction ``(2,)``.

        The control point is where a point load acts, or the highest corner that lies farthest along a lateral
        load (the paper's upper corner on the side of the push); its displacement is read along the live load.
        """
        live, blocks = self.load.live, self.blocks
        if isinstance(live, PointLoad):
            return self.loaded_blocks, np.array(live.at), np.array(live.force) / np.hypot(*live.force)
        direction = np.array(live.direction)
        up = -np.array(self.load.gravity) / np.hypot(*self.load.gravity)
        movable = np.flatnonzero(~self.fixed[blocks.owner])
        height = blocks.vertices[movable] @ up
        top = movable[height >= height.max() - blocks.tolerance]
        corner = top[[np.argmax(blocks.vertices[top] @ direction)]]
        return blocks.owner[corner], blocks.vertices[corner[0]], direction

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
        x, y = self.blocks.vertices.T
        first = self.blocks.first[:-1]
        sides = [np.maximum.reduceat(z, first) - np.minimum.reduceat(z, first) for z in (x, y)]
        return np.asarray(np.maximum(np.minimum(*sides), self.block_size))

    @property
    def lowest_block(self) -> float:
        """Smallest height of a movable block [m]."""
        y, first = self.blocks.vertices[:, 1], self.blocks.first[:-1]
        height = np.maximum.reduceat(y, first) - np.minimum.reduceat(y, first)
        return float(height[~self.fixed].min())


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
    support_needs_ground = support == "base"
    wall_blocks = Blocks.from_polygons(polygons)
    wall_blocks.check()
    whole = np.arange(len(polygons))
    if inner_joint is not None:
        polygons, whole = halved(polygons, 0.75 * bond.width if bond else 0.0)
        wall_blocks = Blocks.from_polygons(polygons)
    if ground is None and support_needs_ground:
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
    part_of = np.append(whole, np.full(len(outlines) - len(polygons), -1))[joints.block]
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
    live = scene.load.live
    if isinstance(live, PointLoad):
        if scene.loaded_blocks.size == 0:
            low, high = scene.blocks.extent(scene.wall)
            raise SceneError(
                "load.live.at",
                "touches no block that can move; the wall spans "
                f"x {low[0]:.4g} … {high[0]:.4g} m, y {low[1]:.4g} … {high[1]:.4g} m",
                list(live.at),
            )
    elif not any(scene.load.gravity):
        raise SceneError("load.gravity", "leaves a lateral load nothing to push with; give the blocks a weight", 0.0)


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
