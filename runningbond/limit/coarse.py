"""Certificates for walls of some hundred blocks, found in walls of fewer macro-blocks and proved in the full wall.

Most mechanisms of small load move a few large parts of a wall. A program over these parts takes milliseconds instead of
some tenths of a second, and a mechanism of the parts is also a mechanism of the full wall (`macro`). Where the wall
separates is not known beforehand. It is estimated by sequences of interior-point programs over the full wall. Each
solution mixes all mechanisms of about the same load, so some joints move far and others barely. Blocks that move
together in all programs of a sequence are glued, and the glued wall is searched like any other (`search`).

Forces that balance the blocks of the wall also balance its parts. The loads that drive a mechanism of the glued wall
therefore include all those that drive it in the full wall: the smallest load in the glued wall is not above that in the
full wall, and if the glued wall has no such forces, the full wall has none. Certificates are therefore proved in the
full wall from the lowest up, until the next one cannot be lower than those proved, and likewise from the highest down.

A wall that moves in many small parts, e.g. one that slides all over, has no such mechanism, and is left to `search`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .certificates import NO_JUMP, Certificate, certify, least_multiplier, roughly_certified
from .descent import jump_pattern
from .equilibrium import Equilibrium
from .force_program import ForceSolution, coulomb, frozen_friction, solve_forces
from .interior_point import near
from .macro import Glued, freest, still_points
from .neighbourhood import certificates_near, neighbourhood, one_of
from .programs import Programs
from .search import programs_allowed, search
from .search_log import Observer, SearchLog
from .sequences import WEIGHTS, averaged

COARSE_POINTS = 1000
"""Number of joint points from which a wall is searched in parts first; for smaller walls a direct search is as fast."""

SEQUENCE_PROGRAMS = 8
"""Number of programs of a sequence that shows where a wall may separate."""

GLUE_LEVELS = tuple(float(f"{digit}e-{power}") for power in (2, 3, 4, 5) for digit in (5, 2, 1))
"""Levels of jumps, relative to the largest motion, below which blocks may be glued."""

PROGRAM_FREEDOMS, SEQUENCE_FREEDOMS, FIRST_FREEDOMS = 45, 150, 300
"""Largest number of degrees of freedom, three a part, of a wall glued by the jumps of one program, of one sequence, and
of the first two sequences together."""

FEW_PROGRAMS, PROGRAMS = 60, 400
"""Number of programs after which the search of a glued wall ends: of one glued by one program, and by several."""

MAX_DRY_STARTS, MAX_STARTS = 4, 40
"""Number of consecutive sequences without a lower load after which no more are run, and largest number of sequences."""

COST_FACTOR = 4
"""Largest cost of a search, relative to that allowed over the full wall; most searches end long before."""

NEIGHBOURHOOD_FREEDOMS, NEIGHBOURHOOD_SEQUENCES = 350, 8
"""Largest number of degrees of freedom of a neighbourhood of a certificate, and sequences run in it."""

MAX_FAILURES = 6
"""Number of consecutive neighbourhoods without a lower load after which the search around a certificate ends."""

MIN_CHANGE = 1e-5
"""Change of the multiplier, relative to the larger of it and 1, above which a proof is tried; interior points do not
resolve smaller changes."""


@dataclass(eq=False)
class CoarseSearch:
    """A search over parts of a wall.

    Parameters
    ----------
    system, place
        Equations of a wall without moving supports, and centroids of its movable blocks ``(n, 2)`` [m].
    observe
        Called with the `SearchLog` after each glued wall.
    workers
        Parallel workers of `search`.
    starts
        Largest number of sequences over the full wall.
    most
        Cost, in programs of the full wall, after which no new search begins; by default `COST_FACTOR` times that of
        `search`.
    """

    system: Equilibrium
    place: Array
    observe: Observer
    workers: int = 1
    starts: int = MAX_STARTS
    most: float | None = None
    found: SearchLog = field(default_factory=SearchLog)
    seen: set[bytes] = field(default_factory=set)
    tried: set[bytes] = field(default_factory=set)

    def run(self) -> SearchLog:
        """Run the search; at Ctrl-C return what was found so far."""
        return self._kept(self._run)

    def go_on(self) -> SearchLog:
        """Search the neighbourhoods of certificates found by other means; at Ctrl-C return what was found so far."""
        return self._kept(self._search_neighbourhoods)

    def _kept(self, search: Callable[[], None]) -> SearchLog:
        try:
            search()
        except KeyboardInterrupt:
            self.found.interrupted = True
        return self.found

    def _run(self) -> None:
        associated = near(self.system, coulomb(self.system.strength))
        if associated.status != "optimal":
            return
        parting = self._start(associated.pressure, 1.0, associated)
        if self.starts > 1:
            parting = np.maximum(parting, self._start(associated.pressure, 0.3, None))
        self._search_glued(finest(self.system, self.place, parting, FIRST_FREEDOMS), PROGRAMS)
        number, left = 0, np.inf
        while (best := self.found.best) is not None and not self._ends():
            if self.found.dry < MAX_DRY_STARTS and self.found.starts < min(self.starts, MAX_STARTS):
                rng = np.random.default_rng([2, number])
                pressure = (associated if number % 2 == 0 else best.least).pressure
                pressure = pressure * rng.lognormal(size=len(pressure))
                self._start(pressure, WEIGHTS[number % len(WEIGHTS)], associated if number % 4 < 2 else None)
                number += 1
            elif is_worth(left, self.found.lowest):
                self._search_neighbourhoods()
                left = self.found.lowest
            else:
                return

    def _search_neighbourhoods(self) -> None:
        """Search neighbourhoods of the lowest certificate until several in a row have nothing lower.

        The first neighbourhood of a certificate is that of all moving points, the others each that of a single one.
        """
        rng, failures = np.random.default_rng(3), 0
        while (best := self.found.best) is not None and failures < MAX_FAILURES and not self._ends():
            before, moving = best.least.multiplier, ~still_points(self.system, best.motion, NO_JUMP)
            one = one_of(moving, rng)
            glued = neighbourhood(self.system, self.place, moving, one if failures else moving, NEIGHBOURHOOD_FREEDOMS)
            self._search_from(best, glued, rng)
            failures += 1
            if is_worth(before, self.found.lowest):
                self.found.dry = failures = 0

    def _ends(self) -> bool:
        return self.found.interrupted or self.found.cost >= self._allowed

    @property
    def _allowed(self) -> float:
        return COST_FACTOR * programs_allowed(self.system) if self.most is None else self.most

    def _start(self, pressure: Array, weight: float | None, associated: ForceSolution | None) -> Array:
        """Glue what barely moves in a sequence of programs from a pressure ``(np,)``, and search what is left.

        The wall is glued by each single mechanism, and by all of them together with an associated one. Returns the
        largest relative jumps ``(np,)`` of the sequence. Weight None stands for (k + 1)^(−1/2), as in `sequences`.
        """
        before, parting = self.found.lowest, self._jumps(np.zeros(self.system.freedoms))
        for k in range(SEQUENCE_PROGRAMS):
            if self._ends():
                break
            program = near(self.system, frozen_friction(self.system.strength, pressure))
            self.found.add_programs(1)
            if program.status != "optimal":
                break
            jumps = self._jumps(program.motion)
            self._search_glued(finest(self.system, self.place, jumps, PROGRAM_FREEDOMS), FEW_PROGRAMS)
            parting = np.maximum(parting, jumps)
            pressure = averaged(pressure, program.pressure, weight or (k + 1.0) ** -0.5)
        also = 0.0 if associated is None else self._jumps(associated.motion)
        self._search_glued(finest(self.system, self.place, np.maximum(parting, also), SEQUENCE_FREEDOMS), PROGRAMS)
        self.found.starts += 1
        self.found.dry = 0 if is_worth(before, self.found.lowest) else self.found.dry + 1
        return parting

    def _jumps(self, motion: Array) -> Array:
        jumps = np.abs(self.system.jumps(motion)).max(axis=0)
        return np.asarray(jumps / (np.abs(motion).max(initial=0.0) or 1.0))

    def _search_glued(self, glued: Glued | None, programs: int) -> None:
        """Search a glued wall."""
        if glued is None or self._is_done(glued):
            return
        most = min(float(programs), (self._allowed - self.found.cost) / glued.cost)
        associated = solve_forces(glued.system, coulomb(glued.system.strength))
        parts = search(glued.system, associated, workers=self.workers, most=most)
        self.found.add_programs(parts.programs, glued.cost)
        self.found.interrupted |= parts.interrupted
        self._prove(glued, parts.certificates)

    def _search_from(self, best: Certificate, glued: Glued | None, rng: np.random.Generator) -> None:
        """Search a glued wall from a certificate that moves none of the glued joints."""
        if glued is None or self._is_done(glued):
            return
        programs, certificates = Programs(glued.system, asks_interior_point=False), list[Certificate]()
        try:
            certificates += certificates_near(glued, best, programs, NEIGHBOURHOOD_SEQUENCES, rng)
        except KeyboardInterrupt:
            self.found.interrupted = True
        self.found.add_programs(programs.solved, glued.cost)
        self._prove(glued, certificates)

    def _is_done(self, glued: Glued) -> bool:
        """Whether a glued wall was searched before, or the search has to end; the wall is marked as searched."""
        known = self._ends() or glued.points.tobytes() in self.seen
        self.seen.add(glued.points.tobytes())
        return known

    def _prove(self, glued: Glued, certificates: Sequence[Certificate]) -> None:
        """Prove certificates of the glued wall in the full wall, as long as they may extend the range of loads found.

        After Ctrl-C only lower loads are proved, no higher ones.
        """
        for each in sorted(certificates, key=least_multiplier):
            if not is_worth(self.found.lowest, each.least.multiplier):
                break
            self._prove_motion(glued.motions @ each.motion)
        for each in sorted(certificates, key=lambda each: -each.most.multiplier):
            if self.found.interrupted or not is_worth(each.most.multiplier, self.found.highest):
                break
            self._prove_motion(glued.motions @ each.motion)
        self.observe(self.found)

    def _prove_motion(self, motion: Array) -> None:
        """Certify a mechanism ``(nd,)`` of a new jump pattern; only approximately inside the range of loads found."""
        jumps = jump_pattern(self.system, motion)
        if jumps in self.tried:
            return
        self.tried.add(jumps)
        proved = roughly_certified(self.system, motion, self.found.add_programs)
        if proved is not None and self._is_beyond(proved):
            self.found.add_programs(2)
            proved = certify(self.system, motion)  # an approximate certificate would hide exact ones
        if proved is not None:
            self.found.certificates.append(proved)

    def _is_beyond(self, certificate: Certificate) -> bool:
        """Whether a certificate is the lowest or the highest so far."""
        lower = certificate.least.multiplier < self.found.lowest
        return lower or certificate.most.multiplier > self.found.highest


def is_worth(large: float, small: float) -> bool:
    """Whether two multipliers, which may be infinite, differ enough for a proof."""
    return large > small and (np.isinf(large - small) or large - small > MIN_CHANGE * max(1.0, abs(large)))


def finest(system: Equilibrium, place: Array, jumps: Array, freedoms: int) -> Glued | None:
    """Glue the wall where `jumps` ``(np,)`` are smallest, with at most `freedoms` left; None if that leaves none."""
    return freest(system, place, jumps, GLUE_LEVELS, freedoms)
