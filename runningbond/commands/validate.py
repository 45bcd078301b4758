"""``runningbond validate``."""

import json as to_json
import sys
from pathlib import Path

from runningbond.campaigns import Interrupted
from runningbond.pictures.quantities import counted
from runningbond.results import make_folder
from runningbond.scene import SceneError
from runningbond.scene.folder_lock import locked

from .terminal import (
    BAD_INPUT,
    DONE,
    NO_ANSWER,
    UNDECIDED,
    Flag,
    Json,
    check_jobs,
    print_table,
    progress_bar,
    report_interrupt,
    say,
)


def validate(
    *,
    data: Path | None = None,
    out: Path = Path("laboratory"),
    models: str | None = None,
    jobs: int = -1,
    fresh: Flag = False,
    json: Json = False,
) -> int:
    """Predict walls that were tested, and score the predictions beside two hand formulas.

    Every result is stored as soon as it is available; an interrupted command continues from there. A wall with an
    invalid description is refused in one line, and the others are predicted.

    Parameters
    ----------
    data
        Folder of tested walls, instead of the shipped ones: tests.csv, and optionally NAME.csv, NAME.toml and
        NAME-cracks.png.
    out
        Folder for results, charts and the page.
    models
        Names of models of the laboratory, separated by commas; all models if none is given.
    jobs
        Number of processes; -1 for one per core.
    fresh
        Compute again results that are already stored.
    """
    from runningbond.laboratory.folder import SHIPPED, read_folder, unused
    from runningbond.laboratory.ladder import find_rungs
    from runningbond.laboratory.notes import notes_on
    from runningbond.laboratory.page import error_sheet, score_sheet, write_laboratory
    from runningbond.laboratory.predictions import predict, scenes_of
    from runningbond.laboratory.summary import as_json, summary_sheet, totals, verdicts

    rungs = find_rungs(models)
    check_jobs(jobs)
    refused, folders = list[SceneError](), (data,) if data else SHIPPED
    walls = [wall for folder in folders for wall in read_folder(folder, refused.append)]
    scenes = scenes_of(walls, rungs, refused.append)
    walls = [wall for wall in walls if (wall.name, rungs[0].name) in scenes]
    for error in refused:
        say(str(error))
    reasons = {"refused": [str(error) for error in refused]}
    if not walls:
        if json:
            print(to_json.dumps({"walls": [], "summary": as_json([]), **reasons}))
        return BAD_INPUT
    for name in (name for folder in folders for name in unused(folder)):
        print(f"note: {name} belongs to no wall in the table", file=sys.stderr)
    for wall in walls:
        for note in notes_on(wall):
            print(f"note: {wall.name}: {note}", file=sys.stderr)
    make_folder(out)
    total = len(walls) * len(rungs)
    try:
        with progress_bar("predicting", total) as advance:
            predictions, campaign = predict(
                walls, rungs, scenes, out, jobs=jobs, fresh=fresh, progress=lambda cell: advance(", ".join(cell))
            )
    except Interrupted as stopped:
        return report_interrupt(stopped, total, "cases", out, fresh=fresh)
    with locked(out):
        written = write_laboratory(predictions, out, refused)
    sums = totals(predictions)
    if json:
        content = {"walls": [each.row() for each in predictions], "summary": as_json(sums), **reasons}
        print(to_json.dumps(content, allow_nan=False))
    else:
        for sheet in (score_sheet(predictions), error_sheet(predictions), summary_sheet(sums)):
            print_table(sheet)
        print("\n".join(verdicts(sums)).replace("**", ""))  # bold marks of the page
        kept = f"{counted(total, 'case')}, {len(campaign.reused)} of them already in {out}"
        print(f"{kept}; written: {written[0]}, {written[1]}")
    if refused:
        return BAD_INPUT
    return NO_ANSWER if any(each.status in UNDECIDED for each in predictions) else DONE
