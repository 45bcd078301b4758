"""Stiffness of a system in its modes, and its free vibrations with all joints closed."""

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array, vstack

from runningbond.scene import Array, Mask

from .system import BlockSystem
from .ties import STIFFNESS


def stiffness_matrix(system: BlockSystem, springs: Array, taut: Mask) -> csr_array:
    """Stiffness ``(nd, nd)`` [N/m] of the bodies, of springs at joint points ``(2, np)`` [Pa/m] and of `taut` ties.

    Its jumps are evaluated with the kernels, mode by mode.
    """
    interface, ties, unit, rows = system.interface, system.ties, np.zeros(len(system.mass)), []
    for mode in range(len(unit)):
        unit[mode] = 1.0
        jumps = interface.jumps(system.unrestrained(unit))
        rows.append(csr_array(np.concatenate([*jumps, ties.elongation(unit)])[None]))
        unit[mode] = 0.0
    per_mode = vstack(rows)
    of_ties = np.where(taut, ties.constants[:, STIFFNESS], 0.0)
    weight = diags_array(np.concatenate([(springs * interface.area).ravel(), of_ties]))
    return csr_array(per_mode @ weight @ per_mode.T + diags_array(system.stiffness))


def elastic_stiffness(system: BlockSystem) -> tuple[Array, Array]:
    """Stiffness with all joints closed and no ties, of the moving modes, ``(n, n)`` [N/m]; their masses ``(n,)``."""
    law, moving = system.interface.law, np.flatnonzero(np.isfinite(system.mass))
    springs = np.array([law.normal_stiffness, law.shear_stiffness])
    stiffness = stiffness_matrix(system, springs, np.zeros(len(system.ties), dtype=np.bool_))
    return stiffness[moving][:, moving].toarray(), system.mass[moving]


def vibrations(system: BlockSystem) -> tuple[Array, Array]:
    """Natural frequencies ω [1/s] with that stiffness, ascending, ``(n,)``; mass-normalised mode shapes ``(nd, n)``."""
    stiffness, mass = elastic_stiffness(system)
    root = 1 / np.sqrt(mass)
    square, vectors = eigh(stiffness * root[:, None] * root)
    shapes = np.zeros((len(system.mass), len(mass)))
    shapes[np.isfinite(system.mass)] = root[:, None] * vectors
    return np.sqrt(np.maximum(square, 0.0)), shapes
