"""Which model comes next, and why: from what is known so far to a step, one function a rung."""

from dataclasses import dataclass

from runningbond.results import Outcome

from .finite import FINITE
from .knowledge import Knowledge

WORTH = 1.25
"""How many times the cost of following one history a certificate, which holds for all of them, is worth: a choice."""

PATHS = ("dem-static", "dem-dynamic", "fem")
"""Models that follow the wall to its fall at small displacements, each after what it can do more than the last."""


@dataclass(frozen=True)
class Step:
    """The next model, None where what there is suffices or nothing answers, and why."""

    model: str | None
    reason: str


def next_rung(known: Knowledge, model: str, outcome: Outcome) -> Step:
    """What follows from an outcome of a model that is already part of what is known."""
    if model == "homog":
        return Step("limit", "an estimate for the wall as a continuum, on either side; a bound is wanted")
    if outcome.status == "infeasible":
        return Step(None, "it falls under its dead load, whatever the model")
    if model == "limit":
        return _after_limit(known, outcome)
    if model == "limit-nonassociated":
        return _after_certificates(known, outcome)
    return _after_history(known, outcome)


def after_refusal(model: str, refusal: str) -> Step:
    """What follows where a model says nothing of such a scene."""
    if model == "homog":
        return Step("limit", f"{refusal.removeprefix('model homog: ')}; a bound is wanted")
    rest = "the answer at small displacements stays" if model in FINITE else "no other model answers"
    return Step(None, f"{refusal}; {rest}")


def _after_limit(known: Knowledge, outcome: Outcome) -> Step:
    needs = known.needs
    bound = "no wall stands above it" if outcome.status == "collapse" else outcome.status
    if needs.cracks:
        return Step("fem", f"{bound}; blocks may crack elsewhere than on their axes, and do in fem alone")
    if needs.softens:
        return Step("dem-dynamic", f"{bound}; joints soften, and certificates and dem-static know no fracture energies")
    if known.kind == "proof":
        return _enough(known, "nothing slides on a closed joint, so dilatancy is of no account")
    model, why = _history(known)
    if needs.weightless:
        return Step(model, f"{bound}; without weight certified intervals are wide: {why}")
    certificate, history = known.estimate("limit-nonassociated"), known.estimate(model)
    if certificate.seconds > WORTH * history.seconds:
        return Step(model, f"{bound}; certificates, {certificate}, cost more than {WORTH:g} times {model}: {why}")
    return Step("limit-nonassociated", f"{bound}; true friction does not dilate, and may give way before")


def _after_certificates(known: Knowledge, outcome: Outcome) -> Step:
    if outcome.status == "unbounded":
        return Step(None, "it locks even without friction")
    model, why = _history(known)
    if outcome.status != "collapse" or outcome.lower is None or outcome.upper is None:
        return Step(model, f"no collapse was certified: {why}")
    if known.bound is not None and known.bound - outcome.lower <= known.tolerance * known.bound:
        return _enough(known, "from the lowest certified load to the bound it is less than the tolerance")
    if outcome.upper - outcome.lower <= known.tolerance * outcome.upper:
        return _enough(known, "the certified loads lie within the tolerance")
    return Step(model, f"λ depends on how the load came about, by more than the tolerance: {why}")


def _after_history(known: Knowledge, outcome: Outcome) -> Step:
    if outcome.model in FINITE:
        return Step(None, "the wall was followed past its peak at finite displacements")
    onward = PATHS[PATHS.index(outcome.model) + 1 :]
    if outcome.status in ("undecided", "failed") and onward and (onward[0] != "fem" or known.soft):
        return Step(onward[0], f"{outcome.status}: {outcome.message}")
    if outcome.status != "collapse":
        return Step(None, f"{outcome.status}: {outcome.message}")
    if outcome.model == "fem":
        return _enough(known, "the fall of one history is bracketed")
    if known.soft:
        return Step("fem", f"the fall of rigid blocks is bracketed; {_give(known)}")
    return _enough(known, f"the fall of one history is bracketed; {_give(known)}")


def _history(known: Knowledge) -> tuple[str, str]:
    """The model that is to follow the wall, and why that one."""
    if known.soft:
        return "fem", _give(known)
    model = min(("dem-static", "dem-dynamic"), key=lambda name: known.estimate(name).seconds)
    return model, "one history is followed, by the cheaper of two models of rigid blocks"


def _give(known: Knowledge) -> str:
    share = f"blocks have {100 * known.needs.pliancy:.2g} % of the give"
    return f"{share}, and must deform" if known.soft else f"{share}, and lose their deformable modes"


def _enough(known: Knowledge, why: str) -> Step:
    """What was found suffices, unless the wall sways so far before that its geometry is another."""
    follower, way = "fem, finite" if known.soft else "dem-dynamic, finite", known.way
    if known.finite:
        return Step(follower, f"{why}; finite displacements are asked for")
    if way is None:
        return Step(None, f"{why}; displacements are taken to be small")
    if way > known.tolerance:
        return Step(follower, f"{why}; but it sways by {way:.2g} block sizes, which is not small")
    return Step(None, f"{why}; it sways by {way:.1g} block sizes until then, which is small")
