"""Deviation of `homog` from the limit load of blocks: panels of seven textures, seven slendernesses and several sizes.

The lowest course starts with a full or with a half block.

Prints a Markdown table, with rows by shape of the blocks (taller than wide or not) and by the smaller of the numbers of
courses and of blocks per course: the number of panels, and the least, median and largest deviation from `limit`.
`homog.model.OFF` has these values.

    python benchmarks/studies/homogenised.py
"""

import argparse
import itertools

import numpy as np

from homog import homog
from homog.model import FINENESS
from runningbond.limit import limit
from runningbond.scene import Scene, scene_from_dict

TEXTURES = (6.0, 4.0, 2.0, 1.0, 0.9, 0.5, 0.25)
SLENDERNESSES = (1 / 3, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0)
BLOCKS = (2, 3, 5, 8, 10, 12, 16, 18, 24)
FRICTIONS = (0.3, 0.5, 0.7, 1.0)
FIRST_COURSES = ("full", "half")


def panel(texture: float, blocks: int, courses: int, friction: float, first: str) -> Scene:
    """A panel of blocks 0.24 m wide, under lateral load proportional to its weight."""
    width, height = 0.24, 0.24 / texture
    size = {"length": blocks * width, "height": courses * height, "first_course": first}
    return scene_from_dict(
        {
            "title": "panel",
            "wall": {"block_width": width, "block_height": height, "thickness": 0.12, **size},
            "block": {"density": 1800.0},
            "joint": {"friction": friction},
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
        }
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=int, default=1500, help="blocks of the largest panel")
    most = parser.parse_args().most
    deviations: dict[tuple[bool, int], list[float]] = {}
    cases = itertools.product(TEXTURES, SLENDERNESSES, BLOCKS, FRICTIONS, FIRST_COURSES)
    for texture, slenderness, blocks, friction, first in cases:
        courses = round(slenderness * blocks * texture)
        if courses < FINENESS[0] or blocks * courses > most:
            continue
        scene = panel(texture, blocks, courses, friction, first)
        estimate, exact = homog(scene).multiplier, limit(scene).multiplier
        if estimate is None or exact is None:
            raise ValueError(f"{texture}, {blocks} x {courses}, {friction}, {first}: no answer")
        row = texture < 1, int(np.searchsorted(FINENESS, min(blocks, courses), side="right")) - 1
        deviations.setdefault(row, []).append(estimate / exact - 1)
    print("| blocks | fewer of courses and blocks in one | panels | least | middle | largest |")
    print("|---|---|---|---|---|---|")
    for (tall, k), found in sorted(deviations.items()):
        shape = "taller than wide" if tall else "no taller than wide"
        low, middle, high = np.quantile(found, [0, 0.5, 1])
        print(f"| {shape} | from {FINENESS[k]} | {len(found)} | {low:+.1%} | {middle:+.1%} | {high:+.1%} |")


if __name__ == "__main__":
    main()
