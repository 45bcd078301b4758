"""What drives a wall from equilibrium to equilibrium, along a path of prescribed displacements."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from runningbond.dynamics.path_curve import friction_note
from runningbond.limit.settlement import reaction_unit
from runningbond.scene import Array, Scene

from .load_path import StaticState, friction_work
from .static_system import Control, StaticSystem

MIN_STEPS = 25
"""Smallest number of steps in each leg of a path, from one reversal to the next, in the first traverse."""

STEP_GROWTH = 1.3
"""Ratio of a step's length to that of the step before, up to the longest step, in the first traverse."""


def reaction(system: StaticSystem, state: StaticState) -> float:
    """Reaction of a drive along its first move [N], or the share of the dead load on supports that settle."""
    equations, jump = system.equilibrium, system.support_jump
    if jump is None:
        return equations.live_unit * state.multiplier
    work = float((jump[:, : len(state.force)] * state.force.T).sum() + jump[0, len(state.force) :] @ state.pull)
    return -work * equations.force_unit * system.length_unit / reaction_unit(equations.scene)


@dataclass(frozen=True, eq=False)
class StaticLead(ABC):
    """What drives a wall along a path of prescribed values, and what its curve of displacements and forces says."""

    may_lock: ClassVar[bool] = False  # whether joint forces may balance any multiple of the answer

    system: StaticSystem
    origin: StaticState  # at rest under the dead load
    first_step: float  # load of the first, elastic step

    @property
    @abstractmethod
    def answer(self) -> str:
        """Name of the answer, the reaction of the drive [N] or a share of the dead load."""

    @property
    @abstractmethod
    def least(self) -> float:
        """Answer below which the tolerance of its bracket is absolute, not relative."""

    @property
    @abstractmethod
    def metre(self) -> float:
        """Displacement [m] at a value of 1."""

    @property
    @abstractmethod
    def joule(self) -> float:
        """Work on the wall [J] of a unit force along values from 0 to 1."""

    @property
    @abstractmethod
    def goals(self) -> Array:
        """Prescribed values at the ends of the path's legs, in order."""

    @property
    @abstractmethod
    def elastic_step(self) -> float:
        """Value of the elastic wall under `first_step`."""

    @abstractmethod
    def control(self, value: float) -> Control:
        """Control equation that prescribes a value."""

    @abstractmethod
    def value(self, state: StaticState) -> float:
        """Prescribed value in a state."""

    @abstractmethod
    def elastically(self, now: StaticState, value: float) -> Array:
        """Unknowns at a value, if no further point opens and none slides farther."""

    @abstractmethod
    def answering(self, force: Array) -> int:
        """Number of the state at which the answer is reached, from the forces of all ``(n,)``."""

    @abstractmethod
    def moving(self, value: Array) -> tuple[int, int]:
        """Numbers of the states between which motion is drawn, from the values of all ``(n,)``."""

    @abstractmethod
    def reached(self, curve: Array) -> float:
        """Displacement [m] up to which a curve ``(n, 2)`` goes."""

    @abstractmethod
    def unfinished(self, curve: Array) -> tuple[str, bool]:
        """Note on a curve ``(n, 2)`` whose mechanism has not formed, and whether its answer can only become smaller."""

    def growth_left(self, curve: Array) -> float:
        """Force by which the answer of a curve ``(n, 2)`` may grow beyond the end of its path."""
        return 0.0

    def has_formed(self, curve: Array, tolerance: float) -> bool:
        """Whether, apart from `growth_left`, the answer no longer changes by more than a tolerance."""
        return True

    def other_way(self, curve: Array) -> str:
        """Note on the largest reaction in the other direction; may be empty."""
        return ""

    def doubt(self, states: Sequence[StaticState], works: Array, tolerance: float) -> str:
        """Note on an answer that may differ by more than its bracket, from works of the drive ``(n,)`` [J] so far."""
        return ""

    def friction_note(self, states: Sequence[StaticState], works: Array, tolerance: float, differs: str) -> str:
        """The note of `friction_note` for states on the way to an answer, and works of the drive ``(n,)`` [J]."""
        friction = friction_work(self.system, states)
        return friction_note(self.scene, friction, works, self.least_work, tolerance, differs=differs)

    @property
    def least_work(self) -> float:
        """Work [J] below which that of the drive need not be accurate relative to itself."""
        return 0.0

    def has_come_free(self, state: StaticState) -> bool:
        """Whether supports that move carry nothing."""
        return False

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.system.equilibrium.scene

    def stops(self, share: float) -> Iterator[tuple[float, bool]]:
        """Yield the values to hold along the path, each with whether it begins a leg; `share` scales the steps."""
        at = 0.0
        for goal in self.goals:
            lengths, longest = [0.0], abs(goal - at) / MIN_STEPS
            step = min(self.elastic_step, longest)
            while lengths[-1] < abs(goal - at):
                lengths.append(lengths[-1] + share * step)
                step = min(step * STEP_GROWTH**share, longest)
            for k, length in enumerate(lengths[1:]):
                yield float(at + (goal - at) * length / lengths[-1]), k == 0
            at = goal

    def force(self, state: StaticState) -> float:
        """Force in a state, as from `reaction`."""
        return reaction(self.system, state)

    def onward(self, before: StaticState, now: StaticState, value: float) -> Array:
        """Unknowns at a value, extrapolated linearly from the last step."""
        ahead = (value - self.value(now)) / (self.value(now) - self.value(before))
        return np.asarray(now.x + ahead * (now.x - before.x))
