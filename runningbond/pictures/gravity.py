"""Symbols for the direction of gravity: ground that tilts under a wall, and a gravity other than the usual one."""

import math

import numpy as np

from runningbond.scene import Array

from .labels import Spot
from .quantities import minus
from .sketch import Sketch
from .style import DARK, DEAD

TILT, STEEPEST = 2.2, math.radians(12)
"""Largest drop of tilted ground in a drawing, in lengths `Sketch.a`, and its steepest slope [rad]."""


def draw_tilt(sketch: Sketch, low: Array, high: Array, direction: tuple[float, float]) -> None:
    """Draw a ground line that falls in the given direction below a level one, and the angle between them."""
    a, sense = sketch.a, math.copysign(1.0, direction[0])
    base = low[1] - 0.9 * a
    start, end = (low[0] - a, high[0] + a)[:: int(sense)]
    fall = min(TILT * a, abs(end - start) * math.tan(STEEPEST))
    sketch.line("live load", [(start, base), (end, base)], lw=0.6, ls=(0, (4, 2)))
    sketch.line("live load", [(start, base), (end, base - fall)], lw=1.2)
    near = end - sense * 0.12 * abs(end - start)
    sketch.arrow("live load", [(near, base), (near, base - 0.88 * fall)], DARK)
    place = np.array([near - sense * 0.4 * a, base - 0.9 * fall])
    sketch.label("λ = tan α", [Spot(place, (-sense, -1.0)), Spot(np.array([end, base - fall]), (-sense, -1.0))])
    at = np.array([near - sense * 0.2 * a, base - 0.5 * fall])
    sketch.label("α", [Spot(at, (-sense, 0.0)), Spot(at + sense * np.array([0.6 * a, 0]), (sense, 0.0))])


def draw_gravity(sketch: Sketch, low: Array, high: Array, gravity: tuple[float, float]) -> None:
    """Draw the vector of gravity beside everything else, on the side on which loads take less room."""
    a, size = sketch.a, math.hypot(*gravity)
    left, right, *_ = sketch.room() or (low[0], high[0])
    left, right = min(left, low[0]), max(right, high[0])
    sense = 1.0 if right - high[0] <= low[0] - left else -1.0
    half = 1.2 * a * np.array(gravity) / size
    x = (right if sense > 0 else left) + sense * (0.8 * a + abs(half[0]))
    middle = np.array([x, low[1] + 0.6 * (high[1] - low[1])])
    sketch.arrow("gravity", [middle - half, middle + half], DEAD)
    text = f"g = {minus(size)} m/s²" if not gravity[0] else f"g = ({minus(gravity[0])}, {minus(gravity[1])}) m/s²"
    spot = Spot(middle + [sense * abs(half[0]), 0.0], (sense, 0.0), upright=True)
    sketch.label(text, [spot, Spot(middle, (sense, 0.0))], DEAD)
