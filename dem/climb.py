"""Climbs to a wall's collapse: loads are pushed for until the bracket between a rest and a fall is narrow enough.

A load under which a wall neither rests nor falls is gone around: those on either side of it are tried.
"""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from runningbond.dynamics.collapse_load import BEYOND_BOUND, LARGEST_LOAD
from runningbond.limit import proved_bound

from .pushover import NOISE, LoadPath, StaticState, lengthened

UNCLEAR = 3
"""Loads under which a wall may neither rest nor fall; after one more the bracket around them stays as wide as it is."""

HARD = 200
"""Linear systems of a rest after which the wall is loaded by no more than the bracket may be wide at once: a fall takes
more of them than a rest, and a longer step ends in two, that of the step and that of its half."""

INTERRUPTED, NEITHER, SPENT = "interrupted", "it neither rested nor fell", "the budget ran out"
"""Why a wall is undecided: after Ctrl-C, after loads that were not, or after too many linear systems."""


def climb(path: LoadPath, first_step: float, tolerance: float, asked: Sequence[float] = ()) -> None:
    """Load a wall until it has fallen, close enough to the last load at rest, or note why it is undecided.

    Of a wall that has fallen, loads that are `asked` for are tried before those in the middle. Nothing stands above the
    bound of limit analysis, which is asked where a wall neither rests nor falls before it has fallen, and where it has
    borne a million first steps: of a light wall whose joints are strong they may be next to nothing.
    """
    step, left, path.undecided = first_step, list(asked), INTERRUPTED
    most = LARGEST_LOAD * first_step
    with suppress(KeyboardInterrupt):
        while True:
            inside = [load for load in left if path.upper is not None and path.lower < load < path.upper]
            left = inside[1:] if inside else left  # each once: λ of a rest is its load up to rounding
            if path.upper is not None and path.upper - path.lower <= tolerance * max(path.upper, NOISE) and not inside:
                path.undecided = ""
                return
            load = inside[0] if inside else _next_load(path, step)
            held = path.push(load)
            if held.verdict == "undecided":
                path.unclear.append(load)
                if path.upper is None and path.budget > 0:
                    bound = _bound(path)
                    path.upper = None if bound is None else max(bound, path.lower)
                if path.budget <= 0 or path.upper is None or len(path.unclear) > UNCLEAR:
                    path.undecided = SPENT if path.budget <= 0 else "" if path.fall is not None else NEITHER
                    return
            least = tolerance if held.solves > HARD else 2 * tolerance
            step = max(step * lengthened(held.solves), least * path.lower)
            if path.upper is None and path.lower > most:
                most = BEYOND_BOUND * (_bound(path) or 0.0)
                if path.lower > most:
                    path.undecided = "it bore every load tried"
                    return


def _bound(path: LoadPath) -> float | None:
    """Load above which limit analysis proves that nothing stands, if it does, in units of the system."""
    bound = proved_bound(path.system.equilibrium.scene)
    return None if bound is None else bound / path.system.equilibrium.live_unit


def _next_load(path: LoadPath, step: float) -> float:
    """Load in the middle of the widest gap between a rest, loads under which nothing was decided, and a fall."""
    if path.upper is None:
        return path.lower + step
    loads = [path.lower, *sorted(load for load in path.unclear if path.lower < load < path.upper), path.upper]
    widest = int(np.diff(loads).argmax())
    return (loads[widest] + loads[widest + 1]) / 2


def ends(path: LoadPath) -> tuple[float, float]:
    """The bracket of a path."""
    return peak(path).multiplier, np.inf if path.upper is None else path.upper


def look_closer(path: LoadPath, tolerance: float, past: int) -> None:
    """Follow a wall past its bracket, and look whether the bracket's upper half bears anything."""
    path.follow(past)
    # Within the bracket the curve's peak is the better lower end, and a load just above it the better upper one.
    closer = (1 + tolerance / 4) * peak(path).multiplier
    if path.upper is not None and closer < path.upper and path.push(closer, past).verdict == "rest":
        path.follow(past)


def peak(path: LoadPath) -> StaticState:
    """State of the largest λ in equilibrium that is none at which the wall fell."""
    most, states = np.inf if path.upper is None else path.upper, (*path.rests, *path.past)
    return max((state for state in states if state.multiplier < most), key=lambda state: state.multiplier)
