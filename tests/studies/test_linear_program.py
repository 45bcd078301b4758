"""Limit analysis of degenerate walls, at every scale, by two solvers."""

import pytest

from runningbond.studies.stability.linear_program import (
    DEGENERATE,
    QUANTITIES,
    SCALED,
    Degenerate,
    scale_errors,
    solved,
)


@pytest.mark.parametrize("model", SCALED)
@pytest.mark.parametrize("wall", DEGENERATE, ids=lambda wall: wall.what)
def test_degenerate_walls_have_their_load(wall: Degenerate, model: str) -> None:
    """Min of tan φ and width / height, whatever else happens at the same load; grains weigh 1e-7."""
    assert SCALED[model](wall.scene()) == pytest.approx(wall.exact, rel=1e-6)


@pytest.mark.parametrize("model", SCALED)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_the_multiplier_follows_twelve_orders_of_magnitude(quantity: str, model: str) -> None:
    """λ ∝ density, size³ and 1 / load, strengths along with weights, to rounding."""
    assert max(scale_errors(model, quantity)) < 1e-12


@pytest.mark.parametrize("name", ["wall-w1", "wall-w3"])
def test_simplex_and_interior_point_prove_one_number(name: str) -> None:
    case = solved(name)
    assert case.multiplier[1] == pytest.approx(case.multiplier[0], rel=1e-8)
    assert max(case.missed) < 1e-6
