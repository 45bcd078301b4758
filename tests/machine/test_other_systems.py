"""What Windows lacks is removed here: folder locks, signal masks, time limits. Not run on Windows itself."""

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from runningbond.results import Outcome, StoreError, load_outcome, save_outcome
from runningbond.scene import folder_lock
from runningbond.scene.folder_lock import LOCK, locked
from runningbond.studies import apart

filelock = pytest.importorskip("filelock")

ROOT = Path(__file__).parents[2]

WITHOUT = """
import builtins, os, signal, sys
kept = builtins.__import__
def found(name, globals=None, *others, **more):
    if name in ("fcntl", "resource") and (globals or {}).get("__name__", "").startswith("runningbond"):
        raise ImportError(name)
    return kept(name, globals, *others, **more)
builtins.__import__ = found
del signal.pthread_sigmask, signal.SIGXCPU, os.O_DIRECTORY
"""


def without(script: str) -> "subprocess.CompletedProcess[str]":
    """Run a script on a Python without these features."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *filter(None, sys.path)])}
    command = [sys.executable, "-c", WITHOUT + script]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.long
def test_runs_and_campaigns_work_without_posix_features(tmp_path: Path) -> None:
    script = f"""
import runningbond as rb
from runningbond.commands.command_line import command
from runningbond.studies import apart
if __name__ == "__main__":
    assert apart.resource is None
    out = {str(tmp_path)!r}
    assert command(["run", "panel-01", "--model", "limit", "--json", "--out", out + "/run"]) == 0
    walls, changes = rb.read("panel-01"), {{"joint.friction": [0.4, 0.5]}}
    for again in range(2):
        assert set(rb.sweep(walls, changes, "limit", folder=out + "/swept", jobs=2)["status"]) == {{"collapse"}}
"""
    done = without(script)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[0])["status"] == "collapse"
    assert load_outcome(tmp_path / "run")[0].status == "collapse"
    assert len(list((tmp_path / "swept").rglob("outcome.json"))) == 2


@pytest.fixture
def no_fcntl(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folder_lock, "fcntl", None)


def is_free(folder: Path) -> bool:
    other = filelock.FileLock(folder / LOCK, is_singleton=False)
    try:
        other.acquire(timeout=0)
    except filelock.Timeout:
        return False
    other.release()
    return True


@pytest.mark.usefixtures("no_fcntl")
def test_lock_file_locks_a_folder_without_fcntl(tmp_path: Path) -> None:
    with locked(tmp_path):
        assert not is_free(tmp_path)
    assert is_free(tmp_path)
    with pytest.raises(RuntimeError, match="inside"), locked(tmp_path):
        raise RuntimeError("inside")
    assert is_free(tmp_path)
    with pytest.raises(FileNotFoundError), locked(tmp_path / "missing"):
        pass


@pytest.mark.usefixtures("no_fcntl")
def test_outcomes_are_saved_and_loaded_without_fcntl(tmp_path: Path) -> None:
    for seconds in (1.0, 2.0):
        save_outcome(Outcome("wall", "limit", "undecided", seconds=seconds), tmp_path, "key")
    assert load_outcome(tmp_path)[0].seconds == 2.0
    assert {path.name.split("-")[0] for path in tmp_path.iterdir()} <= {LOCK, "outcome.json", "arrays"}
    with pytest.raises(StoreError, match="holds no outcome"):
        load_outcome(tmp_path / "missing")


@pytest.mark.usefixtures("no_fcntl")
def test_folder_that_cannot_be_locked_is_still_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: Any, **__: Any) -> None:
        raise PermissionError(13, "Permission denied")

    save_outcome(Outcome("wall", "limit", "undecided"), tmp_path, "key")
    monkeypatch.setattr(filelock.FileLock, "acquire", refused)
    assert load_outcome(tmp_path)[1] == "key"


def test_process_over_its_time_ends_itself_without_system_limits() -> None:
    script = "from runningbond.studies import apart\napart.LONGEST = 1\napart.limit_time()\nwhile True: pass"
    assert without(script).returncode == 152
    assert apart.ENDED != 152


SOURCES = [
    path
    for room in ("runningbond", "dem", "fem_interface", "homog", "meshing", "docs", "examples", "tools")
    for path in (ROOT / room).rglob("*.py")
]
POSIX = {"fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty"}
GUARDED = {"O_DIRECTORY", "SIGXCPU", "pthread_sigmask"}
"""Names used only behind a guard; the tests above remove them."""


def test_no_unguarded_use_of_posix_features() -> None:
    """Modules outside a ``try``, names of `os` and `signal` that Windows lacks; text is read and written as UTF-8."""
    lacking = {name for name in dir(os) if name in {"fork", "geteuid", "getuid", "killpg", "mkfifo", "setsid", "uname"}}
    lacking |= {"SIGALRM", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGUSR1", "SIGUSR2", "alarm", "setitimer"}
    found = []
    for path in SOURCES:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        guarded = {id(line) for node in ast.walk(tree) if isinstance(node, ast.Try) for line in node.body}
        for node in ast.walk(tree):
            asked: set[str] = set()
            if isinstance(node, ast.Import) and id(node) not in guarded:
                asked = {name.name.split(".")[0] for name in node.names} & POSIX
            elif (
                isinstance(node, ast.Attribute)
                and isinstance(node.value, ast.Name)
                and node.value.id in ("os", "signal")
            ):
                asked = {node.attr} & (lacking - GUARDED)
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                text = node.func.attr in ("read_text", "write_text") and "/proc/" not in ast.unparse(node.func)
                if text and "encoding" not in {word.arg for word in node.keywords}:
                    asked = {ast.unparse(node)}
            found += [f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 0)}: {name}" for name in asked]
    assert not found


def test_shipped_file_names_are_valid_on_every_system() -> None:
    """No character that Windows refuses, no device name, and no two names that differ only by case."""
    kept = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    names = [name for name in kept.stdout.decode().split("\0") if name] or [
        path.relative_to(ROOT).as_posix() for path in SOURCES
    ]
    assert not [name for name in names if re.search(r'[<>:"|?*\\\x00-\x1f]|[. ](/|$)', name)]
    devices = re.compile(r"(?i)(^|/)(con|prn|aux|nul|com\d|lpt\d)(\.[^/]*)?(/|$)")
    assert not [name for name in names if devices.search(name)]
    assert len({name.lower() for name in names}) == len(names)


def test_first_load_needs_no_compiler_mesher_or_vtk() -> None:
    """A browser's Python lacks them: `limit` of the wall that ``new`` writes, with all of them removed."""
    absent = ("numba", "llvmlite", "gmsh", "skfem", "meshio", "pyvista", "vtkmodules", "matplotlib", "psutil")
    script = f"""
import sys
for name in {absent}:
    sys.modules[name] = None
from runningbond.limit import limit
from runningbond.scene import read_scene
print(f"{{limit(read_scene('runningbond/commands/scene.toml')).multiplier:.4f}}")
"""
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "0.4740\n"), done.stderr
