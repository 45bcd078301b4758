"""``runningbond run``."""

import json as to_json
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from runningbond.compare.fingerprint import fingerprint
from runningbond.compare.models import MODELS, TOLERANCE, check_tolerance, find_model, run_model
from runningbond.compare.published import find_scene
from runningbond.results import Outcome, make_folder, save_outcome
from runningbond.scene import read_scene

from .terminal import DONE, NO_ANSWER, STOPPED, UNDECIDED, Json, SceneName, Tolerance, can_draw, interruptions


def run(
    scene: SceneName,
    /,
    *,
    model: Annotated[str, Parameter(help=f"One of {', '.join(MODELS)}.")],
    tolerance: Tolerance = TOLERANCE,
    json: Json = False,
    out: Path | None = None,
) -> int:
    """Run one model on one scene.

    Parameters
    ----------
    model
        Name of the model.
    out
        Folder in which to keep the result, its time series for ParaView and a picture of its mechanism.
    """
    chosen = find_model(model, "--model")
    check_tolerance(tolerance, "--tolerance")
    wall = read_scene(find_scene(scene))
    if out is not None:
        make_folder(out)
    stopped = interruptions(chosen)
    recorder = None if out is None or chosen.observer is None else chosen.observer(wall, out)
    outcome = run_model(chosen, wall, tolerance, recorder)
    print(to_json.dumps(outcome.summary(), allow_nan=False) if json else _as_text(outcome), flush=True)
    if out is not None:
        # What was interrupted is kept under no fingerprint: no comparison takes it for the answer.
        save_outcome(outcome, out, "" if stopped else fingerprint(wall, chosen, tolerance), wall)
        if recorder is None:
            from runningbond.compare.recording import record_mechanism

            record_mechanism(wall, outcome, out)
        else:
            recorder.finish(outcome)
        _draw(out)
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


def _draw(out: Path) -> None:
    """Draw the mechanism, or say in a line why there is no picture: the numbers are kept all the same."""
    from runningbond.pictures.render import remove_pictures, render_folder

    remove_pictures(out)
    if can_draw():
        render_folder(out, moments=False)


def _as_text(outcome: Outcome) -> str:
    loads = (("λ", outcome.multiplier), ("lower", outcome.lower), ("upper", outcome.upper))
    bracket = ", ".join(f"{name} {value:.6g}" for name, value in loads if value is not None)
    size = "" if outcome.dofs is None else f"{outcome.dofs} degrees of freedom, {outcome.steps} steps, "
    lines = [f"{outcome.scene}: {outcome.model}", f"  {outcome.status}{': ' + bracket if bracket else ''}"]
    return "\n".join([*lines, f"  {outcome.message}", f"  {size}{outcome.seconds:.3g} s"])
