"""Soft joints: models report large elastic displacements and do not take swaying for collapse."""

from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array

import runningbond as rb
from dem.stiffness_update import resultant_wall
from runningbond.compare import published_scene
from runningbond.limit import elastic_displacement
from runningbond.limit.elastic import held_motion
from runningbond.models import MODELS, find_model, run_model
from runningbond.models.far import going_far
from runningbond.models.notes import keeps_strength
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
def test_joints_soft_in_shear_are_reported(model: str, stiffness: float, said: bool) -> None:
    """Slip λ ρ g H / k_s of the courses adds up: to 0.2 course heights at 1 MPa/m, and to nothing at 1 GPa/m."""
    joint = {"friction": 0.6, "normal_stiffness": 2e10, "shear_stiffness": stiffness}
    scene = panel(wall__length=0.96, wall__height=0.72, joint=joint)
    message = run_model(model, scene, 0.05).message
    assert ("joints are too soft: the wall gives by" in message) == said


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
@pytest.mark.parametrize(("young", "said"), [(1e9, True), (2.1e11, False)])
def test_large_rotation_on_soft_tie_is_reported(model: str, young: float, said: bool) -> None:
    """A block 0.5 m wide, held at its top by a tie of 3 m and 10 mm²: at 3 kN it is 0.9 m longer, or 4 mm if of steel.

    At small displacements the limit load is (3 kN h + W b / 2) / h in both cases, also after 0.9 m = 1.8 b.
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


def test_large_slip_at_rest_is_not_reported_as_soft() -> None:
    """A weightless wall slips by a block's height as the load grows, on joints that deform by 1/100 of it."""
    assert "too soft" not in run_model("dem-static", published_scene("point-load-4"), 0.05).message


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", *at_length("fem")])
@pytest.mark.parametrize(("count", "height", "stiffness"), [(20, 1.0, 1e9), (40, 0.25, 1e9), (40, 1.0, 1.04e11)])
def test_slender_stack_collapses_by_overturning_not_by_swaying(
    model: str, count: int, height: float, stiffness: float
) -> None:
    """λ = b / (n h) is exact for small displacements, although the stack sways by up to a block's height before."""
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
def test_elastic_displacement_agrees_with_resultant_joints(name: str) -> None:
    """Independent methods: springs at Gauss points here, joint resultants in the published static solver."""
    scene = published_scene(name).with_block(young=None)
    wall = resultant_wall(scene)
    motion = wall.move(np.ones(wall.law.stiffness.shape, dtype=np.bool_), 0.3 * wall.live)
    assert motion is not None
    farthest = np.abs(motion.reshape(-1, 3)[:, :2]).max()
    assert elastic_displacement(scene, 0.3) == pytest.approx(farthest, rel=1e-9)


def test_motion_on_soft_springs_is_exact_and_on_vanishing_ones_loose() -> None:
    """Force over stiffness at a thousandth of the stiffest spring; a block on a trillionth of it counts as loose."""
    load, no_pins = np.array([0.0, 1.0]), csr_array((0, 2))
    motion = held_motion(csr_array(np.diag([1.0, 1e-3])), no_pins, load, stiffest=1.0)
    assert motion == pytest.approx(np.array([0.0, 1e3]))
    assert held_motion(csr_array(np.diag([1.0, 1e-12])), no_pins, load, stiffest=1.0) is None


@pytest.mark.parametrize("stiffness", [1e9, *at_length(1e10, 1e12)])
def test_limit_load_of_slender_pier_does_not_depend_on_joint_stiffness(stiffness: float) -> None:
    """Sixty courses, swaying by two block heights on the softest joints; `limit` is an upper bound."""
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


def test_soft_joints_are_not_reported_at_finite_displacements() -> None:
    """A block on joints of 1 MPa/m sinks by 4 mm and leans under the push: reported only for small displacements."""
    joint = {"friction": 1.4, "normal_stiffness": 1e6, "shear_stiffness": 4e5}
    scene = courses([[1]], 0.06, 0.24, joint=joint)
    far: dict[str, Any] = {"displacements": "finite", "distance": 0.05}
    assert "too soft" in run_model("dem-dynamic", scene, 0.05).message
    assert "too soft" not in run_model("dem-dynamic", scene, 0.05, **far).message
    assert "too soft" not in run_model(going_far(find_model("dem-dynamic"), **far), scene, 0.05).message


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_modulus_of_named_material_does_not_soften_rigid_blocks(model: str) -> None:
    """Outcome and message of rigid blocks are the same with and without a modulus, apart from the note on its key."""
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 1e10}
    named: dict[str, Any] = {"materials": {"soft": {"density": 1800.0, "young": 1e4}}}
    named |= {"assign": [{"block": "soft", "box": [[-1.0, -1.0], [9.0, 9.0]]}]}
    size: dict[str, Any] = {"wall__length": 0.48, "wall__height": 0.24}
    rigid, soft = (run_model(model, panel(**size, joint=joint, **given), 0.05) for given in ({}, named))
    assert soft.status == "collapse"
    assert (soft.lower, soft.upper) == (rigid.lower, rigid.upper)
    assert soft.message == f"{rigid.message}; not taken into account: materials.soft.young"


def test_lost_strength_is_told_if_one_joint_loses_it_and_the_model_does_not_follow() -> None:
    """The joints on the ground soften, and those above it do not; `dem-static` keeps their strength."""
    mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
    fracture = {"cohesion": 1e5, "tensile_strength": 1e5, "fracture_energy_1": 10.0, "fracture_energy_2": 100.0}
    lime = {"friction": 0.6, "mortar": mortar, **fracture}
    assign = [{"joint": "lime", "box": [[-1.0, -0.01], [2.0, 0.01]]}]
    strong, weak = panel(joint__mortar=mortar), panel(joint__mortar=mortar, joints={"lime": lime}, assign=assign)
    assert "keep the strength that they lose" in keeps_strength(MODELS["dem-static"], weak)
    assert keeps_strength(MODELS["dem-dynamic"], weak) == ""
    assert keeps_strength(MODELS["dem-static"], strong) == ""
