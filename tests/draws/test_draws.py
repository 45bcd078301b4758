"""Draws: each is known by its number, stays within its tolerance and is kept; what is none is refused."""

import json
import signal
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstest, norm

import runningbond as rb
from runningbond.campaigns import Interrupted, tasks
from runningbond.commands.command_line import command
from runningbond.compare import published_scene
from runningbond.contacts.materials import ContactMaterials
from runningbond.draws import Draws, Sampling, Scatter
from runningbond.joints.stiffness import block_compliance
from runningbond.models import MODELS, run_model
from runningbond.results import Outcome
from runningbond.scene import JointMaterial, Scene, SceneError
from runningbond.scene.segments import find_joints

from ..walls import content, courses, panel, write_toml

STIFF = {"joint__normal_stiffness": 1e10, "joint__shear_stiffness": 4e9}
TALL = {"length": 0.06, "height": 0.24, "block_width": 0.06, "block_height": 0.24, "thickness": 0.12}
ARCH = str(Path(__file__).parents[2] / "examples" / "walls" / "arch_with_tie.toml")


def block(**changes: Any) -> Scene:
    """A single block, which slides at λ = tan φ."""
    return courses([[1]], joint__friction=0.3, **STIFF, **changes)


@pytest.fixture
def small(tmp_path: Path) -> str:
    changes = {"wall__length": 0.48, "wall__height": 0.12, "joint": {"friction": 0.3}}
    stiffness = {"joint__normal_stiffness": 1e10, "joint__shear_stiffness": 4e9}
    return str(write_toml(content(**changes, **stiffness), tmp_path / "small.toml"))


# --- what is drawn ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["bits", "size=0.02", "friction=0.1", "size=0.02,friction=0.1"])
def test_a_draw_is_known_by_its_number(text: str) -> None:
    """The first is the wall as it is; others differ from it and from each other, and are the same when drawn again."""
    scene, scatter = panel(), Scatter.read(text)
    assert str(scatter) == text
    assert scatter.draw(scene, 0) is scene
    one, again, two = (scatter.draw(scene, k) for k in (1, 1, 2))
    assert one.block.density == again.block.density != two.block.density
    assert 0 < abs(one.block.density / scene.block.density - 1) < 2e-12
    assert np.array_equal(one.blocks.vertices, again.blocks.vertices)
    assert one.joint_materials == again.joint_materials != two.joint_materials


@pytest.mark.parametrize("name", ["panel-04", "panel-08", "panel-10", "wall-w1", "wall-w3"])
def test_sizes_lie_within_the_tolerance(name: str) -> None:
    """Outer sides stay, widths and heights differ within the tolerance, and blocks touch as they did."""
    scene, size = published_scene(name), 0.02
    drawn = Scatter(size=size).draw(scene, 5)
    drawn.blocks.check()
    assert np.allclose(drawn.blocks.extent(drawn.wall), scene.blocks.extent(scene.wall), rtol=0, atol=1e-12)
    before, after = (np.subtract(*each.blocks.boxes[::-1])[scene.wall] for each in (scene, drawn))
    assert 0.2 * size < np.abs(after / before - 1).max() <= size * (1 + 1e-9)
    joints = find_joints(drawn.blocks)
    found = {tuple(pair): ends for pair, ends in zip(map(tuple, joints.block), joints.ends, strict=True)}
    assert Counter(map(tuple, drawn.joints.block)) <= Counter(map(tuple, joints.block))
    for pair, ends in zip(map(tuple, drawn.joints.block), drawn.joints.ends, strict=True):
        assert ends == pytest.approx(found[pair], abs=1e-12)


@pytest.mark.parametrize("model", ["limit", "dem-static"])
def test_a_floor_loads_the_course_that_it_lies_in_whatever_the_sizes(model: str) -> None:
    """Three blocks in a stack, a floor in the upper joint: the block above it slides first, at tan φ, in every draw."""
    floor = {"kind": "line", "from": [0.0, 0.4], "to": [0.8, 0.4], "force": [0.0, -2e4]}
    scene = courses([[1]] * 3, 0.8, 0.2, joint__friction=0.3, load__dead=[floor], **STIFF)
    for k in range(6):
        drawn = Scatter(size=0.02).draw(scene, k)
        assert np.diff(drawn.blocks.boxes[1][drawn.wall, 1]).std() > (1e-4 if k else -1)
        assert run_model(model, drawn).multiplier == pytest.approx(0.3, rel=2e-3)


@pytest.mark.parametrize(
    "load",
    [
        {"kind": "point", "at": [0.6, 0.4], "force": [0.0, -1e4]},
        {"kind": "point", "at": [0.4, 0.7], "force": [-1.0, 0.0]},
        {"kind": "line", "from": [0.4, 0.4], "to": [0.7, 0.4], "force": [0.0, -1e4]},
        {"kind": "moment", "at": [0.6, 0.399], "moment": 300.0},
    ],
)
def test_loads_stay_on_their_blocks_whatever_the_sizes(load: dict[str, Any]) -> None:
    """On a step of the wall: as much force, of the same moment about it but for the change of sizes, on each block."""
    scene = courses([[1, 1], [1, 1], [1], [1]], 0.4, 0.2, load__dead=[load], **STIFF)
    given = scene.dead_forces
    for k in range(1, 8):
        drawn = Scatter(size=0.05).draw(scene, k)
        forces = drawn.dead_forces
        assert np.array_equal(forces.block, given.block)
        assert np.array_equal(forces.force, given.force)
        assert np.array_equal(forces.moment, given.moment)
        low, high = drawn.blocks.boxes
        assert (forces.at > low[forces.block] - 1e-12).all()
        assert (forces.at < high[forces.block] + 1e-12).all()


@pytest.mark.parametrize(
    "load",
    [
        {"kind": "point", "at": [0.6, 0.4], "force": [0.0, -1e4]},
        {"kind": "line", "from": [0.5, 0.4], "to": [0.7, 0.4], "force": [0.0, -1e4]},
        {"kind": "line", "from": [0.0, 0.8], "to": [0.4, 0.8], "force": [0.0, -1e4]},
        {"kind": "moment", "at": [0.6, 0.38], "moment": 300.0},
    ],
)
def test_displacements_of_draws_are_read_where_those_of_the_wall_are(load: dict[str, Any]) -> None:
    """On the same blocks, in the same direction, as far from their lower left corners but for the change of sizes."""
    scene = courses([[1, 1], [1, 1], [1], [1]], 0.4, 0.2, load__live=load, **STIFF)
    block, at, direction = scene.control_point
    low, high = scene.blocks.boxes
    for k in range(1, 8):
        drawn = Scatter(size=0.05).draw(scene, k)
        there, place, way = drawn.control_point
        assert np.array_equal(there, block)
        assert np.array_equal(way, direction)
        (x0, y0), (x1, y1) = drawn.blocks.boxes[0][block[0]], drawn.blocks.boxes[1][block[0]]
        share = (at - low[block[0]]) / (high - low)[block[0]]
        assert place == pytest.approx([x0 + share[0] * (x1 - x0), y0 + share[1] * (y1 - y0)])


def test_pins_and_bars_stay_on_their_blocks_whatever_the_sizes() -> None:
    """A wall held at the corners of its first course, and two of its blocks tied."""
    tie = {"from": [0.2, 0.3], "to": [0.6, 0.3], "area": 1e-4, "young": 2e11, "yield": 4e8}
    scene = courses([[1, 1], [1, 1]], 0.4, 0.2, support__kind="corners", tie=[tie], **STIFF)
    drawn = Scatter(size=0.1).draw(scene, 1)
    corners = {tuple(x) for x in drawn.blocks.vertices.round(12)}
    assert {tuple(x) for x in drawn.pins.point.round(12)} <= corners
    middle = drawn.blocks.centroid[drawn.ties.block[0]]
    assert drawn.ties.ends[0] == pytest.approx(middle)
    assert not np.allclose(drawn.ties.ends, scene.ties.ends)


def test_pins_stay_at_the_corners_of_a_foot_that_is_narrower_than_its_wall() -> None:
    """A block under the middle of two others, whose sides move."""
    scene = courses([[-0.5, 1, -0.5], [1, 1]], 0.4, 0.2, support__kind="corners", **STIFF)
    for k in range(1, 5):
        drawn = Scatter(size=0.1).draw(scene, k)
        (left, bottom), (right, _) = drawn.blocks.extent(0)
        assert left != pytest.approx(0.2, abs=1e-9)
        assert np.unique(drawn.pins.point, axis=0) == pytest.approx(np.array([[left, bottom], [right, bottom]]))


def test_an_anchor_stays_where_it_is_though_all_blocks_move() -> None:
    """One of a wall without a ground, whose last block is any block."""
    tie = {"from": [0.6, 0.3], "to": [0.6, 2.0], "area": 1e-4, "young": 2e11, "yield": 4e8}
    scene = courses([[1, 1]] * 3, 0.4, 0.2, support__kind="fixed-first-course", tie=[tie], **STIFF)
    for k in range(1, 5):
        drawn = Scatter(size=0.1).draw(scene, k)
        assert drawn.ties.ends[0, 1] == pytest.approx([0.6, 2.0], abs=1e-12)
        assert drawn.ties.ends[0, 0] != pytest.approx(np.array([0.6, 0.3]), abs=1e-6)


def test_a_beam_keeps_its_size_though_a_joint_is_in_line_with_its_end() -> None:
    """It lies on the upper one of two steps."""
    scene = courses([[1, 1, 1], [1, 1]], 0.4, 0.2, beam={"height": 0.1, "mass": 10.0}, **STIFF)
    assert scene.beam is not None
    assert scene.beam.block is not None
    block = scene.beam.block
    for k in range(1, 5):
        drawn = Scatter(size=0.1).draw(scene, k)
        assert drawn.blocks.polygon(block) == pytest.approx(scene.blocks.polygon(block), abs=1e-12)
        assert not np.array_equal(drawn.blocks.vertices, scene.blocks.vertices)


def test_joints_do_not_pass_each_other_where_they_are_near() -> None:
    """Head joints 1 to 4 mm apart in courses of 0.2 m: blocks touch as they did, at most a tenth as long."""
    bond: list[list[float]] = [[1, 1], [1.02, 0.98], [1.025, 0.975], [1, 1]]
    scene = courses(bond, **STIFF)
    for k in range(20):
        drawn = Scatter(size=0.1).draw(scene, k)
        run = [each.joints.ends[:, 1] - each.joints.ends[:, 0] for each in (scene, drawn)]
        assert ((run[0] * run[1]).sum(axis=1) > 0.09 * (run[0] ** 2).sum(axis=1)).all()
        found = find_joints(drawn.blocks)
        assert Counter(map(tuple, drawn.joints.block)) == Counter(
            pair for pair in map(tuple, found.block) if not drawn.fixed[list(pair)].all()
        )


@settings(max_examples=20)
@given(noise=st.floats(0.0, 5e-6), seed=st.integers(0, 99))
def test_blocks_that_touch_to_within_contact_move_together(noise: float, seed: int) -> None:
    """Corners of a surveyed bond lie micrometres apart: no gap, no overlap is wider after the draw."""
    scene = courses([[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]], **STIFF)
    random = np.random.default_rng(seed)
    per_side = {key: random.uniform(-noise, noise) for key in range(2 * len(scene.blocks))}
    rough = scene.blocks.vertices.copy()
    low, high = scene.blocks.boxes
    for block in np.flatnonzero(scene.wall).tolist():
        own = slice(scene.blocks.first[block], scene.blocks.first[block + 1])
        for side, edge in enumerate((low, high)):
            rough[own, 0] += np.where(rough[own, 0] == edge[block, 0], per_side[2 * block + side], 0.0)
    surveyed = replace(scene, blocks=replace(scene.blocks, vertices=rough))
    joints = find_joints(surveyed.blocks)
    drawn = Scatter(size=0.05).draw(surveyed, 1 + seed)
    boxes = [np.column_stack(each.blocks.boxes) for each in (surveyed, drawn)]
    for pair, (start, stop) in zip(joints.block, joints.ends, strict=True):
        axis = int(np.argmin(np.abs(stop - start)))
        a, b = ((each[pair[0]], each[pair[1]]) for each in boxes)
        gaps = [min(abs(p[2 + axis] - q[axis]), abs(q[2 + axis] - p[axis])) for p, q in (a, b)]
        assert gaps[1] == pytest.approx(gaps[0], abs=1e-9)


def test_a_beam_is_no_block_of_the_wall_whose_sizes_differ() -> None:
    """The top of the masonry stays, and its blocks differ by their tolerance, not by that of a beam of 1 cm."""
    scene = courses([[1, 1]] * 3, beam={"height": 0.01, "mass": 10.0}, **STIFF)
    heights = []
    for k in range(1, 30):
        drawn = Scatter(size=0.1).draw(scene, k)
        low, high = drawn.blocks.boxes
        assert high[drawn.masonry, 1].max() == pytest.approx(3 * 0.175, abs=1e-12)
        heights.append((high - low)[drawn.masonry, 1] / 0.175)
    assert np.abs(np.array(heights) - 1).max() == pytest.approx(0.1, abs=0.02)


def test_friction_scatters_joint_by_joint() -> None:
    scene, spread = published_scene("panel-12"), 0.1
    drawn = Scatter(friction=spread).draw(scene, 1)
    friction = np.array([material.friction for material in drawn.joint_materials])[drawn.material_of_joint]
    logarithm = np.log(friction / scene.joint.friction)
    error = spread / np.sqrt(len(logarithm))
    assert abs(logarithm.mean()) < 4 * error
    assert logarithm.std() == pytest.approx(spread, abs=4 * error)


def test_no_friction_leaves_more_tensile_strength_than_cohesion_has() -> None:
    """f_t is what was given as long as it is at most c / tan φ, whatever scatters."""
    given = {"friction": 0.6, "cohesion": 1e5, "tensile_strength": 1.6e5}
    scene = panel(wall__length=0.96, wall__height=0.36, joint=given)
    for scatter in ("friction=0.1", "bits"):
        drawn = Scatter.read(scatter).draw(scene, 1).joint_materials
        own = drawn[1:] if scatter != "bits" else drawn
        assert [each.tension for each in own] == [min(1.6e5, 1e5 / each.friction) for each in own]
    exact = replace(scene, joint_materials=(replace(scene.joint, tensile_strength=1e5 / 0.6),))
    Scatter().draw(exact, 1)
    Scatter().draw(exact, 2)


@pytest.mark.parametrize("friction", [0.0, 1e-6, 1e6])
@pytest.mark.parametrize("scatter", ["bits", "friction=0.5"])
def test_walls_of_the_least_and_the_most_friction_have_draws(friction: float, scatter: str) -> None:
    """A draw is a wall that a file may describe: none of its joints is rougher, or smoother, than any may be."""
    scene = panel(wall__length=0.96, wall__height=0.36, joint={"friction": friction})
    for k in range(6):
        drawn = [each.friction for each in Scatter.read(scatter).draw(scene, k).joint_materials]
        assert all(x == 0 if friction == 0 else 1e-6 <= x <= 1e6 for x in drawn)


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", "fem"])
def test_a_block_slides_at_the_friction_it_was_drawn_with(model: str) -> None:
    """Exact: λ = tan φ of each draw's one joint; and no last bit matters to a single block."""
    scene, tolerance = block(block__young=1e12), 1e-3
    found = Sampling(scene, MODELS[model], 4, "friction=0.2").run(tolerance, jobs=1)
    for k, outcome in enumerate(found.outcomes):
        drawn = Scatter(friction=0.2).draw(scene, k)
        friction = drawn.joint_materials[int(drawn.material_of_joint[0])].friction
        assert outcome.lower is not None
        assert outcome.upper is not None
        assert 0.999 * friction <= outcome.upper
        assert outcome.lower <= 1.001 * friction
    assert found.error is not None
    assert found.error > 0.01
    bits = Sampling(scene, MODELS[model], 2).run(tolerance, jobs=1)
    assert bits.multipliers == pytest.approx(0.3, rel=2e-3)


# --- what they come to ------------------------------------------------------------------------------------------


def outcome(multiplier: float | None) -> Outcome:
    status: Any = "undecided" if multiplier is None else "collapse"
    return Outcome("wall", "fem", status, multiplier, multiplier, multiplier)


def test_statistics_are_those_of_the_draws_that_collapse() -> None:
    """Mean 3 and standard deviation √2.5 of 1 … 5; undecided draws are counted, and count for nothing."""
    draws = Draws(tuple(map(outcome, (3.0, 1.0, None, 5.0, 2.0, 4.0))), Scatter())
    assert (draws.lowest, draws.mean) == (1.0, 3.0)
    assert draws.error == pytest.approx(np.sqrt(2.5 / 5))
    assert draws.quantiles == pytest.approx({"5": 1.2, "25": 2.0, "50": 3.0, "75": 4.0, "95": 4.8})
    said = draws.summary()
    assert (said["number"], said["collapsed"], said["each"][2]["multiplier"]) == (6, 5, None)
    assert "5 of 6 draws collapse: lowest 1.0000" in str(draws)
    json.dumps(said, allow_nan=False)


def test_draws_that_agree_are_no_better_known_than_each_of_them() -> None:
    """Bisection ends in one bracket of all: their mean has no scatter, and may be as wrong as each of them."""
    same = Draws((Outcome("wall", "fem", "collapse", 0.601, 0.599, 0.603),) * 5 + (outcome(None),), Scatter())
    assert (same.error, same.half_width) == pytest.approx((0.0, 0.002))
    assert str(same).endswith("mean 0.6010 ± 0.0000 (standard error); λ of each is known to ± 0.002")
    assert same.summary()["half_width"] == same.half_width


def test_a_wall_as_it_is_is_no_draw_of_a_scatter() -> None:
    """It is told beside them: here it bears more than any of them, as a wall without a weakest joint does."""
    walls = tuple(map(outcome, (9.0, 3.0, 1.0, 5.0, 2.0, 4.0)))
    scattered, bits = Draws(walls, Scatter(friction=0.1)), Draws(walls, Scatter())
    assert (scattered.lowest, scattered.mean, bits.mean) == (1.0, 3.0, 4.0)
    assert scattered.error == pytest.approx(np.sqrt(2.5 / 5))
    assert scattered.quantiles["95"] == pytest.approx(4.8)
    assert str(scattered).startswith("as it is 9.0000; 5 of 5 draws collapse: lowest 1.0000")
    assert "5 of 5 collapse" in repr(scattered)
    said = scattered.summary()
    assert (said["number"], said["drawn"], said["collapsed"], len(said["each"])) == (6, 5, 5, 6)
    assert said["half_width"] == scattered.half_width == 0.0
    weak = Draws((replace(outcome(None), status="infeasible"), outcome(1.0)), Scatter(size=0.1))
    assert str(weak) == "as it is infeasible; 1 of 1 draws collapse, at 1.0000"


def test_draws_of_independent_joints_have_the_quantiles_of_the_weakest() -> None:
    """Of a stack that slides at its weakest joint: λ is the least of n log-normal frictions, each drawn by itself."""
    count, spread, number = 10, 0.2, 400
    scene = courses([[1]] * count, joint__friction=0.05, **STIFF)
    least = [
        min(
            drawn.joint_materials[k].friction
            for drawn in [Scatter(friction=spread).draw(scene, draw)]
            for k in drawn.material_of_joint
        )
        for draw in range(1, number)
    ]
    assert kstest(np.log(np.array(least) / 0.05) / spread, lambda x: 1 - norm.sf(x) ** count).pvalue > 0.01
    found = Draws(tuple(outcome(x) for x in (0.05, *least)), Scatter(friction=spread))
    exact = 0.05 * np.exp(spread * norm.isf(0.5 ** (1 / count)))
    assert found.quantiles["50"] == pytest.approx(exact, rel=0.02)
    assert found.quantiles["5"] < found.quantiles["95"] < 0.05


def test_walls_that_fall_under_their_weight_or_never_are_ranked_among_the_others() -> None:
    """Of 0, 0, 0, 1, 2 the median is 0; of 1, 2, ∞, ∞, ∞ it is infinite, and there is no mean."""
    weak, strong = (
        Draws(tuple(outcome(x) if x else replace(outcome(None), status=status) for x in (1.0, 2.0, 0, 0, 0)), Scatter())
        for status in ("infeasible", "unbounded")
    )
    assert (weak.lowest, weak.mean, weak.quantiles["50"], weak.quantiles["75"]) == (0.0, 0.6, 0.0, 1.0)
    assert "2 of 5 draws collapse, 3 fall under dead load alone, at 0: lowest 0" in str(weak)
    assert (strong.lowest, strong.mean, strong.error, strong.quantiles["50"]) == (1.0, None, None, np.inf)
    assert strong.quantiles["5"] == pytest.approx(1.2)
    assert str(strong).endswith(
        "3 fall at no load, ∞: lowest 1.0000, quantiles 5 % 1.2000, 25 % 2.0000, 50 % ∞, 75 % ∞, 95 % ∞"
    )
    said = json.loads(json.dumps(strong.summary(), allow_nan=False))
    assert (said["collapsed"], said["unbounded"], said["quantiles"]["50"]) == (2, 3, None)


def test_a_quantile_between_a_wall_that_falls_and_one_that_never_does_is_infinite() -> None:
    """Of 1, 2, 3 and ∞ three quarters lie below none."""
    walls = (*map(outcome, (1.0, 2.0, 3.0)), replace(outcome(None), status="unbounded"))
    assert Draws(walls, Scatter()).quantiles == pytest.approx(
        {"5": 1.15, "25": 1.75, "50": 2.5, "75": np.inf, "95": np.inf}
    )


def test_no_draw_is_known_better_than_the_one_with_the_widest_bracket() -> None:
    brackets = ((0.59, 0.61), (0.5, 0.7), (0.6, 0.602))
    walls = tuple(Outcome("wall", "fem", "collapse", (a + b) / 2, a, b) for a, b in brackets)
    assert Draws(walls, Scatter()).half_width == pytest.approx(0.1)


def test_draws_of_which_none_or_one_collapses_have_no_spread() -> None:
    none, one = (Draws(tuple(map(outcome, found)), Scatter()) for found in ((None, None), (None, 2.0)))
    assert (none.lowest, none.mean, none.error, none.quantiles) == (None, None, None, {})
    assert (one.lowest, one.mean, one.error) == (2.0, 2.0, None)
    assert str(none) == "0 of 2 draws collapse"
    assert str(one) == "1 of 2 draws collapse, at 2.0000"


# --- kept, gone on with, printed --------------------------------------------------------------------------------


def test_draws_go_on_where_they_were(small: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More of them are the old ones and new ones; another scatter's are others. Processes find what one does."""
    wall, computed = rb.read(small), []

    def counted(*arguments: Any) -> Outcome:
        computed.append(arguments)
        return run_model(*arguments)

    monkeypatch.setattr(tasks, "run_model", counted)
    three = wall.draws("dem-static", 3, folder=tmp_path / "kept", jobs=1)
    five = wall.draws("dem-static", 5, folder=tmp_path / "kept", jobs=1)
    assert len(computed) == 5
    assert [x.multiplier for x in five.outcomes[:3]] == [x.multiplier for x in three.outcomes]
    apart = wall.draws("dem-static", 3, jobs=2)
    assert [x.multiplier for x in apart.outcomes] == [x.multiplier for x in three.outcomes]
    wall.draws("dem-static", 3, scatter="friction=0.1", folder=tmp_path / "kept", jobs=1)
    assert len(computed) == 7  # the first is the same wall


def test_draws_are_pushed_far_in_python_as_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same answers, of which each way has its own: λ of a block that topples, b / h, as it is."""
    path, far = tmp_path / "block.toml", {"displacements": "finite", "distance": 0.004}
    wall = rb.Wall.from_dict(content(wall=TALL, joint__friction=1.4, **STIFF))
    wall.to_toml(path)
    line = ["run", str(path), "--model", "dem-dynamic", "--draws", "2", "--json", "--jobs", "1"]
    assert command([*line, *(word for key, value in far.items() for word in (f"--{key}", str(value)))]) == 0
    said = json.loads(capsys.readouterr().out)["draws"]
    draws = wall.draws("dem-dynamic", 2, folder=tmp_path / "kept", jobs=1, **cast(Any, far))
    assert draws.lowest == said["lowest"]
    assert [each.curve[-1, 0] for each in draws.outcomes] == pytest.approx([0.004] * 2, rel=0.01)
    for way, reached in (({**far, "distance": 0.002}, 0.002), ({}, None), (far, 0.004)):
        outcome = wall.draws("dem-dynamic", 2, folder=tmp_path / "kept", jobs=1, **cast(Any, way)).outcomes[1]
        assert ("finite" in outcome.message) == (reached is not None)
        assert reached is None or outcome.curve[-1, 0] == pytest.approx(reached, rel=0.01)


def test_walls_that_are_not_pushed_far_have_no_draws_there() -> None:
    """They are refused before any draw is run."""
    live = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -1e-3]}
    wall = rb.Wall.from_dict(content(wall=TALL, **STIFF, load__live=live))
    with pytest.raises(SceneError, match="^distance = 0.1: goes with finite displacements of a wall that its live"):
        wall.draws("dem-dynamic", 2, displacements="finite", distance=0.1)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_an_interruption_cuts_short_is_no_draw(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    """A model ends with what it has, in this very process; that is kept under no draw, and no other is begun."""
    begun = []

    def cut_short(*_: Any) -> Outcome:
        begun.append(1)
        if len(begun) == 2:
            with suppress(KeyboardInterrupt):
                signal.raise_signal(number)
        return outcome(1.0)

    monkeypatch.setattr(tasks, "run_model", cut_short)
    sampling = Sampling(block(), MODELS["dem-static"], 5)
    before = signal.signal(number, signal.default_int_handler)  # which a process begun in the background has not
    try:
        with pytest.raises(Interrupted) as stopped:
            sampling.run(folder=tmp_path, jobs=1)
        assert signal.getsignal(number) is signal.default_int_handler
    finally:
        signal.signal(number, before)
    assert (len(begun), stopped.value.campaign.kept) == (2, 1)
    assert len(sampling.run(folder=tmp_path, jobs=1).outcomes) == 5
    assert len(begun) == 6


def test_ctrl_c_reaches_a_script(small: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(tasks, "run_model", interrupted)
    with pytest.raises(KeyboardInterrupt):
        rb.read(small).draws("dem-static", 2, jobs=1)


def test_one_run_is_among_the_draws(small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The object of one run, with one key more; and what one run leaves in its folder."""
    line = ["run", small, "--model", "dem-static", "--json"]
    assert command(line) == 0
    once = json.loads(capsys.readouterr().out)
    out = tmp_path / "out"
    assert command([*line, "--draws", "3", "--jobs", "1", "--out", str(out)]) == 0
    drawn = json.loads(capsys.readouterr().out)
    assert tuple(drawn) == (*once, "draws")
    assert [drawn[key] for key in ("status", "lower", "upper")] == [once[key] for key in ("status", "lower", "upper")]
    assert drawn["draws"]["number"] == len(drawn["draws"]["each"]) == 3
    assert drawn["draws"]["each"][0]["multiplier"] == once["multiplier"] >= drawn["draws"]["lowest"]
    assert {"outcome.json", "draws.json", "curve.csv", "draws"} <= {path.name for path in out.iterdir()}
    assert json.loads((out / "draws.json").read_text()) == drawn["draws"]
    assert command([*line[:-1], "--draws", "3", "--jobs", "1", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "3 of 3 draws collapse: lowest" in said
    assert "draws of bits" in said
    assert command([*line, "--out", str(out)]) == 0
    assert not (out / "draws.json").exists()


@pytest.mark.parametrize(
    ("statuses", "code"),
    [
        (("infeasible", "infeasible"), 0),
        (("unbounded", "undecided"), 0),
        (("undecided", "collapse"), 0),
        (("undecided", "failed"), 3),
    ],
)
def test_draws_end_without_an_answer_where_each_of_them_does(
    statuses: tuple[Any, ...], code: int, small: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one run does: that a wall falls under its weight, or locks, is an answer."""
    draws = (outcome(1.0) if each == "collapse" else replace(outcome(None), status=each) for each in statuses)
    found = Draws(tuple(draws), Scatter())
    monkeypatch.setattr(Sampling, "run", lambda *_: found)
    assert command(["run", small, "--model", "dem-static", "--draws", "2"]) == code


# --- refusals ---------------------------------------------------------------------------------------------------

WRONG = [
    *(("--draws", text, []) for text in ("1", "0", "-3", "2.5", "x", "", "1e1", "10001", "nan")),
    *(("--jobs", text, ["--draws", "2"]) for text in ("0", "-2", "x", "1.5")),
    ("--jobs", "2", []),
    ("--scatter", "bits", []),
    *(
        ("--scatter", text, ["--draws", "2"])
        for text in (
            *("size", "size=", "size=a", "size=0", "size=-0.01", "size=0.2", "size=nan", "size=inf", "=0.1", ","),
            *("friction=0", "friction=0.6", "friction=-1", "sizes=0.01", "frction=0.1", "bits=1", "bits,size=0.01"),
            *("size=0.01,size=0.02", "size=0.01,", "size 0.01", "SIZE=0.01"),
        )
    ),
]


@pytest.mark.parametrize(("option", "value", "others"), WRONG)
def test_what_is_no_draw_is_refused(
    option: str, value: str, others: list[str], small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    line = ["run", small, "--model", "dem-static", "--out", str(out), *others, f"{option}={value}"]
    assert command(line) == 2
    said = capsys.readouterr()
    assert option in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""
    assert not out.exists()


@pytest.mark.parametrize("model", [model.name for model in MODELS.values() if model.kind != "history"])
def test_models_without_a_path_have_no_draws(model: str, small: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", small, "--model", model, "--draws", "2"]) == 2
    assert f"--draws = 2: is for models that follow a path, which {model} does not" in capsys.readouterr().err


def test_misspelt_scatter_is_understood() -> None:
    with pytest.raises(SceneError, match='did you mean "friction"'):
        Scatter.read("frction=0.1")


def test_blocks_of_an_arch_keep_their_sizes(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", ARCH, "--model", "dem-dynamic", "--draws", "2", "--scatter", "size=0.01"]) == 2
    assert "size is taken by walls of level and upright joints alone" in capsys.readouterr().err


@pytest.mark.parametrize("draws", [2.0, True, None, "3"])
def test_a_number_of_draws_is_whole_in_python_too(draws: Any) -> None:
    with pytest.raises(SceneError, match="^number"):
        Sampling(block(), MODELS["dem-static"], draws)


def test_refusals_in_python_name_no_option_of_the_command_line() -> None:
    wall = rb.Wall.running_bond(
        length=0.8, height=0.4, block_width=0.4, block_height=0.2, thickness=0.2, density=1800.0, friction=0.6
    )
    for number, scatter, key in (
        (1, "bits", "number = 1:"),
        (2, "sise=0.1", "scatter = "),
        (2, "size=9", "scatter size"),
    ):
        with pytest.raises(SceneError, match=f"^{key}"):
            wall.draws("dem-static", number, scatter=scatter)


@pytest.mark.parametrize("reader", [block_compliance, ContactMaterials])
def test_joints_with_a_friction_each_are_not_compared_each_with_each(
    reader: Callable[[Scene], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 9000 joints that took three quarters of a minute each time, and a run asks twice or more."""
    scene = Scatter.read("friction=0.05").draw(panel(block__young=5e9, **STIFF), 1)
    same, comparisons = JointMaterial.__eq__, 0

    def counted(one: JointMaterial, other: object) -> bool:
        nonlocal comparisons
        comparisons += 1
        return same(one, other)

    monkeypatch.setattr(JointMaterial, "__eq__", counted)
    reader(scene)
    assert comparisons <= len(scene.joint_materials)
