"""Rigid blocks on joints that crush and close: stress blocks, settlement in closed form, energy, listed forces."""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.rigid_system import contact_points, rigid_system
from dem.static import dem_static
from fem_interface.model import fem
from runningbond.dynamics import Criteria, Run, State, settle
from runningbond.joints import lobatto, wall_points, wall_rule
from runningbond.models import MODELS
from runningbond.pictures.mechanism import mechanism_frame
from runningbond.results import Outcome, Supports
from runningbond.scene import Scene, SceneError, scene_from_dict
from tests.walls import courses

STIFF = {"normal_stiffness": 1e9, "shear_stiffness": 4e8}
WIDTH, HEIGHT, WEIGHT = 0.4, 0.8, 1800 * 9.81 * 0.8  # m, m, Pa on the base


def block(**joint: object) -> Scene:
    """A block of 0.4 × 0.8 m, 0.12 m thick, on a base."""
    return courses([[1]], width=WIDTH, height=HEIGHT, joint={"friction": 5.0, **STIFF, **joint})


@pytest.mark.parametrize("points", [2, 3, 5, 9])
def test_block_topples_about_its_stress_block(points: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """M = N (l − x) / 2 with x = N / (t f_c): exact for the joint's points to the bracket, and converging with them."""
    monkeypatch.setattr(sys.modules[wall_rule.__module__], "BETWEEN", points)
    share = 0.2
    outcome = dem_dynamic(block(compressive_strength=WEIGHT / share, cap_shear=0.0), 5e-3)
    rule = lobatto(points)
    # The points at the toe carry the strength of their area, the last of them the rest.
    full = rule.weights / 2
    carried = np.minimum(full, np.maximum(0.0, share - (np.cumsum(full) - full)))
    at_points = -(carried @ rule.nodes) / share / 2 * WIDTH / (HEIGHT / 2)
    exact = (1 - share) * WIDTH / HEIGHT
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(at_points, rel=6e-3)
    assert abs(at_points / exact - 1) < {2: 0.3, 3: 0.2, 5: 0.08, 9: 0.03}[points]


def test_block_settles_by_joint_closure() -> None:
    """Under its weight p by ln(1 + g p / k_n) / g, which is less than p / k_n."""
    growth = 1e5
    scene = block(closure={"growth": growth, "stiffest": 1e11})
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=1.0)) == "stable"
    opening, _, normal, _ = run.tractions(state)
    exact = np.log1p(growth * WEIGHT / 1e9) / growth
    assert exact < 0.7 * WEIGHT / 1e9
    assert -opening == pytest.approx(exact, rel=1e-3)
    assert -normal == pytest.approx(WEIGHT, rel=1e-3)


@pytest.mark.parametrize(
    "joint",
    [
        {"compressive_strength": 3 * WEIGHT},
        {"compressive_strength": 3 * WEIGHT, "closure": {"growth": 1e5, "stiffest": 1e10}},
        {"compressive_strength": 3 * WEIGHT, "compressive_fracture_energy": 50.0, "peak_closure": 1e-4},
        {"compressive_strength": 3 * WEIGHT, "cohesion": 1e4, "fracture_energy_1": 0.2, "fracture_energy_2": 0.5},
    ],
    ids=["plastic", "closing", "softening", "glued"],
)
def test_energy_balance_closes_while_toe_crushes(joint: dict[str, object]) -> None:
    """Work of the loads = kinetic + stored + dissipated + damped, to 1 %, while a toe crushes.

    The load is applied suddenly: a quarter of the safe step, because the energy error is of first order in the step.
    """
    system = rigid_system(block(**joint))
    run = Run(system, dt=Run(system).safe_step / 4)
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=1.0)) == "stable"
    crushed, spent = run.interface.law.law.row("crushed"), 0.0
    for k in range(20):
        run.hold(state, 0.35 if "cohesion" not in joint else 0.6, 800 + k)
        ledger = run.ledger(state)
        assert ledger.friction >= spent
        spent = ledger.friction
        assert run.unaccounted(state) < 0.01
    assert state.history[crushed].max() > 0
    assert spent > 0


def test_forces_are_listed_at_points_along_each_joint() -> None:
    """Nine per joint, joint by joint along its tangent: resultants, reactions and pictures are those of the whole."""
    scene = courses([[1, 1], [0.5, 1, 0.5]], joint={"friction": 0.6, **STIFF, "compressive_strength": 1e7})
    rule, outcome = wall_rule(scene), dem_dynamic(scene)
    points = wall_points(scene, rule)
    order = contact_points(scene)
    count = len(rule.nodes)
    assert count == 9
    assert len(order) == len(points) == len(outcome.force) == count * len(scene.joints)
    sorted_ = order.part(np.argsort(order.joint, kind="stable"))
    assert np.array_equal(sorted_.position, points.position)
    assert sorted_.area == pytest.approx(points.area)
    on_ground = scene.fixed[points.block].any(axis=1)
    normal, tangential = outcome.force[on_ground].T
    weight = 9.81 * scene.mass[scene.wall].sum()
    assert -normal.sum() == pytest.approx(weight, rel=1e-3)
    assert outcome.lower is not None
    assert abs(tangential.sum()) == pytest.approx(outcome.lower * weight, rel=5e-3)
    reaction = Supports(scene, points).reactions(outcome.force, np.zeros(0), outcome.lower)
    assert reaction[1] == pytest.approx(weight, rel=1e-3)
    frame = mechanism_frame(scene, outcome)
    assert frame is not None
    ends = np.isin(np.arange(len(points)) % count, [0, count - 1])
    assert frame.normal == pytest.approx((outcome.force[:, 0] / points.area)[ends])
    plain = dem_dynamic(courses([[1, 1], [0.5, 1, 0.5]], joint={"friction": 0.6, **STIFF}))
    assert outcome.multiplier == pytest.approx(plain.multiplier, rel=0.02)


def test_deformable_blocks_crush_as_rigid_blocks() -> None:
    """Stiff blocks of triangles: nine points on each joint element, half the base long, against the stress block."""
    joint = {"compressive_strength": 5 * WEIGHT, "cap_shear": 0.0}
    outcome = fem(block(**joint).with_block(young=1e12), 5e-3)
    exact = 0.8 * WIDTH / HEIGHT
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(exact, rel=0.08)


@pytest.mark.parametrize("key", ["compressive_strength", "closure"])
def test_models_use_crushing_and_closure_or_report_that_they_do_not(key: str) -> None:
    scene = block(**{key: 1e6 if key == "compressive_strength" else {"growth": 1e5, "stiffest": 1e11}})
    assert not [name for name in MODELS["dem-dynamic"].unread(scene) if name.startswith("joint.")]
    assert not [name for name in MODELS["fem"].unread(scene) if name.startswith("joint.")]
    assert f"joint.{key}" in MODELS["homog"].unread(scene)
    with pytest.raises(SceneError, match=rf"^joint\.{key}: is not supported by dem-static"):
        dem_static(scene)


def test_joint_too_weak_for_weight_is_infeasible() -> None:
    outcome = dem_dynamic(block(compressive_strength=0.9 * WEIGHT))
    assert isinstance(outcome, Outcome)
    assert outcome.status == "infeasible"


def prism(courses: int, strength: float, stiffness: float, **load: Any) -> Scene:
    """A stack of blocks with crushing joints, under a load at the middle of the top."""
    push = {"kind": "point", "at": [0.2, 0.2 * courses], "force": [0, -1]}
    joint = {"friction": 0.7, "normal_stiffness": stiffness, "shear_stiffness": 0.4 * stiffness}
    wall = {"courses": [[1]] * courses, "block_width": 0.4, "block_height": 0.2, "thickness": 0.1}
    return scene_from_dict(
        {
            "wall": wall,
            "block": {"density": 2000.0, "young": 1e12, "poisson": 0.2},
            "joint": joint | {"compressive_strength": strength},
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "live": push} | load,
        }
    )


@pytest.mark.parametrize("solve", [dem_dynamic, fem])
@pytest.mark.parametrize(
    ("courses", "strength", "stiffness", "gravity"),
    [(4, 5e6, 1e9, 9.81), (1, 5e6, 4e8, 9.81), (1, 5e6, 1e10, 0.0), (1, 5e6, 1e10, 0.01)],
)
def test_column_crushes_at_its_strength_for_any_stiffness_and_weight(
    solve: Callable[..., Outcome], courses: int, strength: float, stiffness: float, gravity: float
) -> None:
    """At f A less the weight on the lowest joint; such walls were reported as locking, as if joints could not crush."""
    scene = prism(courses, strength, stiffness, gravity=gravity)
    exact = strength * 0.4 * 0.1 - courses * 0.4 * 0.2 * 0.1 * 2000.0 * gravity
    found = solve(scene, 0.02)
    assert found.status == "collapse"
    assert found.lower is not None
    assert found.upper is not None
    assert found.lower <= exact * 1.001
    assert exact <= found.upper * 1.001
