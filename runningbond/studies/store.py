"""The table of a study: a row is stored as soon as it is measured, and reused while nothing that it depends on changes.

``NAME.csv`` is written atomically. Each row carries a key, the digest of everything that it depends on, and a seal, the
digest of the row itself with its column heads.
"""

import csv
import hashlib
import io
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import cache
from pathlib import Path
from threading import Event
from typing import TypeAlias

import numpy as np

from runningbond.campaigns.fingerprint import code_digest
from runningbond.pictures.sheet import csv_lines
from runningbond.results import write_atomically

from .apart import measure_apart
from .study import FAILURE, Case, Row, Rows, Study

Where: TypeAlias = tuple[str, Case]  # the name of a part, and one of its cases


def run_study(
    study: Study, folder: Path, *, jobs: int = 1, progress: Callable[[str], None] = lambda case: None
) -> dict[str, list[Row]]:
    """Measure the cases missing in a folder's table, and report each case to `progress`; returns all rows, by part."""
    kept = kept_rows(study, folder)

    def tell(where: Where) -> None:
        progress(", ".join([study.name, *(str(entry) for entry in where[1] if entry != "")]))

    for where in kept:
        tell(where)
    for where, row in _measured(study, [where for where in study.cases if where not in kept], jobs):
        kept[where] = row
        write_atomically(table_path(study, folder), csv_text(study, kept).encode())
        tell(where)
    return {name: [kept[name, case] for case in part.cases] for name, part in study.parts.items()}


def failures(rows: Rows) -> list[str]:
    """Cases that ended in an error, with its message."""
    return [", ".join(map(str, row.values())) for own in rows.values() for row in own if FAILURE in row]


def is_complete(study: Study, folder: Path) -> bool:
    """Whether the table has every case."""
    return len(kept_rows(study, folder)) == len(study.cases)


def table_path(study: Study, folder: Path) -> Path:
    """File of the table."""
    return folder / f"{study.name}.csv"


def kept_rows(study: Study, folder: Path) -> dict[Where, Row]:
    """Rows of the table that are still valid, except cases that ended in an error: these are tried again."""
    try:
        rows = read_csv(table_path(study, folder).read_text(encoding="utf-8"))
    except (OSError, ValueError, csv.Error):
        return {}
    cases = ((where, study.entries(where), rows.get(_key(study, where))) for where in study.cases)
    return {where: case | row | case for where, case, row in cases if row is not None and FAILURE not in row}


def csv_text(study: Study, rows: dict[Where, Row]) -> str:
    """The table as CSV, in the order of the study; `kept_rows` reads the same rows back, to the last bit."""
    columns = list(dict.fromkeys(column for row in rows.values() for column in row))
    lines = [["part", *columns, "key", "seal"]]
    for where in study.cases:
        if where in rows:
            case, row = study.parts[where[0]].columns, rows[where]
            entries = [_text(row.get(column), plain=column in case) for column in columns]
            cells = [where[0], *entries, _key(study, where)]
            lines.append([*cells, _seal(lines[0], cells)])
    return csv_lines(lines)


def read_csv(text: str) -> dict[str, Row]:
    """Rows of a table by their keys, without damaged ones."""
    reader = csv.reader(io.StringIO(text))
    heads = next(reader, [])
    return {
        cells[-2]: {head: _value(cell) for head, cell in zip(heads[1:-2], cells[1:-2], strict=True) if cell}
        for cells in reader
        if len(cells) == len(heads) and cells[-1] == _seal(heads, cells[:-1])
    }


def _text(value: object, *, plain: bool) -> str:
    """An entry as a cell: text as it is if it belongs to the case or reads back unchanged, everything else as JSON."""
    if value is None or value == "":
        return ""
    if isinstance(value, str) and (plain or value == _value(value)):
        return value
    return json.dumps(value, default=np.generic.item)  # NumPy numbers as Python numbers


def _value(cell: str) -> object:
    try:
        return json.loads(cell)
    except ValueError:
        return cell


def _seal(heads: Sequence[str], cells: Sequence[str]) -> str:
    """Digest of a row and its column heads."""
    return _digest("\0".join([*heads, *cells]))[:16]


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _key(study: Study, where: Where) -> str:
    """Digest of everything that the row of a case depends on."""
    return _digest(f"{code_digest()} {sources_digest(tuple(study.sources))} {where!r} {study.depends(where[1])}")


@cache
def sources_digest(sources: tuple[Path, ...]) -> str:
    """Digest of files, and of all code and scenes in folders."""
    digest = hashlib.sha256()
    for source in sources:
        for path in sorted(source.rglob("*")) if source.is_dir() else [source]:
            if path.suffix in (".py", ".toml"):
                digest.update(f"{path.relative_to(source.parent).as_posix()}\n".encode() + path.read_bytes())
    return digest.hexdigest()


def _measured(study: Study, cases: Sequence[Where], jobs: int) -> Iterator[tuple[Where, Row]]:
    """Rows as they are measured: one after another in this thread, or by threads that each wait for a process."""
    stop = Event()
    if jobs == 1:
        yield from ((where, _row(study, where, stop)) for where in cases)
        return
    with ThreadPoolExecutor(jobs) as threads:
        tasks = {threads.submit(_row, study, where, stop): where for where in cases}
        try:
            yield from ((tasks[task], task.result()) for task in as_completed(tasks))
        finally:
            stop.set()
            threads.shutdown(cancel_futures=True)


def _row(study: Study, where: Where, stop: Event) -> Row:
    measure, row = study.parts[where[0]].measure, study.entries(where)
    try:
        return row | (measure_apart(measure, where[1], stop) if study.apart else measure(*where[1]))
    except Exception as error:  # a defect in one case must not lose the others
        return row | {FAILURE: f"{type(error).__name__}: {error}"}
