"""Limit analysis of rigid blocks: kinematics, exact collapse loads, invariances, proofs and verdicts."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime, linprog

from runningbond.joints import joint_points
from runningbond.limit import (
    bears_dead_load,
    equilibrium,
    is_self_locking,
    limit,
    limit_nonassociated,
    limit_state,
    proved_bound,
)
from runningbond.limit.associated import STRENGTH_CAP
from runningbond.limit.certificates import Certificate, certified_loads
from runningbond.limit.force_program import ForceSolution
from runningbond.limit.kinematics import (
    dead_load,
    jump_operator,
    live_load,
    mass_matrix_diagonal,
    movable_freedoms,
    pin_operator,
)
from runningbond.results import Outcome
from runningbond.scene import (
    Array,
    BlockMaterial,
    JointMaterial,
    Lateral,
    Load,
    PointLoad,
    Scene,
    SceneError,
    build_scene,
    scene_from_dict,
)
from runningbond.scene.materials import MOST_FRICTION
from tests.walls import content, courses, panel

EXACT = 1e-9
WINDOW: list[list[float]] = [
    [1, 1, 1],
    [0.5, 1, 1, 0.5],
    [1, -1, 1],
    [0.5, 0.5, -1, 0.5, 0.5],
    [0.5, 2, 0.5],
    [1, 1, 1],
]


def rectangle(x: float, y: float, width: float, height: float) -> Array:
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


def pile(blocks: list[Array], friction: float, live: Lateral | PointLoad | None = None) -> Scene:
    """Blocks on a flat base, dry joints, pushed along +x."""
    return build_scene(
        "pile",
        blocks,
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(friction),
        load=Load(live=(live or Lateral(),)),
    )


def multiplier(scene: Scene) -> float:
    outcome = limit(scene)
    assert outcome.status == "collapse"
    assert outcome.multiplier is not None
    return outcome.multiplier


# --- kinematics ----------------------------------------------------------------------------------------------


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1))
def test_rigid_body_motion_opens_no_joint(u: float, v: float, spin: float) -> None:
    scene = courses(WINDOW)
    centroid = scene.blocks.centroid
    motion = np.column_stack([u - spin * centroid[:, 1], v + spin * centroid[:, 0], np.full(len(centroid), spin)])
    jump = jump_operator(joint_points(scene.joints, scene.thickness), centroid)
    assert np.abs(jump.opening @ motion.ravel()).max() < 1e-14
    assert np.abs(jump.slip @ motion.ravel()).max() < 1e-14


def test_signs_of_opening_and_slip() -> None:
    """Opening is positive; if the normal points up, the tangent points to −x."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(0, 1, 1, 1)], 0.5)
    points = joint_points(scene.joints, scene.thickness)
    between = (points.block == [0, 1]).all(axis=1)
    jump = jump_operator(points, scene.blocks.centroid)
    motion = np.zeros(9)
    motion[3:5] = 0.2, 0.1
    assert (jump.opening @ motion)[between] == pytest.approx([0.1, 0.1])
    assert (jump.slip @ motion)[between] == pytest.approx([-0.2, -0.2])


def test_jump_operator_is_derivative_of_rigid_motion() -> None:
    """Against finite differences of points moved by exact rotations."""
    scene = courses(WINDOW)
    points = joint_points(scene.joints, scene.thickness)
    centroid = scene.blocks.centroid

    def opening(motion: Array, k: int) -> float:
        moved = []
        for block in points.block[k]:
            u, v, spin = motion.reshape(-1, 3)[block]
            x, y = points.position[k] - centroid[block]
            c, s = math.cos(spin), math.sin(spin)
            moved.append(centroid[block] + [u + c * x - s * y, v + s * x + c * y])
        return float((moved[1] - moved[0]) @ points.normal[k])

    jump = jump_operator(points, centroid)
    rest = np.zeros(3 * len(centroid))
    for k in (0, 7, len(points) - 1):
        assert jump.opening[[k]].toarray()[0] == pytest.approx(approx_fprime(rest, opening, 1e-7, k), abs=1e-6)


def test_loads_sum_to_weight_of_wall() -> None:
    scene = panel()
    weight = 1800 * 9.81 * 1.44 * 0.72 * 0.12
    dead, live = dead_load(scene).reshape(-1, 3), live_load(scene).reshape(-1, 3)
    assert dead[scene.wall].sum(axis=0) == pytest.approx([0, -weight, 0])
    assert live[scene.wall].sum(axis=0) == pytest.approx([weight, 0, 0])


def test_shared_point_load_keeps_force_and_moment() -> None:
    """About any point, the forces on the blocks add up to the force and moment of the point load."""
    at, force = np.array([0.72, 0.72]), np.array([0.3, -1.0])
    live = {"kind": "point", "at": at.tolist(), "force": force.tolist()}
    scene = panel(wall__first_course="half", load__live=live)
    load = live_load(scene).reshape(-1, 3)
    centroid = scene.blocks.centroid
    moment = load[:, 2] + centroid[:, 0] * load[:, 1] - centroid[:, 1] * load[:, 0]
    assert load[:, :2].sum(axis=0) == pytest.approx(force)
    assert moment.sum() == pytest.approx(at[0] * force[1] - at[1] * force[0])


def test_pin_operator_returns_corner_displacement() -> None:
    scene = panel(support__kind="pinned-corners")
    centroid = scene.blocks.centroid
    spin = np.column_stack([-centroid[:, 1], centroid[:, 0], np.ones(len(centroid))]).ravel()
    expected = [-y if d[0] else x for (x, y), d in zip(scene.pins.point, scene.pins.direction, strict=True)]
    assert pin_operator(scene) @ spin == pytest.approx(expected)


def test_mass_matrix_of_rectangles() -> None:
    mass = mass_matrix_diagonal(panel()).reshape(-1, 3)[0]
    m = 1800 * 0.12 * 0.24 * 0.06
    assert mass == pytest.approx([m, m, m * (0.24**2 + 0.06**2) / 12])


# --- exact collapse loads ------------------------------------------------------------------------------------


FRICTION = st.one_of(st.just(0.0), st.floats(1e-3, 3))
"""Down to a thousandth: HiGHS balances forces to 1e-7 of the largest weight, so λ is no more accurate."""


@given(width=st.floats(0.02, 5), height=st.floats(0.02, 5), friction=FRICTION, n=st.integers(1, 6))
@settings(max_examples=60)
def test_stack_slides_at_mu_or_topples_at_b_over_nh(width: float, height: float, friction: float, n: int) -> None:
    """n equal blocks b × h: λ = min(μ, b / (n h)), with or without dilatancy."""
    scene = pile([rectangle(0, i * height, width, height) for i in range(n)], friction)
    exact = min(friction, width / (n * height))
    assert multiplier(scene) == pytest.approx(exact, rel=1e-7, abs=1e-9)
    outcome = limit_nonassociated(scene, starts=4)
    assert outcome.status == "collapse"
    assert outcome.lower == pytest.approx(exact, rel=1e-6, abs=1e-9)
    assert outcome.upper == pytest.approx(exact, rel=1e-6, abs=1e-9)


@given(
    top=st.floats(0.1, 1.0),
    offset=st.floats(0, 1),
    h1=st.floats(0.2, 3),
    h2=st.floats(0.2, 3),
    friction=st.floats(0.05, 2),
)
@settings(max_examples=60)
def test_couplet_topples_about_weakest_corner(top: float, offset: float, h1: float, h2: float, friction: float) -> None:
    """A block of width b2 on a block of width 1: the upper one topples alone, or both about the corner of the base."""
    x = offset * (1 - top)
    scene = pile([rectangle(0, 0, 1, h1), rectangle(x, h1, top, h2)], friction)
    w1, w2 = h1, top * h2
    upper = top / h2
    both = (w1 * 0.5 + w2 * (1 - x - top / 2)) / (w1 * h1 / 2 + w2 * (h1 + h2 / 2))
    assert multiplier(scene) == pytest.approx(min(friction, upper, both), rel=1e-7)


@pytest.mark.parametrize("friction", [0.6, 1e3, 1e6])
def test_weightless_dry_row_carries_nothing(friction: float) -> None:
    """Nothing presses on its joints. With tan φ = 1e6, rounding errors of slips were taken for interpenetration."""
    push = {"kind": "point", "at": [0.0, 0.01], "force": [1.0, 0.0]}
    row = {"wall__length": 2.0, "wall__height": 0.02, "wall__block_width": 1.0, "wall__block_height": 0.02}
    scene = panel(**row, wall__first_course="half", joint__friction=friction, load__live=push, load__gravity=0.0)
    outcome = limit(scene)
    assert (outcome.status, outcome.lower, outcome.upper) == ("collapse", 0.0, 0.0)


@given(height=st.floats(0.1, 3), friction=st.floats(0.02, 2), weight=st.floats(100, 1e6))
@settings(max_examples=40)
def test_point_load_slides_or_topples_block(height: float, friction: float, weight: float) -> None:
    """Pushed at its top a block 1 × h resists P = W min(μ, 1 / (2 h))."""
    live = PointLoad((0.0, height), (1.0, 0.0))
    scene = pile([rectangle(0, 0, 1, height)], friction, live)
    scene = scene.with_block(density=weight / (9.81 * 0.1 * height))
    assert multiplier(scene) == pytest.approx(weight * min(friction, 1 / (2 * height)), rel=1e-6)


@given(cohesion=st.floats(1e3, 1e6), friction=FRICTION)
@settings(max_examples=30)
def test_weightless_block_slides_at_cohesion(cohesion: float, friction: float) -> None:
    """Sheared along its base, a flat weightless block resists P = c A unless it rocks."""
    live = {"kind": "point", "at": [0.0, 0.0], "force": [1, 0]}
    scene = panel(
        wall__length=0.24,
        wall__height=0.06,
        load={"gravity": 0.0, "live": live},
        joint={"friction": friction, "cohesion": cohesion, "tensile_strength": 0.5 * cohesion / max(friction, 1.0)},
    )
    assert multiplier(scene) == pytest.approx(cohesion * 0.24 * 0.12, rel=1e-6)


@given(cohesion=st.floats(1e3, 1e6), friction=st.floats(0.01, 2), cut=st.floats(0.01, 1))
@settings(max_examples=30)
def test_tension_cut_off_limits_uplift(cohesion: float, friction: float, cut: float) -> None:
    """Pulled straight up, a weightless block comes off at f_t A."""
    tension = cut * cohesion / friction
    live = {"kind": "point", "at": [0.12, 0.06], "force": [0, 1]}
    scene = panel(
        wall__length=0.24,
        wall__height=0.06,
        load={"gravity": 0.0, "live": live},
        joint={"friction": friction, "cohesion": cohesion, "tensile_strength": tension},
    )
    assert multiplier(scene) == pytest.approx(tension * 0.24 * 0.12, rel=1e-6)


# --- invariances ---------------------------------------------------------------------------------------------


def mapped(scene: Scene, change: Callable[[Array], Array], *, turn: Callable[[Array], Array], mirror: bool) -> Scene:
    """The same wall with points, loads and ground moved by `change`, and directions by `turn`."""
    outlines = [change(scene.blocks.polygon(i)) for i in range(len(scene.blocks))]
    if mirror:
        outlines = [outline[::-1] for outline in outlines]
    gravity, push = turn(np.array([[0.0, -9.81], [1.0, 0.0]]))
    return build_scene(
        scene.title,
        outlines[:-1],
        thickness=scene.thickness,
        block=scene.block,
        joint=scene.joint,
        load=Load((float(gravity[0]), float(gravity[1])), (Lateral((float(push[0]), float(push[1]))),)),
        grounds=outlines[-1:],
    )


@pytest.mark.parametrize("pattern", [WINDOW, [[1, 1, 1], [0.5, 1, 1, 0.5], [-0.5, 1, 1]]])
def test_mirrored_wall_has_same_multiplier(pattern: list[list[float]]) -> None:
    scene = courses(pattern)
    mirrored = mapped(scene, lambda p: p * [-1, 1], turn=lambda v: v * [-1, 1], mirror=True)
    assert multiplier(mirrored) == pytest.approx(multiplier(scene), rel=EXACT)


@pytest.mark.parametrize("angle", [0.3, 1.0, -2.5])
def test_rotated_wall_has_same_multiplier(angle: float) -> None:
    c, s = math.cos(angle), math.sin(angle)
    rotation = np.array([[c, s], [-s, c]])
    scene = courses(WINDOW)
    rotated = mapped(scene, lambda p: p @ rotation + [3.0, -7.0], turn=lambda v: v @ rotation, mirror=False)
    assert len(rotated.joints) == len(scene.joints)
    assert multiplier(rotated) == pytest.approx(multiplier(scene), rel=1e-8)


@pytest.mark.parametrize("factor", [1e-6, 1e-2, 1e3])
@pytest.mark.parametrize("key", ["wall__thickness", "block__density", "load__gravity"])
def test_dry_multiplier_is_independent_of_weight(key: str, factor: float) -> None:
    room, name = key.split("__")
    value = content()[room][name] * factor
    scene, scaled = panel(wall__height=0.24), panel(wall__height=0.24, **{key: value})
    assert multiplier(scaled) == pytest.approx(multiplier(scene), rel=EXACT)


@pytest.mark.parametrize("factor", [1e-6, 1e-2, 1e3])
def test_dry_multiplier_is_independent_of_size(factor: float) -> None:
    assert multiplier(courses(WINDOW, width=0.4 * factor, height=0.175 * factor)) == pytest.approx(
        multiplier(courses(WINDOW)), rel=EXACT
    )


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e6])
def test_collapse_force_is_independent_of_load_unit(unit: float) -> None:
    def crushed(force: float) -> float:
        live = {"kind": "point", "at": [0.72, 0.72], "force": [0, -force]}
        return multiplier(panel(joint__cohesion=1e5, support__kind="corners", load={"gravity": 0.0, "live": live}))

    assert crushed(unit) * unit == pytest.approx(crushed(1.0), rel=1e-8)


# --- proofs of programs --------------------------------------------------------------------------------------


WALLS: dict[str, Scene] = {
    "window": courses(WINDOW),
    "fixed": panel(support__kind="fixed-first-course"),
    "toothed": panel(wall__ends="toothed"),
    "inset": courses(WINDOW, joint__inset=0.02),
    "cohesive": panel(joint__cohesion=2e3),
    "cut-off": panel(joint__cohesion=2e3, joint__tensile_strength=5e2),
    "frictionless": panel(joint={"friction": 0.0, "cohesion": 2e3, "tensile_strength": 1e3}),
    "corners": panel(
        joint__cohesion=1e5,
        support__kind="corners",
        load={"gravity": 0.0, "live": {"kind": "point", "at": [0.72, 0.72], "force": [0, -1]}},
    ),
}


@pytest.mark.parametrize("name", WALLS)
def test_forces_and_mechanism_prove_each_other(name: str) -> None:
    """Equilibrium, admissibility, flow rule, strong duality and complementarity, each to 1e-9."""
    state = limit_state(equilibrium(WALLS[name]))
    assert state.forces.status == "optimal"
    assert max(state.measures.values()) < 1e-9, state.measures


@pytest.mark.parametrize("name", WALLS)
def test_certificates_satisfy_equilibrium_and_coulomb(name: str) -> None:
    """The certified forces balance the loads, obey Coulomb, and lie below the associated bound."""
    scene = WALLS[name]
    outcome, bound = limit_nonassociated(scene, starts=4), multiplier(scene)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.upper <= bound * (1 + 1e-9)
    system = equilibrium(scene)
    free = movable_freedoms(scene)
    jump = jump_operator(system.points, scene.blocks.centroid)
    normal, tangential = outcome.force.T
    unbalanced = (
        jump.opening[:, free].T @ normal
        + jump.slip[:, free].T @ tangential
        - (dead_load(scene) + outcome.lower * live_load(scene))[free]
    )
    if not len(scene.pins):
        assert np.abs(unbalanced).max() < 1e-7 * np.abs(outcome.force).max()
    strength = system.strength
    unit = system.force_unit
    assert strength.violation(normal / unit, tangential / unit).max() < 1e-7 * np.abs(outcome.force).max() / unit
    opening, slip = jump.opening @ outcome.motion.ravel(), jump.slip @ outcome.motion.ravel()
    largest = max(np.abs(opening).max(), np.abs(slip).max())
    assert opening.min() > -1e-5 * largest
    # An opening point carries its full tension; a sliding one its limiting shear force, against the slip.
    resist = strength.tension * unit - normal
    assert np.abs(resist[opening > 1e-5 * largest]).max(initial=0.0) < 1e-7 * np.abs(outcome.force).max()
    slides = np.abs(slip) > 1e-5 * largest
    limit_force = strength.shear * unit + strength.friction * resist
    assert np.allclose(
        tangential[slides], np.sign(slip[slides]) * limit_force[slides], atol=1e-7 * np.abs(outcome.force).max()
    )


def test_mechanism_is_scaled_to_fastest_corner() -> None:
    scene = courses(WINDOW)
    motion = limit(scene).motion
    assert not motion[scene.fixed].any()
    arm = scene.blocks.vertices - scene.blocks.centroid[scene.blocks.owner]
    u, v, spin = motion[scene.blocks.owner].T
    assert np.hypot(u - spin * arm[:, 1], v + spin * arm[:, 0]).max() == pytest.approx(1)


# --- verdicts ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_wall_that_falls_under_dead_load_is_infeasible(model: Callable[[Scene], object]) -> None:
    """A corbel whose upper block overhangs by more than half."""
    outcome = model(pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1)], 0.5))
    assert outcome.status == "infeasible"  # type: ignore[attr-defined]
    assert outcome.multiplier is None  # type: ignore[attr-defined]


@pytest.mark.parametrize("friction", [1e-6, 3e-6, 1e-5, 1e-3])
def test_joints_of_low_friction_are_not_taken_for_frictionless(friction: float) -> None:
    """Slender blocks that may split, on held corners: the pressure between the halves is a million weights.

    λ is linear in the friction of the splits. The simplex method, whose tolerance is a tenth of the smallest friction,
    found two thirds of λ.
    """
    pier = {"block_width": 0.01, "block_height": 0.5, "length": 0.015, "height": 1.5, "thickness": 0.12}

    def answer(between: float) -> Outcome:
        walls = {"wall": {**pier, "first_course": "full"}, "inner_joint": {"friction": between}}
        return limit(panel(**walls, support__kind="pinned-corners", joint={"friction": 0.75}))

    low, high = (answer(between).multiplier for between in (0.05, 0.1))
    assert low is not None
    assert high is not None
    outcome = answer(friction)
    expected = low + (high - low) * (friction - 0.05) / 0.05
    assert (outcome.lower, outcome.upper) == pytest.approx((expected, expected), rel=1e-6)


def test_split_blocks_of_largest_friction_topple() -> None:
    """λ = b / (n h). Rounding times tan φ violates the flow rule, and the attempted repair meets a zero pivot."""
    size = {"block_width": 0.2, "block_height": 0.1, "length": 0.2, "height": 0.3, "thickness": 0.12}
    joints = {"joint": {"friction": MOST_FRICTION}, "inner_joint": {"friction": 1.0}}
    outcome = limit(panel(wall={**size, "first_course": "full"}, **joints))
    assert (outcome.lower, outcome.upper) == pytest.approx((2 / 3, 2 / 3), rel=1e-6)


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_fall_under_dead_load_moves_only_falling_block(model: Callable[[Scene], Outcome]) -> None:
    """Of three blocks, only the one that overhangs moves: it tips about the corner on which it rests."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1), rectangle(3, 0, 1, 1)], 0.5)
    corbel, motion = scene.blocks.centroid[:, 1].argmax(), model(scene).motion
    u, v, spin = motion[corbel]
    edge = np.array([1.0, 1.0]) - scene.blocks.centroid[corbel]
    assert np.array([u - spin * edge[1], v + spin * edge[0]]) == pytest.approx(0.0, abs=1e-9)
    assert spin < 0
    assert not np.delete(motion, corbel, axis=0).any()


@given(
    strength=st.floats(0.01, 0.95),  # relative to the strength that carries the weight
    overhang=st.floats(0.51, 0.9),
    crushing=st.booleans(),
)
@settings(max_examples=12, deadline=None)
def test_message_states_share_of_weight_that_weak_joints_carry(
    strength: float, overhang: float, crushing: bool
) -> None:
    """Share: f_t l² t / 2 about the corner, over ρ g l h t (o − 1/2) l for a block of length l that overhangs by o l.

    The joint is (1 − o) l long. With gravity below that share of g the wall stands.
    """
    share, length, density, gravity = strength, 1.0 - overhang, 2000.0, 9.81
    tension = share * density * gravity * (overhang - 0.5) * 2 / length**2
    joint = JointMaterial(0.7, cohesion=10 * tension, tensile_strength=tension)
    if crushing:  # negligibly: the end of the joint presses on one point
        joint = replace(joint, compressive_strength=1e6 * tension)
    blocks = [rectangle(0, 0, 1, 1), rectangle(overhang, 1, 1, 1)]

    def wall(gravity: float) -> Scene:
        load = Load(gravity=(0.0, -gravity))
        return build_scene("corbel", blocks, thickness=0.5, block=BlockMaterial(density), joint=joint, load=load)

    outcome = limit(wall(gravity))
    assert outcome.status == "infeasible"
    said = float(outcome.message.split("they balance ")[1].split(" of it")[0])
    assert said == pytest.approx(share, rel=0.06)  # printed with two digits
    assert limit(wall(0.99 * share * gravity)).status != "infeasible"
    assert limit(wall(1.01 * share * gravity)).status == "infeasible"


def test_message_states_no_share_if_none_of_the_weight_is_balanced() -> None:
    """A dry corbel whose upper block overhangs by more than half."""
    outcome = limit(pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1)], 0.6))
    assert outcome.status == "infeasible"
    assert "they balance" not in outcome.message


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_wall_held_up_by_live_load_is_infeasible(model: Callable[[Scene], object]) -> None:
    """A block that overhangs to the left by more than half would be balanced by a push to the right."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(-0.55, 1, 1, 1)], 2.0)
    assert limit_state(equilibrium(scene)).forces.status == "optimal"
    assert model(scene).status == "infeasible"  # type: ignore[attr-defined]


def test_blocks_that_cannot_slide_topple_as_one() -> None:
    """With tan φ = 1e6, two blocks topple as one: λ = (2 b − 2 s) / h, with contacts at s from the ends."""
    scene = panel(
        wall__block_width=0.01,
        wall__block_height=0.5,
        wall__length=0.02,
        wall__height=0.5,
        joint__friction=1e6,
        joint__inset=0.002,
    )
    outcome = limit(scene)
    assert outcome.status == "collapse"
    assert outcome.lower == pytest.approx(0.016 / 0.5, rel=1e-6)


BEDS = (
    ((0, 0), (0.433, 0.683), (0.866, 0.881625), (1.299, 1.174)),
    ((0, 0), (0.283, 0.291), (0.843, 0.521), (1.161, 0.944), (1.376, 1.252)),
)
"""Heights of beds [m] at the left and the right of stones one metre wide, on which HiGHS fails with tan φ = 1e6 if they
may crack: it solves no program of the first wall, and forces and mechanism of the second disagree."""


@pytest.mark.parametrize("beds", BEDS)
def test_load_without_slip_is_that_of_less_friction(beds: tuple[tuple[float, float], ...]) -> None:
    """Cracked stones that fall without slip have the same λ with a tan φ of 100 and of 1e6."""
    stones = [
        np.array([(0, left), (1, right), (1, upper_right), (0, upper_left)])
        for (left, right), (upper_left, upper_right) in pairwise(beds)
    ]
    loads = []
    for joint in (JointMaterial(100.0), JointMaterial(1e6)):
        load = Load(live=(Lateral((1.0, 0.0)),))
        material = {"block": BlockMaterial(1.0), "joint": joint, "inner_joint": joint}
        outcome = limit(build_scene("stones", stones, thickness=0.12, load=load, **material))  # type: ignore[arg-type]
        assert outcome.status == "collapse", outcome.message
        loads.append(outcome.multiplier)
    assert loads[1] == pytest.approx(loads[0], rel=1e-9)


@pytest.mark.parametrize("friction", [10.0, 1e3, 1e4, 1e5, 3e5, 1e6])
@pytest.mark.parametrize(("columns", "rows"), [(2, 5), (3, 3), (4, 1)])
def test_wall_on_corners_falls_at_any_friction(columns: int, rows: int, friction: float) -> None:
    """Blocks separate without slip, which no friction resists. HiGHS alone cannot decide this from tan φ = 3000 on."""
    size = {"wall__length": 0.2 * columns, "wall__height": 0.1 * rows, "wall__block_width": 0.2}
    scene = panel(**size, wall__block_height=0.1, support__kind="corners", joint__friction=friction)
    system = equilibrium(scene).under_dead_load()
    parts = linprog(
        -system.dead,
        A_ub=system.opening.T.toarray(),
        b_ub=np.zeros(len(system.points)),
        A_eq=np.vstack([system.slip.T.toarray(), system.reaction.T.toarray()]),
        b_eq=np.zeros(len(system.points) + system.reaction.shape[1]),
        bounds=(-1, 1),
    )
    assert parts.fun is not None
    assert parts.fun < -0.1  # in block weights
    assert limit(scene).status == "infeasible"


def test_friction_above_largest_value_is_refused() -> None:
    with pytest.raises(SceneError, match=r"joint\.friction = 10000000\.0: must be such that tan φ ≤ 1e\+06"):
        panel(joint__friction=1e7)


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_block_pressed_straight_down_locks(model: Callable[[Scene], object]) -> None:
    live = PointLoad((0.5, 1.0), (0.0, -1.0))
    assert model(pile([rectangle(0, 0, 1, 1)], 0.5, live)).status == "unbounded"  # type: ignore[attr-defined]


def test_block_on_incline_stands_up_to_friction_angle() -> None:
    """A block on an incline of slope 0.4 stands with μ = 0.41 and falls with 0.39, before any live load."""
    angle = math.atan(0.4)
    c, s = math.cos(angle), math.sin(angle)
    incline = np.array([[c, s], [-s, c]])
    block, ground = rectangle(0, 0, 1, 0.2) @ incline, rectangle(-1, -1, 3, 1) @ incline

    def status(friction: float) -> str:
        scene = build_scene(
            "incline",
            [block],
            thickness=1.0,
            block=BlockMaterial(1.0),
            joint=JointMaterial(friction),
            load=Load(),
            grounds=[ground],
        )
        return limit(scene).status

    assert status(0.41) == "collapse"
    assert status(0.39) == "infeasible"


def test_associated_wall_may_lock_though_true_friction_fails() -> None:
    """Both corners held, upright blocks (b/a = 1/4): with dilatancy the struts lock, without it they slide."""
    live = {"kind": "point", "at": [0.72, 1.44], "force": [0, -1]}
    size = {"wall__block_width": 0.06, "wall__block_height": 0.24, "wall__height": 1.44}
    scene = scene_from_dict(
        content(**size, joint__cohesion=1e5, support__kind="pinned-corners", load={"gravity": 0.0, "live": live})
    )
    assert limit(scene).status == "unbounded"
    assert limit_nonassociated(scene, starts=1).status == "collapse"


@pytest.mark.parametrize(("length", "force", "friction"), [(0.48, [0, -1], 0.6), (0.24, [-0.7, -1], 1.0)])
def test_message_of_wall_that_locks_by_friction(length: float, force: list[float], friction: float) -> None:
    """Both corners held: Coulomb forces balance any multiple of the load, normal forces alone do not.

    True friction then allows rest at every multiple. The message does not exclude that other forces drive a mechanism.
    """
    live = {"kind": "point", "at": [0.12, 0.12], "force": force}
    size = {"wall__length": length, "wall__height": 0.12, "wall__first_course": "half"}
    scene = panel(
        **size, joint__friction=friction, support__kind="pinned-corners", load={"gravity": 9.81, "live": live}
    )
    assert limit(scene).status == "unbounded"
    assert is_self_locking(scene)
    assert not is_self_locking(scene.with_joint(friction=0.0))
    outcome = limit_nonassociated(scene)
    assert outcome.status == "unbounded", outcome.message
    assert "no collapse certified from" in outcome.message
    assert "which does not exclude one" in outcome.message


@pytest.mark.parametrize(
    ("joint", "status"), [({}, "undecided"), ({"cohesion": 1e5, "tensile_strength": 0.0}, "unbounded")]
)
def test_stone_between_walls_is_not_held_by_pushing_it_aside(joint: dict[str, float], status: str) -> None:
    """Normal forces carry any push, but the weight hangs on friction, which nothing calls up, or on cohesion.

    With λ times its weight to the right the dry stone can slip down for all λ up to 1 / 0.6: then the wall on its left
    presses by (1 / 0.6 - λ) / 2 and that on its right by (1 / 0.6 + λ) / 2 of the weight.
    """
    ground = [rectangle(-1, -1, 1, 1.4).tolist(), rectangle(0.4, -1, 1, 1.4).tolist()]
    scene = scene_from_dict(
        {
            "wall": {"outlines": [rectangle(0, 0, 0.4, 0.4).tolist()], "ground": ground, "thickness": 0.2},
            "block": {"density": 2000.0},
            "joint": {"friction": 0.6, **joint},
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
        }
    )
    outcome = limit_nonassociated(scene)
    assert outcome.status == status, outcome.message
    assert "normal forces carry any multiple of the live load" in outcome.message
    assert ("the dead load needs friction, which may give way" in outcome.message) == (not joint)


@pytest.mark.parametrize("hangs", [False, True])
def test_support_that_locks_proves_nothing_of_a_stone_that_hangs_on_friction(hangs: bool) -> None:
    """A plate is driven against a stone that leans on another plate; a second stone hangs between two plates."""
    stones = [rectangle(0, 0, 1, 1), rectangle(2, 0, 1, 1)]
    grounds = [rectangle(-1, 0, 1, 1), rectangle(0, -1, 1, 1), rectangle(1, -1, 1, 2), rectangle(3, -1, 1, 2)]
    outlines = {"outlines": [each.tolist() for each in stones[: 1 + hangs]], "ground": [g.tolist() for g in grounds]}
    scene = scene_from_dict(
        {
            "wall": {**outlines, "thickness": 0.2},
            "block": {"density": 2000.0},
            "joint": {"friction": 0.5},
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "live": {"kind": "settlement", "box": [[-2, -2], [0, 2]], "by": [0.001, 0.0]}},
        }
    )
    outcome = limit_nonassociated(scene)
    assert outcome.status == ("undecided" if hangs else "unbounded"), outcome.message
    assert "the wall holds the support against any force that drives it" in outcome.message
    assert ("the dead load needs friction, which may give way" in outcome.message) == hangs


def test_frictionless_wall_carries_no_lateral_load() -> None:
    zero = multiplier(panel(joint__friction=0.0))
    assert zero == pytest.approx(0, abs=1e-12)
    assert math.copysign(1.0, zero) == 1.0


@pytest.mark.parametrize(
    ("friction", "force", "bears"), [(0.5, (1.0, 0.0), True), (0.0, (1.0, 0.0), False), (0.0, (0.0, -1.0), True)]
)
def test_dead_load_is_borne_together_with_some_live_load(
    friction: float, force: tuple[float, float], bears: bool
) -> None:
    """A block without friction bears its weight, but no push; pressed straight down it locks."""
    assert bears_dead_load(pile([rectangle(0, 0, 1, 1)], friction, PointLoad((0.5, 1.0), force))) == bears


def test_disjoint_load_intervals_are_listed() -> None:
    """Mechanisms certified at loads far from each other prove nothing in between."""
    size = {"wall__block_width": 0.06, "wall__block_height": 0.24, "wall__height": 1.44}
    outcome = limit_nonassociated(scene_from_dict(content(**size, joint__inset=0.005)), starts=4)
    assert outcome.status == "collapse"
    if "nothing is proved in between" not in outcome.message:
        assert "every load of the interval" in outcome.message
    merged = certified_loads([_certificate(3, 4), _certificate(1, 2), _certificate(1.5, 2.5)], lambda x: 10 * x)
    assert merged == [(10, 25), (30, 40)]


def test_certified_loads_are_ascending_and_include_intervals_within_others() -> None:
    inside = [_certificate(1, 10), _certificate(2, 3), _certificate(9, 11), _certificate(12, 12)]
    assert certified_loads(inside, lambda x: x) == [(1, 11), (12, 12)]
    support = [_certificate(-0.5, -0.3), _certificate(-0.4, -0.1)]  # the share on a support falls as the load grows
    assert certified_loads(support, lambda x: -x, falling=True) == [(0.1, 0.5)]


def _certificate(least: float, most: float) -> Certificate:
    none = np.zeros(0)
    first, last = (ForceSolution("optimal", x, none, none, none, none, 0) for x in (least, most))
    return Certificate(none, first, last)


@pytest.mark.parametrize("width", [0.2, 0.5, 0.999, 1.0, 1.000000003, 1.000000006, 1.00000001])
def test_proved_bound_is_rounded_up_to_nine_digits(width: float) -> None:
    """A block of height 1 topples at its width, also if that is rounded down to nearest nine digits."""
    scene = pile([rectangle(0, 0, width, 1.0)], 5.0)
    bound, upper = proved_bound(scene), limit(scene).upper
    assert upper == pytest.approx(width, rel=1e-12)
    assert bound is not None
    assert upper is not None
    assert upper <= bound <= upper * (1 + 1.1e-8)
    assert bound == float(f"{bound:.9g}")


@pytest.mark.parametrize("size", [10.0, 100.0, 1000.0])
def test_small_block_on_huge_block_topples(size: float) -> None:
    """b/h = 0.2 on a block up to ten thousand times as wide, whose equilibrium must not hide that of the small one."""
    scene = pile([rectangle(0, 0, size, size), rectangle(size / 2, size, 0.1, 0.5)], 0.6)
    assert multiplier(scene) == pytest.approx(0.2, rel=1e-4)
    assert limit_nonassociated(scene).lower == pytest.approx(0.2, rel=1e-4)


def test_collapse_load_may_be_zero() -> None:
    """A weightless wall without tensile strength, which any force pulls apart."""
    live = {"kind": "point", "at": [0.7, 0.5], "force": [0.5, -1]}
    joint = {"friction": 0.3, "cohesion": 100, "tensile_strength": 0.0}
    load = {"gravity": 0.0, "live": live}
    assert multiplier(courses([[1, 2, 0.5]], 0.2, 0.5, joint=joint, load=load)) == pytest.approx(0, abs=1e-6)


def _upright(cohesion: float) -> Scene:
    """Dry upright blocks of 6e-7 N each, which may crack."""
    size = {"block_width": 0.01, "block_height": 0.5, "thickness": 0.12, "length": 0.025, "height": 0.5}
    inner = {"friction": 1.0, "cohesion": cohesion, "tensile_strength": cohesion / 2}
    return panel(wall=size, block__density=1.0, joint__friction=1.0, load__gravity=0.001, inner_joint=inner)


@pytest.mark.parametrize("cohesion", [1e2, 1e4, 1e8])
def test_very_strong_joints_do_not_affect_weak_ones(cohesion: float) -> None:
    """With cracks that would carry 1e6 to 1e12 block weights, the wall carries the same as with cracks of 1 Pa."""
    scene, weaker = _upright(cohesion), _upright(1.0)
    strongest = equilibrium(weaker).strength.strongest
    assert 100 < strongest < STRENGTH_CAP < 100 * strongest
    assert limit(scene).multiplier == pytest.approx(limit(weaker).multiplier, rel=1e-8)
    assert limit_nonassociated(scene, starts=4).lower == pytest.approx(
        0.01, rel=1e-6
    )  # b / h of the half block at the end


def test_strength_is_not_cut_if_mechanism_needs_it() -> None:
    """λ of a block glued to its base exceeds a million, and is proportional to the cohesion."""
    scenes = [panel(wall__height=0.06, wall__length=0.24, joint__cohesion=c, load__gravity=1e-3) for c in (1e6, 2e6)]
    one, two = (limit(scene).multiplier for scene in scenes)
    assert one is not None
    assert one > STRENGTH_CAP
    assert two == pytest.approx(2 * one, rel=1e-6)


@pytest.mark.parametrize("cohesion", [10.0, 1e3])
@pytest.mark.parametrize("friction", [1e-6, 1e-4, 0.0])
def test_glued_block_of_low_friction_slides_at_any_tension(friction: float, cohesion: float) -> None:
    """λ = tan φ + c A / W. The slender friction cone has its apex at 1e3 to 1e9 times the weight."""
    joint = {"friction": friction, "cohesion": cohesion, "tensile_strength": cohesion / max(friction, 1e-6)}
    scene = panel(wall__length=0.24, wall__height=0.06, wall__first_course="full", joint=joint, block__density=1.0)
    weight, area = 0.24 * 0.06 * 0.12 * 9.81, 0.24 * 0.12
    for model in (limit, limit_nonassociated):
        outcome = model(scene)
        assert outcome.status == "collapse"
        for bound in (outcome.lower, outcome.upper):
            assert bound == pytest.approx(friction + cohesion * area / weight, rel=1e-6)


@pytest.mark.parametrize("cohesion", [1e3, 1e6, 1e12])
def test_block_without_tension_topples_at_any_cohesion(cohesion: float) -> None:
    """At b / h, though its shear strength is up to 1e14 times its weight."""
    joint = {"friction": 0.25, "cohesion": cohesion, "tensile_strength": 0.0}
    scene = panel(wall__length=0.24, wall__height=0.06, wall__first_course="full", joint=joint, load__gravity=0.01)
    for model in (limit, limit_nonassociated):
        assert model(scene).lower == pytest.approx(4.0, rel=1e-9)


def test_stone_wedged_between_rocks_may_take_any_larger_load() -> None:
    """It is lifted by its weight if nothing presses its sides, and by more the more the rocks press it."""
    rocks = [rectangle(-1, 0, 1, 1), rectangle(1, 0, 1, 1), rectangle(-1, -1, 3, 1)]
    tables: dict[str, Any] = {
        "block": {"density": 1000.0},
        "joint": {"friction": 0.6},
        "wall": {
            "thickness": 1.0,
            "outlines": [rectangle(0, 0, 1, 1).tolist()],
            "ground": [rock.tolist() for rock in rocks],
        },
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "point", "at": [0.5, 1.0], "force": [0, 1]}},
    }
    outcome = limit_nonassociated(scene_from_dict(tables))
    assert (outcome.lower, outcome.upper) == pytest.approx((9810.0, 9810.0))
    assert "at every load larger than 9,810 as well" in outcome.message


def harmonic_stack(count: int, excess: float) -> Scene:
    """A stack that leans out as far as it can, every block balanced on the edge of the next, and a little farther."""
    x, blocks = 0.0, []
    for k in range(count):
        blocks.append(rectangle(x, 0.1 * k, 1.0, 0.1))
        x += 0.5 / max(1, count - 1 - k) * (1 + excess)
    return pile(blocks, 0.7, Lateral())


@pytest.mark.parametrize("excess", [3e-8, 1e-9])
def test_wall_on_the_brink_of_falling_under_its_dead_load_is_no_failure(excess: float) -> None:
    """It falls, by less than the tolerance of the solver; one program finds forces, the other does not."""
    outcome = limit(harmonic_stack(150, excess))
    assert outcome.status in ("infeasible", "undecided")
    assert outcome.status == "infeasible" or "on the brink of falling" in outcome.message
    assert limit(harmonic_stack(150, 1e-6)).status == "infeasible"
    assert limit(harmonic_stack(150, -1e-3)).status == "collapse"
