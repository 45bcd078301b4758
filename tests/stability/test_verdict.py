"""Criteria of the verdict, too tight and too loose, against walls whose load is known."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from dem import limit_nonassociated
from dem.rigid_system import rigid_system
from runningbond.compare.published import published_scene
from runningbond.dynamics import Criteria, Run, load_steps
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.dynamics.load_stepping import LOADING_WEIGHTLESS
from runningbond.studies.stability.literature import KnownWall, rounded_wall, sliding_block, toppling_block
from runningbond.studies.stability.verdict import (
    INTERVAL,
    REST,
    WEIGHTLESS,
    WIDTH,
    believed,
    experiment,
    far_sweep,
    interval_sweep,
    rest_sweep,
    trial,
    weightless_sweep,
)

WALLS = [sliding_block(), toppling_block(), rounded_wall("wall-w1")]


@pytest.mark.parametrize("wall", WALLS, ids=lambda wall: str(wall.name))
def test_the_suites_criteria_stand_on_a_plateau(wall: KnownWall) -> None:
    """Half and twice each of them find the same λ, which is the one known."""
    for sweep in (
        rest_sweep(wall, (REST / 2, REST, 2 * REST)),
        far_sweep(wall, (U_CRIT / 2, U_CRIT, 2 * U_CRIT)),
        interval_sweep(wall, (INTERVAL // 2, INTERVAL, 2 * INTERVAL)),
    ):
        assert sweep.plateau == (sweep.default / 2, 2 * sweep.default), sweep.criterion
        assert sweep.trials[sweep.default].middle == pytest.approx(wall.multiplier, rel=WIDTH)


@pytest.mark.parametrize("wall", WALLS, ids=lambda wall: str(wall.name))
def test_a_threshold_of_rest_too_loose_takes_walls_for_standing_up_to_the_load_that_theory_has(
    wall: KnownWall,
) -> None:
    """λ_c + r / w: false stability, 5 to 10 % above the load with r = 0.03."""
    loose = (0.01, 0.03)
    sweep = rest_sweep(wall, (REST, *loose))
    middles = [sweep.trials[rest].middle for rest in loose]
    assert middles == pytest.approx(list(believed(wall, np.array(loose))), rel=WIDTH)
    assert (middles[1] or 0.0) > 1.04 * wall.multiplier
    assert sweep.plateau == (REST, REST)


def test_a_threshold_of_rest_below_rounding_is_never_met() -> None:
    assert trial(sliding_block().scene, U_CRIT, rest=1e-16).answer == "undecided"


def test_a_displacement_too_small_takes_settlement_for_a_fall() -> None:
    assert trial(rounded_wall("wall-w1").scene, 1e-7).answer == "infeasible"


def test_a_displacement_too_small_takes_a_slip_for_a_fall() -> None:
    """W2 at a hundred-thousandth of a block: false collapse some 2 % below the load, where a thousandth is right."""
    wall = rounded_wall("wall-w2")
    slip, right = (trial(wall.scene, far).middle for far in (1e-5, 1e-3))
    assert (slip or 0.0) < 0.985 * wall.multiplier
    assert right == pytest.approx(wall.multiplier, rel=WIDTH)


def test_a_wall_without_weight_pauses_and_bears_the_same_at_any_speed() -> None:
    """A quarter of the time to come to each load, and four times it, find one λ to 1 %."""
    scene = published_scene(WEIGHTLESS)
    run = Run(rigid_system(scene))
    first, criteria = FIRST_STEP / run.system.measure(run.system.live), Criteria(U_CRIT * scene.block_sizes)
    loadings = (LOADING_WEIGHTLESS / 4, LOADING_WEIGHTLESS, 4 * LOADING_WEIGHTLESS)
    found = [load_steps(run, first, WIDTH, criteria, loading=loading) for loading in loadings]
    assert found[0].lower == pytest.approx(found[1].lower, rel=0.01)
    assert found[2].lower == pytest.approx(found[1].lower, rel=0.01)


@pytest.mark.long
def test_without_weight_the_suite_follows_it_far_enough() -> None:
    """Twice as far finds the same λ, inside the interval that is certified."""
    sweep = weightless_sweep((U_CRIT, 2 * U_CRIT))
    certified = limit_nonassociated(published_scene(WEIGHTLESS))
    assert sweep.plateau == (U_CRIT, 2 * U_CRIT)
    assert (certified.lower or np.inf) <= sweep.unit <= (certified.upper or 0.0)


@pytest.mark.long
def test_every_edge_lies_where_theory_has_it_and_defaults_inside() -> None:
    found = experiment()
    assert not [edge for edge in found.edges if edge.agrees is False]
    found.draw(Figure(layout="constrained"))
