"""The block system of a wall with deformable blocks."""

from collections.abc import Iterator

import numpy as np

from runningbond.dynamics import NOTHING_CARRIED, BlockSystem, Carried, Interface, Restraint, force_unit, tie_rows
from runningbond.joints.wall_law import kernel_law
from runningbond.joints.wall_points import wall_strength
from runningbond.limit.settlement import largest_displacement, reaction_unit
from runningbond.scene import Array, Indices

from .block_kernels import ModalJoints, modal_kernels, nodal_tables
from .cracks import motion_of_blocks
from .fracture import Energies, fractured
from .loads import Loads
from .mass_scaling import ScaledModes, scaled_modes
from .mirror_symmetry import fold_of_many, folded_tables
from .modal_wall import ModalWall, element_runs
from .templates import rows_of

DAMPING = 0.05
"""Viscous damping ratio of the deformable modes."""

ROUNDING = 1e-14
"""Coefficient of a node's displacement in a point's jump below which it is set to zero, to save its computation."""


def system_of(
    wall: ModalWall,
    *,
    loads: Loads = "consistent",
    damping: float = DAMPING,
    mass_scaling: bool = True,
    energies: Energies = "given",
) -> BlockSystem:
    """Set up the deformable blocks of a wall, at small displacements.

    Parameters
    ----------
    wall
        The wall in modal coordinates.
    damping
        Viscous damping ratio of the deformable modes.
    loads, mass_scaling, energies
        As in `fem_interface.model.fem`.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness.
    """
    points = wall.elements.points
    scaled = scaled_modes(wall, damping, mass_scaling=mass_scaling)
    materials, of_joint = fractured(wall.scene, energies)
    law = kernel_law(materials, of_joint[points.joint])
    geometry = _geometry(wall)
    kernels = modal_kernels(alone=bool((geometry.tables.shapes[:, 0] == 1).any()))
    interface = Interface(law, points.area, *kernels, geometry, scaled.frequency_squared)
    return block_system(wall, scaled, interface, loads)


def block_system(
    wall: ModalWall, scaled: ScaledModes, interface: Interface, loads: Loads = "consistent"
) -> BlockSystem:
    """The system of a wall's blocks with scaled modes, its loads and an interface."""
    scene, pieces = wall.scene, wall.pieces
    dead, live = (wall.load(forces, loads) for forces in wall.forces_by_piece)
    dead[np.isinf(wall.mass)] = live[np.isinf(wall.mass)] = 0.0
    control, carried = wall.control_row(), NOTHING_CARRIED
    if scene.settlement:
        moved = np.zeros_like(wall.mass)
        moved[wall.rigid] = scene.support_motion
        far = float(control @ moved) or largest_displacement(scene)
        carried = Carried(moved, far, reaction_unit(scene))
    return BlockSystem(
        mass=scaled.mass,
        stiffness=wall.stiffness,
        viscosity=scaled.viscosity,
        dead=dead,
        live=live,
        control=control,
        force_unit=force_unit(scene, wall.block, wall.mass, live, wall_strength(scene, wall.elements.points)),
        rigid=wall.rigid,
        owner=pieces.owner,
        restraint=_restraint(wall),
        interface=interface,
        ties=tie_rows(scene.ties, wall.place[:, 0] >= 0, wall.displacement_row),
        late=wall.rigid[scene.late_pins.block, 1],
        carried=carried,
        block_motion=None if pieces.are_blocks else motion_of_blocks(pieces),
        source=wall,
    )


def _restraint(wall: ModalWall) -> Restraint:
    pinned = np.unique(wall.scene.pins.block)
    free = [wall.templates[wall.place[block, 0]].modes.free for block in pinned]
    return Restraint(wall.rigid[pinned], np.reshape(free, (-1, 3, 3)))


def _geometry(wall: ModalWall) -> ModalJoints:
    mesh, joint = wall.mesh, wall.elements
    n, ne, _ = joint.weights.shape
    _, start = element_runs(wall)
    local, tables = zip(*_tables(wall), strict=True) if wall.templates else ((), ())
    row = np.full(len(mesh.points), -1)
    for template, own in zip(wall.templates, local, strict=True):
        row[mesh.first_node[template.blocks][:, None] + own] = np.arange(len(own))
    place, first = wall.places(mesh.block, row, [len(own) for own in local])
    plain, folds = [], []
    for template, own, table, coordinate, at in zip(wall.templates, local, tables, wall.first, first, strict=False):
        shape = (len(template.blocks), table.shape[1], len(table), int(coordinate), int(at))
        fold = fold_of_many(len(template.blocks), mesh.points[mesh.first_node[template.blocks[0]] + own], table)
        if fold:
            folds.append((shape, fold))
        else:
            plain.append((shape, table))
    begin = start[:-1]
    frame = np.stack([joint.normal, joint.tangent], axis=1)[begin]
    shares = np.einsum("pre,rdx->rpdex", joint.weights[:, begin], frame).reshape(len(begin), n, 2, 4)
    shares[np.abs(shares) < ROUNDING] = 0.0
    area = joint.points.area.reshape(n, ne)[:, begin].T[:, :, None, None]
    return ModalJoints(
        nodal_tables(plain, int(first[-1]), int(np.diff(start).max(initial=0))),
        folded_tables(folds),
        start.astype(np.uint64),
        (place[joint.nodes[begin]].reshape(-1, 8) - begin[:, None]).astype(np.uint64),
        shares,
        shares * area,
    )


def _tables(wall: ModalWall) -> Iterator[tuple[Indices, Array]]:
    """For each template, its nodes on joints and their displacements per rigid motion and deformation mode."""
    mesh, on_joint = wall.mesh, np.unique(wall.elements.nodes)
    of_node = wall.place[mesh.block[on_joint], 0]
    for k, template in enumerate(wall.templates):
        own, modes = on_joint[of_node == k], template.modes
        local = np.unique(own - mesh.first_node[mesh.block[own]])
        yield local, rows_of(np.hstack([modes.rigid, modes.shape[:, 3:]]), local)
