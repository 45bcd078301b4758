"""The largest force along a path, from means over windows that are as short as the peak requires.

A force fluctuates, and is measured by its mean over a part of the path. The longer the part, the lower the mean at a
peak: if a wall snaps within a hundredth of a row, little of the peak is left. Therefore means over shorter and shorter
windows are computed in parallel, and the longest windows are taken to which shorter ones add almost nothing.
"""

from dataclasses import dataclass, field

import numpy as np

from .state import State

WINDOW_STEPS = 50
"""Least number of steps in windows shorter than a row."""

LEAST_WINDOWS = 2
"""Least number of windows in a row, of one step each at least."""

RESOLVED_GAIN = 2.5e-3
"""Relative increase of a peak by windows half as long up to which the peak is resolved."""


@dataclass
class Peak:
    """The largest force by windows of one length: the median of three in succession, because single ones fluctuate."""

    state: State  # at the end of the middle window
    force: float = 0.0
    inertia: float = 0.0  # the largest of the three
    spent: float = 0.0  # the median of the three: a crack may set much energy free in one of them
    row: int = 1  # row of the path before which the peak occurred
    _last: list[tuple[float, float, float]] = field(default_factory=list)
    _before: State | None = None

    def see(self, force: float, inertia: float, spent: float, state: State, row: int) -> None:
        """Update with means over the next window, as in `Peaks.see`, and with the state at its end."""
        self._last = [*self._last[-2:], (force, abs(inertia), spent)]
        middle = sorted(self._last)[1][0] if len(self._last) == 3 else 0.0
        if middle > self.force:
            self.state = self._before or state.copy()
            self.force, self.row = middle, row
            self.inertia = max(each[1] for each in self._last)
            self.spent = sorted(each[2] for each in self._last)[1]
        self._before = state.copy() if force > self.force else None


class Peaks:
    """Peaks by windows of a whole row, of half a row, and so on.

    Parameters
    ----------
    start
        State at the start of the path.
    steps
        Steps of a row, a whole number up to rounding.
    most
        Largest number of windows in a row: fluctuating forces need long ones.
    """

    def __init__(self, start: State, steps: float, most: float = np.inf) -> None:
        # Rounded first: the last bit of a time step may make 199.999 steps of 200, and still there are four windows.
        levels = int(np.log2(max(LEAST_WINDOWS, min(most, round(steps) / WINDOW_STEPS))))
        self.windows = 2**levels  # number of the shortest windows in a row
        self._peaks = [Peak(start) for _ in range(levels + 1)]
        # Sums of force, inertia and `spent` times steps, and of steps, up to the end of each window of the row.
        self._sums, self._ends = [np.zeros(3)], [0]

    def see(self, force: float, inertia: float, steps: int, state: State, row: int, *, spent: float = 0.0) -> None:
        """Update with means over the next window, of so many steps, the state at its end, and the row it precedes.

        `spent` is the part of the force whose work becomes kinetic energy or is damped.
        """
        if len(self._sums) > self.windows:
            self._sums, self._ends = [np.zeros(3)], [0]
        self._sums.append(self._sums[-1] + steps * np.array([force, inertia, spent]))
        self._ends.append(self._ends[-1] + steps)
        for level, peak in enumerate(self._peaks):
            some = self.windows >> level
            whole = (len(self._sums) - 1) % some == 0
            if whole and (level == 0 or self._ends[-1] - self._ends[-1 - some] >= WINDOW_STEPS):
                peak.see(*self._means(some), state, row)

    def mean(self, windows: int) -> float:
        """Mean force over the last `windows` windows of the row."""
        return self._means(windows)[0]

    def _means(self, windows: int) -> tuple[float, float, float]:
        """Mean force, inertia and `spent` over the last `windows` windows of the row."""
        steps = self._ends[-1] - self._ends[-1 - windows]
        force, inertia, spent = ((self._sums[-1] - self._sums[-1 - windows]) / steps).tolist()
        return force, inertia, spent

    @property
    def longest(self) -> Peak:
        """The peak of means over whole rows, which fluctuate least."""
        return self._peaks[0]

    def resolved(self) -> tuple[Peak, bool, float, bool]:
        """Peak, whether its windows are shorter than a row, by how much it may be too low, and whether it is resolved.

        Resolved: windows half as long add almost nothing; otherwise fluctuations may have raised the peak.

        The shortest windows may miss as much as they add: what windows miss of a peak is proportional to their length.
        """
        force = np.array([peak.force for peak in self._peaks])
        more = np.diff(force)
        seen = np.flatnonzero(more <= RESOLVED_GAIN * force[1:])
        level = int(seen[0]) if len(seen) else len(more) - 1
        unseen = max(0.0, float(more[level]), float(force[-1] - force[level] + more[-1]))
        return self._peaks[level], level > 0, unseen, len(seen) > 0
