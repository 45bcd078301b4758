"""Campaigns resume, tables say what was found, and the command line keeps its contract."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest

from runningbond.commands.command_line import command
from runningbond.compare import MODELS, PUBLISHED, published_scene, run_campaign, run_model
from runningbond.compare.figures import SLENDERNESS, TEXTURES, figure_6_data
from runningbond.compare.fingerprint import fingerprint
from runningbond.compare.table import corrected_homo
from runningbond.results import Outcome, load_outcome
from runningbond.scene import Scene, SceneError

from .walls import panel

FAST = ["panel-04", "panel-08", "wall-w3", "point-load-quarter"]
CONTRACT = ["scene", "model", "status", "multiplier", "lower", "upper", "dofs", "steps", "seconds", "message"]


# --- one scene -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_json_is_one_object_with_the_keys_of_the_contract(model: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", "panel-04", "--model", model, "--json"]) == 0
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    assert list(found) == CONTRACT
    assert found["status"] == "collapse"
    assert found["model"] == model
    assert printed.err == ""


def test_an_undecided_run_leaves_with_3(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("runningbond.limit.nonassociated.MOST_PROGRAMS", 1)
    assert command(["run", "panel-04", "--model", "limit-nonassociated"]) == 3


def test_a_kept_run_can_be_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", "panel-04", "--model", "limit", "--out", str(tmp_path / "kept"), "--json"]) == 0
    outcome, _ = load_outcome(tmp_path / "kept")
    assert outcome.summary() == json.loads(capsys.readouterr().out)
    assert outcome.motion.shape == (len(published_scene("panel-04").blocks), 3)


def test_help_names_both_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["--help"]) == 0
    printed = capsys.readouterr().out
    assert "run" in printed
    assert "compare" in printed


def test_the_five_lines_of_the_readme() -> None:
    from runningbond.limit import limit
    from runningbond.scene import read_scene

    wall = read_scene(PUBLISHED[0].path)
    outcome = limit(wall)
    assert (outcome.status, round(outcome.lower or 0, 4)) == ("collapse", 0.6)


def test_unknown_models_are_refused_in_python_too() -> None:
    with pytest.raises(SceneError, match="--model"):
        run_model("limt", panel())


# --- campaigns -----------------------------------------------------------------------------------------------


def test_a_campaign_reuses_what_is_there_and_only_that(tmp_path: Path) -> None:
    scenes = {name: published_scene(name) for name in FAST}
    models = ["homog", "limit"]
    first = run_campaign(scenes, models, folder=tmp_path, jobs=1)
    assert len(first) == 8
    assert not first.reused
    assert set(first.inapplicable) == {("wall-w3", "homog"), ("point-load-quarter", "homog")}
    second = run_campaign(scenes, models, folder=tmp_path, jobs=1)
    assert second.reused == set(first.outcomes)
    assert {c: o.summary() for c, o in second.outcomes.items()} == {c: o.summary() for c, o in first.outcomes.items()}
    assert not run_campaign(scenes, models, folder=tmp_path, jobs=1, fresh=True).reused


def test_another_scene_tolerance_or_model_is_another_key() -> None:
    keys = {
        fingerprint(scene, model, tolerance)
        for scene in (panel(), panel(joint__friction=0.61), panel(wall__height=0.78), panel(title="other"))
        for model in ("limit", "homog")
        for tolerance in (0.01, 0.02)
    }
    assert len(keys) == 16
    assert fingerprint(panel(), "limit", 0.01) in keys


def test_a_damaged_result_is_computed_again(tmp_path: Path) -> None:
    scenes = {"panel-04": published_scene("panel-04")}
    whole = run_campaign(scenes, ["limit"], folder=tmp_path, jobs=1).outcomes["panel-04", "limit"]
    for path in sorted((tmp_path / "panel-04" / "limit").iterdir()):
        path.write_bytes(path.read_bytes()[:-20])
        again = run_campaign(scenes, ["limit"], folder=tmp_path, jobs=1)
        assert not again.reused
        assert again.outcomes["panel-04", "limit"].multiplier == whole.multiplier


def test_a_model_that_breaks_on_one_scene_does_not_lose_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limit = MODELS["limit"]

    def fragile(scene: Scene, tolerance: float) -> Outcome:
        if scene.title == "broken":
            raise ZeroDivisionError("division by zero")
        return limit.solve(scene, tolerance)

    monkeypatch.setitem(MODELS, "limit", replace(limit, solve=fragile))
    scenes = {"good": panel(), "bad": panel(title="broken")}
    campaign = run_campaign(scenes, ["limit"], folder=tmp_path, jobs=1)
    assert campaign.outcomes["good", "limit"].status == "collapse"
    assert campaign.outcomes["bad", "limit"].status == "failed"
    assert "ZeroDivisionError" in campaign.outcomes["bad", "limit"].message
    assert not (tmp_path / "bad").exists()


def start(out: Path, *arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [Path(sys.executable).parent / "runningbond", "compare", *arguments, "--out", out],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupted_campaign_goes_on_where_it_was(how: signal.Signals, tmp_path: Path) -> None:
    """Stopped after its first result, by Ctrl-C or by force, in the middle of one that takes half a minute."""
    models = ["limit", "limit-nonassociated"]
    process = start(tmp_path, "panel-11", *FAST, "--models", ",".join(models))
    deadline = time.monotonic() + 60
    while not list(tmp_path.glob("*/*/outcome.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(process.pid, how)
    _, errors = process.communicate(timeout=60)
    if how == signal.SIGINT:
        assert process.returncode == 130
        assert "the same command goes on" in errors
        assert "Traceback" not in errors
    assert not (tmp_path / "table.csv").exists()
    kept = {path.parent.relative_to(tmp_path) for path in tmp_path.glob("*/*/outcome.json")}
    assert kept

    assert Path("panel-11", "limit-nonassociated") not in kept

    scenes = {name: published_scene(name) for name in FAST}
    campaign = run_campaign(scenes, models, folder=tmp_path, jobs=2)
    assert len(campaign.outcomes) == len(models) * len(scenes)
    assert {Path(*cell) for cell in campaign.reused} == {path for path in kept if path.parts[0] in scenes}


def test_a_run_stopped_by_ctrl_c_leaves_what_it_had_found(tmp_path: Path) -> None:
    """Exit 130, one JSON object, and a readable result that no comparison takes for the answer."""
    script = Path(sys.executable).parent / "runningbond"
    folder = tmp_path / "panel-12" / "dem-dynamic"
    line = [str(script), "run", "panel-12", "--model", "dem-dynamic", "--json", "--tolerance", "1e-6"]
    line += ["--out", str(folder)]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    # At rest under its dead load, and far from its end.
    while not (folder / "blocks.pvd").exists() and process.poll() is None:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    printed, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert json.loads(printed)["status"] == "undecided"
    outcome, key = load_outcome(folder)
    assert outcome.status == "undecided"
    assert key == ""


# --- tables and charts ---------------------------------------------------------------------------------------


def test_comparison_writes_every_case_with_printed_values(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["compare", *FAST[:3], "--out", str(tmp_path)]) == 0
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * len(MODELS)
    row = next(row for row in rows if (row["scene"], row["model"]) == ("panel-04", "limit"))
    assert (row["printed FEM/DEM"], row["printed DEM"], row["printed HOMO"]) == ("0.31", "0.16", "0.134")
    assert float(row["printed HOMO corrected, tan 30°"]) == pytest.approx(0.1343, abs=5e-5)
    assert float(row["multiplier"]) == pytest.approx(0.1865, abs=5e-5)
    assert (row["dofs"], row["status"]) == ("219", "collapse")
    unfit = next(row for row in rows if (row["scene"], row["model"]) == ("wall-w3", "homog"))
    assert unfit["status"] == "not applicable"
    assert "running bond" in unfit["message"] or "rectangular" in unfit["message"]
    markdown = (tmp_path / "table.md").read_text()
    printed = capsys.readouterr().out
    for text in (markdown, printed):
        assert all(name in text for name in FAST[:3])
        assert "0.1865" in text
    assert (tmp_path / "figure-6.png").read_bytes().startswith(b"\x89PNG")


def test_published_walls_are_the_sixteen_panels_and_three_walls() -> None:
    assert len(PUBLISHED) == 19
    assert len({case.name for case in PUBLISHED}) == 19
    for case in PUBLISHED[:12]:
        low, high = published_scene(case.name).blocks.extent(published_scene(case.name).wall)
        assert (high - low)[0] == pytest.approx(1.44)


@pytest.mark.parametrize(
    ("row", "blocks"),
    # Baraldi, Reccia & Cecchi, Table 1: blocks along and courses up, half blocks counted by every second course.
    [
        (1, (6, 12)),
        (2, (12, 12)),
        (3, (24, 12)),
        (4, (24, 3)),
        (5, (6, 24)),
        (8, (24, 6)),
        (9, (6, 48)),
        (12, (24, 12)),
    ],
)
def test_panels_have_the_blocks_of_table_1(row: int, blocks: tuple[int, int]) -> None:
    along, up = blocks
    assert published_scene(f"panel-{row:02d}").wall.sum() == along * up + up // 2


def test_figure_6_holds_the_homogenised_multiplier_of_every_panel() -> None:
    slenderness, multiplier = figure_6_data()
    for i, case in enumerate(PUBLISHED[:12]):
        outcome = run_model("homog", published_scene(case.name))
        r, texture = SLENDERNESS[i // 4][1], i % 4
        assert np.interp(r, slenderness, multiplier[:, texture]) == pytest.approx(outcome.multiplier)
    assert len(TEXTURES) == multiplier.shape[1] == 4


def test_corrected_column_is_not_the_stated_friction() -> None:
    scene = published_scene("panel-05")
    assert corrected_homo(scene) == pytest.approx(0.5336, abs=5e-5)
    assert run_model("homog", scene).multiplier == pytest.approx(0.5420, abs=5e-5)


def test_your_own_wall_is_yours_whatever_its_file_is_called(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A changed copy of a published scene, under its name, with a title that looks like markup."""
    own = PUBLISHED[0].path.read_text().replace('"flush"', '"toothed"').replace("H/L = 0.5, b/a = 4", "my [/b] wall")
    (tmp_path / "panel-01.toml").write_text(own)
    arguments = ["compare", str(tmp_path / "panel-01.toml"), "--models", "limit", "--out", str(tmp_path / "out")]
    assert command(arguments) == 0
    printed = capsys.readouterr().out
    assert "Your scenes" in printed
    assert "my [/b] wall" in printed
    assert "0.570" not in printed
    assert not (tmp_path / "out" / "figure-6.png").exists()


def test_results_lying_about_do_not_hide_a_published_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        assert command(["compare", "panel-04", "--models", "limit", "--out", "."]) == 0
    assert command(["run", "panel-04", "--model", "homog"]) == 0


def test_a_killed_process_loses_one_case_and_no_more(tmp_path: Path) -> None:
    """As the kernel does to one that takes all the memory: its case is run again, the others stay."""
    process = start(tmp_path, "panel-11", *FAST, "--models", "limit,limit-nonassociated")
    deadline = time.monotonic() + 60
    while not list(tmp_path.glob("*/*/outcome.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    workers = [child for child in psutil.Process(process.pid).children() if "LokyProcess" in " ".join(child.cmdline())]
    busiest = max(workers, key=lambda child: sum(child.cpu_times()[:2]))
    busiest.kill()
    waiting = time.monotonic() + 120
    while not (tmp_path / "wall-w3" / "limit" / "outcome.json").exists() and time.monotonic() < waiting:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert (tmp_path / "wall-w3" / "limit" / "outcome.json").exists()
    assert process.returncode == 130
    assert "Traceback" not in errors


def test_a_broken_pipe_is_no_complaint() -> None:
    script = Path(sys.executable).parent / "runningbond"
    line = f"{script} run panel-04 --model limit | true; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
