"""Fictitious inertia of deformable blocks under loads that grow slowly (`runningbond.dynamics.inertia`).

Rigid motions are slowed down as those of rigid blocks are. The step is then limited by fast deformations whose own
stiffness is no larger than that of the joints: their masses are scaled for their share of the joints' stiffness too.
"""

from dataclasses import replace

import numpy as np

from runningbond.dynamics import BlockSystem, inertia_factors, largest_scaling, with_highest_frequency

from .mass_scaling import AT_REST, scaled_modes
from .modal_wall import ModalWall
from .system import DAMPING


def with_fictitious_inertia(wall: ModalWall, system: BlockSystem) -> BlockSystem:
    """Give a wall's blocks inertia that allows long time steps.

    Parameters
    ----------
    wall
        The wall.
    system
        The wall's blocks.
    """
    rigid = _heavier(wall)
    scaled = scaled_modes(rigid, DAMPING, allowance=AT_REST)
    interface = replace(system.interface, frequency_squared=scaled.frequency_squared)
    heavier = replace(
        system,
        mass=scaled.mass,
        viscosity=scaled.viscosity,
        interface=interface,
        inertia_scaling=largest_scaling(rigid.mass, wall.mass),
    )
    return with_highest_frequency(heavier, AT_REST.viscous)


def _heavier(wall: ModalWall) -> ModalWall:
    """The wall with more inertia in rigid motions; all blocks of a template get the largest factors among them."""
    factors, templates = inertia_factors(wall.scene, wall.elements.points, wall.mass[wall.rigid]), []
    for template in wall.templates:
        scale = np.ones_like(template.modes.mass)
        scale[:3] = factors[template.blocks].max(axis=0)
        templates.append(replace(template, modes=replace(template.modes, mass=template.modes.mass * scale)))
    return replace(wall, templates=templates)
