"""The stiffness update as published: exact on one block, lost on walls, and honest about it."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from dem.stiffness_update import load_step, resultant_wall
from runningbond.compare.published import published_scene
from runningbond.limit import limit
from runningbond.studies.stability.blocks import one_block
from runningbond.studies.stability.stiffness_update import (
    ARMS,
    INCREMENTS,
    LOOKS,
    OUTSIDE,
    Trial,
    block_edges,
    draw,
    trial,
    trials,
)


def test_one_block_is_borne_to_its_exact_collapse() -> None:
    """b/h, μ, and 2 b/h with l_c the whole length of the joint, to 1e-3."""
    assert [edge.theory for edge in block_edges()] == [1.0, 1.0, 2.0]
    assert all(edge.agrees for edge in block_edges())


def test_a_block_beyond_its_collapse_is_singular_and_what_follows_is_not_reached() -> None:
    """Loaded up to 1.25 b/h in ten steps: eight of them are borne."""
    found = trial("block", one_block(0.5, 2.0, 0.6, 1e11), 1.25 * 0.25, 10, 0.5)
    assert list(found.fates) == ["converged"] * 8 + ["singular", "unreached"]
    assert found.borne == pytest.approx(0.8)
    assert found.end == "singular"


@pytest.fixture(scope="module")
def found() -> list[Trial]:
    return trials(("panel-02", "panel-04", "wall-w2", "wall-w3"), arms=ARMS[:1])


def test_no_wall_is_borne_to_the_collapse_load_of_the_robust_variant(found: list[Trial]) -> None:
    """A load below the one that limit analysis allows, which `dem_static` bears."""
    for each in found:
        associated = limit(published_scene(each.wall)).upper
        assert associated is not None
        assert each.collapse <= associated * (1 + 1e-6)
        assert each.end in ("cycle", "singular", "wandering")
        assert each.borne < 0.8


def test_finer_steps_do_not_help(found: list[Trial]) -> None:
    """In a hundred steps panel-02 gets less far than in ten, and panel-04 and W3 nowhere in either."""
    borne = {(each.wall, each.increments): each.borne for each in found}
    assert borne["panel-02", 100] < borne["panel-02", 10]
    assert borne["panel-04", 100] == borne["panel-04", 10] == 0.0
    assert borne["wall-w3", 100] == borne["wall-w3", 10] < 0.0


def test_every_tenth_of_the_load_has_its_fate(found: list[Trial]) -> None:
    """A run in steps ends once; what lies beyond is never told as borne."""
    for each in found:
        assert len(each.fates) == 10
        if each.increments > 1:
            end = each.fates.index(each.end)
            assert set(each.fates[:end]) <= {"converged", "outside"}
            assert set(each.fates[end + 1 :]) <= {"unreached"}
            assert end <= 10 * max(each.borne, 0.0) + 1e-9 <= end + 1


def test_a_step_may_converge_on_forces_that_break_the_law() -> None:
    """Equilibrium is kept, and Eq. 3 is not: it was asked of other forces than those that are kept. W1, up to .45."""
    wall = resultant_wall(published_scene("wall-w1"))
    force = 0.0 * wall.law.stiffness
    excess = []
    for multiplier in np.arange(8) * 0.064:
        load = wall.dead + multiplier * wall.live
        step = load_step(wall, force, load)
        assert step.status == "converged"
        force = step.force
        assert wall.jump.T @ force.T.ravel() == pytest.approx(load, abs=1e-9 * np.abs(load).max())
        excess.append(wall.excess(force))
    assert excess[0] < 1e-9
    assert max(excess) > 10 * OUTSIDE


def test_chart_has_a_map_for_every_size_of_step(found: list[Trial]) -> None:
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    draw(figure, found)
    assert len(figure.axes) == len(INCREMENTS)
    walls = list(dict.fromkeys(each.wall for each in found))
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == walls
    for axes, increments in zip(figure.axes, INCREMENTS, strict=True):
        fates = [fate for each in found if each.increments == increments for fate in each.fates]
        assert [text.get_text() for text in axes.texts] == [LOOKS[fate][1] for fate in fates]
