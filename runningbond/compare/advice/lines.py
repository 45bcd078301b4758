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
    found = advice.outcome().summary()
    kept = ("scene", "model", "status", "multiplier", "lower", "upper", "seconds", "message")
    answer = {key: found[key] for key in kept}
    extra = {
        "lowest": advice.known.lowest,
        "bound": advice.known.bound,
        "rungs": [_rung(rung) for rung in advice.rungs],
    }
    return json.dumps({**answer, **extra}, allow_nan=False)


def _rung(rung: Rung) -> dict[str, Any]:
    outcome, cost = rung.outcome, rung.next_cost
    found = {key: getattr(outcome, key, None) for key in ("status", "multiplier", "lower", "upper", "dofs", "steps")}
    return {
        "model": rung.model,
        **found,
        "seconds": rung.seconds,
        "reason": rung.reason,
        "next": rung.onward,
        "next_seconds": None if cost is None else cost.seconds,
    }
