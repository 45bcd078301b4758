"""What a test rig does at finite displacements: it prescribes the way of a point of the beam, and presses on it.

The point driven is at p from the beam's centroid. With the beam's rotation θ it goes by
u_x + p_x (cos θ − 1) − p_y sin θ, and pushes with a moment −(p_x sin θ + p_y cos θ) per unit of horizontal force.
A dead force F whose line is fixed turns the beam about its centroid, which has gone by u, with −(u_x F_y − u_y F_x).

Forces at points of blocks go along with these (`body_points`), and do more on their rotations and deformations than
they do at rest.
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
    """Forces at points of bodies that turn, dead ones or live ones."""

    points: BodyPoints  # (n,) where they are
    force: Array  # (n, 2) [N]
    # (n + m,) written by the steps: what they now do more than at rest on the rotations, then on the deformations
    more: Array
    work: Array  # (1,) and the work of that [J]


def turning_loads(forces: Forces, points: Callable[[Indices, Array], BodyPoints]) -> TurningLoads | None:
    """Those of a scene's forces, from the `points` that are of blocks ``(n,)`` at places ``(n, 2)`` [m]."""
    on = points(forces.block, forces.at)
    turns = on.arm.any(axis=1) | (np.diff(on.start) > 0)
    if not turns.any():
        return None
    on, force = points(forces.block[turns], forces.at[turns]), forces.force[turns]
    return TurningLoads(on, force, np.zeros(len(on.arm) + len(on.mode)), np.zeros(1))


NO_TURNING_LOADS = TurningLoads(NO_POINTS, np.zeros((0, 2)), np.zeros(0), np.zeros(1))


@kernel
def turn_loads(loads: tuple[Points, Array, Array, Array], motion: Array, force: Array) -> None:
    """Add to forces ``(nd,)`` what turning loads now do more than at rest, and keep it."""
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
    """Bring a live load ``(nd,)``, of which what was kept is a part, to where its points are now."""
    points, push, more, _ = loads
    rigid, mode, n = points[0], points[4], push.shape[0]
    for k in range(n):
        live[rigid[k, 2]] -= more[k]
    for i in range(mode.size):
        live[mode[i]] -= more[n + i]
    turn_loads(loads, motion, live)


@kernel
def work_of_turned(loads: tuple[Points, Array, Array, Array], velocity: Array, dt: float) -> float:
    """Work of what was kept [J] in a step at a velocity ``(nd,)``."""
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
    """Supports that turn about a point, which goes straight."""

    freedom: Unsigned  # (n, 3) where in the motion their translations and rotations stand
    arm: Array  # (n, 2) from that point to their centroids at rest [m]
    rate: Array  # (3,) displacement of the point [m] and rotation [rad] at λ = 1

    @classmethod
    def of(cls, scene: Scene, rigid: Indices) -> "TurningSupports | None":
        """Those of a scene, from where the rigid motions of its blocks stand ``(nb, 3)``."""
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
    """Write how supports go on, per unit of λ, from where they have turned to in a motion ``(nd,)``."""
    freedom, arm, rate = supports
    for k in range(freedom.shape[0]):
        spin = motion[freedom[k, 2]]
        c, s = math.cos(spin), math.sin(spin)
        way[freedom[k, 0]] = rate[0] - rate[2] * (s * arm[k, 0] + c * arm[k, 1])
        way[freedom[k, 1]] = rate[1] + rate[2] * (c * arm[k, 0] - s * arm[k, 1])


@kernel
def turn_rig(rig: tuple[Unsigned, Array, Array, Array], motion: Array, live: Array) -> float:
    """Write the live load where the beam is now, and return the moment of a dead force whose line is fixed."""
    freedom, arm, force, _ = rig
    x, y, spin = motion[freedom[0]], motion[freedom[1]], motion[freedom[2]]
    live[freedom[2]] = -live[freedom[0]] * (arm[0] * math.sin(spin) + arm[1] * math.cos(spin))
    return float(y * force[0] - x * force[1])


def is_finite(displacements: str, model: str, scene: Scene, distance: float | None = None) -> bool:
    """Whether displacements are finite.

    A `SceneError` for unknown ones, for finite ones where the ground moves, and for a `distance` [m] of a wall that is
    not pushed so far by its live load.
    """
    key = f"model {model}: displacements"
    finite = one_of(key, displacements, get_args(Displacements)) == "finite"
    if finite and scene.history:
        raise SceneError(key, "is not taken where the ground moves, which walls follow far anyway", displacements)
    if distance is not None:
        key = f"model {model}: distance"
        ABOVE_ZERO.take(key, distance)
        if not finite or scene.is_led:
            what = "goes with finite displacements of a wall that its live load pushes alone; leave it out"
            raise SceneError(key, what, distance)
    return finite


def check_finite(scene: Scene) -> None:
    """Refuse, by a `SceneError`, what models do not know of at finite displacements."""
    for key in scene.extras:
        is_known = key in ("load.history", "tie") or key.startswith("load.live settlement")
        if not is_known and not ((scene.history or scene.drive_path) and key.startswith("beam")):
            leads = "a support settles" if scene.settlement else "live loads push a wall"
            where = f" where {leads}" if key.startswith("beam") else ""
            raise SceneError(key, f"is not taken at finite displacements{where}; leave it out")
    turns = scene.support_motion[:, 2] != 0
    if turns.any() and (scene.ties.block == ANCHOR).any() and (turns | ~scene.fixed).all():
        what = "is anchored while all of the ground turns, which is not taken at finite displacements; leave it out"
        raise SceneError("tie", what)
    if not scene.is_beam[scene.pins.block].all():
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
