"""The joint's law on its resultants: the paper's Eq. 3 for normal force, shear and moment of a whole joint.

    f_n ≤ F_t,    |f_t| ≤ s + (F_t − f_n) tan φ,    |m| ≤ (F_t − f_n) l_c

with F_t the joint's tensile strength and s the shear that it carries at that tension (`PointStrength` of its whole
area; the paper has s = 0 because its F_t is the apex of the cone). l_c is how far from the joint's centre the
normal force may act. For forces at the two ends of a joint that is exactly half its length. The paper (Sec. 3)
calls it a distance from the *block's* centre, b/2 for a bed joint of length b/2, hence the whole length of the
joint, which is unsafe: pass ``arm=length`` to get it.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array, Mask

from .mohr_coulomb import PointStrength

DETACHED, SLIDING, ROTATING = range(3)
"""Columns of `ResultantLaw.violated`: the failure modes of Eq. 3."""


@dataclass(frozen=True, eq=False)
class ResultantLaw:
    """Joints that answer elastically to the jump at their centre, and what their actions must respect.

    Parameters
    ----------
    strength
        Strength of the joints' whole areas.
    stiffness : (nj, 3) float
        Normal [N/m], shear [N/m] and rotational stiffness [N m], of a uniform layer of length l k_n A l² / 12.
    arm : (nj,) float
        Largest distance l_c of the normal force from the joint's centre [m].
    """

    strength: PointStrength
    stiffness: Array
    arm: Array

    def excess(self, action: Array) -> Array:
        """By how much actions ``(nj, 3)`` [N, N, N m] exceed Eq. 3, mode by mode ``(nj, 3)`` [N, N, N m].

        Past the tensile strength nothing is left of the two other limits.
        """
        normal, shear, moment = action.T
        pressure = self.strength.tension - normal
        left = np.maximum(pressure, 0.0)
        return np.column_stack(
            [
                -pressure,
                np.abs(shear) - self.strength.shear - self.strength.friction * left,
                np.abs(moment) - self.arm * left,
            ]
        )

    def violated(self, action: Array, tolerance: float = 0.0) -> Mask:
        """Failure modes ``(nj, 3)`` of actions ``(nj, 3)`` that exceed Eq. 3 by more than a force [N]."""
        room = tolerance * np.column_stack([np.ones_like(self.arm), np.ones_like(self.arm), self.arm])
        beyond: Mask = self.excess(action) > room
        return beyond
