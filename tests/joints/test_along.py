"""Points between the ends of joints: same work as the ends, and integration along the joint."""

import numpy as np
import pytest

from runningbond.joints import lobatto
from runningbond.joints.along import Along, along, gather_along, scatter_along, to_ends, to_points
from runningbond.joints.compiled import kernel
from runningbond.scene import Array

PAIRS = np.array([[0, 3], [1, 4], [2, 2]])
AREA = np.array([0.1, 0.2, 0.3, 0.1, 0.4])


@kernel
def gather_ends(motion: Array, geometry: tuple[Array], opening: Array, slip: Array) -> None:
    opening[:] = motion
    slip[:] = geometry[0] * motion


@kernel
def scatter_ends(normal: Array, tangential: Array, geometry: tuple[Array], force: Array) -> None:
    force -= normal + geometry[0] * tangential


@pytest.mark.parametrize("points", [2, 3, 5])
def test_points_do_same_work_as_ends(points: int) -> None:
    """Σ A_p t_p δ_p = Σ A_e t_e δ_e for any tractions and jumps; a single end acts as the first point of a pair."""
    rng = np.random.default_rng(points)
    geometry, area = along((), PAIRS, AREA, lobatto(points))
    jump, traction = rng.normal(size=5), rng.normal(size=3 * points)
    at_points, at_ends = np.zeros(3 * points), np.zeros(5)
    to_points(jump, geometry.pairs, geometry.share, at_points)
    to_ends(traction, geometry.pairs, geometry.share, geometry.weight, geometry.scale, at_ends)
    assert area.reshape(points, 3)[:, :2].sum() == pytest.approx(AREA[[0, 1, 3, 4]].sum())
    assert area[2::3].sum() == pytest.approx(lobatto(points).weights[0] * AREA[2])
    assert (area * traction) @ at_points == pytest.approx((AREA * at_ends) @ jump, rel=1e-12)
    assert at_points[2::3] == pytest.approx(jump[2])
    to_ends(np.full(3 * points, 7.0), geometry.pairs, geometry.share, geometry.weight, geometry.scale, at_ends)
    assert at_ends[[0, 3]] == pytest.approx(7.0)
    assert at_ends[2] == pytest.approx(7.0 * lobatto(points).weights[0])


def test_end_kinematics_are_interpolated_to_points() -> None:
    factor = np.array([1.0, 2.0, -1.0, 0.5, 3.0])
    geometry, _ = along((factor,), PAIRS, np.ones(5), lobatto(3))
    motion = np.arange(5.0)
    opening, slip, force = np.zeros(9), np.zeros(9), np.zeros(5)
    gather_along(gather_ends)(motion, tuple(geometry), opening, slip)
    assert opening.reshape(3, 3).tolist() == [[0, 1, 2], [1.5, 2.5, 2], [3, 4, 2]]
    assert slip[:3] == pytest.approx((factor * motion)[[0, 1, 2]])
    # Two points are the ends themselves.
    ends, _ = along((factor,), PAIRS[:2], np.ones(5), lobatto(2))
    scatter_along(scatter_ends)(np.arange(4.0), np.ones(4), tuple(ends), force)
    assert force == pytest.approx([-0 - 1, -1 - 2, 0, -2 - 0.5, -3 - 3])
    assert isinstance(ends, Along)
