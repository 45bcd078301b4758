"""Walls that hang on ties: displacement until the ties yield, and models that follow the wall that far."""

from typing import Any

import numpy as np
import pytest

from runningbond.limit import hanging_displacement
from runningbond.models import run_model
from runningbond.scene import Scene
from tests.at_length import at_length
from tests.walls import courses

WIDTH, HEIGHT, THICKNESS, COURSES = 0.5, 3.0, 0.3, 20
YIELD, PRELOAD, LENGTH, BAR = 9e4, 2e4, 4.0, 1e-4
WEIGHT = 1800 * 9.81 * WIDTH * HEIGHT * THICKNESS


def pier(young: float, **changes: Any) -> Scene:
    """A pier of one block per course, with an unbonded bar on its axis from the rock below to its top."""
    middle, head = WIDTH / 2, HEIGHT - HEIGHT / COURSES / 2
    tie = {"from": [middle, head - LENGTH], "to": [middle, head], "area": BAR, "young": young}
    wall: dict[str, Any] = {
        "wall__thickness": THICKNESS,
        "block__young": 1e11,
        "joint": {"friction": 0.8, "normal_stiffness": 1e10, "shear_stiffness": 4e9},
        "tie": [tie | {"yield": YIELD, "preload": PRELOAD}],
    }
    return courses([[1]] * COURSES, width=WIDTH, height=HEIGHT / COURSES, **wall | changes)


@pytest.mark.parametrize("young", [2.1e11, 5e10])
def test_hanging_displacement_of_pier(young: float) -> None:
    """The pier turns about its toe until the bar, b / 2 away, yields; the far corner has a longer lever arm."""
    slack = (YIELD - PRELOAD) * LENGTH / (young * BAR)
    exact = slack / (WIDTH / 2) * np.hypot(WIDTH, HEIGHT)
    assert hanging_displacement(pier(young)) == pytest.approx(exact, rel=1e-6)
    assert hanging_displacement(courses([[1]])) == 0.0


def test_hanging_displacement_weights_ties_by_their_work() -> None:
    """Each tie that lengthens counts by its yield force times its lever arm; one that goes slack does not count."""
    young, head = 2.1e11, HEIGHT - HEIGHT / COURSES / 2
    upright = [(0.2 * WIDTH, 4.0, 9e4, 2e4), (0.7 * WIDTH, 3.5, 3e4, 1e4)]  # place, length, yield force and preload
    steel = {"area": BAR, "young": young}
    ties = [
        {"from": [x, head - length], "to": [x, head], "yield": most, "preload": preload} | steel
        for x, length, most, preload in upright
    ]
    slack = {"from": [0.5 * WIDTH, head], "to": [5.0, head], "yield": 1e4} | steel
    spent = sum(most * (most - preload) * length / (young * BAR) for _, length, most, preload in upright)
    turned = spent / sum(most * (WIDTH - x) for x, _, most, _ in upright)
    scene = pier(young, tie=[*ties, slack])
    assert hanging_displacement(scene) == pytest.approx(turned * np.hypot(WIDTH, HEIGHT), rel=1e-6)


@pytest.mark.parametrize(
    ("model", "young"),
    [
        *(("dem-static", young) for young in (2.1e11, 5e10, 1e10, 1e9)),
        ("dem-dynamic", 5e10),
        *at_length(("dem-dynamic", 2.1e11), ("dem-dynamic", 1e10), ("fem", 1e10)),
    ],
)
def test_pier_load_is_independent_of_bar_stiffness(model: str, young: float) -> None:
    """λ = (W + Y) b / (W H): steel, glass and rope yield at one load, with the head displaced by 0.2 m, 0.7 m or 30 m.

    A pier that has turned so far does not carry this load in reality; messages say so.
    """
    outcome = run_model(model, pier(young))
    exact = (WEIGHT + YIELD) * WIDTH / (WEIGHT * HEIGHT)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= exact * (1 + 1e-6)
    assert exact < outcome.upper <= 1.01 * outcome.lower
    assert "of its smaller side, beyond small displacements" in outcome.message


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", "fem"])
def test_soft_tie_holds_pier_until_wall_slides_beside_it(model: str) -> None:
    """A portal slides at tan φ + c A / W; with a strap at its left pier, only lintel and right pier slide.

    The area A is that of two joints either way. The strap would be a metre longer when it yields.
    """
    glue = {"cohesion": 1000.0, "tensile_strength": 1000.0}
    tie = {"from": [-2.0, 0.1], "to": [0.0, 0.1], "area": 1e-5, "young": 1.2e8, "yield": 320.0}
    scene = courses(
        [[1, -1, 1], [3]],
        width=0.4,
        height=0.2,
        joint={"friction": 0.3, "normal_stiffness": 1e10, "shear_stiffness": 4e9, **glue},
        block__young=1e11,
        tie=[tie],
    )
    exact = 0.3 + 1000.0 * 0.8 * 0.12 / (scene.mass[1:3].sum() * 9.81)
    assert hanging_displacement(scene) > 0.1
    outcome = run_model(model, scene)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert 0.99 * exact < outcome.lower <= exact * (1 + 1e-6)
    assert exact < outcome.upper < 1.01 * exact
