"""A scene as a block system of rigid blocks."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dynamics import BlockSystem, Restraint, block_frequency_squared
from joints import JointPoints, PointStrength, joint_points, joint_stiffness, point_strength
from joints.point_kernel import KernelLaw, coulomb_law
from joints.softening_kernel import softening_law
from scene import Array, JointMaterial, Scene

from .kinematics import (
    control_row,
    dead_load,
    jump_operator,
    live_load,
    mass_matrix_diagonal,
    pin_operator,
)
from .rigid_kernels import gather_rigid, scatter_rigid


def contact_points(scene: Scene) -> JointPoints:
    """Two contact points a joint, all joints' first ones, then all second ones."""
    points = joint_points(scene.joints, scene.thickness, inset=scene.joint.inset)
    order = np.concatenate([np.arange(0, len(points), 2), np.arange(1, len(points), 2)])
    return JointPoints(
        points.joint[order],
        points.block[order],
        points.position[order],
        points.normal[order],
        points.tangent[order],
        points.area[order],
    )


def rigid_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness.
    """
    points = contact_points(scene)
    strength = point_strength(scene.joint, points.area)
    law = point_law_of(scene.joint, strength, points.area)
    mass = np.where(np.repeat(scene.fixed, 3), np.inf, mass_matrix_diagonal(scene))
    restraint, mass = _restraint(scene, mass)
    dead, live = dead_load(scene), live_load(scene)
    _into_coordinates(dead, restraint)
    _into_coordinates(live, restraint)
    control = control_row(scene)
    _into_coordinates(control, restraint)
    dead[np.isinf(mass)] = live[np.isinf(mass)] = 0.0
    largest = float(np.abs(dead.reshape(-1, 3)[:, :2]).max())
    strongest = float(max(strength.tension.max(initial=0.0), strength.shear.max(initial=0.0)))
    still = np.zeros_like(mass)
    return BlockSystem(
        mass=mass,
        stiffness=still,
        viscosity=still,
        dead=dead,
        live=live,
        law=law,
        gather=gather_rigid,
        scatter=scatter_rigid,
        geometry=_geometry(scene, points),
        restraint=restraint,
        block_frequency_squared=min(float(_own_frequencies(scene, points, law, x).max()) for x in (0.0, 0.5, 1.0)),
        control=control,
        force_unit=largest or strongest or float(np.abs(live).max()),
    )


def point_law_of(joint: JointMaterial, strength: PointStrength, area: Array) -> KernelLaw:
    """Law of points of a material: perfectly plastic without fracture energies, softening with them."""
    stiffness = joint_stiffness(joint)
    normal, shear = stiffness.normal * area, stiffness.shear * area
    if joint.fracture_energy_1 is None and joint.fracture_energy_2 is None:
        return coulomb_law(normal, shear, strength)
    return softening_law(normal, shear, strength, area, joint.fracture_energy_1, joint.fracture_energy_2)


def _geometry(scene: Scene, points: JointPoints) -> tuple[NDArray[Any], ...]:
    n = len(points) // 2
    a, b = points.block[:n].T
    start, stop = points.position[:n], points.position[n:]
    middle = (start + stop) / 2
    arm_a, arm_b = middle - scene.blocks.centroid[a], middle - scene.blocks.centroid[b]
    half = np.hypot(*(stop - start).T) / 2
    arms = (np.ascontiguousarray(column) for column in (*arm_a.T, *arm_b.T, *points.normal[:n].T))
    return ((3 * a).astype(np.uint64), (3 * b).astype(np.uint64), *arms, half)


def _restraint(scene: Scene, mass: Array) -> tuple[Restraint, Array]:
    """Coordinates of the pinned blocks in which their pins hold by themselves, and the masses of those."""
    mass = mass.copy()
    rows = pin_operator(scene).toarray()
    blocks = np.unique(scene.pins.block)
    bases = np.zeros((len(blocks), 3, 3))
    for k, block in enumerate(blocks):
        held = rows[scene.pins.block == block, 3 * block : 3 * block + 3]
        inertia = mass[3 * block : 3 * block + 3]
        # Null space of the pins in the metric of the mass, whose vectors are then mass-orthogonal.
        root = np.sqrt(inertia)
        _, size, vectors = np.linalg.svd(held / root)
        rank = int((size > 1e-9 * size.max()).sum())
        free = (vectors[rank:] / root).T * root.min()
        bases[k, :, : 3 - rank] = free
        modal = np.full(3, np.inf)
        modal[: 3 - rank] = (free**2 * inertia[:, None]).sum(axis=0)
        mass[3 * block : 3 * block + 3] = modal
    return Restraint((3 * blocks).astype(np.int64), bases), mass


def _into_coordinates(load: Array, restraint: Restraint) -> None:
    for freedom, basis in zip(restraint.freedom, restraint.basis, strict=True):
        load[freedom : freedom + 3] = basis.T @ load[freedom : freedom + 3]


def _own_frequencies(scene: Scene, points: JointPoints, law: KernelLaw, share: float) -> Array:
    """Bound of each movable block's largest ω² against its own side of its joints, ``(nb,)`` [1/s²].

    For any c > 0, (u_b − u_a)² ≤ (1 + c) u_b² + (1 + 1/c) u_a², so a joint's energy may be split between its sides.
    With c = (m_b / m_a)^share, and nothing for a side that is held, two blocks of different mass share it fairly.
    """
    n = len(scene.blocks)
    jump = jump_operator(points, scene.blocks.centroid)
    mass = np.where(scene.fixed, np.inf, scene.mass)[points.block]
    ratio = np.column_stack([mass[:, 0] / mass[:, 1], mass[:, 1] / mass[:, 0]])
    part = 1 + np.nan_to_num(ratio, nan=1.0, posinf=0.0) ** share
    own = np.zeros((n, 3, 3))
    for operator, stiffness in ((jump.opening, law.normal_stiffness), (jump.slip, law.shear_stiffness)):
        rows = operator.tocoo()
        values = np.zeros((len(points), 2, 3))
        side = (points.block[rows.row, 1] == rows.col // 3).astype(int)
        values[rows.row, side, rows.col % 3] = rows.data
        for s in (0, 1):
            products = values[:, s, :, None] * values[:, s, None, :]
            np.add.at(own, points.block[:, s], (stiffness * part[:, s])[:, None, None] * products)
    movable = ~scene.fixed
    return block_frequency_squared(own[movable], mass_matrix_diagonal(scene).reshape(-1, 3)[movable])
