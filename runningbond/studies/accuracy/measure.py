"""One case of the study: what a model answers, what that takes, and how much memory."""

import os
import platform
import resource
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path

from runningbond.studies import Row
from runningbond.studies.apart import limit_time

from .parameters import settings_of
from .questions import Answer, ask
from .walls import accuracy_walls, all_walls, error

RUNS, CHEAP = 3, 2.0
"""Timed runs of a case, where one takes no more than so many processor seconds; one of a more expensive case."""

REFERENCE = "limit"
"""Model whose processor seconds on the same wall are the unit of ratios, which hold from machine to machine."""

MEGABYTE = 1e6


def measure(name: str, model: str, parameter: str, setting: str) -> Row:
    """Measure a case in this process, after an untimed run on a small wall of the same kind that loads the kernels.

    The row has the wall and what is known of it, the `Answer` and its relative error, and of the timed runs the median,
    the least and the most seconds by the clock, of the processor, and of the processor in those of `REFERENCE`, run
    just before; and the most memory that a run took beyond what its process held before [MB].
    """
    wall, settings = all_walls()[name], settings_of(model, parameter, setting)
    interval = wall.interval()
    row: Row = {"blocks": wall.blocks, "question": wall.question, "known": wall.known, "machine": machine()}
    if interval is not None:
        row |= {"answer_low": interval[0], "answer_high": interval[1]}
    small = accuracy_walls()["block-slides"].scene if wall.question == "collapse" else wall.scene

    def reference() -> Answer:
        return ask(wall.question, REFERENCE, wall.scene, {})

    ask(wall.question, model, small, settings)
    if wall.question == "collapse":
        reference()
    clock: list[float] = []
    processor: list[float] = []
    ratio: list[float] = []
    memory: list[float] = []
    while not clock or (len(clock) < RUNS and processor[0] <= CHEAP):
        unit = _timed(reference)[2] if wall.question == "collapse" else None
        limit_time()
        held = start_of_memory()
        answer, *seconds = _timed(lambda: ask(wall.question, model, wall.scene, settings))
        memory.append(max(0.0, most_memory() - held) / MEGABYTE)
        clock.append(seconds[0])
        processor.append(seconds[1])
        ratio += [] if unit is None else [seconds[1] / unit]
    row |= answer._asdict()
    if interval is not None and answer.value is not None:
        row["error"] = error(answer.value, interval)
    row |= {"runs": len(clock), "memory_mb": max(memory)}
    return row | _spread("wall_s", clock) | _spread("cpu_s", processor) | _spread("ratio", ratio)


def _timed(run: Callable[[], Answer]) -> tuple[Answer, float, float]:
    """An answer, and its seconds by the clock and of the processor."""
    clock, processor = time.perf_counter(), time.process_time()
    result = run()
    return result, time.perf_counter() - clock, time.process_time() - processor


def _spread(name: str, values: Sequence[float]) -> Row:
    """Median, least and most of what was measured, if anything was."""
    if not values:
        return {}
    return {name: statistics.median(values), f"{name}_min": min(values), f"{name}_max": max(values)}


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
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
