"""Load a wall until the bracket between its last equilibrium and its fall is narrow enough.

A load under which a wall neither rests nor falls is skipped: loads below and above it are tried instead.
"""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from runningbond.dynamics.collapse_load import BEYOND_BOUND, LARGEST_LOAD
from runningbond.limit import proved_bound

from .load_path import NOISE, LoadPath, StaticState, lengthened

MAX_UNDECIDED_LOADS = 3
"""Number of loads that may stay undecided; after one more, the bracket around them is left as wide as it is."""

COSTLY_SOLVES = 200
"""Linear systems for one load above which the smallest load step is once, no longer twice, the allowed bracket width.
Falls cost more systems than rests, and a step of twice that width ends in two of them: at its end and at its middle."""

INTERRUPTED, NO_VERDICT, BUDGET_SPENT = "interrupted", "it neither rested nor fell", "the budget ran out"
"""Why a wall is undecided: after Ctrl-C, because of undecided loads, or after too many linear systems."""


def climb(path: LoadPath, first_step: float, tolerance: float, asked: Sequence[float] = ()) -> None:
    """Load a wall until its last equilibrium and its fall bracket the collapse load, or note why it is undecided.

    Once there is an upper end, the loads in `asked` that lie within the bracket are tried before its middle. No wall
    stands above the bound of limit analysis. It is computed if a load stays undecided before the first fall, and if the
    wall carries a million first steps: for a light wall with strong joints, these may still be a tiny load.
    """
    step, left, path.undecided = first_step, list(asked), INTERRUPTED
    most = LARGEST_LOAD * first_step
    with suppress(KeyboardInterrupt):
        while True:
            inside = [load for load in left if path.upper is not None and path.lower < load < path.upper]
            left = inside[1:] if inside else left  # each is tried once: λ at rest equals its load only up to rounding
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
                if path.budget <= 0 or path.upper is None or len(path.unclear) > MAX_UNDECIDED_LOADS:
                    path.undecided = BUDGET_SPENT if path.budget <= 0 else "" if path.fall is not None else NO_VERDICT
                    return
            least = tolerance if held.solves > COSTLY_SOLVES else 2 * tolerance
            step = max(step * lengthened(held.solves), least * path.lower)
            if path.upper is None and path.lower > most:
                most = BEYOND_BOUND * (_bound(path) or 0.0)
                if path.lower > most:
                    path.undecided = "it carried every load tried"
                    return


def _bound(path: LoadPath) -> float | None:
    """Load above which limit analysis proves that nothing stands, in units of the system; None without a proof."""
    bound = proved_bound(path.system.equilibrium.scene)
    return None if bound is None else bound / path.system.equilibrium.live_unit


def _next_load(path: LoadPath, step: float) -> float:
    """Middle of the widest gap between the last rest, undecided loads and the fall; one step up before any fall."""
    if path.upper is None:
        return path.lower + step
    loads = [path.lower, *sorted(load for load in path.unclear if path.lower < load < path.upper), path.upper]
    widest = int(np.diff(loads).argmax())
    return (loads[widest] + loads[widest + 1]) / 2


def ends(path: LoadPath) -> tuple[float, float]:
    """Lower and upper end of a path's bracket."""
    return peak(path).multiplier, np.inf if path.upper is None else path.upper


def look_closer(path: LoadPath, tolerance: float, past: int) -> None:
    """Follow a wall past its bracket, and check whether it rests under a load just above the curve's peak."""
    path.follow(past)
    # Within the bracket, the curve's peak is a better lower end, and a load just above it may be a better upper end.
    closer = (1 + tolerance / 4) * peak(path).multiplier
    if path.upper is not None and closer < path.upper and path.push(closer, past).verdict == "rest":
        path.follow(past)


def peak(path: LoadPath) -> StaticState:
    """State in equilibrium with the largest λ up to the upper end of the bracket."""
    most, states = np.inf if path.upper is None else path.upper, (*path.rests, *path.past)
    return max((state for state in states if state.multiplier <= most), key=lambda state: state.multiplier)
