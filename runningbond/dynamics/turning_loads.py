"""Dead or live forces at points of bodies that rotate: they move with these points (`body_points`).

Their generalised forces on rotations and deformations differ from those at rest.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Forces, Indices

from .body_points import NO_POINTS, BodyPoints, Points, arm_of


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
