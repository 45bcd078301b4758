"""The smallest load at which a collapse with true Coulomb friction can be certified, looked for from many starts.

What a sequence of programs settles at depends on the pressure that it starts from (`sequences`). From every
certificate `descent` goes on to smaller loads. Finding the smallest of all is a program with complementarity
constraints, for which nothing better than looking is known; no lower bound comes of it.

Starts are made in rounds. Those of a round know what was found before it and nothing of each other, so that what is
found does not depend on how many are made at a time.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event

from runningbond.scene import Array

from .certificates import least_multiplier
from .descent import is_lower
from .equilibrium import Equilibrium
from .force_program import ForceSolution
from .programs import Corners, Programs
from .search_log import Observer, SearchLog
from .starts import ORIGINS, ROUND, Start

STARTS = 160
"""Most starts."""

DRY = 2 * ROUND * len(ORIGINS)
"""Starts in a row that bring nothing lower, every way to start twice, after which the search ends."""

AFFORDED = 22_000
"""Joint points up to which one program more is afforded: programs cost as the power of 2.5 of the points."""

MANY_CORNERS = 2500
"""Joint points from which mechanisms that the simplex method gives up are not left for other starts."""


def programs_allowed(system: Equilibrium) -> int:
    """Programs after which no further start is made: fewer where each costs more, so that all cost about as much."""
    return 20 + int((AFFORDED / max(1, len(system.points))) ** 2.5)


def dry_allowed(system: Equilibrium) -> int:
    """Starts in a row that bring nothing lower, after which the search ends: fewer where there is little to find."""
    return min(DRY, max(8, 2 * system.freedoms))


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
    """Look for certificates from many starts, seeded; a keyboard interrupt keeps those that were found.

    `observe` is shown what was found after every round; starts are made by so many `workers` at a time, and none after
    the `most` linear programs, `programs_allowed` where they are not given. What was `found` before is added to.
    Where movable blocks have their centroids at a `place` ``(n, 2)`` [m], neighbourhoods are searched too.
    """
    found = SearchLog() if found is None else found
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
        before = sorted(found.certificates, key=least_multiplier)
        batch = [Start(number, associated, before, dict(known), place, corners) for number in numbers]
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


def _merge(found: SearchLog, start: SearchLog) -> None:
    found.dry = 0 if is_lower(start.lowest, found.lowest) else found.dry + 1
    found.certificates += start.certificates
    found.starts += 1
    found.programs += start.programs
    found.cost += start.cost
    found.frictionless |= start.frictionless
    found.growing |= start.growing
