"""λ of dynamic models against the loading rate, on walls whose collapse load depends on the history.

Prints a Markdown table, one row per rate and model as it ends: the time of the first load step in units of the time to
rest, and the range of λ over draws of the wall that differ in their last bits.

    python benchmarks/studies/pace.py panel-12
    python benchmarks/studies/pace.py --models dem-dynamic --viscous 0.1 panel-12
    python benchmarks/studies/pace.py --models fem --points joints --draws 3 panel-12
"""

import argparse
from typing import Any, get_args
from unittest.mock import patch

import numpy as np

import dem.dynamic
from fem_interface.joint_elements import PointsOn
from runningbond.compare import published_scene
from runningbond.draws import Scatter
from runningbond.dynamics import CALMER, load_stepping
from runningbond.dynamics.load_stepping import LOADING
from runningbond.models import run_model

MOVING = ["dem-dynamic", "fem"]
TOLERANCE = 0.005


def row(model: str, name: str, loading: float, draws: int, points: PointsOn) -> str:
    """Cells of a row: lowest, median and highest λ, and mean number of time steps."""
    found, steps = [], 0
    parameters: dict[str, Any] = {"points": points} if model == "fem" else {}
    with patch.object(load_stepping, "LOADING", loading):
        for draw in range(draws):
            outcome = run_model(model, Scatter().draw(published_scene(name), draw), TOLERANCE, **parameters)
            steps += (outcome.steps or 0) // draws
            if outcome.multiplier is not None:
                found.append(outcome.multiplier)
    low, middle, high = np.quantile(found, [0, 0.5, 1])
    return f"{low:.4f} | {middle:.4f} | {high:.4f} | {steps}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walls", nargs="+")
    parser.add_argument("--models", nargs="+", choices=MOVING, default=MOVING)
    parser.add_argument("--loadings", nargs="+", type=float, default=[12, 16, 20, LOADING, 28, 32, 36])
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--viscous", type=float, default=CALMER, help="damping ratio of dem-dynamic's joints")
    parser.add_argument(
        "--points", choices=get_args(PointsOn), default="elements", help="where fem has its joint points"
    )
    asked = parser.parse_args()
    print("| wall | model | times to rest | lowest | median | highest | time steps |")
    print("|---|---|---|---|---|---|---|")
    for name in asked.walls:
        for model in asked.models:
            for loading in asked.loadings:
                with patch.object(dem.dynamic, "CALMER", asked.viscous):
                    cells = row(model, name, loading, asked.draws, asked.points)
                print(f"| {name} | `{model}` | {loading:g} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
