"""Supports of a wall: hatched ground, pins and rollers, moving supports, and guides of the beam."""

import numpy as np
import shapely
from numpy.typing import ArrayLike

from runningbond.results.mechanism import carried
from runningbond.scene import Array, Mask, Settlement
from runningbond.scene.polygons import outer_corners, polygonal_parts

from .deformed_shape import DeformedShape
from .labels import Spot
from .quantities import millimetres, minus, round_length
from .sketch import Sketch
from .style import DARK, MOTION, SMALL_TYPE

GREY = "0.45"

DEPTH = 0.55
"""Depth to which ground is drawn below the lowest block, in lengths `Sketch.a`; the scale bar is below it."""


def draw_supports(sketch: Sketch, shape: DeformedShape) -> None:
    """Draw the ground, hatching below fixed blocks, and triangles under pins, on rollers if one direction is free."""
    scene, a = shape.scene, sketch.a
    low, _ = scene.blocks.extent(scene.wall)
    ground = np.flatnonzero(~scene.wall)
    moving = np.zeros(len(scene.blocks), np.bool_) if scene.settlement is None else scene.settlement.moving(scene)
    is_level = len(ground) > 0 and scene.blocks.extent(~scene.wall)[1][1] <= low[1] + scene.blocks.tolerance
    for block in np.flatnonzero(scene.fixed & scene.wall):
        (x0, _), (x1, _) = scene.blocks.extent(int(block))
        colour = MOTION if moving[block] else GREY
        _hatched(sketch, "support", [(x0, low[1]), (x1, low[1])], DEPTH * a, colour)
    for block in ground:
        colour = MOTION if moving[block] else GREY
        outline = scene.blocks.polygon(int(block))
        if is_level:
            ends = np.array([(outline[:, 0].min(), low[1]), (outline[:, 0].max(), low[1])])
            _hatched(sketch, "support", [shape.drawn_at(at, block) for at in ends], DEPTH * a, colour)
            continue
        look = {"fc": "0.87", "ec": DARK if colour == GREY else colour, "lw": 0.6, "zorder": 1.5}
        for part in _above(outline, low[1] - DEPTH * a):
            drawn = [shape.drawn_at(at, block) for at in part]
            sketch.area("support", drawn, counts=False, hatch="////" if moving[block] else "", **look)
    pins = scene.pins
    for block in np.unique(pins.block[pins.direction.any(axis=1)]):
        own = (pins.block == block) & pins.direction.any(axis=1)
        _draw_pin(sketch, shape.drawn_at(pins.point[own][0], block), roller=own.sum() == 1)
    if scene.settlement is not None:
        _draw_motion(sketch, shape, scene.settlement, moving)


def _draw_motion(sketch: Sketch, shape: DeformedShape, settlement: Settlement, moving: Mask) -> None:
    """Draw the enlarged motion of supports, and arrows labelled with their displacement and rotation.

    If supports are already drawn displaced, only the arrows. For a path, its farthest end and its number of moves.
    """
    scene, a = shape.scene, sketch.a
    low, high = scene.blocks.extent(scene.wall)
    numbers = np.flatnonzero(moving)
    farthest = max(settlement.path, key=abs)
    moves = int(np.count_nonzero(np.diff([0.0, *settlement.path])))
    path = f"\n{moves} moves" if moves > 1 else ""
    bottoms, tops = (corner[numbers] for corner in scene.blocks.boxes)
    level = np.where(scene.wall[numbers], bottoms[:, 1], tops[:, 1])
    ends = np.clip([bottoms[:, 0], tops[:, 0]], low[0] - a, high[0] + a).T
    surface = np.stack([ends, np.repeat(level[:, None], 2, axis=1)], axis=2)
    moved = carried(scene.blocks, np.repeat(numbers, 2), surface.reshape(-1, 2), farthest * settlement.motion(scene))
    visible = 1.1 * a / np.hypot(*moved.T).max() * moved.reshape(-1, 2, 2)
    below = min(float(level.min()), low[1] - DEPTH * a)  # bottom of the drawn ground
    at = np.array([(ends.min() + ends.max()) / 2, below - 0.75 * a])
    drawn = shape.drawn_displacement(numbers[:1], at)
    for line in surface + visible if not drawn.any() else []:
        sketch.line("motion", line, color=MOTION, lw=1.0, ls=(0, (3, 1.5)))
    at = at + drawn
    by = farthest * np.array(settlement.by)
    if by.any():
        direction = by / np.hypot(*by)
        depth = abs(direction[1])
        start = at - [0, 0.4 * a * depth] - (1 - depth) * direction * a - [0, 2 * a * max(direction[1], 0)]
        sketch.arrow("motion", [start, start + 2 * a * direction], MOTION)
        tip = start + (1.2 if depth > 0.5 else 2.0) * a * direction
        sides = [(1.0, 0.0), (-1.0, 0.0)] if depth > 0.5 else [(float(np.sign(by[0])), 0.0), (0.0, -1.0)]
        size = millimetres(float(np.hypot(*by))) + path
        sketch.label(size, [Spot(tip, side) for side in sides], MOTION)
        at = at + [-4 * a, 0]
    if angle := farthest * settlement.rotation_angle:
        at = at - [0, 1.2 * a]
        sketch.turn("motion", at, 0.9 * a, MOTION, clockwise=angle < 0)
        spots = [Spot(at + 0.9 * a * np.array(side), side) for side in ((1.0, 0.0), (-1.0, 0.0))]
        sketch.label(f"{minus(abs(angle))}°{'' if by.any() else path}", spots, MOTION)


def _draw_pin(sketch: Sketch, tip: Array, *, roller: bool) -> None:
    a = sketch.a
    x, y = tip
    foot = y - 0.8 * a
    sketch.area("support", [(x, y), (x - 0.5 * a, foot), (x + 0.5 * a, foot)], zorder=3)
    if roller:
        for side in (-0.25, 0.25):
            sketch.disc("support", (x + side * a, foot - 0.15 * a), 0.13 * a, lw=0.6, zorder=3)
        foot -= 0.3 * a
    sketch.line("support", [(x - 0.7 * a, foot), (x + 0.7 * a, foot)], zorder=3)


def draw_beam(sketch: Sketch, shape: DeformedShape) -> None:
    """Draw the outline of the beam and rollers that keep it level: under a bar, or hatching if its height is fixed."""
    scene, beam, a = shape.scene, shape.scene.beam, sketch.a
    if beam is None or beam.block is None:
        return
    outline = np.array([shape.drawn_at(at, beam.block) for at in scene.blocks.polygon(beam.block)])
    sketch.area("beam", outline, fc="none", ec=DARK, lw=1.4, zorder=3.5)
    if beam.condition == "free":
        return
    low, high = outline.min(axis=0), outline.max(axis=0)
    r = 0.32 * a
    for share in (0.2, 0.8):
        x, y = low[0] + share * (high[0] - low[0]), high[1]
        sketch.disc("beam guide", (x, y + r), r, lw=0.9)
        bar = np.array([(x - a, y + 2 * r), (x + a, y + 2 * r)])
        if beam.condition == "fixed-height":
            _hatched(sketch, "beam guide", bar[::-1], 0.5 * a)
        else:
            sketch.line("beam guide", bar, lw=1.1)
            sketch.line("beam guide", bar + [0, 0.28 * a], lw=1.1)
    if beam.condition == "level":
        x = (low[0] + 0.2 * (high[0] - low[0]), low[0] + 0.8 * (high[0] - low[0]))
        sketch.line(
            "beam guide", [(x[0] + a, high[1] + 2 * r + 0.14 * a), (x[1] - a, high[1] + 2 * r + 0.14 * a)], lw=0.5
        )


def draw_scale(sketch: Sketch, shape: DeformedShape) -> None:
    """Draw a scale bar of a round length below everything else."""
    (left, base), (right, top) = shape.scene.blocks.extent(shape.scene.wall)
    length, a = round_length(max((right - left) / 4, (top - base) / 16)), sketch.a
    lowest = [(sketch.room() or (0.0, 0.0, base))[2], float(shape.placed[:, 1].min()), base - DEPTH * a]
    ground = [float(mark.points[:, 1].min()) for mark in sketch.marks if mark.name == "support"]
    level = min(*lowest, *ground) - 0.8 * a
    for x in (left, left + length):
        sketch.line("scale", [(x, level - 0.25 * a), (x, level + 0.25 * a)], lw=0.7)
    sketch.line("scale", [(left, level), (left + length, level)], lw=0.7)
    sketch.label(f"{length:g} m", [Spot(np.array([left + length, level]), (1.0, 0.0))], size=SMALL_TYPE)


def _above(outline: Array, level: float) -> list[Array]:
    """Parts of a polygon ``(n, 2)`` above a level [m]."""
    (left, _), (right, top) = outline.min(axis=0), outline.max(axis=0)
    if outline[:, 1].min() >= level or top <= level:
        return [outline]
    return [
        outer_corners(part) for part in polygonal_parts(shapely.Polygon(outline) & shapely.box(left, level, right, top))
    ]


def _hatched(sketch: Sketch, name: str, surface: ArrayLike, depth: float, colour: str = GREY) -> None:
    """Draw a hatched body without an outline behind a surface ``(2, 2)``, on the right when going from start to end."""
    start, end = np.array(surface)
    run = (end - start) / np.hypot(*(end - start))
    back = depth * np.array([run[1], -run[0]])
    look = {"fc": "none", "ec": colour, "hatch": "//////", "lw": 0, "zorder": 2}
    sketch.area(name, [start, end, end + back, start + back], counts=False, **look)
    sketch.line(name, [start, end], counts=False, color=DARK if colour == GREY else colour, zorder=2)
