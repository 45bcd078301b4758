"""The Mohr–Coulomb joint with a tension cut-off, as the set of forces that a joint point can carry.

Per unit area, with σ the normal traction (tension positive) and τ the tangential one,

    |τ| ≤ c − σ tan φ,    σ ≤ f_t ≤ c / tan φ.

Measured from its vertex, this truncated cone is the sum of a cone and a segment,

    σ = f_t − p,    |τ| ≤ s + p tan φ,    p ≥ 0,    s = c − f_t tan φ ≥ 0,

which avoids divisions by tan φ and by c: dry (c = 0) and frictionless (tan φ = 0) joints are ordinary cases.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array, JointMaterial


@dataclass(frozen=True, eq=False)
class PointStrength:
    """Strength of joint points, as the set of forces that they can carry.

    Parameters
    ----------
    friction : (np,) float
        tan φ.
    tension : (np,) float
        Largest tensile force f_t A [N].
    shear : (np,) float
        Shear force that the point carries at that tension, s A [N].
    """

    friction: Array
    tension: Array
    shear: Array

    @property
    def cohesion(self) -> Array:
        """Shear force that each point carries without pressure, ``(np,)`` [N]."""
        return self.shear + self.friction * self.tension

    @property
    def strongest(self) -> float:
        """Largest of the tensile forces and of the shear forces at that tension [N]; zero for dry joints."""
        return float(max(self.tension.max(initial=0.0), self.shear.max(initial=0.0)))

    def violation(self, normal: Array, tangential: Array) -> Array:
        """Force [N] by which point forces ``(np,)`` lie outside the set; not positive inside it."""
        pressure = self.tension - normal
        return np.maximum(-pressure, np.abs(tangential) - self.shear - self.friction * pressure)

    def dissipation(self, opening: Array, slip: Array) -> Array:
        """Largest power [W] of admissible point forces on jump rates ``(np,)`` [m/s].

        The support function of the set, for jumps in its normal cone: opening ≥ tan φ |slip|.
        """
        return self.tension * opening + self.shear * np.abs(slip)


def truncated_cone(material: JointMaterial) -> tuple[float, float, float]:
    """Friction tan φ, tension f_t [Pa] and shear s at that tension [Pa] of a material."""
    cohesion, friction, tension = material.cohesion, material.friction, material.tension
    # After rounding, the apex may lie slightly beyond the cone.
    if friction * tension > cohesion:
        tension = cohesion / friction
    return friction, tension, max(0.0, cohesion - tension * friction)


def point_strength(material: JointMaterial, area: Array) -> PointStrength:
    """Strength of joint points of one material with areas ``(np,)`` [m²]."""
    friction, tension, shear = truncated_cone(material)
    return PointStrength(np.full(len(area), friction), tension * area, shear * area)
