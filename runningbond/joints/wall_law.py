"""Choice of the law for the joint points of a wall, and that law over all points, with its compiled kernel."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from runningbond.scene import Indices, JointMaterial, Scene, SceneError

from .coulomb import COULOMB, IMPACTS
from .interface import INTERFACE
from .law import KernelLaw, Law
from .softening import SOFTENING
from .trial import constants_of, try_kernel

SEATED = replace(INTERFACE, name=SOFTENING.name)
"""Softening with a plastic closure; for materials that neither crush nor close the tractions are the same."""

OWN = (COULOMB, IMPACTS, SOFTENING, SEATED, INTERFACE)
"""Laws whose kernels need no trial; a copy of one with a changed field is a user's law."""

PER_MATERIAL = 4
"""Number of joints per material from which on joints are grouped by material."""


def law_of(material: JointMaterial) -> Law:
    """Law of a material: its own, else Coulomb's, softening, or `INTERFACE` for crushing, closure, curved softening."""
    if isinstance(material.law, Law):
        return material.law
    if material.law is not None:
        raise SceneError("joint.law", "must be a runningbond.joints.Law", material.law)
    further = material.closure is not None or material.compressive_strength is not None
    if further or material.softening != "linear":
        return INTERFACE
    return COULOMB if material.fracture_energy_1 is None else SOFTENING


def common_law(materials: Sequence[JointMaterial]) -> Law:
    """Common law for the materials of one wall's joints; raises a `SceneError` for laws that cannot be combined.

    Plastic joints may be combined with softening ones, and both with joints that crush or close.
    """
    laws = {law.name: law for law in map(law_of, materials)}
    nested = [law.name for law in (COULOMB, SOFTENING, INTERFACE) if law.name in laws]
    if len(laws) > 1 and len(nested) < len(laws):
        names = " and ".join(f'"{name}"' for name in laws)
        raise SceneError("joint.law", f"the joints of a wall have one law, and these are of {names}")
    return laws[nested[-1]] if nested else next(iter(laws.values()))


def with_impacts(scene: Scene) -> Scene:
    """Scene with an energy ledger that is exact in impacts too, if all of its joints follow Coulomb's law."""
    if common_law(scene.joint_materials) is not COULOMB:
        return scene
    return replace(scene, joint_materials=tuple(replace(each, law=IMPACTS) for each in scene.joint_materials))


def counted_in_impacts(law: KernelLaw) -> KernelLaw | None:
    """The same law over the same points with the ledger of `with_impacts`; None for other laws than Coulomb's."""
    return replace(law, law=IMPACTS) if law.law is COULOMB else None


def row_of_joint(scene: Scene) -> Indices:
    """Material by which kernels group joints ``(nj,)``, or 0 for all if many joints have a material of their own.

    The law then has no long runs of points of one material, and runs of joints of one shape are not interrupted.
    """
    apart = len(scene.joints) >= PER_MATERIAL * len(scene.joint_materials)
    return scene.material_of_joint if apart else np.zeros_like(scene.material_of_joint)


def seated_law(materials: Sequence[JointMaterial]) -> Law:
    """Common law of materials for contacts that may be found while blocks lie in each other.

    Softening points have no plastic closure, so that they would press at once with a pressure that nothing has caused.
    """
    law = common_law(materials)
    return SEATED if law is SOFTENING else law


def bears_by_area(law: Law) -> bool:
    """Whether the area over which blocks bear limits their force: joints crush, or close."""
    return law.closed is not None and law is not SEATED


def kernel_law(materials: Sequence[JointMaterial], of_point: Indices, law: Law | None = None) -> KernelLaw:
    """Law over joint points, from the joints' materials, which need a stiffness, and each point's material ``(np,)``.

    Consecutive points of one material form a segment. The law is by default the `common_law` of the materials.
    """
    law = law or common_law(materials)
    start = np.flatnonzero(np.diff(of_point, prepend=-1))
    segments = np.append(start, len(of_point)).astype(np.uint64)
    constants = constants_of(law, materials)
    if not any(law is own for own in OWN):
        try_kernel(law, constants)
    return KernelLaw(law, segments, np.ascontiguousarray(constants[of_point[start]]))
