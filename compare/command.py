"""The command line: every command of ``runningbond``."""

import io
import json
import os
import signal
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, CycloptsError, Parameter, Token
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from meshing import check_suffix, wall_mesh, write_mesh
from results import Outcome, StoreError, load_scene, make_folder, save_outcome, write_atomically
from results.painting import Colouring
from results.rendering import why_not_drawn
from results.vtk_messages import VtkError
from scene import Scene, SceneError, read_scene

from .advice import TOLERANCE as ADVISED
from .advice import advice_on
from .advice_lines import advice_json, answer_lines, rung_line
from .campaign import Campaign, Cell, Interrupted, run_campaign
from .fingerprint import fingerprint
from .models import IN_MOTION, MODELS, OBSERVED, TOLERANCE, check_model, check_tolerance, run_model
from .published import PUBLISHED, PublishedCase, find_scene, published_case
from .table import Comparison, cost_sheets, csv_text, multiplier_sheets

if TYPE_CHECKING:
    from .recording import Recorder
    from .stability.report import Findings

DONE, BAD_INPUT, NO_ANSWER, STOPPED = 0, 2, 3, 130
UNDECIDED = ("undecided", "failed")

app = App(
    name="runningbond",
    help="From the description of a masonry wall to its collapse.",
    version=lambda: version("runningbond"),
    result_action="return_value",
    suppress_keyboard_interrupt=False,
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
        homog, limit, limit-nonassociated, dem-static, dem-dynamic or fem.
    tolerance
        Relative width of the bracket asked for.
    json
        Print one JSON object and nothing else.
    out
        Folder in which to keep the result, its time series for ParaView and a picture of its mechanism.
    """
    check_model(model)
    check_tolerance(tolerance)
    wall = read_scene(find_scene(scene))
    if out is not None:
        make_folder(out)
    stopped = _interruptions(model)
    recorder = None
    if out is not None and model in OBSERVED:
        from .recording import recorder as observer

        recorder = observer(wall, model, out)
    outcome = run_model(model, wall, tolerance, recorder)
    print(_as_json(outcome) if json else _as_text(outcome), flush=True)
    if out is not None:
        # What was broken off is kept under no fingerprint: no comparison takes it for the answer.
        save_outcome(outcome, out, "" if stopped else fingerprint(wall, model, tolerance), wall)
        _record(wall, outcome, out, recorder)
        _draw(out)
    if stopped:
        return STOPPED
    return NO_ANSWER if outcome.status in UNDECIDED else DONE


@app.command
def advise(
    scene: str,
    /,
    *,
    tolerance: float = ADVISED,
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
    advice = advice_on(read_scene(find_scene(scene)), tolerance, finite=finite)
    if not json:
        print(f"{advice.known.scene.title}: λ to {100 * tolerance:g} %", flush=True)
    stopped: list[int] = []
    for rung in advice.climb():
        if not json:
            print(rung_line(rung), flush=True)
        if stopped:
            return STOPPED
        stopped = _interruptions((rung.onward or "").removesuffix(", finite"))
    print(advice_json(advice) if json else answer_lines(advice), flush=True)
    return NO_ANSWER if advice.outcome().status in UNDECIDED else DONE


def _record(scene: Scene, outcome: Outcome, out: Path, recorder: "Recorder | None") -> None:
    """Finish the time series of a run, or write that of a mechanism."""
    if recorder is not None:
        recorder.finish(outcome)
        return
    from .recording import record_mechanism

    record_mechanism(scene, outcome, out)


def _draw(out: Path) -> None:
    """Draw the mechanism, or say in a line why there is no picture: the numbers are kept all the same."""
    from results.album import draw_mechanism, forget_pictures

    forget_pictures(out)
    why_not = why_not_drawn()
    if not why_not:
        draw_mechanism(out)
    else:
        print(f"runningbond: {why_not}", file=sys.stderr)


@app.command
def render(
    folder: Path,
    /,
    *,
    colour: Colouring = "displacement",
    view: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Draw what a result folder has to show: its collapse mechanism, and of a time series the last moment and a film.

    Parameters
    ----------
    folder
        Folder of one outcome: that of run --out, or scene/model in that of compare.
    colour
        Colour blocks by displacement or by course.
    view
        Open a window instead, where there is a screen.
    """
    load_scene(folder)  # refused before anything is tried
    if view:
        if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            raise SceneError("--view", "needs a screen; without it pictures are written")
        from results.album import view_folder

        view_folder(folder, colour)
        return DONE
    why_not = why_not_drawn()
    if why_not:
        print(f"runningbond: {why_not}", file=sys.stderr)
        return NO_ANSWER
    from results.album import draw_folder

    written = draw_folder(folder, colour)
    print("\n".join(map(str, written)) if written else f"{folder}: the outcome has no mechanism to draw")
    return DONE


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
    cluster: str | None = None,
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
    cluster
        Run on the workers of a Dask cluster: the address of its scheduler, such as tcp://host:8786, or its file.
    fresh
        Compute again what is already there.
    """
    chosen = list(dict.fromkeys(model.strip() for model in models.split(",")))
    for model in chosen:
        check_model(model, "--models")
    check_tolerance(tolerance)
    if jobs == 0 or jobs < -1:
        raise SceneError("--jobs", "must be a number of processes, or -1 for one a core", jobs)
    _check_cluster(cluster, jobs)
    walls, published = _read_all(scenes or [case.name for case in PUBLISHED])
    make_folder(out)
    console = Console(stderr=True)
    try:
        campaign = _run_with_progress(walls, chosen, out, tolerance, jobs, cluster, fresh, console)
    except Interrupted as stopped:
        total, again = len(walls) * len(chosen), "the same command without --fresh" if fresh else "the same command"
        kept = f"{stopped.campaign.kept} of {total} cases are kept in {out}; {again} goes on."
        why = f"runningbond: {stopped.reason}" if stopped.reason else "Interrupted"
        console.print(f"{why}: {kept}", soft_wrap=True, markup=False, highlight=False)
        if isinstance(stopped.__cause__, OSError):
            return BAD_INPUT
        return NO_ANSWER if stopped.reason else STOPPED
    _report(Comparison(walls, chosen, campaign, published), out, tolerance)
    failed = [cell for cell, outcome in campaign.outcomes.items() if outcome.status == "failed"]
    for name, model in failed:
        console.print(f"{name}, {model}: {campaign.outcomes[name, model].message}", markup=False)
    return NO_ANSWER if failed else DONE


@app.command
def stability(*experiments: str, out: Path = Path("stability")) -> int:
    """Drive every method over its edge, and tell where each may be trusted.

    Findings are kept as they come: an interrupted command goes on where it was.

    Parameters
    ----------
    experiments
        Names of experiments; all where none is given.
    out
        Folder for findings, charts and the report.
    """
    from .stability import EXPERIMENTS
    from .stability.keeping import find
    from .stability.report import check_experiments, summary, write_report

    check_experiments(experiments)
    make_folder(out)
    console = Console(stderr=True, highlight=False)
    try:
        found = _find_out_with_progress(experiments or EXPERIMENTS, out, console)
    except Stopped:
        kept = sum(find(name, out) is not None for name in EXPERIMENTS)
        said = f"Interrupted: {kept} of {len(EXPERIMENTS)} experiments are kept in {out}; the same command goes on."
        console.print(said, soft_wrap=True, markup=False)
        return STOPPED
    written = write_report(found, out)
    terminal = Console(width=None if sys.stdout.isatty() else 180, markup=False, highlight=False)
    terminal.print(summary(found).terminal())
    terminal.print(f"written: {', '.join(map(str, written))}", soft_wrap=True)
    for name, edge in found.off:
        theory = f"measured {edge.measured:.6g}, by theory {edge.theory:.6g}"
        console.print(f"{name}: {edge.what}: {theory}", soft_wrap=True, markup=False)
    for name, words in found.broken.items():
        console.print(f"{name} ended in an error: {words}", soft_wrap=True, markup=False)
    return NO_ANSWER if found.off or found.broken else DONE


class Stopped(BaseException):
    """Ctrl-C in the middle of experiments: not a KeyboardInterrupt, which a model would take for its own end."""


def _find_out_with_progress(experiments: Sequence[str], out: Path, console: Console) -> "Findings":
    from .stability.report import Findings, findings

    def stop(number: int, frame: object) -> None:
        raise Stopped

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    found = Findings()
    try:
        with _progress(console) as bar:
            task = bar.add_task("stability", total=len(experiments))
            for name, finding in findings(experiments, out, lambda name: bar.update(task, description=name)):
                if isinstance(finding, str):
                    found.broken[name] = finding
                else:
                    found.kept[name] = finding
                bar.update(task, advance=name in experiments)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return found


def _check_cluster(cluster: str | None, jobs: int) -> None:
    """Refuse a cluster that cannot be used."""
    if cluster is None:
        return
    if jobs != -1:
        raise SceneError("--jobs", "does not go with --cluster, whose workers are as many as it has", jobs)
    if find_spec("distributed") is None:
        raise SceneError("--cluster", "needs Dask: pip install 'runningbond[cluster]'", cluster)


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


@app.command
def study(*, out: Path = Path("study"), jobs: Annotated[int, Parameter(converter=_whole)] = 1) -> int:
    """Measure every model and its knobs on walls whose answer is known: error against cost.

    Measurements are kept as they come: an interrupted study goes on where it was.

    Parameters
    ----------
    out
        Folder for the table, the charts and the page.
    jobs
        Number of processes side by side; with more than one, seconds are worth less.
    """
    if jobs < 1:
        raise SceneError("--jobs", "must be a number of processes, 1 or more", jobs)
    from .accuracy import all_cases, run_study
    from .accuracy.conclusions import conclusions
    from .accuracy.page import write_page

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    console = Console(stderr=True)
    try:
        with _progress(console) as bar:
            task = bar.add_task("measuring", total=len(all_cases()))
            rows = run_study(out, jobs=jobs, progress=lambda case: bar.update(task, advance=1, description=str(case)))
    except KeyboardInterrupt:
        console.print(
            f"Interrupted: what is measured is kept in {out}; the same command goes on.", soft_wrap=True, markup=False
        )
        return STOPPED
    written = write_page(rows, out)
    print("\n".join(conclusions(rows)))
    print(f"written: {', '.join(map(str, written))}")
    failed = [row for row in rows if row.status == "failed"]
    for row in failed:
        console.print(f"{row.case}: {row.message}", markup=False)
    return NO_ANSWER if failed else DONE


def _progress(console: Console) -> Progress:
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=console)


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
    cluster: str | None,
    fresh: bool,
    console: Console,
) -> Campaign:
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # end the workers too when a scheduler ends us
    with _progress(console) as bar:
        task = bar.add_task("comparing", total=len(walls) * len(models))

        def advance(cell: Cell) -> None:
            bar.update(task, advance=1, description=f"{cell[0]}, {cell[1]}")

        return run_campaign(
            walls,
            models,
            folder=out,
            tolerance=tolerance,
            jobs=jobs,
            cluster=cluster,
            fresh=fresh,
            progress=advance,
        )


def _report(comparison: Comparison, out: Path, tolerance: float) -> None:
    from .curves import draw_curves
    from .figures import draw_figures
    from .plates import draw_plates
    from .report import report_html

    campaign = comparison.campaign
    sheets = [*multiplier_sheets(comparison), *cost_sheets(comparison)]
    write_atomically(out / "table.csv", csv_text(comparison).encode())
    write_atomically(out / "table.md", "\n".join(sheet.markdown() for sheet in sheets).encode())
    console = Console(width=None if sys.stdout.isatty() else 180, markup=False, highlight=False)
    for sheet in sheets:
        console.print(sheet.terminal())
    console.print(f"{len(campaign)} cases, {len(campaign.reused)} of them found in {out}", soft_wrap=True)
    published = campaign.only(comparison.published)
    why_not = why_not_drawn()
    charts = [*draw_figures(published, out), *draw_curves(published, out)]
    charts += [] if why_not else draw_plates(comparison, out)
    pictures = [path for path in charts if path.suffix == ".png"]
    write_atomically(out / "report.html", report_html(comparison, pictures, tolerance, why_not).encode())
    tables = [out / name for name in ("table.csv", "table.md", "report.html")]
    console.print(f"written: {', '.join(map(str, [*tables, *charts]))}", soft_wrap=True)
    if why_not:
        print(f"runningbond: {why_not}", file=sys.stderr)


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
    heard: list[int] = []

    def stop(number: int, frame: object) -> None:
        heard.append(number)
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, stop)
    try:
        code = command(arguments)
    except Exception:
        if not heard:
            raise
        code = _stopped()  # within an import or a callback, libraries make another error of it
    sys.exit(code)


def command(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        result = app(tokens, exit_on_error=False, print_error=False)
    except (SceneError, StoreError, CycloptsError) as error:
        return _refuse(str(error))
    except VtkError as error:
        print(f"runningbond: {error}", file=sys.stderr)
        return NO_ANSWER
    except BrokenPipeError:  # whoever read us has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return DONE
    except OSError as error:
        return _refuse(f"{error.filename or 'output'}: {error.strerror or error}")
    except KeyboardInterrupt:
        return _stopped()
    return result if isinstance(result, int) else DONE


def _stopped() -> int:
    print("runningbond: interrupted; every file is whole, or as it was before", file=sys.stderr)
    return STOPPED


def _refuse(message: str) -> int:
    print("runningbond: " + " ".join(message.split()), file=sys.stderr)
    return BAD_INPUT
