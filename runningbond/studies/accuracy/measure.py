"""Measurement of one case of the study: the answer of a model, its time and its memory."""

import os
import platform
import statistics
import sys
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import psutil

from runningbond.studies import Row
from runningbond.studies.apart import limit_time, resource

from .parameters import settings_of
from .questions import AnswerRow, ask
from .walls import StudiedWall, accuracy_walls, all_walls, error

RUNS, CHEAP = 3, 2.0  # number of timed runs, if the first takes at most so many CPU seconds; else one
REFERENCE = "limit"  # its CPU time on the same wall is the unit of cost ratios, which are valid on every machine


def measure(name: str, model: str, parameter: str, setting: str) -> Row:
    """Measure a case in this process, after an untimed run that loads the kernels.

    The untimed run is on a small stack for collapse loads, and on the wall itself for other questions. The row contains
    what is known of the wall, the `AnswerRow` and its relative error; median, smallest and largest value over the timed
    runs of wall-clock time, CPU time, and CPU time relative to that of `REFERENCE` just before; and the peak memory
    [MB].
    """
    wall, settings = all_walls()[name], settings_of(model, parameter, setting)
    interval = wall.interval()
    row: Row = {"blocks": wall.blocks, "question": wall.question, "known": wall.known, "machine": machine()}
    if interval is not None:
        row |= {"answer_low": interval[0], "answer_high": interval[1]}
    brought_down = wall.question == "collapse"
    ask(wall.question, model, accuracy_walls()["stack-of-5"].scene if brought_down else wall.scene, settings)
    if brought_down:
        ask(wall.question, REFERENCE, wall.scene, {})
    spent: dict[str, list[float]] = {"wall_s": [], "cpu_s": [], "ratio": []}
    memory = 0.0
    while not spent["cpu_s"] or (len(spent["cpu_s"]) < RUNS and spent["cpu_s"][0] <= CHEAP):
        unit = _timed(wall, REFERENCE, {})[2] if brought_down else None
        limit_time()
        held = start_of_memory()
        answer, clock, processor = _timed(wall, model, settings)
        memory = max(memory, (most_memory() - held) / 1e6)
        spent["wall_s"].append(clock)
        spent["cpu_s"].append(processor)
        spent["ratio"] += [] if unit is None else [processor / unit]
    row |= answer._asdict()
    if interval is not None and answer.value is not None:
        row["error"] = error(answer.value, interval)
    row |= {"runs": len(spent["cpu_s"]), "memory_mb": memory}
    for name, values in spent.items():
        if values:
            row |= {name: statistics.median(values), f"{name}_min": min(values), f"{name}_max": max(values)}
    return row


def _timed(wall: StudiedWall, model: str, settings: dict[str, Any]) -> tuple[AnswerRow, float, float]:
    """An answer, and its wall-clock and CPU seconds."""
    clock, processor = time.perf_counter(), time.process_time()
    result = ask(wall.question, model, wall.scene, settings)
    return result, time.perf_counter() - clock, time.process_time() - processor


@cache
def machine() -> str:
    """Processor, cores, system and Python; nothing that identifies the owner."""
    processor = platform.processor() or platform.machine()
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        processor = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), processor)
    return f"{processor}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def start_of_memory() -> float:
    """Reset the peak of the memory if the system allows it; returns the memory at the start [bytes]."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return most_memory()


def most_memory() -> float:
    """Peak memory of this process [bytes].

    On Linux `ru_maxrss` includes the memory that the parent process had at the start; ``VmHWM`` does not.
    """
    with suppress(OSError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * float(line.split()[1])
    if resource is None:  # Windows
        return float(psutil.Process().memory_info().peak_wset)
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
