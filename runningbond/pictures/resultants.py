"""Resultants of the joint forces, drawn through their centres of pressure to show the lines of thrust."""

import numpy as np

from runningbond.joints import listed_points
from runningbond.results import Outcome
from runningbond.results.mechanism import turned_frames
from runningbond.scene import Array

from .deformed_shape import DeformedShape, mid_lines, usual_side

MIN_RESULTANT = 0.08
"""Resultant, relative to the largest, up to which none is drawn."""


MAX_DISTANCE = 1.0
"""Largest distance of a drawn resultant beyond the end of its joint, in lengths of the joint."""


def resultants(shape: DeformedShape, outcome: Outcome) -> tuple[Array, float, int]:
    """Lines along the resultants, ``(n, 2, 2)`` [m], the largest resultant [N], and how many are too far to be drawn.

    The longest line has the length `usual_side`. Each is centred at the centre of pressure, which moves with the joint.
    If part of a joint is in tension, the centre may lie beyond the joint, and far away if tension and compression
    nearly cancel. There are no lines for a model that does not list joint forces.
    """
    scene, joints = shape.scene, shape.scene.joints
    points = listed_points(scene, len(outcome.force))
    if points is None or not len(joints):
        return np.zeros((0, 2, 2)), 0.0, 0
    normal, tangent = turned_frames(points, shape.motion) if shape.finite else (points.normal, points.tangent)
    force = outcome.force[:, :1] * normal + outcome.force[:, 1:] * tangent
    start, run = joints.ends[:, 0], joints.ends[:, 1] - joints.ends[:, 0]
    along = ((points.position - start[points.joint]) * run[points.joint]).sum(axis=1) / joints.length[points.joint] ** 2
    # Measured from the middle of the joint. A resultant without a normal component has no centre of pressure.
    arm, pull = along - 0.5, outcome.force[:, 0]
    moment, total = (np.bincount(points.joint, weight, len(joints)) for weight in (pull * arm, pull))
    vector = np.column_stack([np.bincount(points.joint, part, len(joints)) for part in force.T])
    length = np.hypot(*vector.T)
    if not (largest := float(length.max())):
        return np.zeros((0, 2, 2)), 0.0, 0
    large = length > MIN_RESULTANT * largest
    near = large & (np.abs(moment) <= (0.5 + MAX_DISTANCE) * np.abs(total)) & (total != 0)
    share = 0.5 + (moment[near] / total[near])[:, None]
    middle = mid_lines(shape.placed_faces[near])
    centre = (1 - share) * middle[:, 0] + share * middle[:, 1]
    half = 0.5 * usual_side(scene) / largest * vector[near]
    return np.stack([centre - half, centre + half], axis=1), largest, int((large & ~near).sum())
