"""The elastic deflection of a stack of blocks on mortar, as a cantilever, by the number of points on its joints."""

from typing import Any

import pytest

from runningbond.models import run_model
from tests.walls import courses

COUNT, WIDTH, HEIGHT, THICKNESS = 4, 0.3, 0.2, 0.25
NORMAL, SHEAR = 1e10, 4e9


@pytest.mark.parametrize(
    ("model", "settings", "strength", "stiffer"),
    [
        ("dem-static", {}, None, 3.0),
        ("dem-dynamic", {}, None, 3.0),
        ("fem", {"points": "joints"}, None, 3.0),
        ("fem", {}, None, 1.5),  # two elements along a joint
        ("fem", {"cells": 2}, None, 1.125),
        ("dem-dynamic", {}, 1e9, 1.0),  # nine points
        ("fem", {}, 1e9, 1.0),
    ],
)
def test_joints_are_stiffer_against_rotation_at_few_points(
    model: str, settings: dict[str, Any], strength: float | None, stiffer: float
) -> None:
    """By 1 + 2 / n² with n elements between points; rotations and slips of joints move the top of rigid blocks."""
    crushing = {} if strength is None else {"compressive_strength": strength}
    glue = {"friction": 0.6, "cohesion": 1e5, "normal_stiffness": NORMAL, "shear_stiffness": SHEAR}
    top = COUNT * HEIGHT
    load = {"gravity": 9.81, "live": {"kind": "point", "at": [WIDTH, top], "force": [1.0, 0.0]}}
    scene = courses(
        [[1]] * COUNT,
        WIDTH,
        HEIGHT,
        wall__thickness=THICKNESS,
        block={"density": 2000.0, "young": 1e13},
        joint=glue | crushing,
        load=load,
    )
    columns = run_model(model, scene, 0.3, **settings).curve_columns()
    area = WIDTH * THICKNESS
    rotation = 12 / (stiffer * NORMAL * area * WIDTH**2)
    expected = sum((top - k * HEIGHT) ** 2 * rotation + 1 / (SHEAR * area) for k in range(COUNT))
    assert columns["displacement"][1] / columns["multiplier"][1] == pytest.approx(expected, rel=5e-3)
