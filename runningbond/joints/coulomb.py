"""Perfectly plastic joint points as a compiled kernel; `point_law` has the same law with its tangent."""

from typing import Any

import numpy as np

from runningbond.scene import Array, JointMaterial

from .compiled import kernel
from .law import COMMON_ROWS, DAMPED_WORK, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE, KernelLaw, Law, Parameters
from .mohr_coulomb import truncated_cone
from .point_law import PointLaw
from .stiffness import joint_stiffness

HISTORY = (*COMMON_ROWS, "plastic slip")
PLASTIC_SLIP = HISTORY.index("plastic slip")
PULL_BEFORE, SHEAR_BEFORE = len(HISTORY), len(HISTORY) + 1


def coulomb_constants(material: JointMaterial) -> tuple[float, ...]:
    """Constants of `coulomb_kernel`: k_n, k_t [Pa/m], f_t, s [Pa], tan φ and 1 / k_t [m/Pa]."""
    stiffness = joint_stiffness(material)
    friction, tension, shear = truncated_cone(material)
    return stiffness.normal, stiffness.shear, tension, shear, friction, 1 / stiffness.shear


def stored_uncut(points: KernelLaw, opening: Array, normal: Array, tangential: Array) -> Array:
    """Recoverable energy of springs whose tension is cut off reversibly, without loss, ``(np,)`` [J/m²]."""
    torn = np.maximum(0.0, opening - points.tension / points.normal_stiffness)
    elastic = normal**2 / (2 * points.normal_stiffness) + tangential**2 / (2 * points.shear_stiffness)
    return np.asarray(elastic + points.tension * torn)


@kernel
def shear_within(trial: float, drag: float, most: float) -> tuple[float, float]:
    """Shear of a point's spring, and of spring and dashpot together [Pa], both limited to a strength."""
    # Minima are written as conditionals, so that the calling loop runs in vector registers.
    held = trial if trial < most else most
    held = held if held > -most else -most
    t = held + drag
    t = t if t < most else most
    return held, t if t > -most else -most


@kernel
def work_of_slip(before: float, held: float, slid: float) -> float:
    """Work [J/m²] of a slip [m] under the mean of a spring's shear before and after it, as in central differences.

    Negative work, when the shear reverses, is cut off because friction only dissipates; the ledger misses that part.
    """
    work = 0.5 * (before + held) * slid
    return work if work > 0.0 else 0.0


def _coulomb(of_mean: bool) -> Any:
    """Return the kernel; its viscous work uses the mean traction of two steps, as central differences do, or the last.

    With the last traction, the work is several percent too large in an impact, but the history has two rows less.
    """

    @kernel
    def coulomb_kernel(
        opening: Array,
        slip: Array,
        parameters: Parameters,
        history: Array,
        viscosity: float,
        normal: Array,
        tangential: Array,
    ) -> None:
        """Compute tractions of perfectly plastic points, with tension cut-off and zero dilatancy, from their jumps.

        Stiffness-proportional viscosity β acts on the rates of the jumps: `viscosity` = β / Δt multiplies their change
        over the last step. It never lets a joint pull or slide beyond its strength, so it has no part in a mechanism,
        but it removes the chatter of sliding contacts, which local damping would otherwise brake.
        """
        segments, constants = parameters
        spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[PLASTIC_SLIP]
        opening_before, slip_before = history[OPENING_BEFORE], history[SLIP_BEFORE]
        pull_before, shear_before = damped, damped
        if of_mean:
            pull_before, shear_before = history[PULL_BEFORE], history[SHEAR_BEFORE]
        for segment in range(constants.shape[0]):
            k_n, k_t, strength = constants[segment, 0], constants[segment, 1], constants[segment, 2]
            shear, friction, flexibility = constants[segment, 3], constants[segment, 4], constants[segment, 5]
            viscous_n, viscous_t = viscosity * k_n, viscosity * k_t
            # Each array is read once and then written, for vector registers: see `shear_within`.
            for i in range(segments[segment], segments[np.uint64(segment + 1)]):
                jump_n, jump_t = opening[i], slip[i]
                change_n, change_t = jump_n - opening_before[i], jump_t - slip_before[i]
                elastic = k_n * jump_n
                elastic = elastic if elastic < strength else strength
                n = elastic + (viscous_n * change_n if elastic < strength else 0.0)
                n = n if n < strength else strength
                most = shear + friction * (strength - n)
                plastic = plastic_slip[i]
                trial = k_t * (jump_t - plastic)
                held, t = shear_within(trial, viscous_t * change_t, most)
                slid = (trial - held) * flexibility
                spent[i] += work_of_slip(trial - k_t * change_t, held, slid)
                opening_before[i] = jump_n
                slip_before[i] = jump_t
                plastic_slip[i] = plastic + slid
                pull, drag = n - elastic, t - held
                if of_mean:
                    damped[i] += 0.5 * ((pull_before[i] + pull) * change_n + (shear_before[i] + drag) * change_t)
                    pull_before[i] = pull
                    shear_before[i] = drag
                else:
                    damped[i] += pull * change_n + drag * change_t
                normal[i] = n
                tangential[i] = t

    return coulomb_kernel


coulomb_kernel = _coulomb(of_mean=False)
COULOMB = Law("Coulomb", coulomb_constants, coulomb_kernel, HISTORY, stored_uncut, response=PointLaw)

IMPACTS = Law(
    *("Coulomb, impacts", coulomb_constants, _coulomb(of_mean=True)),
    (*HISTORY, "viscous pull", "viscous shear"),
    stored_uncut,
    response=PointLaw,
)
"""Coulomb's law with the energy ledger that impacts need."""
