"""`dem-static` on large running-bond walls: nested dissection beside bands, in one run, and λ of `limit`.

    python benchmarks/static_large.py [BLOCKS …]

Processor seconds, medians of runs made in turn; bands are run up to `BANDS_UP_TO` blocks. Where friction leaves more
than one collapse load the two differ by more than their brackets, by rounding alone, and so does the number of linear
systems: hence their milliseconds as well.
"""

import statistics
import sys
import time
from unittest.mock import patch

from limit_large import SIZES, wall

from dem.static import dem_static
from runningbond.limit import limit
from runningbond.results import Outcome
from runningbond.scene import Mortar, Scene

RUNS = 3
BANDS_UP_TO = 1176
WAYS = {"dissection": 0, "band": sys.maxsize}
"""Blocks from which on systems are dissected."""


def timed(scene: Scene, many: int) -> tuple[Outcome, float]:
    """Outcome, and processor seconds."""
    with patch("dem.static_system.MANY", many):
        start = time.process_time()
        outcome = dem_static(scene)
        return outcome, time.process_time() - start


def main(sizes: list[int]) -> None:
    """Print a row a wall and way of solving its systems."""
    timed(stiff(300), 0)  # loads the kernels
    print("blocks  limit    systems are in   lower    upper    status     systems       [s]  [ms] each")
    for size in sizes:
        scene = stiff(size)
        bound = limit(scene).multiplier
        ways = {way: many for way, many in WAYS.items() if way != "band" or size <= BANDS_UP_TO}
        runs = [{way: timed(scene, many) for way, many in ways.items()} for _ in range(RUNS)]
        for way in ways:
            outcome, seconds = runs[0][way][0], statistics.median(run[way][1] for run in runs)
            systems = outcome.steps or 1
            bracket = " ".join("       –" if x is None else f"{x:8.4f}" for x in (outcome.lower, outcome.upper))
            print(
                f"{scene.wall.sum():6d} {bound or float('nan'):7.4f}   {way:14} {bracket}    {outcome.status:10} "
                f"{systems:7d} {seconds:9.1f} {1e3 * seconds / systems:9.2f}",
                flush=True,
            )


def stiff(size: int) -> Scene:
    """The panel of `limit_large` on mortar of 1 GPa, 10 mm thick."""
    scene = wall(*SIZES[size])
    return scene.with_joint(elasticity=Mortar(1e9, 0.2, 0.01))


if __name__ == "__main__":
    main([int(one) for one in sys.argv[1:]] or list(SIZES)[:3])
