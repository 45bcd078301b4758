"""One start of a search for certificates: its initial pressures, and the search that begins from them.

Random pressures yield the first certificates. Smaller loads are mostly found near known certificates: by sequences from
their pressures, scattered everywhere or near one block, and in neighbourhoods (`neighbourhood`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from runningbond.scene import Array

from .certificates import NO_JUMP, Certificate, least_multiplier
from .descent import Descent, is_lower, random_weights
from .equilibrium import Equilibrium
from .force_program import ForceSolution, coulomb, solve_forces
from .macro import Glued, still_points
from .neighbourhood import certificates_near, distances, neighbourhood, one_of
from .programs import Programs, Vertices
from .search_log import SearchLog
from .sequences import WEIGHTS, averaged, certified, short_sequence

PROGRAM_BUDGET = 40
"""Number of programs after which the first start's sequence ends without a certificate."""

CERTIFIED_IN_A_ROW = 3
"""Consecutive certificates that end the first start's sequence."""

START_PIVOTS = 400
"""Largest number of simplex pivots to the random forces that a sequence starts from."""

ROUND = 4
"""Number of starts in a round after the first, which is a single start."""

Origin: TypeAlias = Literal["random", "balanced", "known", "neighbourhood"]
"""Initial pressures of a start: random, in balance with a random load, of a certificate, or near one."""

ORIGINS: tuple[Origin, ...] = ("random", "known", "balanced", "known", "neighbourhood", "known")
"""Origins of starts 0 to 3, 4 to 7, etc., in turn; 0 to 2 begin from the associated solution whatever their origin.

Rounds end one start later, so that the last start of a round has the origin of the next one's first three.
"""

LOWEST_SHARE = 0.5
"""Probability that a start from a known certificate takes the lowest one."""

SCATTER = 0.3, 1.5
"""Range of the standard deviation of the logarithm of initial pressures, relative to a certificate's."""

LOCAL, RADIUS = 0.5, (0.15, 0.6)
"""Probability that pressures are scattered near one block only, and range of the radius around it, in wall sizes."""

NEIGHBOURHOOD_SIZE, NEIGHBOURHOOD_SEQUENCES = (0.15, 0.5), 3
"""Range of the degrees of freedom of a neighbourhood, relative to the wall's, and sequences run in it."""


@dataclass(eq=False)
class Start:
    """One start of a search, followed by a descent to loads as small as it finds.

    Parameters
    ----------
    number, associated
        Number of the start, from 0, and the associated solution.
    before
        Certificates found before its round, in ascending order of load.
    known
        Forces at the smallest load of mechanisms already solved, by jump pattern.
    place
        Centroids of the movable blocks ``(n, 2)`` [m], if neighbourhoods are to be searched.
    vertices
        Vertices from which its programs start; afterwards those at which they ended.
    """

    number: int
    associated: ForceSolution
    before: Sequence[Certificate]
    known: dict[bytes, ForceSolution | None]
    place: Array | None = None
    vertices: Vertices = (None, None, None)
    found: SearchLog = field(default_factory=SearchLog)

    def run(self, programs: Programs) -> None:
        """Search for certificates, and record them as they are found."""
        solved = programs.solved
        programs.start_from(self.vertices)
        descent, rng = Descent(programs, self.known), np.random.default_rng([0, self.number + 1])
        try:
            for certificate in self._certificates(descent, rng):
                known = self.found.certificates
                known.append(certificate)
                known += descent.below(certificate.motion, certificate.least, rng)
            early = self.number <= ROUND  # early walks from the lowest certificate are no better than from others
            if early or not self.before or is_lower(self.found.lowest, self.before[0].least.multiplier):
                best = self.found.best
                self.found.certificates += () if best is None else descent.around(best, rng)
        finally:
            self.vertices = programs.vertices
            self.found.add_programs(programs.solved - solved)

    def _certificates(self, descent: Descent, rng: np.random.Generator) -> Iterator[Certificate]:
        if self.before and self._origin == "neighbourhood":
            base = self._base(rng)
            glued = self._neighbourhood(descent.system, base, rng)
            if glued is not None:
                yield from self._near(glued, base, descent, rng)
                return
        pressure = self._pressure(descent)
        if self.number == 0:
            yield from first_sequence(descent, pressure, self.found)
        else:
            yield from short_sequence(descent, pressure, WEIGHTS[(self.number - 1) % len(WEIGHTS)])

    @property
    def _origin(self) -> Origin:
        return ORIGINS[self.number // ROUND % len(ORIGINS)]

    def _scattered(self, system: Equilibrium, pressure: Array, rng: np.random.Generator) -> Array:
        """Scatter pressures ``(np,)`` everywhere or, with equal probability, near one block."""
        factor = rng.lognormal(0.0, rng.uniform(*SCATTER), len(pressure))
        if self.place is not None and rng.random() < LOCAL:
            distance = distances(system, self.place, self.place[[rng.integers(len(self.place))]])
            factor[distance > rng.uniform(*RADIUS)] = 1.0
        return pressure * factor

    def _base(self, rng: np.random.Generator) -> Certificate:
        """The lowest certificate or, with equal probability, a random one, more likely a low than a high one."""
        return self.before[0 if rng.random() < LOWEST_SHARE else int(len(self.before) * rng.random() ** 2)]

    def _neighbourhood(self, system: Equilibrium, base: Certificate, rng: np.random.Generator) -> Glued | None:
        """Glue the wall except around one random point that moves, within a random size; None if none is left."""
        if self.place is None:
            return None
        moving = ~still_points(system, base.motion, NO_JUMP)
        freedoms = int(rng.uniform(*NEIGHBOURHOOD_SIZE) * system.freedoms)
        return neighbourhood(system, self.place, moving, one_of(moving, rng), freedoms)

    def _near(
        self, glued: Glued, base: Certificate, descent: Descent, rng: np.random.Generator
    ) -> Iterator[Certificate]:
        """Certificates of the wall below all before, from those in a neighbourhood of one of them."""
        programs = Programs(glued.system, descent.programs.stopped, asks_interior_point=False)
        try:
            found = sorted(certificates_near(glued, base, programs, NEIGHBOURHOOD_SEQUENCES, rng), key=least_multiplier)
        finally:
            self.found.add_programs(programs.solved, glued.cost)
        lowest = self.before[0].least.multiplier
        for each in found:
            if not is_lower(each.least.multiplier, lowest):  # its load in the full wall is no lower
                return
            certificate = certified(descent, glued.motions @ each.motion)
            if certificate is not None:
                lowest = min(lowest, certificate.least.multiplier)
                yield certificate

    def _pressure(self, descent: Descent) -> Array:
        """Initial pressures ``(np,)``.

        For the first three starts those of the associated solution or, if that is unbounded, of forces under the dead
        load. Then by origin: random ones; those of random forces that balance random loads or, if `START_PIVOTS` do not
        reach any, random multiples of the associated ones; random multiples of a certificate's.
        """
        system, bounded = descent.system, self.associated.status == "optimal"
        if self.number <= 2:
            first = self.associated if bounded else solve_forces(system, coulomb(system.strength), "zero")
            return first.pressure if first.status == "optimal" else np.zeros(len(system.points))
        rng = np.random.default_rng([1, self.number])
        top = self.associated.multiplier if bounded else 1.0
        share = rng.random() if self.number > 3 else 0.0  # start 3, a random one, needs none
        weights = random_weights(len(system.points), rng)
        if self.before and self._origin in ("known", "neighbourhood"):
            return self._scattered(descent.system, self._base(rng).least.pressure, rng)
        if self._origin == "random":
            return weights * (self.associated.pressure.mean() if bounded else 1.0)
        load = share * top if top > 0 else (1 + share) * top
        state = descent.programs.vertex(coulomb(system.strength), weights, load, START_PIVOTS)
        if state.status == "optimal":
            return state.pressure
        return self.associated.pressure * rng.lognormal(size=len(weights)) if bounded else weights


def first_sequence(descent: Descent, pressure: Array, found: SearchLog) -> Iterator[Certificate]:
    """Run the sequence from a first pressure ``(np,)``, try to certify every mechanism, and record how it ended."""
    in_a_row, multiplier, growing = 0, -np.inf, True
    for k in range(PROGRAM_BUDGET):
        program = descent.programs.frozen(pressure)
        if program.status != "optimal":
            found.frictionless = program.status == "unbounded"
            return
        growing, multiplier = growing and program.multiplier > multiplier, program.multiplier
        certificate = certified(descent, program.motion)
        if certificate is not None:
            yield certificate
        in_a_row = in_a_row + 1 if certificate is not None else 0
        if in_a_row == CERTIFIED_IN_A_ROW:
            return
        pressure = averaged(pressure, program.pressure, (k + 1.0) ** -0.5)
    found.growing = growing
