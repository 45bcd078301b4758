"""Cohesive joint points that soften: fracture in opening (mode I) and in slip (mode II), down to dry friction.

With the damage D, common to both modes and irreversible, the truncated cone of `mohr_coulomb` shrinks to that of a dry
joint, f_t (1 − D) and s (1 − D). In opening, the traction falls linearly from f_t at δ_e = f_t / k_n to zero at
δ_c = 2 G_I / f_t, and unloads to the origin; in slip, the cohesion falls linearly with the accumulated plastic slip
s_p, to zero at s_c = 2 G_II / c. Each branch encloses its fracture energy exactly:

    D_I = (δ − δ_e) / (δ_c − δ_e),    D_II = s_p / s_c,    D = max over time of (D_I² + D_II²)^{1/2} ≤ 1

(Munjiza 2004, with a linear branch). With x this root of squares, exponential branches of the same energies have

    D = 1 − e^(−2x),    f_t (1 − D) = f_t exp(−(δ − δ_e) / (G_I / f_t − δ_e / 2)),    c (1 − D) = c exp(−c s_p / G_II)

(Lourenço & Rots 1997; only `interface` has them). A joint with δ_c < δ_e breaks at once, because it has stored more
than G_I. A joint without tensile strength cannot dissipate G_I: it keeps its cohesion however far it opens; with
G_I = 0 it loses the cohesion as soon as it opens.
"""

import math

import numpy as np

from runningbond.scene import Array, JointMaterial, Mask

from .compiled import kernel
from .coulomb import HISTORY as PLASTIC_HISTORY
from .coulomb import PLASTIC_SLIP, coulomb_constants, work_of_slip
from .law import DAMPED_WORK, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE, KernelLaw, Law, Parameters
from .point_law import PointLaw

HISTORY = (*PLASTIC_HISTORY, "damage", "slipped")
"""History rows after those of plastic points: damage, and the accumulated length of plastic slip [m]."""

DAMAGE, SLIPPED = HISTORY.index("damage"), HISTORY.index("slipped")

NEVER = 1e30
"""Opening [m] at which softening ends for a joint that is perfectly plastic in opening.

Damage on the way there is small, but must not underflow when it is squared: numbers that small take a processor a
hundred cycles. Slip without softening has no such limit: 1 / s_c is zero.
"""


RESIDUAL_STRENGTH = 1e-7
"""Strength, relative to the initial one, at which an exponential branch ends."""


def softening_constants(material: JointMaterial) -> tuple[float, ...]:
    """Constants of `softening_kernel`: those of `coulomb_kernel`, then δ_e, δ_c [m] and 1 / s_c [1/m]."""
    sound = coulomb_constants(material)
    k_n, _, tension, shear, friction, _ = sound
    cohesion = shear + friction * tension
    first = tension / k_n
    last = max(_end_of_softening(material.fracture_energy_1, tension, NEVER), first * (1 + 1e-9))
    return *sound, first, last, 1 / _end_of_softening(material.fracture_energy_2, cohesion, math.inf)


def _end_of_softening(energy: float | None, strength: float, never: float) -> float:
    """Jump [m] at which a linear branch from a strength has dissipated an energy; tiny for zero energy.

    Without strength, energy is never dissipated, as in the limit of a vanishing strength.
    """
    if energy is None or (energy > 0 and strength == 0):
        return never
    return min(never, max(2 * energy / strength if strength > 0 else 0.0, 1e-15))


def weakens_in_fracture(constants: Array) -> Mask:
    """Whether materials with constants ``(ns, n)`` have a strength and a finite fracture energy."""
    _, _, tension, shear, _, _, _, last, per_slip = constants[:, :9].T  # as in `softening_constants`
    return np.asarray(((tension > 0) | (shear > 0)) & ((last < NEVER) | (per_slip > 0)))


def stored_by_secant(points: KernelLaw, opening: Array, normal: Array, tangential: Array) -> Array:
    """Energy of points that unload to the origin in opening, ``(np,)`` [J/m²]."""
    closed = normal**2 / (2 * points.normal_stiffness)
    opened = normal * np.maximum(opening, 0.0) / 2
    return np.asarray(np.where(opening > 0, opened, closed) + tangential**2 / (2 * points.shear_stiffness))


@kernel
def damage_at(x: float, exponential: bool) -> float:
    """Damage D at x; a linear branch ends at x = 1."""
    if not exponential:
        return min(1.0, x)
    left = math.exp(-2.0 * x)
    return 1.0 - left if left > RESIDUAL_STRENGTH else 1.0


@kernel
def way_to(damage: float, exponential: bool) -> float:
    """The x at a damage D."""
    return -0.5 * math.log(max(RESIDUAL_STRENGTH, 1.0 - damage)) if exponential else damage


@kernel
def softening_kernel(
    opening: Array,
    slip: Array,
    parameters: Parameters,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Tractions of softening joint points from their jumps; see `coulomb_kernel` for the arguments."""
    segments, constants = parameters
    spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[PLASTIC_SLIP]
    opening_before, slip_before = history[OPENING_BEFORE], history[SLIP_BEFORE]
    damage, slipped = history[DAMAGE], history[SLIPPED]
    for segment in range(constants.shape[0]):
        k_n, k_t, tension = constants[segment, 0], constants[segment, 1], constants[segment, 2]
        shear, friction, flexibility = constants[segment, 3], constants[segment, 4], constants[segment, 5]
        first, last, per_slip = constants[segment, 6], constants[segment, 7], constants[segment, 8]
        for i in range(segments[segment], segments[np.uint64(segment + 1)]):
            jump_n, jump_t = opening[i], slip[i]
            change_n, change_t = jump_n - opening_before[i], jump_t - slip_before[i]
            before = damage[i]
            torn = min(1.0, max(0.0, (jump_n - first) / (last - first)))
            sheared = min(1.0, slipped[i] * per_slip)
            after = max(before, min(1.0, np.sqrt(torn * torn + sheared * sheared)))
            sound = 1.0 - after
            # Secant stiffness in opening: the strength at this damage over the opening that would cause it in mode I.
            onset = first + before * (last - first)
            secant_before = (1.0 - before) * tension / onset
            secant = sound * tension / (first + after * (last - first))
            if tension == 0.0:
                secant_before, secant = 0.0, 0.0
            elastic = secant * jump_n if jump_n > 0.0 else k_n * jump_n
            # The triangle between the two secants: exact on the linear branch, for any step size.
            reach = max(jump_n, 0.0)
            spent[i] += 0.5 * (secant_before - secant) * reach * min(reach, onset)
            n = elastic
            if jump_n <= 0.0:
                n = min(elastic + viscosity * k_n * change_n, sound * tension)
            most = max(0.0, sound * shear + friction * (sound * tension - n))
            trial = k_t * (jump_t - plastic_slip[i])
            held = max(-most, min(most, trial))
            t = max(-most, min(most, held + viscosity * k_t * change_t))
            slid = (trial - held) * flexibility
            plastic_slip[i] += slid
            slipped[i] += abs(slid)
            spent[i] += work_of_slip(trial - k_t * change_t, held, slid)
            damped[i] += (n - elastic) * change_n + (t - held) * change_t
            damage[i] = after
            opening_before[i] = jump_n
            slip_before[i] = jump_t
            normal[i] = n
            tangential[i] = t


SOFTENING = Law(
    "softening",
    softening_constants,
    softening_kernel,
    HISTORY,
    stored_by_secant,
    damage="damage",
    response=PointLaw,
    weakens=weakens_in_fracture,
)
"""Softening law; static models do not follow the softening, but treat these joints as perfectly plastic."""
