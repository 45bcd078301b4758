"""Load controls: a ramp, and work-conjugate displacement control; steps of constant load are in `loading`."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array

from .run import Run
from .system import State


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
