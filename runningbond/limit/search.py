"""Search, from many starts, for the smallest load at which a collapse with true Coulomb friction can be certified.

The mechanism at which a sequence of programs settles depends on the pressure that it starts from (`sequences`). From
every certificate `descent` continues to smaller loads. Finding the smallest load of all is a program with
complementarity constraints, for which nothing better than a search is known; it yields no lower bound.

Starts are made in rounds. Starts of one round use what was found before it, but not what the others find, so that the
result does not depend on the number of parallel workers.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event

from runningbond.scene import Array

from .certificates import least_multiplier
from .descent import is_lower
from .equilibrium import Equilibrium
from .force_program import ForceSolution
from .programs import Programs, Vertices
from .search_log import Observer, SearchLog
from .starts import ROUND, Start

STARTS = 400
"""Largest number of starts."""

DRY_STARTS, MANY_POINTS = 64, 600
"""Number of consecutive starts without a lower load that ends the search of a wall of at least so many joint points.

Walls of fewer points are given more starts, which cost less there: rare mechanisms need them.
"""

AFFORDED_POINTS = 22_000
"""Joint points up to which one program beyond 20 is allowed; programs cost as the power of 2.5 of the points."""

PATIENT_POINTS = 2500
"""Joint points from which the interior point decides on mechanisms where the simplex method ends without a result."""


def programs_allowed(system: Equilibrium) -> int:
    """Number of programs after which no further start is made, chosen so that all walls cost about as much."""
    return 20 + int((AFFORDED_POINTS / max(1, len(system.points))) ** 2.5)


def dry_allowed(system: Equilibrium) -> int:
    """Number of consecutive starts without a lower load that ends the search: at most two per freedom, or eight."""
    starts = DRY_STARTS * max(1.0, MANY_POINTS / max(1, len(system.points)))
    return min(int(starts), max(8, 2 * system.freedoms))


def search(
    system: Equilibrium,
    associated: ForceSolution,
    starts: int = STARTS,
    workers: int = 1,
    observe: Observer = lambda found: None,
    most: float | None = None,
    found: SearchLog | None = None,
    place: Array | None = None,
) -> SearchLog:
    """Search for certificates from many seeded starts; a keyboard interrupt keeps those that were found.

    `observe` is called after every round; `workers` starts run in parallel, and none begins after `most` linear
    programs (by default `programs_allowed` more), except that a small wall's search without any certificate makes one
    more round, in which interior points decide on mechanisms. The results are added to those `found` before. If the
    centroids of movable blocks are given as `place` ``(n, 2)`` [m], neighbourhoods are searched, too.
    """
    found = SearchLog() if found is None else found
    found.dry, made, stopped = 0, 0, Event()
    crew = [Programs(system, stopped) for _ in range(workers)]
    known: dict[bytes, ForceSolution | None] = {}
    vertices: list[Vertices] = [(None, None, None)] * ROUND
    patient = len(system.points) >= PATIENT_POINTS
    most = found.cost + programs_allowed(system) if most is None else most
    while made < starts:
        for programs in crew:
            programs.asks_interior_point = patient
        numbers = range(made, min(starts, made + ROUND) if made else 1)
        before = sorted(found.certificates, key=least_multiplier)
        pairs = zip(numbers, vertices, strict=False)  # the first start is alone, and the last round may be short
        batch = [Start(number, associated, before, dict(known), place, last) for number, last in pairs]
        try:
            _run(batch, crew)
        except KeyboardInterrupt:
            stopped.set()
            found.interrupted = True
        for start in batch:
            known |= start.known
            _merge(found, start.found)
        made += len(batch)
        vertices = [start.vertices for start in batch] if len(batch) == ROUND else [batch[0].vertices] * ROUND
        observe(found)
        if found.interrupted or found.frictionless:
            break
        if found.dry >= dry_allowed(system) or found.cost > most:
            if patient or found.certificates:
                break
            # Mechanisms left undecided by the simplex method may be the only ones. This round is the last, unless it
            # finds one and `most` is not reached.
            patient = True
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


def _merge(found: SearchLog, start: SearchLog) -> None:
    found.dry = 0 if is_lower(start.lowest, found.lowest) else found.dry + 1
    found.certificates += start.certificates
    found.starts += 1
    found.programs += start.programs
    found.cost += start.cost
    found.frictionless |= start.frictionless
    found.growing |= start.growing
