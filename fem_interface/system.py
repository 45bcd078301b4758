"""A scene as a block system of deformable blocks."""

from typing import Any

import numpy as np

from runningbond.dynamics import BlockSystem, Restraint, force_unit
from runningbond.joints import Rule
from runningbond.joints.wall_law import kernel_law
from runningbond.joints.wall_points import wall_strength
from runningbond.scene import Scene

from .block_kernels import gather_modes, scatter_modes
from .cracks import Cracks
from .element_order import find_runs, modal_wall
from .fracture import Energies, fractured
from .loads import Loads
from .mass_scaling import scaled_modes
from .mirror_symmetry import Folds
from .modal_wall import ModalWall
from .modes import ModeCount
from .operators import PointsOn

DAMPING = 0.05
"""Viscous damping ratio of the deformable modes."""

ROUNDING = 1e-14
"""Share of a node in a point below which it is none, and no time is spent on it."""


def fem_system(
    scene: Scene,
    cells: int = 1,
    modes: ModeCount | None = None,
    rule: Rule | None = None,
    *,
    points: PointsOn = "elements",
    cracks: Cracks = "joints",
    loads: Loads = "consistent",
    damping: float = DAMPING,
    mass_scaling: bool = True,
    energies: Energies = "given",
) -> BlockSystem:
    """Set up the deformable blocks of a scene.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness, its blocks one too if they deform.
    cells
        Cells in half a block along the course, and in a block's height.
    modes
        Modes of each block (`ModeCount`): 10 by default, all where blocks may crack.
    rule
        Quadrature rule of the joints; two Lobatto points where none is given.
    points
        Whether the rule is laid on each joint element or on each joint whole, as for rigid blocks.
    cracks
        Whether blocks stay whole or may crack between all of their triangles, at the scene's `inner_joint`.
    loads
        Whether loads proportional to mass act as it does, or at inner nodes.
    damping
        Viscous damping ratio of the deformable modes.
    mass_scaling
        Make deformable modes heavy enough not to limit the time step.
    energies
        Where the joints' fracture energies come from.

    Raises
    ------
    SceneError
        If the scene gives its joints or its blocks no stiffness.
    """
    wall = modal_wall(scene, cells, modes, rule, points, cracks)
    return system_of(wall, loads=loads, damping=damping, mass_scaling=mass_scaling, energies=energies)


def system_of(
    wall: ModalWall,
    *,
    loads: Loads = "consistent",
    damping: float = DAMPING,
    mass_scaling: bool = True,
    energies: Energies = "given",
) -> BlockSystem:
    """Block system of a wall in modal coordinates; see `fem_system`."""
    scene, points = wall.scene, wall.interface.points
    scaled = scaled_modes(wall, damping, mass_scaling=mass_scaling)
    materials, of_joint = fractured(scene, energies)
    dead, live = wall.load(scene.dead_forces, loads), wall.load(scene.live_forces, loads)
    return BlockSystem(
        mass=scaled.mass,
        stiffness=wall.stiffness,
        viscosity=scaled.viscosity,
        dead=dead,
        live=live,
        area=points.area,
        law=kernel_law(materials, of_joint[points.joint]),
        gather=gather_modes,
        scatter=scatter_modes,
        geometry=_geometry(wall),
        rigid=wall.rigid,
        restraint=_restraint(wall),
        block_frequency_squared=scaled.frequency_squared,
        control=wall.control_row(),
        force_unit=force_unit(scene, wall.block, wall.mass, live, wall_strength(scene, points)),
        source=wall,
    )


def _restraint(wall: ModalWall) -> Restraint:
    pinned = np.unique(wall.scene.pins.block)
    free = [wall.templates[wall.place[block, 0]].modes.free for block in pinned]
    return Restraint(wall.rigid[pinned], np.reshape(free, (-1, 3, 3)))


def _geometry(wall: ModalWall) -> tuple[Any, ...]:
    """Arrays of the kernels: shapes and tables of the templates, runs of joint elements, and buffers.

    A template's row of `shapes` is its number of blocks, of modes and of displacements of joint nodes a block, and
    where its coordinates, its joint nodes' displacements and its table start; where the table can be folded, the
    template is in the arrays of `Folds` after the tables instead. A run's row of `places` is where the displacements of
    its nodes stand, side a's two ends before side b's, less the number of its first element; its `shares` are what
    each displacement has in the opening and in the slip of each point.
    """
    mesh, joint = wall.mesh, wall.interface
    n, ne, _ = joint.weights.shape
    _, start = find_runs(wall)
    on_joint = np.unique(joint.nodes)
    of_node = wall.place[mesh.block[on_joint], 0]
    place = np.full((len(mesh.points), 2), -1)
    shapes, forward, backward, folds = [], [np.zeros(0)], [np.zeros(0)], Folds()
    at = entry = 0
    for k, template in enumerate(wall.templates):
        blocks, modes = len(template.blocks), template.modes
        own = on_joint[of_node == k]
        local = np.unique(own - mesh.first_node[mesh.block[own]])
        shape = np.hstack([modes.rigid, modes.shape[:, 3:]]).reshape(-1, 2, len(modes.mass))[local]
        table = shape.reshape(2 * len(local), len(modes.mass))
        shape_of_table = (blocks, table.shape[1], len(table), wall.first[k], at)
        nodes = mesh.points[mesh.first_node[template.blocks[0]] + local]
        if not folds.take(shape_of_table, nodes, table):
            shapes.append((*shape_of_table, entry))
            forward.append(table.ravel())
            backward.append(table.T.ravel())
            entry += table.size
        rows = at + blocks * np.arange(len(table)).reshape(-1, 2)
        place[mesh.first_node[template.blocks][:, None] + local] = rows + np.arange(blocks)[:, None, None]
        at += table.shape[0] * blocks
    begin = start[:-1]
    places = place[joint.nodes[begin]].reshape(-1, 8)
    places = np.where(places < 0, at, places) - begin[:, None]
    tangent = np.column_stack([-joint.normal[:, 1], joint.normal[:, 0]])
    frame = np.stack([joint.normal, tangent], axis=1)[begin]
    shares = np.einsum("pre,rdx->rpdex", joint.weights[:, begin], frame).reshape(len(begin), n, 2, 4)
    shares[np.abs(shares) < ROUNDING] = 0.0
    area = joint.points.area.reshape(n, ne)[:, begin].T[:, :, None, None]
    longest = int(np.diff(start).max(initial=0))
    return (
        np.array(shapes, dtype=np.int64).reshape(-1, 6),
        np.concatenate(forward),
        np.concatenate(backward),
        folds.arrays(),
        start.astype(np.uint64),
        places.astype(np.uint64),  # negative differences wrap round and come out right all the same
        shares,
        shares * area,
        np.array([at]),
        np.zeros(at + longest),
        np.zeros(max((row[0] * row[1] for row in shapes), default=0)),
    )
