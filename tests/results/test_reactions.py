"""Reactions and works along a path: in every state the reactions balance the loads."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from runningbond.joints import wall_points
from runningbond.models import run_model
from runningbond.results import Outcome, Supports, load_outcome, save_outcome
from runningbond.results.reactions import AT_REST, WORKS
from runningbond.scene import Array, BlockMaterial, JointMaterial, Lateral, Load, Scene, build_scene
from tests.at_length import at_length

from ..walls import courses, panel

STIFFNESS = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
POINT = {"gravity": 9.81, "live": {"kind": "point", "at": [0.24, 0.18], "force": [100.0, -30.0]}}
WALLS: dict[str, dict[str, Any]] = {
    "base": {},
    "held course": {"support__kind": "fixed-first-course"},
    "corners": {"support__kind": "corners"},
    "pinned": {"support__kind": "pinned-corners"},
    "pushed left": {"load__live": {"kind": "lateral", "direction": "left"}},
    "point": {"load": POINT},
}


def wall(name: str) -> Scene:
    """Three courses of two blocks."""
    size = {"wall__length": 0.48, "wall__height": 0.18, "block__young": 1e12}
    return panel(**size, joint={"friction": 0.6, "cohesion": 2e3} | STIFFNESS, **WALLS[name])


def sums(scene: Scene, outcome: Outcome) -> tuple[Array, Array]:
    """Sums of reactions of all supports and of loads on free blocks, about the origin, for each row ``(n, 3)``."""
    about, total = Supports(scene, wall_points(scene)).about, np.zeros((len(outcome.path), 3))
    for k, (x, y) in enumerate(about):
        px, py, moment = outcome.path[:, 3 * k : 3 * k + 3].T
        total += np.column_stack([px, py, moment + x * py - y * px])
    load = np.zeros((2, 3))
    for row, forces in zip(load, (scene.dead_forces, scene.live_forces), strict=True):
        free = ~scene.fixed
        push = (scene.mass[:, None] * forces.acceleration)[free]
        at, push = np.vstack([scene.blocks.centroid[free], forces.at]), np.vstack([push, forces.force])
        row[:2], row[2] = push.sum(axis=0), (at[:, 0] * push[:, 1] - at[:, 1] * push[:, 0]).sum()
    return total, load[0] + outcome.curve_columns()["multiplier"][:, None] * load[1]


TOLERANCES = {"limit": 1e-6, "limit-nonassociated": 1e-6, "dem-static": 1e-6, "dem-dynamic": 3e-4}
EACH = [(model, tolerance, name) for model, tolerance in TOLERANCES.items() for name in WALLS]


@pytest.mark.parametrize(
    ("model", "tolerance", "name"),
    [*EACH, ("fem", 3e-4, "base"), ("fem", 3e-4, "point"), *at_length(("fem", 3e-4, "corners"))],
)
def test_reactions_balance_loads_in_every_state_at_rest(model: str, tolerance: float, name: str) -> None:
    """In force and moment, to the tolerance of a program, or of rest, which is 1e-5 weights for each block."""
    scene = wall(name)
    outcome = run_model(model, scene, 0.3)
    rests = outcome.curve_columns()[AT_REST] == 1
    assert rests.any(), outcome.message
    reactions, loads = sums(scene, outcome)
    assert np.abs(reactions + loads)[rests].max() < tolerance * np.abs(loads[rests]).max()
    held = np.unique(scene.pins.block)
    for k in np.flatnonzero(np.isin(Supports(scene, wall_points(scene)).block, held)):
        assert np.abs(outcome.path[rests, 3 * k + 2]).max() < tolerance * np.abs(loads[rests]).max()


def test_reaction_of_block_by_hand() -> None:
    """A block of 1 m × 2 m × 1 m and 1000 kg/m³ topples at λ = 0.5, with its reaction at the right corner."""
    joint = {"friction": 0.9} | STIFFNESS
    scene = courses([[1]], width=1, height=2, wall__thickness=1.0, block__density=1000.0, joint=joint)
    outcome = run_model("limit", scene)
    weight = 2000 * 9.81
    columns = outcome.curve_columns()
    heads = ("horizontal [N]", "vertical [N]", "moment about (0.5, 0) [N m]")
    horizontal, vertical, moment = (float(columns[f"ground {head}"][0]) for head in heads)
    assert (horizontal, vertical) == pytest.approx((-weight / 2, weight))
    assert moment == pytest.approx(0.5 * weight)
    assert np.isnan([columns[work][0] for work in WORKS]).all()


def test_reference_points_are_printed_without_rounding_errors() -> None:
    """An arch about the origin, whose springings are at 1e-16 m because of sin π."""
    rays = [(math.cos(angle), math.sin(angle)) for angle in np.linspace(math.pi, 0, 4)]
    ends = np.array([[0.7 * np.array(ray), 1.3 * np.array(ray)] for ray in rays])
    voussoirs = [np.array([a[0], b[0], b[1], a[1]]) for a, b in pairwise(ends)]
    joint, load = JointMaterial(0.7), Load(live=(Lateral(),))
    scene = build_scene("arch", voussoirs, thickness=0.1, block=BlockMaterial(2000.0), joint=joint, load=load)
    assert "ground moment about (0, 0) [N m]" in Supports(scene, wall_points(scene)).columns


def test_each_piece_of_stepped_ground_is_a_support() -> None:
    """A beam with its weight in the middle between two held blocks, each of which carries half of it."""
    joint = {"friction": 0.6} | STIFFNESS
    scene = courses([[1, -1, 1], [3]], width=0.2, height=0.2, joint=joint, support__kind="fixed-first-course")
    outcome = run_model("dem-static", scene, 0.05)
    columns, weight = outcome.curve_columns(), 9.81 * float(scene.mass[~scene.fixed].sum())
    vertical = [values[0] for name, values in columns.items() if "vertical" in name]
    assert vertical == pytest.approx([weight / 2, weight / 2], rel=1e-6)
    assert [name.split(" horizontal")[0] for name in columns if "horizontal" in name] == ["block 0", "block 1"]


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_works_of_loads_along_path(model: str) -> None:
    """A force P = λ f at the control point does the work ∫ P du; the dead load does positive work at first."""
    scene = wall("point")
    outcome = run_model(model, scene, 0.1)
    columns = outcome.curve_columns()
    rests = columns[AT_REST] == 1
    moved, load = columns["displacement"][rests], columns["multiplier"][rests]
    trapezoids = np.append(0.0, np.cumsum((load[1:] + load[:-1]) / 2 * np.diff(moved))) * np.hypot(100, 30)
    live = columns[WORKS[1]][rests]
    assert live == pytest.approx(trapezoids, rel=0.15, abs=0.02 * trapezoids[-1])
    assert columns[WORKS[0]][rests][0] > 0
    assert (np.diff(live) >= 0).all()


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", "fem"])
def test_work_of_load_on_elastic_wall(model: str) -> None:
    """It is half of the load times its displacement, also where models in motion apply the load at once.

    That does twice the work, half of which damping takes.
    """
    glue = {"joint": {"friction": 0.6, "cohesion": 1e5} | STIFFNESS}
    scene = panel(wall__length=0.48, wall__height=0.18, block__young=1e10, load=POINT, **glue)
    outcome = run_model(model, scene, 0.3)
    columns = outcome.curve_columns()
    elastic = slice(1, 4)  # rests under the first loads
    assert (columns[AT_REST][elastic] == 1).all()
    half = columns["multiplier"][elastic] * columns["displacement"][elastic] * np.hypot(100, 30) / 2
    assert columns[WORKS[1]][elastic] == pytest.approx(half, rel=2e-3)


def test_path_is_stored(tmp_path_factory: pytest.TempPathFactory) -> None:
    folder, outcome = tmp_path_factory.mktemp("path"), run_model("dem-static", wall("base"), 0.1)
    save_outcome(outcome, folder)
    back = load_outcome(folder)[0]
    assert back.path_columns == outcome.path_columns
    assert np.array_equal(back.path, outcome.path)


def test_path_needs_as_many_rows_as_curve() -> None:
    with pytest.raises(ValueError, match="path has 3 rows"):
        Outcome("wall", "mine", "undecided", curve=np.zeros((2, 2)), path=np.zeros((3, 1)), path_columns=("x",))


def test_held_block_touched_only_by_ties_carries_their_pull() -> None:
    """Two rods with 30 and 50 N to a rock that nothing else touches, with ends 0.2 m above each other."""
    rod, ends = {"from": [0.3, 0.6], "area": 1e-4, "young": 2e11, "yield": 1e3}, np.array([[1.5, 0.15], [1.5, 0.35]])
    rods = [rod | {"to": end.tolist()} for end in ends]
    scene = courses([[1, -1, 1], [1]], width=0.6, height=0.4, support__kind="fixed-first-course", tie=rods)
    supports, pulls = Supports(scene, wall_points(scene)), np.array([30.0, 50.0])
    reactions = supports.reactions(np.zeros((len(wall_points(scene)), 2)), pulls, 0.0)
    named = dict(zip(supports.columns, reactions, strict=True))
    ways = ends - [0.3, 0.6]
    pull = (pulls / np.hypot(*ways.T))[:, None] * ways
    assert [named[f"block 1 {way} [N]"] for way in ("horizontal", "vertical")] == pytest.approx(pull.sum(axis=0))
    assert named["block 1 moment about (1.5, 0.25) [N m]"] == pytest.approx(0.1 * (pull[0, 0] - pull[1, 0]))


def test_untouched_held_block_is_no_support() -> None:
    scene = courses([[1, -1, 1], [1]], width=0.6, height=0.4, support__kind="fixed-first-course")
    assert Supports(scene, wall_points(scene)).block.tolist() == [0]


def test_pin_reactions_of_falling_wall_are_unknown() -> None:
    """The last row of a wall that fell is in motion, so the reaction of a pinned block is unknown."""
    columns = run_model("dem-dynamic", wall("corners"), 0.1).curve_columns()
    assert columns[AT_REST].tolist() == [1] * (len(columns[AT_REST]) - 1) + [0]
    pinned = [values for name, values in columns.items() if name.startswith("pinned block")]
    assert len(pinned) == 6
    assert all(np.isnan(values[-1]) and np.isfinite(values[:-1]).all() for values in pinned)


def test_reaction_of_held_beam() -> None:
    """A level beam at fixed height, pushed 0.1 m above its middle, on joints that carry nothing."""
    beam = {"height": 0.1, "mass": 50.0, "condition": "fixed-height", "drive": {"force": [2.0, 0.0], "at": 0.39}}
    scene = panel(wall__length=0.48, wall__height=0.24, load={"gravity": 9.81}, beam=beam | {"force": [0.0, -300.0]})
    supports = Supports(scene, wall_points(scene))
    reactions = supports.reactions(np.zeros((len(wall_points(scene)), 2)), np.zeros(0), 3.0)
    columns = dict(zip(supports.columns, reactions, strict=True))
    named = {name: value for name, value in columns.items() if name.startswith("beam")}
    assert list(named) == [
        f"beam {head}" for head in ("horizontal [N]", "vertical [N]", "moment about (0.24, 0.29) [N m]")
    ]
    assert list(named.values()) == pytest.approx([-6.0, 300 + 50 * 9.81, 0.6])
    falling = supports.reactions(np.zeros((len(wall_points(scene)), 2)), np.zeros(0), 3.0, at_rest=False)
    assert [np.isnan(x) for x in falling] == [name.startswith("beam") for name in supports.columns]


def test_moment_on_pinned_block_is_carried_by_pins() -> None:
    """A moment of 2 N m at λ = 1, on a wall whose joints carry nothing."""
    live = {"kind": "moment", "at": [0.1, 0.03], "moment": 2.0}
    scene = panel(support__kind="corners", load__live=live)
    supports, none = Supports(scene, wall_points(scene)), np.zeros((len(wall_points(scene)), 2))
    without, with_it = (supports.reactions(none, np.zeros(0), load) for load in (0.0, 3.0))
    assert with_it - without == pytest.approx([0.0, 0.0, -6.0, 0.0, 0.0, 0.0])


def test_ground_moment_is_about_middle_of_contacts() -> None:
    """Independent of the number of points: joints of 0.4 and 0.2 m have two each."""
    scene = courses([[1, 0.5]], width=0.4)
    assert Supports(scene, wall_points(scene)).about == pytest.approx(np.array([[0.3, 0.0]]))


@pytest.mark.parametrize("angle", [5.0, 1e-7])
def test_rotating_support_is_free_if_loaded_only_at_its_centre(angle: float) -> None:
    """The right half of the ground under a block turns about the block's corner, however little."""
    live = {"kind": "settlement", "box": [[0.2, -9.0], [9.0, 0.1]], "rotation_angle": angle, "about": [0.4, 0.0]}
    tie = {"from": [0.2, 0.1], "to": [0.3, -0.01], "area": 1e-4, "young": 2e11, "yield": 1e3}
    scene = courses([[1]], width=0.4, load__live=live, tie=[tie])
    points = wall_points(scene)
    supports, at = Supports(scene, points), points.position[:, 0]
    moves = np.isin(points.block, np.flatnonzero(scene.support_motion.any(axis=1))).any(axis=1)
    pressed = np.column_stack([np.full(len(at), -50.0), np.zeros(len(at))])
    free = np.where((~moves | (at > 0.39))[:, None], pressed, 0.0)
    assert (~moves).any()
    assert (moves & (at > 0.39)).any()
    assert supports.have_come_free(free, np.zeros(1))
    assert not supports.have_come_free(pressed, np.zeros(1))
    assert not supports.have_come_free(free, np.array([50.0]))  # a taut tie loads the support, too


@pytest.mark.parametrize("model", ["limit", "limit-nonassociated", "dem-static", "dem-dynamic"])
def test_ties_and_ground_balance_loads(model: str) -> None:
    """A pier pushed to the right, tied to the rock beside it and to an anchor: all reactions balance the loads."""
    rock = {"from": [0.1, 0.5], "to": [-0.5, -0.05], "area": 1e-5, "young": 2e11, "yield": 150.0}
    anchor = {"from": [0.1, 0.7], "to": [-1.0, 0.7], "area": 1e-5, "young": 2e11, "yield": 80.0, "preload": 20.0}
    joint = {"friction": 0.9} | STIFFNESS
    pier = {"wall__thickness": 0.5, "width": 0.4, "height": 0.4, "joint": joint}
    scene = courses([[1], [1]], **pier, tie=[rock, anchor])  # type: ignore[arg-type]
    outcome = run_model(model, scene, 0.02)
    columns = {name: values[0] for name, values in outcome.curve_columns().items()}
    if model != "limit" and model != "limit-nonassociated":
        rests = outcome.curve_columns()[AT_REST] == 1
        columns = {name: values[rests][-1] for name, values in outcome.curve_columns().items()}
    weight = 9.81 * float(scene.mass[scene.wall].sum())
    horizontal, vertical = columns["ground horizontal [N]"], columns["ground vertical [N]"]
    load = next(value for name, value in columns.items() if name.startswith(("λ", "multiplier")))
    assert vertical == pytest.approx(weight, rel=1e-4)
    assert horizontal - columns["tie 1 [N]"] == pytest.approx(-load * weight, rel=1e-3)
    assert 0 <= columns["tie 0 [N]"] <= 150 * (1 + 1e-9)
    assert columns["tie 1 [N]"] <= 80 * (1 + 1e-9)
