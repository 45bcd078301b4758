"""``runningbond advise``: one line per rung, then the answer; or one JSON object."""

import json as to_json
import sys
from dataclasses import replace
from typing import Any

from runningbond.compare.advice import TOLERANCE, Advice, AdviceRung
from runningbond.compare.advice.knowledge import Knowledge
from runningbond.compare.published import find_scene
from runningbond.models import check_tolerance
from runningbond.results import Outcome
from runningbond.scene import read_scene

from .terminal import DONE, NO_ANSWER, STOPPED, UNDECIDED, Flag, Json, SceneName, Tolerance, interruptions, remarks


def advise(
    scene: SceneName,
    /,
    *,
    tolerance: Tolerance = TOLERANCE,
    finite: Flag = False,
    json: Json = False,
) -> int:
    """Find the collapse load with the cheapest models that a scene needs, and say why each was or was not run.

    Parameters
    ----------
    finite
        Follow the wall at finite displacements in the end, even if displacements are small.
    """
    check_tolerance(tolerance, "--tolerance")
    advice = Advice(Knowledge(read_scene(find_scene(scene)), tolerance, finite))
    for line in remarks(advice.known.scene):
        print(line, file=sys.stderr)
    if not json:
        print(advice.title, flush=True)
    stopped: list[int] = []
    for rung in advice.climb():
        if not json:
            print(rung, flush=True)
        if stopped:
            break
        if rung.next.model is not None:
            stopped = interruptions(rung.next.model)
    outcome = advice.outcome()
    if stopped:
        before = f" before {rung.next.name}" if rung.next.name else ""
        outcome = replace(outcome, message=f"interrupted{before}: {outcome.message}")
    print(_as_json(advice, outcome) if json else advice.in_words(outcome), flush=True)
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


def _as_json(advice: Advice, outcome: Outcome) -> str:
    """The answer and its rungs as one JSON object."""
    answer = {key: value for key, value in outcome.summary().items() if key not in ("dofs", "steps")}
    error, _ = advice.against_experiment()
    measured = {"model_error": None if error is None else error.as_json()}
    bounds = {"lowest": advice.lowest, "bound": advice.known.bound}
    return to_json.dumps(
        {**answer, **bounds, **measured, "rungs": [_rung_json(rung) for rung in advice.rungs]}, allow_nan=False
    )


def _rung_json(rung: AdviceRung) -> dict[str, Any]:
    keys = ("status", "multiplier", "lower", "upper", "dofs", "steps")
    next_seconds = None if rung.next_cost is None else rung.next_cost.seconds
    said = {"seconds": rung.seconds, "reason": rung.next.reason, "next": rung.next.name, "next_seconds": next_seconds}
    return {"model": rung.model, **{key: getattr(rung.outcome, key, None) for key in keys}, **said}
