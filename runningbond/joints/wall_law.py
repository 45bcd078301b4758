"""Which law the joint points of a wall have, and that law over all of them, with its compiled kernel."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from runningbond.scene import Indices, JointMaterial, Scene, SceneError

from .coulomb import COULOMB, IMPACTS
from .interface import INTERFACE
from .law import KernelLaw, Law
from .softening import SOFTENING

PER_MATERIAL = 4
"""Joints a material from which on those of one stand together."""


def law_of(material: JointMaterial) -> Law:
    """Law of a material: its own, or Coulomb's, which softens where there is an energy; or the one with all else."""
    if isinstance(material.law, Law):
        return material.law
    if material.law is not None:
        raise SceneError("joint.law", "must be a runningbond.joints.Law", material.law)
    further = material.closure is not None or material.compressive_strength is not None
    if further or material.softening != "linear":
        return INTERFACE
    return COULOMB if material.fracture_energy_1 is None else SOFTENING


def common_law(materials: Sequence[JointMaterial]) -> Law:
    """The one law of materials that joints of one wall are of; a `SceneError` for laws that do not go together.

    Plastic joints may stand beside softening ones, and both beside those that crush or close.
    """
    laws = {law.name: law for law in map(law_of, materials)}
    nested = [law.name for law in (COULOMB, SOFTENING, INTERFACE) if law.name in laws]
    if len(laws) > 1 and len(nested) < len(laws):
        names = " and ".join(f'"{name}"' for name in laws)
        raise SceneError("joint.law", f"the joints of a wall have one law, and these are of {names}")
    return laws[nested[-1]] if nested else next(iter(laws.values()))


def with_impacts(scene: Scene) -> Scene:
    """A scene whose joints, where they are all Coulomb's, keep a ledger that is exact in impacts too."""
    if common_law(scene.joint_materials) is not COULOMB:
        return scene
    return replace(scene, joint_materials=tuple(replace(each, law=IMPACTS) for each in scene.joint_materials))


def row_of_joint(scene: Scene) -> Indices:
    """Material by which joints stand together in kernels ``(nj,)``, or 0 for all where most joints have their own.

    The law has no rows of points of one material then, and what is alike in shape goes on from joint to joint.
    """
    apart = len(scene.joints) >= PER_MATERIAL * len(scene.joint_materials)
    return scene.material_of_joint if apart else np.zeros_like(scene.material_of_joint)


def kernel_law(materials: Sequence[JointMaterial], of_point: Indices) -> KernelLaw:
    """Law over joint points from the joints' materials, which need a stiffness, and that of each point ``(np,)``.

    Points of one material in a row are taken together.
    """
    law = common_law(materials)
    start = np.flatnonzero(np.diff(of_point, prepend=-1))
    segments = np.append(start, len(of_point)).astype(np.uint64)
    constants = np.array([law.constants(material) for material in materials])
    return KernelLaw(law, segments, np.ascontiguousarray(constants[of_point[start]]))
