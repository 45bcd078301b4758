"""The words around a drawing, and the figure that holds them: title, load and bracket, key to colours, and scale."""

import io
import math
import textwrap
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from runningbond.results.outcome import Outcome, number
from runningbond.scene import Scene

from .deformed_shape import Extent
from .joint_state import JointState
from .mechanism import mechanism_warning
from .quantities import signed
from .style import AT_REST, CRUSHED, DARK, DRAWN, FASTEST, HELD, SMALL_TYPE, STATE_COLOURS, STATE_NAMES, TYPE, Colouring

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, TALLEST, DPI = 3.5, 4.2, 300
"""Width of a picture, that of a journal's column, largest height of the wall in it [in], and dots per inch."""

LINE, KEY_LINE, NOTE_LINE, AIR = 0.14, 0.14, 0.105, 0.08
"""Heights of a line of the title, of an entry of the key, of a line more, and of the air above and below [in]."""

TITLE = 48
"""Letters in a line of the title, which the narrowest of pictures has room for."""


@dataclass(frozen=True)
class Caption:
    """The words around a drawing.

    Parameters
    ----------
    heading, subtitle
        Lines in bold above the drawing, and a line below them; empty for none.
    notes
        Lines below the drawing and its key.
    key, columns
        What colours and lines stand for, handles of a legend, and in how many columns.
    """

    heading: Sequence[str]
    subtitle: str
    notes: Sequence[str]
    key: Sequence[Any]
    columns: int = 5

    @property
    def room(self) -> tuple[float, float]:
        """Heights above and below the drawing [in]."""
        above = LINE * (len(self.heading) + bool(self.subtitle))
        return above + AIR, self._key_height + NOTE_LINE * len(self.notes) + AIR

    @property
    def _key_height(self) -> float:
        labels = [handle.get_label() for handle in self.key]
        n = math.ceil(len(labels) / self.columns)
        more = sum(max(label.count("\n") for label in labels[k::n]) for k in range(n))
        return float(KEY_LINE * n + NOTE_LINE * more + 0.04)

    def write(self, axes: "Axes") -> None:
        """Write the words above and below some axes."""
        level = 0.04
        for text, weight in ((self.subtitle, "normal"), *((line, "bold") for line in reversed(self.heading))):
            if text:
                _write(axes, text, 1.0, level, va="bottom", fontsize=TYPE, fontweight=weight)
                level += LINE
        place: dict[str, Any] = {"bbox_to_anchor": (0.5, 0.0), "ncols": self.columns, "borderaxespad": 0.4}
        spacing = {"handlelength": 1.5, "handletextpad": 0.5, "columnspacing": 1.0, "borderpad": 0.0}
        legend = place | spacing | {"frameon": False, "fontsize": SMALL_TYPE}
        axes.legend(handles=self.key, loc="upper center", **legend)
        _write(axes, "\n".join(self.notes), 0.0, -self._key_height, va="top", fontsize=SMALL_TYPE, color=DARK)


def _write(axes: "Axes", text: str, level: float, inches: float, **style: Any) -> None:
    """Text in the middle of the width of axes, so far above their bottom (0) or top (1)."""
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False}
    axes.annotate(text, (0.5, level), (0.0, 72 * inches), ha="center", parse_math=False, **place, **style)


def figure_with_room(
    extent: Extent, caption: Caption, enlarged: float = 1.0, make: "Callable[..., Figure] | None" = None
) -> "tuple[Figure, Axes]":
    """A figure of one drawing, so many times as large as a journal's, with room for its caption; `make` makes it."""
    from matplotlib.figure import Figure

    left, right, bottom, top = extent
    above, below = caption.room
    height = enlarged * min(WIDTH * (top - bottom) / (right - left), TALLEST)
    total = height + above + below
    figure = (make or Figure)(figsize=(enlarged * WIDTH, total), dpi=DPI)
    return figure, figure.add_axes((0, below / total, 1, height / total))


def show_extent(axes: "Axes", extent: Extent) -> None:
    """Show a part of the plane in some axes, at one scale both ways and without ticks."""
    left, right, bottom, top = extent
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.axis("off")


def load_symbol(scene: Scene) -> str:
    """What the multiplier is called: P where it is a force in newtons."""
    return "P" if is_force(scene) else "λ"


def is_force(scene: Scene) -> bool:
    """Whether λ is a force in newtons: that of a point load of one newton."""
    live = scene.live_forces
    return live.at_points_alone and math.isclose(math.hypot(*live.force.sum(axis=0)), 1.0)


def load_text(scene: Scene, multiplier: float) -> str:
    """A multiplier, in newtons where it is a force."""
    return f"{load_symbol(scene)} = {number(multiplier)}{' N' if is_force(scene) else ''}"


def multiplier_text(scene: Scene, outcome: Outcome) -> tuple[str, str]:
    """Load at collapse, or what there is instead, and its bracket; empty where that adds nothing."""
    name, unit = load_symbol(scene), " N" if is_force(scene) else ""
    low, high = (None if x is None else signed(number(x)) for x in (outcome.lower, outcome.upper))
    if outcome.status != "collapse" or outcome.multiplier is None:
        bounds = [f"{name} ≥ {low}{unit}"] * (low is not None) + [f"{name} ≤ {high}{unit}"] * (high is not None)
        return outcome.status, ", ".join(bounds)
    bracket = "" if low is None or high is None or low == high else f"[{low}, {high}]{unit}"
    return f"{name} = {signed(number(outcome.multiplier))}{unit}", bracket


def mechanism_caption(scene: Scene, outcome: Outcome, key: Sequence[Any], *, drawn: bool) -> Caption:
    """Title with load and bracket, how large the mechanism is drawn, and what is wrong with it where something is."""
    title, load = wall_title(outcome.scene), f"{outcome.model}: {'  '.join(multiplier_text(scene, outcome)).strip()}"
    warning = mechanism_warning(scene, outcome)
    if not drawn:
        return Caption(title, load, [warning or "no mechanism"], [])
    key = [*key, *held_key(scene)]
    columns = 5 if sum(len(handle.get_label()) for handle in key) < 45 else 3
    what = "shape in the fall; the farthest corner" if scene.history else "mechanism; its fastest corner"
    if outcome.status == "infeasible":
        what = "under dead load; its fastest corner"
    size = f"{what} is drawn to move {DRAWN * scene.size:.2g} m"
    return Caption(title, load, [size, warning] if warning else [size], key, columns)


def wall_title(title: str) -> list[str]:
    """Lines of a wall's name, none longer than a figure is wide."""
    return textwrap.wrap(title, TITLE) or [""]


def colour_key(
    states: Sequence[JointState] = tuple(STATE_COLOURS),
    colouring: Colouring = "displacement",
    dashes: Mapping[JointState, Any] | None = None,
    crushes: bool = False,
) -> list[Any]:
    """What the colours of a picture stand for, and the dashes of its lines: handles of a legend."""
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
    """What the colour of blocks of the wall that are held stands for, where there are some."""
    from matplotlib.patches import Patch

    return [Patch(facecolor=HELD, edgecolor="0.5", lw=0.5, label="held block")] if scene.fixed[scene.wall].any() else []


def to_png(figure: "Figure", dpi: float = DPI) -> bytes:
    """A figure as the content of a PNG file."""
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph", UserWarning)  # a letter of a title that the font lacks is a box
        figure.savefig(buffer, format="png", dpi=dpi)
    return buffer.getvalue()


def to_svg(figure: "Figure") -> bytes:
    """A figure as the content of an SVG file, the same for the same figure."""
    import matplotlib

    buffer = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "runningbond"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()
