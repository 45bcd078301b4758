"""Small against finite displacements: a block loses λ as the tangent, and walls about as a block of their height."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from runningbond.studies.stability.displacements import LOSSES, SPEEDS, Loss, block, block_edges, draw, loss, wall


@pytest.fixture(scope="module")
def rocking() -> Loss:
    return loss(*block(), SPEEDS[0])


def test_a_block_has_lost_a_share_of_its_resistance_where_theory_says(rocking: Loss) -> None:
    """1, 2, 5 and 10 % of it, from λ(θ) = tan(α − θ) with u = h sin θ, to 0.2 %."""
    assert rocking.peak == pytest.approx(0.5, rel=1e-6)
    assert all(edge.agrees for edge in block_edges(rocking))
    alpha = math.atan(0.5)
    for d in LOSSES:
        theta = alpha - math.atan((1 - d) * 0.5)
        assert rocking.as_a_block(d) == pytest.approx(1.0 * math.sin(theta) / 0.5)
        assert rocking.as_a_block(d) == pytest.approx(d * 2 / (0.5 + 1 / 0.5), rel=1.1 * d)


def test_a_block_follows_the_tangent_all_the_way(rocking: Loss) -> None:
    theta = np.arcsin(rocking.moved * rocking.width / rocking.height)
    exact = np.tan(math.atan(0.5) - theta)
    turned = theta > 0.005
    assert turned.sum() > 500
    assert rocking.finite[turned] == pytest.approx(exact[turned], rel=2e-4)
    assert rocking.small[turned] == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize(("name", "height"), [("W1", 6 * 0.175), ("W2", 10 * 0.175)])
def test_a_wall_loses_about_as_much_as_one_block_of_its_height(name: str, height: float) -> None:
    """To 15 % from a loss of 2 % on; smaller ones are of the size of what the pushing speed adds to λ."""
    found = loss(*wall(name), SPEEDS[0])
    assert found.height == pytest.approx(height)
    for d in LOSSES[1:]:
        assert found.at(d) == pytest.approx(found.as_a_block(d), rel=0.15)
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    draw(figure, [found])
    assert len(figure.axes) == 2
