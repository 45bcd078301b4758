"""A case in its own single-threaded process, which ends if it takes too much CPU time or if the study is stopped.

``python -m runningbond.studies.apart MODULE FUNCTION CASE`` prints what a function measures for a case, as JSON.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Event, Thread
from typing import Any

from .study import Case, Row

resource: Any
try:
    import resource
except ImportError:  # Windows
    resource = None

ENDED = -signal.SIGXCPU if resource else 152
"""Exit code of a process that exceeded its CPU time."""

LONGEST = 60  # CPU time [s] after which a run is ended, counted from the call of `limit_time`
TOO_LONG = "too long"  # status of a case whose run took more than `LONGEST`
POLL = 0.2  # time between two checks of a process [s]


class Ended(Exception):
    """A process ended without a result."""


def measure_apart(measure: Callable[..., Row], case: Case, stop: Event | None = None) -> Row:
    """Measure a JSON-serialisable case in a fresh process, until `stop` is set; `Ended` if there is no result."""
    command = [sys.executable, "-P", "-m", __name__, measure.__module__, measure.__name__, json.dumps(case)]
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    path = os.pathsep.join(filter(None, [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]))
    environment, pipe = {**os.environ, **threads, "PYTHONPATH": path}, subprocess.PIPE
    with subprocess.Popen(command, env=environment, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            while True:
                with suppress(subprocess.TimeoutExpired):
                    printed, complaint = process.communicate(timeout=POLL)
                    break
                if stop is not None and stop.is_set():
                    raise KeyboardInterrupt
        finally:
            process.kill()  # if it has not ended
            process.wait()
    if process.returncode == ENDED:
        return {"status": TOO_LONG, "message": f"more than {LONGEST} s of the processor"}
    if process.returncode:
        last = (complaint.strip().splitlines() or [f"signal {-process.returncode}"])[-1]
        raise Ended(f"its process ended without an answer: {last}")
    row: Row = json.loads(printed.splitlines()[-1])
    return row


def limit_time() -> None:
    """End this process after `LONGEST` more seconds of CPU time, by the system or, where it cannot, by a thread."""
    global _limit
    if resource is None:
        if _limit is None:
            Thread(target=_watch, daemon=True).start()
        _limit = time.process_time() + LONGEST
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime) + LONGEST, hard))


_limit: float | None = None


def _watch() -> None:
    while _limit is None or time.process_time() < _limit:
        time.sleep(POLL)
    os._exit(ENDED)


if __name__ == "__main__":
    # Only the study ends this process: an interrupted model would return its partial result as if it were its answer.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    module, function, words = sys.argv[1:]
    print(json.dumps(getattr(import_module(module), function)(*json.loads(words))))
