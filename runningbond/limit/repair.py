"""Proofs from the approximate result of an interior point: balanced forces, and a mechanism that obeys the flow rule.

Both are corrected in the metric of the interior point's last step, in which unknowns far from their bounds change most.
Forces are balanced by weighted least squares. If forces of the wall at rest, well inside all bounds, are known, the
result is moved towards them just until all forces are within bounds. Otherwise forces that leave their bounds are held
there, and the others balanced again. The mechanism is fitted repeatedly to nonnegative reduced costs; the weight of
points that keep closing is increased tenfold from time to time. The results are checked directly, to `ROUNDING`.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import block_array, csc_array, eye_array
from scipy.sparse.linalg import splu

from runningbond.scene import Array

from .interior_point import InteriorPoint

ROUNDING = 1e-11
"""Imbalance relative to the largest force, and closing relative to the largest motion, accepted as rounding errors."""

ROUNDS, STEPS = 12, 40
"""Largest number of metrics in which forces are balanced or a mechanism is corrected, and corrections of a mechanism in
each metric."""

MAX_WEIGHT = 1e10
"""Largest weight of a point that keeps closing; larger ones would swamp the others."""

HELD_COMPLIANCE = 1e-6
"""Factor on the compliance of a force that has left its bounds."""

REGULARISATION = 1e-13
"""Relative stiffness added to motions that no force resists."""

Solve = Callable[[Array], tuple[Array, float]]


def metric(program: dict[str, Any], weights: Array) -> Solve:
    """Factorise A W Aᵀ, bordered by the last column, that of the multiplier, which balances what the forces cannot.

    The result maps right-hand sides ``(m,)`` to multipliers ``(m,)`` and the change of λ; to NaN if singular.
    """
    matrix = program["A_eq"]
    forces = matrix[:, :-1]  # the last column is full, and would make the product full
    stiffness = csc_array((forces * weights[None, :-1]) @ forces.T)
    scale = 1 / np.sqrt(stiffness.diagonal() + np.finfo(float).tiny)
    stiffness = csc_array(stiffness * scale[:, None] * scale[None] + REGULARISATION * eye_array(len(scale)))
    fixed = program["bounds"][-1, 0] == program["bounds"][-1, 1]
    column = np.zeros(len(scale)) if fixed else matrix[:, [-1]].toarray()[:, 0] * scale
    size = float(np.abs(column).max()) or 1.0
    border = csc_array(column[:, None] / size)
    parts: list[list[csc_array]] = [[stiffness, border], [csc_array(border.T), csc_array([[-REGULARISATION]])]]
    bordered = csc_array(block_array(parts))
    try:
        factors = splu(bordered, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:  # raised by SuperLU for a zero pivot
        return lambda right: (np.full_like(right, np.nan), math.nan)

    def solve(right: Array) -> tuple[Array, float]:
        found = factors.solve(np.append(scale * right, 0.0))
        return scale * found[:-1], found[-1] / size

    return solve


def balanced(program: dict[str, Any], point: InteriorPoint, resting: Array | None) -> Array | None:
    """Balanced forces ``(n,)`` within their bounds, near those of an interior point; None if not found.

    `resting` are balanced forces strictly within the bounds, at any multiplier.
    """
    matrix, weights, forces = program["A_eq"], point.compliance.copy(), point.forces.copy()
    weights[-1] = 0.0
    for _ in range(ROUNDS):
        solve = metric(program, weights)
        for _ in range(3):
            multipliers, change = solve(program["b_eq"] - matrix @ forces)
            forces += weights * (matrix.T @ multipliers)
            forces[-1] += change
        if resting is not None:
            forces = _inside(program, forces, resting)
        inside: Array = forces.clip(*program["bounds"].T)
        if np.abs(program["b_eq"] - matrix @ inside).max() <= ROUNDING * np.abs(inside).max():
            return inside
        if resting is not None or not np.isfinite(inside).all():
            return None
        weights[inside != forces] *= HELD_COMPLIANCE
        forces = inside
    return None


def _distance_to_bounds(program: dict[str, Any], forces: Array) -> Array:
    """Distance of forces ``(n,)`` from the nearer of their bounds, negative beyond it."""
    low, high = program["bounds"].T
    return np.asarray(np.minimum(forces - low, high - forces))


def _inside(program: dict[str, Any], forces: Array, resting: Array) -> Array:
    """Interpolate from forces towards those at rest, just until all are within the bounds."""
    here, there = _distance_to_bounds(program, forces), _distance_to_bounds(program, resting)
    beyond = here < 0
    if not beyond.any():
        return forces
    share = float((here[beyond] / (here[beyond] - there[beyond])).max()) * (1 + 1e-9)
    return np.asarray((1 - share) * forces + share * resting)


def admissible(program: dict[str, Any], point: InteriorPoint) -> Array | None:
    """Mechanism ``(m,)`` near that of an interior point that obeys the flow rule; None if not found."""
    matrix, cost, (low, high) = program["A_eq"], program["c"], program["bounds"].T
    half, free = np.isfinite(low) & np.isinf(high), np.isinf(low)
    half[-1], free[-1] = False, False
    motion, weights = point.motion.copy(), point.compliance.copy()
    weights[-1] = 0.0
    rounding = ROUNDING * float(np.abs(motion).max())
    for k in range(ROUNDS):
        slack = point.slack if k < 3 else 0.0  # if blocks wedge each other, no motion opens their points
        solve = metric(program, weights)
        for _ in range(STEPS):
            if not np.isfinite(motion).all():  # the metric was singular
                return None
            reduced = cost - matrix.T @ motion
            closing, held = half & (reduced < 0), np.abs(reduced[free]).max(initial=0.0)
            if not closing.any() and held <= rounding:
                return motion
            goal = np.where(half, np.maximum(reduced, slack), np.where(free, 0.0, reduced))
            last = motion
            motion = motion + solve(matrix @ (weights * (reduced - goal)))[0]
        if max(held, -reduced[closing].min(initial=0.0)) <= rounding:  # no motion opens all of these points
            return last
        weights[closing] = (10 * weights[closing]).clip(max=MAX_WEIGHT)
    return None
