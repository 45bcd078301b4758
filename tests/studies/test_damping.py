"""Verdicts with too little and too much damping, against theory."""

import pytest

from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.studies import Row
from runningbond.studies.stability.damping import (
    LOCALS,
    MAPS,
    VISCOSITIES,
    fits,
    judged,
    least_local,
    most_local,
    most_mass_rate,
)
from runningbond.studies.walls import SLIDING, TOPPLING, W1


def off(edge: Row) -> float:
    """Relative error of the measurement against theory, in units of its tolerance."""
    return float(abs(edge["measured"] / edge["theory"] - 1) / edge["allowed"])


def test_local_damping_has_the_exact_decay_rate() -> None:
    """Each half cycle leaves √((1 − α)/(1 + α)) of the amplitude; to 3 %."""
    edge = least_local()
    assert off(edge) <= 1
    assert edge["allowed"] == 0.03


def test_local_damping_delays_a_fall_by_the_exact_time() -> None:
    """t = (2 u (M / F) / ((1 − α) d))^{1/2}, to 3 %."""
    edge = most_local()
    assert off(edge) <= 1
    assert edge["allowed"] == 0.03


@pytest.mark.parametrize("wall", [SLIDING, TOPPLING])
def test_mass_proportional_damping_gives_false_rest_beyond_the_exact_rate(wall: str) -> None:
    """The unbalanced force decays as e^{−(1−α) c t} before the block has moved far; to 2 %."""
    edge = most_mass_rate(wall)
    assert off(edge) <= 1
    assert edge["allowed"] == 0.02


@pytest.mark.long
def test_heavy_mass_proportional_damping_gives_a_wrong_verdict() -> None:
    assert judged(W1, 1.02, mass_rate=3.0)["verdict"] == "right"
    assert judged(W1, 1.02, mass_rate=100.0)["verdict"] == "wrong"


@pytest.mark.parametrize("load", [0.98, 1.02])
@pytest.mark.parametrize("wall", [SLIDING, W1])
def test_default_damping_is_well_inside_the_range_of_right_verdicts(wall: str, load: float) -> None:
    """From a fifth of its α to nearly 1, and from a third to three times its ξ."""
    around = [(alpha, xi) for alpha in (0.1, LOCAL, 0.9) for xi in (0.03, VISCOUS, 0.3)]
    assert {judged(wall, load, *damping)["verdict"] for damping in around} == {"right"}


@pytest.mark.parametrize("load", [0.98, 1.02])
def test_undamped_wall_is_undecided(load: float) -> None:
    assert judged(SLIDING, load, 0.0, 0.0)["verdict"] == "undecided"


@pytest.mark.parametrize(("viscous", "verdict"), [(0.0, "undecided"), (VISCOUS, "right")])
def test_viscous_damping_removes_chatter_that_local_damping_leaves(viscous: float, verdict: str) -> None:
    """Without viscous damping a wall 2 % above its load creeps; it is not taken to be at rest."""
    assert judged(W1, 1.02, 0.8, viscous, budget=150_000)["verdict"] == verdict


def test_range_of_damping_ends_at_the_first_wrong_verdict() -> None:
    """Around the suite's α and ξ: one wrong verdict at α = 0.2 used to leave the range from 0 on."""
    wrong = {(0.2, VISCOUS), (LOCAL, 3.0)}
    verdicts = [(a, x, "wrong" if (a, x) in wrong else "right") for a in LOCALS for x in VISCOSITIES]
    edges = fits({MAPS: [{"α": a, "ξ": x, "verdict": verdict} for a, x, verdict in verdicts]})
    assert [edge.measured for edge in edges] == [0.35, 0.95, 0.0, 1.0, 2]
    assert edges[-1].agrees is False
