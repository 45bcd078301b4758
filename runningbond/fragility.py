"""Fragility: how likely a wall is brought down by motions of the ground of some intensity, over a set of records."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr

from .compare.model import Model
from .compare.models import TOLERANCE
from .scene import Array, SceneError
from .scene.history import STANDARD_GRAVITY
from .sweeps import sweep
from .tables import Table
from .wall import Wall


@dataclass(frozen=True, eq=False)
class Fragility:
    """Log-normal fragility of a wall.

    Parameters
    ----------
    intensity : (n,) float
        Peak acceleration of the ground at which each record brings the wall down, ascending [g].
    median, dispersion
        Of the log-normal distribution that fits them: exp of the mean, and standard deviation, of their logarithms.
    interval
        Of the median, at 90 %, from records drawn again and again with a seed.
    runs
        A row a record: its bracket of λ, and what became of it.
    left_out
        Records without an answer.
    """

    intensity: Array
    median: float
    dispersion: float
    interval: tuple[float, float]
    runs: Table
    left_out: int

    def probability(self, intensity: Array | float) -> Array:
        """Probability of a collapse at intensities [g]."""
        return np.asarray(ndtr(np.log(np.asarray(intensity) / self.median) / max(self.dispersion, 1e-12)))


def fragility(
    wall: Wall,
    records: Iterable[str | Path],
    model: str | Model,
    *,
    tolerance: float = TOLERANCE,
    folder: str | Path | None = None,
    jobs: int = -1,
    seed: int = 0,
    draws: int = 1000,
) -> Fragility:
    """Find the critical scale of every record, and the fragility that follows.

    Parameters
    ----------
    wall
        The wall, with a ``load.history`` whose file is replaced by each record's in turn.
    records
        Files.
    model, tolerance, folder, jobs
        As of `sweep`: with a folder, only records that are not there are computed.
    seed, draws
        Of the interval of the median.

    Raises
    ------
    SceneError
        Where the wall has no record, or fewer than two records bring it down.
    """
    if wall.scene.history is None or "file" not in wall.description["load"]["history"]:
        raise SceneError("load.history.file", "is missing: the record that others are to take the place of")
    names = [str(record) for record in records]
    runs = sweep(wall, {"load.history.file": names}, model, tolerance=tolerance, folder=folder, jobs=jobs)
    found = []
    for name, scale in zip(names, np.asarray(runs["multiplier"], dtype=object), strict=True):
        if scale is not None and not math.isnan(scale):
            history: Any = wall.with_({"load.history.file": name}).scene.history
            found.append(float(scale) * float(np.hypot(*history.peak)) / STANDARD_GRAVITY)
    if len(found) < 2:
        raise SceneError("records", "must be two at least that bring the wall down", len(found))
    logs = np.log(np.sort(found))
    again = np.random.default_rng(seed).choice(logs, (draws, len(logs))).mean(axis=1)
    low, high = np.exp(np.quantile(again, [0.05, 0.95])).tolist()
    left_out = len(names) - len(found)
    return Fragility(np.exp(logs), float(np.exp(logs.mean())), float(logs.std(ddof=1)), (low, high), runs, left_out)
