"""Which model a scene needs: the ladder of models, climbed until the answer is as narrow as asked.

    homog → limit → limit-nonassociated → dem-static → dem-dynamic → fem

Each rung is climbed for a reason, and left out for one. `homog` has no bracket and shows the trend alone. `limit`
is a proof from above: no wall of Coulomb joints stands above it. `limit-nonassociated` certifies loads at which the
wall can collapse. A model that follows the wall brackets the collapse of one history. docs/advise.md says what ends
the climb, and what its bracket means.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from results import Outcome
from results.outcome import number
from scene import Scene, SceneError

from .costs import LAWS, Estimate, estimate, pace
from .finite import FINITE, Finite, finite_peak
from .models import check_tolerance, run_model
from .needs import Needs, needs_of, sliding_dilates, sway

TOLERANCE = 0.05
"""Relative width of the bracket that is asked for where nothing else is."""

WORTH = 2.0
"""How many times the cost of following one history a certificate, which holds for all of them, is worth."""

PATHS = ("dem-static", "dem-dynamic", "fem")
"""Models that follow the wall to its collapse."""

Kind: TypeAlias = Literal["", "proof", "certificate", "history", "finite"]
"""What a bracket rests on."""


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
        What that model is going to cost; None where nobody knows.
    seconds
        Seconds since the foot of the ladder.
    """

    model: str
    outcome: Outcome | None
    reason: str
    onward: str | None
    next_cost: Estimate | None
    seconds: float


@dataclass(frozen=True)
class Step:
    """What to do after a rung: the next model, or None, and why."""

    model: str | None
    reason: str


@dataclass
class Advice:
    """A climb, and what is known so far.

    Parameters
    ----------
    scene
        The scene.
    tolerance
        Relative width of the bracket asked for.
    finite
        Whether finite displacements are asked for, however small they may be.
    rungs
        Rungs climbed.
    bound
        Associated load, above which nothing stands; None where there is none.
    kind
        What the answer rests on.
    answer
        The outcome whose bracket it is.
    fallen
        Loads at which a certificate or a model brought the wall down.
    """

    scene: Scene
    tolerance: float = TOLERANCE
    finite: bool = False
    rungs: list[Rung] = field(default_factory=list)
    bound: float | None = None
    kind: Kind = ""
    answer: Outcome | None = None
    fallen: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        check_tolerance(self.tolerance)
        self.needs: Needs = needs_of(self.scene)

    def climb(self) -> Iterator[Rung]:
        """Climb rung by rung; each is given when it is done, before the next is begun."""
        model: str | None = "homog"
        while model is not None:
            outcome, refusal = self._run(model)
            if outcome is not None:
                self._learn(outcome)
            step = self._after(model, outcome, refusal)
            cost = self.estimate(step.model) if step.model in LAWS else None
            self.rungs.append(Rung(model, outcome, step.reason, step.model, cost, self.seconds + _seconds(outcome)))
            yield self.rungs[-1]
            model = step.model

    @property
    def seconds(self) -> float:
        """Seconds since the foot of the ladder."""
        return self.rungs[-1].seconds if self.rungs else 0.0

    @property
    def lowest(self) -> float | None:
        """Smallest load at which a certificate or a model brought the wall down."""
        return min(self.fallen, default=None)

    def estimate(self, model: str) -> Estimate:
        """What a model is going to cost, at the pace of the rungs climbed so far."""
        done = [rung.outcome for rung in self.rungs if rung.outcome is not None]
        return estimate(model, self.scene, self.tolerance, pace(self.scene, self.tolerance, done))

    def outcome(self) -> Outcome:
        """The answer: the bracket of the rung that gave it, never above the associated bound."""
        last = self.rungs[-1]
        found = self.answer or last.outcome or Outcome(self.scene.title, last.model, "undecided")
        bound = None if self.kind == "finite" else self.bound
        if bound is not None and found.lower is not None and found.upper is not None and found.multiplier is not None:
            upper = max(found.lower, min(found.upper, bound))
            found = replace(found, upper=upper, multiplier=min(found.multiplier, upper))
        return replace(found, seconds=last.seconds, message=self._meaning())

    def _run(self, model: str) -> tuple[Outcome | None, str]:
        try:
            if model in FINITE:
                return finite_peak(self.scene, FINITE[model], self.tolerance, self._way(), self.bound), ""
            if model == "fem" and self.needs.cracks:
                from fem_interface.model import fem

                return fem(self.scene, self.tolerance, cracks="blocks"), ""
            return run_model(model, self.scene, self.tolerance), ""
        except SceneError as refusal:
            return None, str(refusal).removeprefix("model homog: ")

    def _learn(self, outcome: Outcome) -> None:
        """Keep what an outcome says of the wall."""
        if outcome.status != "collapse" or outcome.upper is None or outcome.lower is None:
            return
        if outcome.model == "limit":
            self.bound = outcome.upper
            if outcome.multiplier == 0 or not sliding_dilates(self.scene, outcome.motion):
                self._answer("proof", outcome, outcome.lower)
        elif outcome.model == "limit-nonassociated":
            self._answer("certificate", outcome, outcome.lower)
        elif outcome.model in FINITE:
            self._answer("finite", outcome, outcome.lower)
        else:
            self._answer("history", outcome, outcome.upper)

    def _answer(self, kind: Kind, outcome: Outcome, fallen: float) -> None:
        self.kind, self.answer = kind, outcome
        self.fallen.append(fallen)

    # --- what to do next ---------------------------------------------------------------------------------------

    def _after(self, model: str, outcome: Outcome | None, refusal: str) -> Step:
        if model == "homog":
            trend = "an estimate for the wall as a continuum, on either side" if outcome else refusal
            return Step("limit", f"{trend}; a bound is wanted")
        if outcome is None:
            rest = "the answer at small displacements stays" if model in FINITE else "no other model answers"
            return Step(None, f"{refusal}; {rest}")
        if outcome.status == "infeasible":
            return Step(None, "it falls under its dead load, whatever the model")
        if model in FINITE:
            return Step(None, "blocks were followed as far as they went")
        if model == "limit":
            return self._after_limit(outcome)
        if model == "limit-nonassociated":
            return self._after_certificates(outcome)
        return self._after_history(outcome)

    def _after_limit(self, outcome: Outcome) -> Step:
        needs = self.needs
        if needs.cracks:
            return Step("fem", "no wall stands above it; blocks may crack elsewhere than on their axes, as fem's can")
        if needs.softens:
            return Step(*self._softening())
        if self.kind == "proof":
            return self._enough("nothing slides on a closed joint, so dilatancy is of no account")
        if needs.weightless:
            model, why = self._history()
            return Step(model, f"no wall stands above it; without weight certified intervals are wide: {why}")
        certificate = self.estimate("limit-nonassociated")
        model, why = self._history()
        history = self.estimate(model)
        if certificate.seconds > WORTH * history.seconds:
            dear = f"certificates, {certificate}, cost more than {WORTH:g} times {model}"
            return Step(model, f"no wall stands above it; {dear}: {why}")
        if outcome.status == "unbounded":
            return Step("limit-nonassociated", "it locks if sliding joints dilate; true friction does not")
        return Step("limit-nonassociated", "no wall stands above it; true friction may give way before")

    def _after_certificates(self, outcome: Outcome) -> Step:
        if outcome.status == "unbounded":
            return Step(None, "it locks even without friction")
        if outcome.status == "collapse" and outcome.lower is not None and outcome.upper is not None:
            if self.bound is not None and self.bound - outcome.lower <= self.tolerance * self.bound:
                self.answer = replace(outcome, upper=max(outcome.upper, self.bound))
                return self._enough("from the lowest certified load to the bound it is less than the tolerance")
            if outcome.upper - outcome.lower <= self.tolerance * outcome.upper:
                return self._enough("the loads certified lie within the tolerance")
        model, why = self._history()
        if outcome.status == "collapse":
            return Step(model, f"λ depends on how the load came about, by more than the tolerance: {why}")
        return Step(model, f"no collapse was certified: {why}")

    def _enough(self, why: str) -> Step:
        """What was found suffices, unless the wall sways so far before that its geometry is another."""
        way = None if self.answer is None else sway(self.scene, self.answer)
        if self.finite:
            return Step(self._follower(), f"{why}; finite displacements are asked for")
        if way is None:
            return Step(None, f"{why}; displacements are taken to be small")
        if way > self.tolerance:
            return Step(self._follower(), f"{why}; but it sways by {way:.2g} block sizes, which is not small")
        return Step(None, f"{why}; it sways by {way:.1g} block sizes until then, which is small")

    def _follower(self) -> Finite:
        return "fem, finite" if self._soft() else "dem-dynamic, finite"

    def _way(self) -> float:
        """How far a wall is to be followed at finite displacements, in block sizes."""
        way = None if self.answer is None else sway(self.scene, self.answer)
        return max(way or 0.0, self.tolerance)

    def _after_history(self, outcome: Outcome) -> Step:
        onward = PATHS[PATHS.index(outcome.model) + 1 :]
        if outcome.status in ("undecided", "failed") and onward and "interrupted" not in outcome.message:
            return Step(onward[0], f"{outcome.status}: {outcome.message}")
        if outcome.status != "collapse":
            return Step(None, f"{outcome.status}: {outcome.message}")
        needs = self.needs
        if needs.softens and self._soft() and outcome.model == "dem-dynamic":
            return Step("fem", f"the history is bracketed for rigid blocks; {self._pliant()}")
        stiff = "" if outcome.model == "fem" else f"; {self._pliant()}"
        return self._enough(f"the history's collapse is bracketed{stiff}")

    def _history(self) -> tuple[str, str]:
        """The model that is to follow the wall, and why that one."""
        if self._soft():
            return "fem", self._pliant()
        costs = {model: self.estimate(model).seconds for model in ("dem-static", "dem-dynamic")}
        model = min(costs, key=lambda name: costs[name])
        return model, "one history is followed, by the cheaper of two models of rigid blocks"

    def _softening(self) -> tuple[str, str]:
        why = "no wall stands above it; joints soften, and certificates and dem-static know no fracture energies"
        return "dem-dynamic", why

    def _soft(self) -> bool:
        return self.needs.pliancy > self.tolerance

    def _pliant(self) -> str:
        share = f"blocks have {100 * self.needs.pliancy:.2g} % of the give"
        return f"{share}, and must deform" if self._soft() else f"{share}, and lose their deformable modes"

    # --- what the answer means -----------------------------------------------------------------------------------

    def _meaning(self) -> str:
        if self.kind == "":
            return self.rungs[-1].reason
        above = "" if self.bound is None else f"; above {number(self.bound)} nothing stands"
        if self.kind == "proof":
            return "forces and a mechanism prove it, whether or not sliding joints dilate"
        if self.kind == "finite":
            small = "" if self.bound is None else f"; at small displacements nothing stands above {number(self.bound)}"
            return f"{self.answer.message if self.answer else ''}{small}"
        if self.rungs[-1].model in FINITE:
            above += "; at small displacements, though they are not small"
        if self.kind == "certificate":
            return f"collapse is certified from the lower load on; smaller ones are not excluded{above}"
        lowest = self.lowest
        below = "" if lowest is None else f"; others may end from {number(lowest)} on, or lower"
        return f"largest load at rest and smallest of a fall in one history, loads raised slowly{below}{above}"


def _seconds(outcome: Outcome | None) -> float:
    return 0.0 if outcome is None else outcome.seconds


def advise(scene: Scene, tolerance: float = TOLERANCE, *, finite: bool = False) -> Advice:
    """Climb the ladder as far as a scene needs.

    Parameters
    ----------
    scene
        The scene.
    tolerance
        Relative width of the bracket asked for.
    finite
        Whether finite displacements are asked for, however small they may be.
    """
    advice = Advice(scene, tolerance, finite)
    for _ in advice.climb():
        pass
    return advice
