"""Fragility over a set of records."""

from pathlib import Path

import numpy as np
import pytest

import runningbond as rb
from runningbond.scene.history import pulse


@pytest.mark.long
def test_fragility_of_a_block_over_some_records(tmp_path: Path) -> None:
    """Half sines that differ in nothing but the unit they are written in bring it down at one peak acceleration."""
    time, values = pulse("half-sine", 1.0, 1.0)
    for k, factor in enumerate((0.5, 1.0)):
        rows = np.column_stack([time[::10], factor * values[::10, 0]])
        np.savetxt(tmp_path / f"{k}.csv", rows, delimiter=",")
    wall = rb.Wall.courses(
        [[1]],
        block_width=0.5,
        block_height=2.0,
        thickness=0.12,
        density=1800.0,
        friction=2.0,
        normal_stiffness=1e9,
        shear_stiffness=1e9,
        history={"file": str(tmp_path / "0.csv"), "quantity": "g"},
    )
    records = [tmp_path / "0.csv", tmp_path / "1.csv"]
    found = rb.fragility(wall, records, "dem-dynamic", tolerance=0.05, folder=tmp_path / "kept", jobs=1)
    assert found.left_out == 0
    assert found.intensity[1] == pytest.approx(found.intensity[0], rel=0.05)
    assert found.interval[0] <= found.median <= found.interval[1]
    assert found.probability(found.median * np.array([0.5, 1.0, 2.0])) == pytest.approx([0, 0.5, 1], abs=1e-3)
    again = rb.fragility(wall, records, "dem-dynamic", tolerance=0.05, folder=tmp_path / "kept", jobs=1)
    assert np.array_equal(again.intensity, found.intensity)


def test_a_wall_without_a_record_has_no_fragility() -> None:
    with pytest.raises(rb.SceneError, match="load.history.file: is missing"):
        rb.fragility(rb.read("panel-01"), ["a.csv"], "dem-dynamic")
