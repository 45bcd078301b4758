"""Quantities derived from the rows of a response, whose numbers are known."""

import math

import numpy as np
import pytest

from runningbond.response import Response
from runningbond.response.response import ENERGIES, supplied, unaccounted, until_fallen

ENERGY = np.array(
    [  # work of the ground and of the weight, kinetic, stored, friction, damped
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [8.0, -4.0, 2.0, 1.0, 0.5, 0.25],
        [-2.0, 4.0, 1.0, 0.5, 0.25, 0.0],
    ]
)


def response(
    fallen: tuple[int, int, int] = (0, 0, 0), drift: tuple[float, float, float] = (0.0, -0.3, 0.1)
) -> Response:
    """Three rows for a wall with two points."""
    return Response(
        scene="wall",
        model="dem-dynamic",
        scale=2.0,
        verdict="stands",
        message="stands; and so on",
        points=np.array([[0.0, 1.0], [1.0, 1.0]]),
        time=np.array([0.1, 0.2, 0.3]),
        ground=np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),
        displacement=np.arange(12.0).reshape(3, 2, 2),
        drift=np.array(drift),
        reaction=np.array([[7.0, 8.0], [9.0, 10.0], [11.0, 12.0]]),
        energy=ENERGY,
        fallen=np.array(fallen),
        first=np.array([5, 3]),
        motion=np.zeros((6, 3)),
        shape=np.zeros((6, 3)),
        unaccounted=0.0,
        steps=3,
    )


def test_ledger_residual_is_supplied_less_present_energy() -> None:
    """4 J less 3.75 J, and 2 J less 1.75 J; ground and weight did 10 J and 8 J of work, counting either sign."""
    assert supplied(ENERGY).tolist() == [0.0, 4.0, 2.0]
    assert response().residual.tolist() == [0.0, 0.25, 0.25]
    assert unaccounted(ENERGY, 0.0) == pytest.approx(0.25 / 18)
    assert unaccounted(ENERGY, 50.0) == pytest.approx(0.25 / 50)  # little was supplied
    assert unaccounted(np.zeros((2, 6)), 0.0) == 0.0


def test_response_counts_until_a_block_has_fallen() -> None:
    """Including the row in which the block has fallen."""
    assert until_fallen(ENERGY, np.array([0, 1, 1])).tolist() == ENERGY[:2].tolist()
    assert until_fallen(ENERGY, np.zeros(3, dtype=int)) is ENERGY
    for fallen, peak in (((0, 0, 0), 0.4), ((0, 1, 2), 0.3), ((1, 1, 2), 0.1)):
        found = response(fallen, (-0.1, -0.3, 0.4))
        assert (found.peak_drift, found.residual_drift) == (peak, 0.4)


def test_response_table_has_its_numbers_in_named_columns() -> None:
    columns = response((0, 0, 1)).columns()
    assert columns["time [s]"].tolist() == [0.1, 0.2, 0.3]
    assert (columns["ground x [m/s²]"].tolist(), columns["ground y [m/s²]"].tolist()) == ([1, 3, 5], [2, 4, 6])
    places = [columns[f"point {k} {axis} [m]"].tolist() for k in (1, 2) for axis in "xy"]
    assert places == [[0, 4, 8], [1, 5, 9], [2, 6, 10], [3, 7, 11]]
    assert (columns["base shear [N]"].tolist(), columns["base pressure [N]"].tolist()) == ([7, 9, 11], [8, 10, 12])
    assert np.column_stack([columns[f"{name} [J]"] for name in ENERGIES]).tolist() == ENERGY.tolist()
    assert (columns["drift"].tolist(), columns["fallen"].tolist()) == ([0.0, -0.3, 0.1], [0, 0, 1])
    said = response((0, 0, 1)).summary()
    assert (said["fallen"], said["time"], said["peak_drift"], said["residual_drift"]) == ([5, 3], 0.3, 0.3, 0.1)
    assert not any(isinstance(value, float) and math.isnan(value) for value in said.values())
