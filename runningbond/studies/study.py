"""What a study is: cases, what is measured of each, the edges that come of it, and charts.

A study has parts. A part has cases, tuples of words and numbers, and a function that measures one of them. A case and
what was measured of it are a row of the study's table; tables, edges and charts are made of rows and of nothing else.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from matplotlib.figure import Figure

from runningbond.pictures.sheet import Sheet

Case: TypeAlias = tuple[Any, ...]  # words and numbers that tell what is measured
Row: TypeAlias = dict[str, Any]  # a case and what was measured of it, by columns; lists are for charts alone
Rows: TypeAlias = Mapping[str, Sequence[Row]]  # rows of a study, by the names of its parts
FAILURE = "failure"  # column that holds the words of the error in which a case ended, if it did
PACKAGE = Path(__file__).parents[1]


@dataclass(frozen=True)
class Edge:
    """An edge beyond which a method fails."""

    what: str  # the edge, with its unit: ``largest ω dt with local damping 0.5``
    measured: float  # where the method began to fail
    theory: float | None = None  # where it must, by theory
    tolerance: float | None = None  # relative difference that the study allows itself

    @property
    def error(self) -> float | None:
        """Relative difference of measurement and theory."""
        return None if self.theory is None else abs(self.measured - self.theory) / abs(self.theory)

    @property
    def agrees(self) -> bool | None:
        """Whether measurement and theory agree; None without a theory or a tolerance."""
        return None if self.error is None or self.tolerance is None else self.error <= self.tolerance


@dataclass(frozen=True)
class Part:
    """Cases of one kind, in the order in which they are measured, and what their entries are called."""

    columns: tuple[str, ...]
    cases: Sequence[Case]
    measure: Callable[..., Row]  # takes the entries of a case as its arguments, and returns what comes of it


@dataclass(frozen=True)
class Chart:
    """A chart: what it shows, and what draws it on an empty figure of a size [in]."""

    caption: str
    draw: Callable[[Figure, Rows], None]
    name: str = ""  # of its file, without suffix; where none is given, that of the study
    size: tuple[float, float] = (8, 4.6)


def all_rows(rows: Rows) -> list[Sheet]:
    """Every part as a table: columns with a word or a number in any row, lists left to charts."""
    sheets = []
    for part, own in rows.items():
        every = dict.fromkeys(head for row in own for head in row)
        heads = [x for x in every if any(row.get(x) is not None for row in own) and not isinstance(own[0].get(x), list)]
        sheets.append(Sheet(part, heads, [[cell(row.get(head)) for head in heads] for row in own]))
    return sheets


def cell(value: object) -> str:
    """An entry of a row, as tables print it."""
    return "–" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Study:
    """A study, and in fixed words where its method may be trusted; the numbers are edges.

    A row that has a column `measured` is an edge itself, with `theory` and `allowed` beside it where there is one.
    """

    name: str  # on the command line, and of its table
    title: str  # what is studied, in a few words
    parts: Mapping[str, Part]  # its cases, by the names of its parts
    charts: Sequence[Chart]
    trusted: str = ""  # where the method may be trusted,
    beyond: str = ""  # and what a user is told beyond
    fits: Callable[[Rows], list[Edge]] = lambda rows: []  # edges that are read off several rows
    tables: Callable[[Rows], list[Sheet]] = all_rows  # tables of the page
    sources: Sequence[Path] = (PACKAGE,)  # code beside the computing rooms whose change makes rows invalid
    depends: Callable[[Case], str] = lambda case: ""  # what else the row of a case depends on, as words
    apart: bool = False  # whether each case is measured in a process of its own

    @property
    def cases(self) -> list[tuple[str, Case]]:
        """Every case, with the name of its part."""
        return [(name, case) for name, part in self.parts.items() for case in part.cases]

    def entries(self, where: tuple[str, Case]) -> Row:
        """A case of a part, by columns."""
        return dict(zip(self.parts[where[0]].columns, where[1], strict=True))

    def edges(self, rows: Rows) -> list[Edge]:
        """Every edge: rows that are one, and those that are read off several rows."""
        edges = []
        for name, part in self.parts.items():
            for row in rows[name]:
                if row.get("measured") is not None:
                    what = ", ".join(str(row[column]) for column in part.columns)
                    edges.append(Edge(f"{name}: {what}", row["measured"], row.get("theory"), row.get("allowed")))
        return [*edges, *self.fits(rows)]
