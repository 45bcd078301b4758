"""Which model comes next, and why: from what is known so far to a step, one function a kind of model."""

from dataclasses import dataclass

from runningbond.compare.model import Model
from runningbond.results import Outcome

from .knowledge import Knowledge, deforms, ladder

WORTH = 1.25  # times the cost of one history that a certificate, which holds for all of them, is worth: a choice


@dataclass(frozen=True)
class Step:
    """What to do next, and why: run a model, at finite displacements or small ones; or nothing, None."""

    model: Model | None
    reason: str
    finite: bool = False

    @property
    def name(self) -> str | None:
        """What the step is called."""
        return None if self.model is None else self.model.name + (", finite" if self.finite else "")


def next_step(known: Knowledge, step: Step, outcome: Outcome) -> Step:
    """What follows from an outcome that is already part of what is known."""
    assert step.model is not None
    if step.model.kind == "estimate":
        return Step(ladder("bound")[0], "an estimate for the wall as a continuum, on either side; a bound is wanted")
    if outcome.status == "infeasible":
        return Step(None, "it collapses under its dead load, whatever the model")
    if step.model.kind == "bound":
        return _after_bound(known, outcome)
    if step.model.kind == "certificate":
        return _after_certificate(known, outcome)
    if step.finite:
        return Step(None, "the wall was followed past its peak at finite displacements")
    return _after_history(known, step.model, outcome)


def after_refusal(step: Step, refusal: str) -> Step:
    """What follows where a model does not apply to the scene."""
    assert step.model is not None
    if step.model.kind == "estimate":
        reason = refusal.removeprefix(f"model {step.model.name}: ")
        return Step(ladder("bound")[0], f"{reason}; a bound is wanted")
    rest = "the answer at small displacements stays" if step.finite else "no other model answers"
    return Step(None, f"{refusal}; {rest}")


def _after_bound(known: Knowledge, outcome: Outcome) -> Step:
    histories = ladder("history")
    bound = "no wall stands above it" if outcome.status == "collapse" else outcome.status
    if known.cracks:
        model = next(model for model in histories if "cracks" in model.parameters)
        return Step(model, f"{bound}; blocks may crack elsewhere than on their axes, and do in {model.name} alone")
    if known.softens:
        softening = [model for model in histories if "joint.fracture_energy_1" in model.reads]
        others = [model.name for model in (*ladder("certificate"), *histories) if model not in softening]
        reason = f"joints soften, which {' and '.join(others)} do not take into account"
        return Step(softening[0], f"{bound}; {reason}")
    if known.evidence == "proof":
        return _enough(known, "nothing slides on a closed joint, so dilatancy has no influence")
    model, why = _history(known)
    if not any(known.scene.load.gravity):
        return Step(model, f"{bound}; without weight certified intervals are wide: {why}")
    certificate = ladder("certificate")[0]
    cost = known.estimate(certificate)
    if cost.seconds > WORTH * known.estimate(model).seconds:
        return Step(model, f"{bound}; certificates, {cost}, cost more than {WORTH:g} times {model.name}: {why}")
    return Step(certificate, f"{bound}; true friction does not dilate, and collapse may come earlier")


def _after_certificate(known: Knowledge, outcome: Outcome) -> Step:
    if outcome.status == "unbounded":
        return Step(None, "it is self-locking even where friction does not dilate")
    model, why = _history(known)
    if outcome.status != "collapse" or outcome.lower is None or outcome.upper is None:
        return Step(model, f"no collapse was certified: {why}")
    if known.bound is not None and known.bound - outcome.lower <= known.tolerance * known.bound:
        return _enough(known, "from the lowest certified load to the bound it is less than the tolerance")
    if outcome.upper - outcome.lower <= known.tolerance * outcome.upper:
        return _enough(known, "the certified loads lie within the tolerance")
    return Step(model, f"λ depends on how the load came about, by more than the tolerance: {why}")


def _after_history(known: Knowledge, model: Model, outcome: Outcome) -> Step:
    histories = ladder("history")
    onward = histories[histories.index(model) + 1 :]
    if outcome.status in ("undecided", "failed") and onward and (known.soft or not deforms(onward[0])):
        return Step(onward[0], f"{outcome.status}: {outcome.message}")
    if outcome.status != "collapse":
        return Step(None, f"{outcome.status}: {outcome.message}")
    if known.soft and not deforms(model):
        model, why = _history(known)
        return Step(model, f"the collapse of rigid blocks is bracketed; {why}")
    rigid = "" if deforms(model) else f"; {_compliance(known)}"
    return _enough(known, f"the collapse of one history is bracketed{rigid}")


def _history(known: Knowledge) -> tuple[Model, str]:
    """The model that is to follow the wall, and why that one."""
    if known.soft:
        return next(model for model in ladder("history") if deforms(model)), _compliance(known)
    rigid = [model for model in ladder("history") if not deforms(model)]
    model = min(rigid, key=lambda model: known.estimate(model).seconds)
    return model, f"one history is followed, by the cheapest of {len(rigid)} models of rigid blocks"


def _compliance(known: Knowledge) -> str:
    what = "must deform" if known.soft else "are taken as rigid"
    return f"blocks have {100 * known.compliance:.2g} % of the compliance, and {what}"


def _enough(known: Knowledge, why: str) -> Step:
    """The answer so far suffices, unless the wall moves so far before that its geometry is another."""
    finite = next(model for model in ladder("history") if model.pushover and deforms(model) == known.soft)
    if known.finite:
        return Step(finite, f"{why}; finite displacements are asked for", finite=True)
    moved = known.displacement
    if moved is None:
        return Step(None, f"{why}; displacements are taken to be small")
    if moved > known.tolerance:
        return Step(finite, f"{why}; but it moves by {moved:.2g} block sizes before, which is not small", finite=True)
    return Step(None, f"{why}; it moves by {moved:.1g} block sizes until then, which is small")
