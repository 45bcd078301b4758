"""Self-contained HTML pages, without external files, filled in from the templates beside this file."""

import base64
import io
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib
from jinja2 import Environment, PackageLoader
from markupsafe import Markup
from matplotlib.figure import Figure

from runningbond.pictures.sheet import Sheet


@cache
def templates() -> Environment:
    """Page templates, which escape the text that is filled in."""
    return Environment(loader=PackageLoader("runningbond.compare"), autoescape=True, trim_blocks=True)


def page_html(subject: str, parts: Sequence[str], contents: Sequence[tuple[str, str]] = ()) -> str:
    """Assemble a page from parts; `contents` lists identifiers of headings and their entries in the contents."""
    marked = [Markup(part) for part in parts]
    return templates().get_template("page.html").render(subject=subject, parts=marked, contents=contents)


def table_html(sheet: Sheet, wrapped: bool = False, folded: bool = False) -> str:
    """A table below its title; `wrapped` if its cells hold sentences, `folded` if it opens by a click."""
    parts: Any = templates().get_template("parts.html").module
    return str(parts.table(sheet, wrapped, folded))


def figure_html(path: Path, caption: str) -> str:
    """A PNG file, embedded in the page, above its caption."""
    data = base64.b64encode(path.read_bytes()).decode()
    image = '<figure><img alt="{1}" src="data:image/png;base64,{0}"><figcaption>{1}</figcaption></figure>'
    return str(Markup(image).format(data, caption))


def inline_svg(figure: Figure, title: str) -> Markup:
    """A chart as an ``svg`` element: text as text, long paths rounded to 0.1 point, no identifiers of groups."""
    buffer = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": title}):
        figure.savefig(buffer, format="svg", metadata={"Date": None}, transparent=True)
    svg = buffer.getvalue()
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg[svg.index("<svg") :], flags=re.DOTALL)
    svg = re.sub(r'<g id="[^"]*">', "<g>", svg)
    svg = re.sub(r' xmlns(:xlink)?="[^"]*"|<!DOCTYPE[^>]*>', "", svg).replace("xlink:href", "href")
    svg = re.sub(r' d="[^"]{400,}"', lambda path: re.sub(r"(\.\d)\d+", r"\1", path[0]), svg)
    svg = re.sub(r"\s*\n\s*", " ", svg)
    name = Markup('<svg class="chart" role="img" aria-label="{}"').format(title)
    return Markup(svg.replace("<svg", str(name), 1))
