"""The page of the laboratory: error against experiment over cost, scores, one card per wall, and sources."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from runningbond.compare.advice.experiment import FILE, write_errors
from runningbond.pictures.legend import thickness_text
from runningbond.pictures.sheet import Sheet
from runningbond.results import write_atomically
from runningbond.results.outcome import two_digits
from runningbond.scene import BlockMaterial, JointMaterial, Mortar, SceneError, Stiffness, table_of
from runningbond.studies.page import Block, Picture, write_page, write_picture

from .cards import card, drawn_by, error_over_cost
from .ladder import LADDER, Rung
from .measured import MeasuredWall
from .notes import notes_on
from .predictions import Prediction
from .rig import driven_path, vertical_load
from .scores import has_cycles
from .stones import sources
from .summary import model_errors, percent, summary_sheet, totals, verdicts

NAME = "laboratory"
OVER_COST = (
    "Error against experiment over cost: one point per wall; large points are medians of models, dashed lines formulas "
    "worked out by hand."
)
LEGEND = (
    "ΔV is the predicted strength divided by the measured one, minus 1; the strength of a wall that is pushed to both "
    "sides is the mean of both. Other columns are ratios of predicted to measured values: *stiffness* of the secant at "
    "0.3 of the strength, *at peak* and *at 0.8* of the displacements at the largest force and where the force has "
    "fallen to 0.8 of it, *cycles* of the peaks of cycles (mean), *energy* of the dissipated work, *residual* of the "
    "largest displacement without force. Modes: R/TC is rocking with toe crushing, F a stepped diagonal crack, SL "
    "sliding; a prediction is right if the report names its mode. A dash means that there is no such value. No "
    "parameter is fitted to a test."
)


def write_laboratory(predictions: Sequence[Prediction], folder: Path, refused: Sequence[SceneError] = ()) -> list[Path]:
    """Write the page and its charts into a folder, with the reasons for refused walls; returns the written files."""
    sums = totals(predictions)
    blocks: list[Block] = ["# The laboratory: measured walls, predicted blind", *verdicts(sums)]
    blocks += [f"**Not predicted**: {error}" for error in refused]
    blocks += [LEGEND, summary_sheet(sums), _chart(predictions, folder), error_sheet(predictions)]
    blocks.append(score_sheet(predictions))
    blocks.append(
        Sheet("Models", ("model", "what it is"), [[rung.name, rung.model.title] for rung in _rungs(predictions)])
    )
    for wall in _walls(predictions):
        blocks += _wall(wall, [each for each in predictions if each.wall is wall], folder)
    blocks += ["## Where numbers come from", sources()]
    write_atomically(folder / FILE, write_errors(model_errors(predictions)).encode())
    before = _pictured(folder)
    written = write_page(NAME, blocks, folder, NAME)
    for older in before.difference(written):
        older.unlink(missing_ok=True)
    return written


def _pictured(folder: Path) -> set[Path]:
    """Pictures of walls of an earlier page in the folder, if there is one."""
    page = folder / f"{NAME}.md"
    text = page.read_text(encoding="utf-8", errors="replace") if page.is_file() else ""
    return {folder / name for name in re.findall(r"^!\[.*\]\(<?(wall-[^/\\\n]+\.png)>?\)$", text, re.MULTILINE)}


def _walls(predictions: Sequence[Prediction]) -> list[MeasuredWall]:
    return list({each.wall.name: each.wall for each in predictions}.values())


def _rungs(predictions: Sequence[Prediction]) -> list[Rung]:
    used = {each.rung.name for each in predictions}
    return [rung for name, rung in LADDER.items() if name in used]


def _chart(predictions: Sequence[Prediction], folder: Path) -> Picture:
    figure = Figure(figsize=(11, 5), layout="constrained")
    error_over_cost(figure, predictions)
    return write_picture(figure, folder / "error-over-cost.png", OVER_COST, dots=150)


def error_sheet(predictions: Sequence[Prediction]) -> Sheet:
    """Table of ΔV, one row per wall and one column per model."""
    rungs, rows = _rungs(predictions), list[list[str]]()
    for wall in _walls(predictions):
        errors = {each.rung.name: percent(each.error, "+") for each in predictions if each.wall is wall}
        name = wall.name if wall.is_scored else f"{wall.name} (not scored)"
        peak = "–" if wall.peak is None else f"{wall.peak / 1e3:.1f}"
        rows.append([name, peak, *(errors.get(rung.name, "–") for rung in rungs)])
    return Sheet("ΔV", ("wall", "measured [kN]", *(rung.name for rung in rungs)), rows)


def score_sheet(predictions: Sequence[Prediction]) -> Sheet:
    """Table of all scores, one row per wall and model."""
    ratios_of = {
        "stiffness": "stiffness_ratio",
        "at peak": "peak_displacement_ratio",
        "at 0.8": "drift_ratio",
        "cycles": "cycle_ratio",
        "energy": "energy_ratio",
        "residual": "residual_ratio",
    }
    heads = ("wall", "model", "status", "V [kN]", "measured", "ΔV", *ratios_of, "mode (measured)", "CPU s")
    rows = []
    for row in (each.row() for each in predictions):
        forces = ["–" if row[key] is None else f"{row[key] / 1e3:.1f}" for key in ("V_max", "V_measured")]
        ratios = ["–" if row[key] is None else f"{row[key]:.2f}" for key in ratios_of.values()]
        mode = f"{row['mode'] or '–'} ({row['mode_measured'] or '–'})"
        seconds = "–" if row["seconds"] is None else two_digits(row["seconds"])
        error = percent(row["dV"], "+") + ("" if row["scored"] else " (not scored)")
        rows.append([row["wall"], row["model"], row["status"], *forces, error, *ratios, mode, seconds])
    return Sheet("Scores", heads, rows)


def _wall(wall: MeasuredWall, own: Sequence[Prediction], folder: Path) -> list[Block]:
    caption = "Measured and predicted curves"
    if drawn := drawn_by(own):
        caption += f", and the motion of failure by {drawn.rung.name}"
    if wall.cracks:
        caption += ", beside the cracks"
    picture = write_picture(card(own), folder / f"wall-{wall.name}.png", caption + ".", dots=150)
    told = [f"Published in {wall.reference}. {_rig(wall, own[0])}", *(f"Note: {note}." for note in notes_on(wall))]
    if not wall.is_scored:
        told.append("Shown, not scored: it took more than rocking or friction allow; its beam was not as free as said.")
    said = [[each.rung.name, each.row()["message"]] for each in own]
    messages = Sheet("What the models say", ("model", "message"), said)
    richest = max(own, key=lambda each: list(LADDER).index(each.rung.name))
    return [f"## {wall.name}", *told, picture, _parameters(richest), messages]


def _parameters(one: Prediction) -> Sheet:
    """Table of all material parameters that a model receives, by their keys in the scene file."""
    materials: list[BlockMaterial | JointMaterial] = [*one.scene.block_materials, *one.scene.joint_materials]
    numbers = ((f"{table_of(each)}.{key}", f"{value:.5g}") for each in materials for key, value in _numbers(each))
    rows = [list(row) for row in dict.fromkeys(numbers)]  # copies of one material are equal
    return Sheet(f"Materials, as {one.rung.name} is handed them, in SI units", ("key", "value"), rows)


def _numbers(part: Any) -> Iterator[tuple[str, float]]:
    """Numbers of a material and its parts that are not the defaults, by key; of a joint that crushes C_ss as well."""
    crushes = getattr(part, "compressive_strength", None) is not None
    for entry in fields(part):
        value = getattr(part, entry.name)
        if isinstance(value, Stiffness):
            yield from ((f"{key}_stiffness", number) for key, number in _numbers(value))
        elif isinstance(value, Mortar):
            yield from ((f"mortar.{key}", number) for key, number in _numbers(value))
        elif is_dataclass(value):
            yield from ((f"{entry.name}.{key}", number) for key, number in _numbers(value))
        elif isinstance(value, float) and (value != entry.default or (crushes and entry.name == "cap_shear")):
            yield entry.name, value


def _rig(wall: MeasuredWall, one: Prediction) -> str:
    """Size and loads, as text."""
    beam = one.scene.beam
    (left, bottom), (right, top) = one.scene.blocks.extent(one.scene.masonry)
    pressed = -beam.force[1] if beam else vertical_load(wall)
    where = "from a scene of its own" if wall.scene_file else f"from line {wall.row.line} of {wall.row.path.name}"
    kind = "pushed to and fro" if has_cycles(driven_path(wall)) else "pushed to one side"
    return (
        f"{1e3 * (right - left):.0f} × {1e3 * (top - bottom):.0f} mm, {thickness_text(one.scene)}, under "
        f"{pressed / 1e3:.0f} kN, {kind}; made {where}."
    )
