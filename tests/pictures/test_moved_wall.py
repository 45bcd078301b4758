"""Pictures of walls after a ground motion."""

import itertools
import math
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

import runningbond as rb
from runningbond.pictures.moved_wall import MAX_DISTANCE, NEGLIGIBLE, draw_moved, enlarged, extent_around, moved_shape
from runningbond.pictures.response import response_figure

mpl.use("Agg")
BLOCK: dict[str, Any] = {"block_width": 0.25, "block_height": 1.0, "thickness": 0.2, "density": 2000.0}
SPRINGS = {"friction": 0.8, "normal_stiffness": 1e8, "shear_stiffness": 4e7}


def shaken(amplitude: float) -> rb.Wall:
    pulse = {"pulse": {"kind": "half-sine", "amplitude": amplitude, "period": 1.0}, "quantity": "g"}
    return rb.Wall.courses([[1]], **BLOCK, **SPRINGS, history=pulse)


def test_fallen_block_is_drawn_where_it_lies() -> None:
    """Rotated by 90° to the right about its foot: it lies on its side in its true size."""
    scene = shaken(0.1).scene
    middle, foot = scene.blocks.centroid[0], scene.blocks.extent(0)[0] + [0.25, 0.0]
    motion = np.zeros((len(scene.blocks), 3))
    motion[0] = *(foot + [middle[1] - foot[1], foot[0] - middle[0]] - middle), -math.pi / 2
    shape = moved_shape(scene, motion)
    low, high = shape.placed.min(axis=0), shape.placed.max(axis=0)
    assert shape.scale == 1.0
    assert [*low, *high] == pytest.approx([foot[0], foot[1], foot[0] + 1.0, foot[1] + 0.25])


def test_small_motion_is_enlarged_and_distant_blocks_are_left_out() -> None:
    scene = shaken(0.1).scene
    motion = np.zeros((len(scene.blocks), 3))
    motion[0, 0] = 1e-4
    assert moved_shape(scene, motion).scale > 100
    assert moved_shape(scene, 0 * motion).scale == 1.0
    motion[0, 0] = 50.0
    left, right, _, _ = extent_around([moved_shape(scene, motion)])
    (start, bottom), (end, top) = scene.blocks.extent(scene.wall)
    assert right - end < MAX_DISTANCE * max(end - start, top - bottom) + 0.1 * scene.size
    assert start - left < 0.1 * scene.size


@pytest.mark.parametrize(("amplitude", "verdict", "walls"), [(0.2, "stands", 1), (1.0, "collapse", 2)])
def test_response_figure_shows_wall_at_collapse_and_at_end(amplitude: float, verdict: str, walls: int) -> None:
    wall = shaken(amplitude)
    response = wall.respond("dem-dynamic")
    assert response.verdict == verdict
    drawn = [axes for axes in response_figure(response, wall.scene).axes if axes.collections and not axes.lines]
    assert len(drawn) == walls
    assert "displacements ×" in drawn[0].get_title()
    (block,) = [each for each in response.plot().collections if isinstance(each, PolyCollection) and each.zorder == 2]
    shape = moved_shape(wall.scene, response.motion)
    assert np.asarray(block.get_paths()[0].vertices)[:4] == pytest.approx(shape.placed)


def test_negligible_motion_is_not_enlarged() -> None:
    """A large scale would show it as a ruin."""
    scene = shaken(0.1).scene
    motion = np.zeros((len(scene.blocks), 3))
    motion[0, 0] = 0.9 * NEGLIGIBLE * scene.blocks.tolerance
    assert moved_shape(scene, motion).scale == 1.0
    motion[0, 0] = 1.1 * NEGLIGIBLE * scene.blocks.tolerance
    assert enlarged(moved_shape(scene, motion)) == ", displacements × 10,900"


def test_ties_are_drawn_between_displaced_ends() -> None:
    tie = {"from": [0.0, 0.5], "to": [0.25, 0.5], "area": 1e-4, "young": 2e11, "yield": 1e4}
    scene = shaken(0.1).with_(tie=[{**tie, "to": [2.0, 0.5]}]).scene
    motion = np.zeros((len(scene.blocks), 3))
    motion[0, 1] = 0.5
    axes, shape = Figure().add_subplot(), moved_shape(scene, motion)
    draw_moved(axes, shape, extent_around([shape]))
    (line,) = [line for line in axes.lines if line.get_label() == "tie"]
    assert np.column_stack(line.get_data()) == pytest.approx(np.array([[0.0, 1.0], [2.0, 0.5]]))


def test_figure_height_fits_wall_and_titles_do_not_overlap() -> None:
    """No white band around a low wall, and no title that overlaps the next picture."""
    tall = shaken(0.2)
    low = tall.with_({"wall.courses": [[8, 8, 8]], "wall.block_height": 0.2})
    tall_one, low_one = tall.respond("dem-dynamic"), low.respond("dem-dynamic")
    assert (
        response_figure(low_one, low.scene).get_figheight() < response_figure(tall_one, tall.scene).get_figheight() - 1
    )
    figure = Figure(figsize=(6.4, 2.0), layout="constrained")
    for axes in (*figure.subplots(1, 4),):
        tall_one.plot(axes)
    figure.draw_without_rendering()
    boxes = [axes.title.get_window_extent() for axes in figure.axes]
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))


def test_wall_that_falls_under_dead_load_is_drawn_undeformed() -> None:
    leaning = shaken(0.1).with_({"load.gravity": [9.0, -3.0]})
    response = leaning.respond("dem-dynamic")
    assert response.verdict == "infeasible"
    assert response.plot().get_title().startswith("infeasible: collapses under its dead load")
    assert response._repr_png_() is None
