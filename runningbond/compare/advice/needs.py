"""What of a scene asks for more than limit analysis: for blocks that deform, soften, crack or move far."""

from dataclasses import dataclass

import numpy as np

from dem import jump_operator
from dem.stiffness_update import resultant_wall
from runningbond.joints import wall_points, wall_strength
from runningbond.joints.stiffness import joint_stiffness
from runningbond.results import Outcome
from runningbond.scene import Array, Scene

NO_SLIP = 1e-6
"""Slip [m] that counts as none in a mechanism whose fastest corner moves by 1 m."""


@dataclass(frozen=True)
class Needs:
    """What a scene asks of a model.

    Parameters
    ----------
    pliancy
        Share that blocks have in the give of the wall, k_n h / (k_n h + E); zero where either is not given and blocks
        are taken as rigid.
    softens
        Whether joints lose their strength as they open and slip: they have a strength to lose and fracture energies.
    cracks
        Whether blocks may crack.
    weightless
        Whether nothing but the live load presses the joints.
    """

    pliancy: float
    softens: bool
    cracks: bool
    weightless: bool


def needs_of(scene: Scene) -> Needs:
    """Read off a scene what it asks for."""
    return Needs(
        pliancy(scene),
        any(
            material.cohesion > 0 and (material.fracture_energy_1, material.fracture_energy_2) != (None, None)
            for material in scene.joint_materials
        ),
        scene.inner_joint is not None,
        not any(scene.load.gravity),
    )


def pliancy(scene: Scene) -> float:
    """Share that blocks have in the give of a column of blocks and joints, k_n h / (k_n h + E)."""
    if scene.block.young is None or scene.joint.elasticity is None:
        return 0.0
    height = scene.bond.height if scene.bond else scene.lowest_block
    softer = joint_stiffness(scene.joint).normal * height
    return softer / (softer + scene.block.young)


def sliding_dilates(scene: Scene, motion: Array) -> bool:
    """Whether a mechanism ``(nb, 3)`` of associated joints opens some only because they slide.

    Where none does, joints that slide are off each other anyway and carry no friction: forces and mechanism prove
    their load for friction without dilatancy just as well.
    """
    points = wall_points(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    opening, slip = jump.opening @ motion.ravel(), np.abs(jump.slip @ motion.ravel())
    friction = wall_strength(scene, points).friction
    return bool(((slip > NO_SLIP) & (opening < friction * slip + NO_SLIP)).any())


def sway(scene: Scene, outcome: Outcome) -> float | None:
    """How far a wall moves under the live load until it collapses, in block sizes.

    By the outcome's own curve, where its model followed the wall, else `elastic_sway`.
    """
    if outcome.lower is None:
        return None
    if not len(outcome.curve):
        return elastic_sway(scene, outcome.lower)
    displacement, multiplier = outcome.curve.T
    last = int(np.argmin(np.abs(multiplier - outcome.lower)))
    return float(abs(displacement[last] - displacement[0]) / scene.block_size)


def elastic_sway(scene: Scene, multiplier: float) -> float | None:
    """Largest motion of a block under the live load alone, in block sizes, while joints neither open nor slip.

    A lower bound of the way to the collapse, soft blocks counted in; None without a stiffness, or on pins that leave
    such a wall loose.
    """
    if scene.joint.elasticity is None:
        return None
    wall = resultant_wall(scene)
    moved = wall.move(np.ones(wall.law.stiffness.shape, dtype=np.bool_), multiplier * wall.live)
    if moved is None:
        return None
    share = pliancy(scene)
    return float(np.abs(moved.reshape(-1, 3)[:, :2]).max() / (1 - share) / scene.block_size)
