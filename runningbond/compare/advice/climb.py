"""Which model a scene needs: models are run in the order of a ladder until the bracket meets the tolerance.

Every model that is tried is a rung, with the reason for its choice. `Kind` defines the meaning of its multiplier;
docs/advise.md describes what ends the climb and what the final bracket means.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from runningbond.draws import Scatter
from runningbond.joints.wall_points import spreads
from runningbond.models import MODELS, check_tolerance, run_model
from runningbond.models.beds import along_joints
from runningbond.models.costs import Estimate, short_search, tolerance_of_draws
from runningbond.results import Outcome
from runningbond.results.outcome import joined
from runningbond.scene import Scene, SceneError

from ..table import bracket
from .experiment import ModelError, error_of
from .knowledge import Knowledge, ladder
from .steps import ROLLS, Step, after_refusal, next_step

TOLERANCE = 0.05  # default of the requested relative width of the bracket
PUSH_FACTOR = 3.0  # displacement up to which to push, relative to that of the collapse at small displacements


@dataclass(frozen=True)
class AdviceRung:
    """One rung: the outcome of a model, and what follows from it."""

    model: str  # name of the model
    outcome: Outcome | None  # None if the model does not apply to the scene
    next: Step  # the model that follows, and why; or why no further model is needed
    next_cost: Estimate | None  # None on the last rung, and if there is no cost law for the next step
    seconds: float  # time used by all rungs so far

    def __str__(self) -> str:
        """One line with the result, the time so far, what follows, and the next model with its expected cost."""
        result = "–"
        if self.outcome is not None:
            result = bracket(self.outcome) if self.outcome.status == "collapse" else self.outcome.status
        line = f"{self.model:20} {result:19} {self.seconds:7.2f} s  {self.next.reason}"
        if self.next.name is None:
            return line
        return f"{line} → {self.next.name}, {self.next_cost or 'at unknown cost'}"


@dataclass(repr=False)
class Advice:
    """A climb of the ladder: the knowledge about a scene, and the rungs so far."""

    known: Knowledge
    rungs: list[AdviceRung] = field(default_factory=list)

    def __repr__(self) -> str:
        """Text that ``runningbond advise`` prints: one line per rung, then the answer."""
        return "\n".join([self.title, *map(str, self.rungs), *([self.in_words(self.outcome())] if self.rungs else [])])

    @property
    def title(self) -> str:
        """Title of the scene, and the requested relative width of the bracket."""
        return f"{self.known.scene.title}: λ to {100 * self.known.tolerance:g} %"

    def in_words(self, outcome: Outcome) -> str:
        """The answer, the model it is from, the meaning of its bracket, and the model's measured error in tests."""
        result = f"λ {bracket(outcome)}" if outcome.status == "collapse" else outcome.status
        said = outcome.message, self.against_experiment()[1]
        return "\n  ".join([f"{result} by {outcome.model}, {outcome.seconds:.2f} s", *filter(None, said)])

    def climb(self) -> Iterator[AdviceRung]:
        """Climb the ladder; yields each rung when it is done, before the next model is run."""
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
        """The answer: the bracket of the last rung that has one, and its meaning in the message.

        It has no lower end where the wall, as it leans, bears less by an estimate, and no model has followed it.
        """
        known, last = self.known, self.rungs[-1]
        answer = known.answer or last.outcome or Outcome(known.scene.title, last.model, "undecided")
        message = known.meaning() or last.next.reason + known.above
        leans, followed = known.on_edges, last.outcome is not None and last.outcome.status == "collapse"
        if leans is not None:
            small = bracket(answer) if answer.status == "collapse" else answer.status
            message = f"{small} at small displacements: {message}; but {ROLLS}: {leans}"
            answer = replace(answer, status="undecided", multiplier=None, lower=None)
        if known.answer is not None and not followed:
            finite, large = last.model.endswith("finite"), (known.displacement or 0.0) > known.tolerance
            if finite and leans is None:
                message += "; at small displacements" + (", though they are not small" if large else "")
            message += f"; {last.model}: {last.next.reason}" if last.outcome is not None or not finite or leans else ""
        model = MODELS.get(answer.model.split(",")[0])
        ignored = model.unread_by_law(known.scene) if model is not None and known.answer is not None else []
        left_out = f"not taken into account: {', '.join(ignored)}"
        message += f"; {left_out}" if ignored and left_out not in message else ""  # a finite run has told it
        return replace(answer, seconds=known.seconds, message=message)

    @property
    def lowest(self) -> float | None:
        """Smallest load at which a certificate or a model brought the wall down, or an estimate, as it leans."""
        least, leans = self.known.lowest, self.known.on_edges
        return least if least is None or leans is None else min(least, leans.load)

    def against_experiment(self) -> tuple[ModelError | None, str]:
        """Measured error of the answer's model and a description; the bound's error if no test covers that model."""
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
        """Run a step; returns one outcome per draw, fewer if a run was interrupted."""
        known, model = self.known, step.model
        assert model is not None
        if step.finite:
            return [finite_peak(known, step)]
        # The curve past the peak is not needed for the bracket; blocks crack anywhere if the scene permits this.
        cracks = "blocks" if known.cracks else "joints"
        wanted: dict[str, Any] = {"past": 0, "cracks": cracks, "programs": short_search(known.scene)}
        settings = {name: value for name, value in wanted.items() if name in model.parameters}
        tolerance, found = tolerance_of_draws(known.tolerance, step.draws), list[Outcome]()
        for k in range(step.draws):
            found.append(run_model(model, Scatter().draw(known.scene, k), tolerance, **settings))
            if "interrupted" in found[-1].message:
                break
        return found


def together(draws: Sequence[Outcome]) -> Outcome:
    """Combine draws: the lowest collapse or else the first draw, the bracket around all collapses, their median as λ.

    The seconds are those of all draws.
    """
    if len(draws) == 1:
        return draws[0]
    seconds = sum(draw.seconds for draw in draws)
    fallen = [draw for draw in draws if draw.lower is not None and draw.multiplier is not None]
    if not fallen:
        return replace(draws[0], seconds=seconds)
    lowest = min(fallen, key=lambda draw: draw.lower or 0.0)
    upper = max(draw.upper or 0.0 for draw in fallen)
    median = float(np.median([draw.multiplier for draw in fallen if draw.multiplier is not None]))
    return replace(lowest, upper=upper, multiplier=median, seconds=seconds)


def advise(scene: Scene, tolerance: float = TOLERANCE, *, finite: bool = False) -> Advice:
    """Run models until the bracket of a scene has the requested relative width, at `finite` displacements if set."""
    check_tolerance(tolerance)
    advice = Advice(Knowledge(scene, tolerance, finite))
    for _ in advice.climb():
        pass
    return advice


def finite_peak(known: Knowledge, step: Step) -> Outcome:
    """Push a wall past its peak at finite displacements, where blocks crack only on their axes.

    Joints bear along their whole length if the wall then falls earlier, as it leans.
    Undecided if it ends above the bound at small displacements, as inertia then bears part of the load, or if λ is
    above the load under which the wall fell when its blocks could crack anywhere.
    """
    model, scene, tolerance, bound = step.model, known.scene, known.tolerance, known.bound
    assert model is not None
    distance = PUSH_FACTOR * max(known.displacement or 0.0, tolerance) * scene.block_size
    leans, along = known.on_edges, ""
    if leans is not None:
        distance = max(distance, PUSH_FACTOR * leans.moved)
        along = "" if spreads(scene, finite=True) else "joints are taken to be pressed along their whole length"
        scene = along_joints(scene)
    reach: dict[str, Any] = {} if scene.is_led else {"distance": distance}  # a beam moves as its drive prescribes
    outcome = run_model(model, scene, tolerance, displacements="finite", **reach)
    reached, above = outcome.lower, "above the load that no wall carries at small displacements"
    if known.cracks and known.answer is not None:
        reached, bound, above = outcome.multiplier, known.answer.upper, "it bears more, as blocks crack only on axes"
    if outcome.status == "collapse" and bound is not None and reached is not None and reached > bound:
        outcome = replace(outcome, status="undecided", multiplier=None, message=f"{above}: {outcome.message}")
    return replace(outcome, model=step.name or "", message=joined(outcome.message, along))
