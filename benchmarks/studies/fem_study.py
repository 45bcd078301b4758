"""Convergence of the load multiplier of deformable blocks: joint quadrature, mesh, modes, lumped loads and load steps.

Prints a Markdown table, one row per run as it ends: the bracket of λ, and the difference of its middle from that of
`dem-dynamic`. From the project's directory, for all walls (panel-06 takes longest) or some of them:

    python benchmarks/studies/fem_study.py
    python benchmarks/studies/fem_study.py panel-04 wall-w1
"""

import sys
from dataclasses import dataclass
from typing import Literal

from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from fem_interface.modes import BENDING, ModeCount
from runningbond.compare import published_scene
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.joints import Rule, gauss, lobatto
from runningbond.results import Outcome
from runningbond.scene import Scene
from runningbond.scene.errors import exits_in_a_line

WALLS = {"panel-02": 2, "panel-04": 4, "panel-06": 2, "wall-w1": 4}
"""Walls, and the number of cells of the finest mesh for each."""

INSET = 0.02
"""Distance of wall-w1's contacts from the ends of its joints [m], which makes its λ unique."""

RULES = {"Lobatto 2": lobatto(), "Lobatto 3": lobatto(3), "Gauss 2": gauss(2)}


@dataclass(frozen=True)
class Case:
    """Settings of one run of a wall."""

    rule: str = "Lobatto 2"
    points: Literal["elements", "joints"] = "elements"
    cells: int = 1
    modes: ModeCount = BENDING
    loads: Literal["consistent", "inner"] = "consistent"
    first_step: float = FIRST_STEP

    def run(self, scene: Scene) -> Outcome:
        """Outcome of a scene with these settings."""
        rule: Rule = RULES[self.rule]
        return fem(
            scene,
            cells=self.cells,
            modes=self.modes,
            rule=rule,
            points=self.points,
            loads=self.loads,
            first_step=self.first_step,
        )

    def __str__(self) -> str:
        return f"{self.rule} | {self.points} | {self.cells} | {self.modes} | {self.loads} | {self.first_step:g}"


def cases(finest: int) -> list[Case]:
    """Cases, mostly with one setting varied at a time."""
    on: tuple[Literal["elements", "joints"], ...] = ("elements", "joints")
    modes: tuple[ModeCount, ...] = (3, 6, 20, "all")
    found = [Case(rule, points) for points in on for rule in RULES]
    found += [Case(rule, cells=cells) for rule in ("Lobatto 2", "Gauss 2") for cells in (2, 4) if cells <= finest]
    found += [Case(modes=count) for count in modes]
    found.append(Case(loads="inner"))
    return found + [Case(first_step=step) for step in (0.04, 0.06)]


def wall(name: str) -> Scene:
    """A published wall with E = 1000 GPa, as in the paper."""
    scene = published_scene(name)
    inset = INSET if name == "wall-w1" else 0.0
    return scene.with_block(young=1e12, poisson=0.0).with_joint(inset=inset)


def row(name: str, case: str, outcome: Outcome, reference: float | None) -> str:
    """A row of the table."""
    if outcome.multiplier is None or reference is None:
        return f"| {name} | {case} | {outcome.status} | |"
    change = round(100 * (outcome.multiplier / reference - 1), 1) or 0.0  # no −0.0
    return f"| {name} | {case} | {outcome.lower:.4f}–{outcome.upper:.4f} | {change:+.1f} % |"


def main() -> None:
    """Print the table."""
    walls = {name: wall(name) for name in sys.argv[1:] or WALLS}
    print("| wall | rule | on | cells | modes | loads | first step | λ | to `dem-dynamic` |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, scene in walls.items():
        for step in (FIRST_STEP, 0.04, 0.06):
            rigid = dem_dynamic(scene, first_step=step)
            if step == FIRST_STEP:
                reference = rigid.multiplier
            print(row(name, f"`dem-dynamic` | joints | | 3 | | {step:g}", rigid, reference), flush=True)
        for case in cases(WALLS.get(name, 1)):
            print(row(name, str(case), case.run(scene), reference), flush=True)


if __name__ == "__main__":
    with exits_in_a_line():
        main()
