"""The words around a drawing, and the figure that holds them: title, load and bracket, key to colours, and scale."""

import io
import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from runningbond.results.outcome import Outcome, number
from runningbond.scene import PointLoad, Scene

from .deformed_shape import DeformedShape, Extent, wall_size
from .joint_state import JointState
from .style import AT_REST, DARK, DRAWN, FASTEST, SMALL_TYPE, STATE_COLOURS, STATE_NAMES, TYPE, Colouring

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, TALLEST, DPI = 3.5, 4.2, 300
"""Width of a picture, that of a journal's column, largest height of the wall in it [in], and dots per inch."""

LINE, FOOT = 0.14, 0.36
"""Height of a line of the title, and room for the key and a note below a drawing [in]."""


def load_symbol(scene: Scene) -> str:
    """What the multiplier is called: P where it is a force in newtons."""
    return "P" if is_force(scene) else "λ"


def is_force(scene: Scene) -> bool:
    """Whether λ is a force in newtons: that of a point load of one newton."""
    live = scene.load.live
    return isinstance(live, PointLoad) and math.isclose(math.hypot(*live.force), 1.0)


def multiplier_text(scene: Scene, outcome: Outcome) -> tuple[str, str]:
    """Load at collapse, or what there is instead, and its bracket; empty where that adds nothing."""
    name, unit = load_symbol(scene), " N" if is_force(scene) else ""
    low, high = (None if x is None else number(x) for x in (outcome.lower, outcome.upper))
    if outcome.status != "collapse" or outcome.multiplier is None:
        bounds = [f"{name} ≥ {low}{unit}"] * (low is not None) + [f"{name} ≤ {high}{unit}"] * (high is not None)
        return outcome.status, ", ".join(bounds)
    bracket = "" if low is None or high is None or low == high else f"[{low}, {high}]{unit}"
    return f"{name} = {number(outcome.multiplier)}{unit}", bracket


def outcome_title(scene: Scene, outcome: Outcome) -> list[str]:
    """Lines of a title: the wall, and the load that a model found."""
    return [*_wrapped(outcome.scene), f"{outcome.model}: {'  '.join(multiplier_text(scene, outcome)).strip()}"]


def frame_title(shape: DeformedShape, outcome: Outcome) -> list[str]:
    """Lines of a title: the wall, and the load at one moment of a run."""
    load = f"{load_symbol(shape.scene)} = {number(shape.multiplier)}"
    return [*_wrapped(outcome.scene), f"{outcome.model}: {load}"]


def _wrapped(title: str) -> list[str]:
    return textwrap.wrap(title, 62) or [""]


def mechanism_note(scene: Scene) -> str:
    """How large a mechanism is drawn."""
    return f"mechanism; the fastest corner is drawn to move {DRAWN * wall_size(scene):.2g} m"


def colour_key(states: Sequence[JointState] = tuple(STATE_COLOURS), colouring: Colouring = "displacement") -> list[Any]:
    """What the colours of a picture stand for, for a legend."""
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=STATE_COLOURS[state], lw=1.6, label=STATE_NAMES[state]) for state in states]
    return lines if colouring == "course" else [*lines, *motion_key()]


def motion_key() -> list[Any]:
    """What the colours of blocks stand for, for a legend."""
    from matplotlib.patches import Patch

    ends = ((AT_REST, "block at rest"), (FASTEST, "fastest block"))
    return [Patch(facecolor=colour, edgecolor="0.5", lw=0.5, label=label) for colour, label in ends]


def figure_with_room(extent: Extent, lines: int) -> "tuple[Figure, Axes]":
    """A figure of one drawing, with room for a title of some lines above and a caption below."""
    from matplotlib.figure import Figure

    left, right, bottom, top = extent
    height = min(WIDTH * (top - bottom) / (right - left), TALLEST)
    total = height + LINE * lines + 0.1 + FOOT
    figure = Figure(figsize=(WIDTH, total), dpi=DPI)
    return figure, figure.add_axes((0, FOOT / total, 1, height / total))


def caption(axes: "Axes", title: Sequence[str], note: str, key: Sequence[Any]) -> None:
    """Write a title above a drawing, its wall in bold, and a key and a note below."""
    points = 72 * LINE
    for line, text in enumerate(reversed(title)):
        bold = {"fontweight": "bold"} if line > 0 or len(title) == 1 else {}
        _write(axes, text, 1.0, 3 + line * points, "bottom", TYPE, **bold)
    axes.legend(
        handles=list(key),
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        ncols=5,
        frameon=False,
        fontsize=SMALL_TYPE,
        handlelength=1.5,
        handletextpad=0.5,
        columnspacing=1.0,
        borderpad=0.0,
        borderaxespad=0.3,
    )
    _write(axes, note, 0.0, -14, "top", SMALL_TYPE, color=DARK)


def _write(
    axes: "Axes", text: str, level: float, points: float, va: Literal["top", "bottom"], size: float, **style: Any
) -> None:
    """Text in the middle of a drawing's width, so many points above its bottom (0) or top (1)."""
    middle: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    axes.annotate(text, (0.5, level), (0.0, points), ha="center", va=va, fontsize=size, **middle, **style)


def frame_axes(axes: "Axes", extent: Extent) -> None:
    """Show a part of the plane, at one scale both ways and without ticks."""
    left, right, bottom, top = extent
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.axis("off")


def to_png(figure: "Figure", dpi: float = DPI) -> bytes:
    """A figure as the content of a PNG file."""
    return _saved(figure, format="png", dpi=dpi)


def to_svg(figure: "Figure") -> bytes:
    """A figure as the content of an SVG file, the same for the same figure."""
    import matplotlib

    with matplotlib.rc_context({"svg.hashsalt": "runningbond", "svg.fonttype": "path"}):
        return _saved(figure, format="svg", metadata={"Date": None})


def _saved(figure: "Figure", **options: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, **options)
    return buffer.getvalue()
