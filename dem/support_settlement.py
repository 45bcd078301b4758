"""Supports that settle along their path, from equilibrium to equilibrium."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runningbond.dynamics.path_curve import LITTLE, SUPPORT_ANSWER, SUPPORT_DIFFERS, formed, shedding
from runningbond.limit.kinematics import control_row
from runningbond.limit.settlement import largest_displacement, reaction_unit
from runningbond.results import Supports
from runningbond.scene import Array

from .lead import StaticLead
from .load_path import StaticState
from .static_system import Control


@dataclass(frozen=True, eq=False)
class StaticSettlement(StaticLead):
    """The supports that settle: values are shares of their settlement."""

    answer = SUPPORT_ANSWER
    least = LITTLE

    @cached_property
    def metre(self) -> float:
        """Displacement [m] at a value of 1."""
        moved = float(control_row(self.scene) @ self.scene.support_motion.ravel())
        return moved or largest_displacement(self.scene)

    @cached_property
    def joule(self) -> float:
        """Work on the wall [J] of a unit share along values from 0 to 1."""
        return -reaction_unit(self.scene)

    @cached_property
    def goals(self) -> Array:
        """Prescribed shares at the ends of the path's legs, in order."""
        if self.scene.settlement is None:
            raise TypeError("no support of the scene settles")
        return np.array(self.scene.settlement.path)

    @cached_property
    def elastic_step(self) -> float:
        """Share of the settlement that loads the elastic wall by `first_step`."""
        if self.system.support_jump is None:
            raise TypeError("no support of the system settles")
        return self.first_step / float(np.abs(self.system.support_jump).max())

    def control(self, value: float) -> Control:
        """Control equation that prescribes a share."""
        return Control(value, multiplier=True)

    def value(self, state: StaticState) -> float:
        """Share of the settlement in a state."""
        return state.multiplier

    def elastically(self, now: StaticState, value: float) -> Array:
        """Unknowns of a state at another share."""
        return np.append(now.x[:-1], value)

    def answering(self, force: Array) -> int:
        """Number of the last state."""
        return len(force) - 1

    def moving(self, value: Array) -> tuple[int, int]:
        """Numbers of the first and the farthest state."""
        return 0, int(np.abs(value).argmax())

    def reached(self, curve: Array) -> float:
        """Settlement [m] at the end of a curve ``(n, 2)``."""
        return float(abs(curve[-1, 0]))

    def has_formed(self, curve: Array, tolerance: float) -> bool:
        """Whether the share no longer changes at the end of a curve ``(n, 2)``."""
        return formed(curve, tolerance)

    def unfinished(self, curve: Array) -> tuple[str, bool]:
        """Note on a share that still changes, and whether it can only become smaller."""
        falls, changes = shedding(curve)
        return f"the support still {changes} where its settlement ends, it bears", falls

    @property
    def least_work(self) -> float:
        """Work [J] below which that of the supports need not be accurate relative to itself."""
        return LITTLE * abs(self.joule)

    def doubt(self, states: Sequence[StaticState], works: Array, tolerance: float) -> str:
        """Note on a share that depends on how joints slid."""
        return self.friction_note(states, works, tolerance, SUPPORT_DIFFERS)

    def has_come_free(self, state: StaticState) -> bool:
        """Whether supports that move carry nothing."""
        return Supports(self.scene, self.system.equilibrium.points).have_come_free(state.force, state.pull)
