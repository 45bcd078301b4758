"""``runningbond run``."""

import json as to_json
import sys
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from runningbond.compare.fingerprint import fingerprint
from runningbond.compare.models import MODELS, TOLERANCE, check_tolerance, find_model, run_model
from runningbond.compare.published import find_scene
from runningbond.compare.table import csv_lines
from runningbond.pictures.time_series import KINDS
from runningbond.results import Outcome, make_folder, save_outcome, write_atomically
from runningbond.results.store import RECORD
from runningbond.scene import Scene, read_scene

from .terminal import (
    DONE,
    NO_ANSWER,
    STOPPED,
    UNDECIDED,
    Json,
    SceneName,
    Tolerance,
    interruptions,
    progress_line,
    remarks,
)

CURVE_FILES = ("curve.csv", "curve.png")


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
        Folder in which to keep the result, its time series for ParaView, its curve with all reactions as a table and
        as a picture, and a picture of its mechanism.
    """
    chosen = find_model(model, "--model")
    check_tolerance(tolerance, "--tolerance")
    wall = read_scene(find_scene(scene))
    if out is not None:
        make_folder(out)
    stopped = interruptions(chosen)
    recorder = None if out is None or chosen.observer is None else chosen.observer(wall, out)
    progress = chosen.progress() if chosen.progress else None
    observers = [each for each in (recorder, progress) if each is not None]

    def observe(*seen: Any) -> None:
        for observer in observers:
            observer(*seen)

    with progress_line(chosen.name, progress.line if progress else None):
        outcome = run_model(chosen, wall, tolerance, observe if observers else None)
    for line in remarks(wall):  # not before: a scene that the model refuses is one line
        print(line, file=sys.stderr)
    print(to_json.dumps(outcome.summary(), allow_nan=False) if json else _as_text(outcome), flush=True)
    if out is not None:
        # What was interrupted is kept under no fingerprint: no comparison takes it for the answer.
        save_outcome(outcome, out, "" if stopped else fingerprint(wall, chosen, tolerance), wall)
        if recorder is None:
            from runningbond.compare.recording import record_mechanism

            record_mechanism(wall, outcome, out)
        else:
            recorder.finish(outcome)
        _draw(wall, outcome, out)
        if not json:
            print("\n".join(map(str, _written(out))))
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


def _draw(wall: Scene, outcome: Outcome, out: Path) -> None:
    """Write and draw the curve and the mechanism."""
    from runningbond.pictures.captions import to_png
    from runningbond.pictures.curve import curve_figure
    from runningbond.pictures.render import draw_folder, remove_pictures

    remove_pictures(out)
    for name in CURVE_FILES:
        (out / name).unlink(missing_ok=True)
    columns = outcome.curve_columns("λ", "control displacement [m]")
    rows = [["" if np.isnan(x) else float(x) for x in row] for row in zip(*columns.values(), strict=True)]
    if rows:
        write_atomically(out / CURVE_FILES[0], csv_lines([list(columns), *rows]).encode())
    if len(outcome.curve):
        write_atomically(out / CURVE_FILES[1], to_png(curve_figure(wall, outcome)))
    draw_folder(out)


def _written(out: Path) -> list[Path]:
    """What a run has left in its folder."""
    names = (RECORD, "arrays-*.npz", *CURVE_FILES, *(f"{kind}.pvd" for kind in KINDS), "mechanism.*")
    return [path for name in names for path in sorted(out.glob(name))]


def _as_text(outcome: Outcome) -> str:
    loads = (("λ", outcome.multiplier), ("lower", outcome.lower), ("upper", outcome.upper))
    bracket = ", ".join(f"{name} {value:.6g}" for name, value in loads if value is not None)
    size = "" if outcome.dofs is None else f"{outcome.dofs} degrees of freedom, {outcome.steps} steps, "
    lines = [f"{outcome.scene}: {outcome.model}", f"  {outcome.status}{': ' + bracket if bracket else ''}"]
    return "\n".join([*lines, f"  {outcome.message}", f"  {size}{outcome.seconds:.3g} s"])
