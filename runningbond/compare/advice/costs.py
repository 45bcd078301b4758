"""What a model is going to cost, from what it cost on the published walls and what this machine has taken so far.

    seconds = pace · (at_100 · (n / 100)^growth · (COARSE / tolerance)^finer + LOADING)

with n blocks. `LAWS` is printed by `benchmarks/studies/cost_laws.py` from the table of a comparison; pace is how much
slower the machine at hand was in the rungs already climbed, so that the laws hold from one to the next.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from runningbond.compare.models import IN_MOTION
from runningbond.results import Outcome
from runningbond.scene import Scene

COARSE = 0.01
"""Tolerance of the comparison that the laws were found in."""

FINER = {"dem-static": 0.10, "dem-dynamic": 0.06, "fem": 0.06}
"""Power of the tolerance in the cost of models that bisect; the others have none.

Those of models in motion are what `runningbond study` says of a tolerance of 5 %: 0.91 times the cost.
"""

LOADING = 3.0
"""Seconds until the kernels of blocks in motion are there, once a process: `dem-dynamic` and `fem` wait for them."""

CRACKED = 6.0
"""How many times more degrees of freedom fem has where blocks crack between all triangles."""


@dataclass(frozen=True)
class Law:
    """Cost of one model.

    Parameters
    ----------
    at_100
        Seconds for 100 blocks.
    growth
        Power of the number of blocks.
    weightless
        How many times as much walls without weight cost.
    spread
        Factor within which two thirds of the walls lie about the law.
    """

    at_100: float
    growth: float
    weightless: float
    spread: float


LAWS: dict[str, Law] = {
    "homog": Law(0.00029, 0.59, 1, 1.15),
    "limit": Law(0.035, 1.56, 0.72, 1.29),
    "limit-nonassociated": Law(0.22, 1.87, 1, 1.48),
    "dem-static": Law(0.29, 1.82, 0.72, 1.55),
    "dem-dynamic": Law(1.4, 1.23, 1, 1.51),
    "fem": Law(5.0, 1.05, 1.1, 1.46),
}


@dataclass(frozen=True)
class Estimate:
    """Expected seconds, and the factor by which they may be wrong either way."""

    seconds: float
    spread: float

    def __str__(self) -> str:
        return f"about {self.seconds:.2g} s (×÷ {self.spread:.1f})"


def estimate(model: str, scene: Scene, tolerance: float, pace: float = 1.0) -> Estimate:
    """What a model will take on a scene."""
    law = LAWS[model]
    seconds = law.at_100 * (_blocks(scene) / 100) ** law.growth
    seconds *= (COARSE / tolerance) ** FINER.get(model, 0.0)
    if not any(scene.load.gravity):
        seconds *= law.weightless
    if model == "fem" and scene.inner_joint is not None:
        seconds *= CRACKED
    if model in IN_MOTION:
        seconds += LOADING
    return Estimate(pace * seconds, law.spread)


def pace(scene: Scene, tolerance: float, outcomes: Sequence[Outcome]) -> float:
    """How much slower than the laws the outcomes so far were; 1 where there are none that tell."""
    told = [outcome for outcome in outcomes if outcome.model != "homog" and outcome.seconds > 0]
    if not told:
        return 1.0
    ratios = [math.log(out.seconds / estimate(out.model, scene, tolerance).seconds) for out in told]
    return math.exp(sum(ratios) / len(ratios))


def _blocks(scene: Scene) -> int:
    return int((scene.wall & ~scene.fixed).sum())
