"""``runningbond validate``: its output, files, cache and refusals, for walls that are not shipped."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from runningbond.commands.command_line import command
from runningbond.laboratory import read_folder
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.page import _parameters
from runningbond.laboratory.predictions import Prediction
from runningbond.laboratory.rig import Features, scene_of
from runningbond.results import Outcome
from runningbond.scene import Drive, SceneError
from tests.at_length import at_length
from tests.walls import write_toml

from .folders import GRANITE, HEADS, SANDSTONE, write_folder

QUICK = ["--models", "rocking,sliding,by-hand,limit", "--jobs", "1"]
KEYS = {
    "wall",
    "model",
    "status",
    "V_max",
    "V_measured",
    "dV",
    "stiffness_ratio",
    "drift_ratio",
    "mode",
    "mode_measured",
}


def test_joints_of_one_kind_are_summed_up_under_one_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_folder(tmp_path / "walls", GRANITE, SANDSTONE.replace("Dry", "Dry joints"))
    arguments = ["--data", str(folder), "--out", str(tmp_path / "out"), "--models", "rocking", "--json"]
    assert command(["validate", *arguments]) == 0
    assert printed(capsys)["summary"]["dry"]["rocking"]["walls"] == 2


@pytest.fixture
def walls(tmp_path: Path) -> list[str]:
    return ["--data", str(write_folder(tmp_path / "walls", GRANITE, SANDSTONE)), "--out", str(tmp_path / "out")]


def printed(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """The single JSON object on standard output, without NaN."""
    content: dict[str, Any] = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    return content


def test_own_walls_are_predicted_and_scored(
    walls: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rocking: 175 / 2.65 and 100 / 2 kN."""
    assert command(["validate", *walls, *QUICK, "--json"]) == 0
    content = printed(capsys)
    rows = {(row["wall"], row["model"]): row for row in content["walls"]}
    assert len(rows) == 8
    assert all(KEYS | {"seconds", "message"} <= set(row) for row in rows.values())
    rocking = rows["WS.175", "rocking"]
    assert rocking["V_max"] == pytest.approx(175e3 / 2.65)
    assert rocking["V_measured"] == 61e3
    assert rocking["dV"] == pytest.approx(175 / 2.65 / 61 - 1)
    assert rocking["stiffness_ratio"] is None
    assert rows["SW.100.1", "by-hand"]["V_max"] == pytest.approx(50e3)
    assert rows["SW.100.1", "limit"]["V_max"] == pytest.approx(50e3, rel=0.05)
    assert rows["WS.175", "limit"]["mode"] == "R/TC"
    assert content["summary"]["dry"]["limit"]["walls"] == 2
    assert content["summary"]["cheapest"] is None
    out = tmp_path / "out"
    page = (out / "laboratory.md").read_text()
    assert all(
        word in page for word in ("# The laboratory", "## WS.175", "Where numbers come from", "not earned its cost")
    )
    assert "data:image/png;base64" in (out / "report.html").read_text()
    assert all((out / f"{name}.png").is_file() for name in ("error-over-cost", "wall-WS.175", "wall-SW.100.1"))


def test_pictures_of_removed_walls_are_deleted(tmp_path: Path) -> None:
    """Only those of the previous page; other files stay."""
    out, folder = tmp_path / "out", tmp_path / "walls"
    arguments = ["validate", "--data", str(folder), "--out", str(out), "--models", "rocking", "--jobs", "1"]
    write_folder(folder, GRANITE, SANDSTONE)
    assert command(arguments) == 0
    (out / "wall-of-mine.png").touch()
    write_folder(folder, GRANITE)
    assert command(arguments) == 0
    assert {path.name for path in out.glob("wall-*.png")} == {"wall-WS.175.png", "wall-of-mine.png"}


@pytest.mark.long
def test_walls_that_differ_only_in_name_are_computed_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    twin = GRANITE.replace("WS.175", "WS2.175").replace(",61,", ",70,")
    folder, out = write_folder(tmp_path / "walls", GRANITE, twin), tmp_path / "out"
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", "limit", "--json"]) == 0
    one, other = printed(capsys)["walls"]
    assert (one["wall"], other["wall"]) == ("WS.175", "WS2.175")
    assert one["V_max"] == other["V_max"]
    assert one["dV"] != other["dV"]
    assert (out / "WS.175" / "limit").is_dir()
    assert not (out / "WS2.175").exists()


def test_kept_results_are_not_computed_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, out = write_folder(tmp_path / "walls", GRANITE), str(tmp_path / "out")
    for models, cases, kept, more in (
        ("rocking", 1, 0, []),
        ("rocking,limit", 2, 1, []),
        ("rocking,limit", 2, 2, []),
        ("limit", 1, 0, ["--fresh"]),
    ):
        arguments = ["validate", "--data", str(folder), "--out", out, "--models", models, "--jobs", "1", *more]
        assert command(arguments) == 0
        told = capsys.readouterr().out
        assert f"{cases} case{'s' * (cases > 1)}, {kept} of them already in" in told
        assert "None reaches all of it." in told
        assert "**" not in told


def test_changed_row_is_predicted_again(walls: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["validate", *walls, *QUICK, "--json"]) == 0
    before = printed(capsys)["walls"]
    write_folder(tmp_path / "walls", GRANITE, SANDSTONE.replace(",200,1000,100,", ",200,2000,100,"))
    assert command(["validate", *walls, *QUICK, "--json"]) == 0
    after = printed(capsys)["walls"]
    loads = [{(row["wall"], row["model"]): row["V_max"] for row in rows} for rows in (before, after)]
    assert loads[1]["SW.100.1", "limit"] == pytest.approx(loads[0]["SW.100.1", "limit"] / 2, rel=0.05)
    assert loads[1]["WS.175", "limit"] == loads[0]["WS.175", "limit"]


def leaning(side: int) -> dict[str, Any]:
    """A wall shortened at the top behind its pushed side: pushed to the right with 1, its mirror image with -1."""
    courses = [[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1], [-1, 1, 1] if side > 0 else [1, 1]]
    return {
        "wall": {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2, "courses": courses},
        "block": {"density": 2000.0},
        "joint": {"friction": 0.7, "normal_stiffness": 5e9, "shear_stiffness": 2e9},
        "support": {"kind": "base"},
        "load": {"gravity": 9.81},
        "beam": {"height": 0.2, "force": [0, -2e4], "drive": {"displacement": [0.02 * side, 0]}},
    }


def test_wall_pushed_to_the_left_is_scored_as_its_mirror_image(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the direction of the push it rocks at 9.9 kN; to the other side it would slide, at 14 = 0.7 · 20 kN."""
    folder = write_folder(tmp_path / "walls", "left,,,,,,,,,,,,,R", "right,,,,,,,,,,,,,R")
    for name, side in (("left", -1), ("right", 1)):
        write_toml(leaning(side), folder / f"{name}.toml")
        points = "".join(f"{side * x:g},{side * min(2.0 * x, 5.0):g}\n" for x in range(21))
        (folder / f"{name}.csv").write_text(f"displacement_mm,force_kN\n{points}")
    arguments = ["--data", str(folder), "--out", str(tmp_path / "out"), "--models", "limit,rigid", "--jobs", "1"]
    assert command(["validate", *arguments, "--json"]) == 0
    found = printed(capsys)["walls"]
    for row, mirrored in zip(found[:2], found[2:], strict=True):
        assert (row["wall"], mirrored["wall"], row["mode"]) == ("left", "right", "R/TC")
        assert row["V_max"] == pytest.approx(mirrored["V_max"], rel=1e-3)
    assert found[0]["V_max"] == pytest.approx(9889, rel=1e-3)
    for key in ("stiffness_ratio", "peak_displacement_ratio"):
        assert found[1][key] == pytest.approx(found[3][key], rel=0.01)


def test_scores_come_with_the_values_that_they_compare(tmp_path: Path) -> None:
    """In N and m; ratios alone do not tell how far a wall went."""
    (wall,) = read_folder(write_folder(tmp_path, GRANITE))
    rung, curve = LADDER["rigid"], np.array([(0.0, 0.0), (1e-3, 33e3), (0.02, 66e3), (0.04, 33e3)])
    row = Prediction(wall, rung, scene_of(wall, rung.features), Outcome("", "", "collapse", 66e3, curve=curve)).row()
    assert (row["V_max"], row["at_peak"], row["at_loss"]) == pytest.approx((66e3, 0.02, 0.028))
    assert (row["V_measured"], row["at_peak_measured"]) == pytest.approx((61e3, 0.01))
    assert (row["at_loss_measured"], row["residual"]) == (None, None)
    assert row["stiffness"] / row["stiffness_measured"] == pytest.approx(row["stiffness_ratio"])
    assert row["stiffness_measured"] == pytest.approx(30e6)


@pytest.mark.parametrize("rest", [0.1, 0.0, -0.1])
def test_cycles_to_the_left_are_compared_whatever_the_unloading_point(rest: float, tmp_path: Path) -> None:
    """The record is mirrored; an outcome that is positive along its first move is not mirrored again."""
    path, points = [-2, rest, -4], [(0, 0), (-2, -4), (rest, 0), (-4, -5)]
    curve = "displacement_mm,force_kN\n" + "".join(f"{x},{y}\n" for x, y in points)
    folder = write_folder(tmp_path / "walls", "left,Cyclic,,,,,,,,,,,,R", curve=curve)
    tables = leaning(-1)
    tables["beam"]["drive"] = {"displacement": [[1e-3 * x for x in path]]}
    write_toml(tables, folder / "left.toml")
    (wall,) = read_folder(folder)
    rung = LADDER["rigid"]
    curved = Outcome("", "", "collapse", 5.5e3, curve=np.array(points) * (-1e-3, -1.1e3))
    row = Prediction(wall, rung, scene_of(wall, rung.features), curved).row()
    assert (row["dV"], row["cycle_ratio"]) == pytest.approx((0.1, 1.1))


@pytest.mark.parametrize(
    "drive", [{"force": [-5, 0], "at": 0.7}, {"displacement": [[0, -0.01, 0.01]]}, {"amplitudes": [-0.01]}]
)
def test_limit_analysis_pushes_in_the_direction_of_the_first_move(drive: dict[str, Any], tmp_path: Path) -> None:
    """With a drive of λ newtons at the same height."""
    folder = write_folder(tmp_path / "walls", "left,,,,,,,,,,,5,,R")
    tables = leaning(-1)
    tables["beam"]["drive"] = drive
    write_toml(tables, folder / "left.toml")
    (wall,) = read_folder(folder)
    assert scene_of(wall, Features(driven=False)).drive == Drive((-1.0, 0.0), drive.get("at"))


@pytest.mark.parametrize("features", [Features(), Features(driven=False)])
def test_strength_is_in_newtons_whatever_the_force_of_a_drive(features: Features, tmp_path: Path) -> None:
    """A drive of 1 kN once gave λ in kilonewtons, scored as newtons, in all models except limit analysis."""
    folder = write_folder(tmp_path / "walls", "right,,,,,,,,,,,5,,R")
    tables = leaning(1)
    tables["beam"]["drive"] = {"force": [1000, 0], "at": 0.7}
    write_toml(tables, folder / "right.toml")
    (wall,) = read_folder(folder)
    assert scene_of(wall, features).drive == Drive((1.0, 0.0), 0.7)


@pytest.mark.parametrize(
    ("force", "live", "said"),
    [([1, -1], {}, "beam.drive.force: must be horizontal"), ([1, 0], {"live": {"kind": "lateral"}}, "load.live: must")],
)
def test_wall_whose_multiplier_is_no_horizontal_strength_is_refused(
    force: list[float], live: dict[str, Any], said: str, tmp_path: Path
) -> None:
    folder = write_folder(tmp_path / "walls", "right,,,,,,,,,,,5,,R")
    tables = leaning(1)
    tables["beam"]["drive"] = {"force": force}
    tables["load"] |= live
    write_toml(tables, folder / "right.toml")
    (wall,) = read_folder(folder)
    with pytest.raises(SceneError, match=f"right.toml: {said}"):
        scene_of(wall, Features())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--models", "limti"], "--models = 'limti': must be of rocking"),
        (["--models", ""], "--models = '': must be of rocking"),
        (["--jobs", "0"], "--jobs = 0: must be a number of processes"),
        (["--data", "/nowhere"], "/nowhere: must be a folder that holds tests.csv"),
    ],
)
def test_bad_arguments_give_one_line_and_no_files(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(["validate", "--out", str(tmp_path / "out"), *arguments]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert len(told.err.splitlines()) == 1
    assert said in told.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("usual", "other", "column", "units"),
    [
        ("L [mm]", "L [kN]", "L", "mm, cm, m"),
        ("H0 [mm]", "H0 [%]", "H0", "mm, cm, m"),
        ("Ntot [kN]", "Ntot [MPa]", "Ntot", "N, kN"),
        ("Vmax,+ [kN]", "Vmax,+ [mm]", "Vmax,+", "N, kN"),
    ],
)
def test_units_of_another_quantity_are_refused(
    usual: str, other: str, column: str, units: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A length in kN was once read as one in km, and 39 mm as a load of 0.039 N."""
    folder = write_folder(tmp_path / "walls", GRANITE, heads=HEADS.replace(usual, other))
    assert command(["validate", "--data", str(folder), "--out", str(tmp_path / "out"), *QUICK]) == 2
    unit = other.partition("[")[2].rstrip("]")
    said = f"runningbond: WS.175: tests.csv, line 2: {column} = '{unit}': must have a unit, one of {units}\n"
    assert capsys.readouterr().err == said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("row", [GRANITE.replace("Granite", "Marble"), GRANITE.replace(",150,", ",15 cm,")])
def test_impossible_wall_gives_one_line_and_no_files(
    row: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_folder(tmp_path / "walls", row)
    assert command(["validate", "--data", str(folder), "--out", str(tmp_path / "out"), *QUICK, "--json"]) == 2
    told = capsys.readouterr()
    assert told.err.startswith("runningbond: WS.175: tests.csv, line 2: ")
    assert len(told.err.splitlines()) == 1
    refused = [told.err.removeprefix("runningbond: ").strip()]
    assert json.loads(told.out) == {"walls": [], "summary": {"cheapest": None}, "refused": refused}
    assert not (tmp_path / "out").exists()


def test_refused_wall_does_not_stop_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An invalid row, curve and scene are all reported, on the page as well."""
    marble = GRANITE.replace("WS.175", "marble").replace("Granite", "Marble")
    pushed = GRANITE.replace("WS.175", "scene")
    folder, out = write_folder(tmp_path / "walls", marble, GRANITE, pushed, SANDSTONE), tmp_path / "out"
    (folder / "scene.toml").write_text("[wall]\n")
    (folder / "SW.100.1.csv").write_text("mm,kN\n")
    arguments = ["validate", "--data", str(folder), "--out", str(out), "--models", "rocking", "--jobs", "1", "--json"]
    assert command(arguments) == 2
    told = capsys.readouterr()
    content = json.loads(told.out)
    assert [row["wall"] for row in content["walls"]] == ["WS.175"]
    lines = [
        "SW.100.1.csv, line 1 = 'mm,kN': must be the heads displacement_mm,force_kN",
        "marble: tests.csv, line 2: Stone = 'Marble': must be one of sandstone, granite; for another give a scene "
        "NAME.toml",
        "scene.toml: beam.drive: is missing; a tested wall is pushed at its beam",
    ]
    assert content["refused"] == lines
    assert [line for line in told.err.splitlines() if line.startswith("runningbond")] == [
        f"runningbond: {line}" for line in lines
    ]
    page = (out / "laboratory.md").read_text()
    assert all(f"**Not predicted**: {line}\n" in page for line in lines)
    assert "## marble" not in page


def test_scene_that_only_other_models_cannot_read_does_not_stop_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Notes on a wall read its inner joint whatever the models, and once ended the command without its name."""
    folder, out = write_folder(tmp_path / "walls", GRANITE, "pier,,,,,,,,,,,,,"), tmp_path / "out"
    write_toml(leaning(1) | {"inner_joint": {"friction": -0.7}}, folder / "pier.toml")
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", "rocking"]) == 2
    told = capsys.readouterr()
    assert "pier.toml: inner_joint.friction = -0.7: must be a number at least 0" in told.err
    assert "WS.175" in told.out
    assert "pier" not in told.out


def test_formulas_do_not_apply_to_a_wall_that_is_lifted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """They once rocked it at a negative force, 200 % below the test."""
    folder, out = write_folder(tmp_path / "walls", "pier,,,,,,,,,,,44,,R"), tmp_path / "out"
    tables = leaning(1)
    tables["beam"]["force"] = [0, 2e4]
    write_toml(tables, folder / "pier.toml")
    arguments = ["validate", "--data", str(folder), "--out", str(out), "--models", "rocking,by-hand,limit", "--json"]
    assert command([*arguments, "--jobs", "1"]) == 0
    rows = printed(capsys)["walls"]
    assert [row["status"] for row in rows] == ["inapplicable", "inapplicable", "infeasible"]
    assert {row["V_max"] for row in rows} == {None}
    assert rows[0]["message"].startswith("beam.force: lifts the wall; the formulas are of walls that are pressed")


def test_curves_without_a_wall_are_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a curve with a typing error in its name would go unnoticed."""
    folder = write_folder(tmp_path / "walls", GRANITE)
    (folder / "WS.175.csv").rename(folder / "WS 175.csv")
    assert command(["validate", "--data", str(folder), "--out", str(tmp_path / "out"), "--models", "rocking"]) == 0
    assert "note: WS 175.csv belongs to no wall in the table\n" in capsys.readouterr().err


def test_failure_types_that_are_not_understood_are_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """On standard error and on the page; once they were only left out."""
    folder, out = write_folder(tmp_path / "walls", GRANITE[:-1] + "R + fell over"), tmp_path / "out"
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", "rocking", "--json"]) == 0
    told = capsys.readouterr()
    assert [row["mode_right"] for row in json.loads(told.out)["walls"]] == [True]
    said = "failure type 'FELL OVER' is not understood and does not count; the words are R, TC, F, S, DT, SL, rocking, "
    assert f"note: WS.175: {said}" in told.err
    assert f"Note: {said}" in (out / "laboratory.md").read_text()


def test_cyclic_wall_without_a_record_is_said_to_be_pushed_to_one_side(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The page once called it pushed to and fro, as the test was, whatever the models did."""
    row = GRANITE.replace("Monotonic", "Cyclic")
    folder, out = write_folder(tmp_path / "walls", row, row.replace("WS.175", "WS2.175")), tmp_path / "out"
    (folder / "WS.175.csv").unlink()
    (folder / "WS2.175.csv").write_text("displacement_mm,force_kN\n0,0\n10,61\n9,0\n-10,-61\n")
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", "rocking"]) == 0
    notes = [line for line in capsys.readouterr().err.splitlines() if line.startswith("note: WS")]
    said = "the test was cyclic, but there is no WS.175.csv with its cycles; models push the wall to one side"
    assert notes == [f"note: WS.175: {said}"]
    page = (out / "laboratory.md").read_text()
    assert f"Note: {said}." in page
    assert (page.count("pushed to one side;"), page.count("pushed to and fro;")) == (1, 1)


@pytest.mark.parametrize(("side", "first"), [(1, -1), (-1, 1), *at_length((1, 1), (-1, -1))])
def test_scene_of_a_cyclic_test_may_push_to_one_side(side: int, first: int, tmp_path: Path) -> None:
    """It was called pushed to and fro, `fem` was refused, and a push to the side of the second half cycle not read."""
    curve = f"displacement_mm,force_kN\n0,0\n{2 * first},{4 * first}\n{-2 * first},{-4 * first}\n0,0\n"
    folder, out = write_folder(tmp_path / "walls", "pier,Cyclic,,,,,,,,,,,,R", curve=curve), tmp_path / "out"
    write_toml(leaning(side), folder / "pier.toml")
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", "rocking"]) == 0
    page = (out / "laboratory.md").read_text()
    said = (
        "the test was cyclic, but pier.toml pushes the wall to one side; only the strength of that side is comparable"
    )
    assert f"Note: {said}." in page
    assert "pushed to one side;" in page
    (wall,), rung = read_folder(folder), LADDER["rigid"]
    scene = scene_of(wall, rung.features)
    assert LADDER["fem-splitting"].leaves_out(scene) == ""
    pushed = Outcome("", "", "undecided", curve=np.array([(0.0, 0.0), (0.01, 4.4e3), (0.02, 4e3)]))
    row = Prediction(wall, rung, scene, pushed).row()
    assert (row["dV"], row["cycle_ratio"], row["stiffness_ratio"]) == (pytest.approx(0.1), None, None)


def test_drive_too_fast_for_time_steps_is_not_scored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It moved along the whole path, so that its force and stiffness were scored although the model gave no answer."""
    folder, tables = write_folder(tmp_path / "walls", "pier,Monotonic,,,,,,,,,,9,,R"), leaning(1)
    tables["beam"]["drive"]["rate"] = 1e3
    write_toml(tables, folder / "pier.toml")
    arguments = ["--data", str(folder), "--out", str(tmp_path / "out"), "--models", "rigid", "--jobs", "1", "--json"]
    assert command(["validate", *arguments]) == 3
    (row,) = printed(capsys)["walls"]
    assert (row["status"], row["V_max"], row["dV"], row["stiffness"], row["mode"]) == ("undecided", *4 * [None])
    assert "is too fast for its time steps" in row["message"]


@pytest.mark.parametrize(("model", "crushes"), [("limit", False), ("limit-crushing", True)])
def test_page_lists_the_shape_of_the_cap_of_joints_that_crush(model: str, crushes: bool, tmp_path: Path) -> None:
    """C_ss is a default for dry joints, and was once listed nowhere."""
    folder, out = write_folder(tmp_path / "walls", SANDSTONE), tmp_path / "out"
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", model, "--jobs", "1"]) == 0
    page = (out / "laboratory.md").read_text()
    assert ("| joint.cap_shear | 9 |" in page) == crushes
    assert "C_ss of their cap" in page


def test_page_lists_each_material_once_by_the_keys_of_scene_files(tmp_path: Path) -> None:
    """A copy of a joint that has no strength in places is listed with its own numbers only."""
    folder, out = write_folder(tmp_path / "walls", "pier,,,,,,,,,,,,,"), tmp_path / "out"
    mortar = {"young": 2e9, "poisson": 0.25, "thickness": 0.01}
    tables = leaning(1) | {"joint": {"friction": 0.7, "mortar": mortar}}
    tables["joints"] = {"lime": {"friction": 0.6, "normal_stiffness": 5e9, "shear_stiffness": 2e9}}
    tables["assign"] = [{"joint": "lime", "orientation": "head"}]
    write_toml(tables, folder / "pier.toml")
    scene = scene_of(read_folder(folder)[0], Features())
    (joint, lime) = scene.joint_materials
    twice = replace(scene, joint_materials=(joint, lime, replace(lime, friction=0.0)))
    assert command(["validate", "--data", str(folder), "--out", str(out), "--models", "rocking", "--jobs", "1"]) == 0
    page = (out / "laboratory.md").read_text()
    assert "| joint.mortar.young | 2e+09 |" in page
    assert "| joints.lime.normal_stiffness | 5e+09 |" in page
    one = Prediction(read_folder(folder)[0], LADDER["rigid"], twice, None)
    keys = [key for key, _ in _parameters(one).rows]
    assert [keys.count(f"joints.lime.{key}") for key in ("friction", "normal_stiffness")] == [2, 1]


def test_picture_of_a_wall_with_a_space_in_its_name_is_linked(tmp_path: Path) -> None:
    folder, out = write_folder(tmp_path / "walls", GRANITE.replace("WS.175", "Wand (Süd)")), tmp_path / "out"
    arguments = ["validate", "--data", str(folder), "--out", str(out), "--models", "rocking", "--jobs", "1"]
    assert command(arguments) == 0
    assert "](<wall-Wand (Süd).png>)\n" in (out / "laboratory.md").read_text()
    write_folder(folder, GRANITE)
    assert command(arguments) == 0
    assert [path.name for path in out.glob("wall-*.png")] == ["wall-WS.175.png"]


def test_model_without_an_answer_gives_exit_code_3(walls: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    rung = LADDER["limit"]
    silent = replace(rung, model=replace(rung.model, solve=lambda *_: Outcome("", "", "undecided", message="none")))
    with patch.dict(LADDER, {"limit": silent}):
        assert command(["validate", *walls, *QUICK, "--json"]) == 3
    rows = [row for row in printed(capsys)["walls"] if row["model"] == "limit"]
    assert {row["status"] for row in rows} == {"undecided"}
    assert {row["V_max"] for row in rows} == {None}
