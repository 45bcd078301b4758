"""Undamaged joint points within their strength, which `interface` evaluates in loops that run in vector registers.

Most points of potential cracks, and of mortar away from where a wall fails, always stay sound. Results equal those of
`interface.any_points` bit by bit, except for the sign of a zero.
"""

import numpy as np

from runningbond.scene import Array

from .compiled import kernel
from .coulomb import PLASTIC_SLIP, shear_within
from .dry_points import CRUSHED, SEAT, SLIPPED
from .law import DAMPED_WORK, OPENING_BEFORE, SLIP_BEFORE
from .softening import DAMAGE


@kernel
def traction_when_sound(
    jumps: tuple[float, float], changes: tuple[float, float], plastic: float, of: Array, viscosity: float
) -> tuple[float, float, float, float]:
    """Normal traction without and with viscosity, then shear without and with it [Pa], of an undamaged point.

    They follow from its jumps, their changes in a step, and its plastic slip [m]. Shear without viscosity is that of
    the elastic spring, because the point is within its strength.
    """
    (jump_n, jump_t), (change_n, change_t) = jumps, changes
    k_t, tension, shear, friction, first, k_n = of[1], of[2], of[3], of[4], of[6], of[13]
    secant = tension / first if tension > 0.0 else 0.0
    is_open = jump_n > 0.0
    elastic = (secant if is_open else k_n) * jump_n
    n = elastic + (0.0 if is_open else viscosity * k_n * change_n)
    n = tension if n > tension else n  # written so that NaN stays NaN
    most = shear + friction * tension - friction * n
    most = most if most > 0.0 else 0.0
    trial = k_t * (jump_t - plastic)
    _, t = shear_within(trial, viscosity * k_t * change_t, most)
    return elastic, n, trial, t


@kernel
def are_sound(
    rows: tuple[np.uint64, np.uint64], of: Array, opening: Array, slip: Array, history: Array, viscosity: float
) -> bool:
    """Whether all points in a range of rows are undamaged, and stay within their strength in this step."""
    plastic, before_n, before_t = history[PLASTIC_SLIP], history[OPENING_BEFORE], history[SLIP_BEFORE]
    damage, slipped, seat, crushed = history[DAMAGE], history[SLIPPED], history[SEAT], history[CRUSHED]
    tension, shear, friction, first, per_slip = of[2], of[3], of[4], of[6], of[8]
    room, cap_shear = shear + friction * tension, of[15]
    limit = of[14] / 3.0 if of[16] > 0.0 else of[14]
    most_squared = limit * limit
    found = 0
    for i in range(rows[0], rows[1]):
        jumps = opening[i] + seat[i], slip[i]
        changes = opening[i] - before_n[i], slip[i] - before_t[i]
        elastic, n, trial, t = traction_when_sound(jumps, changes, plastic[i], of, viscosity)
        sheared = slipped[i] * per_slip
        pressure = max(0.0, -min(elastic, n))
        most = max(abs(trial), abs(t))
        # Conditions are written so that NaN is not sound.
        whole = (damage[i] + sheared * sheared + crushed[i] <= 0.0) & (jumps[0] <= first)
        held = (abs(trial) <= room - friction * n) & (abs(trial) <= room - friction * elastic)
        found += whole & held & (pressure * pressure + cap_shear * most * most <= most_squared)
    return found == rows[1] - rows[0]


@kernel
def sound_points(
    rows: tuple[np.uint64, np.uint64],
    of: Array,
    opening: Array,
    slip: Array,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Update a range of points that `are_sound`, with the result of `interface.any_points`."""
    damped, plastic, seat = history[DAMPED_WORK], history[PLASTIC_SLIP], history[SEAT]
    before_n, before_t = history[OPENING_BEFORE], history[SLIP_BEFORE]
    for i in range(rows[0], rows[1]):
        jump_n, jump_t = opening[i], slip[i]
        change_n, change_t = jump_n - before_n[i], jump_t - before_t[i]
        jumps = jump_n + seat[i], jump_t
        elastic, n, held, t = traction_when_sound(jumps, (change_n, change_t), plastic[i], of, viscosity)
        damped[i] += (n - elastic) * change_n + (t - held) * change_t
        before_n[i] = jump_n
        before_t[i] = jump_t
        normal[i] = n
        tangential[i] = t


@kernel
def can_be_sound(of: Array) -> bool:
    """Whether points with the constants `of` have a strength to lose, and close at a constant stiffness."""
    return bool((of[2] > 0.0 or of[3] > 0.0) and of[12] == 0.0)
