"""Elastic displacement of rigid blocks whose joints neither open nor slip: how far a wall moves before it collapses."""

import numpy as np
from scipy.sparse import block_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from runningbond.joints import gauss, joint_points, wall_stiffness
from runningbond.joints.stiffness import block_compliance
from runningbond.scene import Array, Scene

from .kinematics import jump_operator, live_load, movable_freedoms, pin_operator

SINGULAR = 1e9
"""Motion, relative to that of the stiffest spring under the largest load, above which blocks count as loose."""


def elastic_displacement(scene: Scene, multiplier: float) -> float | None:
    """Largest x or y displacement of a centroid [m] under the live load only, while joints neither open nor slip.

    A lower bound of the displacement at collapse; it includes the compliance of deformable blocks. None if a joint has
    no stiffness or if the pins leave blocks loose.
    """
    if any(each.elasticity is None for each in scene.materials_of_joints):
        return None
    points = joint_points(scene.joints, scene.thickness_of_joints, gauss(2))  # exact for jumps linear along a joint
    normal, shear = (k * points.area for k in wall_stiffness(scene, points.joint))
    free = movable_freedoms(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    opening, slip = jump.opening[:, free], jump.slip[:, free]
    inner = csr_array(opening.T @ diags_array(normal) @ opening + slip.T @ diags_array(shear) @ slip)
    stiffest = float(max(normal.max(initial=0.0), shear.max(initial=0.0)))
    motion = held_motion(inner, pin_operator(scene)[:, free], multiplier * live_load(scene)[free], stiffest)
    if motion is None:
        return None
    return float(np.abs(motion.reshape(-1, 3)[:, :2]).max(initial=0.0) / (1 - block_compliance(scene)))


def held_motion(stiffness: csr_array, pins: csr_array, load: Array, stiffest: float) -> Array | None:
    """Motion of blocks on springs.

    Parameters
    ----------
    stiffness : (nd, nd) sparse
        Stiffness matrix of the springs [N/m].
    pins : (n_pins, nd) sparse
        Operator of the displacements that are held.
    load : (nd,) float
        Loads [N, N, N m].
    stiffest
        Stiffness of the stiffest spring [N/m].

    Returns
    -------
    (nd,) float or None
        None if blocks are loose.
    """
    fixed = csr_array(stiffest * pins)
    loose = csr_array((pins.shape[0], pins.shape[0]))
    held = block_array([[stiffness, csr_array(fixed.T)], [fixed, loose]])
    try:
        motion: Array = splu(csc_array(held)).solve(np.concatenate([load, np.zeros(pins.shape[0])]))[: len(load)]
    except RuntimeError:
        return None
    return motion if np.abs(motion).max() * stiffest <= SINGULAR * np.abs(load).max() else None
