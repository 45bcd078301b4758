"""Courses of different heights, openings at any place, lintels."""

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import event, given, settings
from hypothesis import strategies as st

from homog import homog
from runningbond.limit import limit
from runningbond.scene import Scene, SceneError, scene_from_dict
from tests.walls import content, courses, panel

SIZE: dict[str, Any] = {
    "wall__block_width": 0.5,
    "wall__block_height": 0.2,
    "wall__length": 3.0,
    "wall__height": 2.0,
    "materials": {"oak": {"density": 700.0}},
}
LINTEL = {"height": 0.2, "bearing": 0.25}


def opening(x0: float, y0: float, x1: float, y1: float, lintel: Any = None) -> dict[str, Any]:
    return {"from": [x0, y0], "to": [x1, y1]} | ({} if lintel is None else {"lintel": lintel})


def with_openings(*openings: dict[str, Any], **changes: Any) -> Scene:
    return panel(**(SIZE | {"wall__opening": list(openings)} | changes))


def boxes(scene: Scene) -> Any:
    """Bounding boxes of the wall's blocks, sorted, ``(nb, 4)``."""
    low, high = scene.blocks.boxes
    found = np.column_stack([low, high])[scene.wall].round(9)
    return found[np.lexsort(found.T)]


# --- courses of different heights ----------------------------------------------------------------------------------


def test_equal_course_heights_give_the_same_wall_as_one_block_height() -> None:
    plain = panel()
    listed = panel(wall__block_height=None, wall__course_heights=[0.06] * 12, wall__height=None)
    assert listed.bond == plain.bond
    assert np.array_equal(listed.blocks.vertices, plain.blocks.vertices)
    same = panel(wall__block_height=None, wall__course_heights=[0.06] * 12)
    assert np.array_equal(same.blocks.vertices, plain.blocks.vertices)


@pytest.mark.parametrize("by", ["length", "courses"])
def test_each_course_has_its_height(by: str) -> None:
    heights = [0.2, 0.2, 0.15, 0.3]
    keys: dict[str, Any] = {"wall__block_height": None, "wall__height": None, "wall__course_heights": heights}
    if by == "courses":
        keys |= {"wall__length": None, "wall__courses": [[1, 1, 1], [0.5, 1, 1, 0.5]] * 2}
    scene = panel(**{"wall__length": 0.72, **keys})
    assert scene.bond is None
    levels = np.cumsum([0.0, *heights])
    assert set(scene.blocks.boxes[0][scene.wall, 1].round(9)) == set(levels[:-1].round(9))
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(0.72 * 0.85)
    with pytest.raises(SceneError, match="it needs a block width and height"):
        homog(scene)


def test_stack_of_unequal_courses_overturns_at_b_over_h() -> None:
    """One block per course: λ = b / h of the whole stack, for any course heights."""
    keys = {"wall__block_height": None, "wall__height": None, "wall__length": None, "joint__friction": 2.0}
    scene = panel(**keys, wall__course_heights=[0.3, 0.1, 0.2], wall__courses=[[1], [1], [1]])
    assert limit(scene).multiplier == pytest.approx(0.24 / 0.6, rel=1e-8)


# --- openings ------------------------------------------------------------------------------------------------------


def test_opening_on_the_lattice_equals_a_gap_in_a_list_of_courses() -> None:
    whole, half = [1.0] * 6, [0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5]
    pattern = [[1.0, 1.0, -2.0, 1.0, 1.0], [0.5, 1.0, 0.5, -2.0, 0.5, 1.0, 0.5]] * 3 + [whole, half] * 2
    keys = {key: value for key, value in SIZE.items() if key not in ("wall__length", "wall__height")}
    listed = courses(pattern, 0.5, 0.2, **{k: v for k, v in keys.items() if "block_" not in k})
    cut = with_openings(opening(1.0, 0.0, 2.0, 1.2))
    assert boxes(cut) == pytest.approx(boxes(listed), abs=1e-9)
    assert len(cut.joints) == len(listed.joints)
    assert limit(cut).multiplier == pytest.approx(limit(listed).multiplier, rel=1e-9)


def test_opening_in_a_list_of_courses() -> None:
    pattern = [[1.0] * 6, [0.5, 1, 1, 1, 1, 1, 0.5]] * 3
    listed = courses([row[:] for row in pattern], 0.5, 0.2, wall__opening=[opening(1.0, 0.4, 2.0, 0.8)])
    assert listed.blocks.area[listed.wall].sum() == pytest.approx(3.0 * 1.2 - 0.4)


def test_opening_corner_inside_a_block_leaves_an_l_shape() -> None:
    scene = with_openings(opening(0.8, 0.0, 1.8, 1.1))
    corners = np.diff(scene.blocks.first)[scene.wall]
    ells = np.flatnonzero(corners == 6)
    # The sixth course, from 1.0 to 1.2 m, starts with a half block: its joints are at 0.75, 1.25 and 1.75 m.
    assert [scene.blocks.polygon(int(k)).min(axis=0).round(9).tolist() for k in ells] == [[0.75, 1.0], [1.75, 1.0]]
    assert corners[corners != 6] == pytest.approx(4)
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(6.0 - 1.1)


def test_slivers_are_merged_with_the_next_block() -> None:
    """0.05 m of a 0.5 m block would be left beside the opening; it is added to the next block instead."""
    scene = with_openings(opening(0.8, 0.0, 1.7, 1.2))
    width = np.ptp(boxes(scene)[:, [0, 2]], axis=1)
    assert width.min() == pytest.approx(0.25)
    assert {0.55, 0.3} <= set(width.round(9))
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(6.0 - 0.9 * 1.2)


def test_a_slot_cuts_a_block_in_two() -> None:
    scene = with_openings(opening(0.7, 1.8, 0.8, 2.0), wall__first_course="half")
    top = boxes(scene)[boxes(scene)[:, 1] == 1.8]
    assert sorted(top[:, 2] - top[:, 0])[:2] == pytest.approx([0.2, 0.2])
    assert len(top) == 7


def test_opening_edges_snap_to_joints_within_rounding() -> None:
    exact, near = (with_openings(opening(1.0 + e, 0.4 - e, 2.0 - e, 1.2 + e)) for e in (0.0, 1e-8))
    assert np.array_equal(exact.blocks.vertices, near.blocks.vertices)


@pytest.mark.parametrize(
    ("box", "floating"),
    [
        ((0.0, 0.4, 1.0, 1.2), False),  # notch in the left side
        ((2.0, 0.0, 3.0, 1.2), False),  # at the bottom right: the wall above overhangs
        ((1.0, 1.6, 2.0, 2.0), False),  # from the top
        ((0.0, 0.4, 3.0, 1.2), True),  # along the whole length
        ((0.0, 0.0, 3.0, 0.2), False),  # the whole first course: the wall stands on the second
    ],
)
def test_notches_at_the_sides_of_the_wall(box: Any, floating: bool) -> None:
    if floating:
        with pytest.raises(SceneError, match="is a floating block"):
            with_openings(opening(*box))
    else:
        cut = (box[2] - box[0]) * (box[3] - box[1])
        scene = with_openings(opening(*box))
        assert scene.blocks.area[scene.wall].sum() == pytest.approx(6.0 - cut)


def test_lintel_is_one_block_of_its_own_material() -> None:
    scene = with_openings(opening(1.0, 0.0, 2.0, 1.1, LINTEL | {"material": "oak"}), opening(2.4, 1.0, 2.6, 1.4))
    lintel = int(scene.wall.sum()) - 1
    assert scene.blocks.polygon(lintel) == pytest.approx(np.array([[0.75, 1.1], [2.25, 1.1], [2.25, 1.3], [0.75, 1.3]]))
    assert scene.density[lintel] == 700.0
    assert (scene.density[:lintel] == 1800.0).all()
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(6.0 - 1.1 - 0.2 * 0.4)
    plain = with_openings(opening(1.0, 0.0, 2.0, 1.1, LINTEL))
    assert (plain.density[plain.wall] == 1800.0).all()
    # It is let into the courses on either side.
    on = (scene.joints.block == lintel).any(axis=1)
    run = np.abs(np.diff(scene.joints.ends[on], axis=1))[:, 0]
    assert run[run[:, 1] < 1e-9, 0].sum() == pytest.approx(0.25 * 2 + 1.5)


def test_lintel_carries_the_blocks_above_a_wide_opening() -> None:
    """With almost no friction (tan φ = 0.01) the blocks above a wide opening fall; a lintel carries them."""
    wide = (0.5, 0.0, 2.5, 1.0)
    assert limit(with_openings(opening(*wide), joint__friction=0.01)).status == "infeasible"
    assert limit(with_openings(opening(*wide, LINTEL), joint__friction=0.01)).status == "collapse"


def test_a_mirrored_wall_has_the_same_multiplier() -> None:
    holes = [(0.8, 0.0, 1.7, 1.1), (2.1, 0.5, 2.63, 1.2)]
    left = [opening(3.0 - x1, y0, 3.0 - x0, y1, LINTEL if k == 0 else None) for k, (x0, y0, x1, y1) in enumerate(holes)]
    right = [opening(*hole, LINTEL if k == 0 else None) for k, hole in enumerate(holes)]
    one = with_openings(*right)
    other = with_openings(*left, load__live={"kind": "lateral", "direction": "left"})
    mirrored = boxes(other) * [-1, 1, -1, 1] + [3, 0, 3, 0]
    mirrored = mirrored[:, [2, 1, 0, 3]]
    assert mirrored[np.lexsort(mirrored.T)] == pytest.approx(boxes(one), abs=1e-9)
    assert limit(other).multiplier == pytest.approx(limit(one).multiplier, rel=1e-7)


corners = st.tuples(st.integers(0, 40), st.integers(0, 30), st.integers(1, 16), st.integers(1, 20), st.booleans())


@given(st.lists(corners, min_size=1, max_size=3))
@settings(max_examples=200)
def test_random_openings_leave_the_rest_of_the_wall(drawn: list[Any]) -> None:
    """The remaining area is exact, no block is a sliver or lies in an opening, and the rest is refused."""
    spans = [(x / 16, y / 20, (x + w) / 16, (y + h) / 20) for x, y, w, h, _ in drawn]
    holes = [opening(*span, LINTEL if over else None) for span, (*_, over) in zip(spans, drawn, strict=True)]
    try:
        scene = with_openings(*holes)
    except SceneError as error:
        said = str(error)
        event(said.partition(": ")[2][:12])
        return
    cut = sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in spans)
    assert scene.blocks.area[scene.wall].sum() == pytest.approx(6.0 - cut, rel=1e-9)
    event("a wall")
    found = boxes(scene)
    assert (found[:, 2] - found[:, 0]).min() >= 0.125 * (1 - 1e-5)
    assert (found[:, 3] - found[:, 1]).min() >= 0.05 * (1 - 1e-5)
    voids = shapely.union_all([shapely.box(*hole["from"], *hole["to"]) for hole in holes])
    assert shapely.area(shapely.intersection(scene.blocks.shapes(np.flatnonzero(scene.wall)), voids)).max() < 1e-9


# --- refusals ------------------------------------------------------------------------------------------------------

HEIGHTS = {"wall__block_height": None, "wall__height": None}
ROWS = {"wall__length": None, "wall__height": None, "wall__courses": [[1.0] * 6] * 2}
GOOD = opening(1.0, 0.0, 2.0, 1.2)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"wall__course_heights": [0.2] * 10}, "wall.course_heights = [0.2, 0.2"),
        ({"wall__course_heights": [0.2] * 10}, "does not go with wall.block_height; give one of them"),
        ({"wall__block_height": None}, "wall.block_height: is missing"),
        ({**HEIGHTS, "wall__course_heights": []}, "wall.course_heights = []: must be a list of heights"),
        ({**HEIGHTS, "wall__course_heights": 0.2}, "wall.course_heights = 0.2: must be a list of heights"),
        ({**HEIGHTS, "wall__course_heights": [0.2, 0]}, "wall.course_heights[1] = 0: must be a number above 0"),
        ({**HEIGHTS, "wall__course_heights": [0.2, "low"]}, "wall.course_heights[1] = 'low': must be a number"),
        ({**HEIGHTS, "wall__course_heights": [[0.2]]}, "wall.course_heights[0] = [0.2]: must be a number above 0"),
        (
            {**HEIGHTS, "wall__course_height": [0.2]},
            'wall.course_height = [0.2]: is not a key of [wall]; did you mean "course_heights"?',
        ),
        (
            {"wall__block_height": None, "wall__course_heights": [0.2, 0.3]},
            "wall.height = 2.0: must be left out, or be the sum of wall.course_heights, 0.5",
        ),
        (
            {**ROWS, "wall__block_height": None, "wall__course_heights": [0.2, 0.2, 0.1]},
            "wall.course_heights = [0.2, 0.2, 0.1]: must be as many as the courses of wall.courses, 2",
        ),
        (
            {"wall": {"drawing": "a.dxf", "units": "mm", "thickness": 0.1, "course_heights": [0.2]}},
            "wall.course_heights: does not go with wall.drawing",
        ),
        (
            {"wall": {"drawing": "a.dxf", "units": "mm", "thickness": 0.1, "opening": [GOOD]}},
            "wall.opening: does not go with wall.drawing",
        ),
        ({"wall__opening": GOOD}, "wall.opening = {'from': [1.0, 0.0], 'to': [2.0, 1.2]}: must be tables"),
        ({"wall__opening": [3]}, "wall.opening[0] = 3: must be a table"),
        ({"wall__opening": [{"to": [2.0, 1.2]}]}, "wall.opening[0].from: is missing"),
        ({"wall__opening": [{"from": [1.0, 0.0]}]}, "wall.opening[0].to: is missing"),
        ({"wall__opening": [GOOD | {"from": [1.0]}]}, "wall.opening[0].from = [1.0]: must be a pair"),
        ({"wall__opening": [GOOD | {"to": [2.0, "top"]}]}, "wall.opening[0].to = [2.0, 'top']: must be a pair"),
        ({"wall__opening": [opening(2.0, 0.0, 1.0, 1.2)]}, "wall.opening[0].to = [1.0, 1.2]: must lie to the right"),
        ({"wall__opening": [opening(1.0, 1.2, 2.0, 1.2)]}, "wall.opening[0].to = [2.0, 1.2]: must lie to the right"),
        ({"wall__opening": [GOOD, GOOD | {"at": 3}]}, "wall.opening[1].at = 3: is not a key of [wall.opening[1]]"),
        (
            {"wall__opening": [GOOD | {"lintl": {}}]},
            "wall.opening[0].lintl = 'a table': is not a key of [wall.opening[0]]; did you mean",
        ),
        ({"wall__opening": [opening(5, 0, 6, 1)]}, "must not reach beyond the wall, which spans x 0 … 3 m, y 0 … 2 m"),
        ({"wall__opening": [opening(-0.1, 0, 1, 1)]}, "wall.opening[0] = [[-0.1, 0.0], [1.0, 1.0]]: must not reach"),
        ({"wall__opening": [opening(1, 1.5, 2, 2.1)]}, "wall.opening[0] = [[1.0, 1.5], [2.0, 2.1]]: must not reach"),
        (
            {**ROWS, "wall__courses": [[1, 1, -2, 1, 1], [1.0] * 6], "wall__opening": [opening(1.1, 0, 1.9, 0.2)]},
            "wall.opening[0] = [[1.1, 0.0], [1.9, 0.2]]: cuts no block of the wall",
        ),
        ({"wall__opening": [GOOD, opening(1.5, 0.6, 2.5, 1.6)]}, "overlaps wall.opening[0]; keep them apart"),
        ({"wall__opening": [opening(0, 0, 3, 2)]}, "wall.opening[0]: leaves nothing of the wall"),
        ({"wall__opening": [opening(1, 0, 2, 1.17)]}, "leaves a piece 0.03 m high of a course from y = 1 to 1.2 m"),
        ({"wall__opening": [opening(0.05, 0, 1, 1.2)]}, "leaves a piece 0.05 m long of a block, and none beside it"),
        ({"wall__opening": [opening(0.1, 0.05, 0.2, 0.15)]}, "wall.opening[0]: lies inside one block"),
        ({"wall__opening": [GOOD | {"lintel": 0.2}]}, "wall.opening[0].lintel = 0.2: must be a table"),
        ({"wall__opening": [GOOD | {"lintel": {"height": 0.2}}]}, "wall.opening[0].lintel.bearing: is missing"),
        ({"wall__opening": [GOOD | {"lintel": {"bearing": 0.2}}]}, "wall.opening[0].lintel.height: is missing"),
        (
            {"wall__opening": [GOOD | {"lintel": LINTEL | {"bearing": 0}}]},
            "wall.opening[0].lintel.bearing = 0: must be a number above 0",
        ),
        (
            {"wall__opening": [GOOD | {"lintel": LINTEL | {"material": "oka"}}]},
            'wall.opening[0].lintel.material = \'oka\': must be one of "block", "oak"; did you mean "oak"?',
        ),
        (
            {"wall__opening": [GOOD | {"lintel": LINTEL | {"width": 1.5}}]},
            "wall.opening[0].lintel.width = 1.5: is not a key of [wall.opening[0].lintel]",
        ),
        (
            {"wall__opening": [opening(0.1, 0, 1, 1.2, LINTEL)]},
            "wall.opening[0].lintel = [[-0.15, 1.2], [1.25, 1.4]]: must not reach beyond the wall",
        ),
        ({"wall__opening": [opening(1, 0, 2, 1.9, LINTEL)]}, "wall.opening[0].lintel = [[0.75, 1.9], [2.25, 2.1]]"),
        (
            {"wall__opening": [opening(1, 0, 2, 1.2, LINTEL), opening(2.1, 1, 2.6, 1.4)]},
            "wall.opening[0].lintel = [[0.75, 1.2], [2.25, 1.4]]: overlaps wall.opening[1]; keep them apart",
        ),
        (
            {"wall__opening": [opening(0.5, 0, 1, 1.2, LINTEL), opening(1.4, 0, 2, 1.2, LINTEL)]},
            "wall.opening[1].lintel = [[1.15, 1.2], [2.25, 1.4]]: overlaps wall.opening[0].lintel; keep them apart",
        ),
        (
            {
                **ROWS,
                "wall__courses": [[1.0] * 6, [1, 1, -2, 1, 1], [1.0] * 6],
                "wall__opening": [opening(0.4, 0, 0.9, 0.2, LINTEL)],
            },
            "wall.opening[0].lintel = [[0.15, 0.2], [1.15, 0.4]]: must lie whole in the wall",
        ),
    ],
)
def test_invalid_heights_openings_and_lintels_are_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene_from_dict(content(**(SIZE | changes)))
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("unit", [0.1, 1.0, 10.0, 100.0])
def test_three_quarter_blocks_beside_an_opening_are_not_split_in_any_unit(unit: float) -> None:
    """They are exactly as wide as the limit for splitting; rounding of the width once decided whether they split."""
    size = {"length": 0.8, "height": 1.2, "block_width": 0.2, "block_height": 0.2, "thickness": 0.1}
    hole = {"from": [round(0.25 * unit, 9), round(0.2 * unit, 9)], "to": [round(0.45 * unit, 9), round(0.6 * unit, 9)]}
    wall = {key: round(value * unit, 9) for key, value in size.items()} | {"opening": [hole]}
    scene = panel(wall=wall, inner_joint={"friction": 0.7, "cohesion": 1e5, "tensile_strength": 1e4})
    halves = scene.joints.block[scene.joints.inner]
    low, high = scene.blocks.boxes
    assert (high[halves[:, 1], 0] - low[halves[:, 0], 0] > 0.8 * 0.2 * unit).all()
