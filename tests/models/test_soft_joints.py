"""Joints that give much: models that follow a wall say so, and do not take a sway for a fall."""

import numpy as np
import pytest

import runningbond as rb
from dem.stiffness_update import resultant_wall
from runningbond.compare import published_scene
from runningbond.limit import elastic_displacement
from runningbond.models import run_model
from tests.at_length import at_length
from tests.walls import panel


@pytest.mark.parametrize(
    ("model", "stiffness", "said"),
    [
        ("dem-static", 1e6, True),
        ("dem-static", 1e9, False),
        ("dem-dynamic", 1e9, False),
        *at_length(("dem-dynamic", 1e6, True)),
    ],
)
def test_joints_soft_in_shear_are_told(model: str, stiffness: float, said: bool) -> None:
    """Slip λ ρ g H / k_s of a course adds up over the height: to 0.2 of one with 1 MPa/m, to nothing with 1 GPa/m."""
    joint = {"friction": 0.6, "normal_stiffness": 2e10, "shear_stiffness": stiffness}
    scene = panel(wall__length=0.96, wall__height=0.72, joint=joint)
    message = run_model(model, scene, 0.05).message
    assert ("joints are too soft: the wall gives by" in message) == said


def test_what_slips_far_at_rest_is_not_soft() -> None:
    """A wall without weight slips by a block's height as the load grows, on joints that give by a hundredth of it."""
    assert "too soft" not in run_model("dem-static", published_scene("point-load-4"), 0.05).message


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", *at_length("fem")])
@pytest.mark.parametrize(("count", "height", "stiffness"), [(20, 1.0, 1e9), (40, 0.25, 1e9), (40, 1.0, 1.04e11)])
def test_a_slender_stack_falls_when_it_overturns_and_not_as_it_sways(
    model: str, count: int, height: float, stiffness: float
) -> None:
    """λ = b / (n h) is exact of small displacements, though the stack sways by up to a block's height on the way."""
    stack = rb.Wall.courses(
        [[1]] * count,
        block_width=0.5,
        block_height=height,
        thickness=0.3,
        density=2000.0,
        friction=0.6,
        normal_stiffness=stiffness,
        shear_stiffness=0.4 * stiffness,
        young=1e12,
    )
    result, exact = stack.run(model), 0.5 / (count * height)
    assert result.status == "collapse"
    assert result.lower is not None
    assert result.upper is not None
    assert result.lower <= exact * (1 + 1e-9) < result.upper <= 1.01 * result.lower


@pytest.mark.parametrize("name", ["panel-04", "panel-10", "point-load-2", "wall-w4"])
def test_what_a_wall_gives_is_the_motion_of_its_joints_resultants(name: str) -> None:
    """Independent routes: springs at Gauss points here, the joints' resultants in the published static solver."""
    scene = published_scene(name).with_block(young=None)
    wall = resultant_wall(scene)
    motion = wall.move(np.ones(wall.law.stiffness.shape, dtype=np.bool_), 0.3 * wall.live)
    assert motion is not None
    farthest = np.abs(motion.reshape(-1, 3)[:, :2]).max()
    assert elastic_displacement(scene, 0.3) == pytest.approx(farthest, rel=1e-9)


@pytest.mark.parametrize("stiffness", [1e9, *at_length(1e10, 1e12)])
def test_a_slender_pier_bears_as_much_on_soft_joints(stiffness: float) -> None:
    """Sixty courses, which sway by two heights of a block on the softest; above `limit` nothing stands."""
    pier = rb.Wall.running_bond(
        length=0.5,
        height=6.0,
        block_width=0.25,
        block_height=0.1,
        thickness=0.3,
        density=2000.0,
        friction=0.6,
        normal_stiffness=stiffness,
        shear_stiffness=0.4 * stiffness,
    )
    result, bound = pier.run("dem-static"), pier.run("limit").upper
    assert result.status == "collapse"
    assert result.lower is not None
    assert bound is not None
    assert 0.99 * bound < result.lower <= bound
