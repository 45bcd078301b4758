"""Ground motion applied to a run: in the ground's frame every mass m carries the inertia force −m a.

The load is constant over intervals of a few time steps, with the mean acceleration derived from the ground's velocity.
Whatever the time step, the wall has therefore received the velocity of the record at the end of each, to rounding.
"""

import numpy as np

from runningbond.dynamics import Run, State
from runningbond.scene import Array, History

LONGEST = 5e-4
"""Longest interval [s] over which the mean replaces the ground's acceleration, however far apart the samples are."""


class Ground:
    """Ground motion applied to a run, starting at the time of a state.

    Parameters
    ----------
    run
        The wall, at finite displacements.
    history, scale
        The record, and the factor on it.
    start
        Time of the state at which the record begins [s].
    """

    def __init__(self, run: Run, history: History, scale: float, start: float) -> None:
        self.run, self.history, self.scale, self.start = run, history, scale, start
        self.velocity = np.zeros(2)  # ground velocity that has been applied so far [m/s]
        self.load = run.system.dead  # (nd,) current load [N]
        self.inertia = run.system.mass_along

    def time(self, state: State) -> float:
        """Time since the record began [s]."""
        return state.time - self.start

    def acceleration(self, time: float) -> Array:
        """Acceleration of the ground ``(2,)`` [m/s²]."""
        return self.scale * self.history.acceleration(time)

    def bring(self, state: State, until: float) -> None:
        """Integrate a state up to a time of the record [s], within half a time step."""
        run, history = self.run, self.history
        while (left := until - (now := self.time(state))) > run.dt / 2:
            # Average over whole intervals of the record, whatever output times lie within them.
            whole = min(left, self._span(now)) if now >= history.duration else self._span(now)
            steps = max(1, round(whole / run.dt))
            aim = self.scale * history.velocity(now + steps * run.dt)
            acceleration = (aim - self.velocity) / (steps * run.dt)
            steps = max(1, min(steps, round(left / run.dt)))
            load, before = run.system.dead - acceleration @ self.inertia, state.time
            # The time step at which the load changes is half under the old load and half under the new one.
            state.external += 0.5 * run.dt * float((load - self.load) @ state.velocity)
            self.load = load
            run.bear(state, load, steps)
            # New contacts may have changed the time step; the next intervals correct the difference in velocity.
            self.velocity += acceleration * (state.time - before)

    def _span(self, now: float) -> float:
        """Time [s] from `now` on over which the ground's acceleration may be averaged: one time step where it jumps."""
        step, to_the_end = self.run.dt, self.history.duration - now
        if self.history.has_jumps and min(now, abs(to_the_end)) <= step / 2:
            return step
        if to_the_end <= 0:
            return np.inf
        interval = min(self.history.resolution, LONGEST)
        to_the_next = interval * (np.floor(now / interval) + 1) - now
        return float(min(to_the_next if to_the_next > step / 2 else interval, to_the_end))

    def momentum(self, state: State) -> Array:
        """Momentum of the wall in the fixed frame ``(2,)`` [kg m/s]."""
        return np.asarray(self.inertia @ state.velocity + self.inertia.sum(axis=1) * self.velocity)

    def dead(self) -> Array:
        """Resultant of the dead load on the moving bodies ``(2,)`` [N]."""
        return np.asarray((self.inertia > 0) @ np.nan_to_num(self.run.system.dead))
