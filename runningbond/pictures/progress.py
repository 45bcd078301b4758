"""Progress lines of running models: the load, the bracket so far, the motion, and the share of the budget used."""

import math
from typing import Self

import numpy as np

from dem.load_path import LoadPath, StaticState
from dem.static import BUDGET as STATIC_BUDGET
from runningbond.dynamics import Criteria, Run, State
from runningbond.dynamics.collapse import CALM
from runningbond.dynamics.collapse_load import BUDGET
from runningbond.limit.search_log import SearchLog
from runningbond.results.outcome import number


class StaticProgress:
    """Observes a run of `dem.static`."""

    def __init__(self) -> None:
        self._path: LoadPath | None = None

    def __call__(self, path: LoadPath, state: StaticState) -> None:
        """Record a state at rest."""
        self._path = path

    def line(self) -> str:
        """Return the progress line."""
        path = self._path
        if path is None:
            return "settles under its dead load"
        unit, nd = path.system.equilibrium.live_unit, path.system.freedoms
        last = path.past[-1] if path.past and path.upper is None else path.rests[-1]  # past: displacement control
        moved = path.system.length_unit * np.abs(last.x[:nd] - path.rests[0].x[:nd])
        upper = None if path.upper is None else unit * path.upper
        spent = f"{1 - path.budget / STATIC_BUDGET:.0%} of the budget"
        return f"{_bracket(unit * last.multiplier, upper)}; moved {1e3 * moved.max(initial=0.0):.2g} mm, {spent}"


class MotionProgress:
    """Observes a run with blocks in motion."""

    def __init__(self) -> None:
        self._begin("")

    def _begin(self, of: str) -> None:
        self._of = of
        self._load, self._looks, self._calm = math.nan, 0, 0
        self._lower: float | None = None
        self._upper: float | None = None
        self._seen: tuple[Run, State] | None = None

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Record a state of a run."""
        if multiplier != self._load:
            # A load that ended within its budget, but without coming to rest, brought the wall down.
            if 0 < self._looks < BUDGET // Criteria.interval and self._calm < CALM:
                self._upper = self._load
            self._load, self._looks, self._calm = multiplier, 0, 0
        self._looks += 1
        self._calm = self._calm + 1 if run.unbalanced(state) < Criteria.rest else 0
        if self._calm == CALM:
            self._lower = multiplier
        self._seen = run, state

    def turn_to(self, other: str) -> Self:
        """Observe another run for the same answer from now on, and name it in the progress line; return itself."""
        self._begin(other)
        return self

    def line(self) -> str:
        """Return the progress line."""
        return f"{self._of}: {self._so_far()}" if self._of else self._so_far()

    def _so_far(self) -> str:
        if self._seen is None:
            return "gets ready"
        run, state = self._seen
        spent, speed = self._looks * Criteria.interval / BUDGET, 1e3 * run.system.farthest(state.velocity)
        held = f"λ {number(self._load)}, {spent:.1%} of its budget, {speed:.2g} mm/s"
        return held if self._lower is None else f"{held}; {_bracket(self._lower, self._upper)}"


class ResponseProgress:
    """Observes a wall under a ground motion, once or at one scale after another."""

    def __init__(self) -> None:
        self._motions, self._scale, self._begin, self._now = 0, math.nan, 0.0, math.inf

    def __call__(self, run: Run, state: State, scale: float) -> None:
        """Record a state of a run; the first state of each motion is at rest."""
        if scale != self._scale or state.time < self._now:
            self._motions, self._scale, self._begin = self._motions + 1, scale, state.time
        self._now = state.time

    def line(self) -> str:
        """Return the progress line."""
        if not self._motions:
            return "comes to rest under its dead load"
        return f"motion {self._motions}, λ {number(self._scale)}, {self._now - self._begin:.2f} s of it"


class SearchProgress:
    """Observes a search for certificates."""

    def __init__(self) -> None:
        self._said = "looks for a first certificate"

    def __call__(self, found: SearchLog) -> None:
        """Record what the search has found."""
        certified = f"{len(found.certificates)} certificates, the last {found.dry} starts in vain"
        self._said = f"{found.starts} starts, {found.programs} linear programs, {certified}"

    def line(self) -> str:
        """Return the progress line."""
        return self._said


def _bracket(lower: float, upper: float | None) -> str:
    return f"rests at {number(lower)}" + ("" if upper is None else f", falls at {number(upper)}")
