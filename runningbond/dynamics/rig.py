"""Test rigs at finite displacements: they prescribe the path of a point of the beam, and apply a force to it.

The driven point is at p from the beam's centroid. With the beam's rotation θ it moves horizontally by
u_x + p_x (cos θ − 1) − p_y sin θ, and a horizontal force on it has a moment −(p_x sin θ + p_y cos θ) per unit. A dead
force F with a fixed line of action exerts a moment −(u_x F_y − u_y F_x) about the centroid, displaced by u.

Forces at points of blocks move with these points (`body_points`), and their generalised forces on rotations and
deformations differ from those at rest.
"""

import math
from collections.abc import Callable
from typing import Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import ANCHOR, Array, Forces, Indices, Scene, SceneError, Unsigned
from runningbond.scene.ranges import ABOVE_ZERO, one_of

from .body_points import NO_POINTS, BodyPoints, Points, arm_of

Displacements: TypeAlias = Literal["small", "finite"]
"""Whether equilibrium is that of the undeformed wall, or of the deformed wall."""


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


class TurningLoads(NamedTuple):
    """Dead or live forces at points of bodies that rotate."""

    points: BodyPoints  # (n,) points at which they act
    force: Array  # (n, 2) [N]
    # (n + m,) written by the steps: change of the generalised forces on rotations, then on deformations, since rest
    more: Array
    work: Array  # (1,) work of that change [J]


def turning_loads(forces: Forces, points: Callable[[Indices, Array], BodyPoints]) -> TurningLoads | None:
    """The rotating loads among forces; `points` returns those of blocks ``(n,)`` at positions ``(n, 2)`` [m]."""
    on = points(forces.block, forces.at)
    turns = on.arm.any(axis=1) | (np.diff(on.start) > 0)
    if not turns.any():
        return None
    on, force = points(forces.block[turns], forces.at[turns]), forces.force[turns]
    return TurningLoads(on, force, np.zeros(len(on.arm) + len(on.mode)), np.zeros(1))


NO_TURNING_LOADS = TurningLoads(NO_POINTS, np.zeros((0, 2)), np.zeros(0), np.zeros(1))


@kernel
def turn_loads(loads: tuple[Points, Array, Array, Array], motion: Array, force: Array) -> None:
    """Add the change of the generalised forces of rotating loads since rest to forces ``(nd,)``, and store it."""
    points, push, more, _ = loads
    rigid, _, arm, start, mode, shape = points
    n = push.shape[0]
    for k in range(n):
        fx, fy = push[k, 0], push[k, 1]
        x, y, c, s = arm_of(points, k, motion)
        more[k] = (x - arm[k, 0]) * fy - (y - arm[k, 1]) * fx
        force[rigid[k, 2]] += more[k]
        gx, gy = c * fx + s * fy - fx, c * fy - s * fx - fy
        for i in range(start[k], start[k + 1]):
            more[n + i] = shape[i, 0] * gx + shape[i, 1] * gy
            force[mode[i]] += more[n + i]


@kernel
def turn_live(loads: tuple[Points, Array, Array, Array], motion: Array, live: Array) -> None:
    """Update a live load ``(nd,)``, which includes the stored change, to the present positions of its points."""
    points, push, more, _ = loads
    rigid, mode, n = points[0], points[4], push.shape[0]
    for k in range(n):
        live[rigid[k, 2]] -= more[k]
    for i in range(mode.size):
        live[mode[i]] -= more[n + i]
    turn_loads(loads, motion, live)


@kernel
def work_of_turned(loads: tuple[Points, Array, Array, Array], velocity: Array, dt: float) -> float:
    """Work of the stored change [J] in a step at a velocity ``(nd,)``."""
    points, push, more, work = loads
    rigid, _, _, _, mode, _ = points
    done, n = 0.0, push.shape[0]
    for k in range(n):
        done += more[k] * dt * velocity[rigid[k, 2]]
    for i in range(mode.size):
        done += more[n + i] * dt * velocity[mode[i]]
    work[0] += done
    return done


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


@kernel
def turn_rig(rig: tuple[Unsigned, Array, Array, Array], motion: Array, live: Array) -> float:
    """Write the live load at the present position of the beam; return the moment of the force with a fixed line."""
    freedom, arm, force, _ = rig
    x, y, spin = motion[freedom[0]], motion[freedom[1]], motion[freedom[2]]
    live[freedom[2]] = -live[freedom[0]] * (arm[0] * math.sin(spin) + arm[1] * math.cos(spin))
    return float(y * force[0] - x * force[1])


def is_finite(displacements: str, model: str, scene: Scene, distance: float | None = None) -> bool:
    """Whether displacements are finite.

    Raises a `SceneError` for an unknown kind of displacements, for finite ones together with ground motion, and for a
    `distance` [m] unless the live load pushes the wall at finite displacements.
    """
    key = f"model {model}: displacements"
    finite = one_of(key, displacements, get_args(Displacements)) == "finite"
    if finite and scene.history:
        raise SceneError(key, "is not supported where the ground moves, which walls follow far anyway", displacements)
    if distance is not None:
        key = f"model {model}: distance"
        ABOVE_ZERO.take(key, distance)
        if not finite or scene.is_led:
            what = "goes with finite displacements of a wall that its live load pushes alone; leave it out"
            raise SceneError(key, what, distance)
    return finite


def check_finite(scene: Scene) -> None:
    """Raise a `SceneError` for keys of the scene that models do not support at finite displacements."""
    for key in scene.extras:
        is_known = key in ("load.history", "tie") or key.startswith("load.live settlement")
        if not is_known and not ((scene.history or scene.drive_path) and key.startswith("beam")):
            leads = "a support settles" if scene.settlement else "live loads push a wall"
            where = f" where {leads}" if key.startswith("beam") else ""
            raise SceneError(key, f"is not supported at finite displacements{where}; leave it out")
    turns = scene.support_motion[:, 2] != 0
    if turns.any() and (scene.ties.block == ANCHOR).any() and (turns | ~scene.fixed).all():
        what = "is anchored while all of the ground turns, which is not supported at finite displacements; leave it out"
        raise SceneError("tie", what)
    if not scene.is_beam[scene.pins.block].all():
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
