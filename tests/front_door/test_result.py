"""Results: tables in equilibrium, pictures, and the states along the path."""

import math
import sys
from typing import Any

import numpy as np
import pytest

import runningbond as rb
from fem_interface.modal_wall import modal_wall
from runningbond.draws import Scatter
from runningbond.results import Outcome
from runningbond.run_result import Result

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
MATERIAL: dict[str, Any] = {"density": 1800.0, "young": 1e10, "friction": 0.4, "mortar": MORTAR, "title": "small"}
WALL = rb.Wall.courses([[1, 1], [0.5, 1, 0.5], [1, 1]], block_width=0.4, block_height=0.2, thickness=0.2, **MATERIAL)


@pytest.fixture(params=["structured arrays", "pandas"], autouse=True)
def tables(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables with and without pandas."""
    if request.param == "pandas":
        pytest.importorskip("pandas")
    else:
        monkeypatch.setitem(sys.modules, "pandas", None)


def test_scalars_are_those_of_the_outcome() -> None:
    result = WALL.run("limit")
    for name, value in result.outcome.summary().items():
        if name != "scene":
            assert getattr(result, name) == value
    assert {"status", "multiplier", "curve"} <= set(dir(result))
    with pytest.raises(AttributeError, match="mutliplier"):
        result.mutliplier  # noqa: B018 - refused where it is read


@pytest.mark.parametrize(
    ("model", "rest"), [("limit", 1e-9), ("dem-static", 1e-6), ("dem-dynamic", 1e-4), ("fem", 1e-4)]
)
def test_joint_forces_balance_the_loads_on_every_block(model: str, rest: float) -> None:
    """Forces and moments, relative to the heaviest block's weight; also for fem, whose meshes have other points."""
    result = WALL.run(model)
    scene, table = result.wall.scene, result.joints
    at = np.column_stack([table["x"], table["y"]])
    ends = scene.joints.ends[np.asarray(table["joint"])]
    tangent = (ends[:, 1] - ends[:, 0]) / scene.joints.length[np.asarray(table["joint"])][:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    force = np.asarray(table["normal_force"])[:, None] * normal + np.asarray(table["shear_force"])[:, None] * tangent
    left = np.zeros((len(scene.blocks), 3))
    left[:, :2] = scene.mass[:, None] * 9.81 * (result.lower, -1.0)
    for block, sense in ((np.asarray(table["a"]), 1.0), (np.asarray(table["b"]), -1.0)):
        arm = at - scene.blocks.centroid[block]
        moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
        np.add.at(left, block, sense * np.column_stack([force, moment]))
    assert np.abs(left[~scene.fixed]).max() < rest * scene.mass[~scene.fixed].max() * 9.81


def test_forces_on_the_ground_balance_weight_and_live_load() -> None:
    """Vertical forces of the joints with the ground add up to the weight, shear forces to λ times it."""
    result = WALL.run("limit")
    ground, weight = len(WALL.scene.blocks) - 1, 9.81 * WALL.scene.mass[WALL.scene.wall].sum()
    joints = result.joints
    at_ground = np.asarray(joints["b"]) == ground
    assert -joints["normal_force"][at_ground].sum() == pytest.approx(weight, rel=1e-6)
    assert result.multiplier is not None
    assert abs(joints["shear_force"][at_ground].sum()) == pytest.approx(result.multiplier * weight, rel=1e-6)


def test_sliding_block_dilates_by_its_friction_angle() -> None:
    """Exact for associated flow: a block that moves by 1 m has u = cos φ, v = sin φ and opening = tan φ · slip."""
    block = rb.Wall.courses([[2]], block_width=0.4, block_height=0.2, thickness=0.2, **MATERIAL)
    result = block.run("limit")
    phi = math.atan(0.4)
    assert np.asarray(result.blocks["u"]) == pytest.approx([math.cos(phi), 0.0])
    assert np.asarray(result.blocks["v"]) == pytest.approx([math.sin(phi), 0.0])
    assert np.asarray(result.blocks["fixed"]).tolist() == [False, True]
    assert np.asarray(result.joints["opening"]) == pytest.approx(0.4 * abs(np.asarray(result.joints["slip"])))


def test_curve_is_that_of_the_outcome() -> None:
    result = WALL.run("dem-static")
    assert np.array_equal(result.curve["displacement"], result.outcome.curve[:, 0])
    assert np.array_equal(result.curve["multiplier"], result.outcome.curve[:, 1])


def test_missing_results_are_nan() -> None:
    empty = Result(WALL, Outcome("small", "mine", "undecided"))
    assert len(empty.curve) == 0
    for column in ("u", "v", "rotation"):
        assert np.isnan(empty.blocks[column]).all()
    for column in ("normal_force", "shear_force", "opening", "slip"):
        assert np.isnan(empty.joints[column]).all()


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic", "fem"])
def test_states_at_rest_are_in_equilibrium_and_include_the_lower_bound(model: str) -> None:
    """The first state has λ = 0, one has λ = `lower`; states at rest up to `lower` are in equilibrium at the ground."""
    result = WALL.run(model, states=True)
    states, scene = result.states, WALL.scene
    assert states[0].multiplier == 0.0
    assert {result.lower} <= {state.multiplier for state in states}
    weight = 9.81 * scene.mass[scene.wall].sum()
    assert result.lower is not None
    resting = [x for x in states if x.multiplier <= result.lower and not np.abs(x.velocity).max() > 1e-6]
    assert result.lower in {state.multiplier for state in resting}
    for state in resting:
        ground = state.points.block[:, 1] == len(scene.blocks) - 1
        assert -state.force[ground, 0].sum() == pytest.approx(weight, rel=1e-3)
        assert abs(state.force[ground, 1].sum()) == pytest.approx(state.multiplier * weight, rel=1e-2, abs=1e-2)
        assert state.pull[ground] == pytest.approx(state.force[ground, ::-1] * (1.0, -1.0))
    assert (np.diff(states[0].points.joint) >= 0).all()


def test_states_of_a_finer_mesh_use_its_contact_points() -> None:
    """The run's own contact points, with forces that balance the weight, and at `lower` also the live load."""
    result = WALL.run("fem", states=True, tolerance=0.1, cells=2, modes=6)
    points = modal_wall(WALL.scene, 2, 6).elements.points
    weight = 9.81 * WALL.scene.mass[WALL.scene.wall].sum()
    first = result.states[0]
    assert len(points) > len(result.joints)
    for name in ("position", "area"):
        seen, there = (np.asarray(getattr(each, name)) for each in (first.points, points))
        assert np.sort(seen, axis=0) == pytest.approx(np.sort(there, axis=0))
    last = next(state for state in result.states if state.multiplier == result.lower)
    for state in (first, last):
        ground = state.points.block[:, 1] == len(WALL.scene.blocks) - 1
        assert -state.force[ground, 0].sum() == pytest.approx(weight, rel=1e-3)
        assert abs(state.force[ground, 1].sum()) == pytest.approx(state.multiplier * weight, rel=1e-2, abs=1e-2)


def test_forces_at_the_lower_bound_are_in_the_order_of_the_joints() -> None:
    result = WALL.run("dem-dynamic", states=True)
    last = next(state for state in result.states if state.multiplier == result.lower)
    assert last.force[:, 0] == pytest.approx(np.asarray(result.joints["normal_force"]), rel=1e-6, abs=1e-6)
    assert last.points.position[:, 0] == pytest.approx(np.asarray(result.joints["x"]))


def test_states_of_pushed_walls_belong_to_the_multipliers_of_their_rows() -> None:
    """In the curve, the row with the multiplier of a state has the work of the dead load on its motion."""
    size = {"length": 0.2, "height": 0.8, "block_width": 0.2, "block_height": 0.2, "thickness": 0.2}
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    pier = rb.Wall.running_bond(**size, **joint, density=1800.0)
    result, scene = pier.run("dem-dynamic", states=True, displacements="finite", tolerance=0.05), pier.scene
    weight = np.where(scene.fixed, 0.0, 9.81 * scene.mass)
    work = dict(zip(result.curve["multiplier"], result.curve["work of the dead load [J]"], strict=True))
    pushed = [state for state in result.states if state.multiplier in work and state.multiplier > 0]
    assert len(pushed) > 5
    for state in pushed:
        done = -float(weight @ state.motion[:, 1])
        assert done == pytest.approx(work[state.multiplier], rel=1e-3)


def test_states_need_the_option_states() -> None:
    with pytest.raises(ValueError, match=r"states=True"):
        WALL.run("limit").states  # noqa: B018 - refused where it is read
    assert WALL.run("limit", states=True).states == []


def test_repr_of_a_result() -> None:
    result = WALL.run("limit")
    assert repr(result) == "<Result of limit on 'small': collapse: λ 0.4000, lower 0.4000, upper 0.4000>"
    stuck = Result(WALL, Outcome("small", "mine", "undecided", upper=1.0))
    assert repr(stuck) == "<Result of mine on 'small': undecided: upper 1.0000>"


def test_result_has_pictures_for_notebooks() -> None:
    result = WALL.run("limit")
    assert "<svg" in result._repr_svg_()
    assert result._repr_png_().startswith(b"\x89PNG")


def test_mechanism_and_curve_are_plotted_into_given_axes() -> None:
    from matplotlib.figure import Figure

    result = WALL.run("dem-static")
    figure = Figure()
    mechanism, curve = figure.subplots(1, 2)
    assert result.plot(axes=mechanism) is mechanism
    assert mechanism.has_data()
    result.plot("curve", curve)
    assert curve.get_xlabel().endswith("[mm]")
    at_rest = next(line for line in curve.lines if line.get_label() == "at rest")
    drawn = np.asarray(at_rest.get_xdata())
    assert np.array_equal(drawn, 1e3 * result.outcome.curve[: len(drawn), 0])
    assert len(drawn) > 2
    alone = result.plot()
    assert alone.get_position().y0 > 0.1  # with space for the caption below
    with pytest.raises(rb.SceneError, match="what = 'curves': must be mechanism or curve"):
        result.plot("curves")  # type: ignore[arg-type]


def test_tolerance_that_is_no_number_is_refused() -> None:
    with pytest.raises(rb.SceneError, match="tolerance = 'a': must be a number above 0 and below 1"):
        rb.read("wall-w1").run("limit", tolerance="a")  # type: ignore[arg-type]


def test_unknown_model_is_refused_with_a_suggestion() -> None:
    with pytest.raises(rb.SceneError, match='did you mean "limit"?'):
        WALL.run("limt")


def test_model_that_does_not_apply_gives_the_reason() -> None:
    with pytest.raises(rb.SceneError, match="mortar"):
        WALL.with_({"joint.mortar": None}).run("dem-static")


def test_repr_of_draws_and_fragility() -> None:
    ends = (3.0, 1.0, None, 5.0, 2.0, 4.0)
    each = [Outcome("small", "mine", "collapse" if x else "undecided", multiplier=x) for x in ends]
    told = "<Draws of mine on 'small', bits: 5 of 6 collapse, lowest 1.0000, mean 3.0000 ± 0.7071>"
    assert repr(rb.Draws(tuple(each), Scatter())) == told
    assert repr(rb.Draws(tuple(each[2:3]), Scatter())) == "<Draws of mine on 'small', bits: 0 of 1 collapse>"
    found = rb.Fragility(np.ones(3), np.ones(1), 0.25, 0.4, (0.2, 0.3), WALL.run("limit").blocks, 2)
    records = "3 records, 1 under which it stands, 2 left out (`runs` says why)"
    assert repr(found) == f"<Fragility: median 0.25 g, dispersion 0.4; {records}>"


def test_repr_and_pictures_of_a_response() -> None:
    pulse = {"pulse": {"kind": "sine", "amplitude": 2.0, "period": 0.05}, "quantity": "acceleration"}
    block: dict[str, Any] = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2, "history": pulse}
    wall = rb.Wall.courses([[1]], **block, **MATERIAL)
    response = wall.respond("dem-dynamic", scale=0.5)
    assert isinstance(response, rb.Response)
    assert repr(response).startswith("<Response of dem-dynamic on 'small', λ = 0.5: stands, with a residual drift")
    assert "<svg" in (response._repr_svg_() or "")
    assert (response._repr_png_() or b"").startswith(b"\x89PNG")
    falls = wall.with_({"load.gravity": [9.0, -3.0]}).respond("dem-dynamic")
    assert repr(falls) == "<Response of dem-dynamic on 'small', λ = 1: infeasible: collapses under its dead load>"
    assert falls._repr_svg_() is None
    assert falls._repr_png_() is None
