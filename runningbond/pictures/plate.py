"""A plate: mechanisms side by side, one row per wall."""

import textwrap
from collections.abc import Sequence
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .captions import show_extent, to_png
from .deformed_shape import DeformedShape, Extent, common_extent
from .flat import line_width, mechanism_key, paint_mechanism

WIDTH, NARROWEST, TALLEST, DPI = 7.2, 5.4, 9.6, 250  # plate: width of a page, least width, height [in]; dots per inch
TITLES, LINE = 0.85, 0.11  # height of title and legend together, and of a caption line under a wall [in]
LETTER, GAP = 0.06, 0.1  # width of a character, and of the gap between walls [in]
LOWEST, HIGHEST = 0.3, 3.0  # limits of a row's height over the width of its walls: labels fit, and other rows have room


class PlateRow(NamedTuple):
    """One wall: its label, its shape in each column, and the caption under each shape."""

    label: str
    shapes: Sequence[DeformedShape]
    captions: Sequence[str]


def draw_plate(title: str, columns: Sequence[str], rows: Sequence[PlateRow]) -> bytes:
    """Draw a plate as the content of a PNG file."""
    return to_png(plate_figure(title, columns, rows), DPI)


def plate_figure(title: str, columns: Sequence[str], rows: Sequence[PlateRow]) -> Figure:
    """Make the figure of a plate; the extent of each row contains all of its shapes."""
    extents = [_with_air(common_extent(row.shapes)) for row in rows]
    below = LINE * max(2, *(text.count("\n") + 1 for row in rows for text in row.captions)) + 0.08
    ratios = [(top - bottom) / (right - left) for left, right, bottom, top in extents]
    room = TALLEST - TITLES - below * len(rows)
    labels = [textwrap.wrap(row.label, 16) or [""] for row in rows]
    side = 0.1 + LETTER * max(len(line) for label in labels for line in label)
    width = min((WIDTH - side) / max(len(columns), 3) - GAP, room / sum(ratios))
    total = max(NARROWEST, side + (width + GAP) * len(columns))
    figure = Figure((total, TALLEST - room + sum(ratios) * width), DPI, layout="constrained")
    figure.suptitle(title, fontsize=8, fontweight="bold")
    grid = figure.subplots(len(rows), len(columns), squeeze=False, height_ratios=ratios)
    for axes, column in zip(grid[0], columns, strict=True):
        axes.set_title(column, fontsize=8)
    for line, row, extent, label, ratio in zip(grid, rows, extents, labels, ratios, strict=True):
        _write(line[0], -0.04, 0.5, "\n".join(label), ha="right", va="center", fontsize=7.5)
        for axes, shape, caption in zip(line, row.shapes, row.captions, strict=True):
            show_extent(axes, extent)
            paint_mechanism(axes, shape, line_width(shape.scene, extent, (width, ratio * width)))
            _write(axes, 0.5, -0.02, caption, ha="center", va="top", fontsize=6.3)
    handles = mechanism_key([shape for row in rows for shape in row.shapes])
    looks = {"ncols": len(handles), "frameon": False, "fontsize": 7, "handlelength": 1.6}
    figure.legend(handles=handles, loc="outside lower center", **looks)
    return figure


def _with_air(extent: Extent) -> Extent:
    """Enlarge an extent so that its row is neither too low nor too high."""
    left, right, bottom, top = extent
    width, height = right - left, top - bottom
    aside, above = max(0.0, height / HIGHEST - width) / 2, max(0.0, LOWEST * width - height) / 2
    return left - aside, right + aside, bottom - above, top + above


def _write(axes: Axes, x: float, y: float, text: str, **style: Any) -> None:
    """Write text at fractions of the width and height of axes."""
    axes.text(x, y, text, transform=axes.transAxes, parse_math=False, **style)
