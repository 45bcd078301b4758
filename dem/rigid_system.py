"""A scene as a block system of rigid blocks."""

from dataclasses import replace

import numpy as np

from runningbond.dynamics import (
    NOTHING_CARRIED,
    BlockSystem,
    Carried,
    Interface,
    Restraint,
    force_unit,
    inertia_factors,
    restrain,
    rigid_frequency_squared,
    tie_rows,
)
from runningbond.joints import JointPoints, wall_points, wall_strength
from runningbond.joints.along import gather_along, scatter_along
from runningbond.joints.law import KernelLaw
from runningbond.joints.wall_law import kernel_law
from runningbond.limit.kinematics import (
    control_row,
    dead_load,
    live_load,
    mass_matrix_diagonal,
    pin_operator,
    point_operator,
)
from runningbond.limit.settlement import largest_displacement, reaction_unit
from runningbond.scene import Array, Indices, Scene, free_motions

from .joint_order import joint_order
from .rigid_kernels import gather_rigid, scatter_rigid


def contact_points(scene: Scene) -> JointPoints:
    """Contact points in the order of the kernels: the first ones of all joints, then all second ones, and so on."""
    return joint_order(scene).points


def rigid_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness.
    """
    order = joint_order(scene)
    points = order.points
    law = kernel_law(scene.materials_of_joints, scene.material_number_of_joint[points.joint])
    bound = largest_frequency_squared(scene, points, law, held_masses(scene).reshape(-1, 3))
    interface = Interface(law, points.area, gather_rigid, scatter_rigid, order.runs, bound)
    if order.between is not None:
        kernels = gather_along(gather_rigid), scatter_along(scatter_rigid)
        interface = Interface(law, points.area, *kernels, order.between, bound)
    return system_on(scene, interface, order.block[:, None] + len(scene.blocks) * np.arange(3))


def with_fictitious_inertia(scene: Scene, system: BlockSystem) -> BlockSystem:
    """Raise the masses of rigid blocks so that all their motions are as slow as the slowest (`inertia_factors`)."""
    points, mass = contact_points(scene), held_masses(scene).reshape(-1, 3)
    factors = inertia_factors(scene, points, mass)
    heavier = system.mass.copy()
    heavier[system.rigid] *= factors
    bound = largest_frequency_squared(scene, points, system.interface.law, mass * factors)
    interface = replace(system.interface, frequency_squared=bound)
    return replace(system, mass=heavier, interface=interface, inertia_scaling=float(factors.max()))


def system_on(scene: Scene, interface: Interface, rigid: Indices) -> BlockSystem:
    """Rigid blocks of a scene on an interface, with their freedoms numbered by `rigid` ``(nb, 3)``."""
    restraint, mass = _restraint(scene, held_masses(scene))
    dead, live, control = dead_load(scene), live_load(scene), control_row(scene)
    for row in (dead, live, control):
        restrain(row, restraint)
    dead[np.isinf(mass)] = live[np.isinf(mass)] = 0.0
    order, still = np.argsort(rigid.ravel()), np.zeros_like(mass)

    def displacement(block: int, at: Array, direction: Array) -> Array:
        row = point_operator(np.array([block]), at[None], direction[None], scene.blocks.centroid).toarray()[0]
        return restrain(row, restraint)[order]

    moved, carried = scene.support_motion.ravel()[order], NOTHING_CARRIED
    if scene.settlement:
        far = float(control[order] @ moved) or largest_displacement(scene)
        carried = Carried(moved, far, reaction_unit(scene))
    moving = ~scene.fixed | scene.support_motion.any(axis=1)
    strength = wall_strength(scene, wall_points(scene))
    return BlockSystem(
        mass=mass[order],
        stiffness=still,
        viscosity=still,
        dead=dead[order],
        live=live[order],
        control=control[order],
        force_unit=force_unit(scene, order // 3, mass[order], live, strength),
        rigid=rigid,
        owner=np.arange(len(scene.blocks)),
        restraint=Restraint(rigid.ravel()[restraint.freedom], restraint.basis),
        interface=interface,
        ties=tie_rows(scene.ties, moving, displacement),
        late=rigid[scene.late_pins.block, 1],
        carried=carried,
    )


def held_masses(scene: Scene) -> Array:
    """Masses of the blocks' freedoms ``(3 nb,)`` [kg, kg, kg m²], inf where a block is held."""
    return np.where(np.repeat(scene.fixed, 3), np.inf, mass_matrix_diagonal(scene))


def largest_frequency_squared(scene: Scene, points: JointPoints, law: KernelLaw, mass: Array) -> float:
    """Bound of the largest ω² of blocks with masses ``(nb, 3)`` [1/s²].

    A single block held at both corners has no joint and no frequency: it does not move, and any value will do.
    """
    normal, shear = law.stiffest, law.shear_stiffness
    return rigid_frequency_squared(points, points.block, scene.blocks.centroid, mass, normal, shear) or 1.0


def _restraint(scene: Scene, mass: Array) -> tuple[Restraint, Array]:
    """Coordinates of the pinned blocks in which the pins are satisfied by construction, and the masses in them."""
    rows = pin_operator(scene).toarray()
    blocks = np.unique(scene.pins.block)
    bases = np.zeros((len(blocks), 3, 3))
    for k, block in enumerate(blocks):
        held = rows[scene.pins.block == block, 3 * block : 3 * block + 3]
        of_block = slice(3 * block, 3 * block + 3)
        bases[k], mass[of_block] = free_motions(held, mass[of_block])
    return Restraint(3 * blocks[:, None] + np.arange(3), bases), mass
