"""The walls for all programs: dry, on a frictional base, under lateral load proportional to their own weight."""

from typing import NamedTuple

from runningbond.scene import Scene, scene_from_dict


class Size(NamedTuple):
    """Size of a wall and its blocks [mm]."""

    width: int
    height: int
    length: int
    rise: int


WALLS = {
    "240x120": Size(240, 120, 1440, 1440),
    "120x60": Size(120, 60, 1440, 1440),
    "240x60, L = 720": Size(240, 60, 720, 1440),
}

TRIAL = {"trial": Size(240, 120, 480, 960)}
"""A wall of a few blocks, to check that everything runs."""


def wall_of(name: str) -> Scene:
    """A wall by its name, 120 mm thick, with 1800 kg/m³ and tan φ = 0.6."""
    size = (WALLS | TRIAL)[name]
    width, height, length, rise = (1e-3 * x for x in size)
    return scene_from_dict(
        {
            "title": name,
            "wall": {
                "block_width": width,
                "block_height": height,
                "thickness": 0.12,
                "length": length,
                "height": rise,
            },
            "block": {"density": 1800.0, "young": 1e12, "poisson": 0.0},
            "joint": {"friction": 0.6, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
        }
    )
