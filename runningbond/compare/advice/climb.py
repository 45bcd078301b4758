"""Which model a scene needs: the ladder of models, climbed until the answer is as narrow as asked.

    homog → limit → limit-nonassociated → dem-static → dem-dynamic → fem

Each rung is climbed for a reason, and left out for one. `homog` has no bracket and shows the trend alone. `limit`
is a proof from above: no wall of Coulomb joints stands above it. `limit-nonassociated` certifies loads at which the
wall can collapse. A model that follows the wall brackets the collapse of one history. docs/advise.md says what ends
the climb, and what its bracket means.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from runningbond.compare.models import check_tolerance, run_model
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError

from .costs import LAWS, Estimate
from .finite import FINITE, finite_peak
from .knowledge import Knowledge
from .next_rung import after_refusal, next_rung

TOLERANCE = 0.05
"""Relative width of the bracket that is asked for where nothing else is."""


@dataclass(frozen=True)
class Rung:
    """One rung: what a model found, and what follows from it.

    Parameters
    ----------
    model
        The model.
    outcome
        What it found; None where it says nothing of such a scene.
    reason
        What follows: why to go on, or why this is enough.
    onward
        The next model; None on the last rung.
    next_cost
        What that model is going to cost; None where no law says.
    seconds
        Seconds since the foot of the ladder.
    """

    model: str
    outcome: Outcome | None
    reason: str
    onward: str | None
    next_cost: Estimate | None
    seconds: float


@dataclass
class Advice:
    """A climb.

    Parameters
    ----------
    known
        What the scene is, what is asked of it, and what the rungs so far have shown.
    rungs
        Rungs climbed.
    """

    known: Knowledge
    rungs: list[Rung] = field(default_factory=list)

    def climb(self) -> Iterator[Rung]:
        """Climb rung by rung; each is given when it is done, before the next is begun."""
        model: str | None = "homog"
        while model is not None:
            outcome: Outcome | None = None
            try:
                outcome = self._run(model)
            except SceneError as refusal:
                step = after_refusal(model, str(refusal))
            else:
                self.known.learn(outcome)
                step = next_rung(self.known, model, outcome)
            cost = self.known.estimate(step.model) if step.model in LAWS else None
            self.rungs.append(Rung(model, outcome, step.reason, step.model, cost, self.known.seconds))
            yield self.rungs[-1]
            model = step.model

    def outcome(self) -> Outcome:
        """The answer: the bracket of the last rung that gave one, and in the message what it means."""
        known, last = self.known, self.rungs[-1]
        found = known.answer or last.outcome or Outcome(known.scene.title, last.model, "undecided")
        message = known.meaning() or last.reason
        if last.outcome is None and known.answer is not None:
            message += "; at small displacements, though they are not small"
        elif last.outcome is not None and last.outcome.status != "collapse" and known.answer is not None:
            message += f"; {last.model}: {last.reason}"
        return replace(found, seconds=known.seconds, message=message)

    def _run(self, model: str) -> Outcome:
        known = self.known
        if model in FINITE:
            way = max(known.way or 0.0, known.tolerance)
            return finite_peak(known.scene, FINITE[model], known.tolerance, way, known.bound)
        return run_model(model, known.scene, known.tolerance, **self._asked(model))

    def _asked(self, model: str) -> dict[str, Any]:
        """What is asked of a model besides: no more than is wanted."""
        if model == "dem-static":
            return {"past": 0}
        return {"cracks": "blocks"} if model == "fem" and self.known.needs.cracks else {}


def advice_on(scene: Scene, tolerance: float = TOLERANCE, *, finite: bool = False) -> Advice:
    """Stand at the foot of the ladder.

    Parameters
    ----------
    scene
        The scene.
    tolerance
        Relative width of the bracket asked for.
    finite
        Whether to end at finite displacements, however small they may be.
    """
    check_tolerance(tolerance)
    return Advice(Knowledge(scene, tolerance, finite))


def advise(scene: Scene, tolerance: float = TOLERANCE, *, finite: bool = False) -> Advice:
    """Climb the ladder as far as a scene needs; see `advice_on`."""
    advice = advice_on(scene, tolerance, finite=finite)
    for _ in advice.climb():
        pass
    return advice
