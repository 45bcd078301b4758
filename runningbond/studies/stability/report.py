"""``runningbond stability``: every experiment in its order, each finding kept, and what they say together."""

import difflib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from runningbond.compare.report import figure_html, page_html, table_html
from runningbond.compare.table import Sheet
from runningbond.results import write_atomically
from runningbond.scene import SceneError

from . import EXPERIMENTS, find_out
from .finding import Edge, Entry
from .store import Kept, drawn, find, keep


@dataclass
class Findings:
    """What there is in a folder.

    Parameters
    ----------
    kept
        Findings by the names of their experiments, in order.
    broken
        Experiments that ended in an error, and its words.
    """

    kept: dict[str, Kept] = field(default_factory=dict)
    broken: dict[str, str] = field(default_factory=dict)

    @property
    def off(self) -> list[tuple[str, Edge]]:
        """Edges that do not lie where theory has them, and whose they are."""
        return [(name, edge) for name, kept in self.kept.items() for edge in kept.off]


def check_experiments(names: Sequence[str]) -> None:
    """Refuse a name that is no experiment's."""
    for name in names:
        if name not in EXPERIMENTS:
            likely = difflib.get_close_matches(name, EXPERIMENTS, n=1)
            hint = f'; did you mean "{likely[0]}"?' if likely else ""
            raise SceneError("experiment", f"must be one of {', '.join(EXPERIMENTS)}{hint}", name)


def findings(
    names: Sequence[str], folder: Path, begin: Callable[[str], None] = lambda name: None
) -> Iterator[tuple[str, Kept | str]]:
    """Do experiments one after another, each unless its finding is in the folder; found ones of others come along.

    Parameters
    ----------
    names
        Names of the experiments wanted.
    folder
        Where findings are kept.
    begin
        Called with the name of each experiment before it is done.

    Yields
    ------
    (str, Kept or str)
        A name, and its finding or the words of the error that it ended in.
    """
    for name in EXPERIMENTS:
        kept = find(name, folder)
        if kept is None and name in names:
            begin(name)
            try:
                finding = find_out(name)
                chart = drawn(finding)
            except Exception as error:  # a defect in one must not lose the others
                yield name, f"{type(error).__name__}: {error}"
            else:
                yield name, keep(name, finding, chart, folder)
        elif kept is not None:
            yield name, kept


def write_report(found: Findings, folder: Path) -> list[Path]:
    """Write what was found as Markdown and as one HTML page that needs nothing from anywhere."""
    written = [folder / "stability.md", folder / "report.html"]
    write_atomically(written[0], markdown(found).encode())
    write_atomically(written[1], html(found).encode())
    return written


def summary(found: Findings) -> Sheet:
    """Experiment by experiment: where the method may be trusted, and what a user gets beyond."""
    heads = ("experiment", "what is driven", "edges", "may be trusted where", "beyond it you get")
    rows = [(name, kept.title, _agreement(kept.edges), kept.trust, kept.beyond) for name, kept in found.kept.items()]
    return Sheet("Where each method may be trusted", heads, rows)


def markdown(found: Findings) -> str:
    """The report in Markdown, charts beside it."""
    parts = ["# Where the methods fail", "", summary(found).markdown()]
    for name, kept in found.kept.items():
        parts += [f"## {kept.title}", "", f"![{kept.title}]({kept.chart.name})", ""]
        parts += [sheet.markdown() for sheet in _sheets(kept)]
        parts += [f"May be trusted where: {kept.trust}", "", f"Beyond: {kept.beyond}", ""]
        parts += [f"(`runningbond stability {name}`)", ""]
    parts += [f"{name} ended in an error: {words}\n" for name, words in found.broken.items()]
    return "\n".join(parts)


def html(found: Findings) -> str:
    """The report as a page."""
    parts = ["<h1>Where the methods fail</h1>", table_html(summary(found), wrapped=True)]
    for kept in found.kept.values():
        heading = Sheet(
            kept.title, ("", ""), [("may be trusted where", kept.trust), ("beyond it you get", kept.beyond)]
        )
        parts += [table_html(heading, wrapped=True), figure_html(kept.chart), *map(table_html, _sheets(kept))]
    return page_html("stability", parts)


def _sheets(kept: Kept) -> list[Sheet]:
    """Tables of one finding: what was run, and the edges."""
    runs = Sheet("Runs", kept.heads, [[_text(entry) for entry in row] for row in kept.rows])
    if not kept.edges:
        return [runs]
    heads = ("edge", "measured", "theory", "off by", "allowed")
    return [runs, Sheet("Edges", heads, [_edge_row(edge) for edge in kept.edges])]


def _edge_row(edge: Edge) -> list[str]:
    measured = f"{edge.measured:.6g}"
    if edge.theory is None or edge.error is None:
        return [edge.what, measured, "–", "–", "–"]
    allowed = "–" if edge.tolerance is None else f"{100 * edge.tolerance:.2g} %"
    off = f"{100 * edge.error:.2g} %" + ("" if edge.agrees is not False else ", does not agree")
    return [edge.what, measured, f"{edge.theory:.6g}", off, allowed]


def _agreement(edges: Sequence[Edge]) -> str:
    compared = [edge for edge in edges if edge.agrees is not None]
    if not compared:
        return f"{len(edges)} measured" if edges else "–"
    return f"{sum(bool(edge.agrees) for edge in compared)} of {len(compared)} as theory has them"


def _text(entry: Entry) -> str:
    return entry if isinstance(entry, str) else f"{entry:d}" if isinstance(entry, int) else f"{entry:.5g}"
