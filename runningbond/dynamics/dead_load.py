"""Application of the dead load: at once, or slowly if joints slide or break or the wall falls under the sudden load.

Preloads of ties come with it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from runningbond.joints.law import KernelLaw
from runningbond.scene import Array

from .collapse import CALM, Criteria, Verdict, settle
from .growth import ramp
from .run import Observer, Run, no_observer
from .state import State

SUDDEN_PART = 1 / 4
"""Part of the dead load that is applied at once if all of it is too much: it overshoots to twice this part."""

SUDDEN_PART_NO_BREAK = 1 / 64
"""As `SUDDEN_PART`, where joints slide or the wall falls but nothing breaks.

After a quarter at once, thrusts were up to 40 % too small, and weightless blocks that nothing holds were thrown. Joints
that break are better off after a quarter: what is left grows in a longer time.
"""

SLIP_WORK = 1e-3
"""Fraction of the work of dead load and preloads above which friction work is more than rounding: joints have slid."""

TIGHTENINGS = 200
"""Number of increments in which ties are tightened while the remaining load grows."""

GROWTH_TIMES = 4
"""Time in which the remaining load grows, in multiples of that in which the wall rests under the first part."""


@dataclass(frozen=True, eq=False)
class UnderDeadLoad:
    """A wall under its dead load."""

    state: State
    verdict: Verdict
    rest: int  # steps to rest under a load that was applied at once
    steps: int  # steps taken, on every path


def put_on_dead_load(run: Run, criteria: Criteria, observe: Observer = no_observer) -> UnderDeadLoad:
    """Bring a wall to rest under its dead load.

    A load that is applied at once overshoots to twice its value. This matters to joints that slide, are damaged or are
    crushed, which is irreversible, and to walls that sway far: if any of this happens, the load is applied again,
    slowly. The thrusts that slip leaves may last until the wall collapses, or to the end of the way of a support.

    Joints that become softer as they open let a wall lean far before it rests, as under the live load.

    Raises
    ------
    Unstable
        As in `hold_load`.
    """
    criteria = replace(criteria, collapse=criteria.softness * criteria.collapse, shortest=0)
    state = State.at_rest(run.system)
    verdict = settle(run, state, 0.0, criteria, sudden=True)
    # A fallen wall may have no contacts left that could be broken, or have swayed twice as far as under the load alone.
    if _is_broken(run, state) or (verdict == "collapse" and _may_break(run)):
        return _slowly(run, criteria, observe, state.steps, SUDDEN_PART)
    if verdict == "collapse" or (verdict == "stable" and _has_slid(run, state)):
        return _slowly(run, criteria, observe, state.steps, SUDDEN_PART_NO_BREAK)
    for _ in range(CALM):  # observers take a wall as at rest after this many checks at rest
        observe(run, state, 0.0)
    return UnderDeadLoad(state, verdict, state.steps, state.steps)


def fall_under_dead_load(law: KernelLaw, bears: Callable[[], bool]) -> tuple[Literal["infeasible", "undecided"], str]:
    """Status and message for a wall that fell as its dead load was applied, given the law of its joints.

    The fall proves nothing if the joints keep their strength and balance the dead load (`bears`).
    """
    if not law.can_break and bears():
        return "undecided", "collapses under its dead load as it is applied, although forces exist that balance it"
    return "infeasible", "collapses under its dead load"


def _may_break(run: Run) -> bool:
    return run.interface.law.law.may_break


def _is_broken(run: Run, state: State) -> bool:
    law = run.interface.law
    return bool(law.damage(state.history).any() or law.plastic_closure(state.history).any())


def _has_slid(run: Run, state: State) -> bool:
    ledger = run.ledger(state)
    return ledger.friction > SLIP_WORK * (ledger.external - min(ledger.ties, 0.0))  # preloads do work as well


def _slowly(run: Run, criteria: Criteria, observe: Observer, before: int, part: float) -> UnderDeadLoad:
    """Apply a part of the dead load at once, and the rest evenly."""
    state, system = State.at_rest(run.system), run.system
    grown = replace(system, dead=np.zeros_like(system.dead), live=system.dead, rig=None, turning_live=None)
    growing = run.of_system(grown)
    shares = np.linspace(part, 1.0, (TIGHTENINGS if len(system.ties) else 1) + 1)
    _tighten(run, state, (part - 1.0) * system.ties.slack)
    verdict = settle(growing, state, part, criteria, sudden=True)
    rest = state.steps
    if verdict == "stable":
        for before_turn, share in pairwise(shares.tolist()):
            ramp(growing, state, before_turn, share, max(1, GROWTH_TIMES * rest // (len(shares) - 1)))
            _tighten(run, state, (share - before_turn) * system.ties.slack)
        # The growing load did about half of the work of the constant one, which the ledger takes as done and absorbed.
        missing = float(system.dead @ state.motion) - state.external
        state.external += missing
        state.absorbed += missing
        verdict = settle(run, state, 0.0, criteria, observe)
    elif verdict == "collapse" and observe is not no_observer:  # they are shown the fall under all of the load
        settle(run, State.at_rest(system), 0.0, criteria, observe, sudden=True)
    return UnderDeadLoad(state, verdict, rest, before + state.steps)


def _tighten(run: Run, state: State, by: Array) -> None:
    """Shorten ties by `by` ``(nt,)`` [m], in place; the ledger absorbs this, as if preloads did their full work."""
    before = run.ledger(state).ties
    state.stretch -= by
    state.absorbed += before - run.ledger(state).ties
