"""Small against finite displacements: how far a wall may move before its small-displacement curve is no longer true.

A block b × h that rocks about its corner resists λ(θ) = tan(α − θ), tan α = b/h, when its upper corner has moved by
u = h sin θ; at small displacements it resists b/h for ever. So a share d of λ is lost at

    u = h sin(α − arctan((1 − d) b/h)) ≈ d h / (λ + 1/λ),  λ = b/h,                                          (1)

and walls that turn over about a corner of their base as a whole lose about as much, with their own λ and height.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from dem.dynamic import finite_pushover
from dem.static import dem_static
from runningbond.compare.figures import COLOURS, bare
from runningbond.scene import Array, Mortar, Scene

from .blocks import one_block, rounded
from .finding import Edge, Finding

LOSSES = (0.01, 0.02, 0.05, 0.1)
"""Shares of the small-displacement λ whose loss is looked for."""

WIDTH, HEIGHT = 0.5, 1.0
"""Of the block [m]."""

SOFTER = 0.1
"""Mortar's modulus of the walls, in the published one: past the peak λ does not depend on it, the time step does."""

SPEEDS = (5e-4, 1.25e-4)
"""Mean speeds of the blocks along the live load [m/s], the first to show that the second is slow enough."""

LOCAL = 0.1
"""Local damping: what there is of it drags on blocks that move, and adds to λ."""

FARTHEST = 0.25
"""Displacement to which they are pushed, in block widths."""

SMOOTHED = 15
"""Rows of a curve that are averaged: blocks that slip are heard in λ."""


@dataclass(frozen=True, eq=False)
class Loss:
    """What a scene loses of its small-displacement λ as it moves.

    Parameters
    ----------
    name
        What is pushed.
    speed
        How fast [m/s].
    peak
        λ at small displacements, in the end.
    width, height
        Of a block, and of the whole [m].
    moved, lost : (n,) float
        Displacement of the control point from the peak on, in block widths, and share of λ that is lost.
    small, finite : (n,) float
        λ of both curves there.
    """

    name: str
    speed: float
    peak: float
    width: float
    height: float
    moved: Array
    lost: Array
    small: Array
    finite: Array

    def at(self, loss: float) -> float:
        """Displacement, in block widths, from which on more than a share of λ is lost."""
        last = int(np.flatnonzero(self.lost < loss)[-1])
        assert last + 1 < len(self.lost), f"{self.name} is not pushed far enough"
        return float(np.interp(loss, self.lost[last : last + 2], self.moved[last : last + 2]))

    def as_a_block(self, loss: float) -> float:
        """The same for one block of the same λ and height that rocks, (1)."""
        alpha = math.atan(self.peak)
        return self.height * math.sin(alpha - math.atan((1 - loss) * self.peak)) / self.width


def loss(name: str, scene: Scene, width: float, speed: float) -> Loss:
    """Push a scene at small and at finite displacements.

    Parameters
    ----------
    name
        What it is called.
    scene
        The scene.
    width
        Of one of its blocks [m].
    speed
        Mean speed of the blocks along the live load [m/s].
    """
    distance = FARTHEST * width
    static = dem_static(scene, collapse=2 * distance / scene.lowest_block).curve
    curve = finite_pushover(scene, distance, speed=speed, local=LOCAL)
    # λ is the mean since the last row.
    window = np.ones(SMOOTHED) / SMOOTHED
    u = np.convolve((curve[1:, 0] + curve[:-1, 0]) / 2, window, "valid")
    finite = np.convolve(curve[1:, 2], window, "valid")
    peak = int(np.argmax(finite))
    u, finite = u[peak:], finite[peak:]
    small = np.interp(u, static[:, 0], static[:, 1])
    low, high = scene.blocks.extent(scene.wall)
    return Loss(
        name, speed, float(static[-1, 1]), width, float(high[1] - low[1]), u / width, 1 - finite / small, small, finite
    )


def block() -> tuple[str, Scene, float]:
    """A block that rocks: its name, its scene and its width [m]."""
    return "block", one_block(WIDTH, HEIGHT, 2.0, 1e10), WIDTH


def wall(name: str) -> tuple[str, Scene, float]:
    """A published wall with rounded corners and a softer mortar: its name, its scene and its blocks' width [m]."""
    scene = rounded(f"wall-{name.lower()}")
    assert isinstance(scene.joint.elasticity, Mortar)
    assert scene.bond is not None
    mortar = replace(scene.joint.elasticity, young=SOFTER * scene.joint.elasticity.young)
    return name, replace(scene, joint=replace(scene.joint, elasticity=mortar)), scene.bond.width


def losses(pushed: Sequence[tuple[str, Scene, float]], speeds: Sequence[float] = SPEEDS) -> list[Loss]:
    """Push scenes at several speeds."""
    return [loss(*each, speed) for each in pushed for speed in speeds]


def block_edges(found: Loss) -> list[Edge]:
    """Where a block has lost so much, beside (1)."""
    return [
        Edge(f"u/b at which a block has lost {100 * d:.0f} % of λ", found.at(d), found.as_a_block(d), 2e-3)
        for d in LOSSES
    ]


def experiment() -> Finding:
    """Push a block, W1 and W2 at small and at finite displacements."""
    found = losses([block(), wall("W1"), wall("W2")])
    slow = [each for each in found if each.speed == min(SPEEDS)]
    walls = [each for each in slow if each.name != "block"]
    first = LOSSES[0]
    measured = [
        Edge(f"u/b at which {each.name} has lost {100 * d:.0f} % of λ", each.at(d)) for each in walls for d in LOSSES
    ]
    least = min(each.at(first) * each.width for each in walls)
    apart = max(abs(each.at(d) / each.as_a_block(d) - 1) for each in walls for d in LOSSES)
    return Finding(
        "Small displacements: how far a wall may move before λ is no longer that of its undeformed shape",
        ("what", "speed [m/s]", "λ, small", *(f"u/b at {100 * d:.0f} % lost" for d in LOSSES), *ESTIMATES),
        [_row(each) for each in found],
        [*block_edges(slow[0]), *measured],
        f"Collapse loads at small displacements are good to {100 * first:.0f} % while the top has moved by less than "
        f"{1e3 * least:.0f} mm on these walls. A share d is lost at about u = d H / (λ + 1/λ), as by one block of "
        f"the wall's height H and λ: exact for a block, within {100 * apart:.0f} % on the walls.",
        "A model at small displacements says so in its message (collapse, small displacements) and goes on at the same "
        "λ; `dem.dynamic.finite_pushover` gives the curve that falls.",
        lambda figure: draw(figure, slow),
    )


ESTIMATES = tuple(f"as one block, {100 * d:.0f} %" for d in LOSSES)


def _row(each: Loss) -> tuple[str | float, ...]:
    found = (each.at(d) for d in LOSSES)
    return each.name, each.speed, each.peak, *found, *(each.as_a_block(d) for d in LOSSES)


def draw(figure: Figure, found: Sequence[Loss]) -> None:
    """Both curves of each scene past its peak, and what is lost between them."""
    curves, lost = figure.subplots(1, 2)
    shares = np.linspace(0.001, 0.2, 50)
    for each, colour in zip(found, COLOURS, strict=False):
        curves.plot(each.moved, each.finite, color=colour, lw=1.4)
        curves.plot(each.moved, each.small, color=colour, lw=1.0, ls="--")
        lost.plot(each.moved, 100 * each.lost, color=colour, lw=1.4)
        lost.plot([each.as_a_block(d) for d in shares], 100 * shares, color=colour, lw=1.2, ls=":")
    names = [Line2D([], [], color=colour, label=each.name) for each, colour in zip(found, COLOURS, strict=False)]
    curves.plot([], [], color="0.3", ls="--", lw=1.0, label="small displacements")
    curves.plot([], [], color="0.3", lw=1.4, label="finite displacements")
    curves.set(ylabel="load multiplier λ", ylim=(0, None), xlim=(0, FARTHEST))
    curves.legend(frameon=False, fontsize=8, loc="lower left")
    dotted = Line2D([], [], color="0.3", ls=":", lw=1.2, label="one block of that λ and height")
    lost.set(ylabel="λ lost [%]", xlim=(0, 0.2), ylim=(0, 15))
    lost.set_yticks([100 * d for d in LOSSES] + [15])
    lost.grid(axis="y", color="0.9", lw=0.8)
    lost.legend(handles=[*names, dotted], frameon=False, fontsize=8, loc="lower right")
    for axes in (curves, lost):
        axes.set_xlabel("displacement of the top, in block widths u / b")
        bare(axes)
