"""Masses of the pieces of blocks that may crack, which limit the time step though nothing moves at their pace.

Inner joints hardly deform, and what they hold together is small: steps become a tenth of those that joints between
blocks ask for. Heavier pieces would make a heavier wall. So a block as a whole keeps its inertia, and what its pieces
do besides has 1 + β times theirs (`runningbond.dynamics.clusters`). Of a motion u = r + d, r that of whole blocks,
inner joints and deformations know d alone. If (1 + β) M bounds all joints and deformations of the pieces at ω_d, and
M those of the joints between whole blocks at ω_r, then M* bounds the wall at ω² = ω_r² + ω_d²: for any a > 0 jumps
have (u_r + u_d)² ≤ (1 + a) u_r² + (1 + 1/a) u_d², and a = ω_d² / ω_r² makes both parts equal.
"""

from dataclasses import replace

import numpy as np

from runningbond.dynamics import BlockSystem, rigid_frequency_squared
from runningbond.dynamics.clusters import Clusters
from runningbond.joints.wall_points import wall_stiffness
from runningbond.scene import Array, Indices, Mask
from runningbond.scene.arrays import components

from .mass_scaling import scaled_modes
from .modal_wall import ModalWall
from .system import DAMPING

LONGER = 10.0
"""Steps become at most so many times as long, with β of 99: more would save little, for what joints between
blocks ask for is near. Pushed slowly a wall bears the same to 3e-3 (its test)."""

UNNOTICED = 100.0
"""How many times a wave at a block's heavier pace crosses it and comes back while a beam that leads goes its way."""


def with_heavier_pieces(wall: ModalWall, system: BlockSystem) -> BlockSystem:
    """Give pieces of blocks more inertia against one another, where a beam leads the wall slowly; or the system as is.

    Parameters
    ----------
    wall
        The wall.
    system
        Its pieces, with modes as `mass_scaling` has them.
    """
    points, count = wall.elements.points, len(wall.scene.blocks)
    block = components(points.block[wall.scene.joints.inner[points.joint]], count)  # of all that these hold together
    part = (np.bincount(block)[block] > 1) & ~wall.scene.fixed
    part[np.isin(block, block[wall.scene.pins.block])] = False
    if wall.pieces.are_blocks or not part.any():
        return system
    more = _longer(wall, block) ** 2 - 1
    if more <= 0:
        return system
    templates = [
        replace(t, modes=replace(t.modes, mass=t.modes.mass * (1 + more))) if part[t.blocks].all() else t
        for t in wall.templates
    ]
    scaled = scaled_modes(replace(wall, templates=templates), DAMPING)
    clusters, mass = _clusters(wall, block, part, more), scaled.mass.copy()
    mass[clusters.freedom] = wall.mass[clusters.freedom]
    square = scaled.frequency_squared + _frequency_squared(wall, block)
    interface = replace(system.interface, frequency_squared=square)
    return replace(system, mass=mass, viscosity=scaled.viscosity, interface=interface, clusters=clusters)


def _longer(wall: ModalWall, block: Indices) -> float:
    """How many times as long steps may be: as many as a beam's way leaves unnoticed, at most `LONGER`.

    A beam that has no rate goes its way in a number of steps, the slower the longer they are.
    """
    scene, drive = wall.scene, wall.scene.drive
    if drive is None or not drive.path:
        return 1.0
    if drive.rate is None:
        return LONGER
    time = np.abs(np.diff(drive.path, prepend=0.0)).max() / drive.rate
    speeds = (np.sqrt(each.young / each.density) for each in scene.block_materials if each.young)
    low, high = np.full((2, block.max() + 1, 2), [[[np.inf]], [[-np.inf]]])
    np.minimum.at(low, block[wall.mesh.block], wall.mesh.points)
    np.maximum.at(high, block[wall.mesh.block], wall.mesh.points)
    longest = (high - low)[np.bincount(block) > 1].max()
    return float(min(LONGER, time * min(speeds, default=np.inf) / (2 * longest * UNNOTICED)))


def _clusters(wall: ModalWall, block: Indices, part: Mask, more: float) -> Clusters:
    """The pieces that are `part` of a block ``(np,)``, which are its cluster, with β more inertia."""
    piece = wall.scene.column_by_column
    piece = piece[part[piece]]
    _, cluster = np.unique(block[piece], return_inverse=True)
    centre, whole = _inertia(wall, block)
    mass, _, own = wall.mass[wall.rigid[piece]].T
    total, _, spin = whole[block[piece]].T
    shares = np.column_stack([mass / total, mass / spin, own / spin])
    arm = wall.scene.blocks.centroid[piece] - centre[block[piece]]
    return Clusters(wall.rigid[piece].astype(np.uint64), cluster.astype(np.uint64), arm, shares, more)


def _inertia(wall: ModalWall, block: Indices) -> tuple[Array, Array]:
    """Centroids ``(nb, 2)`` [m] of blocks, and their masses and moments of inertia ``(nb, 3)``, inf where held."""
    mass, at = wall.mass[wall.rigid], wall.scene.blocks.centroid
    weight = np.where(np.isfinite(mass[:, 0]), mass[:, 0], 1.0)  # of what is held any will do
    centre = np.column_stack([np.bincount(block, weight * x) for x in at.T]) / np.bincount(block, weight)[:, None]
    spin = mass[:, 2] + weight * ((at - centre[block]) ** 2).sum(axis=1)
    return centre, np.column_stack([np.bincount(block, m) for m in (*mass.T[:2], spin)])


def _frequency_squared(wall: ModalWall, block: Indices) -> float:
    """ω_r² [1/s²] of whole blocks on the joints between them."""
    points, (centre, mass) = wall.elements.points, _inertia(wall, block)
    points = points.part(np.flatnonzero(np.not_equal(*block[points.block].T)))
    sides = block[points.block]
    normal, shear = wall_stiffness(wall.scene, points.joint, closed=True)
    return rigid_frequency_squared(points, sides, centre, mass, normal, shear)
