"""Scenes for pictures, which together use every key of a scene file that is drawn."""

from pathlib import Path
from typing import Any, TypeAlias

from runningbond.scene import Scene, scene_from_dict

from ..scenes import write_drawing

Outline: TypeAlias = list[tuple[float, float]]

MORTAR = {"friction": 0.75, "cohesion": 1e5, "tensile_strength": 5e4}
OAK = {"density": 700.0}


def wall(length: float, height: float, block: tuple[float, float] = (0.5, 0.25), **tables: Any) -> dict[str, Any]:
    """A limestone wall 0.3 m thick; `tables` replace the default ones."""
    size = {"block_width": block[0], "block_height": block[1], "thickness": 0.3, "length": length, "height": height}
    return {
        "title": "wall",
        "wall": size,
        "block": {"density": 2000.0},
        "joint": {"friction": 0.6},
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
    } | tables


def line(y: float, x0: float, x1: float, force: list[float]) -> dict[str, Any]:
    return {"kind": "line", "from": [x0, y], "to": [x1, y], "force": force}


def point(x: float, y: float, fx: float, fy: float) -> dict[str, Any]:
    return {"kind": "point", "at": [x, y], "force": [fx, fy]}


def facade() -> dict[str, Any]:
    """Two storeys with a door, windows, oak lintels, mortared piers, floors and a roof, pushed to the left."""
    full, half = [1.0] * 12, [0.5, *[1.0] * 11, 0.5]
    door = (
        [1.0] * 2 + [-2.0] + [1.0] * 3 + [-2.0] + [1.0] * 3,
        [0.5, 1, 0.5, -2.0, 0.5, 1, 1, 0.5, -2.0, 0.5, 1, 1, 0.5],
    )
    solid = ([1.0] * 2 + [-2.0] + [1.0] * 8, [0.5, 1, 0.5, -2.0, 0.5, *[1.0] * 7, 0.5])
    lintels = [1.0] + [4.0] + [1.0] + [4.0] + [1.0] * 2
    upper = [[0.5, 1, 0.5, -2, 0.5, 1, 1, 0.5, -2, 0.5, 1, 1, 0.5], [1.0, 1, -2, 1, 1, 1, -2, 1, 1, 1]]
    rows = [
        *solid,
        *solid[:1],
        door[1],
        door[0],
        door[1],
        lintels,
        half,
        full,
        half,
        *upper,
        *upper[:1],
        lintels,
        half,
        full,
    ]
    courses = [[float(x) for x in row] for row in rows]
    return wall(0, 0) | {
        "title": "Façade of two storeys",
        "wall": {"block_width": 0.5, "block_height": 0.3, "thickness": 0.4, "courses": courses},
        "materials": {"oak": OAK},
        "joints": {"mortar": MORTAR},
        "assign": [
            {"block": "oak", "box": [[0.5, 1.8], [5.0, 2.1]]},
            {"block": "oak", "box": [[0.5, 3.9], [5.0, 4.2]]},
            {"block": "block", "box": [[2.5, 0.0], [3.0, 9.0]]},
            {"joint": "mortar", "box": [[0.0, 0.0], [6.0, 1.75]]},
        ],
        "load": {
            "gravity": 9.81,
            "dead": [line(2.7, 0, 6, [0, -8e3]), line(4.8, 0, 6, [0, -5e3])],
            "live": {"kind": "lateral", "direction": "left"},
        },
    }


def settling_portal() -> dict[str, Any]:
    """Two piers and a wall above; the ground under the right pier sinks by 20 mm."""
    rows = [[2.0, -2.0, 2.0], [1, 1, -2, 1, 1]] * 3 + [[1.0, 4.0, 1.0], [1.0] * 6, [0.5, *[1.0] * 5, 0.5]]
    return wall(0, 0) | {
        "title": "Portal on a settling pier",
        "wall": {"block_width": 0.5, "block_height": 0.25, "thickness": 0.3, "courses": rows},
        "load": {"gravity": 9.81, "live": {"kind": "settlement", "box": [[1.9, -1.0], [9.0, 0.1]], "by": [0.0, -0.02]}},
    }


def turning_support() -> dict[str, Any]:
    """The same portal with a support that moves outwards and rotates."""
    live = {
        "kind": "settlement",
        "box": [[-9.0, -1.0], [1.1, 0.1]],
        "by": [-0.005, 0.0],
        "rotation_angle": 0.5,
        "about": [1.0, 0.0],
    }
    return settling_portal() | {"title": "Spreading support", "load": {"gravity": 9.81, "live": live}}


def shear_wall() -> dict[str, Any]:
    """Under a level beam of 500 kg on its own mortar, with a constant force, cyclically driven at mid-height."""
    path = [0.0, 0.001, -0.001, 0.002, -0.002, 0.004, -0.004]
    return wall(1.0, 1.25, (0.25, 0.0625)) | {
        "title": "Shear wall, cyclic",
        "joints": {"mortar": MORTAR},
        "beam": {
            "height": 0.25,
            "mass": 500.0,
            "joint": "mortar",
            "condition": "level",
            "force": [0, -1e5],
            "drive": {"displacement": [path], "rate": 1e-3, "at": 0.625},
        },
        "load": {"gravity": 9.81},
    }


def kept_beam() -> dict[str, Any]:
    """A beam held at its height, pushed to the left by a live force; bed and head joints of different materials."""
    return wall(2.0, 1.0) | {
        "title": "Beam kept at its height",
        "joints": {"mortar": MORTAR, "dry": {"friction": 0.4}},
        "assign": [{"joint": "mortar", "orientation": "bed"}, {"joint": "dry", "orientation": "head"}],
        "beam": {"height": 0.3, "condition": "fixed-height", "force": [0, -5e4], "drive": {"force": [-1e3, 0]}},
        "load": {"gravity": 9.81},
    }


def free_beam() -> dict[str, Any]:
    return wall(1.0, 1.0) | {
        "title": "Free beam",
        "beam": {"height": 0.2, "mass": 200.0, "drive": {"displacement": [0.01, 0], "at": 1.1}},
        "load": {"gravity": 9.81, "dead": [point(0.25, 1.2, 0, -2e4), point(0.75, 1.2, 0, -3e4)]},
    }


def tied() -> dict[str, Any]:
    """Two ties, one of them to an anchor in space, and a moment in addition to a lateral load."""
    bar = {"area": 3e-4, "young": 2.1e11, "yield": 7e4}
    return wall(3.0, 2.0) | {
        "title": "Wall with ties",
        "tie": [
            {"from": [0.1, 1.6], "to": [2.9, 1.6], "preload": 5e3} | bar,
            {"from": [2.9, 0.9], "to": [4.0, 0.4]} | bar,
        ],
        "load": {"gravity": 9.81, "live": [{"kind": "lateral"}, {"kind": "moment", "at": [1.5, 1.9], "moment": -2e3}]},
    }


def tilted() -> dict[str, Any]:
    """On ground that tilts down to the left; gravity is the moon's."""
    return wall(1.5, 1.5, (0.5, 0.25)) | {
        "title": "On tilting ground",
        "load": {"gravity": 1.62, "live": {"kind": "tilt", "direction": "left"}},
    }


def many_loads() -> dict[str, Any]:
    """Dead and live loads of every kind, several at one point, and inclined gravity."""
    return wall(4.0, 1.5) | {
        "title": "Every kind of load",
        "load": {
            "gravity": [1.0, -9.5],
            "dead": [
                line(1.5, 0, 4, [0, -2e3]),
                point(1.0, 1.5, 0, -5e3),
                {"kind": "moment", "at": [3.2, 1.1], "moment": 500.0},
                {"kind": "lateral", "direction": "left"},
                {"kind": "body", "acceleration": [0.0, -1.0]},
            ],
            "live": [
                line(1.5, 2, 4, [0, -1.5e3]),
                point(1.0, 1.5, 0, -1e3),
                point(0.0, 1.0, 2e3, 0),
                point(4.0, 1.25, 300.0, 400.0),
                {"kind": "body", "acceleration": [2.0, 0.0]},
                {"kind": "lateral", "direction": "right"},
            ],
        },
    }


def cracked() -> dict[str, Any]:
    """On a pin and a roller, under one newton; blocks may crack."""
    crack = {"friction": 1.0, "cohesion": 1e6, "tensile_strength": 5e5}
    return wall(1.5, 1.0) | {
        "title": "On a pin and a roller",
        "inner_joint": crack,
        "support": {"kind": "corners"},
        "load": {"gravity": 0.0, "live": point(0.75, 1.0, 0, -1)},
    }


def one_block() -> dict[str, Any]:
    """Under an eccentric, inclined line load."""
    return wall(0.5, 1.0, (0.5, 1.0)) | {
        "title": "One block",
        "load": {"gravity": 9.81, "live": line(1.0, 0.3, 0.5, [3e2, -1e3])},
    }


def many_materials() -> dict[str, Any]:
    """As many materials of blocks and joints as there are colours, for a long key."""
    places = [[[0, 0.25 * k + 0.2], [4, 0.25 * k + 0.4]] for k in range(6)]
    return wall(4.0, 1.75) | {
        "title": "Many materials",
        "materials": {f"stone-{k}": {"density": 1000.0 + 200 * k} for k in range(6)},
        "joints": {f"mortar-{k}": {"friction": 0.5 + 0.05 * k} for k in range(5)},
        "assign": [{"block": f"stone-{k}", "box": box} for k, box in enumerate(places)]
        + [{"joint": f"mortar-{k}", "box": box} for k, box in enumerate(places[:5])],
    }


def large() -> dict[str, Any]:
    return wall(10.0, 5.0, (0.25, 0.1)) | {
        "title": "2025 blocks",
        "joints": {"mortar": MORTAR},
        "materials": {"oak": OAK},
        "assign": [{"joint": "mortar", "box": [[0, 2], [10, 3]]}, {"block": "oak", "box": [[0, 4.5], [10, 5]]}],
        "load": {"gravity": 9.81, "live": [{"kind": "lateral"}, line(5.0, 0, 10, [0, -1e4])]},
    }


def on_a_step(folder: Path) -> Scene:
    """Drawn in millimetres: a pier on a step, another one below it, and a lintel on both."""
    ground: Outline = [(-500, -600), (2500, -600), (2500, 0), (900, 0), (900, 300), (-500, 300)]
    sides = [(0, 300, 400, 600), (0, 600, 400, 900), (1400, 0, 1800, 450), (1400, 450, 1800, 900), (0, 900, 1800, 1100)]
    blocks: list[Outline] = [[(a, b), (c, b), (c, d), (a, d)] for a, b, c, d in sides]
    write_drawing([ground, *blocks], folder / "wall.dxf")
    scene = wall(0, 0) | {
        "title": "On a step",
        "wall": {"drawing": "wall.dxf", "units": "mm", "thickness": 0.3},
        "load": {"gravity": 9.81, "live": [point(0.9, 1.1, 0, -1e3), {"kind": "lateral", "direction": [-1, 0]}]},
    }
    return scene_from_dict(scene, folder=folder)


SCENES = {
    each.__name__: each
    for each in (
        facade, settling_portal, turning_support, shear_wall, kept_beam, free_beam,
        tied, tilted, many_loads, cracked, one_block, many_materials,
    )
}  # fmt: skip
"""Scenes by name."""
