"""Dry joint points that do not crush, which `interface` evaluates in loops that run in vector registers.

Their pressure is that of `closure`, with expm1 from a series in x / 64 and six doublings, e^{2x} − 1 = y (y + 2).
"""

import math

import numpy as np

from runningbond.scene import Array

from .closure import closure_at
from .compiled import kernel
from .coulomb import PLASTIC_SLIP, shear_within, work_of_slip
from .law import DAMPED_WORK, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE
from .softening import HISTORY, NEVER

SLIPPED, SEAT, CRUSHED = (len(HISTORY) + k for k in (-1, 0, 1))
"""Rows in the history of `interface`."""

SERIES_LIMIT = 8.0
"""Largest g c for which the series is exact up to rounding; there the stiffness has grown by a factor of 3000."""

C2, C3, C4, C5, C6, C7, C8, C9, C10 = (1.0 / math.factorial(k) for k in range(2, 11))
"""Coefficients of the series of expm1."""

PRESSURE_SHARE, VISCOUS_SHARE = 0.9, 0.1
"""Shares of the cap that elastic and viscous pressure may reach before points are left to `interface.any_points`."""


@kernel
def dry_within(of: Array, viscosity: float) -> tuple[float, float]:
    """Closure and its change in a step [m] up to which points with the constants `of` are dry and within their cap.

    The closure is negative if `dry_points` cannot update such points. Their shear is at most tan φ times the pressure.
    """
    tension, shear, friction, last, growth, end, largest = of[2], of[3], of[4], of[7], of[10], of[12], of[13]
    if tension > 0.0 or shear > 0.0 or last < NEVER or growth * end > SERIES_LIMIT:
        return -1.0, 0.0
    strength, cap_shear, peak = of[14], of[15], of[16]
    if strength == math.inf:
        return math.inf, math.inf
    pressed = (strength / 3.0 if peak > 0.0 else strength) / math.sqrt(1.0 + cap_shear * friction * friction)
    curve = (of[9], growth, of[11], end, largest)
    jolt = VISCOUS_SHARE * pressed / (viscosity * largest) if viscosity > 0.0 else math.inf
    return closure_at(PRESSURE_SHARE * pressed, curve), jolt


@kernel
def is_beyond(rows: tuple[np.uint64, np.uint64], opening: Array, history: Array, bounds: tuple[float, float]) -> bool:
    """Whether any point in a range of rows is beyond the bounds of `dry_within`, or was crushed before."""
    before, seat, crushed = history[OPENING_BEFORE], history[SEAT], history[CRUSHED]
    closure, jolt = bounds
    found = 0
    for i in range(rows[0], rows[1]):
        deep = opening[i] + seat[i] < -closure
        found += deep | (opening[i] - before[i] < -jolt) | (crushed[i] > 0.0)
    return found > 0


@kernel
def dry_points(
    rows: tuple[np.uint64, np.uint64],
    of: Array,
    opening: Array,
    slip: Array,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Update a range of points within the bounds of `dry_within`, with the result of `interface.any_points`."""
    spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[PLASTIC_SLIP]
    opening_before, slip_before, seat, slipped = (
        history[OPENING_BEFORE],
        history[SLIP_BEFORE],
        history[SEAT],
        history[SLIPPED],
    )
    k_t, friction, flexibility = of[1], of[4], of[5]
    k_n, growth, end, largest = of[9], of[10], of[12], of[13]
    scale, unit, viscous_t = growth / 64.0, k_n / growth, viscosity * k_t
    # As in `coulomb_kernel`, each array is read once and then written, and minima are written as conditionals.
    for i in range(rows[0], rows[1]):
        jump_n, jump_t = opening[i], slip[i]
        change_n, change_t = jump_n - opening_before[i], jump_t - slip_before[i]
        closure = -(jump_n + seat[i])
        is_closed = closure >= 0.0
        closure = closure if is_closed else 0.0
        below = closure if closure < end else end
        x = scale * below
        y = x * (1.0 + x * (C2 + x * (C3 + x * (C4 + x * (C5 + x * (C6 + x * (C7 + x * (C8 + x * (C9 + x * C10)))))))))
        y = y * (y + 2.0)
        y = y * (y + 2.0)
        y = y * (y + 2.0)
        y = y * (y + 2.0)
        y = y * (y + 2.0)
        y = y * (y + 2.0)
        pressure = unit * y + largest * (closure - below)
        stiffness = k_n + growth * pressure
        stiffness = stiffness if stiffness < largest else largest
        n = (viscosity * stiffness * change_n if is_closed else 0.0) - pressure
        n = n if n < 0.0 else 0.0
        most = -friction * n
        plastic = plastic_slip[i]
        trial = k_t * (jump_t - plastic)
        held, t = shear_within(trial, viscous_t * change_t, most)
        slid = (trial - held) * flexibility
        spent[i] += work_of_slip(trial - k_t * change_t, held, slid)
        opening_before[i] = jump_n
        slip_before[i] = jump_t
        plastic_slip[i] = plastic + slid
        slipped[i] += abs(slid)
        damped[i] += (n + pressure) * change_n + (t - held) * change_t
        normal[i] = n
        tangential[i] = t
