"""Inertia coupled across joints for soft blocks between stiffer joints, where mass scaling does not allow long steps.

A wall of soft blocks vibrates slowly, but two of its blocks on their joint vibrate as fast as rigid ones: a period
takes ten or more times as many steps as with rigid blocks (`benchmarks/studies/stiff_blocks.py`). Heavier deformable
modes do not help, because the rigid motions r limit the step, and heavier blocks would slow the whole wall. Instead the
blocks are given inertia across their joints, which acts only on jumps between blocks. Central differences are stable
at ω if

    K ≤ ω² M*,   M* = diag(m_r) + (1 + a) K_rr / ω²  ⊕  diag(m_d + β (k_b + (1 + 1/a) s) / ω²),

for any ω. K_rr is the joints' largest stiffness in the rigid motions, k_b the blocks' stiffness in their deformations
d, and s a diagonal upper bound of the joints' stiffness in d. The reason is that jumps are sums of both parts, and
(u_r + u_d)² ≤ (1 + a) u_r² + (1 + 1/a) u_d² for any a > 0. Static equilibrium does not depend on the masses
(`olovsson2005`).
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array, diags_array

from runningbond.dynamics import BlockSystem, stable_step
from runningbond.dynamics.run import CALMING, VISCOUS
from runningbond.dynamics.system import Coupling
from runningbond.scene import Array

from .frequency_shift import GROUND_STIFFNESS, lowest_frequencies, modal_stiffness
from .mass_scaling import modal_viscosity, undeformed_frequency_squared
from .modal_wall import ModalWall
from .system import DAMPING

STEP_RATIO = 2.0
"""Masses are coupled if the lowest period takes more than this many times the steps it takes with rigid blocks."""

MOST_STEPS = 200
"""Number of steps per lowest period that coupling aims at, or the number with rigid blocks if that is smaller."""

MOST_BLOCKS = 60
"""Number of movable blocks above which masses are not coupled: each force accelerates all blocks, at a cost that grows
with the square of their number. On panel-04, 73 blocks of 10 GPa, this costs more than the longer steps save."""

ENERGY_SPLIT = 2.0
"""The number a above; larger than one because mass on deformations also slows neighbours that deform alike."""

MASS_FACTOR = 1.452
"""The factor β above; its excess over one allows for the viscosity of the deformations, as in `mass_scaling`."""


def with_coupled_masses(wall: ModalWall, system: BlockSystem) -> BlockSystem:
    """Give soft blocks inertia across their joints.

    The system is returned unchanged if its blocks are stiff or too many, if it has no joints, or if anything but loads
    acts on it: ties, supports that move, a beam that drives the wall or is held at its height.

    Parameters
    ----------
    wall
        The wall.
    system
        The wall's blocks, with the modal masses of `mass_scaling`.
    """
    scene, moving = wall.scene, np.isfinite(wall.mass)
    more = scene.is_led or len(system.ties) or len(system.late) or not len(scene.joints)
    rigid = (wall.stiffness == 0)[moving]
    if more or (~scene.fixed).sum() > MOST_BLOCKS or rigid.all() or not rigid.any():
        return system
    stiffness, mass = modal_stiffness(wall, closed=True), wall.mass[moving]
    of_rigid, square = undeformed_frequency_squared(wall), system.interface.frequency_squared
    slow, slow_rigid = _lowest(stiffness, mass, square), _lowest(stiffness[rigid][:, rigid], mass[rigid], square)
    # Steps per period, squared, up to a factor that both have in common.
    steps, steps_rigid = square / slow, of_rigid / slow_rigid
    if steps <= STEP_RATIO**2 * steps_rigid:
        return system
    one = (2 * np.pi / stable_step(1.0, VISCOUS, CALMING)) ** 2  # steps per period, squared, if all ω are equal
    target = slow * min(steps_rigid, MOST_STEPS**2 / one)
    return _coupled(wall, system, stiffness.toarray(), target)


def _coupled(wall: ModalWall, system: BlockSystem, K: Array, square: float) -> BlockSystem:
    """The system with masses that make ω² [1/s²] a bound, given the moving modes' stiffness ``(n, n)`` [N/m]."""
    moving = np.flatnonzero(np.isfinite(wall.mass))
    own = wall.stiffness[moving]
    rigid = own == 0
    deformed = ~rigid
    joints = (K - np.diag(own))[np.ix_(deformed, deformed)]
    # |d_i d_j| ≤ (w_i d_i² / w_j + w_j d_j² / w_i) / 2, with weights that balance the terms.
    weight = np.sqrt(np.maximum(np.diag(joints), np.diag(joints).max() * GROUND_STIFFNESS))
    summed = weight * (np.abs(joints) @ (1 / weight))
    mass = system.mass.copy()
    mass[moving] = wall.mass[moving]
    mass[moving[deformed]] += MASS_FACTOR * (own[deformed] + (1 + 1 / ENERGY_SPLIT) * summed) / square
    viscosity = modal_viscosity(wall.stiffness, mass, DAMPING)
    coupling = Coupling(moving[rigid], (1 + ENERGY_SPLIT) * K[np.ix_(rigid, rigid)] / square)
    # The largest eigenvalue is itself a bound, because viscosity counts less at its own, longer step.
    M = np.diag(mass[moving])
    M[np.ix_(rigid, rigid)] += coupling.inertia
    damped = K + np.diag(2 / stable_step(square, VISCOUS, CALMING) * viscosity[moving])
    last = len(moving) - 1
    highest = float(eigh(damped, M, eigvals_only=True, subset_by_index=(last, last))[0])
    interface = replace(system.interface, frequency_squared=highest)
    return replace(system, mass=mass, viscosity=viscosity, interface=interface, coupling=coupling)


def _lowest(stiffness: csr_array, mass: Array, highest: float) -> float:
    """Smallest ω² [1/s²] of a stiffness and masses, with weak springs to the ground as in `frequency_shift`."""
    return float(lowest_frequencies(csc_array(stiffness + diags_array(GROUND_STIFFNESS * highest * mass)), 1)(mass)[0])
