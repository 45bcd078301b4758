"""Fictitious inertia of the pieces of blocks that may crack, whose highest frequencies limit the time step.

Inner joints are stiff and the pieces that they connect are small: time steps become a tenth of those that joints
between blocks would allow, although nothing moves that fast. Heavier pieces would make the wall heavier. Therefore a
block as a whole keeps its inertia, and only the motion of its pieces relative to the block gets 1 + β times theirs
(`runningbond.dynamics.clusters`). With a motion u = r + d, where r is that of whole blocks, inner joints and
deformations depend on d only. If (1 + β) M bounds all joints and deformations of the pieces at ω_d, and M bounds the
joints between whole blocks at ω_r, then M* bounds the wall at ω² = ω_r² + ω_d²: for any a > 0 jumps satisfy
(u_r + u_d)² ≤ (1 + a) u_r² + (1 + 1/a) u_d², and a = ω_d² / ω_r² makes both parts equal.
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

STEP_FACTOR = 10.0
"""Largest factor by which time steps are lengthened, with β = 99. A larger one would save little, because the limit
from joints between blocks is near. A slowly pushed wall carries the same load to 3e-3 (tested)."""

WAVE_TRIPS = 100.0
"""Least number of times that a wave, slowed down by the heavier pieces, crosses the longest cracked block and returns
during the longest leg of the beam's path."""


def with_heavier_pieces(wall: ModalWall, system: BlockSystem) -> BlockSystem:
    """Give pieces of blocks more inertia against one another if a beam drives the wall slowly; otherwise none.

    Parameters
    ----------
    wall
        The wall.
    system
        The wall's pieces, with the modal masses of `mass_scaling`.
    """
    points, count = wall.elements.points, len(wall.scene.blocks)
    block = components(points.block[wall.scene.joints.inner[points.joint]], count)  # all that inner joints connect
    part = (np.bincount(block)[block] > 1) & ~wall.scene.fixed
    part[np.isin(block, block[wall.scene.pins.block])] = False
    if wall.pieces.are_blocks or not part.any():
        return system
    more = _step_factor(wall, block) ** 2 - 1
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


def _step_factor(wall: ModalWall, block: Indices) -> float:
    """Factor by which steps may be longer without effect on a wall driven at the beam's rate, at most `STEP_FACTOR`.

    A beam without a rate takes a fixed number of steps for its path, so it is slower if they are longer.
    """
    scene, drive = wall.scene, wall.scene.drive
    if drive is None or not drive.path:
        return 1.0
    if drive.rate is None:
        return STEP_FACTOR
    time = np.abs(np.diff(drive.path, prepend=0.0)).max() / drive.rate
    speeds = (np.sqrt(each.young / each.density) for each in scene.block_materials if each.young)
    low, high = np.full((2, block.max() + 1, 2), [[[np.inf]], [[-np.inf]]])
    np.minimum.at(low, block[wall.mesh.block], wall.mesh.points)
    np.maximum.at(high, block[wall.mesh.block], wall.mesh.points)
    longest = (high - low)[np.bincount(block) > 1].max()
    return float(min(STEP_FACTOR, time * min(speeds, default=np.inf) / (2 * longest * WAVE_TRIPS)))


def _clusters(wall: ModalWall, block: Indices, part: Mask, more: float) -> Clusters:
    """Clusters of the pieces that are `part` of a cracking block ``(np,)``; `more` is β."""
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
    """Centroids ``(nb, 2)`` [m] of blocks, and their masses and moments of inertia ``(nb, 3)``, inf if held."""
    mass, at = wall.mass[wall.rigid], wall.scene.blocks.centroid
    weight = np.where(np.isfinite(mass[:, 0]), mass[:, 0], 1.0)  # arbitrary for held blocks
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
