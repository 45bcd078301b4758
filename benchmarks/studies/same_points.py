"""Deformable blocks beside rigid ones where both have the same joint points, on the twelve panels.

Prints a Markdown table, one row a panel as it ends. From the project's directory, for all panels or some of them:

    python benchmarks/studies/same_points.py
    python benchmarks/studies/same_points.py panel-10 panel-12
"""

import sys

from compare import published_scene
from compare.table import bracket
from dem.dynamic import dem_dynamic
from fem_interface.model import fem

PANELS = [f"panel-{row:02d}" for row in range(1, 13)]

TOLERANCE = 0.005


def main() -> None:
    """Print the table."""
    print("| panel | `dem-dynamic` | `fem` | its middle beside the other's |\n|---|---|---|---|")
    for name in sys.argv[1:] or PANELS:
        scene = published_scene(name)  # of 1000 GPa, as the paper's are
        rigid, deformable = dem_dynamic(scene, TOLERANCE), fem(scene, TOLERANCE, points="joints")
        off = ""
        if rigid.multiplier is not None and deformable.multiplier is not None:
            change = round(100 * (deformable.multiplier / rigid.multiplier - 1), 2) or 0.0  # no −0.0
            off = f"{change:+.2f} %"
        print(f"| {name} | {bracket(rigid)} | {bracket(deformable)} | {off} |", flush=True)


if __name__ == "__main__":
    main()
