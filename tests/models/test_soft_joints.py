"""Joints that give much: models that follow a wall say so, and do not take a sway for a fall."""

from typing import Any

import numpy as np
import pytest

import runningbond as rb
from dem.stiffness_update import resultant_wall
from runningbond.compare import published_scene
from runningbond.limit import elastic_displacement
from runningbond.models import find_model, run_model
from runningbond.models.far import going_far
from tests.at_length import at_length
from tests.walls import courses, panel


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


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
@pytest.mark.parametrize(("young", "said"), [(1e9, True), (2.1e11, False)])
def test_a_wall_that_has_turned_far_on_its_tie_is_told(model: str, young: float, said: bool) -> None:
    """A block 0.5 m wide, held at its top by 3 m of 10 mm²: at 3 kN they are longer by 0.9 m, or, of steel, 4 mm.

    At small displacements it falls at (3 kN h + W b / 2) / h all the same, 0.9 m = 1.8 b from where it stood.
    """
    scene = courses(
        [[1]],
        width=0.5,
        height=1.0,
        wall__thickness=0.3,
        joint={"friction": 1.4, "normal_stiffness": 1e10, "shear_stiffness": 1e10},
        load={"gravity": 9.81, "live": {"kind": "point", "at": [0.0, 1.0], "force": [1, 0]}},
        tie=[{"from": [-3.0, 1.0], "to": [0.0, 1.0], "area": 1e-5, "young": young, "yield": 3000.0}],
    )
    outcome = run_model(model, scene)
    assert outcome.lower == pytest.approx(3000 + 9.81 * float(scene.mass[0]) / 4, rel=0.01)
    assert ("of its smaller side, beyond small displacements" in outcome.message) == said


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


def test_what_gives_at_finite_displacements_is_followed_and_not_beyond_them() -> None:
    """A block on joints of 1 MPa/m sinks by 4 mm and leans as it is pushed: small displacements say that it is soft."""
    joint = {"friction": 1.4, "normal_stiffness": 1e6, "shear_stiffness": 4e5}
    scene = courses([[1]], 0.06, 0.24, joint=joint)
    far: dict[str, Any] = {"displacements": "finite", "distance": 0.05}
    assert "too soft" in run_model("dem-dynamic", scene, 0.05).message
    assert "too soft" not in run_model("dem-dynamic", scene, 0.05, **far).message
    assert "too soft" not in run_model(going_far(find_model("dem-dynamic"), **far), scene, 0.05).message
