"""Expected run time of a model, from its run times on the published walls and those on this machine so far.

    seconds = pace · (at_100 · (n / 100)^growth · (FITTED_TOLERANCE / tolerance)^finer + start)

with n blocks and the `Cost` of the model, which `benchmarks/studies/cost_laws.py` prints from the table of a
comparison, and the exponent of the tolerance as measured by `runningbond study`. Factors for features of the wall that
increase the cost are not shown. The pace transfers the laws from one machine to another: it is the geometric mean of
measured over expected time of the models already run, with weights 1 / (log s)² for a law with a factor s of scatter.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot, log

import numpy as np

from runningbond.results import Outcome
from runningbond.results.outcome import two_digits
from runningbond.scene import Scene

from .model import Cost, Model
from .registry import MODELS
from .second_opinion import asks_others

FITTED_TOLERANCE = 0.01  # tolerance of the comparison to which the laws were fitted

LEAST_SCATTER = 1e-3
"""Least logarithm of the factor of scatter of a law, so that the weight of a law without scatter is finite."""

POINT_PROGRAMS = 150_000
"""Linear programs of a short search for certificates, times the number of joint ends. The search then takes about as
long as a few histories."""

SHORT_SEARCH = Cost(1.8, 1.03, 1.34, weightless=0.56, start=0.03)
"""Cost law of this short search."""


@dataclass(frozen=True)
class Estimate:
    """Expected seconds, and the factor by which they may be too high or too low."""

    seconds: float
    spread: float

    def __str__(self) -> str:
        return f"about {two_digits(self.seconds)} s (×÷ {self.spread:.1f})"


@dataclass(frozen=True)
class Pace:
    """Time on this machine over the time by the laws, and the factor by which this ratio may be too high or too low."""

    factor: float = 1.0
    spread: float = 1.0


FITTED_PACE = Pace()
"""Pace of the machine on which the laws were fitted."""


def short_search(scene: Scene) -> int:
    """Number of linear programs in the search for certificates by `advise`."""
    return 20 + POINT_PROGRAMS // (2 * max(1, len(scene.joints)))


def cracks_anywhere(scene: Scene) -> bool:
    """Whether `advise` lets blocks crack between all of their triangles: these need a modulus, and cannot hold ties."""
    moduli = [scene.block_materials[k].young for k in np.unique(scene.material_of_block[~scene.fixed])]
    return scene.inner_joint is not None and not len(scene.ties) and None not in moduli


def tolerance_of_draws(tolerance: float, draws: int) -> float:
    """Tolerance of each draw: with several draws half, so that draws that agree lie within the tolerance together."""
    return tolerance / min(draws, 2)


def estimate(
    model: Model, scene: Scene, tolerance: float, pace: Pace = FITTED_PACE, *, advised: bool = False, draws: int = 1
) -> Estimate:
    """Estimate the time of a model that has a `Cost` for some draws of a scene, run by itself or as in `advise`.

    The draws are run to `tolerance_of_draws`.
    """
    law = SHORT_SEARCH if advised and model.kind == "certificate" else model.cost
    if law is None:
        raise ValueError(f"there is no cost law for {model.name}")
    blocks = int((scene.wall & ~scene.fixed).sum())
    seconds = law.at_100 * (blocks / 100) ** law.growth
    seconds *= (FITTED_TOLERANCE / tolerance_of_draws(tolerance, draws)) ** law.finer
    if not any(scene.load.gravity):
        seconds *= law.weightless
    settings = {"cracks": "blocks"} if advised and "cracks" in model.parameters and cracks_anywhere(scene) else {}
    if settings:
        seconds *= law.cracked
    seconds = _dearer(model, law, scene, settings) * (draws * seconds + law.start)
    return Estimate(pace.factor * seconds, exp(hypot(log(law.spread), log(pace.spread))))


def _dearer(model: Model, law: Cost, scene: Scene, settings: Mapping[str, str]) -> float:
    """Factor on the cost for the most expensive material property that a model reads, and for soft blocks."""
    joints = scene.materials_of_joints
    causes = (
        ("fracture_energy_1", any(each.softens for each in joints), law.softened),
        ("compressive_strength", any(each.compressive_strength is not None for each in joints), law.crushed),
        ("closure", any(each.closure is not None for each in joints), law.crushed),
    )
    dearest = max((factor for key, there, factor in causes if there and f"joint.{key}" in model.reads), default=1.0)
    return dearest * (law.soft if asks_others(scene, settings) else 1.0)


def pace(scene: Scene, tolerance: float, outcomes: Sequence[Outcome], draws: Sequence[int] = ()) -> Pace:
    """Pace from the outcomes so far; `FITTED_PACE` if none of them has a cost law and a measured time.

    `draws` is the number of draws in the seconds of each outcome, by default one.
    """
    runs = [
        (MODELS[each.model], number, each.seconds)
        for each, number in zip(outcomes, draws or [1] * len(outcomes), strict=True)
        if each.model in MODELS and each.seconds > 0
    ]
    timed = [run for run in runs if run[0].cost is not None and run[0].kind != "estimate"]
    if not timed:
        return FITTED_PACE
    laws = [estimate(model, scene, tolerance, advised=True, draws=number) for model, number, _ in timed]
    weights = [max(log(law.spread), LEAST_SCATTER) ** -2 for law in laws]
    slower = [log(seconds / law.seconds) for law, (*_, seconds) in zip(laws, timed, strict=True)]
    mean = sum(weight * each for weight, each in zip(weights, slower, strict=True)) / sum(weights)
    return Pace(exp(mean), exp(sum(weights) ** -0.5))
