"""Stacks whose joints neither open nor slip: the way of their tops is that of springs in series, model by model."""

from typing import Any

import pytest

from runningbond.models import run_model
from runningbond.scene import Scene
from tests.at_length import at_length
from tests.walls import courses

COUNT, WIDTH, HEIGHT, THICKNESS = 4, 0.5, 0.4, 0.3
NORMAL, SHEAR = 1e9, 4e8
AREA = WIDTH * THICKNESS
TURNS = NORMAL * AREA * WIDTH**2 / 4  # [N m] of a joint that is two springs at its ends

LIFT: dict[str, Any] = {"kind": "point", "at": [WIDTH / 2, COUNT * HEIGHT], "force": [0, 1]}
PRESS: dict[str, Any] = {"kind": "point", "at": [WIDTH / 2, COUNT * HEIGHT], "force": [0, -1]}
PUSH: dict[str, Any] = {"kind": "point", "at": [0.0, COUNT * HEIGHT], "force": [1, 0]}
ARMS = [HEIGHT * (k + 1) for k in range(COUNT)]  # of the push about each joint


def stack(live: dict[str, Any]) -> Scene:
    return courses(
        [[1]] * COUNT,
        width=WIDTH,
        height=HEIGHT,
        wall__thickness=THICKNESS,
        block__young=1e14,
        joint={"friction": 0.7, "cohesion": 1e5, "normal_stiffness": NORMAL, "shear_stiffness": SHEAR},
        load={"gravity": 9.81, "live": live},
    )


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", "fem"])
@pytest.mark.parametrize("live", [LIFT, *at_length(PRESS)])
def test_a_stack_is_lifted_and_pressed_from_where_it_rests(model: str, live: dict[str, Any]) -> None:
    """n / (k_n A) a newton, from nothing at no load: what its weight has pressed it down by is not of the load."""
    curve = run_model(model, stack(live)).curve
    elastic = curve[curve[:, 1] < 1e4]
    assert elastic[0] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert len(elastic) > 4
    assert elastic[:, 0] == pytest.approx(COUNT / (NORMAL * AREA) * elastic[:, 1], rel=1e-3, abs=1e-10)


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_a_stack_that_is_pushed_shears_and_bends(model: str) -> None:
    """Σ 1 / (k_t A) + arm² / (k_n A b² / 4) over the joints, a newton."""
    curve = run_model(model, stack(PUSH)).curve
    elastic = curve[curve[:, 1] < 500.0]  # below what opens the lowest joint, whose tension its weight and glue bear
    exact = sum(1 / (SHEAR * AREA) + arm**2 / TURNS for arm in ARMS)
    assert len(elastic) > 4
    assert elastic[:, 0] == pytest.approx(exact * elastic[:, 1], rel=1e-3, abs=1e-10)
