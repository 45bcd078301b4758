"""`dem-static` on large running-bond walls: bracket beside λ of `limit`, cost, and cost of a linear system.

    python benchmarks/static_large.py [BLOCKS …]

Prints processor seconds, medians of several runs. The last columns are milliseconds of one linear system, by nested
dissection and by a library's sparse factorisation (`static_pushover`).
"""

import statistics
import time

from limit_large import SIZES, chosen_sizes, wall
from static_pushover import linear_system

from dem.static import dem_static
from dem.static_system import static_system
from runningbond.limit import limit
from runningbond.results import Outcome
from runningbond.scene import Mortar, Scene

RUNS = 3


def timed(scene: Scene) -> tuple[Outcome, float]:
    """Outcome of `dem-static`, and processor seconds."""
    start = time.process_time()
    outcome = dem_static(scene)
    return outcome, time.process_time() - start


def main(sizes: list[int]) -> None:
    """Print one row per wall."""
    timed(stiff(300))  # loads the kernels
    print("blocks   limit    lower    upper  status     systems       [s]  [ms] each      own   sparse")
    for size in sizes:
        scene = stiff(size)
        bound = limit(scene).multiplier
        outcomes, spent = zip(*(timed(scene) for _ in range(RUNS)), strict=True)
        outcome, seconds = outcomes[0], statistics.median(spent)
        bracket = " ".join("       –" if x is None else f"{x:8.4f}" for x in (outcome.lower, outcome.upper))
        print(
            f"{scene.wall.sum():6d} {bound or float('nan'):7.4f} {bracket}  {outcome.status:10} {outcome.steps:7d} "
            f"{seconds:9.1f} {1e3 * seconds / (outcome.steps or 1):10.2f} {linear_system(static_system(scene))}",
            flush=True,
        )


def stiff(size: int) -> Scene:
    """The panel of `limit_large` with mortar of 1 GPa, 10 mm thick."""
    scene = wall(*SIZES[size])
    return scene.with_joint(elasticity=Mortar(1e9, 0.2, 0.01))


if __name__ == "__main__":
    main(chosen_sizes(__doc__, list(SIZES)[:3]))
