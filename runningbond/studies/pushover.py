"""Work-conjugate displacement control of a wall, as studies compare it with load steps."""

from dataclasses import dataclass, replace

import numpy as np

from runningbond.dynamics import Run, State
from runningbond.scene import Array

PIECES = 200
"""Largest number of intervals of a push."""


@dataclass(frozen=True, eq=False)
class Pushover:
    """A wall pushed at a prescribed speed."""

    curve: Array  # (n, 2) displacement of the control point [m] and mean multiplier, interval by interval
    # Largest multiplier of the curve without its soft start, in which the multiplier includes the force that sets the
    # wall in motion. If the wall's strength peaks within it, the peak is missed; a shorter distance shows it.
    peak: float
    rate_error: float  # change of the peak when the speed was last halved; inf if it was never halved
    state: State  # the wall at the end


def drive(run: Run, start: State, distance: float, steps: int) -> Pushover:
    """Push a wall until its control point has moved a distance [m], starting from a copy of a state.

    The work-conjugate displacement, live load times motion, grows at a constant rate after a soft start; the multiplier
    follows. The push takes `steps` if everything moves as far as the control point, and usually fewer; the curve has
    one point for each of at most `PIECES` intervals, which are at least one step long.
    """
    system, state = run.system, start.copy()
    power = float(distance * np.abs(system.live).sum()) / (steps * run.dt)
    pieces = min(PIECES, steps)
    soft = max(1, pieces // 20)
    rows: list[tuple[float, float]] = []
    given = run.given(state)
    for row in range(pieces):
        length = (row + 1) * steps // pieces - row * steps // pieces
        multiplier = run.drive(state, power * min(1.0, (row + 1) / soft), length, given=given)
        rows.append((float(system.control @ state.motion), multiplier))
        if rows[-1][0] >= distance:
            break
    curve = np.array(rows)
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
