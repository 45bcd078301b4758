"""``runningbond run``."""

import json as to_json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from cyclopts import Parameter

from runningbond.campaigns import Interrupted
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.compare.published import find_scene
from runningbond.draws import Sampling
from runningbond.models import MODELS, TOLERANCE, Model, Progress, Recorder, check_tolerance, find_model, run_model
from runningbond.models.far import check_goes_far, going_far
from runningbond.pictures.sheet import csv_lines
from runningbond.pictures.time_series import KINDS, MACRO
from runningbond.results import Outcome, save_outcome, write_atomically
from runningbond.results.store import ARRAY_FILES, RECORD
from runningbond.scene import Scene, SceneError, read_scene

from .left_behind import CURVE_FILES, DRAWS, own_folder, remove_older
from .terminal import (
    DONE,
    NO_ANSWER,
    STOPPED,
    UNDECIDED,
    Json,
    SceneName,
    Together,
    Tolerance,
    Whole,
    check_jobs,
    interruptions,
    print_table,
    progress_bar,
    progress_line,
    remarks,
    tell_cost,
    told_interruption,
)

OPTIONS = {"number": "--draws", "scatter": "--scatter"}
"""What draws are asked for with on the command line, by their names in Python."""

FLAG = "--"
"""What stands before the names of options."""


def run(
    scene: SceneName,
    /,
    *,
    model: Annotated[str, Parameter(help=f"One of {', '.join(MODELS)}.")],
    tolerance: Tolerance = TOLERANCE,
    displacements: Literal["small", "finite"] = "small",
    distance: float | None = None,
    json: Json = False,
    out: Path | None = None,
    draws: Whole | None = None,
    scatter: str | None = None,
    jobs: Whole | None = None,
) -> int:
    """Run one model on one scene, once or as often as draws are asked for.

    Parameters
    ----------
    model
        Name of the model.
    displacements
        Whether the wall keeps the shape it was built in, or dem-dynamic or fem follows it as far as a beam that is
        driven by displacements, or a support that moves, leads it, or live loads push it past their peak.
    distance
        How far live loads push it [m], read where displacements are; until they have fallen to nothing, or else by the
        wall's smaller side, where none is given.
    out
        Folder in which to keep the result, its time series for ParaView, its curve with all reactions as a table and
        as a picture, and a picture of its mechanism.
    draws
        Number of runs: of the wall as it is, and of walls beside it that differ in nothing that is known. What is kept
        in --out is that of the first, and all of them in a folder of it, where the same command goes on.
    scatter
        What differs between draws: bits, the last ones; or size=0.01,friction=0.05, a relative tolerance of blocks and
        the standard deviation of the logarithm of each joint's friction, or one of them.
    jobs
        Number of processes for draws; -1, the default, is one a core.
    """
    chosen = going_far(find_model(model, "--model"), displacements, distance, FLAG)
    check_tolerance(tolerance, "--tolerance")
    for option, value in (("--scatter", scatter), ("--jobs", jobs)):
        if draws is None and value is not None:
            raise SceneError(option, "goes with --draws alone", value)
    wall = read_scene(find_scene(scene))
    check_goes_far(chosen, wall, displacements, distance, FLAG)
    if draws is not None:
        return _draws(wall, chosen, draws, scatter or "bits", tolerance, -1 if jobs is None else jobs, out, json)
    chosen.check(wall)
    with own_folder(out):
        stopped = interruptions(chosen)
        recorder = None if out is None or chosen.observer is None else chosen.observer(wall, out)
        progress = _progress(chosen, wall)
        observers = [each for each in (recorder, progress) if each is not None]
        tell_cost(chosen, wall, tolerance)
        with progress_line(chosen.name, progress.line if progress else None):
            outcome = run_model(chosen, wall, tolerance, Together(observers) if observers else None)
    for line in remarks(wall):  # not before: a scene that the model refuses is one line
        print(line, file=sys.stderr)
    print(to_json.dumps(outcome.summary(), allow_nan=False) if json else _as_text(outcome), flush=True)
    if out is not None:
        remove_older(out)
        # What was interrupted is kept under no fingerprint: no comparison takes it for the answer.
        save_outcome(outcome, out, "" if stopped else fingerprint(wall, chosen, tolerance), wall)
        _picture(wall, outcome, out, recorder, json)
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


def _progress(model: Model, wall: Scene) -> Progress | None:
    """What looks at a run and says how far it has come, if anything does."""
    if wall.history is None:
        return model.progress() if model.progress else None
    from runningbond.pictures.progress import ResponseProgress

    return ResponseProgress()


@contextmanager
def _as_options() -> Iterator[None]:
    """Name what draws refuse after the options that it was given by."""
    try:
        yield
    except SceneError as error:
        name, *rest = error.key.split(" ")
        if name not in OPTIONS:
            raise
        raise SceneError(" ".join([OPTIONS[name], *rest]), error.remedy, error.value) from None


def _draws(
    wall: Scene, model: Model, number: int, scatter: str, tolerance: float, jobs: int, out: Path | None, json: bool
) -> int:
    """Run a model on draws of a wall, and print and keep what came of them."""
    check_jobs(jobs)
    folder, bar = None if out is None else out / DRAWS, (f"{model.name}, draws", number)
    with _as_options():
        sampling = Sampling(wall, model, number, scatter)
    try:
        with own_folder(out), own_folder(folder), progress_bar(*bar) as advance, _as_options():
            found = sampling.run(tolerance, folder, jobs, advance)
    except Interrupted as stopped:
        return told_interruption(stopped, number, "draws", folder)
    for line in remarks(wall):
        print(line, file=sys.stderr)
    outcome = found.outcomes[0]
    if json:
        print(to_json.dumps({**outcome.summary(), DRAWS: found.summary()}, allow_nan=False), flush=True)
    else:
        print(_as_text(outcome))
        print_table(found.sheet())
        print(found, flush=True)
    if out is not None:
        remove_older(out)
        save_outcome(outcome, out, fingerprint(wall, model, tolerance), wall)
        write_atomically(out / f"{DRAWS}.json", (to_json.dumps(found.summary(), indent=2) + "\n").encode())
        _picture(wall, outcome, out, None, json)
    return NO_ANSWER if all(each.status in UNDECIDED for each in found.outcomes) else DONE


def _picture(wall: Scene, outcome: Outcome, out: Path, recorder: Recorder | None, json: bool) -> None:
    """Write and draw what there is to see of an outcome, and say what was written."""
    if recorder is None:
        from runningbond.pictures.recording import record_mechanism

        record_mechanism(wall, outcome, out)
    else:
        recorder.finish(outcome)
    _draw(wall, outcome, out)
    if not json:
        print("\n".join(map(str, _written(out))))


def _draw(wall: Scene, outcome: Outcome, out: Path) -> None:
    """Write and draw the curve and the mechanism."""
    from runningbond.pictures.captions import to_png
    from runningbond.pictures.curve import curve_figure
    from runningbond.pictures.render import draw_folder

    columns = outcome.curve_columns("λ", "control displacement [m]")
    rows = [["" if np.isnan(x) else float(x) for x in row] for row in zip(*columns.values(), strict=True)]
    if rows:
        write_atomically(out / CURVE_FILES[0], csv_lines([list(columns), *rows]).encode())
    if len(outcome.curve):
        write_atomically(out / CURVE_FILES[1], to_png(curve_figure(wall, outcome)))
    draw_folder(out)


def _written(out: Path) -> list[Path]:
    """What a run has left in its folder."""
    series = (*(f"{kind}.pvd" for kind in KINDS), MACRO)
    names = (RECORD, ARRAY_FILES, f"{DRAWS}.json", *CURVE_FILES, *series, "mechanism.*")
    return [path for name in names for path in sorted(out.glob(name))]


def _as_text(outcome: Outcome) -> str:
    loads = (("λ", outcome.multiplier), ("lower", outcome.lower), ("upper", outcome.upper))
    bracket = ", ".join(f"{name} {value:.6g}" for name, value in loads if value is not None)
    size = "" if outcome.dofs is None else f"{outcome.dofs} degrees of freedom, {outcome.steps} steps, "
    lines = [f"{outcome.scene}: {outcome.model}", f"  {outcome.status}{': ' + bracket if bracket else ''}"]
    return "\n".join([*lines, f"  {outcome.message}", f"  {size}{outcome.seconds:.3g} s"])
