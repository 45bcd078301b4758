"""Limit analysis of every published wall beside a bare `linprog` call on the same matrices.

The two are timed in turn, run by run; the table has the median ratio and its spread.
"""

import statistics
import time
from collections.abc import Callable
from typing import Any, TypeVar

from scipy.optimize import linprog

from runningbond.compare import PUBLISHED, published_scene
from runningbond.limit import equilibrium, limit
from runningbond.limit.force_program import coulomb, force_program

RUNS = 5
Argument = TypeVar("Argument")


def seconds(call: Callable[[Argument], object], argument: Argument) -> float:
    """Wall-clock time of one call."""
    start = time.perf_counter()
    call(argument)
    return time.perf_counter() - start


def bare(program: dict[str, Any]) -> object:
    """Solve a linear program by a direct call of HiGHS."""
    return linprog(**program, method="highs-ipm")


def main() -> None:
    """Print one row per wall."""
    print("wall                 blocks   build [ms]   linprog [s]   limit [s]   limit / linprog (spread)")
    for case in PUBLISHED:
        scene = published_scene(case.name)
        system = equilibrium(scene)
        program = force_program(system, coulomb(system.strength))

        limit(scene)
        build = statistics.median(seconds(equilibrium, scene) for _ in range(RUNS))
        pairs = [(seconds(bare, program), seconds(limit, scene)) for _ in range(RUNS)]
        ratios = sorted(whole / alone for alone, whole in pairs)
        print(
            f"{case.name:20} {scene.wall.sum():6d} {1e3 * build:12.2f} {statistics.median(p[0] for p in pairs):13.3f} "
            f"{statistics.median(p[1] for p in pairs):11.3f} {statistics.median(ratios):11.2f} "
            f"({ratios[0]:.2f} … {ratios[-1]:.2f})"
        )


if __name__ == "__main__":
    main()
