"""Order of joints in which the kernels of rigid blocks access memory sequentially."""

from dataclasses import replace

import numpy as np
import pytest

from dem.joint_order import joint_order
from dem.rigid_system import rigid_system
from runningbond.compare import published_scene
from runningbond.draws import Scatter
from runningbond.joints.wall_law import PER_MATERIAL
from tests.walls import courses


@pytest.mark.parametrize("name", ["panel-01", "panel-06", "point-load-2"])
def test_joints_of_many_materials_have_runs_as_long_as_of_one(name: str) -> None:
    scene = published_scene(name)
    drawn = Scatter.read("friction=0.1").draw(scene, 1)
    alike, order = joint_order(scene), joint_order(drawn)
    assert len(order.runs.shape) == len(alike.runs.shape) < len(scene.joints) / PER_MATERIAL
    friction = [drawn.joint_materials[k].friction for k in drawn.material_of_joint[order.points.joint]]
    np.testing.assert_array_equal(rigid_system(drawn).interface.law.of_points(4), friction)


def test_joints_of_two_materials_are_grouped() -> None:
    scene = published_scene("panel-06")
    weaker = replace(scene.joint, friction=scene.joint.friction / 2)
    of_joint = np.arange(len(scene.joints)) % 2
    two = replace(scene, joint_materials=(scene.joint, weaker), material_of_joint=of_joint)
    assert len(rigid_system(two).interface.law.constants) == 2 * 2  # for first points, and for second points


def test_joints_of_different_thickness_are_in_different_runs() -> None:
    """Kernels assume that all joints of a run have the size of its first one."""
    pattern = [[1.0, 1.0, 1.0], [0.5, 1.0, 1.0, 0.5]] * 3
    materials = {"above": {"density": 1800.0, "thickness": 0.1}, "top": {"density": 1800.0, "thickness": 0.05}}
    storeys = {"above": [[0.0, 0.35], [1.2, 0.7]], "top": [[0.0, 0.7], [1.2, 1.05]]}
    assign = [{"block": name, "box": box} for name, box in storeys.items()]
    size = {"joint__normal_stiffness": 1e9, "joint__shear_stiffness": 4e8}
    scene = courses(pattern, wall__thickness=0.3, materials=materials, assign=assign, **size)
    order = joint_order(scene)
    start = order.runs.start.astype(np.int64)
    area = np.repeat(order.runs.shape[:, -1], start[1:] - start[:-1])
    assert area == pytest.approx(order.points.area[: len(area)])
    assert area == pytest.approx((scene.joints.length * scene.thickness_of_joints / 2)[order.points.joint[: len(area)]])
