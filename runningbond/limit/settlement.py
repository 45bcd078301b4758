"""The reaction share of a support that moves: what it still bears of the wall's dead load."""

import numpy as np

from runningbond.scene import Scene, SceneError

from .kinematics import dead_load


def reaction_unit(scene: Scene) -> float:
    """Work [J] in which that of a moving support's reaction, against its motion at λ = 1, is the share λ.

    The resultant of all dead loads on movable blocks, times the largest displacement of an end of the support's joints.

    Raises
    ------
    SceneError
        For blocks without any resultant load: nothing follows the support.
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
