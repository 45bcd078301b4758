"""The stiffness update as published: exact for one block, failing on walls, and reported as such."""

import numpy as np
import pytest

from dem.stiffness_update import load_step, resultant_wall
from runningbond.compare.published import published_scene
from runningbond.limit import limit
from runningbond.studies import Row
from runningbond.studies.stability.stiffness_update import (
    BORNE,
    ENDED,
    INCREMENTS,
    OUTSIDE,
    block_row,
    collapse_load,
    loaded,
    measure,
)
from runningbond.studies.walls import one_block

WALLS = ("panel-02", "panel-04", "wall-w2", "wall-w3")


@pytest.mark.parametrize(
    ("what", "borne"),
    [
        pytest.param("topples, l_c half the joint", 1.0, marks=pytest.mark.long),
        ("slides, l_c half the joint", 1.0),
        pytest.param("topples, l_c the whole joint", 2.0, marks=pytest.mark.long),
    ],
)
def test_one_block_is_followed_to_its_exact_collapse(what: str, borne: float) -> None:
    """b/h, μ, and 2 b/h if l_c is the whole length of the joint, to 1e-3."""
    row = block_row(what)
    assert row["theory"] == borne
    assert row["measured"] == pytest.approx(borne, rel=1e-3)


def test_step_beyond_collapse_is_singular_and_ends_the_run() -> None:
    """Loaded up to 1.25 b/h in ten steps: eight of them converge."""
    row = loaded(one_block(0.5, 2.0, 0.6, 1e11), 1.25 * 0.25, 0.5, 10)
    assert row["fates"] == ["converged"] * 8 + ["singular", "unreached"]
    assert row[BORNE] == pytest.approx(0.8)
    assert row[ENDED] == "singular"


@pytest.fixture(scope="module")
def result() -> dict[tuple[str, int], Row]:
    return {(wall, steps): measure(wall, 0.5, steps) for wall in WALLS for steps in INCREMENTS}


@pytest.mark.long
def test_no_wall_reaches_the_collapse_load_of_the_robust_variant(result: dict[tuple[str, int], Row]) -> None:
    """That load, which `dem_static` reaches, is below the bound of limit analysis."""
    for (wall, _), row in result.items():
        associated = limit(published_scene(wall)).upper
        assert associated is not None
        assert collapse_load(wall) <= associated * (1 + 1e-6)
        assert row[ENDED] in ("cycle", "singular", "wandering")
        assert row[BORNE] < 0.8


@pytest.mark.long
def test_finer_steps_do_not_help(result: dict[tuple[str, int], Row]) -> None:
    """In a hundred steps panel-02 gets less far than in ten; panel-04 and W3 fail at once in both."""
    borne = {which: row[BORNE] for which, row in result.items()}
    assert borne["panel-02", 100] < borne["panel-02", 10]
    assert borne["panel-04", 100] == borne["panel-04", 10] == 0.0
    assert borne["wall-w3", 100] == borne["wall-w3", 10] < 0.0


@pytest.mark.long
def test_every_tenth_of_the_load_has_a_status(result: dict[tuple[str, int], Row]) -> None:
    """A stepwise run ends once; load steps beyond are never reported as converged."""
    for (_, steps), row in result.items():
        fates = row["fates"]
        assert len(fates) == 10
        if steps > 1:
            end = fates.index(row[ENDED])
            assert set(fates[:end]) <= {"converged", "outside"}
            assert set(fates[end + 1 :]) <= {"unreached"}
            assert end <= 10 * max(row[BORNE], 0.0) + 1e-9 <= end + 1


def test_converged_step_may_violate_the_joint_law() -> None:
    """Equilibrium holds, Eq. 3 does not: it was checked for other forces than those kept. W1, up to .45."""
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
