"""Rigid blocks on beds of springs without tension, whose loads gain lever arms as the wall leans.

A mechanism tells how a wall falls if all other joints are rigid. Where these are soft, the wall leans on them before
the mechanism turns, or falls over one of them first. Here every joint bears along its whole length, and equilibrium is
that of the moved wall: with forces F on a block at r from its centroid, its rotation ω adds a moment -ω Σ F · r. Ties
are springs that yield and never push; a tie of length L with a pull T, whose ends move apart by v across it, pulls them
back by T v / L.
Joints with friction do not slide, even where they part: equilibrium is then the least energy, whatever the history, and
walls that slide, which bear less, are left to other models.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array, diags_array, hstack, vstack
from scipy.sparse.linalg import SuperLU, splu

from runningbond.joints import JointPoints, lobatto, wall_points, wall_stiffness, wall_strength
from runningbond.joints.closure import closure_curve
from runningbond.joints.law import NEVER_REACHED
from runningbond.joints.wall_points import spreads
from runningbond.limit.kinematics import (
    apart_across,
    dead_load,
    jump_operator,
    live_load,
    movable_freedoms,
    tie_operator,
)
from runningbond.results.mechanism import fastest_corner
from runningbond.results.outcome import number
from runningbond.scene import ANCHOR, Array, Forces, Scene

POINTS = 17
"""Number of points on a bed; with nine, as models have, walls rest under slightly larger loads than on springs."""

FINEST = 1 / 256
"""Smallest step of the load, relative to that under which a wall is to rest."""

ROUNDS = 20
"""Number of times that moments of the leaning wall are computed from forces in joints."""

SETTLED = 1e-6
"""Relative change of these moments that counts as none."""

ITERATIONS = 60
"""Newton iterations until blocks are in balance; a wall that rests takes a few."""

FAR = 1.0
"""Rotation of a block, or displacement relative to the size of the wall, at which it has fallen."""

PARTS = 20
"""Number of parts or multiples of a Newton step that are tried."""

RESIDUAL = 1e-8
"""Forces out of balance of a wall at rest, relative to its loads."""

SYMMETRIC = {"SymmetricMode": True}

LOOSE = 1e-9
"""Stiffness of ground springs, relative to those of the closed joints, that hold blocks that nothing touches."""


class Leaning(NamedTuple):
    """A wall that rolls onto the edges of its joints as it leans."""

    load: float  # largest λ on the way
    moved: float  # displacement of the fastest corner there [m]
    rigid: bool = False  # whether joints outside a mechanism were taken as rigid

    def __str__(self) -> str:
        if self.load <= 0:
            return "as it leans it falls under its dead load"
        less = "joints elsewhere bend" if self.rigid else "joints slide"
        return f"as it leans it bears about {number(self.load)}, or less if {less}"


def along_joints(scene: Scene) -> Scene:
    """The scene with joints that bear along their whole length, at finite displacements too."""
    if spreads(scene, finite=True):
        return scene
    materials = tuple(replace(each, compressive_strength=NEVER_REACHED) for each in scene.joint_materials)
    return replace(scene, joint_materials=materials)


class Lost(Exception):
    """Neither rest nor fall was found, because of rounding or of too few iterations."""


def on_beds(scene: Scene, load: float) -> Leaning | None:
    """Largest λ at which a wall on beds of springs rests, if it is below `load`; 0 if it falls under its dead load.

    None if it rests under `load`, for walls without stiffnesses or with held motions or loads that move supports, and
    if the search is `Lost`.
    """
    held = len(scene.pins) or len(scene.late_pins) or scene.is_led
    if held or load <= 0 or any(each.elasticity is None for each in scene.materials_of_joints):
        return None
    beds = _Beds(along_joints(scene))
    try:
        part, start = _climb(lambda share, motion: beds.rest(share, 0.0, motion), 1.0, np.zeros(len(beds.free)))
        if part < 1:
            return Leaning(0.0, 0.0)
        reached, rest = _climb(lambda multiplier, motion: beds.rest(1.0, multiplier, motion), load, start)
    except Lost:
        return None
    if reached >= load:
        return None
    motion = np.zeros(3 * len(scene.blocks))
    motion[beds.free] = rest - start
    return Leaning(reached, fastest_corner(scene.blocks, motion.reshape(-1, 3)))


def _climb(rest: Callable[[float, Array], Array | None], load: float, start: Array) -> tuple[float, Array]:
    """Largest load up to `load` under which a wall rests, and its motion there, from its motion under none.

    A load under which it falls, or is lost, is tried again from nearer: a long step may pass a rest.
    """
    reached, motion, step = 0.0, start, load
    while reached < load:
        found, lost = None, False
        following = min(reached + step, load)
        try:
            found = rest(following, motion)
        except Lost:
            lost = True
        if found is not None:
            reached, motion, step = following, found, 2 * step
        elif step > FINEST * load:
            step = (following - reached) / 2
        elif lost:
            raise Lost
        else:
            break
    return reached, motion


class _Beds:
    """Joints of a scene as beds of springs, and its ties."""

    def __init__(self, scene: Scene) -> None:
        points, ties = wall_points(scene, lobatto(POINTS)), scene.ties
        jump = jump_operator(points, scene.blocks.centroid)
        self.free = movable_freedoms(scene)
        self.jump = csr_array(vstack([jump.opening, jump.slip, tie_operator(scene)])[:, self.free])
        self.across = csr_array(apart_across(scene)[:, self.free])
        stiffness = wall_stiffness(scene, points.joint)
        strength = wall_strength(scene, points)
        smooth = (strength.friction == 0) & (strength.cohesion == 0)
        self.normal, self.shear = stiffness[0] * points.area, np.where(smooth, 0.0, stiffness[1] * points.area)
        self.tension, self.ties = strength.tension, ties
        curves = np.array([closure_curve(each) for each in scene.materials_of_joints])
        _, self.growth, _, self.end, largest = curves[scene.material_number_of_joint[points.joint]].T
        self.largest = largest * points.area
        self.far = np.tile([FAR * scene.size, FAR * scene.size, FAR], len(scene.blocks))[self.free]
        self.dead, self.live = dead_load(scene)[self.free], live_load(scene)[self.free]
        closed = np.concatenate([self.normal, stiffness[1] * points.area, ties.stiffness])
        self.ground = LOOSE * (self.jump.T @ diags_array(closed) @ self.jump).diagonal()
        self.own, self.pushed = (_virials(scene, each) for each in (scene.dead_forces, scene.live_forces))
        self.virials = csr_array(hstack([_virials_of_joints(scene, points), _virials_of_ties(scene)]))

    def rest(self, share: float, load: float, motion: Array) -> Array | None:
        """Motion at rest under a share of the dead load and λ = `load`, sought from another motion; None if it falls.

        Raises
        ------
        Lost
            If neither is found.
        """
        leaning = self._leaning(share, load, motion)
        for _ in range(ROUNDS):
            found = self._balanced(share * self.dead + load * self.live, motion, leaning)
            if found is None:
                return None
            motion, last, leaning = found, leaning, self._leaning(share, load, found)
            if abs(leaning - last).max() <= SETTLED * abs(last).max():
                return motion
        raise Lost

    def _balanced(self, outer: Array, motion: Array, leaning: csr_array) -> Array | None:
        """Motion in stable balance by Newton's method, given loads and the stiffness due to forces that move."""
        least = RESIDUAL * float(np.linalg.norm(outer))
        for _ in range(ITERATIONS):
            force, tangent = self._forces(motion)
            unbalanced = outer - leaning @ motion - self.jump.T @ force
            springs = self.jump.T @ diags_array(tangent) @ self.jump + diags_array(self.ground)
            factors = _factors(springs + leaning)
            stable = bool((factors.U.diagonal() > 0).all())
            if np.linalg.norm(unbalanced) <= least:
                return motion if stable else None
            change = (factors if stable else _factors(springs)).solve(unbalanced)
            motion = motion + self._part(outer, leaning, motion, change) * change
            if not (np.abs(motion) <= self.far).all():
                return None
        raise Lost

    def _part(self, outer: Array, leaning: csr_array, motion: Array, change: Array) -> float:
        """Part of a step at which the energy is about lowest: forces out of balance do little work along the step.

        It is larger than 1 if joints open on the way.
        """

        def work(part: float) -> float:
            tried = motion + part * change
            return float((outer - leaning @ tried - self.jump.T @ self._forces(tried)[0]) @ change)

        first, low, high, part = work(0.0), 0.0, np.inf, 1.0
        for _ in range(PARTS):
            left = work(part)
            if abs(left) <= first / 2:
                break
            low, high = (part, high) if left > 0 else (low, part)
            part = min(2 * part, (low + high) / 2)
        return part

    def _forces(self, motion: Array) -> tuple[Array, Array]:
        """Normal and shear forces of the points and pulls of the ties, and their stiffnesses."""
        opening, slip, longer = np.split(self.jump @ motion, [len(self.normal), 2 * len(self.normal)])
        below = np.clip(-opening, 0.0, self.end)  # part of the closure on which the stiffness grows
        stiffer = self.normal * np.exp(self.growth * below)
        pressed = (stiffer - self.normal) / self.growth + self.largest * (np.maximum(-opening, 0.0) - below)
        pull = np.where(opening > 0, self.normal * opening, -pressed)
        closing = np.where(-opening < self.end, stiffer, self.largest)
        tied = self.ties.preload + self.ties.stiffness * longer
        force = [np.minimum(pull, self.tension), self.shear * slip, np.clip(tied, 0.0, self.ties.yield_force)]
        gives = (tied >= 0) & (tied <= self.ties.yield_force)
        stiff = [
            np.where(pull <= self.tension, closing, 0.0),
            self.shear,
            np.where(gives, self.ties.stiffness, 0.0),
        ]
        return np.concatenate(force), np.concatenate(stiff)

    def _leaning(self, share: float, load: float, motion: Array) -> csr_array:
        """Stiffness of the freedoms due to forces that move with blocks, under a share of the dead load and λ."""
        levers, force = np.zeros((len(self.own), 3)), self._forces(motion)[0]
        levers[:, 2] = self.virials @ force + share * self.own + load * self.pushed
        strung = force[2 * len(self.normal) :] / self.ties.length
        tied = self.across.T @ diags_array(strung) @ self.across
        return csr_array(diags_array(levers.ravel()[self.free]) + tied)


def _factors(stiffness: csr_array | csc_array) -> SuperLU:
    """Factors of a symmetric matrix without pivoting, whose pivots have the signs of its eigenvalues."""
    try:
        return splu(csc_array(stiffness), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=SYMMETRIC)
    except RuntimeError as singular:
        raise Lost from singular


def _virials(scene: Scene, forces: Forces) -> Array:
    """Sum of F · r over forces at points of each block, at r from its centroid, ``(nb,)`` [J]."""
    virial = np.zeros(len(scene.blocks))
    arm = forces.at - scene.blocks.centroid[forces.block]
    np.add.at(virial, forces.block, (forces.force * arm).sum(axis=1))
    return virial


def _virials_of_joints(scene: Scene, points: JointPoints) -> csr_array:
    """The same of normal and shear forces of joint points, ``(nb, 2 np)``: b pulls on a, and a on b."""
    arms = points.position[:, None] - scene.blocks.centroid[points.block]
    along = [(arms @ axis[:, :, None])[:, :, 0] * (1.0, -1.0) for axis in (points.normal, points.tangent)]
    column = np.tile(np.arange(2 * len(points))[:, None], (1, 2))
    row = np.tile(points.block, (2, 1))
    shape = len(scene.blocks), 2 * len(points)
    return csr_array(coo_array((np.concatenate(along).ravel(), (row.ravel(), column.ravel())), shape=shape))


def _virials_of_ties(scene: Scene) -> csr_array:
    """The same of pulls of ties, ``(nb, nt)``: they pull on their first end along their direction."""
    ties = scene.ties
    tie, end = np.nonzero(ties.block != ANCHOR)
    block = ties.block[tie, end]
    along = ((ties.ends[tie, end] - scene.blocks.centroid[block]) * ties.direction[tie]).sum(axis=1)
    shape = len(scene.blocks), len(ties)
    return csr_array(coo_array((np.where(end == 0, along, -along), (block, tie)), shape=shape))
