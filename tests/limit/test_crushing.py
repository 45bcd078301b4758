"""Joints of finite compressive strength: strength domain of one joint, and walls by hand and by fibre models."""

import copy
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import clarabel
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.sparse import csc_matrix, eye_array, hstack, vstack

from runningbond.compare.published import published_scene
from runningbond.limit import crushed, equilibrium, limit, limit_state
from runningbond.limit.associated import INTERRUPTED
from runningbond.limit.crushed import InnerProgram, Resultants, first_resultants
from runningbond.limit.crushing import Crushing, _boundary
from runningbond.limit.interior_point import InteriorPoint, interior_point
from runningbond.limit.kinematics import dead_load, live_load, movable_freedoms
from runningbond.limit.proved import is_large
from runningbond.models import run_model
from runningbond.results import save_outcome
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
from tests.checker import check
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
    "its cone met by the cap in tension": JointMaterial(0.6, 0.4, 0.2, compressive_strength=1.0),
}
EACH_MATERIAL = pytest.mark.parametrize("name", MATERIALS)


def joint(name: str, n: int = 1) -> Crushing:
    """Joints of a material, each of unit area."""
    material = MATERIALS[name]
    strength, shear = np.full(n, material.compressive_strength), np.full(n, material.cap_shear)
    least = material.cohesion - material.friction * material.tension
    slope, tension, held = (np.full(n, part) for part in (material.friction, material.tension, least))
    return Crushing(np.arange(n), strength, shear, *_boundary(slope, tension, held, strength, shear))


def jumps(seed: int, n: int) -> Array:
    """Directions of jumps ``(3, n)``, with components that differ by up to three orders of magnitude."""
    random = np.random.default_rng(seed)
    return np.asarray(random.normal(size=(3, n)) * 10 ** random.uniform(-3, 0, (3, n)))


# --- strength domain of one joint ----------------------------------------------------------------------------


def fibres(friction: float, cohesion: float, tension: float, strength: float, shear: float, n: int) -> tuple[Any, ...]:
    """Clarabel's rows A x + s = b and cones of tractions (σ, τ) and pressures p ≥ −σ, p ≥ 0 on n fibres, n of each.

    Strengths may have any magnitude.
    """
    one, zero = eye_array(n), 0 * eye_array(n)
    cone = vstack(
        [
            hstack([friction * one, one, zero]),
            hstack([friction * one, -one, zero]),
            hstack([one, zero, zero]),
            hstack([-one, zero, -one]),
            hstack([zero, zero, -one]),
        ]
    )
    ellipse = vstack(
        [hstack([zero, zero, zero]), hstack([zero, zero, -one]), hstack([zero, -math.sqrt(shear) * one, zero])]
    )
    order = np.arange(3 * n).reshape(3, n).T.ravel()
    right = np.concatenate([np.full(2 * n, cohesion), np.full(n, tension), np.zeros(2 * n)])
    cap = np.tile([strength, 0.0, 0.0], n)
    return cone, ellipse.tocsr()[order], right, cap


def largest(cost: Array, equal: Any, given: Array, cone: Any, ellipse: Any, right: Array, cap: Array) -> float:
    """Largest cost · x, found by Clarabel."""
    rows = vstack([equal, cone, ellipse], format="csc") if len(given) else vstack([cone, ellipse], format="csc")
    cones = [clarabel.ZeroConeT(len(given))] if len(given) else []
    cones += [clarabel.NonnegativeConeT(len(right)), *[clarabel.SecondOrderConeT(3)] * (len(cap) // 3)]
    set_ = clarabel.DefaultSettings()
    set_.verbose, set_.tol_gap_rel, set_.tol_gap_abs, set_.tol_feas = False, 1e-10, 1e-12, 1e-10
    nothing = csc_matrix((len(cost), len(cost)))
    every = np.concatenate([given, right, cap])
    return -float(clarabel.DefaultSolver(nothing, -cost, csc_matrix(rows), every, cones, set_).solve().obj_val)


@EACH_MATERIAL
def test_joint_dissipation_matches_400_fibres(name: str) -> None:
    """In any direction, up to the discretisation error (f_t + f_m) |α₂ − α₁| / (8 n²) of n fibres."""
    material, one, n = MATERIALS[name], joint(name), 400
    at = (np.arange(n) + 0.5) / n
    program = fibres(material.friction, material.cohesion, material.tension, 1.0, material.cap_shear, n)
    for first, second, slip in jumps(1, 6).T:
        cost = np.concatenate([first * (1 - at) + second * at, np.full(n, slip), np.zeros(n)]) / n
        found = largest(cost, None, np.zeros(0), *program)
        exact = one.dissipation(np.array([[first], [second], [slip]]))[0]
        size = max(abs(first), abs(second), abs(slip))
        left = (material.tension + 1.0) * abs(second - first) / (8 * n**2)
        assert -1e-8 * size <= exact - found <= left + 1e-8 * size


@EACH_MATERIAL
def test_joint_forces_are_gradient_of_dissipation(name: str) -> None:
    for direction in jumps(2, 20).T:
        if np.abs(direction[2]) > 1e-2 * np.abs(direction).max():  # for smaller slips it nearly has a kink
            step = 1e-6 * np.abs(direction).max()
            changed = direction[:, None] + step * np.hstack([np.eye(3), -np.eye(3)])
            up, down = joint(name, 6).dissipation(changed).reshape(2, 3)
            assert joint(name).forces(direction[:, None])[:, 0] == pytest.approx((up - down) / (2 * step), abs=1e-4)


@EACH_MATERIAL
def test_joint_forces_are_admissible_in_all_directions(name: str) -> None:
    directions = jumps(3, 300)
    forces = np.hstack([joint(name, 300).forces(directions), joint(name).blocks(4.0 ** -np.arange(8.0))])
    beyond = forces.T @ directions - joint(name, 300).dissipation(directions)
    assert (beyond <= 1e-12 * np.abs(directions).max(axis=0)).all()


@pytest.mark.parametrize("name", ["dry", "cohesive", "capped all round"])
@pytest.mark.parametrize("slip", [0.0, 1e-12, 1e-3, 1.0])
def test_joint_dissipation_is_continuous_and_homogeneous(name: str, slip: float) -> None:
    """Continuous between closed forms and quadrature, and for nearly equal openings; homogeneous, and even in slip."""
    one = joint(name)
    for tilt in 10.0 ** -np.arange(0.0, 17.0, 0.5):
        direction = np.array([[-0.3], [-0.3 + tilt], [slip]])
        level = np.array([[-0.3 + tilt / 2]] * 2 + [[slip]])
        value, beside = one.dissipation(direction)[0], one.dissipation(level)[0]
        assert -1e-14 <= value - beside <= tilt**2 / 2 + 1e-14
        other = 1e7 * direction[[1, 0, 2]] * [[1], [1], [-1]]
        assert one.dissipation(other)[0] == pytest.approx(1e7 * value, rel=1e-12)


@given(share=st.floats(1e-4, 1.0))
@settings(max_examples=20)
def test_dry_joint_with_shear_free_cap_is_stress_block(share: float) -> None:
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
    """Blocks on a flat base, or weightless blocks between given grounds."""
    more: dict[str, Any] = {"grounds": grounds} if grounds else {}
    load = Load((0.0, 0.0 if grounds else -9.81), (live or Lateral(),))
    block = BlockMaterial(DENSITY)
    return build_scene("by hand", blocks, thickness=THICKNESS, block=block, joint=crushing, load=load, **more)


def collapse(scene: Scene) -> float:
    """λ of a scene, whose bracket must be narrow."""
    outcome = limit(scene)
    assert outcome.status == "collapse", outcome.message
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.multiplier == outcome.lower
    assert outcome.upper - outcome.lower <= NARROW * abs(outcome.upper)
    return outcome.lower


@pytest.mark.parametrize(("share", "height"), [(0.9, 1.0), (0.3, 2.5), (0.01, 1.0), (1e-4, 2.5), (1e-8, 1.0)])
def test_toe_of_block_on_crushing_ground(share: float, height: float) -> None:
    """N crushes this share of the base. Pushed at its top: V H = N (l/2 − N / (2 t f_c)), turning about N / (t f_c)."""
    weight = DENSITY * 9.81 * THICKNESS * height
    material = JointMaterial(5.0, compressive_strength=weight / (share * THICKNESS), cap_shear=0.0)
    scene = built([rectangle(0, 0, 1, height)], material, PointLoad((0.0, height), (1.0, 0.0)))
    assert collapse(scene) == pytest.approx(weight * (1 - share) / (2 * height), rel=NARROW)
    outcome = limit(scene)
    if share > 1e-3:
        assert f"inside them: 1, foremost about ({1 - share:.3g}"[:-1] in outcome.message
    corner = outcome.motion[0] @ [[1, 0], [0, 1], [height / 2, 1 / 2]]  # the toe moves down, not sideways
    assert -corner[1] == pytest.approx(share / (1 - share) * (corner[1] + outcome.motion[0] @ [0, 0, -1]), abs=1e-3)


@pytest.mark.parametrize("share", [0.3, 0.01])
def test_block_of_low_friction_slides_on_crushing_ground(share: float) -> None:
    """V = N tan φ, whether its ground crushes or not."""
    weight = DENSITY * 9.81 * THICKNESS
    material = JointMaterial(0.1, compressive_strength=weight / (share * THICKNESS), cap_shear=0.0)
    assert collapse(built([rectangle(0, 0, 1, 1)], material)) == pytest.approx(0.1, rel=NARROW)


@pytest.mark.parametrize("eccentricity", [0.0, 0.1, 0.3, 0.45])
@pytest.mark.parametrize("shear", [0.0, 9.0])
def test_eccentric_column_carries_stress_block(eccentricity: float, shear: float) -> None:
    """P = t f_c (l − 2 e) for a weightless column."""
    material = JointMaterial(0.6, compressive_strength=1e6, cap_shear=shear)
    live = PointLoad((0.5 + eccentricity, 2.0), (0.0, -1.0))
    scene = built([rectangle(0, 0, 1, 2)], material, live, [rectangle(0, -1, 1, 1)])
    assert collapse(scene) == pytest.approx(THICKNESS * 1e6 * (1 - 2 * eccentricity), rel=NARROW)


@pytest.mark.parametrize("hundredths", range(20))
def test_heavy_column_carries_stress_block(hundredths: int) -> None:
    """Smallest of the loads of two blocks' beds, each from N = t f_c (l − 2 M / N), N with the weight above the bed.

    Some of these cases were `failed`: few resultants are in use, and the metric of their repair is singular.
    """
    strength, length, height, away = 5e6, 0.4, 0.2, hundredths / 100
    material = JointMaterial(0.7, compressive_strength=strength, cap_shear=0.0)
    live = PointLoad((length / 2 + away, 2 * height), (0.0, -1.0))
    scene = built([rectangle(0, k * height, length, height) for k in range(2)], material, live)

    def beyond(load: float, weight: float) -> float:
        total = load + weight
        return total - THICKNESS * strength * (length - 2 * load * away / total)

    weights = [k * DENSITY * 9.81 * THICKNESS * length * height for k in (1, 2)]
    exact = min(float(brentq(beyond, 1.0, 1e6, args=(weight,))) for weight in weights)
    assert collapse(scene) == pytest.approx(exact, rel=NARROW)


@pytest.mark.parametrize("strength", [2e5, 1e6])
def test_stack_crushes_at_its_foot(strength: float) -> None:
    """n blocks b × h: λ = (b − n W / (t f_c)) / (n h)."""
    n, height = 3, 0.5
    material = JointMaterial(2.0, compressive_strength=strength, cap_shear=0.0)
    scene = built([rectangle(0, k * height, 1, height) for k in range(n)], material)
    crushed = n * DENSITY * 9.81 * height / strength
    assert collapse(scene) == pytest.approx((1 - crushed) / (n * height), rel=NARROW)


@pytest.mark.parametrize(("factor", "status"), [(0.5, "infeasible"), (0.999, "infeasible"), (1.001, "collapse")])
@pytest.mark.parametrize("shear", [0.0, 9.0])
def test_column_stands_up_to_strength_of_its_foot(factor: float, status: str, shear: float) -> None:
    strength = 2 * DENSITY * 9.81 * factor
    material = JointMaterial(0.6, compressive_strength=strength, cap_shear=shear)
    assert limit(built([rectangle(0, 0, 1, 1), rectangle(0, 1, 1, 1)], material)).status == status


def strut(material: JointMaterial) -> Scene:
    """Two weightless blocks 1 × 0.2 end to end between abutments, pressed down where they meet."""
    blocks = [rectangle(0, 0, 1, 0.2), rectangle(1, 0, 1, 0.2)]
    return built(
        blocks, material, PointLoad((1.0, 0.2), (0.0, -1.0)), [rectangle(-1, -1, 1, 3), rectangle(2, -1, 1, 3)]
    )


def test_strut_between_crushing_abutments_is_plastic_arch() -> None:
    """P = t f_c h² / L: thrust t f_c h / 2 with arm h / 2 over half the span; without crushing the strut locks."""
    exact = THICKNESS * 1e6 * 0.2**2 / 2
    material = JointMaterial(3.0, compressive_strength=1e6, cap_shear=0.0)
    assert collapse(strut(material)) == pytest.approx(exact, rel=1e-6)
    assert limit(strut(JointMaterial(3.0))).status == "unbounded"


def test_crushing_and_strong_joints_in_one_wall() -> None:
    """The strut's abutments crush, its middle joint does not: T (h − T / (2 t f_c)) is largest at T = t f_c h."""
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


@pytest.mark.parametrize(
    ("gravity", "live", "tension"), [(0.0, [0, 9.81], 6e3), (0.0, [0, 9.81], None), ([0, 4.0], [9.81, 0], 6e3)]
)
def test_compressive_cap_does_not_limit_tension(gravity: Any, live: list[float], tension: float | None) -> None:
    """A joint stronger in tension than in compression is pulled apart at f_t A. Sheared, it agrees with `dem-dynamic`.

    If not given, f_t is c / tan φ, which easily exceeds f_m of a weak stone.
    """
    cut = {} if tension is None else {"tensile_strength": tension}
    strengths = {"friction": 0.6, "cohesion": 8e3, "compressive_strength": 4e3, **cut}
    tables = {
        "wall": {"block_width": 0.2, "block_height": 0.2, "thickness": 0.1, "courses": [[1]]},
        "block": {"density": 2000.0},
        "joint": {**strengths, "normal_stiffness": 1e9, "shear_stiffness": 4e8},
        "support": {"kind": "base"},
        "load": {"gravity": gravity, "live": {"kind": "body", "acceleration": live}},
    }
    scene = scene_from_dict(tables)
    moved = run_model("dem-dynamic", scene)
    assert moved.lower is not None
    assert moved.upper is not None
    assert moved.lower <= collapse(scene) <= moved.upper
    if live[1]:
        assert collapse(scene) == pytest.approx((tension or 8e3 / 0.6) * 0.02 / (8 * 9.81), rel=NARROW)


# --- walls by fibres -----------------------------------------------------------------------------------------


def fibre_load(scene: Scene, n: int) -> float:
    """Largest λ balanced by tractions on n fibres of each joint, from independent equilibrium equations."""
    joints, free = scene.joints, movable_freedoms(scene)
    start, run = joints.ends[:, 0], joints.ends[:, 1] - joints.ends[:, 0]
    tangent = run / joints.length[:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    at = start[:, None] + (np.arange(n) + 0.5)[None, :, None] / n * run[:, None]
    count = len(joints) * n
    columns = np.zeros((3 * len(scene.blocks), 3 * count + 1))  # σ, τ, p (without resultant), λ
    pull = np.stack([np.repeat(part, n, axis=0) for part in (normal, tangent)])  # on block a, opposite on b
    for side, sense in ((0, 1.0), (1, -1.0)):
        block = np.repeat(joints.block[:, side], n)
        arm = at.reshape(-1, 2) - scene.blocks.centroid[block]
        for kind in range(2):
            force = sense * pull[kind] * np.repeat(joints.length * scene.thickness / n, n)[:, None]
            moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
            for row, part in enumerate((force[:, 0], force[:, 1], moment)):
                np.add.at(columns, (3 * block + row, kind * count + np.arange(count)), part)
    dead, live = dead_load(scene)[free], live_load(scene)[free]
    unit, strength = np.abs(dead).max() or 1.0, scene.joint.compressive_strength or math.nan
    columns[free, -1] = live
    columns[:, :-1] *= strength / unit
    columns[:, -1] /= unit
    joint = scene.joint
    program = fibres(joint.friction, joint.cohesion / strength, joint.tension / strength, 1.0, joint.cap_shear, count)
    cone, ellipse = (csc_matrix(hstack([part, csc_matrix((part.shape[0], 1))])) for part in program[:2])
    cost = np.append(np.zeros(3 * count), 1.0)
    return largest(cost, csc_matrix(columns[free]), -dead / unit, cone, ellipse, *program[2:])


@pytest.mark.parametrize("shear", [0.0, 9.0])
@pytest.mark.parametrize(
    ("strength", "friction", "cohesion"), [(3e5, 0.7, 0.0), (2e4, 0.7, 0.0), (3e4, 0.5, 3e3), (2e4, 0.2, 0.0)]
)
def test_bracket_contains_load_of_fibre_model(shear: float, strength: float, friction: float, cohesion: float) -> None:
    """Five blocks with 60 fibres per joint: their load is below the upper bound, at most 0.1 % below the lower."""
    scene = courses(
        [[0.5, 0.5], [1], [0.5, 0.5]],
        joint={
            "friction": friction,
            "cohesion": cohesion,
            "tensile_strength": cohesion / 4,
            "compressive_strength": strength,
            "cap_shear": shear,
        },
    )
    outcome, found = limit(scene), fibre_load(scene, 60)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.upper - outcome.lower <= NARROW * outcome.upper
    assert (1 - 1e-3) * outcome.lower <= found <= outcome.upper * (1 + 1e-7)
    assert fibre_load(scene, 20) <= found * (1 + 1e-7)


def test_course_crushes_on_whole_bed() -> None:
    """Under growing weight, beside a tie without force: λ = f_m / (ρ g h) − 1 for both bounds."""
    strength, height = 203504.49175942724, 2.655326128687889
    size = {"block_width": 2 * height, "block_height": height, "thickness": 6.638}
    dry = {"friction": 0.3, "cohesion": 13094.0, "tensile_strength": 43646.0}
    tie = {"from": [14.8917, 1.93376], "to": [-15.932, 1.02681], "area": 0.017627, "young": 2e11, "yield": 1.43e7}
    content = {
        "title": "a course",
        "wall": {**size, "courses": [[0.5, 0.5, 0.37, 0.8, 0.83]]},
        "block": {"density": 2400.0},
        "joint": {**dry, "compressive_strength": strength, "cap_shear": 9.0},
        "support": {"kind": "base"},
        "load": {"gravity": [0.0, -1.6], "live": {"kind": "lateral", "direction": [0.0, -1.0]}},
        "tie": [tie],
    }
    outcome, exact = limit(scene_from_dict(content)), strength / (2400.0 * 1.6 * height) - 1
    assert outcome.status == "collapse", outcome.message
    assert outcome.lower == pytest.approx(exact, rel=NARROW)
    assert outcome.upper == pytest.approx(exact, rel=NARROW)


def test_inner_polyhedron_converges_to_strength_domain() -> None:
    """Lower bounds rise as resultants are added, and never exceed the upper bounds."""
    system = equilibrium(panel(joint__compressive_strength=3e4, wall__height=0.36)).with_crushing()
    joints = system.crushing
    assert joints is not None
    known, bounds = first_resultants(joints), []
    for _ in range(6):
        found = InnerProgram(system, joints, known).vertex()
        bounds.append((found.multiplier, system.kinematic_multiplier(found.motion)))
        known = known.nearer(joints, system.crushed_jumps(found.motion))
    lower, upper = np.array(bounds).T
    assert (np.diff(lower) >= -1e-9).all()
    assert lower.max() <= upper.min() + 1e-9
    assert upper[-1] - lower[-1] < (upper[0] - lower[0]) / 5


# --- what must not change ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "strength"), [("panel-01", 1e6), ("wall-w1", 3e10)])
def test_huge_compressive_strength_changes_nothing(name: str, strength: float) -> None:
    """To 1e-6. A strength far above all forces is left out, and the message states that."""
    scene = published_scene(name)
    exact, found, beyond = (limit(scene.with_joint(compressive_strength=f)) for f in (None, strength, 1e15))
    assert found.lower == pytest.approx(exact.lower, rel=1e-6)
    assert found.upper == pytest.approx(exact.upper, rel=1e-6)
    assert (beyond.lower, beyond.upper) == (exact.lower, exact.upper)
    assert "are taken not to crush" in beyond.message
    assert "crush" not in exact.message


def test_load_grows_with_compressive_strength() -> None:
    """Random walls with all keys; the load without crushing is the largest."""
    found = 0
    for seed in range(8):
        content = random_scene(seed)
        exact = limit(scene_from_dict(content))
        if exact.status != "collapse" or scene_from_dict(content).settlement is not None:
            continue
        tables = [content["joint"], *content.get("joints", {}).values()]
        loads = []
        for strength in (1e5, 4e5, 1e7):
            for table in tables:
                table["compressive_strength"] = strength
            outcome = limit(scene_from_dict(content))
            assert outcome.status in ("collapse", "infeasible"), outcome.message
            if outcome.lower is not None and outcome.upper is not None:
                loads += [outcome.lower, outcome.upper]
        unit = abs(exact.upper or 0.0)
        assert (np.diff([*loads, exact.upper]) >= -1e-6 * unit - 1e-9).all()
        found += len(loads) > 2
    assert found > 1


@pytest.mark.parametrize("seed", range(101, 105))
def test_mirrored_crushing_wall_has_same_load(seed: int) -> None:
    content = random_scene(seed)
    if content["support"]["kind"] == "corners":
        content["support"]["kind"] = "pinned-corners"
    content["assign"] = [entry for entry in content.get("assign", []) if "blocks" not in entry]
    content["joint"]["compressive_strength"] = 2e5
    one, two = (limit(scene_from_dict(tables)) for tables in (content, mirrored(copy.deepcopy(content))))
    assert one.status == two.status
    if one.multiplier is not None:
        assert one.multiplier == pytest.approx(two.multiplier, rel=2e-6, abs=1e-7)


# --- crushing with other features ----------------------------------------------------------------------------

TIE = {"from": [0.03, 0.33], "to": [-1.0, 0.1], "area": 1e-4, "young": 2e11, "yield": 30.0}
BEAM = {"height": 0.1, "force": [0, -2e3], "drive": {"force": [1, 0]}}
SINKS = {"kind": "settlement", "box": [[0.75, -1], [4, 0.01]], "by": [0.0, -0.01]}
WALLS: dict[str, dict[str, Any]] = {
    "dry": {"joint__friction": 1.2},
    "cohesive and tied": {"tie": [TIE], "joint__cohesion": 2e3, "joint__tensile_strength": 1e3},
    "level beam": {"beam": BEAM | {"condition": "level"}},
    "beam at its height": {"beam": BEAM | {"condition": "fixed-height"}},
    "sinking": {"load__live": SINKS},
    "pinned corners": {"support__kind": "pinned-corners", "joint__cohesion": 1e4},
    "inset": {"joint__inset": 0.01, "joint__cap_shear": 0.0},
    "capped all round": {"joint__cohesion": 3e4, "joint__tensile_strength": 1e4, "wall__height": 0.24},
}


def crushing_panel(name: str) -> Scene:
    """A panel 0.96 m × 0.36 m."""
    size = {"wall__length": 0.96, "wall__height": 0.36, "joint__compressive_strength": 4e4}
    return panel(**{**size, **WALLS[name]})


@pytest.mark.parametrize("name", WALLS)
def test_checker_proves_forces_and_mechanism(name: str, tmp_path: Path) -> None:
    """With the checker's own tractions and equations."""
    scene = crushing_panel(name)
    outcome = run_model("limit", scene)
    assert outcome.status == "collapse", outcome.message
    assert "not taken into account" not in outcome.message
    save_outcome(outcome, tmp_path, "", scene)
    assert check(tmp_path)


@pytest.mark.parametrize("array", ["force", "motion", "multiplier"])
def test_checker_rejects_wrong_crushing_results(array: str, tmp_path: Path) -> None:
    """Forces for joints 10 % weaker; horizontal motions 0.1 % too large; multipliers 0.1 % too large."""
    scene = crushing_panel("dry")
    weaker = scene.with_joint(compressive_strength=0.9 * 4e4)
    outcome = limit(scene)
    if array == "force":
        save_outcome(outcome, tmp_path, "", weaker)
    elif array == "motion":
        save_outcome(replace(outcome, motion=outcome.motion * [1.001, 1, 1]), tmp_path, "", scene)
    else:
        changed = {bound: 1.001 * getattr(outcome, bound) for bound in ("lower", "multiplier", "upper")}
        save_outcome(replace(outcome, **changed), tmp_path, "", scene)
    assert not check(tmp_path)


def test_unloaded_joints_carry_no_shear() -> None:
    """Without weight most joints are unloaded: rounding errors in tension were divided by a pressure of almost zero."""
    system = equilibrium(courses([[1, 1], [0.5, 1, 0.5]], joint={"friction": 0.7, "compressive_strength": 1e5}))
    system = system.with_crushing()
    assert system.crushing is not None
    program = InnerProgram(system, system.crushing, first_resultants(system.crushing))
    rounding = 1e-16 * np.random.default_rng(1).normal(size=len(program.arguments()["c"]))
    forces = program.solution("optimal", rounding, np.zeros(system.freedoms), 0)
    assert abs(forces.pressure).max() < 1e-12
    assert abs(forces.tangential).max() < 1e-12


def test_end_forces_of_crushing_joints_obey_coulomb() -> None:
    scene = crushing_panel("cohesive and tied")
    system, force = equilibrium(scene), limit(scene).force / equilibrium(scene).force_unit
    assert system.strength.violation(*force.T).max() < 1e-9 * np.abs(force).max()


def test_nonassociated_analysis_refuses_crushing() -> None:
    """Its certificates neglect crushing, and would prove loads that such a wall cannot carry."""
    scene = courses([[1], [1]], joint__compressive_strength=2e4)
    without = run_model("limit-nonassociated", scene.with_joint(compressive_strength=None))
    assert without.lower is not None
    assert collapse(scene) < 0.9 * without.lower
    with pytest.raises(
        SceneError, match="joint.compressive_strength = 20000.0: is not supported by limit-nonassociated"
    ):
        run_model("limit-nonassociated", scene)


def test_repaired_interior_point_brackets_large_crushing_wall() -> None:
    """204 blocks that slide at tan φ = 0.6, whether joints crush or not."""
    scene = panel(wall__length=2.16, wall__height=1.32, joint__compressive_strength=5e5)
    assert is_large(equilibrium(scene))
    outcome = limit(scene)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= 0.6 * (1 + 1e-9)
    assert outcome.upper >= 0.6 * (1 - 1e-9)
    assert outcome.upper - outcome.lower <= 1e-4 * 0.6


@pytest.mark.parametrize("when", [1, 2, 8])
def test_ctrl_c_keeps_bracket_of_last_program(monkeypatch: pytest.MonkeyPatch, when: int) -> None:
    """After the first program, known forces and a mechanism prove bounds on the load."""
    material = JointMaterial(0.65, compressive_strength=2e5)
    blocks = [rectangle(x, 0.5 * k, 1.0, 0.5) for k in range(4) for x in (0.0, 1.0)]
    scene = built(blocks, material)
    exact, programs = collapse(scene), [0]

    def solve(program: dict[str, Any], tolerance: float) -> InteriorPoint:
        programs[0] += bool(np.any(program["c"]))  # programs of rest have no cost
        if programs[0] == when:
            programs[0] += 1000  # the following programs run to their end
            raise KeyboardInterrupt
        return interior_point(program, tolerance)

    monkeypatch.setattr(crushed, "interior_point", solve)
    outcome = limit(scene)
    assert outcome.status == "undecided"
    assert outcome.message.startswith(INTERRUPTED)
    if when == 1:
        assert outcome.lower == 0.0
        return
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert 0.0 < outcome.lower <= exact * (1 + NARROW)
    assert outcome.upper >= exact * (1 - NARROW)
    assert outcome.upper - outcome.lower < {2: 2.0, 8: 0.01}[when] * exact
    assert len(outcome.motion)


def test_ctrl_c_between_programs_keeps_bracket_of_last_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """While resultants are sought on mechanisms of the second program, whose forces and mechanism are known."""
    blocks = [rectangle(x, 0.5 * k, 1.0, 0.5) for k in range(4) for x in (0.0, 1.0)]
    scene = built(blocks, JointMaterial(0.65, compressive_strength=2e5))
    exact, nearer, searches = collapse(scene), Resultants.nearer, [0]

    def seek(known: Resultants, joints: Crushing, jumps: Array) -> Resultants:
        searches[0] += 1
        if searches[0] == 3:
            raise KeyboardInterrupt
        return nearer(known, joints, jumps)

    monkeypatch.setattr(Resultants, "nearer", seek)
    outcome = limit(scene)
    assert (outcome.status, outcome.message[: len(INTERRUPTED)]) == ("undecided", INTERRUPTED)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert 0.0 < outcome.lower <= exact * (1 + NARROW)
    assert exact * (1 - NARROW) <= outcome.upper < 2 * exact


def test_strong_joints_need_few_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors of mechanisms kept brackets wide, so that all 60 programs were solved, none of them accurately."""
    found = list[InteriorPoint]()

    def solve(*arguments: Any) -> InteriorPoint:
        found.append(interior_point(*arguments))
        return found[-1]

    monkeypatch.setattr(crushed, "interior_point", solve)
    size = {"length": 0.48, "height": 0.54, "block_width": 0.24, "block_height": 0.06}
    wall = {f"wall__{key}": value for key, value in size.items()}
    outcome = limit(panel(joint__friction=0.3, joint__compressive_strength=8.09e7, **wall))
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.upper - outcome.lower < 1e-6 * outcome.upper
    assert len(found) < 25
