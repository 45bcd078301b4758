"""Reading of DXF drawings: the same wall results however it was drawn."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from runningbond.scene import SceneError
from runningbond.scene.drawings import curves, read_drawing

from .drafting import BRICKS, COURSES, GROUND, Draw, Outline, box, closed, dxf, lines, multiplier, own_lines, scene_of


def nearly_closed(_: Any, space: Any) -> None:
    """The last corner repeats the first to within 6e-13 mm, as in published drawings."""
    for outline in BRICKS:
        space.add_lwpolyline([*outline, (outline[0][0] + 6e-13, outline[0][1])])


def old_polylines(_: Any, space: Any) -> None:
    for k, outline in enumerate(BRICKS):
        if k % 2:
            space.add_polyline2d(outline, close=True)
        else:
            space.add_polyline3d([(*corner, 3.0) for corner in outline], close=True)


def shared(_: Any, space: Any) -> None:
    """Each course line and each head joint once."""
    for k in range(4):
        space.add_line((0, 100 * k), (400, 100 * k))
    for k, xs in enumerate(COURSES):
        for x in xs:
            space.add_line((x, 100 * k), (x, 100 * (k + 1)))


def halves(_: Any, space: Any) -> None:
    """Two open polylines per block, of opposite sense."""
    for a, b, c, d in BRICKS:
        space.add_lwpolyline([a, b, c])
        space.add_lwpolyline([a, d, c])


def cut_outline(_: Any, space: Any) -> None:
    """A closed outline of each course, with lines for its head joints."""
    for k, xs in enumerate(COURSES):
        space.add_lwpolyline(box(0, 100 * k, 400, 100 * (k + 1)), close=True)
        for x in xs[1:-1]:
            space.add_line((x, 100 * k), (x, 100 * (k + 1)))


def inserts(document: Any, space: Any) -> None:
    """One brick of unit size: scaled, mirrored, turned, nested and in an array."""
    brick = document.blocks.new("BRICK")
    brick.add_lwpolyline(box(0, 0, 1, 1), close=True)
    pair = document.blocks.new("PAIR")
    pair.add_blockref("BRICK", (0, 0))
    pair.add_blockref("BRICK", (2, 1), dxfattribs={"xscale": -1, "yscale": -1})
    space.add_blockref(
        "BRICK", (0, 0), dxfattribs={"xscale": 200, "yscale": 100, "column_count": 2, "column_spacing": 200}
    )
    space.add_blockref("BRICK", (100, 100), dxfattribs={"xscale": 100, "yscale": 100, "rotation": 90})
    space.add_blockref("BRICK", (300, 100), dxfattribs={"xscale": -200, "yscale": 100})
    space.add_blockref("BRICK", (300, 200), dxfattribs={"xscale": 100, "yscale": 100, "rotation": -90})
    space.add_blockref("PAIR", (0, 200), dxfattribs={"xscale": 200, "yscale": 100})


def turned_inserts(document: Any, space: Any) -> None:
    """One brick of unit size, turned upright in a block that is stretched."""
    document.blocks.new("BRICK").add_lwpolyline(box(0, 0, 1, 1), close=True)
    document.blocks.new("UPRIGHT").add_blockref("BRICK", (1, 0), dxfattribs={"rotation": 90})
    for (left, bottom), _, (right, top), _ in BRICKS:
        scales = {"xscale": right - left, "yscale": top - bottom}
        space.add_blockref("UPRIGHT", (left, bottom), dxfattribs=scales)


WAYS: dict[str, Draw] = {
    "closed": closed(),
    "nearly closed": nearly_closed,
    "old polylines": old_polylines,
    "own lines": own_lines(),
    "shared lines": shared,
    "halves": halves,
    "cut outlines": cut_outline,
    "inserts": inserts,
    "turned inserts": turned_inserts,
}


@pytest.mark.parametrize("way", WAYS)
def test_multiplier_does_not_depend_on_how_the_wall_is_drawn(way: str, tmp_path: Path) -> None:
    exact = scene_of(dxf(tmp_path / "wall.dxf", closed()))
    scene = scene_of(dxf(tmp_path / "other.dxf", WAYS[way]))
    assert len(scene.joints) == len(exact.joints) == 14
    assert np.sort(scene.blocks.area) == pytest.approx(np.sort(exact.blocks.area))
    assert multiplier(scene) == pytest.approx(multiplier(exact), rel=1e-9)


@pytest.mark.parametrize(
    ("way", "said"),
    [
        ("shared lines", "layer 0: 14 lines and curves are joined into 7 outlines; neighbours share lines, so every"),
        ("own lines", "layer 0: 28 lines and curves are joined into 7 outlines"),
        ("cut outlines", "joined into 7 outlines"),
    ],
)
def test_note_says_how_lines_were_joined_into_outlines(way: str, said: str, tmp_path: Path) -> None:
    (note,) = scene_of(dxf(tmp_path / "wall.dxf", WAYS[way])).notes
    assert said in note


def test_area_without_an_outline_of_its_own_is_an_opening(tmp_path: Path) -> None:
    """Four bricks around a hole, each with its own LINEs."""
    around = [box(0, 0, 100, 300), box(200, 0, 300, 300), box(100, 0, 200, 100), box(100, 200, 200, 300)]
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", own_lines(around)), "mm")
    assert len(drawing.blocks) == 4
    assert "one area within them is an opening" in drawing.notes[0]


@pytest.mark.parametrize("again", [1, 4])
def test_duplicate_lines_do_not_remove_a_stone(again: int, tmp_path: Path) -> None:
    """Neighbours may both draw their common line, but beyond a line on the outside there is no neighbour."""
    sides = [(0, 0, 100, 0), (100, 0, 100, 100), (100, 100, 0, 100), (0, 100, 0, 0)]
    twice = lines(*sides, *sides[:again])
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", twice, closed([box(200, 0, 300, 100)])), "mm")
    assert _areas(drawing.blocks) == pytest.approx([0.01, 0.01])


def test_crossing_lines_are_cut_at_their_intersection(tmp_path: Path) -> None:
    cross = lines(
        (0, 0, 200, 0), (200, 0, 200, 200), (200, 200, 0, 200), (0, 200, 0, 0), (0, 90, 200, 90), (70, 0, 70, 200)
    )
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", cross), "mm")
    assert sorted(round(1e6 * a) for a in _areas(drawing.blocks)) == [6300, 7700, 11700, 14300]


def _areas(outlines: list[Any]) -> list[float]:
    return [float((o[:, 0] * np.roll(o[:, 1], -1) - np.roll(o[:, 0], -1) * o[:, 1]).sum() / 2) for o in outlines]


# --- layers, and what is left out ----------------------------------------------------------------------------------


def test_ignored_entities_are_counted_by_type_and_layer(tmp_path: Path) -> None:
    def more(document: Any, space: Any) -> None:
        document.layers.add("AXES").freeze()
        document.layers.add("GRID").off()
        for _ in range(3):
            space.add_text("brick", dxfattribs={"layer": "NOTES"})
        space.add_point((3, 3), dxfattribs={"layer": "NOTES"})
        space.add_hatch().paths.add_polyline_path(BRICKS[0])
        space.add_line((0, -99), (0, 999), dxfattribs={"layer": "AXES"})
        space.add_line((0, -99), (0, 999), dxfattribs={"layer": "GRID"})
        space.add_linear_dim((0, -20), (0, 0), (200, 0)).render()

    scene = scene_of(dxf(tmp_path / "wall.dxf", closed(), more))
    (note,) = scene.notes
    assert note.startswith("left out: ")
    for part in (
        "3 TEXT, 1 POINT on layer NOTES",
        "1 HATCH, 1 DIMENSION on layer 0",
        "1 LINE on layer AXES, which is frozen",
        "1 LINE on layer GRID, which is off",
    ):
        assert part in note


def test_paper_space_and_zero_length_lines_are_ignored_with_a_note(tmp_path: Path) -> None:
    """A line of zero length is no open outline, and a polyline of a single point is no block."""

    def more(document: Any, space: Any) -> None:
        closed([box(0, 0, 420, 297)])(document, document.layout("Layout1"))
        space.add_line((5, 5), (5, 5))
        space.add_lwpolyline([(5, 5), (5, 5)], close=True, dxfattribs={"layer": "X"})
        space.add_lwpolyline([(5, 5)])

    scene = scene_of(dxf(tmp_path / "wall.dxf", closed(), more))
    assert len(scene.joints) == 14
    assert scene.notes == (
        "left out: 1 LINE of no length, 1 LWPOLYLINE of no length on layer 0; 1 LWPOLYLINE of no length on layer X; "
        "1 LWPOLYLINE in paper space",
    )


@pytest.mark.parametrize("version", ["R2000", "R2004", "R2007", "R2018"])
@pytest.mark.parametrize("form", ["asc", "bin"])
def test_layer_names_in_any_alphabet(version: str, form: str, tmp_path: Path) -> None:
    """DXF before 2007 has a code page and escapes other letters; names must still match to find hidden layers."""
    document = ezdxf.new(version)  # type: ignore[attr-defined]
    space = document.modelspace()
    document.layers.add("Оси").off()
    closed([*BRICKS], "Mörtel, Кладка")(document, space)
    closed([GROUND], "ground")(document, space)
    lines((0, -99, 0, 999), layer="Оси")(document, space)
    document.saveas(tmp_path / "wall.dxf", fmt=form)
    drawing = read_drawing(tmp_path / "wall.dxf", "m")
    assert set(drawing.layers) == {"Mörtel, Кладка"}
    assert drawing.notes == ("left out: 1 LINE on layer Оси, which is off",)


def test_first_corner_is_removed_if_it_lies_within_a_side(tmp_path: Path) -> None:
    stone = [(100, 300), (200, 300), (200, 400), (0, 400), (0, 300)]
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed([*BRICKS, stone])), "mm")
    assert sorted(map(tuple, drawing.blocks[7].round(9))) == [(0.0, 0.3), (0.0, 0.4), (0.2, 0.3), (0.2, 0.4)]


def test_huge_ground_does_not_change_the_tolerances_of_stones(tmp_path: Path) -> None:
    """Tolerances for corners and slivers scale with the stones: a corner 0.1 mm off a straight side must remain."""
    stone = [(0, 300), (200, 300), (200.1, 350), (200, 400), (0, 400)]
    ground = closed([box(-50_000, -100_000, 50_000, 0)], layer="ground")
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed([*BRICKS, stone]), ground, ground=False), "mm")
    assert len(drawing.blocks[7]) == 5
    assert drawing.notes == ()


def test_sliver_is_reported_with_the_contact_tolerance(tmp_path: Path) -> None:
    """A block 0.01 mm thin, between two nearby lines, reduces the contact tolerance of all blocks to 0.2 µm."""
    strip = closed([box(0, 300, 400, 300.01)])
    (note,) = read_drawing(dxf(tmp_path / "wall.dxf", closed(), strip), "mm").notes
    assert note == (
        "slivers: block 7 at (0.2, 0.3) is 1e-05 m thin; the smallest block sets how wide a gap is contact, 2e-07 m"
    )


@pytest.mark.parametrize("off", [0.0, 3e-13])
@pytest.mark.parametrize(
    ("tip", "spiked"),
    [
        ((50, -70), lambda off: [(0, 0), (50, 0), (50, -70), (50 + off, -70), (50, 0), (200, 0), (200, 100), (0, 100)]),
        ((150, 40), lambda off: [(0, 0), (200, 0), (200, 100), (150 + off, 100), (150, 40), (150, 100), (0, 100)]),
        ((200, 180), lambda off: [(0, 0), (200 + off, 0), (200, 180), (200, 100), (0, 100)]),
        ((0, -20), lambda off: [(0, -20), (0, 0), (200, 0), (200, 100), (off, 100)]),
    ],
    ids=["out of a side", "into it", "along a head joint", "at its first corner"],
)  # fmt: skip
def test_spikes_of_zero_width_are_removed(
    tip: tuple[int, int], spiked: Callable[[float], Outline], off: float, tmp_path: Path
) -> None:
    """Cutting and joining shapes leaves such spikes; they would make joints with the stones that they touch."""
    path = dxf(tmp_path / "wall.dxf", closed([spiked(off), *BRICKS[1:]]))
    scene, plain = scene_of(path), scene_of(dxf(tmp_path / "plain.dxf", closed()))
    assert np.sort(scene.blocks.vertices, axis=0) == pytest.approx(np.sort(plain.blocks.vertices, axis=0))
    assert scene.joints.length == pytest.approx(plain.joints.length)
    at = f"({1e-3 * tip[0]:g}, {1e-3 * tip[1]:g})"
    assert f"spikes: an outline turns back on itself at {at} m; what has no width is left out" in scene.notes


def test_layer_0_inside_a_block_becomes_the_layer_of_its_insert(tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        block = document.blocks.new("BRICK")
        block.add_lwpolyline(box(0, 0, 200, 100), close=True)
        block.add_lwpolyline(box(200, 0, 400, 100), close=True, dxfattribs={"layer": "LIME"})
        space.add_blockref("BRICK", (0, 0), dxfattribs={"layer": "TUFF"})

    assert read_drawing(dxf(tmp_path / "wall.dxf", draw), "mm").layers == ("TUFF", "LIME")


@pytest.mark.parametrize("name", ["ground", "Soil", "SUPPORT", "base", "Terrain"])
def test_ground_pieces_are_found_by_layer_name(name: str, tmp_path: Path) -> None:
    """A lintel on two blocks on a stepped ground of two pieces; one block lies lower than the ground's higher piece."""
    pieces = [box(-100, -200, 100, -100), [(200, -50), (700, -50), (700, 40), (600, 40), (600, 0), (200, 0)]]
    blocks = [box(0, -100, 100, 100), box(500, 0, 600, 100), box(0, 100, 600, 200)]
    path = dxf(tmp_path / "wall.dxf", closed(blocks, "ASHLAR"), closed(pieces, name), ground=False)
    scene = scene_of(path)
    assert scene.wall.tolist() == [True, True, True, False, False]
    assert scene.fixed.tolist() == [False, False, False, True, True]
    assert scene.notes == ()
    assert len(scene.joints) == 5
    assert multiplier(scene) > 0


def test_plinth_on_a_ground_layer_is_reported(tmp_path: Path) -> None:
    """It becomes a fixed support, which no result would reveal."""
    plinth, soil = closed([box(-50, -60, 450, 0)], "Base"), closed([box(-500, -90, 900, -60)], "ground")
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(BRICKS), plinth, soil, ground=False), "mm")
    assert len(drawing.grounds) == 2
    assert drawing.notes == ("ground: all that lies on layers Base and ground is ground, 2 outlines",)
    plain = read_drawing(dxf(tmp_path / "plain.dxf", closed(BRICKS), soil, ground=False), "mm")
    assert not any(note.startswith("ground") for note in plain.notes)


def test_lowest_outline_is_the_ground_without_a_ground_layer(tmp_path: Path) -> None:
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed([*BRICKS, box(-500, -50, 900, 0)]), ground=False), "mm")
    assert (len(drawing.blocks), len(drawing.grounds)) == (7, 1)
    assert drawing.notes == ("ground: no layer is named ground, so it is the lowest outline, at (0.2, -0.025)",)


def test_several_equally_low_outlines_are_refused_as_ground(tmp_path: Path) -> None:
    """Three stones side by side, drawn without ground: one would be fixed and the others float."""
    path = dxf(tmp_path / "wall.dxf", closed([box(x, 0, x + 300, 200) for x in (0, 300, 600)]), ground=False)
    with pytest.raises(SceneError, match="has no outline on a layer named ground, and 3 outlines lie as low"):
        read_drawing(path, "mm")


def test_units_that_differ_from_the_header_are_reported(tmp_path: Path) -> None:
    def header(document: Any, _: Any) -> None:
        document.header["$INSUNITS"] = 5

    (note,) = read_drawing(dxf(tmp_path / "wall.dxf", closed(), header), "mm").notes
    assert note == "units: the drawing's header says cm, wall.units says mm, which counts"


@pytest.mark.parametrize(("state", "seen"), [("on", ["0", "STONE"]), ("off", ["STONE"]), ("freeze", [])])
def test_contents_of_an_insert_are_read_if_its_layer_is_off_but_not_if_frozen(
    state: str, seen: list[str], tmp_path: Path
) -> None:
    """As CAD programs show it; layer 0 inside the block is the INSERT's layer, and hidden with it."""

    def insert(document: Any, space: Any) -> None:
        getattr(document.layers.add("INSERTS"), state)()
        two = document.blocks.new("TWO")
        two.add_lwpolyline(box(0, 300, 100, 400), close=True, dxfattribs={"layer": "STONE"})
        two.add_lwpolyline(box(100, 300, 250, 400), close=True)
        space.add_blockref("TWO", (0, 0), dxfattribs={"layer": "INSERTS"})

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(), insert), "mm")
    areas = {"STONE": 0.01, "0": 0.015}
    assert sorted(_areas(drawing.blocks[7:])) == pytest.approx(sorted(areas[layer] for layer in seen))


def test_invisible_outlines_are_left_out_with_a_note(tmp_path: Path) -> None:
    def hidden(_: Any, space: Any) -> None:
        space.add_lwpolyline(box(0, 300, 100, 400), close=True, dxfattribs={"invisible": 1})

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(), hidden), "mm")
    assert len(drawing.blocks) == 7
    assert drawing.notes == ("left out: 1 LWPOLYLINE on layer 0, invisible",)


@pytest.mark.parametrize(
    ("code", "unit", "metres"), [(1, "in", 0.0254), (2, "ft", 0.3048), (4, "mm", 1e-3), (5, "cm", 0.01), (6, "m", 1.0)]
)
def test_units_that_agree_with_the_header_need_no_note(code: int, unit: str, metres: float, tmp_path: Path) -> None:
    """With AutoCAD's codes of $INSUNITS; lengths are converted from drawing units to metres."""

    def units(document: Any, _: Any) -> None:
        document.header["$INSUNITS"] = code

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(), units), unit)
    assert not any(note.startswith("units: ") for note in drawing.notes)
    assert np.ptp(np.vstack(drawing.blocks), axis=0) == pytest.approx(np.array([400.0, 300.0]) * metres)


def test_drawing_without_a_header_needs_no_units_note(tmp_path: Path) -> None:
    """As scripts write DXF: an ENTITIES section and nothing else."""

    def polyline(outline: Outline, layer: str) -> str:
        corners = "".join(f"0\nVERTEX\n8\n{layer}\n10\n{x}\n20\n{y}\n" for x, y in outline)
        return f"0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n1\n{corners}0\nSEQEND\n"

    text = "".join(polyline(outline, "S") for outline in BRICKS) + polyline(GROUND, "ground")
    (tmp_path / "wall.dxf").write_text(f"0\nSECTION\n2\nENTITIES\n{text}0\nENDSEC\n0\nEOF\n")
    scene = scene_of(tmp_path / "wall.dxf")
    assert len(scene.joints) == 14
    assert scene.notes == ()


@pytest.mark.parametrize("stones", [closed, own_lines])
def test_distant_entities_do_not_merge_corners_of_stones(stones: Any, tmp_path: Path) -> None:
    """A wall at map coordinates and a hatching sample at the origin: line ends half a metre apart once merged."""
    there = [[(x + 512_345e3, y + 5_412_345e3) for x, y in outline] for outline in [*BRICKS, GROUND]]
    ground, sample = closed(there[-1:], "ground"), closed([box(0, 0, 50, 20)], "ground")
    scene = scene_of(dxf(tmp_path / "wall.dxf", stones(there[:-1]), ground, sample, ground=False))
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(0.12, rel=1e-6)
    assert len(scene.joints) == 14


def test_block_below_the_ground_layer_is_reported(tmp_path: Path) -> None:
    """A first course on a layer named base, and soil on a layer whose name does not mark it as ground."""
    plinth, soil = closed(BRICKS[:2], "Base"), closed([GROUND], "Soil model")
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(BRICKS[2:]), plinth, soil, ground=False), "mm")
    assert drawing.notes == ("ground: layer Base; block 5, on layer Soil model, lies lower",)


# --- arcs ------------------------------------------------------------------------------------------------------------


def at(radius: float, angle: float) -> tuple[float, float]:
    return radius * math.cos(angle), radius * math.sin(angle)


INNER, OUTER, STONES = 1000.0, 1200.0, 9


def bulged(_: Any, space: Any) -> None:
    """Stones of a round arch as polylines, alternately clockwise."""
    for k, (a, b) in enumerate(pairwise(np.linspace(0, math.pi, STONES + 1))):
        bulge = math.tan((b - a) / 4)
        corners = [at(INNER, a), at(OUTER, a), at(OUTER, b), at(INNER, b)]
        bulges = [0, bulge, 0, -bulge]
        if k % 2:
            corners, bulges = corners[::-1], [0, -bulge, 0, bulge]
        space.add_lwpolyline([(*p, c) for p, c in zip(corners, bulges, strict=True)], "xyb", close=True)


def of_arcs(_: Any, space: Any) -> None:
    """Stones of the same arch, each of two ARCs and two LINEs."""
    for a, b in pairwise(np.linspace(0, math.pi, STONES + 1)):
        for angle in (a, b):
            space.add_line(at(INNER, angle), at(OUTER, angle))
        for radius in (INNER, OUTER):
            space.add_arc((0, 0), radius, math.degrees(a), math.degrees(b))


def of_two_arcs(_: Any, space: Any) -> None:
    """The same arch as one ring, cut by its joints."""
    for angle in np.linspace(0, math.pi, STONES + 1):
        space.add_line(at(INNER, angle), at(OUTER, angle))
    for radius in (INNER, OUTER):
        space.add_arc((0, 0), radius, 0, 180)


def mirrored(document: Any, space: Any) -> None:
    """One half of the polylines, its mirror image by an INSERT, and the keystone in the middle."""
    half = document.blocks.new("HALF")
    for k, (a, b) in enumerate(pairwise(np.linspace(0, math.pi, STONES + 1))):
        corners = [at(INNER, a), at(OUTER, a), at(OUTER, b), at(INNER, b)]
        bulge = math.tan((b - a) / 4)
        rows = [(*p, c) for p, c in zip(corners, (0, bulge, 0, -bulge), strict=True)]
        if k < STONES // 2:
            half.add_lwpolyline(rows, "xyb", close=True)
        elif k == STONES // 2:
            space.add_lwpolyline(rows, "xyb", close=True)
    space.add_blockref("HALF", (0, 0))
    space.add_blockref("HALF", (0, 0), dxfattribs={"xscale": -1})


SPRINGINGS = closed([box(-1500, -100, -900, 0), box(900, -100, 1500, 0)], "ground")


def arch_load(draw: Draw, folder: Path) -> float:
    return multiplier(scene_of(dxf(folder / "wall.dxf", draw, SPRINGINGS, ground=False)))


@pytest.mark.parametrize("draw", [of_arcs, of_two_arcs, mirrored])
def test_multiplier_of_an_arch_does_not_depend_on_how_it_is_drawn(draw: Draw, tmp_path: Path) -> None:
    assert arch_load(draw, tmp_path) == pytest.approx(arch_load(bulged, tmp_path), rel=1e-9)


def sheared(document: Any, space: Any) -> None:
    """The polylines as one voussoir of a squeezed arch, turned from place to place in a block that is stretched."""
    voussoir, arch = document.blocks.new("VOUSSOIR"), document.blocks.new("ARCH")
    step = math.pi / STONES
    corners, bulge = [at(INNER, 0), at(OUTER, 0), at(OUTER, step), at(INNER, step)], math.tan(step / 4)
    rows = [(x / 2, y / 2, c) for (x, y), c in zip(corners, (0, bulge, 0, -bulge), strict=True)]
    voussoir.add_lwpolyline(rows, "xyb", close=True)
    for k in range(STONES):
        arch.add_blockref("VOUSSOIR", (0, 0), dxfattribs={"rotation": math.degrees(k * step)})
    space.add_blockref("ARCH", (0, 0), dxfattribs={"xscale": 2, "yscale": 2.5})


def test_inserts_turned_in_a_stretched_one_are_sheared(tmp_path: Path) -> None:
    """An elliptic arch whose stones all touch."""
    scene = scene_of(dxf(tmp_path / "wall.dxf", sheared, SPRINGINGS, ground=False))
    round_arch = scene_of(dxf(tmp_path / "round.dxf", bulged, SPRINGINGS, ground=False))
    assert len(scene.joints) == STONES + 1
    assert scene.blocks.area[scene.wall] == pytest.approx(1.25 * round_arch.blocks.area[round_arch.wall], rel=1e-3)
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(1.25e-6 * math.pi / 2 * (OUTER**2 - INNER**2), rel=1e-3)


def test_arch_multiplier_converges_quadratically_in_the_chord_length(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A quarter of the sagitta, i.e. half the chord length, leaves a quarter of the error."""
    loads = []
    for sagitta in (4e-3, 1e-3, 2.5e-4, 1e-6):
        monkeypatch.setattr(curves, "SAGITTA", sagitta)
        loads.append(arch_load(bulged, tmp_path))
    errors = np.abs(np.array(loads[:3]) - loads[3])
    assert errors[:-1] / errors[1:] == pytest.approx(4, rel=0.35)


def test_reported_sagitta_is_the_largest_deviation_of_the_chords(tmp_path: Path) -> None:
    drawing = read_drawing(dxf(tmp_path / "wall.dxf", bulged, SPRINGINGS, ground=False), "mm")
    (note,) = drawing.notes
    assert "arcs: 18 are cut into" in note
    said = float(note.split("at most ")[1].split()[0])
    middles = np.vstack([(o + np.roll(o, -1, axis=0)) / 2 for o in drawing.blocks]) * 1e3
    radii = np.hypot(*middles.T)
    near = np.min([np.abs(radii - INNER), np.abs(radii - OUTER)], axis=0)
    chords = near < 50
    assert near[chords].max() == pytest.approx(said, rel=0.05)
    assert said <= curves.SAGITTA * OUTER


def test_filling_touches_the_voussoirs_along_the_whole_arc(tmp_path: Path) -> None:
    """The filling has one arc along the stones' nine arcs, of opposite sense."""

    def filling(_: Any, space: Any) -> None:
        top = [(-1500, 0, 0), (-1200, 0, -1), (1200, 0, 0), (1500, 0, 0), (1500, 1500, 0), (-1500, 1500, 0)]
        space.add_lwpolyline(top, "xyb", close=True, dxfattribs={"layer": "fill"})

    scene = scene_of(dxf(tmp_path / "wall.dxf", bulged, filling, SPRINGINGS, ground=False))
    fill = int(np.argmax(scene.blocks.area * scene.wall))
    touching = (scene.joints.block == fill).any(axis=1) & (
        scene.joints.block[:, 0] + scene.joints.block[:, 1] < fill * 2 + 1
    )
    radii = np.hypot(*scene.joints.ends[touching].reshape(-1, 2).T)
    on_arc = np.abs(radii - OUTER / 1e3) < 1e-9
    assert on_arc.sum() >= 2 * 9
    length = scene.joints.length[touching][on_arc.reshape(-1, 2).all(axis=1)].sum()
    assert length == pytest.approx(math.pi * OUTER / 1e3, rel=1e-3)


@pytest.mark.parametrize("kind", ["circle", "bulges", "ellipse", "spline"])
def test_polygons_of_round_blocks_keep_their_area(kind: str, tmp_path: Path) -> None:
    def draw(document: Any, space: Any) -> None:
        if kind == "circle":
            space.add_circle((200, 150), 100)
        elif kind == "bulges":
            space.add_lwpolyline([(100, 150, 1), (300, 150, 1)], "xyb", close=True)
        elif kind == "ellipse":
            block = document.blocks.new("ROUND")
            block.add_circle((0, 0), 1)
            space.add_blockref("ROUND", (200, 150), dxfattribs={"xscale": 200, "yscale": 50})
        else:
            nodes = [(200 + 100 * math.cos(t), 150 + 100 * math.sin(t)) for t in np.linspace(0, 2 * math.pi, 41)]
            space.add_spline([(*p, 0) for p in nodes])

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", draw), "mm")
    (block,) = drawing.blocks
    assert _areas([block])[0] == pytest.approx(math.pi * 1e-2, rel=3e-3)


@pytest.mark.parametrize("kind", ["circle", "ellipse"])
def test_drawing_mostly_of_full_circles_is_read(kind: str, tmp_path: Path) -> None:
    """The ends of a full circle coincide up to rounding: curves count with their size, not with their ends."""

    def draw(_: Any, space: Any) -> None:
        for k in range(8):
            if kind == "circle":
                space.add_circle((2000 * k + 100, 0), 300)
            else:
                space.add_ellipse((2000 * k + 100, 0), (300, 0), 0.5)

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", draw), "mm")
    exact = math.pi * 0.09 * (1.0 if kind == "circle" else 0.5)
    assert _areas(drawing.blocks) == pytest.approx([exact] * 8, rel=3e-3)


def test_drawing_of_one_circle_is_refused(tmp_path: Path) -> None:
    def draw(_: Any, space: Any) -> None:
        space.add_circle((5, 5), 0.3)

    with pytest.raises(SceneError, match="holds 1 closed outline; it needs the ground and at least one block"):
        read_drawing(dxf(tmp_path / "wall.dxf", draw, ground=False), "mm")


def test_arc_across_angle_zero_and_its_mirror_image(tmp_path: Path) -> None:
    """The right half of a disc; with its extrusion away from the viewer, mirrored, the left half."""

    def half(_: Any, space: Any) -> None:
        space.add_arc((1000, 600), 200, 270, 90)
        space.add_line((1000, 400), (1000, 800))

    def mirrored(_: Any, space: Any) -> None:
        space.add_arc((1000, 1600), 200, 270, 90, dxfattribs={"extrusion": (0, 0, -1)})
        space.add_line((-1000, 1400), (-1000, 1800))

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", half, mirrored), "mm")
    boxes = sorted([*o.min(axis=0), *o.max(axis=0)] for o in drawing.blocks)
    assert boxes[0] == pytest.approx([-1.2, 1.4, -1.0, 1.8], abs=1e-3)
    assert boxes[1] == pytest.approx([1.0, 0.4, 1.2, 0.8], abs=1e-3)


@pytest.mark.parametrize("kind", ["add_lwpolyline", "add_polyline2d"])
def test_polyline_with_negative_extrusion_is_mirrored(kind: str, tmp_path: Path) -> None:
    """As left by a mirrored block: x of the corners has the opposite sign."""

    def mirrored(_: Any, space: Any) -> None:
        getattr(space, kind)(box(600, 300, 700, 400), close=True, dxfattribs={"extrusion": (0, 0, -1)})

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(), mirrored), "mm")
    found = drawing.blocks[7]
    assert [*found.min(axis=0), *found.max(axis=0)] == pytest.approx([-0.7, 0.3, -0.6, 0.4])


def test_control_points_of_a_fitted_polyline_are_ignored(tmp_path: Path) -> None:
    """An old polyline that was fitted to a curve also stores the vertices of its control polygon."""

    def fitted(_: Any, space: Any) -> None:
        curve, frame = box(0, 300, 100, 400), [(50, 350), (500, 900)]
        polyline = space.add_polyline2d([*curve[:2], *frame, *curve[2:]], close=True)
        for vertex in polyline.vertices[2:4]:
            vertex.dxf.flags |= 16

    drawing = read_drawing(dxf(tmp_path / "wall.dxf", closed(), fitted), "mm")
    assert _areas(drawing.blocks[7:]) == pytest.approx([0.01])
    assert len(drawing.blocks[7]) == 4


def test_blocks_on_both_sides_of_a_spline_touch(tmp_path: Path) -> None:
    """The two blocks draw the spline in opposite directions."""
    nodes = [(0, 100, 0), (60, 130, 0), (140, 80, 0), (200, 100, 0)]

    def draw(_: Any, space: Any) -> None:
        for layer, order, end in (("a", nodes, 0), ("b", nodes[::-1], 220)):
            space.add_open_spline(order, dxfattribs={"layer": layer})
            for p, q in pairwise([(0, 100), (0, end), (200, end), (200, 100)]):
                space.add_line(p, q, dxfattribs={"layer": layer})

    scene = scene_of(dxf(tmp_path / "wall.dxf", draw))
    a, b = scene.joints.block.T
    between = (a == 0) & (b == 1)
    assert scene.joints.ends[between][..., 0].min() == 0
    assert scene.joints.ends[between][..., 0].max() == pytest.approx(0.2)
    assert (scene.joints.ends[between][:, 0, 0] - scene.joints.ends[between][:, 1, 0]).sum() == pytest.approx(0.2)
