"""A wall that was tested: what is known of it before its test, and what was measured in it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runningbond.scene import Array

from .table_row import TableRow

SWING = 0.05
"""Displacements that turn back by less, relative to the largest, are noise of the record and no turn of the rig."""

BOTH = 0.2
"""Displacement to the lesser side, relative to that to the other, above which a wall was pushed to both."""

LARGER = 1.1
"""Cycles not larger than the last one by this factor repeat it, and are left out of a prediction."""

CYCLIC, MONOTONIC = "cycl", "monoton"
"""In the word that a table has for how a wall was pushed."""

SHOWN = "SW.30"
"""Walls of this load are shown and not scored: their beam was not as free as it is said."""


@dataclass(frozen=True, eq=False)
class MeasuredWall:
    """A tested wall.

    Parameters
    ----------
    name
        What the campaign calls it.
    row
        Its row of the table.
    curve : (n, 2) float
        Displacement at the height of the actuator [m] and horizontal force [N]; rows that are not numbers part the
        loops of a record. Empty where only the peak is known.
    peaks
        Largest horizontal force [N] to one side, and to the other where it was pushed there.
    modes
        How it failed, in the words of the table, such as R, TC, F, SL. Empty where that is not said.
    scene_file, cracks
        Its scene where it is not made from the row, and the drawing of its cracks.
    is_turned
        Whether its record went to the negative side and is turned round here, as its cracks are not.
    """

    name: str
    row: TableRow
    curve: Array
    peaks: tuple[float, ...]
    modes: tuple[str, ...]
    scene_file: Path | None = None
    cracks: Path | None = None
    is_turned: bool = False

    @property
    def reference(self) -> str:
        """Where it was published."""
        return self.row.text("reference") or "–"

    @property
    def is_cyclic(self) -> bool:
        """Whether it was pushed to both sides."""
        said = self.row.text("cyclic / monotonic").casefold()
        if CYCLIC in said or MONOTONIC in said:
            return CYCLIC in said
        return min(self.reach) > BOTH * max(self.reach)

    @property
    def reach(self) -> tuple[float, float]:
        """How far its curve goes to the positive and to the negative side [m]."""
        moved = np.append(self.curve[:, 0], 0.0)
        return float(np.nanmax(moved)), -float(np.nanmin(moved))

    @property
    def is_scored(self) -> bool:
        """Whether it counts."""
        return not f"{self.name}.".startswith(f"{SHOWN}.")

    @property
    def peak(self) -> float | None:
        """Its strength [N]: the mean of both sides where it was pushed to both."""
        return float(np.mean(self.peaks)) if self.peaks else None

    @property
    def path(self) -> tuple[float, ...]:
        """Displacements [m] that the actuator was taken to one after the other; empty where no curve says so."""
        moved = self.curve[~np.isnan(self.curve[:, 0]), 0]
        if not len(moved):
            return ()
        if not self.is_cyclic:
            return (float(moved[np.argmax(np.abs(moved))]),)
        return growing(turning_points(moved))


def turning_points(moved: Array) -> list[float]:
    """Where a record of displacements ``(n,)`` turns back, and its end."""
    least = SWING * float(np.ptp(moved)) / 2
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
    """The first of several cycles of one size: turns that go farther than any before, and the one after each.

    Where those between two to one side were left out, the second one takes the first one's place. Where the record goes
    on, the last one is let go back, if no farther than to rest: that closes the largest loop.
    """
    kept, last, farthest, owed = list[float](), -1, 0.0, False
    for k, turn in enumerate(turns):
        grows = abs(turn) > LARGER * farthest
        if grows or owed:
            if kept and (k - last) % 2 == 0:
                kept.pop()
            kept.append(turn)
            last, owed = k, grows
            farthest = max(farthest, abs(turn))
    if kept and last + 1 < len(turns):
        kept.append(turns[last + 1] if turns[last + 1] * kept[-1] > 0 else 0.0)
    return tuple(kept)
