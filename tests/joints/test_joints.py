"""Joint points, the truncated Coulomb cone and joint stiffness."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runningbond.joints import gauss, joint_points, joint_stiffness, lobatto, point_strength, wall_rule
from runningbond.joints.stiffness import rocking_softness
from runningbond.scene import JointMaterial, Joints, Mortar, SceneError, Stiffness
from tests.walls import panel


@pytest.mark.parametrize("n", [2, 3, 4, 5, 8])
def test_rules_integrate_polynomials_exactly(n: int) -> None:
    """Lobatto with n points is exact to degree 2n − 3, Gauss to 2n − 1."""
    for rule, degree in ((lobatto(n), 2 * n - 3), (gauss(n), 2 * n - 1)):
        for power in range(degree + 1):
            exact = 2 / (power + 1) if power % 2 == 0 else 0.0
            assert rule.weights @ rule.nodes**power == pytest.approx(exact, abs=1e-13)
        missed = rule.weights @ rule.nodes ** (degree + 1) - 2 / (degree + 2)
        assert abs(missed) > 1e-6


def test_lobatto_points_include_joint_ends() -> None:
    assert lobatto(2).nodes.tolist() == [-1, 1]
    assert lobatto(3).weights == pytest.approx([1 / 3, 4 / 3, 1 / 3])


def test_points_represent_the_whole_joint_and_lie_on_it() -> None:
    scene = panel()
    for rule in (lobatto(), lobatto(4), gauss(2)):
        points = joint_points(scene.joints, scene.thickness, rule)
        area = np.bincount(points.joint, points.area)
        assert area == pytest.approx(scene.joints.length * scene.thickness)
        start, stop = scene.joints.ends[points.joint].transpose(1, 0, 2)
        from_ends = np.hypot(*(points.position - start).T) + np.hypot(*(points.position - stop).T)
        assert from_ends == pytest.approx(scene.joints.length[points.joint])


@given(st.floats(-math.pi, math.pi), st.floats(0, 0.9))
def test_frame_is_right_handed_and_inset_moves_points_inwards(angle: float, inset: float) -> None:
    """t = (−n_y, n_x); the two points of a joint of length 2 are 2 − 2 · inset apart."""
    end = [2 * math.cos(angle), 2 * math.sin(angle)]
    points = joint_points(Joints(np.array([[0, 1]]), np.array([[[0.0, 0.0], end]])), 1.0, inset=inset)
    n, t = points.normal[0], points.tangent[0]
    assert t == pytest.approx([-n[1], n[0]])
    assert math.hypot(*(points.position[1] - points.position[0])) == pytest.approx(2 - 2 * inset)


@pytest.mark.parametrize(("count", "expected"), [(2, 1.0), (3, 2.0), (9, 240.0)])
def test_joint_is_the_softer_the_less_of_it_bears(count: int, expected: float) -> None:
    """With three points, Σ w x² = 1/12, the end carries a sixth, and the next point is half a length away."""
    scene = panel()
    points = joint_points(scene.joints, scene.thickness, lobatto(count))
    shuffled = points.part(np.random.default_rng(1).permutation(len(points)))
    assert rocking_softness(shuffled) == pytest.approx(expected, rel=0.01)
    assert rocking_softness(joint_points(scene.joints, scene.thickness, gauss(1))) == 1.0


def test_mortar_stiffness_is_that_of_a_confined_layer() -> None:
    """The paper's 1 GPa with ν = 0.2 and 10 mm: 1.041667e11 and 4.166667e10 Pa/m."""
    stiffness = joint_stiffness(JointMaterial(0.6, elasticity=Mortar(1e9, 0.2, 0.01)))
    assert stiffness.normal == pytest.approx(1e9 / (0.01 * 0.96))
    assert stiffness.shear == pytest.approx(1e9 / (2 * 1.2 * 0.01))
    given = Stiffness(1e10, 2e9)
    assert joint_stiffness(JointMaterial(0.6, elasticity=given)) == given


def test_missing_stiffness_is_refused() -> None:
    with pytest.raises(SceneError, match=r"joint\.mortar"):
        joint_stiffness(JointMaterial(0.6))


def up_to(most: float) -> st.SearchStrategy[float]:
    """Numbers that a material may have: zero, or large enough not to vanish in rounding."""
    return st.one_of(st.just(0.0), st.floats(1e-6, most))


@given(
    friction=up_to(3),
    cohesion=up_to(10),
    cut=up_to(1),
    sigma=st.floats(-20, 20),
    tau=st.floats(-20, 20),
)
def test_cone_from_its_vertex_is_mohr_coulomb_with_a_cut_off(
    friction: float, cohesion: float, cut: float, sigma: float, tau: float
) -> None:
    """The same set as |τ| ≤ c − σ tan φ and σ ≤ f_t."""
    tension = cut * (cohesion / friction if friction > 1e-3 else cohesion)
    strength = point_strength(JointMaterial(friction, cohesion, tension), np.ones(1))
    violation = strength.violation(np.array([sigma]), np.array([tau]))[0]
    expected = max(sigma - tension, abs(tau) - (cohesion - sigma * friction))
    assert violation == pytest.approx(expected, abs=1e-9)


@given(
    friction=st.floats(0.01, 3),
    cohesion=up_to(10),
    cut=up_to(1),
    slip=st.floats(-5, 5),
    extra=st.floats(0, 5),
    pressure=st.floats(0, 50),
    share=st.floats(-1, 1),
)
def test_work_of_admissible_forces_does_not_exceed_dissipation(
    friction: float, cohesion: float, cut: float, slip: float, extra: float, pressure: float, share: float
) -> None:
    strength = point_strength(JointMaterial(friction, cohesion, cut * cohesion / friction), np.ones(1))
    opening = friction * abs(slip) + extra
    normal = strength.tension - pressure
    tangential = share * (strength.shear + friction * pressure)
    work = normal * opening + tangential * slip
    assert (work <= strength.dissipation(np.array([opening]), np.array([slip])) + 1e-9 * (1 + abs(work))).all()


@pytest.mark.parametrize(("parts", "within"), [(1, 0.03), (2, 0.02), (3, 0.02), (4, 0.02), (8, 0.01)])
def test_error_of_crushed_points_in_bending_is_as_reported(parts: int, within: float) -> None:
    """Crushed over a share s from one end, against s (1 - s) / 2 for a continuous joint (`crushing_note`)."""
    rule = wall_rule(panel(joint__compressive_strength=1e7), parts)
    at = np.concatenate([(k + (1 + np.asarray(rule.nodes)) / 2) / parts for k in range(parts)])
    order = np.argsort(at, kind="stable")
    weight = np.tile(np.asarray(rule.weights) / np.sum(rule.weights) / parts, parts)[order]
    filled, errors = np.cumsum(weight) - weight, []
    for share in np.linspace(0.05, 0.6, 200):
        borne = np.clip(share - filled, 0.0, weight)
        errors.append((share / 2 - float(borne @ at[order])) / (share * (1 - share) / 2) - 1)
    assert 0.5 * within < np.abs(errors).max() < within
