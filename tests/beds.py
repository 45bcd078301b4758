"""A pushed stack of rigid blocks whose joints are beds of springs without tension, as it leans: a reference."""

import numpy as np
from scipy.optimize import root

from runningbond.scene import Array

TURNS = np.geomspace(1e-6, 0.5, 300)  # of the lowest block [rad]


def stack_on_beds(rows: int, width: float, height: float, weight: float, normal: float, shear: float) -> float:
    """Largest λ of a stack of `rows` blocks under a lateral load, at large rotations of the blocks.

    Parameters
    ----------
    width, height, weight
        Of a block [m, m, N].
    normal, shear
        Stiffness of a joint per unit length [N/m²].
    """
    pressed = weight * np.arange(rows, 0, -1)

    def moments(turn: Array) -> Array:
        """Moments of beds that turn, ``(rows,)`` [N m]; a cracked one bears on a triangle of pressure at its edge."""
        closed = normal * width**3 / 12 * turn
        size = np.maximum(np.abs(turn), np.finfo(float).tiny)
        cracked = np.sign(turn) * pressed * (width / 2 - np.sqrt(2 * pressed / (9 * normal * size)))
        return np.asarray(np.where(np.abs(closed) <= pressed * width / 6, closed, cracked))

    def residual(unknown: Array, first: float) -> Array:
        spin, load = np.append(first, unknown[:-1]), unknown[-1]
        along, up = np.sin(spin) * height, np.cos(spin) * height
        slid = np.cumsum(load * pressed / (shear * width))
        x, y = slid + np.cumsum(along) - along, np.cumsum(up) - up  # middles of the joints under the blocks
        arm = x + along / 2 + load * (y + up / 2)
        own = weight * (np.cumsum(arm[::-1])[::-1] - np.arange(rows, 0, -1) * (x + load * y))
        return np.asarray((own - moments(np.diff(spin, prepend=0.0))) / (weight * rows * width))

    largest, unknown = 0.0, np.append(np.zeros(rows - 1), 1e-3)
    for first in TURNS:
        found = root(residual, unknown, args=(first,), tol=1e-11)
        if found.success:
            unknown = found.x
            largest = max(largest, float(unknown[-1]))
    return largest
