"""The highest frequency of a system whose joints are all closed, by Lanczos' method.

Bounds from each block alone hold whatever its neighbours do, as if each moved against its own shadow in a mirror; of a
running bond, whose joints do not line up, no motion does that everywhere, and they are a fifth too high. Steps may be
as much longer, with masses, springs and dashpots as they are.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from runningbond.scene import Array

from .run import LOCAL, VISCOUS
from .system import BlockSystem, restrain
from .time_step import stable_step

STEPS = 60
"""Most steps of Lanczos' method, which comes from below to a thousandth and has places where it hardly moves."""

ROUNDING = 1e-9
"""Part of the largest frequency squared below which what is left of a motion is rounding."""

DIGITS = 6
"""Digits that are kept of it: the last ones of a library's eigenvalues differ from machine to machine."""


def with_highest_frequency(system: BlockSystem, viscous: float = VISCOUS) -> BlockSystem:
    """Blocks at small displacements whose time steps go by their own highest frequency, in place of a bound.

    The viscosity of the blocks themselves counts as a stiffness, as it does for the bound (`stable_step`), at the step
    that goes with the joints' viscous damping ratio.
    """
    interface, root = system.interface, 1 / np.sqrt(system.mass)  # nothing for what is held
    own = system.stiffness + 2 / stable_step(interface.frequency_squared, viscous, LOCAL) * system.viscosity

    def product(motion: Array) -> Array:
        moved = root * motion
        return root * (_closed_joints(system, moved) + own * moved)

    # Without a pattern that a mode of the wall could be at right angles to.
    start = np.random.default_rng(0).standard_normal(len(root)) * (root > 0)
    closer = min(interface.frequency_squared, float(f"{_largest_eigenvalue(product, start):.{DIGITS}g}"))
    return replace(system, interface=replace(interface, closer=closer or None))


def _closed_joints(system: BlockSystem, motion: Array) -> Array:
    """Forces ``(nd,)`` against a motion, of springs in all joints."""
    interface, force = system.interface, np.zeros_like(motion)
    opening, slip = interface.jumps(system.unrestrained(motion))
    law = interface.law
    geometry = tuple(interface.geometry)
    interface.scatter(law.stiffest * opening, law.shear_stiffness * slip, geometry, force)
    return -restrain(force, system.restraint)


def _largest_eigenvalue(product: Callable[[Array], Array], vector: Array) -> float:
    """Of a symmetric positive operator on vectors; each that is found is kept at right angles to all before."""
    basis: list[Array] = []
    diagonal: list[float] = []
    beside: list[float] = []
    length = _length(vector)
    while len(basis) < STEPS and length > ROUNDING * max(diagonal, default=0.0):
        beside.append(length)
        basis.append(vector / length)
        vector = product(basis[-1])
        diagonal.append(float(np.einsum("i,i", basis[-1], vector)))
        for one in basis:
            vector = vector - np.einsum("i,i", one, vector) * one
        length = _length(vector)
    return largest_of_tridiagonal(np.array(diagonal), np.array(beside))


def largest_of_tridiagonal(diagonal: Array, beside: Array) -> float:
    """Largest eigenvalue of a symmetric matrix that Lanczos' method leaves; the first entry beside is of no use."""
    matrix = np.diag(diagonal) + np.diag(beside[1:], 1) + np.diag(beside[1:], -1)
    return float(np.linalg.eigvalsh(matrix).max(initial=0.0))


def _length(vector: Array) -> float:
    return math.sqrt(np.einsum("i,i", vector, vector))
