"""Associated limit analysis of large walls: an interior point, and the proof derived from its result.

HiGHS computes an exact vertex, as fast as the interior point for up to some two hundred blocks; for more its cost grows
faster.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from runningbond.scene import Array

from .equilibrium import Equilibrium
from .force_program import Aim, ForceSet, ForceSolution, ProgramStatus, coulomb, force_program, solution_of
from .interior_point import InteriorPoint, finishing, interior_point
from .kinematics import movable_freedoms
from .repair import admissible, balanced

LARGE = 600
"""Degrees of freedom, three per block, from which the interior point is tried first."""

VERY_LARGE = 4500
"""Degrees of freedom from which a looser tolerance of the interior point and a wider bracket are accepted."""

HUGE = 75_000
"""Degrees of freedom from which the interior point stops as soon as the bracket is narrow enough for practical use."""

CLOSE, WIDE, WIDEST = 1e-6, 1e-4, 1e-2
"""Relative width of the bracket up to which the result for a large, a very large and a huge wall is accepted."""

STOP = {CLOSE: 1e-9, WIDE: 3e-7, WIDEST: 2e-5}
"""Relative tolerance of the interior point that leads to a bracket of such width."""

ROUGH, FINE = 1e-4, 1e-6
"""Relative tolerances, in turn, of the search for forces of a wall at rest, which need not be extreme."""

FALL_MARGIN = 1e-6
"""Share of the dead load's power, summed as absolute values, by which the net power must exceed dissipation to prove a
fall."""


def resting_forces(system: Equilibrium) -> tuple[Array | None, InteriorPoint]:
    """Forces strictly within all bounds that balance the dead load, unknowns of a `force_program`; None if not found.

    They prove that the wall stands. Also returns the interior point from which they were, or were to be, derived.
    """
    program = force_program(system, coulomb(system.strength), "zero")
    for tolerance in (ROUGH, FINE):
        point = interior_point(program, tolerance)
        found = balanced(program, point, None) if point.status == "optimal" else None
        if found is not None or point.status == "infeasible":
            break
    return found, point


def fall_at_rest(system: Equilibrium, point: InteriorPoint) -> Array | None:
    """Mechanism ``(nd,)`` from the interior point of `resting_forces` with less dissipation than power of the load.

    It proves that no admissible forces balance the dead load; None if it does not.
    """
    program = force_program(system, coulomb(system.strength), "zero")
    motion = admissible(program, point) if point.status == "infeasible" else None
    if motion is None:
        return None
    power, gained = float(np.abs(system.dead) @ np.abs(motion)), float(system.dead @ motion)
    return motion if system.dissipated(motion) < gained - FALL_MARGIN * power else None


def proved(system: Equilibrium, resting: Array | None, tolerance: float | None = None) -> ForceSolution:
    """Solve the associated limit analysis; the status is ``optimal`` only if forces and mechanism are exact.

    Ctrl-C returns those derived from the last iterate, if any, with status ``budget``. `resting` are forces of the same
    system before its live load (`Equilibrium.under_dead_load`); `tolerance` is that of the interior point, by default
    from `STOP` by the size of the wall.
    """
    tolerance = STOP[tolerance_of(system)] if tolerance is None else tolerance
    forces = coulomb(system.strength)
    program = force_program(system, forces)
    point = interior_point(program, tolerance, unfinished=True)
    if point.status in ("infeasible", "unbounded"):
        return ForceSolution.none(point.status, point.iterations)
    within = None if resting is None else loaded(system, program, resting)
    with finishing() as interruptions:
        found, motion = balanced(program, point, within), admissible(program, point)
    is_interrupted = point.interrupted or bool(interruptions)
    if found is None or motion is None or system.live @ motion <= 0:
        status: ProgramStatus = "budget" if is_interrupted else "numerical"
        return ForceSolution.none(status, point.iterations)
    status = "budget" if is_interrupted else "optimal"
    solution = solution_of(system, forces, status, found, motion, point.iterations)
    return replace(solution, motion=motion / (system.live @ motion))


def nearly_extreme(system: Equilibrium, forces: ForceSet, aim: Aim) -> ForceSolution | None:
    """Balanced forces of a set at nearly the largest or smallest multiplier; None if not found."""
    program = force_program(system, forces, aim)
    point = interior_point(program, STOP[CLOSE])
    found = balanced(program, point, None) if point.status == "optimal" else None
    return None if found is None else solution_of(system, forces, "optimal", found, point.motion, point.iterations)


def tolerance_of(system: Equilibrium) -> float:
    """Relative width of the bracket, `CLOSE`, `WIDE` or `WIDEST`, up to which a result is accepted."""
    return CLOSE if system.freedoms < VERY_LARGE else WIDE if system.freedoms < HUGE else WIDEST


def loaded(system: Equilibrium, program: dict[str, Any], resting: Array) -> Array:
    """Convert forces of the wall at rest to unknowns of a program of the system under its live load.

    Motions held under the live load only have no reaction yet; a moving support's multiplier balances its equation.
    """
    late = system.reaction.shape[1] - len(system.scene.pins)
    forces = np.concatenate([resting[:-1], np.zeros(late), [0.0]])
    if system.has_support:
        last = system.freedoms - 1
        unbalanced = program["b_eq"] - program["A_eq"] @ forces
        forces[-1] = unbalanced[last] / program["A_eq"][last, -1]
    return forces


def is_large(system: Equilibrium) -> bool:
    """Whether the interior point is tried first."""
    return len(movable_freedoms(system.scene)) >= LARGE
