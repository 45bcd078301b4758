"""Test rigs at finite displacements: they prescribe the path of a point of the beam, and apply a force to it.

The driven point is at p from the beam's centroid. With the beam's rotation θ it moves horizontally by
u_x + p_x (cos θ − 1) − p_y sin θ, and a horizontal force on it has a moment −(p_x sin θ + p_y cos θ) per unit. A dead
force F with a fixed line of action exerts a moment −(u_x F_y − u_y F_x) about the centroid, displaced by u.
"""

import math
from typing import NamedTuple

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Indices, Scene, Unsigned


class Rig(NamedTuple):
    """A driven beam."""

    freedom: Unsigned  # (3,) indices in the motion of its translations and its rotation
    arm: Array  # (2,) from its centroid to the driven point [m]
    force: Array  # (2,) dead force with a fixed line of action [N]
    work: Array  # (1,) written by the steps: work of that force's moment [J]

    @classmethod
    def of(cls, scene: Scene, rigid: Indices) -> "Rig | None":
        """The rig of a scene with a driven beam, else None, from indices of the blocks' rigid motions ``(nb, 3)``."""
        beam = scene.beam
        if beam is None or beam.block is None or not scene.drive_path:
            return None
        _, (at, *_), _ = scene.load.live[0].control(scene)
        force = np.array(beam.force) * (beam.force_line == "fixed")
        arm = at - scene.blocks.centroid[beam.block]
        return cls(rigid[beam.block].astype(np.uint64), arm, force, np.zeros(1))

    def displacement(self, motion: Array) -> float:
        """Horizontal displacement of the driven point [m]."""
        x, _, spin = motion[self.freedom]
        return float(x + self.arm[0] * (math.cos(spin) - 1) - self.arm[1] * math.sin(spin))


NO_RIG = Rig(np.zeros(0, dtype=np.uint64), np.zeros(2), np.zeros(2), np.zeros(1))


@kernel
def turn_rig(rig: tuple[Unsigned, Array, Array, Array], motion: Array, live: Array) -> float:
    """Write the live load at the present position of the beam; return the moment of the force with a fixed line."""
    freedom, arm, force, _ = rig
    x, y, spin = motion[freedom[0]], motion[freedom[1]], motion[freedom[2]]
    live[freedom[2]] = -live[freedom[0]] * (arm[0] * math.sin(spin) + arm[1] * math.cos(spin))
    return float(y * force[0] - x * force[1])
