"""One case of the study: what a model answers, what that takes, and how much memory."""

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

RUNS, CHEAP = 3, 2.0  # timed runs of a case of which one takes no more processor seconds than that; else one
REFERENCE = "limit"  # its processor seconds on the same wall are the unit of ratios, which hold on every machine


def measure(name: str, model: str, parameter: str, setting: str) -> Row:
    """Measure a case in this process, after an untimed run on a small wall of the same kind that loads the kernels.

    The row has what is known of the wall, the `AnswerRow` and its relative error; median, least and most seconds of
    timed runs by the clock, of the processor, and in those of `REFERENCE` just before; and the most memory they took
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
    """An answer, and its seconds by the clock and of the processor."""
    clock, processor = time.perf_counter(), time.process_time()
    result = ask(wall.question, model, wall.scene, settings)
    return result, time.perf_counter() - clock, time.process_time() - processor


@cache
def machine() -> str:
    """Processor, cores, system and Python; not whose it is."""
    processor = platform.processor() or platform.machine()
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        processor = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), processor)
    return f"{processor}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def start_of_memory() -> float:
    """Begin to watch for the most memory from here on, where the system can; returns what is held now [bytes]."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return most_memory()


def most_memory() -> float:
    """The most memory that this process has held [bytes].

    Linux counts towards `ru_maxrss` what a process's parent held when it began, and keeps another mark without that.
    """
    with suppress(OSError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * float(line.split()[1])
    if resource is None:  # Windows
        return float(psutil.Process().memory_info().peak_wset)
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
