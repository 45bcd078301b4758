"""Walls whose beam or supports are led through displacements: closed forms, loops, mirrors and honest answers."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.pushover import LoadPath, StaticState
from dem.relaxation import Rest
from dem.static import dem_static
from dem.static_system import Control
from runningbond.limit import limit
from runningbond.limit.settlement import reaction_unit
from runningbond.models import MODELS, run_model
from runningbond.pictures.recording import StaticRecorder
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import (
    Action,
    Array,
    Beam,
    BlockMaterial,
    JointMaterial,
    Load,
    Scene,
    SceneError,
    Settlement,
    Stiffness,
    Tie,
    build_scene,
)
from runningbond.scene.beam import Condition, Drive
from tests.limit.test_limit import rectangle
from tests.walls import courses, panel

K_N, K_T, WEIGHT = 1e10, 4e9, 1962.0
"""Stiffness of joints [Pa/m], and weight of a square metre of wall of .1 m thickness [N]."""


def wall(blocks: list[Array], *live: Action, friction: float = 0.9, **other: Any) -> Scene:
    return build_scene(
        "led",
        blocks,
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(friction, 0.0, 0.0, elasticity=Stiffness(K_N, K_T)),
        load=Load(live=live),
        **other,
    )


def under_beam(condition: Condition, drive: Drive, n: float = 1e4, b: float = 1.0, **other: Any) -> Scene:
    """A block b × 2 m under a beam of .2 m that is pressed down by N."""
    beam = Beam(0.2, 0.0, condition, (0.0, -n), drive)
    return wall([rectangle(0, 0, b, 2)], beam=beam, **other)


def ground_moves(x0: float, x1: float, by: tuple[float, float] = (0.0, 0.0), angle: float = 0.0) -> Settlement:
    return Settlement(((x0, -9.0), (x1, 1e-6)), by, angle)


def check(outcome: Outcome, exact: float, *, rel: float = 1e-6, upper: float | None = None) -> None:
    """A collapse at an exact value, in a bracket around it, as narrow unless it is said how wide."""
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(exact, rel=rel)
    assert outcome.lower == pytest.approx(exact, rel=10 * rel)
    assert outcome.upper == pytest.approx(exact, rel=upper or 10 * rel)


# --- beams ---------------------------------------------------------------------------------------------------

PUSHES = [Drive((1.0, 0.0), 2.0), Drive.along((0.01,), 2.0)]


@pytest.mark.parametrize("drive", PUSHES, ids=["force", "displacement"])
@pytest.mark.parametrize(
    ("condition", "exact"),
    [("level", (1e4 + WEIGHT) / 2), ("free", (1e4 / 2 + WEIGHT) / 2)],
)
def test_block_under_a_level_beam_bends_doubly_and_bears_twice_what_it_does_under_a_free_one(
    condition: Condition, exact: float, drive: Drive
) -> None:
    """Level: N at one corner of its top and N + W at the opposite one of its base, H h = N b + W b/2.
    Free, driven at the joint's height: N stays at the middle of the beam, H h = N b/2 + W b/2."""
    check(dem_static(under_beam(condition, drive)), exact, upper=None if drive.path else 0.01)


def test_reactions_at_the_end_of_a_drive_are_those_by_hand() -> None:
    """The level beam is held by N b/2 against the press at one of its corners, the ground bears N + W and −H; the drive
    has done the work of the plateau, and that of its elastic start at half the force."""
    outcome = dem_static(under_beam("level", PUSHES[1]))
    most = (1e4 + WEIGHT) / 2
    end = dict(zip(outcome.path_columns, outcome.path[-1], strict=True))
    moment = next(value for name, value in end.items() if name.startswith("beam moment"))
    assert moment == pytest.approx(5e3, rel=1e-6)
    assert end["ground vertical [N]"] == pytest.approx(1e4 + 2 * WEIGHT, rel=1e-6)
    assert end["ground horizontal [N]"] == pytest.approx(-most, rel=1e-6)
    assert 0.99 * 0.01 * most < end["work of the live load [J]"] < 0.01 * most


def test_settling_support_takes_what_the_dead_load_gives() -> None:
    """A block that sinks with all its ground: W s from the dead load, and as much against the support's reaction."""
    outcome = dem_static(wall([rectangle(0, 0, 1, 1)], ground_moves(-3.0, 3.0, (0.0, -0.01))))
    check(outcome, 1.0)
    dead, live = outcome.path[:, -3:-1].T
    assert dead[-1] - dead[0] == pytest.approx(WEIGHT * 0.01)
    assert live[-1] == pytest.approx(-WEIGHT * 0.01)


@pytest.mark.parametrize("condition", ["level", "free"])
def test_driven_beam_slides_at_the_friction_of_its_own_joint(condition: Condition) -> None:
    """μ N, the weight of the block below it not counting; its curve stays there."""
    outcome = dem_static(under_beam(condition, Drive.along((5e-3,), 2.0), friction=0.1))
    check(outcome, 1e3)
    assert outcome.curve[-1] == pytest.approx([5e-3, 1e3], rel=1e-6)


@pytest.mark.parametrize("path", [(5e-3,), (1e-3, -1e-3)])
def test_beam_without_weight_slides_off_under_no_force(path: tuple[float, ...]) -> None:
    outcome = dem_static(under_beam("free", Drive.along(path, 2.0), 0.0))
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-3)


def test_height_of_the_drive_counts_from_the_base_and_pushes_to_the_left_are_mirrored() -> None:
    """Free beam, H at 2.2 m: H 2.2 = (N + W) b / 2; to either side the same curve, to rounding."""
    right, left = (dem_static(under_beam("free", Drive.along((d,), 2.2))) for d in (4e-3, -4e-3))
    check(right, (1e4 + 2 * WEIGHT) / 4.4)
    check(left, (1e4 + 2 * WEIGHT) / 4.4)
    assert left.curve == pytest.approx(right.curve, rel=1e-9)
    assert left.motion[:, 0] == pytest.approx(-right.motion[:, 0], abs=1e-7)


def test_wall_under_a_beam_of_fixed_height_is_a_strut_that_hardens() -> None:
    """A diagonal strut between two corners, with springs k = K_n b t / 2 and k_t = K_t b t / 2 at either end: thrust H,
    press N = H h / b, so d = H (2 / k_t + (h/b)² 2 / k). No collapse is reported, but what it takes."""
    outcome = dem_static(under_beam("fixed-height", Drive.along((0.01,), 2.0)))
    assert outcome.status in ("undecided", "unbounded")
    assert outcome.multiplier is outcome.upper is None
    d, force = outcome.curve.T
    stiffness = 1 / (2 / (K_T * 0.05) + 4 * 2 / (K_N * 0.05))
    assert np.diff(force)[-10:] / np.diff(d)[-10:] == pytest.approx(stiffness, rel=1e-6)
    assert f"{force[-1]:,.0f} at 0.01 m" in outcome.message


def test_fixed_height_lets_the_dead_load_settle_the_wall_before_it_holds() -> None:
    """At rest joints carry N + W and N, and none of it hangs in what holds the beam."""
    seen: list[tuple[LoadPath, StaticState]] = []
    dem_static(under_beam("fixed-height", PUSHES[1]), observe=lambda *state: seen.append(state))
    system, rest = seen[0][0].system, seen[0][1]
    pressed = rest.force[:, 0] * system.equilibrium.force_unit
    assert sorted(pressed) == pytest.approx([-5e3 - WEIGHT] * 2 + [-5e3] * 2, rel=1e-9)
    assert rest.x[system.freedoms : -1] == pytest.approx(0.0, abs=1e-9)
    heights = [system.motion(state.x)[1, 1] for _, state in seen]
    assert heights == pytest.approx([heights[0]] * len(heights), rel=1e-9)


def test_cyclic_drive_of_a_sliding_beam_dissipates_the_area_of_its_loop() -> None:
    """Rigid-plastic ± μ N on an elastic slope k: from a to −a and back 4 μ N (a − μ N / k), all of it in friction."""
    a, most, states = 1e-3, 300.0, []
    seen: list[tuple[LoadPath, StaticState]] = []
    drive = Drive.along((a, -a, a), 2.0)
    outcome = dem_static(under_beam("level", drive, 1e3, friction=0.3), observe=lambda *state: seen.append(state))
    check(outcome, most)
    assert "the other way it takes 300" in outcome.message
    d, force = outcome.curve.T
    assert np.abs(force).max() <= most * (1 + 1e-9)
    start, end = (int(k) for k in np.flatnonzero(np.isclose(d, a, rtol=1e-9)))
    assert np.isclose(d[start:end].min(), -a)
    loop = float(((force[start + 1 : end + 1] + force[start:end]) / 2 * np.diff(d[start : end + 1])).sum())
    work = outcome.path[:, outcome.path_columns.index("work of the live load [J]")]
    assert work[end] - work[start] == pytest.approx(loop)
    slope = force[1] / d[1]
    assert loop == pytest.approx(4 * most * (a - most / slope), rel=1e-2)
    states = [state for _, state in seen][start : end + 1]
    system = seen[0][0].system
    unit = system.equilibrium.force_unit * system.length_unit
    slid = np.diff([state.plastic_slip for state in states], axis=0)
    dissipated = unit * float((slid * np.array([state.force[:, 1] for state in states[1:]])).sum())
    assert dissipated == pytest.approx(4 * most * (a - most / slope), rel=1e-3)


def test_shear_wall_follows_cycles_that_grow_and_its_mirror_does_too() -> None:
    """A wall of W-like courses under a level beam; the beam slides at μ N both ways."""
    scenes = [
        courses(
            [[0.5, 1, 1, 0.5], [1, 1, 1]] * 4,
            joint__friction=0.65,
            joint__mortar={"young": 1e9, "poisson": 0.2, "thickness": 0.01},
            load__live=None,
            beam={"height": 0.2, "condition": "level", "force": [0, -3e4], "drive": {"displacement": [path]}},
        )
        for path in ([1e-3, -1e-3, 2e-3], [-1e-3, 1e-3, -2e-3])
    ]
    one, other = (dem_static(scene) for scene in scenes)
    check(one, 0.65 * 3e4, rel=1e-4)
    assert other.multiplier == pytest.approx(one.multiplier, rel=1e-6)
    assert other.curve == pytest.approx(one.curve, rel=1e-3, abs=1e-3 * 0.65 * 3e4)


def test_low_beam_does_not_say_how_far_a_wall_has_to_fall() -> None:
    """A beam of 5 cm on blocks of 2 m, and nothing but a beam."""
    scene = wall([rectangle(0, 0, 1, 2)], beam=Beam(0.05, 10.0, "free", drive=Drive((1.0, 0.0))))
    assert scene.lowest_block == 2.0
    assert scene.block_sizes[1] >= 1.0
    alone = wall(
        [rectangle(0, 0, 1, 2)],
        beam=Beam(0.05, 10.0, "free", drive=Drive((1.0, 0.0))),
        support="fixed-first-course",
    )
    assert alone.lowest_block == pytest.approx(0.05)


# --- supports ------------------------------------------------------------------------------------------------

PORTAL = [rectangle(0, 0, 0.5, 2), rectangle(2, 0, 0.5, 2), rectangle(0, 2, 2.5, 0.4)]


def test_portal_whose_pier_settles_hangs_its_lintel_between_two_edges() -> None:
    """The right pier sinks: the lintel, W of 1 m², turns about the inner edge of the left pier and bears on the outer
    one of the right, R 2 = W (1.25 − .5). The right base bears R and its pier's W, of 3 W in all. The lintel turns by
    s / 2, its left bearing's edge lifts by s / 4."""
    outcome = dem_static(wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -0.01))))
    check(outcome, (0.375 + 1) / 3)
    assert outcome.curve[0] == pytest.approx([0.0, 0.5])
    assert outcome.curve[-1, 0] == pytest.approx(0.01)
    motion = outcome.motion / -outcome.motion[1, 1]
    assert motion[1] == pytest.approx([0.0, -1.0, 0.0], abs=2e-3)
    assert motion[2, 2] == pytest.approx(-0.5, rel=2e-3)
    assert motion[2, 1] == pytest.approx(-0.375, rel=2e-3)
    assert motion[3] == pytest.approx([0.0, -1.0, 0.0], abs=2e-3)


@pytest.mark.parametrize("model", [dem_static, dem_dynamic])
@pytest.mark.parametrize(("path", "lever"), [((1.0, -1.0), 0.625), ((-1.0, 0.5, 1.0), 0.375)])
def test_portal_whose_pier_goes_to_and_fro_ends_as_if_it_had_gone_there_at_once(
    model: Callable[[Scene], Outcome], path: tuple[float, ...], lever: float
) -> None:
    """Where the pier rises, the lintel bears on its inner edge and the other's outer one: R 2 = W 1.25."""
    outcome = model(wall(PORTAL, replace(ground_moves(1.8, 3.0, (0.0, -0.01)), path=path)))
    check(outcome, (lever + 1) / 3, rel=1e-6 if model is dem_static else 1e-3)
    assert outcome.curve[:, 0].max() == pytest.approx(0.01 * max(path))
    assert outcome.curve[:, 0].min() == pytest.approx(0.01 * min(path))
    assert outcome.curve[-1, 0] == pytest.approx(0.01 * path[-1])


@pytest.mark.parametrize("model", [dem_static, dem_dynamic])
@pytest.mark.parametrize(("by", "path"), [(-1e-6, (-1.0,)), (1e-6, (1.0,))])
def test_a_pier_that_is_hardly_lifted_takes_up_load_and_bounds_its_mechanism_on_the_side_it_comes_from(
    model: Callable[[Scene], Outcome], by: float, path: tuple[float, ...]
) -> None:
    """Its share goes from a half towards (.625 + 1) / 3, negative against a lift: what it reached is short of that."""
    outcome = model(wall(PORTAL, replace(ground_moves(1.8, 3.0, (0.0, by)), path=path)))
    assert outcome.status == "undecided"
    assert "still takes up load" in outcome.message
    reached, mechanism = outcome.curve[-1, 1], -np.sign(by) * (0.625 + 1) / 3
    assert 0.5 < abs(reached) < abs(mechanism)
    assert outcome.lower is None or outcome.lower <= mechanism
    assert outcome.upper is None or outcome.upper >= mechanism
    assert (outcome.lower is None) != (outcome.upper is None)


def test_block_over_a_cut_in_its_ground_leans_on_what_stays() -> None:
    """1 m long, cut at .4 m: pivots there, R (1 − .4) = W (.5 − .4); with the other part R .4 = 0, it bridges it."""
    block = [rectangle(0, 0, 1, 1)]
    check(dem_static(wall(block, ground_moves(0.4, 3.0, (0.0, -0.01)))), 1 / 6)
    gone = dem_static(wall(block, ground_moves(-3.0, 0.4, (0.0, -0.01))))
    assert gone.status == limit(wall(block, ground_moves(-3.0, 0.4, (0.0, -0.01)))).status == "unbounded"
    assert gone.curve[-1, 1] == pytest.approx(0.0, abs=1e-9)


def arch(count: int) -> list[Array]:
    """Voussoirs of a half circle of 1 m, .25 m thick, with straight faces, from left to right."""
    angle = np.linspace(np.pi, 0, count + 1)
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    return [np.array([0.75 * ray[k + 1], ray[k + 1], ray[k], 0.75 * ray[k]]) for k in range(count)]


@pytest.mark.parametrize(("sense", "hinges"), [(1.0, ((0.75, 0.0), (1.0, 1.0))), (-1.0, ((1.0, 0.0), (0.75, 0.75)))])
def test_arch_of_three_blocks_spreads_at_its_least_thrust_and_closes_at_its_largest(
    sense: float, hinges: tuple[tuple[float, float], tuple[float, float]]
) -> None:
    """Half the middle block, at a hinge of the joint at 60°, and a side block about its springing's hinge: moments give
    H. The springing opens at its back and the joint at its belly where it spreads, or the other way round. The reaction
    against the motion is H, positive where the support gives way."""
    blocks = arch(3)
    outcome = dem_static(wall(blocks, ground_moves(0.0, 3.0, (sense * 1e-3, 0.0)), friction=2.0))
    foot = np.array([-hinges[0][0], 0.0])
    top = hinges[1][0] * np.array([-0.5, np.sqrt(0.75)])

    def area_and_middle(polygon: Array) -> tuple[float, Array]:
        following = np.roll(polygon, -1, axis=0)
        cross = polygon[:, 0] * following[:, 1] - following[:, 0] * polygon[:, 1]
        return cross.sum() / 2, ((polygon + following) * cross[:, None]).sum(axis=0) / (3 * cross.sum())

    (side, centre), (crown, _) = area_and_middle(blocks[0]), area_and_middle(blocks[1])
    thrust = (crown / 2 * (top - foot)[0] + side * (centre - foot)[0]) / (top - foot)[1]
    check(outcome, sense * thrust / (2 * side + crown))


def test_block_falls_when_what_clamps_it_gives_way() -> None:
    """A tie presses a block against a wall that moves off by s: W / 2 = μ N on either face at the end, the pressing
    block's own base resists with μ (W₁ + W / 2), so K s = P − N − that; N is the last the wall bears."""
    base = rectangle(-3, -1, 4, 1), rectangle(1.2, -1, 0.8, 3)
    blocks = [rectangle(0, 0, 0.8, 1), rectangle(0.8, 0.3, 0.4, 0.4)]
    preload, stiffness, mu = 6e3, 1e5, 0.6
    bar = Tie((0.4, 0.5), (3.4, 0.5), stiffness * 3 / 2e11, 2e11, 1e5, preload)
    heavy, light = 0.8 * WEIGHT, 0.16 * WEIGHT
    moves = Settlement(((1.15, -9.0), (3.0, 3.0)), (0.2, 0.0))
    outcome = dem_static(wall(blocks, moves, friction=mu, grounds=base, ties=[bar]))
    clamp = light / 2 / mu
    check(outcome, clamp / (heavy + light), rel=1e-5)
    fall = (preload - clamp - mu * (heavy + light / 2)) / stiffness
    assert outcome.curve[-1, 0] == pytest.approx(fall, rel=1e-4)
    assert f"falls at {fall:.4g} m" in outcome.message
    assert outcome.motion[1] == pytest.approx([0.0, -1.0, 0.0], abs=1e-6)


def test_turned_ground_is_led_by_its_largest_joint_end() -> None:
    """A block on ground that turns about its middle by 1°: it turns along, and its weight does no work."""
    moves = Settlement(((-3.0, -9.0), (3.0, 1e-6)), rotation_angle=1.0, about=(0.5, 0.0))
    scene = wall([rectangle(0, 0, 1, 1)], moves)
    outcome = dem_static(scene)
    assert reaction_unit(scene) == pytest.approx(WEIGHT * 0.5 * np.radians(1))
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-9)
    assert outcome.curve[-1, 0] == pytest.approx(0.5 * np.radians(1), rel=1e-9)
    assert np.ptp(outcome.motion[:, 2]) == pytest.approx(0.0, abs=1e-9)


def mortared(rows: list[list[float]], box: list[list[float]]) -> Scene:
    return courses(
        rows,
        joint__friction=0.65,
        joint__mortar={"young": 1e9, "poisson": 0.2, "thickness": 0.01},
        load__live={"kind": "settlement", "box": box, "by": [0, -0.002]},
    )


def test_half_a_wall_settles_as_its_mirror_does() -> None:
    rows: list[list[float]] = [[0.5, 1, 1, 0.5], [1, 1, 1]] * 3
    right, left = (dem_static(mortared(rows, [[x, -9], [x + 9, 0]])) for x in (0.6, -8.4))
    assert right.status == left.status == "collapse"
    assert left.multiplier == pytest.approx(right.multiplier, rel=1e-3)
    assert right.multiplier is not None
    assert 0 < right.multiplier < 0.5


# --- honest answers ------------------------------------------------------------------------------------------


def test_support_that_has_hardly_moved_has_shed_no_load_for_good() -> None:
    outcome = dem_static(wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -1e-6))))
    assert (outcome.status, outcome.lower) == ("undecided", None)
    assert "still sheds load where its settlement ends" in outcome.message
    assert f"it bears {number(outcome.curve[-1, 1])} at 1e-06 m; " in outcome.message
    assert outcome.upper == pytest.approx(outcome.curve[-1, 1], rel=1e-6)
    assert 1.375 / 3 < outcome.curve[-1, 1] < 0.5


def test_drive_that_ends_in_the_elastic_wall_has_found_no_capacity() -> None:
    outcome = dem_static(under_beam("level", Drive.along((1e-5,), 2.0)))
    assert (outcome.status, outcome.upper) == ("undecided", None)
    assert outcome.lower == pytest.approx(outcome.curve[-1, 1], rel=1e-6)
    reached = f"{number(outcome.curve[-1, 1])} at 1e-05 m"
    assert f"still hardens where its drive ends, which takes {reached}; " in outcome.message


@pytest.mark.parametrize("budget", [5, 40])
def test_budget_that_runs_out_on_the_way_leaves_it_undecided(budget: int) -> None:
    scene = mortared([[0.5, 1, 1, 0.5], [1, 1, 1]] * 3, [[0.6, -9], [9, 0]])
    outcome = dem_static(scene, budget=budget)
    assert outcome.status == "undecided"
    assert outcome.multiplier is None


def test_support_of_a_weightless_wall_is_refused() -> None:
    scene = wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -1e-6)))
    with pytest.raises(SceneError, match=r"load\.gravity = 0"):
        dem_static(replace(scene, load=replace(scene.load, gravity=(0.0, 0.0))))


def test_every_key_is_taken_and_what_is_not_read_is_named() -> None:
    """Rates of drives and fracture energies change nothing, and the outcome says so."""
    assert MODELS["dem-static"].takes >= {"tie", "beam", "beam.drive.displacement, cyclic", "load.live settlement"}
    drive = Drive.along((1e-3, -1e-3), 2.0, rate=1e-3)
    scene = under_beam("level", drive, friction=0.1).with_joint(
        cohesion=1e3, tensile_strength=1e3, fracture_energy_1=10.0, fracture_energy_2=10.0
    )
    message = run_model("dem-static", scene).message
    unread = "joint.fracture_energy_1, joint.fracture_energy_2, beam.drive.rate"
    assert message.endswith(f"not taken into account: {unread}")


def test_recorded_supports_move_with_the_wall() -> None:
    """The load of a frame is the share of the dead load that they bear then, as in the curve."""
    scene = wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -0.01)))
    recorder = StaticRecorder(scene, None)
    outcome = run_model("dem-static", scene, observe=recorder)
    assert [frame.multiplier for frame in recorder.frames] == pytest.approx(outcome.curve[:, 1])
    assert recorder.frames[-1].motion[3] == pytest.approx([0.0, -0.01, 0.0])
    assert recorder.frames[-1].motion[1, 1] == pytest.approx(-0.01, rel=1e-3)


@pytest.mark.parametrize(("after", "rows"), [(1, 1), (12, 12)])
def test_ctrl_c_leaves_the_way_so_far(after: int, rows: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its states at rest, the dead load's among them."""
    hold, values = LoadPath.hold, list[float]()

    def stop(path: LoadPath, start: Array, plastic_slip: Array, control: Control) -> Rest:
        values.append(control.value)
        if len(values) == after:
            raise KeyboardInterrupt
        return hold(path, start, plastic_slip, control)

    monkeypatch.setattr(LoadPath, "hold", stop)
    outcome = dem_static(under_beam("level", PUSHES[1]))
    assert (outcome.status, outcome.multiplier) == ("undecided", None)
    assert "interrupted" in outcome.message
    assert len(outcome.curve) == len(outcome.path) == rows


def test_one_run_along_a_settlement_is_no_bracket() -> None:
    """What it says is an upper end; how far off, steps half as long would say, for which the budget is spent."""
    sinks = {"kind": "settlement", "box": [[0.72, -1.0], [3.0, 0.0]], "by": [0.0, -1e-3]}
    springs = {"joint__normal_stiffness": 1e11, "joint__shear_stiffness": 4e10}
    scene = panel(load__live=sinks, **springs)
    whole = dem_static(scene)
    assert whole.status == "collapse"
    tried = (dem_static(scene, budget=budget) for budget in (300, 500, 700, 1000))
    outcome = next(found for found in tried if found.curve[-1, 0] > 9e-4)
    assert outcome.status == "undecided"
    assert (outcome.multiplier, outcome.lower) == (None, None)
    assert outcome.upper == pytest.approx(outcome.curve[-1, 1], rel=1e-9)
    assert whole.multiplier is not None
    assert outcome.upper is not None
    assert outcome.upper >= whole.multiplier
    assert "the budget ran out in steps half as long" in outcome.message
