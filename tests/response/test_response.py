"""What a response says of its rows, whose numbers are known."""

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
    """Three rows of a wall of two points."""
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


def test_what_the_ledger_misses_is_what_was_supplied_less_what_there_is() -> None:
    """4 J less 3.75 J, and 2 J less 1.75 J; of works that went 10 J and 8 J far, the ground's and the weight's."""
    assert supplied(ENERGY).tolist() == [0.0, 4.0, 2.0]
    assert response().residual.tolist() == [0.0, 0.25, 0.25]
    assert unaccounted(ENERGY, 0.0) == pytest.approx(0.25 / 18)
    assert unaccounted(ENERGY, 50.0) == pytest.approx(0.25 / 50)  # next to nothing was supplied
    assert unaccounted(np.zeros((2, 6)), 0.0) == 0.0


def test_a_response_counts_until_a_block_has_fallen() -> None:
    """With the row in which it has."""
    assert until_fallen(ENERGY, np.array([0, 1, 1])).tolist() == ENERGY[:2].tolist()
    assert until_fallen(ENERGY, np.zeros(3, dtype=int)) is ENERGY
    for fallen, peak in (((0, 0, 0), 0.4), ((0, 1, 2), 0.3), ((1, 1, 2), 0.1)):
        found = response(fallen, (-0.1, -0.3, 0.4))
        assert (found.peak_drift, found.residual_drift) == (peak, 0.4)


def test_a_table_of_a_response_has_each_number_in_the_column_of_its_name() -> None:
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
