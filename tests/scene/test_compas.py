"""Assemblies of COMPAS, laid out as its packages write them, read without them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.scene.drawings import read_drawing

from .drafting import BRICKS, GROUND, Outline, closed, dxf, multiplier, scene_of

WALL = [[(x / 1e3, y / 1e3) for x, y in outline] for outline in BRICKS]
BASE = [(x / 1e3, y / 1e3) for x, y in GROUND]

UPRIGHT = ("x", "z", "y")
"""Axes of an assembly along the wall, upwards and across it."""


def mesh(outline: Outline, axes: tuple[str, str, str] = UPRIGHT, depth: float = 0.12) -> dict[str, Any]:
    """Data of a COMPAS mesh: a prism, or one face where it has no depth."""
    n, (u, v, w) = len(outline), axes
    levels = [0.0, depth] if depth else [0.0]
    vertex = {
        str(k * n + i): {u: x, v: y, w: level} for k, level in enumerate(levels) for i, (x, y) in enumerate(outline)
    }
    faces = [list(range(n))]
    if depth:
        faces += [list(range(n, 2 * n))[::-1], *[[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]]
    data: dict[str, Any] = {
        "vertex": vertex,
        "face": {str(k): face for k, face in enumerate(faces)},
        "facedata": {},
        "edgedata": {},
    }
    return {"attributes": {}, "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0}, **data}


def assembly(**how: Any) -> dict[str, Any]:
    """compas_assembly 0.7 on COMPAS 2, as in its docs/examples/stack_assembly.json."""

    def node(outline: Outline) -> dict[str, Any]:
        return {"block": {"dtype": "compas_assembly.datastructures/Block", "data": mesh(outline, **how), "name": "Box"}}

    nodes: dict[str, Any] = {str(k): node(outline) for k, outline in enumerate(WALL)}
    nodes["7"] = node(BASE) | {"is_support": True}
    graph = {"default_node_attributes": {"block": None, "is_support": False}, "node": nodes, "edge": {}}
    wrapped = {"dtype": "compas.datastructures/Graph", "data": graph}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": {"attributes": {}, "graph": wrapped}}


def first_version() -> dict[str, Any]:
    """The same on COMPAS 1, which wraps data in a value, and a mesh's in one more table."""
    found = json.loads(json.dumps(assembly()).replace('"data":', '"value":'))
    for node in found["value"]["graph"]["value"]["node"].values():
        node["block"]["value"] = {
            "compas": "1.17.5",
            "datatype": node["block"]["dtype"],
            "data": node["block"]["value"],
        }
    return dict(found)


def untyped() -> dict[str, Any]:
    """compas_assembly of 2018, before there were types: a network, and blocks beside it."""
    vertex = {str(k): {"x": 0.0, "y": 0.0, "z": 0.0, "is_support": k == 7} for k in range(8)}
    blocks = {str(k): mesh(outline) for k, outline in enumerate([*WALL, BASE])}
    for block in blocks.values():
        block["face"] = {key: [str(corner) for corner in face] for key, face in block["face"].items()}
    return {"assembly": {"dva": {"is_support": False}, "vertex": vertex, "edge": {}}, "blocks": blocks}


def model(**how: Any) -> dict[str, Any]:
    """A BlockModel of compas_dem 0.3, as in its data/dem_crossvault.json; one block is moved into its place."""

    def element(k: int, outline: Outline) -> dict[str, Any]:
        geometry = {"dtype": "compas.datastructures/Mesh", "data": mesh(outline, **how)}
        data: dict[str, Any] = {
            "transformation": None,
            "features": [],
            "name": f"Block {k}",
            "material": None,
            "geometry": geometry,
        }
        return {"dtype": "compas_dem.elements/Block", "data": data | {"is_support": k == 7}, "guid": str(k)}

    elements = {str(k): element(k, outline) for k, outline in enumerate([*WALL, BASE])}
    shifted = element(0, [(x - 3, y) for x, y in WALL[0]])
    matrix = [[1.0, 0.0, 0.0, 3.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    shifted["data"]["transformation"] = {"dtype": "compas.geometry/Transformation", "data": {"matrix": matrix}}
    rest: dict[str, Any] = {"materials": {}, "tree": {"root": {}}, "graph": {}}
    return {
        "dtype": "compas_dem.models/BlockModel",
        "data": {"transformation": None, "elements": elements | {"0": shifted}, **rest},
    }


@pytest.mark.parametrize("layout", [assembly, first_version, untyped, model])
def test_an_assembly_is_the_wall_that_a_drawing_of_it_is(layout: Any, tmp_path: Path) -> None:
    exact = scene_of(dxf(tmp_path / "wall.dxf", closed()))
    (tmp_path / "wall.json").write_text(json.dumps(layout()))
    scene = scene_of(tmp_path / "wall.json", units="m")
    assert scene.fixed.tolist() == [False] * 7 + [True]
    assert multiplier(scene) == pytest.approx(multiplier(exact), rel=1e-9)
    assert scene.notes == (
        "assembly: read in its x-z plane; 0.12 thick in the file's unit, in place of which wall.thickness counts",
    )


@pytest.mark.parametrize("axes", [("x", "z", "y"), ("y", "z", "x"), ("x", "y", "z")])
@pytest.mark.parametrize("depth", [0.12, 0.0])
def test_the_wall_may_stand_along_x_or_y_or_lie_flat(axes: tuple[str, str, str], depth: float, tmp_path: Path) -> None:
    (tmp_path / "wall.json").write_text(json.dumps(assembly(axes=axes, depth=depth)))
    drawing = read_drawing(tmp_path / "wall.json", "m")
    assert all(np.array(o) == pytest.approx(np.array(w)) for o, w in zip(drawing.blocks, WALL, strict=True))
    assert len(drawing.grounds) == 1


def test_without_a_support_the_wall_stands_on_a_strip(tmp_path: Path) -> None:
    found = assembly()
    del found["data"]["graph"]["data"]["node"]["7"]
    (tmp_path / "wall.json").write_text(json.dumps(found))
    scene = scene_of(tmp_path / "wall.json", units="m")
    assert scene.fixed.sum() == 1
    assert "no block is a support" in scene.notes[1]


def test_gaps_of_an_assembly_are_healed(tmp_path: Path) -> None:
    """Blocks a millimetre apart, as compas_dem lays its own walls."""
    found = assembly()
    for k, node in found["data"]["graph"]["data"]["node"].items():
        for vertex in node["block"]["data"]["vertex"].values():
            vertex["z"] += 1e-3 * (vertex["z"] > 0.05) if k == "7" else 1e-4 * int(k)
    (tmp_path / "wall.json").write_text(json.dumps(found))
    assert len(scene_of(tmp_path / "wall.json", units="m", heal=2e-3).joints) == 14
