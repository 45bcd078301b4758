"""Equilibrium of rigid blocks at a given control: Newton's method kept in check by a vanishing proximal term.

With g(x) the unbalanced forces and K their consistent, unsymmetric tangent, each iteration solves

    (K + ε diag K_e) Δq = −g                                                                            (1)

K_e being the elastic stiffness. This is one implicit step of length 1/ε of the blocks' motion in a viscous fluid,
diag(K_e) q̇ = −g, whose rest is true equilibrium whatever ε is: *pseudo-transient continuation* (Kelley & Keyes
1998). Small ε is Newton's method. Large ε follows the fluid motion, which always goes on: loose blocks beside
openings, for which K is singular, fall until something carries them. Next ε is chosen by how well the linear
model (1) foretold the unbalanced forces, as a trust region's radius is.
"""

from dataclasses import dataclass

import numpy as np

from joints import PointResponse
from scene import Array

from .static_system import Control, StaticSystem

BALANCED = 1e-9
"""Largest unbalanced force that counts as none, relative to the largest joint force (or to the unit of force)."""

FIRST_PROXIMAL, LEAST_PROXIMAL, MOST_PROXIMAL = 1e-2, 1e-10, 1e2
"""ε of the first iteration, and its bounds."""

EXACT, FORETOLD, WORTH = 0.05, 0.25, 0.9
"""Error of the linear model, twice, and unbalanced force left, relative to the unbalanced force before."""

VANISH, SHRINK, KEEP, GROW = 0.05, 0.3, 0.7, 4.0
"""Factors of ε after a step that was foretold exactly, one that was foretold, one worth it and any other."""

REFUSED, REFUSAL = 10.0, 10.0
"""Growth of the unbalanced force at which a step is not taken, and the factor of ε with which it is tried again."""


@dataclass(frozen=True, eq=False)
class Rest:
    """What an iteration came to.

    Parameters
    ----------
    x : (n,) float
        Unknowns (q, r, λ) of the `StaticSystem`.
    response
        Answer of the joint points.
    balanced : bool
        Whether this is an equilibrium.
    solves : int
        Linear systems solved.
    """

    x: Array
    response: PointResponse
    balanced: bool
    solves: int


def relax(system: StaticSystem, guess: Array, plastic_slip: Array, control: Control, patience: int = 200) -> Rest:
    """Look for equilibrium.

    Parameters
    ----------
    system
        The static equations.
    guess : (n,) float
        First unknowns; they should satisfy the control, or the first step is judged by forces it must disturb.
    plastic_slip : (np,) float
        History of the joint points.
    control
        The last equation.
    patience
        Linear systems after which it is given up.
    """
    nd = system.freedoms
    x, proximal = guess, FIRST_PROXIMAL
    response = system.respond(x, plastic_slip)
    residual = system.unbalanced(x, response, control)
    size = float(np.linalg.norm(residual[:nd]))
    for solves in range(patience):
        if _balanced(residual, response):
            return Rest(x, response, True, solves)
        try:
            step = system.solve(response.tangent, proximal, control, -residual)
        except RuntimeError:
            step = np.full_like(x, np.nan)
        if not np.isfinite(step).all():
            proximal = min(REFUSAL * proximal, MOST_PROXIMAL)
            continue
        tried = system.respond(x + step, plastic_slip)
        left = system.unbalanced(x + step, tried, control)
        size_left = float(np.linalg.norm(left[:nd]))
        if size_left > REFUSED * size and proximal < MOST_PROXIMAL:
            proximal = min(REFUSAL * proximal, MOST_PROXIMAL)
            continue
        error = float(np.linalg.norm(left[:nd] + proximal * system.diagonal * step[:nd]))
        proximal = float(np.clip(proximal * _factor(error, size_left, size), LEAST_PROXIMAL, MOST_PROXIMAL))
        x, response, residual, size = x + step, tried, left, size_left
    return Rest(x, response, _balanced(residual, response), patience)


def _factor(error: float, left: float, before: float) -> float:
    """Factor of ε after a step, from the linear model's error and the unbalanced force left and before."""
    if error < FORETOLD * before:
        return VANISH if error < EXACT * before else SHRINK
    return KEEP if left < WORTH * before else GROW


def _balanced(residual: Array, response: PointResponse) -> bool:
    largest = max(np.abs(response.normal).max(initial=0.0), np.abs(response.tangential).max(initial=0.0), 1.0)
    # Displacements, of which one unit makes about one unit of force, are held to the same measure.
    return bool(np.abs(residual).max() <= BALANCED * largest)
