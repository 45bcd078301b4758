"""How the load of a wall grows from one load that is held to the next."""

from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .collapse import Criteria
from .controls import ramp
from .run import Run
from .state import State

FAR, FASTER = 1 / 3, 8
"""Part of a bound of the load up to which a wall with a weight is loaded faster, and how much faster."""

SOFTER = 2.0
"""How much farther than where it was stiffest a wall goes with the load where it has begun to give way.

Until then it is loaded faster as well: what slips there slips one after the other all the same.
"""

GIVES_WAY, LOOKS = 1.0, 8
"""Motion, in units of collapse, at which a load grows no more, and looks at it in a step of the load: at those loads
that bisection would try, so that models that see the same wall find the same bracket."""

PAUSES, NEARLY_AT_REST = 10, 1e-3
"""How often the load of a wall without weight pauses in a step, and the unbalanced force at which it grows again.

Such a wall has no pressure on its joints but what the load gives it, and slips for good wherever a wave takes that
away. A wall with a weight chatters at such loads without end, and slow growth does it better.
"""

PAUSE_INTERVAL = 200
"""Time steps of a pause between two looks."""


@dataclass(eq=False)
class Growth:
    """How the load of a wall grows: slowly once the wall gives way, which is when the order of slips counts."""

    run: Run
    criteria: Criteria
    far: float  # multiplier up to which it grows faster whatever the wall does
    unhurried: float  # steps in which it grows by the first step, or by an eighth where that is more
    softest: float = np.inf  # least motion per multiplier that was seen, in units of collapse
    slow: float = np.inf  # multiplier from which the wall gives way
    # multipliers that growth has passed since the last one that grew, each with the wall then
    passed: list[tuple[float, State]] = field(default_factory=list)
    steps: int = 0  # steps taken

    def reach(self, trial: float, state: State, start: float, share: float) -> tuple[float, State]:
        """Raise the multiplier in a share of the unhurried steps; what it reached, and the wall then."""
        steps = self.unhurried * share
        if self.run.system.weightless:
            return self._in_parts(trial, state, start, steps, PAUSES * share)
        return self.passed_by(trial) or self.up_to(trial, state, start, steps)

    def passed_by(self, trial: float) -> tuple[float, State] | None:
        """The multiplier, but for rounding, and a copy of the wall as it grew through it; None where it did not."""
        for multiplier, state in self.passed:
            if np.isclose(multiplier, trial, rtol=1e-12, atol=0.0):
                return multiplier, state.copy()
        return None

    def up_to(self, stop: float, state: State, start: float, steps: float) -> tuple[float, State]:
        """Raise the multiplier in some steps, until the wall gives way; what it reached, and the wall then."""
        begin, reached, self.passed = state.motion, start, []
        for look in range(1, LOOKS + 1):
            before, reached = reached, stop if look == LOOKS else start + (stop - start) * look / LOOKS
            state = self._onward(state, before, reached, max(1, round(steps / LOOKS)))
            if self.run.system.farthest(state.motion - begin, self.criteria.collapse) > GIVES_WAY:
                break
            self.passed.append((reached, state))
        return reached, state.copy()

    def _onward(self, state: State, start: float, stop: float, steps: int) -> State:
        """The wall after the multiplier has grown: faster first, and slowly after all where it gave way to that."""
        if stop <= self.far or (stop <= self.slow and self.softest < np.inf):
            grown, softness = self._grown(state, start, stop, max(1, round(steps / FASTER)))
            if stop <= self.far or softness <= SOFTER * self.softest:
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
        """Raise the multiplier of a wall without weight: it pauses, and falls where it cannot."""
        grown, parts, reached = state.copy(), max(1, round(pauses)), start
        for part in range(1, parts + 1):
            before, reached = reached, stop if part == parts else start + (stop - start) * part / parts
            ramp(self.run, grown, before, reached, max(1, round(steps / parts)))
            if not self._pauses(grown, reached, state.motion):
                break
        self.steps += grown.steps - state.steps
        return reached, grown

    def _pauses(self, state: State, multiplier: float, motion: Array) -> bool:
        """Hold a load, in place, until the wall is nearly at rest; not where it has come far from a motion before."""
        given = self.run.given(state)
        for _ in range(self.criteria.budget // PAUSE_INTERVAL):
            if self.run.unbalanced(state) < NEARLY_AT_REST:
                return True
            self.run.hold(state, multiplier, PAUSE_INTERVAL, given=given)
            if self.run.system.farthest(state.motion - motion, self.criteria.collapse) > 1:
                return False
        return False
