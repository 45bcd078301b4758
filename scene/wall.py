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
from .loads import Load, PointLoad
from .materials import BlockMaterial, JointMaterial
from .refusal import SceneError
from .segments import Joints, find_joints
from .supports import NO_PINS, Pins, SupportKind, corner_pins, first_course


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

    def __post_init__(self) -> None:
        object.__setattr__(self, "fixed", frozen(self.fixed, np.bool_))
        object.__setattr__(self, "wall", frozen(self.wall, np.bool_))

    @cached_property
    def mass(self) -> Array:
        """Mass of each block, ``(nb,)`` [kg]."""
        return self.block.density * self.thickness * self.blocks.area

    @cached_property
    def loaded_blocks(self) -> Indices:
        """Movable blocks that share a point load; empty for a lateral load."""
        live = self.load.live
        if not isinstance(live, PointLoad):
            return np.zeros(0, dtype=np.int64)
        touching = self.blocks.containing(np.array(live.at))
        return touching[~self.fixed[touching]]


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
) -> Scene:
    """Join blocks into a wall, put it on its support, and check that it can be analysed.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks of the wall [m], convex and counter-clockwise.
    ground : (n, 2) float, optional
        Outline of the ground; without it a flat strip is laid under the lowest course where the
        support needs one.

    Raises
    ------
    SceneError
        For blocks that are not convex, overlap or touch nothing that is held, for an inset that
        leaves no joint, and for a load that nothing takes up.
    """
    support_needs_ground = support == "base"
    wall_blocks = Blocks.from_polygons(polygons)
    wall_blocks.check()
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
    movable = ~fixed[joints.block].all(axis=1)
    scene = Scene(
        title,
        blocks,
        fixed,
        wall,
        pins,
        Joints(joints.block[movable], joints.ends[movable]),
        thickness,
        block,
        joint,
        load,
        bond,
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
    inset = scene.joint.inset
    if len(scene.joints) and 2 * inset >= scene.joints.length.min():
        raise SceneError(
            "joint.inset",
            f"must be less than half the shortest joint, {scene.joints.length.min():.4g} m long",
            inset,
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
