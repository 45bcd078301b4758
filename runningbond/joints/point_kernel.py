"""The point law as a compiled kernel over all joint points; `point_law` is the same law with its tangent.

Kernels know tractions and jumps; the area that a point stands for is its weight, and no business of theirs.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from runningbond.scene import Array, JointMaterial

from .compiled import kernel
from .mohr_coulomb import truncated_cone
from .stiffness import joint_stiffness

FRICTION_WORK, DAMPED_WORK, OPENING_BEFORE, SLIP_BEFORE = range(4)
"""Rows of the history that every law has: work spent on the joint and its viscosity [J/m²], jumps of the last step."""

Parameters: TypeAlias = tuple[NDArray[np.uint64], Array]


@dataclass(frozen=True, eq=False)
class KernelLaw:
    """A law of joint points for the integrator.

    Parameters
    ----------
    kernel
        Compiled ``kernel(opening, slip, parameters, history, viscosity, normal, tangential)``: reads jumps
        ``(np,)`` [m] and parameters, brings the history up to date and writes tractions ``(np,)`` [Pa].
    segments : (ns + 1,) uint64
        First point of each row of points of one material, then their number.
    constants : (ns, n_constants) float
        What the kernel needs to know of each material; k_n, k_t and f_t come first.
    rows : int
        Rows of the history.
    stored
        ``stored(law, opening, normal, tangential)``: energy that the points would give back, ``(np,)`` [J/m²].
    """

    kernel: Any
    segments: NDArray[np.uint64]
    constants: Array
    rows: int
    stored: Callable[["KernelLaw", Array, Array, Array], Array]

    @property
    def parameters(self) -> Parameters:
        """What the kernel is called with."""
        return self.segments, self.constants

    @property
    def points(self) -> int:
        """Number of points."""
        return int(self.segments[-1])

    @property
    def normal_stiffness(self) -> Array:
        """k_n of each point, ``(np,)`` [Pa/m]."""
        return self.of_points(0)

    @property
    def shear_stiffness(self) -> Array:
        """k_t of each point, ``(np,)`` [Pa/m]."""
        return self.of_points(1)

    @property
    def tension(self) -> Array:
        """Largest tension of each point, ``(np,)`` [Pa]."""
        return self.of_points(2)

    def of_points(self, constant: int) -> Array:
        """A constant of each point's material, ``(np,)``."""
        return np.repeat(self.constants[:, constant], np.diff(self.segments).astype(np.int64))


def coulomb_constants(material: JointMaterial) -> tuple[float, ...]:
    """Constants of `coulomb_kernel`: k_n, k_t [Pa/m], f_t, s [Pa], tan φ and 1 / k_t [m/Pa]."""
    stiffness = joint_stiffness(material)
    friction, tension, shear = truncated_cone(material)
    return stiffness.normal, stiffness.shear, tension, shear, friction, 1 / stiffness.shear


def stored_uncut(law: KernelLaw, opening: Array, normal: Array, tangential: Array) -> Array:
    """Energy of springs whose tension is cut off but not forgotten, ``(np,)`` [J/m²]."""
    torn = np.maximum(0.0, opening - law.tension / law.normal_stiffness)
    elastic = normal**2 / (2 * law.normal_stiffness) + tangential**2 / (2 * law.shear_stiffness)
    return np.asarray(elastic + law.tension * torn)


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
    """Tractions of perfectly plastic points with a tension cut-off and without dilatancy, from their jumps.

    Stiffness-proportional viscosity β acts on the jumps' rates: `viscosity` = β / Δt times their change over the
    last step. It never lets a joint pull or slide beyond its strength, so it has no part in a mechanism, but takes
    out the chatter of sliding contacts, on which local damping would otherwise drag.
    """
    segments, constants = parameters
    spent, damped, plastic_slip = history[FRICTION_WORK], history[DAMPED_WORK], history[4]
    opening_before, slip_before = history[OPENING_BEFORE], history[SLIP_BEFORE]
    for segment in range(constants.shape[0]):
        k_n, k_t, strength = constants[segment, 0], constants[segment, 1], constants[segment, 2]
        shear, friction, flexibility = constants[segment, 3], constants[segment, 4], constants[segment, 5]
        viscous_n, viscous_t = viscosity * k_n, viscosity * k_t
        # Each array is read once and then written, and minima are spelt out: so the loop runs in vector registers.
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
            held = trial if trial < most else most
            held = held if held > -most else -most
            t = held + viscous_t * change_t
            t = t if t < most else most
            t = t if t > -most else -most
            slid = (trial - held) * flexibility
            opening_before[i] = jump_n
            slip_before[i] = jump_t
            plastic_slip[i] = plastic + slid
            spent[i] += held * slid
            damped[i] += (n - elastic) * change_n + (t - held) * change_t
            normal[i] = n
            tangential[i] = t
