"""Two stacked rigid blocks that rock and do not slide, by Lagrange's equations, independent of the suite.

The patterns are those of Psycharis (1990): the upper block alone, both as one body, both in the same sense, or in
opposite senses. The initial pattern follows from contacts that can open and press but not pull.

θ1 and θ2 are the blocks' rotations, counter-clockwise; each block stands on one corner or on both. With the pivots at
s1 and s2 on the two bases, c1 = (−s1, h1), d = (s2 − s1, 2 h1), c2 = (−s2, h2) rotated by θ,

    r1 = (s1, 0) + R(θ1) c1,    r2 = (s1, 0) + R(θ1) d + R(θ2) c2,    Σ m (r̈ − f) · ∂r/∂θ + I θ̈ = 0

in the field f = (−a, −g) of a frame that moves with the ground's acceleration a.
"""

import math
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from runningbond.scene import Array

from .housner import GRAVITY


class Pattern(NamedTuple):
    """Corners on which the lower block, and the upper block on it, stand: −1 left, 1 right, 0 both."""

    lower: int
    upper: int


REST, UPPER_ALONE, ONE_BODY = Pattern(0, 0), Pattern(0, -1), Pattern(-1, 0)
BOTH_AND_UPPER_MORE, UPPER_LAGS = Pattern(-1, -1), Pattern(-1, 1)


def turned(vector: Array, angle: float = math.pi / 2) -> Array:
    x, y = vector
    return np.array([x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)])


def cross(left: Array, right: Array) -> float:
    return float(left[0] * right[1] - left[1] * right[0])


@dataclass(frozen=True)
class TwoBlocks:
    """Half widths b and half heights h [m] of the lower and the upper block, of equal density, on one axis."""

    b: tuple[float, float]
    h: tuple[float, float]

    @property
    def mass(self) -> Array:
        """Masses per density and thickness."""
        return np.asarray(4 * np.array(self.b) * np.array(self.h))

    @property
    def inertia(self) -> Array:
        return np.asarray(self.mass * (np.square(self.b) + np.square(self.h)) / 3)

    def accelerations(self, pattern: Pattern, ground: float, angle: Array, rate: Array) -> Array:
        """θ̈1, θ̈2 [rad/s²] in a pattern."""
        m1, m2 = self.mass
        s1, s2 = pattern.lower * self.b[0], pattern.upper * self.b[1]
        field = np.array([-ground, -GRAVITY])
        c1, d, c2 = self._arms(s1, s2, angle)
        matrix = np.diag(self.inertia) + np.array(
            [[m1 * c1 @ c1 + m2 * d @ d, m2 * d @ c2], [m2 * d @ c2, m2 * c2 @ c2]]
        )
        spin = m2 * turned(d) @ c2
        load = np.array([field @ turned(m1 * c1 + m2 * d), m2 * field @ turned(c2)])
        load += spin * np.array([rate[1] ** 2, -(rate[0] ** 2)])
        free = np.array([[pattern.lower != 0, False], [pattern.lower != 0 and pattern.upper == 0, pattern.upper != 0]])
        modes = free[:, free.any(axis=0)].astype(float)
        return np.asarray(modes @ np.linalg.solve(modes.T @ matrix @ modes, modes.T @ load))

    def _arms(self, s1: float, s2: float, angle: Array) -> tuple[Array, Array, Array]:
        (lower, upper), (h1, h2) = angle, self.h
        c1, d = turned(np.array([-s1, h1]), lower), turned(np.array([s2 - s1, 2 * h1]), lower)
        return c1, d, turned(np.array([-s2, h2]), upper)

    def starts(self, ground: float) -> list[Pattern]:
        """Patterns in which a pair at rest can start: joints open with the rotations, with pressure within them."""
        return [each for each in map(Pattern._make, product((-1, 0, 1), repeat=2)) if self._admissible(each, ground)]

    def _admissible(self, pattern: Pattern, ground: float) -> bool:
        still = np.zeros(2)
        alpha, mass, inertia = self.accelerations(pattern, ground, still, still), self.mass, self.inertia
        if pattern.lower * alpha[0] > 0 or pattern.upper * (alpha[1] - alpha[0]) > 0:
            return False
        c1, d, c2 = self._arms(pattern.lower * self.b[0], pattern.upper * self.b[1], still)
        weight = np.array([ground, GRAVITY])
        between = mass[1] * (alpha[0] * turned(d) + alpha[1] * turned(c2) + weight)
        under = mass[0] * (alpha[0] * turned(c1) + weight) + between
        # Positions of the resultants in the joints, from the moment about each centroid.
        upper = (inertia[1] * alpha[1] - self.h[1] * between[0]) / between[1]
        on_lower = inertia[0] * alpha[0] + cross(np.array([upper, self.h[0]]), between)
        lower = (on_lower - self.h[0] * under[0]) / under[1]
        inside = np.abs([lower, upper]) <= np.array(self.b) * (1 + 1e-9)
        return bool(inside.all() and between[1] > 0 and under[1] > 0)

    def rotations(self, pattern: Pattern, ground: float, time: Array) -> Array:
        """θ1 and θ2 ``(2, n)`` at times since the ground began to move from rest, in one pattern throughout."""

        def motion(_: float, y: Array) -> Array:
            return np.concatenate([y[2:], self.accelerations(pattern, ground, y[:2], y[2:])])

        found: Any = solve_ivp(motion, (0.0, time[-1]), np.zeros(4), t_eval=time, rtol=1e-10, atol=1e-13)
        return np.asarray(found.y[:2])
