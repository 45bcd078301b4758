"""The critical time step of a wall, the effect of damping on it, and runs beyond it."""

import math
from typing import Literal

import numpy as np
import pytest

from dem.rigid_system import contact_points, rigid_system
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.dynamics import BlockSystem, Criteria, Run, State, Unstable, collapse_by_steps, settle
from runningbond.dynamics.central_differences import LOOK
from runningbond.dynamics.vibrations import elastic_stiffness, vibrations
from runningbond.limit.kinematics import jump_operator
from runningbond.scene import Scene
from runningbond.studies.pushover import drive
from runningbond.studies.stability.time_step import (
    GROWTH,
    LOCAL,
    TIMES,
    VISCOUS,
    critical_step,
    growth_at,
    mass_row,
    run_beyond,
)
from runningbond.studies.walls import bonded
from tests.at_length import at_length
from tests.walls import courses, panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}


def small() -> Scene:
    """Three courses of wall W1's blocks."""
    return courses([[0.5, 1, 0.5], [1, 1], [0.5, 1, 0.5]], joint__mortar=MORTAR, block__young=1e11)


# --- the critical step ---------------------------------------------------------------------------------------


def test_assembled_stiffness_equals_that_of_the_sparse_operators() -> None:
    """Jumps of the contact kernels against the operators of limit analysis."""
    scene = small()
    system, points = rigid_system(scene), contact_points(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    k_n, k_t = system.interface.law.normal_stiffness * points.area, system.interface.law.shear_stiffness * points.area
    expected = jump.opening.T @ (k_n[:, None] * jump.opening.toarray())
    expected += jump.slip.T @ (k_t[:, None] * jump.slip.toarray())
    column = np.argsort(system.rigid.ravel())[np.isfinite(system.mass)]
    result, _ = elastic_stiffness(system)
    assert np.abs(result - expected[np.ix_(column, column)]).max() < 1e-12 * np.abs(expected).max()


def test_vibrations_are_mass_normalised_and_have_the_discrete_frequency() -> None:
    """u_n = u cos(n θ) with sin(θ/2) = ω Δt / 2, in the highest and the lowest mode."""
    system = rigid_system(bonded(small()))
    frequencies, shapes = vibrations(system)
    moving = np.isfinite(system.mass)
    assert shapes[moving].T @ (system.mass[moving][:, None] * shapes[moving]) == pytest.approx(
        np.eye(len(frequencies)), abs=1e-9
    )
    for k in (0, -1):
        run = Run(system, local=0.0, viscous=0.0)
        theta = 2 * math.asin(frequencies[k] * run.dt / 2)
        state = State.at_rest(system)
        state.motion[:] = 1e-9 * shapes[:, k]
        state.velocity[:] = 1e-9 * shapes[:, k] * (1 - math.cos(theta)) / run.dt
        run.hold(state, 0.0, 100, dead=0.0)
        assert state.motion == pytest.approx(1e-9 * math.cos(100 * theta) * shapes[:, k], abs=1e-18)


@pytest.mark.parametrize("modes", [3, 6, "all"])
@pytest.mark.parametrize("scaled", [True, False])
def test_motion_grows_beyond_the_step_of_the_largest_eigenvalue(modes: ModeCount, scaled: bool) -> None:
    """To 0.1 %; the bound from single blocks is below it by at most a fifth."""
    system = system_of(modal_wall(bonded(small()), modes=modes), damping=0.0, mass_scaling=scaled)
    row = critical_step(system)
    assert row["measured"] == pytest.approx(row["theory"], rel=1e-3)
    assert 0.8 * row["theory"] < row["bound from each block"] <= row["theory"] * (1 + 1e-12)
    assert row["growth"] == pytest.approx([growth_at(times) for times in TIMES], rel=1e-6)


@pytest.mark.parametrize(("omega_dt", "exact"), [(2.1, 1.877328), (2.01, 1.221301), (1.99, 1.0)])
def test_growth_rate_of_one_mass_is_exact(omega_dt: float, exact: float) -> None:
    assert mass_row(GROWTH, omega_dt)["measured"] == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize("alpha", [0.5, *at_length(0.2, 0.8)])
def test_local_damping_reduces_the_critical_step(alpha: float) -> None:
    assert mass_row(LOCAL, alpha)["measured"] == pytest.approx(2 / math.sqrt(1 + alpha), rel=1e-3)


@pytest.mark.parametrize("ratio", [0.3, *at_length(0.05, 1.0)])
def test_viscous_damping_reduces_the_critical_step(ratio: float) -> None:
    """With viscous joints, as in a run."""
    theory = 2 * (math.sqrt(1 + ratio**2) - ratio)
    assert mass_row(VISCOUS, ratio)["measured"] == pytest.approx(theory, rel=1e-3)


# --- runs beyond the critical step ---------------------------------------------------------------------------


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
@pytest.mark.parametrize("times", [1.05, 1.5, 10.0, 1e12])
def test_run_beyond_the_critical_step_fails_at_its_first_check(
    model: Literal["dem-dynamic", "fem"], times: float
) -> None:
    """The message has the step taken and a safe step."""
    outcome = run_beyond(model, times)
    scene = published_scene("wall-w1")
    system = rigid_system(scene) if model == "dem-dynamic" else system_of(modal_wall(scene))
    taken = times * 2 / vibrations(system)[0][-1]
    assert (outcome.status, outcome.multiplier, outcome.lower, outcome.upper) == ("failed", None, None, None)
    assert outcome.steps == LOOK
    assert f"{taken:.4g} s" in outcome.message
    assert f"a step of {Run(system).dt:.4g} s is safe" in outcome.message


def test_run_at_rest_with_a_too_long_step_reports_it() -> None:
    """Between the critical steps with and without damping, the result may equal that at the safe step."""
    scene = courses([[1]], joint__mortar=MORTAR)
    system = rigid_system(scene)
    points = contact_points(scene)
    order = np.argsort(points.joint, kind="stable")

    def result(times: float) -> tuple[float | None, str]:
        run = Run(system, dt=times * Run(system).dt)
        outcome = collapse_by_steps(
            scene, "", run, 0.01, points=points, point_order=order, is_self_locking=lambda: False
        )
        return outcome.multiplier, outcome.message

    safe, long = result(1.0), result(1.05)
    assert safe[0] == long[0]
    assert "longer than the safe" not in safe[1]
    assert "longer than the safe" in long[1]


@pytest.mark.parametrize("look", ["settle", "drive"])
def test_settle_and_drive_raise_for_a_too_long_step(look: str) -> None:
    system = rigid_system(small())
    step = 1.3 * 2 / float(vibrations(system)[0][-1])
    run, state = Run(system, dt=step), State.at_rest(system)

    def look_on() -> object:
        if look == "settle":
            return settle(run, state, 0.1, Criteria(collapse=0.01))
        return drive(run, state, 0.01, 20_000)

    with pytest.raises(Unstable, match=f"time steps of {step:.4g} s; a step of {run.safe_step:.4g} s is safe"):
        look_on()
    assert state.steps == (LOOK if look == "settle" else 0)


def test_nan_stops_a_run() -> None:
    system = rigid_system(small())
    state = State.at_rest(system)
    state.velocity[system.rigid[-1, 0]] = math.nan
    with pytest.raises(Unstable):
        Run(system).hold(state, 0.0, 1000, given=0.0)
    assert state.steps == LOOK


# --- motions that are not unstable ---------------------------------------------------------------------------


def _undamped(system: BlockSystem, times: float = 1.0) -> Run:
    return Run(system, local=0.0, viscous=0.0, dt=times * 2 / float(vibrations(system)[0][-1]))


@pytest.mark.parametrize("times", [0.3, 0.9])
def test_initial_velocity_counts_as_supplied_energy(times: float) -> None:
    """Without it the kinetic energy would exceed what the loads supplied."""
    system = rigid_system(bonded(small()))
    run, state = _undamped(system, times), State.at_rest(system)
    state.velocity[np.isfinite(system.mass)] = np.random.default_rng(2).normal(size=int(np.isfinite(system.mass).sum()))
    given = run.given(state)
    assert given == pytest.approx(
        0.5 * float((state.velocity**2)[np.isfinite(system.mass)] @ system.mass[np.isfinite(system.mass)])
    )
    copy = state.copy()
    run.hold(state, 0.0, 20_000, dead=0.0, given=given)
    with pytest.raises(Unstable):
        run.hold(copy, 0.0, 20_000, dead=0.0, given=0.0)


@pytest.mark.parametrize("times", [0.3, 0.9])
@pytest.mark.parametrize("cohesion", [0.0, 1e12])
def test_undamped_wall_under_a_sudden_load_is_not_unstable(times: float, cohesion: float) -> None:
    """A dry wall chatters and falls; a bonded one oscillates for ever."""
    system = rigid_system(courses([[0.5, 1, 0.5], [1, 1]], joint__mortar=MORTAR, joint__cohesion=cohesion))
    run, state = _undamped(system, times), State.at_rest(system)
    run.hold(state, 0.7, 20_000, given=0.0)
    assert state.steps == 20_000


def test_checks_do_not_depend_on_how_steps_are_grouped() -> None:
    """The motion is bitwise equal as well."""
    system = rigid_system(panel(joint__mortar=MORTAR, wall__length=0.48, wall__height=0.24))
    run = Run(system)
    whole, pieces = State.at_rest(system), State.at_rest(system)
    run.hold(whole, 0.2, 210)
    for steps in (1, 99, 30, 80):
        run.hold(pieces, 0.2, steps, given=0.0)
    assert (whole.motion == pieces.motion).all()
    assert whole.steps == pieces.steps
    assert whole.external == pytest.approx(pieces.external, rel=1e-12)
