"""Joint points between the two ends of a joint: jumps between the ends' linearly, tractions handed back to the ends.

Joints that crush or close answer to pressures all along. With shares ξ_p of the way from the first end to the second
and weights w_p that add up to 1, the points of a joint of area A have

    δ_p = (1 − ξ_p) δ_1 + ξ_p δ_2,    A_1 t_1 = A Σ w_p (1 − ξ_p) t_p,    A_2 t_2 = A Σ w_p ξ_p t_p,

and do the work of the ends. A kinematics of ends becomes one of points by `gather_along` and `scatter_along`.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from runningbond.scene import Array, Indices, Unsigned

from .compiled import kernel
from .points import Rule


class Along(NamedTuple):
    """What `gather_along` and `scatter_along` share: the ends' kinematics, and points between ends.

    Point p of joint j is number ``p n + j`` of the m n points of n joints.
    """

    ends: Any  # geometry of the kinematics of the ends
    pairs: Unsigned  # (n, 2) numbers of each joint's two ends; twice the same for an end that is alone
    share: Array  # (m,) way of each point from the first end to the second
    weight: Array  # (m,) part of the joint's area that each point stands for
    scale: Array  # (n, 2) area of the joint in those of its ends
    # (ne,) buffers of the ends' jumps and tractions
    opening: Array
    slip: Array
    normal: Array
    tangential: Array


def along(ends: Any, pairs: Indices, area: Array, rule: Rule) -> tuple[Along, Array]:
    """Lay a rule between pairs ``(n, 2)`` of ends of areas ``(ne,)`` [m²].

    A pair of one end twice is an end alone, and stands for what the first point does: a corner that rolls from a side
    of which it was one end onto another one would be stiffer at once by many times, and thrown off.

    Returns
    -------
    Along
        Geometry of the points; that of the ends is kept as it is.
    (m n,) float
        Area that each point stands for [m²].
    """
    weight, pairs = rule.weights / 2, np.ascontiguousarray(pairs)  # of one layout, for which kernels are compiled
    whole = area[pairs].sum(axis=1) * np.where(pairs[:, 0] == pairs[:, 1], weight[0], 1.0)
    buffers = (np.zeros(len(area)) for _ in range(4))
    scale = whole[:, None] / area[pairs]
    geometry = Along(ends, pairs.astype(np.uint64), (rule.nodes + 1) / 2, weight.copy(), scale, *buffers)
    return geometry, np.outer(weight, whole).ravel()


@kernel
def to_points(ends: Array, pairs: Unsigned, share: Array, points: Array) -> None:
    """Write jumps of points ``(m n,)`` between those of ends ``(ne,)``."""
    n = pairs.shape[0]
    for j in range(n):
        first = ends[pairs[j, 0]]
        change = ends[pairs[j, 1]] - first
        for p in range(share.size):
            points[p * n + j] = first + share[p] * change


@kernel
def to_ends(points: Array, pairs: Unsigned, share: Array, weight: Array, scale: Array, ends: Array) -> None:
    """Write tractions of ends ``(ne,)`` that do the work of those of points ``(m n,)``."""
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
    """The kernel ``gather(motion, geometry, opening, slip)`` of points between ends, from that of the ends."""

    @kernel
    def gather_points(motion: Array, geometry: Any, opening: Array, slip: Array) -> None:
        ends, pairs, share, _, _, opening_of_ends, slip_of_ends, _, _ = geometry
        gather(motion, ends, opening_of_ends, slip_of_ends)
        to_points(opening_of_ends, pairs, share, opening)
        to_points(slip_of_ends, pairs, share, slip)

    return gather_points


@cache
def scatter_along(scatter: Callable[..., Any]) -> Any:
    """The kernel ``scatter(normal, tangential, geometry, force)`` of points between ends, from that of the ends."""

    @kernel
    def scatter_points(normal: Array, tangential: Array, geometry: Any, force: Array) -> None:
        ends, pairs, share, weight, scale, _, _, pull, shear = geometry
        to_ends(normal, pairs, share, weight, scale, pull)
        to_ends(tangential, pairs, share, weight, scale, shear)
        scatter(pull, shear, ends, force)

    return scatter_points
