"""A column of rectangular blocks by non-smooth contact dynamics (Moreau 1988): rigid, with velocity jumps.

In each step h the velocities v⁺ = v⁻ + h (g − a) + M⁻¹ Hᵀ p have impulses p ≥ 0 at corners with gaps s such that
0 ≤ p ⟂ u_n + s / h ≥ 0, and friction |p_t| ≤ μ p against the slip, by projected Gauss-Seidel iteration. There are no
springs and no restitution.
"""

import math

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array

NEAR, SWEEPS, SMALL = 0.02, 3000, 1e-13  # m; most Gauss-Seidel sweeps; and the change [m/s] that ends them


@kernel
def _corner(x: float, y: float, turn: float, arm_x: float, arm_y: float) -> tuple[float, float]:
    cosine, sine = math.cos(turn), math.sin(turn)
    return x + cosine * arm_x - sine * arm_y, y + sine * arm_x + cosine * arm_y


@kernel
def _find(at: Array, half: Array, rows: Array, between: Array, gap: Array) -> int:
    """Write the contacts of each block with the one below, up to two corners of either, and return their number."""
    count = 0
    for i in range(len(at)):
        below = i - 1
        for corner in range(4 if below >= 0 else 2):
            upper = corner < 2
            of, on = (i, below) if upper else (below, i)
            side = 1.0 if corner % 2 else -1.0
            x, y = _corner(at[of, 0], at[of, 1], at[of, 2], side * half[of, 0], (-1.0 if upper else 1.0) * half[of, 1])
            nx, ny, away = 0.0, 1.0, y
            if on >= 0:
                nx, ny = -math.sin(at[on, 2]), math.cos(at[on, 2])
                dx, dy = x - at[on, 0], y - at[on, 1]
                # Of two coincident corners only the upper block's counts.
                if abs(dx * ny - dy * nx) > half[on, 0] + (1e-9 if upper else -1e-9):
                    continue
                away = (dx * nx + dy * ny) * (1.0 if upper else -1.0) - half[on, 1]
            if away > NEAR:
                continue
            gap[count], between[count] = away, i
            for row in range(2):
                ex, ey = (nx, ny) if row == 0 else (ny, -nx)
                rows[count, row, 0], rows[count, row, 1] = ex, ey
                rows[count, row, 2] = (x - at[i, 0]) * ey - (y - at[i, 1]) * ex
                if below >= 0:
                    rows[count, row, 3] = (x - at[below, 0]) * ey - (y - at[below, 1]) * ex
            count += 1
    return count


@kernel
def column_in_motion(
    half: Array, mass: Array, inertia: Array, friction: float, ground: Array, gravity: float, step: float, every: int
) -> Array:
    """Motion of a column's blocks in the frame of the ground, every so many steps, ``(steps // every, n, 3)``.

    Parameters
    ----------
    half : (n, 2) float
        Half width and half height of each block [m], the lowest first.
    mass, inertia : (n,) float
        Masses [kg] and moments of inertia [kg m²].
    ground : (steps,) float
        Acceleration of the ground in each step [m/s²].
    """
    n = len(half)
    at, velocity, kept = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((len(ground) // every, n, 3))
    height = 0.0
    for i in range(n):
        at[i, 1] = height + half[i, 1]
        height += 2.0 * half[i, 1]
    rest = at.copy()
    rows, between, gap, impulse = np.zeros((4 * n, 2, 4)), np.zeros(4 * n), np.zeros(4 * n), np.zeros((4 * n, 2))
    for number in range(len(ground)):
        velocity[:, 0] -= step * ground[number]
        velocity[:, 1] -= step * gravity
        count = _find(at, half, rows, between, gap)
        impulse[:] = 0.0
        for _ in range(SWEEPS):
            largest = 0.0
            for k in range(count):
                i = int(between[k])
                j = i - 1
                for row in range(2):
                    ex, ey, lever, other = rows[k, row]
                    speed = ex * velocity[i, 0] + ey * velocity[i, 1] + lever * velocity[i, 2]
                    mobility = 1.0 / mass[i] + lever**2 / inertia[i]
                    if j >= 0:
                        speed -= ex * velocity[j, 0] + ey * velocity[j, 1] + other * velocity[j, 2]
                        mobility += 1.0 / mass[j] + other**2 / inertia[j]
                    before, most = impulse[k, row], friction * impulse[k, 0]
                    if row == 0:
                        after = max(0.0, before - (speed + max(0.0, gap[k]) / step) / mobility)
                    else:
                        after = min(most, max(-most, before - speed / mobility))
                    impulse[k, row] = after
                    change = after - before
                    largest = max(largest, abs(change) * mobility)
                    velocity[i, 0] += change * ex / mass[i]
                    velocity[i, 1] += change * ey / mass[i]
                    velocity[i, 2] += change * lever / inertia[i]
                    if j >= 0:
                        velocity[j, 0] -= change * ex / mass[j]
                        velocity[j, 1] -= change * ey / mass[j]
                        velocity[j, 2] -= change * other / inertia[j]
            if largest < SMALL:
                break
        at += step * velocity
        if (number + 1) % every == 0:
            kept[(number + 1) // every - 1] = at - rest
    return kept
