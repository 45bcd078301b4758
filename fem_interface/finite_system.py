"""Deformable blocks at finite displacements, whose contacts are sought anew as they move.

Deformations are small in the frame of their block, which turns with it. Left out are what turning does to them and
they to it: the centrifugal and Coriolis forces on the deformations and the change of a block's moment of inertia.
They strain a block by the square of its corners' speed over that of sound in it, 1e-5 at 10 m/s in brick, and change
its inertia by its strain.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from runningbond import dynamics
from runningbond.contacts.contacts import Contacts
from runningbond.dynamics import BlockSystem, Restraint, block_frequency_squared, force_unit, joint_shares, stable_step
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.joints.law import KernelLaw
from runningbond.joints.wall_law import kernel_law
from runningbond.joints.wall_points import wall_strength
from runningbond.scene import Array, Indices, JointMaterial

from .finite_kernels import gather_deformable, scatter_deformable
from .finite_wall import FiniteWall
from .mass_scaling import CLOSE, scaled_modes
from .system import DAMPING


def finite_system(blocks: FiniteWall, *, damping: float = DAMPING, mass_scaling: bool = True) -> BlockSystem:
    """Set up the deformable blocks of a wall on its undeformed contacts; see `fem_system` for the arguments."""
    wall, contacts = blocks.wall, blocks.undeformed
    scaled = scaled_modes(wall, damping, mass_scaling=mass_scaling)
    dead, live = wall.load(wall.scene.dead_forces), wall.load(wall.scene.live_forces)
    law = contact_law(wall.scene.joint, contacts)
    system = BlockSystem(
        mass=scaled.mass,
        stiffness=wall.stiffness,
        viscosity=scaled.viscosity,
        dead=dead,
        live=live,
        law=law,
        area=contacts.area,
        gather=gather_deformable,
        scatter=scatter_deformable,
        geometry=blocks.geometry(contacts),
        rigid=wall.rigid,
        restraint=Restraint(np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3, 3))),
        block_frequency_squared=scaled.frequency_squared,
        control=wall.control_row(),
        force_unit=force_unit(
            wall.scene, wall.block, wall.mass, live, wall_strength(wall.scene, wall.interface.points)
        ),
    )
    return replace(
        system, block_frequency_squared=_frequency_squared(blocks, system, contacts, scaled.frequency_squared)
    )


class FiniteRun(dynamics.FiniteRun):
    """Deformable blocks in motion at finite displacements.

    Parameters
    ----------
    blocks
        The blocks.
    system
        Their `finite_system`, with other masses or loads if need be.
    local, viscous
        Damping, as in `Run`.
    part
        Part of the stable time step, which follows the contacts, that is taken.
    """

    def __init__(
        self,
        blocks: FiniteWall,
        system: BlockSystem | None = None,
        *,
        local: float = LOCAL,
        viscous: float = VISCOUS,
        part: float = 1.0,
    ) -> None:
        system = system or finite_system(blocks)
        super().__init__(system, blocks.outline, blocks.undeformed, local=local, viscous=viscous, part=part)
        self.blocks = blocks

    def _geometry(self, contacts: Contacts) -> tuple[Any, ...]:
        return self.blocks.geometry(contacts)

    def _find(self, motion: Array, margin: float) -> Contacts:
        return self.blocks.find(motion, margin)

    def _deformation(self, motion: Array) -> float:
        return self.blocks.deformation(motion)

    def _resting(self, contacts: Contacts, motion: Array) -> Indices:
        geometry = self.blocks.geometry(contacts)
        gather_deformable(motion, geometry, *np.zeros((2, len(contacts))))
        of_a = geometry[9][:, 2] == 1
        v, w, _, _, e, f = contacts.ends.astype(np.int64).T
        inner = contacts.inwards == 0
        corner, side = np.where(of_a & ~inner, w, v), np.where(of_a, e, f)
        return np.asarray(corner * 2**32 + side)

    def _system_on(self, contacts: Contacts) -> BlockSystem:
        system = replace(
            self.system,
            law=contact_law(self.blocks.scene.joint, contacts),
            area=contacts.area,
            geometry=self._geometry(contacts),
        )
        # From the same guess each time: the bound must not depend on the contacts that came before.
        bound = _frequency_squared(self.blocks, system, contacts, self._undeformed_bound)
        return replace(system, block_frequency_squared=bound)


def contact_law(joint: JointMaterial, contacts: Contacts) -> KernelLaw:
    """Law of contacts: that of their joint where they are glued, and of its dry material elsewhere."""
    dry = replace(joint, cohesion=0.0, tensile_strength=0.0, fracture_energy_1=None, fracture_energy_2=None)
    if joint.cohesion == 0:
        return kernel_law((dry,), np.zeros(len(contacts), dtype=np.int64))
    return kernel_law((dry, joint), contacts.glued.astype(np.int64))


def _frequency_squared(blocks: FiniteWall, system: BlockSystem, contacts: Contacts, guess: float) -> float:
    """Bound of the largest ω² [1/s²] with every contact closed, each block against its share of their stiffness.

    The viscosity of the deformations counts as in `stable`.
    """
    own = _contact_stiffness(blocks, system, contacts)
    square = guess
    while True:
        slowing = 2 / stable_step(square, VISCOUS, LOCAL)
        found = 0.0
        for stiffness, mass, k, c in own:
            with_own = stiffness + np.einsum("ij,jk->ijk", k + slowing * c, np.eye(k.shape[1]))
            found = max(found, float(block_frequency_squared(with_own, mass).max()))
        if found <= square:
            return found
        square = found * (1 + CLOSE)


def _contact_stiffness(
    blocks: FiniteWall, system: BlockSystem, contacts: Contacts
) -> list[tuple[Array, Array, Array, Array]]:
    """Of each template, its blocks' shares of contacts ``(n, m, m)``, masses, stiffness and viscosity ``(n, m)``."""
    wall = blocks.wall
    geometry, law = system.geometry, system.law
    motion = np.zeros(len(system.mass))
    motion[wall.rigid] = contacts.motion.reshape(-1, 3)
    gather_deformable(motion, geometry, *np.zeros((2, len(contacts))))
    turned, contact, touched = geometry[6][0], geometry[8], geometry[9]
    n = contact[:, 2:4]
    directions = ((n, law.normal_stiffness), (np.column_stack([-n[:, 1], n[:, 0]]), law.shear_stiffness))
    split = [wall.split(values) for values in (system.mass, system.stiffness, system.viscosity)]
    mass = system.mass[wall.rigid[:, 0]]
    facets = touched[:, :2]
    owner = blocks.owner[facets]
    found = []
    for number, template in enumerate(wall.templates):
        shape = template.modes.shape.reshape(-1, 2, len(template.modes.mass))
        own = np.zeros((len(template.blocks), shape.shape[2], shape.shape[2]))
        for side in (0, 1):
            here = np.flatnonzero(wall.place[owner[:, side], 0] == number)
            block, facet, share = owner[here, side], facets[here, side], contact[here, 4 + side, None, None]
            nodes = (
                blocks.node[np.column_stack([facet, blocks.following[facet]])] - wall.mesh.first_node[block][:, None]
            )
            at = (1 - share) * shape[nodes[:, 0]] + share * shape[nodes[:, 1]]
            cosine, sine, x, y = turned[block].T
            arm = contact[here, :2] - np.column_stack([x, y])
            part = joint_shares(mass[np.column_stack([block, owner[here, 1 - side]])], 0.5)[:, 0]
            for direction, stiffness in directions:
                dx, dy = direction[here].T
                local = np.column_stack([cosine * dx + sine * dy, cosine * dy - sine * dx])
                row = np.einsum("px,pxm->pm", local, at)
                row[:, :3] = np.column_stack([dx, dy, arm[:, 0] * dy - arm[:, 1] * dx])
                weight = part * stiffness[here] * contacts.area[here]
                np.add.at(own, wall.place[block, 1], weight[:, None, None] * row[:, :, None] * row[:, None, :])
        mass_k, k, c = (values[number].T for values in split)
        found.append((own, mass_k, k, c))
    return found
