"""Deformable blocks beside rigid ones where both have the same joint points, on the twelve panels.

Prints a Markdown table, one row a panel as it ends. From the project's directory, for all panels or some of them:

    python benchmarks/studies/same_points.py
    python benchmarks/studies/same_points.py panel-10 panel-12
"""

import sys
from dataclasses import replace

from compare import published_scene
from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from results import Outcome
from scene import BlockMaterial, Scene

PANELS = [f"panel-{row:02d}" for row in range(1, 13)]

TOLERANCE = 0.005


def stiff(name: str) -> Scene:
    """A panel, its blocks of 1000 GPa as the paper's are."""
    scene = published_scene(name)
    return replace(scene, block=BlockMaterial(scene.block.density, 1e12, 0.0))


def bracket(outcome: Outcome) -> str:
    """The bracket, or why there is none."""
    if outcome.lower is None or outcome.upper is None:
        return outcome.status
    return f"{outcome.lower:.4f}–{outcome.upper:.4f}" + ("" if outcome.status == "collapse" else f" {outcome.status}")


def main() -> None:
    """Print the table."""
    print("| panel | `dem-dynamic` | `fem` | its middle beside the other's |\n|---|---|---|---|")
    for name in sys.argv[1:] or PANELS:
        scene = stiff(name)
        rigid, deformable = dem_dynamic(scene, TOLERANCE), fem(scene, TOLERANCE, points="joints")
        off = ""
        if rigid.multiplier is not None and deformable.multiplier is not None:
            off = f"{100 * (deformable.multiplier / rigid.multiplier - 1):+.2f} %"
        print(f"| {name} | {bracket(rigid)} | {bracket(deformable)} | {off} |", flush=True)


if __name__ == "__main__":
    main()
