"""Settlements: cutting of the ground by their boxes, motion of supports and paths."""

import math
from typing import Any

import numpy as np
import pytest

from runningbond.limit.settlement import largest_displacement
from runningbond.models import run_model
from runningbond.results.mechanism import carried
from runningbond.scene import Scene, SceneError, scene_from_dict
from tests.walls import panel

from .drafting import box as box_of
from .drafting import closed, dxf, tables


def piers(tmp_path: Any, at: float, box: float) -> Scene:
    """Two mortared piers on two pieces of ground that meet at x = `at`; the ground right of x = `box` sinks."""
    x = 1e3 * at
    blocks = [box_of(0.0, 0.0, 400.0, 300.0), box_of(400.02, 0.0, 800.0, 300.0)]
    grounds = [box_of(-200.0, -100.0, x, 0.0), box_of(x, -100.0, 1000.0, 0.0)]
    path = dxf(tmp_path / "wall.dxf", closed(blocks), closed(grounds, layer="ground"), ground=False)
    live = {"kind": "settlement", "box": [[box, -1.0], [2.0, 0.0]], "by": [0.0, -1.0]}
    joint = {"friction": 0.6, "cohesion": 3e3}
    return scene_from_dict(
        tables(thickness=0.2) | {"joint": joint, "load": {"gravity": 9.81, "live": live}}, folder=path.parent
    )


@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-5, -1e-5])
def test_box_within_tolerance_of_a_ground_edge_snaps_to_it(off: float, tmp_path: Any) -> None:
    """It cuts no sliver of ground; the contact tolerance and the multiplier stay the same."""
    exact, beside = (piers(tmp_path, 0.40001, 0.40001 + x) for x in (0.0, off))
    assert len(beside.blocks) == 4
    assert beside.blocks.tolerance == exact.blocks.tolerance
    assert np.array_equal(beside.support_motion != 0, exact.support_motion != 0)
    loads = [run_model("limit", scene).multiplier for scene in (exact, beside)]
    assert loads[1] == pytest.approx(loads[0], rel=1e-6)


@pytest.mark.parametrize("at", [0.3, 0.5, 0.7, 0.1 + 0.2])
def test_rounding_of_units_cuts_no_sliver_of_ground(at: float, tmp_path: Any) -> None:
    assert len(piers(tmp_path, at, at).blocks) == 4


@pytest.mark.parametrize("width", [0.1, 0.2, 0.3, 0.4, 0.6, 0.7])
def test_fixed_block_centred_on_a_box_side_does_not_move(width: float) -> None:
    """The second to the seventh of eight fixed blocks in turn, with decimal coordinates that are rounded."""
    size = {"length": round(8 * width, 9), "height": 0.6, "block_width": width, "block_height": 0.3, "thickness": 0.1}
    for number in range(1, 7):
        middle, moving = round((number + 0.5) * width, 9), []
        for box in ([[-1, -1], [middle, 0.3]], [[middle, -1], [9, 0.3]]):
            live = {"kind": "settlement", "box": box, "by": [0, -1e-3]}
            scene = panel(wall=size, support__kind="fixed-first-course", load__live=live)
            moving.append(int(scene.support_motion.any(axis=1).sum()))
        assert moving == [number, 7 - number]


@pytest.mark.parametrize(("bottom", "top"), [(-1.0, 0.0), (0.3, 1.0)])
def test_box_that_only_touches_fixed_blocks_is_refused(bottom: float, top: float) -> None:
    """At their bottom or top, however far it extends sideways."""
    size = {"length": 1.6, "height": 0.6, "block_width": 0.4, "block_height": 0.3, "thickness": 0.1}
    live = {"kind": "settlement", "box": [[0.1, bottom], [9.0, top]], "by": [0.0, -1e-3]}
    with pytest.raises(SceneError, match="holds no ground that bears a block"):
        panel(wall=size, support__kind="fixed-first-course", load__live=live)


@pytest.mark.parametrize("top", [0.01, 0.15, 0.3, 1.0])
def test_fixed_block_moves_for_any_overlap_in_height(top: float) -> None:
    size = {"length": 1.6, "height": 0.6, "block_width": 0.4, "block_height": 0.3, "thickness": 0.1}
    live = {"kind": "settlement", "box": [[-1.0, -1.0], [0.7, top]], "by": [0.0, -1e-3]}
    scene = panel(wall=size, support__kind="fixed-first-course", load__live=live)
    assert np.flatnonzero(scene.support_motion.any(axis=1)).tolist() == [0, 1]


@pytest.mark.parametrize("side", [0.65, 0.75, 0.85, 0.95, 1.05])
def test_halves_of_a_fixed_block_move_together(side: float) -> None:
    """They move exactly if the uncut block would; otherwise the settlement would tear a joint of any strength."""
    size = {"length": 1.6, "height": 0.4, "block_width": 0.4, "block_height": 0.2, "thickness": 0.1}
    live = {"kind": "settlement", "box": [[side, -1.0], [9.0, 0.2]], "by": [0.0, -1e-3]}
    inner = {"friction": 0.6, "cohesion": 1e9}
    whole, cut = (
        panel(wall=size, support__kind="fixed-first-course", load__live=live, **one)
        for one in ({}, {"inner_joint": inner})
    )
    moving, pieces = (np.flatnonzero(scene.support_motion[:, 1]) for scene in (whole, cut))
    assert np.array_equal(pieces, np.flatnonzero(np.isin(cut.part_of, moving)))
    found = [run_model("limit", scene).multiplier for scene in (whole, cut)]
    assert found[0] == pytest.approx(found[1], rel=1e-6)


@pytest.mark.parametrize(("side", "moving"), [(0.34, 2), (0.35, 1), (0.43, 1)])
def test_halves_of_a_trapezoid_move_if_its_centroid_is_in_the_box(side: float, moving: int) -> None:
    """For sides of 1 m and 0.2 m, 0.3 m apart, it is at x = 31 / 90; the halves are weighted by their areas."""
    outlines = [
        [[0, 0], [1, 0], [0.2, 0.3], [0, 0.3]],
        [[1, 0], [1.6, 0], [1.6, 0.3], [1, 0.3]],
        [[1, 0.3], [1.6, 0.3], [1.6, 0.6], [1, 0.6]],
    ]
    live = {"kind": "settlement", "box": [[side, -1.0], [9.0, 0.2]], "by": [0.0, -1e-3]}
    wall = {"outlines": outlines, "thickness": 0.1}
    scene = panel(wall=wall, support__kind="fixed-first-course", load__live=live, inner_joint={"friction": 0.6})
    assert len(np.unique(scene.part_of[scene.support_motion.any(axis=1)])) == moving


@pytest.mark.parametrize("right", [-0.5, 0.0, 1.0])
def test_ground_above_a_settlement_box_does_not_move(right: float, tmp_path: Any) -> None:
    """A terrace sinks beneath one of two equal piers and carries half of their weight; the bank with the other stays.

    However far the box extends under the bank: with its middle in the box the whole ground once sank and carried all.
    """
    blocks = [box_of(-1000.0, -500.0, -700.0, -200.0), box_of(0.0, 0.0, 300.0, 300.0)]
    ground = [(-1200, -900), (1500, -900), (1500, 0), (-500, 0), (-500, -500), (-1200, -500)]
    path = dxf(tmp_path / "wall.dxf", closed(blocks), closed([ground], layer="ground"), ground=False)
    live = {"kind": "settlement", "box": [[-2.0, -1.0], [right, -0.4]], "by": [0.0, -0.01]}
    load = {"gravity": 9.81, "live": live}
    scene = scene_from_dict(tables(thickness=0.2) | {"load": load}, folder=path.parent)
    assert run_model("limit", scene).multiplier == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("about", [None, (0.3, -0.7)])
def test_ground_turns_about_its_point_as_a_rigid_body(about: tuple[float, float] | None) -> None:
    """That point, or by default the centre of the box, moves by `by`; a point 1 m to its right also rises by the angle.

    Only the moving ground rotates. The control point is on top of it, in the direction of the motion there.
    """
    by, angle = (0.002, -0.005), 2.0
    live: dict[str, Any] = {"kind": "settlement", "box": [[0.8, -3.0], [4.0, 0.5]], "by": by, "rotation_angle": angle}
    live |= {} if about is None else {"about": about}
    scene = panel(load__live=live)
    moving = np.flatnonzero(scene.support_motion.any(axis=1))
    assert len(moving) == 1
    point, turn = np.array(about or (2.4, -1.25)), math.radians(angle)

    def motion(place: Any) -> Any:
        return carried(scene.blocks, moving, np.array([place]), scene.support_motion)[0]

    assert motion(point) == pytest.approx(by, abs=1e-15)
    assert motion(point + [1.0, 0.0]) == pytest.approx([by[0], by[1] + turn], rel=1e-12)
    assert motion(point + [0.0, 1.0]) == pytest.approx([by[0] - turn, by[1]], rel=1e-12)
    block, (at,), (direction,) = scene.control_point
    low, high = scene.blocks.extent(int(moving[0]))
    assert (block.tolist(), at.tolist()) == (moving.tolist(), pytest.approx([(low[0] + high[0]) / 2, high[1]]))
    assert direction * np.hypot(*motion(at)) == pytest.approx(motion(at), rel=1e-12)


@pytest.mark.parametrize("off", [0.0, 1e-17, 1e-9])
@pytest.mark.parametrize("angle", [1.0, -1.0])
def test_control_point_is_where_ground_that_turns_about_its_top_moves_most(angle: float, off: float) -> None:
    """The middle of the top stays, or moves by rounding errors only; the control point is an end of a joint."""
    live = {"kind": "settlement", "box": [[0.0, -0.1], [0.4, 0.1]], "rotation_angle": angle, "about": [0.2 + off, 0.0]}
    scene = panel(load__live=live)
    (block,), (at,), (direction,) = scene.control_point
    assert scene.support_motion[block].any()
    assert at == pytest.approx([0.0, 0.0], abs=1e-12)
    assert direction == pytest.approx([0.0, -angle], abs=1e-12)
    move = carried(scene.blocks, np.array([block]), at[None], scene.support_motion)[0]
    assert move @ direction == pytest.approx(largest_displacement(scene), rel=1e-6)
    (arrow,) = scene.load.live[0].arrows(scene)
    assert np.hypot(*arrow.direction) == pytest.approx(1.0)


def test_support_turns_by_ten_degrees_at_most_along_its_path() -> None:
    """Exactly ten degrees are accepted although 3 · 10/3 is rounded."""
    live = {"kind": "settlement", "box": [[0.8, -3.0], [4.0, 0.5]], "rotation_angle": 10 / 3}
    assert panel(load__live=live | {"path": [1.0, -3.0]}).settlement.farthest == 3.0  # type: ignore[union-attr]
    with pytest.raises(SceneError, match=r"rotation_angle = 3\.3\d*: must turn the support by at most 10 degrees"):
        panel(load__live=live | {"path": [1.0, -3.01]})


def test_ground_is_cut_into_moving_and_fixed_parts(tmp_path: Any) -> None:
    """It is cut at both sides and at the top of the box, for a shallow box too; the areas add up to the whole."""
    ground = [(-1000, -900), (2000, -900), (2000, 0), (800, 0), (800, 400), (600, 400), (600, 0), (-1000, 0)]
    pier = box_of(100.0, 0.0, 400.0, 300.0)
    path = dxf(tmp_path / "wall.dxf", closed([pier]), closed([ground], layer="ground"), ground=False)
    live = {"kind": "settlement", "box": [[0.0, -0.1], [1.5, 0.1]], "by": [0.0, -0.01]}
    scene = scene_from_dict(tables(thickness=0.2) | {"load": {"gravity": 9.81, "live": live}}, folder=path.parent)
    moves = scene.support_motion.any(axis=1)
    assert scene.blocks.area[moves] == pytest.approx([1.5 * 0.9 + 0.2 * 0.1])
    assert np.sort(scene.blocks.area[scene.fixed & ~moves]) == pytest.approx([0.2 * 0.3, 0.5 * 0.9, 0.9])


def test_settlement_path_is_given_in_one_way() -> None:
    """By turning points, or by amplitudes with cycles; `about` needs `rotation_angle`."""
    live = {"kind": "settlement", "box": [[0.8, -3.0], [4.0, 0.5]], "by": [0.0, -0.01]}
    assert panel(load__live=live | {"amplitudes": [0.5, 1.0]}).settlement.path == (0.5, -0.5, 1.0, -1.0, 0.0)  # type: ignore[union-attr]
    with pytest.raises(SceneError, match="load.live: must have one of path and amplitudes, not both"):
        panel(load__live=live | {"amplitudes": [0.5, 1.0], "path": [1.0]})
    with pytest.raises(SceneError, match="load.live.rotation_angle: is missing; about is the point"):
        panel(load__live=live | {"about": [1.0, 0.0]})
