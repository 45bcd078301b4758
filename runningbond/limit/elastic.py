"""Elastic motion of rigid blocks whose joints neither open nor slip: how far a wall gives before it begins to fall."""

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from runningbond.joints import gauss, joint_points, wall_stiffness
from runningbond.joints.stiffness import block_compliance
from runningbond.scene import Scene

from .kinematics import jump_operator, live_load, movable_freedoms, pin_operator

SINGULAR = 1e9
"""Motion, in those of a single spring as stiff as any joint, at which blocks are loose."""


def elastic_displacement(scene: Scene, multiplier: float) -> float | None:
    """Largest displacement of a block [m] under the live load alone, while joints neither open nor slip.

    A lower bound of that at collapse, soft blocks counted in; None without a stiffness, or on pins that leave such a
    wall loose.
    """
    if scene.joint.elasticity is None:
        return None
    points = joint_points(scene.joints, scene.thickness, gauss(2))  # which are exact for what is linear along a joint
    normal, shear = (k * points.area for k in wall_stiffness(scene, points.joint))
    free = movable_freedoms(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    opening, slip = jump.opening[:, free], jump.slip[:, free]
    inner = opening.T @ diags_array(normal) @ opening + slip.T @ diags_array(shear) @ slip
    pins, load = pin_operator(scene)[:, free], multiplier * live_load(scene)[free]
    largest = float(max(normal.max(initial=0.0), shear.max(initial=0.0)))
    held = block_array([[inner, largest * pins.T], [largest * pins, None]])
    try:
        motion = splu(csc_array(held)).solve(np.concatenate([load, np.zeros(pins.shape[0])]))[: len(load)]
    except RuntimeError:
        return None
    if not np.abs(motion).max(initial=0.0) * largest <= SINGULAR * np.abs(load).max(initial=0.0):
        return None
    return float(np.abs(motion.reshape(-1, 3)[:, :2]).max(initial=0.0) / (1 - block_compliance(scene)))
