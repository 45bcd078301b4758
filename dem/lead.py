"""What drives a wall: prescribed displacements of its beam or its supports, and the reaction to them."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runningbond.limit.kinematics import control_row
from runningbond.limit.settlement import largest_displacement, reaction_unit
from runningbond.scene import Array, Scene

from .pushover import StaticState
from .static_system import Control, StaticSystem, dot

MIN_STEPS = 25
"""Smallest number of steps in the longest leg of a path, from one reversal to the next, in the first run."""

STEP_GROWTH = 1.3
"""Ratio of a step's length to that of the step before, up to the longest step, in the first run."""

REGULARISATION = 1e-6
"""Part of the elastic stiffness that open points keep in the tangent of a first guess, which makes it regular."""


def reaction(system: StaticSystem, state: StaticState) -> float:
    """Reaction of a drive along its first move [N], or the share of the dead load on supports that settle."""
    equations, jump = system.equilibrium, system.support_jump
    if jump is None:
        return equations.live_unit * state.multiplier
    work = float((jump[:, : len(state.force)] * state.force.T).sum() + jump[0, len(state.force) :] @ state.pull)
    return -work * equations.force_unit * system.length_unit / reaction_unit(equations.scene)


@dataclass(frozen=True, eq=False)
class StaticLead:
    """What drives a wall: the beam's drive, or the supports with a share of their settlement."""

    system: StaticSystem
    origin: StaticState  # at rest under the dead load
    first_step: float  # load of the first, elastic step

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.system.equilibrium.scene

    @property
    def settles(self) -> bool:
        """Whether supports are moved, not the beam."""
        return self.scene.settlement is not None

    @cached_property
    def metre(self) -> float:
        """Displacement [m] that counts as 1: the prescribed settlement, or the unit of f_live · q."""
        if self.settles:
            moved = float(control_row(self.scene) @ self.scene.support_motion.ravel())
            return moved or largest_displacement(self.scene)
        return self.system.equilibrium.force_unit / self.system.equilibrium.live_unit * self.system.length_unit

    @cached_property
    def joule(self) -> float:
        """Work on the wall [J] of a unit force on a path of unit length."""
        return -reaction_unit(self.scene) if self.settles else self.metre

    @cached_property
    def goals(self) -> Array:
        """Prescribed values at the ends of the path's legs, in order."""
        drive = self.scene.drive
        if self.scene.settlement is not None:
            return np.array(self.scene.settlement.path)
        return np.ones(1) if drive is None else drive.force[0] * np.array(drive.path) / self.metre

    @cached_property
    def elastic_step(self) -> float:
        """Length of the first step: the elastic wall's displacement, or share of settlement, under `first_step`."""
        system = self.system
        if system.support_jump is not None:
            return self.first_step / float(np.abs(system.support_jump).max())
        load = np.append(np.zeros(system.unknowns - 1), self.first_step)
        step = system.solve(system.elastic, Control(self.first_step, multiplier=True), load)
        return abs(dot(system.equilibrium.live, step[: system.freedoms]))

    def stops(self, share: float) -> Iterator[tuple[float, bool]]:
        """Yield the values to hold along the path, each with whether it begins a leg; `share` scales the steps."""
        at, goals = 0.0, self.goals
        longest = np.abs(np.diff(goals, prepend=0.0)).max() / MIN_STEPS
        for goal in goals:
            lengths = [0.0]
            step = min(self.elastic_step, longest)
            while lengths[-1] < abs(goal - at):
                lengths.append(lengths[-1] + share * step)
                step = min(step * STEP_GROWTH**share, longest)
            for k, length in enumerate(lengths[1:]):
                yield float(at + (goal - at) * length / lengths[-1]), k == 0
            at = goal

    def control(self, value: float) -> Control:
        """Control equation that prescribes a value."""
        return Control(value if self.settles else self.origin.displacement + value, multiplier=self.settles)

    def value(self, state: StaticState) -> float:
        """Prescribed value in a state."""
        return state.multiplier if self.settles else state.displacement - self.origin.displacement

    def force(self, state: StaticState) -> float:
        """Force in a state, as from `reaction`."""
        return reaction(self.system, state)

    def onward(self, before: StaticState, now: StaticState, value: float) -> Array:
        """Unknowns at a value, extrapolated linearly from the last step."""
        ahead = (value - self.value(now)) / (self.value(now) - self.value(before))
        return np.asarray(now.x + ahead * (now.x - before.x))

    def elastically(self, now: StaticState, value: float) -> Array:
        """Unknowns at a value, if no further point opens and none slides farther."""
        if self.settles:
            return np.append(now.x[:-1], value)
        response = self.system.respond(now.x, now.plastic_slip)
        pressed = (response.normal != 0)[:, None, None]
        tangent = self.system.elastic * np.where(pressed, 1.0, REGULARISATION)
        ahead = self.control(value)
        right = np.append(np.zeros(self.system.unknowns - 1), ahead.value - now.displacement)
        return np.asarray(now.x + self.system.solve(tangent, ahead, right))
