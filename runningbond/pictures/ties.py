"""Ties: lines between end plates, or from an end plate to a hatched anchor."""

import numpy as np

from runningbond.scene import ANCHOR, Scene

from .deformed_shape import DeformedShape
from .labels import Spot
from .quantities import readable
from .sketch import Sketch
from .style import SMALL_TYPE

TIE = "0.1"
"""Colour of ties."""


def draw_ties(sketch: Sketch, shape: DeformedShape) -> None:
    """Draw ties between the displaced positions of their ends; several ties are numbered as in tables and messages."""
    ties, a = shape.scene.ties, sketch.a
    for k in range(len(ties)):
        ends = np.array([shape.drawn_at(*end) for end in zip(ties.ends[k], ties.block[k], strict=True)])
        along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
        across = np.array([-along[1], along[0]])
        sketch.line("tie", ends, color=TIE, lw=1.6)
        for end, block, outward in zip(ends, ties.block[k], (-along, along), strict=True):
            plate = end + np.outer([-0.6 * a, 0.6 * a], across)
            if block == ANCHOR:
                plate = end + np.outer([-a, a], across)
                back = plate[::-1] + 0.9 * a * outward
                sketch.area("anchor", [*plate, *back], fc="white", ec="0.45", hatch="//////", lw=0)
            sketch.line("anchor" if block == ANCHOR else "tie plate", plate, color=TIE, lw=2.2)
        if len(ties) > 1:
            middle = ends.mean(axis=0)
            spots = [
                Spot(
                    middle + 0.2 * a * side,
                    (float(np.sign(side[0])) if abs(side[0]) > 0.4 else 0.0, float(np.sign(side[1]))),
                )
                for side in (across, -across)
            ]
            sketch.label(f"tie {k}", spots, TIE, SMALL_TYPE)


def tie_kinds(scene: Scene) -> dict[str, list[int]]:
    """Group identical ties by their description in a legend."""
    ties = scene.ties
    kinds: dict[str, list[int]] = {}
    for k in range(len(ties)):
        preload = f", preload {readable(ties.preload[k], 'N')}" if ties.preload[k] else ""
        stiffness, strength = readable(ties.young[k] * ties.area[k], "N"), readable(ties.yield_force[k], "N")
        text = f"E A = {stiffness}, yields at {strength}{preload}"
        kinds.setdefault(text, []).append(k)
    return kinds
