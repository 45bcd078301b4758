"""The dead load put on a wall: at once, and slowly where that breaks joints, or brings down walls, that it need not.

Preloads of ties come with it. A beam that is held at its height from then on keeps what thrust there is, and ties that
have drawn blocks along have lost their preload: there the load comes slowly as well where joints have slid.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from runningbond.joints.law import PLASTIC_CLOSURE, KernelLaw
from runningbond.scene import Array

from .collapse import CALM, Criteria, Verdict, settle
from .controls import ramp
from .run import Observer, Run, no_observer
from .state import State

ELASTIC = 1 / 4
"""Part of the dead load that is put on at once where all of it is too much: it overshoots to half."""

HARDLY = 1 / 64
"""As `ELASTIC`, where joints must not slide either: after a quarter at once thrusts were up to two fifths too small."""

SLID = 1e-3
"""Part of the work of the dead load and of preloads beyond which what friction took of it is no rounding."""

TURNS = 200
"""Turns in which ties are tightened to the rest of their preloads meanwhile."""

GROWTH_TIMES = 4
"""Times in which the rest of it grows, in times that the wall takes to rest under that part."""


@dataclass(frozen=True, eq=False)
class UnderDeadLoad:
    """A wall under its dead load."""

    state: State
    verdict: Verdict
    rest: int  # steps that it took to rest under a load that was put on at once
    steps: int  # steps taken, on every path


def put_on_dead_load(run: Run, criteria: Criteria, observe: Observer = no_observer) -> UnderDeadLoad:
    """Bring a wall to rest under its dead load.

    A load that is put on at once overshoots to twice itself, which matters to joints that keep what it does, and to
    walls that sway far: where any joint is damaged, or crushed, or the wall falls, it is loaded again, slowly. Friction
    remembers too, of which a mechanism asks nothing unless its beam is held at its height, and what bore the overshoot
    then presses too little; or ties are preloaded, which go slack, and leave blocks apart, as these slide too far.

    Raises
    ------
    Unstable
        As of `hold_load`.
    """
    state, keeps = State.at_rest(run.system), keeps_what_it_does(run)
    held = len(run.system.late) > 0 or bool(run.system.ties.slack.any())
    unseen = keeps or held
    verdict = settle(run, state, 0.0, criteria, no_observer if unseen else observe, sudden=True)
    # What has fallen may have no contacts left to be broken, or have swayed twice as far as the load alone moves it.
    if _is_broken(run, state) or verdict == "collapse":
        return _slowly(run, criteria, observe, state.steps)
    if held and verdict == "stable" and _has_slid(run, state):
        return _slowly(run, criteria, observe, state.steps, HARDLY)
    for _ in range(CALM if unseen else 0):  # observers take a wall to be at rest that is so at as many looks
        observe(run, state, 0.0)
    return UnderDeadLoad(state, verdict, state.steps, state.steps)


def fall_under_dead_load(law: KernelLaw, bears: Callable[[], bool]) -> tuple[Literal["infeasible", "undecided"], str]:
    """Status and message of a wall that fell as its dead load was put on, of joints of a law.

    It proves nothing where these keep their strength and, which `bears` says, balance that load.
    """
    if not law.can_break and bears():
        return "undecided", "collapses under its dead load as it was put on, though forces exist that balance it"
    return "infeasible", "collapses under its dead load"


def keeps_what_it_does(run: Run) -> bool:
    """Whether joints may be damaged or crushed for good, by a load that would not do so had it come slowly."""
    law = run.interface.law.law
    return law.damage is not None or PLASTIC_CLOSURE in law.history


def _is_broken(run: Run, state: State) -> bool:
    law = run.interface.law
    return bool(law.damage(state.history).any() or law.plastic_closure(state.history).any())


def _has_slid(run: Run, state: State) -> bool:
    ledger = run.ledger(state)
    return ledger.friction > SLID * (ledger.external - min(ledger.ties, 0.0))  # what preloads gave is work as well


def _slowly(run: Run, criteria: Criteria, observe: Observer, before: int, part: float = ELASTIC) -> UnderDeadLoad:
    """Put on a part of the dead load at once, and the rest evenly."""
    state, system = State.at_rest(run.system), run.system
    grown = replace(system, dead=np.zeros_like(system.dead), live=system.dead, rig=None, pushing=None)
    growing = run.of_system(grown)
    shares = np.linspace(part, 1.0, (TURNS if len(system.ties) else 1) + 1)
    _tighten(run, state, (part - 1.0) * system.ties.slack)
    verdict = settle(growing, state, part, criteria, sudden=True)
    rest = state.steps
    if verdict == "stable":
        for before_turn, share in pairwise(shares.tolist()):
            ramp(growing, state, before_turn, share, max(1, GROWTH_TIMES * rest // (len(shares) - 1)))
            _tighten(run, state, (share - before_turn) * system.ties.slack)
        # The ledger has the dead load do its whole work.
        state.turned += state.external - float(system.dead @ state.motion)
        verdict = settle(run, state, 0.0, criteria, observe)
    return UnderDeadLoad(state, verdict, rest, before + state.steps)


def _tighten(run: Run, state: State, by: Array) -> None:
    """Shorten ties by so much each ``(nt,)`` [m], in place; the ledger has their preloads do their whole work."""
    before = run.ledger(state).ties
    state.stretch -= by
    state.absorbed += before - run.ledger(state).ties
