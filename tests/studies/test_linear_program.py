"""Limit analysis of degenerate walls, at any scale, with two solvers."""

import pytest

from runningbond.studies.stability.linear_program import (
    DEGENERATE,
    PROGRAMS,
    QUANTITIES,
    degenerate_row,
    scale_row,
    solver_row,
)


@pytest.mark.parametrize("model", PROGRAMS)
@pytest.mark.parametrize("wall", DEGENERATE)
def test_degenerate_walls_have_their_exact_load(wall: str, model: str) -> None:
    """Minimum of tan φ and width / height, whatever else happens at the same load; grains weigh 1e-7."""
    assert degenerate_row(wall, model)["measured"] == pytest.approx(DEGENERATE[wall][1], rel=1e-6)


@pytest.mark.parametrize("model", PROGRAMS)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_multiplier_scales_over_twelve_orders_of_magnitude(quantity: str, model: str) -> None:
    """λ ∝ density, size³ and 1 / load, with strengths scaled like weights, to rounding."""
    assert max(scale_row(model, quantity)["errors"]) < 1e-12


@pytest.mark.parametrize("name", ["wall-w1", "wall-w3"])
def test_simplex_and_interior_point_agree(name: str) -> None:
    row = solver_row(name)
    assert row["λ, simplex"] == pytest.approx(row["λ, interior point"], rel=1e-8)
    assert max(row["simplex misses"], row["interior point misses"]) < 1e-6
