"""Deformable blocks beside rigid ones where both have the same joint points, on the twelve panels.

Prints a Markdown table, one row a panel as it ends. From the project's directory, for all panels or some of them:

    python benchmarks/studies/same_points.py
    python benchmarks/studies/same_points.py panel-10 panel-12

A dry wall's λ depends on its history, and where slips set off slips a history on the last bit of a number. Draws of
one wall differ in its density, by parts in a thousand million that change nothing else:

    python benchmarks/studies/same_points.py --draws 5 panel-11
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from statistics import mean

from joblib import Parallel, delayed

from compare import published_scene, run_model
from compare.table import bracket
from fem_interface.model import fem
from results import Outcome
from scene import Scene

PANELS = [f"panel-{row:02d}" for row in range(1, 13)]

TOLERANCE = 0.005

DRAW = 1e-9
"""Relative difference of density between two draws."""


def redrawn(scene: Scene, k: int) -> Scene:
    """A wall that differs from another in nothing that counts."""
    return replace(scene, block=replace(scene.block, density=scene.block.density * (1 + k * DRAW)))


def outcome_of(scene: Scene, model: str) -> Outcome:
    """Outcome of one model, at the joint points of rigid blocks."""
    if model == "fem":
        return fem(scene, TOLERANCE, points="joints")
    return run_model(model, scene, TOLERANCE)


def middle(outcomes: Sequence[Outcome]) -> float | None:
    """Mean multiplier, if every outcome has one."""
    each = [outcome.multiplier for outcome in outcomes if outcome.multiplier is not None]
    return mean(each) if len(each) == len(outcomes) else None


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Deformable blocks beside rigid ones with the same joint points.")
    parser.add_argument("panels", nargs="*", default=PANELS)
    parser.add_argument("--draws", type=int, choices=range(1, 100), metavar="N", default=1, help="runs of each model")
    asked = parser.parse_args()
    print("| panel | `dem-dynamic` | `fem` | its middle beside the other's |\n|---|---|---|---|")
    with Parallel(n_jobs=-1) as workers:
        for name in asked.panels:
            walls = [redrawn(published_scene(name), k) for k in range(asked.draws)]  # of 1000 GPa, as the paper's are
            # What takes longest first.
            cases = [(wall, model) for model in ("fem", "dem-dynamic") for wall in walls]
            outcomes = workers(delayed(outcome_of)(*case) for case in cases)
            deformable, rigid = outcomes[: asked.draws], outcomes[asked.draws :]
            of_deformable, of_rigid, off = middle(deformable), middle(rigid), ""
            if of_deformable is not None and of_rigid is not None:
                off = f"{round(100 * (of_deformable / of_rigid - 1), 2) or 0.0:+.2f} %"  # no −0.0
            brackets = (", ".join(map(bracket, each)) for each in (rigid, deformable))
            print(f"| {name} | {' | '.join(brackets)} | {off} |", flush=True)


if __name__ == "__main__":
    main()
