"""The page of one or more studies, in Markdown beside its charts and as one HTML file that needs nothing else."""

import html
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from matplotlib.figure import Figure

from runningbond.compare.figures import bare
from runningbond.compare.report import figure_html, page_html, table_html
from runningbond.compare.table import Sheet
from runningbond.pictures.captions import to_png
from runningbond.results import write_atomically

from .store import failures
from .study import Chart, Edge, Rows, Study


@dataclass(frozen=True)
class Picture:
    """A chart that is drawn: its file and what it shows."""

    path: Path
    caption: str


Block: TypeAlias = str | Picture | Sheet  # a heading or a paragraph in Markdown, a chart, or a table
Measured: TypeAlias = Sequence[tuple[Study, Rows]]  # experiments and their rows


def write_page(subject: str, blocks: Sequence[Block], folder: Path, name: str) -> list[Path]:
    """Write ``NAME.md`` and ``report.html``; returns the files of the page, its charts among them."""
    written = [folder / f"{name}.md", folder / "report.html"]
    write_atomically(written[0], "\n".join(map(_markdown, blocks)).encode())
    write_atomically(written[1], page_html(subject, [_html(block) for block in blocks]).encode())
    return [*written, *(block.path for block in blocks if isinstance(block, Picture))]


def summary(measured: Measured) -> Sheet:
    """Experiment by experiment: where the method may be trusted, and what a user gets beyond."""
    heads = ("experiment", "what is driven", "edges", "may be trusted where", "beyond it you get")
    sound = [(study, rows) for study, rows in measured if not failures(rows)]
    body = [(one.name, one.title, agreement(one.edges(rows)), one.trusted, one.beyond) for one, rows in sound]
    return Sheet("Where each method may be trusted", heads, body)


def page(measured: Measured, folder: Path) -> list[Block]:
    """The page; charts are drawn into a folder."""
    sections = [block for study, rows in measured if not failures(rows) for block in section(study, rows, folder)]
    return ["# Where the methods fail", summary(measured), *sections, *failed(measured)]


def off(measured: Measured) -> list[str]:
    """Edges that do not lie where theory has them."""
    edges = [(study.name, edge) for study, rows in measured if not failures(rows) for edge in study.edges(rows)]
    wrong = [(name, edge) for name, edge in edges if edge.agrees is False]
    return [f"{name}: {edge.what}: measured {edge.measured:.6g}, by theory {edge.theory:.6g}" for name, edge in wrong]


def failed(measured: Measured) -> list[str]:
    """Experiments that ended in an error, and its words."""
    return [f"{study.name} ended in an error: {words}" for study, rows in measured for words in failures(rows)]


def section(study: Study, rows: Rows, folder: Path) -> list[Block]:
    """An experiment on the page of all: where it may be trusted, its charts, its edges and its rows."""
    blocks: list[Block] = [f"## {study.title}", f"May be trusted: {study.trusted}", f"Beyond: {study.beyond}"]
    blocks += [*draw_charts(study, rows, folder), edges_sheet(study.edges(rows)), *study.tables(rows)]
    return [*blocks, f"`runningbond stability {study.name}` measures it."]


def draw_charts(study: Study, rows: Rows, folder: Path) -> list[Block]:
    """Draw the charts of a study into a folder."""
    return [Picture(draw(chart, rows, folder), chart.caption) for chart in study.charts if any(rows.values())]


def draw(chart: Chart, rows: Rows, folder: Path) -> Path:
    """Draw a chart into a folder."""
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    figure.suptitle(chart.caption, fontsize=11)
    chart.draw(figure, rows)
    for axes in figure.axes:
        bare(axes)
    path = folder / f"{chart.name}.png"
    write_atomically(path, to_png(figure, 160))
    return path


def edges_sheet(edges: Sequence[Edge]) -> Sheet:
    """Edges, theory beside what was measured."""
    return Sheet("Edges", ("edge", "measured", "theory", "off by", "allowed"), [_edge_row(edge) for edge in edges])


def _edge_row(edge: Edge) -> list[str]:
    measured = f"{edge.measured:.6g}"
    if edge.theory is None or edge.error is None:
        return [edge.what, measured, "–", "–", "–"]
    allowed = "–" if edge.tolerance is None else f"{100 * edge.tolerance:.2g} %"
    off = f"{100 * edge.error:.2g} %" + ("" if edge.agrees is not False else ", does not agree")
    return [edge.what, measured, f"{edge.theory:.6g}", off, allowed]


def agreement(edges: Sequence[Edge]) -> str:
    """How many edges lie where theory has them."""
    compared = [edge.agrees for edge in edges if edge.agrees is not None]
    return f"{sum(compared)} of {len(compared)} as theory has them" if compared else f"{len(edges)} measured"


def _markdown(block: Block) -> str:
    if isinstance(block, Sheet):
        return block.markdown()
    return f"![{block.caption}]({block.path.name})\n" if isinstance(block, Picture) else f"{block}\n"


def _html(block: Block) -> str:
    if isinstance(block, Sheet):
        return table_html(block, wrapped=any(len(cell) > 60 for row in block.rows for cell in row))
    if isinstance(block, Picture):
        return f"{figure_html(block.path)}<p>{html.escape(block.caption)}</p>"
    level = len(block) - len(block.lstrip("#"))
    text = _inline(block[level:].strip())
    return f"<h{level}>{text}</h{level}>" if level else f"<p>{text}</p>"


def _inline(text: str) -> str:
    """Markdown's bold, emphasis and code within a line, in HTML."""
    text = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", html.escape(text, quote=False))
    text = re.sub(r"\*(.+?)\*", r"<i>\1</i>", text)
    return re.sub(r"`(.+?)`", r"<code>\1</code>", text)
