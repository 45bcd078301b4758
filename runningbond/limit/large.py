"""Certificates of large walls: two sequences from the associated pressures, by interior points.

From corner to corner a program of more than some thousand points takes longer than afresh, and the simplex method may
never see that there are no forces. What brings pressures up to date is solved by Clarabel to a rough tolerance. Its
mechanism is a mix of all that collapse at that load; a corner is looked for, by HiGHS, where it is cheap or promises
something:

- in the wall whose blocks are glued where they hardly move against each other (`macro`), which leaves some hundred
  freedoms. Pressures that follow slowly pass by many such mechanisms of few parts;
- in the wall itself, once there are forces that drive the mix but for its smallest jumps. Where the whole wall slides
  and opens no coarse mechanism does, and pressures that follow at once come to rest soonest.

Nothing is searched further: neither other starts nor a descent.
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

POINTS = 4500
"""Joint points, six or so a block, from which a wall is searched so."""

STILL = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
"""Jumps, relative to the largest motion, below which points count as still when blocks are glued, in turn."""

FREEDOMS = 700
"""Most freedoms of a glued wall whose corner is looked for."""

MIXED = 1e-4
"""Jumps of a mix of mechanisms, relative to its largest motion, that a corner need not have."""

SLOW, AT_ONCE = (0.3, range(2, 4)), (1.0, range(4, 40))
"""Weight of new pressures, and programs whose mechanisms are looked at, of the sequence that glues and of the other."""


def takes_one_start(system: Equilibrium) -> bool:
    """Whether a wall is too large for more than this."""
    return len(system.points) >= POINTS


def search_large(system: Equilibrium, place: Array, observe: Observer) -> SearchLog:
    """Run both sequences from the associated pressures, or up to a certificate, or Ctrl-C; loads are rough.

    Movable blocks have their centroids at `place` ``(n, 2)`` [m].
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
    """A program of the sequences; HiGHS says whether one without an optimum has forces without end."""
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
    """Bring pressures ``(np,)`` up to date until a mechanism is certified; blocks are glued if their place is known."""
    for k in range(looked_at.stop):
        if k:
            pressure = averaged(pressure, program.pressure, weight)
            program = _program(system, pressure, found)
        if program.status != "optimal":
            return
        if k in looked_at:
            corners = _corners(system, place, pressure, program.motion, found)
            certified = (roughly_certified(system, corner, found.add_programs) for corner in corners)
            found.certificates += islice(filter(None, certified), 1)  # of the first that forces near those here drive
            if found.certificates:
                return
        observe(found)


def _corners(
    system: Equilibrium, place: Array | None, pressure: Array, motion: Array, found: SearchLog
) -> Iterator[Array]:
    """Mechanisms ``(nd,)`` at corners of the program of which a mix is given: of the glued wall, or of the wall."""
    if place is None:
        mixed = driving_forces(system, motion, MIXED)
        found.add_programs(1)
        if mixed is not None and near(system, mixed, "smallest").status == "optimal":
            corner = _corner(system, pressure, found)
            if corner.status == "optimal":
                yield corner.motion
        return
    last = 0
    for least in STILL:
        glued = glue(system, place, still_points(system, motion, least))
        if last < glued.system.freedoms <= FREEDOMS:
            last = glued.system.freedoms
            corner = _corner(glued.system, pressure[glued.points], found)
            if corner.status == "optimal":
                yield glued.motions @ corner.motion


def _corner(system: Equilibrium, pressure: Array, found: SearchLog) -> ForceSolution:
    found.add_programs(1)
    return solve_forces(system, frozen_friction(system.strength, pressure))
