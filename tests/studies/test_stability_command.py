"""`runningbond stability` keeps each finding as it comes, goes on where it was, and says where theory is not met."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from runningbond.commands.command_line import command
from runningbond.studies.stability import EXPERIMENTS, Edge, Finding
from runningbond.studies.stability.store import drawn, find, keep

THREE = EXPERIMENTS[:3]


def finding(title: str = "A beam", measured: float = 1.0) -> Finding:
    def draw(figure: Figure) -> None:
        figure.add_subplot().plot([0, 1], [0, measured])

    edges = [Edge("largest load [N]", measured, 1.0, 1e-3), Edge("sag [m]", 0.5)]
    return Finding(
        title, ["load [N]", "sag [m]"], [[1, 0.25], ["many", math.inf]], edges, "loads | small", "falls", draw
    )


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Three experiments that take no time, and a list of those that were done."""
    names: list[str] = []

    def find_out(name: str) -> Finding:
        names.append(name)
        return finding(f"Experiment {name}")

    monkeypatch.setattr("runningbond.studies.stability.EXPERIMENTS", THREE)
    monkeypatch.setattr("runningbond.studies.stability.report.EXPERIMENTS", THREE)
    monkeypatch.setattr("runningbond.studies.stability.report.find_out", find_out)
    return names


def test_a_finding_is_read_back_as_it_was_kept(tmp_path: Path) -> None:
    one = finding()
    kept = keep("time-step", one, drawn(one), tmp_path)
    assert find("time-step", tmp_path) == kept
    assert kept.rows == [[1, 0.25], ["many", "∞"]]
    assert (kept.title, kept.heads, kept.edges) == (one.title, one.heads, one.edges)
    assert not kept.off
    with Image.open(kept.chart) as chart:
        assert chart.size == (1280, 736)


def test_numbers_of_numpy_are_kept_as_numbers(tmp_path: Path) -> None:
    rows: list[list[Any]] = [[np.int64(3), np.float32(0.5), np.float64("nan")]]
    one = Finding("", ["a", "b", "c"], rows, [Edge("x", float(np.float64(2.0)))], "", "", lambda figure: None)
    assert keep("verdict", one, drawn(one), tmp_path).rows == [[3, 0.5, "–"]]


@pytest.mark.parametrize("suffix", [".json", ".png"])
def test_a_damaged_finding_is_none(tmp_path: Path, suffix: str) -> None:
    one = finding()
    keep("time-step", one, drawn(one), tmp_path)
    path = tmp_path / f"time-step{suffix}"
    whole = path.read_bytes()
    for damaged in (whole[:-9], whole.replace(b"1", b"2", 1), b""):
        path.write_bytes(damaged)
        assert find("time-step", tmp_path) is None
    path.write_bytes(whole)
    assert find("time-step", tmp_path) is not None


def test_a_finding_of_other_code_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = finding()
    keep("time-step", one, drawn(one), tmp_path)
    monkeypatch.setattr("runningbond.studies.stability.store.stability_digest", lambda: "other")
    assert find("time-step", tmp_path) is None


def test_the_command_tells_of_every_experiment(
    tmp_path: Path, done: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(["stability", "--out", str(tmp_path)]) == 0
    assert done == list(THREE)
    assert "Where each method may be trusted" in capsys.readouterr().out
    text = (tmp_path / "stability.md").read_text()
    page = (tmp_path / "report.html").read_text()
    for name in THREE:
        assert f"## Experiment {name}" in text
        assert f"![Experiment {name}]({name}.png)" in text
        assert f"Experiment {name}" in page
    assert "1 of 1 as theory has them" in text
    assert "loads \\| small" in text
    assert page.count("data:image/png;base64,") == len(THREE)
    assert "http" not in page.replace("http-equiv", "")


def test_what_is_kept_is_not_done_again(tmp_path: Path, done: list[str]) -> None:
    assert command(["stability", THREE[1], "--out", str(tmp_path)]) == 0
    assert command(["stability", "--out", str(tmp_path)]) == 0
    assert done == [THREE[1], THREE[0], THREE[2]]
    first = (tmp_path / "stability.md").read_bytes()
    assert command(["stability", THREE[0], "--out", str(tmp_path)]) == 0
    assert len(done) == 3
    assert (tmp_path / "stability.md").read_bytes() == first


def test_an_edge_that_is_not_where_theory_has_it_leaves_with_3(
    tmp_path: Path, done: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("runningbond.studies.stability.report.find_out", lambda name: finding(measured=1.002))
    for _ in range(2):  # done, then found
        assert command(["stability", THREE[0], "--out", str(tmp_path)]) == 3
        assert f"{THREE[0]}: largest load [N]: measured 1.002, by theory 1" in capsys.readouterr().err
    assert "0.2 %, does not agree" in (tmp_path / "stability.md").read_text()


def test_an_experiment_that_breaks_does_not_lose_the_others(
    tmp_path: Path, done: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def find_out(name: str) -> Finding:
        if name == THREE[1]:
            raise ZeroDivisionError("division by zero")
        return finding()

    monkeypatch.setattr("runningbond.studies.stability.report.find_out", find_out)
    assert command(["stability", "--out", str(tmp_path)]) == 3
    assert f"{THREE[1]} ended in an error: ZeroDivisionError: division by zero" in capsys.readouterr().err
    assert {path.stem for path in tmp_path.glob("*.json")} == {THREE[0], THREE[2]}


def test_an_unknown_experiment_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["stability", "time-stop", "--out", str(tmp_path / "new")]) == 2
    printed = capsys.readouterr().err
    assert 'did you mean "time-step"?' in printed
    assert printed.count("\n") == 1
    assert not (tmp_path / "new").exists()


STOPPED_IN_THE_SECOND = """
import sys, time
import runningbond.studies.stability.report as report
from compare.command import main
from tests.stability.test_stability_command import finding

def find_out(name):
    if name == report.EXPERIMENTS[1] and "fast" not in sys.argv[1]:
        try:
            print("in the middle", flush=True)
            time.sleep(60)
        except KeyboardInterrupt:  # as a model takes it: for the end of one run, not of all
            pass
    return finding(name)

report.find_out = find_out
main(["stability", "--out", sys.argv[2]])
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_command_stopped_in_the_middle_goes_on_where_it_was(how: signal.Signals, tmp_path: Path) -> None:
    def start(pace: str) -> "subprocess.Popen[str]":
        line = [sys.executable, "-c", STOPPED_IN_THE_SECOND, pace, str(tmp_path / "found")]
        return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    process = start("slow")
    assert process.stdout is not None
    assert process.stdout.readline() == "in the middle\n"
    time.sleep(0.1)
    os.kill(process.pid, how)
    _, errors = process.communicate(timeout=60)
    kept = tmp_path / "found" / f"{EXPERIMENTS[0]}.json"
    if how != signal.SIGKILL:
        assert process.returncode == 130
        assert f"1 of {len(EXPERIMENTS)} experiments are kept in" in errors
        assert "the same command goes on" in errors
        assert "Traceback" not in errors
    assert [path.name for path in (tmp_path / "found").iterdir() if path.suffix == ".json"] == [kept.name]
    assert json.loads(kept.read_bytes())["title"] == EXPERIMENTS[0]
    before = kept.stat().st_mtime_ns
    again = start("fast")
    again.communicate(timeout=120)
    assert again.returncode == 0
    assert kept.stat().st_mtime_ns == before
    assert {path.stem for path in (tmp_path / "found").glob("*.json")} == set(EXPERIMENTS)
