"""One start of a search for certificates: the pressures it is made from, and where it goes from there.

Random pressures bring the first certificates. Smaller loads are mostly found beside those that are known: by sequences
from a certificate's pressures, scattered everywhere or near one block, and in neighbourhoods (`neighbourhood`).
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
from .programs import Corners, Programs
from .search_log import SearchLog
from .sequences import WEIGHTS, averaged, certified, short_sequence

PROGRAM_BUDGET = 40
"""Programs of the first start's sequence after which it ends without a certificate."""

CERTIFIED_IN_A_ROW = 3
"""Certificates in a row that end the first start's sequence."""

PIVOTS = 400
"""Corners passed on the way to random forces to start from."""

ROUND = 4
"""Starts of a round."""

Origin: TypeAlias = Literal["random", "balanced", "known", "neighbourhood"]
"""What a start is made from: random pressures, those that balance a random load, or those of a certificate."""

ORIGINS: tuple[Origin, ...] = (
    *("random", "balanced", "known", "neighbourhood"),
    *("known", "balanced", "known", "neighbourhood"),
)
"""Origins of the rounds, in turn."""

LOWEST = 0.5
"""Share of the certificates started from that are the lowest."""

SCATTER = 0.3, 1.5
"""Least and most scatter of the logarithm of the pressures started from, beside a certificate's."""

LOCAL, RADIUS = 0.5, (0.15, 0.6)
"""Share of such pressures that are scattered near one block alone, and how near at least and at most, in wall sizes."""

AROUND, SEQUENCES = (0.15, 0.5), 3
"""Least and most freedoms of a neighbourhood, beside the wall's, and sequences in it."""


@dataclass(eq=False)
class Start:
    """One start of a search, numbered from 0, from which it goes down as far as it gets.

    Parameters
    ----------
    number, associated
        Its number, and the associated solution.
    before
        Certificates from before its round, from the lowest up.
    known
        What mechanisms have led to.
    place
        Centroids of the movable blocks ``(n, 2)`` [m], where neighbourhoods are to be searched.
    corners
        Where its programs start from.
    """

    number: int
    associated: ForceSolution
    before: Sequence[Certificate]
    known: dict[bytes, ForceSolution | None]
    place: Array | None = None
    corners: Corners = (None, None, None)
    found: SearchLog = field(default_factory=SearchLog)

    def run(self, programs: Programs) -> None:
        """Look for certificates, and write down what is found as it is found."""
        solved = programs.solved
        programs.go_to(self.corners)
        descent, rng = Descent(programs, self.known), np.random.default_rng([0, self.number + 1])
        try:
            for certificate in self._certificates(descent, rng):
                known = self.found.certificates
                known.append(certificate)
                known += descent.below(certificate.motion, certificate.least, rng)
            early = self.number <= ROUND  # a walk from the first certificate is no better than from any other
            if early or not self.before or is_lower(self.found.lowest, self.before[0].least.multiplier):
                best = self.found.best
                self.found.certificates += () if best is None else descent.around(best, rng)
        finally:
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
        """Pressures ``(np,)`` beside others, everywhere or, as often, near one block."""
        factor = rng.lognormal(0.0, rng.uniform(*SCATTER), len(pressure))
        if self.place is not None and rng.random() < LOCAL:
            distance = distances(system, self.place, self.place[[rng.integers(len(self.place))]])
            factor[distance > rng.uniform(*RADIUS)] = 1.0
        return pressure * factor

    def _base(self, rng: np.random.Generator) -> Certificate:
        """The lowest certificate or, as often, another one, rather a low than a high one."""
        return self.before[0 if rng.random() < LOWEST else int(len(self.before) * rng.random() ** 2)]

    def _neighbourhood(self, system: Equilibrium, base: Certificate, rng: np.random.Generator) -> Glued | None:
        """The wall glued but around one point that a certificate moves, more or less of it; None for none."""
        if self.place is None:
            return None
        moving = ~still_points(system, base.motion, NO_JUMP)
        freedoms = int(rng.uniform(*AROUND) * system.freedoms)
        return neighbourhood(system, self.place, moving, one_of(moving, rng), freedoms)

    def _near(
        self, glued: Glued, base: Certificate, descent: Descent, rng: np.random.Generator
    ) -> Iterator[Certificate]:
        """Certificates of the wall that are lower than all before, from those of a neighbourhood of one of them."""
        programs = Programs(glued.system, descent.programs.stopped, asks_interior_point=False)
        try:
            found = sorted(certificates_near(glued, base, programs, SEQUENCES, rng), key=least_multiplier)
        finally:
            self.found.add_programs(programs.solved, glued.cost)
        lowest = self.before[0].least.multiplier
        for each in found:
            if not is_lower(each.least.multiplier, lowest):  # what drives it in the wall drives it here as well
                return
            certificate = certified(descent, glued.motions @ each.motion)
            if certificate is not None:
                lowest = min(lowest, certificate.least.multiplier)
                yield certificate

    def _pressure(self, descent: Descent) -> Array:
        """Pressures ``(np,)`` to start from.

        Those of the associated solution, of the dead load, and then by rounds: random ones; those of random forces
        that balance random loads, or, where these are more than `PIVOTS` corners away, random multiples of the
        associated ones; random multiples of a certificate's.
        """
        system, bounded = descent.system, self.associated.status == "optimal"
        if self.number <= 2:
            first = self.associated if bounded else solve_forces(system, coulomb(system.strength), "zero")
            return first.pressure if first.status == "optimal" else np.zeros(len(system.points))
        rng = np.random.default_rng([1, self.number])
        top = self.associated.multiplier if bounded else 1.0
        share = rng.random() if self.number > 3 else 0.0
        weights = random_weights(len(system.points), rng)
        if self.before and self._origin in ("known", "neighbourhood"):
            return self._scattered(descent.system, self._base(rng).least.pressure, rng)
        if self._origin == "random":
            return weights * (self.associated.pressure.mean() if bounded else 1.0)
        load = share * top if top > 0 else (1 + share) * top
        state = descent.programs.corner(coulomb(system.strength), weights, load, PIVOTS)
        if state.status == "optimal":
            return state.pressure
        return self.associated.pressure * rng.lognormal(size=len(weights)) if bounded else weights


def first_sequence(descent: Descent, pressure: Array, found: SearchLog) -> Iterator[Certificate]:
    """Run the sequence from a first pressure ``(np,)``, certifying every program, and note how it ended."""
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
