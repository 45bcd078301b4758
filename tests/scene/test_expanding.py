"""Stones drawn with gaps for mortar are expanded to the middle of the joints (`wall.expand`)."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import runningbond as rb
from runningbond.scene import Array, SceneError
from runningbond.scene.drawings.expanding import expand
from tests.scene.drafting import closed, dxf
from tests.walls import content

SOLID: dict[str, Any] = {"thickness": 0.25, "density": 1800.0, "friction": 0.6}
MORTAR = 0.01


def box(left: float, low: float, right: float, high: float) -> Array:
    return np.array([(left, low), (right, low), (right, high), (left, high)])


def bricks(mortar: float, courses: int = 4) -> list[Array]:
    """Three bricks per course, 250 × 70 mm including mortar, reduced by half a joint's width on all sides."""
    half = mortar / 2
    corners = [(0.25 * n + 0.125 * (k % 2), 0.07 * k) for k in range(courses) for n in range(3)]
    return [box(x + half, y + half, x + 0.25 - half, y + 0.07 - half) for x, y in corners]


def crooked(seed: int, courses: int = 4) -> list[Array]:
    """Three or four stones per course between uneven beds, with inclined and staggered head joints."""
    random, nodes = np.random.default_rng(seed), 0.3 * np.arange(5)
    beds = [0.25 * k + random.uniform(-0.05, 0.05, 5) * (k > 0) for k in range(courses + 1)]
    stones = []
    for k, (low, high) in enumerate(itertools.pairwise(beds)):
        inner = (np.arange(0.3, 1.2, 0.3) - 0.15 * (k % 2)) + random.uniform(-0.04, 0.04, (2, 3))
        heads = np.column_stack([(0.0, 0.0), inner, (1.2, 1.2)])
        for (left, left_up), (right, right_up) in zip(heads.T[:-1], heads.T[1:], strict=True):
            under, over = (
                np.sort([a, *nodes[(nodes > a) & (nodes < b)], b]) for a, b in ((left, right), (left_up, right_up))
            )
            bottom, top = (np.column_stack([x, np.interp(x, nodes, y)]) for x, y in ((under, low), (over, high)))
            stones.append(np.vstack([bottom, top[::-1]]))
    return stones


def shrunk(stones: list[Array], by: float) -> list[Array]:
    polygons = shapely.buffer([shapely.Polygon(stone) for stone in stones], -by, join_style="mitre")
    return [np.array(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1] for polygon in polygons]


def test_expanded_bricks_equal_bricks_drawn_without_mortar() -> None:
    """Same number of joints, and the same multiplier except for the half joints missing along the wall's outline."""
    wall = rb.Wall.outlines(bricks(MORTAR), expand=0.012, **SOLID)
    whole = rb.Wall.outlines(bricks(0.0), **SOLID)
    assert "expand: stones take the mortar between them, 0.0097 m wide on average" in wall.scene.notes
    assert len(wall.scene.joints) == len(whole.scene.joints)
    assert wall.run("limit").multiplier == pytest.approx(whole.run("limit").multiplier, rel=0.02)
    along = np.abs(np.diff(wall.scene.joints.ends, axis=1)[:, 0])
    slope = along[:, 1] / along[:, 0].clip(1e-9)
    assert slope[along[:, 0] > along[:, 1]].max() < 1e-3  # no bumps at the ends of head joints


ANY_JOINTS = given(st.integers(0, 10**6), st.sampled_from([0.005, 0.01, 0.02]), st.floats(1.2, 2.0), st.booleans())


def fill_the_joints(seed: int, mortar: float, more: float, on_ground: bool) -> None:
    true = crooked(seed)
    drawn, ground = shrunk(true, mortar / 2), [box(-1.0, -0.5, 2.2, 0.0)] if on_ground else []
    found = [shapely.Polygon(outline) for outline in expand(drawn, ground, more * mortar)[0]]
    assert all(polygon.is_valid for polygon in found)
    together = shapely.union_all(found, grid_size=1e-9)
    assert sum(polygon.area for polygon in found) == pytest.approx(together.area, rel=1e-6)
    assert together.geom_type == "Polygon"
    assert not together.interiors
    for polygon, stone, was in zip(found, drawn, true, strict=True):
        for one, within, by in ((stone, polygon, 0.15), (polygon, shapely.Polygon(was), 1.0)):
            around = shapely.buffer(within, by * more * mortar)
            assert shapely.difference(shapely.Polygon(one), around, grid_size=1e-9).area < 1e-9
    if on_ground:
        assert together.bounds[1] == pytest.approx(0.0, abs=1e-6 * more * mortar)


@settings(max_examples=13)
@ANY_JOINTS
def test_expanded_stones_fill_the_joints(seed: int, mortar: float, more: float, on_ground: bool) -> None:
    """They contain the drawn stones, do not overlap, and stay near the outlines from which the joints were removed."""
    fill_the_joints(seed, mortar, more, on_ground)


@pytest.mark.long
@settings(max_examples=200)
@ANY_JOINTS
def test_expanded_stones_fill_the_joints_at_length(seed: int, mortar: float, more: float, on_ground: bool) -> None:
    fill_the_joints(seed, mortar, more, on_ground)


@pytest.mark.parametrize("seed", range(6))
def test_expanded_wall_has_the_multiplier_of_the_wall_without_gaps(seed: int) -> None:
    """To 3 %: half a joint's width is 2 % of a stone."""
    true = crooked(seed)
    wall = rb.Wall.outlines(shrunk(true, MORTAR / 2), [box(-1.0, -0.5, 2.2, 0.0)], expand=0.015, **SOLID)
    load = rb.Wall.outlines(true, [box(-1.0, -0.5, 2.2, 0.0)], **SOLID).run("limit").multiplier
    assert wall.run("limit").multiplier == pytest.approx(load, rel=0.03)


@pytest.mark.parametrize(("turn", "offset"), [(0.3, 0.0), (2.0, 5e5)])
def test_expansion_is_independent_of_rotation_and_position(turn: float, offset: float) -> None:
    drawn = shrunk(crooked(3), MORTAR / 2)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    here = expand(drawn, [], 0.015)[0]
    there = expand([stone @ rotation.T + offset for stone in drawn], [], 0.015)[0]
    for one, other in zip(here, there, strict=True):
        back = shapely.Polygon((other - offset) @ rotation)
        assert shapely.Polygon(one).symmetric_difference(back).area < 0.02 * MORTAR * back.length


def test_beds_of_expanded_bricks_are_straight() -> None:
    """A wall slides on such a bed at exactly tan φ, for any `wall.expand`."""
    corners = [(0.25 * n + 0.125 * (k % 2), 0.1 * k) for k in range(3) for n in range(8)]
    drawn = [box(x + 0.005, y + 0.005, x + 0.245, y + 0.095) for x, y in corners]
    for width in (0.0101, 0.012, 0.017):
        wall = rb.Wall.outlines(drawn, expand=width, **SOLID)
        assert wall.run("limit").multiplier == pytest.approx(0.6, rel=1e-9)
        ends = wall.scene.joints.ends[wall.scene.joints.is_bed]
        assert np.abs(np.diff(ends[:, :, 1], axis=1)).max() < 1e-8


def test_stones_end_exactly_on_a_ground_at_zero() -> None:
    """They once ended at -7.5e-9 m, by the grid on which they are expanded, and columns of results were named so."""
    stones = [*crooked(3), box(0.0, 1.0, 1.2, 1.0 + np.sqrt(0.02))]
    expanded, _ = expand(shrunk(stones, 0.004), [box(-1.0, -0.5, 2.0, 0.0)], 0.012)
    assert np.vstack(expanded)[:, 1].min() == pytest.approx(0.0, abs=1e-15)


def test_stones_do_not_expand_into_gaps_of_the_ground() -> None:
    grounds = [box(-1.0, -0.5, 0.195, 0.0), box(0.205, -0.5, 1.4, 0.0)]
    outlines = expand([box(0.0, 0.01, 0.195, 0.1), box(0.205, 0.01, 0.4, 0.1)], grounds, 0.012)[0]
    assert [outline[:, 1].min() for outline in outlines] == pytest.approx([0.0, 0.0], abs=1e-7)


def test_overlaps_are_divided_like_gaps() -> None:
    """Boxes that overlap by 4 mm, or are 4 mm apart, meet in the middle."""
    for gap in (-0.004, 0.004):
        left, right = expand([box(0, 0, 0.2, 0.1), box(0.2 + gap, 0, 0.4, 0.1)], [], 0.01)[0]
        assert left[:, 0].max() == pytest.approx(0.2 + gap / 2, abs=2e-4)
        assert right[:, 0].min() == pytest.approx(0.2 + gap / 2, abs=2e-4)


def test_gaps_wider_than_a_joint_stay_open() -> None:
    outlines, note = expand([box(0, 0, 0.2, 0.1), box(0.25, 0, 0.4, 0.1)], [], 0.02)
    assert [shapely.Polygon(outline).area for outline in outlines] == pytest.approx([0.02, 0.015])
    assert note == "expand: there is no mortar between stones"
    assert expand([box(0, 0, 0.2, 0.1), box(0.2, 0, 0.4, 0.1)], [], 0.02)[1] == note


def test_open_gaps_little_wider_than_a_joint_are_reported() -> None:
    """A joint that widens upwards from 10 to 30 mm, whose upper half stays open, and two joints of 30 mm."""
    wedge = np.array([(0.21, 0.0), (0.4, 0.0), (0.4, 0.2), (0.23, 0.2)])
    assert "; a gap wider than 0.02 m stays open at (0.21" in expand([box(0, 0, 0.2, 0.2), wedge], [], 0.02)[1]
    apart = [box(x, 0, x + 0.2, 0.2) for x in (0.0, 0.23, 0.46)]
    assert "; 2 gaps wider than 0.02 m stay open, the largest at (0." in expand(apart, [], 0.02)[1]
    assert "open" not in expand(apart, [], 0.03)[1]


def test_drawings_are_expanded(tmp_path: Path) -> None:
    """In the drawing's own units, with the same number of blocks as listed outlines."""
    dxf(tmp_path / "wall.dxf", closed([[tuple(1000 * corner) for corner in brick] for brick in bricks(MORTAR)]))
    tables = {name: table for name, table in content().items() if name != "wall"}
    keys = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.25, "expand": 0.012}
    wall = rb.Wall({**tables, "wall": keys}, tmp_path)
    listed = rb.Wall.outlines(bricks(MORTAR), expand=0.012, **SOLID)
    assert len(wall.scene.blocks) == len(listed.scene.blocks)
    assert any(note.startswith("expand:") for note in wall.scene.notes)


def test_invalid_expand_is_refused() -> None:
    stones = [*bricks(MORTAR), box(0.0, 0.3, 0.75, 0.308)]
    what = (
        r"wall.expand = 0.02: must be at most the smallest block's smaller side, 0.008: that of block 12 at \(0.375, "
    )
    with pytest.raises(SceneError, match=what):
        rb.Wall.outlines(stones, expand=0.02, **SOLID)
    with pytest.raises(SceneError, match=r"wall.expand = 0.0: must be a number above 0"):
        rb.Wall.outlines(stones, expand=0.0, **SOLID)
    size: dict[str, Any] = {"length": 1.0, "height": 0.5, "block_width": 0.25, "block_height": 0.1}
    with pytest.raises(SceneError, match=r"wall.expand: does not go with wall.length; describe the wall in one way"):
        rb.Wall.running_bond(**size, **SOLID, wall={"expand": 0.01})


def test_expand_far_too_small_is_refused() -> None:
    """For example a width in another unit, whose samples would exhaust the memory."""
    what = r"wall.expand = 1e-05: must be at least 2.2e-05 m for blocks with 7.2 m of sides$"
    with pytest.raises(SceneError, match=what):
        rb.Wall.outlines(bricks(MORTAR), expand=1e-5, **SOLID)


HOOK = np.array([(0, 0), (0.6, 0), (0.6, 0.3), (0.31, 0.3), (0.31, 0.2), (0.5, 0.2), (0.5, 0.1), (0.1, 0.1)])
HOOK = np.vstack([HOOK, [(0.1, 0.2), (0.3, 0.2), (0.3, 0.3), (0, 0.3)]])


@pytest.mark.parametrize(
    ("stones", "grounds", "what"),
    [
        ([box(0, 0, 0.6, 0.3), box(0.1, 0.1, 0.2, 0.2)], [], r"finds 100% of block 1 at .* in block 0; draw"),
        ([box(0, 0, 0.6, 0.3), box(0.2, 0, 0.8, 0.3)], [], r"finds 67% of block [01] at .* in block [01]; draw"),
        ([box(0, 0, 0.6, 0.3)], [box(-1, -1, 2, 0.2)], r"finds 67% of block 0 at \(0.3, 0.15\) in the ground; draw"),
        ([HOOK, box(0.11, 0.11, 0.49, 0.19)], [], r"has block 0 at .* go all around what it encloses; cut it in two"),
    ],
)
def test_overlapping_and_enclosed_stones_are_located(stones: list[Array], grounds: list[Array], what: str) -> None:
    with pytest.raises(SceneError, match=f"wall.expand = 0.012: {what}"):
        rb.Wall.outlines(stones, grounds or None, expand=0.012, **SOLID)


@pytest.mark.parametrize(
    ("stones", "width"),
    [
        (  # one corner of the joint line is left between two ends with bumps
            [
                [(-0.41013, 0.53509), (-0.40274, 0.53795), (-0.09417, 0.54079), (-0.09017, 0.54585)]
                + [(-0.08499, 0.76642), (-0.09729, 0.76672), (-0.39016, 0.72043)],
                [(-0.0712, 0.53884), (0.18795, 0.48957), (0.18677, 0.74754), (-0.05347, 0.75744)],
            ],
            0.021,
        ),
        (  # stones that overlap, with a corner of the joint line on one of them
            [
                [(0.228, 0.496), (0.376, 0.291), (0.268, 0.514)],
                [(0.235, 0.421), (0.223, 0.487), (0.11, 0.493)],
                [(0.114, 0.5), (0.372, 0.535), (0.121, 0.783)],
            ],
            0.0042,
        ),
    ],
)
@pytest.mark.filterwarnings("error")
def test_short_joint_lines_give_valid_outlines(stones: list[list[tuple[float, float]]], width: float) -> None:
    outlines = expand([counter_clockwise(np.array(stone)) for stone in stones], [], width)[0]
    assert all(shapely.Polygon(outline).is_valid for outline in outlines)


def counter_clockwise(stone: Array) -> Array:
    """Corners of a stone in counter-clockwise order."""
    return np.array(shapely.geometry.polygon.orient(shapely.Polygon(stone)).exterior.coords)[:-1]
