"""COMPAS assemblies in the JSON layouts of the COMPAS packages, which are not needed to read them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.scene import SceneError
from runningbond.scene.drawings import read_drawing

from .drafting import BRICKS, GROUND, Outline, box, closed, dxf, multiplier, scene_of

WALL = [[(x / 1e3, y / 1e3) for x, y in outline] for outline in BRICKS]
BASE = [(x / 1e3, y / 1e3) for x, y in GROUND]

UPRIGHT = ("x", "z", "y")
"""Axes of an assembly along the wall, upwards and across it."""


def mesh(outline: Outline, axes: tuple[str, str, str] = UPRIGHT, depth: float = 0.12) -> dict[str, Any]:
    """Data of a COMPAS mesh: a prism, or a single face if it has no depth."""
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
    """Layout of compas_assembly 0.7 on COMPAS 2, as in its docs/examples/stack_assembly.json."""

    def node(outline: Outline) -> dict[str, Any]:
        return {"block": {"dtype": "compas_assembly.datastructures/Block", "data": mesh(outline, **how), "name": "Box"}}

    nodes: dict[str, Any] = {str(k): node(outline) for k, outline in enumerate(WALL)}
    nodes["7"] = node(BASE) | {"is_support": True}
    graph = {"default_node_attributes": {"block": None, "is_support": False}, "node": nodes, "edge": {}}
    wrapped = {"dtype": "compas.datastructures/Graph", "data": graph}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": {"attributes": {}, "graph": wrapped}}


def first_version() -> dict[str, Any]:
    """The same on COMPAS 1, which wraps data in a value, and mesh data in another table."""
    found = json.loads(json.dumps(assembly()).replace('"data":', '"value":'))
    for node in found["value"]["graph"]["value"]["node"].values():
        node["block"]["value"] = {
            "compas": "1.17.5",
            "datatype": node["block"]["dtype"],
            "data": node["block"]["value"],
        }
    return dict(found)


def untyped() -> dict[str, Any]:
    """Layout of compas_assembly of 2018, without dtypes: a network, and the blocks beside it."""
    vertex = {str(k): {"x": 0.0, "y": 0.0, "z": 0.0, "is_support": k == 7} for k in range(8)}
    blocks = {str(k): mesh(outline) for k, outline in enumerate([*WALL, BASE])}
    for block in blocks.values():
        block["face"] = {key: [str(corner) for corner in face] for key, face in block["face"].items()}
    return {"assembly": {"dva": {"is_support": False}, "vertex": vertex, "edge": {}}, "blocks": blocks}


def model(**how: Any) -> dict[str, Any]:
    """A BlockModel of compas_dem 0.3, as in its data/dem_crossvault.json; one block is placed by a transformation."""

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


def analysis() -> dict[str, Any]:
    """The same model as written by compas_dem 0.6, together with its analysis problems."""
    return {"dtype": "compas_dem.models/Analysis", "data": {"name": None, "model": model(), "problems": []}}


@pytest.mark.parametrize("layout", [assembly, first_version, untyped, model, analysis])
def test_assembly_gives_the_same_wall_as_its_drawing(layout: Any, tmp_path: Path) -> None:
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
def test_assembly_may_lie_in_any_coordinate_plane(axes: tuple[str, str, str], depth: float, tmp_path: Path) -> None:
    (tmp_path / "wall.json").write_text(json.dumps(assembly(axes=axes, depth=depth)))
    drawing = read_drawing(tmp_path / "wall.json", "m")
    assert all(np.array(o) == pytest.approx(np.array(w)) for o, w in zip(drawing.blocks, WALL, strict=True))
    assert len(drawing.grounds) == 1


def test_assembly_without_support_gets_a_ground_strip(tmp_path: Path) -> None:
    found = assembly()
    del found["data"]["graph"]["data"]["node"]["7"]
    (tmp_path / "wall.json").write_text(json.dumps(found))
    scene = scene_of(tmp_path / "wall.json", units="m")
    assert scene.fixed.sum() == 1
    assert "no block is a support" in scene.notes[1]


def test_gaps_of_an_assembly_are_healed(tmp_path: Path) -> None:
    """Blocks a millimetre apart, as in walls generated by compas_dem."""
    found = assembly()
    for k, node in found["data"]["graph"]["data"]["node"].items():
        for vertex in node["block"]["data"]["vertex"].values():
            vertex["z"] += 1e-3 * (vertex["z"] > 0.05) if k == "7" else 1e-4 * int(k)
    (tmp_path / "wall.json").write_text(json.dumps(found))
    assert len(scene_of(tmp_path / "wall.json", units="m", heal=2e-3).joints) == 14


PIER = [box(0, 0.1 * k, 0.3, 0.1 * (k + 1)) for k in range(-1, 6)]
"""Stack of blocks 0.3 m wide and 0.6 m high, and a support of the same width."""


def stack(axes: tuple[str, str, str], depth: float) -> dict[str, Any]:
    """A pier as an assembly."""
    found = assembly()
    nodes = found["data"]["graph"]["data"]["node"]
    for k, outline in enumerate(PIER):
        nodes[str(k)] = {"block": {"data": mesh(outline, axes, depth)}, "is_support": k == 0}
    del nodes["7"]
    return found


AXES = [("x", "z", "y"), ("y", "z", "x"), ("x", "y", "z")]


@pytest.mark.parametrize("axes", AXES)
def test_plane_of_a_pier_is_chosen_by_wall_thickness(axes: tuple[str, str, str], tmp_path: Path) -> None:
    """It overturns at b / h = 0.5 for all axes; read in the wrong plane, with its narrow side, it did at 0.2."""
    (tmp_path / "wall.json").write_text(json.dumps(stack(axes, 0.12)))
    assert multiplier(scene_of(tmp_path / "wall.json", units="m")) == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize("axes", AXES)
def test_pier_with_two_possible_planes_is_refused_with_both(axes: tuple[str, str, str], tmp_path: Path) -> None:
    (tmp_path / "wall.json").write_text(json.dumps(stack(axes, 0.12)))
    said = [f"{depth} (seen along {axis})" for depth, axis in ((0.3, axes[0]), (0.12, axes[2]))]
    with pytest.raises(SceneError, match="wall.thickness = 0.2: must be ") as refused:
        scene_of(tmp_path / "wall.json", units="m", thickness=0.2)
    assert all(one in str(refused.value) for one in said)


def test_square_pier_is_read_if_upright_and_refused_if_lying(tmp_path: Path) -> None:
    """Upright, λ = 0.5 from both sides; lying flat, it may be a stack or a row of the same blocks."""
    (tmp_path / "wall.json").write_text(json.dumps(stack(UPRIGHT, 0.3)))
    assert multiplier(scene_of(tmp_path / "wall.json", units="m", thickness=0.3)) == pytest.approx(0.5, rel=1e-6)
    (tmp_path / "wall.json").write_text(json.dumps(stack(("x", "y", "z"), 0.3)))
    with pytest.raises(SceneError, match="is how thick all blocks are along x and z"):
        scene_of(tmp_path / "wall.json", units="m", thickness=0.3)


def test_thickness_of_a_pier_in_millimetres_is_compared_in_metres(tmp_path: Path) -> None:
    found = stack(UPRIGHT, 0.12)
    for node in found["data"]["graph"]["data"]["node"].values():
        for vertex in node["block"]["data"]["vertex"].values():
            vertex |= {axis: 1e3 * x for axis, x in vertex.items()}
    (tmp_path / "wall.json").write_text(json.dumps(found))
    assert multiplier(scene_of(tmp_path / "wall.json", units="mm")) == pytest.approx(0.5, rel=1e-6)
    with pytest.raises(SceneError, match="wall.thickness = 0.125: must be "):  # 4 % off
        scene_of(tmp_path / "wall.json", units="mm", thickness=0.125)


@pytest.mark.parametrize("layout", [assembly, untyped])
def test_blocks_may_be_supports_by_default(layout: Any, tmp_path: Path) -> None:
    """COMPAS stores only attributes that differ from the file's defaults."""
    found = layout()
    if layout is assembly:
        graph = found["data"]["graph"]["data"]
        usual, nodes = graph["default_node_attributes"], graph["node"]
    else:
        usual, nodes = found["assembly"]["dva"], found["assembly"]["vertex"]
    usual["is_support"] = True
    for key, node in nodes.items():
        node.pop("is_support", None)
        node |= {} if key == "7" else {"is_support": False}
    (tmp_path / "wall.json").write_text(json.dumps(found))
    drawing = read_drawing(tmp_path / "wall.json", "m")
    assert (len(drawing.blocks), len(drawing.grounds)) == (7, 1)


@pytest.mark.parametrize("face", [0.0, 0.12])
def test_block_thicker_than_the_others_is_refused(face: float, tmp_path: Path) -> None:
    found = assembly()
    for vertex in found["data"]["graph"]["data"]["node"]["2"]["block"]["data"]["vertex"].values():
        vertex["y"] += 0.5 * (face - 0.06) * (vertex["y"] == face)
    (tmp_path / "wall.json").write_text(json.dumps(found))
    with pytest.raises(SceneError, match="node 2: does not reach as far as the others do along x, y or z"):
        read_drawing(tmp_path / "wall.json", "m")


def test_pier_without_depth_is_read_in_its_plane(tmp_path: Path) -> None:
    (tmp_path / "wall.json").write_text(json.dumps(stack(("y", "z", "x"), 0.0)))
    assert multiplier(scene_of(tmp_path / "wall.json", units="m", thickness=0.3)) == pytest.approx(0.5, rel=1e-6)


def moving(x: float, z: float, turned: bool = False, across: float = 0.0) -> dict[str, Any]:
    """COMPAS transformation: a translation and, if `turned`, a quarter turn about the thickness from z towards x."""
    turn = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]] if turned else np.eye(3).tolist()
    matrix = [[*row, by] for row, by in zip(turn, (x, across, z), strict=True)] + [[0.0, 0.0, 0.0, 1.0]]
    return {"dtype": "compas.geometry/Transformation", "data": {"matrix": matrix}}


def test_nested_transformations_are_combined(tmp_path: Path) -> None:
    """As compas_model's `modeltransformation`: those of the block, its parent, the group and the model."""
    found = model()
    elements = found["data"]["elements"]
    elements["0"]["data"]["transformation"] = moving(2, 0)
    elements["1"]["data"]["transformation"] = moving(0, 5, turned=True)
    bare: dict[str, Any] = {"transformation": moving(0, 1), "features": [], "name": "Group", "material": None}
    elements["group"] = {"dtype": "compas_model.elements/Group", "data": bare}
    nested = {"element": "group", "children": [{"element": "1", "children": [{"element": "0"}]}]}
    found["data"] |= {"transformation": moving(10, 0), "tree": {"root": {"name": "root", "children": [nested]}}}
    (tmp_path / "wall.json").write_text(json.dumps(found))
    blocks = [np.mean(outline, axis=0) for outline in read_drawing(tmp_path / "wall.json", "m").blocks]
    (x, z), (u, v), (free, low) = (np.mean(outline, axis=0) for outline in WALL[:3])
    x += 2 - 3  # the first block is written 3 m beside its place
    assert blocks[0] == pytest.approx((z + 10, -x + 5 + 1))
    assert blocks[1] == pytest.approx((v + 10, -u + 5 + 1))
    assert blocks[2] == pytest.approx((free + 10, low))


@pytest.mark.parametrize("last", [[0.1, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 2.0], None])
def test_transformation_that_is_not_affine_is_refused(last: list[float] | None, tmp_path: Path) -> None:
    """Its last row was left out, so that the wall had another shape than in COMPAS, which divides by it."""
    found = model()
    moved = moving(0, 0)
    moved["data"]["matrix"][3:] = [] if last is None else [last]
    found["data"]["transformation"] = moved
    (tmp_path / "wall.json").write_text(json.dumps(found))
    with pytest.raises(SceneError, match="transformation = .*: must be a matrix of 4 × 4 whose last row is 0, 0, 0, 1"):
        read_drawing(tmp_path / "wall.json", "m")


@pytest.mark.parametrize("layout", [assembly, untyped, model])
def test_support_that_is_neither_true_nor_false_is_refused(layout: Any, tmp_path: Path) -> None:
    """ "false", as text, made the block a support."""
    text = json.dumps(layout())
    (tmp_path / "wall.json").write_text(text.replace('"is_support": true', '"is_support": "false"'))
    with pytest.raises(SceneError, match="is_support = 'false': must be true or false"):
        read_drawing(tmp_path / "wall.json", "m")


def without_zeros(value: Any) -> Any:
    """Remove zero coordinates of mesh vertices, as COMPAS does for default values."""
    if isinstance(value, list):
        return [without_zeros(one) for one in value]
    if not isinstance(value, dict):
        return value
    value = {key: without_zeros(one) for key, one in value.items()}
    corners = value.get("vertex", {}) if "face" in value else {}
    for corner in corners.values():
        for axis in [axis for axis in corner if corner[axis] == 0.0]:
            del corner[axis]
    return value


@pytest.mark.parametrize("usual", ["default_vertex_attributes", "dva"])
@pytest.mark.parametrize("layout", [assembly, first_version, untyped, model])
def test_omitted_coordinates_have_the_default_value(layout: Any, usual: str, tmp_path: Path) -> None:
    """`Mesh.add_vertex(x=1, y=2)` writes no z; COMPAS 1 abbreviates the key of the defaults to `dva`."""
    outlines = []
    for found in (layout(), without_zeros(layout())):
        text = json.dumps(found).replace("default_vertex_attributes", usual)
        (tmp_path / "wall.json").write_text(text)
        outlines.append(read_drawing(tmp_path / "wall.json", "m").blocks)
    assert len(json.dumps(without_zeros(layout()))) < len(json.dumps(layout()))
    assert np.array_equal(outlines[0], outlines[1])


@pytest.mark.parametrize("wider", [0.05, -0.05])
def test_block_that_is_no_prism_between_its_faces_is_refused(wider: float, tmp_path: Path) -> None:
    """Its two faces are equal, but between them the outline is wider or narrower."""
    found = assembly()
    rings = [[(x + out * np.sign(x - 0.1), z) for x, z in WALL[0]] for out in (0.0, wider, 0.0)]
    vertex = {
        str(4 * k + i): {"x": x, "y": 0.06 * k, "z": z} for k, ring in enumerate(rings) for i, (x, z) in enumerate(ring)
    }
    around = [
        [4 * k + i, 4 * k + (i + 1) % 4, 4 * k + 4 + (i + 1) % 4, 4 * k + 4 + i] for k in (0, 1) for i in range(4)
    ]
    faces = [[0, 1, 2, 3], [11, 10, 9, 8], *around]
    block = {"vertex": vertex, "face": {str(k): face for k, face in enumerate(faces)}}
    found["data"]["graph"]["data"]["node"]["0"]["block"]["data"] |= block
    (tmp_path / "wall.json").write_text(json.dumps(found))
    with pytest.raises(SceneError, match="node 0: is not a prism across the wall: between its two sides"):
        read_drawing(tmp_path / "wall.json", "m")


def test_prism_with_subdivided_sides_is_read(tmp_path: Path) -> None:
    """Additional vertices at mid-depth, and triangles between them, do not change the outline."""
    found, n = assembly(), 4
    block = found["data"]["graph"]["data"]["node"]["0"]["block"]["data"]
    block["vertex"] |= {str(8 + i): {"x": x, "y": 0.06, "z": z} for i, (x, z) in enumerate(WALL[0])}
    lower = [[i, (i + 1) % n, 8 + i] for i in range(n)] + [[(i + 1) % n, 8 + (i + 1) % n, 8 + i] for i in range(n)]
    upper = [[8 + i, 8 + (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    block["face"] = {str(k): face for k, face in enumerate([[0, 1, 2, 3], [7, 6, 5, 4], *lower, *upper])}
    (tmp_path / "wall.json").write_text(json.dumps(found))
    assert np.array(read_drawing(tmp_path / "wall.json", "m").blocks[0]) == pytest.approx(np.array(WALL[0]))
