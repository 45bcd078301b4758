"""Housner's block, integrated independently: rotation θ about the corner it stands on, impact at θ = 0."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from runningbond.scene import Array

GRAVITY = 9.81


@dataclass(frozen=True)
class HousnerBlock:
    """A block of half width b and half height h [m] under a sine pulse of amplitude A [m/s²] and period T [s]."""

    b: float = 0.25
    h: float = 1.0

    @property
    def alpha(self) -> float:
        return math.atan(self.b / self.h)

    @property
    def p(self) -> float:
        return math.sqrt(3 * GRAVITY / (4 * math.hypot(self.b, self.h)))

    @property
    def restitution(self) -> float:
        """Ratio of the angular velocities after and before an impact (Housner 1963, Eq. 9, with the root)."""
        return 1 - 1.5 * math.sin(self.alpha) ** 2

    def overturns(self, amplitude: float, period: float, cycles: float) -> bool:
        """Whether a pulse with this number of cycles overturns the block."""
        return self.peak(amplitude, period, cycles) == math.inf

    def peak(self, amplitude: float, period: float, cycles: float) -> float:
        """Largest rotation under a pulse of so many cycles [rad]; inf if it overturns."""
        end, largest = cycles * period, 0.0

        def ground(t: float) -> float:
            return amplitude * math.sin(2 * math.pi * t / period) if t < end else 0.0

        lifts = math.tan(self.alpha) * GRAVITY / amplitude
        if lifts > 1:
            return 0.0
        t, rate, sense = math.asin(lifts) * period / (2 * math.pi), 0.0, -1.0
        for _ in range(60):

            def motion(t: float, y: Array, sense: float = sense) -> list[float]:
                lean = self.alpha * sense - y[0]
                return [y[1], -(self.p**2) * (math.sin(lean) + ground(t) / GRAVITY * math.cos(lean))]

            def lands(_: float, y: Array, sense: float = sense) -> float:
                return float(y[0] * sense)

            def lies(_: float, y: Array) -> float:
                return float(abs(y[0]) - math.pi / 2)

            def turns(_: float, y: Array) -> float:
                return float(y[1])

            lands.terminal, lands.direction, lies.terminal = True, -1.0, True  # type: ignore[attr-defined]
            longest = period / 20 if t < end else np.inf
            start = [1e-14 * sense, rate]
            found: Any = solve_ivp(
                motion, (t, end + 12), start, events=(lands, lies, turns), rtol=1e-9, atol=1e-12, max_step=longest
            )
            if len(found.t_events[1]):
                return math.inf
            largest = float(max([largest, *np.abs(found.y[0]), *(abs(y[0]) for y in found.y_events[2])]))
            if not len(found.t_events[0]):
                return largest
            t, rate = float(found.t_events[0][0]), float(found.y_events[0][0][1]) * self.restitution
            sense = float(np.sign(rate))
            if t > end and abs(rate) < 0.05 * self.p * self.alpha:
                return largest
        return largest


def edge(falls: Callable[[float], bool], about: float, width: float = 0.04, tolerance: float = 2e-3) -> float | None:
    """Scale at which a verdict changes, by bisection within a relative width; None if it does not change there."""
    low, high = about * (1 - width), about * (1 + width)
    at_low = falls(low)
    if falls(high) == at_low:
        return None
    while high - low > tolerance * high:
        middle = (low + high) / 2
        low, high = (middle, high) if falls(middle) == at_low else (low, middle)
    return (low + high) / 2
