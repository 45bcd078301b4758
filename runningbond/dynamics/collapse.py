"""A load held until the wall is at rest or in collapse: when it counts as the one, and when as the other."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from runningbond.scene import Array

from .run import Observer, Run, no_observer
from .state import State

CALM = 3
"""Looks in a row at which a wall must be balanced to be at rest: one in full motion may pass through balance."""

U_CRIT = 0.05
"""Displacement at which a wall that does not slow down is in collapse, in block sizes (`Scene.block_sizes`).

A wall without weight may slip as far and be caught by the pressure that the slip itself brings about; loaded slowly
enough it does not.
"""

DRAGGED = 50_000
"""Steps after which a wall that neither rests nor falls, and does not get on steadily, is damped not to be dragged on.

Contacts that slip without an end may shake for as long, and local damping drags on what drifts while it shakes. What
speeds up all the same is left alone: damping that is combined takes more of a fall that rings.
"""

Verdict: TypeAlias = Literal["stable", "collapse", "undecided"]
"""What a wall does under a load."""


@dataclass(frozen=True)
class Criteria:
    """When a held load has been borne, and when it has brought the wall down."""

    # displacement [m] of any body, or ``(n,)`` of each, since the load was raised: the unit in which
    # `CollapseDetector` measures whether a wall that does not slow down is in collapse
    collapse: float | Array
    rest: float = 1e-5  # unbalanced force, in the system's units, below which the wall is at rest
    budget: int = 2_000_000  # steps after which the question is left undecided
    interval: int = 200  # steps between two looks
    dragged: float = DRAGGED  # steps after which what drifts is not dragged on


def settle(
    run: Run,
    state: State,
    multiplier: float,
    criteria: Criteria,
    observe: Observer = no_observer,
    *,
    sudden: bool = False,
) -> Verdict:
    """Hold a load until the wall rests or falls, and say which; see `hold_load`."""
    return hold_load(run, state, multiplier, criteria, observe, sudden=sudden)[0]


def hold_load(
    run: Run,
    state: State,
    multiplier: float,
    criteria: Criteria,
    observe: Observer = no_observer,
    *,
    sudden: bool = False,
) -> tuple[Verdict, Array | None]:
    """Hold a load until the wall rests or falls; of a fall, also the motion ``(nd,)`` when it had come half as far.

    It rests when the unbalanced force is below the threshold at `CALM` looks in a row. It falls when it has moved far
    and does not slow down (`CollapseDetector`), so that a wall that slips and is caught is not mistaken for one in
    collapse; one on which a `sudden` load was put may give way elastically first.

    Raises
    ------
    Unstable
        If it spends more energy than the load and the state at the start can have supplied.
    """
    start, given = state.motion.copy(), run.given(state)
    detector = CollapseDetector(elastic=sudden or run.system.weightless)
    halfway = start
    calm, late, drags_less = 0, criteria.dragged / criteria.interval, False
    for look in range(criteria.budget // criteria.interval):
        if look >= late and not detector.steady and not drags_less:
            run, drags_less = run.drifting, True
        run.hold(state, multiplier, criteria.interval, given=given)
        observe(run, state, multiplier)
        calm = calm + 1 if run.unbalanced(state) < criteria.rest else 0
        if calm == CALM:
            return "stable", None
        marks = detector.marks
        if detector.goes_on(run.system.farthest(state.motion - start, criteria.collapse), state.steps):
            return "collapse", halfway
        if detector.marks > marks:
            halfway = state.motion.copy()
    return "undecided", None


class CollapseDetector:
    """Whether a motion is a collapse: it has come a unit, and no slower over the last half of its way than before.

    `EARLY` is enough where the same held when it had come half as far. A motion that does slow down is a collapse
    once it has come `FARTHEST` doublings of the unit.

    Parameters
    ----------
    elastic
        Whether springs may take up a good part of the unit, so that it has to come the whole: under a load put on at
        once, or in a wall without weight, whose joints hold by nothing but what the load presses them together.
    """

    FARTHEST = 4
    """Doublings after which a motion that does slow down counts as collapse all the same."""

    SLACK = 1.1
    """How much slower than before is not yet slower: sliding contacts chatter, and their speed with them."""

    EARLY = 0.5
    """Part of the unit, a power of two, after which a motion that never slowed is a collapse.

    Dry walls that were caught had slowed by then, and a fall at constant speed takes twice the steps for the whole.
    """

    def __init__(self, *, elastic: bool = False) -> None:
        # Steady at EARLY for the second time, or at the unit for the first, is at the fourth mark, or the third.
        first = -2 if elastic else int(math.log2(self.EARLY)) - 3
        self._marks = [2.0**k for k in range(first, self.FARTHEST + 1)]
        self._passed: list[int] = []
        self._steady = 0

    @property
    def marks(self) -> int:
        """Marks that were passed, each twice as far as the one before."""
        return len(self._passed)

    @property
    def steady(self) -> bool:
        """Whether it had not slowed over the last half of its way."""
        return self._steady > 0

    def goes_on(self, moved: float, steps: int) -> bool:
        """Whether a wall that has moved so far after so many steps is in collapse."""
        while self.marks < len(self._marks) and moved > (mark := self._marks[self.marks]):
            self._passed.append(steps)
            if len(self._passed) >= 3:
                first, second, third = self._passed[-3:]
                # The way from the second mark to the third is twice as long as that from the first to the second.
                # Marks passed in one look say nothing of the speed.
                steady = 0 < third - second <= 2 * self.SLACK * (second - first)
                self._steady = self._steady + 1 if steady else 0
            if self._steady >= (1 if mark >= 1 else 2) or self.marks == len(self._marks):
                return True
        return False
