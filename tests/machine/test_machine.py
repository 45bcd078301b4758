"""No result is lost by Ctrl-C, SIGKILL, full or read-only disks, a second writer or damaged files."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from runningbond.commands.command_line import command, main
from runningbond.compare.published import find_scene
from runningbond.limit import limit
from runningbond.pictures.mechanism import mechanism_frame
from runningbond.pictures.offscreen import why_not_drawn
from runningbond.pictures.recording import StaticRecorder
from runningbond.pictures.time_series import frame_files
from runningbond.results import Outcome, StoreError, load_outcome, make_folder, save_outcome, write_atomically
from tests.at_length import at_length
from tests.walls import courses

from .commands import COMMANDS, COMPARE, MESH, RENDER, TITLE, WALL, Command
from .disk import disk_trials_apart
from .faults import at_once, damage, interrupt
from .trial import LOST, NOT_TRIED, REDONE, REFUSED, Scratch, call


def what_commands_need(home: Path) -> dict[str, Path]:
    """Folders with the inputs of some commands: a scene, and the result of a run."""
    needed = {"compare": home / "scene", "render": home / "result"}
    needed["compare"].mkdir()
    # With another title; otherwise the charts of the published walls would be drawn each time.
    (needed["compare"] / "wall.toml").write_text(find_scene(WALL).read_text().replace(TITLE, "wall"))
    call(["run", WALL, "--model", "limit", "--out", str(needed["render"])])
    return needed


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders with undisturbed results of mesh, compare and render."""
    home = tmp_path_factory.mktemp("machine")
    needed = what_commands_need(home)
    for each in (MESH, COMPARE, *([] if why_not_drawn() else [RENDER])):
        Scratch(each, home).prepare(needed.get(each.name))
    return home


@pytest.mark.parametrize("how", [signal.SIGKILL, *at_length(signal.SIGINT)])
def test_interrupted_mesh_is_complete_after_a_second_call(how: signal.Signals, home: Path) -> None:
    trial = interrupt(Scratch(MESH, home), home / f"mesh-{how}", how, how.name)
    assert (trial.verdict, trial.kept) == (REDONE, 0)
    assert trial.message == ("runningbond: interrupted; every file is whole, or as it was before" if how == 2 else "")


@pytest.mark.long
def test_interrupted_pictures_are_complete_after_a_second_call(home: Path) -> None:
    if why_not_drawn():
        pytest.skip("nothing can be drawn here")
    trial = interrupt(Scratch(RENDER, home), home / "pictures", signal.SIGINT, "Ctrl-C")
    assert (trial.verdict, trial.code) == (REDONE, 130)
    assert (trial.kept, trial.pieces) == (1, 3)


@pytest.mark.long
def test_full_and_read_only_disks_are_reported_without_loss(home: Path) -> None:
    """On a small disk that becomes full after the first case, and on a read-only one."""
    found = {(trial.command, trial.fault): trial for trial in disk_trials_apart(home, ["mesh", "compare"])}
    assert [trial.verdict for trial in found.values() if trial.fault == "full disk"] == [REDONE, REDONE]
    read_only = [trial for trial in found.values() if trial.fault == "read-only folder"]
    assert {trial.verdict for trial in read_only} <= {REFUSED, NOT_TRIED}
    full = found["compare", "full disk"]
    assert "of 4 cases are kept in OUT; the same command goes on." in full.message
    assert f"{full.kept} of 4 cases" in full.message
    for trial in read_only:
        if trial.verdict == REFUSED:
            assert trial.message.startswith("runningbond: OUT")
            assert (trial.code, trial.kept) == (2, 0)


def test_trial_with_an_unexpected_result_is_lost(home: Path, tmp_path: Path) -> None:
    """So is one with a traceback or a second line of output."""
    scratch = Scratch(MESH, home)
    folder = scratch.fresh(tmp_path / "mesh")
    assert scratch.trial("fault", folder, 2, "a line", REFUSED).verdict == REFUSED
    assert scratch.trial("fault", folder, 2, "two\nlines", REFUSED).verdict == LOST
    assert scratch.trial("fault", folder, 2, "Traceback: line", REFUSED).verdict == LOST
    (folder / "wall.msh").write_bytes((scratch.done / "wall.msh").read_bytes()[:-1])
    assert scratch.trial("fault", folder, 2, "a line", REFUSED).verdict == LOST


def outcome(multiplier: float) -> Outcome:
    return Outcome("wall", "limit", "collapse", multiplier, motion=np.full((4, 3), multiplier))


def test_two_writers_into_one_folder_leave_one_complete_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second starts when the first has written its arrays but not the record that refers to them."""
    writers: list[threading.Thread] = []

    def interrupted(path: Path, content: bytes) -> None:
        if path.name == "outcome.json" and not writers:
            writers.append(threading.Thread(target=save_outcome, args=(outcome(0.6), tmp_path, "second")))
            writers[0].start()
            writers[0].join(timeout=0.5)
        write_atomically(path, content)

    monkeypatch.setattr("runningbond.results.store.write_atomically", interrupted)
    save_outcome(outcome(0.5), tmp_path, "first")
    writers[0].join()
    found, key = load_outcome(tmp_path)
    assert (found.multiplier, key) == (0.6, "second")
    assert len(list(tmp_path.iterdir())) == 2


def test_leftovers_of_a_killed_writer_are_removed(tmp_path: Path) -> None:
    for name in (".outcome.json.k3", ".arrays-0123.npz.k3", "arrays-0123456789abcdef.npz"):
        (tmp_path / name).write_text("half")
    save_outcome(outcome(0.5), tmp_path)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".json", ".npz"]


def test_unwritable_folder_is_reported_before_computing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device", "some temporary name")

    monkeypatch.setattr("tempfile.TemporaryFile", full)
    with pytest.raises(OSError, match="No space") as error:
        make_folder(tmp_path)
    assert error.value.filename == str(tmp_path)
    for line in (["run", "panel-04", "--model", "limit"], ["compare", "panel-04"]):
        assert command([*line, "--out", str(tmp_path)]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err == f"runningbond: {tmp_path}: No space left on device\n"


def test_unwritable_file_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space") as error:
        write_atomically(tmp_path / "table.csv", b"content")
    assert error.value.filename == str(tmp_path / "table.csv")


def test_new_series_removes_the_outcome_of_the_previous_run(tmp_path: Path) -> None:
    """A run killed after its first frame leaves no outcome, instead of that of the run before."""
    scene = courses([[1]])
    found = limit(scene)
    save_outcome(found, tmp_path, "key", scene)
    frame = mechanism_frame(scene, found)
    assert frame is not None
    StaticRecorder(scene, tmp_path).keep(frame)
    assert len(frame_files(tmp_path, "blocks")) == 1
    with pytest.raises(StoreError, match="holds no outcome"):
        load_outcome(tmp_path)


def _halve(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


@pytest.mark.parametrize("content", [b"", b"<VTKFile", bytes(range(256)), b"<VTKFile><DataSet/></VTKFile>"])
def test_damaged_list_of_frames_is_named(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "blocks.pvd").write_bytes(content)
    with pytest.raises(StoreError, match="blocks.pvd: is damaged"):
        frame_files(tmp_path, "blocks")


@pytest.fixture
def shown(home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    if why_not_drawn():
        pytest.skip("nothing can be drawn here")
    monkeypatch.setattr("runningbond.pictures.render.has_mechanism", lambda *_: False)
    return Scratch(RENDER, home).fresh(tmp_path / "shown")


@pytest.mark.parametrize(
    "damage",
    [
        lambda folder: _halve(folder / "frames" / "blocks-0003.vtu"),
        lambda folder: (folder / "frames" / "joints-0003.vtu").unlink(),
        lambda folder: (folder / "frames" / "blocks-0003.vtu").write_bytes(b""),
        lambda folder: (folder / "frames" / "joints-0003.vtu").replace(folder / "frames" / "blocks-0003.vtu"),
    ],
)
def test_damaged_frame_is_named(damage: Any, shown: Path, capfd: pytest.CaptureFixture[str]) -> None:
    damage(shown)
    assert command(["render", str(shown)]) == 2
    said = capfd.readouterr().err
    assert said == (
        f"runningbond: {shown}/frames/blocks-0003.vtu, joints-0003.vtu: are damaged or of another wall; "
        "another run replaces them\n"
    )


def test_ctrl_c_turned_into_another_error_gives_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As by VTK during its import, where Ctrl-C becomes an error for a missing module."""

    def importing(_: object) -> int:
        try:
            os.kill(os.getpid(), signal.SIGINT)
            threading.Event().wait(1)
        except KeyboardInterrupt:
            raise ImportError("No module named vtkmodules.vtkIOXMLParser") from None
        return 0

    monkeypatch.setattr("runningbond.commands.command_line.command", importing)
    before = signal.getsignal(signal.SIGINT)
    try:
        with pytest.raises(SystemExit) as left:
            main([])
    finally:
        signal.signal(signal.SIGINT, before)
    assert left.value.code == 130
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption_in_a_callback_is_not_lost(number: signal.Signals) -> None:
    """A run once continued to its end, and Ctrl-C only printed the traceback of an ignored exception."""
    program = f"""
import os, sys, time
import runningbond.commands.command_line as line
from runningbond.__main__ import main

class Dropped:
    def __del__(self):
        os.kill(os.getpid(), {int(number)})
        time.sleep(0.001)

def run(tokens, **_):
    Dropped()
    time.sleep(20)
    print("not heard")

line.app = run
main()
"""
    start = time.monotonic()
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    told = "runningbond: interrupted; every file is whole, or as it was before\n"
    assert (done.returncode, done.stdout, done.stderr) == (130, "", told)
    assert time.monotonic() - start < 20


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption_after_the_end_of_a_command_is_not_lost(number: signal.Signals) -> None:
    """While idle workers end, for a second: the exit code was once 0, and loops in a shell went on."""
    program = f"""
import atexit, os, time
import runningbond.commands.command_line as line
from runningbond.__main__ import main

def end():
    os.kill(os.getpid(), {int(number)})
    time.sleep(1)

atexit.register(end)
line.app = lambda tokens, **_: print("done")
main()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (-number, "done\n", "")


@pytest.mark.parametrize("module", ["runningbond.commands.command_line", "numpy", "runningbond.commands.validate"])
def test_ctrl_c_during_import_gives_no_traceback(module: str) -> None:
    program = f"""
import os, signal, sys

class Interrupting:
    def find_spec(name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupting)
from runningbond.__main__ import main
sys.argv = ["runningbond", "run", "panel-04", "--model", "limit"]
main()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")


@pytest.mark.parametrize("number", [1, *at_length(0, 2)])
def test_closed_stream_receives_no_output(number: int, tmp_path: Path) -> None:
    """Without stdout there was once a traceback; without stderr its lines once went to stdout."""
    where: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "cwd": tmp_path}
    told = []
    for model in ("homog", "limti"):
        line = [sys.executable, "-m", "runningbond", "run", "panel-04", "--model", model, "--json"]
        shell = ["sh", "-c", f'exec "$@" {number}{"<" if number == 0 else ">"}&-', "sh", *line, "--out", "kept"]
        told.append(subprocess.run(shell, **where, timeout=60))
    right, wrong = told
    assert (right.returncode, right.stderr) == (0, "")
    assert right.stdout == "" if number == 1 else json.loads(right.stdout)["multiplier"] > 0
    assert load_outcome(tmp_path / "kept")[0].status == "collapse"
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr == "" if number == 2 else wrong.stderr.startswith("runningbond: --model = 'limti'")


def test_ctrl_c_after_the_last_case_does_not_wait_for_idle_workers(tmp_path: Path) -> None:
    """While tables and charts are drawn; idle worker processes stay alive for minutes."""
    line = [sys.executable, "-m", "runningbond", "compare", "wall-w1", "panel-04", "--models", "limit", "--jobs", "2"]
    where: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "cwd": tmp_path}
    process = subprocess.Popen([*line, "--out", "kept"], **where)
    assert process.stderr is not None
    while "2 of 2" not in process.stderr.readline():
        pass
    process.send_signal(signal.SIGINT)
    told = process.communicate(timeout=60)
    assert process.returncode == 130, told


@pytest.mark.parametrize("seconds", [2.2, *at_length(2.0, 2.4)])
def test_ctrl_c_in_linear_programs_gives_the_exit_code_of_interruptions(seconds: float, tmp_path: Path) -> None:
    """HiGHS leaves threads behind that abort a process that exits normally."""
    scene = find_scene("point-load-2").read_text().replace('"corners"', '"pinned-corners"')
    (tmp_path / "wall.toml").write_text(scene)
    line = [sys.executable, "-m", "runningbond", "run", "wall.toml", "--model", "limit-nonassociated"]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    while not any("highs" in part.path for part in psutil.Process(process.pid).memory_maps()):
        time.sleep(0.02)
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    told = process.communicate(timeout=60)
    assert process.returncode == 130, told


@pytest.mark.long
@pytest.mark.parametrize("tried", COMMANDS, ids=lambda tried: str(tried.name))
def test_no_command_loses_results_by_any_fault(tried: Command, tmp_path: Path) -> None:
    """Ctrl-C, SIGKILL, a second writer, damaged results, full and read-only disks; some of the disks need a mount."""
    if tried is RENDER and why_not_drawn():
        pytest.skip("nothing can be drawn here")
    scratch = Scratch(tried, tmp_path)
    scratch.prepare(what_commands_need(tmp_path).get(tried.name))
    trials = [
        interrupt(scratch, tmp_path / "interrupted", signal.SIGINT, "Ctrl-C"),
        interrupt(scratch, tmp_path / "killed", signal.SIGKILL, "SIGKILL"),
        at_once(scratch, tmp_path / "twice"),
        damage(scratch, tmp_path / "damaged"),
        *disk_trials_apart(tmp_path, [tried.name]),
    ]
    assert [trial.fault for trial in trials] == [
        *("Ctrl-C", "SIGKILL", "two at once", "damaged result", "full disk", "read-only folder")
    ]
    assert not [trial for trial in trials if trial.verdict == LOST]
