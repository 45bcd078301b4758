"""The paper's static solver as it was published: violated joint actions lose their stiffness (Sec. 3, Eq. 3).

The load grows in equal increments. In each, the stiffness matrix is assembled from the joints' normal, shear and
rotational stiffnesses, and the increment of motion is solved for. If the actions at full stiffness of a joint would
violate a condition of Eq. 3, its stiffness in that mode is set to zero, or in all three modes if the joint detaches,
and the increment is solved for again, until the set of violated conditions repeats. The paper does not say
which force a mode without stiffness keeps: here it is the force before the increment, so that equilibrium is kept, or
zero in a joint that detaches, whose forces the other joints must take over.

The method is known to fail. Released modes come and go: since only the set of violated conditions enters the next
solution, a set that occurred before proves a *cycle*. Loose blocks make the matrix *singular*. Other runs *wander* from
set to set. And a step may converge to forces that break Eq. 3, because the check uses the forces at full stiffness,
not those that are kept. ``runningbond stability stiffness-update`` runs the method on the dry published walls with
several increments and both readings of l_c, and reports how the runs end, and at which share of the collapse load of
`dem_static`, the robust variant. The curve up to there is the method's result.
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

MAX_UPDATES = 100
"""Solutions of one load step after which the step counts as wandering."""

ROUNDING = 1e-9
"""Excess over Eq. 3 that counts as zero, relative to the largest action or load."""


@dataclass(frozen=True, eq=False)
class StiffnessUpdate:
    """Result of the published algorithm."""

    # (n, 2) displacement of the control point [m] and λ of the converged load steps, from the dead load on
    curve: Array
    # (n,) largest excess over Eq. 3 of the converged forces in each of these steps, relative to the largest joint
    # force
    excess: Array
    status: tuple[UpdateStatus, ...]  # how each load step ended; all but the last converged
    solves: int  # linear systems solved

    @property
    def multiplier(self) -> float | None:
        """λ of the last converged load step; None if even the dead load failed."""
        return float(self.curve[-1, 1]) if len(self.curve) else None


@dataclass(frozen=True, eq=False)
class ResultantWall:
    """Rigid blocks whose joints act by their resultants."""

    law: ResultantLaw  # law of the joints
    # (3 nj, nd) opening, slip and relative rotation of the joints, all openings first, per movable freedom
    jump: csr_array
    pins: csr_array  # (n_pins, nd) displacements that are held, per freedom
    # (nd,) loads [N, N, N m]
    dead: Array
    live: Array

    def move(self, intact: Mask, load: Array) -> Array | None:
        """Motion ``(nd,)`` under a load, with stiffness in intact joint modes ``(nj, 3)`` only; None if singular."""
        stiffness = np.where(intact, self.law.stiffness, 0.0).T.ravel()
        largest = float(self.law.stiffness.max(initial=0.0)) or 1.0  # if there are only pins and no joints
        inner = csr_array(self.jump.T @ diags_array(stiffness) @ self.jump)
        return held_motion(inner, self.pins, load, largest)

    def excess(self, force: Array) -> float:
        """Largest excess of actions ``(nj, 3)`` over Eq. 3 as a force, relative to the largest force."""
        arms = np.column_stack([np.ones_like(self.law.arm), np.ones_like(self.law.arm), self.law.arm])
        largest = float(np.abs(force / arms).max(initial=0.0))
        return max(0.0, float((self.law.excess(force) / arms).max())) / largest if largest > 0 else 0.0

    def actions(self, motion: Array) -> Array:
        """Actions ``(nj, 3)`` that a motion ``(nd,)`` adds in intact joints."""
        return np.asarray(self.law.stiffness * (self.jump @ motion).reshape(3, -1).T)


def resultant_wall(scene: Scene, arm: float = 0.5) -> ResultantWall:
    """Set up a scene with joint resultants; l_c is `arm` times each joint's length."""
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
    """Push a wall over by the published algorithm, until it fails or reaches the largest multiplier.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness.
    increment, most
        Load increment, and the multiplier at which to stop.
    arm
        l_c as a share of each joint's length: 0.5 is exact, 1 is the paper's reading.
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
    """One load step: its status, actions ``(nj, 3)`` and motion ``(nd,)``, and the number of solutions."""

    status: UpdateStatus
    force: Array
    motion: Array
    solves: int


def load_step(wall: ResultantWall, force: Array, load: Array) -> LoadStep:
    """Update stiffnesses until the violated conditions repeat, from actions ``(nj, 3)`` to a load ``(nd,)``."""
    intact: Mask = np.ones(force.shape, dtype=np.bool_)
    met: set[bytes] = set()
    motion = np.zeros_like(load)
    for solves in range(1, MAX_UPDATES + 1):
        met.add(intact.tobytes())
        kept = np.where(np.any(intact, axis=1, keepdims=True), force, 0.0)
        solved = wall.move(intact, load - wall.jump.T @ kept.T.ravel())
        if solved is None:
            return LoadStep("singular", force, motion, solves)
        motion, added = solved, wall.actions(solved)
        scale = max(float(np.abs(kept + added)[:, :2].max(initial=0.0)), float(np.abs(load).max()))
        violated = wall.law.violated(force + added, ROUNDING * scale)
        now: Mask = ~(violated | violated[:, [DETACHED]])
        if np.array_equal(now, intact):
            return LoadStep("converged", kept + np.where(intact, added, 0.0), motion, solves)
        if now.tobytes() in met:
            return LoadStep("cycle", force, motion, solves)
        intact = now
    return LoadStep("wandering", force, motion, MAX_UPDATES)
