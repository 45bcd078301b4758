"""Corners that touch a block without a joint: a note tells if a mechanism violates that contact."""

from typing import Any

import numpy as np
import pytest

from runningbond import Wall
from runningbond.models.corners import corners_on_corners, corners_on_sides
from tests.at_length import at_length

NOTE = "contact at the corner (0.4, 0) m, which touches a block without a joint, is left out"
IN_TWO = [
    [[-1, -0.5], [0.4, -0.5], [0.4, 0], [-1, 0]],
    [[0.4, -0.5], [2, -0.5], [2, 0.3], [0.7, 0.3], [0.4, 0]],
]
"""The same ground in two pieces, with corners at the toe of the block."""

NOTCHED = [[-1, -0.5], [2, -0.5], [2, 0.3], [0.7, 0.3], [0.4, 0], [-1, 0]]
"""Ground whose slope of 45° begins at the toe of a block that is 0.4 m wide."""


def block(*outlines: list[list[float]], direction: str = "right", **changes: Any) -> Wall:
    keys: dict[str, Any] = {
        "thickness": 0.2,
        "density": 2000.0,
        "young": 1e11,
        "friction": 0.2,
        "normal_stiffness": 1e10,
        "shear_stiffness": 1e10,
        "ground": [NOTCHED],
        "live": {"kind": "lateral", "direction": direction},
    }
    return Wall.outlines(list(outlines) or [[[0, 0], [0.4, 0], [0.4, 0.8], [0, 0.8]]], **keys | changes)


@pytest.mark.parametrize("model", ["limit", "limit-nonassociated", "dem-dynamic", *at_length("dem-static", "fem")])
def test_toe_that_slides_into_the_slope_of_its_notch_is_told(model: str) -> None:
    """λ = tan φ = 0.2 at small displacements; at finite ones the block topples at b / h = 0.5 (`test_reentrant`)."""
    result = block().run(model)
    assert result.lower == pytest.approx(0.2, rel=0.01)
    assert f"{NOTE}: the wall may bear more" in result.message
    assert NOTE in block(ground=IN_TWO).run(model).message


def test_nothing_is_told_of_toes_that_stay_or_move_away() -> None:
    assert NOTE not in block(direction="left").run("limit").message
    topples = block(friction=1.0).run("limit")
    assert topples.lower == pytest.approx(0.5)
    assert NOTE not in topples.message


def test_corners_in_notches_and_on_sides_have_no_joints() -> None:
    """The toe is in the notch of the ground, and a tip of the stone on the slope touches the block's side."""
    leaning = [[0.4, 0.2], [0.55, 0.15], [0.7, 0.3]]
    wall = block([[0, 0], [0.4, 0], [0.4, 0.8], [0, 0.8]], leaning)
    corner, side, _ = corners_on_sides(wall.scene)
    blocks = wall.scene.blocks
    touching = zip(blocks.vertices[corner].tolist(), blocks.owner[corner], blocks.owner[side], strict=True)
    assert sorted(touching) == [([0.4, 0.0], 0, 2), ([0.4, 0.2], 1, 0)]


def test_bonded_walls_have_joints_wherever_blocks_touch() -> None:
    wall = Wall.running_bond(
        length=2.0,
        height=1.0,
        block_width=0.4,
        block_height=0.2,
        thickness=0.2,
        density=2000.0,
        friction=0.6,
        live={"kind": "lateral"},
    )
    assert not len(corners_on_sides(wall.scene).corner)
    assert not len(corners_on_corners(wall.scene).corner)


def test_corners_that_meet_crosswise_touch_along_either_side() -> None:
    """Four squares at a point: of each diagonal pair, two sides of each block keep them apart."""
    squares = [[[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]] for y in (0.0, 1.0) for x in (0.0, 1.0)]
    scene = block(*squares, ground=[[[-1, -1], [3, -1], [3, 0], [-1, 0]]]).scene
    corner, side, place = corners_on_corners(scene)
    assert (scene.blocks.vertices[corner] == 1.0).all()
    assert np.bincount(place).tolist() == [4, 4]
    pairs = np.sort(scene.blocks.owner[np.column_stack([corner, side])])
    assert {tuple(pair) for pair in pairs.tolist()} == {(0, 3), (1, 2)}
