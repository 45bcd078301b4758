"""Hand formulas: the force at which a wall rocks or slides under the vertical load on it, without its own weight.

Stored outcomes of these formulas also depend on the digest of this file, which imports nothing else from its package.
"""

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError

FORMULAS = ("rocking", "sliding")
"""Names of the two hand formulas."""

WHOLE = 0.5
"""Least length, relative to the longest bed, of a bed along which a wall may slide; openings interrupt shorter
beds."""


def by_hand(scene: Scene) -> dict[str, float]:
    """Forces [N] by each of the hand formulas, `FORMULAS`."""
    beam = scene.beam
    if beam is None or beam.drive is None:
        raise SceneError("beam.drive", "is missing; the formulas are of walls that are pushed at a beam")
    (left, bottom), (right, _) = scene.blocks.extent(scene.wall)
    length, force = right - left, pressed(scene)
    if force < 0:
        raise SceneError("beam.force", "lifts the wall; the formulas are of walls that are pressed from above")
    height = scene.blocks.centroid[beam.block, 1] - bottom if beam.drive.at is None else beam.drive.at
    # A beam that does not rotate causes double bending: it presses on one corner of the wall's top.
    lever = length / (2 * height) if beam.condition == "free" else length / height
    return dict(zip(FORMULAS, (force * lever, _sliding(scene)), strict=True))


def pressed(scene: Scene, level: float = -np.inf) -> float:
    """Vertical force on the wall [N]: the beam and its load, and the dead loads on the wall's blocks above a level."""
    weight = 0.0 if scene.beam is None else -scene.beam.mass * scene.load.gravity[1]
    dead = scene.dead_forces
    is_above = scene.blocks.centroid[dead.block, 1] > level
    return float(weight - dead.force[is_above, 1].sum())


def _sliding(scene: Scene) -> float:
    """Smallest N tan φ + c L t [N] of all beds, N of the loads above each; several materials of a bed share its N."""
    joints, tolerance = scene.joints, scene.blocks.tolerance
    (x0, y0), (x1, y1) = joints.ends[:, 0].T, joints.ends[:, 1].T
    flat = np.flatnonzero(np.abs(y1 - y0) <= tolerance)
    order = flat[np.argsort(y0[flat], kind="stable")]
    beds = np.split(order, np.flatnonzero(np.diff(y0[order]) > tolerance) + 1)
    length = np.abs(x1 - x0)
    longest = max(float(length[bed].sum()) for bed in beds)
    friction, cohesion = np.array([(each.friction, each.cohesion) for each in scene.joint_materials]).T
    found = []
    for bed in beds:
        share, material = length[bed], scene.material_of_joint[bed]
        if share.sum() >= WHOLE * longest:
            mean = float(friction[material] @ share / share.sum())
            force = max(0.0, pressed(scene, float(y0[bed].min())))
            found.append(force * mean + float(cohesion[material] @ (share * scene.thickness_of_joints[bed])))
    return min(found)


def formula(scene: Scene, tolerance: float, *, what: str) -> Outcome:
    """Outcome of one of `FORMULAS`, or of the smaller one for any other name; used as the ``solve`` of a model."""
    loads = by_hand(scene)
    load = loads.get(what, min(loads.values()))
    ignored = [("its ties", len(scene.ties) > 0), ("horizontal dead loads", scene.dead_forces.force[:, 0].any())]
    left_out = [what for what, is_there in ignored if is_there]
    message = "worked out by hand" + (f", without {' and '.join(left_out)}" if left_out else "")
    return Outcome(scene.title, what, "collapse", load, load, load, message=message)
