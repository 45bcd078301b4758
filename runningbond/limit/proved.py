"""Associated limit analysis of large walls: an interior point, and the proof made of what it leaves.

HiGHS's vertex is exact and, up to some two hundred blocks, found as fast; above, its cost grows faster.
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
"""Freedoms, three a block, from which the interior point is asked first."""

VERY_LARGE = 4500
"""Freedoms from which the interior point is asked for less, and believed with a wider bracket."""

HUGE = 75_000
"""Freedoms from which the interior point is stopped as soon as the bracket is narrow enough for use."""

CLOSE, WIDE, WIDEST = 1e-6, 1e-4, 1e-2
"""Relative width of the bracket with which the answer for a large, a very large and a huge wall is believed."""

STOP = {CLOSE: 1e-9, WIDE: 3e-7, WIDEST: 2e-5}
"""Relative tolerance of the interior point that leads to such a bracket."""

ROUGH, FINE = 1e-4, 1e-6
"""Relative tolerances with which forces of a wall at rest are looked for, in turn; they need not be extreme."""

OVERTURNED = 1e-6
"""Share of a dead load's power, of all blocks without their signs, that it has to have left to prove a fall."""


def resting_forces(system: Equilibrium) -> tuple[Array | None, InteriorPoint]:
    """Forces, unknowns of a `force_program`, that balance the dead load strictly within all bounds; None if not found.

    They prove that the wall stands. Beside them is the interior point that they were made of, or would have been.
    """
    program = force_program(system, coulomb(system.strength), "zero")
    for tolerance in (ROUGH, FINE):
        point = interior_point(program, tolerance)
        found = balanced(program, point, None) if point.status == "optimal" else None
        if found is not None or point.status == "infeasible":
            break
    return found, point


def fall_at_rest(system: Equilibrium, point: InteriorPoint) -> Array | None:
    """The interior point of `resting_forces` as a mechanism ``(nd,)`` that dissipates less than the load does.

    It proves that no admissible forces balance the dead load; None if it is none.
    """
    program = force_program(system, coulomb(system.strength), "zero")
    motion = admissible(program, point) if point.status == "infeasible" else None
    if motion is None:
        return None
    power, gained = float(np.abs(system.dead) @ np.abs(motion)), float(system.dead @ motion)
    return motion if system.dissipated(motion) < gained - OVERTURNED * power else None


def proved(system: Equilibrium, resting: Array | None, tolerance: float | None = None) -> ForceSolution:
    """Solve the associated limit analysis; the status is ``optimal`` for exact forces and mechanism only.

    Ctrl-C leaves those that are near by then, if any are, and the status is ``budget``. `resting` are forces of
    the same system before its live load (`Equilibrium.under_dead_load`), `tolerance` that of the interior point, from
    `STOP` by the wall's size where it is not given.
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
    """Forces of a set in balance, at nearly the largest or smallest multiplier; None if none were found."""
    program = force_program(system, forces, aim)
    point = interior_point(program, STOP[CLOSE])
    found = balanced(program, point, None) if point.status == "optimal" else None
    return None if found is None else solution_of(system, forces, "optimal", found, point.motion, point.iterations)


def tolerance_of(system: Equilibrium) -> float:
    """Relative width of the bracket, `CLOSE`, `WIDE` or `WIDEST`, with which an answer is believed."""
    return CLOSE if system.freedoms < VERY_LARGE else WIDE if system.freedoms < HUGE else WIDEST


def loaded(system: Equilibrium, program: dict[str, Any], resting: Array) -> Array:
    """Forces of the wall at rest as unknowns of a program of the system under its live load.

    What is held later holds nothing yet; what a support bears of them is their multiplier.
    """
    late = system.reaction.shape[1] - len(system.scene.pins)
    forces = np.concatenate([resting[:-1], np.zeros(late), [0.0]])
    if system.has_support:
        last = system.freedoms - 1
        unbalanced = program["b_eq"] - program["A_eq"] @ forces
        forces[-1] = unbalanced[last] / program["A_eq"][last, -1]
    return forces


def is_large(system: Equilibrium) -> bool:
    """Whether the interior point is asked first."""
    return len(movable_freedoms(system.scene)) >= LARGE
