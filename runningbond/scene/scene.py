"""The scene: a wall with its joints, materials, supports and loads, complete and checked."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from .actions import same_for
from .arrays import Array, Indices, Mask, frozen
from .beam import Beam, Drive
from .blocks import Blocks
from .bond import Bond
from .errors import SceneError
from .forces import Forces
from .history import KEY, History
from .loads import Load
from .materials import BlockMaterial, JointMaterial
from .ranges import ABOVE_ZERO
from .segments import Joints
from .settlement import Settlement
from .supports import NO_PINS, Pins
from .ties import NO_TIES, Ties

LEAST_BEAM_MASS = 1e-3
"""Least mass of a beam, relative to that of the masonry, if the ground moves: lighter beams need shorter time steps."""

SAME_COLUMN = 1e-9
"""Difference in x, relative to the wall's size, below which blocks are in one column: far below contact tolerance."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Complete input of a model.

    Parameters
    ----------
    title
        Name in tables and pictures.
    blocks
        Blocks of the wall and, last, the ground if there is one.
    fixed : (nb,) bool
        Blocks that do not move: the ground, or a fixed first course.
    wall : (nb,) bool
        Blocks of the wall: all except the ground.
    pins
        Motions of blocks that are held at zero.
    joints
        Joints with at least one movable side.
    thickness
        Out-of-plane thickness [m] of blocks whose material does not define one.
    block_materials, joint_materials
        Materials of blocks and of joints, the default ones first.
    material_of_block : (nb,) int
        Material of each block.
    material_of_joint : (nj,) int
        Material of each joint; for potential cracks inside blocks the one named ``inner_joint``.
    load
        Dead and live load.
    bond
        Nominal block if the wall is bonded in courses of equal height, else None.
    ties, beam
        Bars; and the stiff body across the top, None if there is none.
    notes
        What was healed or left out when the wall was read.
    part_of : (nb,) int
        Number in ``assign`` of the block that each block is, or is a part of; −1 for the beam and the ground.
    assigned
        Result of each entry of ``assign``, one line each.
    """

    title: str
    blocks: Blocks
    fixed: Mask
    wall: Mask
    pins: Pins
    joints: Joints
    thickness: float
    block_materials: tuple[BlockMaterial, ...]
    material_of_block: Indices
    joint_materials: tuple[JointMaterial, ...]
    material_of_joint: Indices
    load: Load
    bond: Bond | None = None
    ties: Ties = NO_TIES
    beam: Beam | None = None
    notes: tuple[str, ...] = ()
    part_of: Indices = field(default_factory=lambda: np.zeros(0, np.int64))
    assigned: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not len(self.part_of):
            object.__setattr__(self, "part_of", np.where(self.masonry, np.arange(len(self.blocks)), -1))
        for name in ("material_of_block", "material_of_joint", "part_of"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))
        object.__setattr__(self, "fixed", frozen(self.fixed, np.bool_))
        object.__setattr__(self, "wall", frozen(self.wall, np.bool_))
        object.__setattr__(self, "thickness", ABOVE_ZERO.take("wall.thickness", self.thickness))

    @property
    def block(self) -> BlockMaterial:
        """Default material of the blocks."""
        return self.block_materials[0]

    @property
    def joint(self) -> JointMaterial:
        """Default material of the joints."""
        return self.joint_materials[0]

    @cached_property
    def materials_of_joints(self) -> tuple[JointMaterial, ...]:
        """Materials in use, at least one; the default material is left out if every joint has another one."""
        return tuple(self.joint_materials[k] for k in np.unique(self.material_of_joint)) or (self.joint,)

    @cached_property
    def material_number_of_joint(self) -> Indices:
        """Index into `materials_of_joints` for each joint, ``(nj,)``."""
        return np.unique(self.material_of_joint, return_inverse=True)[1]

    @property
    def inner_joint(self) -> JointMaterial | None:
        """Material of the potential cracks inside blocks; None if blocks do not crack."""
        return next((material for material in self.joint_materials if material.name == "inner_joint"), None)

    def with_block(self, **changes: Any) -> "Scene":
        """A copy with some fields of the default block material changed."""
        return replace(self, block_materials=(replace(self.block, **changes), *self.block_materials[1:]))

    def with_rigid_blocks(self) -> "Scene":
        """A copy in which no material of blocks has a Young's modulus, so that all blocks are rigid."""
        return replace(self, block_materials=tuple(replace(each, young=None) for each in self.block_materials))

    def with_joint(self, **changes: Any) -> "Scene":
        """A copy with some fields of the default joint material changed."""
        return replace(self, joint_materials=(replace(self.joint, **changes), *self.joint_materials[1:]))

    def without_corner_contacts(self) -> "Scene":
        """The scene without contacts of single corners, for models that find contacts themselves."""
        kept = ~self.joints.at_corner
        if kept.all():
            return self
        return replace(self, joints=self.joints.between_sides, material_of_joint=self.material_of_joint[kept])

    @cached_property
    def is_beam(self) -> Mask:
        """Whether each block is the beam, ``(nb,)``."""
        is_beam = np.zeros(len(self.blocks), dtype=np.bool_)
        if self.beam is not None and self.beam.block is not None:
            is_beam[self.beam.block] = True
        return frozen(is_beam, np.bool_)

    @property
    def masonry(self) -> Mask:
        """Mask of the wall's blocks, without a beam on top, ``(nb,)``."""
        return self.wall & ~self.is_beam

    def count_blocks(self, among: Mask | None = None) -> int:
        """Number of the wall's blocks, or of those in a mask ``(nb,)``: parts of one count once, a beam does not."""
        return len(np.unique(self.part_of[self.masonry if among is None else among & self.masonry]))

    @property
    def drive(self) -> Drive | None:
        """How the beam is driven; None if it is not driven."""
        return None if self.beam is None else self.beam.drive

    @property
    def drive_path(self) -> tuple[float, ...]:
        """Turning points of the beam's prescribed horizontal displacement [m]; empty if a force drives the beam."""
        return () if self.drive is None else self.drive.path

    @cached_property
    def density(self) -> Array:
        """Density of each block, ``(nb,)`` [kg/m³]; if the ground moves, a beam's is its inertial density."""
        return self.density_in_motion if self.history else self._given_density

    @cached_property
    def _given_density(self) -> Array:
        density = np.array([material.density for material in self.block_materials])[self.material_of_block]
        if self.beam is not None:
            density[self.beam.block] = self.beam.mass / self._volume[self.beam.block]
        return frozen(density)

    @cached_property
    def inertial_density(self) -> Array:
        """Inertial density of each block, ``(nb,)`` [kg/m³]: for a beam at least the default density.

        A beam of very small mass would force dynamic models to very short time steps. Static equilibrium does not
        depend on this density, but the response to ground motion does: see `density_in_motion`.
        """
        return self.density_in_motion if self.history else self._with_beam_of(self.block.density)

    @cached_property
    def density_in_motion(self) -> Array:
        """Density of each block if the ground moves, ``(nb,)`` [kg/m³]: as given; for a beam see `LEAST_BEAM_MASS`."""
        mass = float(self._given_density[self.masonry] @ self._volume[self.masonry])
        beam = 0.0 if self.beam is None else float(self._volume[self.beam.block].sum())
        return self._with_beam_of(LEAST_BEAM_MASS * mass / beam if beam else 0.0)

    def _with_beam_of(self, least: float) -> Array:
        """Densities of all blocks as given, that of the beam raised to `least` [kg/m³] if it is lower."""
        density = self._given_density.copy()
        if self.beam is not None:
            density[self.beam.block] = np.maximum(density[self.beam.block], least)
        return frozen(density)

    @cached_property
    def mass(self) -> Array:
        """Mass of each block, ``(nb,)`` [kg]."""
        return frozen(self.density * self.thickness_of_blocks * self.blocks.area)

    @cached_property
    def inertial_mass(self) -> Array:
        """Inertial mass of each block, ``(nb,)`` [kg]; see `inertial_density`."""
        return frozen(self.inertial_density * self.thickness_of_blocks * self.blocks.area)

    @cached_property
    def thickness_of_blocks(self) -> Array:
        """Out-of-plane thickness of each block, ``(nb,)`` [m]; a beam and the ground are as thick as the thickest."""
        own = np.array([material.thickness or self.thickness for material in self.block_materials])
        thickness = own[self.material_of_block]
        thickness[~self.masonry] = thickness[self.masonry].max()
        return frozen(thickness)

    @cached_property
    def thickness_of_joints(self) -> Array:
        """Out-of-plane thickness of each joint, ``(nj,)`` [m]: that of the thinner of the two blocks."""
        return frozen(self.thickness_of_blocks[self.joints.block].min(axis=1))

    @cached_property
    def _volume(self) -> Array:
        """Volume of each block, ``(nb,)`` [m³]."""
        return frozen(self.thickness_of_blocks * self.blocks.area)

    @cached_property
    def settlement(self) -> Settlement | None:
        """The live load that moves a support; None if there is none."""
        return next((load for load in self.load.live if isinstance(load, Settlement)), None)

    @cached_property
    def history(self) -> History | None:
        """The ground motion; None if the ground does not move."""
        return next((load for load in self.load.live if isinstance(load, History)), None)

    @property
    def is_led(self) -> bool:
        """Whether displacements of a support or of the beam are prescribed, in place of loads."""
        return self.settlement is not None or len(self.drive_path) > 0

    @property
    def is_determinate(self) -> bool:
        """Whether the balance of blocks alone gives the resultant in every joint, as in a stack.

        These forces change linearly with λ. In a wall that stands without live load, none of their limits is then
        reached before all forces that balance a larger load are inadmissible: every collapse is at the same load. In
        other walls forces that balance smaller loads may be at their limits as well, with true friction also on another
        mechanism.
        """
        joints = (~self.fixed[self.joints.block]).any(axis=1).sum()
        return bool(joints == (~self.fixed).sum()) and not (len(self.pins) or len(self.late_pins) or len(self.ties))

    @cached_property
    def support_motion(self) -> Array:
        """Prescribed motion of supports at λ = 1, ``(nb, 3)``: of each block's centroid [m], and its rotation [rad]."""
        return frozen(np.zeros((len(self.blocks), 3)) if self.settlement is None else self.settlement.motion(self))

    @cached_property
    def late_pins(self) -> Pins:
        """Motions of blocks that are held at zero after the dead load has been applied."""
        return NO_PINS if self.beam is None else self.beam.late_pins(self.blocks.centroid[self.beam.block])

    @property
    def extras(self) -> tuple[str, ...]:
        """Keys of the features that a model refuses unless it names them in `Model.takes`."""
        given = {
            "tie": len(self.ties) > 0,
            "beam": self.beam is not None,
            "beam.condition fixed-height": len(self.late_pins) > 0,
            "beam.drive.displacement": len(self.drive_path) == 1,
            "beam.drive.displacement, cyclic": len(self.drive_path) > 1,
            "load.live settlement": self.settlement is not None,
            "load.live settlement, along a path": self.settlement is not None and self.settlement.path != (1.0,),
            KEY: self.history is not None,
        }
        return tuple(key for key, there in given.items() if there)

    @cached_property
    def dead_forces(self) -> Forces:
        """Forces of the blocks' weight and of all dead loads."""
        return self._sum(self._weight, [load.forces(self) for load in self.load.dead])

    @cached_property
    def live_forces(self) -> Forces:
        """Forces of all live loads at λ = 1."""
        return self._sum(Forces.on(self), [load.forces(self) for load in self.load.live])

    def forces_by_piece(self, edges: Array) -> tuple[Forces, Forces]:
        """As `dead_forces` and `live_forces`, with line loads cut at edges ``(n, 2, 2)`` [m] of elements."""
        dead, live = ([load.forces_by_piece(self, edges) for load in one] for one in (self.load.dead, self.load.live))
        return self._sum(self._weight, dead), self._sum(Forces.on(self), live)

    @property
    def _weight(self) -> Forces:
        return Forces.on(self, self.load.gravity)

    def _sum(self, first: Forces, others: Sequence[Forces]) -> Forces:
        total = sum(others, first)
        loose = ~self.fixed[total.block]
        return replace(total, block=total.block[loose], at=total.at[loose], force=total.force[loose])

    @cached_property
    def control_point(self) -> tuple[Indices, Array, Array]:
        """Blocks, points and directions whose mean displacement is recorded: those of the first live load."""
        block, at, direction = self.load.live[0].control(self)
        # A user's load may give one point for all blocks.
        return (block, at, direction) if np.ndim(at) == 2 else same_for(block, np.asarray(at), np.asarray(direction))

    @cached_property
    def column_by_column(self) -> Indices:
        """Order of blocks by columns: left to right, each from the bottom up; columns of alternate courses apart.

        With this numbering, joints of one kind come in long runs, in which both block numbers increase by one from
        joint to joint; if the two kinds of columns are of equal height, runs continue from one column to the next.
        """
        low, high = self.blocks.extent(self.wall)
        pitch = self.bond.width if self.bond else float((high - low)[0])
        x, y = (self.blocks.centroid - low).T
        column = np.rint(x / (SAME_COLUMN * (high - low).max()))
        return frozen(np.lexsort((y, column, np.rint(4 * x / pitch) % 4)), np.int64)

    @property
    def block_size(self) -> float:
        """Smallest block dimension [m]: `lowest_block`, or the nominal block width of a bonded wall if that is less."""
        return min(self.lowest_block, self.bond.width) if self.bond else self.lowest_block

    @property
    def size(self) -> float:
        """Size of the wall: the root of its length times its height [m]."""
        low, high = self.blocks.extent(self.wall)
        return float(np.sqrt(np.prod(high - low)))

    @property
    def block_sizes(self) -> Array:
        """Size of each block [m], ``(nb,)``: the smaller side of its bounding box, at least `block_size`.

        A large block on small ones leans and settles, before it falls, by more than the size of a small block suggests.
        """
        low, high = self.blocks.boxes
        return np.asarray(np.maximum((high - low).min(axis=1), self.block_size))

    @property
    def overturning_size(self) -> float:
        """Median of the smaller sides of movable blocks [m], at most `block_size`: slender ones overturn across it."""
        low, high = self.blocks.boxes
        return min(self.block_size, float(np.median((high - low)[self._moving_masonry].min(axis=1))))

    @property
    def lowest_block(self) -> float:
        """Smallest height of a movable block [m]; the beam counts only if nothing else can move."""
        low, high = self.blocks.boxes
        return float((high - low)[self._moving_masonry, 1].min())

    @property
    def _moving_masonry(self) -> Mask:
        """Movable blocks except the beam, or the beam if nothing else can move, ``(nb,)``."""
        movable = ~self.fixed
        masonry = movable & ~self.is_beam
        return masonry if masonry.any() else movable


def check_scene(scene: object) -> None:
    """Refuse an object that is not a `Scene`, such as a wall of the Python interface or a file name."""
    if not isinstance(scene, Scene):
        raise SceneError("scene", "must be a Scene: of a Wall it is wall.scene, of a file read_scene gives it", scene)
