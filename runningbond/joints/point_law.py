"""The joint's law at its points: elastic contact with Coulomb friction, forces and consistent tangent.

With K = k A the stiffness of a point that stands for an area A, δ_n its opening, δ_t its slip and δ_t^p the
plastic part of the slip, its only history,

    N = min(K_n δ_n, T)                                   no memory: a crack closes where it opened      (1)
    S* = K_t (δ_t − δ_t^p)                                trial                                          (2)
    S = S* min(1, R / |S*|),   R = s + tan φ (T − N)      returned to the cone at constant N             (3)
    δ_t^p ← δ_t − S / K_t                                 so that slip opens nothing: zero dilatancy     (4)

T and s are the point's tensile strength and the shear that it carries at that tension (`PointStrength`). In a
dry joint T = s = 0, and a point that opens carries nothing at all.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array

from .mohr_coulomb import PointStrength


@dataclass(frozen=True, eq=False)
class PointResponse:
    """What joint points answer to a jump.

    Parameters
    ----------
    normal, tangential : (np,) float
        Forces N and S [N], tension positive.
    plastic_slip : (np,) float
        Plastic slip after the jump [m].
    tangent : (np, 2, 2) float
        Derivative of (N, S) by (opening, slip) [N/m]; not symmetric where a point slides under pressure.
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
        """Answer to the jumps ``(np,)`` [m] of points with a given plastic slip ``(np,)`` [m]."""
        from .point_kernel import respond  # limit analysis does without a compiler

        forces, tangent = np.empty((3, len(opening))), np.empty((len(opening), 2, 2))
        strength = self.strength
        of_points = strength.friction, strength.tension, strength.shear, self.normal_stiffness, self.shear_stiffness
        respond(opening, slip, plastic_slip, of_points, forces, tangent)
        normal, tangential, plastic_slip = forces
        return PointResponse(normal, tangential, plastic_slip, tangent)
