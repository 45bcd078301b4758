"""Choice of the next model and the reason for it, from the knowledge so far; one function per kind of model."""

from dataclasses import dataclass

from runningbond.models import Model
from runningbond.results import Outcome

from .knowledge import Knowledge, deforms, ladder

DRAWS = 3  # number of histories, of walls that differ in their last bits, if certified loads do not settle the answer
ROLLS = "pressed along their length, joints roll onto their edges"


@dataclass(frozen=True)
class Step:
    """The next step and the reason for it: a model to run, at finite or small displacements, or None to stop."""

    model: Model | None
    reason: str
    finite: bool = False
    draws: int = 1  # number of runs, on walls that differ in their last bits

    @property
    def name(self) -> str | None:
        """Name of the step: that of its model, marked if displacements are finite; None if no model follows."""
        return None if self.model is None else self.model.name + (", finite" if self.finite else "")


def next_step(known: Knowledge, step: Step, outcome: Outcome) -> Step:
    """Step that follows from an outcome that `Knowledge.learn` has already added."""
    assert step.model is not None
    if step.model.kind == "estimate":
        return Step(ladder("bound")[0], "an estimate for the wall as a continuum, on either side; a bound is wanted")
    if outcome.status == "infeasible":
        return Step(None, "it collapses under its dead load, whatever the model")
    if step.model.kind == "bound":
        return _after_bound(known, outcome)
    if step.model.kind == "certificate":
        return _after_certificate(known, outcome)
    if step.finite and outcome.status != "collapse":
        return Step(None, f"{outcome.status}: {outcome.message}")
    if step.finite:
        return Step(None, "the wall was followed past its peak at finite displacements")
    return _after_history(known, step, step.model, outcome)


def after_refusal(known: Knowledge, step: Step, refusal: str) -> Step:
    """Step that follows if a model does not apply to the scene."""
    assert step.model is not None
    if step.model.kind == "estimate":
        reason = refusal.removeprefix(f"model {step.model.name}: ")
        return Step(ladder("bound")[0], f"{reason}; a bound is wanted")
    histories = known.histories
    onward = histories[histories.index(step.model) + 1 :] if step.model in histories and not step.finite else []
    if onward and (known.soft or not deforms(onward[0])):
        return Step(onward[0], refusal, draws=1 if deforms(onward[0]) else step.draws)
    if step.model.kind == "history" and not step.finite and known.evidence == "certificate":
        return _enough(known, f"{refusal}; no history was followed, and the certified loads stay")
    stays = step.finite and known.on_edges is None
    rest = "the answer at small displacements stays" if stays else "no other model answers"
    return Step(None, f"{refusal}; {rest}")


def _after_bound(known: Knowledge, outcome: Outcome) -> Step:
    histories = known.histories
    bound = "no wall stands above it" if outcome.status == "collapse" else outcome.status
    if known.cracks:
        model = next(model for model in histories if "cracks" in model.parameters)
        return Step(model, f"{bound}; blocks may crack elsewhere than on their axes, as only {model.name} models it")
    if known.weakens:
        softening = [model for model in histories if "joint.fracture_energy_1" in model.reads]
        others = [model.name for model in (*ladder("certificate"), *ladder("history")) if model not in softening]
        reason = f"joints soften, which {' and '.join(others)} do not take into account"
        return Step(softening[0], f"{bound}; {reason}")
    if known.evidence == "proof":
        if known.bound == 0.0:
            return _enough(known, "it carries none of the live load")
        stack = "forces in joints follow from balance alone, and nothing slides with friction on a closed joint"
        why = "no joint has friction" if known.frictionless else stack
        return _enough(known, f"{why}: dilatancy has no influence")
    model, why = _history(known)
    if known.crushes:
        return Step(model, f"{bound}; joints crush, which certificates do not include: {why}")
    if not any(known.scene.load.gravity):
        return Step(model, f"{bound}; without weight certified intervals are wide: {why}")
    return Step(ladder("certificate")[0], f"{bound}; true friction does not dilate, and collapse may come earlier")


def _after_certificate(known: Knowledge, outcome: Outcome) -> Step:
    if outcome.status == "unbounded":
        return Step(None, outcome.message)
    if known.narrow:  # rigid blocks suffice: certificates do not include stiffness
        why = "the certified loads lie within the tolerance, but a better search may find lower ones"
        return Step(_cheapest_rigid(known), f"{why}: one history is followed to see")
    model, why = _history(known)
    draws = 1 if deforms(model) else DRAWS  # deformable blocks cost most
    if outcome.status != "collapse" or outcome.lower is None or outcome.upper is None:
        return Step(model, f"no collapse was certified: {why}", draws=draws)
    return Step(model, f"λ depends on how the load came about, by more than the tolerance: {why}", draws=draws)


def _after_history(known: Knowledge, step: Step, model: Model, outcome: Outcome) -> Step:
    if known.evidence == "certificate":
        agrees = f"the history is {outcome.status}, and the certified loads stay: {outcome.message}"
        return _enough(known, "a history agrees with them" if outcome.status == "collapse" else agrees)
    histories = known.histories
    onward = histories[histories.index(model) + 1 :]
    if outcome.status in ("undecided", "failed") and onward and (known.soft or not deforms(onward[0])):
        return Step(onward[0], f"{outcome.status}: {outcome.message}")
    if outcome.status != "collapse":
        return Step(None, f"{outcome.status}: {outcome.message}")
    if known.soft and not deforms(model):
        model, why = _history(known)
        return Step(model, f"the collapse of rigid blocks is bracketed; {why}")
    rigid = "" if deforms(model) else f"; {_compliance(known)}"
    if known.contradicted and step.draws == 1 and not deforms(model):
        model, why = _history(known)
        return Step(model, f"the history ends beside the certified loads: {why}", draws=DRAWS)
    histories_told = "one history" if known.draws == 1 else f"{known.draws} histories"
    return _enough(known, f"the collapse of {histories_told} is bracketed{rigid}")


def _history(known: Knowledge) -> tuple[Model, str]:
    """Model that is to follow the loading path, and the reason for its choice."""
    if known.soft:
        return next(model for model in known.histories if deforms(model)), _compliance(known)
    return _cheapest_rigid(known), "it is followed by the cheapest model of rigid blocks"


def _cheapest_rigid(known: Knowledge) -> Model:
    rigid = [model for model in known.histories if not deforms(model)]
    return min(rigid, key=lambda model: known.estimate(model).seconds)


def _compliance(known: Knowledge) -> str:
    what = "must deform" if known.soft else "are taken as rigid"
    return f"blocks have {100 * known.compliance:.2g} % of the compliance, and {what}"


def _enough(known: Knowledge, why: str) -> Step:
    """Stop with the answer so far, unless displacements before collapse are too large for the initial geometry."""
    far = [model for model in known.histories if "displacements" in model.parameters]
    finite = next(model for model in far if deforms(model) == known.soft)
    if known.finite:
        return Step(finite, f"{why}; finite displacements are requested", finite=True)
    leans = known.on_edges
    if leans is not None:
        model = next(model for model in far if deforms(model) == known.soft_on_edges(leans))
        return Step(model, f"{why}; but {ROLLS}: {leans}", finite=True)
    moved = known.displacement
    if moved is None:
        return Step(None, f"{why}; displacements are taken to be small")
    if moved > known.tolerance:
        return Step(finite, f"{why}; but it moves by {moved:.2g} block sizes before, which is not small", finite=True)
    return Step(None, f"{why}; it moves by {moved:.1g} block sizes until then, which is small")
