"""The page of one or more studies: Markdown with separate charts, and one self-contained HTML file."""

import html
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.figure import Figure

from runningbond.compare.page import figure_html, page_html, table_html
from runningbond.pictures.captions import to_png
from runningbond.pictures.charts import bare
from runningbond.pictures.sheet import Sheet
from runningbond.results import write_atomically

from .store import failures
from .study import Edge, Rows, Study

LONG = 30
"""Number of rows above which a table is folded."""


@dataclass(frozen=True)
class Picture:
    """A chart that has been drawn: its file and its caption."""

    path: Path
    caption: str


Block: TypeAlias = str | Picture | Sheet  # a heading or a paragraph in Markdown, a chart, or a table
Measured: TypeAlias = Sequence[tuple[Study, Rows]]  # experiments and their rows


def write_page(subject: str, blocks: Sequence[Block], folder: Path, name: str) -> list[Path]:
    """Write ``NAME.md`` and ``report.html``; returns the files of the page, including its charts."""
    written = [folder / f"{name}.md", folder / "report.html"]
    write_atomically(written[0], "\n".join(map(_markdown, blocks)).encode())
    heads = [block[3:] for block in blocks if isinstance(block, str) and block.startswith("## ")]
    contents = [(_identifier(head), head) for head in heads]
    write_atomically(written[1], page_html(subject, [_html(block) for block in blocks], contents).encode())
    return [*written, *(block.path for block in blocks if isinstance(block, Picture))]


def summary(measured: Measured) -> Sheet:
    """Table of all experiments: where the method may be trusted, and what a user gets beyond that."""
    heads = ("experiment", "what is driven", "edges", "may be trusted where", "beyond it you get")
    body = [(x.name, x.title, agreement(x.edges(rows)), x.trusted, x.beyond) for x, rows in _whole(measured)]
    return Sheet("Where each method may be trusted", heads, body)


def page(measured: Measured, folder: Path) -> list[Block]:
    """The page, with its charts drawn into a folder."""
    sections = [block for study, rows in _whole(measured) for block in section(study, rows, folder)]
    return ["# Where the methods fail", summary(measured), *sections, *failed(measured)]


def off(measured: Measured) -> list[str]:
    """Edges that do not agree with theory."""
    edges = [(study.name, edge) for study, rows in _whole(measured) for edge in study.edges(rows)]
    wrong = [(name, edge) for name, edge in edges if edge.agrees is False]
    return [f"{name}: {edge.what}: measured {edge.measured:.6g}, by theory {edge.theory:.6g}" for name, edge in wrong]


def failed(measured: Measured) -> list[str]:
    """Experiments that ended in an error, with its message."""
    return [f"{study.name} ended in an error: {words}" for study, rows in measured for words in failures(rows)]


def _whole(measured: Measured) -> Measured:
    return [(study, rows) for study, rows in measured if not failures(rows)]


def section(study: Study, rows: Rows, folder: Path) -> list[Block]:
    """The section of one experiment: where it may be trusted, its charts, its edges and its rows."""
    blocks: list[Block] = [f"## {study.title}", f"May be trusted: {study.trusted}", f"Beyond: {study.beyond}"]
    blocks += [*draw_charts(study, rows, folder), edges_sheet(study.edges(rows)), *study.tables(rows)]
    return [*blocks, f"`runningbond stability {study.name}` measures it."]


def draw_charts(study: Study, rows: Rows, folder: Path) -> list[Picture]:
    """Draw the charts of a study into a folder, if there are any rows."""
    pictures = []
    for chart in study.charts if any(rows.values()) else ():
        figure = Figure(figsize=chart.size, layout="constrained")
        figure.suptitle(chart.caption, fontsize=11)
        with rc_context({"legend.frameon": False, "legend.fontsize": 8}):
            chart.draw(figure, rows)
        pictures.append(write_picture(figure, folder / f"{chart.name or study.name}.png", chart.caption, dots=160))
    return pictures


def write_picture(figure: Figure, path: Path, caption: str, *, dots: int) -> Picture:
    """Write a chart, with a resolution of `dots` per inch and without frames around its axes."""
    for axes in figure.axes:
        bare(axes)
    write_atomically(path, to_png(figure, dots))
    return Picture(path, caption)


def edges_sheet(edges: Sequence[Edge]) -> Sheet:
    """Table of edges, with theory beside the measured values."""
    rows = []
    for edge in edges:
        cells = ["–"] * 3
        if edge.theory is not None and edge.error is not None:
            off_by = f"{100 * edge.error:.2g} %" + (", does not agree" if edge.agrees is False else "")
            cells = [f"{edge.theory:.6g}", off_by, "–" if edge.tolerance is None else f"{100 * edge.tolerance:.2g} %"]
        rows.append([edge.what, f"{edge.measured:.6g}", *cells])
    return Sheet("Edges", ("edge", "measured", "theory", "off by", "allowed"), rows)


def agreement(edges: Sequence[Edge]) -> str:
    """Number of edges that agree with theory, as text."""
    compared = [edge.agrees for edge in edges if edge.agrees is not None]
    return f"{sum(compared)} of {len(compared)} as theory has them" if compared else f"{len(edges)} measured"


def _markdown(block: Block) -> str:
    if isinstance(block, Sheet):
        return block.markdown()
    return f"![{block.caption}]({_link(block.path.name)})\n" if isinstance(block, Picture) else f"{block}\n"


def _link(name: str) -> str:
    """File name as a link target in Markdown."""
    return f"<{name}>" if set(name) & set(" ()") else name


def _html(block: Block) -> str:
    if isinstance(block, Sheet):
        wrapped = any(len(cell) > 60 for row in block.rows for cell in row)
        marked = replace(block, rows=[[Markup(_in_line(cell)) for cell in row] for row in block.rows])
        return table_html(marked, wrapped, folded=len(block.rows) > LONG)
    if isinstance(block, Picture):
        return figure_html(block.path, block.caption)
    text = _in_line(block.lstrip("#").strip())
    level = len(block) - len(block.lstrip("#"))
    mark = f' id="{_identifier(block[3:])}"' if level == 2 else ""
    return f"<h{level}{mark}>{text}</h{level}>" if level else f"<p>{text}</p>"


def _in_line(text: str) -> str:
    """Convert Markdown within a line to HTML."""
    text = html.escape(text, quote=False)
    for mark, tag in ((r"\*\*", "b"), (r"\*", "i"), ("`", "code")):
        text = re.sub(f"{mark}(.+?){mark}", rf"<{tag}>\1</{tag}>", text)
    return text


def _identifier(head: str) -> str:
    return re.sub(r"\W+", "-", head).strip("-").lower()
