"""The smallest load at which a collapse with true Coulomb friction can be certified, looked for from many starts.

After Gilbert, Casapulla & Ahmed (2006) a sequence of linear programs freezes each point's shear resistance at μ times
a pressure that is brought up to date between programs: averaged with weights (k + 1)^(−1/2) in program k, which settles
where fixed weights keep wandering, or with fixed ones, which settle elsewhere. What it settles at depends on the
pressure that it starts from. From every certificate `descent` goes on to smaller loads. Finding the smallest of all is
a program with complementarity constraints, for which nothing better than looking is known; no lower bound comes of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .certificates import Certificate, certify
from .descent import Descent, is_lower
from .equilibrium import Equilibrium
from .force_program import ForceSolution, coulomb, frozen_friction, solve_forces

PROGRAM_BUDGET = 40
"""Programs of the first start's sequence after which it ends without a certificate."""

CERTIFIED_IN_A_ROW = 2
"""Certificates in a row that end the first start's sequence."""

SHORT = 16
"""Programs of every other sequence after which it ends without a certificate."""

STARTS = 80
"""Most starts."""

WEIGHTS = (0.6, 1.0, None, 0.3)
"""Fixed weights of a new pressure in the sequences after the first, in turn; None is (k + 1)^(−1/2)."""


@dataclass(eq=False)
class Search:
    """What a search found.

    Parameters
    ----------
    certificates
        Every collapse that was proved.
    starts, programs
        Starts, and linear programs solved.
    frictionless
        Whether normal forces alone carry any multiple of the live load.
    growing
        Whether each program of a full sequence carried more than the one before: friction grew with the load.
    interrupted
        Whether it was stopped before its end.
    """

    certificates: list[Certificate] = field(default_factory=list)
    starts: int = 0
    programs: int = 0
    frictionless: bool = False
    growing: bool = False
    interrupted: bool = False


def programs_allowed(system: Equilibrium) -> int:
    """Programs after which no further start is made: fewer where each costs more."""
    return 20 + 200_000 // max(1, len(system.points))


def dry_allowed(system: Equilibrium) -> int:
    """Starts in a row that bring nothing lower, after which the search ends: a small wall has less to find."""
    return min(max(8, system.freedoms // 2), 40)


def search(system: Equilibrium, associated: ForceSolution, starts: int = STARTS) -> Search:
    """Look for certificates from many starts, seeded; a keyboard interrupt keeps those that were found."""
    found, descent = Search(), Descent(system)
    lowest, dry = np.inf, 0
    try:
        for pressure, weight in _first_pressures(descent, associated, starts):
            start = (
                _first_sequence(descent, pressure, found) if not found.starts else _sequence(descent, pressure, weight)
            )
            found.starts += 1
            rng = np.random.default_rng([0, found.starts])
            for certificate in list(start):
                found.certificates += [certificate, *descent.below(certificate.motion, certificate.least, rng)]
            least = min((each.least.multiplier for each in found.certificates), default=np.inf)
            dry = 0 if is_lower(least, lowest) else dry + 1
            if not dry:
                best = min(found.certificates, key=lambda each: each.least.multiplier)
                found.certificates += descent.around(best, rng)
                lowest = min(each.least.multiplier for each in found.certificates)
            found.programs = descent.programs
            if found.frictionless or dry >= dry_allowed(system) or descent.programs > programs_allowed(system):
                break
    except KeyboardInterrupt:
        if not found.certificates:
            raise
        found.interrupted = True
    return found


def _first_pressures(descent: Descent, associated: ForceSolution, starts: int) -> Iterator[tuple[Array, float | None]]:
    """Pressures ``(np,)`` to start from, and the weight of new ones.

    Those of the associated solution, of the dead load, and of random forces that balance random loads.
    """
    system, bounded = descent.system, associated.status == "optimal"
    dead = None if bounded else solve_forces(system, coulomb(system.strength), "zero")
    first = associated if dead is None else dead
    pressure = first.pressure if first.status == "optimal" else np.zeros(len(system.points))
    yield pressure, None
    for start in range(1, starts):
        weight = WEIGHTS[(start - 1) % len(WEIGHTS)]
        if start <= 2:
            yield pressure, weight
            continue
        rng = np.random.default_rng([1, start])
        top = associated.multiplier if bounded else 1.0
        share = rng.random() if start > 3 else 0.0
        state = descent.random_forces(coulomb(system.strength), rng, share * top if top > 0 else (1 + share) * top)
        if state is not None:
            yield state.pressure, weight


def _first_sequence(descent: Descent, pressure: Array, found: Search) -> list[Certificate]:
    """Run the sequence from a first pressure ``(np,)``, certifying every second program, and note how it ended."""
    system = descent.system
    certificates: list[Certificate] = []
    in_a_row, multiplier, growing = 0, -np.inf, True
    for k in range(PROGRAM_BUDGET):
        descent.programs += 1
        program = solve_forces(system, frozen_friction(system.strength, pressure))
        if program.status != "optimal":
            found.frictionless = program.status == "unbounded"
            return certificates
        growing, multiplier = growing and program.multiplier > multiplier, program.multiplier
        if k % 2:
            descent.programs += 2
            certificate = certify(system, program.motion)
            if certificate is not None:
                certificates.append(certificate)
            in_a_row = in_a_row + 1 if certificate is not None else 0
            if in_a_row == CERTIFIED_IN_A_ROW:
                return certificates
        pressure = _averaged(pressure, program.pressure, (k + 1.0) ** -0.5)
    found.growing = growing
    return certificates


def _sequence(descent: Descent, pressure: Array, weight: float | None) -> list[Certificate]:
    """Run a short sequence from a first pressure ``(np,)`` to its first certificate."""
    system = descent.system
    for k in range(SHORT):
        descent.programs += 1
        program = solve_forces(system, frozen_friction(system.strength, pressure))
        if program.status != "optimal":
            break
        known = len(descent.known)
        if descent.least(program.motion) is not None:
            if len(descent.known) == known:  # it was gone on from before
                break
            descent.programs += 2
            certificate = certify(system, program.motion)
            return [] if certificate is None else [certificate]
        pressure = _averaged(pressure, program.pressure, weight or (k + 1.0) ** -0.5)
    return []


def _averaged(pressure: Array, new: Array, weight: float) -> Array:
    return (1 - weight) * pressure + weight * new
