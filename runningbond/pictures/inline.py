"""Mechanisms as small SVG drawings in a page: few bytes, with all blocks of one colour in one path."""

from collections.abc import Iterable

import numpy as np

from runningbond.scene import Array, Scene

from .deformed_shape import DeformedShape, Extent, joint_lines, outline
from .flat import line_width
from .joint_state import JointState
from .style import AT_REST, CRUSHED, STATE_COLOURS, tint

WIDTH, UNITS, SHADES, SEEN_AREA = 2.4, 700, 24, 30
"""Width on paper [in] and in drawing units, shades per colour channel, and area of gaps above which they are filled."""


def inline_wall(scene: Scene, extent: Extent, name: str) -> str:
    """Define the undeformed blocks of a wall as SVG paths, to which mechanisms of the same extent refer by name."""
    polygons = (scene.blocks.polygon(int(k)) for k in np.flatnonzero(scene.wall))
    paths = {name: _path(polygons, extent), f"{name}-outline": _path(outline(scene), extent)}
    defined = "".join(f'<path id="{key}" d="{path}"/>' for key, path in paths.items())
    return f'<svg width="0" height="0"><defs>{defined}</defs></svg>'


def inline_mechanism(shape: DeformedShape, extent: Extent, name: str) -> str:
    """Draw a shape within an extent as an ``svg`` element of class ``wall``, over the `inline_wall` of the same name.

    Visible gaps are filled, joints that slide or are debonded are dashed, hinges are circles, and crushed joint ends
    are crosses. The undeformed outline is dashed.
    """
    left, right, bottom, top = extent
    scale, rest = UNITS / (right - left), hexadecimal(AT_REST)
    height = round((top - bottom) * scale)
    width = line_width(shape.scene, extent, (WIDTH, WIDTH * height / UNITS)) * UNITS / (72 * WIDTH)
    moved = np.maximum.reduceat(np.hypot(*(shape.placed - shape.points).T), shape.first[:-1]) * scale > 0.5
    away = np.zeros(len(shape.scene.blocks), np.bool_)
    away[shape.block[moved]] = True
    parts = [
        f'<svg class="wall" viewBox="0 0 {UNITS} {height}" stroke-width="{0.5 * width:.1f}" aria-hidden="true">',
        f'<use class="block" href="#{name}" fill="{rest}"/>',
        f'<path class="void" d="{_path(outline(shape.scene, away) if away.any() else [], extent)}"/>',
        f'<use class="ghost" href="#{name}-outline"/>',
    ]
    polygons = np.split(shape.placed, shape.first[1:-1])
    colours = shape.block_colours()  # similar colours share the first of them: rounding would change the hue
    _, first, kind = np.unique(np.rint(colours * SHADES), axis=0, return_index=True, return_inverse=True)
    for k, colour in enumerate(colours[first]):
        own = [polygon for polygon, one in zip(polygons, moved * (1 + kind.ravel()), strict=True) if one == k + 1]
        if own:
            parts.append(f'<path class="block" d="{_path(own, extent)}" fill="{hexadecimal(colour)}"/>')
    for state in shape.states:
        faces, colour = shape.placed_faces[shape.drawn_state == state], STATE_COLOURS[state]
        across, along = faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1]
        area = np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0]) / 2
        parts.append(
            f'<path d="{_path(faces[area * scale**2 > SEEN_AREA], extent)}" fill="{hexadecimal(tint(state))}"/>'
        )
        lines = joint_lines(faces, state)
        dashes = "" if state == JointState.OPEN else f' stroke-dasharray="{2.6 * width:.0f} {1.3 * width:.0f}"'
        look = f'stroke="{colour}" stroke-width="{(0.75 if state == JointState.OPEN else 1) * width:.1f}"'
        parts.append(f'<path d="{_path(lines, extent, "")}" fill="none" {look}{dashes}/>')
    for x, y in np.rint(scale * (shape.hinges - [left, top]) * [1, -1]).astype(int):
        parts.append(f'<circle cx="{x}" cy="{y}" r="{1.2 * width:.1f}" fill="#fff" stroke="#404040"/>')
    if len(shape.crosses):
        crosses = _path(shape.crossed_lines(1.2 * width / scale), extent, "")
        parts.append(f'<path d="{crosses}" fill="none" stroke="{CRUSHED}" stroke-width="{width:.1f}"/>')
    return "".join([*parts, "</svg>"])


def _path(lines: Iterable[Array], extent: Extent, close: str = "z") -> str:
    left, right, _, top = extent
    scale = UNITS / (right - left)
    return "".join(f"M{_steps(scale * (line - [left, top]) * [1, -1])}{close}" for line in lines)


def _steps(points: Array) -> str:
    """Format the first point and the steps between points in whole units, without the spaces before minus signs."""
    whole = np.rint(points).astype(int)
    start, steps = (" ".join(map(str, part.ravel())) for part in (whole[0], np.diff(whole, axis=0)))
    return f"{start}l{steps}".replace(" -", "-")


def hexadecimal(colour: Iterable[float]) -> str:
    """A colour as ``#rrggbb``."""
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour)
