"""Deformable blocks beside rigid ones on the sixteen panels, with the same joint points or on finer meshes.

Prints a Markdown table, one row per panel as it ends. From the project's directory, for all panels or some of them:

    python benchmarks/studies/beside_rigid_blocks.py
    python benchmarks/studies/beside_rigid_blocks.py panel-10 panel-12

With a mesh of two cells in half a block along the course and in its height, with the same points or with points on
every joint element:

    python benchmarks/studies/beside_rigid_blocks.py --cells 2
    python benchmarks/studies/beside_rigid_blocks.py --cells 2 --points elements

A dry wall's λ depends on its history; where one slip triggers others, the history depends on the last bits of numbers.
Draws of a wall differ in density by a few parts in 1e9, which changes nothing else; rows then have the mean of their
λ with its standard error, and their range:

    python benchmarks/studies/beside_rigid_blocks.py --draws 25 panel-11
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np
from joblib import Parallel, delayed

from fem_interface.joint_elements import PointsOn
from fem_interface.model import fem
from runningbond.compare import published_scene
from runningbond.compare.table import answer
from runningbond.models import run_model
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Array, Scene

PANELS = [f"panel-{row:02d}" for row in range(1, 13)] + [f"point-load-{ratio}" for ratio in (4, 2, 1, "quarter")]

TOLERANCE = 0.005

DRAW = 1e-9
"""Relative difference of density between two draws."""


def redrawn(scene: Scene, k: int) -> Scene:
    """The k-th draw of a wall, whose density differs by k times `DRAW`."""
    return scene.with_block(density=scene.block.density * (1 + k * DRAW))


def outcome_of(scene: Scene, model: str, cells: int = 1, points: PointsOn = "joints") -> Outcome:
    """Outcome of a model; for `fem` with the given number of cells, and points on joint elements or whole joints."""
    if model == "fem":
        return fem(scene, TOLERANCE, cells=cells, points=points)
    return run_model(model, scene, TOLERANCE)


@dataclass(frozen=True)
class Sample:
    """Multipliers of one wall's draws.

    Parameters
    ----------
    each : (n,) float
        Middle of each draw's bracket.
    """

    each: Array

    @property
    def mean(self) -> float:
        """Mean multiplier."""
        return float(self.each.mean())

    @property
    def error(self) -> float:
        """Standard error of the mean; 0 for a single draw."""
        return float(self.each.std(ddof=1) / np.sqrt(len(self.each))) if len(self.each) > 1 else 0.0

    def __str__(self) -> str:
        """Mean, standard error from their scatter, and range."""
        mean, least, most = (number(x) for x in (self.mean, self.each.min(), self.each.max()))
        return f"{mean} ± {100 * self.error / self.mean:.2f} % ({least} … {most})"


def sample(outcomes: Sequence[Outcome]) -> Sample | None:
    """Multipliers of the outcomes that have one; None if none has."""
    each = [outcome.multiplier for outcome in outcomes if outcome.multiplier is not None]
    return Sample(np.array(each)) if each else None


def told(outcomes: Sequence[Outcome]) -> str:
    """Answer of one outcome, or the sample of several, with the number of multipliers if not all have one."""
    if len(outcomes) == 1:
        return answer(outcomes[0])
    found = sample(outcomes)
    answered = len(found.each) if found else 0
    return f"{found or ''}{'' if answered == len(outcomes) else f' {answered} of {len(outcomes)}'}".strip()


def apart(deformable: Sample, rigid: Sample) -> str:
    """Relative difference of the means, with its standard error if there are several draws."""
    ratio = deformable.mean / rigid.mean
    off = f"{round(100 * (ratio - 1), 2) or 0.0:+.2f}"  # no −0.0
    if len(rigid.each) == len(deformable.each) == 1:
        return f"{off} %"
    error = ratio * math.hypot(deformable.error / deformable.mean, rigid.error / rigid.mean)
    return f"{off} ± {100 * error:.2f} %"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Deformable blocks beside rigid ones.")
    parser.add_argument("panels", nargs="*", default=PANELS)
    parser.add_argument("--draws", type=int, choices=range(1, 100), metavar="N", default=1, help="runs of each model")
    parser.add_argument("--cells", type=int, choices=range(1, 9), metavar="N", default=1, help="cells of the mesh")
    parser.add_argument("--points", choices=get_args(PointsOn), default="joints", help="what joint points are laid on")
    asked = parser.parse_args()
    print("| panel | `dem-dynamic` | `fem` | beside the other's |\n|---|---|---|---|")
    with Parallel(n_jobs=-1) as workers:
        for name in asked.panels:
            walls = [redrawn(published_scene(name), k) for k in range(asked.draws)]  # E = 1000 GPa, as in the paper
            # The slowest cases first.
            cases = [(wall, model) for model in ("fem", "dem-dynamic") for wall in walls]
            outcomes = workers(delayed(outcome_of)(*case, asked.cells, asked.points) for case in cases)
            deformable, rigid = outcomes[: asked.draws], outcomes[asked.draws :]
            of_deformable, of_rigid = sample(deformable), sample(rigid)
            off = apart(of_deformable, of_rigid) if of_deformable and of_rigid else ""
            print(f"| {name} | {told(rigid)} | {told(deformable)} | {off} |", flush=True)


if __name__ == "__main__":
    main()
