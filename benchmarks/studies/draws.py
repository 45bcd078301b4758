"""Draws of the models that follow a loading path beside certified loads, on walls with more than one collapse load.

Prints a Markdown table, one row per wall and model as it ends. Draws stored in the folder are not computed again:

    python benchmarks/studies/draws.py --draws 20 panel-07 panel-10 panel-11 panel-12
    python benchmarks/studies/draws.py --draws 20 --models dem-dynamic --scatter size=0.01 panel-12
"""

import argparse
import time
from pathlib import Path

from runningbond.compare import published_scene
from runningbond.compare.table import bracket
from runningbond.draws import Draws, Sampling
from runningbond.models import MODELS, run_model
from runningbond.results.outcome import number

WALLS = ["panel-07", "panel-10", "panel-11", "panel-12"]
PATHS = [model.name for model in MODELS.values() if model.kind == "history"]
TOLERANCE = 0.005


def row(draws: Draws) -> str:
    """Cells of a row: number of collapses; lowest, median and highest λ; mean with its standard error; scatter."""
    loads = draws.multipliers
    count = f"{len(loads)} of {len(draws.outcomes)}"
    if draws.mean is None or draws.error is None:
        return f"{count} | | | | |"
    scatter = draws.error * len(loads) ** 0.5 / draws.mean
    three = " | ".join(number(load) for load in (loads[0], draws.quantiles["50"], loads[-1]))
    return f"{count} | {three} | {number(draws.mean)} ± {draws.error:.1g} | {100 * scatter:.2g} %"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walls", nargs="*", default=WALLS)
    parser.add_argument("--models", nargs="+", choices=PATHS, default=PATHS)
    parser.add_argument("--draws", type=int, default=20)
    parser.add_argument("--scatter", default="bits")
    parser.add_argument("--jobs", type=int, default=-1)
    parser.add_argument("--tolerance", type=float, default=TOLERANCE)
    parser.add_argument("--folder", type=Path, default=Path("draws"), help="where draws are kept")
    asked = parser.parse_args()
    print("| wall | model | draws | lowest | median | highest | mean | scatter | seconds each |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in asked.walls:
        scene = published_scene(name)
        for model in ("limit", "limit-nonassociated"):
            start = time.perf_counter()
            found = run_model(model, scene)
            print(
                f"| {name} | `{model}` | {bracket(found)} | | | | | | {time.perf_counter() - start:.2g} |", flush=True
            )
        for model in asked.models:
            sampling = Sampling(scene, MODELS[model], asked.draws, asked.scatter)
            draws = sampling.run(asked.tolerance, asked.folder / name / asked.scatter, asked.jobs)
            seconds = sum(outcome.seconds for outcome in draws.outcomes) / len(draws.outcomes)
            print(f"| {name} | `{model}` | {row(draws)} | {seconds:.2g} |", flush=True)


if __name__ == "__main__":
    main()
