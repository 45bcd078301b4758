"""Stand-in for what writes figures, until it is here."""

import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def to_svg(figure: "Figure") -> bytes:
    """A figure as the content of an SVG file."""
    return _written(figure, "svg")


def to_png(figure: "Figure") -> bytes:
    """A figure as the content of a PNG file."""
    return _written(figure, "png")


def _written(figure: "Figure", kind: str) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind)
    return buffer.getvalue()
