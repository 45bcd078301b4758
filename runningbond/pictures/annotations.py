"""The signs that engineers draw around a wall: hatched ground, pins and rollers, arrows of loads."""

from typing import TYPE_CHECKING

import numpy as np

from runningbond.scene import Array, Arrow, Scene

from .moment import Shown
from .painting import View, wall_size

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 7.5
"""Size of type [pt]."""

DARK = "0.25"


def with_signs(scene: Scene, view: View) -> tuple[float, float, float, float]:
    """A view with room for the signs of supports and loads: left, right, bottom and top [m]."""
    low, high = scene.blocks.extent(scene.wall)
    a = _unit(scene)
    left, right, bottom, top = view.extent
    bottom = min(bottom, low[1] - 1.2 * a)
    if len(scene.pins):
        left, right = left - 0.8 * a, right + 0.8 * a
    for arrow in live_arrows(scene):
        dx, dy = arrow.direction
        if arrow.at is not None:
            x, y = arrow.at - 2.9 * a * arrow.direction
            left, right, bottom, top = min(left, x - a), max(right, x + a), min(bottom, y - a), max(top, y + a)
            continue
        left = min(left, low[0] - 2.6 * a) if dx > 0 else left
        right = max(right, high[0] + 2.6 * a) if dx < 0 else right
        bottom = min(bottom, low[1] - 2.6 * a) if dy > 0 else bottom
        top = max(top, high[1] + 2.6 * a) if dy < 0 else top
    return left, right, bottom, top


def live_arrows(scene: Scene) -> list[Arrow]:
    """Arrows of all live loads."""
    return [arrow for load in scene.load.live for arrow in load.arrows(scene)]


def _unit(scene: Scene) -> float:
    """Size of a sign [m]."""
    return 0.045 * wall_size(scene)


def draw_supports(axes: "Axes", shown: Shown) -> None:
    """Hatch what does not move, and put triangles under pins, on rollers where these may move aside."""
    scene = shown.scene
    ground = np.flatnonzero(~scene.wall)
    base = float(scene.blocks.extent(scene.wall)[0][1])
    sloping = len(ground) > 0 and scene.blocks.extent(~scene.wall)[1][1] > base + scene.blocks.tolerance
    if sloping:
        _draw_ground(axes, scene)
    elif len(ground):
        _hatch(axes, axes.get_xlim(), base, _unit(scene))
    elif scene.fixed.any():
        low, high = scene.blocks.extent(scene.fixed)
        _hatch(axes, (float(low[0]), float(high[0])), base, _unit(scene))
    for block in np.unique(scene.pins.block):
        own = scene.pins.block == block
        at = scene.pins.point[own][0]
        _draw_pin(axes, at + shown.drawn_motion(np.array([block]), at), _unit(scene), roller=own.sum() == 1)


def _draw_ground(axes: "Axes", scene: Scene) -> None:
    from matplotlib.patches import Polygon

    for block in np.flatnonzero(~scene.wall):
        outline = scene.blocks.polygon(int(block))
        axes.add_patch(Polygon(outline, facecolor="0.85", edgecolor=DARK, lw=0.6, zorder=2))


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


def draw_load(axes: "Axes", shown: Shown, name: str) -> None:
    """Arrows of the live loads, called by a name."""
    for arrow in live_arrows(shown.scene):
        _draw_arrow(axes, shown, arrow, name)


def _draw_arrow(axes: "Axes", shown: Shown, arrow: Arrow, name: str) -> None:
    """One arrow where a point load acts, or a row along the side pushed."""
    scene = shown.scene
    a, direction = _unit(scene), arrow.direction
    if arrow.at is not None:
        tip = arrow.at + shown.drawn_motion(arrow.block, arrow.at)
        _arrow(axes, tip - 2.2 * a * direction, tip)
        beside = tip - 1.5 * a * direction + 0.5 * a * np.array([-direction[1], direction[0]])
    else:
        low, high = scene.blocks.extent(scene.wall)
        across = np.array([-direction[1], direction[0]])
        reach, width = float((high - low) @ np.abs(direction)) / 2, float((high - low) @ np.abs(across)) / 2
        start = (low + high) / 2 - (reach + 2.2 * a) * direction
        places = width * np.linspace(-0.8, 0.8, int(np.clip(width / a, 2, 5)))
        for place in places:
            _arrow(axes, start + place * across, start + place * across + 1.5 * a * direction)
        between = places[-1] - places[-2] > 2.5 * a
        aside = (places[-1] + places[-2]) / 2 if between else width + 0.6 * a
        beside = start + aside * across + 0.7 * a * direction
    axes.text(beside[0], beside[1], name, ha="center", va="center", fontsize=SIZE, color=DARK)


def _arrow(axes: "Axes", tail: Array, tip: Array) -> None:
    style = {"arrowstyle": "-|>,head_width=0.16,head_length=0.32", "color": DARK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (tip[0], tip[1]), (tail[0], tail[1]), arrowprops=style, zorder=3, annotation_clip=False)
