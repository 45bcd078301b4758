"""Joints that give so much that a fall is told by elastic motion: models that follow a wall say so."""

import pytest

from runningbond.compare import published_scene
from runningbond.models import run_model
from tests.walls import panel


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
@pytest.mark.parametrize(("stiffness", "said"), [(1e6, True), (1e9, False)])
def test_joints_soft_in_shear_are_told(model: str, stiffness: float, said: bool) -> None:
    """Slip λ ρ g H / k_s of a course adds up over the height: to 0.2 of one with 1 MPa/m, to nothing with 1 GPa/m."""
    joint = {"friction": 0.6, "normal_stiffness": 2e10, "shear_stiffness": stiffness}
    scene = panel(wall__length=0.96, wall__height=0.72, joint=joint)
    message = run_model(model, scene, 0.05).message
    assert ("joints are too soft: the wall gives by" in message) == said


def test_what_slips_far_at_rest_is_not_soft() -> None:
    """A wall without weight slips by a block's height as the load grows, on joints that give by a hundredth of it."""
    assert "too soft" not in run_model("dem-static", published_scene("point-load-4"), 0.05).message
