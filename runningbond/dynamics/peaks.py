"""The largest force of a drive, from means over windows of its path that are as short as the peak asks for.

A force shakes, and is told by its mean over a part of the path. Such a mean takes from a peak the more the longer it
is: of a wall that snaps after a hundredth of a row it leaves little. Means over ever shorter windows therefore stand
side by side, and the longest are taken to which shorter ones add next to nothing.
"""

from dataclasses import dataclass, field

import numpy as np

from .state import State

WINDOW_STEPS = 50
"""Least steps of windows shorter than a row."""

SEEN = 2.5e-3
"""What windows half as long may add to a peak that is seen, relative to it."""


@dataclass
class Peak:
    """The largest force by windows of one length, the middle one of three in a row, for single ones shake."""

    state: State  # at the end of the window in the middle
    force: float = 0.0
    inertia: float = 0.0  # the largest of the three
    row: int = 1  # the row of the path before which it was met
    _last: list[tuple[float, float]] = field(default_factory=list)
    _before: State | None = None

    def see(self, force: float, inertia: float, state: State, row: int) -> None:
        """Look at the mean force of the next window, at what speeds up meanwhile, and at the state at its end."""
        self._last = [*self._last[-2:], (force, abs(inertia))]
        middle = sorted(self._last)[1][0] if len(self._last) == 3 else 0.0
        if middle > self.force:
            self.state = self._before or state.copy()
            self.force, self.row = middle, row
            self.inertia = max(inertia for _, inertia in self._last)
        self._before = state.copy() if force > self.force else None


class Peaks:
    """Peaks by windows of a whole row, of half of one, and so on.

    Parameters
    ----------
    start
        Where the path begins.
    steps
        Steps of a row, whole but for rounding.
    most
        Most windows in a row: what shakes is told by long ones.
    """

    def __init__(self, start: State, steps: float, most: float = np.inf) -> None:
        # Four windows stay four where a time step's last bit makes 199.999 steps of 200.
        levels = max(1, int(np.log2(max(1.0, min(most, round(steps) / WINDOW_STEPS)))))
        self.windows = 2**levels  # of the shortest kind in a row
        self._peaks = [Peak(start) for _ in range(levels + 1)]
        # Force and inertia times steps, and steps, up to the end of each window of the row.
        self._sums, self._ends = [np.zeros(2)], [0]

    def see(self, force: float, inertia: float, steps: int, state: State, row: int) -> None:
        """Look at means over the next window, of so many steps, and at the state at its end, before a row."""
        if len(self._sums) > self.windows:
            self._sums, self._ends = [np.zeros(2)], [0]
        self._sums.append(self._sums[-1] + steps * np.array([force, inertia]))
        self._ends.append(self._ends[-1] + steps)
        for level, peak in enumerate(self._peaks):
            some = self.windows >> level
            whole = (len(self._sums) - 1) % some == 0
            if whole and (level == 0 or self._ends[-1] - self._ends[-1 - some] >= WINDOW_STEPS):
                peak.see(*self._means(some), state, row)

    def mean(self, windows: int) -> float:
        """Mean force of the last windows of the row."""
        return self._means(windows)[0]

    def _means(self, windows: int) -> tuple[float, float]:
        """Mean force and inertia of the last windows of the row."""
        steps = self._ends[-1] - self._ends[-1 - windows]
        force, inertia = ((self._sums[-1] - self._sums[-1 - windows]) / steps).tolist()
        return force, inertia

    @property
    def longest(self) -> Peak:
        """The peak by means over whole rows, which shake least."""
        return self._peaks[0]

    def resolved(self) -> tuple[Peak, bool, float, bool]:
        """The peak, whether it is of windows shorter than a row, and what its windows may miss, shaking included.

        And whether windows half as long add next to nothing to it: else it may be the larger for what shakes.

        The shortest miss as much as they add, for what a mean takes from a peak falls as its length.
        """
        force = np.array([peak.force for peak in self._peaks])
        more = np.diff(force)
        seen = np.flatnonzero(more <= SEEN * force[1:])
        level = int(seen[0]) if len(seen) else len(more) - 1
        unseen = max(0.0, float(more[level]), float(force[-1] - force[level] + more[-1]))
        return self._peaks[level], level > 0, unseen, len(seen) > 0
