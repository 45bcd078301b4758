"""What the models run so far have shown of a wall, and what that is worth."""

from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from runningbond.compare.model import Kind, Model
from runningbond.compare.models import MODELS
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene

from .costs import Estimate, estimate, pace
from .needs import Needs, collapse_displacement, needs_of, sliding_dilates

Evidence: TypeAlias = Literal["", "proof", "certificate", "history", "finite"]
"""What a bracket rests on; nothing, to begin with."""


def ladder(kind: Kind) -> list[Model]:
    """Models of a kind whose cost is known, the cheapest first."""
    return [model for model in MODELS.values() if model.kind == kind and model.cost is not None]


def deforms(model: Model) -> bool:
    """Whether the blocks of a model deform."""
    return "block.young" in model.reads


@dataclass
class Knowledge:
    """What is asked of a scene, and what the models run so far have shown."""

    scene: Scene
    tolerance: float  # relative width of the bracket asked for
    finite: bool = False  # whether finite displacements are asked for, however small they may be
    outcomes: list[Outcome] = field(default_factory=list)
    bound: float | None = None  # associated load, above which nothing stands at small displacements
    evidence: Evidence = ""  # what the answer rests on
    answer: Outcome | None = None  # the outcome whose bracket it is
    collapses: list[float] = field(default_factory=list)  # loads at which a proof, a certificate or a model found it

    def __post_init__(self) -> None:
        self.needs: Needs = needs_of(self.scene)

    def learn(self, model: Model, outcome: Outcome, *, finite: bool = False) -> None:
        """Take in what a model found, at `finite` displacements or at small ones."""
        self.outcomes.append(outcome)
        if outcome.status != "collapse" or outcome.lower is None or outcome.upper is None:
            return
        if model.kind == "bound":
            self.bound = outcome.upper
            perfect = not (self.needs.softens or self.needs.cracks)
            if perfect and not sliding_dilates(self.scene, outcome.motion):
                self._answer("proof", outcome, outcome.lower)
        elif model.kind == "certificate":
            certified = outcome
            if self.bound is not None and self.bound - outcome.lower <= self.tolerance * self.bound:
                certified = replace(outcome, upper=max(outcome.upper, self.bound))
            self._answer("certificate", certified, outcome.lower)
        elif finite:
            self._answer("finite", outcome, outcome.lower)
        else:
            self._answer("history", self._below_the_bound(outcome), outcome.upper)

    def _answer(self, evidence: Evidence, outcome: Outcome, collapse: float) -> None:
        self.evidence, self.answer = evidence, outcome
        self.collapses.append(collapse)

    def _below_the_bound(self, outcome: Outcome) -> Outcome:
        """The outcome of a history, which cannot have stood above the associated bound."""
        if self.bound is None or outcome.lower is None or outcome.upper is None or outcome.multiplier is None:
            return outcome
        upper = max(outcome.lower, min(outcome.upper, self.bound))
        return replace(outcome, upper=upper, multiplier=min(outcome.multiplier, upper))

    @property
    def seconds(self) -> float:
        """Seconds that the models have taken."""
        return sum(outcome.seconds for outcome in self.outcomes)

    @property
    def lowest(self) -> float | None:
        """Smallest load at which a proof, a certificate or a model brought the wall down."""
        return min(self.collapses, default=None)

    @property
    def soft(self) -> bool:
        """Whether blocks are so compliant that they must deform."""
        return self.needs.compliance > self.tolerance

    @property
    def displacement(self) -> float | None:
        """How far the wall moves before it collapses, in block sizes; None where nothing tells."""
        return None if self.answer is None else collapse_displacement(self.scene, self.answer)

    def estimate(self, model: Model) -> Estimate:
        """What a model is going to cost, at the pace of those run so far."""
        return estimate(model, self.scene, self.tolerance, pace(self.scene, self.tolerance, self.outcomes))

    def meaning(self) -> str:
        """What the bracket of the answer means; empty without one."""
        if self.answer is None:
            return ""
        above = "" if self.bound is None else f"; above {number(self.bound)} nothing stands"
        if self.evidence == "proof":
            return "forces and a mechanism prove it, whether or not sliding joints dilate"
        if self.evidence == "finite":
            return self.answer.message + (above and f"{above} at small displacements")
        if self.evidence == "certificate":
            return f"collapse is certified from the lower load on; smaller ones are not excluded{above}"
        below = "" if self.lowest is None else f"; others may end from {number(self.lowest)} on, or lower"
        return f"largest load at rest and smallest at collapse in one history, loads raised slowly{below}{above}"
