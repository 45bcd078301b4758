"""Walls driven by a beam or by moving supports: closed forms, cycles, mirror images and undecided results."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.load_path import LoadPath, StaticState
from dem.relaxation import Rest
from dem.static import dem_static
from dem.static_system import Control
from runningbond import Wall
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
"""Stiffnesses of joints [Pa/m], and weight of a square metre of wall of .1 m thickness [N]."""


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
    """Assert collapse at an exact value, with a bracket around it, narrow unless a width is given."""
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
def test_block_under_level_and_under_free_beam_has_exact_strength(
    condition: Condition, exact: float, drive: Drive
) -> None:
    """Level: N at one corner of the top and N + W at the opposite corner of the base, H h = N b + W b/2.
    Free, driven at the height of its joint: N stays at the middle of the beam, H h = N b/2 + W b/2."""
    check(dem_static(under_beam(condition, drive)), exact, upper=None if drive.path else 0.01)


def test_reactions_at_end_of_drive_equal_hand_calculation() -> None:
    """The moment N b/2 keeps the beam level against the pressure at a corner, the ground carries N + W and −H; the
    drive has done the work of the plateau, and of the elastic start at half the force."""
    outcome = dem_static(under_beam("level", PUSHES[1]))
    most = (1e4 + WEIGHT) / 2
    end = dict(zip(outcome.path_columns, outcome.path[-1], strict=True))
    moment = next(value for name, value in end.items() if name.startswith("beam moment"))
    assert moment == pytest.approx(5e3, rel=1e-6)
    assert end["ground vertical [N]"] == pytest.approx(1e4 + 2 * WEIGHT, rel=1e-6)
    assert end["ground horizontal [N]"] == pytest.approx(-most, rel=1e-6)
    assert 0.99 * 0.01 * most < end["work of the live load [J]"] < 0.01 * most


def test_settling_support_takes_up_work_of_dead_load() -> None:
    """A block that sinks with all its ground: work W s of the dead load, and as much against the support reaction."""
    outcome = dem_static(wall([rectangle(0, 0, 1, 1)], ground_moves(-3.0, 3.0, (0.0, -0.01))))
    check(outcome, 1.0)
    dead, live = outcome.path[:, -3:-1].T
    assert dead[-1] - dead[0] == pytest.approx(WEIGHT * 0.01)
    assert live[-1] == pytest.approx(-WEIGHT * 0.01)


@pytest.mark.parametrize("condition", ["level", "free"])
def test_driven_beam_slides_at_friction_of_its_own_joint(condition: Condition) -> None:
    """μ N, without the weight of the block below; the curve stays at this plateau."""
    outcome = dem_static(under_beam(condition, Drive.along((5e-3,), 2.0), friction=0.1))
    check(outcome, 1e3)
    assert outcome.curve[-1] == pytest.approx([5e-3, 1e3], rel=1e-6)


@pytest.mark.parametrize("path", [(5e-3,), (1e-3, -1e-3)])
def test_beam_without_weight_slides_off_under_no_force(path: tuple[float, ...]) -> None:
    outcome = dem_static(under_beam("free", Drive.along(path, 2.0), 0.0))
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-3)


def test_drive_height_counts_from_base_and_left_push_is_mirrored() -> None:
    """Free beam, H at 2.2 m: H 2.2 = (N + W) b / 2; the same curve in both directions, to rounding."""
    right, left = (dem_static(under_beam("free", Drive.along((d,), 2.2))) for d in (4e-3, -4e-3))
    check(right, (1e4 + 2 * WEIGHT) / 4.4)
    check(left, (1e4 + 2 * WEIGHT) / 4.4)
    assert left.curve == pytest.approx(right.curve, rel=1e-9)
    assert left.motion[:, 0] == pytest.approx(-right.motion[:, 0], abs=1e-7)


def test_wall_under_fixed_height_beam_is_a_hardening_strut() -> None:
    """A diagonal strut between two corners, with springs k = K_n b t / 2 and k_t = K_t b t / 2 at both ends: thrust H,
    vertical force N = H h / b, so d = H (2 / k_t + (h/b)² 2 / k). No collapse, but the force reached is reported."""
    outcome = dem_static(under_beam("fixed-height", Drive.along((0.01,), 2.0)))
    assert outcome.status in ("undecided", "unbounded")
    assert outcome.multiplier is outcome.upper is None
    d, force = outcome.curve.T
    stiffness = 1 / (2 / (K_T * 0.05) + 4 * 2 / (K_N * 0.05))
    assert np.diff(force)[-10:] / np.diff(d)[-10:] == pytest.approx(stiffness, rel=1e-6)
    assert f"{force[-1]:,.0f} at 0.01 m" in outcome.message


def test_beam_height_is_fixed_after_dead_load() -> None:
    """At rest the joints carry N + W and N, and the restraint of the beam carries nothing."""
    seen: list[tuple[LoadPath, StaticState]] = []
    dem_static(under_beam("fixed-height", PUSHES[1]), observe=lambda *state: seen.append(state))
    system, rest = seen[0][0].system, seen[0][1]
    pressed = rest.force[:, 0] * system.equilibrium.force_unit
    assert sorted(pressed) == pytest.approx([-5e3 - WEIGHT] * 2 + [-5e3] * 2, rel=1e-9)
    assert rest.x[system.freedoms : -1] == pytest.approx(0.0, abs=1e-9)
    heights = [system.motion(state.x)[1, 1] for _, state in seen]
    assert heights == pytest.approx([heights[0]] * len(heights), rel=1e-9)


def test_cyclic_sliding_dissipates_area_of_loop() -> None:
    """Rigid-plastic ± μ N with elastic slope k: from a to −a and back 4 μ N (a − μ N / k), dissipated by friction."""
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


def test_growing_cycles_of_shear_wall_and_of_its_mirror_agree() -> None:
    """A wall in running bond under a level beam; the beam slides at μ N in both directions."""
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


def test_low_beam_does_not_set_collapse_displacement() -> None:
    """A beam of 5 cm on blocks of 2 m, and a beam as the only moving block."""
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


def test_lintel_of_portal_with_settling_pier_rests_on_two_edges() -> None:
    """The right pier sinks: the lintel, W for 1 m², rotates about the left pier's inner edge and bears on the right
    pier's outer edge, R 2 = W (1.25 − .5). The right base carries R and its pier's W, out of 3 W. The lintel rotates
    by s / 2, so the edge of its left bearing lifts by s / 4."""
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
def test_final_state_of_portal_does_not_depend_on_settlement_path(
    model: Callable[[Scene], Outcome], path: tuple[float, ...], lever: float
) -> None:
    """If the pier rises, the lintel bears on the pier's inner edge and the other pier's outer one: R 2 = W 1.25."""
    outcome = model(wall(PORTAL, replace(ground_moves(1.8, 3.0, (0.0, -0.01)), path=path)))
    check(outcome, (lever + 1) / 3, rel=1e-6 if model is dem_static else 1e-3)
    assert outcome.curve[:, 0].max() == pytest.approx(0.01 * max(path))
    assert outcome.curve[:, 0].min() == pytest.approx(0.01 * min(path))
    assert outcome.curve[-1, 0] == pytest.approx(0.01 * path[-1])


@pytest.mark.parametrize(("path", "sense"), [((1.0, -0.5), -1.0), ((0.5, -1.0), 1.0)])
def test_motion_is_drawn_where_the_settlement_is_farthest(path: tuple[float, ...], sense: float) -> None:
    """The pier sinks at the start of both paths, and is lifted farther than that by one of them."""
    outcome = dem_static(wall(PORTAL, replace(ground_moves(1.8, 3.0, (0.0, -0.01)), path=path)))
    assert outcome.motion[1] / abs(outcome.motion[1, 1]) == pytest.approx([0.0, sense, 0.0], abs=2e-3)


@pytest.mark.parametrize("model", [dem_static, dem_dynamic])
@pytest.mark.parametrize(("by", "path"), [(-1e-6, (-1.0,)), (1e-6, (1.0,))])
def test_slightly_lifted_pier_gives_one_sided_bound(
    model: Callable[[Scene], Outcome], by: float, path: tuple[float, ...]
) -> None:
    """Its share grows from 1/2 towards (.625 + 1) / 3, negative for a lift; the share reached falls short of it."""
    outcome = model(wall(PORTAL, replace(ground_moves(1.8, 3.0, (0.0, by)), path=path)))
    assert outcome.status == "undecided"
    assert "still takes up load" in outcome.message
    reached, mechanism = outcome.curve[-1, 1], -np.sign(by) * (0.625 + 1) / 3
    assert 0.5 < abs(reached) < abs(mechanism)
    assert outcome.lower is None or outcome.lower <= mechanism
    assert outcome.upper is None or outcome.upper >= mechanism
    assert (outcome.lower is None) != (outcome.upper is None)


def test_block_over_sinking_part_of_ground_leans_on_rest() -> None:
    """1 m long, cut at .4 m: pivots there, R (1 − .4) = W (.5 − .4); if the other part sinks, R .4 = 0: bridged."""
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
def test_arch_of_three_blocks_has_minimum_and_maximum_thrust(
    sense: float, hinges: tuple[tuple[float, float], tuple[float, float]]
) -> None:
    """H follows from moments of half the middle block, about a hinge of the joint at 60°, and of a side block about the
    hinge of its springing. Spreading opens the springing's extrados and the joint's intrados; closing does the
    reverse. The reaction against the motion is H, positive if the support gives way."""
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


def test_clamped_block_falls_when_support_moves_away() -> None:
    """A tie presses a block against a support that moves away by s: finally W / 2 = μ N on each face, and the pressing
    block's base resists with μ (W₁ + W / 2), so K s = P − N − that; N is the last force on the support."""
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


def test_ground_rotation_is_controlled_by_farthest_joint_end() -> None:
    """A block on ground that rotates about its middle by 1°: the block rotates too, and its weight does no work."""
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


def test_settlement_of_half_a_wall_and_of_its_mirror_agree() -> None:
    rows: list[list[float]] = [[0.5, 1, 1, 0.5], [1, 1, 1]] * 3
    right, left = (dem_static(mortared(rows, [[x, -9], [x + 9, 0]])) for x in (0.6, -8.4))
    assert right.status == left.status == "collapse"
    assert left.multiplier == pytest.approx(right.multiplier, rel=1e-3)
    assert right.multiplier is not None
    assert 0 < right.multiplier < 0.5


@pytest.mark.parametrize("model", [dem_static, dem_dynamic])
@pytest.mark.parametrize("slides", [False, True])
def test_share_that_hangs_on_friction_is_said_to_depend_on_the_path(
    model: Callable[[Scene], Outcome], slides: bool
) -> None:
    """A lintel that rocks on two edges, and half of a wall that slides down along the other half."""
    rows: list[list[float]] = [[0.5, 1, 1, 0.5], [1, 1, 1]] * 3
    scene = mortared(rows, [[0.6, -9], [9, 0]]) if slides else wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -0.01)))
    outcome = model(scene)
    assert outcome.status == "collapse", outcome.message
    assert ("joints slide: another path" in outcome.message) == slides


@pytest.mark.parametrize("model", [dem_static, dem_dynamic])
def test_wall_that_bridges_its_support_after_sliding_is_said_to_depend_on_the_path(
    model: Callable[[Scene], Outcome],
) -> None:
    """A stone that leans on a plate with three times its weight hangs there by friction as the ground sinks."""
    stone = Wall.outlines(
        [rectangle(0, 0, 1, 1)],
        [rectangle(-1, 0, 1, 1), rectangle(0, -1, 1, 1)],
        thickness=0.1,
        density=2000.0,
        friction=0.8,
        normal_stiffness=1e9,
        shear_stiffness=4e8,
        load={
            "gravity": 9.81,
            "dead": {"kind": "body", "acceleration": [-29.43, 0.0]},
            "live": {"kind": "settlement", "box": [[0, -2], [1, 1e-4]], "by": [0, -0.001]},
        },
    )
    outcome = model(stone.scene)
    assert outcome.status == "unbounded", outcome.message
    assert "joints slide: another path" in outcome.message


# --- undecided results and refusals --------------------------------------------------------------------------


def test_slightly_moved_support_is_undecided() -> None:
    outcome = dem_static(wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -1e-6))))
    assert (outcome.status, outcome.lower) == ("undecided", None)
    assert "still sheds load where its settlement ends" in outcome.message
    assert f"it bears {number(outcome.curve[-1, 1])} at 1e-06 m; " in outcome.message
    assert outcome.upper == pytest.approx(outcome.curve[-1, 1], rel=1e-6)
    assert 1.375 / 3 < outcome.curve[-1, 1] < 0.5


@pytest.mark.filterwarnings("ignore:tie.*is an anchor fixed in space")
@pytest.mark.parametrize("back", [0.5, 0.85, 0.95])
def test_tie_that_unloads_along_a_short_last_leg_is_no_mechanism(back: float) -> None:
    """A block on ground that sinks by 1 mm, and rises again by less, hangs on a tie that yields at 1 kN."""
    stiffness, weight, yield_force = 1.05e6, 0.5 * 0.4 * 2000 * 9.81, 1000.0
    held = Wall.outlines(
        [rectangle(0.0, 0.0, 0.5, 1.0)],
        [rectangle(-2.0, -0.5, 5.0, 0.5)],
        thickness=0.4,
        density=2000.0,
        friction=0.8,
        tie=[{"from": [0.25, 1], "to": [0.25, 2], "area": 1e-4, "young": 1e4 * stiffness, "yield": yield_force}],
        live={"kind": "settlement", "box": [[-3, -1], [4, 1e-4]], "by": [0, -1e-3], "path": [1, back]},
        normal_stiffness=1e10,
        shear_stiffness=4e9,
    )
    outcome = dem_static(held.scene)
    assert (outcome.status, outcome.upper) == ("undecided", None)
    share = 1 - (yield_force - stiffness * 1e-3 * (1 - back)) / weight
    assert outcome.lower == pytest.approx(share, rel=1e-3)


def test_answer_of_a_cycle_is_the_reaction_along_its_first_move() -> None:
    """Elastic: twice the reaction at twice the displacement the other way."""
    outcome = dem_static(under_beam("level", Drive.along((1e-5, -2e-5), 2.0)))
    moved, force = outcome.curve.T
    assert outcome.lower == pytest.approx(force[moved.argmax()], rel=1e-9)
    assert f"{number(force.max())} at 1e-05 m" in outcome.message
    assert force.min() == pytest.approx(-2 * force.max(), rel=1e-6)


def test_displacements_of_a_drive_start_at_rest_under_the_dead_load() -> None:
    """A third of the weight pushes sideways beforehand, by a displacement that is no part of the path."""
    beam = {"height": 0.1, "force": [0, -5e3], "drive": {"displacement": [1e-5, 0.0]}}
    sideways = {"kind": "body", "acceleration": [3.27, 0.0]}
    springs = {"joint__normal_stiffness": 1e9, "joint__shear_stiffness": 4e8}
    outcome = dem_static(panel(load__live=None, load__dead=sideways, beam=beam, **springs))
    assert outcome.curve[0, 0] == pytest.approx(0.0, abs=1e-15)
    assert outcome.curve[0, 1] == pytest.approx(0.0, abs=1e-6)
    assert outcome.curve[-1, 0] == pytest.approx(1e-5, rel=1e-9)


def test_drive_ending_in_elastic_range_is_undecided() -> None:
    outcome = dem_static(under_beam("level", Drive.along((1e-5,), 2.0)))
    assert (outcome.status, outcome.upper) == ("undecided", None)
    assert outcome.lower == pytest.approx(outcome.curve[-1, 1], rel=1e-6)
    reached = f"{number(outcome.curve[-1, 1])} at 1e-05 m"
    assert f"still hardens where its drive ends, which takes {reached}; " in outcome.message


@pytest.mark.parametrize("budget", [5, 40])
def test_exhausted_budget_is_undecided(budget: int) -> None:
    scene = mortared([[0.5, 1, 1, 0.5], [1, 1, 1]] * 3, [[0.6, -9], [9, 0]])
    outcome = dem_static(scene, budget=budget)
    assert outcome.status == "undecided"
    assert outcome.multiplier is None


def test_support_of_a_weightless_wall_is_refused() -> None:
    scene = wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -1e-6)))
    with pytest.raises(SceneError, match=r"load\.gravity = 0"):
        dem_static(replace(scene, load=replace(scene.load, gravity=(0.0, 0.0))))


def test_all_keys_are_accepted_and_unused_ones_are_listed() -> None:
    """Drive rates and fracture energies have no effect, and the outcome lists them."""
    assert MODELS["dem-static"].takes >= {"tie", "beam", "beam.drive.displacement, cyclic", "load.live settlement"}
    drive = Drive.along((1e-3, -1e-3), 2.0, rate=1e-3)
    scene = under_beam("level", drive, friction=0.1).with_joint(
        cohesion=1e3, tensile_strength=1e3, fracture_energy_1=10.0, fracture_energy_2=10.0
    )
    message = run_model("dem-static", scene).message
    unread = "joint.fracture_energy_1, joint.fracture_energy_2, beam.drive.rate"
    assert message.endswith(f"not taken into account: {unread}")


def test_recorded_supports_move_with_the_wall() -> None:
    """The multiplier of a frame is the share of the dead load on the support, as in the curve."""
    scene = wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -0.01)))
    recorder = StaticRecorder(scene, None)
    outcome = run_model("dem-static", scene, observe=recorder)
    assert [frame.multiplier for frame in recorder.frames] == pytest.approx(outcome.curve[:, 1])
    assert recorder.frames[-1].motion[3] == pytest.approx([0.0, -0.01, 0.0])
    assert recorder.frames[-1].motion[1, 1] == pytest.approx(-0.01, rel=1e-3)


@pytest.mark.parametrize(("after", "rows"), [(1, 1), (12, 12)])
def test_interrupt_keeps_curve_so_far(after: int, rows: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its states at rest, including the one under dead load."""
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


def test_single_run_along_settlement_is_undecided() -> None:
    """One run gives an upper bound; its error would follow from steps half as long, but the budget is exhausted."""
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


def test_step_without_verdict_in_second_run_is_not_put_down_to_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first step of the second run, half as long as that of the first, neither rests nor falls."""
    hold, values = LoadPath.hold, list[float]()

    def held(path: LoadPath, start: Array, plastic_slip: Array, control: Control) -> Rest:
        values.append(control.value)
        if control.value < values[0]:
            return Rest("undecided", start, path.system.respond(start, plastic_slip), start, 10)
        return hold(path, start, plastic_slip, control)

    monkeypatch.setattr(LoadPath, "hold", held)
    outcome = dem_static(wall(PORTAL, ground_moves(1.8, 3.0, (0.0, -0.01))))
    assert outcome.status == "undecided"
    assert "m it neither rested nor fell in steps half as long" in outcome.message
    assert "budget" not in outcome.message
