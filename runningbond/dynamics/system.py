"""The block system: modes and their masses, joint points and their law, loads, and how modes move joints.

A model is a choice of modes and a pair of kernels, `gather` from motions to jumps and `scatter` back from joint
forces to motions; the integrator sees vectors only and the law jumps only.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from runningbond.joints import PointStrength
from runningbond.joints.law import KernelLaw
from runningbond.scene import Array, Indices, Scene

Kernel: TypeAlias = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Restraint:
    """Blocks whose motion is restrained at points, in coordinates that leave the restraint satisfied.

    Parameters
    ----------
    freedom : (nr, 3) int
        Freedoms of each such block.
    basis : (nr, 3, 3) float
        Motion of the block per coordinate, mass-orthogonal; columns that are not needed are zero.
    """

    freedom: Indices
    basis: Array


@dataclass(frozen=True, eq=False)
class BlockSystem:
    """Blocks in motion.

    Parameters
    ----------
    mass : (nd,) float
        Modal masses; inf where a mode is held.
    stiffness : (nd,) float
        Modal stiffness of the blocks themselves [N/m]; zero for rigid modes.
    viscosity : (nd,) float
        Modal viscous damping coefficient [N s/m].
    dead, live : (nd,) float
        Modal loads [N], the live one for λ = 1.
    law
        Law of the joint points.
    area : (np,) float
        Area that each joint point stands for [m²].
    gather, scatter
        Compiled kernels ``gather(motion, geometry, opening, slip)`` and ``scatter(normal, tangential, geometry,
        force)``; the latter subtracts the forces of the joints' tractions from `force`.
    geometry
        Arrays, and groups of them, that the two kernels share.
    rigid : (nb, 3) int
        Where in the motion each block's translations along x and y [m] and its rotation [rad] stand.
    restraint
        Blocks held at points.
    block_frequency_squared : float
        Largest ω² [1/s²] of any block against its share of its joints: an upper bound of the system's.
    control : (nd,) float
        Displacement of the control point along the live load, per modal motion.
    force_unit : (nd,) float
        Force of each mode against which its unbalanced one is measured; inf where a mode is held.
    source
        What it was set up from, for observers: the wall in modal coordinates where blocks deform.
    """

    mass: Array
    stiffness: Array
    viscosity: Array
    dead: Array
    live: Array
    law: KernelLaw
    area: Array
    gather: Kernel
    scatter: Kernel
    geometry: tuple[Any, ...]
    rigid: Indices
    restraint: Restraint
    block_frequency_squared: float
    control: Array
    force_unit: Array
    source: object = None

    @property
    def freedoms(self) -> int:
        """Number of modes that move."""
        return int(np.isfinite(self.mass).sum())

    @property
    def weightless(self) -> bool:
        """Whether nothing loads it but the live load."""
        return not self.dead.any()

    def measure(self, force: Array) -> float:
        """Largest of modal forces ``(nd,)`` on what moves, each in its unit."""
        return float((np.abs(force) / self.force_unit)[np.isfinite(self.mass)].max(initial=0.0))


def force_unit(scene: Scene, block: Indices, mass: Array, live: Array, strength: PointStrength) -> Array:
    """Force by which unbalanced ones are measured, ``(nd,)``: its own block's weight, in each mode.

    A small block beside large ones falls as freely as they do, under forces that are nothing to them. Moments and
    other modal forces are those that accelerate the mode as much, F (m / m_b)^{1/2}. Without weight the force of all
    blocks is what the strongest point carries.

    Parameters
    ----------
    scene
        The wall.
    block : (nd,) int
        Block of each mode.
    mass : (nd,) float
        Modal masses, not scaled; inf where a mode is held.
    live : (nd,) float
        Modal live load.
    strength
        Strength of the joint points.
    """
    gravity = float(np.hypot(*scene.load.gravity))
    each = np.full(len(scene.blocks), strength.strongest or float(np.abs(live).max()) or 1.0)
    force = gravity * scene.mass if gravity > 0 else each
    return np.asarray(force[block] * np.sqrt(mass / scene.mass[block]))


@dataclass(eq=False)
class State:
    """Where a system is: brought forward in place by the integrator.

    Parameters
    ----------
    motion, velocity : (nd,) float
        Modal displacement, and velocity half a step behind.
    history : (rows, np) float
        History of the joint points, as their law keeps it.
    damped : (nd,) float
        Work done against damping [J], mode by mode.
    external : float
        Work of the loads [J].
    unbalanced : (nd,) float
        Force of the last step.
    steps : int
        Steps taken.
    supplied : (1,) float
        Largest energy that was found supplied at any look at it [J].
    """

    motion: Array
    velocity: Array
    history: Array
    damped: Array
    unbalanced: Array
    external: float = 0.0
    steps: int = 0
    supplied: Array = field(default_factory=lambda: np.zeros(1))

    @classmethod
    def at_rest(cls, system: BlockSystem) -> "State":
        """The undeformed system without velocity."""
        nd = len(system.mass)
        history = np.zeros((system.law.rows, system.law.points))
        return cls(np.zeros(nd), np.zeros(nd), history, np.zeros(nd), np.zeros(nd))

    def copy(self) -> "State":
        """A state that goes its own way from here."""
        return State(
            self.motion.copy(),
            self.velocity.copy(),
            self.history.copy(),
            self.damped.copy(),
            self.unbalanced.copy(),
            self.external,
            self.steps,
            self.supplied.copy(),
        )
