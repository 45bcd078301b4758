"""``runningbond show``: the wall before any analysis."""

from pathlib import Path

import numpy as np
import pytest

from runningbond.commands.command_line import command
from runningbond.commands.inventory import rows
from runningbond.compare import published_scene
from runningbond.joints import wall_points
from runningbond.results.reactions import Supports
from runningbond.scene import BlockMaterial, JointMaterial, Lateral, Load, build_scene, scene_from_dict

from ..pictures.scenes import MORTAR, SCENES, line, point, wall
from ..walls import panel


def test_show_lists_blocks_mass_and_weight() -> None:
    """Panel 1 is 1.44 × 0.72 × 0.12 m of 1800 kg/m³, in twelve courses of six or five and two halves."""
    told = dict(rows(published_scene("panel-01")))
    mass = 1800 * 1.44 * 0.72 * 0.12
    assert told["blocks"] == f"{6 * 6 + 6 * 7}, of which 0 held"
    assert told["mass of the wall"] == f"{mass:.5g} kg"
    assert told["weight of movable blocks"] == f"{9.81e-3 * mass:.4g} kN"
    assert told["live load at λ = 1"].startswith(f"({9.81e-3 * mass:.4g}, 0) kN, −")


def test_push_to_the_left_has_a_negative_resultant() -> None:
    told = dict(rows(panel(load__live={"kind": "lateral", "direction": "left"})))
    assert told["live load at λ = 1"].startswith("(−")


def test_resultants_are_those_by_hand_about_the_lower_left_corner() -> None:
    """A floor of 3 kN/m on 2 of 4 m, a lateral force and a moment; the wall weighs 4 × 1.5 × 0.3 × 2000 × 9.81 N."""
    loads = [line(1.5, 1, 3, [0, -3e3]), point(0, 1.0, 2e3, 0), {"kind": "moment", "at": [3.2, 1.1], "moment": 500.0}]
    tables = wall(4.0, 1.5) | {"load": {"gravity": 9.81, "dead": loads, "live": [loads[1], {"kind": "lateral"}]}}
    told = dict(rows(scene_from_dict(tables)))
    assert told["load.dead[0]"] == "3 kN/m along 2 m: (0, −6) kN, −12 kN m about (0, 0)"
    assert told["load.dead[1]"] == "point: (2, 0) kN, −2 kN m about (0, 0)"
    assert told["load.dead[2]"].endswith("(0, 0) N, 500 N m about (0, 0)")
    weight = 4 * 1.5 * 0.3 * 2000 * 9.81e-3
    assert told["load.live[1]"] == f"lateral: ({weight:.4g}, 0) kN, −{weight * 0.75:.4g} kN m about (0, 0)"
    assert told["live load at λ = 1"].startswith(f"({weight + 2:.4g}, 0) kN, −{weight * 0.75 + 2:.4g} kN m")
    assert told["weight of movable blocks"] == f"{weight:.4g} kN"


def test_show_counts_blocks_and_joints_by_material() -> None:
    """Two blocks of 1 × 0.5 × 0.3 m, the upper one of oak, with a joint of mortar between them."""
    tables = wall(1.0, 1.0, (1.0, 0.5)) | {
        "materials": {"oak": {"density": 700.0}},
        "joints": {"mortar": {"friction": 0.75, "cohesion": 1e5}},
        "assign": [{"block": "oak", "box": [[0, 0.5], [1, 1]]}, {"joint": "mortar", "between": ["oak", "block"]}],
    }
    tables["wall"] = tables["wall"] | {"courses": [[1], [1]]}
    del tables["wall"]["length"], tables["wall"]["height"]
    told = dict(rows(scene_from_dict(tables)))
    assert told["  of block"] == "1 block of 2000 kg/m³, 300 kg, 2.943 kN"
    assert told["  of oak"] == "1 block of 700 kg/m³, 105 kg, 1.03 kN"
    assert told["  of joint"] == "1 bed, 0 head: tan φ = 0.6"
    assert told["  of mortar"] == "1 bed, 0 head: tan φ = 0.75, c = 0.1 MPa"
    assert told["contact points"].startswith("4, 2 to a joint")
    assert (told["assign[0]"], told["assign[1]"]) == ("1 block of oak", "1 joint of mortar")


def test_show_reports_the_effect_of_every_assign_entry() -> None:
    """Later entries win: the second takes half of what the first chose, the fourth all that the third did."""
    tables = wall(2.0, 1.0) | {
        "materials": {"oak": {"density": 700.0}, "brick": {"density": 1700.0}},
        "joints": {"mortar": {"friction": 0.75}},
        "assign": [
            {"block": "oak", "blocks": [0, 1, 2, 3]},
            {"block": "brick", "blocks": [2, 3]},
            {"joint": "mortar", "orientation": "head"},
            {"joint": "joint", "box": [[-1, -1], [3, 2]]},
        ],
    }
    scene = scene_from_dict(tables)
    told = dict(rows(scene))
    heads = int((np.ptp(scene.joints.ends[:, :, 0], axis=1) < 1e-9).sum())
    assert told["assign[0]"] == "2 blocks of oak; later entries choose 2 more that it chose"
    assert told["assign[1]"] == "2 blocks of brick"
    assert told["assign[2]"] == f"assigns mortar to nothing: later entries choose all of its {heads} joints"
    assert told["assign[3]"] == f"{len(scene.joints)} joints of joint"
    assert "  of mortar" not in told


def test_show_names_the_blocks_at_the_ends_of_ties() -> None:
    told = dict(rows(scene_from_dict(SCENES["tied"]())))
    assert told["tie[0]"].startswith("from (0.1, 1.6) m, block 39, to (2.9, 1.6) m, block 44, E A / L = 22.5 MN/m")
    assert "to (4, 0.4) m, an anchor fixed in space," in told["tie[1]"]
    assert told["tie[1]"].endswith("yields at 70 kN")


def test_show_describes_the_beam_and_its_drive() -> None:
    """Loads of the beam have their own keys and do not change the numbers of other loads."""
    told = dict(rows(scene_from_dict(SCENES["shear_wall"]())))
    assert told["beam"] == "0.25 m high, 500 kg, 4.905 kN, kept level, free to rise, on joints of mortar"
    assert told["beam.drive"].startswith(
        "moved to 0, 1, −1, 2, −2, 4, −4 mm at 1 mm/s, the force that takes: (1, 0) N, −0.625 N m"
    )
    assert told["beam.force"] == "on the beam: (0, −100) kN, −50 kN m about (0, 0)"
    driven = SCENES["kept_beam"]()
    driven["load"]["live"] = [{"kind": "lateral"}]
    told = dict(rows(scene_from_dict(driven)))
    assert {"beam.drive", "load.live", "beam.force"} <= set(told)


def test_show_describes_supports() -> None:
    assert dict(rows(scene_from_dict(SCENES["cracked"]())))["supports"] == "pin at (0, 0) m, roller at (1.5, 0) m"
    told = dict(rows(scene_from_dict(SCENES["turning_support"]())))
    assert told["supports"] == "ground in 2 pieces"
    assert told["load.live"] == "1 support moved by (−5 mm, 0 mm) and turned by 0.5°; λ is the share of the reaction"
    assert "live load at λ = 1" not in told
    turns = {"kind": "settlement", "box": [[1.0, -1.0], [3.0, 0.0]], "rotation_angle": -1.0}
    told = dict(rows(scene_from_dict(wall(2.0, 1.0, load={"gravity": 9.81, "live": turns}))))
    assert told["load.live"] == "1 support turned by −1°; λ is the share of the reaction"
    held = scene_from_dict(wall(2.0, 1.0, support={"kind": "fixed-first-course"}))
    assert dict(rows(held))["supports"] == "4 fixed blocks"


def test_blocks_that_may_crack_are_counted_whole() -> None:
    told = dict(rows(scene_from_dict(SCENES["cracked"]())))
    assert told["blocks"] == "14 in 24 parts, of which 0 held"
    assert told["joints"].startswith("28, and 10 potential cracks")
    tables = wall(2.0, 1.0, support={"kind": "fixed-first-course"}, inner_joint=MORTAR)
    told = dict(rows(scene_from_dict(tables)))
    assert (told["blocks"], told["supports"]) == ("18 in 32 parts, of which 4 held", "4 fixed blocks")


@pytest.mark.parametrize("name", SCENES)
def test_rows_of_a_scene_have_distinct_labels(name: str) -> None:
    told = rows(scene_from_dict(SCENES[name]()))
    assert len(dict(told)) == len(told)
    assert all(value for _, value in told)


@pytest.mark.parametrize(("suffix", "begins"), [(".svg", b"<?xml"), (".PNG", b"\x89PNG")])
def test_show_draws_the_wall(suffix: str, begins: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / f"wall{suffix}"
    assert command(["show", "wall-w3", "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(begins)
    assert "weight of movable blocks" in capsys.readouterr().out
    plain = picture.read_bytes()
    assert command(["show", "wall-w3", "--numbers", "-o", str(picture)]) == 0
    assert picture.read_bytes() != plain


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["panel-01", "-o", "wall.pdf"], "--out = 'wall.pdf': must end in .svg or .png"),
        (["panel-01", "-o", "wall"], "--out = 'wall': must end in .svg or .png"),
        (["panel-01", "--numbers"], "--numbers: needs a picture to write into"),
        (["panel-77"], "panel-77"),
    ],
)
def test_show_refuses_in_one_line(
    arguments: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command(["show", *arguments]) == 2
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_map_coordinates_are_shown_with_enough_digits() -> None:
    """Two blocks of 0.4 × 0.2 m; with four digits their extent was printed as 5.123e+05 … 5.123e+05."""
    low = np.array([512_345.1, 5_412_345.2])
    blocks = [low + [[0, y], [0.4, y], [0.4, y + 0.2], [0, y + 0.2]] for y in (0.0, 0.2)]
    scene = build_scene(
        "map",
        blocks,
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.7),
        load=Load(live=(Lateral(),)),
    )
    told = dict(rows(scene))
    assert told["extent"] == "x 512345.1 … 512345.5 m, y 5412345.2 … 5412345.6 m, 0.1 m thick"
    assert told["live load at λ = 1"].endswith(" about (512345.1, 5412345.2)")
    assert "ground moment about (512345.3, 5412345.2) [N m]" in Supports(scene, wall_points(scene)).columns


def test_rounding_errors_of_coordinates_are_shown_as_zero() -> None:
    """The springing of a drawn arch is at sin 180° = 1.2e-16; `show` printed "y −1.225e−16 … 1 m"."""
    corners = np.array([[1.0, -np.sin(np.pi)], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]])
    scene = build_scene(
        "springing",
        [corners],
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.7),
        load=Load(live=(Lateral(),)),
    )
    assert dict(rows(scene))["extent"] == "x 1 … 2 m, y 0 … 1 m, 0.1 m thick"
