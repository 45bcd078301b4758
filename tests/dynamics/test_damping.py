"""Local and combined damping: vibration, drift, and a load that is held for many steps."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from runningbond.dynamics import Criteria, Run, State, settle
from runningbond.dynamics.run import MOVING
from runningbond.dynamics.update import Damping
from runningbond.limit import limit
from runningbond.scene import BlockMaterial, JointMaterial, Lateral, Load, Mortar, build_scene
from tests.at_length import at_length
from tests.dynamics.test_dynamics import oscillator

LOCAL = 0.5


def _run(damping: Damping, stiffness: float = 1.0, dt: float = 0.01) -> Run:
    system = replace(oscillator(), stiffness=np.array([stiffness]))
    return Run(system, local=LOCAL, viscous=0.0, dt=dt, damping=damping)


@pytest.mark.parametrize(("damping", "share"), [("local", 1 - LOCAL), ("combined", 1.0)])
def test_drift_under_constant_force_is_damped_by_local_damping_only(damping: Damping, share: float) -> None:
    run, steps = _run(damping, stiffness=0.0), 1000
    state = State.at_rest(run.system)
    run.bear(state, np.ones(1), steps)
    # The first step starts from rest, where there is no velocity to resist.
    assert state.velocity[0] == pytest.approx((1 + (steps - 1) * share) * run.dt, rel=1e-9)
    way = state.motion[0] - run.dt * (run.dt + state.velocity[0]) / 2  # trapezoidal rule, from the first step on
    assert state.damped[0] == pytest.approx((1 - share) * way, rel=1e-9)


def test_local_and_combined_damping_reduce_vibration_equally() -> None:
    """The spring force always changes against the velocity; α scales each half swing's energy by (1 − α) / (1 + α)."""
    swings = {}
    for damping in ("local", "combined"):
        run = _run(damping, dt=1e-4)
        state = State.at_rest(run.system)
        state.motion[0] = 1.0
        lowest = 0.0
        while state.velocity[0] <= 0.0:
            run.hold(state, 0.0, 1)
            lowest = min(lowest, state.motion[0])
        swings[damping] = lowest
    assert swings["combined"] == pytest.approx(swings["local"], rel=1e-6)
    # (1 − α) k over the first quarter and (1 + α) k over the second conserve energy: A² (1 − α) = B² (1 + α).
    assert swings["combined"] == pytest.approx(-math.sqrt((1 - LOCAL) / (1 + LOCAL)), rel=1e-3)


@pytest.mark.parametrize(("part", "grows"), [(0.98, False), (1.05, True)])
def test_combined_damping_has_same_stability_limit_as_local(part: float, grows: bool) -> None:
    run = _run("combined", dt=part * 2 / math.sqrt(1 + LOCAL))
    state = State.at_rest(run.system)
    state.motion[0] = 1e-3
    run.hold(state, 0.0, 20_000)
    assert (not abs(state.motion[0]) < 1.0) is grows


@pytest.mark.parametrize(("unit", "verdict"), [(0.4, "collapse"), (0.5, "undecided")])
def test_load_held_long_is_no_longer_locally_damped(unit: float, verdict: str) -> None:
    """A mass under a unit force moves .25 T² in T under local damping, and .44 T² if the last 7/8 of T are undamped.

    Collapse is a displacement of `unit` T², as the mass has no weight; local damping alone would leave .4 T² undecided.
    """
    steps = 8000
    run = _run("local", stiffness=0.0)
    run.system.live[:] = 1.0
    time = steps * run.dt
    criteria = Criteria(unit * time**2, budget=steps, interval=100, dragged=steps / 8, shortest=0)
    state = State.at_rest(run.system)
    assert settle(run, state, 1.0, criteria) == verdict
    if verdict == "undecided":
        free = 7 / 8
        exact = 0.25 * (1 - free) ** 2 + 0.5 * (1 - free) * free + 0.5 * free**2
        assert state.motion[0] == pytest.approx(exact * time**2, rel=1e-3)


@pytest.mark.parametrize("local", [0.5, MOVING, 0.1])
def test_load_held_long_is_damped_at_most_as_large_motion(local: float) -> None:
    """Combined damping of α scales each half swing by √((1 − α) / (1 + α)); it also brakes a drift with vibration."""
    run = Run(replace(oscillator(), stiffness=np.ones(1)), local=local, viscous=0.0, dt=1e-4).drifting
    state = State.at_rest(run.system)
    state.motion[0] = 1.0
    least = min(local, MOVING)
    # Towards its natural length the spring pulls with 1 − α of its force; away from it, it resists with 1 + α of it.
    half_swing = math.pi / 2 * (1 / math.sqrt(1 - least) + 1 / math.sqrt(1 + least))
    run.hold(state, 0.0, round(half_swing / run.dt))
    assert state.motion[0] == pytest.approx(-math.sqrt((1 - least) / (1 + least)), rel=1e-3)


@pytest.mark.parametrize("friction", [0.39, *at_length(0.4)])
def test_accelerating_arch_collapses_despite_damping(friction: float) -> None:
    """Twelve voussoirs under lateral load, whose collapse 0.5 % above the limit load takes more than 50 000 steps.

    Damping that resists drift with superposed vibration halved the speed, and the result was undecided.
    """
    angle = np.pi * (1 - np.arange(13) / 12)
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    voussoirs = [np.array([0.92 * b, 1.08 * b, 1.08 * a, 0.92 * a]) for a, b in pairwise(ray)]
    scene = build_scene(
        "arch",
        voussoirs,
        thickness=0.12,
        block=BlockMaterial(1800.0),
        joint=JointMaterial(friction, elasticity=Mortar(1e9, 0.2, 0.01)),
        load=Load((0.0, -9.81), (Lateral(),)),
        grounds=[np.array([[x, -0.3], [x + 0.16, -0.3], [x + 0.16, 0.0], [x, 0.0]]) for x in (-1.08, 0.92)],
    )
    exact, found = limit(scene).multiplier, dem_dynamic(scene)
    assert found.status == "collapse"
    assert exact is not None
    assert found.lower is not None
    assert found.upper is not None
    assert found.lower <= exact <= found.upper
