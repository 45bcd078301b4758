"""``runningbond advise``."""

from typing import Annotated

from cyclopts import Parameter

from runningbond.compare.advice import TOLERANCE, Advice
from runningbond.compare.advice.knowledge import Knowledge
from runningbond.compare.advice.lines import advice_json, answer_lines, rung_line
from runningbond.compare.models import check_tolerance
from runningbond.compare.published import find_scene
from runningbond.scene import read_scene

from .exits import DONE, NO_ANSWER, STOPPED, UNDECIDED
from .terminal import interruptions


def advise(
    scene: str,
    /,
    *,
    tolerance: float = TOLERANCE,
    finite: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Answer with the cheapest models that a scene needs, and say why each was or was not run.

    Parameters
    ----------
    scene
        Scene file, or the name of a published scene such as panel-01.
    tolerance
        Relative width of the bracket asked for.
    finite
        Follow the wall at finite displacements in the end, however small they may be.
    json
        Print one JSON object and nothing else.
    """
    check_tolerance(tolerance)
    advice = Advice(Knowledge(read_scene(find_scene(scene)), tolerance, finite))
    if not json:
        print(f"{advice.known.scene.title}: λ to {100 * tolerance:g} %", flush=True)
    stopped: list[int] = []
    for rung in advice.climb():
        if not json:
            print(rung_line(rung), flush=True)
        if stopped:
            return STOPPED
        if rung.next.model is not None:
            stopped = interruptions(rung.next.model)
    print(advice_json(advice) if json else answer_lines(advice), flush=True)
    return NO_ANSWER if advice.outcome().status in UNDECIDED else DONE
