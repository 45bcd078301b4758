"""``runningbond respond``: its report for walls that collapse under dead load, and the files it leaves."""

import json
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from runningbond.commands.command_line import command
from runningbond.commands.left_behind import holds_results
from runningbond.pictures.time_series import frame_files
from runningbond.results import load_scene
from tests.walls import content, write_toml

PULSE = {"pulse": {"kind": "sine", "amplitude": 2.0, "period": 0.05}, "quantity": "acceleration"}
SHAKEN = {"load__live": None, "load__history": PULSE}
LEANING = {**SHAKEN, "load__gravity": [9.0, -3.0]}
SIZE = {"wall__length": 0.24, "wall__height": 0.12, "wall__block_height": 0.12}
STIFF = {"joint__normal_stiffness": 1e9, "joint__shear_stiffness": 1e9}


@pytest.fixture
def ask(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Any:
    """Run a command on a block, with a folder for its results; return its output. All succeed."""

    def asked(name: str, out: Path, *options: str, **changes: Any) -> str:
        path = write_toml(content(**SIZE, **STIFF, **changes), tmp_path / "wall.toml")
        assert command([name, str(path), "--model", "dem-dynamic", "--out", str(out), *options]) == 0
        return capsys.readouterr().out

    return asked


def test_wall_that_falls_under_dead_load_is_infeasible_for_both_commands(ask: Any, tmp_path: Path) -> None:
    run = json.loads(ask("run", tmp_path / "run", "--json", **LEANING))
    response = json.loads(ask("respond", tmp_path / "respond", "--json", **LEANING))
    assert run["status"] == response["verdict"] == "infeasible"
    assert run["message"] == response["message"] == "collapses under its dead load"
    assert response["time"] is response["peak_drift"] is None
    assert "  infeasible: collapses under its dead load\n" in ask("respond", tmp_path / "respond", **LEANING)
    assert not (tmp_path / "respond").exists()


def test_folder_holds_only_the_last_result(ask: Any, tmp_path: Path) -> None:
    """A static run, a response, a run again, and a wall that collapses under dead load, all into one folder."""
    out = tmp_path / "out"

    def written(name: str, **changes: Any) -> set[str]:
        ask(name, out, **changes)
        return {path.name.split("-")[0] for path in out.glob("*.*")}

    ran = written("run")
    assert {"outcome.json", "curve.csv", "mechanism.svg", "blocks.pvd", "joints.pvd"} <= ran
    response = {"response.csv", "response.json", "response.png", "arrays"}
    assert written("respond", **SHAKEN) == {*response, "open_run.py", "blocks.pvd", "joints.pvd"}
    assert written("run") == ran
    assert written("respond", **LEANING) == set()


def test_users_own_files_are_kept(ask: Any, tmp_path: Path) -> None:
    """A response changes no file of a folder without results; a run keeps tables that no command wrote."""
    own = tmp_path / "own"
    own.mkdir()
    names = {"curve.csv", "draws.json", "arrays-of-sensors.npz", "film.gif", "rendering.png"}
    for name in names:
        (own / name).write_text("measured")
    assert not holds_results(own)
    ask("respond", own, **SHAKEN)
    assert {name for name in names if (own / name).read_text() == "measured"} == names
    assert holds_results(own)
    (own / "response.png").unlink()
    ask("run", own)
    assert (own / "response.csv").exists()
    ask("respond", own, **SHAKEN)
    assert (own / "arrays-of-sensors.npz").read_text() == "measured"
    assert not (own / "outcome.json").exists()


def test_response_reports_what_its_model_ignores(ask: Any, tmp_path: Path) -> None:
    """As a run does; rigid blocks ignore Young's modulus, which decides how far a soft column sways."""
    soft = {"block__young": 1e9, "block__poisson": 0.2}
    told = json.loads(ask("respond", tmp_path / "out", "--json", **SHAKEN, **soft))["message"]
    assert told.endswith("; not taken into account: block.young, block.poisson")


def test_response_is_rendered_from_its_folder(ask: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The film has every frame of the series; a damaged file in the folder is named and nothing is rendered from it."""
    out = tmp_path / "out"
    ask("respond", out, **SHAKEN)
    said = json.loads((out / "response.json").read_text())
    assert (said["scene"], said["verdict"]) == (load_scene(out).title, "stands")
    for number in frame_files(out, "blocks")[3:]:
        (out / "blocks.pvd").write_text(without(number.name, out / "blocks.pvd"))
    assert command(["render", str(out)]) == 0
    assert capsys.readouterr().out.split() == [str(out / "film.gif")]
    with Image.open(out / "film.gif") as film:
        assert getattr(film, "n_frames", 1) == len(frame_files(out, "blocks")) == 3
    (out / "response.json").write_text((out / "response.json").read_text().replace("stands", "failed"))
    assert command(["render", str(out)]) == 2
    assert f"{out}: is not what response.json vouches for" in capsys.readouterr().err


def without(name: str, listing: Path) -> str:
    """A list of frames without one of its entries."""
    return "\n".join(line for line in listing.read_text().splitlines() if name not in line)


def test_wall_that_leaves_its_ground_is_filmed(ask: Any, tmp_path: Path) -> None:
    """When the ground falls faster than the wall, no contacts are left from which to take joint values."""
    record = tmp_path / "hop.txt"
    rows = [f"{k / 1000:.3f} 0.0 {-15.0 if k < 100 else 0.0}" for k in range(500)]
    record.write_text("\n".join(rows) + "\n")
    history = {"file": str(record), "quantity": "acceleration"}
    out = tmp_path / "out"
    response = json.loads(ask("respond", out, "--json", load__live=None, load__history=history))
    assert response["verdict"] == "stands"
    assert (out / "blocks.pvd").exists()


def test_output_folder_does_not_change_the_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With a folder a fall is filmed on, but drifts, energies and named blocks are those at the fall."""
    pulse = {"kind": "sine", "amplitude": 8.0, "period": 0.5}
    tall = {"wall__length": 0.12, "wall__block_width": 0.12, "wall__block_height": 0.24, "wall__height": 0.48}
    history = {"pulse": pulse, "quantity": "acceleration"}
    path = write_toml(content(**tall, **STIFF, load__live=None, load__history=history), tmp_path / "wall.toml")
    said = []
    for options in ([], ["--out", str(tmp_path / "out")]):
        assert command(["respond", str(path), "--model", "dem-dynamic", "--json", *options]) == 0
        said.append(json.loads(capsys.readouterr().out))
    bare, kept = said
    assert bare["verdict"] == "collapse"
    assert kept["time"] > bare["time"]
    for key in ("peak_drift", "unaccounted", "message"):
        assert kept[key] == bare[key]
