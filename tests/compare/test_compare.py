"""Campaigns resume, tables state the outcomes, and the command line keeps its output format and exit codes."""

import csv
import inspect
import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from fem_interface.model import fem
from runningbond.campaigns import Campaign, run_campaign
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.commands.command_line import command
from runningbond.compare import PUBLISHED, published_scene, table
from runningbond.compare.figures import SLENDERNESS, TEXTURES, figure_6_data
from runningbond.compare.published import FURTHER
from runningbond.compare.table import corrected_homo
from runningbond.models import MODELS, Model, respond, run_model
from runningbond.results import Outcome, load_outcome
from runningbond.scene import Scene, SceneError
from tests.at_length import at_length
from tests.fem_interface.walls import MORTAR
from tests.walls import content, courses, panel, write_toml

FAST = ["panel-04", "panel-08", "wall-w3", "point-load-quarter"]
SCRIPT = str(Path(sys.executable).parent / "runningbond")
CONTRACT = ["scene", "model", "status", "multiplier", "lower", "upper", "dofs", "steps", "seconds", "message"]


# --- one scene -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_json_is_one_object_with_the_keys_of_the_contract(
    model: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    wall = content(wall__length=0.48, wall__height=0.24, joint__mortar=MORTAR, block__young=1e10, block__poisson=0.2)
    path = str(write_toml(wall, tmp_path / "wall.toml"))
    assert command(["run", path, "--model", model, "--json"]) == 0
    printed = capfd.readouterr()
    found = json.loads(printed.out)
    assert list(found) == CONTRACT
    assert found["status"] == "collapse"
    assert found["model"] == model
    assert printed.err == ""


def test_undecided_run_exits_with_3(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("runningbond.limit.starts.PROGRAM_BUDGET", 0)
    monkeypatch.setattr("runningbond.limit.sequences.SHORT", 0)
    assert command(["run", "panel-04", "--model", "limit-nonassociated"]) == 3


def test_stored_run_can_be_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", "panel-04", "--model", "limit", "--out", str(tmp_path / "kept"), "--json"]) == 0
    outcome, _ = load_outcome(tmp_path / "kept")
    assert outcome.summary() == json.loads(capsys.readouterr().out)
    assert outcome.motion.shape == (len(published_scene("panel-04").blocks), 3)


def test_help_names_both_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["--help"]) == 0
    printed = capsys.readouterr().out
    assert "run" in printed
    assert "compare" in printed


def test_read_scene_and_limit_from_python() -> None:
    from runningbond.limit import limit
    from runningbond.scene import read_scene

    wall = read_scene(PUBLISHED[0].path)
    outcome = limit(wall)
    assert (outcome.status, round(outcome.lower or 0, 4)) == ("collapse", 0.6)


def test_unknown_models_are_refused_in_python_too() -> None:
    with pytest.raises(SceneError, match=r"^model = 'limt': .* did you mean \"limit\"\?"):
        run_model("limt", panel())


def test_refused_tolerance_has_its_name_in_python() -> None:
    for run in (run_model, lambda *arguments: run_campaign({}, folder=Path(), tolerance=arguments[2])):
        with pytest.raises(SceneError, match=r"^tolerance = 2: must be"):
            run("limit", panel(), 2)


# --- models --------------------------------------------------------------------------------------------------


def rigid_block(scene: Scene, tolerance: float) -> Outcome:
    """Custom model: a single block slides at tan φ or topples at b / h."""
    width, height = np.ptp(scene.blocks.vertices[scene.blocks.owner == 0], axis=0)
    multiplier = min(scene.joint.friction, float(width / height))
    return Outcome(scene.title, "toppling", "collapse", multiplier, message="closed form")


READS = frozenset({"block.density", "joint.friction"})
TOPPLING = Model("toppling", "one rigid block in closed form", rigid_block, READS)


@pytest.mark.parametrize(("friction", "exact"), [(0.3, 0.3), (3.0, 0.5)])
def test_custom_model_runs_without_registration(friction: float, exact: float) -> None:
    scene = courses([[1]], width=0.2, height=0.4, joint__friction=friction)
    outcome = run_model(TOPPLING, scene)
    assert outcome.multiplier == pytest.approx(exact, rel=1e-12)
    assert outcome.multiplier == pytest.approx(run_model("limit", scene).multiplier, rel=1e-6)


def test_registered_custom_model_is_in_the_comparison(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A model added to `MODELS` is in the tables, also if worker processes run it that do not have it in theirs."""
    monkeypatch.setitem(MODELS, "toppling", TOPPLING)
    tall = content(wall__length=None, wall__height=None, wall__courses=[[1]], wall__block_width=0.2)
    tall["wall"]["block_height"] = 0.4
    path = write_toml(tall, tmp_path / "block.toml")
    line = ["compare", str(path), "--models", "limit,toppling", "--out", str(tmp_path / "out"), "--jobs", "2"]
    assert command(line) == 0
    assert "| block | panel | 0.5000 | 0.5000 |" in (tmp_path / "out" / "table.md").read_text()
    assert "toppling" in (tmp_path / "out" / "report.html").read_text()
    assert command(line) == 0
    assert "2 of them already in" in capsys.readouterr().out


def test_fingerprint_depends_on_the_code_of_a_custom_model() -> None:
    namespace: dict[str, Any] = {"__name__": "notebook"}
    exec("def solve(scene, tolerance):\n    return 1\ndef changed(scene, tolerance):\n    return 2", namespace)
    solvers = (rigid_block, namespace["solve"], namespace["changed"])
    keys = [fingerprint(panel(), replace(TOPPLING, solve=solve), 0.01) for solve in solvers]
    assert len(set(keys)) == 3
    assert fingerprint(panel(), MODELS["limit"], 0.01) == fingerprint(panel(), "limit", 0.01)


def test_model_parameters_match_the_solver_signature() -> None:
    solvers: dict[str, Callable[..., Outcome]] = {"dem-static": dem_static, "dem-dynamic": dem_dynamic, "fem": fem}
    for name, model in MODELS.items():
        taken = inspect.signature(solvers.get(name, model.solve)).parameters.values()
        own = {parameter.name for parameter in taken if parameter.kind == parameter.KEYWORD_ONLY}
        assert set(model.parameters) == own - {"observe"}
    with pytest.raises(SceneError, match="model limit: modes = 3: is not a parameter"):
        run_model("limit", panel(), modes=3)


def test_message_lists_keys_that_the_model_ignores() -> None:
    glued = {"cohesion": 1e4, "fracture_energy_1": 5.0, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    scene = panel(block__young=1e10, joint__friction=0.6, **{f"joint__{key}": value for key, value in glued.items()})
    stiffness, energy = ["joint.normal_stiffness", "joint.shear_stiffness"], ["joint.fracture_energy_1"]
    unread = {name: model.unread(scene) for name, model in MODELS.items()}
    assert unread["limit"] == unread["limit-nonassociated"] == ["block.young", *stiffness, *energy]
    assert unread["dem-static"] == ["block.young", *energy]
    assert unread["dem-dynamic"] == ["block.young"]
    assert unread["fem"] == []
    assert run_model("limit", scene).message.endswith("not taken into account: " + ", ".join(unread["limit"]))
    assert "taken into account" not in run_model("limit", panel()).message


STIFF = {"joint__normal_stiffness": 1e10, "joint__shear_stiffness": 4e9, "wall__length": 0.48, "wall__height": 0.12}


def test_message_lists_beam_keys_that_the_model_ignores() -> None:
    """`force_line` matters only at finite displacements of a driven beam, `rate` only if blocks move in time."""
    led = {"displacement": [0.002, 0.0], "rate": 0.01}
    beam = {"height": 0.1, "force": [0.0, -1e3], "force_line": "fixed", "drive": led}
    scene = panel(load__live=None, beam=beam, **STIFF)
    line, rate = "beam.force_line", "beam.drive.rate"
    unread = {name: [key for key in model.unread(scene) if key.startswith("beam")] for name, model in MODELS.items()}
    assert unread == {name: [line] if name in ("dem-dynamic", "fem") else [line, rate] for name in MODELS}
    assert run_model("limit", scene).message.endswith(f"joint.shear_stiffness, {line}, {rate}")
    assert run_model("dem-dynamic", scene).message.endswith(f"not taken into account: {line}")
    assert "taken into account" not in run_model("dem-dynamic", scene, displacements="finite").message


def test_beam_force_line_is_ignored_under_ground_motion() -> None:
    history = {"pulse": {"kind": "sine", "amplitude": 0.1, "period": 0.2}, "quantity": "g"}
    beam = {"height": 0.1, "force": [0.0, -1e3], "force_line": "fixed"}
    scene = panel(load__live=None, load__history=history, beam=beam, **STIFF)
    assert respond("dem-dynamic", scene).message.endswith("not taken into account: beam.force_line")


@pytest.mark.parametrize("energy", ["fracture_energy_1", "compressive_fracture_energy"])
def test_models_without_softening_warn_of_a_lower_load(energy: str) -> None:
    """A block glued to its base, for which `limit` and `dem-static` give loads that a brittle joint does not carry."""
    size = {"length": 0.24, "height": 0.24, "block_width": 0.24, "block_height": 0.24, "thickness": 0.12}
    joint = {"cohesion": 1e4, "tensile_strength": 5e3, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    if energy == "compressive_fracture_energy":
        joint["compressive_strength"] = 3e4
    scene = panel(wall=size, **{f"joint__{key}": value for key, value in joint.items()})
    brittle = scene.with_joint(**{energy: 0.1})
    note = "the wall may bear less"
    bound, path = run_model("limit", brittle), run_model("dem-dynamic", brittle)
    assert note in bound.message
    assert note not in path.message
    assert note not in run_model("limit", scene).message
    assert bound.lower is not None
    assert path.upper is not None
    assert path.upper < 0.9 * bound.lower
    if energy == "fracture_energy_1":
        assert note in run_model("dem-static", brittle).message
        assert note not in run_model("dem-static", scene).message


# --- campaigns -----------------------------------------------------------------------------------------------


def test_campaign_reuses_stored_results(tmp_path: Path) -> None:
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


def test_fingerprint_depends_on_scene_model_and_tolerance() -> None:
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


def test_exception_in_one_case_does_not_lose_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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
        [SCRIPT, "compare", *arguments, "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


@pytest.mark.parametrize("how", [signal.SIGKILL, *at_length(signal.SIGINT)])
def test_interrupted_campaign_resumes(how: signal.Signals, tmp_path: Path) -> None:
    """Stopped after its first result, by Ctrl-C or SIGKILL, during a case that takes half a minute."""
    models, walls = ["limit", "dem-static"], ["panel-04", "wall-w3"]
    process = start(tmp_path, "panel-11", *walls, "--models", ",".join(models))
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

    assert Path("panel-11", "dem-static") not in kept

    scenes = {name: published_scene(name) for name in walls}
    campaign = run_campaign(scenes, models, folder=tmp_path, jobs=2)
    assert len(campaign.outcomes) == len(models) * len(scenes)
    assert {Path(*cell) for cell in campaign.reused} == {path for path in kept if path.parts[0] in scenes}


@pytest.mark.parametrize("work", [2.0, *at_length(0.1)])
def test_ctrl_c_with_waiting_tasks_prints_only_the_hint(work: float, tmp_path: Path) -> None:
    """More tasks than the workers' queue holds; each worker has run for `work` s, in a task or while loading."""
    process = start(tmp_path, "--models", "fem", "--jobs", "2", "--fresh")
    deadline, workers = time.monotonic() + 60, psutil.Process(process.pid)
    while time.monotonic() < deadline:
        busy = [child for child in workers.children() if "LokyProcess" in " ".join(child.cmdline())]
        if len(busy) > 1 and all(sum(child.cpu_times()[:2]) > work for child in busy):
            break
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert errors.splitlines()[-1].endswith("the same command without --fresh goes on.")
    assert "Traceback" not in errors
    assert "KeyError" not in errors


def test_run_stopped_by_ctrl_c_stores_an_undecided_outcome(tmp_path: Path) -> None:
    """Exit code 130, one JSON object, and a readable outcome without a fingerprint, which no comparison reuses."""
    folder = tmp_path / "panel-12" / "dem-dynamic"
    line = [SCRIPT, "run", "panel-12", "--model", "dem-dynamic", "--json", "--tolerance", "1e-6"]
    line += ["--out", str(folder)]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    # Until the wall is at rest under its dead load; the run is then far from its end.
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
    walls, models = ["panel-04", "wall-w3"], ["homog", "limit", "dem-static"]
    line = ["compare", *walls, "--models", ",".join(models), "--tolerance", "0.05"]
    assert command([*line, "--jobs", "1", "--out", str(tmp_path)]) == 0
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(walls) * len(models)
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
        assert all(name in text for name in walls)
        assert "0.1865" in text
    assert (tmp_path / "figure-6.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("write", [table.multiplier_sheets, table.csv_text])
def test_corrected_homo_is_computed_twice_per_panel(
    write: Callable[[table.Comparison], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once for the labels and once for the value, not for each other panel or model: it is a run of `homog`."""
    panels = [case.name for case in PUBLISHED if case.name.startswith("panel")]
    scenes = {name: published_scene(name) for name in panels}
    published = {case.name: case for case in PUBLISHED if case.name in panels}
    worked_out = Counter[str]()

    def counted(scene: Scene) -> float:
        worked_out[scene.title] += 1
        return corrected_homo(scene)

    monkeypatch.setattr(table, "corrected_homo", counted)
    write(table.Comparison(scenes, list(MODELS.values()), Campaign(), published))
    assert set(worked_out.values()) == {2}


def test_compare_runs_all_models_by_default(tmp_path: Path) -> None:
    joint = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    scene = content(wall__length=0.48, wall__height=0.24, joint=joint, block__young=1e12)
    path = write_toml(scene, tmp_path / "wall.toml")
    assert command(["compare", str(path), "--jobs", "1", "--out", str(tmp_path / "out")]) == 0
    with (tmp_path / "out" / "table.csv").open() as file:
        assert {row["model"]: row["status"] for row in csv.DictReader(file)} == dict.fromkeys(MODELS, "collapse")


def test_walls_with_openings_are_compared_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Ferris & Tin-Loi's W4 to W6 have 55, 61 and 146 blocks; a comparison runs them if they are named."""
    walls = {case.name: published_scene(case.name).wall.sum() for case in FURTHER}
    assert walls == {"wall-w4": 55, "wall-w5": 61, "wall-w6": 146}
    assert command(["compare", *walls, "--models", "limit", "--out", str(tmp_path), "--jobs", "1"]) == 0
    assert "Ferris & Tin-Loi (2001)" in (tmp_path / "table.md").read_text()


@pytest.mark.long
def test_pictures_of_an_earlier_comparison_are_removed(tmp_path: Path) -> None:
    """Other files stay; a comparison of other walls has other plates."""
    line = ["compare", "--models", "dem-static", "--tolerance", "0.05", "--out", str(tmp_path), "--jobs", "1"]
    own = tmp_path / "mine.png"
    own.touch()
    for wall, plate in (("panel-04", "figure-8"), ("panel-08", "figure-9")):
        assert command([*line, wall]) == 0
        assert {path.stem for path in tmp_path.glob("*.png")} == {"mine", "figure-6", "figure-7", plate}


def test_published_walls_are_the_sixteen_panels_and_three_walls() -> None:
    assert len(PUBLISHED) == 19
    assert len({case.name for case in PUBLISHED}) == 19
    for case in PUBLISHED[:12]:
        low, high = published_scene(case.name).blocks.extent(published_scene(case.name).wall)
        assert (high - low)[0] == pytest.approx(1.44)


@pytest.mark.parametrize(
    ("row", "blocks"),
    # Baraldi, Reccia & Cecchi, Table 1: blocks along and courses up; two half blocks in every second course.
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


def test_corrected_homo_uses_another_friction_than_stated() -> None:
    scene = published_scene("panel-05")
    assert corrected_homo(scene) == pytest.approx(0.5336, abs=5e-5)
    assert run_model("homog", scene).multiplier == pytest.approx(0.5420, abs=5e-5)


def test_own_scene_may_have_a_published_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A changed copy of a published scene, with the same file name and a title that looks like markup."""
    own = PUBLISHED[0].path.read_text().replace('"flush"', '"toothed"').replace("H/L = 0.5, b/a = 4", "my [/b] wall")
    (tmp_path / "panel-01.toml").write_text(own)
    arguments = [str(tmp_path / "panel-01.toml"), "--models", "limit", "--jobs", "1", "--out", str(tmp_path / "out")]
    assert command(["compare", *arguments]) == 0
    printed = capsys.readouterr().out
    assert "Your scenes" in printed
    assert "my [/b] wall" in printed
    assert "0.570" not in printed
    assert not (tmp_path / "out" / "figure-6.png").exists()


def test_result_folders_do_not_hide_published_scenes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        assert command(["compare", "panel-04", "--models", "limit", "--jobs", "1", "--out", "."]) == 0
    assert command(["run", "panel-04", "--model", "homog"]) == 0


@pytest.mark.long
def test_killed_worker_does_not_stop_the_other_cases(tmp_path: Path) -> None:
    """Killed as by the kernel if memory runs out; the other cases are still computed."""
    process = start(tmp_path, "panel-11", "panel-04", "wall-w3", "--models", "limit,limit-nonassociated")
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


@pytest.mark.parametrize("name", ["..toml", "...toml"])
def test_scene_file_without_a_stem_is_refused(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_toml(content(), tmp_path / name)
    assert command(["compare", str(tmp_path / name), "--models", "limit", "--out", str(tmp_path / "out")]) == 2
    assert "must have a name before .toml" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == [name]


def test_scene_file_with_an_undecodable_name_is_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tables = content(wall__length=0.48, wall__height=0.24)
    del tables["title"]
    os.rename(write_toml(tables, tmp_path / "wall.toml"), os.fsencode(tmp_path) + b"/w\xe9nd.toml")
    path = os.fsdecode(os.fsencode(tmp_path) + b"/w\xe9nd.toml")
    assert command(["compare", path, "--models", "limit", "--out", str(tmp_path / "out"), "--jobs", "1"]) == 0
    for name in ("table.csv", "table.md", "report.html"):
        assert "w\ufffdnd" in (tmp_path / "out" / name).read_text(encoding="utf-8")
    assert command(["run", path, "--model", "limit", "--out", str(tmp_path / "run")]) == 0


def forbid_file_growth() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))


@pytest.mark.parametrize(
    "line", ["compare panel-04 --models limit --out", *at_length("run panel-04 --model limit --out")]
)
def test_file_size_limit_of_zero_is_a_one_line_error(line: str, tmp_path: Path) -> None:
    """`ulimit -f 0` is found before anything is computed; the exit code is right even if no message can be printed."""
    words = [SCRIPT, *line.split(), str(tmp_path)]
    said = subprocess.run(words, capture_output=True, text=True, check=False, preexec_fn=forbid_file_growth)
    assert said.returncode == 2
    assert said.stderr == f"runningbond: {tmp_path}: File too large\n"
    assert said.stdout == ""
    with (tmp_path / "silent").open("wb") as silent:
        done = subprocess.run(words, stdout=silent, stderr=silent, check=False, preexec_fn=forbid_file_growth)
    assert done.returncode == 2


def test_unknown_matplotlib_backend_is_bad_input() -> None:
    wrong = os.environ | {"MPLBACKEND": "nonsense"}
    line = [SCRIPT, "compare", "panel-04", "--models", "limit"]
    said = subprocess.run(line, capture_output=True, text=True, check=False, env=wrong)
    assert said.returncode == 2
    assert said.stderr.startswith("runningbond: MPLBACKEND = 'nonsense': is not a backend of matplotlib")
    assert said.stderr.count("\n") == 1


def test_broken_pipe_is_no_error() -> None:
    line = f"{SCRIPT} run panel-04 --model limit | true; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_folder_is_locked_while_tables_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a lock, of two comparisons that end at once the tables could be of one and the pictures of the other."""
    fcntl, compare = pytest.importorskip("fcntl"), import_module("runningbond.commands.compare")
    report, found = vars(compare)["_report"], list[bool]()

    def tried(*arguments: Any) -> None:
        folder = os.open(tmp_path, os.O_RDONLY)
        try:
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            found.append(True)
        finally:
            os.close(folder)
        report(*arguments)

    monkeypatch.setattr(compare, "_report", tried)
    assert command(["compare", "panel-04", "--models", "homog", "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert found == [True]
    assert (tmp_path / "report.html").is_file()


def test_note_says_why_a_model_does_not_apply_to_an_own_scene(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """For a wall without stiffness only n/a was printed; for the published W3 without closed form that suffices."""
    own = str(write_toml(content(), tmp_path / "own.toml"))
    line = ["compare", own, "wall-w3", "--models", "homog,dem-static", "--tolerance", "0.1", "--jobs", "1"]
    assert command([*line, "--out", str(tmp_path / "out")]) == 0
    notes = [line for line in capsys.readouterr().err.splitlines() if line.startswith("note: ")]
    assert len(notes) == 1
    assert notes[0].startswith("note: own, dem-static: joint.mortar: is missing; this model needs it")


def test_a_note_names_its_model_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`run` prints "model homog: has no closed form", but the note already begins with the model's name."""
    opened = [[1, 1, 1], [1, -1, 1], [1, 1, 1]]
    own = str(write_toml(content(wall__length=None, wall__height=None, wall__courses=opened), tmp_path / "own.toml"))
    assert command(["compare", own, "--models", "homog", "--jobs", "1", "--out", str(tmp_path / "out")]) == 0
    (note,) = (line for line in capsys.readouterr().err.splitlines() if line.startswith("note: "))
    assert note.startswith("note: own, homog: has no closed form for this scene")
