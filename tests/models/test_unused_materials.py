"""The ``[joint]`` table changes nothing if all joints have named materials."""

from typing import Any

import numpy as np
import pytest

from homog import rigid_moduli
from runningbond.compare.advice.experiment import joints_of
from runningbond.joints import wall_rule
from runningbond.models import run_model
from runningbond.scene import Scene
from tests.at_length import at_length
from tests.walls import courses

STIFF = {"normal_stiffness": 1e9, "shear_stiffness": 4e8}
DRY: dict[str, Any] = {"friction": 0.386} | STIFF
CRUSHES: dict[str, Any] = {"friction": 1.3, "cohesion": 1e5, "compressive_strength": 1e4, "fracture_energy_1": 1.0}
ALL = {"joint": "dry", "between": ["*", "*"]}
GATE: list[list[float]] = [[0.5, 1, 1, 0.5], [1, -1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]]
PANEL: list[list[float]] = [[1, 1, 1], [0.5, 1, 1, 0.5]]


def _wall(joint: dict[str, Any], pattern: list[list[float]] = GATE, **changes: Any) -> Scene:
    return courses(pattern, 0.2, 0.2, joint=joint, joints={"dry": DRY}, assign=[ALL], **changes)


@pytest.fixture(scope="module")
def named() -> Scene:
    """A gate of dry joints of one named material; the unused default material crushes and softens."""
    return _wall(CRUSHES | {"normal_stiffness": 1e7, "shear_stiffness": 1e5})


@pytest.mark.parametrize("model", ["limit", "limit-nonassociated", "dem-static", "dem-dynamic", *at_length("fem")])
def test_unused_joint_material_does_not_change_results(model: str, named: Scene) -> None:
    """The unused default once caused nine points per joint, and a limit load 5 % lower or a refusal."""
    known, scene = (each.with_block(young=1e12) for each in (_wall(DRY), named))
    one, two = (run_model(model, each) for each in (known, scene))
    assert (one.status, one.lower, one.upper) == (two.status, two.lower, two.upper)
    assert np.array_equal(one.force, two.force)


def test_unused_material_sets_points_only_at_finite_displacements(named: Scene) -> None:
    assert len(wall_rule(named).nodes) == 2
    assert len(wall_rule(named, finite=True).nodes) > 2


def test_unused_material_does_not_affect_advice(named: Scene) -> None:
    assert joints_of(named) == joints_of(_wall(DRY))


def test_moduli_depend_on_joints_of_wall_only() -> None:
    one, two = (rigid_moduli(_wall(joint, PANEL)) for joint in (DRY, DRY | {"normal_stiffness": 1e5}))
    assert one == two
