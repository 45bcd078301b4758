"""Blocks and joints are correct for geometry from any source: patterns, TOML files, drawings, Python."""

import math
import os
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runningbond.scene import (
    Array,
    Beam,
    BlockMaterial,
    Blocks,
    Bond,
    JointMaterial,
    Lateral,
    Load,
    Mortar,
    PointLoad,
    SceneError,
    Stiffness,
    build_scene,
    find_joints,
    read_scene,
    scene_from_dict,
)
from runningbond.scene.bond import bonded_rows, pattern_rows, rectangles
from tests.walls import content, courses, panel, write_toml


def rotated(points: Array, angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    turned: Array = points @ np.array([[c, s], [-s, c]])
    return turned


# --- polygons ------------------------------------------------------------------------------------------------


@given(
    width=st.floats(0.05, 5),
    height=st.floats(0.05, 5),
    angle=st.floats(-3, 3),
    x=st.floats(-100, 100),
    y=st.floats(-100, 100),
)
def test_area_moments_of_a_rectangle_at_any_position_and_rotation(
    width: float, height: float, angle: float, x: float, y: float
) -> None:
    """A = b h, J = b h (b² + h²) / 12 about the centre, for any position and rotation."""
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]])
    blocks = Blocks.from_polygons([rotated(corners, angle) + [x, y]])
    centre = rotated(np.array([[width / 2, height / 2]]), angle) + [x, y]
    assert blocks.area[0] == pytest.approx(width * height, rel=1e-9)
    assert blocks.centroid[0] == pytest.approx(centre[0], rel=1e-9, abs=1e-9)
    assert blocks.polar_moment[0] == pytest.approx(width * height * (width**2 + height**2) / 12, rel=1e-8)


def test_area_moments_of_a_triangle() -> None:
    """Right triangle with legs 3 and 2: J = b h (b² + h²) / 36 about its centroid at a third of the legs."""
    blocks = Blocks.from_polygons([np.array([[0.0, 0], [3, 0], [0, 2]])])
    assert blocks.area[0] == pytest.approx(3)
    assert blocks.centroid[0] == pytest.approx([1, 2 / 3])
    assert blocks.polar_moment[0] == pytest.approx(3 * 2 * (9 + 4) / 36)


@pytest.mark.parametrize(
    ("corners", "fault"),
    [
        ([[0, 0], [1, 0], [2, 0]], "encloses no area"),
        ([[0, 0], [0, 1], [1, 1], [1, 0]], "encloses no area"),  # clockwise
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "encloses no area"),  # crossing itself
    ],
)
def test_degenerate_polygons_are_refused(corners: list[list[float]], fault: str) -> None:
    with pytest.raises(SceneError, match=fault):
        Blocks.from_polygons([np.array(corners, dtype=float)]).check()


def test_self_crossing_polygon_without_right_turns_is_refused() -> None:
    angle = 2 * np.pi * 2 * np.arange(5) / 5
    with pytest.raises(SceneError, match="crosses or touches itself"):
        Blocks.from_polygons([np.column_stack([np.cos(angle), np.sin(angle)])]).check()


# --- joints --------------------------------------------------------------------------------------------------


def test_joints_of_running_bond() -> None:
    """6 × 12 panel, flush: 6.5 blocks a course on average; every block meets two above and two below."""
    scene = panel()
    assert scene.wall.sum() == 6 * 6 + 6 * 7
    joints, blocks = scene.joints, scene.blocks
    upright = np.abs(np.diff(joints.ends[:, :, 0], axis=1))[:, 0] < 1e-12
    base = (joints.block == len(blocks) - 1).any(axis=1)
    assert upright.sum() == 6 * 5 + 6 * 6
    assert base.sum() == 6
    assert joints.length[upright] == pytest.approx(0.06)
    assert joints.length[base] == pytest.approx(0.24)
    beds = ~upright & ~base
    assert beds.sum() == 11 * 12
    assert joints.length[beds] == pytest.approx(0.12)


@given(
    st.lists(st.lists(st.sampled_from([0.5, 1.0, -0.5, -1.0]), min_size=1, max_size=6), min_size=1, max_size=6),
    st.floats(-3, 3),
)
@settings(max_examples=60)
def test_joints_are_the_shared_edges_for_any_pattern_and_rotation(pattern: list[list[float]], angle: float) -> None:
    """Total joint length equals the shared perimeter counted cell by cell on the half-block lattice."""
    solid = [[w for w in course if w > 0] for course in pattern]
    if not all(solid):
        return
    cells: dict[tuple[int, int], int] = {}
    number = 0
    for row, course in enumerate(pattern):
        column = 0
        for width in course:
            span = round(2 * abs(width))
            if width > 0:
                cells |= {(column + i, row): number for i in range(span)}
                number += 1
            column += span
    bed = sum(0.5 for (x, y) in cells if (x, y + 1) in cells)
    head = sum(1.0 for (x, y), block in cells.items() if cells.get((x + 1, y), block) != block)
    polygons = rectangles(pattern_rows(pattern), 1.0, np.arange(len(pattern) + 1.0))
    joints = find_joints(Blocks.from_polygons([rotated(p, angle) for p in polygons]))
    assert joints.length.sum() == pytest.approx(bed + head, abs=1e-9)


def test_joint_normal_points_from_its_first_to_its_second_block() -> None:
    """A joint runs along block a's boundary, so its normal, the tangent turned by −90°, points to block b."""
    for scene in (panel(), courses([[1, 1], [0.5, 1, 0.5]])):
        a, b = scene.joints.block.T
        run = scene.joints.ends[:, 1] - scene.joints.ends[:, 0]
        across = scene.blocks.centroid[b] - scene.blocks.centroid[a]
        assert (run[:, 1] * across[:, 0] - run[:, 0] * across[:, 1] > 0).all()


def test_inclined_edges_and_t_junctions_are_found() -> None:
    """Two voussoir-like blocks on one wide block: an inclined joint of length √2 and two bed joints of 1."""
    wide = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]])
    left = np.array([[0.0, 1], [1, 1], [2, 2], [0, 2]])
    right = np.array([[1.0, 1], [2, 1], [3, 1], [3, 2], [2, 2]])
    joints = find_joints(Blocks.from_polygons([wide, left, right]))
    assert sorted(joints.length.tolist()) == pytest.approx([1, 1, math.sqrt(2)])


@pytest.mark.parametrize("shift", [0.0, 1e-7, 5e-6])
def test_blocks_that_almost_touch_are_in_contact(shift: float) -> None:
    block = np.array([[0.0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]])
    assert len(find_joints(Blocks.from_polygons([block, block + [0, 0.1 + shift]]))) == 1


def test_blocks_farther_apart_than_the_tolerance_are_not_in_contact() -> None:
    block = np.array([[0.0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]])
    assert len(find_joints(Blocks.from_polygons([block, block + [0, 0.1 + 1e-4]]))) == 0


def test_corner_contact_is_no_joint() -> None:
    block = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    assert len(find_joints(Blocks.from_polygons([block, block + [1, 1]]))) == 0


@pytest.mark.parametrize("move", [[0.0, 0.0], [0.1, 0.05], [0.1, 0.0], [0.15, 0.07], [0.0, 0.099]])
def test_overlapping_blocks_are_refused(move: list[float]) -> None:
    block = np.array([[0.0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]])
    with pytest.raises(SceneError, match="overlaps"):
        find_joints(Blocks.from_polygons([block, block + move]))


def test_blocks_of_very_different_size_share_a_joint() -> None:
    """A block on another one a hundred times as large."""
    large = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    small = np.array([[5.0, 10], [5.1, 10], [5.1, 10.1], [5, 10.1]])
    assert find_joints(Blocks.from_polygons([large, small])).length == pytest.approx([0.1])


# --- generators ----------------------------------------------------------------------------------------------


@given(
    n=st.integers(1, 12), courses=st.integers(1, 8), first=st.sampled_from(["full", "half"]), width=st.floats(0.01, 3)
)
def test_flush_running_bond_fills_its_rectangle(n: int, courses: int, first: str, width: float) -> None:
    bond = Bond(width, 0.3 * width)
    starts: Literal["full", "half"] = "full" if first == "full" else "half"
    rows = bonded_rows(width, n * width / 2, bond.courses_in(courses * bond.height), starts)
    blocks = Blocks.from_polygons(rectangles(rows, width, bond.levels(courses)))
    assert blocks.area.sum() == pytest.approx(n * width / 2 * courses * bond.height)
    low, high = blocks.extent()
    assert high - low == pytest.approx([n * width / 2, courses * bond.height])


def test_toothed_ends_leave_the_half_blocks_out() -> None:
    assert panel(wall__ends="toothed").wall.sum() == 6 * 6 + 6 * 5


def test_half_first_course_equals_the_wall_without_its_lowest_course() -> None:
    full = panel(wall__height=0.78).blocks
    half = panel(wall__first_course="half").blocks
    upper = full.centroid[: full.first.size - 2][full.centroid[:-1, 1] > 0.06]
    assert np.allclose(upper - [0, 0.06], half.centroid[:-1])


# --- supports and loads --------------------------------------------------------------------------------------


def test_fixed_first_course_holds_it_and_drops_its_joints() -> None:
    scene = panel(support__kind="fixed-first-course")
    assert scene.fixed.sum() == 6
    assert not scene.fixed[scene.joints.block].all(axis=1).any()


@pytest.mark.parametrize(("kind", "held"), [("corners", 3), ("pinned-corners", 4)])
def test_corners_hold_the_first_course_at_its_ends(kind: str, held: int) -> None:
    pins = panel(support__kind=kind).pins
    assert len(pins) == held
    assert set(map(tuple, pins.point.tolist())) == {(0.0, 0.0), (1.44, 0.0)}


@pytest.mark.parametrize("higher", [0, 1])
def test_corner_supports_ignore_rounding_in_the_first_course(higher: int) -> None:
    """Its two blocks differ in level by a millionth of a millimetre; both ends must be held, not those of one block."""
    off = 1e-9 * np.eye(2)[higher]
    outlines = [np.array([[x, y], [x + 0.4, y], [x + 0.4, 0.2], [x, 0.2]]) for x, y in ((0.0, off[0]), (0.4, off[1]))]
    scene = build_scene(
        "uneven",
        outlines,
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.6),
        load=Load(live=(Lateral(),)),
        support="pinned-corners",
    )
    assert scene.pins.point == pytest.approx(np.array([[0.0, off[0]], [0.0, off[0]], [0.8, off[1]], [0.8, off[1]]]))


def test_beam_lies_on_the_level_part_of_the_top() -> None:
    """A stone with a chamfered shoulder carries it on its level top only."""
    stone = Blocks.from_polygons([np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.2], [0.7, 0.5], [0.0, 0.5]])])
    assert Beam(height=0.1).outline(stone).tolist() == [[0.0, 0.5], [0.7, 0.5], [0.7, 0.6], [0.0, 0.6]]


def test_point_load_is_shared_by_the_blocks_it_touches() -> None:
    live = {"kind": "point", "at": [0.72, 0.72], "force": [0, -1]}
    scene = panel(wall__first_course="half", load__live=live)
    assert isinstance(scene.load.live[0], PointLoad)
    assert scene.live_forces.force.tolist() == [[0, -0.5], [0, -0.5]]
    assert panel(load__live=live).live_forces.force.tolist() == [[0, -1]]


# --- the file ------------------------------------------------------------------------------------------------


def test_a_file_and_its_tables_give_the_same_scene(tmp_path: Path) -> None:
    tables = content(joint__mortar={"young": 1e9, "poisson": 0.2, "thickness": 0.01})
    read, built = read_scene(write_toml(tables, tmp_path / "wall.toml")), scene_from_dict(tables)
    assert read.title == built.title == "panel"
    assert np.array_equal(read.blocks.vertices, built.blocks.vertices)
    assert read.joint == built.joint
    assert read.load == built.load


def test_friction_angle_is_in_degrees() -> None:
    assert panel(joint={"friction_angle": 45}).joint.friction == pytest.approx(1)


def test_tensile_strength_is_the_apex_unless_given() -> None:
    assert panel(joint__cohesion=1e5).joint.tension == pytest.approx(1e5 / 0.6)
    assert panel(joint__cohesion=1e5, joint__tensile_strength=3e4).joint.tension == 3e4


INVALID_OBJECTS: list[tuple[Callable[[], Any], str]] = [
    (lambda: BlockMaterial(-1.0), "block.density = -1.0: must be a number above 0"),
    (lambda: BlockMaterial(1e200), "block.density = 1e+200: must be a number above 0, of a size from 1e-100 to 1e+100"),
    (lambda: BlockMaterial(1.0, math.inf), "block.young = inf: must be a number above 0"),
    (lambda: BlockMaterial(1.0, 1.0, 0.6), "block.poisson = 0.6: must be a number above -1 and at most 0.5"),
    (lambda: JointMaterial(math.nan), "joint.friction = nan: must be a number at least 0"),
    (lambda: JointMaterial(1e-9), "joint.friction = 1e-09: must be 0, for joints without friction"),
    (lambda: JointMaterial(True), "joint.friction = True: must be a number"),
    (lambda: JointMaterial(0.6, cohesion=-1.0), "joint.cohesion = -1.0"),
    (lambda: JointMaterial(0.6, 1e5, 2e5), "joint.tensile_strength = 200000.0: must be at most cohesion / friction"),
    (lambda: JointMaterial(0.0, 1e5), "joint.tensile_strength: is missing; with friction 0"),
    (lambda: JointMaterial(0.6, fracture_energy_2=1.0), "joint.fracture_energy_1: is missing"),
    (lambda: JointMaterial(0.6, inset=-1.0), "joint.inset = -1.0"),
    (lambda: Mortar(1e9, 0.5, 0.01), "joint.mortar.poisson = 0.5: must be a number at least 0 and below 0.5"),
    (lambda: Stiffness(0.0, 1.0), "joint.normal_stiffness = 0.0: must be a number above 0"),
    (lambda: replace(panel().joint, friction=-1), "joint.friction = -1"),
    (lambda: replace(panel(), thickness=0), "wall.thickness = 0: must be a number above 0"),
    (lambda: Bond(0.24, -0.06), "wall.block_height = -0.06"),
    (lambda: bonded_rows(0.24, 1.44, 12, ends="open"), "wall.ends = 'open'"),  # type: ignore[arg-type]
    (lambda: Lateral((math.nan, 0.0)), "load.live.direction = (nan, 0.0): must be a pair of finite numbers"),
    (lambda: PointLoad((0.0, 0.0), (0.0, 0.0)), "load.live.force = [0.0, 0.0]: must not be zero"),
]


@pytest.mark.parametrize(("made", "said"), INVALID_OBJECTS)
def test_python_refuses_invalid_values_as_files_do(made: Callable[[], Any], said: str) -> None:
    with pytest.raises(SceneError) as refused:
        made()
    assert said in str(refused.value)
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)


def test_joint_material_is_the_same_in_python_and_in_a_file() -> None:
    assert JointMaterial(0.6, cohesion=1e5) == panel(joint__cohesion=1e5).joint
    assert JointMaterial(0.6, cohesion=1e5).tension == pytest.approx(1e5 / 0.6)


def test_default_tensile_strength_follows_friction_but_a_given_one_does_not() -> None:
    given = JointMaterial(0.6, 1e5, tensile_strength=1e5)
    assert replace(JointMaterial(0.6, 1e5), friction=0.8).tension == pytest.approx(1e5 / 0.8)
    assert replace(given, friction=0.8).tension == 1e5
    with pytest.raises(SceneError, match=r"joint\.tensile_strength = 100000\.0: must be at most"):
        replace(given, friction=1.2)


def test_a_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    path = write_toml(content(), tmp_path / "wall.toml")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert read_scene(path).wall.sum() == 78


def test_title_defaults_to_the_file_name(tmp_path: Path) -> None:
    assert read_scene(write_toml(content(title=None), tmp_path / "tower.toml")).title == "tower"


def drawing(path: Path, outlines: list[list[tuple[float, float]]], *, close: bool = True) -> Path:
    document = ezdxf.new()  # type: ignore[attr-defined]
    for outline in outlines:
        document.modelspace().add_lwpolyline(outline, close=close)
    document.saveas(path)
    return path


GROUND = [(-500.0, -50.0), (700.0, -50.0), (700.0, 0.0), (-500.0, 0.0)]


def test_a_drawing_is_read_in_its_units_with_the_lowest_outline_as_ground(tmp_path: Path) -> None:
    """Clockwise outlines are reversed, corners in the middle of a straight side are removed."""
    lower = [(0.0, 0.0), (0.0, 100.0), (200.0, 100.0), (200.0, 0.0), (90.0, 0.0)]
    upper = [(0.0, 100.0), (200.0, 100.0), (200.0, 200.0), (0.0, 200.0)]
    drawing(tmp_path / "wall.dxf", [upper, GROUND, lower])
    wall = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    scene = read_scene(write_toml(content(wall=wall), tmp_path / "wall.toml"))
    assert scene.wall.tolist() == [True, True, False]
    assert scene.fixed.tolist() == [False, False, True]
    assert scene.joints.length == pytest.approx([0.2, 0.2])
    assert scene.blocks.area[:2] == pytest.approx([0.02, 0.02])


def test_mirrored_outline_keeps_its_position(tmp_path: Path) -> None:
    """CAD programs mirror a polyline by turning its axes (extrusion); the corners in the world stay."""
    plain, turned = tmp_path / "plain.dxf", tmp_path / "turned.dxf"
    outline = [(0.0, 0.0), (200.0, 0.0), (200.0, 100.0), (0.0, 100.0)]
    drawing(plain, [GROUND, outline])
    document = ezdxf.new()  # type: ignore[attr-defined]
    document.modelspace().add_lwpolyline(GROUND, close=True)
    mirrored = document.modelspace().add_lwpolyline([(-x, y) for x, y in outline], close=True)
    mirrored.dxf.extrusion = (0, 0, -1)
    document.saveas(turned)
    scenes = []
    for path in (plain, turned):
        wall = {"drawing": path.name, "units": "mm", "thickness": 0.12}
        scenes.append(read_scene(write_toml(content(wall=wall), tmp_path / "wall.toml")))
    assert scenes[0].blocks.extent(0)[0] == pytest.approx(scenes[1].blocks.extent(0)[0])
    assert scenes[0].joints.length == pytest.approx(scenes[1].joints.length)


@pytest.mark.parametrize(
    ("outlines", "close", "fault"),
    [
        ([GROUND], True, "needs the ground and at least one block"),
        ([GROUND, [(0.0, 0.0), (200.0, 0.0), (200.0, 100.0)]], False, "is open"),
        ([GROUND, [(0.0, 0.0), (200.0, 100.0), (200.0, 0.0), (0.0, 100.0)]], True, "crosses itself"),
        ([GROUND, [(0.0, 5.0), (200.0, 5.0), (200.0, 100.0), (0.0, 100.0)]], True, "floating"),
    ],
)
def test_invalid_drawings_are_refused(
    tmp_path: Path, outlines: list[list[tuple[float, float]]], close: bool, fault: str
) -> None:
    drawing(tmp_path / "wall.dxf", outlines, close=close)
    wall = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    with pytest.raises(SceneError, match=fault):
        read_scene(write_toml(content(wall=wall), tmp_path / "wall.toml"))


def read_drawn(folder: Path) -> None:
    wall = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    read_scene(write_toml(content(wall=wall), folder / "wall.toml"))


@pytest.mark.parametrize("binary", [True, False])
def test_truncated_drawing_is_refused(tmp_path: Path, binary: bool) -> None:
    document = ezdxf.new()  # type: ignore[attr-defined]
    for outline in (GROUND, [(0.0, 0.0), (200.0, 0.0), (200.0, 100.0), (0.0, 100.0)]):
        document.modelspace().add_lwpolyline(outline, close=True)
    document.saveas(tmp_path / "wall.dxf", fmt="bin" if binary else "asc")
    read_drawn(tmp_path)
    full = (tmp_path / "wall.dxf").read_bytes()
    for share in (0.0, 0.001, 0.2, 0.5, 0.9, 0.99):
        (tmp_path / "wall.dxf").write_bytes(full[: int(share * len(full))])
        with pytest.raises(SceneError, match=r"wall\.drawing") as refused:
            read_drawn(tmp_path)
        assert "\n" not in str(refused.value)


def test_drawing_must_be_a_regular_file(tmp_path: Path) -> None:
    made: list[Callable[[Path], Any]] = [os.mkfifo, Path.mkdir, lambda path: path.symlink_to("/dev/zero")]
    for make in made:
        make(tmp_path / "wall.dxf")
        with pytest.raises(SceneError, match="it is not a regular file"):
            read_drawn(tmp_path)
        (tmp_path / "wall.dxf").rename(tmp_path / f"was {made.index(make)}")


@pytest.mark.parametrize("last", [0.1, 0.1001, 0.15])
def test_narrow_blocks_are_not_split_for_any_course_heights(last: float) -> None:
    """Blocks of at most 3/4 of the nominal width get no inner joint, in courses of equal or unequal height."""
    wall = {"block_width": 0.2, "thickness": 0.1, "courses": [[1, 1], [0.5, 1, 0.5], [0.75, 1, 0.25]]}
    table = content(inner_joint={"friction": 0.6, "cohesion": 1e5})
    table["wall"] = wall | {"course_heights": [0.1, 0.1, last]}
    widths = np.ptp(scene_from_dict(table).blocks.boxes, axis=0)[:-1, 0]  # without the ground
    assert np.sort(widths / 0.2) == pytest.approx([0.25, *[0.5] * 10, 0.75])
