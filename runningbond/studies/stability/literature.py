"""Walls whose collapse load is known, and the motion in which they fall.

While a wall falls in one motion, its blocks' displacements u φ with the largest translation u, the loads drive it by
(λ − λ_c) F, F = f_live · φ, against the inertia M = Σ m φ² of its blocks. Local damping takes a share α of every
unbalanced force, and mass-proportional damping c M u̇ of the driving one:

    (M / F) ü = (1 − α) ((λ − λ_c) − c (M / F) u̇).                                                            (1)

Friction follows the pressure, and the pressure the inertia of what moves; (1) leaves that out. It is exact for a
block, whose pressure does not change.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dem import limit_nonassociated
from dem.rigid_system import rigid_system
from runningbond.dynamics import BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.scene import Array, Scene

from .blocks import one_block, rounded

RAMP = 4
"""Length of a ramp to a load, in times that the wall took to rest under its weight."""

SLIDES, TOPPLES = 0.4, 0.5
"""tan φ of the block that slides, and b/h of the one that topples."""


@dataclass(frozen=True, eq=False)
class KnownWall:
    """A wall under its weight and a lateral load, with the load that brings it down.

    Parameters
    ----------
    name
        What to call it.
    scene
        The wall.
    multiplier
        λ at which it falls.
    motion : (nb, 3) float
        The motion in which it falls, to any scale [m, m, rad].
    """

    name: str
    scene: Scene
    multiplier: float
    motion: Array

    @cached_property
    def system(self) -> BlockSystem:
        """Its rigid blocks."""
        return rigid_system(self.scene)

    @property
    def far(self) -> float:
        """Displacement [m] by which the suite judges whether it falls."""
        return U_CRIT * self.scene.block_size

    @cached_property
    def mechanism(self) -> Array:
        """φ, the motion with a largest translation of one, ``(nd,)``."""
        phi = np.zeros(len(self.system.mass))
        phi[self.system.rigid] = self.motion / np.abs(self.motion[:, :2]).max()
        return phi

    @cached_property
    def inertia(self) -> float:
        """M / F of (1) [s²/m]: what the wall weighs in its motion, for each newton that drives it."""
        system, phi = self.system, self.mechanism
        moving = np.isfinite(system.mass)
        return float((system.mass[moving] * phi[moving] ** 2).sum() / (system.live @ phi))

    @cached_property
    def unrest(self) -> float:
        """Largest unbalanced force, in the system's units, for each unit of λ − λ_c."""
        system, phi = self.system, self.mechanism
        moving = np.isfinite(system.mass)
        return system.measure(np.where(moving, np.where(moving, system.mass, 0.0) * phi / self.inertia, 0.0))

    def rest(self, local: float = LOCAL, viscous: float = VISCOUS) -> tuple[Run, State]:
        """Its blocks at rest under their weight."""
        run = Run(self.system, local=local, viscous=viscous)
        state = State.at_rest(self.system)
        assert settle(run, state, 0.0, Criteria(collapse=self.far)) == "stable"
        return run, state


def sliding_block() -> KnownWall:
    """A block twice as long as high: λ = tan φ."""
    return _known("block that slides", one_block(0.24, 0.12, SLIDES, 1e10), SLIDES)


def toppling_block() -> KnownWall:
    """A block twice as high as long: λ = b/h."""
    return _known("block that topples", one_block(0.12, 0.12 / TOPPLES, 0.9, 1e10), TOPPLES)


def rounded_wall(name: str) -> KnownWall:
    """A published wall with rounded corners, whose one collapse load limit analysis certifies."""
    return _known(f"rounded {name.removeprefix('wall-').upper()}", rounded(name))


def _known(name: str, scene: Scene, exact: float | None = None) -> KnownWall:
    """A wall with its load as it is known, or as limit analysis with true friction certifies it."""
    certified = limit_nonassociated(scene)
    assert certified.multiplier is not None
    return KnownWall(name, scene, exact or certified.multiplier, certified.motion)
