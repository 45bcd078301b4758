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
