"""The load path of rigid blocks to their collapse: states of rest under growing loads, and past the peak.

Loads are held one after the other until the wall rests or falls (`LoadPath.push`). Past the largest that it bears, the
displacement f_live · q that does the live load's work is prescribed instead, and λ follows (`LoadPath.follow`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from runningbond.joints.stiffness import GIVES
from runningbond.scene import Array

from .relaxation import LONGEST, Rest, relax
from .static_system import Control, StaticSystem, dot

NOISE = 1e-6
"""Multiplier, in scaled units, below which a bracket need not be relatively narrow."""

EASY = 30
"""Linear systems of a step after which the next is as long."""

LONGER, SHORTER = 1.15, 0.3
"""Bounds of the next step's length, relative to this one's."""

STRIDE = 0.05
"""Longest step of prescribed displacement, relative to the displacement so far."""

ROUNDING = 1e-12
"""Step of the displacement, relative to the displacement so far, that has no direction but rounding's."""

ATTEMPTS = ((1.0, False), (0.25, False), (1.0, True))
"""Lengths of such a step that are tried in turn, and whether the wall may creep: only where it snaps."""


@dataclass(frozen=True, eq=False)
class StaticState:
    """A state of rest."""

    x: Array  # (n,) unknowns (q, r, λ) of the `StaticSystem`
    plastic_slip: Array  # (np + nt,) history of the joint points and ties after it
    force: Array  # (np, 2) normal and tangential forces of the joint points
    displacement: float  # displacement f_live · q of the live load
    pull: Array  # (nt,) forces of the ties

    @property
    def multiplier(self) -> float:
        """λ."""
        return float(self.x[-1])


StaticObserver: TypeAlias = Callable[["LoadPath", StaticState], None]
"""Looks at a state of rest as it is found, and at the path so far, and changes nothing."""


def no_observer(path: "LoadPath", state: StaticState) -> None:
    """Observe nothing."""


@dataclass(eq=False)
class LoadPath:
    """The path of a wall to its collapse, as far as it was followed."""

    system: StaticSystem  # the static equations
    far: float  # motion of a freedom that counts as a fall, in units of the system
    budget: int  # linear systems that may still be solved
    rests: list[StaticState]  # states of rest under growing loads, the dead load's first
    elastic: float = 0.0  # motion under the live load while joints neither open nor slip
    hangs: float = 0.0  # motion until ties yield
    past: list[StaticState] = field(default_factory=list)  # states of rest past the largest load, under displacements
    upper: float | None = None  # smallest load under which the wall fell, or above which nothing stands
    unclear: list[float] = field(default_factory=list)  # loads under which it neither rested nor fell
    undecided: str = ""  # why there is no bracket
    fall: Array | None = None  # (nd,) how it was moving when it had fallen far enough
    observe: StaticObserver = no_observer  # called with every state of rest under a load that is pushed for

    @property
    def lower(self) -> float:
        """Largest load at rest."""
        return self.rests[-1].multiplier

    def fall_over(self, multiplier: float) -> float:
        """Motion under a load that counts as a fall, in units of the system: more than springs alone can give."""
        return max(self.far, GIVES * (self.elastic * abs(multiplier) + self.hangs))

    def push(self, multiplier: float, budget: int = LONGEST) -> Rest:
        """Hold a load larger than the last until the wall rests or falls, and note which."""
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
        """Find states of rest at ever larger displacements, from the last load's to a fall or the end of the budget."""
        if len(self.rests) < 2:
            return
        origin, before, last = self.rests[0].displacement, self.rests[-2], self.rests[-1]
        states, nd = [before, last], self.system.freedoms
        stride = STRIDE * (last.displacement - origin)
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
            stride = min(stride * lengthened(result.solves), STRIDE * (states[-1].displacement - origin))
        self.past = states[2:]

    def hold(
        self, start: Array, plastic_slip: Array, control: Control, budget: int = LONGEST, creeps: bool = True
    ) -> Rest:
        """Let the wall come to rest or fall, and count the linear systems."""
        far = self.fall_over(control.value) if control.multiplier else self.far
        result = relax(self.system, start, plastic_slip, control, far, min(budget, self.budget), creeps=creeps)
        self.budget -= result.solves
        return result


def lengthened(solves: int) -> float:
    """Factor of the next step after one that took some linear systems."""
    return float(np.clip(math.sqrt(EASY / max(solves, 1)), SHORTER, LONGER))


def state_of(system: StaticSystem, rest: Rest) -> StaticState:
    """A state of rest as it is kept."""
    force, joints = np.column_stack([rest.response.normal, rest.response.tangential]), len(system.equilibrium.points)
    displacement = dot(system.equilibrium.live, rest.x[: system.freedoms])
    return StaticState(rest.x, rest.response.plastic_slip, force[:joints], displacement, force[joints:, 0])
