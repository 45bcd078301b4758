"""Warnings about likely input errors: each one on a faulty scene, and none on a similar correct scene."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.commands.command_line import command
from runningbond.commands.terminal import remarks
from runningbond.compare.published import PUBLISHED, published_scene
from runningbond.scene import BlockMaterial, History, JointMaterial, Load, Scene, build_scene
from runningbond.scene.plausibility import warnings
from runningbond.studies.accuracy.walls import all_walls
from runningbond.studies.walls import KNOWN, known_scene

from ..models.test_corners import LEANING, block
from ..walls import content, courses, panel, write_toml

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
FIRST = {"assign": [{"block": "oak", "blocks": [0]}]}
OAK = {"materials": {"oak": {"density": 700.0}}} | FIRST


def test_published_walls_have_no_warnings() -> None:
    assert {case.name: warnings(published_scene(case.name)) for case in PUBLISHED} == {
        case.name: () for case in PUBLISHED
    }


def test_walls_of_the_studies_have_no_warnings() -> None:
    scenes = {name: wall.scene for name, wall in all_walls().items()} | {name: known_scene(name) for name in KNOWN}
    assert {name: warnings(scene) for name, scene in scenes.items()} == dict.fromkeys(scenes, ())


def joint(**keys: Any) -> dict[str, Any]:
    return {"joint": {"friction": 0.6, "cohesion": 2e5, "mortar": MORTAR} | keys}


def stiff(**keys: Any) -> dict[str, Any]:
    return {"joint": {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9} | keys}


def tie(young: float, area: float = 1e-4, most: float = 2e4, to: float = 1.4) -> dict[str, Any]:
    return {"tie": [{"from": [0.1, 0.7], "to": [to, 0.7], "area": area, "young": young, "yield": most}]}


def beam(height: float, moves: float | None = None) -> dict[str, Any]:
    drive = {} if moves is None else {"drive": {"displacement": [moves, 0.0]}}
    return {"beam": {"height": height, "force": [0.0, -1e3], **drive}} | ({"load__live": None} if drive else {})


def pressed(force: float, dead: float = 0.0) -> dict[str, Any]:
    """A panel of 2.2 kN under a beam's force, and under a line load on 1.44 m."""
    line = {"kind": "line", "from": [0.0, 0.72], "to": [1.44, 0.72], "force": [0.0, -dead]}
    beams = {"beam": {"height": 0.2, "force": [0.0, -force]}} if force else {}
    return beams | ({"load__dead": [line]} if dead else {})


def glued(stone: float) -> dict[str, Any]:
    """Joints with a tensile strength of 0.2 MPa, and that of the stones beside them [Pa]."""
    inner = {"friction": 0.6, "cohesion": 6e5, "tensile_strength": stone, "mortar": MORTAR}
    return joint(tensile_strength=2e5) | {"inner_joint": inner}


def settles(by: float, path: list[float] | None = None) -> dict[str, Any]:
    live = {"kind": "settlement", "box": [[0.0, -1.0], [0.72, 0.1]], "by": [0.0, -by]}
    return {"load__live": live if path is None else live | {"path": path}}


def scaled(size: float, thickness: float = 0.12) -> dict[str, Any]:
    sizes = {"length": 1.44, "height": 0.72, "block_width": 0.24, "block_height": 0.06}
    return {"wall": {key: size * value for key, value in sizes.items()} | {"thickness": thickness}}


@pytest.mark.parametrize(
    ("odd", "says", "near"),
    [
        ({"block__density": 18.0}, "block.density = 18: * is 18 kN/m³ meant, which is 1835 kg/m³?", 250.0),
        ({"block__density": 1.8}, "block.density = 1.8: * is 1.8 t/m³ meant, which is 1800 kg/m³?", 7800.0),
        ({"block__density": 18000.0}, "block.density = 18000: is not within 200 … 8000 kg/m³", 2700.0),
        ({"block__young": 5.0}, "block.young = 5: * is 5 GPa meant", 5e9),
        ({"block__young": 5000.0}, "block.young = 5000: * is 5000 MPa meant", 5e7),
        ({"joint__friction": 30.0}, "joint.friction = 30: * is friction_angle = 30 meant, tan φ = 0.577?", 1.5),
        ({"joint__friction": 1.6}, "joint.friction = 1.6: is tan φ, and above 1.5", 1.4),
        ({"joint__friction": 0.01}, "joint.friction = 0.01: is tan φ, and below 0.1; an angle is friction_angle", 0.0),
        ({"joint__friction": 0.009425}, "joint.friction = 0.009425: * is 30.9 meant, which is 0.54 in radians?", 0.0),
        (joint(mortar=MORTAR | {"young": 1.0}), "joint.mortar.young = 1: * is 1 GPa meant", joint()),
        (joint(mortar=MORTAR | {"thickness": 10}), "joint.mortar.thickness = 10: * is 10 mm meant", joint()),
        (joint(cohesion=0.2), "joint.cohesion = 0.2: * is 0.2 MPa meant, which is 2e+05 Pa?", joint(cohesion=200.0)),
        (joint(cohesion=2e8, tensile_strength=1e5), "joint.cohesion = 2e+08: is not within", joint(cohesion=9e7)),
        (joint(tensile_strength=0.1), "joint.tensile_strength = 0.1: * is 0.1 MPa", joint(tensile_strength=1e5)),
        (joint(fracture_energy_1=0.02), "joint.fracture_energy_1 = 0.02: * 0.02 N/mm", joint(fracture_energy_1=20.0)),
        (stiff(normal_stiffness=10.0), "joint.normal_stiffness = 10: * is 10 N/mm³ meant", stiff()),
        (stiff(shear_stiffness=4.0), "joint.shear_stiffness = 4: * is 4 N/mm³ meant", stiff(shear_stiffness=4e6)),
        (glued(1.9e5), "joint: its tensile strength of 2e+05 Pa is above * fem with cracks", glued(2e5)),
        ({"load__gravity": 981.0}, "load.gravity = 981: is not within 9.3 … 10.3 m/s²", 10.0),
        (
            glued(2e5) | {"materials": {"oak": {"density": 700.0}}} | FIRST,
            "materials.oak: its blocks, also lintels, may crack like all others, with the strength of inner_joint",
            OAK,
        ),
        (scaled(1e3, 120.0), "wall.length = 1440: * is 1440 mm meant, which is 1.44 m?", scaled(10.0, 1.0)),
        (scaled(0.01, 0.001), "wall.length = 0.0144: is not within 0.05 … 200 m", scaled(0.1, 0.012)),
        ({"wall__thickness": 120.0}, "wall.thickness = 120: is odd for blocks of about 0.12 m; are 120 mm meant?", 3.0),
        ({"wall__thickness": 1e-3}, "wall.thickness = 0.001: is odd for blocks", 0.01),
        ({"materials": {"oak": {"density": 7.0}}} | FIRST, "materials.oak.density = 7: * is 7 kN/m³ meant", OAK),
        (tie(210.0), "tie[0].young = 210: * is 210 GPa meant", tie(2.1e11)),
        (tie(2.1e11, area=314.0), "tie[0].area = 314: * is 314 mm² meant, which is 0.000314 m²?", tie(2.1e11)),
        (tie(2.1e11, most=2.35e8), "tie[0].yield = 2.35e+08: is a force * is a stress meant?", tie(2.1e11, most=3e5)),
        (tie(2.1e11, most=30.0), "tie[0].yield = 30: is only * are 30 kN meant?", tie(2.1e11, most=3e4)),
        (tie(2.1e11, to=1.45), "tie[0].to = [1.45, 0.7]: is an anchor * 0.01 m beside the wall", tie(2.1e11, to=2.0)),
        (beam(250.0), "beam.height = 250: is more than the wall's size, 1.44 m; are mm meant?", beam(0.25)),
        (beam(0.2, 10.0), "beam.drive.displacement = 10: is more than", beam(0.2, 0.01)),
        (pressed(30.0), "beam.force: 30 N * 1.4% of the wall's weight; are kN meant?", pressed(3e4)),
        (pressed(0.0, 20.0), "load.dead: 28.8 N * are kN meant?", pressed(0.0, 2e4)),
        (settles(2.0), "load.live.by = 2: moves a support by more than a tenth", settles(0.02)),
        (
            settles(0.01, [1.0, -100.0, 0.0]),
            "load.live.by, largest along path = 1: moves a support by more than a tenth",
            settles(1.0, [0.01, -0.02]),
        ),
    ],
)
def test_values_in_a_wrong_unit_are_warned_about(odd: dict[str, Any], says: str, near: Any) -> None:
    """The warning names the key, the value and what may be meant; the plausible value `near` has no warning."""
    near = near if isinstance(near, dict) else dict.fromkeys(odd, near)
    first, _, second = says.partition(" * ")
    (line,) = warnings(panel(**odd))
    assert line.startswith(first)
    assert second in line
    assert "\n" not in line
    assert warnings(panel(**near)) == ()


def test_corners_without_strength_repeat_no_warning() -> None:
    assert len(warnings(block(LEANING, friction=0.05, cohesion=1e4).scene)) == 1


def test_zero_gravity_has_no_warning() -> None:
    live = {"kind": "point", "at": [1.44, 0.72], "force": [1.0, 0.0]}
    assert warnings(panel(load={"gravity": 0.0, "live": live})) == ()


@pytest.mark.parametrize(
    ("pattern", "says"),
    [
        ([[1, 1, 1], [1, 1], [1, 1, 1]], ["on the right", "x = 0.8 m"]),
        ([[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1], [0.5, 1, 0.5]], ["y = 0.6125 m", "x = 0.8 m"]),
        ([[1, 1, 1], [-1, 1, 1], [1, 1, 1]], ["on the left", "x = 0.4 m"]),
        ([[1, 1, 1], [-0.5, 1, 1], [1, 1, 1]], []),  # toothed
        ([[1, 1, 1, 1, 1], [-1, 1, 1, 1], [-2, 1]], []),  # a gable
        ([[1, 1, 1], [0.5, 1, 1], [1, 1], [0.5, 1, 0.5], [1, 1, 1]], []),  # an opening at the side
        ([[1, -1, 1], [0.5, 2, 0.5]], []),  # two courses say nothing
        ([[1], [1], [1]], []),
    ],
)
def test_course_that_is_too_short_is_warned_about(pattern: list[list[float]], says: list[str]) -> None:
    lines = warnings(courses(pattern, joint={"friction": 0.6}))
    assert len(lines) == bool(says)
    for words in says:
        assert words in lines[0]
        assert "more than half a block short" in lines[0]


def boxes(*places: tuple[float, float, float, float]) -> Scene:
    outlines = [np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]]) for x, y, w, h in places]
    brick, dry = BlockMaterial(1800.0), JointMaterial(0.6)
    return build_scene("boxes", outlines, thickness=0.12, load=Load(), block=brick, joint=dry)


@pytest.mark.parametrize(("drop", "is_odd"), [(0.002, True), (0.0, False), (0.05, False)])
def test_misaligned_courses_are_warned_about(drop: float, is_odd: bool) -> None:
    """A block 2 mm lower than its neighbours is an error; one 5 cm lower belongs to another course."""
    low = [(0.2, 0.0, 0.2, 0.1 - drop)]
    first = [(0.0, 0.0, 0.2, 0.1), (0.4, 0.0, 0.2, 0.1), (0.6, 0.0, 0.2, 0.1)]
    second = [(x, 0.1 - (drop if x == 0.2 else 0.0), 0.2, 0.1) for x in (0.0, 0.2, 0.4, 0.6)]
    lines = warnings(boxes(*low, *first, *second))
    assert [line.startswith("wall: courses do not line up") for line in lines] == [True] * is_odd
    if is_odd:
        assert "y = 0.098 and 0.1 m, 2 mm apart" in lines[0]


def test_stones_cut_by_an_arch_are_no_misaligned_course() -> None:
    """The lowest corner of a stone above an arch lies 2 mm below its bed, where the arch cuts it."""
    course = [(x, y, 0.2, 0.1) for y in (0.0, 0.1) for x in (0.0, 0.4, 0.6, 0.8)]
    cut = [[(0.2, 0.0), (0.4, 0.0), (0.4, 0.1), (0.3, 0.098), (0.2, 0.1)]]
    cut += [[(0.2, 0.1), (0.3, 0.098), (0.4, 0.1), (0.4, 0.2), (0.2, 0.2)]]
    corners = [np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]]) for x, y, w, h in course]
    corners += [np.array(stone) for stone in cut]
    brick, dry = BlockMaterial(1800.0), JointMaterial(0.6)
    assert warnings(build_scene("arch", corners, thickness=0.12, load=Load(), block=brick, joint=dry)) == ()


@pytest.mark.parametrize(("gap", "is_odd"), [(0.002, True), (0.0, False), (0.08, False)])
def test_open_head_joints_are_warned_about(gap: float, is_odd: bool) -> None:
    """Head joints drawn 2 mm open; none for touching blocks (gap 0) and separate piers (gap 80 mm)."""
    piers = [(x, y, 0.2, 0.1) for y in (0.0, 0.1) for x in (0.0, 0.2 + gap, 0.4 + 2 * gap)]
    lines = warnings(boxes(*piers))
    assert [line.startswith("wall: no head joint") for line in lines] == [True] * is_odd
    assert all("2 mm apart" in line for line in lines)


def test_drawing_in_millimetres_read_as_metres_is_warned_about() -> None:
    (size, thick) = warnings(boxes(*((240.0 * k, 0.0, 240.0, 60.0) for k in range(6))))
    assert size.startswith("wall: length = 1440: ")
    assert "is 1440 mm meant" in size
    assert thick.startswith("wall.thickness = 0.12: is odd")


@pytest.fixture
def odd(tmp_path: Path) -> str:
    return str(write_toml(content(block__density=18.0), tmp_path / "odd.toml"))


@pytest.mark.parametrize(
    "line", ["run {} --model limit --json", "run {} --model limit", "compare {} --models limit --jobs 1 --out {}-out"]
)
def test_commands_warn_on_standard_error(line: str, odd: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command([word.format(odd) if word.startswith("{}") else word for word in line.split()]) == 0
    out, err = capsys.readouterr()
    assert "kN/m³" not in out
    (said,) = [row for row in err.splitlines() if row.startswith("warning: ")]
    assert "block.density = 18" in said


def test_show_warns_below_its_table(odd: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["show", odd]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1].startswith("warning: block.density = 18: is not within")


def test_show_has_no_warning_for_a_plain_wall(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["show", "panel-01"]) == 0
    assert "warning" not in capsys.readouterr().out


def test_remarks_are_notes_followed_by_warnings() -> None:
    scene = replace(panel(block__density=18.0), notes=("2 gaps of up to 0.1 mm closed",))
    assert remarks(scene) == ("note: 2 gaps of up to 0.1 mm closed", *(f"warning: {x}" for x in warnings(scene)))


@pytest.mark.parametrize(
    ("step", "peak", "says"),
    [
        (0.01, 300.0, "load.history, peak acceleration = 300: * are its values in cm/s², which makes it 3 m/s²?"),
        (0.01, 1e-3, "load.history, peak acceleration = 0.001: is not within 0.01 … 50 m/s²"),
        (10.0, 3.0, "load.history, time step = 10: * is 10 ms meant, which is 0.01 s?"),
        (0.01, 3.0, ""),
    ],
)
def test_records_in_a_wrong_unit_are_warned_about(step: float, peak: float, says: str) -> None:
    history = History(step * np.arange(9.0), peak * np.column_stack([np.sin(np.arange(9.0) * np.pi / 2), np.zeros(9)]))
    found = warnings(replace(panel(), load=Load(live=(history,))))
    assert len(found) == bool(says)
    assert all(part in "".join(found) for part in says.split(" * "))


@pytest.mark.parametrize(
    ("quantity", "factor", "says"),
    [
        ("g", 100.0, "are its values in cm/s², which makes it 1 m/s²?"),
        ("g", 6.0, "are its values in m/s², which makes it 6 m/s²?"),
        ("velocity", 100.0, "are its values in cm/s, which makes it "),
        ("displacement", 1e3, "are its values in mm, which makes it "),
    ],
)
def test_hint_on_the_unit_of_a_record_follows_its_quantity(quantity: Any, factor: float, says: str) -> None:
    """Displacements in mm were asked about as accelerations of thousands of cm/s²; the record itself is plausible."""
    time = 0.05 * np.arange(41.0)
    shape = np.column_stack([np.sin(2 * np.pi * time), np.zeros(41)])
    amplitude = {"g": 1.0, "velocity": 0.2, "displacement": 0.05}[quantity]
    plain, odd = (History(time, scale * amplitude * shape, quantity) for scale in (1.0, factor))
    assert warnings(replace(panel(), load=Load(live=(plain,)))) == ()
    (line,) = warnings(replace(panel(), load=Load(live=(odd,))))
    assert says in line


def test_show_prints_the_ground_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shaken = {"pulse": {"kind": "sine", "amplitude": 0.3, "period": 0.5}, "quantity": "g"}
    path = write_toml(content(load__live=None, load__history=shaken), tmp_path / "wall.toml")
    assert command(["show", str(path)]) == 0
    printed = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "sine, 0.5 s, the ground is accelerated by up to 0.3 g" in printed
    assert "warning" not in printed


def test_tie_that_ends_in_an_opening_is_warned_about() -> None:
    """0.5 m from the jambs, more than the block size; at that distance beside the wall it is an anchor, no warning."""
    opening = {"from": [1.0, 0.0], "to": [2.0, 1.5], "lintel": {"height": 0.25, "bearing": 0.25}}
    said = {}
    for x in (1.5, -0.5):
        tie = {"from": [0.4, 1.6], "to": [x, 0.9], "area": 1e-4, "young": 2.1e11, "yield": 2e4}
        size = {"block_width": 0.5, "block_height": 0.25, "length": 3.0, "height": 2.0, "thickness": 0.4}
        said[x] = warnings(panel(wall=size | {"opening": [opening]}, tie=[tie]))
    assert said[-0.5] == ()
    assert len(said[1.5]) == 1
    assert said[1.5][0].startswith("tie[0].to = [1.5, 0.9]: is an anchor fixed in space, 0.5 m beside the wall")
