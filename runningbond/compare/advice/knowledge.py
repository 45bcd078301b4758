"""What is known of a wall part of the way up the ladder, and what it is worth."""

from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene

from .costs import Estimate, estimate, pace
from .finite import FINITE
from .needs import Needs, needs_of, sliding_dilates, sway

Kind: TypeAlias = Literal["", "proof", "certificate", "history", "finite"]
"""What a bracket rests on; nothing so far, to begin with."""


@dataclass
class Knowledge:
    """What the rungs so far have shown.

    Parameters
    ----------
    scene
        The scene.
    tolerance
        Relative width of the bracket asked for.
    finite
        Whether finite displacements are asked for, however small they may be.
    outcomes
        What the models found, rung by rung.
    bound
        Associated load, above which nothing stands at small displacements; None where there is none.
    kind
        What the answer rests on.
    answer
        The outcome whose bracket it is.
    fallen
        Loads at which a proof, a certificate or a model brought the wall down.
    """

    scene: Scene
    tolerance: float
    finite: bool = False
    outcomes: list[Outcome] = field(default_factory=list)
    bound: float | None = None
    kind: Kind = ""
    answer: Outcome | None = None
    fallen: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.needs: Needs = needs_of(self.scene)

    def learn(self, outcome: Outcome) -> None:
        """Take in what a model found."""
        self.outcomes.append(outcome)
        if outcome.status != "collapse" or outcome.lower is None or outcome.upper is None:
            return
        if outcome.model == "limit":
            self.bound = outcome.upper
            whole = not (self.needs.softens or self.needs.cracks)
            if whole and not sliding_dilates(self.scene, outcome.motion):
                self._answer("proof", outcome, outcome.lower)
        elif outcome.model == "limit-nonassociated":
            certified = outcome
            if self.bound is not None and self.bound - outcome.lower <= self.tolerance * self.bound:
                certified = replace(outcome, upper=max(outcome.upper, self.bound))
            self._answer("certificate", certified, outcome.lower)
        elif outcome.model in FINITE:
            self._answer("finite", outcome, outcome.lower)
        else:
            self._answer("history", self._below_the_bound(outcome), outcome.upper)

    def _answer(self, kind: Kind, outcome: Outcome, fallen: float) -> None:
        self.kind, self.answer = kind, outcome
        self.fallen.append(fallen)

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
        return min(self.fallen, default=None)

    @property
    def soft(self) -> bool:
        """Whether blocks give so much that they must deform."""
        return self.needs.pliancy > self.tolerance

    @property
    def way(self) -> float | None:
        """How far the wall sways before it falls, in block sizes; None where that is not known."""
        return None if self.answer is None else sway(self.scene, self.answer)

    def estimate(self, model: str) -> Estimate:
        """What a model is going to cost, at the pace of those run so far."""
        paced = pace(self.scene, self.tolerance, self.outcomes)
        return estimate(model, self.scene, self.tolerance, paced)

    def meaning(self) -> str:
        """What the bracket of the answer means; empty without one."""
        if self.answer is None:
            return ""
        above = "" if self.bound is None else f"; above {number(self.bound)} nothing stands"
        if self.kind == "proof":
            return "forces and a mechanism prove it, whether or not sliding joints dilate"
        if self.kind == "finite":
            return self.answer.message + (above and f"{above} at small displacements")
        if self.kind == "certificate":
            return f"collapse is certified from the lower load on; smaller ones are not excluded{above}"
        below = "" if self.lowest is None else f"; others may end from {number(self.lowest)} on, or lower"
        return f"largest load at rest and smallest of a fall in one history, loads raised slowly{below}{above}"
