"""Equilibrium of rigid blocks under a load or a displacement, or their fall: blocks creep on dashpots until at rest.

With the unbalanced forces g(x) and the elastic stiffness K_e, equilibrium is first sought directly, in one implicit
step from the plastic slip before it. If Newton's method finds none, the wall moves as if every joint had a dashpot
proportional to its springs,

    K_e q̇ = −g(q),                                                                                      (1)

and slip is taken up on the way: friction then follows a path that exists, instead of a state guessed far from it. A
wall at rest under (1) is in equilibrium; a wall that is not keeps moving. Loose blocks, for which the tangent
is singular, do not obstruct this: every joint resists its own motion, none the motion of the wall as a whole. Time
steps 1/ε are implicit,

    g(q) + ε K_e (q − q₀) = 0,                                                                          (2)

and solved by Newton's method with the consistent, unsymmetric Coulomb tangent. ε is adapted to the number of linear
systems per step, so that (2) turns into Newton's method for equilibrium as the wall comes to rest. This is
*pseudo-transient continuation* (Kelley & Keyes 1998) along a path with a physical meaning.
"""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from runningbond.joints import PointResponse
from runningbond.scene import Array

from .static_system import Control, StaticSystem, dot

RestVerdict: TypeAlias = Literal["rest", "fall", "undecided"]

BALANCE_TOLERANCE = 1e-9
"""Tolerance of the unbalanced force, relative to the largest joint force (or to the unit of force, if larger)."""

FIRST_RATE, MIN_RATE, MAX_RATE = 1e-2, 1e-12, 1e3
"""ε of the first time step if no equilibrium is found at once, and the bounds of ε."""

DRAG_TOLERANCE, FORCE_TOLERANCE = 0.3, 1e-10
"""Tolerances of the residual of (2), relative to dashpot forces and to the largest joint force; the larger counts."""

MAX_ITERATIONS, DIVERGENCE = 25, 100.0
"""Newton iterations after which a time step is given up, and growth of its residual above which it is."""

LINE_SEARCH = 1.0, 0.4, 0.16, 0.064
"""Factors of a Newton step that are tried in turn until the residual decreases enough."""

TARGET, MIN_FACTOR, MAX_FACTOR, RETRY_FACTOR = 8.0, 0.1, 2.0, 10.0
"""Linear systems in a time step after which ε stays, bounds of its factor after a step, factor after one given up."""

CAUTIOUS, CAUTIOUS_STEPS = 0.6, 3
"""Lower bound of the factor of ε after a time step was given up, and the number of steps for which it holds."""

FALL_RATIO, CREEP_RATIO = 0.9, 0.5
"""Ratio of the unbalanced force to that at half the motion, from which on a motion beyond `far` is a fall: at once,
or after `MAX_SOLVES`. The latter is lower because blocks that hit others on the way lose some force each time."""

MAX_SOLVES = 3000
"""Linear systems after which creep is left undecided, unless it has gone far and slowed down little (`CREEP_RATIO`)."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Result of `relax`."""

    # ``rest`` in equilibrium, ``fall`` if the wall moved farther than `far` without slowing down, or ``undecided``
    verdict: RestVerdict
    x: Array  # (n,) unknowns (q, r, λ) of the `StaticSystem`
    response: PointResponse  # response of the joint points
    last: Array  # (nd,) motion of the last time step
    solves: int  # linear systems solved


def relax(
    system: StaticSystem,
    guess: Array,
    plastic_slip: Array,
    control: Control,
    far: float,
    budget: int = MAX_SOLVES,
    *,
    creeps: bool = True,
) -> Rest:
    """Bring a wall to rest or to its fall.

    Parameters
    ----------
    guess : (n,) float
        Initial unknowns. They should satisfy the control: a step that restores it may increase the residual and fail.
    plastic_slip : (np,) float
        History of the joint points.
    control
        The last equation.
    far
        Motion of a freedom that counts as a fall unless it slows down.
    budget
        Linear systems after which the wall is left undecided.
    creeps
        Whether the wall may creep if there is no equilibrium at once; otherwise it is left undecided.
    """
    nd, x, rate, wary, refused, solves = system.freedoms, guess, MIN_RATE, 0, False, 0
    response = system.respond(x, plastic_slip)
    tangent, last = response.tangent, np.zeros(nd)
    path: list[tuple[float, float]] = []
    while True:
        residual = system.unbalanced(x, response, control)
        path.append((float(np.abs(x[:nd] - guess[:nd]).max()), _norm(residual[:nd])))
        # The same tolerance holds for displacement residuals: a unit of them makes about a unit of force.
        if np.abs(residual).max() <= BALANCE_TOLERANCE * _largest(response):
            return Rest("rest", x, response, last, solves)
        if path[-1][0] > far and _steady(path, FALL_RATIO):
            return Rest("fall", x, response, last, solves)
        made = None
        while made is None:
            if solves >= budget or (refused and not creeps):
                falls = solves >= MAX_SOLVES and path[-1][0] > far and _steady(path, CREEP_RATIO)
                return Rest("fall" if falls else "undecided", x, response, last, solves)
            made, taken = _creep(system, x, plastic_slip, control, rate, tangent, residual)
            solves += taken
            if made is not None and not refused and np.abs(made[0][:nd] - guess[:nd]).max() > far:
                made = None  # no fall is accepted in one step: an equilibrium may lie on the way
            if made is None:
                rate = min(RETRY_FACTOR * rate, MAX_RATE) if refused else FIRST_RATE
                wary, refused = CAUTIOUS_STEPS, True
        last, x, tangent, plastic_slip = made[0][:nd] - x[:nd], made[0], made[1].tangent, made[1].plastic_slip
        # The tangent is that of the last step: points that slid are assumed to keep sliding.
        response = system.respond(x, plastic_slip)
        rate = float(
            np.clip(rate * np.clip(taken / TARGET, CAUTIOUS if wary else MIN_FACTOR, MAX_FACTOR), MIN_RATE, MAX_RATE)
        )
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
    """Take one time step (2) from `start`: unknowns and response after it, or None, and the linear systems it took."""
    nd, x, drag = system.freedoms, start, np.zeros(system.freedoms)
    first = size = _norm(residual)
    for taken in range(1, MAX_ITERATIONS + 1):
        try:
            step = system.solve(tangent + rate * system.elastic, control, -residual)
        except np.linalg.LinAlgError:
            return None, taken
        if not np.isfinite(step).all():
            return None, taken
        by_step, best = rate * system.viscous(step), np.inf
        for share in LINE_SEARCH:
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
        if size <= max(DRAG_TOLERANCE * _norm(drag), FORCE_TOLERANCE * _largest(response)):
            return (x, response), taken
        if size > DIVERGENCE * first:
            return None, taken
    return None, MAX_ITERATIONS


def _steady(path: list[tuple[float, float]], share: float) -> bool:
    """Whether the unbalanced force is at least `share` of its last value within the first half of the motion."""
    moved, size = path[-1]
    return size >= share * next(before for way, before in reversed(path) if way <= moved / 2)


def _largest(response: PointResponse) -> float:
    return float(max(np.abs(response.normal).max(initial=0.0), np.abs(response.tangential).max(initial=0.0), 1.0))


def _norm(vector: Array) -> float:
    return math.sqrt(dot(vector, vector))
