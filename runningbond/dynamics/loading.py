"""Steps of constant load, each held until the wall rests or falls, with slow ramps between them."""

from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .controls import ramp
from .run import Criteria, Observer, Run, Verdict, moved_by, nobody, settle
from .system import State

LOADING, LOADING_WEIGHTLESS = 16, 4
"""Times in which the load grows by its first step, in times that the wall takes to rest under that step put on at once.

A wall that is loaded faster slips in several places at once where it would slip in one after the other, and so comes
to bear more, or less.
"""

PAUSES, NEARLY = 10, 1e-3
"""How often the load of a wall without weight pauses in a step, and the unbalanced force at which it grows again.

Such a wall has no pressure on its joints but what the load gives it, and slips for good wherever a wave takes that
away. A wall with a weight chatters at such loads without end, and slow growth does it better.
"""

LOOK = 200
"""Time steps of a pause between two looks."""

RESOLVED = 10
"""Least width of a bracket, in live loads that a wall would be held to bear though nothing balances them."""

GROWTH = 1 / 8
"""Largest step, once the first ones are borne, as a fraction of the load."""

UNANSWERED = 4
"""Loads without an answer, side by side, after which a search that knows of a fall is given up; half as many end one
that knows of none. Each has cost the whole budget."""

BEYOND = 200
"""Load, in first steps, beyond which it is doubled in each: at ten weights a wall that still stands is like to lock."""


@dataclass(eq=False)
class LoadSteps:
    """What a search by steps of constant load came to.

    Parameters
    ----------
    lower, upper
        Largest multiplier that the wall bore at rest, smallest that brought it down; None where none did.
    verdict
        Of the last load tried, or ``undecided`` where loads without an answer ended the search; ``stable`` without
        `upper` where it was given up.
    borne
        State at rest under `lower`; None if not even the dead load was borne.
    fallen
        State in the collapse under `upper`.
    rests : list of (multiplier, State)
        Every state at rest, in order of load.
    taken
        Steps taken, on every path.
    interrupted
        Whether Ctrl-C ended it.
    """

    lower: float | None = None
    upper: float | None = None
    verdict: Verdict = "undecided"
    borne: State | None = None
    fallen: State | None = None
    rests: list[tuple[float, State]] = field(default_factory=list)
    taken: int = 0
    interrupted: bool = False

    def add(self, trial: float, state: State) -> None:
        """Take note of a load that held or brought the wall down, and of the wall under it."""
        if self.verdict == "stable":
            self.lower, self.borne = trial, state
            self.rests.append((trial, state))
        elif self.verdict == "collapse":
            self.upper, self.fallen = trial, state


@dataclass(frozen=True)
class Gap:
    """Loads that neither held nor fell, inside the bracket.

    Parameters
    ----------
    loads
        The loads.
    """

    loads: tuple[float, ...] = ()

    def sides(self, found: LoadSteps) -> tuple[float, float]:
        """Width of the bracket below the lowest of the loads, and above the highest."""
        return min(self.loads) - (found.lower or 0.0), (found.upper or np.inf) - max(self.loads)

    def closed(self, found: LoadSteps, width: float) -> bool:
        """Whether nothing more is to be learnt of the loads around these for a bracket of some width."""
        most = UNANSWERED // 2 if found.upper is None else UNANSWERED
        return bool(self.loads) and (len(self.loads) >= most or max(self.sides(found)) <= width / 4)

    def after(self, found: LoadSteps, trial: float) -> "Gap":
        """These loads and one more without an answer; none where the wall held above them or fell below them."""
        loads = (*self.loads, trial) if found.verdict == "undecided" else self.loads
        gap = Gap(loads)
        return gap if loads and min(gap.sides(found)) > 0 else Gap()


def load_steps(
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    *,
    most: float = np.inf,
    farthest: float | Array = np.inf,
    loading: float | None = None,
    observe: Observer = nobody,
) -> LoadSteps:
    """Raise the load step by step, each to rest, and bisect the step that brings the wall down.

    Every trial starts from the last state at rest, so that a fall leaves no trace in the states that count.
    Steps grow while they are borne, so that the first one need not know the answer's size. A load that neither
    holds nor falls is passed by, just beside it; once a fall is known the bracket closes in on such loads from both
    sides.

    Parameters
    ----------
    run
        The system.
    first
        First step of the multiplier.
    tolerance
        Relative width of the bracket at which to stop; it stops as well where the criterion of rest sees no more.
    criteria
        When a load counts as borne.
    most
        Multiplier beyond which the search is given up.
    farthest : float or (nb,) float
        Displacement [m] of any block, or of each, since the dead load was borne, beyond which it is given up.
    loading
        Time in which the load grows by its first step, or by an eighth where that is more, in times that the wall
        takes to rest under the first step put on at once; `LOADING` or `LOADING_WEIGHTLESS` where none is given.
    observe
        Called at every look.

    Returns
    -------
    LoadSteps
        Ctrl-C ends the search with what it had found.
    """
    found = LoadSteps()
    if loading is None:
        loading = LOADING_WEIGHTLESS if run.system.weightless else LOADING
    try:
        _search(found, run, first, tolerance, criteria, (most, farthest), loading, observe)
    except KeyboardInterrupt:
        found.interrupted, found.verdict = True, "undecided"
    return found


def _search(
    found: LoadSteps,
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    limits: tuple[float, float | Array],
    loading: float,
    observe: Observer,
) -> None:
    """Fill in what a search finds, as it finds it."""
    state = State.at_rest(run.system)
    found.verdict = settle(run, state, 0.0, criteria, observe, sudden=True)
    found.taken = state.steps
    if found.verdict != "stable":
        found.fallen = state
        return
    most, farthest = limits
    found.lower, found.borne = 0.0, state
    found.rests.append((0.0, state))
    probe = state.copy()
    seen = settle(run, probe, first, criteria, sudden=True) != "undecided"
    unhurried = loading * (probe.steps - state.steps) if seen else criteria.budget
    found.taken = probe.steps
    step, gap = first, Gap()
    narrowest = RESOLVED * criteria.rest / (run.system.measure(run.system.live) or 1.0)
    while found.upper is None or found.upper - found.lower > max(tolerance * found.upper, narrowest):
        if gap.closed(found, max(tolerance * (found.upper or 0.0), narrowest)):
            found.verdict = "undecided"
            return
        trial = _next_trial(found, step, gap, tolerance)
        if trial > most:
            return
        state = found.borne.copy()
        growth = 1.0 if trial > BEYOND * first and not run.system.weightless else GROWTH
        share = (trial - found.lower) / max(first, growth * trial)
        trial = _raise(run, state, found.lower, trial, unhurried * share, PAUSES * share, criteria)
        found.verdict = settle(run, state, trial, criteria, observe)
        found.taken += state.steps - found.borne.steps
        found.add(trial, state)
        gap = gap.after(found, trial)
        if found.verdict == "stable":
            if found.upper is None and moved_by(run.system, state, found.rests[0][1].motion, farthest) > 1:
                return
            if growth > GROWTH:
                step = growth * trial
            elif len(found.rests) % 3 == 0:
                step = max(step, min(2 * step, GROWTH * trial))


def _next_trial(found: LoadSteps, step: float, gap: Gap, tolerance: float) -> float:
    """Next load to try: a step up, or the middle of the bracket; beside a load without an answer, or well off two."""
    lower, upper = found.lower or 0.0, found.upper
    if not gap.loads:
        return lower + step if upper is None else (lower + upper) / 2
    low, high = min(gap.loads), max(gap.loads)
    if upper is None or len(gap.loads) == 1:
        above = high * (1 + tolerance / 4)
        return above if upper is None or upper > above else low * (1 - tolerance / 4)
    below, above = gap.sides(found)
    return (lower + low) / 2 if below > above else (high + upper) / 2


def _raise(run: Run, state: State, start: float, stop: float, steps: float, pauses: float, criteria: Criteria) -> float:
    """Raise the multiplier in some steps, in place; a wall without weight pauses, and falls where it cannot.

    Returns
    -------
    float
        The multiplier that was reached.
    """
    if not run.system.weightless:
        ramp(run, state, start, stop, round(steps))
        return stop
    motion, parts = state.motion.copy(), max(1, round(pauses))
    reached = start
    for part in range(1, parts + 1):
        before, reached = reached, stop if part == parts else start + (stop - start) * part / parts
        ramp(run, state, before, reached, round(steps / parts))
        if not _pauses(run, state, reached, motion, criteria):
            return reached
    return stop


def _pauses(run: Run, state: State, multiplier: float, motion: Array, criteria: Criteria) -> bool:
    """Hold a load, in place, until the wall is nearly at rest; not where it has come far from a motion before."""
    given = run.given(state)
    for _ in range(criteria.budget // LOOK):
        if run.unbalanced(state) < NEARLY:
            return True
        run.hold(state, multiplier, LOOK, given=given)
        if moved_by(run.system, state, motion, criteria.collapse) > 1:
            return False
    return False
