"""Resultants of the forces in joints, drawn through their centres of pressure: where the thrust runs."""

import numpy as np

from runningbond.joints import listed_points
from runningbond.results import Outcome
from runningbond.scene import Array

from .deformed_shape import DeformedShape, mid_lines, usual_side

LEAST = 0.08
"""Resultant, relative to the largest, below which none is drawn."""


FARTHEST = 1.0
"""How far beyond the end of its joint a resultant is drawn, in lengths of the joint."""


def resultants(shape: DeformedShape, outcome: Outcome) -> tuple[Array, float, int]:
    """Lines along the resultants, ``(n, 2, 2)`` [m], the largest resultant [N], and how many pass too far to be drawn.

    The longest is as long as the usual smaller side of blocks; the middle of each is the centre of pressure, carried
    along with the joint. Where a part of a joint pulls that is beside the joint, and far away where pull and pressure
    are nearly the same. There are none of a model that does not list the forces in its joints.
    """
    scene, joints = shape.scene, shape.scene.joints
    points = listed_points(scene, len(outcome.force))
    if points is None or not len(joints):
        return np.zeros((0, 2, 2)), 0.0, 0
    force = outcome.force[:, :1] * points.normal + outcome.force[:, 1:] * points.tangent
    start, run = joints.ends[:, 0], joints.ends[:, 1] - joints.ends[:, 0]
    along = ((points.position - start[points.joint]) * run[points.joint]).sum(axis=1) / joints.length[points.joint] ** 2
    # From the middle of the joint: a resultant without a part across it has no place there.
    arm, pull = along - 0.5, outcome.force[:, 0]
    moment, total = (np.bincount(points.joint, weight, len(joints)) for weight in (pull * arm, pull))
    vector = np.column_stack([np.bincount(points.joint, part, len(joints)) for part in force.T])
    length = np.hypot(*vector.T)
    if not (largest := float(length.max())):
        return np.zeros((0, 2, 2)), 0.0, 0
    large = length > LEAST * largest
    near = large & (np.abs(moment) <= (0.5 + FARTHEST) * np.abs(total)) & (total != 0)
    share = 0.5 + (moment[near] / total[near])[:, None]
    middle = mid_lines(shape.placed_faces[near])
    centre = (1 - share) * middle[:, 0] + share * middle[:, 1]
    half = 0.5 * usual_side(scene) / largest * vector[near]
    return np.stack([centre - half, centre + half], axis=1), largest, int((large & ~near).sum())
