"""Joint states (stick, slide, open, debonded, crushed), derived from jumps and tractions."""

from enum import IntEnum

import numpy as np

from runningbond.joints import JointPoints, wall_caps, wall_cones, wall_stiffness
from runningbond.results.mechanism import MAX_OVERLAP
from runningbond.scene import Array, Indices, Mask, Scene

VISIBLE_JUMP = 0.01
"""Jump in a mechanism, relative to the motion of its fastest corner, up to which it is not visible in a picture."""

NORMALITY_TOLERANCE = 1e-4
"""Lack of opening, relative to the fastest corner's motion, that solver rounding leaves in associated mechanisms."""

SLIDING_TOLERANCE = 1e-3
"""Relative distance of the shear from its strength within which a point counts as sliding."""

ROUNDING = 1e-6
"""Traction, relative to the wall's largest, that counts as zero: solvers leave this much in unloaded joints."""

MIN_CRUSHING = 0.01
"""Plastic closure up to which a joint is not crushed, relative to the elastic closure at its compressive strength."""


class JointState(IntEnum):
    """State of a joint point; the same numbers are used in files."""

    STICK = 0
    SLIDE = 1
    OPEN = 2
    DEBONDED = 3
    """Neither sliding nor open, but the bond is broken (damage 1)."""
    CRUSHED = 4
    """Not open, but with a plastic closure at the compressive strength."""


_BY_PRIORITY = (JointState.STICK, JointState.DEBONDED, JointState.SLIDE, JointState.CRUSHED, JointState.OPEN)
"""States in ascending priority."""


def joint_states(state: Indices) -> Indices:
    """State of each joint ``(n,)`` from those of its points ``(n, k)``: the one with the highest priority."""
    most = np.argsort(_BY_PRIORITY)[state].max(axis=1, initial=0)
    return np.asarray(np.array(_BY_PRIORITY)[most], dtype=np.int64)


def states_of_mechanism(
    scene: Scene, points: JointPoints, opening: Array, slip: Array, closure: Array | None = None
) -> Indices:
    """States of joint points ``(np,)`` from the jumps of a mechanism whose fastest corner moves by one metre.

    A joint opens if its opening is visible in a picture. With associated flow, as in `limit`, a sliding joint dilates
    by tan φ times its slip, and only the excess counts as opening. Associated flow is recognised by the jumps: no point
    opens by less than that. A joint with a compressive strength is crushed if its blocks overlap by more than elastic
    joints can explain. If its plastic closure [m] is given, this must be large enough too, because gaps also close.
    """
    dilation = wall_cones(scene, points.joint)[0] * np.abs(slip)
    associated = bool((opening >= dilation - NORMALITY_TOLERANCE).all())
    opens = opening > (dilation if associated else 0.0) + VISIBLE_JUMP
    slides = np.abs(slip) > VISIBLE_JUMP
    crushed = np.isfinite(wall_caps(scene, points.joint)[0]) & (opening < -MAX_OVERLAP)
    if closure is not None:
        crushed &= _has_crushed(scene, points, closure)
    kinds = [JointState.OPEN, JointState.CRUSHED, JointState.SLIDE]
    return np.select([opens, crushed, slides], kinds, JointState.STICK)


def states_under_load(
    scene: Scene,
    points: JointPoints,
    opening: Array,
    normal: Array,
    tangential: Array,
    damage: Array,
    closure: Array | float = 0.0,
) -> Indices:
    """States of joint points ``(np,)`` from their jumps [m], tractions [Pa], damage and plastic closure [m].

    A point is open if its opening exceeds the elastic one at its tensile strength, or zero if its bond is broken. It is
    crushed if its plastic closure exceeds that at the compressive strength and `MIN_CRUSHING` of the elastic one. A
    point without traction or opening beyond rounding sticks, unless debonded. The scene's joints need a stiffness.
    """
    friction, tension, shear = wall_cones(scene, points.joint)
    stiffness, _ = wall_stiffness(scene, points.joint)
    sound = 1 - damage
    strength = sound * shear + friction * np.maximum(0.0, sound * tension - normal)
    none = ROUNDING * float(np.abs([normal, tangential]).max(initial=0.0))
    opens = opening > np.where(damage < 1, tension / stiffness, 0.0) * (1 + 1e-9) + none / stiffness
    slides = (np.abs(tangential) >= (1 - SLIDING_TOLERANCE) * strength) & (np.hypot(normal, tangential) > none)
    crushed = _has_crushed(scene, points, closure)
    kinds = [JointState.OPEN, JointState.CRUSHED, JointState.SLIDE, JointState.DEBONDED]
    return np.select([opens, crushed, slides, damage >= 1], kinds, JointState.STICK)


def _has_crushed(scene: Scene, points: JointPoints, closure: Array | float) -> Mask:
    """Whether the plastic closure [m] of joint points is large enough to count as crushed, ``(np,)``."""
    cap, peak = wall_caps(scene, points.joint)
    stiffness, _ = wall_stiffness(scene, points.joint)
    return np.asarray(closure > np.maximum(peak, MIN_CRUSHING * cap / stiffness))
