"""Walls of stones whose corners are listed in a file or script (`wall.outlines`)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import runningbond as rb
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.scene import SceneError
from runningbond.scene.plausibility import warnings
from tests.scene.drafting import BRICKS, GROUND, closed, dxf

THICK: dict[str, Any] = {"thickness": 0.2, "density": 1800.0, "friction": 0.6}
TABLES: dict[str, Any] = {
    "title": "outlines",
    "block": {"density": 1800.0},
    "joint": {"friction": 0.6},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}


def test_listed_stones_give_the_same_wall_as_their_drawing(tmp_path: Path) -> None:
    """In mm, with ground. Rings may repeat the first corner, run in either sense and have corners within a side."""
    dxf(tmp_path / "wall.dxf", closed())
    drawn = rb.Wall({**TABLES, "wall": {"drawing": "wall.dxf", "units": "mm", "thickness": 0.2}}, tmp_path)
    untidy = [np.array([*brick[::-1], brick[-1]]) for brick in BRICKS]
    untidy[0] = np.insert(np.array(BRICKS[0]), 1, [100.0, 0.0], axis=0)
    listed = rb.Wall.outlines(untidy, [GROUND], units="mm", **THICK)
    assert fingerprint(listed.scene, "limit", 0.01) == fingerprint(drawn.scene, "limit", 0.01)
    listed.to_toml(tmp_path / "listed.toml")
    assert (tmp_path / "listed.toml").read_text().count("\n    [[") == len(BRICKS) + 1  # each on a line of its own
    assert fingerprint(rb.read(tmp_path / "listed.toml").scene, "limit", 0.01) == fingerprint(
        listed.scene, "limit", 0.01
    )


def test_stones_are_numbered_in_the_order_of_the_list() -> None:
    order = [4, 0, 6, 2, 1, 5, 3]
    stones = [np.array(BRICKS[k]) / 1000 for k in order]
    wall = rb.Wall.outlines(stones, **THICK)
    assert wall.scene.blocks.centroid[: len(order)] == pytest.approx(np.array([each.mean(axis=0) for each in stones]))
    heavier = wall.with_(materials={"lead": {"density": 11340.0}}, assign=[{"block": "lead", "blocks": [2]}])
    assert np.argmax(heavier.scene.mass[: len(order)] / heavier.scene.blocks.area[: len(order)]) == 2


def test_stones_without_ground_get_a_strip_below_the_lowest_one() -> None:
    wall = rb.Wall.outlines(BRICKS, units="mm", **THICK)
    low, high = wall.scene.blocks.extent(wall.scene.fixed)
    assert high[1] == pytest.approx(0.0)
    assert low[0] < 0.0 < 0.4 < high[0]
    assert rb.Wall.outlines(BRICKS, [GROUND], units="mm", **THICK).run("limit").multiplier == pytest.approx(
        wall.run("limit").multiplier, rel=1e-6
    )


def test_gaps_between_listed_stones_are_healed() -> None:
    apart = [np.array(brick) + [0.4 * k, 0.0] for k, brick in enumerate(BRICKS[:2])]
    wall = rb.Wall.outlines(apart, units="mm", heal=0.001, **THICK)
    assert sorted(wall.scene.joints.length) == pytest.approx([0.1, 0.2, 0.2], abs=1e-3)


def test_stones_without_ground_are_healed_onto_the_strip_below_them() -> None:
    """One foundation stone is 1 mm high. Healing broke the bearing of its neighbour, and no note told of the gap."""
    lifted = np.array([[400, 1], [800, 1], [800, 200], [400, 200]])
    stones = [*(shapely.box(x, y, x + 400, y + 200).exterior.coords[:-1] for x, y in ((0, 0), (0, 200), (400, 200)))]
    stones = [*map(np.array, stones), lifted]
    loose = rb.Wall.outlines(stones, units="mm", **THICK)
    (note,) = loose.scene.notes
    assert note.startswith("a gap of 0.001 m between block 3")
    assert note.endswith("[wall] heal = 0.0011 would close it")
    healed = rb.Wall.outlines(stones, units="mm", heal=0.002, **THICK)
    on_ground = rb.Wall.outlines(stones, [GROUND], units="mm", heal=0.002, **THICK)
    for wall in (healed, on_ground):
        assert len(wall.scene.joints) == 6
        assert wall.run("limit").multiplier == pytest.approx(0.6, rel=1e-6)
    pier = [shapely.box(0, y, 500, y + 400).exterior.coords[:-1] for y in (0, 408)]
    assert len(rb.Wall.outlines(pier, units="mm", heal=0.01, **THICK).scene.joints) == 2  # the strip sets no limit
    for kind in ("fixed-first-course", "corners"):
        assert rb.Wall.outlines(stones, units="mm", support=kind, **THICK).scene.notes == ()


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"outlines": []}, "wall.outlines = []: must be a list of outlines"),
        ({"outlines": 3}, "wall.outlines = 3: must be a list of outlines"),
        ({"outlines": [[[0, 0], [1, 0]]]}, r"wall.outlines[0] = [[0, 0], [1, 0]]: must be an outline"),
        ({"outlines": [[[0, 0], [1, 0], [1, "x"]]]}, "wall.outlines[0][2] = [1, 'x']: must be a pair"),
        ({"outlines": [[[0, 0], [1, 1], [1, 0], [0, 1]]]}, "wall.outlines[0]: crosses itself at (0.5, 0.5) m"),
        ({"outlines": [[[0, 0], [0.1, 0.3], [0.2, 0.6]]]}, "wall.outlines[0]: has no area: its corners, the first at"),
        ({"outlines": [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]}, "wall.outlines[0][0] = [0, 0, 0]: must be a pair"),
        ({"ground": []}, "wall.ground = []: must be a list of outlines"),
        ({"ground": [[[0, 0]]]}, "wall.ground[0] = [[0, 0]]: must be an outline"),
        ({"units": "km"}, "wall.units = 'km': must be one of"),
        ({"length": 2.0}, "wall.length: does not go with wall.outlines"),
        ({"courses": [[1]]}, "wall.courses: does not go with wall.outlines"),
        ({"drawing": "wall.dxf"}, "wall.outlines: does not go with wall.drawing"),
    ],
)
def test_invalid_outlines_are_refused(keys: dict[str, Any], message: str) -> None:
    wall = {"outlines": [[[0, 0], [1, 0], [1, 1], [0, 1]]], "thickness": 0.2, **keys}
    with pytest.raises(SceneError) as refused:
        rb.Wall({**TABLES, "wall": wall})
    assert str(refused.value).startswith(message)


def test_outlines_may_be_object_arrays_or_coordinate_sequences() -> None:
    """Stones with different numbers of corners as an object array; shapely's coordinates, which are no arrays."""
    stones = np.empty(2, dtype=object)
    stones[:] = [np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), np.array([[1, 0], [2, 0], [1, 1]])]
    wall = rb.Wall.outlines(stones, **THICK)
    assert wall.description["wall"]["outlines"][1] == [[1, 0], [2, 0], [1, 1]]
    assert wall.with_({"wall.outlines[1][2]": [1, 0.5]}).scene.blocks.area[1] == pytest.approx(0.25)
    rings = rb.Wall.outlines([shapely.Polygon(stone).exterior.coords for stone in stones], **THICK)
    assert fingerprint(rings.scene, "limit", 0.01) == fingerprint(wall.scene, "limit", 0.01)


def test_messages_about_many_stones_are_one_short_line() -> None:
    """For a key given without its table the message shows how to give it, but not the whole value."""
    wall = rb.Wall.outlines(BRICKS, units="mm", **THICK)
    for keys in ({"outlines": 50 * BRICKS}, {"wall__outlines": 50 * BRICKS}):
        with pytest.raises(SceneError, match=r'give it as \{"wall.outlines": .*…}$') as refused:
            wall.with_(**keys)
        assert len(str(refused.value)) < 250


def test_messages_about_listed_stones_name_their_own_keys() -> None:
    with pytest.raises(SceneError, match="the wall brings its ground"):
        rb.Wall.outlines(BRICKS, [GROUND], units="mm", support="corners", **THICK)
    (length, _) = warnings(rb.Wall.outlines(BRICKS, **THICK).scene)
    assert length.startswith("wall: length = 400: is not within")
    apart = [np.array(brick) - [0.4 * k, 0.0] for k, brick in enumerate(BRICKS[:2])]
    with pytest.raises(SceneError, match="wall.heal closes small overlaps of drawings and outlines"):
        rb.Wall.outlines(apart, units="mm", **THICK)
