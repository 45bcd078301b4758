"""Stacks with closed, sticking joints: in every model the top moves as springs in series."""

from typing import Any

import pytest

from runningbond.models import run_model
from runningbond.scene import Scene
from tests.at_length import at_length
from tests.walls import courses

COUNT, WIDTH, HEIGHT, THICKNESS = 4, 0.5, 0.4, 0.3
NORMAL, SHEAR = 1e9, 4e8
AREA = WIDTH * THICKNESS
ROTATIONAL = NORMAL * AREA * WIDTH**2 / 4  # [N m] of a joint with one spring at each end

LIFT: dict[str, Any] = {"kind": "point", "at": [WIDTH / 2, COUNT * HEIGHT], "force": [0, 1]}
PRESS: dict[str, Any] = {"kind": "point", "at": [WIDTH / 2, COUNT * HEIGHT], "force": [0, -1]}
PUSH: dict[str, Any] = {"kind": "point", "at": [0.0, COUNT * HEIGHT], "force": [1, 0]}
ARMS = [HEIGHT * (k + 1) for k in range(COUNT)]  # levers of the push about each joint


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
def test_vertically_loaded_stack_moves_as_springs_in_series(model: str, live: dict[str, Any]) -> None:
    """n / (k_n A) per newton, starting from zero: the settlement under dead load does not count."""
    curve = run_model(model, stack(live)).curve
    elastic = curve[curve[:, 1] < 1e4]
    assert elastic[0] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert len(elastic) > 4
    assert elastic[:, 0] == pytest.approx(COUNT / (NORMAL * AREA) * elastic[:, 1], rel=1e-3, abs=1e-10)


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_pushed_stack_shears_and_bends_as_springs_in_series(model: str) -> None:
    """Σ 1 / (k_t A) + arm² / (k_n A b² / 4) over the joints, per newton."""
    curve = run_model(model, stack(PUSH)).curve
    elastic = curve[curve[:, 1] < 500.0]  # below the load that opens the lowest joint, held by weight and cohesion
    exact = sum(1 / (SHEAR * AREA) + arm**2 / ROTATIONAL for arm in ARMS)
    assert len(elastic) > 4
    assert elastic[:, 0] == pytest.approx(exact * elastic[:, 1], rel=1e-3, abs=1e-10)
