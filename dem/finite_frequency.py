"""Largest frequency of rigid blocks on contacts at finite displacements: a bound, and an estimate by Lanczos' method.

The bound is taken block by block and is too large where several blocks move together. A few steps of Lanczos' method
approach ω from below to within a hundredth, for any wall: a tenth of the safety margin of a stable step.
"""

import numpy as np

from runningbond.contacts.rigid_sides import ONE, THREE, TWO, RigidSides
from runningbond.dynamics import joint_shares
from runningbond.dynamics.highest_frequency import largest_of_tridiagonal
from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Indices

LANCZOS_STEPS = 16
"""Number of steps of Lanczos' method."""

DIGITS = 9
"""Significant digits that are kept: far more than time steps need, given their `SAFETY`."""


def frequencies_squared(sides: RigidSides, normal: Array, shear: Array, mass: Array) -> tuple[float, float]:
    """Bound of the largest ω² [1/s²] with every contact closed, and its Lanczos estimate, which is slightly below it.

    The sides are placed by `gather_sides`, the stiffnesses ``(n,)`` [Pa/m] are those of their ends, and the masses
    ``(3 nb,)`` are modal.
    """
    block = sides.corners.freedom[sides.ends[:, :2]] // THREE
    share, rows = joint_shares(mass[::3][block], 0.5), np.zeros((len(normal), 12))
    own, root = np.zeros((len(mass) // 3, 3, 3)), 1 / np.sqrt(mass)
    _rows(tuple(sides), normal, shear, root, share, rows, own)
    # A random start vector is orthogonal to no mode of the wall.
    start = np.random.default_rng(0).standard_normal(len(mass)) * (root > 0)
    diagonal, beside = np.zeros((2, LANCZOS_STEPS))
    _lanczos(rows, 3 * block, start / np.linalg.norm(start), diagonal, beside)
    bound, found = float(np.linalg.eigvalsh(own).max()), largest_of_tridiagonal(diagonal, beside)
    # A library's last digits differ from machine to machine, and bouncing blocks amplify that of a time step.
    return float(f"{bound:.{DIGITS}g}"), float(f"{found:.{DIGITS}g}")


@kernel
def _rows(sides: RigidSides, normal: Array, shear: Array, root: Array, share: Array, rows: Array, own: Array) -> None:
    """Write opening, then slip of ends per motion of blocks b and a, times √(area × stiffness / mass), ``(n, 12)``.

    Also sum up the mass-scaled stiffness ``(nb, 3, 3)`` of each block, with its `share` ``(n, 2)`` of its ends.
    """
    corners, _, _, ends, _, _, area, placed, contact, _, _ = sides
    for k in range(normal.size):
        for half in range(2):
            first = corners.freedom[ends[k, half]]
            block = first // THREE
            x, y = contact[k, 0] - placed.blocks[2, block], contact[k, 1] - placed.blocks[3, block]
            sense = 1.0 - 2.0 * half
            for way in range(2):
                nx, ny = contact[k, 2], contact[k, 3]
                if way == 1:
                    nx, ny = -ny, nx
                weight = sense * np.sqrt(area[k] * (normal[k] if way == 0 else shear[k]))
                at = 6 * way + 3 * half
                rows[k, at] = weight * nx * root[first]
                rows[k, at + 1] = weight * ny * root[first]
                rows[k, at + 2] = weight * (x * ny - y * nx) * root[first + TWO]
                for i in range(3):
                    for j in range(3):
                        own[block, i, j] += share[k, half] * rows[k, at + i] * rows[k, at + j]


@kernel
def _lanczos(rows: Array, freedom: Indices, v: Array, diagonal: Array, beside: Array) -> None:
    """Write the tridiagonal matrix of Lanczos steps from a unit start vector ``(3 nb,)``."""
    before, after = np.zeros_like(v), np.zeros_like(v)
    for step in range(diagonal.size):
        for i in range(v.size):
            after[i] = -beside[step] * before[i]
        for k in range(rows.shape[0]):
            b, a, of = freedom[k, 0], freedom[k, 1], rows[k]
            for at in (0, 6):
                jump = of[at] * v[b] + of[at + 1] * v[b + ONE] + of[at + 2] * v[b + TWO]
                jump += of[at + 3] * v[a] + of[at + 4] * v[a + ONE] + of[at + 5] * v[a + TWO]
                for i in range(3):
                    after[b + np.uint64(i)] += of[at + i] * jump
                    after[a + np.uint64(i)] += of[at + 3 + i] * jump
        diagonal[step] = np.dot(after, v)
        for i in range(v.size):
            after[i] -= diagonal[step] * v[i]
        length = np.sqrt(np.dot(after, after))
        if step + 1 == diagonal.size or length <= 1e-12 * abs(diagonal[step]):
            return
        beside[step + 1] = length
        for i in range(v.size):
            before[i], v[i] = v[i], after[i] / length
