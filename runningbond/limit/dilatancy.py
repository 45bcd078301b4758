"""Whether a collapse load of associated joints holds for friction that does not dilate, too."""

import numpy as np

from runningbond.joints import wall_points, wall_strength
from runningbond.scene import Array, Scene

from .kinematics import jump_operator

NO_SLIP = 1e-6  # slip [m] that counts as none in a mechanism whose fastest corner moves by 1 m


def sliding_dilates(scene: Scene, motion: Array) -> bool:
    """Whether a mechanism ``(nb, 3)`` of associated joints opens some only because they slide.

    Where none does, joints that slide are off each other anyway and carry no friction: forces and mechanism prove
    their load for friction without dilatancy just as well.
    """
    points = wall_points(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    opening, slip = jump.opening @ motion.ravel(), np.abs(jump.slip @ motion.ravel())
    friction = wall_strength(scene, points).friction
    return bool(((slip > NO_SLIP) & (opening < friction * slip + NO_SLIP)).any())
