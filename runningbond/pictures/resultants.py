"""Resultants of the forces in joints, drawn through their centres of pressure: where the thrust runs."""

import numpy as np

from runningbond.joints import listed_points
from runningbond.results import Outcome
from runningbond.scene import Array

from .deformed_shape import DeformedShape

LEAST = 0.08
"""Resultant, relative to the largest, below which none is drawn."""


def resultants(shape: DeformedShape, outcome: Outcome) -> tuple[Array, float]:
    """Lines along the resultants, ``(n, 2, 2)`` [m], and the largest resultant [N].

    The longest is as long as the smaller side of a block; the middle of each is the centre of pressure, carried along
    with the joint. There are none of a model that does not list the forces in its joints.
    """
    scene, joints = shape.scene, shape.scene.joints
    points = listed_points(scene, len(outcome.force))
    if points is None or not len(joints):
        return np.zeros((0, 2, 2)), 0.0
    force = outcome.force[:, :1] * points.normal + outcome.force[:, 1:] * points.tangent
    start, run = joints.ends[:, 0], joints.ends[:, 1] - joints.ends[:, 0]
    along = ((points.position - start[points.joint]) * run[points.joint]).sum(axis=1) / joints.length[points.joint] ** 2
    size = np.abs(outcome.force[:, 0])
    moment, total = (np.bincount(points.joint, weight, len(joints)) for weight in (size * along, size))
    vector = np.column_stack([np.bincount(points.joint, part, len(joints)) for part in force.T])
    length = np.hypot(*vector.T)
    if not (largest := float(length.max())):
        return np.zeros((0, 2, 2)), 0.0
    pressed = (length > LEAST * largest) & (total > 0)
    share = (moment[pressed] / total[pressed])[:, None]
    faces = shape.placed_faces[pressed]
    middle = (faces[:, :2] + faces[:, :1:-1]) / 2
    centre = (1 - share) * middle[:, 0] + share * middle[:, 1]
    half = 0.5 * scene.block_size / largest * vector[pressed]
    return np.stack([centre - half, centre + half], axis=1), largest
