"""Associated limit analysis of large running-bond walls: interior point and repair beside HiGHS, in one run.

    python benchmarks/limit_large.py [BLOCKS …]

Walls are named by their number of blocks, one of `SIZES`. Prints processor seconds, medians of runs in turn; HiGHS
solves walls of up to `HIGHS_UP_TO` blocks.
"""

import argparse
import statistics
import time
from collections.abc import Sequence

from runningbond.limit import equilibrium, limit
from runningbond.limit.force_program import coulomb, solve_forces
from runningbond.scene import Scene, scene_from_dict

SIZES = {300: (12, 24), 1176: (24, 48), 5000: (50, 99), 10000: (70, 140)}
"""Blocks per course, and number of courses, by the number of blocks."""

RUNS = 3
HIGHS_UP_TO = 1176


def chosen_sizes(description: str | None, default: Sequence[int]) -> list[int]:
    """Sizes named on the command line, or those that are run by default."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sizes", nargs="*", type=int, default=list(default), metavar="BLOCKS")
    sizes: list[int] = parser.parse_args().sizes
    if unknown := [size for size in sizes if size not in SIZES]:
        parser.error(f"no wall has {unknown[0]} blocks; choose from {', '.join(map(str, SIZES))}")
    return sizes


def wall(blocks: int, courses: int) -> Scene:
    """Panel of blocks of 240 × 60 × 120 mm under lateral load proportional to its weight."""
    return scene_from_dict(
        {
            "title": "large panel",
            "wall": {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12}
            | {"length": 0.24 * blocks, "height": 0.06 * courses},
            "block": {"density": 1800.0},
            "joint": {"friction": 0.6},
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
        }
    )


def main(sizes: list[int]) -> None:
    """Print one row per wall."""
    print("blocks   lower        upper        width     limit [s]   HiGHS alone [s]   its λ")
    for size in sizes:
        scene = wall(*SIZES[size])
        seconds: tuple[list[float], list[float]] = ([], [])
        highs = "–"
        for _ in range(RUNS):
            start = time.process_time()
            outcome = limit(scene)
            seconds[0].append(time.process_time() - start)
            if size <= HIGHS_UP_TO:
                start = time.process_time()
                system = equilibrium(scene).under_live_load()
                highs = f"{solve_forces(system, coulomb(system.strength)).multiplier:.10f}"
                seconds[1].append(time.process_time() - start)
        if outcome.lower is None or outcome.upper is None:
            raise SystemExit(f"{size} blocks: {outcome.status}, {outcome.message}")
        old = f"{statistics.median(seconds[1]):.2f}" if seconds[1] else "–"
        print(
            f"{scene.wall.sum():6d} {outcome.lower:12.9f} {outcome.upper:12.9f} "
            f"{outcome.upper / outcome.lower - 1:9.1e} {statistics.median(seconds[0]):11.2f} {old:>17} {highs:>14}"
        )


if __name__ == "__main__":
    main(chosen_sizes(__doc__, list(SIZES)))
