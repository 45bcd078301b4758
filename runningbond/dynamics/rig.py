"""What a test rig does at finite displacements: it prescribes the way of a point of the beam, and presses on it.

The point driven is at p from the beam's centroid. With the beam's rotation θ it goes by
u_x + p_x (cos θ − 1) − p_y sin θ, and pushes with a moment −(p_x sin θ + p_y cos θ) per unit of horizontal force.
A dead force F whose line is fixed turns the beam about its centroid, which has gone by u, with −(u_x F_y − u_y F_x).

Dead forces at points of blocks go along with these. At rest, at r from the centroid, they have the moment M = Σ r × F
and the virial V = Σ r · F; where the block has turned by θ the moment is M cos θ − V sin θ.
"""

import math
from typing import Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Indices, Scene, SceneError, Unsigned
from runningbond.scene.ranges import one_of

Displacements: TypeAlias = Literal["small", "finite"]
"""Whether equilibrium is that of the undeformed wall, or of the wall as it has moved."""


class Rig(NamedTuple):
    """A beam that is driven."""

    freedom: Unsigned  # (3,) where in the motion its translations and its rotation stand
    arm: Array  # (2,) from its centroid to the point driven [m]
    force: Array  # (2,) dead force whose line is fixed [N]
    work: Array  # (1,) written by the steps: work of that force's moment [J]

    @classmethod
    def of(cls, scene: Scene, rigid: Indices) -> "Rig | None":
        """The rig of a scene whose beam is led, from where the rigid motions of its blocks stand ``(nb, 3)``."""
        beam = scene.beam
        if beam is None or beam.block is None or not scene.drive_path:
            return None
        _, at, _ = scene.load.live[0].control(scene)
        force = np.array(beam.force) * (beam.force_line == "fixed")
        arm = at - scene.blocks.centroid[beam.block]
        return cls(rigid[beam.block].astype(np.uint64), arm, force, np.zeros(1))

    def displacement(self, motion: Array) -> float:
        """Horizontal displacement of the point driven [m]."""
        x, _, spin = motion[self.freedom]
        return float(x + self.arm[0] * (math.cos(spin) - 1) - self.arm[1] * math.sin(spin))


NO_RIG = Rig(np.zeros(0, dtype=np.uint64), np.zeros(2), np.zeros(2), np.zeros(1))


class TurningLoads(NamedTuple):
    """Dead forces at points of blocks that turn."""

    spin: Unsigned  # (k,) where in the motion the blocks' rotations stand
    moment: Array  # (k,) about the centroid at rest [N m]
    virial: Array  # (k,) [N m]
    more: Array  # (k,) written by the steps: what the moment now is more than at rest [N m]
    work: Array  # (1,) and the work of that [J]

    @classmethod
    def of(cls, scene: Scene, rigid: Indices) -> "TurningLoads | None":
        """Those of a scene, from where the rigid motions of its blocks stand ``(nb, 3)``."""
        dead = scene.dead_forces
        arm = dead.at - scene.blocks.centroid[dead.block]
        moment, virial = np.zeros((2, len(scene.blocks)))
        np.add.at(moment, dead.block, arm[:, 0] * dead.force[:, 1] - arm[:, 1] * dead.force[:, 0])
        np.add.at(virial, dead.block, (arm * dead.force).sum(axis=1))
        turn = np.flatnonzero(((moment != 0) | (virial != 0)) & ~scene.fixed)
        if not len(turn):
            return None
        spin = rigid[turn, 2].astype(np.uint64)
        return cls(spin, moment[turn], virial[turn], np.zeros(len(turn)), np.zeros(1))


NO_TURNING_LOADS = TurningLoads(np.zeros(0, dtype=np.uint64), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(1))


@kernel
def turn_loads(loads: tuple[Unsigned, Array, Array, Array, Array], motion: Array, force: Array) -> None:
    """Add to forces ``(nd,)`` what the moments of turning loads now are more than at rest, and keep it."""
    spin, moment, virial, more, _ = loads
    for k in range(spin.size):
        angle = motion[spin[k]]
        more[k] = moment[k] * (math.cos(angle) - 1.0) - virial[k] * math.sin(angle)
        force[spin[k]] += more[k]


@kernel
def work_of_turned(loads: tuple[Unsigned, Array, Array, Array, Array], velocity: Array, dt: float) -> float:
    """Work of what was kept [J] in a step at a velocity ``(nd,)``."""
    spin, _, _, more, work = loads
    done = 0.0
    for k in range(spin.size):
        done += more[k] * dt * velocity[spin[k]]
    work[0] += done
    return done


@kernel
def turn_rig(rig: tuple[Unsigned, Array, Array, Array], motion: Array, live: Array) -> float:
    """Write the live load where the beam is now, and return the moment of a dead force whose line is fixed."""
    freedom, arm, force, _ = rig
    x, y, spin = motion[freedom[0]], motion[freedom[1]], motion[freedom[2]]
    live[freedom[2]] = -live[freedom[0]] * (arm[0] * math.sin(spin) + arm[1] * math.cos(spin))
    return float(y * force[0] - x * force[1])


def is_finite(displacements: str, model: str, scene: Scene) -> bool:
    """Whether displacements are finite; a `SceneError` for unknown ones, and for a scene that is not taken through."""
    key = f"model {model}: displacements"
    finite = one_of(key, displacements, get_args(Displacements)) == "finite"
    if finite and not scene.drive_path:
        what = 'must be "small" for this scene; finite ones are followed where beam.drive.displacement leads a wall'
        raise SceneError(key, what, displacements)
    return finite


def check_finite(scene: Scene) -> None:
    """Refuse, by a `SceneError`, what models do not know of at finite displacements."""
    for key in scene.extras:
        if key != "load.history" and not ((scene.history or scene.drive_path) and key.startswith("beam")):
            raise SceneError(key, "is not taken at finite displacements; leave it out")
    if not scene.is_beam[scene.pins.block].all():
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
