"""Cohesive joint points that soften: fracture in opening (mode I) and in slip (mode II), down to dry friction.

With damage D, of both modes together and never healing, the truncated cone of `mohr_coulomb` shrinks towards its
dry one, f_t (1 − D) and s (1 − D). In opening the traction falls linearly from f_t at δ_e = f_t / k_n to nothing at
δ_c = 2 G_I / f_t and unloads to the origin; in slip the cohesion falls linearly with the slip s_p that does not
come back, to nothing at s_c = 2 G_II / c. Each encloses its fracture energy exactly:

    D_I = (δ − δ_e) / (δ_c − δ_e),    D_II = s_p / s_c,    D = max over time of (D_I² + D_II²)^{1/2} ≤ 1

(Munjiza 2004, with a straight branch). A joint whose δ_c lies before δ_e breaks at once: it has stored more than G_I.
"""

import numpy as np

from scene import Array

from .compiled import kernel
from .mohr_coulomb import PointStrength
from .point_kernel import DAMPED_WORK, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE, KernelLaw

PLASTIC_SLIP, DAMAGE, SLIPPED = 4, 5, 6
"""Rows of the history beside those of every law: slip that stays [m], damage, and the length of its path [m]."""


def softening_law(
    normal_stiffness: Array,
    shear_stiffness: Array,
    strength: PointStrength,
    area: Array,
    energy_1: float | None,
    energy_2: float | None,
) -> KernelLaw:
    """Mohr–Coulomb points whose tension and cohesion are lost to fracture.

    Parameters
    ----------
    normal_stiffness, shear_stiffness : (np,) float
        k_n A and k_t A [N/m].
    strength
        Strength of the sound points.
    area : (np,) float
        Area of the points [m²].
    energy_1, energy_2
        Fracture energies of the two modes [J/m²]; None never softens.
    """
    cohesion = strength.shear + strength.friction * strength.tension
    first = strength.tension / normal_stiffness
    last = np.maximum(_end_of_softening(energy_1, area, strength.tension), first * (1 + 1e-9))
    slipped = _end_of_softening(energy_2, area, cohesion)
    mu = np.full(len(area), strength.friction)
    parameters = [normal_stiffness, shear_stiffness, strength.tension, strength.shear, mu, 1 / shear_stiffness]
    return KernelLaw(softening_kernel, np.array([*parameters, first, last, 1 / slipped]), 7, _stored)


def _end_of_softening(energy: float | None, area: Array, strength: Array) -> Array:
    """Jump at which a linear branch from a strength has spent an energy [m]; tiny for none of either."""
    if energy is None:
        return np.full(len(area), 1e300)
    with np.errstate(divide="ignore", invalid="ignore"):
        jump = np.where(strength > 0, 2 * energy * area / strength, 0.0)
    return np.maximum(jump, 1e-15)


def _stored(law: KernelLaw, opening: Array, normal: Array, tangential: Array) -> float:
    """Energy of points that unload to the origin in opening."""
    closed = normal**2 / (2 * law.normal_stiffness)
    opened = normal * np.maximum(opening, 0.0) / 2
    return float((np.where(opening > 0, opened, closed) + tangential**2 / (2 * law.shear_stiffness)).sum())


@kernel
def softening_kernel(
    opening: Array,
    slip: Array,
    parameters: Array,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Forces at softening joint points from their jumps; see `coulomb_kernel` for the arguments."""
    k_n, k_t, tension = parameters[0], parameters[1], parameters[2]
    shear, friction, flexibility = parameters[3], parameters[4], parameters[5]
    first, last, per_slip = parameters[6], parameters[7], parameters[8]
    spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[PLASTIC_SLIP]
    opening_before, slip_before = history[OPENING_BEFORE], history[SLIP_BEFORE]
    damage, slipped = history[DAMAGE], history[SLIPPED]
    for i in range(opening.size):
        jump_n, jump_t = opening[i], slip[i]
        change_n, change_t = jump_n - opening_before[i], jump_t - slip_before[i]
        before = damage[i]
        torn = min(1.0, max(0.0, (jump_n - first[i]) / (last[i] - first[i])))
        sheared = min(1.0, slipped[i] * per_slip[i])
        after = max(before, min(1.0, np.sqrt(torn * torn + sheared * sheared)))
        sound = 1.0 - after
        # Secant stiffness in opening: the traction of this damage at the opening that would cause it in mode I.
        onset = first[i] + before * (last[i] - first[i])
        secant_before = (1.0 - before) * tension[i] / onset
        secant = sound * tension[i] / (first[i] + after * (last[i] - first[i]))
        if tension[i] == 0.0:
            secant_before, secant = 0.0, 0.0
        elastic = secant * jump_n if jump_n > 0.0 else k_n[i] * jump_n
        # The triangle between the two secants: exact along the straight branch, however long the step.
        reach = max(jump_n, 0.0)
        spent[i] += 0.5 * (secant_before - secant) * reach * min(reach, onset)
        n = elastic
        if jump_n <= 0.0:
            n = min(elastic + viscosity * k_n[i] * change_n, sound * tension[i])
        most = max(0.0, sound * shear[i] + friction[i] * (sound * tension[i] - n))
        trial = k_t[i] * (jump_t - plastic_slip[i])
        held = max(-most, min(most, trial))
        t = max(-most, min(most, held + viscosity * k_t[i] * change_t))
        slid = (trial - held) * flexibility[i]
        plastic_slip[i] += slid
        slipped[i] += abs(slid)
        spent[i] += held * slid
        damped[i] += (n - elastic) * change_n + (t - held) * change_t
        damage[i] = after
        opening_before[i] = jump_n
        slip_before[i] = jump_t
        normal[i] = n
        tangential[i] = t
