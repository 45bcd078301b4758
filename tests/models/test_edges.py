"""Pushed walls whose joints bear at their ends: what joints along their whole length would bear."""

from dataclasses import replace

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from runningbond.limit import limit
from runningbond.models import run_model
from runningbond.models.beds import along_joints
from runningbond.models.edges import leaning, load_of_beds, rolls
from runningbond.scene import Scene
from tests.walls import courses

WIDTH, HEIGHT, THICKNESS = 0.5, 4.0, 0.3
SOFT = {"friction": 0.8, "normal_stiffness": 1e9, "shear_stiffness": 4e8}


def tower(stiffness: float, rows: int = 1, **joint: float) -> Scene:
    """A slender tower of blocks on soft or stiff joints."""
    joints = {"friction": 0.8, "normal_stiffness": stiffness, "shear_stiffness": 0.4 * stiffness} | joint
    return courses([[1]] * rows, WIDTH, HEIGHT / rows, wall__thickness=THICKNESS, joint=joints)


def on_a_bed(scene: Scene, stiffness: float) -> float:
    """Largest λ of a block on a bed of springs without tension, as it leans: (b / 2 − 3 e / 2) / (h / 2)."""
    weight = float(scene.mass[0]) * 9.81
    e = (2 * weight * HEIGHT / (9 * stiffness * THICKNESS)) ** (1 / 3)
    return float((WIDTH / 2 - 1.5 * e) / (HEIGHT / 2))


@pytest.mark.parametrize("stiffness", [1e9, 1e10])
def test_load_of_a_block_on_a_bed_is_told(stiffness: float) -> None:
    """Points at the ends of its joint give the rigid block's b / h, nine points along it the bed's load."""
    scene = tower(stiffness)
    outcome = dem_dynamic(scene, displacements="finite")
    exact = on_a_bed(scene, stiffness)
    assert outcome.multiplier == pytest.approx(WIDTH / HEIGHT, rel=0.01)
    assert load_of_beds(scene, outcome) == pytest.approx(exact, rel=0.01)
    spread = dem_dynamic(tower(stiffness, compressive_strength=1e12), displacements="finite")
    assert spread.multiplier == pytest.approx(exact, rel=0.015)
    assert f"it bears about {load_of_beds(scene, outcome):.4f}" in rolls(scene, outcome, 0.01)
    assert rolls(scene, outcome, 1.1 * (1 - exact * HEIGHT / WIDTH)) == ""


def test_stiff_joints_and_joints_with_points_along_them_are_not_told() -> None:
    for scene in (tower(1e14), tower(1e9, compressive_strength=1e12)):
        assert "roll onto their edges" not in run_model("dem-dynamic", scene, displacements="finite").message
    assert "roll onto their edges" in run_model("dem-dynamic", tower(1e9), displacements="finite").message
    assert "roll onto their edges" not in run_model("dem-dynamic", tower(1e9)).message


def test_every_joint_that_turns_counts() -> None:
    """Two blocks that turn as one on the ground: the joint between them stays closed and does not count."""
    scene = tower(1e9, rows=2)
    outcome = dem_dynamic(scene, displacements="finite")
    whole = tower(1e9)
    assert load_of_beds(scene, outcome) == pytest.approx(on_a_bed(whole, 1e9), rel=0.01)


@pytest.mark.parametrize("rows", [1, 8])
@pytest.mark.parametrize("stiffness", [1e9, 1e10])
def test_load_as_it_leans_follows_from_forces_and_mechanism_at_small_displacements(rows: int, stiffness: float) -> None:
    scene = tower(stiffness, rows)
    leans = leaning(scene, limit(scene))
    assert leans is not None
    assert leans.load == pytest.approx(on_a_bed(tower(stiffness), stiffness), rel=0.003)
    weight = float(scene.mass[~scene.fixed].sum()) * 9.81
    part = (2 * weight * HEIGHT / (9 * stiffness * THICKNESS)) ** (1 / 3)  # where its loss and that of leaning balance
    turned = 2 * weight / (9 * stiffness * THICKNESS * part**2)
    assert leans.moved == pytest.approx(turned * np.hypot(WIDTH, HEIGHT), rel=0.06)


def test_load_on_top_of_a_wall_counts_as_it_leans() -> None:
    """A load Q in the middle of its top loses its lever arm twice as fast as the weight."""
    load, stiffness = 2e4, 1e10
    top = {"kind": "point", "at": [WIDTH / 2, HEIGHT], "force": [0.0, -load]}
    scene = courses(
        [[1]], WIDTH, HEIGHT, wall__thickness=THICKNESS, joint=SOFT | {"normal_stiffness": stiffness}, load__dead=top
    )
    leans, weight = leaning(scene, limit(scene)), float(scene.mass[0]) * 9.81
    turned = np.geomspace(1e-6, 0.1, 100_000)
    part = np.sqrt(2 * (weight + load) / (9 * stiffness * THICKNESS * turned))
    most = (weight + load) * WIDTH / (weight * HEIGHT)
    arm = (weight + load) * (WIDTH / 2 - part)
    arm -= turned * (weight * HEIGHT / 2 + load * HEIGHT + most * weight * WIDTH / 2)
    assert leans is not None
    assert leans.load == pytest.approx(float(arm.max()) / (weight * HEIGHT / 2), rel=0.001)


def test_tie_that_yields_turns_and_lengthens_as_a_wall_leans() -> None:
    """A level tie at the head of a block, T at a height h; λ from the moments about its toe, at any rotation."""
    most, stiffness, anchor = 2000.0, 1e10, -1.0
    tie = {"from": [anchor, HEIGHT], "to": [0.0, HEIGHT], "area": 1e-4, "young": 2e11, "yield": most}
    joint = SOFT | {"normal_stiffness": stiffness}
    scene = courses([[1]], WIDTH, HEIGHT, wall__thickness=THICKNESS, joint=joint, tie=[tie])
    leans, weight = leaning(scene, limit(scene)), float(scene.mass[0]) * 9.81
    turned = np.geomspace(1e-6, 0.05, 100_000)
    cosine, sine = np.cos(turned), np.sin(turned)
    x, y = -WIDTH * cosine + HEIGHT * sine, WIDTH * sine + HEIGHT * cosine  # head, from the toe
    along = np.array([anchor - WIDTH - x, HEIGHT - y])
    fx, fy = most * along / np.hypot(*along)
    arm, up = WIDTH / 2 * cosine - HEIGHT / 2 * sine, HEIGHT / 2 * cosine + WIDTH / 2 * sine
    rolled = weight * np.sqrt(2 * weight / (9 * stiffness * THICKNESS * turned))
    exact = float(((weight * arm + fy * x - fx * y - rolled) / (weight * up)).max())
    assert leans is not None
    assert leans.load == pytest.approx(exact, rel=0.001)


def test_joints_along_their_length_are_those_that_spread() -> None:
    scene = tower(1e9, compressive_strength=1e7)
    assert along_joints(scene) is scene
    exact = on_a_bed(tower(1e10), 1e10)
    spread = dem_dynamic(along_joints(tower(1e10)), displacements="finite")
    assert spread.multiplier == pytest.approx(exact, rel=0.015)


def test_toe_that_crushes_does_not_roll_as_well() -> None:
    """N is so far from the edge of a joint that crushes that a bed of stiff springs bears nothing less."""
    scene = tower(1e11, compressive_strength=2e5)
    outcome = run_model("dem-dynamic", scene)
    leans = leaning(scene, outcome)
    assert leans is not None
    assert leans.load == pytest.approx(outcome.multiplier, rel=0.03)


def test_no_load_without_mechanism_or_peak() -> None:
    scene = tower(1e9)
    assert load_of_beds(scene, limit(scene)) is None
    whole = dem_dynamic(scene, displacements="finite")
    assert load_of_beds(scene, replace(whole, path=np.zeros((0, 0)), path_columns=())) is None
    short = dem_dynamic(scene, displacements="finite", distance=0.002)
    assert np.abs(short.curve[:, 0]).max() < 0.01
    assert load_of_beds(scene, short) is None
    leans = leaning(scene, short)
    assert leans is not None
    assert leans.load == pytest.approx(on_a_bed(scene, 1e9), rel=0.01)
    assert f"it bears about {leans.load:.4f}" in rolls(scene, short, 0.01)


@pytest.mark.long
def test_load_of_a_wall_that_a_tie_holds_at_its_top() -> None:
    """Two blocks bulge while the point at which displacements are read is held by the tie."""
    tie = {"from": [-3.0, HEIGHT], "to": [0.0, HEIGHT], "area": 1e-4, "young": 2e10, "yield": 2000.0}
    two, nine = (
        courses([[1]] * 2, WIDTH, HEIGHT / 2, joint=SOFT | joint, tie=[tie])
        for joint in ({}, {"compressive_strength": 1e12})
    )
    outcome = dem_dynamic(two, displacements="finite", distance=0.06)
    spread = dem_dynamic(nine, displacements="finite", distance=0.06)
    assert outcome.multiplier == pytest.approx(0.5, rel=0.01)
    assert spread.multiplier is not None
    assert spread.multiplier < 0.9 * 0.5
    assert load_of_beds(two, outcome) == pytest.approx(spread.multiplier, rel=0.015)
