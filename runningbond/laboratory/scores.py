"""Scores of a prediction: strength, stiffness, displacements and, for cycles, energy and residual displacement.

Curves are displacements [m] and forces [N], ``(n, 2)``; rows that are not numbers separate the loops of a record. A
number that does not exist is None.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from runningbond.dynamics.path_curve import LOSS
from runningbond.scene import Array

from .measured import LARGER, NOISE, TWO_SIDED

SECANT = 0.3
"""Share of the strength at which the secant stiffness is read."""

UNLOADED = 0.01
"""Share of the largest displacement by which a one-sided record goes back if it is unloaded; less is noise."""

ROUNDING = 1e-9
"""Net work of a loop, relative to the sum of the magnitudes of its increments, up to which it is rounding error."""

LEAST_DISSIPATED = 0.01
"""Net work of a measured loop, relative to the sum of the magnitudes of its increments, up to which it is no more than
the error of load cells."""


@dataclass(frozen=True)
class Marks:
    """Values read from a curve.

    Parameters
    ----------
    strength
        Largest force [N]; for a curve to both sides, the mean of both.
    stiffness
        Secant at 0.3 of the strength [N/m]; for a curve to both sides, that of the first branch from one side to the
        other, or of its two envelopes together if there is none.
    at_peak, at_loss
        Displacements [m] at the largest force, and where the force has first fallen to 0.8 of it, on the side pushed to
        first; for a curve to both sides, where it has finally fallen so far.
    loops
        For a curve to both sides, the result of `loops`.
    residual
        Largest displacement [m] at which the force has returned to zero, for a curve to both sides.
    """

    strength: float
    stiffness: float | None
    at_peak: float
    at_loss: float | None
    loops: tuple["Loop", ...] = ()
    residual: float | None = None


class Loop(NamedTuple):
    """A loop of a record.

    Parameters
    ----------
    reach
        Its largest displacement to the positive side [m].
    work
        Work of the force along it [J].
    turnover
        Sum of the magnitudes of the increments of this work [J].
    is_two_sided
        Whether it goes to both sides.
    """

    reach: float
    work: float
    turnover: float = 0.0
    is_two_sided: bool = True


def marks_of(curve: Array, *, cyclic: bool, side: float = 1.0) -> Marks | None:
    """Values that can be read from a curve; None if there is no curve, or no force along it.

    A curve to both sides is read from the side to which the test is pushed first, 1 or -1: the same for a record and
    for its predictions, whose first cycle may be too small to be seen in one of them.
    """
    curve = curve * side if cyclic else curve
    known = curve[~np.isnan(curve).any(axis=1)]
    if len(known) < 2 or known[:, 1].max() <= 0:
        return None
    sides = _pushed(backbone(known), backbone(-known)) if cyclic else [_onward(_from_rest(known))]
    peaks = [peak for side in sides if (peak := float(side[:, 1].max())) > 0]
    if not peaks:
        return None
    strength = float(np.mean(peaks))
    force = SECANT * strength
    branch = _first_reversal(curve, force) if cyclic else None
    reaches = [first_crossing(side, force) for side in sides] if branch is None else [branch / 2, branch / 2]
    stiffness = _secant(force, reaches)
    first = sides[0]
    top = int(first[:, 1].argmax())
    after, borne = first[top:], LOSS * float(first[top, 1])
    if cyclic:  # reloading may pass below the envelope
        after = after[int(np.flatnonzero(after[:, 1] >= borne)[-1]) :]
    else:  # without unloading, which reduces the force as the displacement goes back, even by noise
        after = after[after[:, 0] >= np.maximum.accumulate(after[:, 0])]
    loss = first_crossing(after * (1, -1), -borne)
    both = (tuple(loops(curve)), residual(curve)) if cyclic else ((), None)
    return Marks(strength, stiffness, float(first[top, 0]), loss, *both)


def _secant(force: float, reaches: Sequence[float | None]) -> float | None:
    """Mean secant stiffness to a force that is reached at some displacements, one on each side; else None."""
    reached = [reach for reach in reaches if reach is not None and reach > 0]
    return len(reached) * force / sum(reached) if len(reached) == len(reaches) else None


def _pushed(*sides: Array) -> list[Array]:
    """Curves to the sides to which a wall was pushed, without a side reached only by noise on the way back to rest."""
    reach = [float(side[:, 0].max()) for side in sides]
    return [side for side, far in zip(sides, reach, strict=True) if far > NOISE * max(reach)]


def _from_rest(curve: Array) -> Array:
    """A one-sided curve that starts at rest, even if its record does not."""
    return np.concatenate([np.zeros((1, 2)), curve]) if curve[0, 0] > 0 and curve[0, 1] > 0 else curve


def _onward(curve: Array) -> Array:
    """A one-sided curve without its unloading and reloading."""
    moved = curve[:, 0]
    return np.asarray(curve[moved >= np.maximum.accumulate(moved) - UNLOADED * moved.max()])


def backbone(curve: Array) -> Array:
    """The points of a curve that are farther to the positive side than all points before, starting from rest."""
    forward = np.concatenate([[[0.0, 0.0]], curve])
    farthest = np.maximum.accumulate(forward[:, 0])
    new = np.append(True, (forward[1:, 0] > farthest[:-1]) & (forward[1:, 1] > 0))
    return np.asarray(forward[new])


def first_crossing(curve: Array, force: float) -> float | None:
    """Displacement at which a force is first reached, interpolated between points of a curve; else None."""
    reached = np.flatnonzero(curve[:, 1] >= force)
    if not len(reached):
        return None
    k = int(reached[0])
    if k == 0:
        return float(curve[0, 0])
    (x0, y0), (x1, y1) = curve[k - 1 : k + 1]
    return float(x0 + (x1 - x0) * (force - y0) / (y1 - y0))


def force_reversal(curve: Array, force: float) -> float | None:
    """Displacement over which a cycle first runs from a force to its opposite; None if it never does.

    Both forces lie on one branch, to exclude residual displacements due to friction.
    """
    start: tuple[float, float] | None = None  # side of the last excess of the force; displacement at its end
    for (x0, y0), (x1, y1) in pairwise(curve.tolist()):
        if abs(y0) >= force > abs(y1) or (abs(y0) >= force and abs(y1) >= force and y0 * y1 < 0):
            side = float(np.sign(y0))
            start = (side, x0 + (x1 - x0) * (side * force - y0) / (y1 - y0))
        if start is not None and -start[0] * y1 >= force:
            x = x0 + (x1 - x0) * (-start[0] * force - y0) / (y1 - y0)
            return float(abs(x - start[1]))
    return None


def _first_reversal(curve: Array, force: float) -> float | None:
    """`force_reversal` of the first stretch of a record that has one: branches do not continue across gaps."""
    reversals = (force_reversal(part, force) for part in _parts(curve))
    return next((reach for reach in reversals if reach is not None), None)


def loops(curve: Array) -> list[Loop]:
    """The loops of a record, in its order.

    A loop leads from an upward zero crossing of the force, where no elastic energy is stored, to the next one. If a
    part of the record returns to its start, its ends form one more loop. Ends of other parts, and pieces no longer than
    noise (`NOISE`), are none.
    """
    found = list[Loop]()
    for part in _parts(curve):
        part = _with_zeros(part)
        rises, closed = _rises(part), abs(part[-1, 0] - part[0, 0]) <= NOISE * np.ptp(part[:, 0])
        pieces = [part[start : end + 1] for start, end in pairwise(rises)]
        if closed:
            pieces.append(np.concatenate([part[rises[-1] :], part[: rises[0] + 1]]) if rises else part)
        least = NOISE * np.ptp(part[:, 0])
        found += [_loop(each) for each in pieces if np.ptp(each[:, 0]) > least]
    return found


def _loop(piece: Array) -> Loop:
    """A loop of a piece of a record; its work is that of the trapezoidal rule, and zero if it is only rounding."""
    steps = np.diff(piece[:, 0]) * (piece[1:, 1] + piece[:-1, 1]) / 2
    work, turnover = float(steps.sum()), float(np.abs(steps).sum())
    right, left = float(piece[:, 0].max()), -float(piece[:, 0].min())
    is_two_sided = min(right, left) > TWO_SIDED * max(right, left)
    return Loop(right, work if abs(work) > ROUNDING * turnover else 0.0, turnover, is_two_sided)


def energy_ratio(predicted: Sequence[Loop], measured: Sequence[Loop]) -> float | None:
    """Work of predicted loops over that of measured loops of equal reach, to within `LARGER`, to as many sides.

    Of several loops of equal reach the first counts. None if no predicted loop has the reach of a measured one that
    dissipates.
    """
    own, theirs, farthest = 0.0, 0.0, 0.0
    for loop in measured:
        alike = [
            each.work
            for each in predicted
            if loop.reach / LARGER <= each.reach <= loop.reach * LARGER and each.is_two_sided == loop.is_two_sided
        ]
        dissipates = loop.work > LEAST_DISSIPATED * loop.turnover
        if loop.reach > LARGER * farthest and alike and dissipates:
            own, theirs, farthest = own + alike[0], theirs + loop.work, loop.reach
    return own / theirs if theirs > 0 else None


def _parts(curve: Array) -> list[Array]:
    """Stretches of a record between rows that are not numbers; a stretch that starts where one ended continues it."""
    parted = np.flatnonzero(np.isnan(curve).any(axis=1))
    parts = list[Array]()
    for stretch in np.split(curve, parted):
        points = stretch[1:] if np.isnan(stretch[:1]).any() else stretch
        if len(parts) and len(points) and np.array_equal(parts[-1][-1], points[0]):
            parts[-1] = np.concatenate([parts[-1], points[1:]])
        elif len(points) > 1:
            parts.append(points)
    return parts


def _with_zeros(part: Array) -> Array:
    """A stretch of a record with points inserted where the force changes its sign."""
    (x0, y0), (x1, y1) = part[:-1].T, part[1:].T
    k = np.flatnonzero(y0 * y1 < 0)
    zeros = np.column_stack([x0[k] - y0[k] * (x1[k] - x0[k]) / (y1[k] - y0[k]), np.zeros(len(k))])
    return np.insert(part, k + 1, zeros, axis=0)


def _rises(part: Array) -> list[int]:
    """Upward zero crossings of the force after it was clearly negative, or at the beginning."""
    least = NOISE * float(np.abs(part[:, 1]).max())
    rises, below = list[int](), abs(part[0, 1]) < least
    for k, force in enumerate(part[:, 1].tolist()):
        if below and force >= 0:
            rises.append(k)
        below = force <= -least or (below and force < 0)
    return rises


def residual(curve: Array) -> float | None:
    """Largest displacement [m] at which the force returns to zero, recorded or interpolated; None if it does not."""
    zeros = list[float]()
    for (x0, y0), (x1, y1) in pairwise(curve.tolist()):
        if y0 * y1 < 0 or (y1 == 0 and abs(y0) > 0):
            zeros.append(abs(x0 - y0 * (x1 - x0) / (y1 - y0)))
    return max(zeros, default=None)


def is_envelope(curve: Array) -> bool:
    """Whether a record goes outward from rest in two parts, one to each side."""
    parts = _parts(curve)
    sides = {float(np.sign(part[-1, 0])) for part in parts}
    return len(parts) == 2 and len(sides) == 2 and all((np.diff(np.abs(part[:, 0])) >= 0).all() for part in parts)


def cycle_ends(path: tuple[float, ...]) -> tuple[float, ...]:
    """Displacements of a path to which a wall is pushed; unloading, to rest or beyond it by noise, does not count."""
    return tuple(
        goal for start, goal in pairwise((0.0, *path)) if (goal - start) * goal > 0 and abs(goal) > NOISE * abs(start)
    )


def has_cycles(path: tuple[float, ...]) -> bool:
    """Whether a path pushes a wall to and fro."""
    return len(cycle_ends(path)) > 1


def goes_to_both_sides(path: tuple[float, ...]) -> bool:
    """Whether a path pushes a wall to both sides."""
    return len({goal > 0 for goal in cycle_ends(path)}) > 1


def cycle_peaks(curve: Array, path: tuple[float, ...]) -> list[float]:
    """Force [N] of largest magnitude on the way to each displacement of a path, as far as a curve follows the path."""
    known = curve[~np.isnan(curve).any(axis=1)]
    peaks, start = list[float](), 0
    for goal in path:
        toward = known[start:] * np.sign(goal)
        there = np.flatnonzero(toward[:, 0] >= abs(goal) * 0.98)
        if not len(there):
            break
        peaks.append(float(np.sign(goal) * toward[: there[0] + 1, 1].max()))
        start += int(there[0])
    return peaks


def ratio(predicted: float | None, measured: float | None) -> float | None:
    """A predicted number over the measured one; None if either does not exist."""
    return predicted / measured if predicted is not None and measured else None
