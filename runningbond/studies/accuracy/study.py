"""The study: every case measured, kept in its table as it comes, and not again where it is there."""

import hashlib
import statistics
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from functools import cache
from pathlib import Path
from threading import Event
from typing import Any

from runningbond.compare.fingerprint import fingerprint
from runningbond.results import write_atomically

from .cases import Case, all_cases, wall_of
from .measure import Killed, Measurement, TooLong, machine, measure_apart
from .parameters import settings_of
from .rows import FAILED, TOO_LONG, Row, csv_text, read_csv, with_errors

TABLE = "study.csv"

SOURCES = ("walls", "knobs", "cell", "questions", "measure")
"""Modules beside the computing rooms that change what is measured."""


def run_study(
    folder: Path,
    *,
    cases: Sequence[Case] | None = None,
    jobs: int = 1,
    measure: Callable[[Case, Event], Measurement] = measure_apart,
    progress: Callable[[Case], None] = lambda case: None,
) -> list[Row]:
    """Measure what is not in the table yet.

    Parameters
    ----------
    folder
        Where the table is kept. A row is good for as long as its scene, settings, code and machine are the same.
    cases
        What to measure; everything where nothing is said.
    jobs
        Processes side by side. More than one share caches and memory, and their seconds are worth less.
    measure
        Measures one case, and gives up where the event is set.
    progress
        Called with each case that is done.

    Returns
    -------
    list of Row
        The whole table.
    """
    cases = all_cases() if cases is None else cases
    kept = _kept(folder / TABLE)
    left = [case for case in cases if case not in kept]
    for case in cases:
        if case in kept:
            progress(case)
    for row in _measured(left, jobs, measure):
        kept[row.case] = row
        _keep(kept, folder)
        progress(row.case)
    return _keep(kept, folder)


def key_of(case: Case) -> str:
    """Digest of all that a case's row depends on: scene, settings, code, libraries and machine."""
    settings = settings_of(case.model, case.knob, case.setting)
    what = f"{case.part} {case.model} {settings!r} {_own_digest()} {machine()}"
    return fingerprint(wall_of(case).scene, what, 0.0)


@cache
def _own_digest() -> str:
    digest = hashlib.sha256()
    for name in SOURCES:
        digest.update((Path(__file__).parent / f"{name}.py").read_bytes())
    return digest.hexdigest()


def _kept(path: Path) -> dict[Case, Row]:
    """Rows of a table that are still good; what failed is tried again."""
    try:
        rows = read_csv(path.read_text(encoding="utf-8"))
    except (OSError, TypeError, ValueError):  # not there, or damaged
        return {}
    known = set(all_cases())
    return {row.case: row for row in rows if row.status != FAILED and row.case in known and row.key == key_of(row.case)}


def _keep(kept: dict[Case, Row], folder: Path) -> list[Row]:
    """Write the table, whole or not at all, in the order of the study."""
    place = {case: i for i, case in enumerate(all_cases())}
    rows = with_errors(sorted(kept.values(), key=lambda row: place.get(row.case, len(place))))
    write_atomically(folder / TABLE, csv_text(rows).encode())
    return rows


def _measured(cases: Sequence[Case], jobs: int, measure: Callable[[Case, Event], Measurement]) -> Iterator[Row]:
    """Rows as they come, from threads that each wait for a process."""
    stop = Event()
    with ThreadPoolExecutor(jobs) as threads:
        tasks = [threads.submit(_row, case, measure, stop) for case in cases]
        try:
            for task in as_completed(tasks):
                yield task.result()
        finally:
            stop.set()
            threads.shutdown(cancel_futures=True)


def _row(case: Case, measure: Callable[[Case, Event], Measurement], stop: Event) -> Row:
    wall = wall_of(case)
    low, high = wall.answer or (None, None)
    row = Row(
        case.part,
        case.wall,
        wall.blocks,
        wall.question,
        case.model,
        case.knob,
        case.setting,
        wall.known,
        low,
        high,
        machine=machine(),
        key=key_of(case),
    )
    try:
        found = measure(case, stop)
    except TooLong as reason:
        return replace(row, status=TOO_LONG, message=str(reason))
    except Killed as reason:
        return replace(row, message=str(reason))
    return replace(
        row,
        **vars(found.answer),
        **_spread("wall_s", found.wall_s),
        **_spread("cpu_s", found.cpu_s),
        **_spread("ratio", found.ratio),
        runs=len(found.wall_s),
        memory_mb=found.memory_mb,
    )


def _spread(name: str, values: Sequence[float]) -> dict[str, Any]:
    """Median, least and most of what was measured, if anything was."""
    if not values:
        return {}
    return {name: statistics.median(values), f"{name}_min": min(values), f"{name}_max": max(values)}
