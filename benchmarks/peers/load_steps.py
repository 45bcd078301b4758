"""How a program that moves blocks is driven to the collapse of a wall: as the suite drives its own models.

The load is raised in steps of 0.05 of the weight, each from the last state at rest and over a ramp, and held until the
wall rests or falls; the step that brings it down is bisected. A wall falls as the suite's do: it has moved by 5 % of a
block's smaller side and does not slow down. It rests when no block has moved by a thousandth of that in each of three
looks in a row: these programs do not give the unbalanced forces by which the suite judges rest. A wall that has not
fallen after a while counts as borne too, and the bracket says that it was creeping.
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
"""Time between two looks [s]: a block that falls freely moves by 12 mm in it."""

RAMP = 5
"""Looks over which a load is raised."""

PATIENCE = 40
"""Looks after which a wall that has not fallen is said to bear its load; 1 % too much moves it by 0.1 m till then."""

REST = 1e-3
"""Motion between two looks of a wall at rest, as a share of that of a wall in collapse."""

Status: TypeAlias = Literal["collapse", "undecided", "cost only"]


@dataclass(frozen=True)
class Bracket:
    """What a program found.

    Parameters
    ----------
    lower, upper
        Largest multiplier borne, and smallest that was not; None where there was none.
    status
        ``collapse`` where the bracket is as narrow as it was to be, ``undecided`` where it is not, ``cost only`` where
        none was looked for.
    loads
        Number of loads tried.
    message
        One line for the reader.
    ratio
        Cost beside the suite's model of the kind, where there is no bracket to compare.
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
        """Bring the wall forward under its weight and a share of it, along +x; ArithmeticError where it cannot."""

    def position(self) -> Array:
        """Positions by which the wall's motion is judged, ``(n, 2)`` [m]."""

    def copy(self) -> Self:
        """Another wall in the same state."""


def by_load_steps(motion: Motion, scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Drive a wall to its collapse.

    Parameters
    ----------
    motion
        The wall, before it has come to rest under its weight.
    scene
        What it was made of.
    tolerance
        Relative width of the bracket at which to stop.
    budget
        Processor time [s] after which to stop with what there is.
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
    """Hold a load until the wall rests or falls, or patience ends."""
    start = last = motion.position()
    fall = CollapseDetector(elastic=True)  # looks are too far apart for less
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
    """Raise a load in steps, and bisect the one that is not borne; `borne` is given a load and the last one borne."""
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
    """Bisect between no load and one that no wall bears, where loads need not come in order."""
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
