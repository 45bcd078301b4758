"""Kinematics of rigid blocks as compiled kernels: two contact points a joint, at ± h along its tangent.

Small displacements: the jumps are linear in the motions and equal to those of `jump_operator`. Joints come in runs
(`joint_order.JointOrder`), in which block numbers increase along with joint numbers, so that the loops run in vector
registers. Indices are unsigned, which spares the check for negative ones that count from the end.
"""

from typing import NamedTuple

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array, Unsigned

kernel = compiled.kernel


class RigidJoints(NamedTuple):
    """Joints in runs."""

    start: Unsigned  # (nr + 1,) first joint of each run, then the number of joints
    # (nr,) positions of the blocks a and b of each run's first joint, minus the number of that joint; negative
    # differences wrap round, and still give the right sums
    first: Unsigned
    second: Unsigned
    # (nr, 8) values shared by all joints of a run: normal n_x, n_y, half length [m] between the two points, lever
    # arms [m] of normal and tangential force at the joint's middle about the centroids: normal_a, normal_b, tangent_a,
    # tangent_b, and the area [m²] of a point
    shape: Array


@kernel
def jumps(
    apart: tuple[float, float], spin_a: float, spin_b: float, of_run: tuple[float, ...]
) -> tuple[float, float, float]:
    """Openings of a joint's two points and their slip [m], from the motion of block b minus a's, and both rotations."""
    (du, dv), (nx, ny, half, normal_a, normal_b, tangent_a, tangent_b) = apart, of_run
    middle = du * nx + dv * ny + (spin_b * normal_b - spin_a * normal_a)
    along = dv * nx - du * ny + (spin_b * tangent_b - spin_a * tangent_a)
    turn = (spin_b - spin_a) * half
    return middle + turn, middle - turn, along


@kernel
def gather_rigid(motion: Array, geometry: RigidJoints, opening: Array, slip: Array) -> None:
    """Opening and slip ``(2 nj,)`` of all joints' first points, then of their second ones, from motions ``(3 nb,)``.

    Motions are those of all blocks along x, then along y, then their rotations.
    """
    start, first, second, shape = geometry
    n, nb = opening.size // 2, motion.size // 3
    u, v, spin = motion[:nb], motion[nb : 2 * nb], motion[2 * nb :]
    opening_1, opening_2, slip_1, slip_2 = opening[:n], opening[n:], slip[:n], slip[n:]
    for run in range(shape.shape[0]):
        nx, ny, half, normal_a, normal_b = shape[run, 0], shape[run, 1], shape[run, 2], shape[run, 3], shape[run, 4]
        of_run = (nx, ny, half, normal_a, normal_b, shape[run, 5], shape[run, 6])
        a, b, low, high = first[run], second[run], start[run], start[np.uint64(run + 1)]
        if high - low == 1:  # saves the set-up of a loop, as in walls of irregular stones
            p, q = a + low, b + low
            apart = (u[q] - u[p], v[q] - v[p])
            opening_1[low], opening_2[low], slip_1[low] = jumps(apart, spin[p], spin[q], of_run)
            slip_2[low] = slip_1[low]
            continue
        for j in range(low, high):
            apart = (u[b + j] - u[a + j], v[b + j] - v[a + j])
            one, two, along = jumps(apart, spin[a + j], spin[b + j], of_run)
            opening_1[j] = one
            opening_2[j] = two
            slip_1[j] = along
            slip_2[j] = along


@kernel
def scatter_rigid(normal: Array, tangential: Array, geometry: RigidJoints, force: Array) -> None:
    """Subtract the joint points' tractions ``(2 nj,)``, as modal forces, from the modal forces ``(3 nb,)``."""
    start, first, second, shape = geometry
    n, nb = normal.size // 2, force.size // 3
    fx, fy, moment = force[:nb], force[nb : 2 * nb], force[2 * nb :]
    # Pull, shear and turn of each joint overwrite its points' tractions.
    pull, turn, shear = normal[:n], normal[n:], tangential[:n]
    for j in range(n):
        one, two = pull[j], turn[j]
        pull[j] = one + two
        turn[j] = one - two
    for j in range(n):
        shear[j] += tangential[n + j]
    for run in range(shape.shape[0]):
        area = shape[run, 7]
        nx, ny, half = area * shape[run, 0], area * shape[run, 1], area * shape[run, 2]
        normal_a, normal_b = area * shape[run, 3], area * shape[run, 4]
        tangent_a, tangent_b = area * shape[run, 5], area * shape[run, 6]
        a, b = first[run], second[run]
        low, high = start[run], start[np.uint64(run + 1)]
        if high - low == 1:
            p, q = a + low, b + low
            x, y = pull[low] * nx - shear[low] * ny, pull[low] * ny + shear[low] * nx
            fx[p] += x
            fy[p] += y
            moment[p] += pull[low] * normal_a + shear[low] * tangent_a + turn[low] * half
            fx[q] -= x
            fy[q] -= y
            moment[q] -= pull[low] * normal_b + shear[low] * tangent_b + turn[low] * half
            continue
        for j in range(low, high):
            fx[a + j] += pull[j] * nx - shear[j] * ny
        for j in range(low, high):
            fy[a + j] += pull[j] * ny + shear[j] * nx
        for j in range(low, high):
            moment[a + j] += pull[j] * normal_a + shear[j] * tangent_a + turn[j] * half
        # The two sides in separate loops, because the blocks b of a run may be its blocks a of the next joints.
        for j in range(low, high):
            fx[b + j] -= pull[j] * nx - shear[j] * ny
        for j in range(low, high):
            fy[b + j] -= pull[j] * ny + shear[j] * nx
        for j in range(low, high):
            moment[b + j] -= pull[j] * normal_b + shear[j] * tangent_b + turn[j] * half
