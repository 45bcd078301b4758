"""The smallest load at which a collapse with true Coulomb friction can be certified, looked for from many starts.

After Gilbert, Casapulla & Ahmed (2006) a sequence of linear programs freezes each point's shear resistance at μ times
a pressure that is brought up to date between programs: averaged with weights (k + 1)^(−1/2) in program k, which settles
where fixed weights keep wandering, or with fixed ones, which settle elsewhere. What it settles at depends on the
pressure that it starts from. From every certificate `descent` goes on to smaller loads. Finding the smallest of all is
a program with complementarity constraints, for which nothing better than looking is known; no lower bound comes of it.

Starts are made in rounds. Those of a round know what was found before it and nothing of each other, so that what is
found does not depend on how many are made at a time.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Event

import numpy as np

from runningbond.scene import Array

from .certificates import Certificate, certify
from .descent import Descent, is_lower, random_weights
from .equilibrium import Equilibrium
from .force_program import Aim, ForceSet, ForceSolution, coulomb, solve_forces
from .programs import Corners, Programs
from .simplex import PRIMAL

PROGRAM_BUDGET = 40
"""Programs of the first start's sequence after which it ends without a certificate."""

CERTIFIED_IN_A_ROW = 3
"""Certificates in a row that end the first start's sequence."""

SHORT = 16
"""Programs of every other sequence after which it ends without a certificate."""

STARTS = 160
"""Most starts."""

DRY = 100
"""Starts in a row that bring nothing lower, after which the search ends: of walls of some hundred blocks one start in
a hundred finds the lowest mechanism."""

AFFORDED = 22_000
"""Joint points up to which one program more is afforded: programs cost as the power of 2.5 of the points."""

PIVOTS = 400
"""Corners passed on the way to random forces to start from."""

MANY_CORNERS = 2500
"""Joint points from which mechanisms that the simplex method gives up are not left for other starts."""

ROUND = 4
"""Starts of a round."""

WEIGHTS = (0.6, 1.0, None, 0.3)
"""Fixed weights of a new pressure in the sequences after the first, in turn; None is (k + 1)^(−1/2)."""


@dataclass(eq=False)
class Search:
    """What a search has found.

    Parameters
    ----------
    certificates
        Every collapse that was proved.
    starts, programs
        Starts, and linear programs solved.
    cost
        Those programs, where glued walls were searched by what they cost beside the wall's own.
    dry
        Starts in a row, the last ones, that brought nothing lower.
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
    cost: float = 0.0
    dry: int = 0
    frictionless: bool = False
    growing: bool = False
    interrupted: bool = False

    @property
    def best(self) -> Certificate | None:
        """The lowest certificate."""
        return min(self.certificates, key=lambda each: each.least.multiplier, default=None)

    @property
    def lowest(self) -> float:
        """Its multiplier; infinite without one."""
        return np.inf if self.best is None else self.best.least.multiplier

    @property
    def highest(self) -> float:
        """The largest certified multiplier; minus infinity without one."""
        return max((each.most.multiplier for each in self.certificates), default=-np.inf)

    def add_programs(self, number: int, cost: float = 1.0) -> None:
        """Take note of programs that were solved, and of what each cost."""
        self.programs += number
        self.cost += number * cost


Observer = Callable[[Search], None]


def programs_allowed(system: Equilibrium) -> int:
    """Programs after which no further start is made: fewer where each costs more, so that all cost about as much."""
    return 20 + int((AFFORDED / max(1, len(system.points))) ** 2.5)


def dry_allowed(system: Equilibrium) -> int:
    """Starts in a row that bring nothing lower, after which the search ends: fewer where there is little to find."""
    return min(DRY, max(8, 2 * system.freedoms))


@dataclass(eq=False)
class Start:
    """One start of a search, numbered from 0, from which it goes down as far as it gets.

    `best` is the lowest certificate before its round, `known` what mechanisms have led to.
    """

    number: int
    associated: ForceSolution
    best: Certificate | None
    known: dict[bytes, ForceSolution | None]
    corners: Corners = (None, None, None)
    found: Search = field(default_factory=Search)

    def run(self, programs: Programs) -> None:
        """Look for certificates, and write down what is found as it is found."""
        solved = programs.solved
        programs.go_to(self.corners)
        descent, rng = Descent(programs, self.known), np.random.default_rng([0, self.number + 1])
        try:
            for certificate in self._sequence(descent):
                known = self.found.certificates
                known.append(certificate)
                known += descent.below(certificate.motion, certificate.least, rng)
            early = self.number <= ROUND  # a walk from the first certificate is no better than from any other
            if early or self.best is None or is_lower(self.found.lowest, self.best.least.multiplier):
                best = self.found.best
                self.found.certificates += () if best is None else descent.around(best, rng)
        finally:
            self.found.add_programs(programs.solved - solved)

    def _sequence(self, descent: Descent) -> Iterator[Certificate]:
        pressure = self._pressure(descent)
        if self.number == 0:
            yield from first_sequence(descent, pressure, self.found)
        else:
            yield from short_sequence(descent, pressure, WEIGHTS[(self.number - 1) % len(WEIGHTS)])

    def _pressure(self, descent: Descent) -> Array:
        """Pressures ``(np,)`` to start from.

        Those of the associated solution, of the dead load, and then by rounds: those of random forces that balance
        random loads, or, where these are more than `PIVOTS` corners away, random multiples of the associated ones;
        random multiples of the lowest certificate's; random ones.
        """
        system, bounded = descent.system, self.associated.status == "optimal"
        if self.number <= 2:
            first = self.associated if bounded else solve_forces(system, coulomb(system.strength), "zero")
            return first.pressure if first.status == "optimal" else np.zeros(len(system.points))
        rng = np.random.default_rng([1, self.number])
        top = self.associated.multiplier if bounded else 1.0
        share = rng.random() if self.number > 3 else 0.0
        weights = random_weights(len(system.points), rng)
        if self.number // ROUND % 3 == 2 and self.best is not None:
            return self.best.least.pressure * np.exp(rng.normal(size=len(weights)))
        if self.number // ROUND % 3 == 0:
            return weights * (self.associated.pressure.mean() if bounded else 1.0)
        load = share * top if top > 0 else (1 + share) * top
        state = descent.programs.corner(coulomb(system.strength), weights, load, PIVOTS)
        if state.status == "optimal":
            return state.pressure
        return self.associated.pressure * np.exp(rng.normal(size=len(weights))) if bounded else weights


def search(
    system: Equilibrium,
    associated: ForceSolution,
    starts: int = STARTS,
    workers: int = 1,
    observe: Observer = lambda found: None,
    most: float | None = None,
    found: Search | None = None,
) -> Search:
    """Look for certificates from many starts, seeded; a keyboard interrupt keeps those that were found.

    `observe` is shown what was found after every round; starts are made by so many `workers` at a time, and none after
    the `most` linear programs, `programs_allowed` where they are not given. What was `found` before is added to.
    """
    found = Search() if found is None else found
    found.dry, made, stopped = 0, 0, Event()
    crew = [Programs(system, stopped) for _ in range(workers)]
    known: dict[bytes, ForceSolution | None] = {}
    corners: Corners = (None, None, None)
    patient = len(system.points) >= MANY_CORNERS
    most = found.cost + programs_allowed(system) if most is None else most
    while made < starts:
        for programs in crew:
            programs.asks_interior_point = patient
        numbers = range(made, min(starts, made + ROUND) if made else 1)
        batch = [Start(number, associated, found.best, dict(known), corners) for number in numbers]
        try:
            _run(batch, crew)
        except KeyboardInterrupt:
            stopped.set()
            found.interrupted = True
        for start in batch:
            known |= start.known
            _merge(found, start.found)
        made += len(batch)
        corners = crew[0].corners if made == 1 else corners
        observe(found)
        if found.interrupted or found.frictionless:
            break
        if found.dry >= dry_allowed(system) or found.cost > most:
            if patient or found.certificates:
                break
            patient = True  # what was given up may be all there is
            known.clear()
    return found


def _run(batch: Sequence[Start], crew: Sequence[Programs]) -> None:
    if min(len(crew), len(batch)) == 1:
        for start in batch:
            start.run(crew[0])
        return
    with ThreadPoolExecutor(len(crew)) as pool:
        idle = list(crew)

        def run(start: Start) -> None:
            programs = idle.pop()
            try:
                start.run(programs)
            finally:
                idle.append(programs)

        try:
            list(pool.map(run, batch))
        except KeyboardInterrupt:
            crew[0].stopped.set()
            raise


def _merge(found: Search, start: Search) -> None:
    found.dry = 0 if is_lower(start.lowest, found.lowest) else found.dry + 1
    found.certificates += start.certificates
    found.starts += 1
    found.add_programs(start.programs)
    found.frictionless |= start.frictionless
    found.growing |= start.growing


def first_sequence(descent: Descent, pressure: Array, found: Search) -> Iterator[Certificate]:
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


def short_sequence(descent: Descent, pressure: Array, weight: float | None) -> Iterator[Certificate]:
    """Run a short sequence from a first pressure ``(np,)`` to its first certificate."""
    for k in range(SHORT):
        program = descent.programs.frozen(pressure)
        if program.status != "optimal":
            return
        known = len(descent.known)
        if descent.least(program.motion) is not None:
            if len(descent.known) > known:  # or it was gone on from before
                certificate = certified(descent, program.motion)
                if certificate is not None:
                    yield certificate
            return
        pressure = averaged(pressure, program.pressure, weight or (k + 1.0) ** -0.5)


def certified(descent: Descent, motion: Array) -> Certificate | None:
    """The loads that drive a mechanism ``(nd,)``; None where there are none. Of loads without end, the least counts."""

    def extreme(forces: ForceSet, aim: Aim) -> ForceSolution | None:
        return descent.least(motion) if aim == "smallest" else descent.programs.extreme(forces, -1.0, PRIMAL)

    return certify(descent.system, motion, extreme)


def averaged(pressure: Array, new: Array, weight: float) -> Array:
    """Pressures ``(np,)`` for the next program, from those before and those found."""
    return (1 - weight) * pressure + weight * new
