"""Criteria of the verdict, too tight and too loose, against walls whose load is known."""

from functools import cache

import numpy as np
import pytest

from dem.rigid_system import rigid_system
from runningbond.compare.published import published_scene
from runningbond.dynamics import Criteria, Run, load_steps
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.dynamics.load_stepping import LOADING_WEIGHTLESS
from runningbond.limit import limit_nonassociated
from runningbond.studies import Rows
from runningbond.studies.stability.verdict import (
    DEFAULT,
    FAR,
    INTERVAL,
    PART,
    REST,
    WEIGHTLESS,
    WIDTH,
    believed,
    plateau,
    search,
    sweep,
)
from runningbond.studies.walls import SLIDING, TOPPLING, W1, W2, known_wall
from tests.at_length import at_length


def swept(wall: str, criterion: str, values: tuple[float, ...]) -> Rows:
    """Searches with one criterion changed, as rows of the study."""
    case = {"wall": wall, "criterion": criterion}
    return {PART: [case | {"value": value} | search(wall, criterion, value) for value in values]}


@pytest.mark.parametrize("wall", [SLIDING, *at_length(TOPPLING, W1)])
@pytest.mark.parametrize("criterion", [REST, FAR, INTERVAL])
def test_the_suites_criteria_stand_on_a_plateau(wall: str, criterion: str) -> None:
    """Half and twice each of them find the same λ, which is the one known."""
    default = DEFAULT[criterion]
    rows = sweep(swept(wall, criterion, (default / 2, default, 2 * default)), wall, criterion)
    assert plateau(rows) == (default / 2, 2 * default)
    assert rows[1]["λ"] == pytest.approx(known_wall(wall).multiplier, rel=WIDTH)


@pytest.mark.parametrize("wall", [SLIDING, TOPPLING, W1])
def test_a_threshold_of_rest_too_loose_takes_walls_for_standing_up_to_the_load_that_theory_has(wall: str) -> None:
    """λ_c + r / w: false stability, 5 to 10 % above the load with r = 0.03."""
    rest = DEFAULT[REST]
    rows = sweep(swept(wall, REST, (rest, 0.01, 0.03)), wall, REST)
    assert [row["λ"] for row in rows[1:]] == pytest.approx([believed(wall, r) for r in (0.01, 0.03)], rel=WIDTH)
    assert rows[2]["λ"] > 1.04 * known_wall(wall).multiplier
    assert plateau(rows) == (rest, rest)


def test_a_threshold_of_rest_below_rounding_is_never_met() -> None:
    assert search(SLIDING, REST, 1e-16)["answer"] == "undecided"


def test_a_displacement_too_small_takes_settlement_for_a_fall() -> None:
    assert search(W1, FAR, 1e-8)["answer"] == "infeasible"


@pytest.mark.long
@pytest.mark.parametrize("farthest", [1e-6, 1e-3])
def test_a_small_displacement_takes_no_slip_for_a_fall(farthest: float) -> None:
    """W2 slips by more than a millionth of a block from rest to rest, and falls once it comes as far again."""
    assert search(W2, FAR, farthest)["λ"] == pytest.approx(known_wall(W2).multiplier, rel=WIDTH)


@pytest.mark.long
@pytest.mark.parametrize("times", [1 / 4, 4])
def test_a_wall_without_weight_pauses_and_bears_the_same_at_any_speed(times: float) -> None:
    """A quarter of the time to come to each load, and four times it, find one λ to 1 %."""
    assert weightless_at(times) == pytest.approx(weightless_at(1), rel=0.01)


@cache
def weightless_at(times: float) -> float | None:
    """λ that the wall without weight bears, which takes so many times as long as in the suite to come to each load."""
    scene = published_scene(WEIGHTLESS)
    run = Run(rigid_system(scene))
    first, criteria = FIRST_STEP / run.system.measure(run.system.live), Criteria(U_CRIT * scene.block_sizes)
    return load_steps(run, first, WIDTH, criteria, loading=times * LOADING_WEIGHTLESS).lower


@pytest.mark.long
def test_without_weight_the_suite_follows_it_far_enough() -> None:
    """Twice as far finds the same λ, inside the interval that is certified."""
    rows = sweep(swept(WEIGHTLESS, FAR, (U_CRIT, 2 * U_CRIT)), WEIGHTLESS, FAR)
    certified = limit_nonassociated(published_scene(WEIGHTLESS))
    assert plateau(rows) == (U_CRIT, 2 * U_CRIT)
    assert (certified.lower or np.inf) <= rows[0]["λ"] <= (certified.upper or 0.0)
