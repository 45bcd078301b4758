"""Vector drawings of a wall and of its collapse mechanism with matplotlib only: no VTK, drawn in tenths of a second.

`draw_wall` and `draw_mechanism` draw into given axes; `figure_of` makes a figure as wide as a journal column.
Joint states differ in colour and, for grey print, in line style: solid, dashed or dotted.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Array, Mask, Scene

from .annotations import THRUST, Room, annotate, axes_size, metres_of_point, room_for
from .captions import TALLEST, WIDTH, Caption, colour_key, figure_with_room, mechanism_caption, show_extent
from .deformed_shape import DeformedShape, Extent, joint_lines, outline, undeformed_shape, usual_side
from .joint_state import JointState
from .labels import block_numbers
from .legend import CORNER, block_colours, used_joint_materials, wall_caption
from .mechanism import mechanism_shape
from .quantities import readable
from .resultants import resultants
from .style import CRUSHED, DARK, EDGE, OUTLINE, STATE_COLOURS, Colour, joint_colour, tint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SMALLEST_NUMBER, LARGEST_SHEET = 4.0, 5.0
"""Smallest type size of block numbers [pt], to which a figure is enlarged, and the largest enlargement factor."""

THINNEST = 0.2
"""Smallest width of a line [pt]; lines that should be thinner are drawn fainter instead."""

DASHES: dict[JointState, Any] = {
    JointState.OPEN: "solid",
    JointState.SLIDE: (0, (2.6, 1.3)),
    JointState.DEBONDED: (0, (0.8, 1.2)),
}

SPLIT = "#5c1400"
"""Colour of cracks through blocks."""

MIN_BLOCK = 14.0
"""Drawn size of blocks [pt] above which joint forces are drawn too."""

CROSS: dict[str, Any] = {"marker": "X", "ls": "none", "mfc": CRUSHED, "mec": "white", "zorder": 6}
HINGE: dict[str, Any] = {"marker": "o", "ls": "none", "mfc": "white", "mec": DARK, "zorder": 5}


def draw_wall(axes: "Axes", scene: Scene, *, numbers: bool = False) -> None:
    """Draw a wall before any analysis: blocks and joints by material, supports, ties, and loads with their sizes.

    With `numbers` each block shows the number by which ``assign`` refers to it.
    """
    _draw(axes, undeformed_shape(scene), wall_caption(scene), numbers=numbers)


def draw_mechanism(axes: "Axes", scene: Scene, outcome: Outcome, load: str = "") -> None:
    """Draw an outcome's mechanism over the undeformed wall, with joints coloured by state and hinges as circles.

    If there is no mechanism, or the loads do not drive it, the undeformed wall is drawn with a note below. `load`
    replaces the line of model, load and bracket above it.
    """
    shape, caption, thrust = _mechanism(scene, outcome, load)
    _draw(axes, shape, caption, thrust=thrust)


def figure_of(
    scene: Scene,
    outcome: Outcome | None = None,
    *,
    numbers: bool = False,
    make: "Callable[..., Figure] | None" = None,
) -> "Figure":
    """Make a figure of a wall, or of the mechanism of an outcome, as wide as a journal column.

    With block numbers the figure is enlarged until these are legible. `make` replaces `Figure`.
    """
    shape, caption, thrust = undeformed_shape(scene), wall_caption(scene), None
    if outcome is not None:
        shape, caption, thrust = _mechanism(scene, outcome)
    room, enlarged = room_for([shape], shape.extent, (WIDTH, TALLEST), numbers=numbers, thrust=thrust), 1.0
    if numbers:
        smallest = min(one.label.size for one in block_numbers(scene, metres_of_point(room.extent, (WIDTH, TALLEST))))
        enlarged = float(np.clip(SMALLEST_NUMBER / smallest, 1.0, LARGEST_SHEET))
        size = enlarged * WIDTH, enlarged * TALLEST
        room = room_for([shape], shape.extent, size, numbers=numbers, thrust=thrust)
    figure, axes = figure_with_room(room.extent, caption, enlarged, make)
    _draw(axes, shape, caption, room, thrust=thrust, numbers=numbers)
    return figure


def _draw(
    axes: "Axes",
    shape: DeformedShape,
    caption: Caption,
    room: Room | None = None,
    *,
    thrust: Array | None = None,
    numbers: bool = False,
) -> None:
    """Draw a wall coloured by material or, if `thrust` is given, a mechanism, with annotations and caption."""
    scene = shape.scene
    room = room or room_for([shape], shape.extent, axes_size(axes), numbers=numbers, thrust=thrust)
    show_extent(axes, room.extent)
    width = line_width(scene, room.extent, axes_size(axes))
    if thrust is not None:
        paint_mechanism(axes, shape, width)
    else:
        _draw_blocks(axes, shape, block_colours(scene), 0.5 * width)
        for number in used_joint_materials(scene):
            lines, colour = scene.joints.ends[scene.material_of_joint == number], joint_colour(number)
            _draw_lines(axes, lines, colour, (1.0 if number else 0.6) * width, "solid")
        axes.plot(*scene.joints.ends[scene.joints.at_corner].mean(axis=1).T, **CORNER, ms=1.2 * width)
    annotate(axes, shape, room, numbers=numbers, thrust=thrust)
    caption.write(axes)


def paint_mechanism(axes: "Axes", shape: DeformedShape, width: float) -> None:
    """Draw displaced blocks over the undeformed wall, joint states and hinges, with lines of a given width [pt]."""
    _draw_ghost(axes, shape.scene, width)
    _draw_blocks(axes, shape, shape.block_colours(), 0.5 * width)
    _hide_sound_cracks(axes, shape, width)
    splits = split_blocks(shape)
    for state, colour in STATE_COLOURS.items():
        own = (shape.drawn_state == state) & ~splits
        _draw_joints(axes, shape.placed_faces[own], state, colour, width)
    _draw_joints(axes, shape.placed_faces[splits], JointState.OPEN, SPLIT, width)
    axes.plot(*shape.hinges.T, ms=2.4 * width, mew=0.5 * width, **HINGE)
    axes.plot(*shape.crosses.T, ms=max(3.6 * width, 2.0), mew=0.3 * width, **CROSS)


def paint_blocks(axes: "Axes", shape: DeformedShape, width: float) -> None:
    """Draw displaced blocks coloured by material over the undeformed wall, for joint lines of a given width [pt]."""
    _draw_ghost(axes, shape.scene, width)
    _draw_blocks(axes, shape, block_colours(shape.scene), 0.5 * width)


def _mechanism(scene: Scene, outcome: Outcome, load: str = "") -> tuple[DeformedShape, Caption, Array]:
    """Shape and caption of an outcome's mechanism, and its resultants if blocks are drawn large enough."""
    from matplotlib.lines import Line2D

    mechanism = mechanism_shape(scene, outcome)
    shape = mechanism or undeformed_shape(scene)
    key = mechanism_key([shape])
    lines, largest, beside = resultants(shape, outcome)
    if len(lines) and mechanism and usual_side(scene) > MIN_BLOCK * metres_of_point(shape.extent, (WIDTH, TALLEST)):
        label = f"force ≤ {readable(largest, 'N')}" + (f", {beside} far beside their joints" if beside else "")
        key.append(Line2D([], [], color=THRUST, lw=0.8, label=label))
    else:
        lines = lines[:0]
    return shape, mechanism_caption(scene, outcome, key, mechanism, load), lines


def mechanism_key(shapes: Sequence[DeformedShape]) -> list[Any]:
    """Legend handles for the circles, crosses, dashes and colours that occur in mechanisms."""
    from matplotlib.lines import Line2D

    circle = [Line2D([], [], ms=2.8, mew=0.6, label="hinge", **HINGE)] if any(len(x.hinges) for x in shapes) else []
    splits = [Line2D([], [], color=SPLIT, lw=1.5, label="block splits")]
    splits = splits if any(split_blocks(shape).any() for shape in shapes) else []
    drawn = {JointState(state) for shape in shapes for state in shape.drawn_state[~split_blocks(shape)]}
    states = [state for state in STATE_COLOURS if state in drawn]
    crushes = any(len(shape.crosses) for shape in shapes)
    return [*circle, *splits, *colour_key(states, dashes=DASHES, crushes=crushes)]


def line_width(scene: Scene, extent: Extent, size: tuple[float, float]) -> float:
    """Width of joint lines [pt]: a share of `usual_side` in a drawing of a given size [in], but at most 1.2 pt."""
    return float(min(0.14 * usual_side(scene) / metres_of_point(extent, size), 1.2))


def _draw_ghost(axes: "Axes", scene: Scene, width: float) -> None:
    """Draw the undeformed wall faintly."""
    from matplotlib.collections import LineCollection, PolyCollection

    blocks = [scene.blocks.polygon(int(i)) for i in np.flatnonzero(scene.wall)]
    axes.add_collection(PolyCollection(blocks, fc="none", ec="0.86", lw=0.4 * width, zorder=1), autolim=False)
    rings = LineCollection(outline(scene), colors=[OUTLINE], lw=0.6, linestyles=[(0, (5, 2.5))], zorder=1)
    axes.add_collection(rings, autolim=False)


def _draw_blocks(axes: "Axes", shape: DeformedShape, colours: Array, width: float) -> None:
    from matplotlib.collections import PolyCollection

    polygons = np.split(shape.placed, shape.first[1:-1])
    blocks = PolyCollection(polygons, facecolors=colours, edgecolors=[EDGE], lw=width, zorder=2)
    axes.add_collection(blocks, autolim=False)


def split_blocks(shape: DeformedShape) -> Mask:
    """Which joints are potential cracks through blocks that have opened or slid, ``(nj,)``."""
    return np.asarray(shape.scene.joints.inner & (shape.drawn_state != JointState.STICK))


def _hide_sound_cracks(axes: "Axes", shape: DeformedShape, width: float) -> None:
    """Draw potential cracks that stay closed in the colour of their block, so that the block looks whole."""
    from matplotlib.collections import LineCollection

    sound = shape.scene.joints.inner & (shape.drawn_state == JointState.STICK)
    if not sound.any():
        return
    colours = shape.block_colours()[np.searchsorted(shape.block, shape.scene.joints.block[sound, 0])]
    start, end = shape.placed_faces[sound, 0], shape.placed_faces[sound, 1]
    extent = (*axes.get_xlim(), *axes.get_ylim())
    half = 0.25 * width * metres_of_point(extent, axes_size(axes))  # of the outline, which must stay intact
    inwards = half * (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
    within = np.stack([start + inwards, end - inwards], axis=1)
    hidden = LineCollection(list(within), colors=list(colours), lw=0.9 * width, capstyle="butt", zorder=2.5)
    axes.add_collection(hidden, autolim=False)


def _draw_joints(axes: "Axes", faces: Array, state: JointState, colour: str, width: float) -> None:
    """Draw gaps ``(n, 4, 2)`` [m] and lines of joints in one state."""
    from matplotlib.collections import PolyCollection

    if not len(faces):
        return
    gaps = PolyCollection(list(faces), facecolors=[tint(state)], edgecolors="none", zorder=3)
    axes.add_collection(gaps, autolim=False)
    lines = joint_lines(faces, state)
    wide = (0.75 if state == JointState.OPEN else 1.0) * width
    if state != JointState.OPEN:  # dark lines below would show between the dashes
        _draw_lines(axes, lines, "white", wide, "solid")
    _draw_lines(axes, lines, colour, wide, DASHES[state])


def _draw_lines(axes: "Axes", lines: Array, colour: str | Colour, width: float, dashes: Any) -> None:
    """Draw lines ``(n, 2, 2)`` [m]."""
    from matplotlib.collections import LineCollection

    thin = {"lw": max(width, THINNEST), "alpha": float(np.clip(width / THINNEST, 0.25, 1.0))}
    drawn = LineCollection(list(lines), colors=[colour], linestyles=[dashes], capstyle="butt", zorder=4, **thin)
    axes.add_collection(drawn, autolim=False)
