"""A mechanism as a small drawing in a page: SVG of few bytes, blocks of one colour in one path."""

from collections.abc import Iterable

import numpy as np

from runningbond.scene import Array

from .deformed_shape import DeformedShape, Extent, outline
from .flat import line_width
from .joint_state import JointState
from .style import OUTLINE, STATE_COLOURS, tint

WIDTH, UNITS, SHADES = 2.4, 700, 24
"""Width on paper [in], whole units that it is drawn in, and shades of a colour."""


def inline_mechanism(shape: DeformedShape, extent: Extent) -> str:
    """A shape within an extent, as an ``svg`` element of the class ``wall``.

    Gaps of what opens are filled, joints that slide dashed, hinges circles, and the undeformed outline is dashed.
    """
    left, right, bottom, top = extent
    scale = UNITS / (right - left)
    height = round((top - bottom) * scale)

    def path(lines: Iterable[Array], close: str = "z") -> str:
        return "".join(f"M{_steps(scale * (line - [left, top]) * [1, -1])}{close}" for line in lines)

    width = line_width(shape.scene, extent, (WIDTH, WIDTH * height / UNITS)) * UNITS / (72 * WIDTH)
    ghost = f'<path d="{path(outline(shape.scene))}" stroke="{_hex(OUTLINE)}" stroke-dasharray="12 8" fill="none"/>'
    parts = [
        f'<svg class="wall" viewBox="0 0 {UNITS} {height}" stroke-width="{0.5 * width:.1f}" aria-hidden="true">',
        ghost,
    ]
    polygons = np.split(shape.placed, shape.first[1:-1])
    colours, kind = np.unique(np.rint(shape.block_colours() * SHADES) / SHADES, axis=0, return_inverse=True)
    for k, colour in enumerate(colours):
        own = (polygon for polygon, one in zip(polygons, kind.ravel(), strict=True) if one == k)
        parts.append(f'<path class="block" d="{path(own)}" fill="{_hex(colour)}"/>')
    for state in shape.states:
        faces, colour = shape.placed_faces[shape.drawn_state == state], STATE_COLOURS[state]
        parts.append(f'<path d="{path(faces)}" fill="{_hex(tint(state))}"/>')
        middle = (faces[:, :2] + faces[:, :1:-1]) / 2
        lines = np.concatenate([faces[:, :2], faces[:, 2:]]) if state == JointState.OPEN else middle
        dashes = "" if state == JointState.OPEN else f' stroke-dasharray="{2.6 * width:.0f} {1.3 * width:.0f}"'
        look = f'stroke="{colour}" stroke-width="{(0.75 if state == JointState.OPEN else 1) * width:.1f}"'
        parts.append(f'<path d="{path(lines, "")}" fill="none" {look}{dashes}/>')
    for x, y in np.rint(scale * (shape.hinges - [left, top]) * [1, -1]).astype(int):
        parts.append(f'<circle cx="{x}" cy="{y}" r="{1.2 * width:.1f}" fill="#fff" stroke="#404040"/>')
    return "".join([*parts, "</svg>"])


def _steps(points: Array) -> str:
    """A point and the steps from one to the next, in whole units; without spaces that a minus makes needless."""
    whole = np.rint(points).astype(int)
    start, steps = (" ".join(map(str, part.ravel())) for part in (whole[0], np.diff(whole, axis=0)))
    return f"{start}l{steps}".replace(" -", "-")


def _hex(colour: Iterable[float]) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour)
