"""Joint points that crush and close: against rate equations integrated in fine steps, closed forms and energy."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from runningbond.joints.closure import closure_at, closure_curve, pressure_at, stiffness_at, stored_at
from runningbond.joints.coulomb import COULOMB, PLASTIC_SLIP
from runningbond.joints.crushing import crushing_cap, strength_at, work_until
from runningbond.joints.dry_points import CRUSHED, SEAT
from runningbond.joints.interface import HISTORY, INTERFACE, interface_kernel
from runningbond.joints.law import DAMPED_WORK, FRICTION_WORK, KernelLaw
from runningbond.joints.softening import DAMAGE, SOFTENING
from runningbond.joints.wall_law import kernel_law
from runningbond.scene import Array, Closure, JointMaterial, Stiffness

K_N, K_T, STRENGTH, ENERGY = 9e10, 1e10, 1e7, 5e3
MATERIAL = JointMaterial(
    0.75, 3e5, 2e5, elasticity=Stiffness(K_N, K_T), compressive_strength=STRENGTH, fracture_energy_1=20.0
)
SOFT = replace(MATERIAL, compressive_fracture_energy=ENERGY)
PARABOLA = replace(SOFT, peak_closure=9e-5)
CLOSING = Closure(2e4, 4e11)
MATERIALS = {
    "plastic": MATERIAL,
    "soft": SOFT,
    "hardening": PARABOLA,
    "hardening for good": replace(MATERIAL, peak_closure=9e-5),
    "closing": replace(SOFT, closure=CLOSING),
    "sudden": replace(MATERIAL, compressive_fracture_energy=200.0),
}


def law(material: JointMaterial = SOFT) -> KernelLaw:
    found = kernel_law([material], np.zeros(1, dtype=np.int64))
    assert found.law == INTERFACE
    return found


def follow(found: KernelLaw, opening: Array, slip: Array, viscosity: float = 0.0) -> tuple[Array, Array, Array]:
    """Tractions and history rows ``(rows, n)`` along a path of jumps."""
    history = np.zeros((found.rows, 1))
    normal, tangential, histories = (
        np.zeros(len(opening)),
        np.zeros(len(opening)),
        np.zeros((found.rows, len(opening))),
    )
    n, t = np.zeros(1), np.zeros(1)
    for k in range(len(opening)):
        found.kernel(opening[[k]], slip[[k]], found.parameters, history, viscosity, n, t)
        normal[k], tangential[k], histories[:, k] = n[0], t[0], history[:, 0]
    return normal, tangential, histories


def legs(*corners: tuple[float, float], steps: int) -> Array:
    """Path from rest through given jumps at its corners, ``(2, n)``."""
    parts = [np.linspace(a, b, steps, endpoint=False) for a, b in pairwise([(0.0, 0.0), *corners])]
    return np.ascontiguousarray(np.concatenate([*parts, [corners[-1]]]).T)


def by_rates(material: JointMaterial, start: Array, rate: tuple[float, float], *, corner: bool) -> Array:
    """p, |τ|, κ, plastic closure and dissipated energy after unit time at rates of closure and slip, from the cap.

    The rate equations of the cap, and of its corner with the cone, by Dormand & Prince, without return mapping.
    """
    shear, friction, cap = material.cap_shear, material.friction, crushing_cap(material)
    curve = closure_curve(material)
    close, slide = rate

    def rates(_: float, y: Array) -> list[float]:
        p, t, kappa = y[:3]
        k, limit = float(stiffness_at(p, curve)), float(strength_at(kappa, cap))
        hardening = -2 * limit**3 * cap[3]
        if corner:
            toward = p + shear * t * friction
            flow = k * close * toward / (2 * k * p * toward + hardening)
            dp = k * (close - 2 * flow * p)
            dt = friction * dp
        else:
            flow = (p * k * close + shear * t * K_T * slide) / (2 * k * p**2 + 2 * shear**2 * K_T * t**2 + hardening)
            dp, dt = k * (close - 2 * flow * p), K_T * (slide - 2 * flow * shear * t)
        plastic = 2 * flow * p
        return [dp, dt, 2 * flow * limit, plastic, p * plastic + t * (slide - dt / K_T)]

    done = solve_ivp(
        rates, (0, 1), start, method="DOP853", rtol=1e-12, atol=1e-13 * np.abs([1e7, 1e7, 1e-3, 1e-3, 1e3])
    )
    assert done.success
    return np.asarray(done.y[:, -1])


@pytest.mark.parametrize("name", sorted(set(MATERIALS) - {"sudden"}))
@pytest.mark.parametrize("steps", [1, 7, 200])
def test_pure_compression_follows_cap(name: str, steps: int) -> None:
    """−σ = σ_c(κ) for the closure c(σ_c) + κ, to 1e-10, in steps of any length; the dissipation is ∫ σ_c dκ."""
    material = MATERIALS[name]
    cap, curve = crushing_cap(material), closure_curve(material)
    kappa = np.sort(np.append(np.linspace(1e-6, 3e-3, steps), 8e-5))
    exact = np.array([strength_at(k, cap) for k in kappa])
    closure = kappa + [closure_at(p, curve) for p in exact]
    normal, tangential, histories = follow(law(material), -closure, 0 * closure)
    assert -normal == pytest.approx(exact, rel=1e-10)
    assert not tangential.any()
    assert histories[SEAT] == pytest.approx(kappa, rel=1e-9)
    assert histories[CRUSHED] == pytest.approx(kappa, rel=1e-9)
    assert histories[FRICTION_WORK] == pytest.approx([work_until(k, cap) for k in kappa], rel=1e-9)


@pytest.mark.parametrize("material", [SOFT, PARABOLA, MATERIALS["closing"]])
def test_crushing_dissipates_fracture_energy(material: JointMaterial) -> None:
    """∫ −σ dδ over the whole closure is G_c to 1e-6, and so is the dissipation recorded by the point."""
    path = np.concatenate([np.linspace(0, 2e-4, 100_001), np.linspace(2e-4, 2e-2, 100_001)[1:]])
    normal, _, histories = follow(law(material), -path, 0 * path)
    assert np.trapezoid(-normal, path) == pytest.approx(ENERGY, rel=1e-6)
    assert histories[FRICTION_WORK, -1] == pytest.approx(ENERGY, rel=1e-6)


@pytest.mark.parametrize("material", [SOFT, replace(SOFT, compressive_fracture_energy=None), PARABOLA])
def test_shear_on_cap_dissipates_fracture_energy(material: JointMaterial) -> None:
    """Frictionless, a joint that slides on its cap under hardly any pressure dissipates ∫ σ_c dκ."""
    glued = replace(material, friction=0.0, cohesion=1e8, tensile_strength=1e8)
    slip = np.linspace(0, 2e-2, 20_001)
    _, tangential, histories = follow(law(glued), np.full_like(slip, -1e-9), slip)
    spent = histories[FRICTION_WORK, -1]
    assert np.trapezoid(tangential, slip) - tangential[-1] ** 2 / (2 * K_T) == pytest.approx(spent, rel=1e-4)
    assert spent == pytest.approx(work_until(histories[CRUSHED, -1], crushing_cap(material)), rel=1e-12)
    if material.compressive_fracture_energy:
        assert spent == pytest.approx(ENERGY, rel=0.03)  # the tail is long: e^(−κ f / G_c)


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.4])
@pytest.mark.parametrize("material", [MATERIAL, SOFT])
def test_return_mapping_is_exact_on_proportional_path(material: JointMaterial, ratio: float) -> None:
    """If C k_t = k_n and slip is C τ / p times closure, traction and flow keep their directions: 1e-10 for any step."""
    shear = 9.0
    rise = np.sqrt(1 + shear * ratio**2)
    first = STRENGTH / rise / K_N
    start = np.array([STRENGTH / rise, ratio * STRENGTH / rise, 0.0, 0.0, 0.0])
    far = 6e-4
    exact = by_rates(material, start, (far, shear * ratio * far), corner=False)
    closure = np.array([first, first + 0.3 * far, first + far])
    normal, tangential, histories = follow(law(material), -closure, shear * ratio * closure)
    found = [-normal[-1], tangential[-1], *histories[[CRUSHED, SEAT, FRICTION_WORK], -1]]
    assert found == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize(
    ("start", "rate", "corner"),
    [
        pytest.param((0.9, np.sqrt(0.19 / 9)), (1e-5, 8e-5), False, id="face"),
        pytest.param((0.6, 0.8 / 3), (3e-4, -2e-4), False, id="face, sliding back"),
        pytest.param(None, (2e-4, 3e-3), True, id="corner"),
        pytest.param(None, (2.5e-4, 6e-3), True, id="corner, farther"),
    ],
)
@pytest.mark.parametrize("material", [SOFT, MATERIALS["closing"]], ids=["soft", "closing"])
def test_return_mapping_converges_to_rate_equations(
    material: JointMaterial, start: tuple[float, float] | None, rate: tuple[float, float], corner: bool
) -> None:
    """The error of the implicit mapping halves with the step, and is removed by extrapolation."""
    if start is None:  # |τ| = c + p tan φ on the cap
        a, b, c = 1 + 9 * 0.75**2, 2 * 9 * 0.75 * 3e5, 9 * 3e5**2 - STRENGTH**2
        p = (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a)
        t = 3e5 + 0.75 * p
    else:
        p, t = start[0] * STRENGTH, start[1] * STRENGTH
    exact = by_rates(material, np.array([p, t, 0, 0, 0]), rate, corner=corner)
    closure, slip = float(closure_at(p, closure_curve(material))), t / K_T
    found = []
    for n in (2000, 4000):
        way = np.linspace(0, 1, n + 1)
        normal, tangential, histories = follow(law(material), -closure - rate[0] * way, slip + rate[1] * way)
        found.append(np.array([-normal[-1], tangential[-1], *histories[[CRUSHED, SEAT, FRICTION_WORK], -1]]))
    coarse, fine = (np.abs(each / exact - 1).max() for each in found)
    assert fine < 1e-3
    assert fine < 0.6 * coarse + 1e-9
    assert 2 * found[1] - found[0] == pytest.approx(exact, rel=2e-6)


def test_closure_follows_its_curve_and_stores_its_work() -> None:
    """dp/dδ = k_n + g p up to the largest stiffness, by central differences; a closed cycle loses no work."""
    material = replace(MATERIAL, compressive_strength=None, closure=CLOSING)
    found, curve = law(material), closure_curve(material)
    closure = np.linspace(1e-7, 2e-4, 2000)
    normal, _, histories = follow(found, np.concatenate([-closure, -closure[::-1]]), np.zeros(4000))
    assert normal[:2000] == pytest.approx(normal[2000:][::-1], rel=1e-12)
    assert not histories[[FRICTION_WORK, DAMPED_WORK, SEAT, CRUSHED]].any()
    pressure, h = -normal[:2000], 1e-9
    slope = (follow(found, -closure - h, 0 * closure)[0] - follow(found, -closure + h, 0 * closure)[0]) / (-2 * h)
    assert slope == pytest.approx(np.minimum(K_N + CLOSING.growth * pressure, CLOSING.stiffest), rel=1e-3)
    assert slope == pytest.approx([stiffness_at(p, curve) for p in pressure], rel=1e-3)
    assert pressure.max() > 1.1 * (CLOSING.stiffest - K_N) / CLOSING.growth
    assert [closure_at(p, curve) for p in pressure] == pytest.approx(closure, rel=1e-12)
    stored = np.array([stored_at(p, curve) for p in pressure])
    fine = np.linspace(0, closure[-1], 200_001)
    work = np.trapezoid([pressure_at(c, curve) for c in fine], fine)
    assert stored[-1] == pytest.approx(work, rel=1e-8)
    last = np.zeros((found.rows, 1))
    assert found.energy(-closure[-1:], normal[1999:2000], np.zeros(1), last) == pytest.approx(stored[-1:])
    assert found.stiffest == CLOSING.stiffest


def test_crushed_joint_unloads_along_its_curve_and_opens_at_plastic_closure() -> None:
    found = law(MATERIALS["closing"])
    far = 4e-4
    path = np.concatenate([np.linspace(0, far, 200), np.linspace(far, 0, 2000)])
    normal, _, histories = follow(found, -path, 0 * path)
    seat = histories[SEAT, -1]
    assert seat > 1e-4
    curve = closure_curve(MATERIALS["closing"])
    assert -normal[200:] == pytest.approx(
        [pressure_at(c - seat, curve) if c > seat else -secant(seat - c) for c in path[200:]], rel=1e-9, abs=1e-6
    )


def secant(opening: float) -> float:
    """Traction of `MATERIAL` at an opening from its plastic closure, at first loading."""
    first, last = 2e5 / K_N, 2 * 20.0 / 2e5
    return K_N * opening if opening < first else 2e5 * max(0.0, 1 - (opening - first) / (last - first))


def jumps(least: float, most: float) -> st.SearchStrategy[float]:
    """Jumps [m] rounded to a picometre: the squares of jumps of 1e-89 m underflow."""
    return st.floats(least, most).map(lambda jump: round(jump, 12))


corners = st.lists(st.tuples(jumps(-4e-4, 2e-4), jumps(-1e-3, 1e-3)), min_size=1, max_size=5)


@given(corners=corners, name=st.sampled_from(sorted(MATERIALS)), viscosity=st.sampled_from([0.0, 1.0]))
@settings(max_examples=40)
def test_tractions_stay_within_cap_and_cone(corners: list[tuple[float, float]], name: str, viscosity: float) -> None:
    material = MATERIALS[name]
    opening, slip = legs(*corners, steps=40)
    normal, tangential, histories = follow(law(material), opening, slip, viscosity)
    cap, damage = crushing_cap(material), histories[DAMAGE]
    limit = np.array([strength_at(k, cap) for k in histories[CRUSHED]])
    assert (np.hypot(np.minimum(normal, 0), 3 * tangential) <= limit * (1 + 1e-9)).all()
    assert (normal <= 2e5 * (1 - damage) * (1 + 1e-9) + 1e-6).all()
    assert (np.abs(tangential) <= 3e5 * (1 - damage) - 0.75 * normal + 1e-3).all()
    for row in (FRICTION_WORK, DAMAGE, SEAT, CRUSHED):
        assert (np.diff(histories[row], prepend=0.0) >= -1e-12 * np.abs(histories[row])).all()
    assert (np.diff(histories[DAMPED_WORK], prepend=0.0) >= -1e-9).all()


@given(corners=corners, name=st.sampled_from(sorted(MATERIALS)))
@settings(max_examples=12)
def test_no_path_gains_energy(corners: list[tuple[float, float]], name: str) -> None:
    """∫ σ dδ + τ ds − Ψ never decreases and converges to the recorded dissipation, also for closed loops."""
    found = law(MATERIALS[name])
    opening, slip = legs(*corners, (0.0, 0.0), steps=2000)
    normal, tangential, histories = follow(found, opening, slip)
    seat = histories[SEAT]
    points = kernel_law([MATERIALS[name]], np.zeros(len(opening), dtype=np.int64))
    stored = points.energy(opening, normal, tangential, histories)
    assert (stored >= -1e-9).all()
    done = (normal[1:] + normal[:-1]) / 2 * np.diff(opening) + (tangential[1:] + tangential[:-1]) / 2 * np.diff(slip)
    lost = np.concatenate([[0.0], np.cumsum(done) - stored[1:]])
    passing = 5 * (4e11 * np.abs(np.diff(opening)).max() ** 2 + K_T * np.abs(np.diff(slip)).max() ** 2)
    allowed = len(corners) * passing + 1e-300
    assert (np.maximum.accumulate(lost) - lost).max() <= allowed
    assert lost[-1] == pytest.approx(histories[FRICTION_WORK, -1], rel=0.02, abs=allowed)
    assert (seat >= 0).all()


@given(
    corners=st.lists(st.tuples(st.floats(-1e-4, 3e-4), st.floats(-1e-3, 1e-3)), min_size=2, max_size=20),
    energies=st.sampled_from([(None, None), (5.0, None), (5.0, 80.0), (0.0, 0.0)]),
    viscosity=st.sampled_from([0.0, 0.5]),
)
@settings(max_examples=50)
def test_law_without_cap_and_closure_equals_softening_law(
    corners: list[tuple[float, float]], energies: tuple[float | None, float | None], viscosity: float
) -> None:
    plain = replace(MATERIAL, compressive_strength=None, fracture_energy_1=energies[0], fracture_energy_2=energies[1])
    one = np.zeros(1, dtype=np.int64)
    closing = replace(plain, closure=CLOSING)
    both = kernel_law([plain, closing], one)
    assert both.law == INTERFACE
    soft = KernelLaw(SOFTENING, both.segments, np.array([SOFTENING.constants(plain)]))
    opening, slip = np.array(corners).T.copy()
    (*found, after), (*expected, rows) = (follow(each, opening, slip, viscosity) for each in (both, soft))
    assert np.array(found) == pytest.approx(np.array(expected), rel=1e-12, abs=1e-9)
    assert after[: len(rows)] == pytest.approx(rows, rel=1e-12, abs=1e-12)


G_I, G_II, F_T, C = 20.0, 60.0, 2e5, 3e5
CURVED = replace(SOFT, fracture_energy_1=G_I, fracture_energy_2=G_II, softening="exponential")


def test_exponential_softening_in_opening_dissipates_fracture_energy() -> None:
    """σ = f_t exp(−(δ − δ_e) / a), a = G_I / f_t − δ_e / 2, unloading to the origin; ∫ σ dδ = G_I to 1e-6."""
    first = F_T / K_N
    scale = G_I / F_T - first / 2
    opening = np.append(np.linspace(0, first, 50), first + np.linspace(0, 20 * scale, 20_001)[1:])
    normal, _, histories = follow(law(CURVED), opening, 0 * opening)
    exact = np.minimum(K_N * opening, F_T * np.exp(-(opening - first) / scale))
    whole = opening < first + 16 * scale
    assert normal[whole] == pytest.approx(exact[whole], rel=1e-9, abs=1e-6 * F_T)
    assert not normal[~whole][1000:].any()
    assert np.trapezoid(normal, opening) == pytest.approx(G_I, rel=1e-6)
    assert histories[FRICTION_WORK, -1] == pytest.approx(G_I, rel=1e-6)
    back, _, _ = follow(law(CURVED), np.array([first + scale, 0.5 * (first + scale)]), np.zeros(2))
    assert back == pytest.approx([F_T / math.e, F_T / math.e / 2], rel=1e-12)


def test_exponential_softening_in_shear_dissipates_fracture_energy() -> None:
    """τ = c exp(−c s_p / G_II) without pressure, s_p = s − τ / k_t; the area is G_II to 0.2 %."""
    slip = np.linspace(0, 20 * G_II / C, 20_001)
    _, tangential, histories = follow(law(CURVED), 0 * slip, slip)
    plastic = slip - tangential / K_T
    slides = plastic[:-1] > 1e-12
    # Damage follows from the slip before the step.
    assert tangential[1:][slides] == pytest.approx(C * np.exp(-C * plastic[:-1][slides] / G_II), rel=1e-9, abs=1e-6 * C)
    assert np.trapezoid(tangential, slip) == pytest.approx(G_II, rel=2e-3)
    assert histories[FRICTION_WORK, -1] == pytest.approx(G_II, rel=2e-3)


def test_both_modes_share_one_damage_on_exponential_branch() -> None:
    """D = 1 − exp(−(x_I² + x_II²)^{1/2}), with x the inelastic jump of a mode in units of its branch's mean jump."""
    first = F_T / K_N
    scale = G_I / F_T - first / 2
    slip = np.linspace(0, 0.7 * G_II / C, 4_001)
    jumps = np.append(0 * slip, [first + 0.5 * scale] * 2), np.append(slip, [slip[-1]] * 2)
    normal, _, after = follow(law(CURVED), *jumps)
    mean = np.hypot(0.5, after[HISTORY.index("slipped"), -2] * C / G_II)
    assert after[DAMAGE, -1] == pytest.approx(1 - np.exp(-mean), rel=1e-9)
    left = F_T * np.exp(-mean) * (first + 0.5 * scale) / (first + mean * scale)
    assert normal[-1] == pytest.approx(left, rel=1e-9)


def test_snap_back_dissipates_all_stored_energy() -> None:
    """G_c = 200 J/m² is less than f² / (2 k) = 556 J/m²: the joint fails at once and dissipates all stored energy."""
    found = law(MATERIALS["sudden"])
    path = np.linspace(0, 3e-3, 60_001)
    normal, _, histories = follow(found, -path, 0 * path)
    assert -normal.min() == pytest.approx(STRENGTH, rel=1e-3)
    assert histories[FRICTION_WORK, -1] == pytest.approx(STRENGTH**2 / (2 * K_N), rel=0.01)
    assert histories[FRICTION_WORK, -1] == pytest.approx(np.trapezoid(-normal, path), rel=0.01)


def test_kernel_of_wall_with_crushing_joints() -> None:
    """Plastic and softening joints may be combined with them; walls without crushing joints keep simpler kernels."""
    one = np.zeros(1, dtype=np.int64)
    dry = replace(MATERIAL, compressive_strength=None, fracture_energy_1=None)
    soft = replace(dry, fracture_energy_1=1.0)
    for materials, expected in (
        ([dry], COULOMB),
        ([dry, soft], SOFTENING),
        ([dry, MATERIAL], INTERFACE),
        ([soft, MATERIAL], INTERFACE),
        ([dry, soft, MATERIAL], INTERFACE),
    ):
        assert kernel_law(materials, one).law == expected
    assert INTERFACE.kernel is interface_kernel
    assert INTERFACE.row("plastic slip") == PLASTIC_SLIP


def test_cap_limits_shear_without_pressure() -> None:
    """For σ ≥ 0 the cap continues at τ = σ_c / C^{1/2}, with the same limit on both sides of σ = 0."""
    strong = replace(MATERIAL, cohesion=1e8, tensile_strength=1e6, fracture_energy_1=None)
    for opening in (-1e-12, 0.0, 1e-12, 5e-6):
        _, tangential, histories = follow(law(strong), np.full(2, opening), np.array([1e-2, 2e-2]))
        assert tangential[-1] == pytest.approx(STRENGTH / 3, rel=1e-6)
        assert histories[SEAT, -1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "breaks"),
    [
        ({}, False),
        ({"cohesion": 3e5, "tensile_strength": 2e5}, False),
        ({"compressive_strength": STRENGTH}, False),
        ({"compressive_strength": STRENGTH, "peak_closure": 9e-5}, False),
        ({"closure": CLOSING}, False),
        ({"fracture_energy_1": 20.0, "fracture_energy_2": 20.0}, False),  # dry: nothing to lose
        ({"cohesion": 3e5, "tensile_strength": 2e5, "fracture_energy_1": 0.0}, True),
        ({"cohesion": 3e5, "tensile_strength": 0.0, "fracture_energy_1": 20.0}, False),  # nor in opening alone
        ({"cohesion": 3e5, "tensile_strength": 0.0, "fracture_energy_1": 20.0, "fracture_energy_2": 20.0}, True),
        ({"cohesion": 3e5, "tensile_strength": 0.0, "fracture_energy_1": 0.0}, True),
        ({"compressive_strength": STRENGTH, "compressive_fracture_energy": ENERGY}, True),
    ],
)
def test_joints_that_lose_strength_can_break(changes: dict[str, Any], breaks: bool) -> None:
    """Also combined with a joint that keeps its strength, which does not count as breaking."""
    dry = JointMaterial(0.75, elasticity=Stiffness(K_N, K_T))
    other = replace(dry, compressive_strength=STRENGTH, closure=CLOSING)
    material = replace(dry, **changes)
    assert kernel_law([material], np.zeros(1, dtype=np.int64)).can_break is breaks
    assert kernel_law([material, other], np.arange(2)).can_break is breaks
    assert not kernel_law([material, other], np.ones(1, dtype=np.int64)).can_break
