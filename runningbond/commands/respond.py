"""``runningbond respond``."""

import json as to_json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from runningbond.compare.published import find_scene
from runningbond.models import MODELS, check_response
from runningbond.models import respond as respond_with
from runningbond.pictures.sheet import csv_lines
from runningbond.pictures.time_series import KINDS, MACRO
from runningbond.results import Outcome, write_atomically
from runningbond.results.store import RESPONSE_RECORD, save_response
from runningbond.scene import read_scene

from .left_behind import RESPONSE_FILES, holds_results, own_folder, remove_older
from .terminal import DONE, NO_ANSWER, Json, SceneName, Together, progress_line, remarks, tell

if TYPE_CHECKING:
    from runningbond.response import Response
    from runningbond.scene import Scene


def respond(
    scene: SceneName,
    /,
    *,
    model: Annotated[str, Parameter(help=f"One of {', '.join(name for name, one in MODELS.items() if one.respond)}.")],
    scale: Annotated[float, Parameter(help="Factor on the record, λ.")] = 1.0,
    json: Json = False,
    out: Path | None = None,
) -> int:
    """Compute the response of a wall to ground motion, and say whether it stands.

    Parameters
    ----------
    model
        Name of the model.
    out
        Folder for the response as a table and as a chart, and for its time series for ParaView, from which render
        makes a film.
    """
    from runningbond.pictures.progress import ResponseProgress

    wall = read_scene(find_scene(scene))
    check_response(model, wall, scale, "--model", "--scale")
    progress = ResponseProgress()
    observers, settings = list[Callable[..., None]]([progress]), dict[str, Any]()
    recorder, is_new, is_used = None, out is not None and not out.exists(), holds_results(out)
    if out is not None:
        from runningbond.pictures.recording import ResponseRecorder
        from runningbond.response.follow import AFTER

        recorder = ResponseRecorder(wall, out)
        observers.append(recorder)
        settings["after"] = AFTER
    with own_folder(out), progress_line(model, progress.line):
        response = respond_with(model, wall, scale, observe=Together(observers), **settings)
    for line in remarks(wall):
        tell(line, error=True)
    summary = response.summary()
    text = f"{response.scene}: {response.model}, λ {scale:g}\n  {response.line}\n  {response.steps} steps, "
    tell(to_json.dumps(summary, allow_nan=False) if json else f"{text}{response.seconds:.3g} s")
    if out is not None and recorder is not None:
        recorder.finish(Outcome(wall.title, response.model, "undecided", upper=scale))
        if is_used:
            remove_older(out, record=True)
        if len(response.time):
            _keep(response, wall, out)
            if not json:
                written = (RESPONSE_RECORD, *RESPONSE_FILES, *(f"{kind}.pvd" for kind in KINDS), MACRO)
                print("\n".join(str(out / name) for name in written))
        elif is_new:
            with suppress(OSError):  # another process has used it since
                out.rmdir()
    return NO_ANSWER if response.verdict == "undecided" else DONE


def _keep(response: "Response", wall: "Scene", out: Path) -> None:
    """Write the response of a wall as a table and a chart, and the record of the response with the scene."""
    from runningbond.pictures.captions import to_png
    from runningbond.pictures.response import response_figure

    columns, (series, chart) = response.columns(), RESPONSE_FILES
    rows = [[float(x) for x in row] for row in zip(*columns.values(), strict=True)]
    write_atomically(out / series, csv_lines([list(columns), *rows]).encode())
    write_atomically(out / chart, to_png(response_figure(response, wall)))
    save_response(response.summary(), wall, out)
