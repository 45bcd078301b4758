"""Which model a scene needs: the ladder of models, climbed until the answer is as narrow as asked.

Each rung is climbed for a reason, and left out for one. `Kind` says what its answer is worth, docs/advise.md what ends
the climb and what its bracket means.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from runningbond.draws import Scatter
from runningbond.models import check_tolerance, run_model
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError

from ..table import bracket
from .costs import Estimate, short_search
from .experiment import ModelError, error_of
from .knowledge import Knowledge, ladder
from .steps import Step, after_refusal, next_step

TOLERANCE = 0.05  # relative width of the bracket that is asked for where nothing else is
FARTHER = 3.0  # displacement up to which to push, relative to that of the collapse at small displacements


@dataclass(frozen=True)
class AdviceRung:
    """One rung: the outcome of a model, and what follows from it."""

    model: str  # its name
    outcome: Outcome | None  # None where the model does not apply to such a scene
    next: Step  # which model follows, and why; or why this is enough
    next_cost: Estimate | None  # None on the last rung, and where no law says
    seconds: float  # since the foot of the ladder

    def __str__(self) -> str:
        """The result, the cost so far, what follows from it, and the next rung with its cost, in a line."""
        result = "–"
        if self.outcome is not None:
            result = bracket(self.outcome) if self.outcome.status == "collapse" else self.outcome.status
        line = f"{self.model:20} {result:19} {self.seconds:7.2f} s  {self.next.reason}"
        if self.next.name is None:
            return line
        return f"{line} → {self.next.name}, {self.next_cost or 'at a cost that no law gives'}"


@dataclass(repr=False)
class Advice:
    """A climb: what is asked of a scene, what is known of it, and the rungs so far."""

    known: Knowledge
    rungs: list[AdviceRung] = field(default_factory=list)

    def __repr__(self) -> str:
        """What ``runningbond advise`` prints: a line a rung, then the answer."""
        return "\n".join([self.title, *map(str, self.rungs), *([self.in_words(self.outcome())] if self.rungs else [])])

    @property
    def title(self) -> str:
        """Of which wall, and how narrow a bracket is asked for."""
        return f"{self.known.scene.title}: λ to {100 * self.known.tolerance:g} %"

    def in_words(self, outcome: Outcome) -> str:
        """The answer, by which model, what its bracket means, and how far such answers were from tests."""
        result = f"λ {bracket(outcome)}" if outcome.status == "collapse" else outcome.status
        said = outcome.message, self.against_experiment()[1]
        return "\n  ".join([f"{result} by {outcome.model}, {outcome.seconds:.2f} s", *filter(None, said)])

    def climb(self) -> Iterator[AdviceRung]:
        """Climb rung by rung; each is given when it is done, before the next is begun."""
        step = Step(ladder("estimate")[0], "the trend at no cost")
        while step.model is not None:
            outcome: Outcome | None = None
            try:
                draws = self._run(step)
            except SceneError as refusal:
                following = after_refusal(self.known, step, str(refusal))
            else:
                outcome = together(draws)
                self.known.learn(step.model, outcome, finite=step.finite, draws=draws)
                following = next_step(self.known, step, outcome)
            cost: Estimate | None = None
            if following.model is not None and not following.finite:
                cost = self.known.estimate(following.model, following.draws)
            self.rungs.append(AdviceRung(step.name or "", outcome, following, cost, self.known.seconds))
            yield self.rungs[-1]
            step = following

    def outcome(self) -> Outcome:
        """The answer: the bracket of the last rung that gave one, and in the message what it means."""
        known, last = self.known, self.rungs[-1]
        answer = known.answer or last.outcome or Outcome(known.scene.title, last.model, "undecided")
        message = known.meaning() or last.next.reason
        if last.outcome is None and known.answer is not None:
            finite = last.model.endswith("finite")
            large = (known.displacement or 0.0) > known.tolerance
            small = "; at small displacements" + (", though they are not small" if large else "")
            message += small if finite else f"; {last.next.reason}"
        elif last.outcome is not None and last.outcome.status != "collapse" and known.answer is not None:
            message += f"; {last.model}: {last.next.reason}"
        return replace(answer, seconds=known.seconds, message=message)

    def against_experiment(self) -> tuple[ModelError | None, str]:
        """The measured error of the rung that the answer is of, and in words; of the bound where no wall tested it."""
        known = self.known
        if known.answer is None:
            return None, ""
        found = error_of(known.answer.model.split(",")[0], known.scene, finite=known.evidence == "finite")
        if found is not None:
            return found, f"against experiment: {found}"
        found = error_of(ladder("bound")[0].name, known.scene, finite=False)
        untested = f"against experiment: no such wall was tested with {known.answer.model}"
        return found, untested if found is None else f"{untested}; {found}"

    def _run(self, step: Step) -> list[Outcome]:
        """The outcomes of a step, one a draw; fewer where one was interrupted."""
        known, model = self.known, step.model
        assert model is not None
        if step.finite:
            return [finite_peak(known, step)]
        # No curve past the peak, which is no part of the bracket; and cracks in blocks where they may crack.
        wanted: dict[str, Any] = {"past": 0, "cracks": "blocks" if known.cracks else "joints"}
        wanted["programs"] = short_search(known.scene)
        settings = {name: value for name, value in wanted.items() if name in model.parameters}
        # Draws that agree are to lie within the tolerance together.
        tolerance, found = known.tolerance / min(step.draws, 2), list[Outcome]()
        for k in range(step.draws):
            found.append(run_model(model, Scatter().draw(known.scene, k), tolerance, **settings))
            if "interrupted" in found[-1].message:
                break
        return found


def together(draws: Sequence[Outcome]) -> Outcome:
    """What draws come to: the one that ends lowest, with a bracket that holds all that collapse, and their median."""
    fallen = [draw for draw in draws if draw.lower is not None and draw.multiplier is not None]
    if len(draws) == 1 or not fallen:
        return draws[0]
    lowest = min(fallen, key=lambda draw: draw.lower or 0.0)
    upper = max(draw.upper or 0.0 for draw in fallen)
    median = float(np.median([draw.multiplier for draw in fallen if draw.multiplier is not None]))
    return replace(lowest, upper=upper, multiplier=median, seconds=sum(draw.seconds for draw in draws))


def advise(scene: Scene, tolerance: float = TOLERANCE, *, finite: bool = False) -> Advice:
    """Climb the ladder as far as a scene needs for a bracket of some relative width, or to `finite` displacements."""
    check_tolerance(tolerance)
    advice = Advice(Knowledge(scene, tolerance, finite))
    for _ in advice.climb():
        pass
    return advice


def finite_peak(known: Knowledge, step: Step) -> Outcome:
    """The wall pushed past its peak at finite displacements.

    Its bracket reaches down to the load above which nothing stands at small displacements, or inertia has borne it.
    """
    model, scene, tolerance, bound = step.model, known.scene, known.tolerance, known.bound
    assert model is not None
    distance = FARTHER * max(known.displacement or 0.0, tolerance) * scene.block_size
    reach: dict[str, Any] = {} if scene.is_led else {"distance": distance}  # a beam is led as far as its drive says
    outcome = run_model(model, scene, tolerance, displacements="finite", **reach)
    if outcome.status == "collapse" and bound is not None and outcome.lower is not None and outcome.lower > bound:
        message = f"above the load that no wall bears at small displacements: {outcome.message}"
        outcome = replace(outcome, status="undecided", multiplier=None, message=message)
    return replace(outcome, model=step.name or "")
