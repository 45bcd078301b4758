"""Free vibrations of a system whose joints are closed."""

import numpy as np
from scipy.linalg import eigh

from runningbond.scene import Array

from .system import BlockSystem


def elastic_stiffness(system: BlockSystem) -> tuple[Array, Array]:
    """Stiffness of the modes that move, blocks and closed joints together, ``(n, n)`` [N/m], and their masses ``(n,)``.

    Assembled from the jumps that each mode makes, one after another.
    """
    law, moving, one = system.interface.law, np.flatnonzero(np.isfinite(system.mass)), np.eye(len(system.mass))
    jump = np.zeros((len(moving), 2, law.points))
    for row, mode in zip(jump, moving, strict=True):
        row[:] = system.interface.jumps(one[mode])
    springs = system.interface.area * np.stack([law.normal_stiffness, law.shear_stiffness])
    joints = np.einsum("idp,dp,jdp->ij", jump, springs, jump, optimize=True)
    return joints + np.diag(system.stiffness[moving]), system.mass[moving]


def vibrations(system: BlockSystem) -> tuple[Array, Array]:
    """Frequencies ω [1/s] of a system in ascending order, ``(n,)``, and their shapes, mass-normalised ``(nd, n)``."""
    stiffness, mass = elastic_stiffness(system)
    root = 1 / np.sqrt(mass)
    square, vectors = eigh(stiffness * root[:, None] * root)
    shapes = np.zeros((len(system.mass), len(mass)))
    shapes[np.isfinite(system.mass)] = root[:, None] * vectors
    return np.sqrt(np.maximum(square, 0.0)), shapes
