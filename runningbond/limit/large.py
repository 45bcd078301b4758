"""Certificates of large walls: two sequences from the associated pressures, by interior points.

For programs of more than some thousand points, going on from vertex to vertex takes longer than a fresh start, and the
simplex method may never detect that no forces exist. Programs that update pressures are therefore solved by Clarabel to
a rough tolerance. Each solution mixes all mechanisms of the same load. A vertex is computed, by HiGHS, only where it is
cheap or promising:

- in the wall glued wherever its blocks barely move against each other (`macro`), which leaves some hundred degrees of
  freedom. Pressures that are updated slowly pass many such mechanisms of few parts;
- in the full wall, once there are forces that drive the mix except for its smallest jumps. If the whole wall slides and
  opens, no coarse mechanism exists, and fully updated pressures converge soonest.

There is no further search: neither other starts nor a descent.
"""

from collections.abc import Iterator
from itertools import islice

from runningbond.scene import Array

from .certificates import driving_forces, roughly_certified
from .equilibrium import Equilibrium
from .force_program import ForceSolution, coulomb, frozen_friction, solve_forces
from .interior_point import near
from .macro import glue, still_points
from .search_log import Observer, SearchLog
from .sequences import averaged

LARGE_POINTS = 4500
"""Number of joint points, about six per block, from which a wall is searched as described above."""

STILL_LEVELS = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
"""Levels of jumps, relative to the largest motion, below which points count as still when blocks are glued, in turn."""

VERTEX_FREEDOMS = 700
"""Largest number of degrees of freedom of a glued wall whose vertex is computed."""

MIX_TOLERANCE = 1e-4
"""Jumps of a mix of mechanisms, relative to its largest motion, up to which they count as zero."""

SLOW, AT_ONCE = (0.3, range(2, 4)), (1.0, range(4, 40))
"""Weight of new pressures and programs whose mechanisms are examined, of the sequence that glues and of the other."""


def takes_one_start(system: Equilibrium) -> bool:
    """Whether a wall is too large for more than these two sequences."""
    return len(system.points) >= LARGE_POINTS


def search_large(system: Equilibrium, place: Array, observe: Observer) -> SearchLog:
    """Run the sequences from the associated pressures until a certificate, with approximate loads, is found or Ctrl-C.

    `place` are the centroids of the movable blocks ``(n, 2)`` [m].
    """
    found = SearchLog(starts=1)
    try:
        pressure = near(system, coulomb(system.strength)).pressure
        first = _program(system, pressure, found)
        if not system.has_support:
            _sequence(system, place, pressure, first, found, observe, *SLOW)
        if not (found.certificates or found.frictionless):
            _sequence(system, None, pressure, first, found, observe, *AT_ONCE)
    except KeyboardInterrupt:
        found.interrupted = True
    return found


def _program(system: Equilibrium, pressure: Array, found: SearchLog) -> ForceSolution:
    """Solve a program of the sequences; without an optimum, HiGHS decides whether its forces are unbounded."""
    found.add_programs(1)
    forces = frozen_friction(system.strength, pressure)
    program = near(system, forces)
    if program.status != "optimal":
        found.frictionless = solve_forces(system, forces).status == "unbounded"
    return program


def _sequence(
    system: Equilibrium,
    place: Array | None,
    pressure: Array,
    program: ForceSolution,
    found: SearchLog,
    observe: Observer,
    weight: float,
    looked_at: range,
) -> None:
    """Update pressures ``(np,)`` until a mechanism is certified; blocks are glued if their place is given."""
    for k in range(looked_at.stop):
        if k:
            pressure = averaged(pressure, program.pressure, weight)
            program = _program(system, pressure, found)
        if program.status != "optimal":
            return
        if k in looked_at:
            vertices = _vertices(system, place, pressure, program.motion, found)
            certified = (roughly_certified(system, vertex, found.add_programs) for vertex in vertices)
            found.certificates += islice(filter(None, certified), 1)  # only the first one certified
            if found.certificates:
                return
        observe(found)


def _vertices(
    system: Equilibrium, place: Array | None, pressure: Array, motion: Array, found: SearchLog
) -> Iterator[Array]:
    """Mechanisms ``(nd,)`` at vertices of the program whose mix is `motion`: of the glued wall, or of the full wall."""
    if place is None:
        mixed = driving_forces(system, motion, MIX_TOLERANCE)
        found.add_programs(1)
        if mixed is not None and near(system, mixed, "smallest").status == "optimal":
            vertex = _vertex(system, pressure, found)
            if vertex.status == "optimal":
                yield vertex.motion
        return
    last = 0
    for least in STILL_LEVELS:
        glued = glue(system, place, still_points(system, motion, least))
        if last < glued.system.freedoms <= VERTEX_FREEDOMS:
            last = glued.system.freedoms
            vertex = _vertex(glued.system, pressure[glued.points], found)
            if vertex.status == "optimal":
                yield glued.motions @ vertex.motion


def _vertex(system: Equilibrium, pressure: Array, found: SearchLog) -> ForceSolution:
    found.add_programs(1)
    return solve_forces(system, frozen_friction(system.strength, pressure))
