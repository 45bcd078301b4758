"""Reaction of a moving support as a share of the wall's dead load."""

import numpy as np

from runningbond.scene import Scene, SceneError

from .kinematics import dead_load


def reaction_unit(scene: Scene) -> float:
    """Work [J] that equals a share of 1: of a moving support's reaction against the support's motion at λ = 1.

    It is the resultant of all dead loads on movable blocks times the largest displacement of a joint end on the
    support.

    Raises
    ------
    SceneError
        If the blocks have no resultant load, because then nothing follows the support.
    """
    weight = float(np.hypot(*dead_load(scene).reshape(-1, 3)[~scene.fixed, :2].sum(axis=0)))
    if weight <= 0:
        raise SceneError("load.gravity", "leaves a settlement nothing to move; give the blocks a weight", 0.0)
    return weight * largest_displacement(scene)


def largest_displacement(scene: Scene) -> float:
    """Largest displacement [m] of an end of a joint on moving supports, at λ = 1."""
    block = scene.joints.block[:, :, None]  # (nj, side, end)
    x, y = np.moveaxis(scene.joints.ends[:, None] - scene.blocks.centroid[block], -1, 0)
    u, v, turn = np.moveaxis(scene.support_motion[block], -1, 0)
    return float(np.hypot(u - turn * y, v + turn * x).max())
