"""The law of a wall's joint points, as a compiled kernel over all of them."""

from collections.abc import Sequence

import numpy as np

from runningbond.scene import Indices, JointMaterial

from .point_kernel import KernelLaw, coulomb_constants, coulomb_kernel, stored_uncut
from .softening_kernel import softening_constants, softening_kernel, stored_by_secant


def kernel_law(materials: Sequence[JointMaterial], of_point: Indices) -> KernelLaw:
    """Law of joint points: perfectly plastic, or softening where any material has a fracture energy.

    Parameters
    ----------
    materials
        Materials of the joints; they need a stiffness.
    of_point : (np,) int
        Material of each point. Points of one material in a row are taken together.
    """
    start = np.flatnonzero(np.diff(of_point, prepend=-1))
    segments = np.append(start, len(of_point)).astype(np.uint64)
    softens = any(m.fracture_energy_1 is not None or m.fracture_energy_2 is not None for m in materials)
    constants = np.array([(softening_constants if softens else coulomb_constants)(m) for m in materials])
    of_segment = np.ascontiguousarray(constants[of_point[start]])
    if softens:
        return KernelLaw(softening_kernel, segments, of_segment, 7, stored_by_secant)
    return KernelLaw(coulomb_kernel, segments, of_segment, 5, stored_uncut)
