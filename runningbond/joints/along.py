"""Joint points between the two ends of a joint: jumps are interpolated linearly, tractions are lumped at the ends.

Joints that crush or close respond to pressures along their length. With shares ξ_p of the way from the first end to the
second and weights w_p that add up to 1, the points of a joint of area A have

    δ_p = (1 − ξ_p) δ_1 + ξ_p δ_2,    A_1 t_1 = A Σ w_p (1 − ξ_p) t_p,    A_2 t_2 = A Σ w_p ξ_p t_p,

so that points and ends do the same work. `gather_along` and `scatter_along` extend a kinematics of ends to points.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from runningbond.scene import Array, Indices, Unsigned

from .compiled import kernel
from .points import Rule


class Along(NamedTuple):
    """Geometry for `gather_along` and `scatter_along`: the kinematics of ends, and points between ends.

    Point p of joint j is number ``p n + j`` of the m n points of n joints.
    """

    ends: Any  # geometry of the kinematics of the ends
    pairs: Unsigned  # (n, 2) numbers of each joint's two ends; the same number twice for a single end
    share: Array  # (m,) position of each point, from 0 at the first end to 1 at the second
    weight: Array  # (m,) part of the joint's area that belongs to each point
    scale: Array  # (n, 2) area of the joint divided by the areas of its ends
    # (ne,) buffers of the ends' jumps and tractions
    opening: Array
    slip: Array
    normal: Array
    tangential: Array


def along(ends: Any, pairs: Indices, area: Array, rule: Rule) -> tuple[Along, Array]:
    """Place the points of a rule between pairs ``(n, 2)`` of ends of areas ``(ne,)`` [m²].

    A pair of equal numbers is a single end, with only the area of the first point: otherwise a corner that rolls from
    one side, where it was one of two ends, onto another would suddenly be many times stiffer, and be thrown off.

    Returns
    -------
    Along
        Geometry of the points, which includes that of the ends unchanged.
    (m n,) float
        Area of each point [m²].
    """
    weight, pairs = rule.weights / 2, np.ascontiguousarray(pairs)  # the memory layout that kernels are compiled for
    whole = area[pairs].sum(axis=1) * np.where(pairs[:, 0] == pairs[:, 1], weight[0], 1.0)
    buffers = (np.zeros(len(area)) for _ in range(4))
    scale = whole[:, None] / area[pairs]
    geometry = Along(ends, pairs.astype(np.uint64), (rule.nodes + 1) / 2, weight.copy(), scale, *buffers)
    return geometry, np.outer(weight, whole).ravel()


@kernel
def to_points(ends: Array, pairs: Unsigned, share: Array, points: Array) -> None:
    """Write jumps of points ``(m n,)``, interpolated between those of ends ``(ne,)``."""
    n = pairs.shape[0]
    for j in range(n):
        first = ends[pairs[j, 0]]
        change = ends[pairs[j, 1]] - first
        for p in range(share.size):
            points[p * n + j] = first + share[p] * change


@kernel
def to_ends(points: Array, pairs: Unsigned, share: Array, weight: Array, scale: Array, ends: Array) -> None:
    """Write tractions of ends ``(ne,)`` that do the same work as those of points ``(m n,)``."""
    n = pairs.shape[0]
    ends[:] = 0.0
    for j in range(n):
        whole, second = 0.0, 0.0
        for p in range(share.size):
            traction = weight[p] * points[p * n + j]
            whole += traction
            second += share[p] * traction
        ends[pairs[j, 0]] += scale[j, 0] * (whole - second)
        ends[pairs[j, 1]] += scale[j, 1] * second


@cache
def gather_along(gather: Callable[..., Any]) -> Any:
    """Return the kernel ``gather(motion, geometry, opening, slip)`` of points between ends, given that of the ends."""

    @kernel
    def gather_points(motion: Array, geometry: Any, opening: Array, slip: Array) -> None:
        ends, pairs, share, _, _, opening_of_ends, slip_of_ends, _, _ = geometry
        gather(motion, ends, opening_of_ends, slip_of_ends)
        to_points(opening_of_ends, pairs, share, opening)
        to_points(slip_of_ends, pairs, share, slip)

    return gather_points


@cache
def scatter_along(scatter: Callable[..., Any]) -> Any:
    """Return the kernel ``scatter(normal, tangential, geometry, force)`` of points between ends, given that of ends."""

    @kernel
    def scatter_points(normal: Array, tangential: Array, geometry: Any, force: Array) -> None:
        ends, pairs, share, weight, scale, _, _, pull, shear = geometry
        to_ends(normal, pairs, share, weight, scale, pull)
        to_ends(tangential, pairs, share, weight, scale, shear)
        scatter(pull, shear, ends, force)

    return scatter_points
