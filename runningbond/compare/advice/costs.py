"""What a model is going to cost, from what it cost on the published walls and what this machine has taken so far.

    seconds = pace · (at_100 · (n / 100)^growth · (COARSE / tolerance)^finer + start)

with n blocks and the `Cost` of the model, which `benchmarks/studies/cost_laws.py` prints from the table of a
comparison, the power of the tolerance as `runningbond study` measures it; times factors for what of a wall makes it
dearer. Pace is how much slower the machine at hand was in the models already run, so that the laws hold from one
machine to the next: the mean of these models' ratios, each with the weight of what its law is worth.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, hypot, log

from runningbond.models import MODELS, Cost, Model
from runningbond.models.second_opinion import asks_others
from runningbond.results import Outcome
from runningbond.results.outcome import two_digits
from runningbond.scene import Scene

COARSE = 0.01  # tolerance of the comparison that the laws were fitted to

EXACT = 1e-3
"""Logarithm of the scatter of a law that claims to have none."""

POINT_PROGRAMS = 150_000
"""Linear programs of a short search for certificates, times the ends of joints: as long as a few histories take."""

SHORT_SEARCH = Cost(1.8, 1.03, 1.34, weightless=0.56, start=0.03)
"""Law of what that costs."""


@dataclass(frozen=True)
class Estimate:
    """Expected seconds, and the factor by which they may be wrong either way."""

    seconds: float
    spread: float

    def __str__(self) -> str:
        return f"about {two_digits(self.seconds)} s (×÷ {self.spread:.1f})"


@dataclass(frozen=True)
class Pace:
    """How many times as long as the laws a machine takes, and the factor by which that may be wrong either way."""

    factor: float = 1.0
    spread: float = 1.0


USUAL = Pace()
"""That of the machine which the laws were fitted on."""


def short_search(scene: Scene) -> int:
    """Linear programs of the search for certificates that `advise` makes."""
    return 20 + POINT_PROGRAMS // (2 * max(1, len(scene.joints)))


def estimate(
    model: Model, scene: Scene, tolerance: float, pace: Pace = USUAL, *, advised: bool = False, draws: int = 1
) -> Estimate:
    """What a model that has a `Cost` will take on some draws of a scene, of itself or as `advise` runs it."""
    law = SHORT_SEARCH if advised and model.kind == "certificate" else model.cost
    if law is None:
        raise ValueError(f"no law says what {model.name} costs")
    blocks = int((scene.wall & ~scene.fixed).sum())
    seconds = law.at_100 * (blocks / 100) ** law.growth * (COARSE / tolerance) ** law.finer
    if not any(scene.load.gravity):
        seconds *= law.weightless
    if scene.inner_joint is not None:
        seconds *= law.cracked
    seconds = _dearer(model, law, scene) * (draws * seconds + law.start)
    return Estimate(pace.factor * seconds, exp(hypot(log(law.spread), log(pace.spread))))


def _dearer(model: Model, law: Cost, scene: Scene) -> float:
    """How many times as much walls cost for what a model reads of their materials."""
    joints = scene.materials_of_joints
    causes = (
        ("fracture_energy_1", any(each.softens for each in joints), law.softened),
        ("compressive_strength", any(each.compressive_strength is not None for each in joints), law.crushed),
        ("closure", any(each.closure is not None for each in joints), law.crushed),
    )
    dearest = max((factor for key, there, factor in causes if there and f"joint.{key}" in model.reads), default=1.0)
    return dearest * (law.soft if asks_others(scene, {}) else 1.0)


def pace(scene: Scene, tolerance: float, outcomes: Sequence[Outcome]) -> Pace:
    """How much slower than the laws the outcomes so far were; as fast where none of them took time enough to tell."""
    runs = [(MODELS[each.model], each.seconds) for each in outcomes if each.model in MODELS and each.seconds > 0]
    timed = [(model, seconds) for model, seconds in runs if model.cost is not None and model.kind != "estimate"]
    if not timed:
        return USUAL
    laws = [estimate(model, scene, tolerance, advised=True) for model, _ in timed]
    weights = [max(log(law.spread), EXACT) ** -2 for law in laws]
    slower = [log(seconds / law.seconds) for law, (_, seconds) in zip(laws, timed, strict=True)]
    mean = sum(weight * each for weight, each in zip(weights, slower, strict=True)) / sum(weights)
    return Pace(exp(mean), exp(sum(weights) ** -0.5))
