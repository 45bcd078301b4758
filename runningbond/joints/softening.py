"""Cohesive joint points that soften: fracture in opening (mode I) and in slip (mode II), down to dry friction.

With damage D, of both modes together and never healing, the truncated cone of `mohr_coulomb` shrinks towards its
dry one, f_t (1 − D) and s (1 − D). In opening the traction falls linearly from f_t at δ_e = f_t / k_n to nothing at
δ_c = 2 G_I / f_t and unloads to the origin; in slip the cohesion falls linearly with the slip s_p that does not
come back, to nothing at s_c = 2 G_II / c. Each encloses its fracture energy exactly:

    D_I = (δ − δ_e) / (δ_c − δ_e),    D_II = s_p / s_c,    D = max over time of (D_I² + D_II²)^{1/2} ≤ 1

(Munjiza 2004, with a straight branch). With x that mean, exponential branches of the same energies have

    D = 1 − e^(−2x),    f_t (1 − D) = f_t exp(−(δ − δ_e) / (G_I / f_t − δ_e / 2)),    c (1 − D) = c exp(−c s_p / G_II)

(Lourenço & Rots 1997; only `interface` follows them). A joint whose δ_c lies before δ_e breaks at once: it has stored
more than G_I. One without a tensile strength has no G_I to spend: however far it opens, it keeps its cohesion; with
G_I = 0 it loses it as soon as it opens.
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
"""Beside the rows of plastic points: damage, and the length of the path that they have slipped along [m]."""

DAMAGE, SLIPPED = HISTORY.index("damage"), HISTORY.index("slipped")

NEVER = 1e30
"""Opening [m] at which a joint that is perfectly plastic in opening ends to soften.

Damage on the way there is small, but must not vanish when it is squared: numbers as small as that take a processor a
hundred cycles. Of slip without end there is none.
"""


LEFT = 1e-7
"""Strength, in strengths, at which an exponential branch ends."""


def softening_constants(material: JointMaterial) -> tuple[float, ...]:
    """Constants of `softening_kernel`: those of `coulomb_kernel`, then δ_e, δ_c [m] and 1 / s_c [1/m]."""
    sound = coulomb_constants(material)
    k_n, _, tension, shear, friction, _ = sound
    cohesion = shear + friction * tension
    first = tension / k_n
    last = max(_end_of_softening(material.fracture_energy_1, tension, NEVER), first * (1 + 1e-9))
    return *sound, first, last, 1 / _end_of_softening(material.fracture_energy_2, cohesion, math.inf)


def _end_of_softening(energy: float | None, strength: float, never: float) -> float:
    """Jump at which a linear branch from a strength has spent an energy [m]; tiny for none.

    Without a strength an energy is never spent, as with one that is as small as you like.
    """
    if energy is None or (energy > 0 and strength == 0):
        return never
    return min(never, max(2 * energy / strength if strength > 0 else 0.0, 1e-15))


def weakens_in_fracture(constants: Array) -> Mask:
    """Whether materials of some constants ``(ns, n)`` have a strength, and an energy after which it is gone."""
    _, _, tension, shear, _, _, _, last, per_slip = constants[:, :9].T  # as in `softening_constants`
    return np.asarray(((tension > 0) | (shear > 0)) & ((last < NEVER) | (per_slip > 0)))


def stored_by_secant(points: KernelLaw, opening: Array, normal: Array, tangential: Array) -> Array:
    """Energy of points that unload to the origin in opening, ``(np,)`` [J/m²]."""
    closed = normal**2 / (2 * points.normal_stiffness)
    opened = normal * np.maximum(opening, 0.0) / 2
    return np.asarray(np.where(opening > 0, opened, closed) + tangential**2 / (2 * points.shear_stiffness))


@kernel
def damage_at(x: float, exponential: bool) -> float:
    """D at some x, which ends a straight branch at 1."""
    if not exponential:
        return min(1.0, x)
    left = math.exp(-2.0 * x)
    return 1.0 - left if left > LEFT else 1.0


@kernel
def way_to(damage: float, exponential: bool) -> float:
    """The x at some D."""
    return -0.5 * math.log(max(LEFT, 1.0 - damage)) if exponential else damage


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
            # Secant stiffness in opening: the traction of this damage at the opening that would cause it in mode I.
            onset = first + before * (last - first)
            secant_before = (1.0 - before) * tension / onset
            secant = sound * tension / (first + after * (last - first))
            if tension == 0.0:
                secant_before, secant = 0.0, 0.0
            elastic = secant * jump_n if jump_n > 0.0 else k_n * jump_n
            # The triangle between the two secants: exact along the straight branch, however long the step.
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
"""Models that solve for rest follow no softening: to them its joints are perfectly plastic."""
