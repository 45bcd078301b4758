"""The largest load of a wall at finite displacements, for walls that move far before they collapse."""

import time
from dataclasses import replace

import numpy as np

from runningbond.compare.model import Model
from runningbond.results import Outcome
from runningbond.scene import Array, Scene

SPEED = 0.02
"""Speed of the first push, in block sizes a second."""

FARTHER = 3.0
"""Displacement up to which to push, relative to that of the collapse at small displacements."""

HALVINGS = 3
"""How often the speed is halved until the peak settles."""

SMOOTH = 9
"""Rows of the curve over which λ is averaged."""


def finite_peak(scene: Scene, model: Model, tolerance: float, displacement: float, bound: float | None) -> Outcome:
    """Peak of the pushover curve at finite displacements, pushed ever slower until it settles.

    Parameters
    ----------
    scene
        The scene.
    model
        A model that has a `pushover`.
    tolerance
        Relative change of the peak at half the speed with which it counts as settled.
    displacement
        How far the wall moves before it collapses at small displacements, in block sizes.
    bound
        Load above which nothing stands at small displacements. A peak far above it is one of inertia.

    Returns
    -------
    Outcome
        The bracket is of the peaks at the last two speeds.
    """
    assert model.pushover is not None
    start = time.perf_counter()
    distance, speed = FARTHER * displacement * scene.block_size, SPEED * scene.block_size
    curve = model.pushover(scene, distance, speed=speed)
    message = "the peak did not settle as the push was slowed"
    outcome = Outcome(scene.title, finite_name(model), "undecided", message=message)
    for _ in range(HALVINGS):
        fast, speed = _peak(curve), speed / 2
        curve = model.pushover(scene, distance, speed=speed)
        low, high = sorted((fast, _peak(curve)))
        if high - low <= tolerance * high and (bound is None or low <= (1 + tolerance) * bound):
            message = "peaks of two pushes at finite displacements, one at half the speed of the other"
            outcome = replace(outcome, status="collapse", multiplier=low, lower=low, upper=high, message=message)
            outcome = replace(outcome, curve=curve[:, [0, 2]])
            break
    return replace(outcome, seconds=time.perf_counter() - start)


def finite_name(model: Model) -> str:
    """What a model is called where it follows blocks at finite displacements."""
    return f"{model.name}, finite"


def _peak(curve: Array) -> float:
    return float(np.convolve(curve[:, 2], np.ones(SMOOTH) / SMOOTH, "valid").max())
