"""Steps of constant load, each held until the wall rests or falls, with slow ramps between them."""

from dataclasses import dataclass, field, replace

import numpy as np

from runningbond.scene import Array

from .collapse import CALM, CollapseDetector, Criteria, Verdict, hold_load, settle
from .dead_load import put_on_dead_load
from .growth import FAR, Growth
from .run import Observer, Run, no_observer
from .state import State

LOADING, LOADING_WEIGHTLESS = 24, 4
"""Times in which the load grows by its first step, in times that the wall takes to rest under that step put on at once.

A wall that is loaded faster slips in several places at once where it would slip in one after the other, and so comes
to bear more, or less.
"""

RESOLVED = 10
"""Least width of a bracket, in live loads that a wall would be held to bear though nothing balances them."""

GROWTH = 1 / 8
"""Largest step, once the first ones are borne, as a fraction of the load."""

MOST_UNDECIDED = 4
"""Undecided loads, side by side, after which a search that has seen a fall ends; half as many end one that has seen
none. Each has cost the whole budget."""

UNDECIDED_BUDGETS = 3
"""Budgets that may be spent on undecided loads, wherever they are, before a search ends."""

DOUBLED_BEYOND = 200
"""Load, in first steps, beyond which it is doubled in each: at ten weights a wall that stands probably locks."""


@dataclass(eq=False)
class LoadSteps:
    """Result of a search by steps of constant load."""

    # largest multiplier that the wall bore at rest, smallest that brought it down; None where none did
    lower: float | None = None
    upper: float | None = None
    # of the last load tried, or ``undecided`` where undecided loads ended the search; ``stable`` without `upper`
    # where it ended beyond the largest load or displacement
    verdict: Verdict = "undecided"
    borne: State | None = None  # state at rest under `lower`; None if not even the dead load was borne
    fallen: State | None = None  # state in the collapse under `upper`, or under the dead load
    tried_from: float | None = None  # multiplier at rest from which the load last grew to `upper`
    # (nd,) where the wall was on its way to that collapse, the latest first: half the way before, then each rest
    fall_starts: list[Array] = field(default_factory=list)
    # every state at rest and its multiplier, in order of load
    rests: list[tuple[float, State]] = field(default_factory=list)
    steps: int = 0  # steps taken, on every path
    interrupted: bool = False  # whether Ctrl-C ended it
    far: bool = False  # whether it ended as a body, at rest, had come beyond the largest displacement

    @property
    def width(self) -> float:
        """Width of the bracket, infinite until a load brings the wall down."""
        return np.inf if self.upper is None else self.upper - (self.lower or 0.0)

    def add(self, trial: float, state: State, verdict: Verdict, halfway: Array | None) -> None:
        """Take note of a load and of the wall under it."""
        self.verdict = verdict
        if self.verdict == "stable":
            if self.upper is not None and trial >= self.upper:  # on a way with more rests than that of the fall
                self.upper, self.fallen = None, None
            self.lower, self.borne = trial, state
            self.rests.append((trial, state))
        elif self.verdict == "collapse":
            self.upper, self.fallen = trial, state
            rests = [rest.motion for _, rest in reversed(self.rests)]
            self.fall_starts = rests if halfway is None else [halfway, *rests]
        if trial == self.upper:
            self.verdict, self.tried_from = "collapse", self.lower  # it has fallen there, if without an answer now


@dataclass(frozen=True)
class UndecidedLoads:
    """Undecided loads inside the bracket."""

    loads: tuple[float, ...] = ()

    def sides(self, result: LoadSteps) -> tuple[float, float]:
        """Width of the bracket below the lowest of the loads, and above the highest."""
        return min(self.loads) - (result.lower or 0.0), (result.upper or np.inf) - max(self.loads)

    def closed(self, result: LoadSteps, width: float) -> bool:
        """Whether loads around these would make a bracket of some width no narrower."""
        most = MOST_UNDECIDED // 2 if result.upper is None else MOST_UNDECIDED
        return bool(self.loads) and (len(self.loads) >= most or max(self.sides(result)) <= width / 4)

    def after(self, result: LoadSteps, trial: float) -> "UndecidedLoads":
        """These loads and one more if it is undecided; none where the wall held above them or fell below them."""
        undecided = UndecidedLoads((*self.loads, trial) if result.verdict == "undecided" else self.loads)
        return undecided if undecided.loads and min(undecided.sides(result)) > 0 else UndecidedLoads()


def load_steps(
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    *,
    most: float = np.inf,
    farthest: float | Array = np.inf,
    loading: float | None = None,
    bound: float | None = None,
    observe: Observer = no_observer,
) -> LoadSteps:
    """Raise the load step by step, each to rest, and bisect the step that brings the wall down.

    Every trial starts from the last state at rest, or from the wall as it was when the load grew through that trial
    slowly, so that a fall leaves no trace in the states that count.
    Steps grow while they are borne, so that the first one need not know the answer's size. An undecided load is passed
    by, just beside it; once a fall is known the bracket closes in on such loads from both sides. A wall without weight,
    and one that came far at rest in the last step, is in the end brought to the load under which it fell from the
    largest that it bore, and goes on if it bears it.

    Parameters
    ----------
    first
        First step of the multiplier. It is doubled as long as the wall bears it, put on at once, with nothing lost.
    tolerance
        Relative width of the bracket at which to stop; it stops as well where the criterion of rest sees no more.
    most
        Multiplier beyond which the search ends.
    farthest : float or (n,) float
        Displacement [m] of any body, or of each, since the dead load was borne, beyond which it ends.
    loading
        Time in which the load grows by its first step, or by an eighth where that is more, in times that the wall
        takes to rest under the first step put on at once; `LOADING` or `LOADING_WEIGHTLESS` where none is given.
    bound
        Multiplier that is proved too large, where one is: far below it the load grows faster (elsewhere where the wall
        does not give way, `Growth`), and none that is much larger is tried unless the wall bears it.

    Returns
    -------
    LoadSteps
        Ctrl-C ends the search with the result so far.
    """
    if loading is None:
        loading = LOADING_WEIGHTLESS if run.system.weightless else LOADING
    search = _Search(run, first, tolerance, criteria, most, farthest, bound or 0.0, loading, observe)
    try:
        search.go()
    except KeyboardInterrupt:
        search.result.interrupted, search.result.verdict = True, "undecided"
    return search.result


@dataclass(eq=False)
class _Search:
    """A search as it goes on; parameters are those of `load_steps`."""

    run: Run
    first: float
    tolerance: float
    criteria: Criteria
    most: float
    farthest: float | Array
    bound: float  # 0 for none
    loading: float
    observe: Observer
    result: LoadSteps = field(default_factory=LoadSteps)
    undecided: UndecidedLoads = UndecidedLoads()

    def go(self) -> None:
        """Fill in the result."""
        result, system = self.result, self.run.system
        loaded = put_on_dead_load(self.run, self.criteria, self.observe)
        state, result.verdict, result.steps = loaded.state, loaded.verdict, loaded.steps
        if result.verdict != "stable":
            result.fallen = state
            return
        result.add(0.0, state, "stable", None)
        self.run = self.run.held_late(state)
        grows, in_vain = self._load_at_once(), 0
        step = max(self.first, GROWTH * result.rests[-1][0])
        while (trial := self._next_trial(step)) is not None and trial <= self.most:
            growth = 1.0 if trial > DOUBLED_BEYOND * self.first and not system.weightless else GROWTH
            (lower, borne), before = result.rests[-1], grows.steps
            trial, state = grows.reach(trial, borne, lower, (trial - lower) / max(self.first, growth * trial))
            held = state.steps
            verdict, halfway = hold_load(self.run, state, trial, self._criteria(borne), self.observe)
            taken = grows.steps - before + state.steps - held
            result.steps += taken
            result.add(trial, state, verdict, halfway)
            in_vain += taken if verdict == "undecided" else 0
            if in_vain > UNDECIDED_BUDGETS * self.criteria.budget:
                return
            self.undecided = self.undecided.after(result, trial)
            if verdict == "stable":
                moved = system.farthest(state.motion - result.rests[0][1].motion, self.farthest)
                if result.upper is None and moved > 1:
                    result.far = True
                    return
                if growth > GROWTH:
                    step = growth * trial
                elif len(result.rests) % 3 == 0:
                    step = max(step, min(2 * step, GROWTH * trial))

    def _criteria(self, borne: State) -> Criteria:
        """When a load brings down a wall that bears the one before: it moves as far again as it has come at rest.

        Where joints are soft beside the load, one more step moves it farther than what is a fall of others. Walls
        without weight come by another way to the load under which they fell.
        """
        if self.run.system.weightless:
            return self.criteria
        moved = borne.motion - self.result.rests[0][1].motion
        come = self.run.system.farthest(moved, self.criteria.collapse)
        return replace(self.criteria, collapse=self.criteria.collapse * max(1.0, come))

    def _load_at_once(self) -> Growth:
        """Put the first step on at once, and the same again while nothing is lost: elastic walls know no order.

        Returns how the load grows from there.
        """
        result, run, criteria = self.result, self.run, self.criteria
        dead, load, unhurried, softness = result.rests[0][1], self.first, 0.0, np.inf
        while load == self.first or load <= min(self.most, self.bound or np.inf):
            borne, loaded = result.rests[-1][1], result.rests[-1][1].copy()
            verdict = settle(run, loaded, load, criteria, sudden=True)
            taken = loaded.steps - borne.steps
            result.steps += taken
            if load == self.first:
                # A wall that comes to rest slowly is loaded as slowly as the budget allows.
                unhurried = criteria.budget if verdict == "undecided" else min(self.loading * taken, criteria.budget)
            if verdict != "stable" or not loaded.has_lost_nothing_since(borne):
                break
            result.add(load, loaded, "stable", None)
            for _ in range(CALM):  # observers take a wall to be at rest that is so at as many looks
                self.observe(run, loaded, load)
            softness = run.system.farthest(loaded.motion - dead.motion, criteria.collapse) / load
            load *= 2
        return Growth(run, criteria, FAR * self.bound, unhurried, softness)

    def _next_trial(self, step: float) -> float | None:
        """Next load to try; None where the bracket is narrow enough, or around undecided loads."""
        result, system = self.result, self.run.system
        narrowest = RESOLVED * self.criteria.rest / (system.measure(system.live) or 1.0)
        enough = max(self.tolerance * (result.upper or 0.0), narrowest)
        if result.width > enough:
            if not self.undecided.closed(result, enough):
                return _next_load(result, step, self.undecided, self.tolerance, self.bound)
            result.verdict = "undecided"
            return None
        # A wall without weight snaps, and may be carried past a rest where the load comes from far away. One that sways
        # may have been on its way to one.
        wants_more = result.tried_from != result.lower and (system.weightless or self._sways())
        return result.upper if wants_more else None

    def _sways(self) -> bool:
        """Whether the wall, at rest, came half as far as may count as a fall from where the load last grew to one."""
        result = self.result
        if result.lower is None or result.tried_from is None:
            return False
        start, end = (
            next(state for load, state in result.rests if load == at) for at in (result.tried_from, result.lower)
        )
        moved = self.run.system.farthest(end.motion - start.motion, self.criteria.collapse)
        return moved > CollapseDetector.EARLY / 2


def _next_load(result: LoadSteps, step: float, undecided: UndecidedLoads, tolerance: float, bound: float) -> float:
    """Next load to try: a step up, or the middle of the bracket; beside an undecided load, or well off two."""
    lower, upper = result.lower or 0.0, result.upper
    if not undecided.loads:
        if upper is not None:
            return (lower + upper) / 2
        # Just above the bound a wall falls ever so slowly: not where the first step alone is beyond it.
        edge = bound * (1 + tolerance / 2)
        return edge if 0 < lower < edge < lower + step else lower + step
    low, high = min(undecided.loads), max(undecided.loads)
    if upper is None or len(undecided.loads) == 1:
        above = high * (1 + tolerance / 4)
        return above if upper is None or upper > above else low * (1 - tolerance / 4)
    below, above = undecided.sides(result)
    return (lower + low) / 2 if below > above else (high + upper) / 2
