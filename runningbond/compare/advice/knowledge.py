"""What a scene requires of a model, what the models run so far have found, and the evidence behind the answer."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

import numpy as np

from runningbond.dynamics.collapse import BENDS_AT_POINTS
from runningbond.joints import crushes_by_law, loses_strength, wall_cones
from runningbond.joints.stiffness import block_compliance
from runningbond.limit import elastic_displacement, hanging_displacement
from runningbond.limit.kinematics import sliding_dilates
from runningbond.models import MODELS, Kind, Model
from runningbond.models.beds import Leaning, on_beds
from runningbond.models.costs import Estimate, cracks_anywhere, estimate, pace
from runningbond.models.edges import leaning
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene, SceneError

Evidence: TypeAlias = Literal["", "proof", "certificate", "history", "finite"]  # evidence for a bracket; empty if none


def ladder(kind: Kind) -> list[Model]:
    """Models of a kind that have a cost law, in the order of the registry, about from cheap to expensive."""
    return [model for model in MODELS.values() if model.kind == kind and model.cost is not None]


def _refuse(scene: Scene) -> None:
    """Refuse loads for which the bounds and certificates of the ladder do not hold, or hold with opposite sense."""
    if scene.settlement:
        remedy = (
            "is not advised on: λ is the share that the support carries; "
            "take runningbond run SCENE --model limit-nonassociated"
        )
        raise SceneError("load.live settlement", remedy)
    if scene.history is not None:
        remedy = "is not advised on; take runningbond run or respond with dem-dynamic, or fem where blocks are soft"
        raise SceneError("load.history", remedy)


def deforms(model: Model) -> bool:
    """Whether the blocks of a model deform."""
    return "block.young" in model.reads


@dataclass
class Knowledge:
    """The request for a scene, and what the models run so far have found."""

    scene: Scene
    tolerance: float  # requested relative width of the bracket
    finite: bool = False  # whether finite displacements are requested, even if displacements are small
    outcomes: list[Outcome] = field(default_factory=list)
    drawn: list[int] = field(default_factory=list)  # number of draws in each of the outcomes
    bound: float | None = None  # associated limit load: an upper bound at small displacements
    evidence: Evidence = ""  # kind of evidence for the answer
    answer: Outcome | None = None  # outcome with the bracket of the answer
    followed: Outcome | None = None  # the last history that collapsed at small displacements
    lowest: float | None = None  # smallest collapse load by a proof, a certificate or a history
    draws: int = 0  # number of histories that the last model followed up to collapse
    others: list[Outcome] = field(default_factory=list)  # histories of the last model that did not end in a collapse
    rested: dict[float, Leaning | None] = field(default_factory=dict)  # whether it rests on beds under some loads
    contradicted: bool = False  # whether a history and narrow certified loads together span more than the tolerance

    def __post_init__(self) -> None:
        self.compliance = block_compliance(self.scene)
        self.cracks = cracks_anywhere(self.scene)
        materials = self.scene.materials_of_joints
        self.frictionless = not wall_cones(self.scene, np.arange(len(self.scene.joints)))[0].any()
        weakening = [each for each in materials if loses_strength(each)]
        self.weakens, self.bonds_break = bool(weakening), any(each.is_bonded for each in weakening)
        self.crushes_by_law = any(map(crushes_by_law, materials))
        self.crushes = self.crushes_by_law or any(each.compressive_strength is not None for each in materials)
        self.gives_way = any(each.compressive_fracture_energy is not None for each in materials)
        self.closes = any(each.closure is not None for each in materials)
        _refuse(self.scene)

    def learn(self, model: Model, outcome: Outcome, *, finite: bool = False, draws: Sequence[Outcome] = ()) -> None:
        """Add the outcome of a model, at `finite` or small displacements, or the combined outcome of its `draws`."""
        self.outcomes.append(outcome)
        self.drawn.append(max(1, len(draws)))
        if outcome.status == "unbounded" and model.kind == "history" and self.answer and self.evidence == "certificate":
            # Collapse is certified for some joint forces, but the load alone did not lead to such forces.
            self.answer = replace(self.answer, status="undecided", multiplier=None, upper=None)
        if outcome.status != "collapse" or outcome.lower is None or outcome.upper is None:
            return
        if model.kind == "bound":
            self.bound = outcome.upper
            weakens = self.weakens or self.gives_way or self.crushes_by_law or self.cracks
            # The wall is in equilibrium without live load, and collapses under any live load.
            nothing = outcome.upper <= 0
            if not weakens and (nothing or self.frictionless or self._is_only_load(outcome)):
                self._answer("proof", outcome, outcome.lower)
        elif model.kind == "certificate":
            certified = outcome
            if self.bound is not None and self.bound - outcome.lower <= self.tolerance * self.bound:
                certified = replace(outcome, upper=max(outcome.upper, self.bound))
            self._answer("certificate", certified, outcome.lower)
        elif finite:
            self._answer("finite", outcome, outcome.upper)
        else:
            # If paths with several load steps were followed, `upper` is the highest of their collapse loads.
            falls = [each.upper if each.fall is None else each.fall for each in draws or (outcome,) if each.upper]
            self.draws, self.followed = max(1, len(falls)), outcome
            self.others = [each for each in draws if each.status != "collapse"]
            self._follow(outcome, min(falls, default=outcome.upper))

    def _is_only_load(self, bound: Outcome) -> bool:
        """Whether a collapse without sliding, which needs no dilatancy, excludes collapses at smaller loads."""
        return self.scene.is_determinate and not sliding_dilates(self.scene, bound.motion)

    @property
    def histories(self) -> list[Model]:
        """Models that follow the loading path, with crushing and closure if joints have them, in `ladder` order."""
        known = {"joint.compressive_strength": self.crushes, "joint.closure": self.closes}
        wanted = {key for key, is_wanted in known.items() if is_wanted}
        return [model for model in ladder("history") if wanted <= model.reads]

    def _follow(self, outcome: Outcome, fall: float) -> None:
        """Add the bracket of histories with lowest collapse load `fall`; certified loads that agree with it stay."""
        assert outcome.lower is not None
        assert outcome.upper is not None
        history, reached = outcome, fall
        if self.bound is not None and outcome.multiplier is not None:  # higher loads are an error of the history
            upper = max(outcome.lower, min(outcome.upper, self.bound))
            history = replace(outcome, upper=upper, multiplier=min(outcome.multiplier, upper))
            fall = min(fall, self.bound)
        if self._is_above(outcome):
            self.contradicted = self.narrow
        elif self.narrow and self.answer is not None and self.answer.lower is not None:
            # The bound may lie below certified loads by rounding, and a fall that is cut to it with it.
            lower = self.answer.lower if reached >= self.answer.lower else outcome.lower
            upper = max(self.answer.upper or 0.0, history.upper or 0.0)
            wider = replace(self.answer, lower=min(lower, self.answer.lower), upper=upper)
            self.contradicted = not _within(wider, self.tolerance)
            if not self.contradicted:
                self._answer("certificate", wider, fall)
                return
        self._answer("history", history, fall)

    def _is_above(self, history: Outcome) -> bool:
        """Whether a history ends above the certified loads by more than the tolerance, if there is no upper bound."""
        upper = None if self.answer is None else self.answer.upper
        return self.bound is None and upper is not None and (history.lower or 0.0) > upper * (1 + self.tolerance)

    @property
    def narrow(self) -> bool:
        """Whether the answer is an interval of certified loads within the tolerance."""
        return self.evidence == "certificate" and self.answer is not None and _within(self.answer, self.tolerance)

    def _answer(self, evidence: Evidence, outcome: Outcome, collapse: float) -> None:
        self.evidence, self.answer = evidence, outcome
        self.lowest = collapse if self.lowest is None else min(self.lowest, collapse)

    @property
    def seconds(self) -> float:
        """Total seconds of the models run so far."""
        return sum(outcome.seconds for outcome in self.outcomes)

    @property
    def soft(self) -> bool:
        """Whether the blocks are so compliant that a model must include their deformation."""
        return self.compliance > self.tolerance

    @property
    def displacement(self) -> float | None:
        """Displacement [block sizes] under the live load up to collapse, from the curve, or elastic and from ties.

        Certified loads have no curve: it is that of the history that agrees with them, if one was followed.
        """
        if self.answer is None or self.answer.lower is None:
            return None
        path = self.answer if len(self.answer.curve) else self.followed
        if path is None or path.lower is None or not len(path.curve):
            moved = elastic_displacement(self.scene, self.answer.lower)
            return None if moved is None else (moved + hanging_displacement(self.scene)) / self.scene.block_size
        displacement, multiplier = path.curve.T
        last = int(np.argmin(np.abs(multiplier - path.lower)))
        return float(abs(displacement[last] - displacement[0]) / self.scene.block_size)

    @property
    def on_edges(self) -> Leaning | None:
        """How the wall rolls onto the edges of its joints, if it then bears less than the answer by the tolerance.

        Either those of the mechanism do, or the wall does not rest on beds of springs that bend everywhere.
        Bonds that break do so before they roll. Forces and mechanism are those of a history if one was followed: of
        certified ones there are many, and loading leads to few of them.
        """
        if self.answer is None or self.evidence == "finite" or self.bonds_break:
            return None
        for each in filter(None, (self.followed, self.answer)):
            leans = leaning(self.scene, each)
            if leans is None:
                continue
            if leans.load < (1 - self.tolerance) * (each.lower or 0.0):  # what is lost of its own load
                return leans
            break
        least = (1 - self.tolerance) * (self.answer.lower or 0.0)
        if least not in self.rested:
            self.rested[least] = on_beds(self.scene, least)
        return self.rested[least]

    def soft_on_edges(self, leans: Leaning) -> bool:
        """Whether blocks must deform in a wall that rolls: its loss grows with the cube root of the compliance."""
        least = 0.0 if self.answer is None else self.answer.lower or 0.0
        stiffer = np.cbrt(1 - self.compliance)
        return bool((least - leans.load) * (1 - stiffer) > self.tolerance * least * stiffer)

    def estimate(self, model: Model, draws: int = 1) -> Estimate:
        """Expected cost of a model for some draws, at the pace of the models run so far."""
        at = pace(self.scene, self.tolerance, self.outcomes, self.drawn)
        return estimate(model, self.scene, self.tolerance, at, advised=True, draws=draws)

    @property
    def above(self) -> str:
        """What the upper bound says, as the end of a sentence; empty without one."""
        return "" if self.bound is None else f"; above {number(self.bound)} nothing stands"

    def meaning(self) -> str:
        """Meaning of the bracket of the answer, in words; empty if there is no answer."""
        if self.answer is None:
            return ""
        anywhere = self.cracks and self.evidence != "finite"
        where = "between their triangles, and on a finer mesh perhaps earlier" if anywhere else "on their axes"
        return self._meaning(self.answer) + (f"; blocks crack only {where}" if self.scene.inner_joint else "")

    def _meaning(self, answer: Outcome) -> str:
        """Meaning of the bracket of an answer, in words."""
        if self.evidence == "proof":
            return "forces and a mechanism prove it, whether or not sliding joints dilate"
        least, others = self.lowest, ""
        if least is not None and least < (answer.lower or 0.0):
            others = f"; others may end from {number(least)} on, or lower"
        if self.evidence == "finite":
            small = others + self.above
            return answer.message + (small and f"{small} at small displacements")
        if self.evidence == "certificate":
            seen = ", and a history agrees" if self.draws else ""
            if answer.upper is None:
                seen = ", but a history locks: it takes other forces in joints than the load alone brings about"
            return f"{self._certified(answer)}{seen}; smaller ones are not excluded{self.above}"
        told = "one history" if self.draws == 1 else f"{self.draws} histories that differ in their last bits"
        below = others or ("" if least is None else "; others may end lower")
        below += "".join(f"; one more is {each.status}: {each.message}" for each in self.others)
        if self.draws == 1 and answer.fall is not None:
            told = "the lowest and the highest of its paths in load steps of several lengths"
        wide = "" if _within(answer, self.tolerance) else ", which lie further apart than the tolerance"
        above = self.above
        if self.followed is not None and BENDS_AT_POINTS in self.followed.message:
            above += f"; joints that crush {BENDS_AT_POINTS}"
        if self.scene.is_led:
            return f"largest reaction of the drive along its path in {told}{wide}{below}{above}"
        return f"largest load at rest and smallest at collapse in {told}{wide}, loads raised slowly{below}{above}"

    def _certified(self, answer: Outcome) -> str:
        """Describe the certified part of the answer, before the bound or a history has widened its bracket."""
        own = next(each for each in reversed(self.outcomes) if each.model == answer.model)
        if (own.lower, own.upper) == (answer.lower, answer.upper):
            return "loads at which collapse is certified"
        first, last = (number(end or 0.0) for end in (own.lower, own.upper))
        return f"collapse is certified {f'at {first}' if first == last else f'from {first} to {last}'}"


def _within(outcome: Outcome, tolerance: float) -> bool:
    """Whether the relative width of a bracket is at most the tolerance."""
    lower, upper = outcome.lower, outcome.upper
    return lower is not None and upper is not None and upper - lower <= tolerance * upper
