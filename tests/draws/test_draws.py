"""Random draws of a wall: reproducible by number, within tolerances, stored; invalid options are refused."""

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


# --- scatter of a wall ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["bits", "size=0.02", "friction=0.1", "size=0.02,friction=0.1"])
def test_draw_is_determined_by_its_number(text: str) -> None:
    """Draw 0 is the unchanged wall; others differ from it and from each other, and are reproducible."""
    scene, scatter = panel(), Scatter.read(text)
    assert str(scatter) == text
    assert scatter.draw(scene, 0) is scene
    one, again, two = (scatter.draw(scene, k) for k in (1, 1, 2))
    assert one.block.density == again.block.density != two.block.density
    assert 0 < abs(one.block.density / scene.block.density - 1) < 2e-12
    assert np.array_equal(one.blocks.vertices, again.blocks.vertices)
    assert one.joint_materials == again.joint_materials != two.joint_materials


@pytest.mark.parametrize("name", ["panel-04", "panel-08", "panel-10", "wall-w1", "wall-w3"])
def test_block_sizes_lie_within_the_tolerance(name: str) -> None:
    """The outline stays, widths and heights vary within the tolerance, and the joints connect the same blocks."""
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
def test_line_load_stays_in_its_bed_joint_for_any_sizes(model: str) -> None:
    """A stack of three blocks, a floor load in the upper joint: in every draw the top block slides, at tan φ."""
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
def test_loads_stay_on_their_blocks_for_any_sizes(load: dict[str, Any]) -> None:
    """On a step of the wall: each block keeps its forces and moments, at points within the block."""
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
def test_control_point_of_draws_stays_on_its_blocks(load: dict[str, Any]) -> None:
    """On the same blocks, in the same direction, at the same share of the block's width and height."""
    scene = courses([[1, 1], [1, 1], [1], [1]], 0.4, 0.2, load__live=load, **STIFF)
    block, at, direction = scene.control_point
    low, high = scene.blocks.boxes
    for k in range(1, 8):
        drawn = Scatter(size=0.05).draw(scene, k)
        there, place, sense = drawn.control_point
        assert np.array_equal(there, block)
        assert np.array_equal(sense, direction)
        drawn_low, drawn_high = drawn.blocks.boxes
        share = (at - low[block]) / (high - low)[block]
        assert place == pytest.approx(drawn_low[block] + share * (drawn_high - drawn_low)[block])


def test_pins_and_ties_stay_on_their_blocks_for_any_sizes() -> None:
    """A wall with pinned corners of its first course, and a tie between two blocks."""
    tie = {"from": [0.2, 0.3], "to": [0.6, 0.3], "area": 1e-4, "young": 2e11, "yield": 4e8}
    scene = courses([[1, 1], [1, 1]], 0.4, 0.2, support__kind="corners", tie=[tie], **STIFF)
    drawn = Scatter(size=0.1).draw(scene, 1)
    corners = {tuple(x) for x in drawn.blocks.vertices.round(12)}
    assert {tuple(x) for x in drawn.pins.point.round(12)} <= corners
    middle = drawn.blocks.centroid[drawn.ties.block[0]]
    assert drawn.ties.ends[0] == pytest.approx(middle)
    assert not np.allclose(drawn.ties.ends, scene.ties.ends)


def test_pins_stay_at_the_corners_of_a_foot_narrower_than_the_wall() -> None:
    """A block centred under two others; its sides move in the draws."""
    scene = courses([[-0.5, 1, -0.5], [1, 1]], 0.4, 0.2, support__kind="corners", **STIFF)
    for k in range(1, 5):
        drawn = Scatter(size=0.1).draw(scene, k)
        (left, bottom), (right, _) = drawn.blocks.extent(0)
        assert left != pytest.approx(0.2, abs=1e-9)
        assert np.unique(drawn.pins.point, axis=0) == pytest.approx(np.array([[left, bottom], [right, bottom]]))


def test_anchor_in_space_does_not_move() -> None:
    """For a wall without ground, whose last block is a block of the wall."""
    tie = {"from": [0.6, 0.3], "to": [0.6, 2.0], "area": 1e-4, "young": 2e11, "yield": 4e8}
    scene = courses([[1, 1]] * 3, 0.4, 0.2, support__kind="fixed-first-course", tie=[tie], **STIFF)
    for k in range(1, 5):
        drawn = Scatter(size=0.1).draw(scene, k)
        assert drawn.ties.ends[0, 1] == pytest.approx([0.6, 2.0], abs=1e-12)
        assert drawn.ties.ends[0, 0] != pytest.approx(np.array([0.6, 0.3]), abs=1e-6)


def test_beam_keeps_its_size_if_a_joint_is_in_line_with_its_end() -> None:
    """The beam lies on the upper of two steps."""
    scene = courses([[1, 1, 1], [1, 1]], 0.4, 0.2, beam={"height": 0.1, "mass": 10.0}, **STIFF)
    assert scene.beam is not None
    assert scene.beam.block is not None
    block = scene.beam.block
    for k in range(1, 5):
        drawn = Scatter(size=0.1).draw(scene, k)
        assert drawn.blocks.polygon(block) == pytest.approx(scene.blocks.polygon(block), abs=1e-12)
        assert not np.array_equal(drawn.blocks.vertices, scene.blocks.vertices)


def test_close_head_joints_do_not_change_their_order() -> None:
    """Head joints of adjacent courses 2, 8 and 10 mm apart: the same blocks touch, on at least 9 % of their length."""
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
def test_blocks_within_contact_tolerance_move_together(noise: float, seed: int) -> None:
    """Corners of a surveyed bond lie micrometres apart; the draw must not widen such gaps and overlaps."""
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


def test_beam_does_not_count_among_the_blocks_that_vary() -> None:
    """The masonry's top stays; its blocks vary by their own tolerance, not by that of a beam 1 cm high."""
    scene = courses([[1, 1]] * 3, beam={"height": 0.01, "mass": 10.0}, **STIFF)
    heights = []
    for k in range(1, 30):
        drawn = Scatter(size=0.1).draw(scene, k)
        low, high = drawn.blocks.boxes
        assert high[drawn.masonry, 1].max() == pytest.approx(3 * 0.175, abs=1e-12)
        heights.append((high - low)[drawn.masonry, 1] / 0.175)
    assert np.abs(np.array(heights) - 1).max() == pytest.approx(0.1, abs=0.02)


def test_friction_of_joints_scatters_independently() -> None:
    scene, spread = published_scene("panel-12"), 0.1
    drawn = Scatter(friction=spread).draw(scene, 1)
    friction = np.array([material.friction for material in drawn.joint_materials])[drawn.material_of_joint]
    logarithm = np.log(friction / scene.joint.friction)
    error = spread / np.sqrt(len(logarithm))
    assert abs(logarithm.mean()) < 4 * error
    assert logarithm.std() == pytest.approx(spread, abs=4 * error)


def test_tensile_strength_is_limited_by_cohesion_over_friction() -> None:
    """f_t is the given value or, if that is less, c / tan φ of the draw, for every scatter."""
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
def test_friction_of_draws_stays_within_the_valid_range(friction: float, scatter: str) -> None:
    """A draw must be a valid wall, even if the mean friction is at the limit of the valid range."""
    scene = panel(wall__length=0.96, wall__height=0.36, joint={"friction": friction})
    for k in range(6):
        drawn = [each.friction for each in Scatter.read(scatter).draw(scene, k).joint_materials]
        assert all(x == 0 if friction == 0 else 1e-6 <= x <= 1e6 for x in drawn)


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", "fem"])
def test_block_slides_at_the_friction_of_its_draw(model: str) -> None:
    """Exact: λ = tan φ of the draw's only joint; changes of the last bit have no effect on a single block."""
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


# --- statistics -------------------------------------------------------------------------------------------------


def outcome(multiplier: float | None) -> Outcome:
    status: Any = "undecided" if multiplier is None else "collapse"
    return Outcome("wall", "fem", status, multiplier, multiplier, multiplier)


def test_statistics_include_only_draws_that_collapse() -> None:
    """Mean 3 and standard deviation √2.5 of 1 … 5; undecided draws are counted but do not enter the statistics."""
    draws = Draws(tuple(map(outcome, (3.0, 1.0, None, 5.0, 2.0, 4.0))), Scatter())
    assert (draws.lowest, draws.mean) == (1.0, 3.0)
    assert draws.error == pytest.approx(np.sqrt(2.5 / 5))
    assert draws.quantiles == pytest.approx({"5": 1.2, "25": 2.0, "50": 3.0, "75": 4.0, "95": 4.8})
    said = draws.summary()
    assert (said["number"], said["collapsed"], said["each"][2]["multiplier"]) == (6, 5, None)
    assert "5 of 6 draws collapse: lowest 1.0000" in str(draws)
    json.dumps(said, allow_nan=False)


def test_half_width_of_the_bracket_is_reported_beside_the_standard_error() -> None:
    """If bisection ends in the same bracket for all draws the mean has no scatter but still the error of each draw,
    which is the width of the bracket if λ is its lower end."""
    same = Draws((Outcome("wall", "fem", "collapse", 0.601, 0.599, 0.603),) * 5 + (outcome(None),), Scatter())
    assert (same.error, same.half_width) == pytest.approx((0.0, 0.002))
    assert str(same).endswith("mean 0.6010 ± 0.0000 (standard error); each λ has a bracket up to 0.004 wide")
    assert same.summary()["half_width"] == same.half_width


def test_unchanged_wall_is_reported_apart_from_draws_of_a_scatter() -> None:
    """Here it carries more than all draws, as is usual for a wall without a weakest joint. It counts for `bits`."""
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


def test_quantiles_of_a_stack_are_those_of_the_weakest_joint() -> None:
    """A stack slides at its weakest joint: λ is the minimum of n independent log-normal frictions."""
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


def test_infeasible_and_unbounded_draws_are_ranked_as_zero_and_infinity() -> None:
    """The median of 0, 0, 0, 1, 2 is 0; that of 1, 2, ∞, ∞, ∞ is infinite, and there is no mean."""
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


def test_quantile_between_finite_and_unbounded_is_infinite() -> None:
    """For 1, 2, 3 and ∞ the 75 % quantile would be interpolated between 3 and ∞."""
    walls = (*map(outcome, (1.0, 2.0, 3.0)), replace(outcome(None), status="unbounded"))
    assert Draws(walls, Scatter()).quantiles == pytest.approx(
        {"5": 1.15, "25": 1.75, "50": 2.5, "75": np.inf, "95": np.inf}
    )


def test_half_width_is_that_of_the_widest_bracket() -> None:
    brackets = ((0.59, 0.61), (0.5, 0.7), (0.6, 0.602))
    walls = tuple(Outcome("wall", "fem", "collapse", (a + b) / 2, a, b) for a, b in brackets)
    assert Draws(walls, Scatter()).half_width == pytest.approx(0.1)


def test_fewer_than_two_collapses_have_no_standard_error() -> None:
    none, one = (Draws(tuple(map(outcome, found)), Scatter()) for found in ((None, None), (None, 2.0)))
    assert (none.lowest, none.mean, none.error, none.quantiles) == (None, None, None, {})
    assert (one.lowest, one.mean, one.error) == (2.0, 2.0, None)
    assert str(none) == "0 of 2 draws collapse"
    assert str(one) == "1 of 2 draws collapse, at 2.0000"


# --- stored, continued, printed ---------------------------------------------------------------------------------


def test_stored_draws_are_reused(small: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More draws reuse the old ones; another scatter has its own. Parallel runs give the same results."""
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
    assert len(computed) == 7  # draw 0 is the same wall


def test_finite_displacements_in_python_and_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Both give the same outcomes; each distance, and small displacements, have their own in the folder."""
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


def test_draws_with_finite_displacements_refuse_settlements() -> None:
    """Before any draw is run."""
    live = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -1e-3]}
    wall = rb.Wall.from_dict(content(wall=TALL, **STIFF, load__live=live))
    with pytest.raises(SceneError, match="^distance = 0.1: goes with finite displacements of a wall that its live"):
        wall.draws("dem-dynamic", 2, displacements="finite", distance=0.1)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_run_is_not_stored_as_a_draw(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    """The interrupted model returns what it has; that is not stored, and no further draw is started."""
    begun = []

    def cut_short(*_: Any) -> Outcome:
        begun.append(1)
        if len(begun) == 2:
            with suppress(KeyboardInterrupt):
                signal.raise_signal(number)
        return outcome(1.0)

    monkeypatch.setattr(tasks, "run_model", cut_short)
    sampling = Sampling(block(), MODELS["dem-static"], 5)
    before = signal.signal(number, signal.default_int_handler)  # background processes do not have this handler
    try:
        with pytest.raises(Interrupted) as stopped:
            sampling.run(folder=tmp_path, jobs=1)
        assert signal.getsignal(number) is signal.default_int_handler
    finally:
        signal.signal(number, before)
    assert (len(begun), stopped.value.campaign.kept) == (2, 1)
    assert len(sampling.run(folder=tmp_path, jobs=1).outcomes) == 5
    assert len(begun) == 6


def test_keyboard_interrupt_is_raised_in_scripts(small: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(tasks, "run_model", interrupted)
    with pytest.raises(KeyboardInterrupt):
        rb.read(small).draws("dem-static", 2, jobs=1)


def test_output_of_draws_includes_that_of_one_run(
    small: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The JSON object of one run with one more key, and the files of one run in the folder."""
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
def test_exit_code_of_draws(statuses: tuple[Any, ...], code: int, small: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Code 3 only if no draw has a result; ``infeasible`` and ``unbounded`` are results, as for a single run."""
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
def test_invalid_options_of_draws_are_refused(
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


def test_misspelt_scatter_gets_a_suggestion() -> None:
    with pytest.raises(SceneError, match='did you mean "friction"'):
        Scatter.read("frction=0.1")


def test_size_scatter_is_refused_for_arches(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["run", ARCH, "--model", "dem-dynamic", "--draws", "2", "--scatter", "size=0.01"]) == 2
    assert "size is taken by walls of level and upright joints alone" in capsys.readouterr().err


@pytest.mark.parametrize("draws", [2.0, True, None, "3"])
def test_number_of_draws_must_be_an_integer(draws: Any) -> None:
    with pytest.raises(SceneError, match="^number"):
        Sampling(block(), MODELS["dem-static"], draws)


def test_messages_in_python_name_the_parameters() -> None:
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
def test_joint_materials_are_not_compared_pairwise(
    reader: Callable[[Scene], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a friction for each of 9000 joints that took 45 s each time, and a run needs it at least twice."""
    scene = Scatter.read("friction=0.05").draw(panel(block__young=5e9, **STIFF), 1)
    same, comparisons = JointMaterial.__eq__, 0

    def counted(one: JointMaterial, other: object) -> bool:
        nonlocal comparisons
        comparisons += 1
        return same(one, other)

    monkeypatch.setattr(JointMaterial, "__eq__", counted)
    reader(scene)
    assert comparisons <= len(scene.joint_materials)
