"""What of a scene asks for more than limit analysis: for blocks that deform, soften, crack or move far."""

from dataclasses import dataclass

import numpy as np

from dem.stiffness_update import resultant_wall
from runningbond.joints import wall_points, wall_strength
from runningbond.joints.stiffness import joint_stiffness
from runningbond.limit.kinematics import jump_operator
from runningbond.results import Outcome
from runningbond.scene import Array, Scene

NO_SLIP = 1e-6
"""Slip [m] that counts as none in a mechanism whose fastest corner moves by 1 m."""


@dataclass(frozen=True)
class Needs:
    """What a scene asks of a model."""

    compliance: float  # share of the blocks in the compliance of the wall; see `block_compliance`
    softens: bool  # joints have a strength to lose, and fracture energies by which they lose it
    cracks: bool  # blocks may crack
    weightless: bool  # nothing but the live load presses the joints


def needs_of(scene: Scene) -> Needs:
    """Read off a scene what it asks for."""
    softening = (
        material.cohesion > 0 and (material.fracture_energy_1, material.fracture_energy_2) != (None, None)
        for material in scene.joint_materials
    )
    weightless = not any(scene.load.gravity)
    return Needs(block_compliance(scene), any(softening), scene.inner_joint is not None, weightless)


def block_compliance(scene: Scene) -> float:
    """Share of the blocks in the compliance of a column of blocks and joints, k_n h / (k_n h + E).

    Zero where the scene leaves out either stiffness and blocks are taken as rigid.
    """
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


def collapse_displacement(scene: Scene, outcome: Outcome) -> float | None:
    """How far a wall moves under the live load until it collapses, in block sizes.

    By the outcome's own curve, where its model followed the wall, else `elastic_displacement`.
    """
    if outcome.lower is None:
        return None
    if not len(outcome.curve):
        return elastic_displacement(scene, outcome.lower)
    displacement, multiplier = outcome.curve.T
    last = int(np.argmin(np.abs(multiplier - outcome.lower)))
    return float(abs(displacement[last] - displacement[0]) / scene.block_size)


def elastic_displacement(scene: Scene, multiplier: float) -> float | None:
    """Largest displacement of a block under the live load alone, in block sizes, while joints neither open nor slip.

    A lower bound of that at collapse, soft blocks counted in; None without a stiffness, or on pins that leave such a
    wall loose.
    """
    if scene.joint.elasticity is None:
        return None
    wall = resultant_wall(scene)
    moved = wall.move(np.ones(wall.law.stiffness.shape, dtype=np.bool_), multiplier * wall.live)
    if moved is None:
        return None
    share = block_compliance(scene)
    return float(np.abs(moved.reshape(-1, 3)[:, :2]).max() / (1 - share) / scene.block_size)
