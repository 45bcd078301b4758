"""The paper's static solver as it was published: violated joint actions lose their stiffness (Sec. 3, Eq. 3).

The load grows in equal increments. In each, the stiffness matrix is assembled from the joints' normal, shear and
rotational stiffnesses and the increment of motion solved for; where the actions that a joint's full stiffness would
give violate a condition of Eq. 3, the stiffness against that mode is set to zero, against all three where the joint
detaches, and the increment is solved for again, until the set of violated conditions repeats. The paper does not say
what force a mode without stiffness keeps: here the one it had before the increment, so that equilibrium is kept, or
nothing in a joint that detaches, whose forces the rest must take over.

It is known to fail. Released modes come and go: sets of violated conditions that were met before prove a *cycle*, as
nothing but the set enters the next solution. Loose blocks make the matrix *singular*. Others may *wander* from set to
set. And a step may converge on forces that break Eq. 3: it is asked of the forces that the full stiffness would give,
not of those that are kept. ``runningbond stability stiffness-update`` runs it on the dry published walls with several
increments and both readings of l_c, and tells at which share of the collapse load of `dem_static`, the robust variant,
the runs end, and how. The curve up to there is what the method gives.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.sparse import csr_array, diags_array, vstack

from runningbond.joints import ResultantLaw, gauss, joint_points, wall_stiffness, wall_strength
from runningbond.joints.resultant_law import DETACHED
from runningbond.limit.elastic import held_motion
from runningbond.limit.kinematics import (
    control_row,
    dead_load,
    jump_operator,
    live_load,
    movable_freedoms,
    pin_operator,
)
from runningbond.scene import Array, Mask, Scene

UpdateStatus: TypeAlias = Literal["converged", "cycle", "singular", "wandering"]

MOST_UPDATES = 100
"""Solutions of one load step after which it is said to wander."""

ROUNDING = 1e-9
"""Excess over Eq. 3 that counts as none, relative to the largest action or load."""


@dataclass(frozen=True, eq=False)
class StiffnessUpdate:
    """What the published algorithm came to."""

    # (n, 2) displacement of the control point [m] and λ of the converged load steps, the dead load's first
    curve: Array
    # (n,) largest excess over Eq. 3 of the forces with which each of them converged, relative to its largest joint
    # force.
    excess: Array
    status: tuple[UpdateStatus, ...]  # how each load step ended; all but the last converged
    solves: int  # linear systems solved

    @property
    def multiplier(self) -> float | None:
        """λ of the last converged load step; None where even the dead load's failed."""
        return float(self.curve[-1, 1]) if len(self.curve) else None


@dataclass(frozen=True, eq=False)
class ResultantWall:
    """Rigid blocks joined by the resultants of their joints."""

    law: ResultantLaw  # law of the joints
    # (3 nj, nd) opening, slip and relative rotation of the joints, all openings first, per movable freedom
    jump: csr_array
    pins: csr_array  # (n_pins, nd) displacements that are held
    # (nd,) loads [N, N, N m]
    dead: Array
    live: Array

    def move(self, intact: Mask, load: Array) -> Array | None:
        """Motion ``(nd,)`` under a load, with the joint modes ``(nj, 3)`` that are intact; None if singular."""
        stiffness = np.where(intact, self.law.stiffness, 0.0).T.ravel()
        largest = float(self.law.stiffness.max())
        inner = csr_array(self.jump.T @ diags_array(stiffness) @ self.jump)
        return held_motion(inner, self.pins, load, largest)

    def excess(self, force: Array) -> float:
        """Largest excess of actions ``(nj, 3)`` over Eq. 3 as a force, relative to the largest one."""
        arms = np.column_stack([np.ones_like(self.law.arm), np.ones_like(self.law.arm), self.law.arm])
        largest = float(np.abs(force / arms).max())
        return max(0.0, float((self.law.excess(force) / arms).max())) / largest if largest > 0 else 0.0

    def actions(self, motion: Array) -> Array:
        """Actions ``(nj, 3)`` that intact joints add in a motion ``(nd,)``."""
        return np.asarray(self.law.stiffness * (self.jump @ motion).reshape(3, -1).T)


def resultant_wall(scene: Scene, arm: float = 0.5) -> ResultantWall:
    """Set up a scene's resultants, with l_c the given share of each joint's length."""
    middles = joint_points(scene.joints, scene.thickness_of_joints, gauss(1))
    normal, shear = (k * middles.area for k in wall_stiffness(scene, middles.joint))
    length = scene.joints.length
    jump = jump_operator(middles, scene.blocks.centroid)
    joint, (a, b) = np.arange(len(middles)), middles.block.T
    entries = (np.repeat([1.0, -1.0], len(joint)), (np.tile(joint, 2), np.concatenate([3 * b + 2, 3 * a + 2])))
    rotation = csr_array(entries, shape=jump.opening.shape)
    free = movable_freedoms(scene)
    stiffness = np.column_stack([normal, shear, normal * length**2 / 12])
    return ResultantWall(
        ResultantLaw(wall_strength(scene, middles), stiffness, arm * length),
        csr_array(vstack([jump.opening, jump.slip, rotation]))[:, free],
        pin_operator(scene)[:, free],
        dead_load(scene)[free],
        live_load(scene)[free],
    )


def stiffness_update(scene: Scene, increment: float, most: float, arm: float = 0.5) -> StiffnessUpdate:
    """Push a wall over by the published algorithm, as far as it goes.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness.
    increment, most
        Load increment, and the multiplier at which to stop.
    arm
        l_c as a share of each joint's length: one half is exact, one the paper's reading.
    """
    wall = resultant_wall(scene, arm)
    control = control_row(scene)[movable_freedoms(scene)]
    force = np.zeros_like(wall.law.stiffness)
    motion = np.zeros_like(wall.dead)
    rows: list[tuple[float, float]] = []
    excess: list[float] = []
    ends: list[UpdateStatus] = []
    solves = 0
    for multiplier in np.arange(round(most / increment) + 1) * increment:
        step = load_step(wall, force, wall.dead + multiplier * wall.live)
        ends.append(step.status)
        solves += step.solves
        if step.status != "converged":
            break
        force, motion = step.force, motion + step.motion
        rows.append((float(control @ motion), float(multiplier)))
        excess.append(wall.excess(force))
    return StiffnessUpdate(np.array(rows).reshape(-1, 2), np.array(excess), tuple(ends), solves)


@dataclass(frozen=True, eq=False)
class LoadStep:
    """One load step: how it ended, the actions ``(nj, 3)`` and motion ``(nd,)`` after it, and its solutions."""

    status: UpdateStatus
    force: Array
    motion: Array
    solves: int


def load_step(wall: ResultantWall, force: Array, load: Array) -> LoadStep:
    """Set stiffnesses to zero until the violated conditions repeat, from actions ``(nj, 3)`` to a load ``(nd,)``."""
    intact: Mask = np.ones(force.shape, dtype=np.bool_)
    met: set[bytes] = set()
    motion = np.zeros_like(load)
    for solves in range(1, MOST_UPDATES + 1):
        met.add(intact.tobytes())
        kept = np.where(np.any(intact, axis=1, keepdims=True), force, 0.0)
        solved = wall.move(intact, load - wall.jump.T @ kept.T.ravel())
        if solved is None:
            return LoadStep("singular", force, motion, solves)
        motion, added = solved, wall.actions(solved)
        scale = max(float(np.abs(kept + added)[:, :2].max()), float(np.abs(load).max()))
        violated = wall.law.violated(force + added, ROUNDING * scale)
        now: Mask = ~(violated | violated[:, [DETACHED]])
        if np.array_equal(now, intact):
            return LoadStep("converged", kept + np.where(intact, added, 0.0), motion, solves)
        if now.tobytes() in met:
            return LoadStep("cycle", force, motion, solves)
        intact = now
    return LoadStep("wandering", force, motion, MOST_UPDATES)
