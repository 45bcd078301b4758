"""Joint points that may open, slide, crush and close: `softening` in tension and shear, with a cap and a closure.

The plastic closure δ_p shifts the opening at which a joint is closed: wherever `softening` uses δ, this law uses
δ + δ_p. Pressure follows `closure`, shear Coulomb's law with zero dilatancy, both within the cap of `crushing`. For a
material that neither crushes nor closes, the tractions are those of `softening`.
"""

import math

import numpy as np

from runningbond.scene import Array, JointMaterial, Mask

from .closure import Curve, closure_at, closure_curve, pressure_at, stiffness_at, stored_at
from .compiled import kernel
from .coulomb import PLASTIC_SLIP, work_of_slip
from .crushing import breaks_suddenly, crushing_cap, return_to_cap, strength_at, work_until
from .dry_points import CRUSHED, SEAT, SLIPPED, dry_points, dry_within, is_beyond
from .law import (
    CRUSHING,
    DAMPED_WORK,
    FRICTION_WORK,
    OPENING_BEFORE,
    PLASTIC_CLOSURE,
    SLIP_BEFORE,
    KernelLaw,
    Law,
    Parameters,
)
from .softening import DAMAGE, damage_at, softening_constants, way_to, weakens_in_fracture
from .softening import HISTORY as SOFTENING_HISTORY
from .sound_points import are_sound, can_be_sound, sound_points

HISTORY = (*SOFTENING_HISTORY, PLASTIC_CLOSURE, CRUSHING)
"""History rows after those of softening points: plastic closure δ_p and κ of the cap, both [m]."""

BATCH = np.uint64(64)
"""Number of points that are checked and updated together."""

CURVE = 9
"""Index of the closure curve's first constant."""

STIFFEST = CURVE + 4

CAP = CURVE + 5
"""Index of the compressive strength, the cap's first constant."""

SOFTENS_CRUSHED = CURVE + 8
"""Index of 1 / κ_s of the cap: zero for a cap that keeps its strength however far it is crushed."""


def interface_constants(material: JointMaterial) -> tuple[float, ...]:
    """Constants of `interface_kernel`: softening, closure, crushing; flags: sudden crushing, exponential softening."""
    curve, exponential = closure_curve(material), material.softening == "exponential"
    flags = float(breaks_suddenly(material, curve)), float(exponential)
    return *softening_constants(material), *curve, *crushing_cap(material), *flags


def weakens(constants: Array) -> Mask:
    """Whether materials with constants ``(ns, n)`` lose strength, by fracture or by crushing."""
    return np.asarray(weakens_in_fracture(constants) | (constants[:, SOFTENS_CRUSHED] > 0))


def curve_of(points: KernelLaw) -> tuple[Array, ...]:
    """Closure curve of each point, five arrays ``(np,)``."""
    return tuple(points.of_points(CURVE + k) for k in range(5))


def closed_under(points: KernelLaw, pressure: Array) -> tuple[Array, Array]:
    """Elastic closure [m] of points under a pressure [Pa] and their tangent stiffness [Pa/m], two ``(np,)``."""
    curve = curve_of(points)
    return closure_at.py_func(pressure, curve), stiffness_at.py_func(pressure, curve)


def stored_when_seated(points: KernelLaw, opening: Array, normal: Array, tangential: Array) -> Array:
    """Recoverable energy ``(np,)`` [J/m²] of points that unload to contact in opening, along their curve in closure."""
    curve = curve_of(points)
    closed = stored_at.py_func(np.maximum(0.0, -normal), curve)
    opened = np.maximum(0.0, normal) * np.maximum(0.0, opening) / 2
    return np.asarray(closed + opened + tangential**2 / (2 * points.shear_stiffness))


@kernel
def snapped(
    before: tuple[float, float],
    after: tuple[float, float],
    change: tuple[float, float],
    curve: Curve,
    flexibility: float,
) -> float:
    """Energy [J/m²] put into a point in a step and not stored: more than the work of the cap if it crushes suddenly.

    `before` is closure [m] and shear [Pa], `after` pressure and shear [Pa], `change` that of both jumps [m].
    """
    p_before, (p, t) = pressure_at(before[0], curve), after
    put_in = 0.5 * ((before[1] + t) * change[1] - (p_before + p) * change[0])
    released = stored_at(p_before, curve) - stored_at(p, curve)
    energy: float = max(0.0, put_in + released + 0.5 * (before[1] * before[1] - t * t) * flexibility)
    return energy


@kernel
def any_points(
    rows: tuple[np.uint64, np.uint64],
    of: Array,
    opening: Array,
    slip: Array,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Update a range of points of one material, whatever state they are in."""
    spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[PLASTIC_SLIP]
    opening_before, slip_before = history[OPENING_BEFORE], history[SLIP_BEFORE]
    damage, slipped, seat, crushed = history[DAMAGE], history[SLIPPED], history[SEAT], history[CRUSHED]
    k_t, tension, shear, friction, flexibility = of[1], of[2], of[3], of[4], of[5]
    first, last, per_slip = of[6], of[7], of[8]
    is_strong = tension > 0.0 or shear > 0.0  # a dry joint has no strength to lose
    curve = (of[9], of[10], of[11], of[12], of[13])
    cap = (of[14], of[15], of[16], of[17])
    crushes, cap_shear, sudden, exponential = of[14] < math.inf, of[15], of[18] > 0.0, of[19] > 0.0
    for i in range(rows[0], rows[1]):
        change_n, change_t = opening[i] - opening_before[i], slip[i] - slip_before[i]
        jump_n = opening[i] + seat[i]
        before = damage[i]
        after, sheared = before, slipped[i] * per_slip
        if is_strong and before < 1.0 and (jump_n > first or sheared > 0.0):
            torn = max(0.0, (jump_n - first) / (last - first))
            after = max(before, damage_at(math.sqrt(torn * torn + sheared * sheared), exponential))
        sound = 1.0 - after
        trial = k_t * (slip[i] - plastic_slip[i])
        room = sound * (shear + friction * tension)
        viscous, pressure, closure = 0.0, 0.0, max(0.0, -jump_n)
        if jump_n > 0.0:
            secant = 0.0
            if tension > 0.0 and sound > 0.0:
                secant = sound * tension / (first + way_to(after, exponential) * (last - first))
            if tension > 0.0 and after > before:
                onset = first + way_to(before, exponential) * (last - first)
                spent[i] += 0.5 * ((1.0 - before) * tension / onset - secant) * jump_n * min(jump_n, onset)
            elastic = secant * jump_n
        else:
            pressure = pressure_at(closure, curve)
            elastic = -pressure
            viscous = viscosity * stiffness_at(pressure, curve) * change_n
        flowed = 0.0  # plastic slip on the cap
        n = min(elastic + viscous, sound * tension)
        most = max(0.0, room - friction * n)
        held = max(-most, min(most, trial))
        slid = (trial - held) * flexibility
        limit, still = math.inf, 0.0
        if crushes:
            limit = strength_at(crushed[i], cap)
            still = min(abs(trial), max(0.0, room - friction * elastic))
            if pressure * pressure + cap_shear * still * still > limit * limit:
                pull = max(0.0, elastic)
                beyond = (pressure, closure, abs(trial))
                p, t, mu = return_to_cap(beyond, crushed[i], k_t, (room, friction, pull), curve, cap)
                n = elastic = pull - p
                held = math.copysign(t, trial)
                most = t
                slid = (trial - held) * flexibility
                flowed = cap_shear * mu * held
                kappa = crushed[i] + mu * math.sqrt(p * p + cap_shear * t * t)
                work = work_until(kappa, cap) - work_until(crushed[i], cap)
                if sudden:
                    was = (max(0.0, -opening_before[i] - seat[i]), k_t * (slip_before[i] - plastic_slip[i]))
                    work = snapped(was, (p, held), (change_n, change_t), curve, flexibility)
                    work -= work_of_slip(was[1], held, slid - flowed)
                spent[i] += work
                crushed[i] = kappa
                seat[i] += p * mu
                limit = math.inf
        t = max(-most, min(most, held + viscosity * k_t * change_t))
        if crushes and min(0.0, n) ** 2 + cap_shear * t * t > limit * limit:
            # Viscous pressure and shear may not exceed the cap either.
            n = max(n, -max(pressure, math.sqrt(limit * limit - cap_shear * still * still)))
            if cap_shear > 0.0:
                within = max(0.0, limit * limit - min(0.0, n) ** 2) / cap_shear
                most = min(max(0.0, room - friction * n), max(still, math.sqrt(within)))
            held = max(-most, min(most, trial))
            slid = (trial - held) * flexibility
            t = max(-most, min(most, held + viscosity * k_t * change_t))
        plastic_slip[i] += slid
        slipped[i] += abs(slid - flowed)
        spent[i] += work_of_slip(trial - k_t * change_t, held, slid - flowed)
        damped[i] += (n - elastic) * change_n + (t - held) * change_t
        damage[i] = after
        opening_before[i] = opening[i]
        slip_before[i] = slip[i]
        normal[i] = n
        tangential[i] = t


@kernel
def interface_kernel(
    opening: Array,
    slip: Array,
    parameters: Parameters,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Tractions of joint points from their jumps; see `coulomb_kernel` for the arguments.

    Viscosity is proportional to the present stiffness, and does not act on points that are being crushed.
    """
    segments, constants = parameters
    for segment in range(constants.shape[0]):
        of = constants[segment]
        first, last = segments[segment], segments[np.uint64(segment + 1)]
        bounds, strong = dry_within(of, viscosity), can_be_sound(of)
        while first < last:
            rows = (first, min(first + BATCH, last))
            if bounds[0] >= 0.0 and not is_beyond(rows, opening, history, bounds):
                dry_points(rows, of, opening, slip, history, viscosity, normal, tangential)
            elif strong and are_sound(rows, of, opening, slip, history, viscosity):
                sound_points(rows, of, opening, slip, history, viscosity, normal, tangential)
            else:
                any_points(rows, of, opening, slip, history, viscosity, normal, tangential)
            first = rows[1]


INTERFACE = Law(
    "interface",
    interface_constants,
    interface_kernel,
    HISTORY,
    stored_when_seated,
    damage="damage",
    stiffest=STIFFEST,
    cap=CAP,
    closed=closed_under,
    weakens=weakens,
)
