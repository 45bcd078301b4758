"""Verdict criteria that are too tight or too loose, for walls with known load."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

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
    STUDY,
    SWEEPS,
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
    """Searches with different values of one criterion, as rows of the study."""
    case = {"wall": wall, "criterion": criterion}
    return {PART: [case | {"value": value} | search(wall, criterion, value) for value in values]}


@pytest.mark.parametrize("wall", [SLIDING, *at_length(TOPPLING, W1)])
@pytest.mark.parametrize("criterion", [REST, FAR, INTERVAL])
def test_default_criteria_are_on_a_plateau(wall: str, criterion: str) -> None:
    """Half and twice each default find the same λ, which is the known one."""
    default = DEFAULT[criterion]
    rows = sweep(swept(wall, criterion, (default / 2, default, 2 * default)), wall, criterion)
    assert plateau(rows) == (default / 2, 2 * default)
    assert rows[1]["λ"] == pytest.approx(known_wall(wall).multiplier, rel=WIDTH)


@pytest.mark.parametrize("wall", [SLIDING, TOPPLING, W1])
def test_loose_rest_threshold_overestimates_the_load_by_the_exact_amount(wall: str) -> None:
    """λ_c + r / w: false stability, 5 to 10 % above the load with r = 0.03."""
    rest = DEFAULT[REST]
    rows = sweep(swept(wall, REST, (rest, 0.01, 0.03)), wall, REST)
    assert [row["λ"] for row in rows[1:]] == pytest.approx([believed(wall, r) for r in (0.01, 0.03)], rel=WIDTH)
    assert rows[2]["λ"] > 1.04 * known_wall(wall).multiplier
    assert plateau(rows) == (rest, rest)


def test_rest_threshold_below_rounding_is_never_met() -> None:
    assert search(SLIDING, REST, 1e-16)["answer"] == "undecided"


def test_collapse_displacement_too_small_takes_settlement_for_collapse() -> None:
    assert search(W1, FAR, 1e-9)["answer"] == "infeasible"


@pytest.mark.long
@pytest.mark.parametrize("farthest", [1e-6, 1e-3])
def test_small_collapse_displacement_does_not_take_slip_for_collapse(farthest: float) -> None:
    """W2 slips by over a millionth of a block between rests, and collapses once it moves as far again."""
    assert search(W2, FAR, farthest)["λ"] == pytest.approx(known_wall(W2).multiplier, rel=WIDTH)


@pytest.mark.long
@pytest.mark.parametrize("times", [1 / 4, 4])
def test_weightless_wall_has_the_same_load_at_any_loading_rate(times: float) -> None:
    """A quarter of the time for each load step, and four times as long, find the same λ to 1 %."""
    assert weightless_at(times) == pytest.approx(weightless_at(1), rel=0.01)


@cache
def weightless_at(times: float) -> float | None:
    """λ of the weightless wall with a multiple of the default time for each load step."""
    scene = published_scene(WEIGHTLESS)
    run = Run(rigid_system(scene))
    first, criteria = FIRST_STEP / run.system.measure(run.system.live), Criteria(U_CRIT * scene.block_sizes)
    return load_steps(run, first, WIDTH, criteria, loading=times * LOADING_WEIGHTLESS).lower


@pytest.mark.long
def test_default_collapse_displacement_suffices_without_weight() -> None:
    """Twice the displacement finds the same λ, inside the certified interval."""
    rows = sweep(swept(WEIGHTLESS, FAR, (U_CRIT, 2 * U_CRIT)), WEIGHTLESS, FAR)
    certified = limit_nonassociated(published_scene(WEIGHTLESS))
    assert plateau(rows) == (U_CRIT, 2 * U_CRIT)
    assert (certified.lower or np.inf) <= rows[0]["λ"] <= (certified.upper or 0.0)


def test_chart_shows_every_search_without_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the smallest values of a criterion; infeasible walls used to lie outside the axes."""
    none = SimpleNamespace(lower=None, upper=None)
    monkeypatch.setattr("runningbond.studies.stability.verdict.limit_nonassociated", lambda scene: none)
    rows = []
    for (wall, criterion), values in SWEEPS.items():
        unit = 1.0 if wall == WEIGHTLESS else known_wall(wall).multiplier
        found = {"answer": "collapse", "λ": unit, "λ / λ known": 1.0}
        for value in values:
            answer = {"answer": "infeasible"} if value == min(values) else found
            rows.append({"wall": wall, "criterion": criterion, "value": value} | answer)
    figure = Figure()
    STUDY.charts[0].draw(figure, {PART: rows})
    places = []
    for axes in figure.axes:
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        marks = [text.xy for text in axes.texts if isinstance(text, Annotation) and text.get_text() == "×"]
        assert all(left < x < right and low < y < high for x, y in marks)
        places += [(axes.get_title(), *mark) for mark in marks]
    assert len(set(places)) == len(places) == 6
