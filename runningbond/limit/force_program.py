"""Linear programs over the forces at joint points: the load multiplier that admissible forces can balance.

The friction cone is written with its rays, f_n = f_t0 − Σ p_k and f_t = s + Σ m_k p_k with p_k ≥ 0, where the slopes
m_k are ± tan φ for an associated joint. The equilibrium equations are then the only rows. HiGHS's interior point solves
such programs several times faster than programs with friction inequalities as rows.
"""

from collections.abc import Sequence
from concurrent.futures import Future, wait
from dataclasses import dataclass, field
from threading import Thread
from typing import Any, Literal, TypeAlias

import numpy as np
from scipy.optimize import OptimizeResult, linprog
from scipy.sparse import csc_array, hstack, identity

from runningbond.joints import PointStrength
from runningbond.scene import Array

from .equilibrium import Equilibrium

Aim: TypeAlias = Literal["largest", "smallest", "zero"]
"""Objective of a program: the largest or smallest multiplier, or whether forces balance at the multiplier zero."""

ProgramStatus: TypeAlias = Literal["optimal", "budget", "infeasible", "unbounded", "numerical"]
STATUS: dict[int, ProgramStatus] = {0: "optimal", 1: "numerical", 2: "infeasible", 3: "unbounded", 4: "numerical"}
"""Status by scipy's number; 1 is a limit of iterations, not Ctrl-C, after which the status is ``budget``."""

BALANCE_TOLERANCE = 1e-6
"""Sum of unbalanced forces, relative to the largest entry of the load, up to which the load counts as balanced."""

WAKE_INTERVAL = 0.5
"""Interval [s] at which a thread that waits for a program wakes up to receive Ctrl-C."""


@dataclass(frozen=True, eq=False)
class ForceSet:
    """Forces that the points of an `Equilibrium` may carry, in its force unit.

    Parameters
    ----------
    slopes : sequence of (np,) float
        Slopes f_t / p of each ray at each point.
    most : sequence of (np,) float
        Largest p on each ray at each point; inf if the ray is unbounded, 0 if it carries nothing.
    shear_low, shear_high : (np,) float
        Bounds of s.
    tie_low, tie_high : (nt,) float or None
        Bounds of the ties' pulls; None for zero and the yield force.
    late_least : float
        Lower bound of reactions of motions held once the dead load is on; 0 if they may only add to the dead load.
    """

    slopes: Sequence[Array]
    most: Sequence[Array]
    shear_low: Array
    shear_high: Array
    tie_low: Array | None = None
    tie_high: Array | None = None
    late_least: float = -np.inf

    @property
    def has_shear(self) -> bool:
        """Whether any point may carry s ≠ 0."""
        return bool(np.any(self.shear_low) or np.any(self.shear_high))


def coulomb(strength: PointStrength) -> ForceSet:
    """The full truncated Coulomb cone at every point."""
    free = np.full(len(strength.tension), np.inf)
    return ForceSet((strength.friction, -strength.friction), (free, free), -strength.shear, strength.shear)


def frozen_friction(strength: PointStrength, pressure: Array) -> ForceSet:
    """Set with shear resistances frozen at those of a given pressure ``(np,)``, so that slip causes no opening."""
    resistance = strength.shear + strength.friction * pressure
    nothing = np.zeros(len(pressure))
    return ForceSet((nothing,), (np.full(len(pressure), np.inf),), -resistance, resistance)


@dataclass(frozen=True, eq=False)
class ForceSolution:
    """Solution of a linear program, in the units of its `Equilibrium`; arrays are empty without an optimum.

    Parameters
    ----------
    status, multiplier
        Whether there is an optimum, or else why not; λ at the optimum.
    pressure, tangential : (np,) float
        f_t0 − f_n, not negative, and f_t at each point.
    reaction : (n_pins,) float
        Reactions of pinned points.
    motion : (nd,) float
        Multipliers of the equilibrium equations: the collapse mechanism, f_live · q = 1.
    iterations
        Number of iterations of the solver.
    tie : (nt,) float
        Pulls of ties.
    """

    status: ProgramStatus
    multiplier: float
    pressure: Array
    tangential: Array
    reaction: Array
    motion: Array
    iterations: int
    tie: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def none(cls, status: ProgramStatus, iterations: int = 0) -> "ForceSolution":
        """Return the solution of a program without an optimum."""
        empty = np.zeros(0)
        return cls(status, np.nan, empty, empty, empty, empty, iterations)


def force_program(system: Equilibrium, forces: ForceSet, aim: Aim = "largest") -> dict[str, Any]:
    """Arguments of `scipy.optimize.linprog` for the largest or smallest multiplier that forces of a set can balance."""
    rays = [system.slip.multiply(slope).tocsc() - system.opening for slope in forces.slopes]
    shear = [system.slip] if forces.has_shear else []
    others = [*shear, system.tie, system.reaction, csc_array(-system.live[:, None])]
    matrix = csc_array(hstack([*rays, *others], format="csc"))
    bounds = bounds_of(system, forces, has_shear=forces.has_shear)
    if aim == "zero":
        bounds[-1] = 0.0, 0.0
    cost = np.zeros(matrix.shape[1])
    cost[-1] = {"largest": -1.0, "smallest": 1.0, "zero": 0.0}[aim] * mechanism_scale(system)
    right = system.dead - system.opening @ system.strength.tension
    return {"c": cost, "A_eq": matrix, "b_eq": right, "bounds": bounds}


def bounds_of(system: Equilibrium, forces: ForceSet, *, has_shear: bool) -> Array:
    """Bounds ``(n, 2)`` of pressures on rays, shears if there are any, pulls of ties, reactions, and the multiplier."""
    n_pins, n_ties = system.reaction.shape[1], len(system.tie_yield)
    late = n_pins - len(system.scene.pins)
    shears = (forces.shear_low, forces.shear_high) if has_shear else ([], [])
    tie_low = np.zeros(n_ties) if forces.tie_low is None else forces.tie_low
    tie_high = system.tie_yield if forces.tie_high is None else forces.tie_high
    held = np.repeat([-np.inf, forces.late_least], [n_pins - late, late])
    rays = len(forces.slopes) * len(system.points)
    low = np.concatenate([np.zeros(rays), shears[0], tie_low, held, [system.least]])
    high = np.concatenate([*forces.most, shears[1], tie_high, np.full(n_pins + 1, np.inf)])
    return np.column_stack([low, high])


def solve_program(program: dict[str, Any], method: str) -> OptimizeResult:
    """Run `scipy.optimize.linprog`, which ignores Ctrl-C, in a thread that is abandoned at Ctrl-C."""
    result: Future[OptimizeResult] = Future()

    def solve() -> None:
        try:
            result.set_result(linprog(**program, method=method))  # type: ignore[call-overload]
        except BaseException as error:  # passed on to the waiting thread
            result.set_exception(error)

    Thread(target=solve, daemon=True).start()
    while not wait([result], WAKE_INTERVAL).done:  # without a timeout, Windows delivers no Ctrl-C
        pass
    return result.result()


def solve_forces(system: Equilibrium, forces: ForceSet, aim: Aim = "largest", *, method: str = "") -> ForceSolution:
    """Solve `force_program` by interior point and crossover, or by simplex if only feasibility is checked."""
    method = method or ("highs-ds" if aim == "zero" else "highs-ipm")
    program = force_program(system, forces, aim)
    units = [np.ones(len(program["c"]))]
    if (rays := _ray_units(forces, len(units[0]))).min() < 1:
        units.append(rays)
    # With cohesion, a small multiplier would be lost in units of the rays.
    attempts = [(unit, _solved) for unit in (units if aim == "zero" or not forces.has_shear else units[:1])]
    if aim == "zero":
        attempts += [(unit, _least_unbalanced) for unit in reversed(units)]
    for unit, solve in attempts:
        status, result = solve(program if unit is units[0] else _in_units(program, unit), method)
        if status != "numerical":
            break
    if result.x is None or status != "optimal":
        return ForceSolution.none(status, int(result.nit))
    marginals = np.asarray(result.eqlin.marginals)
    return solution_of(system, forces, status, result.x * unit, marginals, int(result.nit))


def _ray_units(forces: ForceSet, n: int) -> Array:
    """Units ``(n,)`` of a program's unknowns in which no ray carries more shear than its own value.

    HiGHS tolerates pressures of -1e-7, from which a tan φ of 1e6 makes shear of a tenth of a block's weight.
    """
    slopes = np.abs(np.concatenate(forces.slopes))
    return np.append(1 / slopes.clip(min=1.0), np.ones(n - len(slopes)))


def _in_units(program: dict[str, Any], unit: Array) -> dict[str, Any]:
    """The same program with unknowns measured in units ``(n,)``."""
    bounds = program["bounds"] / unit[:, None]
    return {**program, "c": program["c"] * unit, "A_eq": program["A_eq"] * unit, "bounds": bounds}


def _solved(program: dict[str, Any], method: str) -> tuple[ProgramStatus, OptimizeResult]:
    result = solve_program(program, method)
    return STATUS[int(result.status)], result


def _least_unbalanced(program: dict[str, Any], method: str) -> tuple[ProgramStatus, OptimizeResult]:
    """Whether forces balance the load, decided by minimising the sum of unbalanced forces.

    This program always has a solution, whereas HiGHS may fail on programs without one. With a tan φ of 1e6 it cannot
    decide whether a wall rests on its corners; here whole weights remain unbalanced if the wall does not.
    """
    n_equations, n = program["A_eq"].shape
    unbalanced = identity(n_equations, format="csc")
    elastic = {
        "c": np.append(np.zeros(n), np.ones(2 * n_equations)),
        "A_eq": hstack([program["A_eq"], unbalanced, -unbalanced], format="csc"),
        "b_eq": program["b_eq"],
        "bounds": np.vstack([program["bounds"], np.tile([0.0, np.inf], (2 * n_equations, 1))]),
    }
    status, result = _solved(elastic, method)
    if result.x is None or status != "optimal":
        return status, result
    balanced = result.x[n:].sum() <= BALANCE_TOLERANCE * np.abs(program["b_eq"]).max(initial=0.0)
    result["x"] = result.x[:n]
    return "optimal" if balanced else "infeasible", result


def solution_of(
    system: Equilibrium, forces: ForceSet, status: ProgramStatus, found: Array, marginals: Array, iterations: int
) -> ForceSolution:
    """Convert unknowns ``(n,)``, ordered as in `bounds_of`, and multipliers of equations ``(nd,)`` to a solution."""
    n, n_pins, n_rays = len(system.points), system.reaction.shape[1], len(forces.slopes)
    ties = slice(len(found) - 1 - n_pins - len(system.tie_yield), len(found) - 1 - n_pins)
    rays = found[: n_rays * n].reshape(n_rays, n)
    tangential = (np.asarray(forces.slopes) * rays).sum(axis=0)
    if len(shear := found[n_rays * n : ties.start]):
        tangential = tangential + shear
    return ForceSolution(
        status,
        float(found[-1]),
        rays.sum(axis=0),
        tangential,
        found[-1 - n_pins : -1],
        marginals / mechanism_scale(system),
        iterations,
        found[ties],
    )


def mechanism_scale(system: Equilibrium) -> float:
    """Power unit that scales a mechanism's motions to order one, far above the solver's dual tolerance.

    With unit power the motions of a wall of a thousand blocks would be about 1e-3, and its smallest jumps below HiGHS's
    tolerance of 1e-7.
    """
    return float(np.abs(system.live).sum()) or 1.0
