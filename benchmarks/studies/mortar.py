"""Why models of the mortared walls carry more than was measured: missing features, added one after the other.

    python benchmarks/studies/mortar.py [WALL …] [--only WORDS]

Prints the largest force [kN] at small displacements, its deviation from the measured one, and processor seconds. The
last rows change one parameter of the shipped scene, with rigid blocks that split.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from runningbond.joints import joint_stiffness
from runningbond.laboratory import chosen_walls
from runningbond.laboratory.rig import Features, scene_of, with_inner_stiffness
from runningbond.laboratory.scores import marks_of
from runningbond.models import TOLERANCE
from runningbond.results import Outcome
from runningbond.scene import Scene, Stiffness
from runningbond.scene.errors import exits_in_a_line

CRUSHES = Features(closes=True, crushes=True)
SPLITS = replace(CRUSHES, splits=True)


def same(scene: Scene) -> Scene:
    """Return the scene as shipped."""
    return scene


def straight(scene: Scene) -> Scene:
    """Set linear softening with the same fracture energies, in the joints and in the bricks."""
    return replace(scene, joint_materials=tuple(replace(each, softening="linear") for each in scene.joint_materials))


def unhardened(scene: Scene) -> Scene:
    """Set a cap without hardening, and linear softening."""
    return straight(scene).with_joint(peak_closure=0.0)


def softer(scene: Scene) -> Scene:
    """Set a quarter of the joints' stiffness."""
    stiffness = joint_stiffness(scene.joint)
    return scene.with_joint(elasticity=Stiffness(stiffness.normal / 4, stiffness.shear / 4))


@dataclass(frozen=True)
class Case:
    """A model, the features of the wall that its scene includes, and a change of the scene."""

    what: str
    solve: Callable[..., Outcome] = dem_dynamic
    features: Features = SPLITS
    change: Callable[[Scene], Scene] = same
    settings: dict[str, Any] = field(default_factory=dict)


CASES = (
    Case(
        "rigid blocks that crush", features=CRUSHES, change=lambda s: s.with_joint(softening="linear", peak_closure=0.0)
    ),
    Case("… and split", change=unhardened),
    Case("deformable blocks, one cell in half a brick, 10 modes", fem, SPLITS, unhardened),
    Case("… two cells, 20 modes", fem, SPLITS, unhardened, {"cells": 2, "modes": 20}),
    Case("… a cap that hardens up to κ_p", fem, SPLITS, straight, {"cells": 2, "modes": 20}),
    Case("… exponential softening: `fem-small`", fem, SPLITS, same, {"cells": 2, "modes": 20}),
    *(
        Case(
            f"… cracks between all triangles of {n} × {n} cells",
            fem,
            replace(SPLITS, parts=n),
            settings={"cells": n, "cracks": "blocks"},
        )
        for n in (1, 2, 3, 4, 6)
    ),
    *(
        Case(
            f"… as stiff between {n} × {n} cells as on axes",
            fem,
            settings={"cells": n, "cracks": "blocks"},
        )
        for n in (2, 4)
    ),
    Case(
        "… twice as stiff between 4 × 4 cells",
        fem,
        replace(SPLITS, parts=4),
        lambda s: with_inner_stiffness(s, 2),
        {"cells": 4, "cracks": "blocks"},
    ),
    Case("rigid blocks that split, as shipped"),
    Case("f_m 5 MPa", change=lambda s: s.with_joint(compressive_strength=5e6)),
    Case("G_II 20 J/m²", change=lambda s: s.with_joint(fracture_energy_2=20.0)),
    Case("a quarter of the joints' stiffness", change=softer),
)


def main(names: list[str], words: str) -> None:
    """Print one row per wall and case, for cases whose names contain `words`."""
    walls = chosen_walls(names)
    print("| wall | what | V [kN] | ΔV | CPU s |\n| --- | --- | --- | --- | --- |")
    for name in names:
        for case in (case for case in CASES if words in case.what):
            scene = case.change(scene_of(walls[name], case.features))
            start = time.process_time()
            outcome = case.solve(scene, TOLERANCE, **case.settings)
            seconds, marks = time.process_time() - start, marks_of(outcome.curve, cyclic=False)
            measured, numbers = walls[name].peak, f"{outcome.status} | –"
            if marks is not None and measured is not None:
                numbers = f"{marks.strength / 1e3:.1f} | {marks.strength / measured - 1:+.1%}"
            print(f"| {name} | {case.what} | {numbers} | {seconds:.0f} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walls", nargs="*", default=["J4D", "J6D", "J7D"])
    parser.add_argument("--only", default="", help="words that a case must have in its name")
    asked = parser.parse_args()
    with exits_in_a_line():
        main(asked.walls, asked.only)
