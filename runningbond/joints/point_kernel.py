"""Equations 1 to 4 of `point_law`, and their derivatives, as a compiled kernel."""

import math

from runningbond.scene import Array

from .compiled import kernel


@kernel
def respond(
    opening: Array, slip: Array, plastic: Array, of_points: tuple[Array, ...], forces: Array, tangent: Array
) -> None:
    """Write forces and plastic slips ``(3, np)`` and tangents ``(np, 2, 2)``, from tan φ, T, s, K_n and K_t."""
    friction, tension, shear, k_n, k_t = of_points
    for i in range(opening.size):
        elastic = k_n[i] * opening[i]
        closed = elastic <= tension[i]
        normal = elastic if closed else tension[i]
        trial = k_t[i] * (slip[i] - plastic[i])
        resistance = shear[i] + friction[i] * (tension[i] - normal)
        sticks = abs(trial) <= resistance
        tangential = trial if sticks else math.copysign(resistance, trial)
        forces[0, i], forces[1, i] = normal, tangential
        # A point that sticks keeps its plastic slip exactly; eq. 4 would round it.
        forces[2, i] = plastic[i] if sticks else slip[i] - tangential / k_t[i]
        tangent[i, 0, 0], tangent[i, 0, 1] = k_n[i] if closed else 0.0, 0.0
        tangent[i, 1, 0] = 0.0 if sticks or not closed else -math.copysign(friction[i] * k_n[i], trial)
        tangent[i, 1, 1] = k_t[i] if sticks and (resistance > 0 or closed) else 0.0
