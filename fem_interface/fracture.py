"""Fracture energies of joints after the paper's Eqs. 4–5, as they should read and as they are printed.

Linear fracture mechanics yields G = K² / E with K² = π l × (strength in that mode)²: the tensile strength f_t resists
opening (I), the cohesion c resists slip (II). The paper prints the two strengths the other way round, and uses the
block's width b as the length of a bed joint, which in running bond is only half of b.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from runningbond.joints.mohr_coulomb import truncated_cone
from runningbond.scene import Array, Indices, JointMaterial, Mortar, Scene, SceneError, table_of

Energies: TypeAlias = Literal["given", "corrected", "printed"]
"""Fracture energies given by the scene; from Eqs. 4–5 with the strengths corrected; from Eqs. 4–5 as printed."""


def corrected_energies(length: float, cohesion: float, tension: float, young: float) -> tuple[float, float]:
    """G_I = l π f_t² / E and G_II = l π c² / E of a joint of length l [m], [J/m²]; strengths and E in Pa."""
    return length * np.pi * tension**2 / young, length * np.pi * cohesion**2 / young


def printed_energies(length: float, cohesion: float, tension: float, young: float) -> tuple[float, float]:
    """G_I = l π c² / E and G_II = l π f_t² / E as the paper prints them, [J/m²]."""
    return length * np.pi * cohesion**2 / young, length * np.pi * tension**2 / young


def fractured(scene: Scene, energies: Energies) -> tuple[Sequence[JointMaterial], Indices]:
    """Materials of a scene's joints with their fracture energies, and the number of each joint's material, ``(nj,)``.

    Inner joints and contacts of single corners are not made of mortar, and keep the energies of the scene.

    Raises
    ------
    SceneError
        If energies are to be computed from a mortar that is not given.
    """
    if energies == "given":
        return scene.materials_of_joints, scene.material_number_of_joint
    formula = corrected_energies if energies == "corrected" else printed_energies
    length = _printed_length(scene) if energies == "printed" else scene.joints.length
    # Joints whose lengths differ only by rounding share one material.
    kept = scene.joints.inner | scene.joints.at_corner
    rounded = np.where(kept, 0.0, np.rint(length / scene.blocks.tolerance))
    keys = np.column_stack([scene.material_of_joint, rounded])
    _, first, kind = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    materials = []
    for joint in first:
        material = scene.joint_materials[scene.material_of_joint[joint]]
        if kept[joint]:
            materials.append(material)
            continue
        if not isinstance(material.elasticity, Mortar):
            raise SceneError(
                f"{table_of(material)}.mortar", f'is missing; "{energies}" fracture energies follow from it'
            )
        _, tension, _ = truncated_cone(material)
        energy_1, energy_2 = formula(float(length[joint]), material.cohesion, tension, material.elasticity.young)
        materials.append(replace(material, fracture_energy_1=energy_1, fracture_energy_2=energy_2))
    return materials, np.asarray(kind.ravel(), dtype=np.int64)


def _printed_length(scene: Scene) -> Array:
    """Joint lengths that the paper uses, those of the block's sides: b for a bed joint and a for a head joint."""
    if scene.bond is None:
        return scene.joints.length
    return np.where(scene.joints.is_bed, scene.bond.width, scene.bond.height)
