"""Blocks and walls that experiments are done on."""

from dataclasses import replace

import numpy as np

from runningbond.compare.published import published_scene
from runningbond.scene import BlockMaterial, JointMaterial, Load, Scene, Stiffness, build_scene

INSET = 0.02
"""Distance of contacts from the ends of the joints [m] with which the load multiplier of W1 to W3 is unique."""


def one_block(width: float, height: float, friction: float, stiffness: float) -> Scene:
    """A dry block of 1800 kg/m³ on rigid ground, 0.12 m thick, pushed at its centroid by λ times its weight.

    Parameters
    ----------
    width, height
        Of the block [m].
    friction
        tan φ of the joint under it.
    stiffness
        Of that joint, normal and shear [Pa/m].
    """
    outline = np.array([[0, 0], [width, 0], [width, height], [0, height]])
    joint = JointMaterial(friction, elasticity=Stiffness(stiffness, stiffness))
    return build_scene(
        "a block", [outline], thickness=0.12, block=BlockMaterial(1800.0, 1e12, 0.0), joint=joint, load=Load()
    )


def rounded(name: str) -> Scene:
    """A published wall with rounded corners, its contacts `INSET` from the ends of the joints."""
    scene = published_scene(name)
    return replace(scene, joint=replace(scene.joint, inset=INSET))
