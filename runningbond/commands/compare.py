"""``runningbond compare``."""

import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from runningbond.campaigns import Interrupted, run_campaign
from runningbond.compare.published import PUBLISHED, PublishedCase, find_scene, published_case
from runningbond.compare.table import Comparison, cost_sheets, csv_text, multiplier_sheets
from runningbond.models import MODELS, TOLERANCE, check_tolerance, find_model
from runningbond.pictures.quantities import counted
from runningbond.results import make_folder, write_atomically
from runningbond.scene import Scene, SceneError, read_scene
from runningbond.scene.file import plain_stem
from runningbond.scene.folder_lock import locked

from .terminal import (
    DONE,
    NO_ANSWER,
    Flag,
    Tolerance,
    check_jobs,
    print_table,
    progress_bar,
    remarks,
    report_interrupt,
)


def compare(
    *scenes: str,
    models: str | None = None,
    tolerance: Tolerance = TOLERANCE,
    out: Path = Path("comparison"),
    jobs: int = -1,
    cluster: str | None = None,
    fresh: Flag = False,
) -> int:
    """Run models on scenes and tabulate them beside the published values.

    Every result is stored as soon as it is available; an interrupted comparison continues from there.

    Parameters
    ----------
    scenes
        Scene files or names; all published walls if none is given.
    models
        Names of models, separated by commas; all models if none is given.
    out
        Folder for results, tables and charts.
    jobs
        Number of processes; -1 for one per core.
    cluster
        Run on the workers of a Dask cluster: the address of its scheduler, such as tcp://host:8786, or its file.
    fresh
        Compute again results that are already stored.
    """
    names = list(MODELS) if models is None else [name.strip() for name in models.split(",")]
    chosen = [find_model(name, "--models") for name in dict.fromkeys(names)]
    check_tolerance(tolerance, "--tolerance")
    check_jobs(jobs)
    if cluster is not None and jobs != -1:
        raise SceneError("--jobs", "does not go with --cluster, whose workers are as many as it has", jobs)
    if cluster is not None and find_spec("distributed") is None:
        raise SceneError("--cluster", "needs Dask: pip install 'runningbond[cluster]'", cluster)
    if cluster is not None:
        from runningbond.campaigns.cluster import scheduler_address

        scheduler_address(cluster)
    walls, published = _read_all(scenes or [case.name for case in PUBLISHED])
    make_folder(out)
    for name, wall in walls.items():
        for line in remarks(wall):
            kind, _, what = line.partition(": ")
            print(f"{kind}: {name}: {what}", file=sys.stderr)
    total = len(walls) * len(chosen)
    try:
        with progress_bar("comparing", total) as advance:
            campaign = run_campaign(
                walls,
                chosen,
                folder=out,
                tolerance=tolerance,
                jobs=jobs,
                cluster=cluster,
                fresh=fresh,
                progress=lambda cell: advance(", ".join(cell)),
            )
    except Interrupted as stopped:
        return report_interrupt(stopped, total, "cases", out, fresh=fresh)
    with locked(out):  # if two comparisons end at once, all files are from one of them
        # The machine that waits for a cluster may be shared.
        _report(Comparison(walls, chosen, campaign, published), out, tolerance, jobs if cluster is None else 1)
    for (name, model), reason in campaign.inapplicable.items():
        if name not in published:  # for published walls this is documented
            print(f"note: {name}, {model}: {reason}", file=sys.stderr)
    failed = [(cell, outcome.message) for cell, outcome in campaign.outcomes.items() if outcome.status == "failed"]
    for cell, message in failed:
        print(f"{', '.join(cell)}: {message}", file=sys.stderr)
    return NO_ANSWER if failed else DONE


def _read_all(scenes: Sequence[str]) -> tuple[dict[str, Scene], dict[str, PublishedCase]]:
    """Scenes by name, and the published cases among them."""
    walls: dict[str, Scene] = {}
    published: dict[str, PublishedCase] = {}
    for scene in scenes:
        path = find_scene(scene)
        name = plain_stem(path)
        if not name.strip("."):
            raise SceneError(scene, "must have a name before .toml that is more than dots; results are kept by it")
        if name in walls:
            raise SceneError(scene, f'is the second scene called "{name}"; results are kept by file name')
        try:
            walls[name] = read_scene(path)
        except SceneError as error:  # add the name of the file
            key = error.key if error.key.startswith(str(path)) else f"{path}: {error.key}"
            raise SceneError(key, error.remedy, error.value) from error
        case = published_case(path)
        if case is not None:
            published[name] = case
    return walls, published


def _report(comparison: Comparison, out: Path, tolerance: float, jobs: int) -> None:
    from runningbond.campaigns.processes import in_background
    from runningbond.compare import figures, plates
    from runningbond.compare.report import report_html

    campaign, is_used = comparison.campaign, (out / "table.csv").exists()
    sheets = [*multiplier_sheets(comparison), *cost_sheets(comparison)]
    write_atomically(out / "table.csv", csv_text(comparison).encode())
    write_atomically(out / "table.md", "\n".join(sheet.markdown() for sheet in sheets).encode())
    for sheet in sheets:
        print_table(sheet)
    print(f"{counted(len(campaign), 'case')}, {len(campaign.reused)} of them already in {out}")
    drawings = plates.plate_drawings(comparison)
    with in_background(list(drawings.values()), jobs) as drawn:
        charts = figures.charts_of(comparison.only_published())
        pictures = figures.draw_figures(charts, out)
        page = report_html(comparison, charts, tolerance)
        for name, content in zip(drawings, drawn, strict=True):
            write_atomically(out / name, content)
            pictures.append(out / name)
    if is_used:  # remove pictures of an earlier comparison with other walls
        for older in {out / name for name in (*figures.FILES, *plates.FILES)}.difference(pictures):
            older.unlink(missing_ok=True)
    write_atomically(out / "report.html", page.encode())
    tables = [out / name for name in ("table.csv", "table.md", "report.html")]
    print(f"written: {', '.join(map(str, [*tables, *pictures]))}")
