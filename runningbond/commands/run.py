"""``runningbond run``."""

import json as to_json
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
    print_cost,
    print_table,
    progress_bar,
    progress_line,
    remarks,
    report_interrupt,
    tell,
)

OPTIONS = {"number": "--draws", "scatter": "--scatter"}
"""Command-line options for draws, by the names of the parameters in Python."""

FLAG = "--"
"""Prefix of the names of options."""


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
    """Run one model on one scene, once or for a number of draws.

    Parameters
    ----------
    model
        Name of the model.
    displacements
        With small ones, equilibrium is that of the undeformed wall. With finite ones, dem-dynamic or fem follow the
        deformed wall as far as a driven beam or a moving support goes, or as live loads push it past their peak.
    distance
        Displacement of the control point up to which live loads push the wall [m], only if displacements are finite;
        by default the smaller side of the wall, and then less if that gives no answer. The push ends earlier if the
        loads fall to zero.
    out
        Folder for the result, its time series for ParaView, its curve with all reactions as a table and as a picture,
        and a picture of its mechanism.
    draws
        Number of runs: of the wall as it is, and of copies that differ from it within the scatter. The result in --out
        is that of the first; a folder in it keeps all draws, from which the same command continues.
    scatter
        What differs between draws: bits, the last bits of numbers; or size=0.01,friction=0.05, a relative tolerance of
        block sizes and the standard deviation of the logarithm of each joint's friction, or only one of these.
    jobs
        Number of processes for draws; -1, the default, for one per core.
    """
    chosen = going_far(find_model(model, "--model"), displacements, distance, FLAG)
    check_tolerance(tolerance, "--tolerance")
    for option, value in (("--scatter", scatter), ("--jobs", jobs)):
        if draws is None and value is not None:
            raise SceneError(option, "only goes with --draws", value)
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
        print_cost(chosen, wall, tolerance)
        with progress_line(chosen.name, progress.line if progress else None):
            outcome = run_model(chosen, wall, tolerance, Together(observers) if observers else None)
    for line in remarks(wall):  # after the run: if the model refuses the scene, only that line is printed
        tell(line, error=True)
    tell(to_json.dumps(outcome.summary(), allow_nan=False) if json else _as_text(outcome))
    if out is not None:
        remove_older(out)
        # An interrupted result has no fingerprint, and therefore no comparison reuses it.
        save_outcome(outcome, out, "" if stopped else fingerprint(wall, chosen, tolerance), wall)
        _picture(wall, outcome, out, recorder, json)
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


def _progress(model: Model, wall: Scene) -> Progress | None:
    """Observer that reports the progress of a run; None if the model has none."""
    if wall.history is None:
        return model.progress() if model.progress else None
    from runningbond.pictures.progress import ResponseProgress

    return ResponseProgress()


@contextmanager
def _as_options() -> Iterator[None]:
    """Replace parameter names by option names in errors about draws."""
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
    """Run a model on draws of a wall, and print and store the results; returns the exit code."""
    check_jobs(jobs)
    folder, bar = None if out is None else out / DRAWS, (f"{model.name}, draws", number)
    with _as_options():
        sampling = Sampling(wall, model, number, scatter)
    try:
        with own_folder(out), own_folder(folder), progress_bar(*bar) as advance, _as_options():
            found = sampling.run(tolerance, folder, jobs, advance)
    except Interrupted as stopped:
        return report_interrupt(stopped, number, "draws", folder)
    for line in remarks(wall):
        tell(line, error=True)
    outcome = found.outcomes[0]
    if json:
        tell(to_json.dumps({**outcome.summary(), DRAWS: found.summary()}, allow_nan=False))
    else:
        tell(_as_text(outcome))
        print_table(found.sheet())
        tell(str(found))
    if out is not None:
        remove_older(out)
        save_outcome(outcome, out, fingerprint(wall, model, tolerance), wall)
        write_atomically(out / f"{DRAWS}.json", (to_json.dumps(found.summary(), indent=2) + "\n").encode())
        _picture(wall, outcome, out, None, json)
    return NO_ANSWER if all(each.status in UNDECIDED for each in found.outcomes) else DONE


def _picture(wall: Scene, outcome: Outcome, out: Path, recorder: Recorder | None, json: bool) -> None:
    """Write the time series and pictures of an outcome, and print the files written."""
    if recorder is None:
        from runningbond.pictures.recording import record_mechanism

        record_mechanism(wall, outcome, out)
    else:
        recorder.finish(outcome)
    _draw(wall, outcome, out)
    if not json:
        print("\n".join(map(str, _written(out))))


def _draw(wall: Scene, outcome: Outcome, out: Path) -> None:
    """Write the curve as a table, and draw the curve and the mechanism."""
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
    """Files that a run has written to its folder."""
    series = (*(f"{kind}.pvd" for kind in KINDS), MACRO)
    names = (RECORD, ARRAY_FILES, f"{DRAWS}.json", *CURVE_FILES, *series, "mechanism.*")
    return [path for name in names for path in sorted(out.glob(name))]


def _as_text(outcome: Outcome) -> str:
    loads = (("λ", outcome.multiplier), ("lower", outcome.lower), ("upper", outcome.upper))
    bracket = ", ".join(f"{name} {value:.6g}" for name, value in loads if value is not None)
    size = "" if outcome.dofs is None else f"{outcome.dofs} degrees of freedom, {outcome.steps} steps, "
    lines = [f"{outcome.scene}: {outcome.model}", f"  {outcome.status}{': ' + bracket if bracket else ''}"]
    return "\n".join([*lines, f"  {outcome.message}", f"  {size}{outcome.seconds:.3g} s"])
