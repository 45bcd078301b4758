"""What engineers draw around a wall: hatched ground, pins and rollers, arrows of loads."""

from typing import TYPE_CHECKING

import numpy as np

from runningbond.scene import Array, Arrow, Scene

from .captions import load_symbol
from .deformed_shape import DeformedShape, Extent, wall_size
from .style import DARK, TYPE

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def annotated_extent(scene: Scene, extent: Extent) -> Extent:
    """An extent with room for supports and loads."""
    (x0, y0), (x1, y1) = scene.blocks.extent(scene.wall)
    a = _unit(scene)
    left, right, bottom, top = extent
    bottom = min(bottom, y0 - 1.2 * a)
    if len(scene.pins):
        left, right = left - 0.8 * a, right + 0.8 * a
    for arrow in _live_arrows(scene):
        dx, dy = arrow.direction
        if arrow.at is not None:
            x, y = arrow.at - 2.9 * a * arrow.direction
            left, right, bottom, top = min(left, x - a), max(right, x + a), min(bottom, y - a), max(top, y + a)
            continue
        left, right = min(left, x0 - 2.6 * a * (dx > 0)), max(right, x1 + 2.6 * a * (dx < 0))
        bottom, top = min(bottom, y0 - 2.6 * a * (dy > 0)), max(top, y1 + 2.6 * a * (dy < 0))
    return left, right, bottom, top


def annotate(axes: "Axes", shape: DeformedShape) -> None:
    """Draw the supports of a wall and its live load."""
    _draw_supports(axes, shape)
    for arrow in _live_arrows(shape.scene):
        if arrow.at is None:
            _draw_push(axes, shape.scene, arrow.direction)
        else:
            tip = arrow.at + shape.drawn_displacement(arrow.block, arrow.at)
            _draw_force(axes, shape.scene, arrow.direction, tip)


def _live_arrows(scene: Scene) -> list[Arrow]:
    """Arrows of all live loads."""
    return [arrow for load in scene.load.live for arrow in load.arrows(scene)]


def _unit(scene: Scene) -> float:
    """Length [m] in which annotations are measured."""
    return 0.045 * wall_size(scene)


def _draw_supports(axes: "Axes", shape: DeformedShape) -> None:
    """Hatch what does not move, and put triangles under pins, on rollers where these may move aside."""
    from matplotlib.patches import Polygon

    scene, a = shape.scene, _unit(shape.scene)
    ground = np.flatnonzero(~scene.wall)
    base = float(scene.blocks.extent(scene.wall)[0][1])
    if len(ground) and scene.blocks.extent(~scene.wall)[1][1] > base + scene.blocks.tolerance:
        for block in ground:  # sloping or stepped
            outline = scene.blocks.polygon(int(block))
            axes.add_patch(Polygon(outline, facecolor="0.85", edgecolor=DARK, lw=0.6, zorder=2))
    elif len(ground):
        _hatch(axes, axes.get_xlim(), base, a)
    elif scene.fixed.any():
        low, high = scene.blocks.extent(scene.fixed)
        _hatch(axes, (float(low[0]), float(high[0])), base, a)
    for block in np.unique(scene.pins.block):
        own = scene.pins.block == block
        at = scene.pins.point[own][0]
        _draw_pin(axes, at + shape.drawn_displacement(np.array([block]), at), a, roller=own.sum() == 1)


def _hatch(axes: "Axes", span: tuple[float, float], level: float, a: float) -> None:
    from matplotlib.patches import Rectangle

    strip = Rectangle((span[0], level - 0.55 * a), span[1] - span[0], 0.55 * a)
    strip.set(facecolor="none", edgecolor="0.45", hatch="//////", linewidth=0, zorder=2)
    axes.add_patch(strip)
    axes.plot(span, [level, level], color=DARK, lw=0.9, zorder=2)


def _draw_pin(axes: "Axes", tip: Array, a: float, *, roller: bool) -> None:
    from matplotlib.patches import Circle, Polygon

    x, y = tip
    foot = y - 0.8 * a
    axes.add_patch(Polygon([(x, y), (x - 0.5 * a, foot), (x + 0.5 * a, foot)], fc="white", ec=DARK, lw=0.8))
    if roller:
        for side in (-0.25, 0.25):
            axes.add_patch(Circle((x + side * a, foot - 0.15 * a), 0.13 * a, fc="white", ec=DARK, lw=0.6))
        foot -= 0.3 * a
    axes.plot([x - 0.7 * a, x + 0.7 * a], [foot, foot], color=DARK, lw=0.9)


def _draw_force(axes: "Axes", scene: Scene, direction: Array, tip: Array) -> None:
    """An arrow to a point, and its name beside it."""
    a = _unit(scene)
    _arrow(axes, tip - 2.2 * a * direction, tip)
    _name(axes, scene, tip - 1.5 * a * direction + 0.5 * a * np.array([-direction[1], direction[0]]))


def _draw_push(axes: "Axes", scene: Scene, direction: Array) -> None:
    """A row of arrows along the side on which all blocks are pushed, and their name."""
    a = _unit(scene)
    low, high = scene.blocks.extent(scene.wall)
    across = np.array([-direction[1], direction[0]])
    reach, width = float((high - low) @ np.abs(direction)) / 2, float((high - low) @ np.abs(across)) / 2
    start = (low + high) / 2 - (reach + 2.2 * a) * direction
    places = width * np.linspace(-0.8, 0.8, int(np.clip(width / a, 2, 5)))
    for place in places:
        _arrow(axes, start + place * across, start + place * across + 1.5 * a * direction)
    has_room = places[-1] - places[-2] > 2.5 * a
    aside = (places[-1] + places[-2]) / 2 if has_room else width + 0.6 * a
    _name(axes, scene, start + aside * across + 0.7 * a * direction)


def _name(axes: "Axes", scene: Scene, at: Array) -> None:
    axes.text(at[0], at[1], load_symbol(scene), ha="center", va="center", fontsize=TYPE, color=DARK)


def _arrow(axes: "Axes", tail: Array, tip: Array) -> None:
    style = {"arrowstyle": "-|>,head_width=0.16,head_length=0.32", "color": DARK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (tip[0], tip[1]), (tail[0], tail[1]), arrowprops=style, zorder=6, annotation_clip=False)
