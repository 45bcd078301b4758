"""Whether walls fall by mechanisms that close earlier gaps, which certificates for the undeformed wall exclude.

Prints a Markdown table, one row per wall: the bracket of `dem-dynamic`, certified loads, the number of joint points
that close in the fall by more than a thousandth of the largest motion, and how many of these were open when it began.

    python benchmarks/studies/gaps_in_falls.py panel-10 panel-12
"""

import argparse

import numpy as np

from dem.dynamic import dem_dynamic
from runningbond.compare import published_scene
from runningbond.compare.table import bracket
from runningbond.dynamics import Run, State
from runningbond.models import run_model
from runningbond.scene import Array

CLOSES = 1e-3
TOLERANCE = 0.005


class Holds:
    """Observer that keeps the first and last motion ``(nd,)`` under each load, and the run."""

    def __init__(self) -> None:
        self.motions: dict[float, tuple[Array, Array]] = {}
        self.run: Run | None = None

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Store the motion of a state."""
        self.run = run
        now = state.motion.copy()
        self.motions[multiplier] = self.motions.get(multiplier, (now, now))[0], now


def row(name: str) -> str:
    """Table row of a wall."""
    scene, seen = published_scene(name), Holds()
    outcome = dem_dynamic(scene, TOLERANCE, observe=seen)
    if outcome.upper is None or seen.run is None:
        return f"| {name} | {bracket(outcome)} | | | |"
    start, end = seen.motions[outcome.upper]
    system, jumps = seen.run.system, seen.run.interface.jumps
    rate, _ = jumps(system.unrestrained(end - start))
    gap, _ = jumps(system.unrestrained(start))
    closing = rate < -CLOSES * np.abs((end - start)[system.rigid][:, :2]).max()
    open_before = closing & (gap > 0)
    certified = bracket(run_model("limit-nonassociated", scene))
    return f"| {name} | {bracket(outcome)} | {certified} | {closing.sum()} | {open_before.sum()} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walls", nargs="*", default=["panel-10", "panel-12"])
    print("| wall | `dem-dynamic` | certified | points that close in the fall | open when it began |")
    print("|---|---|---|---|---|")
    for name in parser.parse_args().walls:
        print(row(name), flush=True)


if __name__ == "__main__":
    main()
