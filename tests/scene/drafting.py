"""DXF files of one small wall, drawn in different ways."""

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf

from runningbond.limit import equilibrium, limit_state
from runningbond.scene import Scene, scene_from_dict
from tests.walls import content

Outline = Sequence[tuple[float, float]]

Draw = Callable[[Any, Any], None]
"""Function that draws into a DXF document and its model space."""


def box(left: float, bottom: float, right: float, top: float) -> Outline:
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


COURSES = ([0.0, 200.0, 400.0], [0.0, 100.0, 300.0, 400.0], [0.0, 200.0, 400.0])
BRICKS = [box(a, 100.0 * k, b, 100.0 * (k + 1)) for k, xs in enumerate(COURSES) for a, b in pairwise(xs)]
GROUND = box(-500.0, -50.0, 900.0, 0.0)


def dxf(path: Path, *draw: Draw, ground: bool = True) -> Path:
    """Save a DXF file with what `draw` draws and, if `ground`, an outline on layer Ground."""
    document = ezdxf.new()  # type: ignore[attr-defined]
    document.units = 4  # mm
    for one in draw:
        one(document, document.modelspace())
    if ground:
        document.modelspace().add_lwpolyline(GROUND, close=True, dxfattribs={"layer": "Ground"})
    document.saveas(path)
    return path


def closed(outlines: Iterable[Outline] = BRICKS, layer: str = "0") -> Draw:
    def draw(_: Any, space: Any) -> None:
        for outline in outlines:
            space.add_lwpolyline(outline, close=True, dxfattribs={"layer": layer})

    return draw


def lines(*segments: Sequence[float], layer: str = "0") -> Draw:
    """LINEs, each given as x and y of its start and of its end."""

    def draw(_: Any, space: Any) -> None:
        for a, b, c, d in segments:
            space.add_line((a, b), (c, d), dxfattribs={"layer": layer})

    return draw


def own_lines(outlines: Iterable[Outline] = BRICKS) -> Draw:
    """Four LINEs for every block, not shared with its neighbours."""
    return lines(*[(*p, *q) for outline in outlines for p, q in zip(outline, [*outline[1:], outline[0]], strict=True)])


def tables(**wall: Any) -> dict[str, Any]:
    return content(wall={"drawing": "wall.dxf", "units": "mm", "thickness": 0.12} | wall)


def scene_of(path: Path, **wall: Any) -> Scene:
    return scene_from_dict(tables(drawing=path.name, **wall), folder=path.parent)


def multiplier(scene: Scene) -> float:
    """Collapse multiplier, as exact as the linear program's vertex solution."""
    forces = limit_state(equilibrium(scene)).forces
    assert forces.status == "optimal"
    return float(forces.multiplier)
