"""Crushing of joints: a cap on pressure p and shear τ, which hardens and softens with the work spent on it.

    p² + C τ² ≤ σ_c(κ)²,    dκ = (p dδ_p + τ ds_p) / σ_c

(Lourenço & Rots 1997, eq. 19, with C_nn = 1 and C_n = 0), with associated flow of plastic closure δ_p and slip s_p.
κ [m] is defined such that ∫ σ_c dκ is the work spent on the cap in any mode; in pure compression it equals δ_p. With
the strength f,

    κ < κ_p:  σ_c = f (1 + 2 (x (2 − x))^{1/2}) / 3,  x = κ / κ_p        κ ≥ κ_p:  σ_c = f exp(−(κ − κ_p) / κ_s)

where κ_s makes the branch past the peak dissipate the rest of the fracture energy, and is infinite without one. The cap
ends at zero pressure in τ = ± σ_c / C^{1/2}; in tension it continues at that shear.

Return mapping. At the pressure p = z p', with ' for the trial, the closure is elastic except for Δδ_p = c' − c(p), and

    μ = Δδ_p / p,    τ = min(|τ'| / (1 + C k_t μ), Coulomb's at p),    Δκ = μ (p² + C τ²)^{1/2}

satisfy the flow rule, both on the face of the cap and in its corner with the Coulomb cone. One equation remains for z
between 0 and 1, that of the cap, whose excess grows with z: it is solved by false position (Illinois).
"""

import math
from typing import TypeAlias

from runningbond.scene import JointMaterial

from .closure import Curve, closure_at, stiffness_at
from .compiled import kernel
from .stiffness import joint_stiffness

Cap: TypeAlias = tuple[float, float, float, float]
"""f [Pa], C, κ_p [m] and 1 / κ_s [1/m]; f is infinite for a joint that does not crush."""

RESIDUAL_STRENGTH = 1e-12
"""Residual strength after crushing, relative to f: practically zero, but positive."""

MAX_ITERATIONS = 100
"""Largest number of iterations of the return mapping, which takes about ten."""


def crushing_cap(material: JointMaterial) -> Cap:
    """Cap of a material."""
    strength, peak, energy = material.compressive_strength, material.peak_closure, material.compressive_fracture_energy
    if strength is None:
        return math.inf, 0.0, 0.0, 0.0
    rate = 0.0 if energy is None else strength / (energy - material.energy_to_peak)
    return strength, material.cap_shear, peak, rate


def breaks_suddenly(material: JointMaterial, curve: Curve) -> bool:
    """Whether a joint softens faster in crushing than it unloads, and so releases more than its fracture energy."""
    strength, shear, _, rate = crushing_cap(material)
    if not rate:
        return False
    unloading = float(stiffness_at(strength, curve)), shear * joint_stiffness(material).shear or math.inf
    return strength * rate > min(unloading)


@kernel
def strength_at(crushed: float, cap: Cap) -> float:
    """Strength σ_c [Pa] at a κ [m]."""
    strength, _, peak, rate = cap
    if crushed < peak:
        x = crushed / peak
        return strength / 3.0 * (1.0 + 2.0 * math.sqrt(x * (2.0 - x)))
    return strength if crushed * rate == 0.0 else strength * max(RESIDUAL_STRENGTH, math.exp((peak - crushed) * rate))


@kernel
def work_until(crushed: float, cap: Cap) -> float:
    """Work ∫ σ_c dκ [J/m²] up to a κ [m]."""
    strength, _, peak, rate = cap
    work = 0.0
    if peak > 0.0:
        x = min(1.0, crushed / peak)
        circle = 0.5 * ((x - 1.0) * math.sqrt(x * (2.0 - x)) + math.asin(x - 1.0) + 0.5 * math.pi)
        work = strength * peak / 3.0 * (x + 2.0 * circle)
    beyond = max(0.0, crushed - peak)
    return work + strength * (beyond if rate == 0.0 else -math.expm1(-rate * beyond) / rate)


@kernel
def flow_at(
    z: float,
    trial: tuple[float, float, float],
    k_t: float,
    cone: tuple[float, float, float],
    curve: Curve,
    shear: float,
) -> tuple[float, float, float, float]:
    """Pressure p [Pa], |τ| [Pa], (p² + C τ²)^{1/2} [Pa] and μ [m/Pa] at z; see `return_to_cap` for the arguments."""
    pressure, closure, tangential = trial
    room, friction, tension = cone
    p = z * pressure
    if pressure > 0.0 and closure > 0.0:
        mu = max(0.0, closure - closure_at(p, curve)) / p
    else:
        mu = (1.0 - z) / (z * curve[0])
    most = max(0.0, room + friction * (p - tension))
    t = min(tangential / (1.0 + shear * k_t * mu), most)
    return p, t, math.sqrt(p * p + shear * t * t), mu


@kernel
def return_to_cap(
    trial: tuple[float, float, float],
    crushed: float,
    k_t: float,
    cone: tuple[float, float, float],
    curve: Curve,
    cap: Cap,
) -> tuple[float, float, float]:
    """Return a trial state beyond the cap to the cap, or to its corner with the Coulomb cone.

    Parameters
    ----------
    trial
        Pressure [Pa] and closure [m], both zero for an open joint, and |τ| [Pa].
    crushed
        κ before the step [m].
    k_t
        Shear stiffness [Pa/m].
    cone
        Shear strength without pressure [Pa], tan φ, and tension on the joint [Pa].

    Returns
    -------
    p, |τ|, μ
        Pressure and shear [Pa], and μ [m/Pa]: the step's plastic closure is p μ, its plastic slip on the cap C |τ| μ.
    """
    shear = cap[1]
    low, below = 0.0, -strength_at(crushed, cap)
    high = z = 1.0
    p, t, q, mu = flow_at(z, trial, k_t, cone, curve, shear)
    above = q - strength_at(crushed, cap)
    if above <= 0.0:
        return p, t, 0.0
    side = 0
    for _ in range(MAX_ITERATIONS):
        z = (low * above - high * below) / (above - below)
        if not low < z < high:
            z = 0.5 * (low + high)
        p, t, q, mu = flow_at(z, trial, k_t, cone, curve, shear)
        strength = strength_at(crushed + mu * q, cap)
        excess = q - strength
        if abs(excess) <= 2e-16 * strength or high - low <= 2e-16 * high:
            break
        if excess > 0.0:
            high, above = z, excess
            below *= 0.5 if side > 0 else 1.0
            side = 1
        else:
            low, below = z, excess
            above *= 0.5 if side < 0 else 1.0
            side = -1
    return p, t, mu
