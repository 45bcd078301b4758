"""Certificates of large walls: one start, by interior points.

From corner to corner a program of more than some thousand points takes longer than afresh, and the simplex method may
never see that there are no forces. What only brings pressures up to date is solved by Clarabel to a rough tolerance;
then HiGHS finds corners, whose mechanisms move few points, and Clarabel sees in a moment whether forces drive them.
Nothing is searched further: neither other starts nor a descent.
"""

from dataclasses import replace

from runningbond.scene import Array

from .certificates import Certificate, driving_forces
from .equilibrium import Equilibrium
from .force_program import (
    Aim,
    ForceSet,
    ForceSolution,
    coulomb,
    force_program,
    frozen_friction,
    solution_of,
    solve_forces,
)
from .interior_point import interior_point
from .search import Observer, Search, averaged

POINTS = 4500
"""Joint points, six or so a block, from which a wall is searched so."""

ROUGH = 1e-6
"""Relative tolerance of programs that only bring pressures up to date, and of whether there are forces."""

SETTLING = 4
"""Programs before the first mechanism is looked at."""

MOST = 40
"""Programs in all."""


IN_A_ROW = 2
"""Certificates in a row that end the sequence."""


def takes_one_start(system: Equilibrium) -> bool:
    """Whether a wall is too large for more than this."""
    return len(system.points) >= POINTS


def near(system: Equilibrium, forces: ForceSet, aim: Aim = "largest") -> ForceSolution:
    """Forces of a set near those at the largest or smallest load, and near balance."""
    point = interior_point(force_program(system, forces, aim), ROUGH)
    return replace(solution_of(system, forces, "optimal", point.forces, point.motion, 0), status=point.status)


def search_large(system: Equilibrium, observe: Observer) -> Search:
    """Run the sequence from the associated pressures until certificates come twice in a row; loads are rough."""
    found, in_a_row = Search(starts=1), 0
    pressure = near(system, coulomb(system.strength)).pressure
    try:
        for k in range(MOST):
            forces, looked_at = frozen_friction(system.strength, pressure), k >= SETTLING
            program = solve_forces(system, forces) if looked_at else near(system, forces)
            found.programs += 1
            if program.status != "optimal":
                found.frictionless = looked_at and program.status == "unbounded"
                break
            if looked_at:
                certificate = _driven(system, program.motion, found)
                found.certificates += [] if certificate is None else [certificate]
                in_a_row = 0 if certificate is None else in_a_row + 1
                if in_a_row == IN_A_ROW:
                    break
            observe(found)
            pressure = averaged(pressure, program.pressure, (k + 1.0) ** -0.5)
    except KeyboardInterrupt:
        if not found.certificates:
            raise
        found.interrupted = True
    return found


def _driven(system: Equilibrium, motion: Array, found: Search) -> Certificate | None:
    """A mechanism ``(nd,)`` with forces near those that drive it."""
    driving = driving_forces(system, motion)
    if driving is None:
        return None
    found.programs += 2
    least = near(system, driving, "smallest")
    most = near(system, driving) if least.status == "optimal" else least
    return Certificate(motion, least, most) if most.status == "optimal" else None
