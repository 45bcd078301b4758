"""Rigid blocks on beds of springs, which lean on soft joints before the mechanism of stiff ones turns."""

from typing import Any

import numpy as np
import pytest

from runningbond.compare import published_scene
from runningbond.compare.advice.knowledge import Knowledge
from runningbond.limit import limit
from runningbond.models import MODELS
from runningbond.models.beds import on_beds
from runningbond.models.edges import leaning, rolls
from runningbond.results import Outcome
from runningbond.scene import Scene, scene_from_dict
from tests.beds import stack_on_beds
from tests.walls import courses

WIDTH, HEIGHT, THICKNESS, WEIGHT = 0.5, 4.0, 0.3, 2000.0 * 9.81  # of a pier, and the weight of its stone


def on_a_plinth(plinth: float, stiffness: float, **changes: Any) -> Scene:
    """A pier on a stiff bed, on a plinth of a given width, as high as the pier is wide, on a soft bed."""
    left = (plinth - WIDTH) / 2
    boxes = [(0.0, 0.0, plinth, WIDTH), (left, WIDTH, WIDTH, HEIGHT)]
    outlines = [[[x, y], [x + w, y], [x + w, y + h], [x, y + h]] for x, y, w, h in boxes]
    tables = {
        "wall": {"outlines": outlines, "thickness": THICKNESS},
        "block": {"density": 2000.0},
        "joint": {"friction": 2.0, "normal_stiffness": stiffness, "shear_stiffness": 0.4 * stiffness},
        "joints": {"stiff": {"friction": 2.0, "normal_stiffness": 1e13, "shear_stiffness": 4e12}},
        "assign": [{"joint": "stiff", "box": [[0.0, WIDTH - 0.01], [plinth, WIDTH + 0.01]]}],
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
    }
    return scene_from_dict(tables | changes)


def as_it_leans(plinth: float, stiffness: float) -> float:
    """Largest λ of the two blocks if the upper bed is rigid: the plinth leans, and the pier upon it may turn."""
    low, high = WEIGHT * THICKNESS * plinth * WIDTH, WEIGHT * THICKNESS * WIDTH * HEIGHT
    turned, spring, both = np.geomspace(1e-6, 0.1, 100_000), stiffness * THICKNESS, low + high
    closed = spring * plinth**3 / 12 * turned
    cracked = both * (plinth / 2 - np.sqrt(2 * both / (9 * spring * turned)))
    lever = low * WIDTH / 2 + high * (WIDTH + HEIGHT / 2)
    leans = np.where(closed < both * plinth / 6, closed, cracked) / lever - turned
    return float(np.minimum(leans, WIDTH / HEIGHT - turned).max())


@pytest.mark.parametrize(("plinth", "stiffness"), [(0.57, 1e10), (0.6, 1e9), (0.6, 1e10), (1.0, 1e8)])
def test_soft_bed_outside_the_mechanism_leans(plinth: float, stiffness: float) -> None:
    scene, exact = on_a_plinth(plinth, stiffness), as_it_leans(plinth, stiffness)
    found = on_beds(scene, WIDTH / HEIGHT)
    assert found is not None
    assert found.load == pytest.approx(exact, rel=0.015)
    assert on_beds(scene, 0.98 * exact) is None
    leans = leaning(scene, limit(scene))  # of the pier alone
    assert leans is not None
    assert leans.load > 0.99 * WIDTH / HEIGHT


@pytest.mark.parametrize(("rows", "stiffness"), [(4, 1e9), (8, 1e9), (8, 1e10), (12, 1e9)])
def test_stack_on_beds(rows: int, stiffness: float) -> None:
    joint = {"friction": 0.8, "normal_stiffness": stiffness, "shear_stiffness": 0.4 * stiffness}
    scene = courses([[1]] * rows, 0.5, 0.5, joint=joint)
    exact = stack_on_beds(rows, 0.5, 0.5, float(scene.mass[0]) * 9.81, 0.12 * stiffness, 0.12 * 0.4 * stiffness)
    found = on_beds(scene, 1 / rows)
    assert found is not None
    assert found.load == pytest.approx(exact, rel=0.01)


def test_mirrored_wall_leans_alike() -> None:
    left = {"gravity": 9.81, "live": {"kind": "lateral", "direction": "left"}}
    one, other = (on_beds(on_a_plinth(0.6, 1e9, **changes), 0.125) for changes in ({}, {"load": left}))
    assert one is not None
    assert other is not None
    assert other == pytest.approx(one, rel=1e-6)


@pytest.mark.parametrize(("name", "lowest"), [("panel-02", 0.4771), ("panel-09", 0.4208), ("wall-w3", 0.3558)])
def test_walls_on_stiff_joints_rest(name: str, lowest: float) -> None:
    """Just below the lowest certified loads, which assume rigid joints."""
    assert on_beds(published_scene(name), 0.995 * lowest) is None


def test_wall_with_held_motions_or_rigid_joints_is_not_judged() -> None:
    tie = {"from": [-3.0, 4.5], "to": [0.05, 4.5], "area": 1e-4, "young": 2e11, "yield": 2000.0}
    assert on_beds(on_a_plinth(0.6, 1e9, tie=[tie]), 0.125) is None
    assert on_beds(courses([[1]] * 8, 0.5, 0.5), 0.125) is None


def test_load_is_not_advised_as_proved_where_soft_joints_lean() -> None:
    scene = on_a_plinth(0.6, 1e9)
    for tolerance, leans in ((0.05, True), (0.15, False)):
        known = Knowledge(scene, tolerance)
        known.learn(MODELS["limit"], limit(scene))
        assert known.evidence == "proof"
        assert (known.on_edges is not None) == leans


def test_push_with_points_at_the_ends_of_joints_tells_what_soft_ones_bear() -> None:
    """The mechanism of the stiff bed loses little."""
    scene = on_a_plinth(0.6, 1e9)
    note = rolls(scene, Outcome("", "dem-dynamic", "collapse", 0.125, 0.125, 0.125), 0.01)
    assert "it bears about 0.11" in note
    assert "or less if joints slide" in note
    assert rolls(scene, Outcome("", "dem-dynamic", "collapse", 0.125, 0.125, 0.125), 0.15) == ""
