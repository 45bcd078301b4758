"""The text around a drawing (title, load and bracket, colour key, scale) and the figure that holds both."""

import io
import math
import textwrap
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from runningbond.results.outcome import Outcome, number
from runningbond.scene import Scene

from .deformed_shape import DeformedShape, Extent, farthest_motion
from .joint_state import JointState
from .mechanism import mechanism_warning
from .quantities import signed
from .style import AT_REST, CRUSHED, DARK, DRAWN, FASTEST, HELD, SMALL_TYPE, STATE_COLOURS, STATE_NAMES, TYPE, Colouring

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, TALLEST, DPI = 3.5, 4.2, 300
"""Width of a picture (a journal column) and largest height of the wall in it [in], and dots per inch."""

LINE, KEY_LINE, NOTE_LINE, AIR = 0.14, 0.14, 0.105, 0.08
"""Heights of a title line, a key entry, a note or further line of an entry, and the margins above and below [in]."""

TITLE_LENGTH = 48
"""Characters per line of the title, which fit into the narrowest picture."""

FIVE_COLUMNS = 45
"""Letters in all entries of a key below which five of them fit side by side; otherwise at most three do."""

HANDLE, HANDLE_GAP, COLUMN_GAP = 1.5, 0.5, 1.0
"""Widths of a symbol in the key, and of the gaps after it and between columns, in font sizes."""


@dataclass(frozen=True)
class Caption:
    """The text around a drawing.

    Parameters
    ----------
    heading, subtitle
        Bold lines above the drawing, and one line below them; empty for none.
    notes
        Lines below the drawing and its key.
    key, columns
        Legend handles that explain colours and lines, and the number of columns of the legend; None for as many as fit.
    """

    heading: Sequence[str]
    subtitle: str
    notes: Sequence[str]
    key: Sequence[Any]
    columns: int | None = None

    @property
    def room(self) -> tuple[float, float]:
        """Heights above and below the drawing [in]."""
        above = LINE * (len(self.heading) + bool(self.subtitle))
        return above + AIR, self._key_height + NOTE_LINE * len(self.notes) + AIR

    @property
    def _key_height(self) -> float:
        labels = [handle.get_label() for handle in self.key]
        n = math.ceil(len(labels) / self._columns)
        more = sum(max(label.count("\n") for label in labels[k::n]) for k in range(n))
        return float(KEY_LINE * n + NOTE_LINE * more + 0.04)

    @property
    def _columns(self) -> int:
        letters = sum(len(handle.get_label()) for handle in self.key)
        # Drawn letters are a little wider, because they begin at whole pixels.
        room = 0.96 * 72 * WIDTH
        fitting = [n for n in (3, 2) if _key_width([handle.get_label() for handle in self.key], n) <= room]
        return self.columns or (5 if letters < FIVE_COLUMNS else next(iter(fitting), 1))

    def write(self, axes: "Axes") -> None:
        """Write the text above and below axes."""
        level = 0.04
        for text, weight in ((self.subtitle, "normal"), *((line, "bold") for line in reversed(self.heading))):
            if text:
                _write(axes, text, 1.0, level, va="bottom", fontsize=TYPE, fontweight=weight)
                level += LINE
        place: dict[str, Any] = {"bbox_to_anchor": (0.5, 0.0), "ncols": self._columns, "borderaxespad": 0.4}
        spacing = {"handlelength": HANDLE, "handletextpad": HANDLE_GAP, "columnspacing": COLUMN_GAP, "borderpad": 0.0}
        legend = place | spacing | {"frameon": False, "fontsize": SMALL_TYPE}
        axes.legend(handles=self.key, loc="upper center", **legend)
        _write(axes, "\n".join(self.notes), 0.0, -self._key_height, va="top", fontsize=SMALL_TYPE, color=DARK)


def _key_width(labels: Sequence[str], columns: int) -> float:
    """Width of a key [pt] whose entries are spread over columns, one column after the other."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=SMALL_TYPE)
    widths = [
        max(text_to_path.get_text_width_height_descent(line, font, ismath=False)[0] for line in label.split("\n"))
        for label in labels
    ]
    text = sum(float(max(part)) for part in np.array_split(widths, columns) if len(part))
    return text + SMALL_TYPE * (columns * (HANDLE + HANDLE_GAP) + (columns - 1) * COLUMN_GAP)


def _write(axes: "Axes", text: str, level: float, inches: float, **style: Any) -> None:
    """Write text centred on the width of axes, at a distance above their bottom (level 0) or top (level 1)."""
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    axes.annotate(text, (0.5, level), (0.0, 72 * inches), ha="center", parse_math=False, **place, **style)


def figure_with_room(
    extent: Extent, caption: Caption, enlarged: float = 1.0, make: "Callable[..., Figure] | None" = None
) -> "tuple[Figure, Axes]":
    """Make a figure of one drawing, enlarged from journal size, with room for its caption; `make` replaces `Figure`."""
    from matplotlib.figure import Figure

    left, right, bottom, top = extent
    above, below = caption.room
    height = enlarged * min(WIDTH * (top - bottom) / (right - left), TALLEST)
    total = height + above + below
    figure = (make or Figure)(figsize=(enlarged * WIDTH, total), dpi=DPI)
    return figure, figure.add_axes((0, below / total, 1, height / total))


def show_extent(axes: "Axes", extent: Extent) -> None:
    """Show a part of the plane in axes, with equal scales and without ticks."""
    left, right, bottom, top = extent
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.axis("off")


def load_symbol(scene: Scene) -> str:
    """Symbol of the multiplier: P if it is a force in newtons, else λ."""
    return "P" if is_force(scene) else "λ"


def is_force(scene: Scene) -> bool:
    """Whether λ is a force in newtons, because the live load consists of point forces with a resultant of 1 N."""
    live = scene.live_forces
    return live.at_points_alone and math.isclose(math.hypot(*live.force.sum(axis=0)), 1.0)


def load_text(scene: Scene, multiplier: float) -> str:
    """Format a multiplier, in newtons if it is a force."""
    return f"{load_symbol(scene)} = {number(multiplier)}{' N' if is_force(scene) else ''}"


def multiplier_text(scene: Scene, outcome: Outcome) -> tuple[str, str]:
    """Load at collapse, or else the status, and the bracket or bounds; these are empty if they add nothing."""
    name, unit = load_symbol(scene), " N" if is_force(scene) else ""
    low, high = (None if x is None else signed(number(x)) for x in (outcome.lower, outcome.upper))
    if outcome.status != "collapse" or outcome.multiplier is None:
        bounds = [f"{name} ≥ {low}{unit}"] * (low is not None) + [f"{name} ≤ {high}{unit}"] * (high is not None)
        return outcome.status, ", ".join(bounds)
    bracket = "" if low is None or high is None or low == high else f"[{low}, {high}]{unit}"
    return f"{name} = {signed(number(outcome.multiplier))}{unit}", bracket


def mechanism_caption(
    scene: Scene, outcome: Outcome, key: Sequence[Any], shape: DeformedShape | None, load: str = ""
) -> Caption:
    """Caption with title, load, bracket, drawn size of the mechanism, and a warning if something is wrong with it.

    `shape` is that of `mechanism_shape`, or None if the undeformed wall is drawn. `load` replaces the line of model,
    load and bracket.
    """
    title = wall_title(outcome.scene)
    load = load or f"{outcome.model}: {'  '.join(multiplier_text(scene, outcome)).strip()}"
    warning = mechanism_warning(scene, outcome)
    if shape is None:
        return Caption(title, load, [warning or "no mechanism"], [])
    key = [*key, *held_key(scene)]
    what = "shape in the fall; the farthest corner" if scene.history else "mechanism; its fastest corner"
    if outcome.status == "infeasible":
        what = "under dead load; its fastest corner"
    moves = DRAWN * scene.size
    if outcome.moved is not None:
        what, moves = "deformed shape; its farthest corner", shape.scale * farthest_motion(shape.displacement)
    size = f"{what} is drawn to move {moves:.2g} m"
    return Caption(title, load, [size, warning] if warning else [size], key)


def wall_title(title: str) -> list[str]:
    """Split a wall's title into lines that fit the width of a figure."""
    return textwrap.wrap(title, TITLE_LENGTH) or [""]


def colour_key(
    states: Sequence[JointState] = tuple(STATE_COLOURS),
    colouring: Colouring = "displacement",
    dashes: Mapping[JointState, Any] | None = None,
    crushes: bool = False,
) -> list[Any]:
    """Legend handles that explain the colours of a picture and the dashes of its lines."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    styles = dashes or dict.fromkeys(STATE_COLOURS, "solid")
    lines = [Line2D([], [], color=STATE_COLOURS[x], ls=styles[x], lw=1.5, label=STATE_NAMES[x]) for x in states]
    if crushes:
        style: dict[str, Any] = {"marker": "X", "ms": 4, "mfc": CRUSHED, "mec": "white", "mew": 0.3}
        lines.append(Line2D([], [], ls="none", label=STATE_NAMES[JointState.CRUSHED], **style))
    if colouring == "course":
        return lines
    ends = ((AT_REST, "block at rest"), (FASTEST, "block that moves most"))
    return [*lines, *(Patch(facecolor=colour, edgecolor="0.5", lw=0.5, label=label) for colour, label in ends)]


def held_key(scene: Scene) -> list[Any]:
    """Legend handle for held blocks of the wall, if there are any."""
    from matplotlib.patches import Patch

    return [Patch(facecolor=HELD, edgecolor="0.5", lw=0.5, label="held block")] if scene.fixed[scene.wall].any() else []


def to_png(figure: "Figure", dpi: float = DPI) -> bytes:
    """A figure as the content of a PNG file."""
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph", UserWarning)  # characters that the font lacks are drawn as boxes
        figure.savefig(buffer, format="png", dpi=dpi)
    return buffer.getvalue()


def to_svg(figure: "Figure") -> bytes:
    """A figure as the content of an SVG file, identical for identical figures."""
    import matplotlib

    buffer = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "runningbond"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()
