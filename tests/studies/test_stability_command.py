"""`runningbond stability` reports every experiment, resumes, and says where theory is not met."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from runningbond.commands.command_line import command
from runningbond.studies import Chart, Part, Row, Rows, Study
from runningbond.studies.stability import EXPERIMENTS

THREE = EXPERIMENTS[:3]


def draw(figure: Figure, rows: Rows) -> None:
    figure.add_subplot().plot([0, 1], [0, 1])


CHARTS = [Chart("Sag", draw)]


def beam(measure: Callable[[str], Row], name: str, charts: Sequence[Chart] = CHARTS) -> Study:
    """An experiment that takes no time."""
    part = Part(("beam",), [("long",), ("short",)], measure)
    return Study(name, f"Experiment {name}", {"sag": part}, charts, trusted="loads | small", beyond="falls")


def straight(beam: str) -> Row:
    return {"measured": 1.0, "theory": 1.0, "allowed": 1e-3}


def bent(beam: str) -> Row:
    return {"measured": 1.002, "theory": 1.0, "allowed": 1e-3}


def broken(beam: str) -> Row:
    raise ZeroDivisionError("division by zero")


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Three instant experiments, and a list of the cases that were measured."""
    names: list[str] = []

    def experiment(name: str) -> Study:
        def measure(beam: str) -> Row:
            names.append(f"{name} {beam}")
            return straight(beam)

        return beam(measure, name)

    _experiments(monkeypatch, experiment)
    return names


def _experiments(monkeypatch: pytest.MonkeyPatch, experiment: Callable[[str], Study]) -> None:
    monkeypatch.setattr("runningbond.studies.stability.EXPERIMENTS", THREE)
    monkeypatch.setattr("runningbond.studies.stability.experiment", experiment)


def test_command_reports_every_experiment(tmp_path: Path, done: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["stability", "--out", str(tmp_path)]) == 0
    assert done == [f"{name} {which}" for name in THREE for which in ("long", "short")]
    assert "Where each method may be trusted" in capsys.readouterr().out
    text = (tmp_path / "stability.md").read_text()
    page = (tmp_path / "report.html").read_text()
    for name in THREE:
        assert f"## Experiment {name}" in text
        assert f"![Sag]({name}.png)" in text
        assert f"Experiment {name}" in page
    assert "2 of 2 as theory has them" in text
    assert "loads \\| small" in text
    assert page.count("data:image/png;base64,") == len(THREE)
    assert "http" not in page.replace("http-equiv", "")


def test_kept_experiments_are_not_repeated(tmp_path: Path, done: list[str]) -> None:
    assert command(["stability", THREE[1], "--out", str(tmp_path)]) == 0
    assert {name.split()[0] for name in done} == {THREE[1]}
    assert command(["stability", "--out", str(tmp_path)]) == 0
    assert len(done) == 6
    first = (tmp_path / "stability.md").read_bytes()
    assert command(["stability", THREE[0], "--out", str(tmp_path)]) == 0
    assert len(done) == 6
    assert (tmp_path / "stability.md").read_bytes() == first


def test_edge_that_contradicts_theory_gives_exit_code_3(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _experiments(monkeypatch, lambda name: beam(bent, name))
    for _ in range(2):  # first measured, then read
        assert command(["stability", THREE[0], "--out", str(tmp_path)]) == 3
        assert f"{THREE[0]}: sag: long: measured 1.002, by theory 1" in capsys.readouterr().err
    assert "0.2 %, does not agree" in (tmp_path / "stability.md").read_text()


def test_failing_experiment_does_not_stop_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _experiments(monkeypatch, lambda name: beam(broken if name == THREE[1] else straight, name))
    assert command(["stability", "--out", str(tmp_path)]) == 3
    assert f"{THREE[1]} ended in an error: long, ZeroDivisionError: division by zero" in capsys.readouterr().err
    text = (tmp_path / "stability.md").read_text()
    assert f"## Experiment {THREE[0]}" in text
    assert f"## Experiment {THREE[1]}" not in text
    assert f"{THREE[1]} ended in an error" in text


def test_unknown_experiment_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["stability", "time-stop", "--out", str(tmp_path / "new")]) == 2
    printed = capsys.readouterr().err
    assert 'did you mean "time-step"?' in printed
    assert printed.count("\n") == 1
    assert not (tmp_path / "new").exists()


STOPPED_IN_THE_SECOND = """
import sys, time
from runningbond.commands.command_line import main
from runningbond.studies import stability
from tests.studies.test_stability_command import beam, straight

def slow(which):
    if "fast" not in sys.argv[1] and which == "short":
        try:
            print("in the middle", flush=True)
            time.sleep(60)
        except KeyboardInterrupt:  # as a model takes it: for the end of one run, not of all
            pass
    return straight(which)

stability.experiment = lambda name: beam(slow if name == stability.EXPERIMENTS[1] else straight, name, [])
main(["stability", "--out", sys.argv[2]])
"""


@pytest.mark.long
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_interrupted_command_resumes(how: signal.Signals, tmp_path: Path) -> None:
    def start(pace: str) -> "subprocess.Popen[str]":
        line = [sys.executable, "-c", STOPPED_IN_THE_SECOND, pace, str(tmp_path / "result")]
        return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    process = start("slow")
    assert process.stdout is not None
    assert process.stdout.readline() == "in the middle\n"
    time.sleep(0.1)
    os.kill(process.pid, how)
    _, errors = process.communicate(timeout=60)
    if how != signal.SIGKILL:
        assert process.returncode == 130
        assert f"1 of {len(EXPERIMENTS)} experiments, and what is measured of others, are kept in" in errors
        assert "the same command goes on" in errors
        assert "Traceback" not in errors
    whole, begun = (tmp_path / "result" / f"{name}.csv" for name in EXPERIMENTS[:2])
    assert set((tmp_path / "result").glob("*.csv")) == {whole, begun}
    assert "long" in begun.read_text()
    assert "short" not in begun.read_text()
    before = whole.stat().st_mtime_ns
    again = start("fast")
    again.communicate(timeout=120)
    assert again.returncode == 0
    assert whole.stat().st_mtime_ns == before
    assert {path.stem for path in (tmp_path / "result").glob("*.csv")} == set(EXPERIMENTS)
