"""Parts of a study: cases, what is measured for each case, the resulting edges, and charts.

A study has parts. A part has cases, tuples of words and numbers, and a function that measures one case. A case and its
measured values form a row of the study's table; tables, edges and charts are made only from rows.
"""

import math
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from matplotlib.figure import Figure

from runningbond.pictures.sheet import Sheet

Case: TypeAlias = tuple[Any, ...]  # words and numbers that define what is measured
Row: TypeAlias = dict[str, Any]  # a case and its measured values, by column; lists are for charts only
Rows: TypeAlias = Mapping[str, Sequence[Row]]  # rows of a study, by the names of its parts
FAILURE = "failure"  # column with the error message of a case that ended in an error
PACKAGE = Path(__file__).parents[1]


@dataclass(frozen=True)
class Edge:
    """A limit beyond which a method fails."""

    what: str  # name with unit: ``largest ω dt with local damping 0.5``
    measured: float  # where the method began to fail
    theory: float | None = None  # where it must fail by theory
    tolerance: float | None = None  # allowed relative difference between both

    @property
    def error(self) -> float | None:
        """Relative difference between measurement and theory, absolute if theory is zero; None without a theory."""
        return None if self.theory is None else abs(self.measured - self.theory) / (abs(self.theory) or 1.0)

    @property
    def agrees(self) -> bool | None:
        """Whether measurement and theory agree; None without a theory or a tolerance."""
        return None if self.error is None or self.tolerance is None else self.error <= self.tolerance


@dataclass(frozen=True)
class Part:
    """Cases of one kind, in the order in which they are measured, and the column names of their entries."""

    columns: tuple[str, ...]
    cases: Sequence[Case]
    measure: Callable[..., Row]  # takes the entries of a case as arguments, returns the measured values


@dataclass(frozen=True)
class Chart:
    """A chart: its caption, and the function that draws it on an empty figure of a given size [in]."""

    caption: str
    draw: Callable[[Figure, Rows], None]
    name: str = ""  # file name without suffix; by default the name of the study
    size: tuple[float, float] = (8, 4.6)


def run_around(own: float, values: Sequence[float], good: Container[float]) -> tuple[float, float]:
    """First and last of successive good values around `own`, one of the values; NaN if that is not good itself."""
    if own not in good:
        return math.nan, math.nan
    at = values.index(own)
    bad = [-1, *(place for place, value in enumerate(values) if value not in good), len(values)]
    return values[max(x for x in bad if x < at) + 1], values[min(x for x in bad if x > at) - 1]


def all_rows(rows: Rows) -> list[Sheet]:
    """Every part as a table, with the columns that have a value in any row, except lists."""
    sheets = []
    for part, own in rows.items():
        every = dict.fromkeys(head for row in own for head in row)
        heads = [x for x in every if any(row.get(x) is not None for row in own) and not isinstance(own[0].get(x), list)]
        sheets.append(Sheet(part, heads, [[cell(row.get(head)) for head in heads] for row in own]))
    return sheets


def cell(value: object) -> str:
    """An entry of a row as text for tables."""
    return "–" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Study:
    """A study, with fixed text on where its method may be trusted; the numbers are in its edges.

    A row that has a column `measured` is itself an edge, with `theory` and `allowed` if there is a theory.
    """

    name: str  # on the command line, and of the file of its table
    title: str  # what is studied, in a few words
    parts: Mapping[str, Part]  # its cases, by part
    charts: Sequence[Chart]
    trusted: str = ""  # where the method may be trusted
    beyond: str = ""  # what a user gets beyond that
    fits: Callable[[Rows], list[Edge]] = lambda rows: []  # edges that are derived from several rows
    tables: Callable[[Rows], list[Sheet]] = all_rows  # tables of the page
    sources: Sequence[Path] = (PACKAGE,)  # code whose change invalidates rows, besides the computing packages
    depends: Callable[[Case], str] = lambda case: ""  # anything else that the row of a case depends on, as text
    apart: bool = False  # whether each case is measured in its own process

    @property
    def cases(self) -> list[tuple[str, Case]]:
        """Every case, with the name of its part."""
        return [(name, case) for name, part in self.parts.items() for case in part.cases]

    def entries(self, where: tuple[str, Case]) -> Row:
        """The entries of a case, by column."""
        return dict(zip(self.parts[where[0]].columns, where[1], strict=True))

    def edges(self, rows: Rows) -> list[Edge]:
        """All edges: rows that are edges, and edges that are derived from several rows."""
        edges = []
        for name, part in self.parts.items():
            for row in rows[name]:
                if row.get("measured") is not None:
                    what = ", ".join(str(row[column]) for column in part.columns)
                    edges.append(Edge(f"{name}: {what}", row["measured"], row.get("theory"), row.get("allowed")))
        return [*edges, *self.fits(rows)]
