"""Parallel tasks on one machine."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import psutil
import pytest
from joblib import effective_n_jobs

from runningbond.campaigns import processes


@pytest.mark.parametrize(
    ("jobs", "tasks", "cores", "started"),
    [(-1, 1, 16, 2), (-1, 5, 16, 5), (-1, 40, 16, 16), (8, 5, 16, 5), (3, 5, 16, 3), (8, 40, 1, 2), (-1, 5, 1, 1)],
)
def test_number_of_processes_is_limited_by_cores_and_tasks(
    jobs: int, tasks: int, cores: int, started: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At least two if there are worker processes at all, because joblib computes one job in this process."""
    monkeypatch.setattr(processes, "cpu_count", lambda: cores)
    with processes._processes(jobs, tasks):
        assert effective_n_jobs(None) == started


@pytest.mark.parametrize(("calls", "jobs", "elsewhere"), [(2, 2, True), (2, 1, False), (1, 2, False)])
def test_which_processes_make_calls_in_background(calls: int, jobs: int, elsewhere: bool) -> None:
    """A single call, and all calls of one job, are made in this process."""
    with processes.in_background([os.getpid] * calls, jobs) as results:
        found = list(results)
    assert len(found) == calls
    assert all((number != os.getpid()) == elsewhere for number in found)


def later(number: int) -> int:
    """The number, after a time [s] that is longest for 0."""
    time.sleep(0.5 if number == 0 else 0.0)
    return number


def test_results_from_background_keep_the_order_of_calls() -> None:
    with processes.in_background([partial(later, k) for k in range(4)], 2) as results:
        assert list(results) == [0, 1, 2, 3]


@pytest.mark.filterwarnings("error")
def test_error_ends_calls_in_background(tmp_path: Path) -> None:
    """They once went on, and the process with them, until all were done."""
    with pytest.raises(KeyboardInterrupt), processes.in_background([partial(touch_late, tmp_path)] * 6, 2):
        raise KeyboardInterrupt
    with processes.in_background([partial(later, 1)] * 2, 2) as results:
        assert list(results) == [1, 1]
    assert len(list(tmp_path.iterdir())) <= 2


def touch_late(folder: Path) -> None:
    """Leave a file after a while."""
    time.sleep(1.0)
    (folder / f"{os.getpid()}-{time.monotonic_ns()}").touch()


def number_unless(here: int) -> int:
    """The number of this process, which is killed unless it is the one `here`."""
    if os.getpid() != here:
        os.kill(os.getpid(), signal.SIGKILL)
    return here


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signal")
def test_calls_of_killed_processes_are_made_here() -> None:
    with processes.in_background([partial(number_unless, os.getpid())] * 3, 2) as results:
        assert list(results) == [os.getpid()] * 3


WORKER = """
import os, time
from runningbond.campaigns.processes import begin
begin(os.getppid())
print(os.getpid(), flush=True)
time.sleep(60)
"""
PARENT = "import subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]])"


@pytest.mark.skipif(os.name == "nt", reason="a process of Windows keeps the number of its parent")
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_worker_ends_with_its_parent(how: signal.Signals) -> None:
    """Workers of a script that was killed during a sweep once continued to compute."""
    with subprocess.Popen([sys.executable, "-c", PARENT, WORKER], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        worker = psutil.Process(int(parent.stdout.readline()))
        parent.send_signal(how)
    worker.wait(timeout=20)
