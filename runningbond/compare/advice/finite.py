"""The largest load of a wall at finite displacements, for walls that sway before they fall."""

import time
from typing import Literal, TypeAlias

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Array, Scene

Finite: TypeAlias = Literal["dem-dynamic, finite", "fem, finite"]
FINITE: dict[str, Finite] = {"dem-dynamic, finite": "dem-dynamic, finite", "fem, finite": "fem, finite"}
"""Models that follow blocks at finite displacements, by name."""

SPEED = 0.02
"""Speed of the first push, in block sizes a second."""

FARTHER = 3.0
"""Way to push, in times that to the collapse at small displacements."""

SLOWINGS = 3
"""How often the speed is halved until the peak settles."""

SMOOTH = 9
"""Rows of the curve over which λ is averaged."""


def finite_peak(scene: Scene, model: Finite, tolerance: float, way: float, bound: float | None) -> Outcome:
    """Peak of the pushover curve at finite displacements, pushed ever slower until it settles.

    Parameters
    ----------
    scene
        The scene.
    model
        Rigid or deformable blocks.
    tolerance
        Relative change of the peak at half the speed with which it counts as settled.
    way
        How far the wall sways before it falls, in block sizes.
    bound
        Load above which nothing stands at small displacements. A peak far above it is one of inertia.

    Returns
    -------
    Outcome
        The bracket is of the peaks at the last two speeds.
    """
    start = time.perf_counter()
    distance, speed = FARTHER * way * scene.block_size, SPEED * scene.block_size
    curve = _push(scene, model, distance, speed)
    outcome = Outcome(scene.title, model, "undecided", message="the peak did not settle as the push was slowed")
    for _ in range(SLOWINGS):
        fast, speed = _peak(curve), speed / 2
        curve = _push(scene, model, distance, speed)
        low, high = sorted((fast, _peak(curve)))
        if high - low <= tolerance * high and (bound is None or low <= (1 + tolerance) * bound):
            message = "peaks of two pushes at finite displacements, one at half the speed of the other"
            outcome = Outcome(scene.title, model, "collapse", low, low, high, message=message, curve=curve[:, [0, 2]])
            break
    return Outcome(**{**vars(outcome), "seconds": time.perf_counter() - start})


def _push(scene: Scene, model: Finite, distance: float, speed: float) -> Array:
    if model == "fem, finite":
        from fem_interface.finite_pushover import fem_pushover

        return fem_pushover(scene, distance, speed=speed)
    from dem.dynamic import finite_pushover

    return finite_pushover(scene, distance, speed=speed)


def _peak(curve: Array) -> float:
    return float(np.convolve(curve[:, 2], np.ones(SMOOTH) / SMOOTH, "valid").max())
