"""The study on one page: conclusions, charts and tables, in Markdown beside its charts and in HTML by itself."""

import html
import re
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from fem_interface.modes import BENDING
from runningbond.compare.report import figure_html, page_html, table_html
from runningbond.compare.table import Sheet
from runningbond.results import write_atomically

from .cases import all_cases
from .charts import draw_charts
from .conclusions import conclusions
from .findings import sheets
from .measure import CHEAP, LONGEST, REFERENCE, RUNS
from .rows import FAILED, Row
from .study import TABLE
from .walls import INSET

CAPTIONS = {
    "accuracy-seconds": "Error against processor seconds; homog, which costs nothing, is left out",
    "accuracy-freedoms": "Error against degrees of freedom; models with as many stand side by side",
    "accuracy-growth": "Growth of cost with the number of blocks",
    "accuracy-stiffness": "What a physical second costs where blocks are ever stiffer",
}

HOW = (
    "Walls with an exact answer are a block that topples, one that slides and a stack, λ = min(tan φ, b / (n h)); a "
    "block that has turned by θ, λ = tan(α − θ); and periodic cells. W1 – W3 of Ferris & Tin-Loi have their contacts "
    f"{1e3 * INSET:g} mm in from the ends of the joints, with which λ is unique, and are published to four digits. Of "
    "the panels the answer is the interval of loads that `limit-nonassociated` certifies in this study: the error is "
    "the distance from it, and zero inside, where nothing can be said against any load; smaller loads are not "
    "excluded. A model is not judged by its own certificates.",
    "The error is that of the multiplier which a model reports: the middle of a bracket of `dem-dynamic` and `fem`, "
    "the lower end of one of `limit-nonassociated` and `dem-static`. A knob is turned alone: without, `fem` has two "
    f"Lobatto points a joint element, one cell in half a block, {BENDING} modes and scaled masses, brackets are 1 % "
    "wide, and loads are held until the wall rests or falls. *Driven* walls are pushed at a prescribed work-conjugate "
    "speed instead, in so many time steps over a twentieth of a block if all of it moved as far, and λ is the largest "
    "on the way.",
    "Every case runs in a process of its own, on one thread, after an untimed run that loads the kernels: "
    f"{RUNS} times, or once if it takes more than {CHEAP:g} s; seconds are medians, of the processor. Ratios are to "
    f"`{REFERENCE}` on the same wall, run in turn in the same process. A run that would take more than {LONGEST} s is "
    "broken off and left out.",
)
"""How the study is made, for its reader."""


def write_page(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the charts and write ``study.md`` and ``report.html``; returns everything that was written."""
    charts = draw_charts(rows, folder)
    write_atomically(folder / "study.md", markdown(rows, charts).encode())
    write_atomically(folder / "report.html", report(rows, charts).encode())
    return [folder / "study.md", folder / "report.html", *charts]


def markdown(rows: Sequence[Row], charts: Sequence[Path]) -> str:
    """The page in Markdown; charts lie beside it."""
    parts = [
        "# Speed against accuracy",
        "",
        "What `runningbond study` printed.",
        "",
        *_paragraphs(HOW),
        "## What it says",
        "",
    ]
    parts += [f"- {sentence}" for sentence in conclusions(rows)]
    parts += ["", f"Measured on {_where(rows)}{_failures(rows)}", ""]
    parts += ["## Charts", ""]
    for chart in charts:
        parts += [f"![{CAPTIONS[chart.stem]}]({chart.name})", ""]
    parts += ["## Tables", "", *(sheet.markdown() for sheet in sheets(rows))]
    parts += [f"Every run, with the spread of its seconds, is a row of `{TABLE}`.", ""]
    return "\n".join(parts)


def report(rows: Sequence[Row], charts: Sequence[Path]) -> str:
    """The page in HTML, whole in one file."""
    parts = ["<h1>Speed against accuracy</h1>", *(f"<p>{_inline(text)}</p>" for text in HOW)]
    parts += ["<h2>What it says</h2>", "<ul>"]
    parts += [f"<li>{_inline(sentence)}</li>" for sentence in conclusions(rows)]
    parts += ["</ul>", f"<p>Measured on {_inline(_where(rows) + _failures(rows))}</p>"]
    parts += ["<h2>Charts</h2>", *map(figure_html, charts), "<h2>Tables</h2>", *map(table_html, sheets(rows))]
    return page_html("speed against accuracy", [*parts, "<h2>Every run</h2>", table_html(_everything(rows))])


def _paragraphs(texts: Sequence[str]) -> list[str]:
    return [line for text in texts for line in (text, "")]


def _where(rows: Sequence[Row]) -> str:
    measured = f"{len(rows)} of {len(all_cases())} cases"
    return f"{'; '.join(sorted({row.machine for row in rows}))}: {measured}."


def _failures(rows: Sequence[Row]) -> str:
    failed = [f"{row.case}: {row.message}" for row in rows if row.status == FAILED]
    return f" Failed: {'; '.join(failed)}." if failed else ""


def _inline(text: str) -> str:
    """Markdown's bold, emphasis and code within a line, in HTML."""
    text = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", html.escape(text, quote=False))
    text = re.sub(r"\*(.+?)\*", r"<i>\1</i>", text)
    return re.sub(r"`(.+?)`", r"<code>\1</code>", text)


def _everything(rows: Sequence[Row]) -> Sheet:
    heads = [entry.name for entry in fields(Row) if entry.name not in ("machine", "key", "message")]
    return Sheet("study.csv", heads, [[_cell(getattr(row, head)) for head in heads] for row in rows])


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
