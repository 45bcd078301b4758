"""The pushover curve of rigid blocks: states of equilibrium at growing displacements of the live load.

Steps are controlled by the displacement f_live · q that does the live load's work, so the curve goes on past its
peak. Each step is implicit: plastic slip is the history at its beginning. A step of which no equilibrium is found
is tried shorter and longer in turn, for two things end a step: too many joints that change at once, and a snap,
where the wall has no equilibrium nearby and a longer step lands beyond it.
"""

from dataclasses import dataclass

import numpy as np

from scene import Array

from .relaxation import LEAST_PROXIMAL, Rest, relax
from .static_system import Control, StaticSystem

EASY = 25
"""Linear systems of a step after which the next is as long."""

LONGER, SHORTER = 1.5, 0.7
"""Bounds of the next step's length, relative to this one's."""

ATTEMPTS = ((1.0, 200), (0.25, 200), (4.0, 200), (1.0, 1000), (0.25, 1000), (4.0, 1000), (16.0, 1000))
"""Lengths, relative to the step that was meant, that are tried in turn, and the linear systems given to each."""


@dataclass(frozen=True, eq=False)
class State:
    """A state of equilibrium.

    Parameters
    ----------
    x : (n,) float
        Unknowns (q, r, λ) of the `StaticSystem`.
    plastic_slip : (np,) float
        History of the joint points after it.
    force : (np, 2) float
        Normal and tangential forces of the joint points.
    displacement : float
        Displacement f_live · q of the live load.
    """

    x: Array
    plastic_slip: Array
    force: Array
    displacement: float

    @property
    def multiplier(self) -> float:
        """λ."""
        return float(self.x[-1])


@dataclass(eq=False)
class Curve:
    """Successive states of equilibrium, of which `push` finds one after the other.

    Parameters
    ----------
    system
        The static equations.
    states
        The states, the one under the dead load alone first.
    solves
        Linear systems solved.
    """

    system: StaticSystem
    states: list[State]
    solves: int

    @property
    def displacement(self) -> Array:
        """Displacement of the live load since the dead load, ``(n,)``."""
        return np.array([state.displacement for state in self.states]) - self.states[0].displacement

    @property
    def multiplier(self) -> Array:
        """λ of every state, ``(n,)``."""
        return np.array([state.multiplier for state in self.states])

    @property
    def moved(self) -> float:
        """Largest motion of a block since the dead load: a displacement, or a rotation times the block size."""
        nd = self.system.freedoms
        return float(np.abs(self.states[-1].x[:nd] - self.states[0].x[:nd]).max())

    def push(self, step: float) -> tuple[float, int] | None:
        """Add a state, if possible a given step further.

        Returns
        -------
        tuple or None
            The step that was made, and the linear systems solved in it alone; None where the curve broke off.
        """
        last = self.states[-1]
        for share, patience in ATTEMPTS:
            length = share * step
            control = Control(last.displacement + length)
            rest = relax(self.system, self._foreseen(length), last.plastic_slip, control, patience)
            self.solves += rest.solves
            if rest.balanced:
                self.states.append(_state(self.system, rest, control.value))
                return length, rest.solves
        return None

    def _foreseen(self, step: float) -> Array:
        """Unknowns at the end of a step, by the elastic tangent at first and then by the step before."""
        last = self.states[-1]
        if len(self.states) == 1:
            return last.x + step * elastic_response(self.system)
        before = self.states[-2]
        return last.x + step / (last.displacement - before.displacement) * (last.x - before.x)


def elastic_response(system: StaticSystem) -> Array:
    """Unknowns ``(n,)`` that the elastic wall adds where the live load moves by one unit."""
    right = np.zeros(system.unknowns)
    right[-1] = 1.0
    return system.solve(system.elastic, LEAST_PROXIMAL, Control(1.0), right)


def _state(system: StaticSystem, rest: Rest, displacement: float) -> State:
    force = np.column_stack([rest.response.normal, rest.response.tangential])
    return State(rest.x, rest.response.plastic_slip, force, displacement)


def under_dead_load(system: StaticSystem) -> Curve | None:
    """A curve's first state, balanced by the dead load alone; None where there is none to be found."""
    nothing = np.zeros(len(system.law.normal_stiffness))
    rest = relax(system, np.zeros(system.unknowns), nothing, Control(0.0, multiplier=True), patience=1000)
    if not rest.balanced:
        return None
    displacement = float(system.equilibrium.live @ rest.x[: system.freedoms])
    return Curve(system, [_state(system, rest, displacement)], rest.solves)
