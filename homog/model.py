"""Model ``homog``: collapse multiplier of a dry running-bond panel under lateral load, as a homogenised continuum.

The lateral load is proportional to the weight. One crack rises from the lower corner on the far side of the load, and
the wedge above it rotates about that corner. Blocks hold together up to a crack slope tan ψ = s, ψ from the horizontal,
with

    s = (m / tan φ)^{1/2},    m = 2 a / b,    r = H / L

(Baraldi, Reccia & Cecchi, Eq. 6, with the exponent corrected: the printed −1/2 in the second branch makes the
multiplier jump at r = s; see docs/errata.md), or less if tan φ is above 1 (`crack_slope`).
"""

import math
import time

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Bond, Scene, SceneError, check_scene
from runningbond.scene.ranges import ABOVE_ZERO, AT_LEAST_ZERO

from .bond import head_places

FINENESS = (1, 4, 8, 16)
"""Smallest min(number of courses, blocks per course) for which each pair of `OFF` applies."""

OFF = {
    False: ((-0.646, 0.0), (-0.646, 0.0), (-0.566, 0.0), (-0.420, 0.084)),
    True: ((-0.823, -0.038), (-0.726, 0.054), (-0.547, 0.280), (-0.267, 0.315)),
}
"""Smallest and largest relative deviation from the limit load of the block model, a pair for each `FINENESS`: for
blocks no taller than wide (False), and for taller ones (True). Measured on 2816 panels of up to 1500 blocks,
tan φ 0.3 to 1 (benchmarks/studies/homogenised.py)."""

TEXTURES, MOST_SLENDER = (0.25, 6.0), 12.0
"""Smallest and largest b/a and largest H/L for which `OFF` holds. Long panels were measured from H/L = 1/3; their load
does not depend on their length, because the wedge that turns is shorter."""

LOAD_TOLERANCE = 1e-8
"""Tolerated deviation of loads from the weight, as a share of it."""


def crack_slope(block_width: float, block_height: float, friction: float) -> float:
    """Steepest crack slope s of blocks b × a [m] with friction tan φ; inf without friction.

    The jump across a crack is perpendicular to it. Blocks can follow as long as head and bed joints open by at least
    tan φ times their slip (`StrengthDomain`). Bed joints allow s = (m / tan φ)^{1/2}, and so do head joints if
    2 μ² (μ m)^{1/2} ≤ 1 + μ m, which holds for all blocks up to μ = 1. Otherwise s is the smallest positive root of
    (1/μ + m − μ) s² − 2 μ m s + m = 0.

    Raises
    ------
    SceneError
        For numbers that are not valid sizes or not a valid friction.
    """
    b, a = ABOVE_ZERO.take("block_width", block_width), ABOVE_ZERO.take("block_height", block_height)
    m, mu = 2 * a / b, AT_LEAST_ZERO.take("friction", friction)
    if mu == 0.0:
        return math.inf
    if 2 * mu**2 * math.sqrt(mu * m) <= 1 + mu * m:
        return math.sqrt(m / mu)
    return m / (mu * m + math.sqrt((mu * m) ** 2 - m * (1 / mu + m - mu)))


def lateral_multiplier(slenderness: float, slope: float, friction: float) -> float:
    """Collapse multiplier λ of a panel of slenderness r = H / L with crack slope s.

    λ = 1 / (2 s) if r ≤ s, else (3 r − 2 s) / (3 r² − s²), and at most tan φ, at which the whole panel slides.

    Raises
    ------
    SceneError
        For numbers that are not a valid slenderness, slope (inf is valid) or friction.

    Examples
    --------
    >>> round(lateral_multiplier(slenderness=0.5, slope=crack_slope(0.24, 0.06, 0.6), friction=0.6), 4)
    0.5477
    """
    r, s = ABOVE_ZERO.take("slenderness", slenderness), slope
    if s != math.inf:
        s = ABOVE_ZERO.take("slope", slope)
    friction = AT_LEAST_ZERO.take("friction", friction)
    turning = 1 / (2 * s) if r <= s else (3 * r - 2 * s) / (3 * r**2 - s**2)
    return min(turning, friction)


def homog(scene: Scene) -> Outcome:
    """Collapse multiplier of a dry running-bond panel under lateral load, as a homogenised continuum.

    The scene is a full rectangular panel on a frictional base or a fixed first course, from whose top its height is
    then measured; any other scene raises a `SceneError`, also one whose joints crush. The outcome has no bracket: a
    mechanism of the continuum proves that the multiplier is an upper bound for the continuum, but for the wall of
    blocks it is an estimate that may be too high or too low.
    """
    check_scene(scene)
    start = time.perf_counter()
    bond = _bond(scene)
    low, high = scene.blocks.extent(~scene.fixed)
    length, height = high - low
    friction = scene.materials_of_joints[0].friction
    slope = crack_slope(bond.width, bond.height, friction)
    multiplier = lateral_multiplier(height / length, slope, friction)
    sliding = "sliding" if multiplier == friction else "turning about a crack"
    known = deviation(bond, length, height)
    if known is None:
        within = f"b/a from {TEXTURES[0]:g} to {TEXTURES[1]:g} and H/L up to {MOST_SLENDER:g}"
        off = f"by a share of their limit load that is only known for {within}"
    else:
        least, most = (100 * end for end in known)
        off = f"by {least:.3g} to {most:+.3g} % of their limit load on measured panels of this kind, tan φ 0.3 to 1"
        off += "; others may be off by some percent more"
    return Outcome(
        scene.title,
        "homog",
        "collapse",
        multiplier=multiplier,
        seconds=time.perf_counter() - start,
        message=f"homogenised continuum, {sliding}; an estimate for the wall of blocks, off {off}",
    )


def deviation(bond: Bond, length: float, height: float) -> tuple[float, float] | None:
    """Smallest and largest relative deviation of λ from the limit load of the block model, measured on similar panels.

    None for a panel whose blocks are flatter or taller, or which is more slender, than the measured ones.

    Examples
    --------
    >>> deviation(Bond(0.24, 0.06), length=1.44, height=0.72)
    (-0.646, 0.0)
    """
    texture, slenderness = bond.width / bond.height, height / length
    flat, tall = TEXTURES[1] * (1 + 1e-9), TEXTURES[0] * (1 - 1e-9)
    if not tall <= texture <= flat or slenderness > MOST_SLENDER * (1 + 1e-9):
        return None
    # The length is a whole number of half blocks, rounding errors are removed; 7.5 blocks belong to the class below 8.
    across = min(round(2 * length / bond.width) / 2, round(height / bond.height))
    return OFF[bond.height > bond.width * (1 + 1e-9)][max(0, int(np.searchsorted(FINENESS, across, side="right")) - 1)]


def _bond(scene: Scene) -> Bond:
    """Bond of a scene that meets every assumption of the closed form; other scenes are refused."""
    reason = "it needs a block width and height for all courses" if scene.bond is None else _refusal(scene, scene.bond)
    if scene.bond is None or reason:
        raise SceneError("model homog", f"has no closed form for this scene: {reason}")
    return scene.bond


def _refusal(scene: Scene, bond: Bond) -> str:
    """Message on the first assumption of the closed form that a scene violates; empty if there is none."""
    if scene.extras:
        return f"it needs a wall without {', '.join(scene.extras)}"
    if not _is_lateral(scene):
        return 'it needs load.live.kind = "lateral", to the right or the left, and no dead load but the weight'
    if len(scene.pins):
        return 'it needs support.kind = "base" or "fixed-first-course"'
    if scene.inner_joint is not None:
        return "it needs blocks that do not crack, without inner_joint"
    joint, *others = scene.materials_of_joints
    if len(np.unique(scene.material_of_block[~scene.fixed])) > 1 or others:
        return "it needs one material of blocks and one of joints"
    if joint.cohesion > 0:
        return "it needs dry joints, joint.cohesion = 0"
    if joint.compressive_strength is not None:
        return "it needs joints that do not crush, without joint.compressive_strength"
    if joint.inset > 0:
        return "it needs sharp corners, joint.inset = 0"
    movable = ~scene.fixed
    low, high = scene.blocks.extent(movable)
    area = scene.blocks.area[movable].sum()
    if not np.isclose(area, np.prod(high - low), rtol=1e-6):
        return "it needs a full rectangular panel with flush ends and no openings"
    if not _is_full_bond(scene, bond):
        return "it needs running bond, every course half a block off its neighbours"
    return ""


def _is_lateral(scene: Scene) -> bool:
    """Whether the dead load is each block's weight and the live load the same force sideways."""
    live, dead, weight = scene.live_forces, scene.dead_forces, float(np.hypot(*scene.load.gravity))
    aside = float(np.copysign(weight, live.acceleration[0, 0]))
    return (
        live.on_mass_alone
        and dead.on_mass_alone
        and np.allclose(dead.acceleration, [0.0, -weight], rtol=0, atol=LOAD_TOLERANCE * weight)
        and np.allclose(live.acceleration, [aside, 0.0], rtol=0, atol=LOAD_TOLERANCE * weight)
    )


def _is_full_bond(scene: Scene, bond: Bond) -> bool:
    """Whether a panel has all head joints of running bond: at every second half block, alternating by course."""
    movable = ~scene.fixed
    low, high = scene.blocks.extent(movable)
    heads = head_places(scene, bond, movable[scene.joints.block].all(axis=1) & ~scene.joints.is_bed, movable)
    columns, courses = np.rint((high - low) / np.array([bond.width / 2, bond.height])).astype(int)
    return any(
        heads == {(x, y) for y in range(courses) for x in range(1, columns) if (x + y) % 2 == parity}
        for parity in (0, 1)
    )
