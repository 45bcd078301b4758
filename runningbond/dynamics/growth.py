"""How the load of a wall grows from one held load to the next."""

from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .collapse import Criteria
from .run import Run
from .state import State

FAST_FRACTION, FASTER = 1 / 3, 8
"""Fraction of the proved bound up to which the load of a wall with weight grows faster, and factor on its rate."""

SOFTENING_RATIO = 2.0
"""Displacement per load, relative to the smallest observed, above which the wall has begun to yield.

Up to that ratio the load also grows faster: slips then still occur one after the other.
"""

YIELD_DISPLACEMENT, LOOKS = 1.0, 8
"""Displacement, in units of collapse, at which the load stops growing, and number of checks in a load step: they lie at
the loads that bisection would try, so that models that see the same wall find the same bracket."""

PAUSES, NEARLY_AT_REST = 10, 1e-3
"""Number of pauses in a load step of a wall without weight, and unbalanced force below which the load grows again.

In such a wall the load alone presses the joints together, and joints slip for good wherever a wave takes that pressure
away. A wall with weight would chatter at such loads without end; slow growth suits it better.
"""

PAUSE_INTERVAL = 200
"""Time steps of a pause between two checks."""


def ramp(run: Run, state: State, start: float, stop: float, steps: int) -> None:
    """Raise the multiplier evenly from `start` to `stop` over a number of steps, in place."""
    run.hold(state, start, steps, rise=(stop - start) / steps, given=run.given(state))


@dataclass(eq=False)
class Growth:
    """How the load of a wall grows: slowly once the wall yields, because only then does the order of slips matter."""

    run: Run
    criteria: Criteria
    far: float  # multiplier up to which the load grows faster in any case
    unhurried: float  # steps in which it grows by the first step, or by an eighth of the load if that is more
    softest: float = np.inf  # smallest displacement per multiplier observed, in units of collapse
    slow: float = np.inf  # multiplier from which the wall yields
    # multipliers passed in the last growth of the load, each with the state of the wall there
    passed: list[tuple[float, State]] = field(default_factory=list)
    steps: int = 0  # steps taken

    def reach(self, trial: float, state: State, start: float, share: float) -> tuple[float, State]:
        """Raise the multiplier in a share of `unhurried` steps; return the multiplier reached, and the state."""
        steps = self.unhurried * share
        if self.run.system.weightless:
            return self._in_parts(trial, state, start, steps, PAUSES * share)
        return self.passed_by(trial) or self.up_to(trial, state, start, steps)

    def passed_by(self, trial: float) -> tuple[float, State] | None:
        """The multiplier (to rounding) and a copy of the wall as the load passed it; None if it did not."""
        for multiplier, state in self.passed:
            if np.isclose(multiplier, trial, rtol=1e-12, atol=0.0):
                return multiplier, state.copy()
        return None

    def up_to(self, stop: float, state: State, start: float, steps: float) -> tuple[float, State]:
        """Raise the multiplier in `steps`, or until the wall yields; return the multiplier reached, and the state."""
        begin, reached, self.passed = state.motion, start, []
        for look in range(1, LOOKS + 1):
            before, reached = reached, stop if look == LOOKS else start + (stop - start) * look / LOOKS
            state = self._onward(state, before, reached, max(1, round(steps / LOOKS)))
            if self.run.system.farthest(state.motion - begin, self.criteria.collapse) > YIELD_DISPLACEMENT:
                break
            self.passed.append((reached, state))
        return reached, state.copy()

    def _onward(self, state: State, start: float, stop: float, steps: int) -> State:
        """The wall after the multiplier has grown: fast, or, if the wall yielded, from the same start again slowly."""
        if stop <= self.far or (stop <= self.slow and self.softest < np.inf):
            grown, softness = self._grown(state, start, stop, max(1, round(steps / FASTER)))
            if stop <= self.far or softness <= SOFTENING_RATIO * self.softest:
                self.softest = min(self.softest, softness)
                return grown
            self.slow = start
        grown, softness = self._grown(state, start, stop, steps)
        self.softest = min(self.softest, softness)
        return grown

    def _grown(self, state: State, start: float, stop: float, steps: int) -> tuple[State, float]:
        grown = state.copy()
        ramp(self.run, grown, start, stop, steps)
        self.steps += grown.steps - state.steps
        moved = self.run.system.farthest(grown.motion - state.motion, self.criteria.collapse)
        return grown, moved / (stop - start)

    def _in_parts(self, stop: float, state: State, start: float, steps: float, pauses: float) -> tuple[float, State]:
        """Raise the multiplier of a wall without weight, with pauses; stop at a pause in which it does not rest."""
        grown, parts, reached = state.copy(), max(1, round(pauses)), start
        for part in range(1, parts + 1):
            before, reached = reached, stop if part == parts else start + (stop - start) * part / parts
            ramp(self.run, grown, before, reached, max(1, round(steps / parts)))
            if not self._pauses(grown, reached, state.motion):
                break
        self.steps += grown.steps - state.steps
        return reached, grown

    def _pauses(self, state: State, multiplier: float, motion: Array) -> bool:
        """Hold a load, in place, and return whether the wall nearly rests in time, without moving far from `motion`."""
        given = self.run.given(state)
        for _ in range(self.criteria.budget // PAUSE_INTERVAL):
            if self.run.unbalanced(state) < NEARLY_AT_REST:
                return True
            self.run.hold(state, multiplier, PAUSE_INTERVAL, given=given)
            if self.run.system.farthest(state.motion - motion, self.criteria.collapse) > 1:
                return False
        return False
