"""Explicit dynamics of blocks against exact solutions."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem.dynamic import dem_dynamic
from dem.rigid_system import contact_points, rigid_system
from runningbond import Wall
from runningbond.draws import Scatter
from runningbond.dynamics import (
    BlockSystem,
    Criteria,
    Interface,
    Restraint,
    Run,
    State,
    block_frequency_squared,
    mass_factor,
    settle,
    stable_step,
)
from runningbond.dynamics.collapse import CollapseDetector
from runningbond.joints import Rule, joint_points, joint_stiffness
from runningbond.joints.compiled import kernel
from runningbond.joints.law import FRICTION_WORK, KernelLaw
from runningbond.joints.wall_law import kernel_law
from runningbond.limit import limit
from runningbond.limit.kinematics import jump_operator, mass_matrix_diagonal, pin_operator
from runningbond.scene import Array, JointMaterial, Mortar, Scene, Stiffness
from runningbond.studies.pushover import drive, settled_drive
from tests.limit.test_limit import pile, rectangle
from tests.walls import panel

STIFF = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
GRAVITY = 9.81


class NoGeometry(NamedTuple):
    """Geometry without joints."""

    nothing: Array


@kernel
def _no_jumps(motion: Array, geometry: Any, opening: Array, slip: Array) -> None:
    pass


@kernel
def _no_forces(normal: Array, tangential: Array, geometry: Any, force: Array) -> None:
    pass


def oscillator(stiffness: float = 1.0, viscosity: float = 0.0) -> BlockSystem:
    """One unit mass on a spring, without joints."""
    law = kernel_law([JointMaterial(0.0, elasticity=Stiffness(1.0, 1.0))], np.zeros(0, dtype=np.int64))
    return BlockSystem(
        mass=np.ones(1),
        stiffness=np.array([stiffness]),
        viscosity=np.array([viscosity]),
        dead=np.zeros(1),
        live=np.zeros(1),
        control=np.ones(1),
        force_unit=np.ones(1),
        rigid=np.zeros((1, 3), dtype=np.int64),
        owner=np.zeros(1, dtype=np.int64),
        restraint=Restraint(np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3, 3))),
        interface=Interface(law, np.zeros(0), _no_jumps, _no_forces, NoGeometry(np.zeros(0)), stiffness),
    )


def block_on_base(width: float, height: float, friction: float, mass: float = 1.0, stiffness: float = 1e10) -> Scene:
    """One block of a given mass, thickness 1, with stiffness per joint area in both directions."""
    size = {"wall__length": width, "wall__height": height, "wall__block_width": width, "wall__block_height": height}
    joint = {"friction": friction, "normal_stiffness": stiffness, "shear_stiffness": stiffness}
    return panel(**size, wall__thickness=1.0, block__density=mass / (width * height), joint=joint)


# --- the integrator ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("omega_dt", [0.1, 0.9, 1.5, 1.99])
def test_free_oscillation_follows_central_difference_cosine(omega_dt: float) -> None:
    """u_n = cos(n θ) with sin(θ/2) = ω Δt / 2, to rounding, for 300 steps."""
    run = Run(oscillator(), local=0.0, viscous=0.0, dt=omega_dt)
    theta = 2 * math.asin(omega_dt / 2)
    state = State.at_rest(run.system)
    state.motion[0] = 1.0
    state.velocity[0] = (1 - math.cos(theta)) / omega_dt
    for n in range(1, 301):
        run.hold(state, 0.0, 1)
        assert state.motion[0] == pytest.approx(math.cos(n * theta), abs=1e-10)


@pytest.mark.parametrize(("omega_dt", "growth"), [(2.1, 1.877328), (2.01, 1.221301)])
def test_oscillation_beyond_stability_limit_grows_at_known_rate(omega_dt: float, growth: float) -> None:
    run = Run(oscillator(), local=0.0, viscous=0.0, dt=omega_dt)
    state = State.at_rest(run.system)
    state.motion[0] = 1.0
    run.hold(state, 0.0, 300)
    before = state.motion[0]
    run.hold(state, 0.0, 1)
    assert abs(state.motion[0] / before) == pytest.approx(growth, abs=1e-6)


def _grows(run: Run) -> bool:
    state = State.at_rest(run.system)
    state.motion[0] = 1e-3
    run.hold(state, 0.0, 20_000)
    return not abs(state.motion[0]) < 1.0


@pytest.mark.parametrize("local", [0.2, 0.5, 0.8])
def test_local_damping_reduces_stable_step_by_root_of_one_plus_alpha(local: float) -> None:
    edge = 2 / math.sqrt(1 + local)
    assert not _grows(Run(oscillator(), local=local, viscous=0.0, dt=0.999 * edge))
    assert _grows(Run(oscillator(), local=local, viscous=0.0, dt=1.001 * edge))


@pytest.mark.parametrize("ratio", [0.05, 0.3, 1.0])
def test_lagged_viscous_damping_reduces_stable_step(ratio: float) -> None:
    """(ω Δt)_cr = 2 (√(1 + ξ²) − ξ)."""
    edge = 2 * (math.sqrt(1 + ratio**2) - ratio)
    assert not _grows(Run(oscillator(viscosity=2 * ratio), local=0.0, viscous=0.0, dt=0.999 * edge))
    assert _grows(Run(oscillator(viscosity=2 * ratio), local=0.0, viscous=0.0, dt=1.001 * edge))


@pytest.mark.parametrize("local", [0.2, 0.5, 0.8])
@pytest.mark.parametrize("ratio", [0.1, 0.3])
def test_local_and_viscous_damping_together_reduce_stable_step_further(local: float, ratio: float) -> None:
    """Together they reduce the stable step by more than the product of their separate reductions."""
    edge = stable_step(1.0, ratio, local) / 0.9
    assert edge < 2 * (math.sqrt(1 + ratio**2) - ratio) / math.sqrt(1 + local)
    assert not _grows(Run(oscillator(viscosity=2 * ratio), local=local, viscous=0.0, dt=0.999 * edge))
    assert _grows(Run(oscillator(viscosity=2 * ratio), local=local, viscous=0.0, dt=1.001 * edge))


@pytest.mark.parametrize("local", [0.5, 0.95])
@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_stable_step_is_safe_under_heavy_damping(local: float, ratio: float) -> None:
    dt = stable_step(1.0, ratio, local)
    assert not _grows(Run(oscillator(viscosity=2 * ratio), local=local, viscous=0.0, dt=dt))


def test_stable_step_is_nine_tenths_of_both_limits() -> None:
    assert stable_step(4.0) == pytest.approx(0.9)
    assert stable_step(1.0, 0.3) == pytest.approx(0.9 * 2 * (math.sqrt(1.09) - 0.3))
    assert stable_step(1.0, 0.0, 0.5) == pytest.approx(0.9 * 2 / math.sqrt(1.5))


def test_mass_scaling_limits_stiff_modes_but_not_rigid_ones() -> None:
    """With the scaled mass M* a mode's frequency is below 2 / (Δt √(1 + α)), for any stiffness."""
    stiffness, local, dt = np.array([0.0, 1.0, 1e6, 1e12]), 0.5, 0.1
    factor = mass_factor(stiffness, np.ones(4), dt, local)
    assert factor[0] == 1.0
    assert (np.sqrt(stiffness / factor) * dt * math.sqrt(1 + local) <= 2).all()


# --- the system ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scatter", ["bits", "size=0.05,friction=0.1"])
@pytest.mark.parametrize("changes", [{}, {"support__kind": "fixed-first-course"}, {"wall__ends": "toothed"}])
def test_kernels_equal_jump_operator_and_its_transpose(changes: dict[str, Any], scatter: str) -> None:
    """Against the sparse operators of limit analysis; for equal blocks and for a wall without two equal joints."""
    scene = Scatter.read(scatter).draw(panel(joint__mortar=STIFF, **changes), 1)
    system, points = rigid_system(scene), contact_points(scene)
    jump = jump_operator(points, scene.blocks.centroid)
    rng = np.random.default_rng(1)
    motion = np.where(scene.fixed[:, None], 0.0, rng.normal(size=(len(scene.blocks), 3)))
    coordinates = np.zeros(motion.size)
    coordinates[system.rigid] = motion
    opening, slip, force = np.zeros(len(points)), np.zeros(len(points)), np.zeros(motion.size)
    system.interface.gather(coordinates, tuple(system.interface.geometry), opening, slip)
    assert opening == pytest.approx(jump.opening @ motion.ravel(), abs=1e-12)
    assert slip == pytest.approx(jump.slip @ motion.ravel(), abs=1e-12)
    normal, tangential = rng.normal(size=(2, len(points)))
    expected = jump.opening.T @ (normal * points.area) + jump.slip.T @ (tangential * points.area)
    system.interface.scatter(normal, tangential, tuple(system.interface.geometry), force)
    assert force[system.rigid][~scene.fixed] == pytest.approx(-expected.reshape(-1, 3)[~scene.fixed], abs=1e-12)


def _stiffness_matrix(scene: Scene) -> Array:
    points, stiffness = contact_points(scene), joint_stiffness(scene.joint)
    jump = jump_operator(points, scene.blocks.centroid)
    k_n, k_t = stiffness.normal * points.area, stiffness.shear * points.area
    matrix = jump.opening.T @ (k_n[:, None] * jump.opening.toarray())
    total: Array = matrix + jump.slip.T @ (k_t[:, None] * jump.slip.toarray())
    return total


@pytest.mark.parametrize("changes", [{}, {"wall__block_height": 0.24}, {"wall__block_width": 0.06}])
def test_single_block_bound_on_highest_frequency_is_close(changes: dict[str, Any]) -> None:
    scene = panel(joint__mortar=STIFF, **changes)
    free = np.repeat(~scene.fixed, 3)
    root = 1 / np.sqrt(mass_matrix_diagonal(scene)[free])
    scaled = _stiffness_matrix(scene)[np.ix_(free, free)] * root[:, None] * root
    exact = float(np.linalg.eigvalsh(scaled)[-1])
    bound = rigid_system(scene).interface.frequency_squared
    assert exact <= bound * (1 + 1e-12)
    assert math.sqrt(exact / bound) > 0.8  # half blocks next to whole ones; 0.95 if all blocks are equal


def test_block_frequency_of_one_mass_on_spring() -> None:
    assert block_frequency_squared(np.array([[[3.0]]]), np.array([[2.0]])) == pytest.approx(1.5)


@pytest.mark.parametrize("mode", [1, 3, 5])
def test_column_of_blocks_has_frequencies_of_spring_mass_chain(mode: int) -> None:
    """N equal blocks on N joints: ω_j = 2 √(k/m) sin((2j − 1) π / (2 (2N + 1))); modes follow their cosine in time."""
    n, width, height = 5, 0.2, 0.1
    glued = {"friction": 0.6, "cohesion": 1e9, "normal_stiffness": 1e9, "shear_stiffness": 1e9}
    wall = {"block_width": width, "block_height": height, "thickness": 1.0, "courses": [[1]] * n}
    system = rigid_system(panel(wall=wall, joint=glued))
    m, k = 1800 * width * height, 1e9 * width
    phase = (2 * mode - 1) * math.pi / (2 * n + 1)
    omega = 2 * math.sqrt(k / m) * math.sin(phase / 2)
    run = Run(replace(system, dead=np.zeros_like(system.dead)), local=0.0, viscous=0.0)
    theta = 2 * math.asin(omega * run.dt / 2)
    shape = 1e-6 * np.sin(phase * np.arange(1, n + 1))
    state = State.at_rest(run.system)
    rise = system.rigid[:n, 1]
    state.motion[rise] = shape
    state.velocity[rise] = shape * (1 - math.cos(theta)) / run.dt
    for step in range(1, 200):
        run.hold(state, 0.0, 1)
        assert state.motion[rise] == pytest.approx(shape * math.cos(step * theta), abs=1e-14)


def test_elastic_column_conserves_central_difference_energy() -> None:
    """Central differences conserve ½ v⁻·M v⁺ + ½ u·K u − f·u; using v⁻ alone misses a share of each step's energy."""
    glued = {"friction": 0.6, "cohesion": 1e9, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    wall = {"block_width": 0.2, "block_height": 0.1, "thickness": 1.0, "courses": [[1], [0.5, 0.5], [1]]}
    run = Run(rigid_system(panel(wall=wall, joint=glued)), local=0.0, viscous=0.0)
    state, load = State.at_rest(run.system), run.system.dead + 0.3 * run.system.live
    missed, lagging, work = 0.0, 0.0, 0.0
    for _ in range(300):
        run.hold(state, 0.3, 1)
        missed = max(missed, abs(run.ledger(state, load).residual))
        lagging, work = max(lagging, abs(run.ledger(state).residual)), max(work, state.external)
    assert missed < 1e-11 * work
    assert lagging > 1e-2 * work


def test_free_wall_conserves_momentum() -> None:
    """Linear and angular momentum, to 1e-12, while joints open and slide."""
    scene = panel(wall__height=0.24, joint__mortar=STIFF)
    system = rigid_system(scene)
    mass = np.zeros(len(system.mass))
    mass[system.rigid] = mass_matrix_diagonal(scene).reshape(-1, 3)
    free = replace(system, mass=mass, dead=np.zeros_like(mass), live=np.zeros_like(mass))
    run = Run(free, local=0.0)
    state = State.at_rest(free)
    state.velocity[:] = np.random.default_rng(2).normal(size=len(mass))
    centroid = scene.blocks.centroid

    def momenta() -> Array:
        p = (mass * state.velocity)[system.rigid]
        spin = p[:, 2] + centroid[:, 0] * p[:, 1] - centroid[:, 1] * p[:, 0]
        return np.array([*p[:, :2].sum(axis=0), spin.sum()])

    before, scale = momenta(), np.abs(mass * state.velocity).sum()
    run.hold(state, 0.0, 5000)
    assert np.abs(momenta() - before).max() < 1e-12 * scale
    assert state.history[FRICTION_WORK].sum() > 0


@pytest.mark.parametrize("kind", ["corners", "pinned-corners"])
def test_pinned_corners_do_not_move(kind: str) -> None:
    live = {"kind": "point", "at": [0.72, 0.72], "force": [0, -1]}
    scene = panel(joint__mortar=STIFF, joint__cohesion=1e5, support__kind=kind, load={"gravity": 0.0, "live": live})
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    run.hold(state, 5000.0, 3000)
    motion = run.system.motion_of_blocks(state.motion)
    assert np.abs(motion).max() > 1e-6
    assert np.abs(pin_operator(scene) @ motion.ravel()).max() < 1e-12 * np.abs(motion).max() + 1e-18


# --- one block -----------------------------------------------------------------------------------------------


def test_base_reaction_equals_weight() -> None:
    scene = panel(joint__mortar=STIFF)
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=0.01, rest=1e-9)) == "stable"
    base = (contact_points(scene).block == len(scene.blocks) - 1).any(axis=1)
    weight = 1800 * GRAVITY * 1.44 * 0.72 * 0.12
    assert run.forces(state)[0][base].sum() == pytest.approx(-weight, rel=1e-6)


def test_stick_and_slip_under_a_harmonic_force() -> None:
    """m = 1, μ = 0.8, F = 8 cos t: x(10) = −0.00869717 (rigid–plastic friction, integrated exactly)."""
    scene = block_on_base(1.0, 0.01, 0.8, stiffness=1e10)
    run = Run(rigid_system(scene), local=0.0, viscous=0.1)
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=1.0, rest=1e-12, interval=1000, budget=200_000)) == "stable"
    # The joint's spring is first loaded almost to slip: a sudden load would give the block a speed F / √(k m).
    assert settle(run, state, 0.8 * (1 - 1e-6), Criteria(collapse=1.0, rest=1e-9)) == "stable"
    state.velocity[:] = 0.0
    weight, interval = GRAVITY, 20
    start = run.system.motion_of_blocks(state.motion)[0, 0]
    pieces = round(10 / (interval * run.dt))
    step = 10 / (pieces * interval)
    run = Run(rigid_system(scene), local=0.0, viscous=0.1, dt=step)
    for piece in range(pieces):
        t = (piece + 0.5) * interval * step
        run.hold(state, 8 * math.cos(t) / weight, interval)
    assert run.system.motion_of_blocks(state.motion)[0, 0] - start == pytest.approx(-0.00869717, abs=2e-8)


def test_coulomb_oscillator_has_known_turning_points_and_sticks() -> None:
    """m = 1, k = 100, μN = 2, x0 = 0.11: turning points 0.11, −0.07, 0.03, 0.01, at rest from t = 3π/10."""
    scene = block_on_base(1.0, 0.01, 2.0 / GRAVITY, stiffness=1e9)
    system = rigid_system(scene)
    spring = np.zeros_like(system.mass)
    x, y, _ = system.rigid[0]
    spring[x] = 100.0
    run = Run(replace(system, stiffness=spring), local=0.0, viscous=0.1)
    state = State.at_rest(run.system)
    state.motion[y] = -GRAVITY / 1e9  # resting on its base
    state.motion[x] = 0.11
    state.history[4] = -0.11  # the slip of the block (side b in the frame of a downward normal) starts without a force
    state.history[3] = -0.11
    state.history[2] = -GRAVITY / 1e9
    track = []
    while state.steps * run.dt < 3 * math.pi / 10 + 0.2:
        run.hold(state, 0.0, 10)
        track.append((state.steps * run.dt, state.motion[x]))
    time, place = np.array(track).T
    for k, turning in enumerate((-0.07, 0.03, 0.01), start=1):
        at = np.interp(k * math.pi / 10, time, place)
        assert at == pytest.approx(turning, abs=1e-5)
    assert place[time > 3 * math.pi / 10 + 0.01] == pytest.approx(0.01, abs=1e-5)


def test_newmark_block_slides_exact_distance() -> None:
    """μ = 0.3 under a pulse of 0.5 g for 0.4 s: 0.2616 m."""
    run = Run(rigid_system(block_on_base(1.0, 0.1, 0.3, stiffness=1e9)), local=0.0)
    state = State.at_rest(run.system)
    x, y, _ = run.system.rigid[0]
    state.motion[y] = -GRAVITY / 1e9
    run.hold(state, 0.5, round(0.4 / run.dt))
    run.hold(state, 0.0, round(0.6 / run.dt))
    pulse = 0.5 * 0.2 * GRAVITY * 0.4**2
    assert state.motion[x] == pytest.approx(pulse + (0.2 * GRAVITY * 0.4) ** 2 / (2 * 0.3 * GRAVITY), rel=2e-4)
    assert state.motion[x] == pytest.approx(0.2616, abs=1e-4)


@given(force=st.floats(1e2, 1e5), cohesion=st.one_of(st.just(0.0), st.floats(1e-6, 1e5)), friction=st.floats(0.1, 1.5))
@settings(max_examples=15, derandomize=True)
def test_shear_box_slides_at_cohesion_and_friction(force: float, cohesion: float, friction: float) -> None:
    """Pushed slowly, a flat block under N resists c A + N tan φ."""
    scene = block_on_base(1.0, 0.01, friction, mass=force / GRAVITY, stiffness=1e10)
    glued = scene.with_joint(cohesion=cohesion, tensile_strength=cohesion / friction)
    run = Run(rigid_system(glued), local=0.5)
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=1.0))
    pushed = drive(run, state, 1e-3, 40_000)
    plateau = float(np.median(pushed.curve[-50:, 1]))
    assert plateau * force == pytest.approx(cohesion + force * friction, rel=1e-3)


@pytest.mark.parametrize(("steps", "points"), [(1, 1), (150, 150), (350, 200)])
def test_drive_takes_all_steps_in_pieces_of_at_least_one(steps: int, points: int) -> None:
    """A load that only moves one block: the push takes exactly as many steps as requested, at 1e-6 m/s."""
    run = Run(rigid_system(block_on_base(1.0, 0.01, 0.4, stiffness=1e9)), local=0.5)
    pushed = drive(run, State.at_rest(run.system), 1e-6 * steps * run.dt, steps)
    assert len(pushed.curve) == points
    assert pushed.state.time == pytest.approx(steps * run.dt)


def test_drive_speed_is_halved_until_peak_converges() -> None:
    """A block pushed too fast shows inertia above μ; at lower speeds its peak converges to μ."""
    run = Run(rigid_system(block_on_base(1.0, 0.01, 0.4, stiffness=1e9)), local=0.5)
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=1.0))
    fast = drive(run, state, 1e-3, 400)
    settled = settled_drive(run, state, 1e-3, 0.01, steps=400, halvings=12)
    assert fast.peak > 1.05 * 0.4
    assert settled.rate_error <= 0.01 * settled.peak
    assert settled.peak == pytest.approx(0.4, rel=0.02)


@pytest.mark.parametrize("stiffness", [1e10, 1e11, 1e12])
@pytest.mark.parametrize(("width", "friction", "exact"), [(0.0597, 0.9, 0.0597 / 0.24), (0.24, 0.497, 0.497)])
def test_block_topples_at_b_over_h_and_slides_at_mu(
    width: float, friction: float, exact: float, stiffness: float
) -> None:
    """Block b × 0.24: λ to a thousandth, for any joint stiffness."""
    scene = block_on_base(width, 0.24, friction, stiffness=stiffness)
    outcome = dem_dynamic(scene, 1e-3, budget=20_000_000)  # at 1e12 Pa/m a time step is a microsecond
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= exact * (1 + 1e-3)
    assert outcome.upper >= exact * (1 - 1e-3)
    assert outcome.upper - outcome.lower <= 1e-3 * outcome.upper


# --- walls ---------------------------------------------------------------------------------------------------


def test_energy_balance_closes_through_collapse() -> None:
    """Work of the loads = kinetic + stored + friction + damped, to 1 % of the work, at rest and during collapse."""
    scene = panel(wall__height=0.24, wall__block_width=0.06, joint__mortar=STIFF)
    bound = limit(scene).upper
    assert bound is not None
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    for multiplier in (0.0, 0.5 * bound, 1.2 * bound):
        settle(run, state, multiplier, Criteria(collapse=0.006))
        ledger = run.ledger(state)
        assert abs(ledger.residual) < 0.01 * abs(ledger.external)
    assert run.ledger(state).friction > 0
    assert run.ledger(state).kinetic > 0


def test_wall_collapsing_under_its_weight_is_infeasible() -> None:
    scene = pile([rectangle(0, 0, 1, 1), rectangle(0.6, 1, 1, 1)], 0.5)
    stiff = scene.with_joint(elasticity=Mortar(1e9, 0.2, 0.01))
    assert dem_dynamic(stiff).status == "infeasible"


@pytest.mark.parametrize(("springy", "far"), [(True, 1.0), (False, 0.5)])
@pytest.mark.parametrize(("exponent", "falls"), [(2.0, True), (1.0, True), (0.5, False)])
def test_motion_without_deceleration_is_collapse(exponent: float, falls: bool, springy: bool, far: float) -> None:
    """x = t^p beyond the threshold: collapse for p ≥ 1, and for p < 1 only once x reaches 2^4 units."""
    fall = CollapseDetector(elastic=springy)
    at = next(t for t in range(1, 10_000_000) if fall.goes_on((t / 1000) ** exponent, t))
    assert (at / 1000) ** exponent == pytest.approx(far if falls else 2.0**CollapseDetector.FARTHEST, rel=0.01)


def test_motion_that_regains_its_speed_is_collapse_at_one_unit() -> None:
    """Slow between 1/8 and 1/4 of a unit, and then at its earlier speed again."""
    fall = CollapseDetector()
    time = np.cumsum([0, *[100] * 8, *[400] * 8, *[100] * 100])  # at every 1/64 of a unit
    assert next(k for k, t in enumerate(time, 1) if fall.goes_on(k / 64, int(t))) == pytest.approx(64, abs=1)


def test_first_check_alone_does_not_detect_collapse() -> None:
    """A wall that gives way by less than the farthest threshold before the first check is not in collapse."""
    assert not CollapseDetector().goes_on(15.9, 200)
    assert CollapseDetector().goes_on(16.1, 200)


def test_short_motion_is_no_collapse_before_its_last_mark() -> None:
    """At constant speed: one unit in 500 steps, and the first mark beyond 3000 steps is that at 8 units."""
    fall = CollapseDetector(shortest=3000)
    assert next(t for t in range(1, 10_000) if fall.goes_on(t / 500, t)) == pytest.approx(4000, abs=1)


STONES: dict[str, list[list[tuple[float, float]]]] = {
    "wedge": [
        [(0.22, 0.0), (0.98, 0.0), (0.83, 0.48)],
        [(0.98, 0.0), (1.0, 0.0), (1.0, 0.66), (0.83, 0.48)],
        [(0.0, 0.0), (0.22, 0.0), (0.83, 0.48), (1.0, 0.66), (1.0, 0.8), (0.0, 0.8)],
    ],
    "slope": [
        [(0.63, 0.44), (1.0, 0.48), (1.0, 0.8), (0.69, 0.8)],
        [(0.01, 0.0), (1.0, 0.0), (1.0, 0.48), (0.63, 0.44)],
        [(0.0, 0.0), (0.01, 0.0), (0.63, 0.44), (0.69, 0.8), (0.0, 0.8)],
    ],
}


@pytest.mark.parametrize(
    ("stones", "cohesion", "at", "force"),
    [("wedge", 18500.0, [0.0, 0.8], [99.0, 86.0]), ("slope", 16500.0, [1.0, 0.8], [0.0, 24.0])],
)
def test_wall_that_yields_far_before_it_rests_has_not_collapsed(
    stones: str, cohesion: float, at: list[float], force: list[float]
) -> None:
    """Glued stones without friction have one collapse load; some move as far as others fall and then rest."""
    wall = Wall.outlines(
        STONES[stones],
        thickness=0.2,
        density=2000.0,
        friction=0.0,
        cohesion=cohesion,
        tensile_strength=2100.0,
        normal_stiffness=1e9,
        shear_stiffness=4e8,
        live={"kind": "point", "at": at, "force": force},
    )
    exact, outcome = wall.run("limit").multiplier, wall.run("dem-dynamic", tolerance=0.02)
    assert exact is not None
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower < 1.001 * exact
    assert outcome.upper > 0.999 * exact


def test_interrupt_keeps_bracket_and_curve_found_so_far() -> None:
    """Interrupted by an observer during the search: undecided, with the lower bound so far and the curve."""
    scene = panel(joint__mortar=STIFF, wall__height=0.24)
    seen: list[float] = []

    def stop(run: Run, state: State, multiplier: float) -> None:
        assert run.system.motion_of_blocks(state.motion).shape == (len(scene.blocks), 3)
        seen.append(multiplier)
        if multiplier > 0.25:
            raise KeyboardInterrupt

    outcome = dem_dynamic(scene, observe=stop)
    assert outcome.status == "undecided"
    assert outcome.multiplier is None
    assert outcome.lower is not None
    assert 0 < outcome.lower <= 0.25
    assert "interrupted" in outcome.message
    assert outcome.curve[:, 1].max() == outcome.lower
    assert seen == sorted(seen)
    assert outcome.steps


def test_exhausted_budget_is_undecided() -> None:
    outcome = dem_dynamic(panel(joint__mortar=STIFF), budget=200)
    assert outcome.status == "undecided"
    assert outcome.multiplier is None


def test_no_tension_joint_has_exact_rotation_under_eccentric_force() -> None:
    """l = t = 0.12 m, k_n = 1e9 Pa/m, N = 1000 N at e = 0.01, 0.03, 0.05 m: within the kern, and outside it.

    Rotations 5.787037e-4, 2.057613e-3, 1.851852e-2: from N / (k t l) ± 6 e / l, and 2 N / (k t l_c²) with
    l_c = 3 (l/2 − e) if part of the joint opens.
    """
    scene = block_on_base(0.12, 0.12, 0.6)
    points = joint_points(scene.joints, 0.12, _midpoints(20_000))
    xi = (points.position - points.position.mean(axis=0)) @ points.tangent[0]
    law = kernel_law([JointMaterial(0.6, elasticity=Stiffness(1e9, 1e9))], np.zeros(len(points), dtype=np.int64))
    for e, expected in ((0.01, 5.787037e-4), (0.03, 2.057613e-3), (0.05, 1.851852e-2)):
        middle, turn = _rest_of(law, points.area, xi, 1000.0, e)
        assert abs(turn) == pytest.approx(expected, rel=2e-6)
        assert middle < 0 or e > 0.04


def _midpoints(n: int) -> Rule:
    return Rule((np.arange(n) + 0.5) / n * 2 - 1, np.full(n, 2 / n))


def _rest_of(law: KernelLaw, area: Array, xi: Array, normal: float, e: float) -> tuple[float, float]:
    """Opening at the centre and rotation at which the law carries a normal force at an eccentricity (Newton)."""
    unknown = np.array([-normal / (area @ law.normal_stiffness), 0.0])
    for _ in range(60):
        opening = unknown[0] + unknown[1] * xi
        traction, shear = np.zeros_like(xi), np.zeros_like(xi)
        law.kernel(opening, 0 * xi, law.parameters, np.zeros((law.rows, len(xi))), 0.0, traction, shear)
        force = area * traction
        residual = np.array([force.sum() + normal, (force * xi).sum() + normal * e])
        closed = area * law.normal_stiffness * (opening < 0)
        tangent = np.array([[closed.sum(), (closed * xi).sum()], [(closed * xi).sum(), (closed * xi**2).sum()]])
        unknown = unknown - np.linalg.solve(tangent, residual)
    assert np.abs(residual).max() < 1e-6 * normal
    return float(unknown[0]), float(unknown[1])
