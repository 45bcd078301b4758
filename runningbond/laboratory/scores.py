"""How a prediction is scored: strength, stiffness, displacements, and of cycles what they dissipate and leave.

Curves are displacements [m] and forces [N], ``(n, 2)``; rows that are not numbers part the loops of a record. A number
that does not exist is None.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from runningbond.dynamics.lead import LOSS
from runningbond.scene import Array

SECANT = 0.3
"""Share of the strength at which the stiffness is read."""

ROUNDING = 1e-9
"""Share of the work done to and fro below which the sum of it is rounding."""


@dataclass(frozen=True)
class Marks:
    """What is read off a curve.

    Parameters
    ----------
    strength
        Largest force [N]; of a curve to both sides the mean of both.
    stiffness
        Secant at 0.3 of the strength [N/m]; of a curve to both sides, of the first branch from one to the other.
    at_peak, at_loss
        Displacements [m] of the largest force, and where it has first fallen to 0.8 of it, on the side pushed to first.
    dissipated
        Work of the force over the whole record [J], of a curve to both sides.
    residual
        Largest displacement [m] without force, of a curve to both sides.
    """

    strength: float
    stiffness: float | None
    at_peak: float
    at_loss: float | None
    dissipated: float | None = None
    residual: float | None = None


def marks_of(curve: Array, *, cyclic: bool) -> Marks | None:
    """What there is to read off a curve; None without one, or without a force along the way."""
    known = curve[~np.isnan(curve).any(axis=1)]
    if len(known) < 2 or known[:, 1].max() <= 0:
        return None
    sides = [backbone(known), backbone(-known)] if cyclic else [known]
    peaks = [float(side[:, 1].max()) for side in sides]
    strength = float(np.mean([peak for peak in peaks if peak > 0]))
    force = SECANT * strength
    reach = swing(known, force) if cyclic else first_crossing(known, force)
    stiffness = (2 if cyclic else 1) * force / reach if reach else None
    side = sides[0]
    top = int(side[:, 1].argmax())
    loss = first_crossing(side[top:] * (1, -1), -LOSS * float(side[top, 1]))
    energies = (dissipated(curve), residual(curve)) if cyclic else (None, None)
    return Marks(strength, stiffness, float(side[top, 0]), loss, *energies)


def backbone(curve: Array) -> Array:
    """The points of a curve that go farther to the positive side than any before, from rest."""
    forward = np.concatenate([[[0.0, 0.0]], curve])
    farthest = np.maximum.accumulate(forward[:, 0])
    new = np.append(True, (forward[1:, 0] > farthest[:-1]) & (forward[1:, 1] > 0))
    return np.asarray(forward[new])


def first_crossing(curve: Array, force: float) -> float | None:
    """Displacement at which a force is first reached, between two points of a curve; None where it is not."""
    reached = np.flatnonzero(curve[:, 1] >= force)
    if not len(reached):
        return None
    k = int(reached[0])
    if k == 0:
        return float(curve[0, 0])
    (x0, y0), (x1, y1) = curve[k - 1 : k + 1]
    return float(x0 + (x1 - x0) * (force - y0) / (y1 - y0))


def swing(curve: Array, force: float) -> float | None:
    """Displacement over which a cycle first runs from a force to its opposite; None if it never does.

    Both lie on one branch, so that what friction has left behind does not count.
    """
    start: tuple[float, float] | None = None  # the side on which the force was last beyond, and where it ceased to be
    for (x0, y0), (x1, y1) in pairwise(curve.tolist()):
        if abs(y0) >= force > abs(y1) or (abs(y0) >= force and abs(y1) >= force and y0 * y1 < 0):
            side = float(np.sign(y0))
            start = (side, x0 + (x1 - x0) * (side * force - y0) / (y1 - y0))
        if start is not None and -start[0] * y1 >= force:
            x = x0 + (x1 - x0) * (-start[0] * force - y0) / (y1 - y0)
            return float(abs(x - start[1]))
    return None


def dissipated(curve: Array) -> float:
    """Work of the force [J] along a curve, by trapezia; nothing where the record is parted.

    What comes back but for rounding was not dissipated.
    """
    steps = np.diff(curve[:, 0]) * (curve[1:, 1] + curve[:-1, 1]) / 2
    work, turnover = float(np.nansum(steps)), float(np.nansum(np.abs(steps)))
    return work if abs(work) > ROUNDING * turnover else 0.0


def residual(curve: Array) -> float | None:
    """Largest displacement [m] at which the force changes its sign; None where it never does."""
    zeros = list[float]()
    for (x0, y0), (x1, y1) in pairwise(curve.tolist()):
        if y0 * y1 < 0:
            zeros.append(abs(x0 - y0 * (x1 - x0) / (y1 - y0)))
    return max(zeros, default=None)


def cycle_peaks(curve: Array, path: tuple[float, ...]) -> list[float]:
    """Force [N] of largest size on the way to each displacement of a path, as far as a curve goes along it."""
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
    """A predicted number over the measured one; None where one of them does not exist."""
    return predicted / measured if predicted is not None and measured else None
