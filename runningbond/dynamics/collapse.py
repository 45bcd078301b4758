"""Holding a load until the wall is at rest or collapses, and the criteria for both."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from runningbond.scene import Array

from .run import Observer, Run, no_observer
from .state import State

CALM = 3
"""Consecutive checks at which a wall must be balanced to be at rest: a moving wall may pass through balance."""

U_CRIT = 0.05
"""Displacement beyond which a wall that does not slow down has collapsed, in block sizes (`Scene.block_sizes`).

A wall without weight may slip that far and then be held by the pressure that the slip itself causes; if it is loaded
slowly enough it does not.
"""

DRAGGED = 50_000
"""Steps after which damping no longer slows down drift, if a wall neither rests nor falls nor moves steadily.

Contacts that slip without end may vibrate for that long, and local damping slows down what drifts while it vibrates.
Walls that move steadily are left alone: combined damping dissipates more of a fall that vibrates.
"""

NEARLY_CRUSHED = 0.36
"""Share of the compressive strength above which points bend a joint wrongly by more than half a percent."""

BENDS_AT_POINTS = (
    "carry bending at points, with an error of up to 3 % that the bracket does not include; "
    "loads of arches, and of walls that hardly stand, may be off by more"
)
"""End of the note on joints that crush."""

SHORTEST_FALL = 10_000
"""Steps before which no motion under a live load is a collapse, unless it passes the last mark of `CollapseDetector`.

Where joints yield one after another a wall may soon have moved as far as others fall, and then rest as joints yield
that had hardly moved before. At finite displacements, where what falls may land on the ground, and under the dead load
falls may be shorter.
"""

Verdict: TypeAlias = Literal["stable", "collapse", "undecided"]
"""Response of a wall to a load."""


@dataclass(frozen=True)
class Criteria:
    """Criteria for rest and collapse under a held load."""

    # displacement [m] of any body, or ``(n,)`` of each, since the load was raised: the unit in which `CollapseDetector`
    # measures whether a wall that does not slow down has collapsed
    collapse: float | Array
    rest: float = 1e-5  # unbalanced force, in the system's force units, below which the wall is at rest
    budget: int = 2_000_000  # steps after which the verdict is undecided
    interval: int = 200  # steps between two checks
    softness: float = 1.0  # ratio of a wall's motion to its next rest to that to its last one
    dragged: float = DRAGGED  # steps after which damping no longer slows down drift (`DRAGGED`)
    shortest: int = SHORTEST_FALL  # steps before which no motion is a collapse (`SHORTEST_FALL`)


def settle(
    run: Run,
    state: State,
    multiplier: float,
    criteria: Criteria,
    observe: Observer = no_observer,
    *,
    sudden: bool = False,
) -> Verdict:
    """Hold a load until the wall rests or falls, and return the verdict; see `hold_load`."""
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
    """Hold a load until the wall rests or falls; return also the motion ``(nd,)`` half-way to the collapse, or None.

    The wall rests if the unbalanced force is below the threshold at `CALM` consecutive checks. It falls if it moves far
    without slowing down (`CollapseDetector`); a wall that slips and stops does not. Under a load applied at once
    (`sudden`) it must move farther to fall, because it may deform elastically first.

    Raises
    ------
    Unstable
        If more energy is spent than the load and the initial state can have supplied.
    """
    start, begun, given = state.motion.copy(), state.steps, run.given(state)
    detector = CollapseDetector(
        elastic=sudden or run.system.weightless, shortest=min(criteria.shortest, criteria.budget // 2)
    )
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
        if detector.goes_on(run.system.farthest(state.motion - start, criteria.collapse), state.steps - begun):
            return "collapse", halfway
        if detector.marks > marks:
            halfway = state.motion.copy()
    return "undecided", None


class CollapseDetector:
    """Detector of collapse: the wall has moved by one unit, and no slower in the second half than in the first.

    A distance of `EARLY` units is enough if the same held at half of it. A motion that does slow down is a collapse at
    the last of the marks, ``2**FARTHEST`` units.

    Parameters
    ----------
    elastic
        Whether elastic deformation may reach a good part of the unit, so that the wall must move the whole unit: under
        a suddenly applied load, or without weight, where only the load presses the joints together.
    shortest
        Steps before which no motion is a collapse unless it passes the last mark.
    """

    FARTHEST = 4
    """Number of doublings of the unit after which even a motion that slows down counts as a collapse."""

    SLACK = 1.1
    """Ratio of times per distance up to which a motion has not slowed down: the speed of sliding contacts varies."""

    EARLY = 0.5
    """Part of the unit, a power of two, after which a motion that never slowed down is a collapse.

    Dry walls that came to a stop had slowed down by then, and a fall at constant speed takes twice the steps for one
    unit.
    """

    def __init__(self, *, elastic: bool = False, shortest: int = 0) -> None:
        self.shortest = shortest
        # The fourth mark is EARLY (steady for the second time); if elastic, the third is the unit.
        first = -2 if elastic else int(math.log2(self.EARLY)) - 3
        self._marks = [2.0**k for k in range(first, self.FARTHEST + 1)]
        self._passed: list[int] = []
        self._steady = 0

    @property
    def marks(self) -> int:
        """Number of marks passed, each twice as far as the one before."""
        return len(self._passed)

    @property
    def steady(self) -> bool:
        """Whether the motion had not slowed down over the last half of its distance."""
        return self._steady > 0

    def goes_on(self, moved: float, steps: int) -> bool:
        """Whether a wall that has moved this far after this many steps under the load has collapsed."""
        while self.marks < len(self._marks) and moved > (mark := self._marks[self.marks]):
            self._passed.append(steps)
            if len(self._passed) >= 3:
                first, second, third = self._passed[-3:]
                # The distance from the second mark to the third is twice that from the first to the second. Marks
                # passed within one check contain no information on the speed.
                steady = 0 < third - second <= 2 * self.SLACK * (second - first)
                self._steady = self._steady + 1 if steady else 0
            falls = self._steady >= (1 if mark >= 1 else 2) and steps >= self.shortest
            if falls or self.marks == len(self._marks):
                return True
        return False


def crushing_note(run: Run, state: State) -> str:
    """Note on joints that are crushed in a state, or nearly; empty if none is.

    Of nine points an end point stands for 1/72 of a joint. Where it bears all, a continuous joint has a toe of that
    share of the joint times the pressure over the strength, whose resultant lies half of this farther inwards.
    """
    law, (_, _, normal, _) = run.interface_of(state).law, run.tractions(state)
    if law.crushed(state.history).any():
        joints = "crushed joints"
    elif (-normal > NEARLY_CRUSHED * law.compressive_strength).any():
        joints = "joints near their compressive strength"
    else:
        return ""
    return f"{joints} {BENDS_AT_POINTS}"
