"""The point law as a compiled kernel over all joint points; `point_law` is the same law with its tangent."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from scene import Array

from .compiled import kernel
from .mohr_coulomb import PointStrength

FRICTION_WORK, DAMPED_WORK, OPENING_BEFORE, SLIP_BEFORE = range(4)
"""Rows of the history that every law has: work spent on the joint and on its viscosity [J], jumps of the last step."""


@dataclass(frozen=True, eq=False)
class KernelLaw:
    """A law of joint points for the integrator.

    Parameters
    ----------
    kernel
        Compiled ``kernel(opening, slip, parameters, history, viscosity, normal, tangential)``: reads jumps
        ``(np,)`` [m] and parameters, brings the history up to date and writes forces ``(np,)`` [N].
    parameters : (n_parameters, np) float
        What the kernel needs to know of each point.
    rows : int
        Rows of the history.
    stored
        ``stored(law, opening, normal, tangential)``: energy that the points would give back [J].
    """

    kernel: Any
    parameters: Array
    rows: int
    stored: Callable[["KernelLaw", Array, Array, Array], float]

    @property
    def normal_stiffness(self) -> Array:
        """k_n A of each point, ``(np,)`` [N/m]; the first row of every law's parameters."""
        return np.asarray(self.parameters[0])

    @property
    def shear_stiffness(self) -> Array:
        """k_t A of each point, ``(np,)`` [N/m]; the second row of every law's parameters."""
        return np.asarray(self.parameters[1])

    @property
    def tension(self) -> Array:
        """Largest tension of each point, ``(np,)`` [N]; the third row of every law's parameters."""
        return np.asarray(self.parameters[2])


def coulomb_law(
    normal_stiffness: Array, shear_stiffness: Array, strength: PointStrength, friction: Array | None = None
) -> KernelLaw:
    """Perfectly plastic Mohr–Coulomb points with a tension cut-off and without dilatancy.

    Parameters
    ----------
    normal_stiffness, shear_stiffness : (np,) float
        k_n A and k_t A [N/m].
    strength
        Strength of the points.
    friction : (np,) float, optional
        tan φ of each point where they differ.
    """
    mu = np.full(len(strength.tension), strength.friction) if friction is None else friction
    parameters = [normal_stiffness, shear_stiffness, strength.tension, strength.shear, mu, 1 / shear_stiffness]
    return KernelLaw(coulomb_kernel, np.array(parameters), 5, _stored_uncut)


def _stored_uncut(law: KernelLaw, opening: Array, normal: Array, tangential: Array) -> float:
    """Energy of springs whose tension is cut off but not forgotten."""
    torn = np.maximum(0.0, opening - law.tension / law.normal_stiffness)
    elastic = normal**2 / (2 * law.normal_stiffness) + tangential**2 / (2 * law.shear_stiffness)
    return float((elastic + law.tension * torn).sum())


@kernel
def coulomb_kernel(
    opening: Array,
    slip: Array,
    parameters: Array,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """Forces at joint points from their jumps.

    Stiffness-proportional viscosity β acts on the jumps' rates: `viscosity` = β / Δt times their change over the
    last step. It never lets a joint pull or slide beyond its strength, so it has no part in a mechanism, but takes
    out the chatter of sliding contacts, on which local damping would otherwise drag.
    """
    k_n, k_t, tension = parameters[0], parameters[1], parameters[2]
    shear, friction, flexibility = parameters[3], parameters[4], parameters[5]
    spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[4]
    opening_before, slip_before = history[OPENING_BEFORE], history[SLIP_BEFORE]
    # Each array is read once and then written, and minima are spelt out: so the loop runs in vector registers.
    for i in range(opening.size):
        jump_n, jump_t, k, strength = opening[i], slip[i], k_n[i], tension[i]
        change_n, change_t = jump_n - opening_before[i], jump_t - slip_before[i]
        elastic = k * jump_n
        elastic = elastic if elastic < strength else strength
        n = elastic + (viscosity * k * change_n if elastic < strength else 0.0)
        n = n if n < strength else strength
        most = shear[i] + friction[i] * (strength - n)
        plastic = plastic_slip[i]
        trial = k_t[i] * (jump_t - plastic)
        held = trial if trial < most else most
        held = held if held > -most else -most
        t = held + viscosity * k_t[i] * change_t
        t = t if t < most else most
        t = t if t > -most else -most
        slid = (trial - held) * flexibility[i]
        opening_before[i] = jump_n
        slip_before[i] = jump_t
        plastic_slip[i] = plastic + slid
        spent[i] += held * slid
        damped[i] += (n - elastic) * change_n + (t - held) * change_t
        normal[i] = n
        tangential[i] = t
