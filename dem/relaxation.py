"""Rest of rigid blocks under a load or a displacement, or their fall: blocks creep on dashpots until they are still.

With g(x) the unbalanced forces and K_e the elastic stiffness, the wall is first asked for equilibrium at once, as
one implicit step whose history is the plastic slip before it. Where Newton's method finds none, the wall moves as
it would if every joint had a dashpot in proportion to its springs,

    K_e q̇ = −g(q),                                                                                      (1)

slip being taken up on the way: friction along a path that exists, instead of a state guessed far from it. What is at
rest under (1) is in equilibrium, what is not goes on moving for ever, and loose blocks, for which the tangent is
singular, hold nothing up: every joint resists its own motion and none that of the wall as a whole. Time steps 1/ε
are implicit,

    g(q) + ε K_e (q − q₀) = 0,                                                                          (2)

and solved by Newton's method with the consistent, unsymmetric Coulomb tangent; ε follows the linear systems this
takes, so that (2) turns into Newton's method for equilibrium as the wall comes to rest. This is *pseudo-transient
continuation* (Kelley & Keyes 1998) with a path that means something.
"""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from runningbond.joints import PointResponse
from runningbond.scene import Array

from .static_system import Control, StaticSystem, dot

RestVerdict: TypeAlias = Literal["rest", "fall", "undecided"]

BALANCED = 1e-9
"""Largest unbalanced force that counts as none, relative to the largest joint force (or to the unit of force)."""

FIRST, LEAST, LARGEST = 1e-2, 1e-12, 1e3
"""ε of the first time step if there is no equilibrium at once, and its bounds."""

FOLLOWED, EXACT = 0.3, 1e-10
"""Error with which (2) counts as solved, relative to its dashpots' forces or to the largest joint force."""

PATIENCE, HOPELESS = 25, 100.0
"""Linear systems after which a time step is given up, and growth of its error at which it is."""

LENGTHS = 1.0, 0.4, 0.16, 0.064
"""Lengths of a Newton step that are tried in turn while it errs more after it than before."""

USUAL, SMALLER, LARGER, REFUSAL = 8.0, 0.1, 2.0, 10.0
"""Linear systems after which ε stays, bounds of its factor after a time step, and its factor after one given up."""

WARY, WARINESS = 0.6, 3
"""Least factor of ε soon after a time step was given up, and how many time steps are soon."""

STEADY, SLOWING = 0.9, 0.5
"""Unbalanced force, relative to that before half the motion, at which a fall does not slow down; and at which a creep
of the `LONGEST` kind is one all the same: blocks that meet others on the way lose some of it each time."""

LONGEST = 3000
"""Linear systems after which a creep that neither rests nor falls is left undecided, unless it goes on far away."""


@dataclass(frozen=True, eq=False)
class Rest:
    """What became of a wall."""

    # ``rest`` in equilibrium, ``fall`` if it went farther than asked without slowing down, or ``undecided``
    verdict: RestVerdict
    x: Array  # (n,) unknowns (q, r, λ) of the `StaticSystem`
    response: PointResponse  # answer of the joint points
    last: Array  # (nd,) motion of the last time step
    solves: int  # linear systems solved


def relax(
    system: StaticSystem,
    guess: Array,
    plastic_slip: Array,
    control: Control,
    far: float,
    budget: int = LONGEST,
    *,
    creeps: bool = True,
) -> Rest:
    """Let a wall come to rest or fall.

    Parameters
    ----------
    guess : (n,) float
        First unknowns; they should satisfy the control, or the first step is judged by forces it must disturb.
    plastic_slip : (np,) float
        History of the joint points.
    control
        The last equation.
    far
        Motion of a freedom that is a fall unless it slows down.
    budget
        Linear systems after which it is left undecided.
    creeps
        Whether it may creep where there is no equilibrium at once; else it is left undecided.
    """
    nd, x, rate, wary, refused, solves = system.freedoms, guess, LEAST, 0, False, 0
    response = system.respond(x, plastic_slip)
    tangent, last = response.tangent, np.zeros(nd)
    path: list[tuple[float, float]] = []
    while True:
        residual = system.unbalanced(x, response, control)
        path.append((float(np.abs(x[:nd] - guess[:nd]).max()), _norm(residual[:nd])))
        # Displacements, of which one unit makes about one unit of force, are held to the same measure.
        if np.abs(residual).max() <= BALANCED * _largest(response):
            return Rest("rest", x, response, last, solves)
        if path[-1][0] > far and _steady(path, STEADY):
            return Rest("fall", x, response, last, solves)
        made = None
        while made is None:
            if solves >= budget or (refused and not creeps):
                falls = solves >= LONGEST and path[-1][0] > far and _steady(path, SLOWING)
                return Rest("fall" if falls else "undecided", x, response, last, solves)
            made, taken = _creep(system, x, plastic_slip, control, rate, tangent, residual)
            solves += taken
            if made is not None and not refused and np.abs(made[0][:nd] - guess[:nd]).max() > far:
                made = None  # nothing falls at once: a rest may lie on the way
            if made is None:
                rate = min(REFUSAL * rate, LARGEST) if refused else FIRST
                wary, refused = WARINESS, True
        last, x, tangent, plastic_slip = made[0][:nd] - x[:nd], made[0], made[1].tangent, made[1].plastic_slip
        # The tangent is that of the step behind: a point that slid is taken to slide on.
        response = system.respond(x, plastic_slip)
        rate = float(np.clip(rate * np.clip(taken / USUAL, WARY if wary else SMALLER, LARGER), LEAST, LARGEST))
        wary = max(wary - 1, 0)


def _creep(
    system: StaticSystem,
    start: Array,
    plastic_slip: Array,
    control: Control,
    rate: float,
    tangent: Array,
    residual: Array,
) -> tuple[tuple[Array, PointResponse] | None, int]:
    """One time step (2) from `start`: unknowns and response after it, or None; and the linear systems it took."""
    nd, x, drag = system.freedoms, start, np.zeros(system.freedoms)
    first = size = _norm(residual)
    for taken in range(1, PATIENCE + 1):
        try:
            step = system.solve(tangent + rate * system.elastic, control, -residual)
        except np.linalg.LinAlgError:
            return None, taken
        if not np.isfinite(step).all():
            return None, taken
        by_step, best = rate * system.viscous(step), np.inf
        for share in LENGTHS:
            tried, dragged = x + share * step, drag + share * by_step
            answer = system.respond(tried, plastic_slip)
            left = system.unbalanced(tried, answer, control)
            left[:nd] += dragged
            error = _norm(left)
            if error < best:
                best, kept = error, (tried, dragged, answer, left)
            if error < (1 - share / 4) * size:
                break
        if not np.isfinite(best):
            return None, taken
        x, drag, response, residual = kept
        size, tangent = best, response.tangent
        if size <= max(FOLLOWED * _norm(drag), EXACT * _largest(response)):
            return (x, response), taken
        if size > HOPELESS * first:
            return None, taken
    return None, PATIENCE


def _steady(path: list[tuple[float, float]], share: float) -> bool:
    """Whether the unbalanced force is still some share of what it was before half the motion, or larger."""
    moved, size = path[-1]
    return size >= share * next(before for way, before in reversed(path) if way <= moved / 2)


def _largest(response: PointResponse) -> float:
    return float(max(np.abs(response.normal).max(initial=0.0), np.abs(response.tangential).max(initial=0.0), 1.0))


def _norm(vector: Array) -> float:
    return math.sqrt(dot(vector, vector))
