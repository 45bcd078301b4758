"""Fictitious inertia for longer time steps of walls under slowly growing loads, as in dynamic relaxation.

Static equilibrium does not depend on the masses (`underwood1983`, `olovsson2005`), and the time step is limited by a
single block on its joints, mostly by its rotation: the corners have a long lever arm. Each block is made so heavy, in
each of its three motions separately, that none of them is faster than the median block is in its slowest motion. The
slowest vibrations of a wall, which decide how soon it rests, consist mainly of that motion and change very little.

Slips start waves, which such blocks keep longer: dashpots in the joints are four times as strong as elsewhere. With the
usual ones panel-12 takes one branch or another if the loading rate changes by a sixth (docs/fem-study.md).
"""

import numpy as np

from runningbond.joints import JointPoints
from runningbond.joints.wall_points import wall_stiffness
from runningbond.scene import Array, Scene

from .time_step import rigid_stiffness

CALMER = 0.4
"""Viscous damping ratio of the joints at the highest frequency, if inertia is fictitious."""


def inertia_factors(scene: Scene, points: JointPoints, mass: Array) -> Array:
    """Factors on the masses and on the moment of inertia of each block, ``(nb, 3)``, at least one.

    They are one for blocks on pins, which move about their pins, and for held blocks.

    Parameters
    ----------
    scene
        The wall.
    points
        Points of its joints.
    mass : (nb, 3) float
        Mass, mass and polar moment of inertia of each block [kg, kg, kg m²], inf if the block is held.
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
    """Largest factor by which modal masses ``(nd,)`` [kg] of moving modes exceed those of the blocks."""
    moving = np.isfinite(of_blocks)
    return float((mass[moving] / of_blocks[moving]).max(initial=1.0))


def inertia_note(factor: float) -> str:
    """Note in a message on blocks that move with scaled inertia; empty if there are none."""
    return f"inertia of blocks scaled up to {factor:.3g} times" if factor > 1.005 else ""


def beam_note(scene: Scene) -> str:
    """Note on a beam that moves with more inertia than its mass; empty if there is none."""
    if scene.beam is None:
        return ""
    beam = scene.beam.block
    inertia = scene.inertial_mass[beam]
    if np.isclose(scene.beam.mass, inertia):
        return ""
    does = "weighs, and moves with the inertia of," if scene.history else "moves with the inertia of"
    return f"the beam of {scene.beam.mass:.4g} kg {does} {inertia:.4g} kg"
