"""What a joint does, sticks, slides or opens, read from its jumps and tractions."""

from enum import IntEnum

import numpy as np

from runningbond.joints import JointPoints, wall_caps, wall_cones, wall_stiffness
from runningbond.results.mechanism import MAX_OVERLAP
from runningbond.scene import Array, Indices, Mask, Scene

VISIBLE = 0.01
"""Jump of a mechanism, in motions of its fastest corner, below which a picture does not show it."""

NORMALITY = 1e-4
"""Lack of opening, in motions of the fastest corner, that rounding in a program leaves in an associated mechanism."""

AT_THE_LIMIT = 1e-3
"""Shear below the strength, relative to it, that counts as sliding."""

ROUNDING = 1e-6
"""Traction, relative to the wall's largest, that is none: a joint that bears nothing has what programs leave of it."""

CRUSHED = 0.01
"""Plastic closure below which a joint is not said to be crushed, in elastic closures at its compressive strength."""


class JointState(IntEnum):
    """State of a joint point; the numbers are those in files."""

    STICK = 0
    SLIDE = 1
    OPEN = 2
    DEBONDED = 3
    """Neither slides nor is open, but its bond is broken (damage 1)."""
    CRUSHED = 4
    """Is not open, and has been crushed: under its compressive strength it closed for good."""


_BY_WEIGHT = (JointState.STICK, JointState.DEBONDED, JointState.SLIDE, JointState.CRUSHED, JointState.OPEN)
"""States, that with the most to show last."""


def joint_states(state: Indices) -> Indices:
    """State of each joint ``(n,)`` from those of its points ``(n, k)``: the one with the most to show."""
    most = np.argsort(_BY_WEIGHT)[state].max(axis=1, initial=0)
    return np.asarray(np.array(_BY_WEIGHT)[most], dtype=np.int64)


def states_of_mechanism(
    scene: Scene, points: JointPoints, opening: Array, slip: Array, closure: Array | None = None
) -> Indices:
    """States of joint points ``(np,)`` by the jumps of a mechanism whose fastest corner moves by one metre.

    A joint opens if a picture shows it open. Where flow is associated, as in `limit`, a joint that slides opens by
    tan φ times its slip, and only what exceeds that is opening. Such a mechanism is recognised by its jumps: nowhere
    does it open by less. One with a compressive strength is crushed where its blocks overlap by more than elastic
    joints leave in a mechanism; where its plastic closure [m] is known, it has crushed as well, for gaps close too.
    """
    dilation = wall_cones(scene, points.joint)[0] * np.abs(slip)
    associated = bool((opening >= dilation - NORMALITY).all())
    opens = opening > (dilation if associated else 0.0) + VISIBLE
    slides = np.abs(slip) > VISIBLE
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
    """States of joint points ``(np,)`` by their jumps [m], tractions [Pa], damage and plastic closure [m].

    A point is open where it has opened farther than tension can stretch it, and crushed where it has closed for good
    as far as at its compressive strength, and by a part of what is elastic. Joints of the scene need a stiffness.
    One that neither bears nor opens by more than rounding sticks.
    """
    friction, tension, shear = wall_cones(scene, points.joint)
    stiffness, _ = wall_stiffness(scene, points.joint)
    sound = 1 - damage
    strength = sound * shear + friction * np.maximum(0.0, sound * tension - normal)
    none = ROUNDING * float(np.abs([normal, tangential]).max(initial=0.0))
    opens = opening > np.where(damage < 1, tension / stiffness, 0.0) * (1 + 1e-9) + none / stiffness
    slides = (np.abs(tangential) >= (1 - AT_THE_LIMIT) * strength) & (np.hypot(normal, tangential) > none)
    crushed = _has_crushed(scene, points, closure)
    kinds = [JointState.OPEN, JointState.CRUSHED, JointState.SLIDE, JointState.DEBONDED]
    return np.select([opens, crushed, slides, damage >= 1], kinds, JointState.STICK)


def _has_crushed(scene: Scene, points: JointPoints, closure: Array | float) -> Mask:
    """Whether joint points ``(np,)`` have closed for good [m] by more than what counts."""
    cap, peak = wall_caps(scene, points.joint)
    stiffness, _ = wall_stiffness(scene, points.joint)
    return np.asarray(closure > np.maximum(peak, CRUSHED * cap / stiffness))
