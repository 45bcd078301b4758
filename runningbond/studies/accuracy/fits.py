"""What the charts and the conclusions read out of points: Pareto fronts and slopes."""

from collections.abc import Sequence

import numpy as np


def pareto_front(cost: Sequence[float], error: Sequence[float]) -> list[int]:
    """Points that no other point beats in both cost and error, the cheapest first.

    Of points that are equal in both, the first is taken.
    """
    front: list[int] = []
    best = np.inf
    for i in sorted(range(len(cost)), key=lambda i: (cost[i], error[i], i)):
        if error[i] < best:
            front.append(i)
            best = error[i]
    return front


def slope(size: Sequence[float], cost: Sequence[float]) -> float:
    """Exponent p of cost ∝ size^p, by least squares of the logarithms."""
    return float(np.polyfit(np.log(size), np.log(cost), 1)[0])
