"""One case in a process of its own: what it answers, what it takes, and how much memory.

``python -m compare.accuracy part wall model knob setting`` prints one JSON object.
"""

import json
import os
import platform
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from signal import SIGXCPU
from threading import Event

from runningbond.scene import Scene

from .answer import Answer
from .cases import Case, wall_of
from .parameters import settings_of

RUNS, CHEAP = 3, 2.0
"""Timed runs of a case, where one takes no more than so many processor seconds; one of a dearer case."""

LONGEST = 60
"""Processor seconds after which a run is broken off."""

REFERENCE = "limit"
"""Model whose processor seconds on the same wall are the unit of ratios, which hold from machine to machine."""

MEGABYTE = 1e6
POLL = 0.2
"""Seconds between two looks at a process."""


@dataclass(frozen=True)
class Measurement:
    """What a case came to.

    Parameters
    ----------
    answer
        What the model said.
    wall_s, cpu_s
        Seconds of each run by the clock, and of the processor.
    ratio
        Processor seconds of each run in those of the reference on the same wall, run just before; empty where the
        reference has no answer to the question.
    memory_mb
        The most memory that a run took beyond what its process held before [MB].
    """

    answer: Answer
    wall_s: tuple[float, ...] = ()
    cpu_s: tuple[float, ...] = ()
    ratio: tuple[float, ...] = ()
    memory_mb: float | None = None


class TooLong(Exception):
    """A run took more than `LONGEST`."""


class Killed(Exception):
    """A process ended without an answer."""


def measure(case: Case) -> Measurement:
    """Measure a case in this process, after an untimed run on a small wall of the same kind that loads the kernels."""
    from .questions import ask

    wall, settings = wall_of(case), settings_of(case.model, case.knob, case.setting)
    compared = wall.question == "collapse"

    def reference() -> Answer:
        return ask(wall.question, REFERENCE, wall.scene, {})

    def run() -> Answer:
        return ask(wall.question, case.model, wall.scene, settings)

    ask(wall.question, case.model, _small(case), settings)
    if compared:
        reference()
    times: list[tuple[float, float]] = []
    units: list[float] = []
    memory: list[float] = []
    while not times or (len(times) < RUNS and times[0][1] <= CHEAP):
        if compared:
            units.append(_timed(reference)[2])
        _limit_time()
        held = _start_of_memory()
        found, *seconds = _timed(run)
        memory.append(max(0.0, _most_memory() - held) / MEGABYTE)
        times.append((seconds[0], seconds[1]))
    wall_s, cpu_s = zip(*times, strict=True)
    ratio = tuple(a / b for a, b in zip(cpu_s, units, strict=True)) if compared else ()
    return Measurement(found, wall_s, cpu_s, ratio, max(memory))


def _timed(run: Callable[[], Answer]) -> tuple[Answer, float, float]:
    """An answer, and its seconds by the clock and of the processor."""
    clock, processor = time.perf_counter(), time.process_time()
    found = run()
    return found, time.perf_counter() - clock, time.process_time() - processor


def _small(case: Case) -> Scene:
    """The smallest wall of which the same can be asked."""
    from .walls import accuracy_walls

    wall = wall_of(case)
    return accuracy_walls()["block-slides"].scene if wall.question == "collapse" else wall.scene


def measure_apart(case: Case, stop: Event | None = None) -> Measurement:
    """Measure a case in a fresh process with one thread.

    Parameters
    ----------
    case
        The case.
    stop
        Ends the process when it is set.

    Raises
    ------
    TooLong
        If a run takes more than `LONGEST`.
    Killed
        If the process ends without an answer.
    """
    command = [sys.executable, "-m", "runningbond.studies.accuracy"]
    command += [case.part, case.wall, case.model, case.knob, case.setting]
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    root = str(Path(__file__).parents[3])
    path = os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH", "")]))
    process = subprocess.Popen(
        command,
        env={**os.environ, **threads, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        while True:
            with suppress(subprocess.TimeoutExpired):
                out, complaint = process.communicate(timeout=POLL)
                break
            if stop is not None and stop.is_set():
                raise KeyboardInterrupt
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()
    if process.returncode == -SIGXCPU:
        raise TooLong(f"more than {LONGEST} s of the processor")
    if process.returncode:
        last = (complaint.strip().splitlines() or [f"signal {-process.returncode}"])[-1]
        raise Killed(f"its process ended without an answer: {last}")
    found = json.loads(out.splitlines()[-1])
    wall_s, cpu_s, ratio = (tuple(found[name]) for name in ("wall_s", "cpu_s", "ratio"))
    return Measurement(Answer(**found["answer"]), wall_s, cpu_s, ratio, found["memory_mb"])


@cache
def machine() -> str:
    """Processor, cores, system and Python; not whose it is."""
    return f"{_processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def _processor() -> str:
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _limit_time() -> None:
    """Let the system end this process once it has worked `LONGEST` seconds more."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime) + LONGEST, hard))


def _start_of_memory() -> float:
    """Begin to watch for the most memory from here on, where the system can; returns what is held now [bytes]."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return _most_memory()


def _most_memory() -> float:
    """The most memory that this process has held [bytes].

    Linux counts towards `ru_maxrss` what a process's parent held when it began, and keeps another mark without that.
    """
    with suppress(OSError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * float(line.split()[1])
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
