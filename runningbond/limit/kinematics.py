"""Rigid-block kinematics: from the motion of blocks to the jumps at joint points.

Degrees of freedom of block i are 3i, 3i + 1, 3i + 2: the displacement of its centroid [m] along x and y, and
its rotation [rad], counter-clockwise. A point x of the block moves by u + ω × (x − centroid).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack

from runningbond.joints import JointPoints, wall_points, wall_strength
from runningbond.scene import ANCHOR, Array, Indices, Pins, Scene

NO_SLIP = 1e-6  # slip [m] that counts as zero in a mechanism whose fastest corner moves by 1 m


def point_operator(block: Indices, point: Array, direction: Array, centroid: Array) -> csr_array:
    """Operator ``(n, 3 nb)`` of displacements of points ``(n, 2)`` [m] of blocks ``(n,)`` along directions ``(n, 2)``.

    `centroid` are the centroids of all blocks, ``(nb, 2)`` [m].
    """
    arm = point - centroid[block]
    values = np.column_stack([direction, direction[:, 1] * arm[:, 0] - direction[:, 0] * arm[:, 1]])
    rows = np.repeat(np.arange(len(block)), 3)
    columns = (3 * block[:, None] + np.arange(3)).ravel()
    return csr_array(coo_array((values.ravel(), (rows, columns)), shape=(len(block), 3 * len(centroid))))


@dataclass(frozen=True, eq=False)
class Jump:
    """Jump operator of rigid blocks or nodes: opening and slip u_b − u_a [m] per freedom, ``(np, nd)`` each."""

    opening: csr_array
    slip: csr_array


def jump_operator(points: JointPoints, centroid: Array) -> Jump:
    """Jump operator at joint points of rigid blocks with the given centroids ``(nb, 2)`` [m]."""
    a, b = points.block.T

    def along(direction: Array) -> csr_array:
        of_b, of_a = (point_operator(side, points.position, direction, centroid) for side in (b, a))
        return csr_array(of_b - of_a)

    return Jump(along(points.normal), along(points.tangent))


def pin_operator(scene: Scene, pins: Pins | None = None) -> csr_array:
    """Held motion of each of a scene's pins, or of other pins, ``(n_pins, 3 nb)``."""
    pins = scene.pins if pins is None else pins
    at_points = point_operator(pins.block, pins.point, pins.direction, scene.blocks.centroid)
    turn = coo_array((pins.turn, (np.arange(len(pins)), 3 * pins.block + 2)), shape=at_points.shape)
    return csr_array(at_points + turn)


def tie_ends(scene: Scene, direction: Array | None = None) -> csr_array:
    """Elongation of ties by motion of their first, then of their second ends, ``(2 nt, 3 nb)``; zero for anchors.

    In place of elongations, motions along other directions ``(nt, 2)`` if these are given.
    """
    ties, ends = scene.ties, []
    direction = ties.direction if direction is None else direction
    for end, sense in enumerate((-1.0, 1.0)):
        held = ties.block[:, end] != ANCHOR
        along = np.where(held[:, None], sense * direction, 0.0)
        block = np.where(held, ties.block[:, end], 0)
        ends.append(point_operator(block, ties.ends[:, end], along, scene.blocks.centroid))
    return csr_array(vstack(ends))


def tie_operator(scene: Scene, direction: Array | None = None) -> csr_array:
    """Elongation of each tie, ``(nt, 3 nb)``, or motion of its ends apart as in `tie_ends`; an anchor does not move."""
    ends = tie_ends(scene, direction)
    return csr_array(ends[: len(scene.ties)] + ends[len(scene.ties) :])


def apart_across(scene: Scene) -> csr_array:
    """Motion of the ends of each tie apart, across its line, ``(nt, 3 nb)``."""
    x, y = scene.ties.direction.T
    return tie_operator(scene, np.column_stack([-y, x]))


def mass_matrix_diagonal(scene: Scene) -> Array:
    """Mass, mass and polar moment of inertia of each block in motion, ``(3 nb,)`` [kg, kg, kg m²]."""
    density = scene.inertial_density * scene.thickness_of_blocks
    inertia = density * np.array([*[scene.blocks.area] * 2, scene.blocks.polar_moment])
    return np.asarray(inertia.T.ravel())


def dead_load(scene: Scene) -> Array:
    """Loads that λ does not multiply, as forces and moments on the blocks' freedoms, ``(3 nb,)`` [N, N, N m]."""
    return scene.dead_forces.resultants(scene).ravel()


def live_load(scene: Scene) -> Array:
    """Loads that λ multiplies, ``(3 nb,)`` [N, N, N m]."""
    return scene.live_forces.resultants(scene).ravel()


def movable_freedoms(scene: Scene) -> Indices:
    """Degrees of freedom of the blocks that are not fixed."""
    return np.flatnonzero(np.repeat(~scene.fixed, 3))


def control_row(scene: Scene) -> Array:
    """Operator of the control point's displacement along the live load, per motion of the blocks, ``(3 nb,)``."""
    block, at, direction = scene.control_point
    rows = point_operator(block, at, direction, scene.blocks.centroid)
    return np.asarray(rows.T @ np.full(len(block), 1 / len(block)), dtype=np.float64)


def sliding_dilates(scene: Scene, motion: Array) -> bool:
    """Whether some joints of an associated mechanism ``(nb, 3)`` open only because they slide.

    Frictionless joints never do. If no other joint does either, those that slide have separated anyway and carry no
    friction: forces and mechanism then prove a collapse at their load for friction without dilatancy, too. There may be
    others at smaller loads, unless the scene `is_determinate`.
    """
    points = wall_points(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    opening, slip = jump.opening @ motion.ravel(), np.abs(jump.slip @ motion.ravel())
    friction = wall_strength(scene, points).friction
    return bool(((friction > 0) & (slip > NO_SLIP) & (opening < friction * slip + NO_SLIP)).any())
