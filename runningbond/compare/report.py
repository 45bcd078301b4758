"""The report of a comparison: one HTML page that holds everything, and needs nothing from anywhere."""

import base64
import html
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from .fingerprint import LIBRARIES, code_digest
from .table import Comparison, Sheet, cost_sheets, multiplier_sheets

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.25rem 0.6rem; text-align: left; border-bottom: 1px solid #ddd; white-space: nowrap; }
.wrapped th, .wrapped td { white-space: normal; vertical-align: top; }
th { border-bottom: 2px solid #888; }
figure { margin: 1.5rem 0; } img { max-width: 100%; height: auto; } figcaption { color: #555; font-size: 0.85rem; }
"""
HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>runningbond: {subject}</title>
<style>{style}</style>
</head>
<body>
"""


def report_html(comparison: Comparison, pictures: Sequence[Path], tolerance: float, why_no_plates: str = "") -> str:
    """Write the page, with the PNG files of charts and plates in their order, or why there are no plates."""
    versions = [
        ("models", ", ".join(model.name for model in comparison.models)),
        ("tolerance", f"{tolerance:g}"),
        ("written", datetime.now(UTC).isoformat(timespec="seconds")),
        ("runningbond", f"{version('runningbond')}, sources {code_digest()[:16]}"),
        ("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}"),
        *((name, version(name)) for name in (*LIBRARIES, "pyvista", "vtk", "matplotlib")),
    ]
    parts = [
        "<h1>Masonry walls from their description to their collapse</h1>",
        f"<p>{len(comparison.campaign)} cases: {len(comparison.scenes)} walls by {len(comparison.models)} models.</p>",
        "<h2>Collapse multipliers</h2>",
        *map(table_html, multiplier_sheets(comparison)),
        "<h2>Charts and mechanisms</h2>",
        *([f"<p>{html.escape(why_no_plates)}</p>"] if why_no_plates else []),
        *map(figure_html, pictures),
        "<h2>Cost</h2>",
        *map(table_html, cost_sheets(comparison)),
        "<h2>What was run</h2>",
        table_html(Sheet("Versions", ("what", "which"), versions)),
    ]
    return page_html("comparison", parts)


def page_html(subject: str, parts: Sequence[str]) -> str:
    """One page of parts, which needs nothing from anywhere."""
    return HEAD.format(subject=subject, style=STYLE) + "\n".join([*parts, "</body>\n</html>\n"])


def table_html(sheet: Sheet, wrapped: bool = False) -> str:
    """A table under its title; its cells hold sentences where it is `wrapped`."""
    heads = "".join(f"<th>{html.escape(head)}</th>" for head in sheet.heads)
    rows = "\n".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in sheet.rows)
    title = html.escape(sheet.title)
    kind = ' class="wrapped"' if wrapped else ""
    return (
        f'<h3>{title}</h3>\n<div class="wide"><table{kind} data-title="{title}">\n<thead><tr>{heads}</tr></thead>\n'
        f"<tbody>\n{rows}\n</tbody>\n</table></div>"
    )


def figure_html(path: Path) -> str:
    """A PNG file, in the page itself."""
    data = base64.b64encode(path.read_bytes()).decode()
    name = html.escape(path.stem)
    return f'<figure><img alt="{name}" src="data:image/png;base64,{data}"><figcaption>{name}.png</figcaption></figure>'
