"""Masses of soft blocks between stiffer joints, whose own masses no scaling makes fit for a long step.

A wall of soft blocks vibrates slowly, but two of its blocks on their joint as fast as rigid ones do: a period takes
ten times as many steps as that of rigid blocks, and more (`benchmarks/studies/stiff_blocks.py`). Heavier deformations
do not help, for it is the rigid motions r that limit the step, and heavier blocks would slow the wall as well. So they
are given inertia across their joints, which moves only with the jumps between blocks: central differences are stable
at ω if

    K ≤ ω² M*,   M* = diag(m_r) + (1 + a) K_rr / ω²  ⊕  diag(m_d + β (k_b + (1 + 1/a) s) / ω²),

whatever ω is, with K_rr the joints' largest stiffness in the rigid motions, k_b the blocks' in their deformations d and
s the joints' in these, summed to a diagonal that is no smaller. For jumps are sums of both parts, and for any a > 0
(u_r + u_d)² ≤ (1 + a) u_r² + (1 + 1/a) u_d². What is at rest knows no masses (`olovsson2005`).
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array, diags_array

from runningbond.dynamics import BlockSystem, stable_step
from runningbond.dynamics.run import CALMING, VISCOUS
from runningbond.dynamics.system import Coupling
from runningbond.scene import Array

from .frequency_shift import GROUND, lowest_frequencies, modal_stiffness
from .mass_scaling import modal_viscosity, undeformed_frequency_squared
from .modal_wall import ModalWall
from .system import DAMPING

MORE = 2.0
"""How many times as many steps as of rigid blocks a period takes where masses are coupled."""

STEPS = 200
"""Most steps of the lowest period that masses are coupled for; as many as of rigid blocks where those are fewer."""

LARGEST = 60
"""Number of blocks beyond which they are not coupled: forces on all make accelerations of all, at a cost that grows
with its square. On panel-04, 73 blocks of 10 GPa, that is more than the longer steps save."""

RIGID = 2.0
"""What the joints' energy is shared with, a above: deformations that follow their neighbours weigh more in a period."""

ROOM = 1.452
"""β above, which leaves room for the viscosity of the deformations, as for masses that are scaled one by one."""


def with_coupled_masses(wall: ModalWall, system: BlockSystem) -> BlockSystem:
    """Give soft blocks inertia across their joints; a system whose blocks are stiff, or too many, is given back.

    So is one on which more acts than loads: ties, a beam that leads it, supports that move.

    Parameters
    ----------
    wall
        The wall.
    system
        Its blocks, with modes as `mass_scaling` has them.
    """
    scene, moving = wall.scene, np.isfinite(wall.mass)
    more = scene.is_led or len(system.ties) or len(system.late)
    rigid = (wall.stiffness == 0)[moving]
    if more or (~scene.fixed).sum() > LARGEST or rigid.all() or not rigid.any():
        return system
    stiffness, mass = modal_stiffness(wall, closed=True), wall.mass[moving]
    of_rigid, square = undeformed_frequency_squared(wall), system.interface.frequency_squared
    slow, slow_rigid = _lowest(stiffness, mass, square), _lowest(stiffness[rigid][:, rigid], mass[rigid], square)
    # Steps of a period, squared, but for a factor that is the same for both.
    steps, steps_rigid = square / slow, of_rigid / slow_rigid
    if steps <= MORE**2 * steps_rigid:
        return system
    one = (2 * np.pi / stable_step(1.0, VISCOUS, CALMING)) ** 2  # of ω = 1
    target = slow * min(steps_rigid, STEPS**2 / one)
    return _coupled(wall, system, stiffness.toarray(), target)


def _coupled(wall: ModalWall, system: BlockSystem, K: Array, square: float) -> BlockSystem:
    """The system with masses that an ω² bounds [1/s²], of the stiffness of what moves ``(n, n)`` [N/m]."""
    moving = np.flatnonzero(np.isfinite(wall.mass))
    own = wall.stiffness[moving]
    rigid = own == 0
    deformed = ~rigid
    joints = (K - np.diag(own))[np.ix_(deformed, deformed)]
    # |d_i d_j| ≤ (w_i d_i² / w_j + w_j d_j² / w_i) / 2, with weights that make each term count the same.
    weight = np.sqrt(np.maximum(np.diag(joints), np.diag(joints).max() * GROUND))
    summed = weight * (np.abs(joints) @ (1 / weight))
    mass = system.mass.copy()
    mass[moving] = wall.mass[moving]
    mass[moving[deformed]] += ROOM * (own[deformed] + (1 + 1 / RIGID) * summed) / square
    viscosity = modal_viscosity(wall.stiffness, mass, DAMPING)
    coupling = Coupling(moving[rigid], (1 + RIGID) * K[np.ix_(rigid, rigid)] / square)
    # The bound that the largest eigenvalue is: at its own step, which is longer, viscosity is less.
    M = np.diag(mass[moving])
    M[np.ix_(rigid, rigid)] += coupling.inertia
    damped = K + np.diag(2 / stable_step(square, VISCOUS, CALMING) * viscosity[moving])
    last = len(moving) - 1
    highest = float(eigh(damped, M, eigvals_only=True, subset_by_index=(last, last))[0])
    interface = replace(system.interface, frequency_squared=highest)
    return replace(system, mass=mass, viscosity=viscosity, interface=interface, coupling=coupling)


def _lowest(stiffness: csr_array, mass: Array, highest: float) -> float:
    """Smallest ω² [1/s²] of what has a stiffness and masses; what floats is held as in `frequency_shift`."""
    return float(lowest_frequencies(csc_array(stiffness + diags_array(GROUND * highest * mass)), 1)(mass)[0])
