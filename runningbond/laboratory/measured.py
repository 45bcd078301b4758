"""A tested wall: what is known before its test, and what was measured in it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runningbond.scene import Array

from .table_row import TableRow

NOISE = 0.05
"""Displacement, relative to the largest, below which a reversal is noise of the record and no turning point of the
loading."""

TWO_SIDED = 0.2
"""Ratio of the largest displacements to both sides, the smaller over the larger, above which a test is two-sided."""

LARGER = 1.1
"""Ratio of amplitudes up to which a cycle repeats an earlier one, and is left out of a prediction."""

FARTHER = 1.02
"""The same ratio for the largest cycle of all, which a prediction follows to where the test ended."""

DRIFTS = (1e-4, 1.0)
"""Largest displacements of a curve, relative to the actuator's height, at and beyond which their unit is wrong."""

CYCLIC, MONOTONIC = "cycl", "monoton"
"""Parts of the word by which a table describes the loading."""

SHOWN = "SW.30"
"""Beginning of the names of walls that are shown but not scored: their beam was not as free as reported."""


@dataclass(frozen=True, eq=False)
class MeasuredWall:
    """A tested wall.

    Parameters
    ----------
    name
        Name given by the campaign.
    row
        Its row of the table.
    curve : (n, 2) float
        Displacement at the height of the actuator [m] and horizontal force [N]; rows that are not numbers separate the
        loops of a record. Empty if only the peak is known.
    peaks
        Largest horizontal force [N] to one side, and to the other side if the wall was pushed there.
    modes
        Failure modes in the words of the table, such as R, TC, F, SL. Empty if none is reported.
    scene_file, cracks
        Its scene, if that is not made from the row, and the drawing of its cracks.
    is_turned
        Whether its record went to the negative side, and has its signs reversed here; its cracks are not mirrored.
    is_reversed
        Whether its record led from its farthest displacement to rest, and has its rows in the opposite order here.
    """

    name: str
    row: TableRow
    curve: Array
    peaks: tuple[float, ...]
    modes: tuple[str, ...]
    scene_file: Path | None = None
    cracks: Path | None = None
    is_turned: bool = False
    is_reversed: bool = False

    @property
    def reference(self) -> str:
        """Publication of the test."""
        return self.row.text("reference") or "–"

    @property
    def is_cyclic(self) -> bool:
        """Whether it was pushed to both sides."""
        said = self.row.text("cyclic / monotonic").casefold()
        if CYCLIC in said or MONOTONIC in said:
            return CYCLIC in said
        return min(self.reach) > TWO_SIDED * max(self.reach)

    @property
    def reach(self) -> tuple[float, float]:
        """Largest displacement of its curve to the positive and to the negative side [m]."""
        moved = np.append(self.curve[:, 0], 0.0)
        return float(np.nanmax(moved)), -float(np.nanmin(moved))

    @property
    def is_scored(self) -> bool:
        """Whether it is scored."""
        return not f"{self.name}.".startswith(f"{SHOWN}.")

    @property
    def peak(self) -> float | None:
        """Its strength [N]: the mean of both sides if it was pushed to both."""
        return float(np.mean(self.peaks)) if self.peaks else None

    @property
    def side(self) -> float:
        """Side to which it was pushed first: 1, or -1 for the negative one."""
        return -1.0 if self.path and self.path[0] < 0 else 1.0

    @property
    def path(self) -> tuple[float, ...]:
        """Displacements [m] to which the actuator was moved one after the other; empty without a curve."""
        moved = self.curve[~np.isnan(self.curve[:, 0]), 0]
        if not len(moved):
            return ()
        if not self.is_cyclic:
            return (float(moved[np.argmax(np.abs(moved))]),)
        return growing(turning_points(moved))


def turning_points(moved: Array) -> list[float]:
    """Turning points of a record of displacements ``(n,)``, and its end."""
    least = NOISE * float(np.ptp(moved)) / 2
    turns, extreme, sense = list[float](), float(moved[0]), 0.0
    for x in moved.tolist():
        if abs(x - extreme) >= least and (x - extreme) * sense <= 0:
            if sense:
                turns.append(extreme)
            sense, extreme = float(np.sign(x - extreme)), x
        elif (x - extreme) * sense > 0:
            extreme = x
    return [*turns, extreme]


def growing(turns: list[float]) -> tuple[float, ...]:
    """The first of several cycles of one size: turning points farther than any before, and the next one after each.

    Farther is `LARGER` times as far; the farthest of all turns need only be `FARTHER`. If the turns between two on the
    same side were left out, the second one replaces the first. If the record continues, the last turn is followed by
    the unloading, at most to zero displacement, which closes the largest loop.
    """
    kept, last, farthest, owed = list[float](), -1, 0.0, False
    most = max(map(abs, turns), default=0.0)
    for k, turn in enumerate(turns):
        grows = abs(turn) > (FARTHER if abs(turn) == most else LARGER) * farthest
        if grows or owed:
            if kept and (k - last) % 2 == 0:
                kept.pop()
            kept.append(turn)
            last, owed = k, grows
            farthest = max(farthest, abs(turn))
    if kept and last + 1 < len(turns):
        kept.append(turns[last + 1] if turns[last + 1] * kept[-1] > 0 else 0.0)
    return tuple(kept)
