"""Moments of a collapse: the states that an outcome keeps, and drawings that a slider in a page moves through them."""

import base64
import zlib
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from runningbond.results import Outcome
from runningbond.results.mechanism import carried
from runningbond.scene import Array, Scene

from .captions import load_symbol, load_text
from .deformed_shape import DeformedShape, Extent
from .flat import line_width
from .inline import UNITS, WIDTH, hexadecimal
from .style import AT_REST, DRAWN, FASTEST

MOMENTS = 8
"""Default maximum number of moments that an outcome keeps, in addition to that of the largest load."""

CHART = (16.0, 8.0, 296.0, 108.0)
"""Left, top, width and height of the small load-displacement chart, in SVG units."""


class Instant(Protocol):
    """A wall at one moment: λ and the motions of its blocks ``(nb, 3)`` since it was built."""

    @property
    def multiplier(self) -> float: ...  # noqa: D102

    @property
    def motion(self) -> Array: ...  # noqa: D102


def with_moments(scene: Scene, outcome: Outcome, states: Sequence[Instant], most: int = MOMENTS) -> Outcome:
    """Return the outcome with up to `most` states of its run and that of the largest load, in order.

    They are evenly spaced in the displacement of the wall, or in time under a ground motion.
    None are kept if blocks have cracked into pieces that the scene does not contain.
    """
    if not states or any(len(state.motion) != len(scene.blocks) for state in states):
        return outcome
    loads = np.array([state.multiplier for state in states])
    way = np.arange(float(len(states))) if scene.history else distances(scene, [state.motion for state in states])
    even = [int(np.abs(way - x).argmin()) for x in np.linspace(way[0], way.max(), most)]
    chosen = np.unique([*even, int(loads.argmax())])
    kept = np.concatenate([states[i].motion for i in chosen])
    return replace(outcome, moments=kept, moment_loads=loads[chosen])


def distances(scene: Scene, motions: Sequence[Array] | Array) -> Array:
    """Largest displacement of any corner of the wall in each of several motions ``(nb, 3)``, ``(n,)`` [m]."""
    blocks = scene.blocks
    own = scene.wall[blocks.owner]
    corners = (carried(blocks, blocks.owner[own], blocks.vertices[own], motion) for motion in motions)
    return np.array([np.hypot(*corner.T).max() for corner in corners])


def farthest_shape(scene: Scene, outcome: Outcome) -> DeformedShape:
    """Shape of the wall at its largest displacement, which gives the extent for all of its moments."""
    motions = outcome.moments.reshape(len(outcome.moment_loads), -1, 3)
    motion = motions[distances(scene, motions).argmax()]
    return DeformedShape.of_rigid_blocks(scene, motion, np.zeros(len(scene.joints), np.int64), 0.0)


def moving_wall(scene: Scene, outcome: Outcome, extent: Extent, name: str) -> dict[str, Any]:
    """Data that the template ``moments`` draws and ``moments.js`` animates over the `inline_wall` of a name and extent.

    Motions are the displacement of each block's first corner, in drawing units, and its rotation, both rounded to 1/127
    of the largest. They are ordered by component, moment and block, deflated and encoded in base 64.
    """
    left, right, bottom, top = extent
    scale, wall = UNITS / (right - left), np.flatnonzero(scene.wall)
    motions = outcome.moments.reshape(len(outcome.moment_loads), -1, 3)
    far = distances(scene, motions)
    factor = DRAWN * scene.size / (far.max() or 1.0)
    corner = scene.blocks.vertices[scene.blocks.first[wall]]
    moved = np.array([np.column_stack([carried(scene.blocks, wall, corner, x), x[wall, 2]]) for x in motions])
    moved *= factor * np.array([scale, -scale, 1.0])
    place, turn = float(np.abs(moved[..., :2]).max()) or 1.0, float(np.abs(moved[..., 2]).max()) or 1.0
    whole = np.rint(127 * moved / [place, place, turn]).astype(np.int8)
    height, loads = round((top - bottom) * scale), outcome.moment_loads[:, 0]
    x, y, width, tall = CHART
    most = float(loads.max()) if loads.max() > 0 else 1.0
    path = zip(x + width * far / (far.max() or 1.0), y + tall * (1 - loads.clip(0) / most), strict=True)
    pairs = zip(loads, far, strict=True)
    return {
        "model": outcome.model,
        "name": name,
        "box": f"0 0 {UNITS} {height}",
        "width": f"{0.5 * line_width(scene, extent, (WIDTH, WIDTH * height / UNITS)) * UNITS / (72 * WIDTH):.1f}",
        "motion": base64.b64encode(zlib.compress(whole.transpose(2, 0, 1).tobytes(), 9)).decode(),
        "unit": f"{place / 127:.4g} {turn / 127:.4g}",
        "said": "|".join(f"{load_text(scene, load)}, farthest {1000 * gone:.3g} mm" for load, gone in pairs),
        "symbol": load_symbol(scene),
        "path": " ".join(f"{px:.0f},{py:.0f}" for px, py in path),
        "factor": f"{factor:,.0f}" if factor >= 10 else f"{factor:.2g}",
        "colours": f"{hexadecimal(AT_REST)} {hexadecimal(FASTEST)}",
        "count": len(far),
    }
