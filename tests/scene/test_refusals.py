"""Invalid input: one clear line on standard error, exit code 2, no files, nothing on standard output."""

import copy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from runningbond.commands.command_line import command
from runningbond.scene import Scene, SceneError, scene_from_dict
from runningbond.scene.schema import LISTED, PLAIN
from tests.walls import content, courses, panel, write_toml

from .test_scene import drawing

POINT = {"kind": "point", "at": [0.72, 0.72], "force": [0, -1]}
QUAKE = {"pulse": {"kind": "sine", "amplitude": 0.1, "period": 0.2}, "quantity": "g"}
FREE = {"wall__length": None, "wall__height": None}
DIRECT = {"joint__normal_stiffness": 1e10, "joint__shear_stiffness": 4e9}
CLOSURE = {"growth": 1e4, "stiffest": 1e11}
CRUSHING: list[tuple[dict[str, Any], str]] = [
    ({"joint__compressive_strength": 0}, "joint.compressive_strength = 0: must be a number above 0"),
    ({"joint__compressive_strength": -1e7}, "joint.compressive_strength = -10000000.0: must be a number above 0"),
    ({"joint__compressive_strength": "10 MPa"}, "joint.compressive_strength = '10 MPa': must be a number above 0"),
    ({"joint__compressive_strength": float("inf")}, "joint.compressive_strength = inf: must be a number above 0"),
    ({"joint__compresive_strength": 1e7}, 'did you mean "compressive_strength"?'),
    ({"joint__compressive_fracture_energy": 5e3}, "joint.compressive_strength: is missing; a joint that crushes"),
    ({"joint__peak_closure": 9e-5}, "joint.compressive_strength: is missing; a joint that crushes"),
    ({"joint__cap_shear": 3.0}, "joint.compressive_strength: is missing; a joint that crushes"),
    (
        {"joint__compressive_strength": 1e7, "joint__compressive_fracture_energy": 0},
        "joint.compressive_fracture_energy = 0: must be a number above 0",
    ),
    (
        {"joint__compressive_strength": 1e7, "joint__compressive_fracture_energy": [5e3]},
        "joint.compressive_fracture_energy = [5000.0]: must be a number",
    ),
    (
        {"joint__compressive_strength": 1e7, "joint__compressive_fracture_energy": 800, "joint__peak_closure": 1e-4},
        "joint.compressive_fracture_energy = 800.0: must be above 856.932, which is spent on the way to the peak",
    ),
    ({"joint__compressive_strength": 1e7, "joint__cap_shear": -9}, "joint.cap_shear = -9: must be a number at least 0"),
    ({"joint__compressive_strength": 1e7, "joint__cap_shear": True}, "joint.cap_shear = True: must be a number"),
    (
        {"joint__compressive_strength": 1e7, "joint__peak_closure": -1e-5},
        "joint.peak_closure = -1e-05: must be a number at least 0",
    ),
    ({"joint__closure": CLOSURE}, "joint.normal_stiffness: is missing; closure needs the stiffness without pressure"),
    (
        {"joint__closure": CLOSURE, "joint__mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
        "joint.normal_stiffness: is missing; closure needs the stiffness without pressure",
    ),
    ({**DIRECT, "joint__closure": 1e4}, "joint.closure = 10000.0: must be a table"),
    ({**DIRECT, "joint__closure": {"growth": 1e4}}, "joint.closure.stiffest: is missing"),
    ({**DIRECT, "joint__closure": {"stiffest": 1e11}}, "joint.closure.growth: is missing"),
    ({**DIRECT, "joint__closure": {**CLOSURE, "growth": 0}}, "joint.closure.growth = 0: must be a number above 0"),
    (
        {**DIRECT, "joint__closure": {**CLOSURE, "stiffest": 1e9}},
        "joint.closure.stiffest = 1000000000.0: must be at least normal_stiffness = 1e+10",
    ),
    (
        {**DIRECT, "joint__closure": {**CLOSURE, "stifest": 1e9}},
        'joint.closure.stifest = 1000000000.0: is not a key of [joint.closure]; did you mean "stiffest"?',
    ),
    (
        {"joints": {"soft": {"friction": 0.5, "compressive_strength": -1}}},
        "joints.soft.compressive_strength = -1: must be a number above 0",
    ),
    (
        {"joint__softening": "exponentail", "joint__fracture_energy_1": 10.0},
        'joint.softening = \'exponentail\': must be one of "linear", "exponential"; did you mean "exponential"?',
    ),
    ({"joint__softening": True}, 'joint.softening = True: must be one of "linear", "exponential"'),
    ({"joint__softening": "exponential"}, "joint.fracture_energy_1: is missing; a joint that softens needs one"),
    (
        {"joints": {"soft": {"friction": 0.5, "softening": 2}}},
        'joints.soft.softening = 2: must be one of "linear", "exponential"',
    ),
    (
        {"inner_joint": {"friction": 0.5, "softening": "exponential"}},
        "inner_joint.fracture_energy_1: is missing; a joint that softens needs one",
    ),
    (
        {"inner_joint": {"friction": 0.5, "compressive_fracture_energy": 1.0}},
        "inner_joint.compressive_strength: is missing; a joint that crushes needs a strength",
    ),
]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"wall__thicknes": 0.1}, 'wall.thicknes = 0.1: is not a key of [wall]; did you mean "thickness"?'),
        ({"color": "red"}, "color = 'red': is not a key of a scene file"),
        ({"load__live__angle": 3}, "load.live.angle = 3: is not a key of [load.live], which has kind, direction"),
        ({"wall__thickness": None}, "wall.thickness: is missing; it must be a number above 0"),
        (FREE, "wall: must say what its blocks are: by length and height, by courses, by outlines, or by a drawing"),
        ({"wall__length": None}, "wall.length: is missing"),
        ({"materials": {"": {"density": 700.0}}}, "materials.: must have a name, by which [[assign]] knows it"),
        ({"joints": {" ": {"friction": 0.7}}}, "joints. : must have a name, by which [[assign]] knows it"),
        ({"wall__ends": "FLUSH"}, 'must be one of "flush", "toothed"; did you mean "flush"?'),
        ({"block__density": None, "block__densty": 1}, "block.densty = 1: is not a key of [block]; did you mean"),
        ({"support": None}, "support: is missing"),
        ({"support": 3}, "support = 3: must be a table"),
        ({"joint__friction": -0.6}, "joint.friction = -0.6: must be a number at least 0"),
        ({"joint__friction": "rough"}, "joint.friction = 'rough': must be a number"),
        ({"joint__friction": True}, "joint.friction = True: must be a number"),
        (
            {"joint__friction": 1e-9},
            "joint.friction = 1e-09: must be 0, for joints without friction, or such that tan φ ≥ 1e-06",
        ),
        ({"joint__fracture_energy_2": 5.0}, "joint.fracture_energy_1: is missing"),
        *CRUSHING,
        ({"joint": {"friction_angle": 1e-9}}, "joint.friction_angle = 1e-09: must be 0"),
        (
            {"load__live": {"kind": "point", "at": [0.72, 0.72], "force": [1e-9, -1.0]}},
            "load.live.force = [1e-09, -1.0]: must have components that are 0 or at least 1e-06 of each other",
        ),
        ({"joint__friction": float("nan")}, "joint.friction = nan: must be a number"),
        ({"block__density": float("inf")}, "block.density = inf: must be a number"),
        ({"block__density": 10**400}, "block.density"),
        ({"wall__thickness": 0}, "wall.thickness = 0: must be a number above 0"),
        ({"wall__length": 1.5}, "wall.length = 1.5: must be a whole number of half blocks"),
        ({"wall__length": 1e9}, "wall.length = 1000000000.0"),
        ({"wall__height": 1e-9}, "wall.height = 1e-09: must be a whole number of courses"),
        ({"wall__ends": "rough"}, 'wall.ends = \'rough\': must be one of "flush", "toothed"'),
        ({"wall__ends": "toothed", "wall__length": 0.24}, "wall.length = 0.24: toothed ends"),
        ({"wall__first_course": "ful"}, 'did you mean "full"?'),
        ({**FREE, "wall__courses": []}, "wall.courses = []: has no course"),
        ({**FREE, "wall__courses": [[1, 1], []]}, "wall.courses[1] = []: is an empty course"),
        ({**FREE, "wall__courses": [[1, 1], [-1, -1]]}, "wall.courses[1] = [-1.0, -1.0]: is an empty course"),
        ({**FREE, "wall__courses": [[1, 0, 1]]}, "wall.courses[0] = [1.0, 0.0, 1.0]: has a width of 0"),
        ({**FREE, "wall__courses": [[1, -0.3, 0.7]]}, "wall.courses[0][1] = -0.3: is an opening off the lattice"),
        ({**FREE, "wall__courses": [[0.7, -1, 0.3]]}, "wall.courses[0][1] = -1.0: is an opening off the lattice"),
        ({**FREE, "wall__courses": [1, 1]}, "wall.courses[0] = 1: must be a list of finite numbers"),
        ({**FREE, "wall__courses": "many"}, "wall.courses = 'many': must be a list of courses"),
        ({"wall__courses": [[1, 1]]}, "wall.length: does not go with wall.courses; describe the wall in one way"),
        ({"wall__length": None, "wall__courses": [[1, 1]]}, "wall.height: does not go with wall.courses"),
        ({"wall__drawing": "wall.dxf"}, "wall.length: does not go with wall.drawing"),
        ({"wall__units": "mm"}, "wall.units: does not go with wall.length"),
        ({**FREE, "wall__courses": [[1, 1], [1, -1], [-1, 1]]}, "is a floating block"),
        ({"joint__friction_angle": 30}, "joint.friction_angle = 30.0: does not go with joint.friction"),
        ({"joint": {"friction_angle": 90}}, "joint.friction_angle = 90: must be a number"),
        ({"joint__tensile_strength": 1e4}, "joint.tensile_strength = 10000.0: must be at most"),
        ({"joint": {"friction": 0, "cohesion": 1e3}}, "joint.tensile_strength: is missing"),
        ({"joint__inset": 0.03}, "joint.inset = 0.03: must be less than half the shortest joint, 0.06 m long"),
        # A hundredth of a block is 2.4000000000000132 mm: contact points 4e-18 m apart have no lever.
        (
            {**FREE, "wall__courses": [[1, 0.01]], "joint__inset": 0.0012},
            "joint.inset = 0.0012: must be less than half the shortest joint, 0.0024 m long",
        ),
        ({"joint__mortar": {"young": 1e9, "poisson": 0.2}}, "joint.mortar.thickness: is missing"),
        ({"joint__normal_stiffness": 1e9}, "joint.shear_stiffness: is missing"),
        ({"support__kind": "rollers"}, "support.kind = 'rollers': must be one of"),
        ({"support__kind": "fixed-first-course", "wall__height": 0.06}, "holds every block"),
        ({"load__gravity": 0}, "load.gravity = 0.0: leaves a lateral load nothing to push with"),
        ({"load__live": {"kind": "lateral", "at": [0, 0]}}, "load.live.at = [0, 0]: is not a key"),
        ({"load__live": POINT | {"at": [5, 5]}}, "load.live.at = [5.0, 5.0]: touches no block that can move"),
        ({"load__live": POINT | {"force": [0, 0]}}, "load.live.force = [0.0, 0.0]: must not be zero"),
        ({"load__live": POINT | {"at": [1, 2, 3]}}, "load.live.at = [1, 2, 3]: must be a pair of finite numbers"),
        ({"title": 5}, "title = 5: must be a string"),
        ({"wall": {"drawing": "no.dxf", "units": "mm", "thickness": 0.1}}, "wall.drawing"),
        ({"wall": {"drawing": "no.dxf", "units": "miles", "thickness": 0.1}}, "wall.units = 'miles'"),
    ],
)
def test_invalid_scene_is_refused(
    changes: dict[str, Any], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = write_toml(content(**changes), tmp_path / "wall.toml")
    out = tmp_path / "out"
    for arguments in (["run", "--model", "limit"], ["compare"]):
        assert command([*arguments, str(scene), "--out", str(out)]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert said in printed.err
        assert printed.err.count("\n") == 1
        assert not out.exists()


@pytest.mark.parametrize(
    ("table", "key", "misspelt"),
    [
        ((), "load", "laod"),
        (("load",), "live", "lvie"),
        (("load", "live", 0), "kind", "knid"),
        (("wall",), "courses", "coursse"),
        (("joints", "glue"), "cohesion", "cohesoin"),
        (("joints", "glue"), "compressive_strength", "compressive_strenght"),
        (("inner_joint", "closure"), "growth", "grwoth"),
        (("beam",), "force", "forec"),
        (("beam", "drive"), "force", "froce"),
        (("assign", 0), "block", "blokc"),
        (("assign", 1), "box", "bxo"),
        (("assign", 2), "between", "betwene"),
        (("tie", 1), "yield", "yeild"),
    ],
)
def test_misspelt_key_is_reported_instead_of_the_missing_key(
    table: tuple[str | int, ...], key: str, misspelt: str
) -> None:
    tables: dict[str, Any] = copy.deepcopy({**PLAIN, **LISTED})
    inner: Any = tables
    for part in table:
        inner = inner[part]
    inner[misspelt] = inner.pop(key)
    with pytest.raises(SceneError, match=rf'{misspelt} = .* is not a key of .*; did you mean "{key}"\?'):
        scene_from_dict(tables)


def test_search_for_misspelt_keys_ignores_values_that_are_no_tables() -> None:
    """Even for deep nesting. Without a misspelt key the error keeps its original cause."""
    deep: Any = 1.0
    for _ in range(700):
        deep = {"a": deep}
    with pytest.raises(SceneError, match=r"block\.density = .*must be a number above 0"):
        scene_from_dict(content(block__density=deep))
    with pytest.raises(SceneError, match="cannot be read") as refused:
        scene_from_dict(content(load__live=None, load__history={"file": "no.csv", "quantity": "g"}))
    assert isinstance(refused.value.__cause__, FileNotFoundError)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"this is no TOML", "is not valid TOML"),
        (b"[wall]\nlength = 3\nlength = 4", "a key is given twice"),
        (b"live = {by = [0, 1], by = [0, 2]}", "a key is given twice"),
        (b"", "wall: is missing"),
        (b"\xff\xfe\x00", "is not UTF-8 text"),
        (b"x = " + b"[" * 5000, "is not valid TOML"),
        (b"x = " + b"9" * 5000, "is not valid TOML"),
    ],
)
def test_invalid_toml_is_refused(text: bytes, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "wall.toml"
    scene.write_bytes(text)
    assert command(["run", str(scene), "--model", "limit"]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "nowhere.toml", "--model", "limit"], "there is no such file"),
        (["run", ".", "--model", "limit"], "it is a folder"),
        (["run", "", "--model", "limit"], ".: cannot be read: it is a folder"),
        (["run", "panel-01"], "--model"),
        (["run", "panel-01", "--model", "limt"], 'did you mean "limit"?'),
        (["run", "panel-01", "--model", "LIMIT"], 'did you mean "limit"?'),
        (["run", "pannel-01", "--model", "limit"], 'did you mean "panel-01"?'),
        (["run", "panel-01", "--model", "fern"], "must be one of homog, limit, limit-nonassociated, dem-static, dem-d"),
        (["run", "panel-01", "--model", "limit", "--tolerance", "nan"], "--tolerance"),
        (["run", "panel-01", "--model", "limit", "--tolerance", "2"], "--tolerance"),
        (["run", "panel-01", "--model", "limit", "--tolerance", "small"], "--tolerance"),
        (["run", "panel-01", "--model", "limit", "--colour"], "--colour"),
        (["run", "point-load-4", "--model", "homog"], "it needs load.live.kind"),
        (["compare", "panel-01", "--models", "limit,dem"], "--models"),
        (["compare", "panel-01", "panel-01"], "second scene"),
        (["compare", "panel-01", "--jobs", "0"], "--jobs"),
        (["collapse", "panel-01"], "Unknown command"),
    ],
)
def test_invalid_command_line_is_refused(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert said in printed.err
    assert printed.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("asked", ["house", "hous.toml", "garden/house.toml", "garden/huose", "garden/house"])
def test_misspelt_file_name_gets_a_suggestion(
    asked: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """From the folder that was named, also for a missing suffix; the suggested file is not run."""
    monkeypatch.chdir(tmp_path)
    there = Path(asked).parent / "house.toml"
    if asked == str(there):
        there = there.with_name("shouse.toml")
    there.parent.mkdir(exist_ok=True)
    for other in (there, there.with_name("arch.toml")):
        write_toml(content(), other)
    assert command(["run", asked, "--model", "limit"]) == 2
    assert capsys.readouterr().err.endswith(f'did you mean "{there}"?\n')


@pytest.mark.parametrize(
    ("arguments", "changes"),
    [
        (["run", "--model", "dem-static"], {}),
        (["run", "--model", "dem-static", "--draws", "2", "--jobs", "1"], {}),
        (["run", "--model", "homog"], {"load__live": POINT}),
        (["respond", "--model", "dem-dynamic"], {"load__live": None, "load__history": QUAKE}),
    ],
)
def test_scene_refused_by_a_model_leaves_no_output_folder(
    arguments: list[str], changes: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """For example joints without a stiffness, which only some models need; an existing folder is kept."""
    scene = write_toml(content(**changes), tmp_path / "wall.toml")
    line = [*arguments, str(scene), "--out"]
    assert command([*line, str(tmp_path / "new" / "result")]) == 2
    *progress, refusal = capsys.readouterr().err.splitlines()
    assert refusal.startswith("runningbond: ")
    assert len(progress) == (2 if "--draws" in arguments else 0)
    assert list(tmp_path.iterdir()) == [scene]
    (tmp_path / "old").mkdir()
    assert command([*line, str(tmp_path / "old" / "result")]) == 2
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["old", "wall.toml"]


def test_impossible_output_folder_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    for arguments in (["run", "panel-01", "--model", "limit"], ["compare", "panel-01"]):
        assert command([*arguments, "--out", str(tmp_path / "file" / "folder")]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err.count("\n") == 1


def test_console_script_returns_the_exit_code(tmp_path: Path) -> None:
    """With the installed console script, called as from outside the project."""
    script = Path(sys.executable).parent / "runningbond"
    done = subprocess.run([script, "run", "panel-01", "--model", "homog"], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    refused = subprocess.run([script, "run", "x", "--model", "homog"], capture_output=True, text=True, check=False)
    assert refused.returncode == 2
    assert "Traceback" not in refused.stderr


@pytest.mark.parametrize(
    ("outlines", "said"),
    [
        ([[(0, 0), (200, 0), (200, 100), (0, 100)], [(100, 50), (300, 50), (300, 150), (100, 150)]], "overlaps"),
        ([[(0, 0), (200, 0), (200, 100), (100, 0), (0, 100)]], "crosses"),
        ([[(0, 40), (200, 40), (200, 100), (0, 100)]], "is a floating block"),
        ([[(0, 0.5), (200, 0.5), (200, 100), (0, 100)]], "over a gap of 0.0005 m, and joints bridge"),
        ([[(0, 15), (200, 15), (200, 100), (0, 100)]], "wall.expand fills those with mortar in them"),
        ([], "needs the ground and at least one block"),
    ],
)
def test_invalid_drawing_is_refused(
    outlines: list[list[tuple[float, float]]], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ground = [(-500.0, -50.0), (700.0, -50.0), (700.0, 0.0), (-500.0, 0.0)]
    drawing(tmp_path / "wall.dxf", [ground, *outlines])
    wall = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    scene = write_toml(content(wall=wall), tmp_path / "wall.toml")
    assert command(["run", str(scene), "--model", "limit", "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert said in printed.err
    assert printed.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_inset_is_compared_with_the_joints_of_its_material() -> None:
    """Those of lime are on the ground, 0.12 and 0.24 m long, and those between blocks of a course are 0.06 m long."""
    rows: list[list[float]] = [[0.5, 1, 0.5], [1, 1]]

    def wall(inset: float) -> Scene:
        lime = {"friction": 0.7, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}, "inset": inset}
        assign = [{"joint": "lime", "box": [[-1.0, -0.01], [2.0, 0.01]]}]
        return courses(rows, width=0.24, height=0.06, joints={"lime": lime}, assign=assign)

    assert {material.inset for material in wall(0.059).joint_materials} == {0.0, 0.059}
    with pytest.raises(SceneError, match=r"inset = 0\.13: must be less than half the shortest joint, 0\.12 m long"):
        wall(0.13)


@pytest.mark.parametrize("opposite", ["left", [-1.0, 0.0]])
def test_live_loads_that_cancel_are_refused(opposite: Any) -> None:
    """Every model would report self-locking; opposite point loads on different blocks are accepted."""
    loads = [{"kind": "lateral"}, {"kind": "lateral", "direction": opposite}]
    with pytest.raises(SceneError, match=r"load\.live: must not cancel out on every block"):
        panel(load__live=loads)
    apart = [{"kind": "point", "at": [x, 0.33], "force": [force, 0.0]} for x, force in ((0.1, 5.0), (0.5, -5.0))]
    assert panel(load__live=apart).load.live


@pytest.mark.parametrize(("last", "cancels"), [(-0.3, True), (-0.3 + 1e-9, False)])
def test_live_loads_cancel_up_to_rounding_alone(last: float, cancels: bool) -> None:
    """0.1 + 0.2 − 0.3 is 6e-17 in floating point; one part in a billion of a load is a load."""
    loads = [{"kind": "point", "at": [0.1, 0.33], "force": [force, 0.0]} for force in (0.1, 0.2, last)]
    if cancels:
        with pytest.raises(SceneError, match=r"load\.live: must not cancel out on every block"):
            panel(load__live=loads)
    else:
        assert len(panel(load__live=loads).load.live) == 3


def test_title_of_no_unicode_text_is_refused() -> None:
    """Names of files that are not UTF-8 have such characters in Python, which no file can be written with."""
    with pytest.raises(SceneError, match="title = .*: must be Unicode text, without lone surrogates"):
        panel(title="\udce9glise")
