"""What a model is going to cost, from what it cost on the published walls and what this machine has taken so far.

    seconds = pace · (at_100 · (n / 100)^growth · (COARSE / tolerance)^finer + start)

with n blocks and the `Cost` of the model, which `benchmarks/studies/cost_laws.py` prints from the table of a
comparison, the power of the tolerance as `runningbond study` measures it. Pace is how much slower the machine at hand
was in the models already run, so that the laws hold from one machine to the next.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import geometric_mean

from runningbond.models import MODELS, Cost, Model
from runningbond.results import Outcome
from runningbond.results.outcome import two_digits
from runningbond.scene import Scene

COARSE = 0.01  # tolerance of the comparison that the laws were fitted to

POINT_PROGRAMS = 150_000
"""Linear programs of a short search for certificates, times the ends of joints: as long as a few histories take."""

SHORT_SEARCH = Cost(1.8, 1.03, 1.34, weightless=0.56)
"""Law of what that costs."""


@dataclass(frozen=True)
class Estimate:
    """Expected seconds, and the factor by which they may be wrong either way."""

    seconds: float
    spread: float

    def __str__(self) -> str:
        return f"about {two_digits(self.seconds)} s (×÷ {self.spread:.1f})"


def short_search(scene: Scene) -> int:
    """Linear programs of the search for certificates that `advise` makes."""
    return 20 + POINT_PROGRAMS // (2 * max(1, len(scene.joints)))


def estimate(model: Model, scene: Scene, tolerance: float, pace: float = 1.0, *, advised: bool = False) -> Estimate:
    """What a model that has a `Cost` will take on a scene, of itself or as `advise` runs it."""
    law = SHORT_SEARCH if advised and model.kind == "certificate" else model.cost
    if law is None:
        raise ValueError(f"no law says what {model.name} costs")
    blocks = int((scene.wall & ~scene.fixed).sum())
    seconds = law.at_100 * (blocks / 100) ** law.growth * (COARSE / tolerance) ** law.finer
    if not any(scene.load.gravity):
        seconds *= law.weightless
    if scene.inner_joint is not None:
        seconds *= law.cracked
    return Estimate(pace * (seconds + law.start), law.spread)


def pace(scene: Scene, tolerance: float, outcomes: Sequence[Outcome]) -> float:
    """How much slower than the laws the outcomes so far were; 1 where none of them took time enough to tell."""
    runs = [(MODELS[each.model], each.seconds) for each in outcomes if each.model in MODELS and each.seconds > 0]
    timed = [(model, seconds) for model, seconds in runs if model.cost is not None and model.kind != "estimate"]
    ratios = [seconds / estimate(model, scene, tolerance, advised=True).seconds for model, seconds in timed]
    return geometric_mean(ratios) if ratios else 1.0
