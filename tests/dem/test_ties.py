"""Ties in the static model: law, linear systems, and tied blocks with closed-form solutions."""

from collections.abc import Sequence

import numpy as np
import pytest

from dem.static import dem_static
from dem.static_system import Control, static_system
from dem.tied_law import TiedLaw
from runningbond.joints import PointLaw, PointStrength
from runningbond.scene import (
    Action,
    Array,
    Beam,
    BlockMaterial,
    JointMaterial,
    Lateral,
    Load,
    PointLoad,
    Scene,
    Stiffness,
    Tie,
    build_scene,
)
from runningbond.scene.beam import Drive
from tests.limit.test_limit import rectangle

YOUNG = 2e11


def tie(start: tuple[float, float], end: tuple[float, float], stiffness: float, most: float, preload: float = 0) -> Tie:
    """A tie with a given stiffness [N/m] and yield force [N]."""
    length = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    return Tie(start, end, stiffness * length / YOUNG, YOUNG, most, preload)


def tied(
    blocks: list[Array], ties: Sequence[Tie], *live: Action, friction: float = 5.0, beam: Beam | None = None
) -> Scene:
    """Blocks of 1962 N/m² on a base, .1 m thick."""
    return build_scene(
        "tied",
        blocks,
        thickness=0.1,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(friction, 0.0, 0.0, elasticity=Stiffness(1e10, 4e9)),
        load=Load(live=live),
        beam=beam,
        ties=ties,
    )


PIER, W = rectangle(0, 0, 0.5, 2), 1962.0


def test_tie_law_has_no_compression_yield_and_plastic_elongation() -> None:
    """K = 10, P = 2, Y = 5: force, new history and tangent as functions of elongation and old history."""
    nothing = np.zeros(0)
    joints = PointLaw(PointStrength(nothing, nothing, nothing), nothing, nothing)
    law = TiedLaw(joints, *np.array([[10.0], [5.0], [2.0]]))
    for elongation, before, force, after, tangent in (
        (0.0, 0.0, 2.0, 0.0, 10.0),
        (0.3, 0.0, 5.0, 0.0, 10.0),
        (0.5, 0.0, 5.0, 0.2, 0.0),
        (0.4, 0.2, 4.0, 0.2, 10.0),
        (0.0, 0.2, 0.0, 0.2, 10.0),
        (-0.1, 0.2, 0.0, 0.2, 0.0),
        (0.1, 0.2, 1.0, 0.2, 10.0),
    ):
        found = law(np.array([elongation]), np.zeros(1), np.array([before]))
        assert (found.normal[0], found.plastic_slip[0]) == pytest.approx((force, after), abs=1e-12)
        assert (found.tangential[0], found.tangent[0, 1].any()) == (0.0, False)
        if elongation not in (0.0, 0.3):  # not at a kink
            assert found.tangent[0, 0, 0] == tangent


@pytest.mark.parametrize("multiplier", [True, False])
def test_linear_systems_with_ties_equal_full_matrix(multiplier: bool) -> None:
    """Ties between blocks, to the ground and to an anchor; elastic, half as stiff and slack."""
    blocks = [PIER, rectangle(2, 0, 0.5, 1), rectangle(2, 1, 0.5, 1)]
    ends = (((0.2, 1.7), (2.3, 1.6)), ((0.3, 1.1), (1.4, -0.1)), ((2.2, 0.4), (4.0, 3.0)), ((0.1, 0.3), (2.4, 0.5)))
    system = static_system(tied(blocks, [tie(*two, 1e8, 1e4) for two in ends], Lateral()))
    generator = np.random.default_rng(1)
    tangent = system.elastic * generator.uniform(0.5, 1.5, len(system.elastic))[:, None, None]
    tangent[-2:] *= np.array([0.5, 0.0])[:, None, None]
    jumps = system.opening.toarray(), system.slip.toarray()
    nd = system.freedoms
    matrix = np.zeros((nd + 1, nd + 1))
    matrix[:nd, :nd] = sum(jumps[i].T @ (tangent[:, i, i, None] * jumps[i]) for i in range(2))
    matrix[:nd, nd] = -system.equilibrium.live
    matrix[nd, :nd], matrix[nd, nd] = (0.0, 1.0) if multiplier else (system.equilibrium.live, 0.0)
    right = generator.normal(size=nd + 1)
    exact = np.linalg.solve(matrix, right)
    found = system.solve(tangent, Control(0.0, multiplier), right)
    assert found == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_block_held_by_ties_only_has_regular_matrix() -> None:
    """All joint points are open: only three ties hold the block."""
    ends = (((0.1, 0.1), (-1.0, -1.5)), ((0.4, 0.2), (3.0, -1.5)), ((0.2, 1.9), (-2.0, 3.0)))
    system = static_system(tied([PIER], [tie(*two, 1e8, 1e4) for two in ends], Lateral()))
    tangent, right = np.zeros_like(system.elastic), np.array([1.0, 2.0, 3.0, 0.0])
    tangent[-3:] = system.elastic[-3:]
    found = system.solve(tangent, Control(0.0, multiplier=True), right)
    pull = system.opening.toarray()[-3:]
    assert pull.T @ (system.elastic[-3:, 0, 0] * (pull @ found[:3])) == pytest.approx(right[:3], abs=1e-9)


@pytest.mark.parametrize(("preload", "most"), [(0.0, 1e3), (500.0, 1e3), (1e3, 1e3), (0.0, 3e3)])
def test_tied_block_topples_when_tie_yields(preload: float, most: float) -> None:
    """λ W h/2 = W b/2 + Y h, for any preload."""
    outcome = dem_static(tied([PIER], [tie((-3.0, 2.0), (1e-4, 2.0), 7e6, most, preload)], Lateral()))
    assert outcome.lower == pytest.approx(0.25 + 2 * most / W, rel=1e-6)
    assert outcome.upper == pytest.approx(0.25 + 2 * most / W, rel=0.01)


def test_tie_in_push_direction_goes_slack() -> None:
    outcome = dem_static(tied([PIER], [tie((3.0, 2.0), (0.4999, 2.0), 7e6, 1e3)], Lateral()))
    assert outcome.lower == pytest.approx(0.25, rel=1e-6)


@pytest.mark.parametrize("preload", [0.0, 400.0])
def test_lifted_block_follows_stiffness_of_joint_and_then_of_tie(preload: float) -> None:
    """With e the uplift from the stress-free joint: λ = W + P + (k_n A + K) e below e = 0 (K = 0 there
    without preload), W + P + K e above, and W + Y at the end; (k_n A + K) e = −W − P at rest."""
    k, most, joint = 3e6, 1e3, 1e10 * 0.05
    pressed = joint + (k if preload else 0.0)
    hanging = tied([PIER], [tie((0.25, 1.0), (0.25, -0.1), k, most, preload)], PointLoad((0.25, 2.0), (0.0, 1.0)))
    outcome = dem_static(hanging)
    lift = outcome.curve[:, 0] - (W + preload) / pressed
    exact = np.minimum(W + preload + np.where(lift < 0, pressed, k) * lift, W + most)
    assert outcome.curve[:, 1] == pytest.approx(exact, rel=1e-6, abs=1e-3)
    assert outcome.lower == pytest.approx(W + most, rel=1e-6)
    between = (lift > 0) & (outcome.curve[:, 1] < W + most - 1)
    assert between.sum() >= 3


@pytest.mark.parametrize(("most", "exact"), [(100.0, W / 8 + 100), (1e6, W / 4)])
def test_tied_piers_topple_together_or_tie_yields(most: float, exact: float) -> None:
    """A push F at height h, away from the other pier: F h = W b/2 + Y h, or both piers' 2 W b/2 if that is less."""
    between = tie((0.25, 2 - 1e-6), (3.25, 2 - 1e-6), 7e6, most)
    push = PointLoad((0.0, 2.0), (-1.0, 0.0))
    outcome = dem_static(tied([PIER, rectangle(3, 0, 0.5, 2)], [between], push))
    assert outcome.lower == pytest.approx(exact, rel=1e-5)


def test_mirrored_tie_gives_mirrored_result() -> None:
    def outcome(sign: float) -> tuple[float | None, Array]:
        piers = ((0, 0, 0.5), (3, 0, 1.0), (0, 1, 0.5), (3, 1, 1.0))
        blocks = [rectangle(sign * x - width / 2, y, width, 1) for x, y, width in piers]
        bar = tie((0.0, 1.9), (sign * 3.0, 1.4), 7e6, 300.0, 50.0)
        found = dem_static(tied(blocks, [bar], Lateral((-sign, 0.0))))
        return found.lower, found.curve

    (one, curve), (other, mirrored) = outcome(1.0), outcome(-1.0)
    assert one is not None
    assert 0.26 < one == pytest.approx(other, rel=1e-8)
    rising = curve[:, 1] < 0.99 * one
    assert rising.sum() > 5
    assert mirrored[: len(curve)][rising] == pytest.approx(curve[rising], rel=1e-6)


def test_yielded_tie_is_slack_on_reversal_and_taut_on_reloading() -> None:
    """A level beam under N slides on its block at ±μ N and pulls a tie: λ = ±μ N + T(d), T = min(max(K (d − e), 0), Y)
    with e = d_max − Y / K after the first push; joints are a thousand times as stiff as the tie."""
    k, most, n = 1e6, 800.0, 2e3
    drive = Drive.along((2e-3, -1e-3, 3e-3), at=1.1)
    beam = Beam(0.2, 0.0, "level", (0.0, -n), drive)
    wall = tied([rectangle(0, 0, 2, 1)], [tie((-4.0, 1.1), (0.1, 1.1), k, most)], friction=0.3, beam=beam)
    outcome = dem_static(wall)
    d, force = outcome.curve.T
    first, back = int(np.flatnonzero(np.diff(d) < 0)[0]), int(d.argmin())
    assert d[[first, back, -1]] == pytest.approx([2e-3, -1e-3, 3e-3])
    state = np.arange(len(d))
    pull = np.clip(k * (d - np.where(state <= first, 0.0, 2e-3 - most / k)), 0, most)
    exact = pull + np.where((state > first) & (state <= back), -0.3 * n, 0.3 * n)
    sliding = np.abs(d[:, None] - [0.0, 2e-3, -1e-3]).min(axis=1) > 1e-5  # beyond the joints' elastic deformation
    assert sliding.sum() > 100
    assert force[sliding] == pytest.approx(exact[sliding], rel=2e-3)
    assert outcome.multiplier == pytest.approx(most + 0.3 * n, rel=1e-6)
