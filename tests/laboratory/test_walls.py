"""Table rows become scenes: facts of the campaigns, and a one-line error for invalid input."""

import csv
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.joints import joint_stiffness
from runningbond.laboratory import MeasuredWall, chosen_walls, read_folder, shipped_walls
from runningbond.laboratory.folder import DATA, _file, unused
from runningbond.laboratory.formulas import by_hand
from runningbond.laboratory.ladder import LADDER, Rung
from runningbond.laboratory.measured import growing, turning_points
from runningbond.laboratory.modes import measured_modes
from runningbond.laboratory.notes import notes_on
from runningbond.laboratory.predictions import scenes_of
from runningbond.laboratory.rig import Features, _tables, scene_of, vertical_load
from runningbond.laboratory.scores import loops, marks_of
from runningbond.laboratory.stones import STONES
from runningbond.limit import limit
from runningbond.models import run_model
from runningbond.scene import Closure, SceneError, Stiffness, scene_from_dict
from runningbond.scene.errors import exits_in_a_line
from tests.walls import write_toml

from .folders import CURVE, GRANITE, HEADS, SANDSTONE, write_folder

ALL = Features(closes=True, crushes=True, splits=True)


def one(tmp_path: Path, row: str = GRANITE) -> MeasuredWall:
    return read_folder(write_folder(tmp_path, row))[0]


def test_nine_dry_and_four_mortared_walls_are_shipped_with_their_licence_and_two_crack_maps() -> None:
    walls = shipped_walls()
    assert len(walls) == 13
    assert [name for name, wall in walls.items() if not wall.is_scored] == ["SW.30.1", "SW.30.2"]
    assert [name for name, wall in walls.items() if wall.cracks] == ["SW.200.1", "WS.250"]
    assert "MIT" in (DATA / "dry" / "LICENSE").read_text()
    assert "10.5281/zenodo.812145" in (DATA / "README.md").read_text()


def test_unknown_shipped_wall_ends_a_script_in_a_line() -> None:
    assert list(chosen_walls(["J4D", "WS.100"])) == ["J4D", "WS.100"]
    with pytest.raises(SystemExit, match=re.escape("wall = 'WS.10': must be of WS1.100, ")), exits_in_a_line():
        chosen_walls(["WS.100", "WS.10"])


def test_every_file_of_the_laboratory_is_package_data() -> None:
    with (Path(__file__).parents[2] / "pyproject.toml").open("rb") as file:
        patterns = tomllib.load(file)["tool"]["setuptools"]["package-data"]["runningbond.laboratory"]
    packed = {path for pattern in patterns for path in DATA.parent.glob(pattern)}
    assert packed == {path for path in DATA.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("name", "size", "courses", "pressed", "modes"),
    [
        ("WS.250", (1.0, 1.2), 8, 250e3, ("R",)),
        ("WS1.175", (1.0, 1.2), 8, 175e3, ("R",)),
        ("SW.200.2", (1.0, 1.0), 10, 200e3, ("TC", "SL")),
        ("SW.30.1", (1.0, 1.0), 10, 30e3, ("F", "R", "SL")),
    ],
)
def test_rows_match_the_walls_of_the_crack_maps(
    name: str, size: tuple[float, float], courses: int, pressed: float, modes: tuple[str, ...]
) -> None:
    wall = shipped_walls()[name]
    scene = scene_of(wall, Features(driven=False))
    assert scene.beam is not None
    assert scene.beam.block is not None
    own = scene.wall & (np.arange(len(scene.blocks)) != scene.beam.block)
    low, high = scene.blocks.extent(own)
    assert high - low == pytest.approx(size)
    assert len(np.unique(np.round(scene.blocks.centroid[own, 1], 6))) == courses
    assert wall.modes == modes
    assert vertical_load(wall) == pressed
    assert scene.beam.force == (0.0, -pressed)
    assert scene.beam.drive is not None
    assert scene.beam.drive.at == pytest.approx(1.325 if name.startswith("WS") else 1.0)


def test_granite_starts_with_whole_blocks_and_sandstone_with_half_ones() -> None:
    for name, lowest in (("WS.100", 5), ("SW.200.1", 6)):
        scene = scene_of(shipped_walls()[name], Features(driven=False))
        own = scene.wall & (scene.blocks.centroid[:, 1] < 0.1 if name[0] == "S" else scene.blocks.centroid[:, 1] < 0.15)
        assert own.sum() == lowest


def test_scene_has_only_the_requested_features() -> None:
    wall = shipped_walls()["WS.250"]
    plain, full = scene_of(wall, Features()), scene_of(wall, ALL)
    joint, rich = plain.joint_materials[0], full.joint_materials[0]
    assert (joint.friction, joint.cohesion, joint.compressive_strength, joint.closure) == (0.65, 0.0, None, None)
    assert rich.compressive_strength == 73e6
    assert isinstance(rich.closure, Closure)
    assert not plain.joints.inner.any()
    assert full.joints.inner.sum() == 36  # 4 courses of five whole blocks, 4 of four and two halves
    assert plain.beam is not None
    assert plain.beam.drive is not None
    assert plain.beam.drive.path == pytest.approx((0.04311,))


def test_joint_stiffness_under_vertical_load_matches_the_measured_modulus() -> None:
    """Equals Epc / h_b within 12 %; without closure that stiffness is constant, and in shear 1 / 2.4 of it."""
    for stone, height in (("sandstone", 0.1), ("granite", 0.15)):
        start, growth = STONES[stone].stiffness(height, deformable=False)
        for pressure, modulus in STONES[stone].moduli.items():
            assert (start + growth * pressure) * height == pytest.approx(modulus, rel=0.12)
    given = scene_of(shipped_walls()["WS.250"], Features()).joint_materials[0].elasticity
    assert isinstance(given, Stiffness)
    assert given.normal == pytest.approx(4722e6 / 0.15, rel=0.01)
    assert given.shear == pytest.approx(given.normal / 2.4)


def test_deformable_blocks_and_joints_in_series_match_the_measured_modulus() -> None:
    for stone, height in (("sandstone", 0.1), ("granite", 0.15)):
        start, growth = STONES[stone].stiffness(height, deformable=True)
        for pressure, modulus in STONES[stone].moduli.items():
            joint = start + growth * pressure
            assert 1 / (1 / joint / height + 1 / STONES[stone].young) == pytest.approx(modulus, rel=0.12)


def test_load_without_a_name_is_ntot_less_the_weight(tmp_path: Path) -> None:
    """1.2 × 1 × 0.2 m at 20 kN/m³ weigh 4.8 kN."""
    assert vertical_load(one(tmp_path, GRANITE.replace("WS.175", "wall"))) == pytest.approx(175e3)


def test_number_in_a_name_far_from_the_stress_is_no_load(tmp_path: Path) -> None:
    """0.875 MPa on 1 m × 0.2 m is 175 kN, whether the wall is called 175 or is the third one."""
    for name in ("WS.175", "Wall-3"):
        row = f"{GRANITE.replace('WS.175', name).replace('179.8', '')},0.875"
        wall = read_folder(write_folder(tmp_path / name, row, heads=f'{HEADS},"σ0,pc [MPa]"'))[0]
        assert vertical_load(wall) == pytest.approx(175e3)


def test_sandstone_reaches_the_actuator_if_that_takes_one_more_course(tmp_path: Path) -> None:
    for height, courses in (("1000", 10), ("1200", 9)):
        row = SANDSTONE.replace(",1000,100,", f",{height},100,")
        assert row != SANDSTONE or height == "1000"
        scene = scene_of(one(tmp_path / height, row), Features(driven=False))
        assert scene.beam is not None
        own = scene.wall & (np.arange(len(scene.blocks)) != scene.beam.block)
        assert len(np.unique(np.round(scene.blocks.centroid[own, 1], 6))) == courses


@pytest.mark.parametrize("name", ["WS.175", "WS2.175", "WS-175", "WS 175", "WS.175.3"])
def test_load_is_read_from_names_with_and_without_other_numbers(tmp_path: Path, name: str) -> None:
    assert vertical_load(one(tmp_path, GRANITE.replace("WS.175", name).replace("179.8", ""))) == 175e3


@pytest.mark.parametrize(
    ("old", "new", "heads"),
    [
        ("Dry", "Dry joints", HEADS),
        ("Dry", "dry joint", HEADS),
        ("Dry", "–", HEADS),
        ("", "", HEADS.replace("[", "(").replace("]", ")")),
        ("1325", "1.325", HEADS.replace("H0 [mm]", "H0 (m)")),
        (",61,,", ",61,−43,", HEADS),
    ],
)
def test_usual_spellings_give_the_same_wall(old: str, new: str, heads: str, tmp_path: Path) -> None:
    (tmp_path / "usual").mkdir()
    usual = one(tmp_path / "usual", GRANITE.replace(",61,,", ",61,-43,") if "43" in new else GRANITE)
    (wall,) = read_folder(write_folder(tmp_path / "other", GRANITE.replace(old, new), heads=heads))
    assert wall.peaks == usual.peaks
    assert _tables(wall, ALL) == _tables(usual, ALL)


@pytest.mark.parametrize("unit", ["[N/mm²]", "(N/mm2)", "[MPa]"])
def test_pressures_may_be_in_newtons_per_square_millimetre(unit: str, tmp_path: Path) -> None:
    row = f"{GRANITE.replace('WS.175', 'wall').replace('179.8', '')},0.875"
    (wall,) = read_folder(write_folder(tmp_path, row, heads=f'{HEADS},"σ0,pc {unit}"'))
    assert vertical_load(wall) == pytest.approx(175e3)


def test_extra_columns_other_table_names_and_missing_entries_are_accepted(tmp_path: Path) -> None:
    heads = "Note," + HEADS + ",More"
    wall = read_folder(write_folder(tmp_path, f"x,{SANDSTONE}", heads=heads, table="hidden-walls.csv"))[0]
    assert wall.peak == 49.2e3
    assert scene_of(wall, ALL).title == "SW.100.1"
    bare = read_folder(write_folder(tmp_path / "bare", SANDSTONE.replace(",49.2,,R", ",,,")))[0]
    assert bare.peak == 61e3  # the peak of the curve
    assert bare.modes == ()


def test_report_words_are_split_and_unknown_ones_kept(tmp_path: Path) -> None:
    assert one(tmp_path, GRANITE[:-1] + "R + tc / falls").modes == ("R", "TC", "FALLS")


@pytest.mark.parametrize(
    ("said", "modes"),
    [
        ("Rocking", ("R/TC",)),
        ("rocking/toe crushing", ("R/TC",)),
        ("Rocking with toe-crushing", ("R/TC",)),
        ("R - TC", ("R/TC",)),
        ("R-TC", ("R/TC",)),
        ("S", ("F",)),
        ("Stepped diagonal crack and sliding", ("F", "SL")),
        ("Diagonal cracks", ("F",)),
    ],
)
def test_modes_may_be_written_out(said: str, modes: tuple[str, ...], tmp_path: Path) -> None:
    """Only the letters were once understood, and only between commas, slashes and plus signs."""
    wall = one(tmp_path, GRANITE[:-1] + said)
    assert measured_modes(wall.modes) == modes
    assert notes_on(wall) == []


@pytest.mark.parametrize("said", ["", "-", "–", "n/a"])
def test_no_word_is_no_mode(said: str, tmp_path: Path) -> None:
    """The dash of an empty entry, and both letters of n/a, were once taken for modes."""
    assert one(tmp_path, GRANITE[:-1] + said).modes == ()


def test_wall_pushed_to_the_negative_side_is_mirrored(tmp_path: Path) -> None:
    curve = "displacement_mm,force_kN\n0,0\n-1,-30\n-10,-61\n"
    wall = read_folder(write_folder(tmp_path, GRANITE.replace(",61,", ",,"), curve=curve))[0]
    assert wall.curve.tolist() == [[0, 0], [1e-3, 30e3], [0.01, 61e3]]
    assert notes_on(wall) == ["the record goes to the negative side; its curve is drawn and scored with reversed signs"]
    assert (wall.path, wall.peaks) == ((0.01,), (61e3,))


def test_wall_without_a_curve_has_a_default_push(tmp_path: Path) -> None:
    wall = one(tmp_path)
    (tmp_path / "WS.175.csv").unlink()
    again = read_folder(tmp_path)[0]
    assert len(wall.curve) == 4
    assert again.path == ()
    beam = scene_of(again, Features()).beam
    assert beam is not None
    assert beam.drive is not None
    assert beam.drive.path == pytest.approx((0.03 * 1.325,))


def test_own_scene_file_replaces_the_row(tmp_path: Path) -> None:
    wall = shipped_walls()["J4D"]
    assert wall.scene_file is not None
    row = "other,Monotonic,Mortar,Clay brick,,,,,,,,40,,F"
    folder = write_folder(tmp_path, row)
    (folder / "other.toml").write_text(wall.scene_file.read_text())
    mine = read_folder(folder)[0]
    assert len(scene_of(mine, ALL).blocks) > len(scene_of(mine, Features()).blocks)
    pushed = scene_of(mine, Features(driven=False)).beam
    assert pushed is not None
    assert pushed.drive is not None
    assert pushed.drive.path == ()


RUNGS = [rung for rung in LADDER.values() if not rung.features.deformable]


@pytest.mark.parametrize("rung", RUNGS, ids=lambda rung: rung.name)
def test_row_written_as_a_scene_file_gives_the_same_scene(rung: Rung, tmp_path: Path) -> None:
    """Closing joints once had the stiffness at zero pressure in models without closure."""
    wall = one(tmp_path)
    file = write_toml(_tables(wall, ALL), tmp_path / "WS.175.toml")
    row, own = scene_of(wall, rung.features), scene_of(replace(wall, scene_file=file), rung.features)
    for mine, theirs in zip(own.joint_materials, row.joint_materials, strict=True):
        assert replace(theirs, elasticity=mine.elasticity) == mine
        assert vars(joint_stiffness(mine)) == pytest.approx(vars(joint_stiffness(theirs)))
    assert own.drive == row.drive


@pytest.mark.parametrize("rung", RUNGS, ids=lambda rung: rung.name)
def test_joints_of_every_material_have_the_requested_features(rung: Rung, tmp_path: Path) -> None:
    """`limit` once crushed the toe of a wall whose lowest bed is a named material, as `limit-crushing` does."""
    wall = one(tmp_path)
    tables = _tables(wall, ALL)
    tables["joints"] = {"foot": tables["joint"] | {"peak_closure": 1e-4, "cap_shear": 4.0}}
    tables["assign"] = [{"joint": "foot", "between": ["ground", "*"]}]
    scene = scene_of(replace(wall, scene_file=write_toml(tables, tmp_path / "WS.175.toml")), rung.features)
    foot = next(each for each in scene.joint_materials if each.name == "foot")
    assert (foot.compressive_strength, foot.peak_closure, foot.cap_shear) == (
        (73e6, 1e-4, 4.0) if rung.features.crushes else (None, 0.0, 9.0)
    )
    assert (foot.closure is not None) == rung.features.closes


def test_joint_stiffness_under_load_uses_the_thickness_of_the_stones(tmp_path: Path) -> None:
    """The thickness may be given for the block or for the wall."""
    wall, rung = one(tmp_path), next(each for each in RUNGS if not each.features.closes and each.base)
    tables = _tables(wall, ALL)
    own = tables["block"] | {"thickness": tables["wall"]["thickness"]}
    stiffness = []
    for each in (tables, tables | {"block": own, "wall": tables["wall"] | {"thickness": 9.0}}):
        scene = scene_of(replace(wall, scene_file=write_toml(each, tmp_path / "wall.toml")), rung.features)
        stiffness.append(joint_stiffness(scene.joint).normal)
    assert stiffness[1] == pytest.approx(stiffness[0])


@pytest.mark.parametrize("name", [name for name, rung in LADDER.items() if rung.base == "dem-dynamic"])
def test_only_small_displacement_models_ignore_the_line_of_the_load(name: str) -> None:
    """Pages once said that all models ignore it; those with finite displacements use it."""
    rung = LADDER[name]
    tables = _tables(shipped_walls()["WS.250"], rung.features)
    tables["wall"]["height"] = 0.3
    tables["beam"] |= {"height": 0.2, "drive": {"displacement": [2e-5, 0], "at": 0.4}}
    said = run_model(rung.model, scene_from_dict(tables)).message
    assert ("beam.force_line" in said) == (name == "rigid")


@pytest.mark.long
@pytest.mark.parametrize(("load", "is_crushed"), [(-2e5, False), (-1.05e7, True)])
def test_note_on_bending_of_crushed_joints_needs_crushing(load: float, is_crushed: bool) -> None:
    """Corners that met other blocks also have a plastic closure; the note once appeared for uncrushed walls."""
    tables = _tables(shipped_walls()["SW.200.1"], LADDER["rigid-splitting"].features)
    tables["wall"]["height"] = 0.5
    tables["beam"] |= {"height": 0.2, "force": [0, load], "drive": {"displacement": [3e-3, 0], "at": 0.6}}
    outcome = LADDER["rigid-splitting"].model.solve(scene_from_dict(tables), 0.05)
    assert ("crushed joints" in outcome.message) == is_crushed


@pytest.mark.long
@pytest.mark.parametrize("rate", [None, 0.01])
@pytest.mark.parametrize("name", ["SW.200.1", "SW.200.2"])
def test_energy_that_splitting_stones_set_free_is_not_taken_from_the_drive(name: str, rate: float | None) -> None:
    """Where stones split at the peak, damping takes several times the force that drives the wall meanwhile."""
    tables = _tables(shipped_walls()[name], LADDER["rigid-splitting"].features)
    tables["beam"]["drive"] |= {} if rate is None else {"rate": rate}
    outcome = LADDER["rigid-splitting"].model.solve(scene_from_dict(tables), 0.02)
    assert outcome.lower is not None
    assert outcome.multiplier is not None
    assert outcome.lower >= 0.95 * outcome.multiplier


def test_unit_in_a_column_head_is_used(tmp_path: Path) -> None:
    heads = HEADS.replace("L [mm]", "L [m]").replace("Ntot [kN]", "Ntot")
    wall = read_folder(write_folder(tmp_path, GRANITE.replace(",1000,", ",1.0,"), heads=heads))[0]
    assert scene_of(wall, Features()).blocks.extent()[1][0] >= 1.0


# --- protocols ---------------------------------------------------------------------------------------------


def test_turning_points_of_a_noisy_record_are_those_of_its_cycles() -> None:
    t = np.linspace(0, 3, 3001)
    moved = (1 + np.floor(t)) * np.sin(2 * np.pi * t) + 0.02 * np.sin(400 * t)
    assert turning_points(moved) == pytest.approx([1, -1, 2, -2, 3, -3, 0], abs=0.05)


def test_repeated_cycles_are_left_out_and_sides_alternate() -> None:
    assert growing([1, -1, 1, -1, 2, -2, 2.05, -2.05, 3, -2.9]) == (1, -1, 2, -2, 3, -2.9)
    assert growing([2.2, -1.5, 2.3, -3.5, 4.7, -3.4, 4.9, -5.6]) == (2.2, -3.5, 4.7, -5.6)
    # The largest cycle is followed even if it is only a little larger than the one before.
    assert growing([1, -1, 2, -2, 2.1, -2.05]) == (1, -1, 2, -2, 2.1, -2.05)
    assert growing([1, -1, 2, -2, 2.01, -2.01]) == (1, -1, 2, -2, 0.0)


@pytest.mark.parametrize(("after", "home"), [((0.1,), (0.0,)), ((2, -2, 1), (0.0,)), ((-1, -1.5), (-1,)), ((), ())])
def test_last_cycle_is_unloaded_to_rest_at_most(after: tuple[float, ...], home: tuple[float, ...]) -> None:
    """If the record goes on; otherwise the largest loop would stay open and its work could not be compared."""
    assert growing([1, -1, 2, -2, *after]) == (1, -1, 2, -2, *home)


def test_repeated_pushes_to_one_side_are_kept() -> None:
    """Increasing pushes to one side with partial unloading, and one push before both sides alternate."""
    assert growing([2, 0.2, 5, 1, 10, 2, 25, 4]) == (2, 0.2, 5, 1, 10, 2, 25, 4)
    assert growing([2, 0, 5, -5, 10, -10]) == (2, 0, 5, -5, 10, -10)


def test_cyclic_walls_are_pushed_to_alternating_sides() -> None:
    for name in ("WS1.100", "WS1.175", "WS2.100"):
        wall = shipped_walls()[name]
        assert wall.is_cyclic
        side = np.sign(np.trim_zeros(wall.path, "b"))
        assert (side[1:] == -side[:-1]).all()
        assert max(map(abs, wall.path)) == pytest.approx(np.nanmax(np.abs(wall.curve[:, 0])), rel=0.02)


# --- refusals ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (GRANITE.replace(",1000,", ",long,"), "tests.csv, line 2: L = 'long': must be a number above 0"),
        (
            GRANITE.replace("1325", '"1,325"'),
            "H0 = '1,325': must be a number above 0, with a decimal point and no other",
        ),
        (GRANITE.replace("1325", ""), "WS.175: tests.csv, line 2: H0: is missing; it must be a number above 0"),
        (GRANITE.replace(",1000,", ",-1,"), "tests.csv, line 2: L = '-1': must be a number above 0"),
        (GRANITE.replace(",1000,", ",inf,"), "tests.csv, line 2: L = 'inf': must be a number above 0"),
        (GRANITE.replace(",1000,", ",,"), "tests.csv, line 2: L: is missing"),
        (GRANITE.replace(",1325,", ",0,"), "tests.csv, line 2: H0 = '0': must be a number above 0"),
        (GRANITE.replace(",1200,", ",1270,"), "tests.csv, line 2: H = '1.27 m': must be a whole number of courses"),
        (
            GRANITE.replace("Granite", "Marble"),
            "tests.csv, line 2: Stone = 'Marble': must be one of sandstone, granite",
        ),
        (GRANITE.replace("Granite", "Granit"), 'did you mean "granite"?'),
        (GRANITE.replace("Dry", "Mortar"), "tests.csv, line 2: Joints = 'Mortar': must be \"Dry\""),
        (GRANITE.replace("WS.175", "wall").replace("179.8", "3"), "tests.csv, line 2: Ntot = '3': must be more than"),
        (GRANITE.replace("WS.175", "wall").replace("179.8", ""), "tests.csv, line 2: Ntot: is missing"),
        (GRANITE.replace(",150,", ",0.15,"), "tests.csv, line 2: hb = '0.15': makes 4e+04 blocks"),
        (GRANITE.replace(",200,179.8", ",350,179.8"), "wall.length = 1.0: must be a whole number of half blocks"),
    ],
)
def test_invalid_row_is_refused_with_file_and_line(tmp_path: Path, row: str, said: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene_of(one(tmp_path, row), Features())
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("rows", "heads", "said"),
    [
        ([], HEADS, "tests.csv: holds no wall, only heads"),
        ([GRANITE, GRANITE], HEADS, "tests.csv, line 3: Test unit name = 'WS.175': is the second row of that name"),
        (["/etc/x" + GRANITE[6:]], HEADS, "Test unit name = '/etc/x': must be a name"),
        (
            ["a$b" + GRANITE[6:]],
            HEADS,
            "'a$b': must be a name, as it may be that of a file, without $",
        ),
        ([GRANITE[6:]], HEADS, "tests.csv, line 2: Test unit name = '': must be a name"),
        ([GRANITE + ",1,2"], HEADS, "WS.175: tests.csv, line 2: must have 14 entries, as its heads; has 16"),
        ([GRANITE.replace(",61,", ",x,")], HEADS, "tests.csv, line 2: Vmax,+ = 'x': must be a number above 0"),
        ([GRANITE], HEADS.replace("Vmax,+ [kN]", "Vmax,+ [kip]"), "Vmax,+ = 'kip': must have a unit, one of N, kN"),
        ([GRANITE], HEADS.replace("Test unit name", "wall"), 'a CSV file with a column "Test unit name"; it has none'),
        (['"WS.175'], HEADS, "tests.csv, line 2: is not a line of a CSV file"),
    ],
)
def test_invalid_table_is_refused(tmp_path: Path, rows: list[str], heads: str, said: str) -> None:
    folder = tmp_path / "walls"
    folder.mkdir()
    (folder / "tests.csv").write_text("\n".join([heads, *rows]) + "\n", encoding="utf-8")
    with pytest.raises(SceneError) as refused:
        read_folder(folder)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("curve", "said"),
    [
        ("", "WS.175.csv, line 1 = '': must be the heads displacement_mm,force_kN"),
        ("mm,kN\n0,0\n1,2\n", "WS.175.csv, line 1 = 'mm,kN': must be the heads"),
        (CURVE + "x,1\n", "WS.175.csv, line 6 = 'x,1': must be two numbers"),
        (CURVE + "1\n", "WS.175.csv, line 6 = '1,': must be two numbers"),
        (CURVE + "1,nan\n", "WS.175.csv, line 6 = '1,nan': must be two numbers"),
        (CURVE + "1,inf\n", "WS.175.csv, line 6 = '1,inf': must be two numbers"),
        (CURVE + "#N/A,3\n", "WS.175.csv, line 6 = '#N/A,3': must be two numbers"),
        (CURVE + "#DIV/0!,#DIV/0!\n", "WS.175.csv, line 6 = '#DIV/0!,#DIV/0!': must be two numbers"),
        (CURVE.replace("\n", "\n\n"), "WS.175.csv: has a gap after every point, such as"),
        (CURVE + "1,5,20,3\n", "WS.175.csv, line 6 = '1,5,20,3': must have 2 entries, as its heads; has 4"),
        (CURVE.replace(",", ";") + "1.000,5;2\n", "WS.175.csv, line 6 = '1.000,5,2': must be two numbers"),
        ("displacement_mm,force_kN\n1,1\n", "WS.175.csv: must hold points of a curve"),
        ("displacement_mm,force_kN\n1,1\n1,2\n", "WS.175.csv: must hold points of a curve"),
        ("displacement_mm,force_kN\n0,0\n1,0\n", "WS.175.csv: must hold points of a curve"),
        ("displacement_mm,force_kN\nNaN,NaN\n", "WS.175.csv: must hold points of a curve"),
        ("displacement_mm,force_kN\n0,0\n1,-2\n", "WS.175.csv: has its forces against its displacements"),
    ],
)
def test_invalid_curve_is_refused(tmp_path: Path, curve: str, said: str) -> None:
    with pytest.raises(SceneError) as refused:
        read_folder(write_folder(tmp_path, GRANITE, curve=curve))
    assert said in str(refused.value)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(",", ";"),
        lambda text: text.replace(",", "\t"),
        lambda text: text.replace(",", ";").replace(".5", ",5"),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: "\ufeff" + text,
        lambda text: "sep=;\r\n" + text.replace(",", ";").replace(".5", ",5"),
        lambda text: text.replace("-", "−"),
        lambda text: text.replace(",", ";").replace(".5", ",5").replace("-", "−"),
        lambda text: "# measured; in, 2005\n\n" + text.replace("\n1.5", "\n# a pause\n1.5") + "# end\n",
    ],
)
def test_curve_does_not_depend_on_the_spreadsheet_format(change: Callable[[str], str], tmp_path: Path) -> None:
    text = "displacement_mm,force_kN\n0,0\n1.5,30.5\nNaN,NaN\n-1.5,-20\n"
    curves = [read_folder(write_folder(tmp_path, GRANITE, curve=each))[0].curve for each in (text, change(text))]
    assert np.array_equal(curves[0], curves[1], equal_nan=True)
    assert curves[0][1] == pytest.approx([1.5e-3, 30.5e3])


@pytest.mark.parametrize("row", ["", "  ", ",", "#N/A,#N/A", "#nv,#nv", "NA,NA", "-,-"])
def test_rows_without_numbers_separate_loops(row: str, tmp_path: Path) -> None:
    """They were once skipped, and the loops on both sides joined to one."""
    text = "displacement_mm,force_kN\n0,0\n1,30\nNaN,NaN\n1,0\n10,61\n"
    texts = (text, text.replace("NaN,NaN", row))
    curves = [read_folder(write_folder(tmp_path, GRANITE, curve=each))[0].curve for each in texts]
    assert np.array_equal(curves[0], curves[1], equal_nan=True)


def test_numbered_rows_without_numbers_separate_loops(tmp_path: Path) -> None:
    """A data frame of pandas is written with a column of row numbers, and NaN as nothing; it was once refused."""
    curve = ",displacement_mm,force_kN\n0,0,0\n1,1,30\n2,,\n3,1,0\n4,10,61\n"
    (wall,) = read_folder(write_folder(tmp_path, GRANITE, curve=curve))
    assert np.isnan(wall.curve[2]).all()
    assert wall.curve[4] == pytest.approx([0.01, 61e3])


def test_comments_may_contain_quotes(tmp_path: Path) -> None:
    """They need not be lines of a CSV file; inside a quoted entry, a line that begins with # is none."""
    comment = '#note,"12 inch'
    folder = write_folder(tmp_path, comment, GRANITE, comment)
    (folder / f"{comment.split(',')[0]}.csv").unlink()
    (wall,) = read_folder(folder)
    assert (wall.name, wall.row.line) == ("WS.175", 3)
    quoted = HEADS.replace("Joints", '"Joints\n# as built"')
    (folder / "tests.csv").write_text(f"{comment}\n{quoted}\n{GRANITE}\n")
    (wall,) = read_folder(folder)
    assert wall.row.line == 4
    (folder / "tests.csv").write_text(f'{comment}\n{quoted}\n"{GRANITE}\n')
    with pytest.raises(SceneError, match=r"^tests.csv, line 4: is not a line of a CSV file"):
        read_folder(folder)


def test_table_does_not_depend_on_the_spreadsheet_format(tmp_path: Path) -> None:
    """Heads contain commas, which need no quotes if semicolons separate the columns."""
    heads, row = HEADS.replace('"', "").replace("Vmax,", "Vmax|"), f"{GRANITE[:-1]}R/TC"
    write_folder(tmp_path, row)
    (wall,) = read_folder(tmp_path)
    table = "\n".join(["# of 2005", heads, row, "# end"]).replace(",", ";").replace("|", ",").replace("179.8", "179,8")
    (tmp_path / "tests.csv").write_text(table)
    (same,) = read_folder(tmp_path)
    assert dict(same.row.entries) == dict(wall.row.entries)
    assert (same.peaks, same.modes) == ((61e3,), ("R", "TC"))
    (tmp_path / "tests.csv").write_text(table.replace(";1000;", ";long;"))
    (wrong,) = read_folder(tmp_path)
    with pytest.raises(SceneError, match="tests.csv, line 3: L = 'long': must be a number"):
        scene_of(wrong, Features())


@pytest.mark.parametrize("separator", [";", "\t"])
@pytest.mark.parametrize("heads", [["Vmax,+ [kN]"], ["σ0,pc [MPa]", "Vmax,+ [kN]", "Vmax,- [kN]"]])
def test_heads_with_as_many_commas_as_separators_are_told_apart(
    separator: str, heads: list[str], tmp_path: Path
) -> None:
    scene_file = shipped_walls()["J4D"].scene_file
    assert scene_file is not None
    (tmp_path / "J2G.toml").write_text(scene_file.read_text())
    entries = {"σ0,pc [MPa]": "0,3", "Vmax,+ [kN]": "38,5", "Vmax,- [kN]": ""}
    lines = [["Test unit name", *heads], ["J2G", *(entries[head] for head in heads)]]
    (tmp_path / "tests.csv").write_text("\n".join(separator.join(line) for line in lines))
    (wall,) = read_folder(tmp_path)
    assert (wall.name, wall.peaks) == ("J2G", (38.5e3,))


@pytest.mark.parametrize("heads", ["displacement_mm,force_kN\t", "displacement_mm,\tforce_kN"])
def test_separator_is_that_beside_a_required_head(heads: str, tmp_path: Path) -> None:
    """A spreadsheet may leave others at the end of a line, or align columns with them."""
    (wall,) = read_folder(write_folder(tmp_path, GRANITE, curve=f"{heads}\n0,0\n10,61\n"))
    assert wall.curve == pytest.approx(np.array([[0.0, 0.0], [0.01, 61e3]]))


def test_name_of_a_table_decides_on_its_separator(tmp_path: Path) -> None:
    """Heads with remarks in brackets may contain semicolons."""
    heads = HEADS.replace("Failure type", "Failure type (crack; slip)")
    assert one(tmp_path, GRANITE).peaks == read_folder(write_folder(tmp_path / "a", GRANITE, heads=heads))[0].peaks


@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_curve_in_another_unit_than_the_table_is_refused(factor: float, tmp_path: Path) -> None:
    """Newtons under a head in kilonewtons were once accepted without a message."""
    curve = "displacement_mm,force_kN\n0,0\n" + f"10,{61 * factor:g}\n"
    with pytest.raises(SceneError, match=r"WS\.175\.csv: has a largest force of .* one of 61 kN; are their"):
        read_folder(write_folder(tmp_path, GRANITE, curve=curve))
    assert len(read_folder(write_folder(tmp_path, GRANITE.replace(",61,", ",,"), curve=curve))) == 1


def test_actuator_below_the_top_of_the_wall_is_noted(tmp_path: Path) -> None:
    """In tables of walls bent in double curvature it is the height without moment: N L / (2 H0) rocks them.

    Stones below a stepped crack stay where they are, so only a part of the wall's weight adds to N.
    """
    wall = one(tmp_path, GRANITE.replace(",1325,", ",1000,"))
    (note,) = notes_on(wall)
    assert note.startswith("H0 = 1000 mm is below the top of the wall, 1200 mm; ")
    scene = scene_of(wall, Features(driven=False))
    assert by_hand(scene)["rocking"] == pytest.approx(175e3 * 1.0 / (2 * 1.0))
    weight = 9.81 * float(scene.mass[~scene.fixed].sum())
    assert 175e3 / 2 < (limit(scene).multiplier or 0.0) < (175e3 + weight) / 2


@pytest.mark.parametrize(("factor", "noted"), [(1.0, False), (1.04, False), (1.06, True), (0.94, True)])
def test_record_with_another_strength_than_the_table_is_noted(factor: float, noted: bool, tmp_path: Path) -> None:
    (table,) = one(tmp_path, GRANITE).peaks
    curve = f"displacement_mm,force_kN\n0,0\n10,{factor * table / 1e3:.6g}\n20,1\n"
    (wall,) = read_folder(write_folder(tmp_path, GRANITE, curve=curve))
    told = [f"the record's largest force is {factor * table / 1e3:.4g} kN, and the table's {table / 1e3:.4g} kN"]
    assert [note.partition(";")[0] for note in notes_on(wall)] == (told if noted else [])


@pytest.mark.parametrize(("factor", "said"), [(1e-3, "0.02, 1.5e-05 of H0 = 1325 mm"), (100, "2e+03, 1.5 of H0")])
def test_displacements_in_another_unit_are_refused(factor: float, said: str, tmp_path: Path) -> None:
    """Metres under a head in millimetres were once predicted as a push of micrometres."""
    curve = "displacement_mm,force_kN\n0,0\n" + f"{20 * factor:g},61\n"
    with pytest.raises(SceneError, match=rf"WS\.175\.csv: displacement_mm: must be in mm; .* is {re.escape(said)}"):
        read_folder(write_folder(tmp_path, GRANITE, curve=curve))
    write_toml(_tables(one(tmp_path / "other", GRANITE), ALL), tmp_path / "WS.175.toml")
    with pytest.raises(SceneError, match=rf"WS\.175\.csv: displacement_mm: must be in mm; .* is {re.escape(said)}"):
        read_folder(tmp_path)
    (tmp_path / "WS.175.toml").unlink()
    assert len(read_folder(write_folder(tmp_path, GRANITE.replace(",1325,", ",,"), curve=curve))) == 1


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ("5,0", "the record starts at 5 mm under 0 kN, and is read as it is; both must count from rest"),
        ("0,10", "the record starts at 0 mm under 10 kN, and is read as it is; both must count from rest"),
        ("1,20", ""),  # recorded only from some load on
        ("0.1,0.5", ""),
    ],
)
def test_record_that_starts_with_an_offset_is_noted(start: str, said: str, tmp_path: Path) -> None:
    curve = f"displacement_mm,force_kN\n{start}\n6,30\n20,61\n"
    assert notes_on(read_folder(write_folder(tmp_path, GRANITE, curve=curve))[0]) == ([said] if said else [])


def test_no_shipped_wall_has_a_note() -> None:
    assert [note for wall in shipped_walls().values() for note in notes_on(wall)] == []


BROKEN = {
    "bytes": b"PK\x03\x04\xff",
    "UTF-16": CURVE.encode("utf-16"),
    "a quote left open": CURVE.replace("1,30", '"1,30').encode(),
}


@pytest.mark.parametrize("content", BROKEN.values(), ids=BROKEN)
def test_unreadable_curve_does_not_stop_other_walls(content: bytes, tmp_path: Path) -> None:
    """The search for the table read every file completely, and once failed for all walls on one damaged file."""
    folder = write_folder(tmp_path, SANDSTONE, GRANITE)
    (folder / "SW.100.1.csv").write_bytes(content)
    refused = list[SceneError]()
    assert [wall.name for wall in read_folder(folder, refused.append)] == ["WS.175"]
    assert [error.key.split(",")[0] for error in refused] == ["SW.100.1.csv"]


def test_unreadable_table_is_reported(tmp_path: Path) -> None:
    folder = write_folder(tmp_path, GRANITE)
    (folder / "tests.csv").write_bytes((folder / "tests.csv").read_text(encoding="utf-8").encode("utf-16"))
    with pytest.raises(SceneError, match=r"tests\.csv: is not a table: it is not UTF-8 text"):
        read_folder(folder)


def test_system_files_in_folders_are_skipped(tmp_path: Path) -> None:
    """Hidden companion files of macOS, once refused as unreadable text, a folder, and a dangling link."""
    folder = write_folder(tmp_path, GRANITE)
    for name in ("._tests.csv", "._WS.175.csv"):
        (folder / name).write_bytes(b"\x00\x05\x16\x07\xff")
    (folder / "old.csv").mkdir()
    (folder / "gone.csv").symlink_to(folder / "nowhere.csv")
    assert len(read_folder(folder)[0].curve) == 4
    assert unused(folder) == []


def test_file_extension_is_case_insensitive(tmp_path: Path) -> None:
    """WS.175.CSV was once skipped without a message, and the wall treated as one without a record."""
    folder = write_folder(tmp_path, GRANITE)
    (folder / "WS.175.csv").rename(folder / "WS.175.CSV")
    (folder / "WS.250.csv").write_text(CURVE)
    assert len(read_folder(folder)[0].curve) == 4
    assert unused(folder) == ["WS.250.csv"]


def test_files_of_a_wall_may_be_named_in_another_case(tmp_path: Path) -> None:
    """The curve ws.175.csv was once left out, and the wall treated as one without a record."""
    folder = write_folder(tmp_path, GRANITE)
    (folder / "WS.175.csv").rename(folder / "ws.175.csv")
    assert len(read_folder(folder)[0].curve) == 4
    assert unused(folder) == []
    files = {name: tmp_path / name for name in ("a.csv", "A.csv")}
    assert [_file(files, name) for name in ("A.csv", "a.csv", "b.csv")] == [files["A.csv"], files["a.csv"], None]


def test_names_that_differ_only_in_case_are_refused(tmp_path: Path) -> None:
    """Their files, and pictures of the page, could be the same ones."""
    with pytest.raises(SceneError, match=r"line 3: Test unit name = 'ws\.175': is the second row of that name"):
        read_folder(write_folder(tmp_path, GRANITE, GRANITE.replace("WS", "ws")))


@pytest.mark.parametrize(
    ("word", "is_cyclic"), [("Quasi-static cyclic", True), ("CYCLIC", True), ("monotone", False), ("–", False)]
)
def test_loading_type_may_be_part_of_a_longer_word(word: str, is_cyclic: bool, tmp_path: Path) -> None:
    """A cyclic wall was once predicted to one side only if the table entry began with another word."""
    assert one(tmp_path, GRANITE.replace("Monotonic", word)).is_cyclic == is_cyclic


def test_unknown_loading_type_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r'line 2: Cyclic / Monotonic = .C.: must be "Cyclic" or "Monotonic"'):
        one(tmp_path, GRANITE.replace("Monotonic", "C"))


def test_missing_folder_or_two_tables_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="must be a folder that holds tests.csv"):
        read_folder(tmp_path / "nowhere")
    write_folder(tmp_path, GRANITE)
    write_folder(tmp_path, SANDSTONE, table="more.csv")
    with pytest.raises(SceneError, match="it has 2: more.csv, tests.csv"):
        read_folder(tmp_path)


def with_column(folder: Path, head: str, cell: str) -> Path:
    """A folder with the granite wall and one additional column in its table."""
    write_folder(folder, f"{GRANITE},{cell}", heads=f"{HEADS},{head}")
    return folder


@pytest.mark.parametrize(
    ("column", "head", "is_likely"),
    [
        ("H0 [mm]", "H_0 [mm]", True),
        ("H0 [mm]", "Ho [mm]", True),
        ("H0 [mm]", "height [mm]", False),
        ("L [mm]", "Length (mm)", True),
        ("t [mm]", "wall thickness [mm]", True),
        ("hb [mm]", "Block height [mm]", True),
        ("Ntot [kN]", "Ntotal [kN]", True),
        ("Ntot [kN]", "sigma0 [MPa]", True),  # one of the two is enough
        ("Stone", "Stone type", True),
        ("Stone", "Remark", False),
    ],
)
def test_missing_column_names_the_one_that_may_be_meant(
    column: str, head: str, is_likely: bool, tmp_path: Path
) -> None:
    write_folder(tmp_path, GRANITE.replace("WS.175", "wall"), heads=HEADS.replace(column, head))
    with pytest.raises(SceneError) as refused:
        scene_of(read_folder(tmp_path)[0], Features())
    said = str(refused.value)
    assert said.startswith(f"wall: tests.csv, line 2: {column.partition(' [')[0]}")
    assert said.endswith(f'; did you mean column "{head}"?') == is_likely
    assert ("did you mean" in said) == is_likely


def test_conflicting_columns_of_one_name_are_refused(tmp_path: Path) -> None:
    """Once the last one counted, whatever the other contained."""
    with pytest.raises(SceneError, match=r"tests.csv, line 2: L = '1.5 m': is in another column as well, as 1000 mm;"):
        read_folder(with_column(tmp_path, "L [m]", "1.5"))


def test_unread_columns_may_have_one_name(tmp_path: Path) -> None:
    """A drift in % beside a displacement in mm was once refused, with the request to leave one of them empty."""
    write_folder(tmp_path, f"{GRANITE},2.1,27", heads=HEADS + ',"dmax,+ [%]","dmax,+ [mm]"')
    assert len(read_folder(tmp_path)) == 1


@pytest.mark.parametrize(("head", "cell"), [("L [m]", ""), ("L [mm]", "1000")])
def test_empty_or_equal_duplicate_column_changes_nothing(head: str, cell: str, tmp_path: Path) -> None:
    (wall,) = read_folder(with_column(tmp_path, head, cell))
    assert wall.row.number("L") == 1.0


def test_own_scene_without_a_drive_is_refused(tmp_path: Path) -> None:
    folder = write_folder(tmp_path, GRANITE)
    (folder / "WS.175.toml").write_text("[wall]\n")
    with pytest.raises(SceneError, match="WS.175.toml: beam.drive: is missing"):
        scene_of(read_folder(folder)[0], Features())


@pytest.mark.parametrize(
    ("name", "load"), [("WS.175", 175e3), ("Wall 3", 185.2e3), ("WS-1.250", 185.2e3), ("A-150", 185.2e3)]
)
def test_number_in_a_name_is_a_load_if_the_table_agrees(tmp_path: Path, name: str, load: float) -> None:
    """Otherwise the load is Ntot less the weight, 20 kN/m³ times 0.24 m³."""
    row = GRANITE.replace("WS.175", name).replace("179.8", "190")
    assert vertical_load(one(tmp_path, row)) == pytest.approx(load, rel=1e-9)


def test_load_that_only_the_name_has_is_noted(tmp_path: Path) -> None:
    """The third wall of a series was once pressed by 3 kN without a word."""
    row = GRANITE.replace("WS.175", "GC-3")
    assert notes_on(one(tmp_path / "table", row)) == []
    bare = one(tmp_path / "name", row.replace("179.8", ""))
    assert vertical_load(bare) == 3e3
    assert notes_on(bare) == ["no Ntot or σ0,pc: the 3 in the name is taken as 3 kN"]


@pytest.mark.parametrize(
    ("column", "same", "other", "said"),
    [
        ("fc [MPa]", "72", "12", "fc = 12 MPa (for 73)"),
        ("fc [N/mm²]", "-", "12", "fc = 12 MPa (for 73)"),
        ("Epc [MPa]", "4100", "900", "Epc = 900 MPa (for 4068)"),
        ("Epc", "4100", "4.9e3", "Epc = 4900 MPa (for 4068)"),
        ('"fc,b (MPa)"', "69.2", "40", "fc,b = 40 MPa (for 69)"),
        ("Eb [GPa]", "20.2", "9", "Eb = 9000 MPa (for 20200)"),
        ("Eb [MPa]", "high", "9e3", "Eb = 9000 MPa (for 20200)"),
    ],
)
def test_numbers_of_another_stone_are_noted(column: str, same: str, other: str, said: str, tmp_path: Path) -> None:
    """Soft and weak granite was once predicted with the numbers of the campaign's granite without a word."""
    for folder, cell in (("same", same), ("other", other)):
        (wall,) = read_folder(with_column(tmp_path / folder, column, cell))
        what = f"not read: {said}; models take the numbers of granite in brackets"
        told = [f"{what}, and a wall of other stone needs a WS.175.toml"] if folder == "other" else []
        assert notes_on(wall) == told
    write_toml(_tables(wall, ALL), tmp_path / "other" / "WS.175.toml")
    assert notes_on(read_folder(tmp_path / "other")[0]) == []


@pytest.mark.parametrize(
    ("head", "unread", "cell", "meant"),
    [
        ("From test report: Failure type", "Failure type", "R", "From test report: Failure type"),
        ("Vmax,+ [kN]", "Vmax+ [kN]", "61", "Vmax,+"),
        ("Vmax,+ [kN]", "Vmax", "61", "Vmax,+"),
        ("Ntot [kN]", "N [kN]", "179.8", "Ntot"),
        ("Ntot [kN]", "sigma0 [MPa]", "0.875", "σ0,pc"),
        ("Ntot [kN]", "N", "-", ""),
        ("Vmax,+ [kN]", "dmax,+ [%]", "2.1", ""),
        ("Vmax,- [kN]", "Vmax [kN]", "61", ""),  # the other one has its entry
        ("Vmax,+ [kN]", "Remark", "none", ""),
        ("Ntot [kN]", "No", "3", ""),  # numbers of walls
    ],
)
def test_misspelt_columns_are_noted(head: str, unread: str, cell: str, meant: str, tmp_path: Path) -> None:
    """They were once ignored without a word, and the wall had no measured strength, or the load of its name."""
    row = next(csv.DictReader(f"{HEADS}\n{GRANITE}\n".splitlines()))
    row |= {head: "", unread: cell}
    with (tmp_path / "tests.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([row.keys(), row.values()])
    (tmp_path / "WS.175.csv").write_text(CURVE)
    told = [note for note in notes_on(read_folder(tmp_path)[0]) if note.startswith("column ")]
    assert told == ([f'column "{unread}" is not read (did you mean "{meant}"?)'] if meant else [])
    write_toml(_tables(one(tmp_path / "other"), ALL), tmp_path / "WS.175.toml")
    told = [note for note in notes_on(read_folder(tmp_path)[0]) if note.startswith("column ")]
    assert len(told) == (meant.startswith(("Vmax", "From")))  # its scene has the loads


def test_likely_slips_of_scenes_are_noted(tmp_path: Path) -> None:
    """A beam pressed by 175 N for 175 kN was once predicted to rock under nothing, without a word."""
    wall = one(tmp_path)
    tables = _tables(wall, ALL)
    tables["beam"]["force"] = [0, -175]
    tables["joint"]["compressive_strength"] = 73
    write_toml(tables, tmp_path / "WS.175.toml")
    strength, force, _ = notes_on(read_folder(tmp_path)[0])
    assert strength.startswith("joint.compressive_strength = 73: is not within 10000 … 1e+10 Pa; is 73 MPa meant")
    assert force == "beam.force: 175 N is only 3.6% of the wall's weight; are kN meant?"
    thin = one(tmp_path / "thin", GRANITE.replace(",200,1325", ",0.2,1325"))
    (said,) = notes_on(thin)
    assert said.startswith("in the scene of its row, wall.thickness = 0.0002: is odd for blocks")


@pytest.mark.parametrize(
    ("column", "factor", "said"),
    [
        ("", 1.0, ""),
        ("L [mm]", 1.04, ""),
        ("L [mm]", 4.5, "L = 4500 mm (for 1000)"),
        ("t [mm]", 0.5, "t = 100 mm (for 200)"),
        ("σ0,pc [MPa]", 1.0, ""),
        ("σ0,pc [MPa]", 0.1, "σ0,pc = 0.0875 MPa (for 0.875)"),
        ("Ntot [kN]", 1.0, ""),
        ("Ntot [kN]", 0.1, "Ntot = 17.98 kN (for 175)"),
        ("Ntot [kN]", 10.0, "Ntot = 1798 kN (for 179.8)"),
    ],
)
def test_scene_of_another_size_than_the_row_is_noted(column: str, factor: float, said: str, tmp_path: Path) -> None:
    """Widths of courses in metres instead of block widths once made a wall of a quarter of the length, unnoticed."""
    known = {"L [mm]": 1000, "t [mm]": 200, "σ0,pc [MPa]": 0.875, "Ntot [kN]": 179.8}
    heads, row = f'Test unit name,"{column or "Remark"}"', f"WS.175,{known.get(column, 1) * factor:g}"
    folder = write_folder(tmp_path / "own", row, heads=heads)
    write_toml(_tables(one(tmp_path / "row"), ALL), folder / "WS.175.toml")
    (wall,) = read_folder(folder)
    what = f"not read: {said}; models take the numbers of WS.175.toml in brackets"
    assert notes_on(wall) == ([what] if said else [])


@pytest.mark.parametrize(
    ("kind", "other", "noted"), [("Cyclic", "59", True), ("Cyclic", "", False), ("Monotonic", "59", False)]
)
def test_record_of_one_side_of_a_cyclic_test_is_noted(kind: str, other: str, noted: bool, tmp_path: Path) -> None:
    wall = one(tmp_path, GRANITE.replace("Monotonic", kind).replace(",61,,", f",61,{other},"))
    said = (
        "the table has largest forces to both sides, but the record goes to one; models push the wall to that side, "
        "and their strength is compared with the mean of both"
    )
    assert notes_on(wall) == ([said] if noted else [])


@pytest.mark.parametrize(
    ("drive", "noted"),
    [
        ({"amplitudes": [0.002, 0.005]}, False),
        ({"amplitudes": [-0.002, -0.005]}, True),
        ({"displacement": [[0, 0.002, -0.002, 0.005, -0.005, 0]]}, False),
        ({"displacement": [[0, -0.002, 0.002, -0.005, 0.005, 0]]}, True),
    ],
)
def test_record_of_cycles_and_scene_that_begin_on_opposite_sides_are_noted(
    drive: dict[str, Any], noted: bool, tmp_path: Path
) -> None:
    """A wall's own prediction, as a record with reversed signs, once dissipated a third more than itself, unnoticed."""
    curve = "displacement_mm,force_kN\n0,0\n2,40\n-2,-40\n5,50\n-5,-50\n0,0\n"
    folder = write_folder(tmp_path / "own", "WS.175,Cyclic", heads="Test unit name,Cyclic / Monotonic", curve=curve)
    tables = _tables(one(tmp_path / "row"), ALL)
    tables["beam"]["drive"] = drive
    write_toml(tables, folder / "WS.175.toml")
    (wall,) = read_folder(folder)
    said = (
        "the record and WS.175.toml push the wall first to opposite sides; sides are compared by their sign, so that "
        "displacements and loops of different half cycles may be compared"
    )
    assert notes_on(wall) == ([said] if noted else [])


@pytest.mark.parametrize(("factor", "noted"), [(1.0, False), (1e-3, True), (1e3, True)])
def test_displacements_in_another_unit_are_noted_without_the_height_of_the_actuator(
    factor: float, noted: bool, tmp_path: Path
) -> None:
    curve = "displacement_mm,force_kN\n" + "".join(
        f"{factor * x},{y}\n" for x, y in ((0, 0), (1, 30), (10, 61), (20, 60))
    )
    folder = write_folder(tmp_path / "own", "WS.175,61", heads='Test unit name,"Vmax,+ [kN]"', curve=curve)
    write_toml(_tables(one(tmp_path / "row"), Features()), folder / "WS.175.toml")
    (wall,) = read_folder(folder)
    said = f"the largest displacement of the record is {20 * factor:.3g} mm, {factor / 60:.2g} of the wall's height"
    assert notes_on(wall) == ([f"{said}; it must be in mm"] if noted else [])


@pytest.mark.parametrize(
    ("cycles", "said"), [(12, []), (13, ["its path is 52 times as long as its largest displacement"])]
)
def test_very_long_protocol_is_noted(cycles: int, said: list[str], tmp_path: Path) -> None:
    tables = _tables(one(tmp_path / "row"), Features())
    tables["beam"]["drive"] = {"amplitudes": [0.01], "cycles": cycles, "at": 1.325}
    folder = write_folder(tmp_path / "own", "WS.175,61", heads='Test unit name,"Vmax,+ [kN]"', curve=CURVE)
    write_toml(tables, folder / "WS.175.toml")
    assert [note.partition(";")[0] for note in notes_on(read_folder(folder)[0])] == said


def test_wall_of_which_nothing_was_measured_is_noted(tmp_path: Path) -> None:
    folder = write_folder(tmp_path, GRANITE.replace(",61,", ",,"))
    assert notes_on(read_folder(folder)[0]) == []
    (folder / "WS.175.csv").unlink()
    said = "neither Vmax,+ nor a curve WS.175.csv: its strength is predicted, but not scored"
    assert notes_on(read_folder(folder)[0]) == [said]


@pytest.mark.parametrize("content", [b"none", b"\x89PNG\r\n\x1a\nhalf", b""])
def test_invalid_crack_picture_is_refused(content: bytes, tmp_path: Path) -> None:
    """Only the first bytes were once checked; a damaged picture caused a traceback after all predictions."""
    folder = write_folder(tmp_path / "walls", GRANITE)
    (folder / "WS.175-cracks.png").write_bytes(content)
    with pytest.raises(SceneError, match=r"WS\.175-cracks\.png: is no PNG picture"):
        read_folder(folder)


def test_impossible_scene_is_refused_with_its_wall(tmp_path: Path) -> None:
    walls = read_folder(
        write_folder(tmp_path / "walls", GRANITE, SANDSTONE.replace(",1000,200,1000", ",1050,200,1000"))
    )
    with pytest.raises(SceneError, match=r"tests\.csv, line 3: wall\.length = 1\.05"):
        scenes_of(walls, list(LADDER.values()))


def test_walls_with_an_uncommon_load_are_scored(tmp_path: Path) -> None:
    walls = [one(tmp_path / name, SANDSTONE.replace("SW.100.1", name)) for name in ("SW.30.3", "SW.300.1", "SW.30")]
    assert [wall.is_scored for wall in walls] == [False, True, False]


def test_curve_to_the_negative_side_may_start_with_noise(tmp_path: Path) -> None:
    curve = "displacement_mm,force_kN\n0.01,0\n-1,-30\n-10,-61\n"
    wall = read_folder(write_folder(tmp_path / "walls", GRANITE, curve=curve))[0]
    assert wall.curve[-1] == pytest.approx([0.01, 61e3])


@pytest.mark.parametrize("kind", ["Monotonic", "Cyclic", ""])
@pytest.mark.parametrize("passing", [0.3, 1.0, 3.0])
def test_reading_a_wall_does_not_depend_on_its_side(passing: float, kind: str, tmp_path: Path) -> None:
    """12 mm to one side under 61 kN after a little to the other; beyond 1/20 the result once depended on the side."""
    points = [(0, 0), (passing / 2, 10), (passing, 12), (0, -1), (-2, -40), (-10, -61), (-12, -45)]
    row, walls = GRANITE.replace("Monotonic", kind).replace(",61,", ",,"), []
    for side in (1, -1):
        curve = "displacement_mm,force_kN\n" + "".join(f"{side * x},{side * y}\n" for x, y in points)
        walls += read_folder(write_folder(tmp_path / str(side), row, curve=curve))
    marks = [marks_of(wall.curve, cyclic=wall.is_cyclic, side=wall.side) for wall in walls]
    assert marks[0] is not None
    assert marks[0] == marks[1]
    assert walls[0].is_cyclic == walls[1].is_cyclic
    assert {walls[0].peak, walls[1].peak} == {marks[0].strength}
    assert walls[0].is_cyclic or walls[0].path == walls[1].path == (0.012,)


ENVELOPE = [(-20, -50), (-10, -59), (-2, -30), (0, 0), (1, 30), (10, 61), (20, 55)]


@pytest.mark.parametrize("kind", ["Cyclic", ""])
@pytest.mark.parametrize("order", [1, -1])
def test_envelope_from_one_side_to_the_other_is_read_from_rest(order: int, kind: str, tmp_path: Path) -> None:
    """Models once pushed such a wall to the side at its end only, and its peak was sought where it begins."""
    rows = [f"{x},{y}\n" for x, y in ENVELOPE]
    curve = "displacement_mm,force_kN\n" + "".join(rows[::order])
    row = GRANITE.replace("Monotonic", kind).replace(",61,", ",,")
    (wall,) = read_folder(write_folder(tmp_path, row, curve=curve))
    assert wall.path == (0.02, -0.02)
    assert wall.peaks == (61e3, 59e3)
    marks = marks_of(wall.curve, cyclic=wall.is_cyclic, side=wall.side)
    assert marks is not None
    assert (marks.strength, marks.at_peak, marks.stiffness) == pytest.approx((60e3, 0.01, 20e6))
    assert (marks.residual, marks.loops) == (None, ())
    said = "the record is an envelope without cycles; models push the wall once to each side, and no work is compared"
    assert notes_on(wall) == [said]


RIGHT, LEFT = ENVELOPE[3:], ENVELOPE[:4]


@pytest.mark.parametrize(
    "rows",
    [
        [*RIGHT, *LEFT[::-1]],
        [*RIGHT[1:], *LEFT[-2::-1]],
        [*RIGHT[::-1], None, *LEFT],
        [*RIGHT[::-1], None, *LEFT[::-1]],
        [RIGHT[0], RIGHT[1], LEFT[2], RIGHT[2], LEFT[1], RIGHT[3], LEFT[0]],
        [*LEFT[:2], (-10.1, -58), LEFT[2], (-0.1, 1), *RIGHT],
    ],
    ids=["side by side", "without rest", "inward", "across rest", "peaks in turn", "noise"],
)
def test_both_sides_of_an_envelope_are_read_from_rest_in_any_order(
    rows: list[tuple[float, float] | None], tmp_path: Path
) -> None:
    """The step from one side to the other was once read as unloading, with a stiffness of a twentieth.

    Noise of a hundredth of the displacement once made a push to one side of the record.
    """
    curve = "displacement_mm,force_kN\n" + "".join(f"{row[0]},{row[1]}\n" if row else "NaN,NaN\n" for row in rows)
    row = GRANITE.replace("Monotonic", "Cyclic").replace(",61,", ",,")
    (wall,) = read_folder(write_folder(tmp_path, row, curve=curve))
    marks = marks_of(wall.curve, cyclic=wall.is_cyclic, side=wall.side)
    assert marks is not None
    assert (wall.path, wall.peaks) == ((0.02, -0.02), (61e3, 59e3))
    assert (marks.at_peak, marks.stiffness, marks.residual) == pytest.approx((0.01, 20e6, None))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("kind", ["Monotonic", "Cyclic", ""])
def test_record_that_ends_at_rest_is_read_from_there(kind: str, side: int, tmp_path: Path) -> None:
    """Its last row is that of the unloaded wall; read from the first, the secant once went to the farthest point."""
    rows = [f"{side * x},{side * y}\n" for x, y in [(20, 40), (10, 61), (1, 30), (0, 0)]]
    curve = "displacement_mm,force_kN\n" + "".join(rows)
    (wall,) = read_folder(write_folder(tmp_path, GRANITE.replace("Monotonic", kind), curve=curve))
    marks = marks_of(wall.curve, cyclic=wall.is_cyclic, side=wall.side)
    assert marks is not None
    assert (marks.at_peak, marks.stiffness) == pytest.approx((0.01, 30e6))
    said = "the record starts at its largest displacement and ends at rest; it is read from its last row to its first"
    assert said in notes_on(wall)


@pytest.mark.parametrize(
    ("order", "heads", "said"),
    [
        ("time", "force_kN,displacement_mm", "its cycles release energy"),
        ("reverse", "displacement_mm,force_kN", "its cycles release energy"),
        ("sorted", "displacement_mm,force_kN", "its rows are sorted by displacement"),
    ],
)
def test_cycles_that_cannot_be_in_the_order_of_the_test_are_refused(
    order: str, heads: str, said: str, tmp_path: Path
) -> None:
    """Friction of 10 kN beside a spring, to 2 and 4 mm; in any other order its scores were once meaningless."""
    turns = [(0, 10), (2, 20), (2, 0), (-2, -20), (-2, 0), (4, 30), (4, 10), (-4, -30), (-4, -10), (0, 10)]
    rows = [(x + k * (x1 - x) / 4, y + k * (y1 - y) / 4) for (x, y), (x1, y1) in pairwise(turns) for k in range(4)]
    rows = {"time": rows, "reverse": rows[::-1], "sorted": sorted(rows)}[order]
    row = GRANITE.replace("Monotonic", "Cyclic").replace(",61,", ",,")
    curve = "\n".join([heads, *(f"{x},{y}" for x, y in rows)]) + "\n"
    with pytest.raises(SceneError, match=said):
        read_folder(write_folder(tmp_path, row, curve=curve))


def test_cycles_recorded_at_peaks_and_at_rest_are_no_envelope(tmp_path: Path) -> None:
    """The forces at rest, which remain by friction, were once left out with the work of the cycles."""
    rows = [(0, 0), (5, 40), (0, -15), (-5, -40), (0, 15), (10, 60), (0, -20), (-10, -60), (0, 20), (20, 61), (0, -20)]
    curve = "displacement_mm,force_kN\n" + "".join(f"{x},{y}\n" for x, y in [*rows, (-20, -61)])
    row = GRANITE.replace("Monotonic", "Cyclic").replace(",61,", ",,")
    (wall,) = read_folder(write_folder(tmp_path, row, curve=curve))
    assert wall.path == pytest.approx((0.005, -0.005, 0.01, -0.01, 0.02, -0.02))
    assert [round(loop.reach, 9) for loop in loops(wall.curve)] == [0.005, 0.01]


def test_half_a_cycle_is_no_envelope(tmp_path: Path) -> None:
    """On its way from one side to the other a wall that slides resists at rest as well."""
    curve = "displacement_mm,force_kN\n-20,-55\n-18,40\n0,50\n20,61\n"
    (wall,) = read_folder(write_folder(tmp_path, GRANITE.replace("Monotonic", "Cyclic"), curve=curve))
    assert wall.curve[0].tolist() == [-0.02, -55e3]
    assert notes_on(wall) == []


def test_noise_before_a_push_to_one_side_makes_no_envelope(tmp_path: Path) -> None:
    curve = "displacement_mm,force_kN\n-0.01,-0.1\n0,0\n1,30\n10,61\n"
    (wall,) = read_folder(write_folder(tmp_path, GRANITE.replace("Monotonic", "Cyclic"), curve=curve))
    assert (len(wall.curve), wall.path) == (4, (0.01,))
    assert notes_on(wall) == []


@pytest.mark.parametrize("kind", ["Monotonic", "Cyclic"])
def test_push_back_to_the_start_is_no_push_to_the_other_side(kind: str, tmp_path: Path) -> None:
    """A sliding wall resists equally on its way back; for one side only, the largest force there counts."""
    curve = "displacement_mm,force_kN\n0,0\n1,50\n10,61\n9,-55\n0,-60\n"
    row = GRANITE.replace("Monotonic", kind).replace(",61,", ",,")
    assert read_folder(write_folder(tmp_path, row, curve=curve))[0].peaks == (61e3,)


def test_force_of_the_other_side_may_be_signed(tmp_path: Path) -> None:
    """Tables give ``Vmax,-`` as a magnitude or as a signed force; the force of the first side is positive."""
    row = GRANITE.replace("Monotonic", "Cyclic").replace(",61,,", ",61,-43,")
    assert one(tmp_path, row).peaks == (61e3, 43e3)
    assert one(tmp_path, row.replace(",-43,", ",0,")).peaks == (61e3,)  # not pushed to that side
    record = "displacement_mm,force_kN\n0,0\n5,58\n-5,-40\n6,50\n0,0\n"
    cyclic = row.replace("Monotonic", "Cyclic")
    assert read_folder(write_folder(tmp_path, cyclic, curve=record))[0].peaks == (61e3, 43e3)
    # A cyclic wall is scored by the mean of both sides: one that the table leaves out is read from the record.
    for forces, peaks in ((",61,,", (61e3, 40e3)), (",,-43,", (58e3, 43e3)), (",,,", (58e3, 40e3))):
        partly = cyclic.replace(",61,-43,", forces)
        assert read_folder(write_folder(tmp_path, partly, curve=record))[0].peaks == peaks
    for sign, forces in product((1, -1), (",61,,", ",,-61,", ",61,0,", ",0,61,")):
        # Of a push to one side the one number counts, whichever side it is.
        one_sided = "displacement_mm,force_kN\n0,0\n" + f"{5 * sign},{58 * sign}\n{10 * sign},{57 * sign}\n"
        for kind in ("Cyclic", "Monotonic"):
            partly = row.replace("Cyclic", kind).replace(",61,-43,", forces)
            assert read_folder(write_folder(tmp_path, partly, curve=one_sided))[0].peaks == (61e3,)
    with pytest.raises(SceneError, match=re.escape("Vmax,+ = '-61': must be a number above 0")):
        one(tmp_path, row.replace(",61,", ",-61,"))
