"""A user-defined joint law: dry friction that decreases with slip, as if joints were polished, to a residual share."""

import math
from typing import Any

import numpy as np

import runningbond as rb
from runningbond.joints import Law, joint_stiffness
from runningbond.joints.compiled import kernel
from runningbond.joints.law import COMMON_ROWS
from runningbond.scene import Array, JointMaterial, Mask

POLISHED, DISTANCE = 0.5, 1e-4  # residual share of the friction, and slip [m] over which the friction decays
WORK, VISCOUS_WORK, OPENING, SLIP, PLASTIC, POLISH = range(6)  # rows of the history


def constants(material: JointMaterial) -> tuple[float, ...]:
    """Constants of a material for `polish`: k_n, k_t [Pa/m], no tensile strength, tan φ."""
    stiffness = joint_stiffness(material)
    return stiffness.normal, stiffness.shear, 0.0, material.friction


@kernel
def polish(
    opening: Array, slip: Array, parameters: Any, history: Array, viscosity: float, normal: Array, shear: Array
) -> None:
    """Compute tractions [Pa] of joint points from their jumps [m]; the viscous part is from the change of the jumps."""
    segments, constants = parameters
    for segment in range(len(constants)):
        k_n, k_t, friction = constants[segment, 0], constants[segment, 1], constants[segment, 3]
        for i in range(segments[segment], segments[segment + 1]):
            d_n, d_t = opening[i] - history[OPENING, i], slip[i] - history[SLIP, i]
            pressed = min(k_n * opening[i], 0.0)
            normal[i] = min(pressed + viscosity * k_n * d_n, 0.0) if pressed < 0.0 else 0.0
            left = POLISHED + (1 - POLISHED) * math.exp(-history[POLISH, i] / DISTANCE)
            most = -left * friction * normal[i]
            trial = k_t * (slip[i] - history[PLASTIC, i])
            held = min(max(trial, -most), most)
            shear[i] = min(max(held + viscosity * k_t * d_t, -most), most)
            slid = (trial - held) / k_t
            history[WORK, i] += held * slid
            history[VISCOUS_WORK, i] += (normal[i] - pressed) * d_n + (shear[i] - held) * d_t
            history[OPENING, i], history[SLIP, i] = opening[i], slip[i]
            history[PLASTIC, i] += slid
            history[POLISH, i] += abs(slid)


def stored(points: Any, opening: Array, normal: Array, shear: Array) -> Array:
    """Energy of the springs, ``(np,)`` [J/m²]."""
    return np.asarray(normal**2 / (2 * points.normal_stiffness) + shear**2 / (2 * points.shear_stiffness))


def weakens(constants: Array) -> Mask:
    """Joints that lose strength: all of them. Models that cannot include this say so."""
    return np.full(len(constants), POLISHED < 1)


HISTORY = (*COMMON_ROWS, "plastic slip", "polish")
LAW = Law("polished friction", constants, polish, HISTORY, stored, weakens=weakens)

if __name__ == "__main__":
    wall = rb.read("wall-w2")
    rough, polished = (wall.with_({"joint.law": law}).run("dem-dynamic") for law in (None, LAW))
    print(rough, polished, sep="\n")
