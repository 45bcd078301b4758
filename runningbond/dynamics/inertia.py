"""Inertia that lets a wall under slowly growing loads take longer steps: fictitious masses, as of dynamic relaxation.

What bears a load at rest knows no masses (`underwood1983`, `olovsson2005`), and what limits the step is a single block
on its joints, which mostly turns: the corners have more leverage than their springs have stiffness. A block is made
so heavy, in each of its three motions by itself, that none of these is faster than most blocks are in the slowest of
them. The slowest vibrations of a wall, which it takes to come to rest, lie in that one, and stay nearly as they are.

Slips start waves, which such blocks hold for longer: dashpots in the joints are four times as strong as elsewhere. With
usual ones panel-12 takes one branch or another as the load's pace is changed by a tenth (docs/fem-study.md).
"""

import numpy as np

from runningbond.joints import JointPoints
from runningbond.joints.wall_points import wall_stiffness
from runningbond.scene import Array, Scene

from .time_step import rigid_stiffness

CALMER = 0.4
"""The joints' viscous damping ratio at the highest frequency where inertia is fictitious."""


def inertia_factors(scene: Scene, points: JointPoints, mass: Array) -> Array:
    """Factors on the masses and on the moment of inertia of each block, ``(nb, 3)``, none below one.

    Blocks on pins, which move about them, and blocks that are held have none.

    Parameters
    ----------
    scene
        The wall.
    points
        Points of its joints.
    mass : (nb, 3) float
        Mass, mass and polar moment of inertia of each block [kg, kg, kg m²], inf where it is held.
    """
    normal, shear = wall_stiffness(scene, points.joint, closed=True)
    stiffness = rigid_stiffness(points, points.block, scene.blocks.centroid, mass, normal, shear)
    square = np.diagonal(stiffness, axis1=1, axis2=2) / mass
    moving, result = np.flatnonzero(np.isfinite(mass).all(axis=1) & (square > 0).all(axis=1)), np.ones_like(mass)
    if len(moving):
        result[moving] = np.maximum(square[moving] / np.median(square[moving], axis=0).min(), 1.0)
    result[scene.pins.block] = 1.0
    return result


def largest_scaling(mass: Array, of_blocks: Array) -> float:
    """Largest factor by which modal masses ``(nd,)`` [kg] exceed those of the blocks, of what moves."""
    moving = np.isfinite(of_blocks)
    return float((mass[moving] / of_blocks[moving]).max(initial=1.0))


def inertia_note(factor: float) -> str:
    """What a message says of blocks that move with more inertia than they have."""
    return f"inertia of blocks scaled up to {factor:.3g} times" if factor > 1.005 else ""


def beam_note(scene: Scene) -> str:
    """What there is to say of a beam that is too light to move as it is."""
    if scene.beam is None:
        return ""
    beam = scene.beam.block
    inertia = scene.inertial_mass[beam]
    if np.isclose(scene.beam.mass, inertia):
        return ""
    does = "weighs, and moves with the inertia of," if scene.history else "moves with the inertia of"
    return f"the beam of {scene.beam.mass:.4g} kg {does} {inertia:.4g} kg"
