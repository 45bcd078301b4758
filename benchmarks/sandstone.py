"""What could explain SW.200.1, of which blocks that split bear more than was measured: one number changed at a time.

    python -m benchmarks.sandstone

Largest force of `rigid-splitting` on the test's path, its part of the measured one, and processor seconds.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest.mock import patch

from runningbond.joints import joint_stiffness
from runningbond.laboratory.folder import SHIPPED, read_folder
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.predictions import Prediction
from runningbond.laboratory.rig import scene_of
from runningbond.laboratory.stones import STONES
from runningbond.models import TOLERANCE
from runningbond.scene import Scene, Stiffness

RUNG = LADDER["rigid-splitting"]


def same(scene: Scene) -> Scene:
    """The scene as it is."""
    return scene


def soft_in_shear(scene: Scene) -> Scene:
    """With a tenth of the normal stiffness under the vertical load in shear; it has 1 / 2.4 of it as shipped."""
    stiffness = joint_stiffness(scene.joint)
    return scene.with_joint(elasticity=Stiffness(stiffness.normal, 0.24 * stiffness.shear))


CASES: dict[str, tuple[dict[str, Any], Callable[[Scene], Scene]]] = {
    "as shipped": ({}, same),
    "f_t of blocks 2.2 MPa, 0.6 of the flexural strength, in place of 3.7": ({"tensile": 2.2e6}, same),
    "f_t of blocks 1.5 MPa": ({"tensile": 1.5e6}, same),
    "tan φ 0.45 in place of 0.62": ({"friction": 0.45}, same),
    "k_s = k_n / 10 in place of k_n / 2.4": ({}, soft_in_shear),
    "lowest course of whole blocks": ({"first_course": "full"}, same),
}


def main() -> None:
    """Print a row a case."""
    wall = next(wall for folder in SHIPPED for wall in read_folder(folder) if wall.name == "SW.200.1")
    print("| what | V [kN] | ΔV | stiffness | at the peak [mm] | mode | CPU s |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, (changes, change) in CASES.items():
        with patch.dict(STONES, sandstone=replace(STONES["sandstone"], **changes)):
            scene = change(scene_of(wall, RUNG.features))
        start = time.process_time()
        found = Prediction(wall, RUNG, scene, RUNG.model.solve(scene, TOLERANCE))
        seconds, marks, row = time.process_time() - start, found.marks, found.row()
        if marks is None or found.error is None:
            print(f"| {name} | {found.status} | – | – | – | – | {seconds:.0f} |", flush=True)
            continue
        numbers = f"{marks.strength / 1e3:.1f} | {found.error:+.0%} | × {row['stiffness_ratio']:.2f}"
        print(f"| {name} | {numbers} | {1e3 * marks.at_peak:.1f} | {found.mode} | {seconds:.0f} |", flush=True)


if __name__ == "__main__":
    main()
