"""A beam driven along its path, from equilibrium to equilibrium."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runningbond.dynamics.path_curve import BEAM_ANSWER, BEAM_DIFFERS, growth_left, other_way
from runningbond.scene import Array

from .lead import StaticLead
from .load_path import NOISE, StaticState
from .static_system import Control, dot

REGULARISATION = 1e-6
"""Part of the elastic stiffness that open points keep in the tangent of a first guess, which makes it regular."""


@dataclass(frozen=True, eq=False)
class StaticBeamDrive(StaticLead):
    """The drive of a beam: values are displacements since the rest under the dead load, in units of f_live · q."""

    may_lock = True
    answer = BEAM_ANSWER

    @cached_property
    def least(self) -> float:
        """Reaction [N] below which the tolerance of its bracket is absolute, not relative."""
        return NOISE * self.system.equilibrium.live_unit

    @cached_property
    def metre(self) -> float:
        """Displacement [m] at a value of 1."""
        return self.system.equilibrium.force_unit / self.system.equilibrium.live_unit * self.system.length_unit

    @property
    def joule(self) -> float:
        """Work on the wall [J] of a unit force along values from 0 to 1."""
        return self.metre

    @cached_property
    def goals(self) -> Array:
        """Prescribed values at the ends of the path's legs, in order."""
        if self.scene.drive is None:
            raise TypeError("the scene has no driven beam")
        return self.scene.drive.force[0] * np.array(self.scene.drive.path) / self.metre

    @cached_property
    def elastic_step(self) -> float:
        """Displacement of the elastic wall under `first_step`."""
        system = self.system
        load = np.append(np.zeros(system.unknowns - 1), self.first_step)
        step = system.solve(system.elastic, Control(self.first_step, multiplier=True), load)
        return abs(dot(system.equilibrium.live, step[: system.freedoms]))

    def control(self, value: float) -> Control:
        """Control equation that prescribes a displacement."""
        return Control(self.origin.displacement + value, multiplier=False)

    def value(self, state: StaticState) -> float:
        """Displacement in a state."""
        return state.displacement - self.origin.displacement

    def elastically(self, now: StaticState, value: float) -> Array:
        """Unknowns at a displacement, if no further point opens and none slides farther."""
        response = self.system.respond(now.x, now.plastic_slip)
        pressed = (response.normal != 0)[:, None, None]
        tangent = self.system.elastic * np.where(pressed, 1.0, REGULARISATION)
        ahead = self.control(value)
        right = np.append(np.zeros(self.system.unknowns - 1), ahead.value - now.displacement)
        return np.asarray(now.x + self.system.solve(tangent, ahead, right))

    def answering(self, force: Array) -> int:
        """Number of the state with the largest reaction."""
        return int(force.argmax())

    def moving(self, value: Array) -> tuple[int, int]:
        """Numbers of the farthest state and of the one before."""
        farthest = int(value.argmax())
        return max(farthest - 1, 0), farthest

    def reached(self, curve: Array) -> float:
        """Largest displacement [m] of a curve ``(n, 2)``."""
        return float(curve[:, 0].max())

    def growth_left(self, curve: Array) -> float:
        """Reaction [N] by which the largest of a curve ``(n, 2)`` may grow beyond the end of its path."""
        return growth_left(curve)

    def unfinished(self, curve: Array) -> tuple[str, bool]:
        """Note on a wall that still hardens: its answer can only become larger."""
        return "the wall still hardens where its drive ends, which takes", False

    def other_way(self, curve: Array) -> str:
        """Note on the largest reaction in the other direction of a cyclic drive; empty for others."""
        return other_way(self.goals, curve)

    def doubt(self, states: Sequence[StaticState], works: Array, tolerance: float) -> str:
        """Note on a reaction that depends on how joints slid."""
        until = self.answering(np.array([self.force(state) for state in states])) + 1
        return self.friction_note(states[:until], works[:until], tolerance, BEAM_DIFFERS)
