"""Possible reasons for bad predictions of dry walls by splitting blocks: one parameter changed at a time.

    python -m benchmarks.dry_walls SW.200.1 WS.100

Prints the largest force of `rigid-splitting` on the test's path and its deviation from the measured one, ratios to the
test of the stiffness and of the displacement at which a fifth of the force is lost, and processor seconds.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest.mock import patch

from runningbond.joints import joint_stiffness
from runningbond.laboratory import shipped_walls
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.measured import MeasuredWall
from runningbond.laboratory.predictions import Prediction
from runningbond.laboratory.rig import scene_of
from runningbond.laboratory.stones import STONES
from runningbond.models import TOLERANCE
from runningbond.scene import Scene, Stiffness

RUNG = LADDER["rigid-splitting"]


def same(scene: Scene) -> Scene:
    """Return the scene unchanged."""
    return scene


def soft_in_shear(scene: Scene) -> Scene:
    """Reduce the shear stiffness from 1 / 2.4 to 1 / 10 of the normal stiffness under the vertical load."""
    stiffness = joint_stiffness(scene.joint)
    return scene.with_joint(elasticity=Stiffness(stiffness.normal, 0.24 * stiffness.shear))


def unclosed(scene: Scene) -> Scene:
    """Keep the stiffness of joints without pressure under any pressure, in shear as well."""
    stiffness = joint_stiffness(scene.joint)
    return scene.with_joint(closure=None, elasticity=Stiffness(stiffness.normal, stiffness.normal / 2.4))


def soft(scene: Scene) -> Scene:
    """Set a quarter of the stiffness of joints without pressure, under any pressure."""
    stiffness = joint_stiffness(scene.joint)
    return scene.with_joint(closure=None, elasticity=Stiffness(stiffness.normal / 4, stiffness.normal / 9.6))


CASES: dict[str, tuple[dict[str, Any], Callable[[Scene], Scene]]] = {
    "as shipped": ({}, same),
    "f_t of blocks 2.2 MPa, 0.6 of sandstone's flexural strength": ({"tensile": 2.2e6}, same),
    "f_t of blocks 1.5 MPa": ({"tensile": 1.5e6}, same),
    "tan φ 0.45": ({"friction": 0.45}, same),
    "k_s = k_n / 10 in place of k_n / 2.4": ({}, soft_in_shear),
    "joints do not close: k₀ and k₀ / 2.4 under any pressure": ({}, unclosed),
    "a quarter of both under any pressure": ({}, soft),
    "lowest course of whole blocks": ({"first_course": "full"}, same),
}


def row(wall: MeasuredWall, case: str) -> str:
    """Table cells of a wall for a case."""
    changes, change = CASES[case]
    with patch.dict(STONES, {name: replace(stone, **changes) for name, stone in STONES.items()}):
        scene = change(scene_of(wall, RUNG.features))
    start = time.process_time()
    found = Prediction(wall, RUNG, scene, RUNG.model.solve(scene, TOLERANCE))
    seconds, marks, scores = time.process_time() - start, found.marks, found.row()
    if marks is None or found.error is None:
        return f"{found.status} | – | – | – | – | – | {seconds:.0f}"
    drift = "–" if scores["drift_ratio"] is None else f"× {scores['drift_ratio']:.2f}"
    numbers = f"{marks.strength / 1e3:.1f} | {found.error:+.0%} | × {scores['stiffness_ratio']:.2f}"
    return f"{numbers} | {1e3 * marks.at_peak:.1f} | {drift} | {found.mode} | {seconds:.0f}"


def main() -> None:
    """Print one row per wall and case."""
    walls = shipped_walls()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walls", nargs="*", default=["SW.200.1", "WS.100"])
    names = parser.parse_args().walls
    if unknown := [name for name in names if name not in walls]:
        parser.error(f"no such wall: {unknown[0]}; there are {', '.join(walls)}")
    print("| wall | what | V [kN] | ΔV | stiffness | at the peak [mm] | at 0.8 | mode | CPU s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name in names:
        for case in CASES:
            print(f"| {name} | {case} | {row(walls[name], case)} |", flush=True)


if __name__ == "__main__":
    main()
