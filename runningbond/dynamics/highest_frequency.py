"""Highest frequency of a system whose joints are all closed, by the Lanczos method.

Bounds computed block by block hold whatever the neighbours do, as if each block moved against its own mirror image. In
a running bond, whose joints do not line up, no motion does that everywhere, and the bounds are a fifth too high. Time
steps may be longer by as much, with unchanged masses, springs and dashpots.
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
"""Most Lanczos steps; the method converges from below to a thousandth, and stagnates at times on the way."""

ROUNDING = 1e-9
"""Length of the next Lanczos vector, relative to the largest ω² so far, below which it is only rounding."""

DIGITS = 6
"""Significant digits kept of the eigenvalue: the last ones differ from machine to machine."""


def with_highest_frequency(system: BlockSystem, viscous: float = VISCOUS) -> BlockSystem:
    """A system at small displacements whose time step follows from its own highest frequency instead of a bound.

    The viscosity of the blocks themselves counts as a stiffness, as it does in the bound (`stable_step`), at the step
    that belongs to the viscous damping ratio of the joints.
    """
    interface, root = system.interface, 1 / np.sqrt(system.mass)  # zero for held modes
    own = system.stiffness + 2 / stable_step(interface.frequency_squared, viscous, LOCAL) * system.viscosity

    def product(motion: Array) -> Array:
        moved = root * motion
        return root * (_closed_joints(system, moved) + own * moved)

    # Random, because a pattern could be orthogonal to a mode of the wall.
    start = np.random.default_rng(0).standard_normal(len(root)) * (root > 0)
    closer = min(interface.frequency_squared, float(f"{_largest_eigenvalue(product, start):.{DIGITS}g}"))
    return replace(system, interface=replace(interface, closer=closer or None))


def _closed_joints(system: BlockSystem, motion: Array) -> Array:
    """Forces ``(nd,)`` that springs in all joints exert against a motion."""
    interface, force = system.interface, np.zeros_like(motion)
    opening, slip = interface.jumps(system.unrestrained(motion))
    law = interface.law
    geometry = tuple(interface.geometry)
    interface.scatter(law.stiffest * opening, law.shear_stiffness * slip, geometry, force)
    return -restrain(force, system.restraint)


def _largest_eigenvalue(product: Callable[[Array], Array], vector: Array) -> float:
    """Largest eigenvalue of a symmetric positive operator, with full reorthogonalisation of the Lanczos vectors."""
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
    """Largest eigenvalue of the tridiagonal matrix of the Lanczos method; the first entry of `beside` is not used."""
    matrix = np.diag(diagonal) + np.diag(beside[1:], 1) + np.diag(beside[1:], -1)
    return float(np.linalg.eigvalsh(matrix).max(initial=0.0))


def _length(vector: Array) -> float:
    return math.sqrt(np.einsum("i,i", vector, vector))
