"""Load controls: a ramp, and work-conjugate displacement control; steps of constant load are in `load_stepping`."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.scene import Array, Scene

from .collapse import U_CRIT, Criteria, settle
from .run import Run
from .state import State

CURVE_ROWS, START_ROWS = 4000, 20
"""Rows of a pushover curve if all bodies move as far as the control point, and those in which they gather speed."""


def ramp(run: Run, state: State, start: float, stop: float, steps: int) -> None:
    """Raise the multiplier evenly from `start` to `stop` over a number of steps, in place."""
    run.hold(state, start, steps, rise=(stop - start) / steps, given=run.given(state))


@dataclass(frozen=True, eq=False)
class Pushover:
    """A wall pushed at a prescribed speed."""

    curve: Array  # (n, 2) displacement of the control point [m] and mean multiplier, piece by piece
    peak: float  # largest multiplier of the curve
    rate_error: float  # change of the peak when the speed was last halved; inf if it never settled
    state: State  # the wall at the end


def drive(run: Run, start: State, distance: float, steps: int, pieces: int = 200) -> Pushover:
    """Push a wall until its control point has moved a distance [m], from a copy of a state.

    The work-conjugate displacement, live load times motion, grows at a constant rate after a soft start; the
    multiplier follows. It takes `steps` if everything moves as far as the control point, and fewer as a rule.
    """
    system, state = run.system, start.copy()
    power = float(distance * np.abs(system.live).sum()) / (steps * run.dt)
    soft = max(1, pieces // 20)
    pace = (pieces, soft, steps // pieces)
    curve = _push(run, state, distance, power, pace, lambda motion: (float(system.control @ motion),))
    return Pushover(curve, float(curve[soft:, 1].max(initial=curve[0, 1])), float("inf"), state)


def settled_drive(
    run: Run, start: State, distance: float, tolerance: float, steps: int = 20_000, halvings: int = 8
) -> Pushover:
    """Halve the speed until the peak of the curve changes by less than a relative tolerance."""
    slow = drive(run, start, distance, steps)
    for _ in range(halvings):
        fast, steps = slow, 2 * steps
        slow = drive(run, start, distance, steps)
        error = abs(fast.peak - slow.peak)
        slow = replace(slow, rate_error=error)
        if error <= tolerance * abs(slow.peak):
            break
    return slow


def pushover_curve(
    run: Run, scene: Scene, distance: float, speed: float, measure: Callable[[Array], tuple[float, float]]
) -> Array:
    """Pushover curve of a wall from its rest under its weight, at a constant power of the live load.

    Parameters
    ----------
    run, scene
        The blocks, and their wall.
    distance
        Displacement of the control point at which to stop [m].
    speed
        Mean speed of the blocks along the live load [m/s].
    measure
        Displacement of the control point, and of the corner that has moved farthest, in a motion ``(nd,)`` [m].

    Returns
    -------
    (n, 3) float
        What `measure` says, and the mean multiplier since the last row.
    """
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=U_CRIT * scene.block_size))
    steps = max(1, round(distance / (speed * CURVE_ROWS * run.dt)))
    power = speed * float(np.abs(run.system.live).sum())
    with threadpool_limits(limits=1, user_api="blas"):  # as in `collapse_by_steps`
        return _push(run, state, distance, power, (CURVE_ROWS, START_ROWS, steps), measure)


def _push(
    run: Run,
    state: State,
    distance: float,
    power: float,
    pace: tuple[int, int, int],
    measure: Callable[[Array], tuple[float, ...]],
) -> Array:
    """Push a wall, in place, at a power of the live load at λ = 1 [W], until its first measure is a distance [m].

    The pace is most rows of the curve, those over which the power is brought up, and steps to a row. Returns what is
    measured of the motion ``(nd,)`` in each row, and the mean multiplier since the last one, ``(n, m + 1)``.
    """
    rows, soft, steps = pace
    curve: list[tuple[float, ...]] = []
    given = run.given(state)
    for row in range(rows):
        multiplier = run.drive(state, power * min(1.0, (row + 1) / soft), steps, given=given)
        curve.append((*measure(state.motion), multiplier))
        if curve[-1][0] >= distance:
            break
    return np.array(curve)
