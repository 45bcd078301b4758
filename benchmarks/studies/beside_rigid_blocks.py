"""Deformable blocks beside rigid ones on the sixteen panels, where both have the same joint points or on finer meshes.

Prints a Markdown table, one row a panel as it ends. From the project's directory, for all panels or some of them:

    python benchmarks/studies/beside_rigid_blocks.py
    python benchmarks/studies/beside_rigid_blocks.py panel-10 panel-12

Points are on the joint elements of a mesh, two cells in half a block along the course and in its height, by

    python benchmarks/studies/beside_rigid_blocks.py --cells 2

A dry wall's λ depends on its history, and where slips set off slips a history on the last bit of a number. Draws of
one wall differ in its density, by parts in a thousand million that change nothing else; then rows are means of their
λ with standard errors, and their range:

    python benchmarks/studies/beside_rigid_blocks.py --draws 25 panel-11
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from joblib import Parallel, delayed

from compare import published_scene, run_model
from compare.table import bracket
from fem_interface.model import fem
from results import Outcome
from scene import Array, Scene

PANELS = [f"panel-{row:02d}" for row in range(1, 13)] + [f"point-load-{ratio}" for ratio in (4, 2, 1, "quarter")]

TOLERANCE = 0.005

DRAW = 1e-9
"""Relative difference of density between two draws."""


def redrawn(scene: Scene, k: int) -> Scene:
    """A wall that differs from another in nothing that counts."""
    return replace(scene, block=replace(scene.block, density=scene.block.density * (1 + k * DRAW)))


def outcome_of(scene: Scene, model: str, cells: int | None = None) -> Outcome:
    """Outcome of one model, at the joint points of rigid blocks, or those of a mesh of so many cells."""
    if model != "fem":
        return run_model(model, scene, TOLERANCE)
    return fem(scene, TOLERANCE, cells=cells) if cells else fem(scene, TOLERANCE, points="joints")


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
        """Their mean."""
        return float(self.each.mean())

    @property
    def error(self) -> float:
        """Standard error of the mean; 0 of a single draw."""
        return float(self.each.std(ddof=1) / np.sqrt(len(self.each))) if len(self.each) > 1 else 0.0

    def __str__(self) -> str:
        """Mean, standard error and range."""
        return f"{self.mean:.4f} ± {self.error:.4f} ({self.each.min():.4f} … {self.each.max():.4f})"


def sample(outcomes: Sequence[Outcome]) -> Sample | None:
    """Multipliers, if every outcome has one."""
    each = [outcome.multiplier for outcome in outcomes if outcome.multiplier is not None]
    return Sample(np.array(each)) if len(each) == len(outcomes) else None


def answer(outcome: Outcome) -> str:
    """Bracket of an outcome, after its status if that is none that has a multiplier."""
    status = "" if outcome.multiplier is not None else outcome.status
    return f"{status} {bracket(outcome)}".strip()


def apart(deformable: Sample, rigid: Sample) -> str:
    """How far one mean is from the other, with its standard error where there are draws."""
    ratio = deformable.mean / rigid.mean
    off = f"{round(100 * (ratio - 1), 2) or 0.0:+.2f}"  # no −0.0
    if len(rigid.each) == 1:
        return f"{off} %"
    error = ratio * math.hypot(deformable.error / deformable.mean, rigid.error / rigid.mean)
    return f"{off} ± {100 * error:.2f} %"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Deformable blocks beside rigid ones.")
    parser.add_argument("panels", nargs="*", default=PANELS)
    parser.add_argument("--draws", type=int, choices=range(1, 100), metavar="N", default=1, help="runs of each model")
    parser.add_argument("--cells", type=int, choices=range(1, 9), metavar="N", help="cells of the mesh points are on")
    asked = parser.parse_args()
    print("| panel | `dem-dynamic` | `fem` | its middle beside the other's |\n|---|---|---|---|")
    with Parallel(n_jobs=-1) as workers:
        for name in asked.panels:
            walls = [redrawn(published_scene(name), k) for k in range(asked.draws)]  # of 1000 GPa, as the paper's are
            # What takes longest first.
            cases = [(wall, model) for model in ("fem", "dem-dynamic") for wall in walls]
            outcomes = workers(delayed(outcome_of)(*case, asked.cells) for case in cases)
            deformable, rigid = outcomes[: asked.draws], outcomes[asked.draws :]
            of_deformable, of_rigid = sample(deformable), sample(rigid)
            off = apart(of_deformable, of_rigid) if of_deformable and of_rigid else ""
            told = [
                answer(each[0]) if asked.draws == 1 else str(of_each or "")
                for each, of_each in ((rigid, of_rigid), (deformable, of_deformable))
            ]
            print(f"| {name} | {' | '.join(told)} | {off} |", flush=True)


if __name__ == "__main__":
    main()
