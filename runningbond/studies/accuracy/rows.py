"""The study's table: one row a case, as tidy as a script wants it."""

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, get_type_hints

from .cases import Case
from .walls import Interval

MEASURED = ("collapse", "elastic", "measured")
"""Statuses of an answer that is a number."""

TOO_LONG = "too long"
FAILED = "failed"


@dataclass(frozen=True)
class Row:
    """A case and what came of it; what does not exist is None.

    Parameters
    ----------
    part, wall, blocks, question, model, knob, setting
        The case: `knob` is what was turned, to `setting`; empty where the model ran as it is.
    known, answer_low, answer_high
        What is known of the answer, and the interval in which it lies.
    status, value, lower, upper, dofs, steps, message
        The model's answer, see `answer.Answer`; ``too long`` where it would have taken too long.
    error
        Distance of `value` from the interval of the answer, relative to the nearer end; zero inside.
    runs
        Timed runs, of which the seconds are the median, the least and the most.
    wall_s, wall_s_min, wall_s_max, cpu_s, cpu_s_min, cpu_s_max
        Seconds by the clock, and of the processor.
    ratio, ratio_min, ratio_max
        Processor seconds in those of the reference, run by run in one process.
    memory_mb
        The most memory that a run took beyond what its process held before [MB].
    machine, key
        Processor, cores and Python; digest of scene, settings, code and machine.
    """

    part: str
    wall: str
    blocks: int
    question: str
    model: str
    knob: str
    setting: str
    known: str = ""
    answer_low: float | None = None
    answer_high: float | None = None
    status: str = FAILED
    value: float | None = None
    lower: float | None = None
    upper: float | None = None
    error: float | None = None
    dofs: int | None = None
    steps: int | None = None
    runs: int = 0
    wall_s: float | None = None
    wall_s_min: float | None = None
    wall_s_max: float | None = None
    cpu_s: float | None = None
    cpu_s_min: float | None = None
    cpu_s_max: float | None = None
    ratio: float | None = None
    ratio_min: float | None = None
    ratio_max: float | None = None
    memory_mb: float | None = None
    message: str = ""
    machine: str = ""
    key: str = ""

    @property
    def case(self) -> Case:
        """The case whose row this is."""
        return Case(self.part, self.wall, self.model, self.knob, self.setting)  # type: ignore[arg-type]


def distance(value: float, interval: Interval) -> float:
    """Distance of a value from an interval, relative to the nearer end; zero inside."""
    low, high = interval
    nearer = low if value < low else high
    return 0.0 if low <= value <= high else abs(value - nearer) / abs(nearer)


def with_errors(rows: Iterable[Row]) -> list[Row]:
    """The rows with the error of each, once the certified answers among them are known."""
    rows = list(rows)
    certified = {
        (row.part, row.wall): (row.lower, row.upper)
        for row in rows
        if row.known == "certified" and row.model == "limit-nonassociated" and row.status == "collapse"
    }
    found = []
    for row in rows:
        low, high = row.answer_low, row.answer_high
        if row.known == "certified":
            low, high = certified.get((row.part, row.wall), (None, None))
        error = None
        if row.value is not None and low is not None and high is not None:
            error = distance(row.value, (low, high))
        found.append(replace(row, answer_low=low, answer_high=high, error=error))
    return found


def csv_text(rows: Iterable[Row]) -> str:
    """The table as CSV; `read_csv` gives the same rows back, to the last bit."""
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, [entry.name for entry in fields(Row)], lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _cell(value) for name, value in asdict(row).items()} for row in rows)
    return buffer.getvalue()


def read_csv(text: str) -> list[Row]:
    """Rows of a table; none of a table with other columns, which is of an older study."""
    reader = csv.DictReader(io.StringIO(text))
    if reader.fieldnames != [entry.name for entry in fields(Row)]:
        return []
    kinds = get_type_hints(Row)
    rows: list[dict[str, Any]] = [{name: _value(kinds[name], cell) for name, cell in row.items()} for row in reader]
    return [Row(**row) for row in rows]


def _cell(value: object) -> object:
    return repr(value) if isinstance(value, float) else value


def _value(kind: Any, cell: str) -> object:
    if kind is str:
        return cell
    if cell == "":
        return None
    return int(cell) if kind in (int, int | None) else float(cell)
