"""Small and finite displacements: a block loses λ with the tangent, walls like one block of their height."""

import math

import numpy as np
import pytest

from runningbond.scene import Array
from runningbond.studies.stability.displacements import (
    ALONE,
    HEIGHT,
    LOSSES,
    MOVED,
    TALL,
    THEORY,
    WIDTH,
    as_one_block,
    curves,
    displacement_at,
    measure,
    scene_of,
)

Curves = tuple[float, Array, Array, Array]


@pytest.fixture(scope="module")
def rocking() -> Curves:
    return curves(*scene_of("block"), ALONE)


@pytest.mark.long
def test_block_loses_resistance_at_the_exact_displacements(
    rocking: Curves,
) -> None:
    """Losses of 1, 2, 5 and 10 %, from λ(θ) = tan(α − θ) with u = h sin θ, to 0.2 %."""
    peak, moved, small, finite = rocking
    assert peak == pytest.approx(0.5, rel=1e-6)
    alpha = math.atan(0.5)
    for d in LOSSES:
        theory = as_one_block(peak, HEIGHT / WIDTH, d)
        theta = alpha - math.atan((1 - d) * 0.5)
        assert theory == pytest.approx(1.0 * math.sin(theta) / 0.5)
        assert theory == pytest.approx(d * 2 / (0.5 + 1 / 0.5), rel=1.1 * d)
        assert displacement_at(moved, 1 - finite / small, d) == pytest.approx(theory, rel=2e-3)


@pytest.mark.long
def test_block_resistance_follows_the_tangent(rocking: Curves) -> None:
    _, moved, small, finite = rocking
    theta = np.arcsin(moved * WIDTH / HEIGHT)
    exact = np.tan(math.atan(0.5) - theta)
    turned = theta > 0.005
    assert turned.sum() > 100
    assert finite[turned] == pytest.approx(exact[turned], rel=2e-4)
    assert small[turned] == pytest.approx(0.5, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(("name", "height"), [("W1", 6 * 0.175), ("W2", 10 * 0.175)])
def test_wall_loses_resistance_like_one_block_of_its_height(name: str, height: float) -> None:
    """To 15 %, for losses from 2 %."""
    row = measure(name)
    assert row[TALL] * scene_of(name)[1] == pytest.approx(height)
    for moved, theory in zip(MOVED[1:], THEORY[1:], strict=True):
        assert row[moved] == pytest.approx(row[theory], rel=0.15)
