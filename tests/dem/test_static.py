"""Static rigid blocks: the joint's law, exact collapses, published walls, and honest answers where there is none."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from hypothesis import given
from hypothesis import strategies as st

from dem import relaxation, static
from dem.climb import HARD, climb, ends
from dem.pushover import LoadPath, StaticState
from dem.relaxation import Rest, RestVerdict, relax
from dem.static import dem_static
from dem.static_system import Control, static_system
from dem.stiffness_update import stiffness_update
from runningbond.compare import published_scene
from runningbond.joints import PointLaw, PointStrength, ResultantLaw, point_strength
from runningbond.limit import equilibrium, limit
from runningbond.pictures.recording import StaticRecorder
from runningbond.pictures.style import DRAWN
from runningbond.pictures.time_series import frame_files
from runningbond.pictures.vtk_grids import DISPLACEMENT
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
    Stiffness,
    build_scene,
)
from tests.at_length import at_length
from tests.limit.test_limit import rectangle
from tests.walls import courses

FERRIS: dict[str, list[list[float]]] = {
    "W1": [[0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]] * 3,
    "W2": [[0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]] * 5,
    "W3": [
        [1, 1, 1, 1],
        [0.5, 1, 1, 1, 0.5],
        [1, 1, 1, 1],
        [0.5, 1, -1, 1, 0.5],
        [1, 0.5, -1, 0.5, 1],
        [0.5, 1, -1, 1, 0.5],
        [1, 0.5, -1, 0.5, 1],
        [0.5, 1, -1, 1, 0.5],
        [1, 1, 1, 1],
        [0.5, 1, 1, 1, 0.5],
        [1, 1, 1, 1],
    ],
}
"""Ferris & Tin-Loi (2001), bottom to top."""


def ferris(name: str, inset: float = 0.0) -> Scene:
    mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
    return courses(FERRIS[name], joint__friction=0.65, joint__mortar=mortar, joint__inset=inset)


def pile(
    blocks: list[Array],
    friction: float,
    k_n: float = 1e11,
    live: Lateral | PointLoad | None = None,
    cohesion: float = 0.0,
) -> Scene:
    """Blocks on a flat base; k_t = 0.4 k_n."""
    return build_scene(
        "pile",
        blocks,
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(friction, cohesion, 0.0, elasticity=Stiffness(k_n, 0.4 * k_n)),
        load=Load(live=(live or Lateral(),)),
    )


def bracket(outcome: Outcome) -> tuple[float, float]:
    assert outcome.status == "collapse", outcome.message
    assert outcome.lower is not None
    assert outcome.upper is not None
    return outcome.lower, outcome.upper


# --- the law of a point --------------------------------------------------------------------------------------

jumps = st.floats(-2, 2)
laws = st.builds(
    lambda friction, tension, shear, k_n, k_t: PointLaw(
        PointStrength(*(np.array([x]) for x in (friction, tension, shear))), np.array([k_n]), np.array([k_t])
    ),
    friction=st.floats(0, 2),
    tension=st.just(0.0) | st.floats(0, 2),
    shear=st.just(0.0) | st.floats(0, 2),
    k_n=st.floats(0.5, 10),
    k_t=st.floats(0.5, 10),
)


@given(laws, jumps, jumps, jumps)
def test_forces_never_leave_the_cone_and_a_second_look_changes_nothing(
    law: PointLaw, opening: float, slip: float, plastic: float
) -> None:
    """|S| ≤ s + tan φ (T − N), N ≤ T; the plastic slip that was found explains the forces that were found."""
    jump, before = (np.array([opening]), np.array([slip])), np.array([plastic])
    first = law(*jump, before)
    assert law.strength.violation(first.normal, first.tangential).max() <= 1e-12
    second = law(*jump, first.plastic_slip)
    assert second.normal == first.normal
    assert second.tangential == pytest.approx(first.tangential, abs=1e-12)
    assert (jump[0][0], jump[1][0], before[0]) == (opening, slip, plastic)


@given(laws, jumps, jumps, jumps)
def test_friction_only_dissipates_and_slip_opens_nothing(
    law: PointLaw, opening: float, slip: float, old: float
) -> None:
    """The shear force does no negative work on plastic slip, and the normal one does not know of it."""
    found = law(np.array([opening]), np.array([slip]), np.array([old]))
    assert (found.tangential * (found.plastic_slip - old) >= 0).all()
    assert found.normal == law(np.array([opening]), np.array([0.0]), np.array([0.0])).normal


@given(laws, jumps, jumps, jumps)
def test_tangent_is_the_derivative_of_the_force(law: PointLaw, opening: float, slip: float, plastic: float) -> None:
    """Against central differences, except astride a kink of the law, where the differences see both sides."""
    eps, before = 1e-6, np.array([plastic])
    at = np.array([opening, slip])

    def force(jump: Array) -> Array:
        found = law(jump[:1], jump[1:], before)
        return np.concatenate([found.normal, found.tangential])

    def tangent(jump: Array) -> Array:
        return np.asarray(law(jump[:1], jump[1:], before).tangent[0])

    for k, step in enumerate(eps * np.eye(2)):
        if (tangent(at + step) == tangent(at)).all() and (tangent(at - step) == tangent(at)).all():
            assert tangent(at)[:, k] == pytest.approx((force(at + step) - force(at - step)) / (2 * eps), abs=1e-6)


def test_an_open_dry_point_carries_nothing_and_has_no_tangent() -> None:
    law = PointLaw(PointStrength(np.full(1, 0.6), np.zeros(1), np.zeros(1)), np.ones(1), np.ones(1))
    found = law(np.array([0.1]), np.array([0.3]), np.zeros(1))
    assert found.normal == found.tangential == 0
    assert not found.tangent.any()
    assert found.plastic_slip == 0.3
    still = law(np.zeros(1), np.zeros(1), np.zeros(1))
    assert still.normal == still.tangential == 0
    assert still.tangent[0] == pytest.approx(np.eye(2))


up_to_one = st.one_of(st.just(0.0), st.floats(1e-6, 1))
"""Strengths that a material may have: none, or not so little that it drowns."""


@given(st.tuples(*[st.floats(0, 10)] * 2), st.tuples(*[st.floats(-1, 1)] * 2), up_to_one, st.floats(0.1, 2))
def test_forces_at_the_ends_of_a_joint_respect_the_resultant_law(
    pressures: tuple[float, float], share: tuple[float, float], cohesion: float, length: float
) -> None:
    """Paper Eq. 3 with l_c half the length: two admissible end forces have an admissible resultant."""
    material = JointMaterial(0.6, cohesion, cohesion / 0.6)
    ends = point_strength(material, np.full(2, length / 2))
    normal = ends.tension - np.array(pressures)
    tangential = np.array(share) * (ends.shear + 0.6 * np.array(pressures))
    whole = ResultantLaw(point_strength(material, np.array([length])), np.ones((1, 3)), np.array([length / 2]))
    moment = (normal[1] - normal[0]) * length / 2
    assert not whole.violated(np.array([[normal.sum(), tangential.sum(), moment]]), 1e-9).any()


# --- the equations ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["panel-04", "panel-05", "point-load-quarter", "wall-w3"])
def test_solution_of_the_elastic_wall_balances_its_load(name: str) -> None:
    """K_e q + Cᵀ r = f with K_e applied joint by joint, not assembled; C q = 0; under loads or a displacement."""
    system = static_system(published_scene(name))
    nd, generator = system.freedoms, np.random.default_rng(0)
    right = np.concatenate([generator.normal(size=nd), np.zeros(system.unknowns - 1 - nd), [0.7]])
    for by_multiplier in (True, False):
        x = system.solve(system.elastic, Control(0.0, by_multiplier), right)
        balance = system.viscous(x) + system.equilibrium.reaction @ x[nd:-1] - x[-1] * system.equilibrium.live
        scale = np.abs(system.elastic).max() * np.abs(x[:nd]).max()
        assert balance == pytest.approx(right[:nd], abs=1e-9 * scale)
        assert system.equilibrium.reaction.T @ x[:nd] == pytest.approx(0.0, abs=1e-9 * scale)
        controlled = x[-1] if by_multiplier else system.equilibrium.live @ x[:nd]
        assert controlled == pytest.approx(0.7, abs=1e-9 * scale)


@pytest.mark.parametrize(("multiplier", "verdict"), [(0.2499, "rest"), (0.2501, "fall")])
@pytest.mark.parametrize("far", [1e3, 1e6])
def test_block_rests_below_its_collapse_load_and_falls_above(
    multiplier: float, verdict: RestVerdict, far: float
) -> None:
    """b/h = 1/4; however far it has to go to have fallen."""
    system = static_system(pile([rectangle(0, 0, 0.5, 2)], 0.6))
    start = np.append(np.zeros(system.freedoms), multiplier)
    nothing = np.zeros(len(system.law.normal_stiffness))
    assert relax(system, start, nothing, Control(multiplier, multiplier=True), far).verdict == verdict


@pytest.mark.parametrize(("slowing", "verdict"), [(0.5, "fall"), (2.0, "undecided")])
def test_a_creep_that_goes_on_far_away_has_fallen_when_it_is_given_up(
    slowing: float, verdict: RestVerdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A toppling block of which nothing is said before; and nothing at all of one that slows down."""
    monkeypatch.setattr(relaxation, "STEADY", 9.0)
    monkeypatch.setattr(relaxation, "SLOWING", slowing)
    monkeypatch.setattr(relaxation, "LONGEST", 60)
    system = static_system(pile([rectangle(0, 0, 0.5, 2)], 0.6))
    start = np.append(np.zeros(system.freedoms), 0.26)
    found = relax(system, start, np.zeros(len(system.law.normal_stiffness)), Control(0.26, multiplier=True), 1e2, 60)
    assert found.verdict == verdict
    assert relax(system, start, np.zeros(2), Control(0.26, multiplier=True), 1e2, 59).verdict == "undecided"


def test_soft_joints_that_give_way_elastically_are_no_fall() -> None:
    """A block that leans farther than what counts as a fall, but comes to rest there."""
    system = static_system(pile([rectangle(0, 0, 1, 1)], 0.6))
    start = np.append(np.zeros(system.freedoms), 0.1)
    found = relax(system, start, np.zeros(2), Control(0.1, multiplier=True), far=1e-3)
    assert found.verdict == "rest"
    assert np.abs(found.x[: system.freedoms]).max() > 1e-3


# --- one block -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("k_n", [1e10, 1e11, 1e12])
def test_block_topples_at_b_over_h(k_n: float) -> None:
    lower, upper = bracket(dem_static(pile([rectangle(0, 0, 0.5, 2)], 0.6, k_n)))
    assert lower == pytest.approx(0.25, abs=1e-3)
    assert upper == pytest.approx(0.25, abs=3e-3)


@pytest.mark.parametrize("k_n", [1e10, 1e11, 1e12])
def test_block_slides_at_the_friction_coefficient(k_n: float) -> None:
    lower, upper = bracket(dem_static(pile([rectangle(0, 0, 2, 0.5)], 0.6, k_n)))
    assert lower == pytest.approx(0.6, abs=1e-3)
    assert upper == pytest.approx(0.6, abs=6e-3)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_stack_topples_at_b_over_its_height(n: int) -> None:
    lower, _ = bracket(dem_static(pile([rectangle(0, k, 1, 1) for k in range(n)], 0.8)))
    assert lower == pytest.approx(min(0.8, 1 / n), abs=1e-3)


def test_block_without_friction_slides_under_no_load() -> None:
    assert bracket(dem_static(pile([rectangle(0, 0, 1, 1)], 0.0))) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_block_lifts_off_at_its_weight() -> None:
    """1 m × 1 m × 0.1 m, 2000 kg/m³: 1962 N."""
    lift = PointLoad((0.5, 1.0), (0.0, 1.0))
    lower, upper = bracket(dem_static(pile([rectangle(0, 0, 1, 1)], 0.6, live=lift)))
    assert lower == pytest.approx(1962.0, rel=1e-6)
    assert upper == pytest.approx(1962.0, rel=1e-2)


@pytest.mark.parametrize("gravity", [9.81, 1e-3])
def test_however_light_a_block_is_it_is_lifted_at_the_strength_of_its_joint(gravity: float) -> None:
    """0.5 m × 0.3 m of joint bear 1e5 Pa of tension: 15 kN and the weight, of which the lighter one is 0.12 N."""
    glued = JointMaterial(0.7, 1e5, 1e5, elasticity=Stiffness(1e9, 4e8))
    lift = Load((0.0, -gravity), (PointLoad((0.25, 0.4), (0.0, 1.0)),))
    stone = [rectangle(0, 0, 0.5, 0.4)]
    scene = build_scene("stone", stone, thickness=0.3, block=BlockMaterial(2000.0), joint=glued, load=lift)
    lower, upper = bracket(dem_static(scene))
    exact = 15e3 + gravity * float(scene.mass[0])
    assert lower == pytest.approx(exact, rel=1e-6)
    assert exact < upper <= 1.01 * exact


def test_block_that_balances_on_an_edge_bears_no_push() -> None:
    """Its centroid stands over the edge of the block below."""
    lower, _ = bracket(dem_static(pile([rectangle(0, 0, 1, 1), rectangle(0.5, 1, 1, 1)], 0.6)))
    assert lower == pytest.approx(0.0, abs=1e-6)


def test_curve_starts_with_the_elastic_stiffness_of_the_base_joint() -> None:
    """A push λ W at half height shears the base joint by λ W / (k_t A) and, its two ends being springs k_n A / 2 at
    ± b / 2, turns it by (λ W h / 2) / (k_n A b² / 4): the top corner moves by λ W / (k_t A) + 2 λ W h² / (k_n A b²)."""
    b, h, k_n = 0.5, 1.0, 1e10
    weight, area = 2000 * 9.81 * b * h * 0.1, b * 0.1
    curve = dem_static(pile([rectangle(0, 0, b, h)], 0.9, k_n)).curve
    flexibility = weight / (0.4 * k_n * area) + 2 * weight * h**2 / (k_n * area * b**2)
    assert curve[0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert curve[1, 0] / curve[1, 1] == pytest.approx(flexibility, rel=1e-6)


def test_mechanism_of_a_toppling_block_turns_about_its_corner() -> None:
    """Pushed along +x, clockwise about the lower right corner, its upper left corner the fastest."""
    motion = dem_static(pile([rectangle(0, 0, 0.5, 2)], 0.6)).motion[0]
    spin = -1 / np.hypot(0.5, 2)
    assert motion == pytest.approx([-spin * 1.0, spin * -0.25, spin], abs=1e-4)


# --- walls ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "published"), [("W1", 0.5856), ("W2", 0.5244), ("W3", 0.3374)])
def test_walls_with_rounded_corners_collapse_where_they_must(name: str, published: float) -> None:
    """Contacts inset by 20 mm, where the non-associated load is unique: within 1 %. The curve's end, too."""
    outcome = dem_static(ferris(name, 0.02))
    lower, upper = bracket(outcome)
    assert lower == pytest.approx(published, rel=0.01)
    assert upper == pytest.approx(published, rel=0.01)
    assert outcome.curve[-1, 1] == pytest.approx(published, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "least", "most"), [("W1", 0.639, 0.6429), ("W2", 0.5575, 0.5796), ("W3", 0.3558, 0.4027)]
)
def test_walls_with_sharp_corners_collapse_at_a_certified_load(name: str, least: float, most: float) -> None:
    """The certified interval of each wall, to the digits it is given with."""
    lower, upper = bracket(dem_static(ferris(name)))
    assert least - 5e-5 <= lower <= upper <= most + 5e-5


def test_tall_wall_loses_strength_past_its_peak() -> None:
    """W2, inset: from .5250 down to .5244."""
    curve = dem_static(ferris("W2", 0.02)).curve
    assert curve[:, 1].max() == pytest.approx(0.5250, abs=1e-4)
    assert curve[-1, 1] == pytest.approx(0.5244, abs=1e-4)


@pytest.mark.parametrize("name", ["W3", *at_length("W1", "W2")])
def test_half_the_steps_and_twice_the_way_leave_the_bracket_in_place(name: str) -> None:
    scene = ferris(name, 0.02)
    lower, upper = bracket(dem_static(scene))
    for other in (dem_static(scene, first_step=0.015), dem_static(scene, collapse=0.2)):
        other_lower, other_upper = bracket(other)
        assert other_lower == pytest.approx(lower, rel=1e-3)
        assert other_upper == pytest.approx(upper, rel=1e-2)


@pytest.mark.parametrize("name", ["W1", "W3"])
def test_forces_at_the_peak_are_admissible_and_balance_the_loads(name: str) -> None:
    scene = ferris(name)
    outcome, system = dem_static(scene), equilibrium(scene)
    normal, tangential = outcome.force.T / system.force_unit
    assert system.strength.violation(normal, tangential).max() <= 1e-9 * np.abs(normal).max()
    unbalanced = system.opening @ normal + system.slip @ tangential - system.dead
    multiplier = outcome.curve[:, 1].max() / system.live_unit
    assert unbalanced == pytest.approx(multiplier * system.live, abs=1e-8 * np.abs(normal).max())


APART = ("panel-10", "panel-11", "panel-12", "point-load-2")
"""Walls whose paths fall at loads apart: their bracket takes in all of these, and only the lowest is a narrow one."""


def check_against_limit_analysis(name: str) -> None:
    """No load in equilibrium exceeds the associated one, and no fall does by more than a path's bracket is wide."""
    scene = published_scene(name)
    outcome = dem_static(scene)
    associated = limit(scene).upper
    assert associated is not None
    assert outcome.lower is not None
    assert outcome.lower <= associated * (1 + 1e-6)
    lower, upper = bracket(outcome)
    fall = outcome.fall if name in APART else upper
    assert fall is not None
    assert fall - lower <= 0.01 * fall
    assert upper <= associated * (1 + 1e-6) + (fall - lower)


@pytest.mark.parametrize("name", ["panel-01", "panel-04", *at_length("panel-02", "panel-05")])
def test_panels_collapse_below_limit_analysis(name: str) -> None:
    check_against_limit_analysis(name)


def test_curve_goes_on_from_two_rests_at_one_displacement() -> None:
    """Panel 1 slides at 0.6, and is tried there twice: of two states that are one nothing is divided by nothing."""
    outcome = dem_static(published_scene("panel-01"), 0.05)
    assert outcome.lower == pytest.approx(0.6, rel=1e-6)
    assert np.isfinite(outcome.curve).all()


LONG = [f"panel-{n:02}" for n in (3, 6, 7, 8, 9, 10, 11, 12)] + [f"point-load-{n}" for n in (4, 2, 1, "quarter")]


@pytest.mark.long
@pytest.mark.parametrize("name", LONG)
def test_larger_panels_collapse_below_limit_analysis(name: str) -> None:
    check_against_limit_analysis(name)


# --- honest answers ------------------------------------------------------------------------------------------


def test_wall_without_joint_stiffness_is_refused() -> None:
    with pytest.raises(SceneError, match=r"joint\.mortar"):
        dem_static(courses([[1, 1]]))


def test_overhanging_block_falls_under_its_dead_load(tmp_path: Path) -> None:
    """It turns about the corner of the one below, 0.1 m from its centroid, which is all of its series."""
    scene = pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1)], 0.6)
    recorder = StaticRecorder(scene, tmp_path)
    outcome = dem_static(scene, observe=recorder)
    recorder.finish(outcome)
    assert outcome.status == "infeasible"
    assert outcome.lower is outcome.upper is None
    down, turn = outcome.motion[scene.blocks.centroid[:, 1].argmax(), 1:]
    assert down / turn == pytest.approx(0.1)
    assert turn < 0
    first, *_, last = (pyvista.read(file).point_data[DISPLACEMENT] for file in frame_files(tmp_path, "blocks"))
    assert not first.any()
    assert np.hypot(*last.T[:2]).max() == pytest.approx(DRAWN * scene.size)


def test_block_pressed_onto_the_ground_locks() -> None:
    outcome = dem_static(pile([rectangle(0, 0, 1, 1)], 0.6, live=PointLoad((0.5, 1.0), (0.0, -1.0))))
    assert outcome.status == "unbounded"
    assert outcome.multiplier is None


def test_a_wall_that_locks_is_undecided_where_the_budget_runs_out_before_that_is_seen() -> None:
    """It was said to have neither rested nor fallen."""
    outcome = dem_static(pile([rectangle(0, 0, 1, 1)], 0.6, live=PointLoad((0.5, 1.0), (0.0, -1.0))), budget=10)
    assert outcome.status == "undecided"
    assert outcome.message.startswith("no answer: the budget ran out, though joint forces balance any multiple")


def test_a_budget_that_runs_out_leaves_it_undecided_with_what_was_reached() -> None:
    outcome = dem_static(ferris("W1"), budget=20)
    assert outcome.status == "undecided"
    assert outcome.lower is not None
    assert 0 < outcome.lower < 0.6429
    assert outcome.upper is None
    assert outcome.message == "no answer: the budget ran out"


@pytest.mark.parametrize("after", [0.0, 0.3])
def test_ctrl_c_leaves_the_loads_borne_so_far(after: float) -> None:
    def stop(path: LoadPath, state: StaticState) -> None:
        if state.multiplier >= after:
            raise KeyboardInterrupt

    outcome = dem_static(ferris("W1", 0.02), observe=stop)
    assert (outcome.status, outcome.multiplier, outcome.upper) == ("undecided", None, None)
    assert "interrupted" in outcome.message
    if after:
        assert outcome.lower is not None
        assert after <= outcome.lower < 0.5856
        assert outcome.curve[:, 1].max() == outcome.lower


def test_ctrl_c_under_the_dead_load_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dem.static.relax", interrupt)
    outcome = dem_static(ferris("W1"))
    assert (outcome.status, outcome.lower, outcome.upper) == ("undecided", None, None)
    assert "interrupted" in outcome.message


def test_ctrl_c_past_the_largest_load_leaves_the_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LoadPath, "follow", interrupt)
    outcome = dem_static(ferris("W1", 0.02))
    assert outcome.status == "collapse"
    lower, upper = bracket(outcome)
    assert 0.99 * upper <= lower <= 0.5856 <= upper * 1.001
    assert outcome.message.endswith("its curve was interrupted")  # and no other load steps are begun


def interrupt(*arguments: object) -> None:
    raise KeyboardInterrupt


# --- paths in other load steps ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("brackets", "expected"),
    [
        ([(1.0, 1.01), (1.005, 1.02)], (1.0, 1.01)),
        ([(1.0, 1.01), (0.995, 1.005)], (1.0, 1.01)),
        ([(1.0, 1.002), (1.004, 1.006)], (1.0, 1.006)),
        ([(1.004, 1.006), (1.0, 1.002)], (1.0, 1.006)),
        ([(1.0, 1.01), (0.9, 0.91)], (0.9, 1.01)),
        ([(1.0, 1.01), (1.1, 1.11)], (1.0, 1.11)),
        ([(1.0, 1.01), (0.9, 1.0)], (0.9, 1.01)),
        ([(1.0, 1.01), None], (1.0, 1.01)),
        ([None], None),
    ],
)
def test_the_bracket_takes_in_what_paths_in_other_load_steps_found(
    brackets: list[tuple[float, float] | None],
    expected: tuple[float, float] | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first where brackets have a load in common, and else both; the smallest fall is kept."""
    left = iter(brackets)

    def climbed(path: LoadPath, *_: object) -> None:
        found = next(left)
        path.undecided = "" if found else "it neither rested nor fell"
        if found:
            lower, path.upper = (end / path.system.equilibrium.live_unit for end in found)
            path.rests.append(replace(path.rests[0], x=np.append(path.rests[0].x[:-1], lower)))

    monkeypatch.setattr("dem.static.climb", climbed)
    outcome = dem_static(ferris("W1"), past=0)
    assert next(left, "none") == "none"
    if expected is None:
        assert (outcome.status, outcome.message) == ("undecided", "no answer: it neither rested nor fell")
        return
    assert (outcome.lower, outcome.multiplier, outcome.upper) == (expected[0], expected[0], expected[1])
    falls = [found[1] for found in brackets if found]
    assert outcome.fall == (min(falls) if len(falls) > 1 else None)
    for found, factor in zip(brackets, ("", "with load steps 0.5 times"), strict=False):
        assert factor in outcome.message
        assert ("no answer" if found is None else f"{found[0]:.4f}–{found[1]:.4f}") in outcome.message


def test_states_are_those_of_the_lowest_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """A path that ends lower than the first begins the series anew; the curve and the forces are its own."""
    paths = list[LoadPath]()

    def ever_lower(path: LoadPath) -> tuple[float, float]:
        if path not in paths:
            paths.append(path)
        lower, upper = (0.9 ** paths.index(path) * end for end in ends(path))
        return lower, upper

    monkeypatch.setattr(static, "ends", ever_lower)
    scene = ferris("W1")
    recorder = StaticRecorder(scene, None)
    outcome = dem_static(scene, observe=recorder)
    assert len(paths) == 2
    assert [frame.multiplier for frame in recorder.frames] == pytest.approx(outcome.curve[:, 1])
    assert len(recorder.frames) == len(paths[-1].rests) + len(paths[-1].past)


def climbs(monkeypatch: pytest.MonkeyPatch) -> list[LoadPath]:
    """Paths of a wall, as they are climbed."""
    paths: list[LoadPath] = []

    def climbed(path: LoadPath, *others: Any) -> None:
        paths.append(path)
        climb(path, *others)

    monkeypatch.setattr(static, "climb", climbed)
    return paths


def test_a_path_beside_the_first_is_asked_for_the_loads_of_its_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    """W2, whose paths agree: it rests under the one and falls under the other."""
    paths = climbs(monkeypatch)
    lower, upper = bracket(dem_static(ferris("W2", inset=0.02), past=0))
    first, second = paths
    unit = first.system.equilibrium.live_unit
    assert (unit * first.lower, unit * (first.upper or 0.0)) == (lower, upper)
    assert lower <= unit * second.lower * (1 + 1e-9)
    assert unit * (second.upper or np.inf) <= upper


def test_every_path_starts_from_the_rest_under_the_dead_load(monkeypatch: pytest.MonkeyPatch) -> None:
    paths = climbs(monkeypatch)
    dem_static(ferris("W1"), past=0)
    first, second = paths
    assert second.rests[1].multiplier == pytest.approx(first.rests[1].multiplier / 2)
    assert second.rests[0] is first.rests[0]
    assert second.rests is not first.rests


@pytest.mark.parametrize(("solves", "falls"), [(HARD + 1, 1), (HARD, 2)])
def test_a_wall_that_rests_hard_falls_once(solves: int, falls: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """W1 with inset contacts, .5856: hard to bring to rest, it is loaded by a tolerance at a time, and not bisected."""
    hold, fallen = LoadPath.hold, list[LoadPath]()

    def held(path: LoadPath, *others: Any) -> Rest:
        rest = replace(hold(path, *others), solves=solves)
        fallen.extend([path] * (rest.verdict == "fall"))
        return rest

    monkeypatch.setattr(LoadPath, "hold", held)
    lower, upper = bracket(dem_static(ferris("W1", 0.02), past=0))
    assert fallen.count(fallen[0]) == falls
    assert lower <= 0.5856 * 1.001
    assert 0.5856 * 0.999 <= upper <= lower / 0.99


def undecided_at(least: float, most: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """No load between two is decided."""
    hold = LoadPath.hold

    def held(path: LoadPath, start: Array, slip: Array, control: Control, *others: Any) -> Rest:
        if control.multiplier and least < control.value < most:
            return Rest("undecided", start, path.system.respond(start, slip), start, 10)
        return hold(path, start, slip, control, *others)

    monkeypatch.setattr(LoadPath, "hold", held)


@pytest.mark.parametrize(("least", "most"), [(0.55, 0.56), (0.57, 0.58), (0.59, 0.7), (0.582, 0.588)])
def test_a_load_that_is_not_decided_is_gone_around(least: float, most: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """W1 with inset contacts, .5856: the wall rests and falls on either side, and nobody asks whether it locks."""
    undecided_at(least, most, monkeypatch)
    monkeypatch.setattr(static, "is_self_locking", interrupt)
    outcome = dem_static(ferris("W1", 0.02))
    assert outcome.status == "collapse"
    lower, upper = bracket(outcome)
    assert lower <= 0.5856 * 1.001
    assert upper >= 0.5856 * 0.999
    inside = least < 0.5856 < most
    assert ("it neither rested nor fell under" in outcome.message) == inside
    assert upper - lower <= (1.4 * (most - least) if inside else 0.01 * upper)


def test_nothing_is_decided_above_the_last_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Undecided, between that rest and the proved bound."""
    undecided_at(0.5, np.inf, monkeypatch)
    scene = ferris("W1", 0.02)
    outcome = dem_static(scene)
    assert (outcome.status, outcome.multiplier) == ("undecided", None)
    assert outcome.lower is not None
    assert 0.4 < outcome.lower <= 0.5
    assert outcome.upper == pytest.approx(limit(scene).upper)
    assert outcome.message.startswith("no answer: it neither rested nor fell")


# --- the algorithm as published ------------------------------------------------------------------------------


@pytest.mark.parametrize(("size", "exact"), [((0.5, 2), 0.25), ((2.0, 0.5), 0.6)])
def test_published_algorithm_brings_one_block_to_its_exact_collapse(size: tuple[float, float], exact: float) -> None:
    """It converges in every increment below b/h or μ, and the first beyond is singular."""
    found = stiffness_update(pile([rectangle(0, 0, *size)], 0.6), 0.01, 1.0)
    assert found.multiplier == pytest.approx(exact, abs=0.011)
    assert found.status[-1] == "singular"
    assert set(found.status[:-1]) == {"converged"}


def test_published_lever_arm_topples_a_block_at_twice_its_load() -> None:
    """l_c read as the whole length of the joint, the paper's b/2 of a bed joint of that length."""
    found = stiffness_update(pile([rectangle(0, 0, 0.5, 2)], 0.6), 0.01, 1.0, arm=1.0)
    assert found.multiplier == pytest.approx(0.5, abs=0.011)


def test_published_algorithm_cycles_far_below_collapse() -> None:
    """W2: the set of violated joints comes back at .28, where the wall carries .56."""
    found = stiffness_update(ferris("W2"), 0.002, 1.0)
    assert found.status[-1] == "cycle"
    assert found.multiplier is not None
    assert found.multiplier < 0.5 * 0.564


def test_published_algorithm_turns_singular_beside_an_opening() -> None:
    """W3: under its dead load alone."""
    found = stiffness_update(ferris("W3"), 0.01, 1.0)
    assert found.status == ("singular",)
    assert found.multiplier is None


def test_published_algorithm_starts_on_the_elastic_wall() -> None:
    """While no condition is violated it is a linear elastic analysis."""
    curve = stiffness_update(pile([rectangle(0, 0, 0.5, 1)], 0.9, 1e10), 0.01, 0.4).curve
    assert curve[:, 0] / curve[-1, 0] == pytest.approx(curve[:, 1] / curve[-1, 1])
