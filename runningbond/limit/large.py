"""Certificates of large walls: one start, by interior points.

From corner to corner a program of more than some thousand points takes longer than afresh, and the simplex method may
never see that there are no forces. What only brings pressures up to date is solved by Clarabel to a rough tolerance;
then HiGHS finds corners, whose mechanisms move few points, and Clarabel sees in a moment whether forces drive them.
Of walls for which that takes minutes, blocks that hardly move against each other are glued first (`macro`).
Nothing is searched further: neither other starts nor a descent.
"""

from collections.abc import Iterator

from runningbond.scene import Array

from .certificates import Certificate, driving_forces
from .equilibrium import Equilibrium
from .force_program import coulomb, frozen_friction, solve_forces
from .interior_point import near
from .macro import glue, still_points
from .search import Observer, Search, averaged

POINTS = 4500
"""Joint points, six or so a block, from which a wall is searched so."""

POINTS_TO_GLUE = 12_000
"""Joint points from which a wall's blocks are glued before corners are looked for."""

STILL = (1e-2, 1e-3, 1e-4)
"""Jumps, relative to the largest motion, below which points count as still, in turn."""

SETTLING = 4
"""Programs before the first mechanism is looked at."""

MOST = 40
"""Programs in all."""


def takes_one_start(system: Equilibrium) -> bool:
    """Whether a wall is too large for more than this."""
    return len(system.points) >= POINTS


def search_large(system: Equilibrium, place: Array, observe: Observer) -> Search:
    """Run the sequence from the associated pressures to its first certificate, or Ctrl-C; loads are rough.

    Movable blocks have their centroids at `place` ``(n, 2)`` [m].
    """
    found = Search(starts=1)
    glues = len(system.points) >= POINTS_TO_GLUE and not system.has_support
    try:
        pressure = near(system, coulomb(system.strength)).pressure
        for k in range(MOST):
            forces, looked_at = frozen_friction(system.strength, pressure), k >= SETTLING
            program = solve_forces(system, forces) if looked_at and not glues else near(system, forces)
            found.programs += 1
            if program.status != "optimal":
                found.frictionless = looked_at and program.status == "unbounded"
                break
            if looked_at:
                motions = _glued(system, place, pressure, program.motion, found) if glues else [program.motion]
                certificate = next(filter(None, (_driven(system, motion, found) for motion in motions)), None)
                if certificate is not None:
                    found.certificates.append(certificate)
                    break
            observe(found)
            pressure = averaged(pressure, program.pressure, (k + 1.0) ** -0.5)
    except KeyboardInterrupt:
        found.interrupted = True
    return found


def _glued(system: Equilibrium, place: Array, pressure: Array, motion: Array, found: Search) -> Iterator[Array]:
    """Corners ``(nd,)`` of the wall whose blocks are glued where a mechanism ``(nd,)`` hardly moves them."""
    last = 0
    for least in STILL:
        glued = glue(system, place, still_points(system, motion, least))
        if glued.system.freedoms > last:
            last = glued.system.freedoms
            found.programs += 1
            program = solve_forces(glued.system, frozen_friction(glued.system.strength, pressure[glued.points]))
            if program.status == "optimal":
                yield glued.motions @ program.motion


def _driven(system: Equilibrium, motion: Array, found: Search) -> Certificate | None:
    """A mechanism ``(nd,)`` with forces near those that drive it."""
    driving = driving_forces(system, motion)
    if driving is None:
        return None
    found.programs += 2
    least = near(system, driving, "smallest")
    most = near(system, driving) if least.status == "optimal" else least
    return Certificate(motion, least, most) if most.status == "optimal" else None
