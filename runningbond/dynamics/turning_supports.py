"""Supports that rotate, at finite displacements."""

import math
from typing import NamedTuple

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Indices, Scene, Unsigned


class TurningSupports(NamedTuple):
    """Supports that rotate about a point that moves along a straight line."""

    freedom: Unsigned  # (n, 3) indices in the motion of their translations and rotations
    arm: Array  # (n, 2) from that point to their undeformed centroids [m]
    rate: Array  # (3,) displacement of the point [m] and rotation [rad] at λ = 1

    @classmethod
    def of(cls, scene: Scene, rigid: Indices) -> "TurningSupports | None":
        """The rotating supports of a scene, given the indices of its blocks' rigid motions ``(nb, 3)``; or None."""
        settlement = scene.settlement
        if settlement is None or not settlement.rotation_angle:
            return None
        moving = np.flatnonzero(scene.support_motion.any(axis=1))
        rate = np.array([*settlement.by, math.radians(settlement.rotation_angle)])
        arm = scene.blocks.centroid[moving] - settlement.centre
        return cls(rigid[moving].astype(np.uint64), arm, rate)


NO_TURNING_SUPPORTS = TurningSupports(np.zeros((0, 3), dtype=np.uint64), np.zeros((0, 2)), np.zeros(3))


@kernel
def turn_supports(supports: tuple[Unsigned, Array, Array], motion: Array, way: Array) -> None:
    """Write the rate of motion of supports, per unit of λ, at their present rotation in a motion ``(nd,)``."""
    freedom, arm, rate = supports
    for k in range(freedom.shape[0]):
        spin = motion[freedom[k, 2]]
        c, s = math.cos(spin), math.sin(spin)
        way[freedom[k, 0]] = rate[0] - rate[2] * (s * arm[k, 0] + c * arm[k, 1])
        way[freedom[k, 1]] = rate[1] + rate[2] * (c * arm[k, 0] - s * arm[k, 1])
