"""Search for the collapse load of a wall with a program that integrates the motion of blocks, as in the suite's models.

The load is raised in steps of 0.05 of the weight, each from the last state at rest and over a ramp, and held until the
wall rests or falls; the step under which it falls is bisected. The criterion of collapse is the suite's: a displacement
of 5 % of a block's smaller side that does not slow down. A wall rests if no block has moved by a thousandth of that in
each of three looks in a row, because these programs do not return the unbalanced forces by which the suite judges rest.
A load under which the wall has not fallen after `PATIENCE` looks counts as carried, and the message of the bracket says
that the wall was creeping.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, Self, TypeAlias

import numpy as np

from runningbond.dynamics.collapse import CALM, U_CRIT, CollapseDetector
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.scene import Array, Scene

LOOK = 0.05
"""Time between two looks at the wall [s]; a block in free fall moves by 12 mm in it."""

RAMP = 5
"""Number of looks over which a load is raised."""

PATIENCE = 40
"""Number of looks after which a wall that has not fallen counts as stable; 1 % too much load moves it 0.1 m by then."""

REST = 1e-3
"""Largest motion of a wall at rest between two looks, relative to the displacement at collapse."""

Status: TypeAlias = Literal["collapse", "undecided", "cost only"]


@dataclass(frozen=True)
class Bracket:
    """Result of a program.

    Parameters
    ----------
    lower, upper
        Largest multiplier that was carried, and smallest that was not; None if there was none.
    status
        ``collapse`` if the bracket is as narrow as requested, ``undecided`` if it is not, ``cost only`` if no bracket
        was computed.
    loads
        Number of loads tried.
    message
        One line for the reader.
    ratio
        Cost relative to the suite's model of the same kind, if there is no bracket to compare.
    """

    lower: float | None
    upper: float | None
    status: Status
    loads: int
    message: str = ""
    ratio: float | None = None


class Motion(Protocol):
    """A wall in motion in some program."""

    def hold(self, multiplier: float, seconds: float) -> None:
        """Integrate the motion under the weight and `multiplier` times it along +x; ArithmeticError if that fails."""

    def position(self) -> Array:
        """Positions by which the wall's motion is judged, ``(n, 2)`` [m]."""

    def copy(self) -> Self:
        """Another wall in the same state."""


def by_load_steps(motion: Motion, scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Bracket the collapse load of a wall by load steps.

    Parameters
    ----------
    motion
        The wall, before it has come to rest under its weight.
    scene
        Scene of the wall.
    tolerance
        Relative width of the bracket at which to stop.
    budget
        Processor time [s] after which to stop with the bracket so far.
    """
    far = U_CRIT * scene.block_size
    verdict = settle(motion, 0.0, far)
    if verdict == "collapse":
        return Bracket(None, None, "undecided", 1, "falls under its weight")
    remarks = {verdict: None}
    state = motion

    def borne(multiplier: float, lower: float) -> bool:
        nonlocal state
        raised = state.copy()
        try:
            for k in range(RAMP):
                raised.hold(lower + (multiplier - lower) * (k + 0.5) / RAMP, LOOK)
            verdict = settle(raised, multiplier, far)
        except ArithmeticError as error:
            remarks[str(error)] = None
            return False
        remarks[verdict] = None
        if verdict == "collapse":
            return False
        state = raised
        return True

    found = _search(borne, tolerance, budget)
    said = [remark for remark in remarks if remark not in ("rest", "collapse")]
    return Bracket(
        found.lower, found.upper, found.status, found.loads + 1, "; ".join([*said, found.message]).strip("; ")
    )


def settle(motion: Motion, multiplier: float, far: float) -> str:
    """Hold a load until the wall rests or falls, or `PATIENCE` is exceeded; returns the verdict."""
    start = last = motion.position()
    fall = CollapseDetector(elastic=True)  # looks are too far apart for the early criterion
    calm = 0
    for look in range(1, PATIENCE + 1):
        motion.hold(multiplier, LOOK)
        now = motion.position()
        calm = calm + 1 if np.abs(now - last).max() < REST * far else 0
        if calm == CALM:
            return "rest"
        if fall.goes_on(float(np.abs(now - start).max()) / far, look):
            return "collapse"
        last = now
    return "creeps under loads that it bears"


def _search(borne: Callable[[float, float], bool], tolerance: float, budget: float) -> Bracket:
    """Raise the load in steps and bisect the one not carried; `borne` receives a load and the last one carried."""
    start = time.process_time()
    loads, lower, upper = 0, 0.0, None
    while upper is None or upper - lower > tolerance * upper:
        if time.process_time() - start > budget:
            return Bracket(lower, upper, "undecided", loads, f"stopped after {budget:.0f} s")
        trial = lower + FIRST_STEP if upper is None else (lower + upper) / 2
        loads += 1
        if borne(trial, lower):
            lower = trial
        else:
            upper = trial
    return Bracket(lower, upper, "collapse", loads)


def bisect(borne: Callable[[float], bool], upper: float, tolerance: float, budget: float) -> Bracket:
    """Bisect between zero and a load that no wall carries, for programs that can try loads in any order."""
    start = time.process_time()
    loads, lower = 0, 0.0
    while upper - lower > tolerance * upper:
        if time.process_time() - start > budget:
            return Bracket(lower, upper, "undecided", loads, f"stopped after {budget:.0f} s")
        trial = (lower + upper) / 2
        loads += 1
        if borne(trial):
            lower = trial
        else:
            upper = trial
    return Bracket(lower, upper, "collapse", loads)
