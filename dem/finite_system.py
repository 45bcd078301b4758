"""Rigid blocks at finite displacements, whose contacts are sought anew as they move."""

from dataclasses import replace
from typing import Any

import numpy as np

from runningbond import dynamics
from runningbond.contacts.contacts import Contacts, Outline, find_contacts, resting
from runningbond.contacts.side_kernels import gather_finite, scatter_finite
from runningbond.dynamics import BlockSystem, block_frequency_squared, force_unit, joint_shares
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.joints import wall_points, wall_strength
from runningbond.joints.law import KernelLaw
from runningbond.joints.wall_law import kernel_law
from runningbond.scene import Array, Indices, Scene, SceneError

from .rigid_system import loads_and_masses


def finite_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene on the contacts of the undeformed wall, three freedoms a block.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness, or pins corners, or glues its joints: a joint that has slid
        away from where it was glued has a cohesion that only a law with damage can speak of.
    """
    if len(scene.pins):
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
    if scene.joint.cohesion > 0:
        raise SceneError("joint.cohesion", "finite displacements need dry joints", scene.joint.cohesion)
    if scene.inner_joint is not None:
        raise SceneError("inner_joint", "finite displacements need blocks that do not crack")
    restraint, mass, dead, live, control = loads_and_masses(scene)
    rigid = np.arange(len(mass)).reshape(-1, 3)
    outline = Outline.of(scene)
    contacts = find_contacts(outline, np.zeros_like(mass), outline.margin)
    law = _law(scene, contacts)
    still = np.zeros_like(mass)
    return BlockSystem(
        mass=mass,
        stiffness=still,
        viscosity=still,
        dead=dead,
        live=live,
        law=law,
        area=contacts.area,
        gather=gather_finite,
        scatter=scatter_finite,
        geometry=contacts.geometry(outline),
        rigid=rigid,
        restraint=restraint,
        block_frequency_squared=_frequency_squared(outline, contacts, law, mass),
        control=control,
        force_unit=force_unit(scene, np.arange(len(mass)) // 3, mass, live, wall_strength(scene, wall_points(scene))),
    )


class FiniteRun(dynamics.FiniteRun):
    """Rigid blocks of a scene in motion at finite displacements.

    Parameters
    ----------
    scene
        The scene: dry joints with a stiffness, on a base or a fixed first course.
    system
        Its `finite_system`, with other masses or loads if need be.
    local, viscous
        Damping, as in `Run`.
    part
        Part of the stable time step, which follows the contacts, that is taken.
    """

    def __init__(
        self,
        scene: Scene,
        system: BlockSystem | None = None,
        *,
        local: float = LOCAL,
        viscous: float = VISCOUS,
        part: float = 1.0,
    ) -> None:
        system = system or finite_system(scene)
        outline = Outline.of(scene)
        undeformed = find_contacts(outline, np.zeros_like(system.mass), outline.margin)
        super().__init__(system, outline, undeformed, local=local, viscous=viscous, part=part)
        self.scene = scene

    def _geometry(self, contacts: Contacts) -> tuple[Any, ...]:
        return contacts.geometry(self.outline)

    def _resting(self, contacts: Contacts, motion: Array) -> Indices:
        corner, side = resting(self.outline, contacts, motion)
        return corner * 2**32 + side

    def _system_on(self, contacts: Contacts) -> BlockSystem:
        law = _law(self.scene, contacts)
        return replace(
            self.system,
            law=law,
            area=contacts.area,
            geometry=self._geometry(contacts),
            block_frequency_squared=_frequency_squared(self.outline, contacts, law, self.system.mass),
        )


def _law(scene: Scene, contacts: Contacts) -> KernelLaw:
    """Law of dry contacts; what a joint spends on its fracture does not matter to them."""
    dry = replace(scene.joint, fracture_energy_1=None, fracture_energy_2=None)
    return kernel_law((dry,), np.zeros(len(contacts), dtype=np.int64))


def _frequency_squared(outline: Outline, contacts: Contacts, law: KernelLaw, mass: Array) -> float:
    """Bound of the largest ω² [1/s²] with every contact closed, each block against its share of their stiffness."""
    geometry = contacts.geometry(outline)
    gather_finite(contacts.motion, geometry, *np.zeros((2, len(contacts))))
    centroid, contact = geometry[7][0][:, 2:], geometry[8]
    n = contact[:, 2:]
    t = np.column_stack([-n[:, 1], n[:, 0]])
    own = np.zeros((len(centroid), 3, 3))
    b, a = outline.blocks.owner[contacts.ends[:, :2].astype(np.int64)].T
    for block, other in ((a, b), (b, a)):
        arm = contact[:, :2] - centroid[block]
        part = joint_shares(mass[3 * np.column_stack([block, other])], 0.5)[:, 0]
        for direction, stiffness in ((n, law.normal_stiffness), (t, law.shear_stiffness)):
            row = np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])
            np.add.at(own, block, (part * stiffness * contacts.area)[:, None, None] * row[:, :, None] * row[:, None, :])
    movable = np.isfinite(mass[::3])
    return float(block_frequency_squared(own[movable], mass.reshape(-1, 3)[movable]).max())
