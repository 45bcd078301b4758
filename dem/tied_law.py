"""Joint law with ties: bars that carry only tension, and yield.

With e the elongation of a bar, K = E A / L, its preload P, its yield force Y, and its plastic elongation e_p as history
variable,

    F = min(max(P + K (e − e_p), 0), Y),      e_p ← e − (Y − P) / K  if it yields,                            (1)

so that it unloads elastically, and goes slack at a larger elongation once it has yielded.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.joints import PointLaw, PointResponse
from runningbond.scene import Array


@dataclass(frozen=True, eq=False)
class TiedLaw:
    """Law of joint points and, after them, ties: each tie is a point that opens by its elongation and never slips.

    Parameters
    ----------
    joints
        Law of the joint points.
    stiffness, yield_force, preload : (nt,) float
        K, Y and P of the ties.
    """

    joints: PointLaw
    stiffness: Array
    yield_force: Array
    preload: Array

    @property
    def normal_stiffness(self) -> Array:
        """K_n and K, ``(np + nt,)``."""
        return np.append(self.joints.normal_stiffness, self.stiffness)

    @property
    def shear_stiffness(self) -> Array:
        """K_t, and zero for ties, ``(np + nt,)``."""
        return np.append(self.joints.shear_stiffness, np.zeros(len(self.stiffness)))

    def __call__(self, opening: Array, slip: Array, plastic: Array) -> PointResponse:
        """Response to the jumps of points and elongations of ties ``(np + nt,)``, for a given history."""
        n = len(self.joints.normal_stiffness)
        joints = self.joints(opening[:n], slip[:n], plastic[:n])
        trial = self.preload + self.stiffness * (opening[n:] - plastic[n:])
        yields = trial > self.yield_force
        longer = opening[n:] - (self.yield_force - self.preload) / self.stiffness
        tangent = np.zeros((len(trial), 2, 2))
        tangent[:, 0, 0] = np.where((trial >= 0) & ~yields, self.stiffness, 0.0)
        return PointResponse(
            np.append(joints.normal, trial.clip(0.0, self.yield_force)),
            np.append(joints.tangential, np.zeros(len(trial))),
            np.append(joints.plastic_slip, np.where(yields, longer, plastic[n:])),
            np.concatenate([joints.tangent, tangent]),
        )
