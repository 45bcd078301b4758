"""A fall under a constant load, and the energy ledger of that fall counted again where blocks chatter.

Models count the work of viscosity with the traction of the last step, which takes two rows of history less. Where
contacts open and close all the time, as between blocks that slide without rest, that is several percent too much, and
the ledger does not close although the motion is right. With the mean traction of two steps, as central differences
have it, the same motion is followed again.
"""

from dataclasses import dataclass, replace

import numpy as np

from runningbond.joints.wall_law import counted_in_impacts

from .collapse import Criteria, Verdict, hold_load, settle
from .run import Run
from .state import State


@dataclass(frozen=True, eq=False)
class Fall:
    """A fall: the wall as its load stopped growing, and how that load was held."""

    run: Run
    start: State
    multiplier: float
    criteria: Criteria

    def goes_on(self, end: State, since: State) -> Verdict:
        """Verdict on a fall that is followed from its `end` on, until the wall has moved again by all since a rest."""
        unit = self.run.system.farthest(end.motion - since.motion, self.criteria.collapse)
        criteria = replace(self.criteria, collapse=self.criteria.collapse * max(1.0, unit))
        return settle(self.run, end.copy(), self.multiplier, criteria)

    def unaccounted(self, since: State) -> float | None:
        """As `Run.unaccounted` at the end of the fall, with mean tractions; None for a law that has no such ledger."""
        system = self.run.system
        law = counted_in_impacts(system.interface.law)
        if law is None:
            return None
        run = self.run.of_system(replace(system, interface=replace(system.interface, law=law)))
        state, before = (_with_rows(each, law.rows) for each in (self.start, since))
        hold_load(run, state, self.multiplier, self.criteria)
        return run.unaccounted(state, since=before)


def _with_rows(state: State, rows: int) -> State:
    """A copy of a state whose history ``(rows, np)`` has further rows of zeros."""
    missing = rows - len(state.history)
    return replace(state.copy(), history=np.vstack([state.history, np.zeros((missing, state.history.shape[1]))]))
