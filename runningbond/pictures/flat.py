"""Flat drawings of a wall and of its collapse mechanism, with matplotlib alone: vectors, no VTK, tenths of a second.

`draw_wall` and `draw_mechanism` draw into axes of one's own; `figure_of` makes a figure as wide as a journal's column.
What joints do is told apart by colour, and in grey print by solid, dashed and dotted lines.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Array, JointMaterial, Scene

from .annotations import annotate, annotated_extent
from .captions import Caption, colour_key, figure_with_room, mechanism_caption, show_extent, wall_title
from .deformed_shape import DeformedShape, outline, undeformed_shape
from .joint_state import VISIBLE, JointState
from .mechanism import mechanism_shape
from .style import DARK, EDGE, OUTLINE, STATE_COLOURS, tint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MATERIAL_COLOURS = ("0.35", "#0072b2", "#cc79a7", "#e69f00", "#56b4e9")
"""Joints by material; from the palette of Okabe and Ito (2008)."""

THINNEST = 0.2
"""Least width of a line [pt]; what ought to be thinner is fainter instead."""

DASHES: dict[JointState, Any] = {
    JointState.OPEN: "solid",
    JointState.SLIDE: (0, (2.6, 1.3)),
    JointState.DEBONDED: (0, (0.8, 1.2)),
}

HINGE: dict[str, Any] = {"marker": "o", "ls": "none", "mfc": "white", "mec": DARK, "zorder": 5}


def draw_wall(axes: "Axes", scene: Scene) -> None:
    """Draw a wall before any analysis: blocks, joints by material, supports, and arrows of the live load."""
    _draw(axes, *_wall(scene))


def draw_mechanism(axes: "Axes", scene: Scene, outcome: Outcome) -> None:
    """Draw the mechanism of an outcome over the undeformed wall, its joints by what they do and hinges as circles.

    Where there is none, or none that the loads drive, the undeformed wall is drawn and a note below says so.
    """
    _draw(axes, *_mechanism(scene, outcome), is_mechanism=True)


def figure_of(scene: Scene, outcome: Outcome | None = None) -> "Figure":
    """A figure of a wall, or of the mechanism of an outcome: as wide as a journal's column."""
    shape, caption = _wall(scene) if outcome is None else _mechanism(scene, outcome)
    figure, axes = figure_with_room(annotated_extent(scene, shape.extent), caption)
    _draw(axes, shape, caption, is_mechanism=outcome is not None)
    return figure


def _draw(axes: "Axes", shape: DeformedShape, caption: Caption, *, is_mechanism: bool = False) -> None:
    scene = shape.scene
    show_extent(axes, annotated_extent(scene, shape.extent))
    width = _line_width(axes, scene)
    if is_mechanism:
        _draw_ghost(axes, scene, width)
    _draw_blocks(axes, shape, 0.5 * width)
    if is_mechanism:
        for state in shape.states:
            _draw_joints(axes, shape, state, width)
        axes.plot(*_hinges(shape).T, ms=2.2 * width, mew=0.4 * width, **HINGE)
    else:
        for number, colour in _material_colours(scene):
            _draw_lines(axes, scene.joints.ends[scene.material_of_joint == number], colour, 0.6 * width, "solid")
    annotate(axes, shape)
    caption.write(axes)


def _wall(scene: Scene) -> tuple[DeformedShape, Caption]:
    """What is drawn of a wall, and its caption."""
    from matplotlib.lines import Line2D

    materials = scene.joint_materials
    key = [
        Line2D([], [], color=colour, lw=1.2, label=_strength(materials[k])) for k, colour in _material_colours(scene)
    ]
    length, height = np.subtract(*scene.blocks.extent(scene.wall)[::-1])
    size = f"{length:.4g} × {height:.4g} m, {scene.wall.sum()} blocks, {len(scene.joints)} joints"
    return undeformed_shape(scene), Caption(wall_title(scene.title), "", [size], key, columns=1)


def _mechanism(scene: Scene, outcome: Outcome) -> tuple[DeformedShape, Caption]:
    """What is drawn of an outcome, and its caption."""
    from matplotlib.lines import Line2D

    mechanism = mechanism_shape(scene, outcome)
    shape = mechanism or undeformed_shape(scene)
    hinge = [Line2D([], [], ms=2.8, mew=0.6, label="hinge", **HINGE)] if len(_hinges(shape)) else []
    key = [*hinge, *colour_key(shape.states, dashes=DASHES)]
    return shape, mechanism_caption(scene, outcome, key, drawn=mechanism is not None)


def _material_colours(scene: Scene) -> list[tuple[int, str]]:
    """Number and colour of each joint material."""
    return [(k, MATERIAL_COLOURS[k % len(MATERIAL_COLOURS)]) for k in range(len(scene.joint_materials))]


def _line_width(axes: "Axes", scene: Scene) -> float:
    """Width of the lines of joints [pt]: a share of the smaller side of a block as it is drawn."""
    (left, right), (bottom, top), box = axes.get_xlim(), axes.get_ylim(), axes.get_window_extent()
    points = 72 / axes.figure.dpi * min(box.width / (right - left), box.height / (top - bottom))
    return float(min(0.14 * scene.block_size * points, 1.2))


def _draw_ghost(axes: "Axes", scene: Scene, width: float) -> None:
    """The undeformed wall, faint."""
    from matplotlib.collections import LineCollection, PolyCollection

    blocks = [scene.blocks.polygon(int(i)) for i in np.flatnonzero(scene.wall)]
    axes.add_collection(PolyCollection(blocks, fc="none", ec="0.86", lw=0.4 * width, zorder=1), autolim=False)
    rings = LineCollection(outline(scene), colors=[OUTLINE], lw=0.6, linestyles=[(0, (5, 2.5))], zorder=1)
    axes.add_collection(rings, autolim=False)


def _draw_blocks(axes: "Axes", shape: DeformedShape, width: float) -> None:
    from matplotlib.collections import PolyCollection

    polygons = np.split(shape.placed, shape.first[1:-1])
    blocks = PolyCollection(polygons, facecolors=shape.block_colours(), edgecolors=[EDGE], lw=width, zorder=2)
    axes.add_collection(blocks, autolim=False)


def _draw_joints(axes: "Axes", shape: DeformedShape, state: JointState, width: float) -> None:
    """The gaps and lines of joints in one state."""
    from matplotlib.collections import PolyCollection

    faces, colour = shape.placed_faces[shape.state == state], STATE_COLOURS[state]
    gaps = PolyCollection(faces, facecolors=[tint(colour)], edgecolors="none", zorder=3)
    axes.add_collection(gaps, autolim=False)
    # Of a joint that slides, one line along the middle: dashes on both faces would fill each other's gaps.
    middle = (faces[:, :2] + faces[:, :1:-1]) / 2
    lines = np.concatenate([faces[:, :2], faces[:, 2:]]) if state == JointState.OPEN else middle
    _draw_lines(axes, lines, colour, width, DASHES[state])


def _draw_lines(axes: "Axes", lines: Array, colour: str, width: float, dashes: Any) -> None:
    """Lines ``(n, 2, 2)`` [m]."""
    from matplotlib.collections import LineCollection

    thin = {"lw": max(width, THINNEST), "alpha": float(np.clip(width / THINNEST, 0.25, 1.0))}
    drawn = LineCollection(list(lines), colors=[colour], linestyles=[dashes], capstyle="butt", zorder=4, **thin)
    axes.add_collection(drawn, autolim=False)


def _hinges(shape: DeformedShape) -> Array:
    """Ends about which joints that open turn, where they are drawn, ``(n, 2)`` [m]."""
    faces = shape.placed_faces[shape.state == JointState.OPEN]
    gaps = np.hypot(*(faces[:, [3, 2]] - faces[:, [0, 1]]).transpose(2, 0, 1))
    least = VISIBLE * shape.scale * float(np.hypot(*shape.displacement.T).max(initial=0.0))
    turns = (gaps.min(axis=1) < least) & (gaps.max(axis=1) > least)
    return np.asarray(faces[turns, gaps[turns].argmin(axis=1)])


def _strength(material: JointMaterial) -> str:
    """What a joint's material is called in a legend."""
    cohesion = f", c = {material.cohesion / 1e6:.3g} MPa" if material.cohesion else ""
    tension = f", fₜ = {material.tensile_strength / 1e6:.3g} MPa" if material.tensile_strength else ""
    return f"joints: tan φ = {material.friction:.3g}{cohesion}{tension}"
