"""Materials of contacts: that of their joint while they are glued, its dry version afterwards."""

from dataclasses import replace

import numpy as np

from runningbond.joints import joint_stiffness
from runningbond.joints.law import KernelLaw
from runningbond.joints.wall_law import kernel_law, seated_law
from runningbond.scene import Indices, JointMaterial, Scene, SceneError, table_of

from .search import Contacts


class ContactMaterials:
    """Materials of the contacts of a scene.

    Sides that formed a joint have its material until the contact search has lost them, and its dry version afterwards.
    Sides that meet later have the dry version of the default material.

    Parameters
    ----------
    scene
        The scene.

    Raises
    ------
    SceneError
        For a material without stiffness; for a bonded material that cannot break: only a law with damage defines the
        cohesion of a joint that has slid away from where it was glued; and for materials with different insets.
    """

    def __init__(self, scene: Scene) -> None:
        if scene.joint.elasticity is None and scene.joint not in scene.materials_of_joints:
            what = "is missing; blocks that move far meet anew on [joint], which needs it"
            raise SceneError("joint.mortar", f"{what}, or joint.normal_stiffness and joint.shear_stiffness")
        for material in scene.joint_materials:
            table = table_of(material)
            joint_stiffness(material)
            if material.is_bonded and (material.fracture_energy_1 is None or material.fracture_energy_2 is None):
                what = "finite displacements need dry joints, or both fracture energies, with which they break"
                key = "cohesion" if material.cohesion > 0 else "tensile_strength"
                raise SceneError(f"{table}.{key}", what, getattr(material, key))
            if material.inset != scene.joint.inset:
                what = f"finite displacements need one inset, and joint.inset is {scene.joint.inset:g}"
                raise SceneError(f"{table}.inset", what, material.inset)
        own, self._of_joint = scene.joint_materials, scene.material_of_joint
        self._broken = tuple(each.broken() for each in own)
        both = zip(own, self._broken, strict=True)
        self._all = (*(each if each.is_bonded else broken for each, broken in both), *self._broken)
        # Equal materials share the number of the first, so that points form few runs of one material.
        first: dict[JointMaterial, int] = {}
        self._alike = np.array([first.setdefault(each, k) for k, each in enumerate(self._all)])

    def number(self, contacts: Contacts) -> Indices:
        """Number of the material of each end, ``(n,)``."""
        joint = np.append(self._of_joint, 0)[contacts.joint]
        return np.where(contacts.glued, joint, joint + len(self._broken))

    def side_by_side(self, contacts: Contacts) -> Contacts:
        """Contacts sorted by the material that they may have, because kernels process one material after the other."""
        in_joint = replace(contacts, glued=contacts.joint >= 0)
        return contacts.chosen(np.argsort(self._alike[self.number(in_joint)], kind="stable"))

    def law(self, contacts: Contacts, pairs: Indices | None = None, points: int = 1) -> KernelLaw:
        """Law of all ends, or of `points` points along each of the ``pairs`` ``(n, 2)`` of ends (`joints.along`)."""
        number = self._alike[self.number(contacts)]
        of_point = number if pairs is None else np.tile(number[pairs[:, 0]], points)
        return kernel_law(self._all, of_point, seated_law(self._all))
