"""``runningbond run``: its curve, its files and its progress output."""

import csv
import json
import os
import pty
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from runningbond.campaigns import INTERRUPTIONS
from runningbond.commands import terminal
from runningbond.commands.command_line import command
from runningbond.compare.published import published_scene
from runningbond.dynamics import Run, State
from runningbond.models import MODELS, run_model
from runningbond.models.second_opinion import asks_others
from runningbond.pictures.curve import curve_figure
from runningbond.pictures.progress import MotionProgress, ResponseProgress
from runningbond.response import follow
from runningbond.results import load_outcome
from runningbond.results.outcome import number

from ..limit.test_large_walls import SIZE, interrupt_at
from ..response.walls import resting
from ..walls import content, panel, write_toml

STIFFNESS = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
SMALL: dict[str, Any] = {"wall__length": 0.48, "wall__height": 0.24, "joint": {"friction": 0.6} | STIFFNESS}


@pytest.fixture
def small(tmp_path: Path) -> str:
    return str(write_toml(content(**SMALL), tmp_path / "small.toml"))


def read_csv(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_run_writes_the_curve_and_lists_its_files(
    small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The curve is that of the stored outcome, and the base carries the whole push."""
    out = tmp_path / "out"
    assert command(["run", small, "--model", "dem-static", "--out", str(out)]) == 0
    written = [line for line in capsys.readouterr().out.splitlines() if line.startswith(str(out))]
    assert {Path(line).name.split("-")[0] for line in written} >= {"outcome.json", "arrays", "curve.csv", "curve.png"}
    assert all(Path(line).is_file() for line in written)
    assert (out / "curve.png").read_bytes().startswith(b"\x89PNG")
    rows, outcome = read_csv(out / "curve.csv"), load_outcome(out)[0]
    load = np.array([float(row["λ"]) for row in rows])
    assert np.array_equal(load, outcome.curve[:, 1])
    assert np.array_equal([float(row["control displacement [m]"]) for row in rows], outcome.curve[:, 0])
    weight = 9.81 * 1800 * 0.48 * 0.24 * 0.12
    assert [float(row["ground horizontal [N]"]) for row in rows] == pytest.approx(-load * weight, abs=1e-6 * weight)
    assert [float(row["ground vertical [N]"]) for row in rows] == pytest.approx(np.full(len(rows), weight))


def test_libraries_print_nothing_into_json_output(tmp_path: Path) -> None:
    """HiGHS 1.16 prints a banner once per process, bypassing Python, on the standard output that ``--json`` uses."""
    wall = str(write_toml(content(**SMALL, block__young=1e10), tmp_path / "wall.toml"))
    lines = f"for model in {list(MODELS)}: command(['run', {wall!r}, '--model', model, '--json'])"
    script = f"from runningbond.commands.command_line import command\n{lines}"
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert [json.loads(line)["model"] for line in printed.splitlines()] == list(MODELS)


@pytest.mark.parametrize(("model", "rows"), [("limit", 1), ("limit-nonassociated", 1), ("homog", None)])
def test_models_without_a_path_write_one_row_or_none(
    model: str, rows: int | None, small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Curves of an earlier run are removed."""
    for name in ("curve.csv", "curve.png"):
        (tmp_path / name).write_bytes(b"old")
    assert command(["run", small, "--model", model, "--out", str(tmp_path), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert not (tmp_path / "curve.png").exists()
    assert (tmp_path / "curve.csv").exists() == (rows is not None)
    if rows is not None:
        (row,) = read_csv(tmp_path / "curve.csv")
        assert float(row["λ"]) == printed["multiplier"]
        assert row["control displacement [m]"] == row["work of the live load [J]"] == ""


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_the_curve_is_drawn_with_its_bracket_and_units(model: str) -> None:
    """Every state is drawn, and those of a fall are marked; the bracket lies within the load axis."""
    scene = published_scene("wall-w1")
    outcome = run_model(model, scene, 0.02)
    axes = curve_figure(scene, outcome).axes[0]
    assert scene.title in axes.get_title()
    assert "[mm]" in axes.get_xlabel()
    assert "λ" in axes.get_ylabel()
    low, high = axes.get_ylim()
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert low <= outcome.lower <= outcome.upper < high
    drawn = np.vstack([line.get_xydata() for line in axes.lines if str(line.get_label()) in ("at rest", "falls")])
    assert drawn == pytest.approx(outcome.curve * (1e3, 1.0))
    assert ("falls" in [line.get_label() for line in axes.lines]) == (model == "dem-dynamic")
    assert axes.get_xscale() == "symlog"  # a plateau a thousand times as long as the elastic range


def test_progress_names_the_comparison_runs_of_soft_blocks() -> None:
    """Of two observers, the one that writes states is called for the run with deformable blocks only."""
    progress, looks = MotionProgress(), list[str]()
    scene = panel(**SMALL).with_block(young=1e9, poisson=0.2)
    assert asks_others(scene, {})

    def write(run: Run, state: State, multiplier: float) -> None:
        looks.append(progress.line().partition(":")[0])

    run_model("fem", scene, 0.05, terminal.Together([progress, write]))
    assert looks
    assert "with rigid blocks" not in looks
    assert progress.line().startswith(("with rigid blocks: λ", "on a mesh 3 times as fine: λ"))


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_progress_shows_the_bracket_so_far(model: str) -> None:
    """In the end it contains the outcome's: peaks under displacement control and the last load are not in it."""
    make = MODELS[model].progress
    assert make is not None
    progress = make()
    assert "λ" not in progress.line()
    outcome = run_model(model, panel(**SMALL), 0.05, progress)
    assert outcome.lower is not None
    rests, falls = map(float, re.findall(r"(?:rests|falls) at ([.\d]+)", progress.line()))
    assert rests <= outcome.lower + 1e-4
    assert outcome.upper is not None
    assert outcome.upper - 1e-4 <= falls <= 1.1 * rests
    assert "% of " in progress.line()


def test_progress_shows_the_time_of_each_ground_motion() -> None:
    """Motions are counted, also if the scale stays the same."""
    pulse = {"pulse": {"kind": "sine", "amplitude": 1.0, "period": 0.1}, "quantity": "acceleration"}
    rest = resting(panel(**SMALL, load__live=None, load__history=pulse))
    progress = ResponseProgress()
    assert "λ" not in progress.line()
    for motion, scale in enumerate((0.5, 1.0, 1.0), 1):
        time = follow(rest, scale, rows=20, observe=progress).time[-1]
        assert progress.line() == f"motion {motion}, λ {number(scale)}, {time:.2f} s of it"


def test_progress_changes_no_number() -> None:
    make = MODELS["dem-dynamic"].progress
    assert make is not None
    scene = panel(**SMALL)
    told, silent = (run_model("dem-dynamic", scene, 0.05, observer) for observer in (make(), None))
    assert np.array_equal(told.path, silent.path, equal_nan=True)


@pytest.mark.parametrize("is_terminal", [True, False])
def test_progress_line_is_for_terminals_and_is_wiped(is_terminal: bool, capsys: pytest.CaptureFixture[str]) -> None:
    """The line is cut to the terminal's width and wiped at the end; without a terminal nothing is printed."""
    with (
        patch.object(terminal, "PATIENCE", 0.0),
        patch.object(sys.stderr, "isatty", lambda: is_terminal),
        patch.object(terminal, "get_terminal_size", lambda: SimpleNamespace(columns=20)),
    ):
        asked = threading.Event()

        def told() -> str:
            asked.set()
            return 40 * "x"

        with terminal.progress_line("fem", told):
            assert not is_terminal or asked.wait()
    out, err = capsys.readouterr()
    assert out == ""
    if not is_terminal:
        assert err == ""
        assert not asked.is_set()
    else:
        assert err.startswith("\r\x1b[Kfem 0 s: xx")
        assert err.endswith("\r\x1b[K")
        assert max(map(len, err.split("\r\x1b[K"))) == 19


def test_progress_of_many_cases_is_printed_at_intervals(capsys: pytest.CaptureFixture[str]) -> None:
    """Without a terminal: a line at the start, one per interval and one at the end; no control characters."""
    clock = iter((0.0, 1.0, 31.0, 32.0, 40.0))
    with (
        patch.object(sys.stderr, "isatty", lambda: False),
        patch("time.perf_counter", lambda: next(clock)),
        terminal.progress_bar("comparing", 4) as advance,
    ):
        for case in "abcd":
            advance(case)
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == ["comparing, 0 of 4, 0 s", "b, 2 of 4, 31 s", "d, 4 of 4, 40 s"]


def test_json_output_is_pure_with_stderr_on_a_terminal(small: str) -> None:
    """With standard error on a terminal, standard output, a pipe, holds one object and nothing else."""
    master, slave = pty.openpty()
    line = [sys.executable, "-m", "runningbond", "run", small, "--model", "limit", "--json"]
    done = subprocess.run(line, stdout=subprocess.PIPE, stderr=slave, check=True)
    os.close(slave)
    os.close(master)
    assert json.loads(done.stdout)["status"] == "collapse"


@pytest.mark.long
def test_comparison_is_written_although_its_reader_closes_the_pipe(small: str, tmp_path: Path) -> None:
    """As ``head -1`` does: the tables are printed before the report is written, which was then left out."""
    reading, writing = os.pipe()
    os.close(reading)
    line = [sys.executable, "-m", "runningbond", "compare", small, "--models", "limit", "--out", str(tmp_path / "out")]
    done = subprocess.run(line, stdout=writing, stderr=subprocess.PIPE, check=False)
    os.close(writing)
    assert done.returncode == 0
    assert b"Error" not in done.stderr
    assert (tmp_path / "out" / "report.html").is_file()


@pytest.mark.parametrize("further", [[], ["--draws", "2"]])
def test_run_is_saved_although_its_readers_close_their_pipes(further: list[str], small: str, tmp_path: Path) -> None:
    """As with ``2>&1 | head -1``: the answer is printed before it is saved, and was then lost."""
    reading, writing = os.pipe()
    os.close(reading)
    model = "dem-static" if further else "limit"
    line = [sys.executable, "-m", "runningbond", "run", small, "--model", model, "--out", str(tmp_path / "out")]
    done = subprocess.run([*line, *further], stdout=writing, stderr=writing, check=False)
    os.close(writing)
    assert done.returncode == 0
    assert load_outcome(tmp_path / "out")[0].status == "collapse"
    assert (tmp_path / "out" / "mechanism.svg").is_file()


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_limit_stores_its_bracket_without_fingerprint(
    how: signal.Signals, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit code 130 and one JSON object; without a fingerprint no comparison reuses the outcome."""
    scene, out = str(write_toml(content(**SIZE), tmp_path / "wall.toml")), tmp_path / "out"
    interrupt_at(8, monkeypatch, how=how)
    before = {number: signal.getsignal(number) for number in INTERRUPTIONS}
    try:
        assert command(["run", scene, "--model", "limit", "--json", "--out", str(out)]) == 130
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    said = json.loads(capsys.readouterr().out)
    assert said["status"] == "undecided"
    assert said["multiplier"] is None
    assert said["lower"] < said["upper"]
    assert load_outcome(out)[1] == ""


def test_folder_in_use_by_another_process_is_refused(
    small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The folder is free again when that process ends; one process may use it several times."""
    out = tmp_path / "out"
    holds = "import sys; from pathlib import Path; from runningbond.scene.folder_lock import claim\n"
    holds += "claim(Path(sys.argv[1]), '--out'); print('held', flush=True); sys.stdin.read()"
    out.mkdir()
    line = [sys.executable, "-c", holds, str(out)]
    with subprocess.Popen(line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        assert other.stdin is not None
        assert other.stdout.readline() == "held\n"
        assert command(["run", small, "--model", "limit", "--out", str(out)]) == 2
        assert "is written by another process; wait for it" in capsys.readouterr().err
        assert not list(out.iterdir())
        other.stdin.close()
        other.wait()
    for _ in range(2):
        assert command(["run", small, "--model", "limit", "--out", str(out)]) == 0


def test_cost_of_a_long_run_is_printed_on_a_terminal_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = published_scene("panel-04")
    monkeypatch.setattr(terminal, "LONG_RUN", 0.0)
    terminal.print_cost(MODELS["limit"], scene, 0.01)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    terminal.print_cost(MODELS["limit"], scene, 0.01)
    monkeypatch.setattr(terminal, "LONG_RUN", 1e9)
    terminal.print_cost(MODELS["limit"], scene, 0.01)
    said = capsys.readouterr()
    assert said.out == ""
    assert re.fullmatch(r"limit: about \S+ s \(×÷ \S+\); Ctrl-C leaves what is proved by then\n", said.err)


def test_extra_scene_argument_is_refused_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", "panel-01", "panel-02", "--model", "limit"]) == 2
    assert capsys.readouterr().err == "runningbond: panel-02: is not an argument of this command\n"


def test_settlement_at_finite_displacements_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As with `displacements` in Python; options that do not apply to a model or wall are refused."""
    live = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -0.01]}
    wall = str(write_toml(content(**SMALL, load__live=live), tmp_path / "sinks.toml"))
    out, far = tmp_path / "out", ["--displacements", "finite"]
    assert command(["run", wall, "--model", "dem-dynamic", *far, "--out", str(out)]) == 0
    assert "finite displacements" in capsys.readouterr().out
    kept, _ = load_outcome(out)
    assert kept.multiplier == pytest.approx(1.0, rel=1e-3)
    for model, options, said in (
        ("limit", far, "dem-dynamic and fem follow"),
        (
            "fem",
            [*far, "--distance", "0.1"],
            "--distance = 0.1: goes with finite displacements of a wall that",
        ),
        ("fem", ["--distance", "0.1"], "--distance = 0.1: goes with --displacements finite alone"),
    ):
        assert command(["run", wall, "--model", model, *options, "--out", str(tmp_path / "none")]) == 2
        assert said in capsys.readouterr().err
        assert not (tmp_path / "none").exists()


def test_distance_option_sets_how_far_a_wall_is_pushed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As with `distance` in Python; the curve is stored."""
    wall, out = str(write_toml(content(**SMALL), tmp_path / "pushed.toml")), tmp_path / "out"
    far = ["--displacements", "finite", "--distance", "0.002"]
    assert command(["run", wall, "--model", "dem-dynamic", *far, "--out", str(out)]) == 0
    assert "largest multiplier along the path" in capsys.readouterr().out
    kept, _ = load_outcome(out)
    assert kept.curve[-1, 0] == pytest.approx(0.002, rel=0.01)
    assert (out / "curve.png").exists()
    assert command(["run", wall, "--model", "dem-dynamic", *far[:-1], "-1"]) == 2
    assert "--distance = -1.0: must be a number above 0" in capsys.readouterr().err


def test_finite_displacements_are_refused_with_ground_motion(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The ground motion determines how far the wall moves, so the option would have no effect."""
    pulse = {"pulse": {"kind": "sine", "amplitude": 0.4, "period": 0.6}, "quantity": "g"}
    shaken = str(write_toml(content(**SMALL, load__live=None, load__history=pulse), tmp_path / "shaken.toml"))
    assert command(["run", shaken, "--model", "dem-dynamic", "--displacements", "finite"]) == 2
    assert "--displacements = 'finite': is not supported where the ground moves" in capsys.readouterr().err
