"""Invalid drawings: the error message is one line that says what is wrong and where."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from runningbond.scene import SceneError, scene_from_dict

from .drafting import BRICKS, GROUND, Draw, Outline, box, closed, dxf, lines, own_lines, scene_of, tables
from .test_compas import assembly, mesh, model, moving, untyped


def polyline(*corners: tuple[float, ...], close: bool = True) -> Draw:
    return lambda _, space: space.add_lwpolyline(corners, close=close)


def tilted(_: Any, space: Any) -> None:
    space.add_arc((0, 0), 10, 0, 180).dxf.extrusion = (0, 1, 1)


def solid(_: Any, space: Any) -> None:
    space.add_polyface().append_face([(0, 0, 0), (200, 0, 0), (200, 100, 0)])


def in_itself(document: Any, space: Any) -> None:
    document.blocks.new("A").add_blockref("B", (0, 0))
    document.blocks.new("B").add_blockref("A", (0, 0))
    space.add_blockref("A", (0, 0))


def without_end(document: Any, space: Any) -> None:
    document.blocks.new("A").add_lwpolyline(BRICKS[0], close=True)
    space.add_blockref("A", (0, 0), dxfattribs={"row_count": 30_000, "column_count": 30_000, "row_spacing": 1})


def texts(_: Any, space: Any) -> None:
    space.add_text("wall")


SQUARE = [(0, 0, 200, 0), (200, 0, 200, 100), (200, 100, 0, 100), (0, 100, 0, 0)]


@pytest.mark.parametrize(
    ("draw", "said"),
    [
        (texts, "holds 1 closed outline (left out: 1 TEXT on layer 0); it needs the ground and at least one block"),
        (closed(BRICKS, "soil"), "has all its outlines on layer soil, which is the ground's"),
        (
            polyline((0, 0), (200, 0), (200, 100), close=False),
            "layer 0: is open at (0, 0) and (200, 100); each block needs a closed outline; what is no block",
        ),
        (lines(*SQUARE[:3]), "layer 0: is open at (0, 0) and (0, 100)"),
        (lines(*SQUARE[:3], (0, 100, 0, 0.1)), "is open at (0, 0) and (0, 0.1)"),
        (lines(*SQUARE, (200, 50, 260, 50)), "is open at (260, 50); each"),
        (lines(*SQUARE, (0, 500, 9, 500), (0, 600, 9, 600)), "is open at (0, 500) and (9, 500) and 2 more"),
        (lines((0, 0, 0, 0), layer="beds"), "holds 1 closed outline (left out: 1 LINE of no length on layer beds)"),
        (lambda _, space: space.add_arc((0, 0), 50, 0, 180), "is open at (50, 0) and (-50, 0)"),
        (polyline((0, 0), (200, 100), (200, 0), (0, 100)), "crosses itself at (0.1, 0.05) m"),
        (polyline((0, 0), (200, 0), (0, 0), (200, 0)), "has no area: its corners, the first at (0, 0) m"),
        (polyline((0, 0), (200, 0)), "must have at least three corners"),
        (own_lines([box(0, 0, 300, 300), box(100, 100, 200, 200)]), "has a block with a hole, at (100, 100)"),
        (
            closed([box(0, 0, 300, 300), box(100, 100, 200, 200)]),
            "overlaps block 1 at (0.15, 0.15): that one lies in it",
        ),
        (closed([BRICKS[0], BRICKS[0]]), "overlaps block 1 at (0.1, 0.05), which lies in the same place; draw it once"),
        (
            closed([BRICKS[0], box(0, 99.8, 200, 199)]),
            "overlaps block 1 at (0.1, 0.1494) by 0.0002 m at (0.1, 0.0999); blocks may touch, not share an area; wal",
        ),
        (
            lines(*SQUARE, (0, 50, 199.9, 50)),
            "is open at (199.9, 50), where a line ends 0.1 drawing units from the next one",
        ),
        (lambda _, space: space.add_line((0, 0, 0), (0, 9, 1)), "LINE 2F: does not lie in the drawing's plane"),
        (
            lambda _, space: space.add_polyline3d([(0, 0, 0), (9, 0, 0), (9, 9, 1)], close=True),
            "does not lie in the drawing's",
        ),
        (tilted, "does not lie in the drawing's plane"),
        (solid, "holds a mesh; each block is one closed polyline"),
        (in_itself, "nests INSERTs more than 32 deep, or in themselves"),
        (without_end, "holds more than 300000 entities, its INSERTs exploded"),
        (lambda _, space: space.add_circle((0, 0), 0), "has no radius"),
        (lambda _, space: space.add_circle((math.nan, 0), 1), "must have its corners at finite coordinates"),
        (polyline((0, 0), (math.inf, 0), (0, 9)), "must have its corners at finite coordinates"),
    ],
)
def test_invalid_dxf_drawing_is_refused(draw: Draw, said: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError) as refused:
        scene_of(dxf(tmp_path / "wall.dxf", draw))
    assert said in str(refused.value)
    assert str(refused.value).startswith("wall.drawing") or "overlaps" in said
    assert "\n" not in str(refused.value)


EAST, NORTH = 512_345e3, 5_412_345e3
"""Map coordinates of a wall [mm], large enough to need many digits."""


@pytest.mark.parametrize(
    ("outlines", "how", "said"),
    [
        ([box(0, 300.1, 400, 400)], {}, "block 7 at (512345.2, 5412345.35): is a floating block"),
        ([box(0, 299.9, 400, 400)], {}, "by 0.0001 m at (512345.1, 5412345.3); blocks may touch"),
        ([], {"heal": 0.02}, "that of block 7 at (512345.2, 5412344.975)"),
        ([], {"live": [512345.0, 0.0]}, "the wall spans x 512345 … 512345.4 m, y 5412345 … 5412345.3 m"),
    ],
)
def test_messages_have_enough_digits_for_map_coordinates(
    outlines: list[Outline], how: dict[str, Any], said: str, tmp_path: Path
) -> None:
    """With four digits all positions were printed as (5.123e+05, 5.412e+06)."""
    here = [[(x + EAST, y + NORTH) for x, y in outline] for outline in [*BRICKS, *outlines]]
    ground = [[(x + EAST, y + NORTH) for x, y in GROUND]]
    dxf(tmp_path / "wall.dxf", closed(here), closed(ground, "ground"), ground=False)
    table = tables(**{key: value for key, value in how.items() if key != "live"})
    if "live" in how:
        table["load"]["live"] = {"kind": "point", "at": how["live"], "force": [1.0, 0.0]}
    with pytest.raises(SceneError) as refused:
        scene_from_dict(table, folder=tmp_path)
    assert said in str(refused.value)


def test_open_lines_at_map_coordinates_are_located(tmp_path: Path) -> None:
    segments = [(a + EAST, b + NORTH, c + EAST, d + NORTH) for a, b, c, d in SQUARE[:3]]
    with pytest.raises(SceneError, match=r"is open at \(512345000, 5412345000\) and \(512345000, 5412345100\); each"):
        scene_of(dxf(tmp_path / "wall.dxf", lines(*segments), ground=False))


@pytest.mark.parametrize("hide", ["off", "freeze"])
def test_ground_on_a_hidden_layer_is_refused_with_a_hint(hide: str, tmp_path: Path) -> None:
    def hidden(document: Any, _: Any) -> None:
        getattr(document.layers.add("GROUND"), hide)()

    state = {"off": "off", "freeze": "frozen"}[hide]
    said = (
        rf"has no outline on a layer named ground \(left out: 1 LWPOLYLINE on layer GROUND, which is {state}\), and 2"
    )
    with pytest.raises(SceneError, match=said):
        scene_of(dxf(tmp_path / "wall.dxf", closed(), hidden))


def test_wall_in_paper_space_is_refused_with_a_hint(tmp_path: Path) -> None:
    """Paper space normally holds frames and titles of sheets; a wall there is a mistake."""

    def on_paper(document: Any, _: Any) -> None:
        closed()(document, document.layout("Layout1"))

    with pytest.raises(SceneError, match=r"holds 1 closed outline \(left out: 7 LWPOLYLINE in paper space\); it needs"):
        scene_of(dxf(tmp_path / "wall.dxf", on_paper))


@pytest.mark.parametrize(
    ("wall", "said"),
    [
        ({"units": "miles"}, 'wall.units = \'miles\': must be one of "mm", "cm", "m", "in", "ft"'),
        ({"units": 1}, "wall.units = 1: must be one of"),
        ({"heal": 0}, "wall.heal = 0: must be a number above 0"),
        ({"heal": -1e-3}, "wall.heal = -0.001: must be a number above 0"),
        ({"heal": "1 mm"}, "wall.heal = '1 mm': must be a number above 0"),
        ({"heal": True}, "wall.heal = True: must be a number above 0"),
        (
            {"heal": 0.02},
            "= 0.02: must be at most a tenth of the smallest block's smaller side, 0.005: that of block 7 at (0.2",
        ),
        ({"healing": 1e-3}, 'wall.healing = 0.001: is not a key of [wall]; did you mean "heal"?'),
        ({"drawing": 3}, "wall.drawing = 3: must be a string"),
        ({"course_heights": [0.1]}, "wall.course_heights: does not go with wall.drawing"),
    ],
)
def test_invalid_keys_of_a_drawing_are_refused(wall: dict[str, Any], said: str, tmp_path: Path) -> None:
    dxf(tmp_path / "wall.dxf", closed())
    with pytest.raises(SceneError) as refused:
        scene_from_dict(tables(**wall), folder=tmp_path)
    assert said in str(refused.value)


@pytest.mark.parametrize("how", [{"length": 1.44, "height": 0.72}, {"courses": [[1.0]]}])
def test_heal_is_refused_without_a_drawing(how: dict[str, Any]) -> None:
    wall = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.1, "heal": 1e-3, **how}
    with pytest.raises(SceneError, match=r"wall\.heal: does not go with wall\.(length|courses); describe the wall"):
        scene_from_dict(tables() | {"wall": wall})


def test_healing_refuses_to_straighten_a_curved_bed(tmp_path: Path) -> None:
    """Courses in bond along a parabola: no quadrilateral blocks fit, and moves of 0.2 mm do not make them fit."""

    def bed(x: float) -> float:
        return 200 + (x - 1000) ** 2 * 7.5e-6

    lower = [[(x, 0), (x + 100, 0), (x + 100, bed(x + 100)), (x, bed(x))] for x in range(0, 2000, 100)]
    upper = [[(x, bed(x)), (x + 100, bed(x + 100)), (x + 100, 400), (x, 400)] for x in range(-50, 1950, 100)]
    path = dxf(tmp_path / "wall.dxf", closed([*lower, *upper]))
    with pytest.raises(
        SceneError, match=r"wall\.heal = 0\.0002: closes no gaps near \(2, 0\.2075\): the corner would move"
    ):
        scene_of(path, heal=2e-4)


def spoilt(change: Callable[[dict[str, Any]], Any], layout: Callable[[], dict[str, Any]] = assembly) -> str:
    found = layout()
    change(found)
    return json.dumps(found)


def nodes(found: dict[str, Any]) -> dict[str, Any]:
    return dict(found["data"]["graph"]["data"]["node"])


def vertices(found: dict[str, Any]) -> dict[str, Any]:
    return dict(nodes(found)["0"]["block"]["data"]["vertex"])


def without_x(found: dict[str, Any]) -> None:
    """Remove x from a corner, in a mesh without a default x."""
    del vertices(found)["0"]["x"]
    del nodes(found)["0"]["block"]["data"]["default_vertex_attributes"]["x"]


def slanted(found: dict[str, Any]) -> None:
    """Turn the wall in plan, away from the coordinate axes."""
    for node in nodes(found).values():
        for vertex in node["block"]["data"]["vertex"].values():
            x, y = vertex["x"], vertex["y"]
            vertex.update(x=0.8 * x - 0.6 * y, y=0.6 * x + 0.8 * y)


def holed(found: dict[str, Any]) -> None:
    """Replace a block by one mesh of four prisms around a hole."""
    parts = [mesh(o) for o in (box(0, 0, 3, 1), box(2, 1, 3, 2), box(0, 2, 3, 3), box(0, 1, 1, 2))]
    whole: dict[str, Any] = {"vertex": {}, "face": {}}
    for k, part in enumerate(parts):
        whole["vertex"] |= {str(8 * k + int(key)): vertex for key, vertex in part["vertex"].items()}
        whole["face"] |= {f"{k} {key}": [8 * k + c for c in face] for key, face in part["face"].items()}
    nodes(found)["0"]["block"]["data"].update(whole)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is not a valid JSON file"),
        ("{", "is not a valid JSON file"),
        ("[" * 100_000, "is not a valid JSON file"),
        (
            "[1, 2]",
            'wall.drawing, dtype = \'(none)\': must be "compas_assembly.datastructures/Assembly" or "compas_dem',
        ),
        ('{"dtype": "compas.datastructures/Mesh", "data": {}}', "wall.drawing, dtype = 'compas.datastructures/Mesh'"),
        ('{"dtype": 7}', "wall.drawing, dtype = 7: must be"),
        ('{"dtype": "compas_assembly.datastructures/Assembly"}', "is not a COMPAS assembly"),
        ('{"assembly": {"vertex": {}}, "blocks": {}}', "is an assembly without blocks"),
        (spoilt(lambda a: a.pop("data")), "is not a COMPAS assembly"),
        (spoilt(lambda a: nodes(a)["0"].pop("block")), "is not a COMPAS assembly: KeyError, 'block'"),
        (spoilt(without_x), "is not a COMPAS assembly: KeyError, 'x'"),
        (spoilt(lambda a: vertices(a)["0"].update(x="a")), "is not a COMPAS assembly: ValueError"),
        (spoilt(lambda a: vertices(a)["0"].update(x=math.nan)), "node 0: must have its corners at finite coordinates"),
        (spoilt(lambda a: vertices(a)["0"].update(x=-0.1)), "node 0: is not a prism across the wall"),
        (spoilt(lambda a: nodes(a)["0"]["block"]["data"]["face"].pop("0")), "node 0: is not a prism across the wall"),
        (
            spoilt(lambda a: nodes(a)["0"]["block"]["data"]["face"].update({"0": [0, 1, 99]})),
            "is not a COMPAS assembly",
        ),
        (
            spoilt(lambda a: [v.update(y=v["y"] + 0.3) for v in vertices(a).values()]),
            "node 0: does not reach as far as the others do along x, y or z",
        ),
        (
            spoilt(lambda a: [v.update(y=2 * v["y"]) for v in vertices(a).values()]),
            "node 0: does not reach as far as the others do along x, y or z",
        ),
        (spoilt(slanted), "wall.drawing: is an assembly in no plane across x, y or z: along none of them do"),
        (spoilt(lambda a: [n.update(is_support=True) for n in nodes(a).values()]), "is an assembly of supports"),
        (spoilt(holed), "node 0: is not a prism across the wall, with one outline a side and no hole"),
        (spoilt(lambda a: a["blocks"]["0"].pop("face"), untyped), "is not a COMPAS assembly: KeyError, 'face'"),
        (spoilt(lambda a: a["data"].update(transformation={}), model), "is not a COMPAS assembly: KeyError, 'data'"),
        (
            spoilt(lambda a: a["data"]["elements"]["0"]["data"].pop("geometry"), model),
            "element 0 (Block 0): has no geometry",
        ),
        (
            spoilt(lambda a: a["data"]["elements"]["1"]["data"].update(transformation=moving(0, 0, across=1)), model),
            "element 1 (Block 1): does not reach as far as the others do along x, y or z; read are walls in a plane",
        ),
        (
            spoilt(lambda a: a["data"]["tree"]["root"].update(children=[{"element": "none"}]), model),
            "is not a COMPAS assembly: KeyError, 'none'",
        ),
        (
            spoilt(lambda a: a["data"]["elements"]["1"]["data"].update(transformation={}), model),
            "is not a COMPAS assembly",
        ),
    ],
)
def test_invalid_json_assembly_is_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "wall.json").write_text(text)
    with pytest.raises(SceneError) as refused:
        scene_of(tmp_path / "wall.json", units="m")
    assert said in str(refused.value)
    assert str(refused.value).startswith("wall.drawing")
    assert "\n" not in str(refused.value)


def test_folder_or_missing_file_as_assembly_is_refused(tmp_path: Path) -> None:
    (tmp_path / "wall.json").mkdir()
    with pytest.raises(SceneError, match="cannot be read as JSON: it is not a regular file"):
        scene_of(tmp_path / "wall.json", units="m")
    with pytest.raises(SceneError, match="cannot be read as JSON: No such file"):
        scene_of(tmp_path / "none.json", units="m")


@pytest.mark.parametrize(
    ("head", "said"),
    [
        (b"AC1032", "is a DWG file; save the drawing as DXF"),
        (b"<svg/>", "is not a DXF file"),
        (b"", "is not a DXF file"),
    ],
)
def test_other_file_formats_are_refused_by_name(head: bytes, said: str, tmp_path: Path) -> None:
    (tmp_path / "wall.dxf").write_bytes(head + bytes(200 * bool(head)))
    with pytest.raises(SceneError) as refused:
        scene_of(tmp_path / "wall.dxf")
    assert str(refused.value).startswith("wall.drawing = ")
    assert str(refused.value).endswith(f": {said}")
