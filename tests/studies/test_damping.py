"""Verdicts with too little damping and too much, against theory."""

import pytest

from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.studies import Row
from runningbond.studies.stability.damping import judged, least_local, most_local, most_mass_rate
from runningbond.studies.walls import SLIDING, TOPPLING, W1


def off(edge: Row) -> float:
    """Difference of measurement and theory, in the tolerance of the edge."""
    return float(abs(edge["measured"] / edge["theory"] - 1) / edge["allowed"])


def test_a_ringing_block_comes_to_rest_at_the_rate_of_its_local_damping() -> None:
    """Each half cycle leaves √((1 − α)/(1 + α)) of the motion; to 3 %."""
    edge = least_local()
    assert off(edge) <= 1
    assert edge["allowed"] == 0.03


def test_a_fall_takes_as_much_longer_as_local_damping_leaves_of_its_drive() -> None:
    """t = (2 u (M / F) / ((1 − α) d))^{1/2}, to 3 %."""
    edge = most_local()
    assert off(edge) <= 1
    assert edge["allowed"] == 0.03


@pytest.mark.parametrize("wall", [SLIDING, TOPPLING])
def test_mass_proportional_damping_feigns_rest_where_theory_has_it(wall: str) -> None:
    """The unbalanced force dies out as e^{−(1−α) c t} before the block has come far; to 2 %."""
    edge = most_mass_rate(wall)
    assert off(edge) <= 1
    assert edge["allowed"] == 0.02


def test_heavy_mass_proportional_damping_takes_a_falling_wall_for_one_at_rest() -> None:
    assert judged(W1, 1.02, mass_rate=3.0)["verdict"] == "right"
    assert judged(W1, 1.02, mass_rate=100.0)["verdict"] == "wrong"


@pytest.mark.parametrize("load", [0.98, 1.02])
@pytest.mark.parametrize("wall", [SLIDING, W1])
def test_the_suites_damping_stands_amid_what_gives_right_verdicts(wall: str, load: float) -> None:
    """All about it: from a fifth of its α to nearly 1, from a third of its ξ to three times that."""
    around = [(alpha, xi) for alpha in (0.1, LOCAL, 0.9) for xi in (0.03, VISCOUS, 0.3)]
    assert {judged(wall, load, *damping)["verdict"] for damping in around} == {"right"}


@pytest.mark.parametrize("load", [0.98, 1.02])
def test_without_any_damping_no_wall_comes_to_rest(load: float) -> None:
    assert judged(SLIDING, load, 0.0, 0.0)["verdict"] == "undecided"


@pytest.mark.parametrize(("viscous", "verdict"), [(0.0, "undecided"), (VISCOUS, "right")])
def test_local_damping_drags_on_chatter_until_viscosity_takes_it_out(viscous: float, verdict: str) -> None:
    """Without it a wall 2 % beyond its load creeps; it is not taken for one at rest."""
    assert judged(W1, 1.02, 0.8, viscous, budget=150_000)["verdict"] == verdict
