"""Joints of finite compressive strength: what one carries, and walls of them, by hand and by fibres."""

import math
from dataclasses import replace
from typing import Any

import clarabel
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.sparse import csc_matrix, diags_array, eye_array, hstack, vstack

from runningbond.compare.models import run_model
from runningbond.compare.published import published_scene
from runningbond.limit import equilibrium, limit, limit_state
from runningbond.limit.crushed import InnerProgram, first_resultants
from runningbond.limit.crushing import Crushing, _boundary
from runningbond.limit.kinematics import dead_load, live_load, movable_freedoms
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
from tests.limit.test_limit import rectangle
from tests.random_scenes import mirrored, random_scene
from tests.walls import courses, panel

NARROW = 1e-6
THICKNESS, DENSITY = 0.1, 2000.0
MATERIALS = {
    "dry": JointMaterial(0.6, compressive_strength=1.0, cap_shear=0.0),
    "dry, capped in shear": JointMaterial(0.6, compressive_strength=1.0),
    "steep": JointMaterial(3.0, compressive_strength=1.0),
    "without friction": JointMaterial(0.0, compressive_strength=1.0),
    "cohesive": JointMaterial(0.6, 0.15, compressive_strength=1.0),
    "cut off": JointMaterial(0.6, 0.15, 0.05, compressive_strength=1.0, cap_shear=2.0),
    "cohesive, without friction": JointMaterial(0.0, 0.2, 0.1, compressive_strength=1.0, cap_shear=0.0),
    "its cone a rest on the cap": JointMaterial(0.3, 0.31, 0.2, compressive_strength=1.0),
    "capped all round": JointMaterial(0.6, 0.6, 0.2, compressive_strength=1.0),
    "stronger in tension": JointMaterial(0.5, 2.0, 2.0, compressive_strength=1.0),
}
OF_ALL = pytest.mark.parametrize("name", MATERIALS)


def joint(name: str, n: int = 1) -> Crushing:
    """Joints of a material, of unit area."""
    material = MATERIALS[name]
    strength, shear = np.full(n, material.compressive_strength), np.full(n, material.cap_shear)
    cone = [material.friction, material.tension, material.cohesion - material.friction * material.tension]
    return Crushing(np.arange(n), strength, shear, *_boundary(*np.tile(cone, (n, 1)).T, strength, shear))


def jumps(seed: int, n: int) -> Array:
    """Directions of jumps ``(3, n)``, of entries that differ by up to three orders."""
    random = np.random.default_rng(seed)
    return np.asarray(random.normal(size=(3, n)) * 10 ** random.uniform(-3, 0, (3, n)))


# --- what one joint carries ----------------------------------------------------------------------------------


def fibres(friction: float, cohesion: float, tension: float, strength: float, shear: float, n: int) -> tuple[Any, ...]:
    """Clarabel's rows A x + s = b and cones of tractions (σ, τ) on n fibres, n of each, with strengths of any size."""
    one, zero = eye_array(n), 0 * eye_array(n)
    cone = vstack([hstack([friction * one, one]), hstack([friction * one, -one]), hstack([one, zero])])
    ellipse = vstack([hstack([zero, zero]), hstack([-one, zero]), hstack([zero, -math.sqrt(shear) * one])])
    order = np.arange(3 * n).reshape(3, n).T.ravel()
    right = np.concatenate([np.full(2 * n, cohesion), np.full(n, tension)])
    cap = np.tile([strength, 0.0, 0.0], n)
    return cone, ellipse.tocsr()[order], right, cap


def largest(cost: Array, equal: Any, given: Array, cone: Any, ellipse: Any, right: Array, cap: Array) -> float:
    """Largest cost · x by Clarabel."""
    rows = vstack([equal, cone, ellipse], format="csc") if len(given) else vstack([cone, ellipse], format="csc")
    cones = [clarabel.ZeroConeT(len(given))] if len(given) else []
    cones += [clarabel.NonnegativeConeT(len(right)), *[clarabel.SecondOrderConeT(3)] * (len(cap) // 3)]
    set_ = clarabel.DefaultSettings()
    set_.verbose, set_.tol_gap_rel, set_.tol_gap_abs, set_.tol_feas = False, 1e-10, 1e-12, 1e-10
    nothing = csc_matrix((len(cost), len(cost)))
    every = np.concatenate([given, right, cap])
    return -float(clarabel.DefaultSolver(nothing, -cost, csc_matrix(rows), every, cones, set_).solve().obj_val)


@OF_ALL
def test_a_joint_carries_the_resultants_of_400_fibres(name: str) -> None:
    """In any direction as far as the best tractions on fibres, beyond which 1 / (8 n²) of the strength is left."""
    material, one, n = MATERIALS[name], joint(name), 400
    at = (np.arange(n) + 0.5) / n
    program = fibres(material.friction, material.cohesion, material.tension, 1.0, material.cap_shear, n)
    for first, second, slip in jumps(1, 12).T:
        cost = np.concatenate([first * (1 - at) + second * at, np.full(n, slip)]) / n
        found = largest(cost, None, np.zeros(0), *program)
        exact = one.dissipation(np.array([[first], [second], [slip]]))[0]
        size = max(abs(first), abs(second), abs(slip))
        assert -1e-8 * size <= exact - found <= 1e-6 * size


@OF_ALL
def test_forces_of_a_joint_are_the_slopes_of_what_it_dissipates(name: str) -> None:
    for direction in jumps(2, 20).T:
        if np.abs(direction[2]) > 1e-2 * np.abs(direction).max():  # elsewhere it has all but a kink
            step = 1e-6 * np.abs(direction).max()
            changed = direction[:, None] + step * np.hstack([np.eye(3), -np.eye(3)])
            up, down = joint(name, 6).dissipation(changed).reshape(2, 3)
            assert joint(name).forces(direction[:, None])[:, 0] == pytest.approx((up - down) / (2 * step), abs=1e-4)


@OF_ALL
def test_forces_found_in_one_direction_lie_within_in_all_others(name: str) -> None:
    directions = jumps(3, 300)
    forces = np.hstack([joint(name, 300).forces(directions), joint(name).blocks(4.0 ** -np.arange(8.0))])
    beyond = forces.T @ directions - joint(name, 300).dissipation(directions)
    assert (beyond <= 1e-12 * np.abs(directions).max(axis=0)).all()


@pytest.mark.parametrize("name", ["dry", "cohesive", "capped all round"])
@pytest.mark.parametrize("slip", [0.0, 1e-12, 1e-3, 1.0])
def test_what_a_joint_dissipates_has_no_seams(name: str, slip: float) -> None:
    """Between closed forms and quadrature, and where its ends all but move as one; homogeneous, and even in slip."""
    one = joint(name)
    for tilt in 10.0 ** -np.arange(0.0, 17.0, 0.5):
        direction = np.array([[-0.3], [-0.3 + tilt], [slip]])
        level = np.array([[-0.3 + tilt / 2]] * 2 + [[slip]])
        value, beside = one.dissipation(direction)[0], one.dissipation(level)[0]
        assert -1e-14 <= value - beside <= tilt**2 / 2 + 1e-14
        other = 1e7 * direction[[1, 0, 2]] * [[1], [1], [-1]]
        assert one.dissipation(other)[0] == pytest.approx(1e7 * value, rel=1e-12)


@given(share=st.floats(1e-4, 1.0))
@settings(max_examples=20, deadline=None)
def test_a_dry_joint_whose_cap_knows_no_shear_is_a_stress_block(share: float) -> None:
    """M ≤ N/2 (l − N / (t f_c)) and V ≤ N tan φ, both at once."""
    one = joint("dry")
    blocks = one.blocks(np.array([share]))
    normal, moment = -blocks[:2].sum(axis=0), np.abs(blocks[0] - blocks[1]) / 2
    assert moment == pytest.approx(normal / 2 * (1 - normal), abs=1e-15)
    assert np.abs(blocks[2]).max() == pytest.approx(0.6 * share)
    n1, n2, v = one.forces(np.array([[-share], [1 - share], [1e-12]]))[:, 0]
    assert [-n1 - n2, (n2 - n1) / 2, v] == pytest.approx([share, share / 2 * (1 - share), 0.6 * share], abs=1e-11)


# --- walls by hand -------------------------------------------------------------------------------------------


def built(blocks: list[Array], crushing: JointMaterial, live: Any = None, grounds: list[Array] | None = None) -> Scene:
    """Blocks on a flat base, or between grounds."""
    load = Load(live=(live or Lateral(),)) if grounds is None else Load((0.0, 0.0), (live,))
    return build_scene(
        *("by hand", blocks), thickness=THICKNESS, block=BlockMaterial(DENSITY), joint=crushing, load=load,
        **({} if grounds is None else {"grounds": grounds}),
    )  # fmt: skip


def collapse(scene: Scene) -> float:
    """λ of a scene whose bracket is narrow."""
    outcome = limit(scene)
    assert outcome.status == "collapse", outcome.message
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.multiplier == outcome.lower
    assert outcome.upper - outcome.lower <= NARROW * abs(outcome.upper)
    return outcome.lower


@pytest.mark.parametrize("share", [0.9, 0.3, 0.01, 1e-4, 1e-7, 1e-11])
@pytest.mark.parametrize("height", [1.0, 2.5])
def test_the_toe_of_a_block_on_crushing_ground(share: float, height: float) -> None:
    """N crushes that share of the base: pushed at its top V H = N (l/2 − N / (2 t f_c)), about a point at N / (t f_c)."""
    weight = DENSITY * 9.81 * THICKNESS * height
    material = JointMaterial(5.0, compressive_strength=weight / (share * THICKNESS), cap_shear=0.0)
    scene = built([rectangle(0, 0, 1, height)], material, PointLoad((0.0, height), (1.0, 0.0)))
    assert collapse(scene) == pytest.approx(weight * (1 - share) / (2 * height), rel=NARROW)
    outcome = limit(scene)
    if share > 1e-3:
        assert f"inside them: 1, foremost about ({1 - share:.3g}"[:-1] in outcome.message
    corner = outcome.motion[0] @ [[1, 0], [0, 1], [height / 2, 1 / 2]]  # of the toe: down, and not sideways
    assert -corner[1] == pytest.approx(share / (1 - share) * (corner[1] + outcome.motion[0] @ [0, 0, -1]), abs=1e-3)


@pytest.mark.parametrize("share", [0.3, 0.01])
def test_a_block_of_little_friction_slides_all_the_same(share: float) -> None:
    """V = N tan φ, whether its ground crushes or not."""
    weight = DENSITY * 9.81 * THICKNESS
    material = JointMaterial(0.1, compressive_strength=weight / (share * THICKNESS), cap_shear=0.0)
    assert collapse(built([rectangle(0, 0, 1, 1)], material)) == pytest.approx(0.1, rel=NARROW)


@pytest.mark.parametrize("eccentricity", [0.0, 0.1, 0.3, 0.45])
@pytest.mark.parametrize("shear", [0.0, 9.0])
def test_an_eccentric_column_bears_the_pressure_on_twice_its_way_to_the_edge(eccentricity: float, shear: float) -> None:
    """P = t f_c (l − 2 e); weightless, on ground."""
    material = JointMaterial(0.6, compressive_strength=1e6, cap_shear=shear)
    live = PointLoad((0.5 + eccentricity, 2.0), (0.0, -1.0))
    scene = built([rectangle(0, 0, 1, 2)], material, live, [rectangle(0, -1, 1, 1)])
    assert collapse(scene) == pytest.approx(THICKNESS * 1e6 * (1 - 2 * eccentricity), rel=NARROW)


@pytest.mark.parametrize("strength", [2e5, 1e6])
def test_a_stack_crushes_at_its_foot(strength: float) -> None:
    """n blocks b × h: λ = (b − n W / (t f_c)) / (n h)."""
    n, height = 4, 0.5
    material = JointMaterial(2.0, compressive_strength=strength, cap_shear=0.0)
    scene = built([rectangle(0, k * height, 1, height) for k in range(n)], material)
    crushed = n * DENSITY * 9.81 * height / strength
    assert collapse(scene) == pytest.approx((1 - crushed) / (n * height), rel=NARROW)


@pytest.mark.parametrize(("factor", "status"), [(0.5, "infeasible"), (0.999, "infeasible"), (1.001, "collapse")])
@pytest.mark.parametrize("shear", [0.0, 9.0])
def test_a_column_too_heavy_for_its_foot_does_not_stand(factor: float, status: str, shear: float) -> None:
    strength = 2 * DENSITY * 9.81 * factor
    material = JointMaterial(0.6, compressive_strength=strength, cap_shear=shear)
    assert limit(built([rectangle(0, 0, 1, 1), rectangle(0, 1, 1, 1)], material)).status == status


def strut(material: JointMaterial) -> Scene:
    """Two weightless blocks 1 × 0.2 end to end between abutments, pressed down where they meet."""
    blocks = [rectangle(0, 0, 1, 0.2), rectangle(1, 0, 1, 0.2)]
    return built(
        blocks, material, PointLoad((1.0, 0.2), (0.0, -1.0)), [rectangle(-1, -1, 1, 3), rectangle(2, -1, 1, 3)]
    )


def test_a_strut_between_abutments_that_crush_is_a_plastic_arch() -> None:
    """P = t f_c h² / L: thrust t f_c h / 2 with the arm h / 2 over the span's half; without crushing it locks."""
    exact = THICKNESS * 1e6 * 0.2**2 / 2
    assert collapse(strut(JointMaterial(3.0, compressive_strength=1e6, cap_shear=0.0))) == pytest.approx(exact, rel=1e-6)
    assert limit(strut(JointMaterial(3.0))).status == "unbounded"


def test_joints_of_one_material_may_crush_beside_others_that_do_not() -> None:
    """The strut's abutments crush, its middle does not: T (h − T / (2 t f_c)) is largest at T = t f_c h."""
    whole = strut(JointMaterial(3.0, compressive_strength=1e6, cap_shear=0.0))
    middle = [bool((whole.joints.block[j] < 2).all()) for j in range(len(whole.joints))]
    scene = replace(
        whole,
        joint_materials=(whole.joint, JointMaterial(3.0, name="strong")),
        material_of_joint=np.array(middle, dtype=np.int64),
    )
    assert collapse(scene) == pytest.approx(THICKNESS * 1e6 * 0.2**2, rel=NARROW)
    state = limit_state(equilibrium(scene).with_crushing().under_live_load())
    assert max(value for name, value in state.measures.items() if name not in ("gap", "complementarity")) < 1e-9
