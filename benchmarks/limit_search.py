"""The search for the smallest certified load on published walls, also with inset contacts: loads, programs, seconds.

    python -m benchmarks.limit_search [SCENE …]

Processor seconds are those of one run each, by one worker.
"""

import sys
import time

from runningbond.compare import PUBLISHED, published_scene
from runningbond.limit import limit_nonassociated
from runningbond.scene import Scene
from runningbond.scene.errors import exits_in_a_line

INSET = 0.02


def main(names: list[str]) -> None:
    """Print one row per wall."""
    scenes: list[tuple[str, Scene]] = [(name, published_scene(name)) for name in names]
    print("wall                 blocks   lower         upper         programs   seconds")
    scenes += [(f"{name}, inset", scene.with_joint(inset=INSET)) for name, scene in scenes if name.startswith("wall")]
    for name, scene in scenes:
        start = time.process_time()
        outcome = limit_nonassociated(scene)
        seconds = time.process_time() - start
        loads = " ".join(f"{'–' if load is None else f'{load:.6g}':13}" for load in (outcome.lower, outcome.upper))
        print(f"{name:20} {scene.wall.sum():6d}   {loads} {outcome.steps:8d} {seconds:9.2f}", flush=True)


if __name__ == "__main__":
    with exits_in_a_line():
        main(sys.argv[1:] or [case.name for case in PUBLISHED])
