"""Verdicts with too little damping and too much, against theory."""

import pytest
from matplotlib.figure import Figure

from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.studies.stability.damping import experiment, judged, least_local, mapped, most_local, most_mass_rate
from runningbond.studies.stability.literature import KnownWall, rounded_wall, sliding_block, toppling_block


def test_a_ringing_block_comes_to_rest_at_the_rate_of_its_local_damping() -> None:
    """Each half cycle leaves √((1 − α)/(1 + α)) of the motion."""
    edge = least_local()
    assert edge.agrees, edge


def test_a_fall_takes_as_much_longer_as_local_damping_leaves_of_its_drive() -> None:
    """t = (2 u (M / F) / ((1 − α) d))^{1/2}."""
    edge = most_local()
    assert edge.agrees, edge


@pytest.mark.parametrize("wall", [sliding_block(), toppling_block()], ids=lambda wall: str(wall.name))
def test_mass_proportional_damping_feigns_rest_where_theory_has_it(wall: KnownWall) -> None:
    """The unbalanced force dies out as e^{−(1−α) c t} before the block has come far."""
    edge = most_mass_rate(wall, 0.02)
    assert edge.agrees, edge


def test_heavy_mass_proportional_damping_takes_a_falling_wall_for_one_at_rest() -> None:
    wall = rounded_wall("wall-w1")
    assert judged(wall, 1.02, mass_rate=3.0).answer == "right"
    assert judged(wall, 1.02, mass_rate=100.0).answer == "wrong"


@pytest.mark.parametrize("load", [0.98, 1.02])
@pytest.mark.parametrize("wall", [sliding_block(), rounded_wall("wall-w1")], ids=lambda wall: str(wall.name))
def test_the_suites_damping_stands_amid_what_gives_right_verdicts(wall: KnownWall, load: float) -> None:
    """All about it: from a fifth of its α to nearly 1, from a third of its ξ to three times that."""
    around = mapped(wall, load, (0.1, LOCAL, 0.9), (0.03, VISCOUS, 0.3))
    assert {cell.answer for cell in around.cells.values()} == {"right"}


@pytest.mark.parametrize("load", [0.98, 1.02])
def test_without_any_damping_no_wall_comes_to_rest(load: float) -> None:
    assert judged(sliding_block(), load, 0.0, 0.0).answer == "undecided"


@pytest.mark.parametrize(("viscous", "answer"), [(0.0, "undecided"), (VISCOUS, "right")])
def test_local_damping_drags_on_chatter_until_viscosity_takes_it_out(viscous: float, answer: str) -> None:
    """Without it a wall 2 % beyond its load creeps; it is not taken for one at rest."""
    assert judged(rounded_wall("wall-w1"), 1.02, 0.8, viscous, budget=150_000).answer == answer


@pytest.mark.long
def test_every_edge_lies_where_theory_has_it() -> None:
    found = experiment()
    assert not [edge for edge in found.edges if edge.agrees is False]
    assert {row[5] for row in found.rows if row[4] == 0.0} == {"right", "undecided"}
    found.draw(Figure(layout="constrained"))
