"""Certificates of walls of some hundred blocks, looked for in walls of fewer and proved in the wall itself.

Most mechanisms of little load move a few large parts of a wall. On these parts alone a program takes milliseconds
where the wall's own takes some tenths of a second, and what moves is a mechanism of the wall all the same (`macro`).
Where a wall may part is not known before: sequences of programs over the wall, by interior points, whose mechanisms are
mixes of all that collapse at about that load, move some joints far and others hardly. Blocks that move as one in all
programs of a sequence are glued, and the glued wall is searched as any other (`search`).

Forces that balance the wall's blocks balance its parts too, so that the loads which drive a mechanism of the glued wall
there hold all those which do in the wall: glued walls have the smaller ones, and no forces there are none in the wall.
Their certificates are therefore proved in the wall from the lowest up, until the next cannot be lower than what is
proved, and as many from the highest down.

What moves in many small parts, as a wall that slides all over does, holds no such mechanism, and is left to `search`.
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

POINTS = 1000
"""Joint points from which a wall is searched so first; smaller ones are searched themselves as soon."""

MIXES = 8
"""Programs of a sequence that shows where a wall may part."""

LEVELS = tuple(float(f"{digit}e-{power}") for power in (2, 3, 4, 5) for digit in (5, 2, 1))
"""Jumps, relative to the largest motion, below which blocks may be glued."""

FEWEST, FEW, MORE = 45, 150, 300
"""Most freedoms of a glued wall, three a part: of a program, of a sequence, and of the first two sequences together."""

FEW_PROGRAMS, PROGRAMS = 60, 400
"""Programs after which such a wall is searched no further, of one program and of more."""

DRY, STARTS = 4, 40
"""Sequences in a row that bring nothing lower, after which the search ends, and most of all."""

ALLOWED = 4
"""What a search may cost beside one over the wall itself: it mostly ends long before."""

AROUND, SEQUENCES = 350, 8
"""Most freedoms of a neighbourhood of a certificate, and sequences in it."""

IN_VAIN = 6
"""Neighbourhoods of a certificate in a row that hold nothing lower, after which it is left."""

WORTH = 1e-5
"""Change of the multiplier, relative to itself and 1, that is worth a proof: interior points tell no smaller ones."""


@dataclass(eq=False)
class CoarseSearch:
    """A search over parts of a wall.

    Parameters
    ----------
    system, place
        Equations of a wall without moving supports, and centroids of its movable blocks ``(n, 2)`` [m].
    observe
        Is shown what was found after each glued wall.
    workers
        Of `search`.
    starts
        Most sequences over the wall.
    most
        Cost after which nothing more is begun, in programs of the wall itself; `ALLOWED` times those of `search` where
        it is not given.
    """

    system: Equilibrium
    place: Array
    observe: Observer
    workers: int = 1
    starts: int = STARTS
    most: float | None = None
    found: SearchLog = field(default_factory=SearchLog)
    seen: set[bytes] = field(default_factory=set)
    tried: set[bytes] = field(default_factory=set)

    def run(self) -> SearchLog:
        """Search, and keep what was found at Ctrl-C."""
        return self._kept(self._run)

    def go_on(self) -> SearchLog:
        """Search the neighbourhoods of what was found otherwise, and keep what was found at Ctrl-C."""
        return self._kept(self._around)

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
        self._look(finest(self.system, self.place, parting, MORE), PROGRAMS)
        number, left = 0, np.inf
        while (best := self.found.best) is not None and not self._ends():
            if self.found.dry < DRY and self.found.starts < min(self.starts, STARTS):
                rng = np.random.default_rng([2, number])
                pressure = (associated if number % 2 == 0 else best.least).pressure
                pressure = pressure * rng.lognormal(size=len(pressure))
                self._start(pressure, WEIGHTS[number % len(WEIGHTS)], associated if number % 4 < 2 else None)
                number += 1
            elif is_worth(left, self.found.lowest):
                self._around()
                left = self.found.lowest
            else:
                return

    def _around(self) -> None:
        """Search neighbourhoods of the lowest certificate until some in a row have nothing lower.

        The first is of all that moves there, others of one point that does.
        """
        rng, in_vain = np.random.default_rng(3), 0
        while (best := self.found.best) is not None and in_vain < IN_VAIN and not self._ends():
            before, moving = best.least.multiplier, ~still_points(self.system, best.motion, NO_JUMP)
            one = one_of(moving, rng)
            glued = neighbourhood(self.system, self.place, moving, one if in_vain else moving, AROUND)
            self._look_from(best, glued, rng)
            in_vain += 1
            if is_worth(before, self.found.lowest):
                self.found.dry = in_vain = 0

    def _ends(self) -> bool:
        return self.found.interrupted or self.found.cost >= self._allowed

    @property
    def _allowed(self) -> float:
        return ALLOWED * programs_allowed(self.system) if self.most is None else self.most

    def _start(self, pressure: Array, weight: float | None, associated: ForceSolution | None) -> Array:
        """Search what is left of gluing all that hardly moves in a sequence of programs from a pressure ``(np,)``.

        In each of its mechanisms by itself, and in all of them and an associated one; it returns their largest jumps
        ``(np,)``, relative. No weight stands for (k + 1)^(−1/2), as in `search`.
        """
        before, parting = self.found.lowest, self._jumps(np.zeros(self.system.freedoms))
        for k in range(MIXES):
            if self._ends():
                break
            program = near(self.system, frozen_friction(self.system.strength, pressure))
            self.found.add_programs(1)
            if program.status != "optimal":
                break
            jumps = self._jumps(program.motion)
            self._look(finest(self.system, self.place, jumps, FEWEST), FEW_PROGRAMS)
            parting = np.maximum(parting, jumps)
            pressure = averaged(pressure, program.pressure, weight or (k + 1.0) ** -0.5)
        also = 0.0 if associated is None else self._jumps(associated.motion)
        self._look(finest(self.system, self.place, np.maximum(parting, also), FEW), PROGRAMS)
        self.found.starts += 1
        self.found.dry = 0 if is_worth(before, self.found.lowest) else self.found.dry + 1
        return parting

    def _jumps(self, motion: Array) -> Array:
        jumps = np.abs(self.system.jumps(motion)).max(axis=0)
        return np.asarray(jumps / (np.abs(motion).max(initial=0.0) or 1.0))

    def _look(self, glued: Glued | None, programs: int) -> None:
        """Search a glued wall."""
        if glued is None or self._knows(glued):
            return
        most = min(float(programs), (self._allowed - self.found.cost) / glued.cost)
        associated = solve_forces(glued.system, coulomb(glued.system.strength))
        parts = search(glued.system, associated, workers=self.workers, most=most)
        self.found.add_programs(parts.programs, glued.cost)
        self.found.interrupted |= parts.interrupted
        self._prove(glued, parts.certificates)

    def _look_from(self, best: Certificate, glued: Glued | None, rng: np.random.Generator) -> None:
        """Search a glued wall from a certificate that moves nothing glued."""
        if glued is None or self._knows(glued):
            return
        programs, certificates = Programs(glued.system, asks_interior_point=False), list[Certificate]()
        try:
            certificates += certificates_near(glued, best, programs, SEQUENCES, rng)
        except KeyboardInterrupt:
            self.found.interrupted = True
        self.found.add_programs(programs.solved, glued.cost)
        self._prove(glued, certificates)

    def _knows(self, glued: Glued) -> bool:
        """Whether a glued wall was searched before; it is now."""
        known = self._ends() or glued.points.tobytes() in self.seen
        self.seen.add(glued.points.tobytes())
        return known

    def _prove(self, glued: Glued, certificates: Sequence[Certificate]) -> None:
        """Prove certificates of the glued wall in the wall, as far as they may be lower or higher than what is.

        After Ctrl-C the lowest alone.
        """
        for each in sorted(certificates, key=least_multiplier):
            if not is_worth(self.found.lowest, each.least.multiplier):
                break
            self._try(glued.motions @ each.motion)
        for each in sorted(certificates, key=lambda each: -each.most.multiplier):
            if self.found.interrupted or not is_worth(each.most.multiplier, self.found.highest):
                break
            self._try(glued.motions @ each.motion)
        self.observe(self.found)

    def _try(self, motion: Array) -> None:
        """Prove a mechanism ``(nd,)``, unless it opens and slides as one did that was tried before."""
        jumps = jump_pattern(self.system, motion)
        if jumps in self.tried:
            return
        self.tried.add(jumps)
        proved = roughly_certified(self.system, motion, self.found.add_programs)
        if proved is not None and self._is_beyond(proved):
            self.found.add_programs(2)
            proved = certify(self.system, motion)  # what is not quite one would hide those that are
        if proved is not None:
            self.found.certificates.append(proved)

    def _is_beyond(self, certificate: Certificate) -> bool:
        """Whether a certificate is the lowest or the highest."""
        lower = certificate.least.multiplier < self.found.lowest
        return lower or certificate.most.multiplier > self.found.highest


def is_worth(large: float, small: float) -> bool:
    """Whether the larger of two multipliers, which may be infinite, is worth a proof."""
    return large > small and (np.isinf(large - small) or large - small > WORTH * max(1.0, abs(large)))


def finest(system: Equilibrium, place: Array, jumps: Array, freedoms: int) -> Glued | None:
    """The wall glued where points jump least ``(np,)``, as far as leaves so many freedoms; None for none."""
    return freest(system, place, jumps, LEVELS, freedoms)
