"""Fragility: the probability that ground motions of a given intensity bring a wall down, from a set of records."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri, stdtrit
from scipy.stats import CensoredData, lognorm

from .models import TOLERANCE, Model
from .scene import Array, Mask, SceneError
from .scene.history import STANDARD_GRAVITY
from .scene.ranges import check_whole_number
from .sweeps import check_wall, sweep
from .tables import Table
from .wall import Wall

TAILS = (0.05, 0.95)
"""Quantiles of resampled medians at the two ends of their interval."""


@dataclass(frozen=True, eq=False, repr=False)
class Fragility:
    """Log-normal fragility of a wall.

    Parameters
    ----------
    intensity : (n,) float
        Peak ground acceleration at which each record brings the wall down, ascending [g].
    stood : (m,) float
        Largest peak acceleration tried for each record that never brings it down, ascending [g].
    median, dispersion
        Median, and standard deviation of the logarithm, of the log-normal distribution fitted by maximum likelihood
        with `stood` as right-censored data.
    interval
        90 % confidence interval of the median from a seeded bootstrap of the records, widened for small samples; its
        upper end is infinite if too few records bring the wall down.
    runs
        One row per record: its bracket of λ, status and message.
    left_out
        Number of records without an answer.
    """

    intensity: Array
    stood: Array
    median: float
    dispersion: float
    interval: tuple[float, float]
    runs: Table
    left_out: int

    def probability(self, intensity: Array | float) -> Array:
        """Probability of collapse at intensities [g]; a `SceneError` for negative ones."""
        try:
            level = np.asarray(intensity, dtype=float)
        except (TypeError, ValueError):
            level = np.array(np.nan)
        if not (level >= 0).all():
            raise SceneError("intensity", "must be numbers of at least 0, in g", intensity)
        with np.errstate(divide="ignore"):  # log of an intensity of 0
            return np.asarray(ndtr(np.log(level / self.median) / max(self.dispersion, 1e-12)))

    def __repr__(self) -> str:
        left_out = f"{self.left_out} left out" + (" (`runs` says why)" if self.left_out else "")
        records = f"{len(self.intensity)} records, {len(self.stood)} under which it stands, {left_out}"
        return f"<Fragility: median {self.median:.3g} g, dispersion {self.dispersion:.3g}; {records}>"


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
    """Find the critical scale of every record and fit the fragility to them.

    Parameters
    ----------
    wall
        The wall, with a ``load.history`` whose file is replaced by each record's in turn.
    records
        Files; relative paths refer to the wall's folder, as in its scene file.
    model, tolerance, folder, jobs
        As in `sweep`: with a folder, only missing records are computed.
    seed, draws
        Seed and number of samples of the bootstrap for the interval of the median.

    Raises
    ------
    SceneError
        If the wall has no record, a record is named twice, or fewer than two records bring it down.
    """
    check_wall(wall)
    if wall.scene.history is None or "file" not in wall.description["load"]["history"]:
        raise SceneError("load.history.file", "is missing: the record that others are to take the place of")
    check_whole_number("draws", draws)
    check_whole_number("seed", seed, least=0)
    if isinstance(records, (str, bytes)) or not isinstance(records, Iterable):
        raise SceneError("records", "must be a list of files", records)
    names = [str(record) for record in records]
    for name, times in Counter((Path(wall.folder) / name).resolve() for name in names).items():
        if times > 1:
            raise SceneError("records", f"must name each record once, and name {name.name} {times} times")
    runs = sweep(wall, {"load.history.file": names}, model, tolerance=tolerance, folder=folder, jobs=jobs)
    levels: dict[bool, list[float]] = {True: [], False: []}  # by whether the wall fell
    unknown = list[int]()
    answers = zip(names, *(runs[key] for key in ("status", "multiplier", "lower", "upper")), strict=True)
    for number, (name, status, *answer) in enumerate(answers):
        scale, lower, upper = (math.nan if x is None else float(x) for x in answer)
        fell = status == "collapse"
        if fell or (status == "undecided" and lower > 0 and math.isnan(upper)):
            history: Any = wall.with_({"load.history.file": name}).scene.history
            peak = float(np.hypot(*history.peak)) / STANDARD_GRAVITY
            levels[fell].append((scale if fell else lower) * peak)
        else:
            unknown.append(number)
    fallen, stood = np.sort(levels[True]), np.sort(levels[False])
    if len(fallen) < 2:
        first = {runs["message"][k]: names[k] for k in reversed(unknown)}  # the first record with each reason
        reasons = [f"{name}: {message}" for message, name in reversed(first.items())]
        remedy = "; ".join(["must be two at least that bring the wall down", *reasons])
        raise SceneError("records", remedy, len(fallen))
    level, stands = np.concatenate([fallen, stood]), np.arange(len(fallen) + len(stood)) >= len(fallen)
    left_out = len(names) - len(level)
    interval = interval_of_median(level, stands, seed, draws)
    return Fragility(fallen, stood, *fitted(level, stands), interval, runs, left_out)


def interval_of_median(level: Array, stands: Mask, seed: int, draws: int) -> tuple[float, float]:
    """Find the 90 % confidence interval of the median of `fitted` by a bootstrap over the records.

    With n falls, bootstrap medians scatter by √((n−1)/n) times the scatter of medians of independent samples, and as if
    the dispersion were known. The interval is therefore widened by √(n/(n−1)) and by the ratio of quantiles of
    Student's distribution to the normal one, which makes it nearly exact for four or more log-normal levels. Of two or
    three levels resampled medians take few values, and the interval contains the median somewhat less often.
    """
    again = np.random.default_rng(seed).integers(len(level), size=(draws, len(level)))
    medians = [fitted(level[drawn], stands[drawn])[0] for drawn in again]
    low, high = np.quantile(medians, TAILS, method="inverted_cdf").tolist()
    n, median = np.count_nonzero(~stands), fitted(level, stands)[0]
    wider = math.sqrt(n / (n - 1)) * float(stdtrit(n - 1, TAILS[1]) / ndtri(TAILS[1]))
    return median * (low / median) ** wider, median * (high / median) ** wider


def fitted(level: Array, stands: Mask) -> tuple[float, float]:
    """Fit a log-normal distribution to right-censored collapse levels by maximum likelihood.

    Parameters
    ----------
    level : (n,) float
        Level at which each fell, or the largest at which it stood; in any unit.
    stands : (n,) bool
        Which of them stood, so that their collapse level is larger.

    Returns
    -------
    tuple
        Median in the unit of the levels, infinite with fewer than two falls; standard deviation of the logarithm.
    """
    if np.count_nonzero(~stands) < 2:
        return math.inf, 0.0
    start = np.log(level)
    if not stands.any():
        return float(np.exp(start.mean())), float(start.std())
    known = CensoredData.right_censored(level, stands)
    shape, _, median = lognorm.fit(known, max(float(start.std()), 0.1), scale=float(np.exp(start.mean())), floc=0)
    return float(median), float(shape)
