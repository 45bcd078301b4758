"""Elastic closure of joints: the normal stiffness grows with the pressure.

    dp/dc = k_n + g p  up to k_∞,    p = (k_n / g) (exp(g c) − 1),    stored (p − k_n c) / g

with c the closure (Evans, Kohl, Hopkirk & Rybach 1992; the hyperbola of Bandis, Lumsden & Barton 1983 fits the same
tests). Above p* = (k_∞ − k_n) / g, reached at c* = ln(k_∞ / k_n) / g, the stiffness is constant at k_∞.
"""

import math
from typing import TypeAlias

import numpy as np

from runningbond.scene import JointMaterial

from .compiled import kernel
from .stiffness import joint_stiffness, stiffest

Curve: TypeAlias = tuple[float, float, float, float, float]
"""k_n [Pa/m], g [1/m], p* [Pa], c* [m] and k_∞ [Pa/m]; p* = c* = 0, and any g, for a joint of constant stiffness."""


def closure_curve(material: JointMaterial) -> Curve:
    """Closure curve of a material."""
    first, last = joint_stiffness(material).normal, stiffest(material)
    growth = 1.0 if material.closure is None else material.closure.growth
    return first, growth, (last - first) / growth, math.log(last / first) / growth, last


@kernel
def pressure_at(closure: float, curve: Curve) -> float:
    """Pressure [Pa] on a joint closed by a distance [m], not negative."""
    k_n, growth, last, end, largest = curve
    if closure >= end:
        return last + largest * (closure - end)
    return k_n / growth * math.expm1(growth * closure)


@kernel
def closure_at(pressure: float, curve: Curve) -> float:
    """Closure [m] under a pressure [Pa], not negative."""
    k_n, growth, last, _, largest = curve
    below = np.minimum(pressure, last)
    closure: float = np.log1p(growth / k_n * below) / growth + (pressure - below) / largest
    return closure


@kernel
def stored_at(pressure: float, curve: Curve) -> float:
    """Recoverable energy [J/m²] of a joint under a pressure [Pa], not negative."""
    k_n, growth, last, _, largest = curve
    below = np.minimum(pressure, last)
    beyond = pressure - below
    curved = (below - k_n * np.log1p(growth / k_n * below) / growth) / growth
    stored: float = curved + beyond * (last + 0.5 * beyond) / largest
    return stored


@kernel
def stiffness_at(pressure: float, curve: Curve) -> float:
    """Tangent stiffness [Pa/m] of a joint under a pressure [Pa]."""
    k_n, growth, _, _, largest = curve
    stiffness: float = np.minimum(k_n + growth * pressure, largest)
    return stiffness
