"""The command line: ``runningbond run``, ``runningbond compare`` and ``runningbond mesh``."""

import io
import json
import os
import signal
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

from cyclopts import App, CycloptsError, Parameter, Token
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from meshing import check_suffix, wall_mesh, write_mesh
from results import Outcome, save_outcome, write_atomically
from scene import Scene, SceneError, read_scene

from .campaign import Campaign, Cell, Interrupted, run_campaign
from .fingerprint import fingerprint
from .models import IN_MOTION, MODELS, TOLERANCE, check_model, check_tolerance, run_model
from .published import PUBLISHED, PublishedCase, find_scene, published_case
from .table import Comparison, cost_sheets, csv_text, multiplier_sheets

DONE, BAD_INPUT, NO_ANSWER, STOPPED = 0, 2, 3, 130
UNDECIDED = ("undecided", "failed")

app = App(
    name="runningbond",
    help="From the description of a masonry wall to its collapse.",
    version=lambda: version("runningbond"),
    result_action="return_value",
)


@app.command
def run(
    scene: str,
    /,
    *,
    model: str,
    tolerance: float = TOLERANCE,
    json: Annotated[bool, Parameter(negative="")] = False,
    out: Path | None = None,
) -> int:
    """Run one model on one scene.

    Parameters
    ----------
    scene
        Scene file, or the name of a published scene such as panel-01.
    model
        homog, limit, limit-nonassociated, dem-static or dem-dynamic.
    tolerance
        Relative width of the bracket asked for.
    json
        Print one JSON object and nothing else.
    out
        Folder in which to keep the result.
    """
    check_model(model)
    check_tolerance(tolerance)
    wall = read_scene(find_scene(scene))
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    stopped = _interruptions(model)
    outcome = run_model(model, wall, tolerance)
    print(_as_json(outcome) if json else _as_text(outcome), flush=True)
    if out is not None:
        # What was broken off is kept under no fingerprint: no comparison takes it for the answer.
        save_outcome(outcome, out, "" if stopped else fingerprint(wall, model, tolerance))
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


def _interruptions(model: str) -> list[int]:
    """Interruptions by Ctrl-C from here on: a run of blocks in motion ends with what it has found so far.

    A linear program does not look up from its work, and the program ends at once.
    """
    found: list[int] = []
    if model not in IN_MOTION:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        return found

    def stop(number: int, frame: object) -> None:
        found.append(number)
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, stop)
    return found


@app.command
def compare(
    *scenes: str,
    models: str = ",".join(MODELS),
    tolerance: float = TOLERANCE,
    out: Path = Path("comparison"),
    jobs: int = -1,
    fresh: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Run models on scenes and tabulate them beside the published values.

    Results are kept as they come: an interrupted comparison goes on where it was.

    Parameters
    ----------
    scenes
        Scene files or names; all published walls where none is given.
    models
        Names of models, separated by commas.
    tolerance
        Relative width of the bracket asked for.
    out
        Folder for results, tables and charts.
    jobs
        Number of processes; -1 is one a core.
    fresh
        Compute again what is already there.
    """
    chosen = list(dict.fromkeys(model.strip() for model in models.split(",")))
    for model in chosen:
        check_model(model, "--models")
    check_tolerance(tolerance)
    if jobs == 0 or jobs < -1:
        raise SceneError("--jobs", "must be a number of processes, or -1 for one a core", jobs)
    walls, published = _read_all(scenes or [case.name for case in PUBLISHED])
    out.mkdir(parents=True, exist_ok=True)
    console = Console(stderr=True)
    try:
        campaign = _run_with_progress(walls, chosen, out, tolerance, jobs, fresh, console)
    except Interrupted as stopped:
        total, again = len(walls) * len(chosen), "the same command without --fresh" if fresh else "the same command"
        console.print(
            f"Interrupted: {stopped.campaign.kept} of {total} cases are kept in {out}; {again} goes on.",
            soft_wrap=True,
            markup=False,
        )
        return STOPPED
    _report(Comparison(walls, chosen, campaign, published), out)
    failed = [cell for cell, outcome in campaign.outcomes.items() if outcome.status == "failed"]
    for name, model in failed:
        console.print(f"{name}, {model}: {campaign.outcomes[name, model].message}", markup=False)
    return NO_ANSWER if failed else DONE


def _whole(_: type, tokens: Sequence[Token]) -> int:
    """Read a whole number; cyclopts would round any other."""
    if not tokens[0].value.lstrip("+-").isdecimal():
        raise ValueError(f"{tokens[0].value!r} is no whole number")
    return int(tokens[0].value)


@app.command
def mesh(
    scene: str,
    /,
    *,
    out: Annotated[Path, Parameter(name=("--out", "-o"))],
    cells: Annotated[int, Parameter(converter=_whole)] = 1,
) -> int:
    """Write a finite-element mesh of a wall, its joints as elements without thickness.

    Parameters
    ----------
    scene
        Scene file, or the name of a published scene such as panel-01.
    out
        File to write, .msh or .vtu.
    cells
        Cells in half a block along the course, and in a block's height.
    """
    check_suffix(out)
    wall = read_scene(find_scene(scene))
    meshed = wall_mesh(wall, cells)
    write_mesh(meshed, wall, out)
    print(
        f"{out}: {len(meshed.points)} nodes, {len(meshed.triangles)} triangles, {len(meshed.interfaces)} joint elements"
    )
    return DONE


def _read_all(scenes: Sequence[str]) -> tuple[dict[str, Scene], dict[str, PublishedCase]]:
    """Scenes by name, and the published cases among them."""
    walls: dict[str, Scene] = {}
    published: dict[str, PublishedCase] = {}
    for scene in scenes:
        path = find_scene(scene)
        if path.stem in walls:
            raise SceneError(scene, f'is the second scene called "{path.stem}"; results are kept by file name')
        walls[path.stem] = read_scene(path)
        case = published_case(path)
        if case is not None:
            published[path.stem] = case
    return walls, published


def _run_with_progress(
    walls: Mapping[str, Scene],
    models: Sequence[str],
    out: Path,
    tolerance: float,
    jobs: int,
    fresh: bool,
    console: Console,
) -> Campaign:
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # end the workers too when a scheduler ends us
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("comparing", total=len(walls) * len(models))

        def advance(cell: Cell) -> None:
            bar.update(task, advance=1, description=f"{cell[0]}, {cell[1]}")

        return run_campaign(walls, models, folder=out, tolerance=tolerance, jobs=jobs, fresh=fresh, progress=advance)


def _report(comparison: Comparison, out: Path) -> None:
    from .curves import draw_curves
    from .figures import draw_figures

    campaign = comparison.campaign
    sheets = [*multiplier_sheets(comparison), *cost_sheets(comparison)]
    write_atomically(out / "table.csv", csv_text(comparison).encode())
    write_atomically(out / "table.md", "\n".join(sheet.markdown() for sheet in sheets).encode())
    published = campaign.only(comparison.published)
    charts = [*draw_figures(published, out), *draw_curves(published, out)]
    console = Console(width=None if sys.stdout.isatty() else 180, markup=False, highlight=False)
    for sheet in sheets:
        console.print(sheet.terminal())
    console.print(f"{len(campaign)} cases, {len(campaign.reused)} of them found in {out}", soft_wrap=True)
    written = ", ".join(str(path) for path in [out / "table.csv", out / "table.md", *charts])
    console.print(f"written: {written}", soft_wrap=True)


def _as_json(outcome: Outcome) -> str:
    return json.dumps(outcome.summary(), allow_nan=False)


def _as_text(outcome: Outcome) -> str:
    bracket = ", ".join(
        f"{name} {value:.6g}"
        for name, value in (("λ", outcome.multiplier), ("lower", outcome.lower), ("upper", outcome.upper))
        if value is not None
    )
    size = "" if outcome.dofs is None else f"{outcome.dofs} degrees of freedom, {outcome.steps} steps, "
    return "\n".join(
        [
            f"{outcome.scene}: {outcome.model}",
            f"  {outcome.status}{': ' + bracket if bracket else ''}",
            f"  {outcome.message}",
            f"  {size}{outcome.seconds:.3g} s",
        ]
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    sys.exit(command(arguments))


def command(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        result = app(tokens, exit_on_error=False, print_error=False)
    except (SceneError, CycloptsError) as error:
        return _refuse(str(error))
    except BrokenPipeError:  # whoever read us has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return DONE
    except OSError as error:
        return _refuse(f"{error.filename or 'output'}: {error.strerror or error}")
    except KeyboardInterrupt:
        return STOPPED
    return result if isinstance(result, int) else DONE


def _refuse(message: str) -> int:
    print("runningbond: " + " ".join(message.split()), file=sys.stderr)
    return BAD_INPUT
