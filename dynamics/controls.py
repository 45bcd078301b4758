"""Load controls: steps with bisection, a ramp, and work-conjugate displacement control."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from scene import Array

from .run import Criteria, Observer, Run, Verdict, nobody, settle
from .system import State

RAMP, RAMP_WEIGHTLESS = 4, 10
"""Length of the ramp to each load, in times that the wall took to rest under the first one.

Loads put on at once send waves through the wall. Under its own weight it hardly minds. A wall without weight has no
pressure on its joints but what the load gives it, and slips for good wherever a wave takes that away: it bears more
the slower it is loaded.
"""

SLOWINGS = 4
"""How often a wall without weight is loaded anew, half as fast each time, until its bracket stays where it is."""

RESOLVED = 10
"""Least width of a bracket, in live loads that a wall would be held to bear though nothing balances them."""

GROWTH = 1 / 8
"""Largest step, once the first ones are borne, as a fraction of the load."""


@dataclass(eq=False)
class LoadSteps:
    """What a search by steps of constant load came to.

    Parameters
    ----------
    lower, upper
        Largest multiplier that the wall bore at rest, smallest that brought it down; None where none did.
    verdict
        Of the last load tried.
    borne
        State at rest under `lower`; None if not even the dead load was borne.
    fallen
        State in the collapse under `upper`.
    rests : list of (multiplier, State)
        Every state at rest, in order of load.
    taken
        Steps taken, on every path.
    rate_error
        Change of `lower` when the loading was last slowed to half its speed; None where it never was.
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
    rate_error: float | None = None
    interrupted: bool = False


def load_steps(
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    *,
    most: float = np.inf,
    ramp_length: int = RAMP,
    observe: Observer = nobody,
) -> LoadSteps:
    """Raise the load step by step, each to rest, and bisect the step that brings the wall down.

    Every trial starts from the last state at rest, so that a fall leaves no trace in the states that count.
    Steps grow while they are borne, so that the first one need not know the answer's size.

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
    ramp_length
        Length of the ramp to each load, in times that the wall took to rest under the first one.
    observe
        Called at every look.

    Returns
    -------
    LoadSteps
        Ctrl-C ends the search with what it had found.
    """
    found = LoadSteps()
    try:
        _search(found, run, first, tolerance, criteria, most, ramp_length, observe)
    except KeyboardInterrupt:
        found.interrupted, found.verdict = True, "undecided"
    return found


def _search(
    found: LoadSteps,
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    most: float,
    ramp_length: int,
    observe: Observer,
) -> None:
    """Fill in what a search finds, as it finds it."""
    state = State.at_rest(run.system)
    found.verdict = settle(run, state, 0.0, criteria, observe)
    found.taken = state.steps
    if found.verdict != "stable":
        found.fallen = state
        return
    found.lower, found.borne = 0.0, state
    found.rests.append((0.0, state))
    step, steps_to_rest, neutral = first, state.steps, None
    narrowest = RESOLVED * criteria.rest / (run.system.measure(run.system.live) or 1.0)
    while found.upper is None or found.upper - found.lower > max(tolerance * found.upper, narrowest):
        trial = _next_trial(found, step, neutral, tolerance)
        if trial > most:
            found.verdict = "undecided"
            return
        state = found.borne.copy()
        ramp(run, state, found.lower, trial, ramp_length * steps_to_rest)
        before = state.steps
        found.verdict = settle(run, state, trial, criteria, observe)
        found.taken += state.steps - found.borne.steps
        if found.verdict == "stable":
            if len(found.rests) == 1:
                steps_to_rest = state.steps - before
            found.lower, found.borne, neutral = trial, state, None
            found.rests.append((trial, state))
            step = max(step, min(2 * step, GROWTH * trial)) if len(found.rests) % 3 == 0 else step
        elif found.verdict == "collapse":
            found.upper, found.fallen = trial, state
        elif neutral is None:
            neutral = trial
        else:
            return


def settled_load_steps(
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    *,
    most: float = np.inf,
    observe: Observer = nobody,
) -> LoadSteps:
    """Search by load steps as slow as the wall asks for; see `load_steps` for the arguments.

    A wall without weight is loaded anew at half the speed until `lower` changes by less than the tolerance; where it
    never settles the verdict is ``undecided``.
    """
    if run.system.dead.any():
        return load_steps(run, first, tolerance, criteria, most=most, observe=observe)
    length = RAMP_WEIGHTLESS
    slow = load_steps(run, first, tolerance, criteria, most=most, ramp_length=length, observe=observe)
    for _ in range(SLOWINGS):
        if slow.lower is None or slow.upper is None or slow.interrupted:
            return slow
        fast, length = slow, 2 * length
        slow = load_steps(run, first, tolerance, criteria, most=most, ramp_length=length, observe=observe)
        slow.taken += fast.taken
        if slow.interrupted:
            fast.interrupted, fast.verdict, fast.taken = True, "undecided", slow.taken
            return fast
        if slow.lower is not None and fast.lower is not None:
            slow.rate_error = abs(slow.lower - fast.lower)
            if slow.rate_error <= tolerance * slow.lower:
                return slow
    slow.verdict = "undecided"
    return slow


def _next_trial(found: LoadSteps, step: float, neutral: float | None, tolerance: float) -> float:
    """Next load to try: a step up, the middle of the bracket, or just beside a load that neither held nor fell."""
    lower = found.lower or 0.0
    if neutral is None:
        return lower + step if found.upper is None else (lower + found.upper) / 2
    above = neutral * (1 + tolerance / 4)
    return above if found.upper is None or found.upper > above else neutral * (1 - tolerance / 4)


def ramp(run: Run, state: State, start: float, stop: float, steps: int, interval: int = 20) -> None:
    """Raise the multiplier evenly from `start` to `stop` over a number of steps, in place."""
    pieces, given = max(1, steps // interval), run.given(state)
    for k in range(pieces):
        run.hold(state, start + (stop - start) * (k + 0.5) / pieces, interval, given=given)


@dataclass(frozen=True, eq=False)
class Drive:
    """A wall pushed at a prescribed speed.

    Parameters
    ----------
    curve : (n, 2) float
        Displacement of the control point [m] and mean multiplier, piece by piece.
    peak
        Largest multiplier of the curve.
    rate_error
        Change of the peak when the speed was last halved; inf if it never settled.
    state
        The wall at the end.
    """

    curve: Array
    peak: float
    rate_error: float
    state: State


def drive(run: Run, start: State, distance: float, steps: int, pieces: int = 200) -> Drive:
    """Push a wall until its control point has moved a distance [m], from a copy of a state.

    The work-conjugate displacement, live load times motion, grows at a constant rate after a soft start; the
    multiplier follows. It takes `steps` if everything moves as far as the control point, and fewer as a rule.
    """
    system = run.system
    state = start.copy()
    speed = _work_displacement(run, distance) / (steps * run.dt)
    soft = max(1, pieces // 20)
    pace = (pieces, soft, steps // pieces)
    found = push(run, state, distance, speed, pace, lambda motion: (float(system.control @ motion),))
    return Drive(found, float(found[soft:, 1].max(initial=found[0, 1])), float("inf"), state)


def push(
    run: Run,
    state: State,
    distance: float,
    power: float,
    pace: tuple[int, int, int],
    measure: Callable[[Array], tuple[float, ...]],
) -> Array:
    """Push a wall, in place, at a power of the live load, and follow its curve.

    Parameters
    ----------
    distance
        First measure [m] at which to stop.
    power
        Power of the live load at λ = 1 [W].
    pace
        Most rows of the curve, those over which the power is brought up, and steps to a row.
    measure
        What is measured of a motion ``(nd,)``, the displacement of the control point [m] first.

    Returns
    -------
    (n, m + 1) float
        The measures, and the mean multiplier since the last row.
    """
    pieces, soft, steps = pace
    curve: list[tuple[float, ...]] = []
    given = run.given(state)
    for piece in range(pieces):
        multiplier = run.drive(state, power * min(1.0, (piece + 1) / soft), steps, given=given)
        curve.append((*measure(state.motion), multiplier))
        if curve[-1][0] >= distance:
            break
    return np.array(curve)


def settled_drive(
    run: Run, start: State, distance: float, tolerance: float, steps: int = 20_000, halvings: int = 8
) -> Drive:
    """Halve the speed until the peak of the curve changes by less than a relative tolerance."""
    slow = drive(run, start, distance, steps)
    for _ in range(halvings):
        fast, steps = slow, 2 * steps
        slow = drive(run, start, distance, steps)
        error = abs(fast.peak - slow.peak)
        slow = Drive(slow.curve, slow.peak, error, slow.state)
        if error <= tolerance * abs(slow.peak):
            break
    return slow


def _work_displacement(run: Run, distance: float) -> float:
    """Work of the live load at λ = 1 when every freedom it acts on moves as far as the control point."""
    system = run.system
    return float(distance * np.abs(system.live).sum())
