"""Kinematics of rigid blocks as compiled kernels: two contact points a joint, at ± h along its tangent.

Small displacements: the jumps are linear in the motions, and the same as `jump_operator`'s.
"""

import numpy as np

from joints import compiled
from scene import Array

kernel = compiled.kernel
ONE, TWO = np.uint64(1), np.uint64(2)  # unsigned indices need no check for counting from the end


@kernel
def gather_rigid(motion: Array, geometry: tuple[Array, ...], opening: Array, slip: Array) -> None:
    """Opening and slip ``(2 nj,)`` of all joints' first points, then of their second ones, from motions ``(3 nb,)``."""
    first, second, ax, ay, bx, by, nx, ny, half = geometry
    n = first.size
    for j in range(n):
        a, b = first[j], second[j]
        spin_a, spin_b = motion[a + TWO], motion[b + TWO]
        du = motion[b] - spin_b * by[j] - motion[a] + spin_a * ay[j]
        dv = motion[b + ONE] + spin_b * bx[j] - motion[a + ONE] - spin_a * ax[j]
        middle = du * nx[j] + dv * ny[j]
        along = dv * nx[j] - du * ny[j]
        turn = (spin_b - spin_a) * half[j]
        opening[j] = middle + turn
        opening[n + j] = middle - turn
        slip[j] = along
        slip[n + j] = along


@kernel
def scatter_rigid(normal: Array, tangential: Array, geometry: tuple[Array, ...], force: Array) -> None:
    """Subtract from modal forces ``(3 nb,)`` what the joint points' forces ``(2 nj,)`` do on them."""
    first, second, ax, ay, bx, by, nx, ny, half = geometry
    n = first.size
    for j in range(n):
        pull = normal[j] + normal[n + j]
        shear = tangential[j] + tangential[n + j]
        moment = half[j] * (normal[n + j] - normal[j])
        fx = pull * nx[j] - shear * ny[j]
        fy = pull * ny[j] + shear * nx[j]
        a, b = first[j], second[j]
        force[a] += fx
        force[a + ONE] += fy
        force[a + TWO] += ax[j] * fy - ay[j] * fx - moment
        force[b] -= fx
        force[b + ONE] -= fy
        force[b + TWO] -= bx[j] * fy - by[j] * fx - moment
