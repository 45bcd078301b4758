"""`assign` gives materials to the selected blocks and joints; later entries override earlier ones."""

from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from runningbond.joints import wall_points
from runningbond.results.scene_arrays import scene_from_arrays, scene_to_arrays
from runningbond.scene import Scene, SceneError, read_scene
from tests.walls import content, panel, write_toml

from .test_scene import GROUND

MATERIALS: dict[str, Any] = {
    "materials": {"oak": {"density": 700.0}, "stone": {"density": 2600.0}},
    "joints": {"mortar": {"friction": 0.75, "cohesion": 1e5}, "dust": {"friction": 0.3, "inset": 0.01}},
}


def assigned(*entries: dict[str, Any], **changes: Any) -> Scene:
    return panel(**MATERIALS, assign=list(entries), **changes)


def names_of_blocks(scene: Scene) -> list[str]:
    return [scene.block_materials[k].name for k in scene.material_of_block]


def names_of_joints(scene: Scene) -> list[str]:
    return [scene.joint_materials[k].name for k in scene.material_of_joint]


def test_box_without_height_chooses_the_bed_joints_on_it() -> None:
    """Boxes include their border. Such a box was refused for its corners, which are in the right order."""
    scene = assigned({"joint": "dust", "box": [[0, 0.06], [1.44, 0.06]]})
    chosen = np.array(names_of_joints(scene)) == "dust"
    level = scene.joints.ends[:, :, 1].mean(axis=1)
    assert chosen.tolist() == (np.abs(level - 0.06) < 1e-9).tolist()
    with pytest.raises(SceneError, match="must have its lower left corner first"):
        assigned({"joint": "dust", "box": [[0, 0.07], [1.44, 0.06]]})


def test_later_entries_win() -> None:
    scene = assigned(
        {"block": "oak", "box": [[0, 0], [1.44, 0.3]]},
        {"block": "stone", "blocks": [0, 1]},
        {"block": "block", "blocks": [1]},
    )
    names = names_of_blocks(scene)
    assert names[:2] == ["stone", "block"]
    low = scene.blocks.centroid[:, 1] <= 0.3
    assert {names[k] for k in np.flatnonzero(scene.wall & low)[2:]} == {"oak"}
    assert {names[k] for k in np.flatnonzero(scene.wall & ~low)} == {"block"}
    assert scene.mass[0] == pytest.approx(2600 * scene.blocks.area[0] * 0.12)
    assert scene.mass[2] == pytest.approx(700 * scene.blocks.area[2] * 0.12)


def test_material_names_may_contain_dots(tmp_path: Path) -> None:
    """Two names with the same ending, and one that ends in the keyword "joint"."""
    tables: dict[str, Any] = {
        "materials": {"oak.1": {"density": 700.0}, "stone.1": {"density": 2600.0}},
        "joints": {"my.joint": {"friction": 0.3}},
        "assign": [
            {"block": "oak.1", "blocks": [0]},
            {"block": "stone.1", "blocks": [1]},
            {"joint": "my.joint", "between": ["oak.1", "*"]},
        ],
    }
    for scene in (panel(**tables), read_scene(write_toml(content(**tables), tmp_path / "wall.toml"))):
        assert names_of_blocks(scene)[:2] == ["oak.1", "stone.1"]
        beside = (scene.joints.block == 0).any(axis=1)
        assert np.array_equal(beside, [name == "my.joint" for name in names_of_joints(scene)])


def test_bed_and_head_joints_get_separate_materials() -> None:
    scene = assigned({"joint": "mortar", "orientation": "bed"}, {"joint": "dust", "orientation": "head"})
    run = np.abs(scene.joints.ends[:, 1] - scene.joints.ends[:, 0])
    assert names_of_joints(scene) == ["mortar" if dx > dy else "dust" for dx, dy in run]


@pytest.mark.parametrize(("height", "courses"), [(0.1, 3), (0.2, 3), (0.2, 6), (0.3, 3), (0.7, 3)])
def test_joints_on_the_border_of_a_box_are_inside(height: float, courses: int) -> None:
    """Whatever the rounding: three courses of 0.1 m end at 0.30000000000000004 m, but users write 0.3."""
    size = {"length": 1.2, "height": round(8 * height, 9), "block_width": 0.3, "block_height": height, "thickness": 0.1}
    level = round(courses * height, 9)
    for box in ([[0, level], [2, 9]], [[0, 0], [2, level]]):
        scene = assigned({"joint": "dust", "box": box}, wall=size)
        on = np.flatnonzero((np.abs(scene.joints.ends[:, :, 1] - level) < 1e-9).all(axis=1))
        assert len(on)
        assert {names_of_joints(scene)[joint] for joint in on} == {"dust"}


@pytest.mark.parametrize(("width", "number"), [(0.1, 1), (0.2, 1), (0.2, 3), (0.4, 1), (0.4, 6)])
def test_blocks_centred_on_the_border_of_a_box_are_inside(width: float, number: int) -> None:
    size = {"length": round(8 * width, 9), "height": 0.3, "block_width": width, "block_height": 0.1, "thickness": 0.1}
    middle = round((number + 0.5) * width, 9)
    for box in ([[middle, 0], [9, 1]], [[0, 0], [middle, 1]]):
        scene = assigned({"block": "oak", "box": box}, wall=size)
        on = np.flatnonzero(scene.wall & (np.abs(scene.blocks.centroid[:, 0] - middle) < 1e-9))
        assert len(on) == 2
        assert {names_of_blocks(scene)[block] for block in on} == {"oak"}


def test_joints_selected_by_their_two_block_materials() -> None:
    """In either order; "*" stands for any block, "ground" for the ground below the wall."""
    oak = {"block": "oak", "box": [[0, 0.1], [1.44, 0.2]]}
    scene = assigned(
        oak, {"joint": "mortar", "between": ["*", "oak"]}, {"joint": "dust", "between": ["ground", "block"]}
    )
    blocks = np.array([*names_of_blocks(scene)[:-1], "ground"], dtype=object)[scene.joints.block]
    for pair, name in zip(blocks, names_of_joints(scene), strict=True):
        assert name == ("mortar" if "oak" in pair else "dust" if "ground" in pair else "joint")


def test_box_selects_joints_by_their_midpoint() -> None:
    scene = assigned({"joint": "mortar", "box": [[0, 0.35], [1.44, 0.37]]})
    middle = scene.joints.ends.mean(axis=1)[:, 1]
    assert names_of_joints(scene) == ["mortar" if 0.35 <= y <= 0.37 else "joint" for y in middle]


def test_inner_joints_keep_their_material_and_half_blocks_that_of_their_block() -> None:
    inner = {"friction": 1.0, "cohesion": 1e6}
    scene = assigned({"block": "oak", "blocks": [0]}, {"joint": "mortar", "box": [[-9, -9], [9, 9]]}, inner_joint=inner)
    names = np.array(names_of_joints(scene))
    assert (names == np.where(scene.joints.inner, "inner_joint", "mortar")).all()
    assert names_of_blocks(scene)[:2] == ["oak", "oak"]
    assert names_of_blocks(scene)[2] == "block"


@pytest.mark.parametrize("drawn", ["OAK", "Oak", "oak"])
def test_blocks_and_joints_by_layer(drawn: str, tmp_path: Path) -> None:
    """Layer names are not case-sensitive, as in CAD programs."""
    document = ezdxf.new()  # type: ignore[attr-defined]
    for layer, y in (("0", 0.0), (drawn, 100.0)):
        corners = [(0.0, y), (200.0, y), (200.0, y + 100.0), (0.0, y + 100.0)]
        document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    document.modelspace().add_lwpolyline(GROUND, close=True)
    document.saveas(tmp_path / "wall.dxf")
    wall = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    entries = [{"block": "oak", "layer": "OAK"}, {"joint": "mortar", "layer": "OAK"}]
    scene = read_scene(write_toml(content(wall=wall, assign=entries, **MATERIALS), tmp_path / "wall.toml"))
    assert names_of_blocks(scene)[:2] == ["block", "oak"]
    of = dict(zip(map(tuple, scene.joints.block.tolist()), names_of_joints(scene), strict=True))
    assert of == {(0, 1): "mortar", (0, 2): "joint"}


def test_scene_with_beam_tie_and_loads_survives_storage_as_arrays() -> None:
    beam = {"height": 0.1, "mass": 20.0, "condition": "level", "drive": {"force": [1, 0], "at": 0.7}}
    tie = {"from": [0, 0.39], "to": [9, 0.39], "area": 3e-4, "young": 2.1e11, "yield": 7e4}
    line = {"kind": "line", "from": [0, 0.6], "to": [1.44, 0.6], "force": [0, -1e3]}
    scene = assigned({"block": "oak", "blocks": [0]}, load__dead=[line], beam=beam, tie=[tie])
    again = scene_from_arrays(scene_to_arrays(scene))
    assert again.beam == scene.beam
    assert again.extras == scene.extras == ("tie", "beam")
    assert (again.material_of_block == scene.material_of_block).all()
    assert (again.ties.ends == scene.ties.ends).all()
    assert (again.dead_forces.force == scene.dead_forces.force).all()


def test_unused_materials_are_dropped_with_a_note() -> None:
    """If kept, the unused crushing joint would give all joints nine points and require a stiffness."""
    unused = {
        "materials": {"oak": {"density": 700.0}},
        "joints": {"weak": {"friction": 0.1, "compressive_strength": 1e6}},
    }
    plain, scene = panel(), panel(**unused)
    assert (scene.block_materials, scene.joint_materials) == (plain.block_materials, plain.joint_materials)
    assert len(wall_points(scene)) == len(wall_points(plain))
    assert scene.notes == (
        "materials.oak: is assigned to nothing; it is left out",
        "joints.weak: is assigned to nothing; it is left out",
    )
