"""Cohesive joint points: dissipated fracture energy, and damage that never decreases."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dem.dynamic import dem_dynamic
from runningbond.joints.coulomb import IMPACTS
from runningbond.joints.law import FRICTION_WORK, KernelLaw
from runningbond.joints.softening import DAMAGE
from runningbond.joints.wall_law import kernel_law
from runningbond.scene import Array, JointMaterial, Stiffness
from tests.walls import panel

JOINT = JointMaterial(0.6, 1e5, 1e5)


def law(joint: JointMaterial = JOINT, energy_1: float | None = 20.0, energy_2: float | None = 80.0) -> KernelLaw:
    sized = replace(joint, elasticity=Stiffness(1e11, 4e10), fracture_energy_1=energy_1, fracture_energy_2=energy_2)
    return kernel_law([sized], np.zeros(1, dtype=np.int64))


def follow(found: KernelLaw, opening: Array, slip: Array) -> tuple[Array, Array, Array]:
    """Tractions along a path of jumps, and the history at the end."""
    history = np.zeros((found.rows, 1))
    normal, tangential = np.zeros(len(opening)), np.zeros(len(opening))
    n, t = np.zeros(1), np.zeros(1)
    for k in range(len(opening)):
        found.kernel(opening[[k]], slip[[k]], found.parameters, history, 0.0, n, t)
        normal[k], tangential[k] = n[0], t[0]
    return normal, tangential, history


def work(force: Array, jump: Array) -> float:
    return float(np.trapezoid(force, jump))


@pytest.mark.parametrize("energy", [1.0, 20.0, 500.0])
def test_area_under_the_opening_branch_is_the_fracture_energy(energy: float) -> None:
    """Pulled apart monotonically: ∫ σ dδ = G_I, to 1e-6, with the kinks of the branch on the path."""
    end = 2 * energy / 1e5
    peak = 1e5 / 1e11
    opening = np.concatenate([np.linspace(0, peak, 1000), np.linspace(peak, end, 4000)[1:], [2 * end]])
    normal, _, history = follow(law(energy_1=energy), opening, 0 * opening)
    assert work(normal, opening) == pytest.approx(energy, rel=1e-6)
    assert normal.max() == pytest.approx(1e5)
    assert normal[-1] == 0
    assert history[DAMAGE, 0] == 1
    assert history[FRICTION_WORK, 0] == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize("pressure", [0.0, 5e4])
def test_area_under_the_slip_branch_is_the_fracture_energy(pressure: float) -> None:
    """Above the residual friction: ∫ (τ − σ tan φ) ds_p = G_II, to 1e-6 as steps shrink (extrapolated).

    So is the dissipation recorded by the point, less that of friction.
    """

    def spent(n: int) -> tuple[float, float]:
        slip = np.linspace(0, 2.5e-3, n)
        opening = np.full(n, -pressure / 1e11)
        _, tangential, history = follow(law(), opening, slip)
        plastic = slip - tangential / (4e10)
        friction = 0.6 * pressure
        area = work(np.maximum(tangential - friction, 0.0), np.maximum.accumulate(plastic))
        return area, history[FRICTION_WORK, 0] - friction * plastic[-1]

    for coarse, fine in zip(spent(100_001), spent(200_001), strict=True):
        assert 2 * fine - coarse == pytest.approx(80.0, rel=1e-6)


@pytest.mark.parametrize("crushes_at", [None, 1e9])
def test_cyclic_slip_reduces_cohesion_by_accumulated_slip(crushes_at: float | None) -> None:
    """c (1 − s_p / s_c) with s_c = 2 G_II / c and s_p the length of the slip path, not the distance from its start."""
    corners = 2e-4 * np.array([0, 1, -1, 1, 0])
    slip = np.concatenate([np.linspace(a, b, 4000, endpoint=False) for a, b in pairwise(corners)])
    _, tangential, _ = follow(law(replace(JOINT, compressive_strength=crushes_at)), np.zeros_like(slip), slip)
    way = np.abs(np.diff(slip - tangential / 4e10)).sum()
    assert way > 1e-3
    assert -tangential[-1] == pytest.approx(1e5 * (1 - way * 1e5 / (2 * 80.0)), rel=1e-3)


@pytest.mark.parametrize("crushes_at", [None, 1e9])
def test_damage_combines_slip_and_opening_by_root_of_squares(crushes_at: float | None) -> None:
    """Slip to 0.3 of its range, then, unloaded, opening to 0.4 of its range: half of the strength is lost."""
    first, last, worn = 1e5 / 1e11, 2 * 20.0 / 1e5, 0.3 * 2 * 80.0 / 1e5
    slip = np.append(np.linspace(0, worn + 0.7 * 1e5 / 4e10, 4000), [worn, worn])
    opening = np.zeros_like(slip)
    opening[-1] = first + 0.4 * (last - first)
    normal, _, history = follow(law(replace(JOINT, compressive_strength=crushes_at)), opening, slip)
    assert history[DAMAGE, 0] == pytest.approx(0.5, rel=1e-3)
    # On the line from the origin to the point of equal damage in pure opening.
    assert normal[-1] == pytest.approx(0.5 * 1e5 * opening[-1] / (first + 0.5 * (last - first)), rel=3e-3)


def test_opening_unloads_to_origin_with_damage() -> None:
    path = np.concatenate([np.linspace(0, 1e-4, 500), np.linspace(1e-4, 0, 500), np.linspace(0, 1e-4, 500)])
    normal, _, _ = follow(law(), path, 0 * path)
    back, again = normal[500:1000], normal[1000:]
    assert back == pytest.approx(normal[499] * path[500:1000] / 1e-4, abs=1e-9)
    assert again == pytest.approx(back[::-1], abs=1e-9)


def test_broken_joint_is_dry() -> None:
    opening = np.array([1.0, -1e-6, -1e-6, -1e-6])
    slip = np.array([0.0, 0.0, 1.0, 2.0])
    normal, tangential, _ = follow(law(), opening, slip)
    assert normal[0] == 0
    assert tangential[2:] == pytest.approx(-0.6 * normal[2:])


@pytest.mark.parametrize("further", [{}, {"law": IMPACTS}, {"compressive_strength": 1e9}])
def test_friction_dissipates_work_that_is_not_stored(
    further: dict[str, Any],
) -> None:
    """At constant pressure, for steps of any length, also with reversals: work of mean shears less τ² / 2 k_t."""
    dry = kernel_law([JointMaterial(0.6, elasticity=Stiffness(1e11, 4e10), **further)], np.zeros(1, dtype=np.int64))
    slip = np.append(0.0, np.random.default_rng(1).normal(scale=4e-6, size=200).cumsum())
    _, tangential, history = follow(dry, np.full(len(slip), -1e-6), slip)
    assert np.abs(tangential).max() == pytest.approx(0.6 * 1e5)
    spent = work(tangential, slip) - tangential[-1] ** 2 / (2 * 4e10)
    assert history[FRICTION_WORK, 0] == pytest.approx(spent, rel=1e-12)


@pytest.mark.parametrize("branch", ["linear", "exponential"])
def test_joint_without_tensile_strength_is_limit_of_weak_joints(branch: Any) -> None:
    """Opening does not use up G_I, so the cohesion is kept; with G_I = 0 it is lost at once."""
    opening, slip = np.array([0.0, 1e-15, 1e-3, -1e-6, -1e-6]), np.array([0.0, 0.0, 0.0, 0.0, 1e-5])
    joint = replace(JOINT, softening=branch, fracture_energy_1=0.0)
    shear = {
        (strength, energy): follow(law(replace(joint, tensile_strength=strength), energy), opening, slip)[1][-1]
        for strength in (0.0, 1e-3)
        for energy in (0.0, 20.0)
    }
    assert shear[0.0, 20.0] == pytest.approx(1e5 + 0.6 * 1e5, rel=1e-6)
    assert shear[0.0, 0.0] == pytest.approx(0.6 * 1e5, rel=1e-6)
    assert [shear[0.0, energy] for energy in (0.0, 20.0)] == pytest.approx(
        [shear[1e-3, energy] for energy in (0.0, 20.0)], rel=1e-6
    )


def test_zero_strength_and_zero_energy_is_dry_friction_without_nan() -> None:
    dry = law(JointMaterial(0.6), 0.0, 0.0)
    rng = np.random.default_rng(3)
    opening, slip = rng.normal(size=200) * 1e-5, rng.normal(size=200) * 1e-5
    normal, tangential, _ = follow(dry, opening, slip)
    assert np.isfinite([normal, tangential]).all()
    assert (normal[opening > 0] == 0).all()
    assert (np.abs(tangential) <= -0.6 * normal + 1e-9).all()


def test_zero_jumps_give_zero_tractions() -> None:
    normal, tangential, _ = follow(law(), np.zeros(3), np.zeros(3))
    assert not normal.any()
    assert not tangential.any()


@given(
    steps=st.lists(st.tuples(st.floats(-1e-4, 3e-4), st.floats(-1e-3, 1e-3)), min_size=2, max_size=40),
    energy_1=st.sampled_from([None, 0.0, 5.0, 100.0]),
    energy_2=st.sampled_from([None, 0.0, 5.0, 100.0]),
)
@settings(max_examples=100)
def test_dissipation_and_damage_never_decrease(
    steps: list[tuple[float, float]], energy_1: float | None, energy_2: float | None
) -> None:
    assume(energy_1 is not None)
    found = law(energy_1=energy_1, energy_2=energy_2)
    history = np.zeros((found.rows, 1))
    n, t = np.zeros(1), np.zeros(1)
    spent, damage = 0.0, 0.0
    for opening, slip in steps:
        found.kernel(np.array([opening]), np.array([slip]), found.parameters, history, 0.0, n, t)
        assert history[FRICTION_WORK, 0] >= spent - 1e-12
        assert history[DAMAGE, 0] >= damage
        spent, damage = history[FRICTION_WORK, 0], history[DAMAGE, 0]
        assert np.isfinite([n[0], t[0]]).all()
    assert 0 <= damage <= 1


@given(
    corners=st.lists(st.tuples(st.floats(-1e-5, 3e-4), st.floats(-1e-3, 1e-3)), min_size=1, max_size=6),
    energy_1=st.sampled_from([0.0, 5.0, 100.0]),
    energy_2=st.sampled_from([0.0, 5.0, 100.0]),
)
@settings(max_examples=25)
def test_work_less_stored_energy_never_decreases(
    corners: list[tuple[float, float]], energy_1: float, energy_2: float
) -> None:
    """∫ σ dδ + τ ds − Ψ from the tractions, independently of the recorded dissipation, along fine steps of any path."""
    found = law(energy_1=energy_1, energy_2=energy_2)
    fine = 4000
    legs = np.array([(0.0, 0.0), *corners])
    path = np.concatenate([np.linspace(a, b, fine, endpoint=False) for a, b in pairwise(legs)] + [legs[-1:]])
    opening, slip = path.T.copy()
    normal, tangential, _ = follow(found, opening, slip)
    stored = found.law.stored(found, opening, normal, tangential)
    middle_n, middle_t = (normal[1:] + normal[:-1]) / 2, (tangential[1:] + tangential[:-1]) / 2
    done = middle_n * np.diff(opening) + middle_t * np.diff(slip)
    lost = np.concatenate([[0.0], np.cumsum(done) - stored[1:]])
    # The trapezoidal rule is off at kinks, by the energy the springs store over that step; legs have few kinks.
    passing = 1e11 * np.abs(np.diff(opening)).max() ** 2 + 4e10 * np.abs(np.diff(slip)).max() ** 2
    assert (np.maximum.accumulate(lost) - lost).max() <= len(corners) * passing + 1e-300  # no denormal number


def test_brittle_joints_carry_less_than_ductile_ones_and_tough_ones_as_much() -> None:
    """A bonded wall under lateral load, from almost no fracture energy to a large one."""
    stiff = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
    scene = panel(wall__length=0.48, wall__height=0.36, joint__cohesion=2e3, joint__mortar=stiff)

    def lower(energy: float | None) -> float:
        outcome = dem_dynamic(scene.with_joint(fracture_energy_1=energy, fracture_energy_2=energy))
        assert outcome.status == "collapse"
        assert outcome.lower is not None
        return outcome.lower

    brittle, tough, plastic = lower(1e-3), lower(1e3), lower(None)
    assert brittle < 0.97 * plastic
    assert tough == pytest.approx(plastic, rel=0.03)


def test_plastic_joint_in_softening_kernel_keeps_tensile_strength() -> None:
    """σ = f_t beyond the elastic branch: with an infinite fracture energy, damage must not reduce the strength."""
    plastic = replace(JOINT, elasticity=Stiffness(1e11, 4e10))
    mixed = [plastic, replace(plastic, fracture_energy_1=20.0, fracture_energy_2=80.0)]
    opening = np.array([1e-6, 1e-5, 1e-3, 0.1])
    for slid in (0.0, 1e-3):
        normal, _, _ = follow(kernel_law(mixed, np.zeros(1, dtype=np.int64)), opening, np.full(4, slid))
        assert normal == pytest.approx(JOINT.tensile_strength, rel=1e-6)


def test_tension_cut_off_stores_the_work_of_its_traction() -> None:
    """Without fracture energies: f_t² / 2 k_n where it is reached, and f_t times the opening beyond."""
    found, strength = law(energy_1=None, energy_2=None), JOINT.tension
    reached = strength / 1e11
    opening = reached * np.array([0.5, 1.0, 3.0])
    normal, tangential, _ = follow(found, opening, np.zeros(3))
    stored = found.law.stored(found, opening, normal, tangential)
    assert stored == pytest.approx(strength * reached * np.array([0.125, 0.5, 2.5]))
