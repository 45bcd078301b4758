"""Steps of constant load, each held until the wall rests or falls, with slow ramps between them."""

from dataclasses import dataclass, field, replace

import numpy as np

from runningbond.scene import Array

from .collapse import CALM, CollapseDetector, Criteria, Verdict, hold_load, settle
from .dead_load import put_on_dead_load
from .fall import Fall
from .growth import FAST_FRACTION, Growth
from .run import Observer, Run, no_observer
from .state import State

LOADING, LOADING_WEIGHTLESS = 24, 4
"""Time in which the load grows by its first step, in multiples of the time to rest under this step applied at once.

A wall that is loaded faster slips in several places at once where it would slip in one after the other, and therefore
carries more, or less.
"""

RESOLVED = 10
"""Smallest width of a bracket, in live loads that would pass as at rest even if nothing balanced them."""

GROWTH = 1 / 8
"""Largest step after the first ones, as a fraction of the load."""

FEW_POINTS = 4.0
"""Softness of joints that become little softer as they open: 1 for two points, 2 for the elements of `fem`."""

MOST_UNDECIDED = 4
"""Number of adjacent undecided loads that ends a search if any load led to collapse; half as many end it otherwise.
Each has cost the whole budget."""

UNDECIDED_BUDGETS = 3
"""Number of budgets that may be spent on undecided loads anywhere before a search ends."""

DOUBLED_BEYOND = 200
"""Load, in first steps, above which each step doubles it: a wall that stands at ten weights probably self-locks."""


@dataclass(eq=False)
class LoadSteps:
    """Result of a search by steps of constant load."""

    # largest multiplier at which the wall came to rest, smallest at which it fell; None if there is none
    lower: float | None = None
    upper: float | None = None
    # verdict on the last load tried, or ``undecided`` if undecided loads ended the search; ``stable`` without `upper`
    # if the search ended beyond the largest load or displacement
    verdict: Verdict = "undecided"
    borne: State | None = None  # state at rest under `lower`; None if the wall did not even carry its dead load
    fallen: State | None = None  # state in the collapse under `upper`, or under the dead load
    tried_from: float | None = None  # multiplier at rest from which the load last grew to `upper`
    fall: Fall | None = None  # how it collapsed under `upper`
    # (nd,) motions on the way to that collapse, the latest first: half-way to it, then each rest
    fall_starts: list[Array] = field(default_factory=list)
    # every state at rest and its multiplier, in the order of loads
    rests: list[tuple[float, State]] = field(default_factory=list)
    at_once: int = 0  # number of these after the first in which the load was applied at once to an elastic wall
    steps: int = 0  # steps taken, on every path
    interrupted: bool = False  # whether Ctrl-C ended it
    far: bool = False  # whether it ended because a body, at rest, had moved beyond the largest displacement
    excluded: float = 0.0  # largest multiplier at which the wall passed as at rest, although that was proved impossible

    @property
    def width(self) -> float:
        """Width of the bracket, infinite until a load makes the wall fall."""
        return np.inf if self.upper is None else self.upper - (self.lower or 0.0)

    def add(
        self, trial: float, state: State, verdict: Verdict, halfway: Array | None, fall: Fall | None = None
    ) -> None:
        """Record a load and the state of the wall under it."""
        self.verdict = verdict
        if self.verdict == "stable":
            if self.upper is not None and trial >= self.upper:  # on a path with more rests than that of the collapse
                self.upper, self.fallen, self.fall = None, None, None
            self.lower, self.borne = trial, state
            self.rests.append((trial, state))
        elif self.verdict == "collapse":
            self.upper, self.fallen, self.fall = trial, state, fall
            rests = [rest.motion for _, rest in reversed(self.rests)]
            self.fall_starts = rests if halfway is None else [halfway, *rests]
        if trial == self.upper:
            self.verdict, self.tried_from = "collapse", self.lower  # it fell there before, even if undecided now

    def exclude_rests_above(self, bound: float) -> None:
        """Take back rests under loads above `bound`, which no forces balance.

        Under a load whose power on the mechanism is below the resolution of the criterion of rest, any wall passes as
        at rest.
        """
        if self.lower is not None and self.lower > bound:
            self.excluded = self.lower
            self.rests = [(load, state) for load, state in self.rests if load <= bound]
            self.lower, self.borne = self.rests[-1]


@dataclass(frozen=True)
class UndecidedLoads:
    """Undecided loads inside the bracket."""

    loads: tuple[float, ...] = ()

    def sides(self, result: LoadSteps) -> tuple[float, float]:
        """Width of the bracket below the lowest of the loads, and above the highest."""
        return min(self.loads) - (result.lower or 0.0), (result.upper or np.inf) - max(self.loads)

    def closed(self, result: LoadSteps, width: float) -> bool:
        """Whether undecided loads end the search: too many, or both sides at most a quarter of `width` wide."""
        most = MOST_UNDECIDED // 2 if result.upper is None else MOST_UNDECIDED
        return bool(self.loads) and (len(self.loads) >= most or max(self.sides(result)) <= width / 4)

    def after(self, result: LoadSteps, trial: float) -> "UndecidedLoads":
        """These loads, and `trial` if it is undecided; none if the wall held above them or fell below them."""
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
    """Raise the load step by step, each to rest, and bisect the step in which the wall falls.

    Every trial starts from the last state at rest, or from the state in which the load passed that trial in slow
    growth: a fall leaves no trace in the states that count. Steps grow while the wall carries them, so the first one
    need not fit the answer. The search passes an undecided load, just beside it; once a collapse is known, the bracket
    closes in on such loads from both sides. A wall without weight, or one that moved far at rest in the last step, is
    finally loaded from the largest load that it carried to the one under which it fell; the search goes on if it
    carries that.

    Parameters
    ----------
    first
        First step of the multiplier. It is doubled as long as the wall carries it, applied at once, without any loss.
    tolerance
        Relative width of the bracket at which to stop; the search also stops at the resolution of the rest criterion.
    most
        Multiplier beyond which the search ends.
    farthest : float or (n,) float
        Displacement [m] of any body, or of each, since the rest under the dead load, beyond which the search ends.
    loading
        Time in which the load grows by its first step, or by an eighth of the load if that is more, in multiples of
        the time to rest under the first step applied at once; by default `LOADING` or `LOADING_WEIGHTLESS`.
    bound
        Multiplier that is proved too large, if there is one: far below it the load grows faster (elsewhere only until
        the wall yields, `Growth`), and no load much larger is tried unless the wall carries it.

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


def smallest_width(run: Run, criteria: Criteria) -> float:
    """Smallest width of a bracket [multiplier] that the criterion of rest can resolve."""
    return RESOLVED * criteria.rest / (run.system.measure(run.system.live) or 1.0)


@dataclass(eq=False)
class _Search:
    """A search in progress; parameters are those of `load_steps`."""

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
        """Run the search and fill in the result."""
        result, system = self.result, self.run.system
        loaded = put_on_dead_load(self.run, self.criteria, self.observe)
        state, result.verdict, result.steps = loaded.state, loaded.verdict, loaded.steps
        if result.verdict != "stable":
            result.fallen = state
            return
        result.add(0.0, state, "stable", None)
        self.run = self.run.held_late(state)
        grows, undecided_steps = self._load_at_once(), 0
        step = max(self.first, GROWTH * result.rests[-1][0])
        while (trial := self._next_trial(step)) is not None and trial <= self.most:
            growth = 1.0 if trial > DOUBLED_BEYOND * self.first and not system.weightless else GROWTH
            (lower, borne), before = result.rests[-1], grows.steps
            trial, state = grows.reach(trial, borne, lower, (trial - lower) / max(self.first, growth * trial))
            fall = Fall(self.run, state.copy(), trial, self._criteria(borne))
            verdict, halfway = hold_load(self.run, state, trial, fall.criteria, self.observe)
            taken = grows.steps - before + state.steps - fall.start.steps
            result.steps += taken
            result.add(trial, state, verdict, halfway, fall)
            undecided_steps += taken if verdict == "undecided" else 0
            if undecided_steps > UNDECIDED_BUDGETS * self.criteria.budget:
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
        """Criteria of collapse at the next load: the wall must move again by as much as it has moved so far at rest.

        If joints are soft relative to the load, one more step displaces such a wall farther than a collapse displaces
        others, and all the more if they become softer as they open. Walls without weight approach the load under which
        they fell in a different way, unless their joints have many points.
        """
        if self.run.system.weightless and self.criteria.softness <= FEW_POINTS:
            return self.criteria
        moved = borne.motion - self.result.rests[0][1].motion
        come = self.run.system.farthest(moved, self.criteria.collapse)
        return replace(self.criteria, collapse=self.criteria.collapse * max(1.0, self.criteria.softness * come))

    def _load_at_once(self) -> Growth:
        """Apply the first step at once, and double it while nothing is lost: elastic walls do not depend on the order.

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
            result.at_once += 1
            for _ in range(CALM):  # observers take a wall as at rest after this many checks at rest
                self.observe(run, loaded, load)
            softness = run.system.farthest(loaded.motion - dead.motion, criteria.collapse) / load
            load *= 2
        return Growth(run, criteria, FAST_FRACTION * self.bound, unhurried, softness)

    def _next_trial(self, step: float) -> float | None:
        """Next load to try; None if the bracket, or that around undecided loads, is narrow enough."""
        result, system = self.result, self.run.system
        enough = max(self.tolerance * (result.upper or 0.0), smallest_width(self.run, self.criteria))
        if result.width > enough:
            if not self.undecided.closed(result, enough):
                return _next_load(result, step, self.undecided, self.tolerance, self.bound)
            result.verdict = "undecided"
            return None
        # A wall without weight snaps, and may be carried past a rest if the load comes from far below. A wall that
        # sways may have been on its way to a rest.
        wants_more = result.tried_from != result.lower and (system.weightless or self._sways())
        return result.upper if wants_more else None

    def _sways(self) -> bool:
        """Whether the wall moved by half of `CollapseDetector.EARLY` between the rests at `tried_from` and `lower`."""
        result = self.result
        if result.lower is None or result.tried_from is None:
            return False
        start, end = (
            next(state for load, state in result.rests if load == at) for at in (result.tried_from, result.lower)
        )
        moved = self.run.system.farthest(end.motion - start.motion, self.criteria.collapse)
        return moved > CollapseDetector.EARLY / 2


def _next_load(result: LoadSteps, step: float, undecided: UndecidedLoads, tolerance: float, bound: float) -> float:
    """Next load to try: a step up, or the middle of the bracket; near one undecided load, or well away from several."""
    lower, upper = result.lower or 0.0, result.upper
    if not undecided.loads:
        if upper is not None:
            return (lower + upper) / 2
        # Just above the bound a wall falls extremely slowly: try a load there unless the first step alone is beyond it.
        edge = bound * (1 + tolerance / 2)
        return edge if 0 < lower < edge < lower + step else lower + step
    low, high = min(undecided.loads), max(undecided.loads)
    if upper is None or len(undecided.loads) == 1:
        above = high * (1 + tolerance / 4)
        return above if upper is None or upper > above else low * (1 - tolerance / 4)
    below, above = undecided.sides(result)
    return (lower + low) / 2 if below > above else (high + upper) / 2
