"""An advice as it is printed: a line a rung, then the answer; or one JSON object."""

import json
from typing import Any

from runningbond.compare.table import bracket

from .climb import Advice, Rung


def rung_line(rung: Rung) -> str:
    """What a rung found, the cost so far, what follows from it, and the next rung with its cost."""
    result = "–"
    if rung.outcome is not None:
        result = bracket(rung.outcome) if rung.outcome.status == "collapse" else rung.outcome.status
    line = f"{rung.model:20} {result:19} {rung.seconds:7.2f} s  {rung.reason}"
    if rung.onward is None:
        return line
    return f"{line} → {rung.onward}, {rung.next_cost or 'at a cost that no law gives'}"


def answer_lines(advice: Advice) -> str:
    """The answer, by which model, and what its bracket means."""
    outcome = advice.outcome()
    result = f"λ {bracket(outcome)}" if outcome.status == "collapse" else outcome.status
    return f"{result} by {outcome.model}, {outcome.seconds:.2f} s\n  {outcome.message}"


def advice_json(advice: Advice) -> str:
    """The answer and its rungs as one JSON object."""
    keys = ("scene", "model", "status", "multiplier", "lower", "upper", "seconds", "message")
    outcome = advice.outcome()
    answer = {key: getattr(outcome, key) for key in keys}
    bounds = {"lowest": advice.known.lowest, "bound": advice.known.bound}
    return json.dumps({**answer, **bounds, "rungs": [_rung(rung) for rung in advice.rungs]}, allow_nan=False)


def _rung(rung: Rung) -> dict[str, Any]:
    keys = ("status", "multiplier", "lower", "upper", "dofs", "steps")
    next_seconds = None if rung.next_cost is None else rung.next_cost.seconds
    said = {"seconds": rung.seconds, "reason": rung.reason, "next": rung.onward, "next_seconds": next_seconds}
    return {"model": rung.model, **{key: getattr(rung.outcome, key, None) for key in keys}, **said}
