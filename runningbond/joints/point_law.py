"""The joint's law at its points: elastic contact with Coulomb friction, forces and consistent tangent.

With the stiffness K = k A of a point of area A, its opening δ_n, its slip δ_t and the plastic slip δ_t^p, its only
history variable,

    N = min(K_n δ_n, T)                                   no history: a crack closes where it opened     (1)
    S* = K_t (δ_t − δ_t^p)                                trial                                          (2)
    S = S* min(1, R / |S*|),   R = s + tan φ (T − N)      returned to the cone at constant N             (3)
    δ_t^p ← δ_t − S / K_t                                 slip causes no opening: zero dilatancy         (4)

T and s are the point's tensile strength and the shear that it carries at that tension (`PointStrength`). In a
dry joint T = s = 0, and a point that opens carries no force.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array

from .mohr_coulomb import PointStrength


@dataclass(frozen=True, eq=False)
class PointResponse:
    """Response of joint points to a jump.

    Parameters
    ----------
    normal, tangential : (np,) float
        Forces N and S [N], tension positive.
    plastic_slip : (np,) float
        Plastic slip after the jump [m].
    tangent : (np, 2, 2) float
        Derivative of (N, S) with respect to (opening, slip) [N/m]; not symmetric if a point slides under pressure.
    """

    normal: Array
    tangential: Array
    plastic_slip: Array
    tangent: Array


@dataclass(frozen=True, eq=False)
class PointLaw:
    """Joint points that are elastic, with K_n and K_t ``(np,)`` [N/m], up to a strength."""

    strength: PointStrength
    normal_stiffness: Array
    shear_stiffness: Array

    def __call__(self, opening: Array, slip: Array, plastic_slip: Array) -> PointResponse:
        """Response to jumps ``(np,)`` [m] of points with a given plastic slip ``(np,)`` [m]."""
        from .point_kernel import respond  # imported here, as limit analysis needs no compiler

        forces, tangent = np.empty((3, len(opening))), np.empty((len(opening), 2, 2))
        strength = self.strength
        of_points = strength.friction, strength.tension, strength.shear, self.normal_stiffness, self.shear_stiffness
        respond(opening, slip, plastic_slip, of_points, forces, tangent)
        normal, tangential, plastic_slip = forces
        return PointResponse(normal, tangential, plastic_slip, tangent)
