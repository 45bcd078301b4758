"""The joint's law for resultants: the paper's Eq. 3 for normal force, shear and moment of a whole joint.

    f_n ≤ F_t,    |f_t| ≤ s + (F_t − f_n) tan φ,    |m| ≤ (F_t − f_n) l_c

with the joint's tensile strength F_t and the shear s that it carries at that tension (`PointStrength` of its whole
area; the paper has s = 0 because its F_t is the apex of the cone). l_c is the largest distance of the normal force from
the joint's centre. For forces at the two ends of a joint it is exactly half the joint's length. The paper (Sec. 3)
calls it a distance from the *block's* centre, b/2 for a bed joint of length b/2, hence the whole length of the joint,
which is unsafe: pass ``arm=length`` to obtain it.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array, Mask

from .mohr_coulomb import PointStrength

DETACHED, SLIDING, ROTATING = range(3)
"""Columns of `ResultantLaw.violated`: the failure modes of Eq. 3."""


@dataclass(frozen=True, eq=False)
class ResultantLaw:
    """Joints that respond elastically to the jump at their centre, and the limits of their actions.

    Parameters
    ----------
    strength
        Strength of the joints' whole areas.
    stiffness : (nj, 3) float
        Normal [N/m], shear [N/m] and rotational stiffness [N m]; the latter is k_n A l² / 12 for a uniform layer of
        length l.
    arm : (nj,) float
        Largest distance l_c of the normal force from the joint's centre [m].
    """

    strength: PointStrength
    stiffness: Array
    arm: Array

    def excess(self, action: Array) -> Array:
        """Excess of actions ``(nj, 3)`` [N, N, N m] over Eq. 3, mode by mode ``(nj, 3)`` [N, N, N m].

        Beyond the tensile strength, the limit of the shear is s, and that of the moment zero.
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
        """Failure modes ``(nj, 3)`` of actions ``(nj, 3)`` beyond Eq. 3 by a tolerance [N], of moments times `arm`."""
        room = tolerance * np.column_stack([np.ones_like(self.arm), np.ones_like(self.arm), self.arm])
        beyond: Mask = self.excess(action) > room
        return beyond
