"""Static model of rigid blocks: joint law, exact limit loads, published walls, and undecided results."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from hypothesis import given
from hypothesis import strategies as st

from dem import relaxation, static
from dem.climb import COSTLY_SOLVES, climb, ends
from dem.load_path import LoadPath, StaticState
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
"""Ferris & Tin-Loi (2001), from bottom to top."""


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
def test_forces_stay_in_cone_and_return_mapping_is_idempotent(
    law: PointLaw, opening: float, slip: float, plastic: float
) -> None:
    """|S| ≤ s + tan φ (T − N), N ≤ T; a second return mapping from the new plastic slip gives the same forces."""
    jump, before = (np.array([opening]), np.array([slip])), np.array([plastic])
    first = law(*jump, before)
    assert law.strength.violation(first.normal, first.tangential).max() <= 1e-12
    second = law(*jump, first.plastic_slip)
    assert second.normal == first.normal
    assert second.tangential == pytest.approx(first.tangential, abs=1e-12)
    assert (jump[0][0], jump[1][0], before[0]) == (opening, slip, plastic)


@given(laws, jumps, jumps, jumps)
def test_friction_dissipates_and_slip_causes_no_dilatancy(
    law: PointLaw, opening: float, slip: float, old: float
) -> None:
    """The shear force does no negative work on plastic slip, and the normal force does not depend on slip."""
    found = law(np.array([opening]), np.array([slip]), np.array([old]))
    assert (found.tangential * (found.plastic_slip - old) >= 0).all()
    assert found.normal == law(np.array([opening]), np.array([0.0]), np.array([0.0])).normal


@given(laws, jumps, jumps, jumps)
def test_tangent_is_the_derivative_of_the_force(law: PointLaw, opening: float, slip: float, plastic: float) -> None:
    """Against central differences, except across a kink of the law."""
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
"""Strengths that a material may have: zero, or large enough not to vanish in rounding."""


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
def test_elastic_solution_balances_load(name: str) -> None:
    """K_e q + Cᵀ r = f with K_e applied joint by joint, not assembled; C q = 0; under load or displacement control."""
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
def test_block_rests_below_its_limit_load_and_falls_above(multiplier: float, verdict: RestVerdict, far: float) -> None:
    """b/h = 1/4; for any threshold displacement of a fall."""
    system = static_system(pile([rectangle(0, 0, 0.5, 2)], 0.6))
    start = np.append(np.zeros(system.freedoms), multiplier)
    nothing = np.zeros(len(system.law.normal_stiffness))
    assert relax(system, start, nothing, Control(multiplier, multiplier=True), far).verdict == verdict


@pytest.mark.parametrize(("slowing", "verdict"), [(0.5, "fall"), (2.0, "undecided")])
def test_continuing_creep_at_end_of_budget_is_a_fall(
    slowing: float, verdict: RestVerdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A toppling block without a verdict before the budget ends; undecided if the motion slows down."""
    monkeypatch.setattr(relaxation, "FALL_RATIO", 9.0)
    monkeypatch.setattr(relaxation, "CREEP_RATIO", slowing)
    monkeypatch.setattr(relaxation, "MAX_SOLVES", 60)
    system = static_system(pile([rectangle(0, 0, 0.5, 2)], 0.6))
    start = np.append(np.zeros(system.freedoms), 0.26)
    found = relax(system, start, np.zeros(len(system.law.normal_stiffness)), Control(0.26, multiplier=True), 1e2, 60)
    assert found.verdict == verdict
    assert relax(system, start, np.zeros(2), Control(0.26, multiplier=True), 1e2, 59).verdict == "undecided"


def test_elastic_motion_on_soft_joints_is_no_fall() -> None:
    """A block that leans farther than the threshold of a fall but comes to rest there."""
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
def test_uplift_of_light_block_equals_joint_strength_plus_weight(gravity: float) -> None:
    """A joint of 0.5 m × 0.3 m carries 1e5 Pa in tension: 15 kN plus the weight, 0.12 N for the lighter block."""
    glued = JointMaterial(0.7, 1e5, 1e5, elasticity=Stiffness(1e9, 4e8))
    lift = Load((0.0, -gravity), (PointLoad((0.25, 0.4), (0.0, 1.0)),))
    stone = [rectangle(0, 0, 0.5, 0.4)]
    scene = build_scene("stone", stone, thickness=0.3, block=BlockMaterial(2000.0), joint=glued, load=lift)
    lower, upper = bracket(dem_static(scene))
    exact = 15e3 + gravity * float(scene.mass[0])
    assert lower == pytest.approx(exact, rel=1e-6)
    assert exact < upper <= 1.01 * exact


def test_block_balanced_on_an_edge_has_zero_limit_load() -> None:
    """Its centroid is above the edge of the block below."""
    lower, _ = bracket(dem_static(pile([rectangle(0, 0, 1, 1), rectangle(0.5, 1, 1, 1)], 0.6)))
    assert lower == pytest.approx(0.0, abs=1e-6)


def test_curve_starts_with_the_elastic_stiffness_of_the_base_joint() -> None:
    """A push λ W at half height shears the base joint by λ W / (k_t A) and, with its two ends as springs k_n A / 2 at
    ± b / 2, rotates it by (λ W h / 2) / (k_n A b² / 4): the corner moves by λ W / (k_t A) + 2 λ W h² / (k_n A b²)."""
    b, h, k_n = 0.5, 1.0, 1e10
    weight, area = 2000 * 9.81 * b * h * 0.1, b * 0.1
    curve = dem_static(pile([rectangle(0, 0, b, h)], 0.9, k_n)).curve
    flexibility = weight / (0.4 * k_n * area) + 2 * weight * h**2 / (k_n * area * b**2)
    assert curve[0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert curve[1, 0] / curve[1, 1] == pytest.approx(flexibility, rel=1e-6)


def test_mechanism_of_a_toppling_block_turns_about_its_corner() -> None:
    """Pushed along +x: clockwise about the lower right corner, with the upper left corner fastest."""
    motion = dem_static(pile([rectangle(0, 0, 0.5, 2)], 0.6)).motion[0]
    spin = -1 / np.hypot(0.5, 2)
    assert motion == pytest.approx([-spin * 1.0, spin * -0.25, spin], abs=1e-4)


# --- walls ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "published"), [("W1", 0.5856), ("W2", 0.5244), ("W3", 0.3374)])
def test_walls_with_inset_contacts_have_published_limit_load(name: str, published: float) -> None:
    """Contacts inset by 20 mm: the lowest certified load, for W1 and W2 the only one, within 1 %, also at the end."""
    outcome = dem_static(ferris(name, 0.02))
    lower, upper = bracket(outcome)
    assert lower == pytest.approx(published, rel=0.01)
    assert upper == pytest.approx(published, rel=0.01)
    assert outcome.curve[-1, 1] == pytest.approx(published, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "least", "most"), [("W1", 0.639, 0.6429), ("W2", 0.5575, 0.5796), ("W3", 0.3558, 0.4027)]
)
def test_walls_with_sharp_corners_have_certified_limit_load(name: str, least: float, most: float) -> None:
    """Limit load within the certified interval of each wall, to the digits given."""
    lower, upper = bracket(dem_static(ferris(name)))
    assert least - 5e-5 <= lower <= upper <= most + 5e-5


def test_tall_wall_loses_strength_past_its_peak() -> None:
    """W2, inset: from .5250 down to .5244."""
    curve = dem_static(ferris("W2", 0.02)).curve
    assert curve[:, 1].max() == pytest.approx(0.5250, abs=1e-4)
    assert curve[-1, 1] == pytest.approx(0.5244, abs=1e-4)


@pytest.mark.parametrize("name", ["W3", *at_length("W1", "W2")])
def test_bracket_does_not_depend_on_step_or_collapse_displacement(name: str) -> None:
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
"""Walls whose loading paths have different limit loads: the bracket contains all, only the lowest one is narrow."""


def check_against_limit_analysis(name: str) -> None:
    """No load in equilibrium exceeds the associated limit, and no fall does by more than a path's bracket width."""
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


def test_curve_continues_from_two_rests_at_same_displacement() -> None:
    """Panel 1 slides at 0.6 and is tried there twice: two identical states must not cause a division 0 / 0."""
    outcome = dem_static(published_scene("panel-01"), 0.05)
    assert outcome.lower == pytest.approx(0.6, rel=1e-6)
    assert np.isfinite(outcome.curve).all()


LONG = [f"panel-{n:02}" for n in (3, 6, 7, 8, 9, 10, 11, 12)] + [f"point-load-{n}" for n in (4, 2, 1, "quarter")]


@pytest.mark.long
@pytest.mark.parametrize("name", LONG)
def test_larger_panels_collapse_below_limit_analysis(name: str) -> None:
    check_against_limit_analysis(name)


# --- undecided results and refusals --------------------------------------------------------------------------


def test_wall_without_joint_stiffness_is_refused() -> None:
    with pytest.raises(SceneError, match=r"joint\.mortar"):
        dem_static(courses([[1, 1]]))


def test_overhanging_block_collapses_under_its_dead_load(tmp_path: Path) -> None:
    """It rotates about the corner of the block below, 0.1 m from its centroid; this motion is its whole recording."""
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


def test_locked_wall_is_undecided_if_budget_runs_out_first() -> None:
    """The message once claimed that the wall had neither rested nor fallen."""
    outcome = dem_static(pile([rectangle(0, 0, 1, 1)], 0.6, live=PointLoad((0.5, 1.0), (0.0, -1.0))), budget=10)
    assert outcome.status == "undecided"
    assert outcome.message.startswith("no answer: the budget ran out, though joint forces balance any multiple")


def test_exhausted_budget_is_undecided_with_lower_bound() -> None:
    outcome = dem_static(ferris("W1"), budget=20)
    assert outcome.status == "undecided"
    assert outcome.lower is not None
    assert 0 < outcome.lower < 0.6429
    assert outcome.upper is None
    assert outcome.message == "no answer: the budget ran out"


@pytest.mark.parametrize("after", [0.0, 0.3])
def test_interrupt_keeps_lower_bound(after: float) -> None:
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


def test_interrupt_under_dead_load_keeps_no_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dem.static.relax", interrupt)
    outcome = dem_static(ferris("W1"))
    assert (outcome.status, outcome.lower, outcome.upper) == ("undecided", None, None)
    assert "interrupted" in outcome.message


def test_interrupt_past_the_peak_keeps_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LoadPath, "follow", interrupt)
    outcome = dem_static(ferris("W1", 0.02))
    assert outcome.status == "collapse"
    lower, upper = bracket(outcome)
    assert 0.99 * upper <= lower <= 0.5856 <= upper * 1.001
    assert outcome.message.endswith("its curve was interrupted")  # and no path with other load steps is started


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
def test_bracket_includes_paths_with_other_load_steps(
    brackets: list[tuple[float, float] | None],
    expected: tuple[float, float] | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first bracket if the brackets overlap, otherwise their union; the smallest fall is kept."""
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


def test_recorded_states_are_those_of_lowest_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """A path that ends lower than the first restarts the recording; curve and forces are those of this path."""
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


def test_peak_of_curve_is_no_larger_than_load_of_fall() -> None:
    """A larger load at a prescribed displacement is no lower end: the wall has fallen under a smaller one."""
    system, none = static_system(pile([rectangle(0, 0, 0.5, 2)], 0.6)), np.zeros(0)
    loads = np.append(np.zeros(system.unknowns - 1), 1.0)
    rests, past = ([StaticState(m * loads, none, none, 0.0, none) for m in part] for part in ((0.0, 0.1), (0.3, 0.2)))
    path = LoadPath(system, far=1e3, budget=0, rests=rests, past=past, upper=0.25)
    assert ends(path) == (0.2, 0.25)


def climbs(monkeypatch: pytest.MonkeyPatch) -> list[LoadPath]:
    """Loading paths of a wall, collected as they are computed."""
    paths: list[LoadPath] = []

    def climbed(path: LoadPath, *others: Any) -> None:
        paths.append(path)
        climb(path, *others)

    monkeypatch.setattr(static, "climb", climbed)
    return paths


def test_second_path_is_checked_at_bounds_of_first_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    """W2, whose paths agree: the second rests at the lower bound and falls at the upper one."""
    paths = climbs(monkeypatch)
    lower, upper = bracket(dem_static(ferris("W2", inset=0.02), past=0))
    first, second = paths
    unit = first.system.equilibrium.live_unit
    assert (unit * first.lower, unit * (first.upper or 0.0)) == (lower, upper)
    assert lower <= unit * second.lower * (1 + 1e-9)
    assert unit * (second.upper or np.inf) <= upper


def test_every_path_starts_from_dead_load_equilibrium(monkeypatch: pytest.MonkeyPatch) -> None:
    paths = climbs(monkeypatch)
    dem_static(ferris("W1"), past=0)
    first, second = paths
    assert second.rests[1].multiplier == pytest.approx(first.rests[1].multiplier / 2)
    assert second.rests[0] is first.rests[0]
    assert second.rests is not first.rests


@pytest.mark.parametrize(("solves", "falls"), [(COSTLY_SOLVES + 1, 1), (COSTLY_SOLVES, 2)])
def test_wall_with_costly_rests_falls_once(solves: int, falls: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """W1 with inset contacts, .5856: with costly rests the load grows by one tolerance per step, without bisection."""
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
    """Make all loads between two undecided."""
    hold = LoadPath.hold

    def held(path: LoadPath, start: Array, slip: Array, control: Control, *others: Any) -> Rest:
        if control.multiplier and least < control.value < most:
            return Rest("undecided", start, path.system.respond(start, slip), start, 10)
        return hold(path, start, slip, control, *others)

    monkeypatch.setattr(LoadPath, "hold", held)


@pytest.mark.parametrize(("least", "most"), [(0.55, 0.56), (0.57, 0.58), (0.59, 0.7), (0.582, 0.588)])
def test_search_bypasses_undecided_loads(least: float, most: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """W1 with inset contacts, .5856: the wall rests and falls on either side, and self-locking is not checked."""
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


def test_undecided_loads_above_last_rest_give_limit_analysis_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Undecided, between the last rest and the upper bound of limit analysis."""
    undecided_at(0.5, np.inf, monkeypatch)
    scene = ferris("W1", 0.02)
    outcome = dem_static(scene)
    assert (outcome.status, outcome.multiplier) == ("undecided", None)
    assert outcome.lower is not None
    assert 0.4 < outcome.lower <= 0.5
    assert outcome.upper == pytest.approx(limit(scene).upper)
    assert outcome.message.startswith("no answer: it neither rested nor fell")


def test_bound_equal_to_last_rest_keeps_that_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A block without friction rests under no load only, which is also the bound of limit analysis."""
    undecided_at(0.0, np.inf, monkeypatch)
    outcome = dem_static(pile([rectangle(0, 0, 1, 1)], 0.0))
    assert outcome.status == "collapse"
    assert bracket(outcome) == pytest.approx((0.0, 0.0), abs=1e-9)


# --- the algorithm as published ------------------------------------------------------------------------------


@pytest.mark.parametrize(("size", "exact"), [((0.5, 2), 0.25), ((2.0, 0.5), 0.6)])
def test_published_algorithm_finds_exact_limit_load_of_one_block(size: tuple[float, float], exact: float) -> None:
    """It converges in every increment below b/h or μ, and the first increment beyond is singular."""
    found = stiffness_update(pile([rectangle(0, 0, *size)], 0.6), 0.01, 1.0)
    assert found.multiplier == pytest.approx(exact, abs=0.011)
    assert found.status[-1] == "singular"
    assert set(found.status[:-1]) == {"converged"}


def test_published_lever_arm_doubles_toppling_load() -> None:
    """With l_c taken as the whole length of the joint, the paper's b/2 of a bed joint of that length."""
    found = stiffness_update(pile([rectangle(0, 0, 0.5, 2)], 0.6), 0.01, 1.0, arm=1.0)
    assert found.multiplier == pytest.approx(0.5, abs=0.011)


def test_published_algorithm_cycles_far_below_collapse() -> None:
    """W2: a set of violated joints recurs at .28, while the wall carries .56."""
    found = stiffness_update(ferris("W2"), 0.002, 1.0)
    assert found.status[-1] == "cycle"
    assert found.multiplier is not None
    assert found.multiplier < 0.5 * 0.564


def test_published_algorithm_is_singular_for_wall_with_opening() -> None:
    """W3: already under its dead load."""
    found = stiffness_update(ferris("W3"), 0.01, 1.0)
    assert found.status == ("singular",)
    assert found.multiplier is None


def test_published_algorithm_is_linear_elastic_at_first() -> None:
    """It is a linear elastic analysis as long as no condition is violated."""
    curve = stiffness_update(pile([rectangle(0, 0, 0.5, 1)], 0.9, 1e10), 0.01, 0.4).curve
    assert curve[:, 0] / curve[-1, 0] == pytest.approx(curve[:, 1] / curve[-1, 1])


@pytest.mark.parametrize(("kind", "statuses"), [("corners", {"converged"}), ("pinned-corners", {"singular"})])
def test_published_algorithm_answers_for_block_without_joints(kind: str, statuses: set[str]) -> None:
    """A block that its pins hold carries any load; a fourth pin, one more than it needs, makes the matrix singular."""
    scene = courses([[1]], support__kind=kind, joint__normal_stiffness=1e10, joint__shear_stiffness=4e9)
    found = stiffness_update(scene, 0.1, 0.5)
    assert set(found.status) == statuses
    assert not found.curve[:, 0].any()
