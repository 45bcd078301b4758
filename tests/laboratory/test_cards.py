"""The summary picture of a tested wall."""

import io
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imsave
from matplotlib.text import Annotation
from PIL import Image

from runningbond.laboratory.cards import card, drawn_by, error_over_cost
from runningbond.laboratory.folder import SHIPPED, read_folder, shipped_walls
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.page import score_sheet
from runningbond.laboratory.predictions import Prediction, predict, scenes_of
from runningbond.laboratory.rig import Features, _tables, scene_of
from runningbond.results import Outcome
from tests.laboratory.folders import CURVE, GRANITE, write_folder
from tests.walls import write_toml

PIXEL = 1.0


@pytest.mark.long
def test_card_draws_the_model_nearest_to_the_test_and_clips_no_text(tmp_path: Path) -> None:
    """Not the costliest model, nor one without a motion; the title of the tall wall J4D was once clipped."""
    walls = [wall for wall in read_folder(SHIPPED[1]) if wall.name == "J4D"]
    rungs = [LADDER[name] for name in ("rocking", "sliding", "limit-crushing", "rigid-finite", "rigid")]
    predictions, _ = predict(walls, rungs, scenes_of(walls, rungs), tmp_path, jobs=1)
    figure = card(predictions)
    figure.savefig(io.BytesIO(), dpi=150)
    words = [each for each in figure.findobj(Annotation) if each.get_text()]
    assert any(each.get_text().startswith("rigid-finite: P = ") for each in words)
    for each in words:
        box = each.get_window_extent()
        assert figure.bbox.y0 <= box.y0
        assert box.y1 <= figure.bbox.y1 + PIXEL


@pytest.mark.parametrize("first", [1, -1])
def test_card_of_cycles_without_a_record_has_the_envelope_of_their_prediction(first: int, tmp_path: Path) -> None:
    """Cycles of 1 and 2 mm, each twice, in a scene: a curve starts to the positive side, whichever that is."""
    folder = write_folder(tmp_path / "walls", "pier,Cyclic,,,,,,,,,,44,,R")
    (folder / "pier.csv").unlink()
    tables = _tables(read_folder(write_folder(tmp_path / "row", GRANITE))[0], Features())
    tables["beam"]["drive"] = {"amplitudes": [first * 1e-3, first * 2e-3], "cycles": 2, "at": 1.325}
    write_toml(tables, folder / "pier.toml")
    (wall,), rung = read_folder(folder), LADDER["rigid"]
    goals = np.array([0.0, 1, -1, 1, -1, 2, -2, 2, -2, 0])
    moved = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(goals)])
    outcome = Outcome("", "", "collapse", 20.0, curve=np.column_stack([1e-3 * moved, 10e3 * moved]))
    figure = card([Prediction(wall, rung, scene_of(wall, rung.features), outcome)])
    (line,) = [each for each in figure.axes[0].lines if each.get_marker() == "o"]
    assert np.asarray(line.get_xydata()) == pytest.approx(np.array([(-2, -20), (-1, -10), (1, 10), (2, 20)]), rel=0.03)


def test_card_of_loads_alone_has_no_axis_of_displacements(tmp_path: Path) -> None:
    """There is neither a record nor a curve; the axis from 0 to 1 mm belonged to nothing."""
    walls = [replace(wall, curve=np.zeros((0, 2))) for wall in read_folder(write_folder(tmp_path / "walls", GRANITE))]
    rung = LADDER["limit"]
    (loads, *_), _ = predict(walls, [rung], scenes_of(walls, [rung]), tmp_path, jobs=1)
    axes = card([loads]).axes[0]
    assert not len(axes.get_xticks())
    assert not axes.get_xlabel()
    followed = replace(loads, wall=replace(walls[0], curve=np.array([(0.0, 0.0), (0.01, 61e3)])))
    assert card([followed]).axes[0].get_xlabel().endswith("[mm]")


def test_mechanism_against_its_loads_is_not_drawn(tmp_path: Path) -> None:
    """The panel of the nearest model was once the undeformed wall, called the motion of failure."""
    walls = read_folder(write_folder(tmp_path / "walls", GRANITE))
    pushed, driven = LADDER["limit"], LADDER["rigid"]
    (sound,), _ = predict(walls, [pushed], scenes_of(walls, [pushed]), tmp_path, jobs=1)
    assert sound.outcome is not None
    curve = np.array([(0.0, 0.0), (0.01, 61e3)])
    motion, load = sound.outcome.motion, sound.outcome.multiplier
    followed = Outcome("", "", "collapse", load, motion=motion, curve=curve)
    nearest = Prediction(walls[0], driven, scene_of(walls[0], driven.features), followed)
    assert drawn_by([sound, nearest]) is nearest
    backward = replace(nearest, outcome=replace(followed, motion=-motion))
    assert drawn_by([backward, sound]) is sound
    assert drawn_by([backward]) is None
    assert len(card([backward]).axes) == 1


@pytest.mark.parametrize("status", ["collapse", "undecided"])
def test_mechanism_has_the_strength_and_status_of_the_table(status: Literal["collapse", "undecided"]) -> None:
    """A wall that was followed to the end of its path was once called undecided, with a bound for its strength."""
    wall, rung = shipped_walls()["J4D"], LADDER["rigid"]
    scene = scene_of(wall, rung.features)
    motion = np.zeros((len(scene.blocks), 3))
    motion[scene.wall & (scene.blocks.centroid[:, 1] > 0.5), 0] = 1.0
    load = 6e4 if status == "collapse" else None
    curve = np.array([(0.0, 0.0), (0.004, 64.14e3)])
    outcome = Outcome("J4D", "rigid", status, load, lower=6e4, motion=motion, curve=curve)
    (row,) = score_sheet([one := Prediction(wall, rung, scene, outcome)]).rows
    assert row[2:4] == [one.status, "64.1"]
    told = [each.get_text() for each in card([one]).findobj(Annotation)]
    assert f"rigid: P = 64.1 kN, {one.status}" in told
    assert (one.status == "followed") == (status == "undecided")


@pytest.mark.parametrize("side", [1, -1])
def test_crack_map_of_a_wall_pushed_to_the_left_is_mirrored(side: int, tmp_path: Path) -> None:
    """Its record is mirrored and the prediction goes to the right; the cracks are dark on the side it leaned to."""
    points = [line.split(",") for line in CURVE.split()[1:]]
    curve = "displacement_mm,force_kN\n" + "".join(f"{side * float(x):g},{side * float(y):g}\n" for x, y in points)
    folder = write_folder(tmp_path / "walls", GRANITE, curve=curve)
    cracks = np.ones((2, 4))
    cracks[:, 2 if side > 0 else 1] = 0.0
    imsave(folder / "WS.175-cracks.png", cracks, cmap="gray")
    (wall,), rung = read_folder(folder), LADDER["rocking"]
    predictions, _ = predict([wall], [rung], scenes_of([wall], [rung]), tmp_path, jobs=1)
    (image,) = (image for axes in card(predictions).axes for image in axes.images)
    assert np.asarray(image.get_array())[0, :, 0].tolist() == [1.0, 1.0, 0.0, 1.0]
    assert ("mirrored" in image.axes.get_title()) == (side < 0)


@pytest.mark.parametrize("has_curve", [True, False])
def test_legend_lists_only_what_is_drawn(has_curve: bool, tmp_path: Path) -> None:
    """It once listed the peaks of cycles for a wall without a record."""
    folder = write_folder(tmp_path / "walls", GRANITE.replace("Monotonic", "Cyclic"))
    if not has_curve:
        (folder / "WS.175.csv").unlink()
    walls, rung = read_folder(folder), LADDER["rocking"]
    predictions, _ = predict(walls, [rung], scenes_of(walls, [rung]), tmp_path, jobs=1)
    lines = card(predictions).axes[0].get_legend_handles_labels()
    assert all(len(np.ravel(line.get_xdata())) for line in lines[0])  # type: ignore[attr-defined]
    assert ("measured, peaks of its cycles" in lines[1]) == has_curve


@pytest.mark.parametrize("mode", ["L", "1", "RGB", "P"])
def test_grey_crack_maps_are_drawn_in_grey(mode: str, tmp_path: Path) -> None:
    """Single-channel scans were once drawn in a chart's colour map: yellow paper and dark purple cracks."""
    folder = write_folder(tmp_path / "walls", GRANITE)
    Image.fromarray(np.array([[255, 255], [0, 255]], dtype=np.uint8)).convert(mode).save(folder / "WS.175-cracks.png")
    (wall,), rung = read_folder(folder), LADDER["rocking"]
    predictions, _ = predict([wall], [rung], scenes_of([wall], [rung]), tmp_path, jobs=1)
    (image,) = (image for axes in card(predictions).axes for image in axes.images)
    assert isinstance(drawn := image.get_array(), np.ndarray)
    expected = np.repeat([[[1.0], [1.0]], [[0.0], [1.0]]], 3, axis=2)
    assert np.asarray(image.to_rgba(drawn))[:, :, :3] == pytest.approx(expected)


@pytest.mark.parametrize("seconds", [(1.13, 1.37), (0.9, 1.1), (0.5, 0.5), (0.02, 30.0)])
def test_tick_labels_of_similar_costs_do_not_overlap(seconds: tuple[float, float], tmp_path: Path) -> None:
    """Ticks from 1.13 to 1.37 s were once labelled 1.15 × 10⁰, 1.2 × 10⁰ and so on, one over the other."""
    rows = [GRANITE, GRANITE.replace("WS.175", "WS2.175")]
    walls, rung = read_folder(write_folder(tmp_path / "walls", *rows)), LADDER["limit"]
    predictions, _ = predict(walls, [rung], scenes_of(walls, [rung]), tmp_path, jobs=1)
    outcomes = [each.outcome for each in predictions if each.outcome]
    alike = [
        replace(each, outcome=replace(outcome, seconds=cost))
        for each, outcome, cost in zip(predictions, outcomes, seconds, strict=True)
    ]
    figure = Figure(figsize=(5, 5), layout="constrained")
    error_over_cost(figure, alike)
    figure.draw_without_rendering()
    axis = figure.axes[0].xaxis
    boxes = [each.get_window_extent() for each in axis.get_ticklabels(which="both") if each.get_text()]
    low, high = figure.axes[0].get_window_extent().intervalx
    boxes = sorted(
        (box for box in boxes if low - PIXEL <= (box.x0 + box.x1) / 2 <= high + PIXEL), key=lambda box: box.x0
    )
    assert len(boxes) >= 2
    assert all(box.x1 < after.x0 for box, after in pairwise(boxes))
