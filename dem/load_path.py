"""Load path of rigid blocks to their collapse: equilibria under growing loads, and past the peak.

Each load is held until the wall rests or falls (`LoadPath.push`). Past the largest load that the wall carries, the
work-conjugate displacement f_live · q of the live load is prescribed instead, and λ follows (`LoadPath.follow`).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from runningbond.joints.stiffness import GIVES
from runningbond.scene import Array

from .relaxation import MAX_SOLVES, Rest, relax
from .static_system import Control, StaticSystem, dot

NOISE = 1e-6
"""Multiplier, in scaled units, below which the tolerance of a bracket is absolute, not relative."""

TARGET_SOLVES = 30
"""Linear systems in a step after which the next step has the same length; fewer lengthen it, more shorten it."""

MAX_GROWTH, MIN_GROWTH = 1.15, 0.3
"""Bounds of the next step's length, relative to the present step."""

MAX_STRIDE = 0.05
"""Longest step of the prescribed displacement, relative to the displacement so far."""

ROUNDING = 1e-12
"""Step of the displacement, relative to the displacement so far, below which its direction is only rounding."""

ATTEMPTS = ((1.0, False), (0.25, False), (1.0, True))
"""Factors of such a step that are tried in turn, and whether the wall may creep then: as a last resort, if it snaps."""


@dataclass(frozen=True, eq=False)
class StaticState:
    """A state of equilibrium."""

    x: Array  # (n,) unknowns (q, r, λ) of the `StaticSystem`
    plastic_slip: Array  # (np + nt,) history of the joint points and ties after this state
    force: Array  # (np, 2) normal and tangential forces of the joint points
    displacement: float  # displacement f_live · q of the live load
    pull: Array  # (nt,) forces of the ties

    @property
    def multiplier(self) -> float:
        """λ."""
        return float(self.x[-1])


StaticObserver: TypeAlias = Callable[["LoadPath", StaticState], None]
"""Callback with each equilibrium as it is found and the path so far; it must not change them."""


def no_observer(path: "LoadPath", state: StaticState) -> None:
    """Observe nothing."""


@dataclass(eq=False)
class LoadPath:
    """Load path of a wall to its collapse, as far as it has been followed."""

    system: StaticSystem  # the static equations
    far: float  # motion of a freedom that counts as a fall, in units of the system
    budget: int  # linear systems that may still be solved
    rests: list[StaticState]  # equilibria under growing loads, that of the dead load first
    elastic: float = 0.0  # motion under a unit live load while joints neither open nor slip
    hangs: float = 0.0  # motion until ties yield
    past: list[StaticState] = field(default_factory=list)  # equilibria past the largest load, under displacements
    upper: float | None = None  # smallest load under which the wall fell, or above which it cannot stand
    unclear: list[float] = field(default_factory=list)  # loads under which the wall neither rested nor fell
    undecided: str = ""  # why there is no bracket
    fall: Array | None = None  # (nd,) motion in the last time step of the fall
    observe: StaticObserver = no_observer  # called with every equilibrium that `push` finds

    @property
    def lower(self) -> float:
        """Largest load at rest."""
        return self.rests[-1].multiplier

    def fall_over(self, multiplier: float) -> float:
        """Motion that counts as a fall under a load, in units of the system: far beyond elastic motion."""
        return max(self.far, GIVES * (self.elastic * abs(multiplier) + self.hangs))

    def push(self, multiplier: float, budget: int = MAX_SOLVES) -> Rest:
        """Hold a load above the last one until the wall rests or falls, and record the result."""
        last = self.rests[-1]
        start = np.append(last.x[:-1], multiplier)
        result = self.hold(start, last.plastic_slip, Control(multiplier, multiplier=True), budget)
        if result.verdict == "rest":
            self.rests.append(state_of(self.system, result))
            self.observe(self, self.rests[-1])
        elif result.verdict == "fall":
            self.upper, self.fall = multiplier, result.last
        return result

    def follow(self, budget: int) -> None:
        """Find equilibria at growing displacements, from the last load to a fall, failed step or the budget's end."""
        if len(self.rests) < 2:
            return
        origin, before, last = self.rests[0].displacement, self.rests[-2], self.rests[-1]
        states, nd = [before, last], self.system.freedoms
        stride = MAX_STRIDE * (last.displacement - origin)
        while budget > 0 and stride > 0 and np.abs(states[-1].x[:nd] - last.x[:nd]).max() < self.far:
            before, now = states[-2:]
            advance = now.displacement - before.displacement
            if abs(advance) <= ROUNDING * abs(now.displacement - origin):
                break
            onward = (now.x - before.x) / advance
            for share, creeps in ATTEMPTS:
                ahead = share * stride
                control = Control(now.displacement + ahead)
                result = self.hold(now.x + ahead * onward, now.plastic_slip, control, budget, creeps)
                budget -= result.solves
                if result.verdict == "rest":
                    break
            else:
                break
            stride = ahead
            states.append(state_of(self.system, result))
            stride = min(stride * lengthened(result.solves), MAX_STRIDE * (states[-1].displacement - origin))
        self.past = states[2:]

    def hold(
        self, start: Array, plastic_slip: Array, control: Control, budget: int = MAX_SOLVES, creeps: bool = True
    ) -> Rest:
        """Bring the wall to rest or to its fall, and count the linear systems."""
        far = self.fall_over(control.value) if control.multiplier else self.far
        result = relax(self.system, start, plastic_slip, control, far, min(budget, self.budget), creeps=creeps)
        self.budget -= result.solves
        return result


def lengthened(solves: int) -> float:
    """Factor of the next step's length after a step that took `solves` linear systems."""
    return float(np.clip(math.sqrt(TARGET_SOLVES / max(solves, 1)), MIN_GROWTH, MAX_GROWTH))


def state_of(system: StaticSystem, rest: Rest) -> StaticState:
    """State to be stored from the result of `relax`."""
    force, joints = np.column_stack([rest.response.normal, rest.response.tangential]), len(system.equilibrium.points)
    displacement = dot(system.equilibrium.live, rest.x[: system.freedoms])
    return StaticState(rest.x, rest.response.plastic_slip, force[:joints], displacement, force[joints:, 0])


def friction_work(system: StaticSystem, states: Sequence[StaticState]) -> float:
    """Work of friction [J] from the first to the last of some states."""
    count = len(states[0].force)
    slid = (np.abs(after.plastic_slip - before.plastic_slip)[:count] for before, after in pairwise(states))
    shear = (np.abs(after.force[:, 1] + before.force[:, 1]) / 2 for before, after in pairwise(states))
    work = sum(float(each @ way) for each, way in zip(shear, slid, strict=True))
    return work * system.equilibrium.force_unit * system.length_unit
