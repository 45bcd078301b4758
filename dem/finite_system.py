"""Rigid blocks at finite displacements, whose contacts are found anew as they move."""

from dataclasses import replace

import numpy as np

from runningbond.contacts.outline import Outline
from runningbond.contacts.rigid_sides import RigidSides, gather_sides, scatter_sides
from runningbond.contacts.search import Contacts, find_contacts, resting
from runningbond.dynamics import BlockSystem, Interface, block_frequency_squared, joint_shares
from runningbond.joints.law import KernelLaw
from runningbond.joints.wall_law import kernel_law
from runningbond.scene import Array, Indices, Scene, SceneError

from .rigid_system import held_masses, system_on


def finite_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene, three freedoms a block, to move far.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness, or pins corners, or glues its joints: a joint that has slid
        away from where it was glued has a cohesion that only a law with damage can speak of.
    """
    if scene.extras:
        raise SceneError(scene.extras[0], "is not taken at finite displacements")
    if len(scene.pins):
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
    if scene.joint.cohesion > 0:
        raise SceneError("joint.cohesion", "finite displacements need dry joints", scene.joint.cohesion)
    if len(scene.joint_materials) > 1 and scene.inner_joint is None:
        raise SceneError("joints", "finite displacements need one material for all joints")
    if scene.inner_joint is not None:
        raise SceneError("inner_joint", "finite displacements need blocks that do not crack")
    contacts = RigidContacts(scene)
    rigid = np.arange(3 * len(scene.blocks)).reshape(-1, 3)
    return system_on(scene, contacts.interface_on(contacts.undeformed), rigid, contacts)


class RigidContacts:
    """Contacts of a scene's rigid blocks, between dry joints; see `runningbond.dynamics.ContactSearch`."""

    def __init__(self, scene: Scene) -> None:
        self.outline = Outline.of(scene)
        # What a joint spends on its fracture does not matter to dry contacts.
        self._joint = replace(scene.joint, fracture_energy_1=None, fracture_energy_2=None)
        self._mass = held_masses(scene)
        self.undeformed = self.find(np.zeros(3 * len(scene.blocks)), self.outline.margin)

    def find(self, motion: Array, margin: float) -> Contacts:
        """Contacts nearer than a margin [m] after a motion ``(3 nb,)``."""
        return find_contacts(self.outline, motion, margin)

    def interface_on(self, contacts: Contacts, system: BlockSystem | None = None) -> Interface:
        """The interface of the blocks on contacts."""
        law = kernel_law((self._joint,), np.zeros(len(contacts), dtype=np.int64))
        geometry = contacts.geometry(self.outline)
        gather_sides(contacts.motion, geometry, *np.zeros((2, len(contacts))))
        bound = _frequency_squared(geometry, law, self._mass)
        return Interface(law, contacts.area, gather_sides, scatter_sides, geometry, bound)

    def resting(self, contacts: Contacts, motion: Array) -> Indices:
        """A number of the corner that rests and the side it rests on, for each contact."""
        corner, side = resting(self.outline, contacts, motion)
        return corner * 2**32 + side

    def deformation(self, motion: Array) -> float:
        """Nothing: the blocks are rigid."""
        return 0.0


def _frequency_squared(geometry: RigidSides, law: KernelLaw, mass: Array) -> float:
    """Bound of the largest ω² [1/s²] with every contact closed, each block against its share of their stiffness.

    The sides are as `gather_sides` placed them, the masses modal ones ``(3 nb,)``.
    """
    centroid, contact = geometry.placed.blocks[:, 2:], geometry.contact
    n = contact[:, 2:]
    t = np.column_stack([-n[:, 1], n[:, 0]])
    own = np.zeros((len(centroid), 3, 3))
    b, a = geometry.corners.freedom[geometry.ends[:, :2]].astype(np.int64).T // 3
    for block, other in ((a, b), (b, a)):
        arm = contact[:, :2] - centroid[block]
        part = joint_shares(mass[3 * np.column_stack([block, other])], 0.5)[:, 0]
        for direction, stiffness in ((n, law.stiffest), (t, law.shear_stiffness)):
            row = np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])
            np.add.at(own, block, (part * stiffness * geometry.area)[:, None, None] * row[:, :, None] * row[:, None, :])
    movable = np.isfinite(mass[::3])
    return float(block_frequency_squared(own[movable], mass.reshape(-1, 3)[movable]).max())
