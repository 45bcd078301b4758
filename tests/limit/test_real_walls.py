"""Limit analysis with ties, a beam on top and moving supports, against solutions by hand."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.limit import equilibrium, limit, limit_nonassociated, limit_state
from runningbond.limit.descent import jump_pattern
from runningbond.limit.force_program import coulomb, solve_forces
from runningbond.limit.kinematics import dead_load
from runningbond.limit.programs import Programs
from runningbond.limit.settlement import largest_displacement
from runningbond.models import run_model
from runningbond.results import Outcome, load_outcome, save_outcome
from runningbond.scene import (
    Array,
    BlockMaterial,
    JointMaterial,
    Lateral,
    Load,
    Scene,
    SceneError,
    Settlement,
    Tie,
    build_scene,
)
from tests.checker import check
from tests.limit.test_limit import rectangle
from tests.walls import courses, panel

MODELS = ("limit", "limit-nonassociated")
BOTH = pytest.mark.parametrize("model", MODELS)
WIDTH, HEIGHT, DENSITY, THICKNESS = 0.5, 1.2, 2000.0, 0.1
WEIGHT = WIDTH * HEIGHT * DENSITY * 9.81 * THICKNESS


def built(blocks: list[Array], friction: float, load: Load | None = None, **more: Any) -> Scene:
    return build_scene(
        "by hand",
        blocks,
        thickness=THICKNESS,
        block=BlockMaterial(DENSITY),
        joint=JointMaterial(friction),
        load=load or Load(),
        **more,
    )


def collapse(model: str, scene: Scene) -> float:
    """λ of a scene, whose bracket must be closed to 1e-6."""
    outcome = run_model(model, scene)
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier is not None
    assert outcome.lower == pytest.approx(outcome.upper, rel=1e-6, abs=1e-7)
    return outcome.multiplier


# --- ties -------------------------------------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize("friction", [0.1, 0.3, 2.0])
@pytest.mark.parametrize("pull", [0.0, 0.05, 0.3])
def test_tie_holds_block_by_its_yield_force(model: str, friction: float, pull: float) -> None:
    """Tied to an anchor at its top: λ = min(μ + T/W, (b/2 + h T/W) / (h/2)); pushed the other way the tie is slack."""
    tie = [Tie((0.0, HEIGHT), (-1.0, HEIGHT), 1e-4, 2e11, pull * WEIGHT)] if pull else []
    for direction, held in ((1.0, pull), (-1.0, 0.0)):
        scene = built([rectangle(0, 0, WIDTH, HEIGHT)], friction, Load(live=(Lateral((direction, 0.0)),)), ties=tie)
        exact = min(friction + held, (WIDTH / 2 + HEIGHT * held) / (HEIGHT / 2))
        assert collapse(model, scene) == pytest.approx(exact, rel=1e-7)


@BOTH
def test_tie_makes_two_columns_topple_together(model: str) -> None:
    """Pushed right, the slender left column topples alone: the tie between the columns shortens, and is slack."""
    columns = [rectangle(0, 0, WIDTH, HEIGHT), rectangle(2, 0, 2 * WIDTH, HEIGHT)]
    slender, wide = WIDTH / HEIGHT, 2 * WIDTH / HEIGHT
    tie = Tie((WIDTH, HEIGHT), (2.0, HEIGHT), 1e-4, 2e11, 100 * WEIGHT)
    for direction, exact in ((1.0, slender), (-1.0, (slender + 2 * wide) / 3)):
        # Pushed left, the slender column pulls the tie, and both columns topple together.
        scene = built(columns, 5.0, Load(live=(Lateral((direction, 0.0)),)), ties=[tie])
        assert collapse(model, scene) == pytest.approx(exact, rel=1e-7)


def test_only_yield_force_of_tie_counts() -> None:
    ends = ((0.0, HEIGHT), (-1.0, HEIGHT))
    ties = [Tie(*ends, 1e-4, 2e11, 100.0), Tie(*ends, 1e-3, 1e9, 100.0, 90.0)]
    found = [limit(built([rectangle(0, 0, WIDTH, HEIGHT)], 1.0, ties=[tie])) for tie in ties]
    assert found[0].multiplier == found[1].multiplier
    assert "ties count only by their yield force" in found[0].message


@BOTH
def test_tie_does_not_make_load_unbounded(model: str) -> None:
    """Lifted, a block comes off at W plus the yield force of its tie; pressed down, it locks as without a tie."""
    tie = Tie((0.25, 0.1), (0.25, -1.5), 1e-4, 2e11, 500.0)
    for force, exact in (([0.0, 1.0], WEIGHT + 500.0), ([0.0, -1.0], None)):
        live = {"kind": "point", "at": [0.25, HEIGHT], "force": force}
        scene = panel(
            wall={"block_width": WIDTH, "block_height": HEIGHT, "thickness": THICKNESS, "courses": [[1]]},
            block={"density": DENSITY},
            load={"gravity": 9.81, "live": live},
            tie=[{"from": list(tie.start), "to": list(tie.end), "area": 1e-4, "young": 2e11, "yield": 500.0}],
        )
        outcome = run_model(model, scene)
        if exact is None:
            assert outcome.status == "unbounded"
        else:
            assert outcome.multiplier == pytest.approx(exact, rel=1e-7)


def test_forces_and_mechanism_with_ties_prove_each_other() -> None:
    """Ties that lengthen yield, those that shorten are slack; stronger ties carry larger loads."""
    walls = [panel(wall__height=1.44, joint__friction=0.9, tie=_ties(pull)) for pull in (20.0, 200.0, 2e4)]
    for scene in walls:
        state = limit_state(equilibrium(scene))
        assert max(state.measures.values()) < 1e-9, state.measures
        assert limit(scene).multiplier == pytest.approx(state.system.load(state.forces.multiplier))
    loads = [limit(scene).multiplier or 0.0 for scene in walls]
    assert loads == sorted(loads)
    assert loads[-1] > loads[0] * 1.05


def _ties(pull: float) -> list[dict[str, Any]]:
    size = {"area": 1e-4, "young": 2e11, "yield": pull}
    return [{"from": [0.05, 1.41], "to": [-1.0, 0.2]} | size, {"from": [0.05, 1.29], "to": [1.4, 1.35]} | size]


@pytest.mark.parametrize(("start", "sense"), [((-1.0, HEIGHT / 2), 1.0), ((2.0, HEIGHT / 2), -1.0)])
def test_forces_drive_mechanisms_in_which_ties_yield_or_go_slack(start: tuple[float, float], sense: float) -> None:
    """A block slides to the right: a bar on its left lengthens at its yield force, and one on its right goes slack."""
    tie = Tie(start, (WIDTH / 2, HEIGHT / 2), area=1e-4, young=2e11, yield_force=0.1 * WEIGHT)
    system = equilibrium(built([rectangle(0, 0, WIDTH, HEIGHT)], 0.1, ties=(tie,)))
    forces = solve_forces(system, coulomb(system.strength))
    assert forces.tie == pytest.approx(system.tie_yield if sense > 0 else 0.0, abs=1e-9)
    motion = Programs(system).mechanism(forces, np.ones(2 * len(system.points)))
    assert motion is not None
    assert system.live @ motion == pytest.approx(1.0)
    assert sense * system.elongation(motion)[0] > 1e-6


def test_mechanisms_that_differ_only_in_their_ties_have_different_patterns() -> None:
    """A block that lifts and slides: its bed opens and slips alike, while a tie at 45° lengthens or shortens."""
    middle = (WIDTH / 2, HEIGHT / 2)
    tie = Tie(middle, (middle[0] - 2, middle[1] + 2), 1e-4, 2e11, 100.0)
    system = equilibrium(built([rectangle(0, 0, WIDTH, HEIGHT)], 0.1, ties=[tie]))
    away, towards = np.array([2.0, 1.0, 0.0]) / system.scale, np.array([1.0, 2.0, 0.0]) / system.scale
    assert system.elongation(away)[0] > 0 > system.elongation(towards)[0]
    assert jump_pattern(system, away) != jump_pattern(system, towards)


# --- the beam ---------------------------------------------------------------------------------------------------


def under_beam(condition: str, friction: float = 5.0, **beam: Any) -> Scene:
    """One block under a massless beam that is loaded by 3 W."""
    return panel(
        wall={"block_width": WIDTH, "block_height": HEIGHT, "thickness": THICKNESS, "courses": [[1]]},
        block={"density": DENSITY},
        joint={"friction": friction},
        load={"gravity": 9.81},
        beam={"height": 0.2, "condition": condition, "force": [0, -3 * WEIGHT], "drive": {"force": [1, 0]}} | beam,
    )


@BOTH
@pytest.mark.parametrize("at", [0.3, HEIGHT, 2.0])
def test_level_beam_bends_wall_in_double_curvature(model: str, at: float) -> None:
    """H = (N + W/2) b / h at any height of the drive: the thrust runs between opposite corners of the block."""
    drive = {"force": [1, 0], "at": at}
    assert collapse(model, under_beam("level", drive=drive)) == pytest.approx(3.5 * WEIGHT * WIDTH / HEIGHT, rel=1e-7)


@BOTH
def test_free_beam_rotates_with_wall(model: str) -> None:
    """H = (N + W) b / (2 h), driven at the wall's top: for a light wall half of what a level beam needs."""
    drive = {"force": [1, 0], "at": HEIGHT}
    assert collapse(model, under_beam("free", drive=drive)) == pytest.approx(2 * WEIGHT * WIDTH / HEIGHT, rel=1e-7)


@BOTH
@pytest.mark.parametrize("condition", ["free", "level"])
def test_beam_slides_on_wall(model: str, condition: str) -> None:
    drive = {"force": [1, 0], "at": HEIGHT}
    assert collapse(model, under_beam(condition, 0.2, drive=drive)) == pytest.approx(0.2 * 3 * WEIGHT, rel=1e-7)


def test_beam_at_fixed_height_locks_wall() -> None:
    """The support provides whatever vertical force the strut under the beam needs, as the message states."""
    for friction in (0.2, 0.6):
        outcome = run_model("limit", under_beam("fixed-height", friction))
        assert outcome.status == "unbounded"
        assert "whatever vertical force" in outcome.message


def test_wall_that_locks_by_dilatancy_may_collapse_with_true_friction() -> None:
    """Joints that open as they slide lock under a beam at its height; true ones let it slide on the wall."""
    scene = under_beam("fixed-height", 0.2)
    assert "with associated joints; true friction may collapse" in run_model("limit", scene).message
    assert run_model("limit-nonassociated", scene).status == "collapse"


@BOTH
def test_beam_lifted_by_its_dead_load_is_infeasible(model: str) -> None:
    """The beam is held at its height only once its dead load is on: until then nothing keeps it down."""
    assert run_model(model, under_beam("fixed-height", force=[0, 0.5 * WEIGHT])).status == "infeasible"


def test_wall_slides_without_dilatancy_under_beam_at_fixed_height() -> None:
    """At μ N with the dead N if the strut from corner to corner slides, i.e. μ < b / h; else undecided."""
    outcome = run_model("limit-nonassociated", under_beam("fixed-height", 0.2))
    assert outcome.status == "collapse"
    assert outcome.multiplier == pytest.approx(0.2 * 3 * WEIGHT, rel=1e-7)
    assert "a wall that sinks as it slides may fall earlier" in outcome.message
    outcome = run_model("limit-nonassociated", under_beam("fixed-height", 0.6))
    assert outcome.status == "undecided"
    assert "balance any multiple of the live load" in outcome.message


@BOTH
def test_drive_path_is_replaced_by_force_in_first_direction(model: str) -> None:
    pushed = collapse(model, under_beam("level"))
    for displacement in ([0.01, 0], [[0, 0.001, -0.001]]):
        outcome = run_model(model, under_beam("level", drive={"displacement": displacement}))
        assert outcome.multiplier == pytest.approx(pushed, rel=1e-9)
        assert "λ is the force on the beam [N]" in outcome.message
        assert ("first direction" in outcome.message) == isinstance(displacement[0], list)


def test_moment_held_by_level_beam() -> None:
    """The moment of N, half a width from the beam's middle, and of H about the beam's height."""
    outcome = limit(under_beam("level", drive={"force": [1, 0], "at": HEIGHT + 0.1}))
    force = 3.5 * WEIGHT * WIDTH / HEIGHT
    assert outcome.held.ravel() == pytest.approx([3 * WEIGHT * WIDTH / 2 + force * 0.1], rel=1e-7)


# --- moving supports --------------------------------------------------------------------------------------------


def on_moving(blocks: list[Array], box: tuple[tuple[float, float], tuple[float, float]], **more: Any) -> Scene:
    friction, grounds = more.pop("friction", 0.6), more.pop("grounds", ())
    return built(blocks, friction, Load(live=(Settlement(box, **more),)), grounds=grounds)


@BOTH
@pytest.mark.parametrize("cut", [0.05, 0.2, 0.24])
def test_sinking_ground_carries_block_at_far_corner(model: str, cut: float) -> None:
    """If [c, b] sinks and [0, c] stays, the block turns about c: λ = (b/2 − c) / (b − c)."""
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((cut, -1), (2, 0.1)), by=(0.0, -0.02))
    assert collapse(model, scene) == pytest.approx((WIDTH / 2 - cut) / (WIDTH - cut), rel=1e-6, abs=1e-9)


@BOTH
@pytest.mark.parametrize("cut", [0.26, 0.4])
def test_block_bridges_sinking_ground(model: str, cut: float) -> None:
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((cut, -1), (2, 0.1)), by=(0.0, -0.02))
    outcome = run_model(model, scene)
    assert outcome.status == "unbounded"
    assert "bridges the support" in outcome.message


@BOTH
@pytest.mark.parametrize("width", [0.2, 1e-3])
def test_sinking_support_carries_half_of_lintel(model: str, width: float) -> None:
    """For bearings a and span L: R = W (L/2 − a) / (L − a), half of W on bearings without width."""
    span = 2.0
    grounds = [rectangle(0, -1, width, 1), rectangle(span - width, -1, width, 1)]
    scene = on_moving([rectangle(0, 0, span, 0.3)], ((1, -2), (3, 0.1)), by=(0.0, -0.01), grounds=grounds)
    found = collapse(model, scene)
    assert found == pytest.approx((span / 2 - width) / (span - width), rel=1e-6)
    assert found == pytest.approx(0.5, rel=width)


def portal(*, mirrored: bool = False, **motion: Any) -> Scene:
    """A lintel 2.0 × 0.3 on two piers 0.4 × 1.5; the ground under the right pier (or the left one) moves."""
    blocks = [rectangle(0, 0, 0.4, 1.5), rectangle(1.6, 0, 0.4, 1.5), rectangle(0, 1.5, 2.0, 0.3)]
    box = ((-0.1, -1.0), (0.5, 0.1)) if mirrored else ((1.5, -1.0), (2.1, 0.1))
    return on_moving(blocks, box, **motion)


PIER, LINTEL = 0.4 * 1.5, 2.0 * 0.3


@BOTH
def test_portal_with_sinking_pier_hinges_at_bearings(model: str) -> None:
    """The lintel turns about the inner edge of the fixed pier, and rests on the outer edge of the sinking one.

    R = W_pier + W_lintel (L/2 − a) / (L − a).
    """
    scene = portal(by=(0.0, -0.02))
    exact = (PIER + LINTEL * 0.6 / 1.6) / (2 * PIER + LINTEL)
    assert collapse(model, scene) == pytest.approx(exact, rel=1e-7)
    outcome = run_model(model, scene)
    sunk = outcome.motion / outcome.motion[1, 1]
    assert sunk[0] == pytest.approx([0, 0, 0], abs=1e-9)
    assert sunk[1] == pytest.approx([0, 1, 0], abs=1e-9)
    assert sunk[2] == pytest.approx([-0.15 / 1.6, 0.6 / 1.6, 1 / 1.6], abs=1e-9)
    moving = scene.support_motion.any(axis=1)
    assert sunk[moving] == pytest.approx(np.array([[0, 1, 0]]), abs=1e-9)
    newtons = exact * (2 * PIER + LINTEL) * DENSITY * 9.81 * THICKNESS
    assert f"bears {newtons:.6g} N" in outcome.message


@BOTH
@pytest.mark.parametrize("by", [(0.0, -0.02), (0.01, 0.0), (0.005, -0.01)])
def test_mirrored_settlement_has_same_multiplier(model: str, by: tuple[float, float]) -> None:
    mirrored = portal(mirrored=True, by=(-by[0], by[1]))
    assert collapse(model, mirrored) == pytest.approx(collapse(model, portal(by=by)), rel=1e-9)


@BOTH
@pytest.mark.parametrize("size", [1e-6, 1.0, 7.0])
def test_size_of_settlement_has_no_influence(model: str, size: float) -> None:
    found = collapse(model, portal(by=(0.0, -size)))
    assert found == pytest.approx(collapse(model, portal(by=(0.0, -0.02))), rel=1e-9)


@BOTH
@pytest.mark.parametrize("friction", [0.6, 1.2, 3.0])
def test_flat_arch_thrust_follows_from_depth_or_friction(model: str, friction: float) -> None:
    """Three blocks b × h held by friction, one abutment gives way: H = W max(b / h, 1.5 / μ)."""
    b, h = 0.4, 0.3
    blocks = [rectangle(k * b, 0, b, h) for k in range(3)]
    grounds = [rectangle(-1, -0.5, 1, 1), rectangle(3 * b, -0.5, 1, 1)]
    scene = on_moving(blocks, ((3 * b - 0.1, -1), (5, 2)), by=(0.01, 0.0), grounds=grounds, friction=friction)
    outcome = run_model(model, scene)
    exact = max(b / h, 1.5 / friction) / 3
    if model == "limit":
        assert outcome.multiplier == pytest.approx(exact, rel=1e-7)
    # Without dilatancy the arch may fall earlier, i.e. at a larger thrust, never at a smaller one.
    elif outcome.status == "collapse":
        assert outcome.lower is not None
        assert outcome.lower >= exact * (1 - 1e-7)
    else:
        assert outcome.lower == pytest.approx(exact, rel=1e-7)


def arch(blocks: int, radius: float, depth: float) -> Scene:
    """Half a ring of voussoirs between two abutments, of which the right one gives way."""
    angles = np.linspace(math.pi, 0, blocks + 1)
    ring = np.array([np.cos(angles), np.sin(angles)]).T
    inner, outer = (radius - depth / 2) * ring, (radius + depth / 2) * ring
    voussoirs = [np.array([inner[k], inner[k + 1], outer[k + 1], outer[k]]) for k in range(blocks)]
    grounds = [rectangle(-radius - 1, -1, 2, 1), rectangle(radius - 1, -1, 2, 1)]
    return on_moving(voussoirs, ((0.1, -2), (9, 0.01)), by=(0.01, 0.0), grounds=grounds, friction=0.8)


@BOTH
def test_arch_with_spreading_abutment_has_smallest_thrust(model: str) -> None:
    """Coulomb: hinges at the top of the crown and at the inner edge of the joint of largest M_j / rise, which is H."""
    n, radius, depth = 10, 1.0, 0.25
    scene = arch(n, radius, depth)
    inside, top = radius - depth / 2, radius + depth / 2
    area, centre = scene.blocks.area[: n // 2][::-1], scene.blocks.centroid[: n // 2, 0][::-1]
    thrust = []
    for j in range(1, n // 2 + 1):  # joints from the crown to the left springing
        angle = math.pi / 2 + j * math.pi / n
        x, y = inside * math.cos(angle), inside * math.sin(angle)
        thrust.append(float((area[:j] * (centre[:j] - x)).sum() / (top - y)))
    exact = max(thrust) / scene.blocks.area[:n].sum()
    outcome = run_model(model, scene)
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(exact, rel=1e-7)
    turning = np.flatnonzero(np.abs(np.diff(outcome.motion[:n, 2])) > 1e-6)
    hinge = int(np.argmax(thrust)) + 1
    springing = hinge == n // 2
    assert sorted({*turning}) == sorted({n // 2 - 1, *(() if springing else (n // 2 - 1 - hinge, n // 2 - 1 + hinge))})


@BOTH
@pytest.mark.parametrize("about", [0.1, 0.0, -1.0])
def test_rotating_ground_carries_block_at_far_corner(model: str, about: float) -> None:
    """For any centre of rotation left of the block at ground level: the same force at the same corner."""
    cut = 0.1
    scene = on_moving(
        [rectangle(0, 0, WIDTH, HEIGHT)], ((cut, -1), (2, 0.1)), rotation_angle=-1.0, about=(about, 0.0), friction=2.0
    )
    assert collapse(model, scene) == pytest.approx((WIDTH / 2 - cut) / (WIDTH - cut), rel=1e-6)


@BOTH
@pytest.mark.parametrize(
    ("motion", "said"),
    [
        ({"by": (0.0, -0.02)}, "the support bears {0:.6g} N of a dead load of {1:.6g} N against its motion"),
        ({"by": (0.0, 0.02)}, "the support has to be driven along its motion with {1:.6g} N"),
        (
            {"rotation_angle": -1.0, "about": (0.0, 0.0)},
            "the support bears {0:.6g} N of a dead load of {1:.6g} N against its motion, as if where it moves most",
        ),
        (
            {"rotation_angle": 1.0, "about": (0.0, 0.0)},
            "the support has to be driven along its motion with {2:.6g} N, as if where it moves most",
        ),
    ],
)
def test_message_states_support_reaction(model: str, motion: dict[str, Any], said: str) -> None:
    """W (b/2 − c) / (b − c) if ground sinks from c on; W if it is lifted, W/2 if it turns up about the other end."""
    cut = 0.1
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((cut, -1), (2, 0.1)), friction=2.0, **motion)
    message = run_model(model, scene).message
    borne = WEIGHT * (WIDTH / 2 - cut) / (WIDTH - cut)
    assert said.format(borne, WEIGHT, WEIGHT / 2) in message
    assert ("where it moves most" in message) == ("rotation_angle" in motion)


def test_ground_that_turns_about_loaded_corner_is_bridged() -> None:
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((0.1, -1), (2, 0.1)), rotation_angle=1.0, about=(WIDTH, 0.0))
    assert limit(scene).status == "unbounded"


@pytest.mark.parametrize(("model", "between"), [*[(model, False) for model in MODELS], ("limit", True)])
def test_wall_that_bridges_by_friction_is_told_from_one_that_needs_none(model: str, between: bool) -> None:
    """A block whose middle is above standing ground, and one that hangs between two walls.

    With true friction it may slip down, because nothing says how hard the walls press it.
    """
    walls = (rectangle(-1, 0.1, 1, 2), rectangle(WIDTH, 0.1, 1, 2)) if between else ()
    ground = rectangle(-1, -1, WIDTH + 2, 1)
    box = ((-1.0 if between else 0.4, -1), (2, 0.05))
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], box, by=(0.0, -0.02), grounds=(ground, *walls))
    outcome = run_model(model, scene)
    assert outcome.status == "unbounded"
    assert "bridges the support" in outcome.message
    assert ("by normal forces alone" in outcome.message) == (not between)


@BOTH
def test_wall_that_bridges_by_glue_needs_more_than_normal_forces(model: str) -> None:
    """A block glued between two walls hangs by shear when the ground under its dry bed sinks."""
    grounds = (rectangle(-1, -1, WIDTH + 2, 1), rectangle(-1, 0.1, 1, 2), rectangle(WIDTH, 0.1, 1, 2))
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((-1.0, -1), (2, 0.05)), by=(0.0, -0.02), grounds=grounds)
    glued, dry = replace(scene.joint, cohesion=1e5, tensile_strength=1e4), replace(scene.joint, name="dry")
    moving = np.asarray(scene.support_motion.any(axis=1))
    bed = np.asarray(moving[scene.joints.block].any(axis=1))
    assert bed.sum() == 1
    scene = replace(scene, joint_materials=(glued, dry), material_of_joint=bed.astype(np.int64))
    outcome = run_model(model, scene)
    assert outcome.status == "unbounded"
    assert "bridges the support" in outcome.message
    assert "by normal forces alone" not in outcome.message
    said = "true friction may give way" if model == "limit" else "which does not exclude one"
    assert said in outcome.message


@BOTH
@pytest.mark.parametrize("share", [1e-5, 1e-3])
def test_support_that_bears_little_is_not_bridged(model: str, share: float) -> None:
    """The ground sinks from c = (1/2 − λ) b / (1 − λ) on, a little short of the middle of the block."""
    cut = (0.5 - share) * WIDTH / (1 - share)
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((cut, -1), (2, 0.1)), by=(0.0, -0.02), friction=2.0)
    assert collapse(model, scene) == pytest.approx(share, rel=1e-3)
    assert f"bears {share * WEIGHT:.5g} N" in run_model(model, scene).message


@pytest.mark.parametrize("slide", [0.0, 0.001, 0.004, -0.04])
def test_ground_that_sinks_and_slides_is_bridged(slide: float) -> None:
    """A block with its centre on the standing part of the ground: with true friction the sinking part loses contact.

    Associated joints dilate: they stay in contact and drag if the ground slides by more than it sinks over tan φ.
    """
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((0.7 * WIDTH, -1), (2, 0.1)), by=(slide, -0.001), friction=0.6)
    assert limit_nonassociated(scene).status == "unbounded"
    assert limit(scene).status == ("unbounded" if abs(slide) * 0.6 <= 0.001 else "collapse")


@pytest.mark.parametrize(("friction", "drags"), [(0.6, True), (0.0, False)])
def test_ground_that_slides_alone_drags_by_its_friction(friction: float, drags: bool) -> None:
    """The friction does not end, however far the ground slides; without any the ground slides away."""
    box = ((0.7 * WIDTH, -1), (2, 0.1))
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], box, by=(0.001, 0.0), friction=friction)
    assert (limit_nonassociated(scene).status == "collapse") == drags
    assert (limit(scene).status == "collapse") == drags


@pytest.mark.parametrize("clockwise", [-1.0, 1.0])
def test_reaction_of_ground_that_turns_about_middle_is_zero(clockwise: float) -> None:
    """All ground turns under a symmetric wall whose weight does no work: rounding must not be reported as a force."""
    scene = on_moving(
        [rectangle(0.1 * WIDTH, y, WIDTH, HEIGHT / 3) for y in (0, HEIGHT / 3, 2 * HEIGHT / 3)],
        ((-1, -1), (2, 0.1)),
        rotation_angle=clockwise,
        about=(0.6 * WIDTH, 0.0),
    )
    outcome = limit(scene)
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-12)
    assert "the support bears nothing of a dead load" in outcome.message


@BOTH
def test_lifted_ground_has_to_be_driven(model: str) -> None:
    """Under one end of a block that turns about its other end: λ = −(b/2) / c."""
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((0.4, -1), (2, 0.1)), by=(0.0, 0.01), friction=2.0)
    outcome = run_model(model, scene)
    assert outcome.status == "collapse"
    # The reaction acts at c = 0.4, the lifted point nearest to the hinge at 0: R c = W b / 2.
    assert outcome.multiplier == pytest.approx(-WIDTH / 2 / 0.4, rel=1e-6)
    assert "has to be driven" in outcome.message


@BOTH
def test_support_has_to_be_torn_off_its_glue(model: str) -> None:
    """The block stands without the sinking ground [c, b], which is glued to it: λ W = −f_t (b − c) t."""
    cut, tension = 0.8 * WIDTH, 100.0
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((cut, -1), (2, 0.1)), by=(0.0, -0.02))
    scene = scene.with_joint(cohesion=1000.0, tensile_strength=tension)
    assert collapse(model, scene) == pytest.approx(-tension * (WIDTH - cut) * THICKNESS / WEIGHT, rel=1e-6)
    assert "has to be driven" in run_model(model, scene).message


@BOTH
def test_wall_that_falls_before_settlement_is_infeasible(model: str) -> None:
    blocks = [rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1)]
    assert run_model(model, on_moving(blocks, ((0.8, -1), (2, 0.1)), by=(0.0, -1.0))).status == "infeasible"


@BOTH
def test_settlement_of_weightless_wall_is_refused(model: str) -> None:
    scene = on_moving([rectangle(0, 0, WIDTH, HEIGHT)], ((0.1, -1), (2, 0.1)), by=(0.0, -0.02))
    with pytest.raises(SceneError, match="gravity"):
        run_model(model, build_scene_without_weight(scene))


def build_scene_without_weight(scene: Scene) -> Scene:
    load = Load((0.0, 0.0), scene.load.live)
    return built([scene.blocks.polygon(0)], 0.6, load)


def test_forces_and_mechanism_on_settlement_prove_each_other() -> None:
    """Running bond on ground half of which sinks: dry, cohesive, with a tie, and with inset contacts."""
    live = {"kind": "settlement", "box": [[0.8, -1], [3, 0.01]], "by": [0.0, -0.01]}
    tie = {"from": [1.4, 0.65], "to": [0.05, 0.65], "area": 1e-4, "young": 2e11, "yield": 100.0}
    for more in ({}, {"joint__cohesion": 500.0}, {"tie": [tie]}, {"joint__inset": 0.004}):
        scene = panel(load__live=live, **more)
        state = limit_state(equilibrium(scene).under_live_load())
        assert max(state.measures.values()) < 1e-9, state.measures


def test_reaction_is_sum_of_joint_forces_on_support() -> None:
    """Summed from the forces in the outcome, not taken from the program's multiplier."""
    live = {"kind": "settlement", "box": [[0.8, -1], [3, 0.01]], "by": [0.0, -0.01]}
    scene = panel(load__live=live)
    outcome, system = limit(scene), equilibrium(scene)
    moving = np.asarray(scene.support_motion.any(axis=1))
    sense = moving[system.points.block[:, 1]].astype(float) - moving[system.points.block[:, 0]]
    upwards = (outcome.force[:, :1] * system.points.normal + outcome.force[:, 1:] * system.points.tangent)[:, 1]
    weight = -dead_load(scene).reshape(-1, 3)[scene.wall, 1].sum()
    assert outcome.multiplier == pytest.approx((sense @ upwards) / weight, rel=1e-9)
    assert largest_displacement(scene) == pytest.approx(0.01)


# --- stored results ---------------------------------------------------------------------------------------------


def test_tie_pulls_and_held_forces_are_stored(tmp_path: Any) -> None:
    outcome = Outcome("scene", "limit", "unbounded", pull=np.array([1.0, 2.0]), held=np.array([[3.0]]))
    save_outcome(outcome, tmp_path)
    found, _ = load_outcome(tmp_path)
    assert found.pull.tolist() == [[1.0], [2.0]]
    assert found.held.tolist() == [[3.0]]


@pytest.mark.parametrize("model", MODELS)
def test_checker_knows_supports_with_their_middle_on_a_side_of_the_box(model: str, tmp_path: Path) -> None:
    """Block 3, with its middle at 1.4, stays; sums of coordinates give 1.4000000000000001."""
    scene = courses(
        [[1, 1, 1, 1, 1], [0.5, 1, 1, 1, 1, 0.5]],
        support={"kind": "fixed-first-course"},
        load__live={"kind": "settlement", "box": [[1.4, -9.0], [9.0, 0.01]], "by": [0.0, -0.01]},
    )
    outcome = run_model(model, scene)
    assert outcome.status == "collapse"
    save_outcome(outcome, tmp_path, scene=scene)
    assert check(tmp_path)


def test_checker_accepts_a_support_that_carries_nothing(tmp_path: Path) -> None:
    """Part of the wall leaves with the ground; the share 0 is a sum of rounding errors."""
    ground = {"kind": "settlement", "box": [[0.2, -9.0], [9.0, 0.01]], "by": [0.01, 0.0]}
    scene = courses([[1, 1], [0.5, 1, 0.5]], joint__friction=0.65, load__live=ground)
    outcome = run_model("limit-nonassociated", scene)
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-12)
    save_outcome(outcome, tmp_path / "right", scene=scene)
    assert check(tmp_path / "right")
    wrong = replace(outcome, multiplier=1e-9, upper=1e-9)
    save_outcome(wrong, tmp_path / "wrong", scene=scene)
    assert not check(tmp_path / "wrong")
