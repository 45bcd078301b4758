"""Contacts of single corners: where they are, and that every model sees the same jumps there."""

from typing import Any

import numpy as np
import pytest

from fem_interface.joint_elements import PointsOn, joint_elements, nodal_jump
from meshing import wall_mesh
from runningbond import Wall
from runningbond.contacts.outline import Outline
from runningbond.contacts.search import find_contacts, jumps
from runningbond.joints import lobatto, wall_points, wall_rule, wall_strength
from runningbond.limit.kinematics import jump_operator
from runningbond.scene import Scene
from tests.models.test_corners import LEANING, block


def leaning(**changes: Any) -> Scene:
    """A block whose toe is in the notch of the ground, and a stone on the slope whose tip touches the block's side."""
    return block(LEANING, **changes).scene


def test_corners_touch_sides_in_notches_and_between_ends() -> None:
    joints = leaning().joints
    assert joints.at_corner.tolist() == [False, False, True, True]
    middles = joints.ends[joints.at_corner].mean(axis=1).tolist()
    assert sorted(zip(middles, joints.block[joints.at_corner].tolist(), strict=True)) == [
        ([0.4, pytest.approx(0.0, abs=1e-12)], [0, 2]),
        ([pytest.approx(0.4), pytest.approx(0.2)], [0, 1]),
    ]


def test_normals_point_out_of_the_first_block() -> None:
    """Out of the block's right side to the right, and from the block down into the slope."""
    scene = leaning()
    points = wall_points(scene)
    normals = {
        tuple(points.block[k].tolist()): points.normal[k] for k in np.flatnonzero(scene.joints.at_corner[points.joint])
    }
    assert normals[0, 1] == pytest.approx([1.0, 0.0])
    assert normals[0, 2] == pytest.approx(np.array([1.0, -1.0]) / np.sqrt(2))


def test_bonded_walls_have_joints_wherever_blocks_touch() -> None:
    keys: dict[str, Any] = {
        "block_width": 0.4,
        "block_height": 0.2,
        "thickness": 0.2,
        "density": 2000.0,
    }
    wall = Wall.running_bond(length=2.0, height=1.0, friction=0.6, live={"kind": "lateral"}, **keys)
    assert not wall.scene.joints.at_corner.any()


def test_corners_have_friction_alone_and_the_area_of_the_end_of_a_joint() -> None:
    scene = leaning(cohesion=1e5, tensile_strength=1e4, compressive_strength=1e6, inset=0.01)
    points = wall_points(scene)
    single = scene.joints.at_corner[points.joint]
    strength = wall_strength(scene, points)
    assert not strength.tension[single].any()
    assert not strength.shear[single].any()
    assert (strength.friction == 0.2).all()
    assert (strength.tension[~single] > 0).all()
    crush = [scene.joint_materials[k].compressive_strength for k in scene.material_of_joint]
    assert crush == [1e6, 1e6, None, None]
    of_end = wall_rule(scene).weights[0] * scene.thickness * scene.joints.corner_length.sum()
    assert points.area[single].sum() == pytest.approx(of_end)


def test_material_of_a_corner_alone_is_in_use() -> None:
    """Lime with a cohesion, which the corner does not have."""
    lime = {"friction": 0.9, "cohesion": 1e4, "normal_stiffness": 1e10, "shear_stiffness": 1e10}
    at_toe = {"joint": "lime", "box": [[0.39, -0.01], [0.41, 0.01]]}
    scene = leaning(joints={"lime": lime}, assign=[at_toe])
    assert not scene.notes
    assert [scene.joint_materials[k].friction for k in scene.material_of_joint] == [0.2, 0.2, 0.2, 0.9]
    assert not any(each.is_bonded for each in scene.joint_materials)  # which finite displacements would refuse


@pytest.mark.parametrize("softening", [{}, {"cohesion": 1e4, "fracture_energy_1": 10.0, "fracture_energy_2": 50.0}])
def test_areas_are_those_at_finite_displacements(softening: dict[str, float]) -> None:
    """There, leaning sides overlap, and touch at the first of the points along them; here the corner is the contact."""
    scene = leaning(**softening)
    outline = Outline.of(scene)
    found = find_contacts(outline, np.zeros(3 * len(scene.blocks)), outline.margin)
    opening, _ = jumps(outline, found, found.motion)
    touching = (found.joint < 0) & (np.abs(opening) < scene.blocks.tolerance)
    end = wall_rule(scene).weights[0]
    points = wall_points(scene)
    area = np.bincount(points.joint, points.area)[scene.joints.at_corner]
    assert np.sort(area) == pytest.approx(np.sort(found.area[touching]) * end)


@pytest.mark.parametrize("points", ["elements", "joints"])
@pytest.mark.parametrize("cells", [1, 3])
def test_elements_see_the_jumps_of_rigid_blocks(points: PointsOn, cells: int) -> None:
    """A rigid motion of the blocks, given at the nodes, opens and shears corners as between rigid blocks."""
    scene = leaning()
    motion = np.random.default_rng(3).normal(size=(len(scene.blocks), 3))
    mesh = wall_mesh(scene, cells)
    assert not scene.joints.at_corner[mesh.joint].any()
    x, y = (mesh.points - scene.blocks.centroid[mesh.block]).T
    u, v, turn = motion[mesh.block].T
    elements = joint_elements(mesh, scene, lobatto(), points)
    jump = nodal_jump(elements, len(mesh.points))
    ours = wall_points(scene)
    rigid = jump_operator(ours, scene.blocks.centroid)
    nodes = np.column_stack([u - turn * y, v + turn * x]).ravel()
    for at_nodes, at_blocks in ((jump.opening, rigid.opening), (jump.slip, rigid.slip)):
        found = (at_nodes @ nodes)[elements.points.joint >= 2]
        expected = (at_blocks @ motion.ravel())[ours.joint >= 2]
        assert np.sort(found) == pytest.approx(np.sort(expected), abs=1e-6)
