"""Rigid blocks: kinematics, and limit analysis against exact answers and invariances."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime, linprog

from runningbond.joints import joint_points
from runningbond.limit import equilibrium, is_self_locking, limit, limit_nonassociated, limit_state
from runningbond.limit.associated import GLUED
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
def test_a_wall_moved_as_one_body_opens_no_joint(u: float, v: float, spin: float) -> None:
    scene = courses(WINDOW)
    centroid = scene.blocks.centroid
    motion = np.column_stack([u - spin * centroid[:, 1], v + spin * centroid[:, 0], np.full(len(centroid), spin)])
    jump = jump_operator(joint_points(scene.joints, scene.thickness), centroid)
    assert np.abs(jump.opening @ motion.ravel()).max() < 1e-14
    assert np.abs(jump.slip @ motion.ravel()).max() < 1e-14


def test_lifting_the_upper_block_opens_the_joint_and_pushing_it_slips() -> None:
    """Opening is positive; with the normal up the tangent points to −x."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(0, 1, 1, 1)], 0.5)
    points = joint_points(scene.joints, scene.thickness)
    between = (points.block == [0, 1]).all(axis=1)
    jump = jump_operator(points, scene.blocks.centroid)
    motion = np.zeros(9)
    motion[3:5] = 0.2, 0.1
    assert (jump.opening @ motion)[between] == pytest.approx([0.1, 0.1])
    assert (jump.slip @ motion)[between] == pytest.approx([-0.2, -0.2])


def test_jump_operator_is_the_derivative_of_the_rigid_motion() -> None:
    """Against finite differences of points carried round by exact rotations."""
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


def test_loads_carry_the_weight_and_the_force_of_the_wall() -> None:
    scene = panel()
    weight = 1800 * 9.81 * 1.44 * 0.72 * 0.12
    dead, live = dead_load(scene).reshape(-1, 3), live_load(scene).reshape(-1, 3)
    assert dead[scene.wall].sum(axis=0) == pytest.approx([0, -weight, 0])
    assert live[scene.wall].sum(axis=0) == pytest.approx([weight, 0, 0])


def test_a_shared_point_load_has_its_force_and_its_moment() -> None:
    """About any point, the forces on the blocks add up to the force and moment of the one load."""
    at, force = np.array([0.72, 0.72]), np.array([0.3, -1.0])
    live = {"kind": "point", "at": at.tolist(), "force": force.tolist()}
    scene = panel(wall__first_course="half", load__live=live)
    load = live_load(scene).reshape(-1, 3)
    centroid = scene.blocks.centroid
    moment = load[:, 2] + centroid[:, 0] * load[:, 1] - centroid[:, 1] * load[:, 0]
    assert load[:, :2].sum(axis=0) == pytest.approx(force)
    assert moment.sum() == pytest.approx(at[0] * force[1] - at[1] * force[0])


def test_pins_read_the_displacement_of_the_corner() -> None:
    scene = panel(support__kind="pinned-corners")
    centroid = scene.blocks.centroid
    spin = np.column_stack([-centroid[:, 1], centroid[:, 0], np.ones(len(centroid))]).ravel()
    expected = [-y if d[0] else x for (x, y), d in zip(scene.pins.point, scene.pins.direction, strict=True)]
    assert pin_operator(scene) @ spin == pytest.approx(expected)


def test_mass_matrix_is_that_of_rectangles() -> None:
    mass = mass_matrix_diagonal(panel()).reshape(-1, 3)[0]
    m = 1800 * 0.12 * 0.24 * 0.06
    assert mass == pytest.approx([m, m, m * (0.24**2 + 0.06**2) / 12])


# --- exact collapse loads ------------------------------------------------------------------------------------


FRICTION = st.one_of(st.just(0.0), st.floats(1e-3, 3))
"""Down to a thousandth: HiGHS balances forces to 1e-7 of the largest weight, and so λ is no finer."""


@given(width=st.floats(0.02, 5), height=st.floats(0.02, 5), friction=FRICTION, n=st.integers(1, 6))
@settings(max_examples=60)
def test_a_stack_slides_at_mu_or_topples_at_b_over_nh(width: float, height: float, friction: float, n: int) -> None:
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
def test_a_couplet_topples_about_whichever_corner_gives_way_first(
    top: float, offset: float, h1: float, h2: float, friction: float
) -> None:
    """A block of width b2 somewhere on a block of width 1: the upper alone, or both about the base's corner."""
    x = offset * (1 - top)
    scene = pile([rectangle(0, 0, 1, h1), rectangle(x, h1, top, h2)], friction)
    w1, w2 = h1, top * h2
    upper = top / h2
    both = (w1 * 0.5 + w2 * (1 - x - top / 2)) / (w1 * h1 / 2 + w2 * (h1 + h2 / 2))
    assert multiplier(scene) == pytest.approx(min(friction, upper, both), rel=1e-7)


@pytest.mark.parametrize("friction", [0.6, 1e3, 1e6])
def test_dry_joints_of_a_row_without_weight_bear_nothing_whatever_their_friction(friction: float) -> None:
    """Nothing presses on them. With tan φ of a million, rounding of slips was taken for blocks in one another."""
    push = {"kind": "point", "at": [0.0, 0.01], "force": [1.0, 0.0]}
    row = {"wall__length": 2.0, "wall__height": 0.02, "wall__block_width": 1.0, "wall__block_height": 0.02}
    scene = panel(**row, wall__first_course="half", joint__friction=friction, load__live=push, load__gravity=0.0)
    outcome = limit(scene)
    assert (outcome.status, outcome.lower, outcome.upper) == ("collapse", 0.0, 0.0)


@given(height=st.floats(0.1, 3), friction=st.floats(0.02, 2), weight=st.floats(100, 1e6))
@settings(max_examples=40)
def test_a_horizontal_point_load_slides_or_topples_a_block(height: float, friction: float, weight: float) -> None:
    """Pushed at its top a block 1 × h resists P = W min(μ, 1 / (2 h))."""
    live = PointLoad((0.0, height), (1.0, 0.0))
    scene = pile([rectangle(0, 0, 1, height)], friction, live)
    scene = scene.with_block(density=weight / (9.81 * 0.1 * height))
    assert multiplier(scene) == pytest.approx(weight * min(friction, 1 / (2 * height)), rel=1e-6)


@given(cohesion=st.floats(1e3, 1e6), friction=FRICTION)
@settings(max_examples=30)
def test_cohesion_carries_a_weightless_block(cohesion: float, friction: float) -> None:
    """Sheared along its base a flat block without weight resists P = c A while it does not rock."""
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
def test_tension_cut_off_limits_what_hangs(cohesion: float, friction: float, cut: float) -> None:
    """Pulled straight up a weightless block comes off at f_t A."""
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
    """The same wall with its points, loads and ground moved by `change` and directions by `turn`."""
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
def test_a_mirrored_wall_pushed_the_other_way_carries_the_same(pattern: list[list[float]]) -> None:
    scene = courses(pattern)
    mirrored = mapped(scene, lambda p: p * [-1, 1], turn=lambda v: v * [-1, 1], mirror=True)
    assert multiplier(mirrored) == pytest.approx(multiplier(scene), rel=EXACT)


@pytest.mark.parametrize("angle", [0.3, 1.0, -2.5])
def test_a_wall_rotated_with_its_loads_carries_the_same(angle: float) -> None:
    c, s = math.cos(angle), math.sin(angle)
    rotation = np.array([[c, s], [-s, c]])
    scene = courses(WINDOW)
    rotated = mapped(scene, lambda p: p @ rotation + [3.0, -7.0], turn=lambda v: v @ rotation, mirror=False)
    assert len(rotated.joints) == len(scene.joints)
    assert multiplier(rotated) == pytest.approx(multiplier(scene), rel=1e-8)


@pytest.mark.parametrize("factor", [1e-6, 1e-2, 1e3])
@pytest.mark.parametrize("key", ["wall__thickness", "block__density", "load__gravity"])
def test_a_dry_wall_carries_the_same_whatever_its_thickness_density_and_gravity(key: str, factor: float) -> None:
    room, name = key.split("__")
    value = content()[room][name] * factor
    scene, scaled = panel(wall__height=0.24), panel(wall__height=0.24, **{key: value})
    assert multiplier(scaled) == pytest.approx(multiplier(scene), rel=EXACT)


@pytest.mark.parametrize("factor", [1e-6, 1e-2, 1e3])
def test_a_dry_wall_carries_the_same_whatever_its_size(factor: float) -> None:
    assert multiplier(courses(WINDOW, width=0.4 * factor, height=0.175 * factor)) == pytest.approx(
        multiplier(courses(WINDOW)), rel=EXACT
    )


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e6])
def test_the_unit_of_a_point_load_scales_out(unit: float) -> None:
    def crushed(force: float) -> float:
        live = {"kind": "point", "at": [0.72, 0.72], "force": [0, -force]}
        return multiplier(panel(joint__cohesion=1e5, support__kind="corners", load={"gravity": 0.0, "live": live}))

    assert crushed(unit) * unit == pytest.approx(crushed(1.0), rel=1e-8)


# --- what a program proves -----------------------------------------------------------------------------------


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
def test_certificates_hold_what_they_say(name: str) -> None:
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
    # Where it opens the joint pulls with its full tension; where it slides the force opposes, at the limit.
    resist = strength.tension * unit - normal
    assert np.abs(resist[opening > 1e-5 * largest]).max(initial=0.0) < 1e-7 * np.abs(outcome.force).max()
    slides = np.abs(slip) > 1e-5 * largest
    limit_force = strength.shear * unit + strength.friction * resist
    assert np.allclose(
        tangential[slides], np.sign(slip[slides]) * limit_force[slides], atol=1e-7 * np.abs(outcome.force).max()
    )


def test_mechanism_moves_its_fastest_corner_by_one_and_the_ground_not_at_all() -> None:
    scene = courses(WINDOW)
    motion = limit(scene).motion
    assert not motion[scene.fixed].any()
    arm = scene.blocks.vertices - scene.blocks.centroid[scene.blocks.owner]
    u, v, spin = motion[scene.blocks.owner].T
    assert np.hypot(u - spin * arm[:, 1], v + spin * arm[:, 0]).max() == pytest.approx(1)


# --- verdicts ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_a_wall_that_falls_under_its_weight_is_infeasible(model: Callable[[Scene], object]) -> None:
    """A corbel whose upper blocks overhang by more than half."""
    outcome = model(pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1)], 0.5))
    assert outcome.status == "infeasible"  # type: ignore[attr-defined]
    assert outcome.multiplier is None  # type: ignore[attr-defined]


@pytest.mark.parametrize("friction", [1e-6, 3e-6, 1e-5, 1e-3])
def test_joints_of_hardly_any_friction_are_not_taken_for_frictionless(friction: float) -> None:
    """Slender blocks that may split, on held corners: pressure between their halves is a million weights, and bears.

    λ is linear in the friction of the splits; simplex, whose tolerance is a tenth of the least, had two thirds of it.
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


def test_split_blocks_of_the_largest_friction_topple() -> None:
    """λ = b / (n h). The mechanism closes by rounding times tan φ, and the repair that is tried meets a zero pivot."""
    size = {"block_width": 0.2, "block_height": 0.1, "length": 0.2, "height": 0.3, "thickness": 0.12}
    joints = {"joint": {"friction": MOST_FRICTION}, "inner_joint": {"friction": 1.0}}
    outcome = limit(panel(wall={**size, "first_course": "full"}, **joints))
    assert (outcome.lower, outcome.upper) == pytest.approx((2 / 3, 2 / 3), rel=1e-6)


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_it_is_seen_what_of_a_wall_falls_under_its_weight(model: Callable[[Scene], Outcome]) -> None:
    """Of three blocks the one that overhangs tips about the corner that it leans on, and only that."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1), rectangle(3, 0, 1, 1)], 0.5)
    corbel, motion = scene.blocks.centroid[:, 1].argmax(), model(scene).motion
    u, v, spin = motion[corbel]
    edge = np.array([1.0, 1.0]) - scene.blocks.centroid[corbel]
    assert np.array([u - spin * edge[1], v + spin * edge[0]]) == pytest.approx(0.0, abs=1e-9)
    assert spin < 0
    assert not np.delete(motion, corbel, axis=0).any()


@given(
    strength=st.floats(0.01, 0.95),  # of a weight as much as can be held
    overhang=st.floats(0.51, 0.9),
    crushing=st.booleans(),
)
@settings(max_examples=12, deadline=None)
def test_joints_that_are_too_weak_for_the_weight_say_how_much_of_it_they_bear(
    strength: float, overhang: float, crushing: bool
) -> None:
    """f_t l² t / 2 about the corner, for ρ g l h t (o − 1/2) l of a block of length l that overhangs by o l.

    Where the joint is (1 − o) l long; and a wall with less gravity than that stands.
    """
    share, length, density, gravity = strength, 1.0 - overhang, 2000.0, 9.81
    tension = share * density * gravity * (overhang - 0.5) * 2 / length**2
    joint = JointMaterial(0.7, cohesion=10 * tension, tensile_strength=tension)
    if crushing:  # by next to nothing: its joint's end presses on one point
        joint = replace(joint, compressive_strength=1e6 * tension)
    blocks = [rectangle(0, 0, 1, 1), rectangle(overhang, 1, 1, 1)]

    def wall(gravity: float) -> Scene:
        load = Load(gravity=(0.0, -gravity))
        return build_scene("corbel", blocks, thickness=0.5, block=BlockMaterial(density), joint=joint, load=load)

    outcome = limit(wall(gravity))
    assert outcome.status == "infeasible"
    said = float(outcome.message.split("they balance ")[1].split(" of it")[0])
    assert said == pytest.approx(share, rel=0.06)  # told to two digits
    assert limit(wall(0.99 * share * gravity)).status != "infeasible"
    assert limit(wall(1.01 * share * gravity)).status == "infeasible"


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_a_wall_that_only_the_live_load_holds_up_is_infeasible(model: Callable[[Scene], object]) -> None:
    """A block that overhangs to the left by more than half would be balanced by a push to the right."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(-0.55, 1, 1, 1)], 2.0)
    assert limit_state(equilibrium(scene)).forces.status == "optimal"
    assert model(scene).status == "infeasible"  # type: ignore[attr-defined]


def test_friction_without_bound_is_proved_too() -> None:
    """Two blocks that cannot slide on each other topple as one: (2 b − 2 s) / h, contacts s from the ends."""
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


@pytest.mark.parametrize("friction", [10.0, 1e3, 1e4, 1e5, 3e5, 1e6])
@pytest.mark.parametrize(("columns", "rows"), [(2, 5), (3, 3), (4, 1)])
def test_no_friction_holds_a_wall_on_its_corners(columns: int, rows: int, friction: float) -> None:
    """Blocks come apart without any slip, which no friction resists: HiGHS alone cannot tell from tan φ = 3000 on."""
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
    assert parts.fun < -0.1  # in weights of a block
    assert limit(scene).status == "infeasible"


def test_more_friction_than_programs_can_tell_from_no_slip_is_refused() -> None:
    with pytest.raises(SceneError, match=r"joint\.friction = 10000000\.0: must be such that tan φ ≤ 1e\+06"):
        panel(joint__friction=1e7)


@pytest.mark.parametrize("model", [limit, limit_nonassociated])
def test_a_block_pressed_straight_down_locks(model: Callable[[Scene], object]) -> None:
    live = PointLoad((0.5, 1.0), (0.0, -1.0))
    assert model(pile([rectangle(0, 0, 1, 1)], 0.5, live)).status == "unbounded"  # type: ignore[attr-defined]


def test_friction_alone_does_not_hold_a_wedge_but_a_fitting_slope_does() -> None:
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


def test_the_associated_bound_can_lock_where_true_friction_gives_way() -> None:
    """Both corners held, blocks on end (b/a = 1/4): dilatancy locks the struts, sliding does not."""
    live = {"kind": "point", "at": [0.72, 1.44], "force": [0, -1]}
    size = {"wall__block_width": 0.06, "wall__block_height": 0.24, "wall__height": 1.44}
    scene = scene_from_dict(
        content(**size, joint__cohesion=1e5, support__kind="pinned-corners", load={"gravity": 0.0, "live": live})
    )
    assert limit(scene).status == "unbounded"
    assert limit_nonassociated(scene, starts=1).status == "collapse"


@pytest.mark.parametrize(("length", "force", "friction"), [(0.48, [0, -1], 0.6), (0.24, [-0.7, -1], 1.0)])
def test_a_wall_that_locks_by_friction_says_what_is_proved_of_it(
    length: float, force: list[float], friction: float
) -> None:
    """Both corners held: Coulomb forces balance any multiple of the load, and normal forces alone do not.

    True friction allows rest at every multiple, then; that no other forces drive a mechanism is not said.
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


def test_no_friction_and_no_strength_hold_nothing_sideways() -> None:
    zero = multiplier(panel(joint__friction=0.0))
    assert zero == pytest.approx(0, abs=1e-12)
    assert math.copysign(1.0, zero) == 1.0


def test_disjoint_certificates_are_named() -> None:
    """Two mechanisms certified at loads apart from each other prove nothing in between."""
    size = {"wall__block_width": 0.06, "wall__block_height": 0.24, "wall__height": 1.44}
    outcome = limit_nonassociated(scene_from_dict(content(**size, joint__inset=0.005)), starts=4)
    assert outcome.status == "collapse"
    if "nothing is proved in between" not in outcome.message:
        assert "every load of the interval" in outcome.message
    merged = certified_loads([_certificate(3, 4), _certificate(1, 2), _certificate(1.5, 2.5)], lambda x: 10 * x)
    assert merged == [(10, 25), (30, 40)]


def _certificate(least: float, most: float) -> Certificate:
    none = np.zeros(0)
    ends = [ForceSolution("optimal", x, none, none, none, none, 0) for x in (least, most)]
    return Certificate(none, *ends)


@pytest.mark.parametrize("size", [10.0, 100.0, 1000.0])
def test_a_small_block_on_a_huge_one_topples_as_on_a_small_one(size: float) -> None:
    """b/h = 0.2 on a block up to ten thousand times as wide; its balance is not lost in the huge one's."""
    scene = pile([rectangle(0, 0, size, size), rectangle(size / 2, size, 0.1, 0.5)], 0.6)
    assert multiplier(scene) == pytest.approx(0.2, rel=1e-4)
    assert limit_nonassociated(scene).lower == pytest.approx(0.2, rel=1e-4)


def test_zero_is_an_answer() -> None:
    """A wall without weight and without tension that any force pulls apart."""
    live = {"kind": "point", "at": [0.7, 0.5], "force": [0.5, -1]}
    joint = {"friction": 0.3, "cohesion": 100, "tensile_strength": 0.0}
    load = {"gravity": 0.0, "live": live}
    assert multiplier(courses([[1, 2, 0.5]], 0.2, 0.5, joint=joint, load=load)) == pytest.approx(0, abs=1e-6)


def _upright(cohesion: float) -> Scene:
    """Dry blocks on end, of 6e-7 N each, that may crack."""
    size = {"block_width": 0.01, "block_height": 0.5, "thickness": 0.12, "length": 0.025, "height": 0.5}
    inner = {"friction": 1.0, "cohesion": cohesion, "tensile_strength": cohesion / 2}
    return panel(wall=size, block__density=1.0, joint__friction=1.0, load__gravity=0.001, inner_joint=inner)


@pytest.mark.parametrize("cohesion", [1e2, 1e4, 1e8])
def test_joints_that_are_as_good_as_glued_do_not_drown_the_others(cohesion: float) -> None:
    """Blocks whose cracks would bear 1e6 to 1e12 times their weight bear what they do with cracks of 1 Pa."""
    scene, weaker = _upright(cohesion), _upright(1.0)
    strongest = equilibrium(weaker).strength.strongest
    assert 100 < strongest < GLUED < 100 * strongest
    assert limit(scene).multiplier == pytest.approx(limit(weaker).multiplier, rel=1e-8)
    assert limit_nonassociated(scene, starts=4).lower == pytest.approx(
        0.01, rel=1e-6
    )  # b / h of the half block at the end


def test_joints_so_strong_that_only_a_load_a_million_times_the_weight_breaks_them_are_not_cut() -> None:
    """λ of a block glued to its base follows the cohesion."""
    scenes = [panel(wall__height=0.06, wall__length=0.24, joint__cohesion=c, load__gravity=1e-3) for c in (1e6, 2e6)]
    one, two = (limit(scene).multiplier for scene in scenes)
    assert one is not None
    assert one > GLUED
    assert two == pytest.approx(2 * one, rel=1e-6)


@pytest.mark.parametrize("cohesion", [10.0, 1e3])
@pytest.mark.parametrize("friction", [1e-6, 1e-4, 0.0])
def test_a_glued_block_of_little_friction_slides_however_much_tension_its_joint_bears(
    friction: float, cohesion: float
) -> None:
    """At λ = tan φ + c A / W: its cone is so slender that its apex lies at 1e3 to 1e9 times the weight."""
    joint = {"friction": friction, "cohesion": cohesion, "tensile_strength": cohesion / max(friction, 1e-6)}
    scene = panel(wall__length=0.24, wall__height=0.06, wall__first_course="full", joint=joint, block__density=1.0)
    weight, area = 0.24 * 0.06 * 0.12 * 9.81, 0.24 * 0.12
    for model in (limit, limit_nonassociated):
        outcome = model(scene)
        assert outcome.status == "collapse"
        for bound in (outcome.lower, outcome.upper):
            assert bound == pytest.approx(friction + cohesion * area / weight, rel=1e-6)


@pytest.mark.parametrize("cohesion", [1e3, 1e6, 1e12])
def test_a_block_that_cannot_slide_topples_however_strong_its_joint(cohesion: float) -> None:
    """Without tension at b / h, though its shear strength is up to 1e14 times its weight."""
    joint = {"friction": 0.25, "cohesion": cohesion, "tensile_strength": 0.0}
    scene = panel(wall__length=0.24, wall__height=0.06, wall__first_course="full", joint=joint, load__gravity=0.01)
    for model in (limit, limit_nonassociated):
        assert model(scene).lower == pytest.approx(4.0, rel=1e-9)
