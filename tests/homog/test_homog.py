"""Closed forms for running bond as a homogenised continuum."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from fem_interface.periodic_cell import rigid_cell
from homog import Moduli, StrengthDomain, crack_slope, elastic_moduli, homog, lateral_multiplier, rigid_moduli
from homog.model import deviation
from runningbond.limit import limit
from runningbond.scene import Bond, JointMaterial, SceneError
from tests.walls import courses, panel

TEXTURES = {(0.24, 0.06): 4, (0.12, 0.06): 2, (0.06, 0.06): 1, (0.06, 0.24): 0.25}


@given(slope=st.floats(0.05, 20))
def test_both_branches_of_the_multiplier_agree_at_their_boundary(slope: float) -> None:
    """At r = s both are 1 / (2 s) with zero slope; with the exponent −1/2 as printed they would differ."""
    sliding = 1e9
    step = 1e-4
    at = lateral_multiplier(slope, slope, sliding)
    beyond = lateral_multiplier(slope * (1 + step), slope, sliding)
    assert at == pytest.approx(1 / (2 * slope))
    assert abs(beyond - at) < 3 * step**2 * at


@given(slenderness=st.floats(0.01, 10), slope=st.floats(0.05, 20))
@settings(max_examples=40)
def test_multiplier_is_the_minimum_over_crack_slopes(slenderness: float, slope: float) -> None:
    """The wedge above a straight crack of slope z ≤ s overturns: λ = (moment of weight) / (moment of lateral load).

    Independent of the closed form: the wedge is integrated as a polygon and z minimised on a grid.
    """
    r, s = slenderness, slope
    best = math.inf
    for z in np.linspace(1e-3, s, 801):
        if z <= r:  # the crack leaves through the side: trapezium with corners (0,0), (1,z), (1,r), (0,r), mirrored
            sx, sy = _first_moments([(0, 0), (0, r), (-1, r), (-1, z)])
        else:
            sx, sy = _first_moments([(0, 0), (0, r), (-r / z, r)])
        best = min(best, -sx / sy)
    assert lateral_multiplier(r, s, 1e9) == pytest.approx(best, rel=2e-3)


def _first_moments(polygon: list[tuple[float, float]]) -> tuple[float, float]:
    x, y = np.array(polygon).T
    xn, yn = np.roll(x, -1), np.roll(y, -1)
    cross = x * yn - xn * y
    sign = math.copysign(1.0, cross.sum())
    return sign * float(((x + xn) * cross).sum()) / 6, sign * float(((y + yn) * cross).sum()) / 6


def test_multiplier_never_exceeds_sliding_and_vanishes_without_friction() -> None:
    assert lateral_multiplier(0.5, 0.1, 0.6) == 0.6
    assert lateral_multiplier(2.0, crack_slope(0.24, 0.06, 0.0), 0.0) == 0.0


@pytest.mark.parametrize(
    ("slenderness", "printed"),
    [
        # Baraldi, Reccia & Cecchi, Table 2, λ_HOMO; row 5 (r = 1, b/a = 4) prints 0.537 from the wrong branch.
        (0.5, (0.537, 0.380, 0.269, 0.134)),
        (1.0, (0.534, 0.380, 0.269, 0.134)),
        (2.0, (0.372, 0.328, 0.267, 0.134)),
    ],
)
def test_corrected_formula_gives_the_published_values_for_tan_30(
    slenderness: float, printed: tuple[float, ...]
) -> None:
    friction = math.tan(math.radians(30))
    for (width, height), value in zip(TEXTURES, printed, strict=True):
        slope = crack_slope(width, height, friction)
        assert lateral_multiplier(slenderness, slope, friction) == pytest.approx(value, abs=5.1e-4)


@pytest.mark.parametrize(
    ("block", "expected"),
    # Recomputed for this project: k_nh, k_th, k_nv, k_tv = 80, 30, 50, 20.
    [((240.0, 60.0), (19200, 4800, 1674.4186)), ((60.0, 240.0), (3112.5, 19200, 1241.3793))],
)
def test_elastic_moduli(block: tuple[float, float], expected: tuple[float, float, float]) -> None:
    moduli = elastic_moduli(*block, bed_normal=80, bed_shear=30, head_normal=50, head_shear=20)
    assert (moduli.a1111, moduli.a2222, moduli.a1212) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize(
    ("block", "oblique", "across"),
    # tan φ = 0.6, c = 1; recomputed for this project as limit analysis of one periodic cell.
    [((240.0, 60.0), 1.527778, 3.666667), ((60.0, 60.0), 1.203704, 2.166667), ((60.0, 240.0), 0.779570, 1.791667)],
)
def test_strength_domain(block: tuple[float, float], oblique: float, across: float) -> None:
    domain = StrengthDomain(Bond(*block), JointMaterial(0.6, 1.0, 1 / 0.6))
    assert domain.strength((1, 0, 0)) == pytest.approx(across, abs=1e-6)
    assert domain.strength((0, 1, 0)) == pytest.approx(1 / 0.6)
    assert domain.strength((0, 0, 1)) == pytest.approx(1)
    assert domain.strength((1, -1, 1)) == pytest.approx(oblique, abs=1e-6)
    assert domain.strength((-1, -1, 1)) == pytest.approx(2.5)
    assert domain.strength((-1, 0, 0)) == math.inf


def test_strength_domain_has_its_apex_at_c_cot_phi() -> None:
    domain = StrengthDomain(Bond(0.24, 0.06), JointMaterial(0.6, 3.0, 5.0))
    assert domain.strength((1, 1, 0)) == pytest.approx(5.0)


def test_strength_domain_grows_with_cohesion_and_shrinks_with_a_cut_off() -> None:
    bond = Bond(0.24, 0.06)
    whole = StrengthDomain(bond, JointMaterial(0.6, 1.0, 1 / 0.6)).strength((1, -1, 1))
    assert StrengthDomain(bond, JointMaterial(0.6, 2.0, 2 / 0.6)).strength((1, -1, 1)) == pytest.approx(2 * whole)
    assert StrengthDomain(bond, JointMaterial(0.6, 1.0, 0.2)).strength((0, 1, 0)) == pytest.approx(0.2)
    assert StrengthDomain(bond, JointMaterial(0.6)).strength((0, 0, 1)) == 0


@pytest.mark.parametrize("cohesion", [1e4, 1e5, 1e6])
def test_joints_without_tension_carry_any_pressure_on_the_beds(cohesion: float) -> None:
    """HiGHS took most of these unbounded programs for infeasible ones."""
    for block in ((0.24, 0.06), (0.4, 0.175), (0.2, 0.2), (0.3, 0.6)):
        domain = StrengthDomain(Bond(*block), JointMaterial(0.6, cohesion, 0.0))
        assert domain.strength((0, -1, 0)) == domain.strength((0, -0.3, 0)) == math.inf
        assert domain.strength((0, 1, 0)) == pytest.approx(0.0, abs=1e-6 * cohesion)


@pytest.mark.parametrize("unit", [1e-90, 1e-12, 1e12, 1e90])
def test_strength_does_not_depend_on_the_unit_of_the_direction(unit: float) -> None:
    """Stresses in Pa, MPa or any other unit: the boundary stress is the same. It was once inf or negative."""
    domain = StrengthDomain(Bond(0.24, 0.06), JointMaterial(0.6, 1.0, 1 / 0.6))
    assert unit * domain.strength((unit, -unit, unit)) == pytest.approx(1.527778, abs=1e-6)


def test_crushing_joints_bound_the_strength_domain() -> None:
    """Compression across the beds: f_m. Along them: f_m of the heads plus the cohesion of beds over half a block each.

    With shear, if cohesion holds the heads, the beds are on the cap: t² (1 + C_ss k²) = f_m². All strengths are finite.
    """
    bond = Bond(0.24, 0.06)
    domain = StrengthDomain(bond, JointMaterial(0.6, 1.0, compressive_strength=10.0))
    assert domain.strength((0, -1, 0)) == pytest.approx(10)
    assert domain.strength((-1, 0, 0)) == pytest.approx(10 + 0.24 / (2 * 0.06) * 1.0)
    assert domain.strength((0, 0, 1)) == pytest.approx(1)
    bonded = StrengthDomain(bond, JointMaterial(0.6, 20.0, compressive_strength=10.0))
    for k in (0.1, 0.5, 2.0):
        assert bonded.strength((0, -1, k)) == pytest.approx(10 / math.sqrt(1 + 9 * k**2))
    uncapped = StrengthDomain(bond, JointMaterial(0.6, 20.0, compressive_strength=10.0, cap_shear=0.0))
    assert uncapped.strength((0, -1, 2)) == pytest.approx(10)


def test_head_joints_may_have_a_strength_of_their_own() -> None:
    """Along the courses: the strength of the heads plus the cohesion of beds over half a block each."""
    bond, beds, overlap = Bond(0.24, 0.06), JointMaterial(0.6, 1.0, compressive_strength=10.0), 0.24 / (2 * 0.06)
    open_heads = StrengthDomain(bond, beds, JointMaterial(0.6))
    assert open_heads.strength((1, 0, 0)) == pytest.approx(overlap * 1.0)
    assert open_heads.strength((-1, 0, 0)) == math.inf
    assert open_heads.strength((0, -1, 0)) == pytest.approx(10)
    weak_heads = StrengthDomain(bond, beds, JointMaterial(0.4, 0.2, compressive_strength=3.0))
    assert weak_heads.strength((1, 0, 0)) == pytest.approx(0.5 + overlap * 1.0)
    assert weak_heads.strength((-1, 0, 0)) == pytest.approx(3 + overlap * 1.0)
    assert weak_heads.strength((0, -1, 0)) == pytest.approx(10)


@settings(max_examples=20, deadline=None)
@given(
    shape=st.floats(0.2, 5.0),
    friction=st.floats(0.1, 2.0),
    cohesion=st.sampled_from([0.0, 0.01, 1.0]),
    crushing=st.floats(0.2, 50.0),
    direction=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda each: max(map(abs, each)) > 0.1),
)
def test_strength_with_caps_is_bracketed_by_polygons(
    shape: float, friction: float, cohesion: float, crushing: float, direction: tuple[float, float, float]
) -> None:
    """A linear program over joint tractions, with a circumscribed polygon of 200 sides in place of the ellipse."""
    found = StrengthDomain(Bond(shape, 1.0), JointMaterial(friction, cohesion, compressive_strength=crushing))
    # Σ11 = σ_v + b/4a (τ1 − τ2), Σ22 = (σ1 + σ2) / 2, Σ12 = (τ1 + τ2) / 2 = τ_v + b/4a (σ1 − σ2)
    q = shape / 4
    balance = np.array([[1, 0, 0, 0, q, -q], [0, 0.5, 0.5, 0, 0, 0], [0, 0, 0, 0, 0.5, 0.5], [0, q, -q, 1, 0, 0]])
    along = np.array([*direction, direction[2]])[:, None]
    rows, right = [], []
    for joint in range(3):
        sides = [(1, 0, cohesion / friction), (friction, 1, cohesion), (friction, -1, cohesion)]
        angles = np.linspace(-np.pi / 2, np.pi / 2, 201)
        sides += [(-np.cos(angle), 3 * np.sin(angle), crushing) for angle in angles]
        for sigma, tau, most in sides:
            rows.append(np.zeros(7))
            rows[-1][[1 + joint, 4 + joint]] = sigma, tau
            right.append(most)
    about: Any = linprog(
        [-1, *[0] * 6],
        A_ub=rows,
        b_ub=right,
        A_eq=np.hstack([-along, balance]),
        b_eq=np.zeros(4),
        bounds=[(0, None)] + [(None, None)] * 6,
    )
    assert (found.strength(direction) == math.inf) == (about.status == 3)
    if about.status == 0:
        largest = float(about.x[0])
        assert largest * math.cos(np.pi / 400) - 1e-6 <= found.strength(direction) <= largest * (1 + 1e-6) + 1e-6


def test_direction_must_be_three_numbers() -> None:
    domain = StrengthDomain(Bond(0.24, 0.06), JointMaterial(0.6, 1.0))
    for direction in ((1, 0), (1, 0, 0, 0), 3.0):
        with pytest.raises(SceneError, match="^direction = .*: must be three numbers"):
            domain.strength(direction)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"^direction\[1\] = nan: must be a number"):
        domain.strength((0.0, math.nan, 0.0))


STIFF: dict[str, Any] = {"joint__normal_stiffness": 80e9, "joint__shear_stiffness": 30e9}
SOFT: dict[str, Any] = {"friction": 0.6, "normal_stiffness": 50e9, "shear_stiffness": 20e9}


def test_moduli_use_the_stiffness_of_bed_and_head_joints() -> None:
    """Head joints may have their own mortar; the base joint has no effect. Heads once got the stiffness of beds."""
    heads = {"joint": "soft", "between": ["*", "*"], "orientation": "head"}
    base = {"joint": "soft", "between": ["*", "ground"]}
    expected = elastic_moduli(0.24, 0.06, bed_normal=80e9, bed_shear=30e9, head_normal=50e9, head_shear=20e9)
    assert rigid_moduli(panel(**STIFF, joints={"soft": SOFT}, assign=[heads, base])) == expected
    assert expected.a1111 == pytest.approx(19.2e9)


@pytest.mark.parametrize(
    "changes", [{"wall__ends": "toothed"}, {"joint__inset": 0.005}, {"wall__first_course": "half"}]
)
def test_moduli_do_not_depend_on_ends_inset_or_first_course(changes: dict[str, Any]) -> None:
    assert rigid_moduli(panel(**STIFF, **changes)) == rigid_moduli(panel(**STIFF))


def test_walls_without_closed_form_moduli_are_refused() -> None:
    """Stack bond once got running bond's moduli, cracking blocks those of whole ones; no bond raised AssertionError."""
    no_bond = panel(**STIFF, wall__block_height=None, wall__height=None, wall__course_heights=[0.1, 0.06, 0.1])
    other: list[list[list[float]]] = [[[1, 1], [1, 1]], [[2, 2], [1, 2, 1]], [[1, 1]]]
    for scene in (no_bond, *(courses(each, **STIFF) for each in other)):
        with pytest.raises(SceneError, match="running bond"):
            rigid_moduli(scene)
    with pytest.raises(SceneError, match="inner_joint"):
        rigid_moduli(panel(**STIFF, inner_joint=SOFT))
    half = {"joint": "soft", "box": [[0.0, 0.0], [0.7, 2.0]], "orientation": "bed"}
    with pytest.raises(SceneError, match="bed joints = 'joint, soft': must be of one material"):
        rigid_moduli(panel(**STIFF, joints={"soft": SOFT}, assign=[half]))


def test_moduli_of_blocks_of_different_thickness_are_refused() -> None:
    """Courses of alternating thickness have beds as thick as the thinner one: A2222 was twice the periodic cell's."""
    thin = {"density": 1800.0, "thickness": 0.04}
    rows = [{"block": "thin", "box": [[0.0, 0.12 * k], [1.44, 0.12 * k + 0.06]]} for k in range(6)]
    scene = panel(**STIFF, wall__thickness=0.12, materials={"thin": thin}, assign=rows)
    found, _ = rigid_cell(scene)
    assert found[1, 1] == pytest.approx(0.06 * 80e9 * 0.04 / 0.08)
    with pytest.raises(SceneError, match=r"thickness of blocks = '0.04, 0.12': must be one"):
        rigid_moduli(scene)
    own = panel(**STIFF, wall__thickness=9.0, block__thickness=0.12)
    assert rigid_moduli(own) == rigid_moduli(panel(**STIFF))


def test_moduli_of_joints_without_stiffness_are_zero() -> None:
    closed = elastic_moduli(0.24, 0.06, bed_normal=1.0, bed_shear=1.0, head_normal=0.0, head_shear=0.0)
    assert closed.a1111 == pytest.approx(0.24**2 / (4 * 0.06))
    assert elastic_moduli(0.24, 0.06, bed_normal=0, bed_shear=0, head_normal=0, head_shear=0) == Moduli(0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda: crack_slope(-1.0, 0.06, 0.6), "block_width"),
        (lambda: crack_slope(0.24, 0.06, math.nan), "friction"),
        (lambda: lateral_multiplier(-1.0, 0.9, 0.6), "slenderness"),
        (lambda: lateral_multiplier(1.0, 0.0, 0.6), "slope"),
        (lambda: elastic_moduli(1, 0, bed_normal=1, bed_shear=1, head_normal=1, head_shear=1), "block_height"),
        (lambda: elastic_moduli(1, 1, bed_normal=1, bed_shear=-1, head_normal=1, head_shear=1), "bed_shear"),
    ],
)
def test_invalid_arguments_of_the_formulas_are_refused_by_name(call: Callable[[], object], key: str) -> None:
    """They once gave a modulus or a multiplier, even for negative arguments."""
    with pytest.raises(SceneError, match=f"^{key} = .*: must be a number"):
        call()


def test_gravity_that_is_not_vertical_is_refused_at_any_magnitude() -> None:
    """Below 1e-8 m/s² any direction of gravity was once taken for downwards."""
    assert homog(panel(load__gravity=1e-9)).multiplier == homog(panel()).multiplier
    with pytest.raises(SceneError, match="no dead load but the weight"):
        homog(panel(load__gravity=[1e-9, 0.0]))


def test_direct_call_refuses_what_the_closed_form_does_not_cover() -> None:
    """When `homog` was called directly, a wall with a tie got the multiplier of the wall without it."""
    tie = {"from": [0.0, 0.7], "to": [-1.0, 0.7], "area": 1e-4, "young": 2e11, "yield": 1e3}
    with pytest.raises(SceneError, match="it needs a wall without tie"):
        homog(panel(tie=[tie]))


def test_multiplier_depends_on_the_free_rectangle_only() -> None:
    """The same for length and height or courses; a fixed first course does not count."""
    by_size = homog(panel(wall__height=1.44)).multiplier
    pattern: list[list[float]] = [[1] * 6, [0.5, 1, 1, 1, 1, 1, 0.5]] * 12
    assert homog(courses(pattern, 0.24, 0.06)).multiplier == by_size == pytest.approx(0.5420, abs=1e-4)
    assert homog(panel(wall__height=1.5, support__kind="fixed-first-course")).multiplier == by_size


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"wall__ends": "toothed"}, "full rectangular panel"),
        ({"joint__cohesion": 1e3}, "dry joints"),
        ({"joint__compressive_strength": 4e4}, "joints that do not crush, without joint.compressive_strength"),
        ({"support__kind": "corners"}, "support.kind"),
        ({"load__live": {"kind": "point", "at": [0.72, 0.72], "force": [1, 0]}}, "lateral"),
    ],
)
def test_message_names_the_violated_assumption(changes: dict[str, object], reason: str) -> None:
    with pytest.raises(SceneError, match=reason):
        homog(panel(**changes))


def test_only_assigned_materials_count() -> None:
    """With all blocks and joints of assigned materials, those count; a mixture of two materials is refused."""
    everywhere: list[dict[str, Any]] = [{"joint": "rough", "between": ["*", each]} for each in ("*", "ground")]
    everywhere.append({"block": "granite", "box": [[-1.0, -1.0], [9.0, 9.0]]})
    changes: dict[str, Any] = {"materials": {"granite": {"density": 2600.0}}, "joints": {"rough": {"friction": 0.75}}}
    rough = panel(**changes, assign=everywhere)
    assert homog(rough).multiplier == homog(panel(joint__friction=0.75)).multiplier
    assert homog(panel(**changes)).multiplier == homog(panel()).multiplier
    for assigned in (everywhere[1:2], [{"block": "granite", "box": [[0.0, 0.0], [9.0, 0.06]]}]):
        with pytest.raises(SceneError, match="one material of blocks and one of joints"):
            homog(panel(**changes, assign=assigned))


@pytest.mark.parametrize("pattern", [[[1, 1, 1], [1, 1, 1]], [[1, 1], [0.5, -1, 0.5], [1, 1]], [[1, 2], [2, 1]]])
def test_other_bonds_than_running_bond_are_refused(pattern: list[list[float]]) -> None:
    with pytest.raises(SceneError, match="running bond|rectangular"):
        homog(courses(pattern))


def is_compatible(slope: float, m: float, mu: float) -> bool:
    """Whether block motions are compatible with an opening crack of this slope; the only unknown is the head shear."""
    # Strain rates over cos² ψ, lengths over b / 2: heads open by slope² and slide by y; beds likewise on both sides.
    heads = [[mu, slope**2], [-mu, slope**2]]
    beds = [[-side + q * mu * -m, m - q * mu * (side * slope**2 + 2 * m * slope)] for side in (1, -1) for q in (1, -1)]
    rows, right = np.split(np.array(heads + beds), 2, axis=1)
    return bool(linprog([0.0], A_ub=rows, b_ub=right.ravel(), bounds=[(None, None)]).status == 0)


@settings(max_examples=60, deadline=None)
@given(mu=st.floats(0.1, 3.0), m=st.floats(0.05, 4.0))
@example(mu=1.1, m=0.5)  # heads govern, by a small margin
@example(mu=1.1, m=4.0)  # beds govern, by a small margin
def test_crack_slope_is_the_steepest_compatible_one(mu: float, m: float) -> None:
    """Feasibility of a linear program just below and above it; for tan φ > 1 the heads exclude m / tan φ."""
    slope = crack_slope(2.0, m, mu)
    assert is_compatible(0.999 * slope, m, mu)
    assert not any(is_compatible(factor * slope, m, mu) for factor in (1.001, 1.1, 2.0, 5.0, 20.0))


@pytest.mark.parametrize("friction", [1.2, 1.5, 2.0])
def test_limit_load_converges_to_the_continuum_with_block_size(friction: float) -> None:
    """Blocks 4 : 1 with dilatancy: half the block size leaves at most two thirds of the deviation."""
    apart = []
    for count in (8, 16):
        width = 1.6 / count
        size = {"wall__block_width": width, "wall__block_height": width / 4}
        scene = panel(**size, wall__length=1.6, wall__height=0.8, joint__friction=friction)
        continuum, blocks = homog(scene).multiplier, limit(scene).multiplier
        assert continuum is not None
        assert blocks is not None
        apart.append(blocks / continuum - 1)
    assert 0 < apart[1] < min(0.07, 0.67 * apart[0])


@pytest.mark.parametrize(("width", "height"), [(0.24, 0.06), (0.2, 0.1), (0.15, 0.15), (0.1, 0.2), (0.06, 0.24)])
@pytest.mark.parametrize(("blocks", "courses"), [(3, 3), (7, 4), (9, 10)])
@pytest.mark.parametrize("friction", [0.4, 0.6])
def test_message_gives_the_deviation_from_the_limit_load(
    width: float, height: float, blocks: int, courses: int, friction: float
) -> None:
    """For panels other than the measured ones: the deviation from the limit load is in the reported range, to 0.01."""
    size = {"length": blocks * width, "height": courses * height, "block_width": width, "block_height": height}
    scene = panel(joint__friction=friction, **{f"wall__{key}": value for key, value in size.items()})
    estimate, exact = homog(scene), limit(scene).multiplier
    assert estimate.multiplier is not None
    assert exact is not None
    known = deviation(Bond(width, height), blocks * width, courses * height)
    assert known is not None
    least, most = known
    assert f"off by {100 * least:.3g} to {100 * most:+.3g} % of their limit load" in estimate.message
    assert least - 0.01 <= estimate.multiplier / exact - 1 <= most + 0.01


def test_deviation_includes_blocks_a_little_taller_than_wide_on_half_blocks() -> None:
    """Ten blocks to a course whose lowest one starts with a half: the estimate is 45.5 % too low, 38.3 % were named."""
    size = {"length": 2.4, "height": 2.4, "block_width": 0.24, "block_height": 0.24 / 0.9, "first_course": "half"}
    scene = panel(joint__friction=1.0, **{f"wall__{key}": value for key, value in size.items()})
    estimate, exact, known = (
        homog(scene).multiplier,
        limit(scene).multiplier,
        deviation(Bond(0.24, 0.24 / 0.9), 2.4, 2.4),
    )
    assert estimate is not None
    assert exact is not None
    assert known is not None
    assert known[0] - 0.001 <= estimate / exact - 1 <= known[1]


@pytest.mark.parametrize(
    ("width", "height", "blocks", "courses", "friction", "off"),
    [
        (0.1, 1.0, 16, 8, 0.5, 0.492),  # the range of less tall blocks ends at 0.28
        (0.2, 1.0, 18, 16, 0.75, 0.433),  # at 0.315
        (0.25, 1.0, 2, 30, 0.35, -0.013),  # a slender panel: that of stouter ones ends at -0.038
    ],
)
def test_message_claims_no_deviation_beyond_the_measured_panels(
    width: float, height: float, blocks: int, courses: int, friction: float, off: float
) -> None:
    """Blocks taller than four times their width, and panels more slender than 12: ranges of other ones do not hold."""
    size = {"length": blocks * width, "height": courses * height, "block_width": width, "block_height": height}
    changes = {f"wall__{key}": value for key, value in size.items()} | {"wall__first_course": "half"}
    scene = panel(joint__friction=friction, **changes)
    estimate, exact = homog(scene), limit(scene).multiplier
    assert estimate.multiplier is not None
    assert exact is not None
    assert estimate.multiplier / exact - 1 == pytest.approx(off, abs=0.01)
    assert deviation(Bond(width, height), blocks * width, courses * height) is None
    assert "off by a share of their limit load that is only known for b/a from 0.25 to 6" in estimate.message


@pytest.mark.parametrize("width", [0.24, 0.3, 0.35, 0.6, 0.7, 1.1])
@pytest.mark.parametrize("blocks", [3.5, 7.5, 15.5])
def test_reported_deviation_does_not_depend_on_the_unit_of_length(width: float, blocks: float) -> None:
    """Half blocks at the ends do not count, whatever the rounding of the sizes."""
    fewer = deviation(Bond(width, width / 4), np.floor(blocks) * width, 20 * width)
    assert fewer is not None
    for unit in (0.1, 1.0, 10.0):
        size = [round(x, 10) * unit for x in (blocks * width, 20 * width, width, width / 4)]
        wall = dict(zip(("wall__length", "wall__height", "wall__block_width", "wall__block_height"), size, strict=True))
        assert f"off by {100 * fewer[0]:.3g} to {100 * fewer[1]:+.3g} %" in (homog(panel(**wall)).message or "")
