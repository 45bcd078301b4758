"""Cost laws of the models, fitted to tables of comparisons and printed as the `Cost` of each model.

For walls larger than those of the comparison the fit includes docs/cost-over-size.csv, which
`benchmarks/cost_over_size.py` wrote.

From the project's directory, after ``runningbond compare --fresh --out fine`` and the same with ``--tolerance 0.05``
and ``--out coarse``, for the exponents of the tolerance:

    python benchmarks/studies/cost_laws.py fine/table.csv coarse/table.csv
"""

import csv
import math
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import runningbond as rb
from dem.dynamic import dem_dynamic
from runningbond.compare import published_scene
from runningbond.compare.advice import TOLERANCE
from runningbond.models import MODELS, run_model
from runningbond.models.costs import FITTED_TOLERANCE
from runningbond.scene import Scene

LARGE = "docs/cost-over-size.csv"

BRACKETING = [model.name for model in MODELS.values() if model.kind == "history"]


def seconds_of(table: str) -> dict[tuple[str, str], tuple[int, float]]:
    """Blocks and seconds by scene and model."""
    with Path(table).open(encoding="utf-8", newline="") as file:
        return {
            (row["scene"], row["model"]): (int(row["blocks"]), float(row["seconds"]))
            for row in csv.DictReader(file)
            if row["status"] in ("collapse", "undecided")
        }


def seconds_beyond(blocks: int) -> list[tuple[str, int, float]]:
    """Model, blocks and seconds of walls with more than this number of blocks."""
    with Path(LARGE).open(encoding="utf-8", newline="") as file:
        rows = [
            (row["model"], int(row["blocks"]), float(row["seconds"]))
            for row in csv.DictReader(file)
            if row["status"] == "collapse"
        ]
    return [row for row in rows if row[1] > blocks]


DEARER: dict[str, tuple[str, dict[str, float]]] = {
    "softened": ("joint.fracture_energy_1", {"cohesion": 2e4, "fracture_energy_1": 5.0, "fracture_energy_2": 20.0}),
    "crushed": ("joint.compressive_strength", {"compressive_strength": 5e5}),
    "soft": ("block.young", {"young": 5e9}),
}
"""Features that increase the cost: the key that a model must read, and changes of the default material."""


def print_factors() -> None:
    """Print the factors on the time of each model by the changes in `DEARER`: medians over walls W1 to W3."""
    walls = [published_scene(f"wall-w{k}") for k in (1, 2, 3)]
    for model in MODELS.values():
        for factor, (key, changes) in DEARER.items():
            if key not in model.reads:
                continue
            change = Scene.with_block if key.startswith("block") else Scene.with_joint
            ratios = [
                _processor_seconds(model.name, change(scene, **changes)) / _processor_seconds(model.name, scene)
                for scene in walls
            ]
            print(f"{model.name}: {factor}={np.median(ratios):.2g}", flush=True)


CRACKING: dict[str, Any] = {
    "block_width": 0.25,
    "block_height": 0.125,
    "thickness": 0.12,
    "density": 1800.0,
    "young": 1e10,
    "poisson": 0.15,
    "friction": 0.65,
    "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01},
    "inner_joint": {"friction": 1.0, "cohesion": 1e6, "normal_stiffness": 1e12, "shear_stiffness": 4e11},
}
"""Keys of walls whose blocks may crack."""


def print_cracked() -> None:
    """Print the factor on the time of `fem` by cracks between all triangles, as in `advise`, on three panels."""
    walls = [rb.Wall.running_bond(length=length, height=0.5, **CRACKING).scene for length in (0.5, 0.75, 1.0)]
    ratios = [_processor_seconds("fem", each, cracks="blocks") / _processor_seconds("fem", each) for each in walls]
    print(f"fem: cracked={np.median(ratios):.2g}", flush=True)


def _processor_seconds(model: str, scene: Scene, **settings: Any) -> float:
    """Processor seconds at the tolerance of `advise`, of a second run, without compilation."""
    run_model(model, scene, TOLERANCE, **settings)
    start = time.process_time()
    run_model(model, scene, TOLERANCE, **settings)
    return time.process_time() - start


def main() -> None:
    """Fit log seconds against log blocks and absence of weight, one line per model; then against the tolerance."""
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    fine = seconds_of(sys.argv[1])
    beyond = seconds_beyond(max(n for n, _ in fine.values()))
    for model in MODELS:
        rows = [(n, not any(published_scene(s).load.gravity), t) for (s, m), (n, t) in fine.items() if m == model]
        rows += [(n, False, t) for m, n, t in beyond if m == model]
        n, weightless, seconds = np.array(rows, dtype=float).T
        terms = np.column_stack([np.ones_like(n), np.log(n / 100), weightless])
        found = np.linalg.lstsq(terms, np.log(seconds))[0]
        spread = np.exp(np.std(np.log(seconds) - terms @ found))
        at_100, growth, factor = np.exp(found[0]), found[1], np.exp(found[2])
        print(f"{model}: Cost({at_100:.2g}, {growth:.2f}, {spread:.2f}, weightless={factor:.2g})")
    if len(sys.argv) > 2:
        coarse = seconds_of(sys.argv[2])
        for model in BRACKETING:
            ratios = [math.log(fine[cell][1] / t) for cell, (_, t) in coarse.items() if cell[1] == model]
            print(f"{model}: finer={np.mean(ratios) / math.log(TOLERANCE / FITTED_TOLERANCE):.2f}")
    seconds = []
    for _ in range(2):
        start = time.process_time()
        dem_dynamic(published_scene("wall-w1"))
        seconds.append(time.process_time() - start)
    print(f"KERNELS = {seconds[0] - seconds[1]:.1f}")
    print_factors()
    print_cracked()


if __name__ == "__main__":
    main()
