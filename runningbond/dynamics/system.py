"""Bodies and the interface between them: masses, loads and restraints, and joint points with their kinematics.

A model is a choice of modes and a pair of kernels, `gather` from motions to jumps and `scatter` from joint forces back
to motions; the integrator depends on vectors only and the law on jumps only. At small displacements the interface never
changes; at finite ones a `ContactSearch` updates the contacts as bodies move, and provides an interface for them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from scipy.sparse import csr_array

from runningbond.contacts.outline import Outline
from runningbond.contacts.search import ContactForces, Contacts
from runningbond.joints import PointStrength
from runningbond.joints.frames import keep_frames
from runningbond.joints.law import KernelLaw
from runningbond.scene import Array, Forces, Indices, Mask, Scene

from .body_points import BodyPoints, Deformation, body_points, rigid_body
from .clusters import NO_CLUSTERS, Clusters
from .rig import Rig
from .ties import NO_TIE_ROWS, TieRows, turned_tie_rows
from .turning_loads import TurningLoads, turning_loads
from .turning_supports import TurningSupports

Kernel: TypeAlias = Callable[..., Any]


class Restraint(NamedTuple):
    """Bodies that are restrained at points, in coordinates that satisfy the restraint."""

    freedom: Indices  # (nr, 3) freedoms of each such body
    basis: Array  # (nr, 3, 3) motion of the body per coordinate, mass-orthogonal; unused columns are zero


def restrain(row: Array, restraint: Restraint) -> Array:
    """Transform a row per motion of bodies ``(nd,)``, in place, into a row per restrained coordinate."""
    for freedom, basis in zip(*restraint, strict=True):
        row[freedom] = np.einsum("ij,i->j", basis, row[freedom])
    return row


class Carried(NamedTuple):
    """Supports that move."""

    motion: Array  # (nd,) motion of their modes, which are held, at λ = 1
    displacement: float = 0.0  # displacement in that motion [m]
    work: float = 0.0  # work of their reaction against it [J] if they carry all of the dead load


NOTHING_CARRIED = Carried(np.zeros(0))


class Coupling(NamedTuple):
    """Inertia that couples modes, in addition to the mass of each: a force on one of them accelerates the others."""

    freedom: Indices  # (n,) the modes
    inertia: Array  # (n, n) [kg]; positive semidefinite

    def energy(self, velocity: Array) -> float:
        """Kinetic energy at a velocity ``(nd,)`` [J]."""
        own = velocity[self.freedom]
        return float(0.5 * own @ self.inertia @ own)


NOT_COUPLED = Coupling(np.zeros(0, dtype=np.int64), np.zeros((0, 0)))


@dataclass(frozen=True, eq=False)
class Interface:
    """Joint points between bodies."""

    law: KernelLaw  # law of the joint points
    area: Array  # (np,) area that each joint point stands for [m²]
    # compiled kernels ``gather(motion, geometry, opening, slip)`` and ``scatter(normal, tangential, geometry, force)``;
    # the latter subtracts the forces of the joints' tractions from `force`
    gather: Kernel
    scatter: Kernel
    geometry: NamedTuple  # arrays that the two kernels share: a named tuple of the kernels' module
    # largest ω² [1/s²] of any body on its share of its joints: an upper bound for the system
    frequency_squared: float
    closer: float | None = None  # the system's own ω², if known to a hundredth: then it determines time steps
    # compiled kernel ``reframe(geometry, frames, history)``: after `gather`, transforms the history to its frames
    reframe: Kernel = keep_frames

    def jumps(self, motion: Array) -> tuple[Array, Array]:
        """Opening and slip of the points after a motion ``(nd,)``, ``(np,)`` each [m]."""
        opening, slip = np.zeros((2, self.law.points))
        self.gather(motion, tuple(self.geometry), opening, slip)  # a plain tuple, as in the steps: compiled once
        return opening, slip


class ContactSearch(Protocol):
    """How a model finds the contacts of its bodies at finite displacements, and the interface on them."""

    outline: Outline
    """Outlines of the undeformed bodies."""

    undeformed: Contacts
    """Contacts of the undeformed wall."""

    def find(self, motion: Array, margin: float) -> Contacts:
        """Contacts nearer than a margin [m] after a motion ``(nd,)``."""

    def bearing(self, contacts: Contacts) -> Contacts:
        """The contacts with areas in joints that add up to that of the length over which the bodies overlap now."""

    def interface_on(self, contacts: Contacts, system: "BlockSystem") -> Interface:
        """The interface of a system's bodies on other contacts than the undeformed ones."""

    def resting(self, contacts: Contacts, motion: Array) -> Indices:
        """A number for each contact that identifies its resting corner and its side after a motion ``(nd,)``."""

    def deformation(self, motion: Array) -> float:
        """Upper bound of the distance of points of bodies from their positions if the bodies were rigid [m]."""

    def points(self, contacts: Contacts) -> "tuple[Indices, Indices]":
        """A key for each point of the interface on contacts, and the end that the point is or −1, two ``(np,)``."""

    def at_joints(self, contacts: Contacts, values: Array) -> Array:
        """Values at the undeformed wall's joint points, ``(6, n)``, from values at contacts' points ``(6, np)``.

        They are openings and slips [m], normal and tangential forces [N], damage, and plastic closure [m].
        """

    def pulls(self, contacts: Contacts, motion: Array, force: Array) -> Array:
        """Force of block b on block a at each point after a motion ``(nd,)``, ``(2, np)`` [N], along x and y in space.

        `force` has the points' normal and tangential forces ``(2, np)`` [N].
        """

    def forces(self, contacts: Contacts, motion: Array, force: Array) -> ContactForces:
        """Forces at the contacts after a motion ``(nd,)``, from the points' normal and tangential ones ``(2, np)`` [N].

        The forces of points between two ends are shared by these.
        """

    def left_out(self, contacts: Contacts) -> Mask:
        """Contacts ``(n,)`` that `at_joints` leaves out: made, or moved along a side, since the wall was built."""


@dataclass(frozen=True, eq=False)
class BlockSystem:
    """Bodies in motion, with an interface between them: blocks, or the pieces of blocks that may crack."""

    mass: Array  # (nd,) modal masses; inf where a mode is held
    stiffness: Array  # (nd,) modal stiffness of the bodies themselves [N/m]; zero for rigid modes
    viscosity: Array  # (nd,) modal viscous damping coefficient [N s/m]
    # (nd,) modal loads [N], the live one for λ = 1
    dead: Array
    live: Array
    control: Array  # (nd,) displacement of the control point along the live load, per modal motion
    force_unit: Array  # (nd,) unit of each mode's unbalanced force; inf where a mode is held
    rigid: Indices  # (n, 3) indices in the motion of each body's translations along x and y [m] and its rotation [rad]
    owner: Indices  # (n,) block to which each body belongs
    restraint: Restraint  # bodies held at points
    interface: Interface  # joints between the bodies: at finite displacements those of the undeformed contacts
    ties: TieRows = NO_TIE_ROWS  # bars between them
    late: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # modes held once the dead load is on
    carried: Carried = NOTHING_CARRIED  # supports that move
    contacts: ContactSearch | None = None  # search for contacts as bodies move; None at small displacements
    rig: Rig | None = None  # rig that drives the beam at finite displacements
    turning_dead: TurningLoads | None = None  # dead loads that rotate with bodies at finite displacements,
    turning_live: TurningLoads | None = None  # and live ones
    turning_supports: TurningSupports | None = None  # supports that rotate at finite displacements
    coupling: Coupling = NOT_COUPLED  # inertia that couples modes; only if nothing but a load acts on them
    inertia_scaling: float = 1.0  # largest factor by which the inertia of bodies is scaled up (`inertia`)
    clusters: Clusters = NO_CLUSTERS  # bodies with more inertia in relative motion; without live load on them
    # (3 nb, 3 n) rigid motion of the blocks per rigid motion of the bodies; None if each body is a block
    block_motion: csr_array | None = None
    source: object = None  # what it was built from, for observers: the wall in modal coordinates if blocks deform

    @property
    def freedoms(self) -> int:
        """Number of modes that move."""
        return int(np.isfinite(self.mass).sum())

    @property
    def mass_along(self) -> Array:
        """Mass that each mode moves along x and along y, ``(2, nd)`` [kg]; zero if the mode is held."""
        along = np.zeros((2, len(self.mass)))
        for axis, modes in enumerate(self.rigid[:, :2].T):
            along[axis, modes] = np.where(np.isfinite(self.mass[modes]), self.mass[modes], 0.0)
        return along

    @property
    def weightless(self) -> bool:
        """Whether only the live load acts on it."""
        return not self.dead.any()

    @property
    def held_late(self) -> "BlockSystem":
        """The system with its dead load on, and its late modes held."""
        if not len(self.late):
            return self
        mass, live, unit = self.mass.copy(), self.live.copy(), self.force_unit.copy()
        mass[self.late] = unit[self.late] = np.inf
        live[self.late] = 0.0
        return replace(self, mass=mass, live=live, force_unit=unit, late=self.late[:0])

    def kinetic_energy(self, velocity: Array) -> float:
        """Kinetic energy of the moving modes at a velocity ``(nd,)`` [J]."""
        moving = np.isfinite(self.mass)
        own = float(0.5 * (self.mass[moving] * velocity[moving] ** 2).sum())
        return own + self.coupling.energy(velocity) + self.clusters.energy(velocity, self.mass)

    def measure(self, force: Array) -> float:
        """Largest of the modal forces ``(nd,)`` on moving modes, each in its unit."""
        moving, unit = self._moving
        return float((np.abs(force[moving]) / unit).max(initial=0.0))

    @cached_property
    def _moving(self) -> tuple[Indices, Array]:
        """The modes that move, and their units of force."""
        moving = np.flatnonzero(np.isfinite(self.mass))
        return moving, self.force_unit[moving]

    def unrestrained(self, motion: Array) -> Array:
        """Motion or velocity with restrained coordinates transformed back to those of their bodies, ``(nd,)``."""
        moved = motion.copy()
        for freedom, basis in zip(*self.restraint, strict=True):
            moved[freedom] = np.einsum("ij,j->i", basis, motion[freedom])
        return moved

    def motion_of_blocks(self, motion: Array) -> Array:
        """Translation and rotation of each block in a motion or velocity ``(nd,)``, ``(nb, 3)`` [m, m, rad]."""
        rigid = self.motion_of_bodies(motion)
        return rigid if self.block_motion is None else np.reshape(self.block_motion @ rigid.ravel(), (-1, 3))

    def motion_of_bodies(self, motion: Array) -> Array:
        """Translation and rotation of each body in a motion or velocity ``(nd,)``, ``(n, 3)`` [m, m, rad]."""
        return self.unrestrained(motion)[self.rigid]

    def farthest(self, motion: Array, unit: float | Array = 1.0) -> float:
        """Largest translation of any body in a motion ``(nd,)``, in a unit [m] or in each body's own ``(n,)``."""
        return float((np.abs(motion[self._translations]).max(axis=1) / unit).max())

    @cached_property
    def _translations(self) -> Indices:
        return self.rigid[:, :2].copy()


def force_unit(scene: Scene, block: Indices, mass: Array, live: Array, strength: PointStrength) -> Array:
    """Unit for the unbalanced force of each mode, ``(nd,)``: the weight of its own block.

    A small block beside large ones falls as freely as they do, under forces that are negligible for them. Moments and
    other modal forces are those that accelerate the mode as much, F (m / m_b)^{1/2}. Without weight the unit for all
    blocks is the force that the strongest point carries.

    Parameters
    ----------
    block : (nd,) int
        Block of each mode.
    mass : (nd,) float
        Modal masses, not scaled; inf where a mode is held. For a beam, its inertial mass.
    live : (nd,) float
        Modal live load.
    strength
        Strength of the joint points.
    """
    gravity = float(np.hypot(*scene.load.gravity))
    each = np.full(len(scene.blocks), strength.strongest or float(np.abs(live).max()) or 1.0)
    inertia = scene.inertial_mass
    force = gravity * inertia if gravity > 0 else each
    return np.asarray(force[block] * np.sqrt(mass / inertia[block]))


def moving_far(
    system: BlockSystem,
    scene: Scene,
    contacts: ContactSearch,
    forces: tuple[Forces, Forces],
    deformation: Deformation = rigid_body,
) -> BlockSystem:
    """The blocks of a scene at finite displacements: with contact search, and with loads that rotate with the blocks.

    Parameters
    ----------
    system
        The blocks, on their undeformed contacts.
    forces
        The scene's dead and live forces.
    deformation
        How blocks deform at a point.
    """
    centroid = scene.blocks.centroid
    still = int(system.rigid[(scene.fixed & (scene.support_motion[:, 2] == 0)).argmax(), 2])

    def points(block: Indices, at: Array) -> BodyPoints:
        return body_points(block, at, centroid, system.rigid, still, deformation)

    rig = Rig.of(scene, system.rigid)
    return replace(
        system,
        contacts=contacts,
        rig=rig,
        turning_dead=turning_loads(forces[0], points),
        turning_live=None if rig else turning_loads(forces[1], points),  # a rig rotates the load that drives it
        turning_supports=TurningSupports.of(scene, system.rigid),
        ties=turned_tie_rows(system.ties, scene.ties, points),
    )
