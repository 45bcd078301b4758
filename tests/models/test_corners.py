"""Corners on sides bear at a point in every model; a note tells if a mechanism violates the contact of two corners."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond import Wall
from runningbond.models.corners import corners_on_corners
from runningbond.results.store import save_outcome
from tests.at_length import at_length
from tests.checker import check

NOTE = "contact of the corners at (0.4, 0) m, which touch without a joint, is left out: the wall may bear more"
IN_TWO = [
    [[-1, -0.5], [0.4, -0.5], [0.4, 0], [-1, 0]],
    [[0.4, -0.5], [2, -0.5], [2, 0.3], [0.7, 0.3], [0.4, 0]],
]
"""The same ground in two pieces, with corners at the toe of the block."""

FLAT = [[-1, -0.5], [2, -0.5], [2, 0], [-1, 0]]

HEIGHT = 0.8
MODELS = ["limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem"]
FEWER = ["limit", "dem-dynamic", *at_length("limit-nonassociated", "dem-static", "fem")]


def notched(width: float) -> list[list[float]]:
    """Ground whose slope of 45° begins at the toe of a block of a given width."""
    return [[-1, -0.5], [4, -0.5], [4, 0.3], [width + 0.3, 0.3], [width, 0], [-1, 0]]


def block(*others: list[list[float]], width: float = 0.4, last: bool = False, **changes: Any) -> Wall:
    """A block whose toe is in a notch, and other blocks; the block is numbered first, or last."""
    keys: dict[str, Any] = {
        "thickness": 0.2,
        "density": 2000.0,
        "young": 1e11,
        "friction": 0.2,
        "normal_stiffness": 1e10,
        "shear_stiffness": 1e10,
        "ground": [notched(width)],
        "live": {"kind": "lateral"},
    }
    outlines = [[[0, 0], [width, 0], [width, HEIGHT], [0, HEIGHT]], *others]
    return Wall.outlines(outlines[::-1] if last else outlines, **keys | changes)


def sliding_out(friction: float, width: float) -> float:
    """λ at which a block slides out of the notch: it bears on its toe, on the slope, and on its heel.

    With N and the friction μ N at both, λ W = k (W - N_heel) + μ N_heel from the forces, k = (1 + μ) / (1 - μ), and
    N_heel b = W b / 2 - λ W h / 2 from the moments about the toe.
    """
    k, arm = (1 + friction) / (1 - friction), HEIGHT / (2 * width)
    return (k + friction) / 2 / (1 - (k - friction) * arm)


def check_bracket(wall: Wall, model: str, exact: float) -> None:
    result = wall.run(model)
    assert result.status == "collapse"
    assert result.lower is not None
    assert result.lower <= exact * (1 + 1e-6)
    assert result.upper == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("model", MODELS)
def test_toe_in_a_notch_topples(model: str) -> None:
    """λ = b / h, although the bed joint slides at 0.2; `test_reentrant` is the same at finite displacements."""
    check_bracket(block(), model, 0.5)


@pytest.mark.parametrize("model", FEWER)
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_block_slides_out_of_its_notch(model: str, friction: float) -> None:
    check_bracket(block(width=1.2, friction=friction), model, sliding_out(friction, 1.2))


LEANING = [[0.4, 0.2], [0.5, 0.1], [0.65, 0.25]]
"""A stone on the slope, whose tip touches the block's side."""


@pytest.mark.parametrize("model", FEWER)
def test_contacts_do_not_depend_on_the_order_of_blocks(model: str) -> None:
    """The corner is the stone's, or the block's in the notch: of the higher and of the lower number."""
    lower = [block(LEANING, last=last).run(model).lower or 0.0 for last in (False, True)]
    assert lower[0] == pytest.approx(lower[1], rel=1e-6)
    assert lower[0] > 0.51  # the block cannot topple without lifting the stone


@pytest.mark.parametrize("model", FEWER)
def test_glued_joints_give_corners_no_strength(model: str) -> None:
    """Pushed to the left, the toe leaves the slope, which must not hold it."""
    glued: dict[str, Any] = {"friction": 0.2, "cohesion": 1e4, "tensile_strength": 1e3}
    away = {"kind": "lateral", "direction": "left"}
    notched_off, flat = (block(live=away, ground=[ground], **glued).run(model) for ground in (notched(0.4), FLAT))
    assert notched_off.lower == pytest.approx(flat.lower, rel=0.01)


@pytest.mark.parametrize("model", ["limit", "limit-nonassociated"])
def test_checker_puts_both_points_at_the_corner(model: str, tmp_path: Path) -> None:
    """Whatever the inset, and without the strength of other joints."""
    wall = block(LEANING, inset=0.02, cohesion=1e3, tensile_strength=1e3)
    save_outcome(wall.run(model).outcome, tmp_path, "", wall.scene)
    assert check(tmp_path)


@pytest.mark.long
def test_cracks_between_triangles_keep_corner_contacts() -> None:
    """The piece with the toe bears on the slope."""
    strong = {"friction": 1.0, "cohesion": 1e7, "tensile_strength": 5e6}
    inner = {**strong, "normal_stiffness": 1e13, "shear_stiffness": 1e13}
    result = block(inner_joint=inner).run("fem", cracks="blocks")
    assert result.upper == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("model", FEWER)
def test_contact_of_two_corners_is_told(model: str) -> None:
    """Where the ground is cut at the toe, the block slips at λ = tan φ = 0.2 past the corner of the other piece."""
    result = block(ground=IN_TWO).run(model)
    assert result.lower == pytest.approx(0.2, rel=0.01)
    assert NOTE in result.message


def test_nothing_is_told_of_corners_that_stay_or_move_away() -> None:
    away = block(ground=IN_TWO, live={"kind": "lateral", "direction": "left"})
    assert NOTE not in away.run("limit").message
    topples = block(ground=IN_TWO, friction=1.0).run("limit")
    assert topples.lower == pytest.approx(0.5)
    assert NOTE not in topples.message


def test_corners_that_meet_crosswise_touch_along_either_side() -> None:
    """Four squares at a point: of each diagonal pair, two sides of each block keep them apart."""
    squares = [[[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]] for y in (0.0, 1.0) for x in (0.0, 1.0)]
    keys: dict[str, Any] = {"thickness": 0.2, "density": 2000.0, "friction": 0.2, "live": {"kind": "lateral"}}
    scene = Wall.outlines(squares, [[[-1, -1], [3, -1], [3, 0], [-1, 0]]], **keys).scene
    corner, side, place = corners_on_corners(scene)
    assert (scene.blocks.vertices[corner] == 1.0).all()
    assert np.bincount(place).tolist() == [4, 4]
    pairs = np.sort(scene.blocks.owner[np.column_stack([corner, side])])
    assert {tuple(pair) for pair in pairs.tolist()} == {(0, 3), (1, 2)}


@pytest.mark.parametrize(
    ("model", "displacements"),
    [("dem-dynamic", "small"), ("dem-dynamic", "finite"), ("fem", "small"), *at_length(("fem", "finite"))],
)
def test_stone_stands_on_two_tips(model: str, displacements: Any) -> None:
    """A wall without any joint; the ground bears its weight, and the pushes that slide it at λ = tan φ."""
    stone = [[0, 0], [0.2, 0.15], [0.4, 0.15], [0.6, 0], [0.7, 0.5], [-0.1, 0.5]]
    wall = Wall.outlines(
        [stone],
        thickness=0.2,
        density=2000.0,
        young=1e11,
        friction=0.6,
        normal_stiffness=1e10,
        shear_stiffness=1e10,
        ground=[FLAT],
        live={"kind": "lateral"},
    )
    assert wall.scene.joints.at_corner.all()
    further: dict[str, Any] = {"distance": 0.01} if displacements == "finite" else {}
    result = wall.run(model, displacements=displacements, **further)
    assert result.multiplier == pytest.approx(0.6, rel=0.01)
    weight, last = 9.81 * float(wall.scene.mass[0]), result.curve.iloc[-1]
    assert last["ground vertical [N]"] == pytest.approx(weight, rel=1e-3)
    assert last["ground horizontal [N]"] == pytest.approx(-0.6 * weight, rel=0.01)


@pytest.mark.parametrize("depth", [0.0, 0.1])
def test_tip_bears_where_a_block_may_crack(depth: float) -> None:
    """On the axis of a block, level or with a notch there; the stone above rests on the next block too."""
    notch = [[0.25, 0.3 - depth]] * (depth > 0)
    lower = [[[0, 0], [0.5, 0], [0.5, 0.3], *notch, [0, 0.3]], [[0.5, 0], [1, 0], [1, 0.3], [0.5, 0.3]]]
    upper = [[0.25, 0.3 - depth], [0.6, 0.4], [0.7, 0.3], [1, 0.3], [0.9, 0.7], [0.1, 0.7]]
    keys: dict[str, Any] = {"thickness": 0.2, "density": 2000.0, "friction": 0.6, "ground": [FLAT]}
    strong = {"friction": 0.6, "cohesion": 1e6, "tensile_strength": 5e5}
    for inner in (None, strong):
        wall = Wall.outlines([*lower, upper], live={"kind": "lateral"}, inner_joint=inner, **keys)
        assert wall.run("limit").multiplier == pytest.approx(0.6)
