"""Searches for the critical scale among responses with known verdicts."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from dem.finite_system import finite_system
from runningbond.joints.wall_law import with_impacts
from runningbond.response import Response, critical_scale, follow
from runningbond.response.critical import BEYOND, LARGEST_SCALE, RATIO, START, ScaleSearch
from runningbond.response.response import ResponseVerdict
from runningbond.results import Outcome
from runningbond.scene.history import STANDARD_GRAVITY

from ..walls import panel
from .walls import resting

PEAK = 3.0  # m/s²
SCENE = panel(  # 0.5 m wide and 2 m high, 3 m from the origin
    wall={"outlines": [[[3, 0], [3.5, 0], [3.5, 2], [3, 2]]], "thickness": 0.12},
    joint={"friction": 2.0, "normal_stiffness": 1e9, "shear_stiffness": 1e9},
    load__live=None,
    load__history={"pulse": {"kind": "half-sine", "amplitude": PEAK, "period": 0.5}, "quantity": "acceleration"},
)
UNIT = STANDARD_GRAVITY / PEAK


@cache
def known() -> Response:
    return follow(resting(SCENE), 0.01)


KnownVerdict = Callable[[float], tuple[ResponseVerdict, float]]


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Callable[[KnownVerdict], Outcome]:
    """Outcome of a search among responses whose verdict and missing share of the energy are known functions of λ."""

    def found(told: KnownVerdict, tolerance: float = 0.02) -> Outcome:
        def at(rest: Any, scale: float, **settings: Any) -> Response:
            verdict, missed = told(scale)
            drift = np.array([0.0, -0.1 * scale, 0.02 * scale])
            bare = replace(known(), time=np.arange(3.0), fallen=np.zeros(3, dtype=np.int64), steps=10)
            bare = replace(bare, shape=np.array([[0.2, 0.0, 0.0], [0.0, 0.0, 0.0]]), motion=np.ones((2, 3)))
            return replace(bare, scale=scale, verdict=verdict, unaccounted=missed, drift=drift)

        monkeypatch.setattr(import_module("runningbond.response.critical"), "follow", at)
        return critical_scale(SCENE, "dem-dynamic", finite_system(with_impacts(SCENE)), tolerance)

    return found


def stands_below(edge: float, missed: float = 0.0) -> KnownVerdict:
    return lambda scale: ("stands" if scale < edge else "collapse", missed)


@pytest.mark.parametrize("edge", [0.3, 20.0])
def test_bracket_meets_the_tolerance_without_extra_runs(edge: float, search: Callable[[KnownVerdict], Outcome]) -> None:
    """The tolerance is relative; the multiplier is the middle; each scale has its peak and its last drift."""
    outcome = search(stands_below(edge))
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower < edge <= outcome.upper
    assert 0.01 < (outcome.upper - outcome.lower) / outcome.upper <= 0.02
    assert outcome.multiplier == pytest.approx((outcome.lower + outcome.upper) / 2)
    scales = outcome.curve[:, 1]
    assert outcome.curve[:, 0] == pytest.approx(2.0 * 0.1 * scales)  # of a block of 2 m
    assert outcome.path == pytest.approx(np.column_stack([scales < edge, 0.02 * scales]))
    assert outcome.motion == pytest.approx(
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    )  # the initial shape, scaled to one
    assert outcome.steps is not None
    assert outcome.steps > 10 * len(scales)  # and the steps until the wall was at rest
    assert "it stands again" not in outcome.message


def test_scales_are_tried_from_a_twentieth_of_g(search: Callable[[KnownVerdict], Outcome]) -> None:
    """In steps of a quarter, up to twice the first scale at which the wall falls."""
    scales = search(stands_below(1.0)).curve[:, 1]
    assert scales[0] == pytest.approx(START * UNIT)
    grid = scales[0] * RATIO ** np.arange(40)
    assert scales[scales < 1 / RATIO] == pytest.approx(grid[grid < 1 / RATIO])
    first = grid[grid >= 1.0].min()
    assert scales[scales > first] == pytest.approx(grid[(grid > first) & (grid <= BEYOND * first)])


def test_wall_that_stands_at_all_scales_has_no_upper_bound(search: Callable[[KnownVerdict], Outcome]) -> None:
    """Scales go up to fifty times g."""
    outcome = search(lambda scale: ("stands", 0.0))
    assert (outcome.status, outcome.upper) == ("undecided", None)
    assert outcome.lower == outcome.curve[-1, 1]
    assert LARGEST_SCALE * UNIT < outcome.curve[-1, 1] <= LARGEST_SCALE * UNIT * RATIO
    assert outcome.message.startswith("stands at every scale tried, up to ")
    doubtful = search(lambda scale: ("undecided", 0.0))
    assert (doubtful.lower, doubtful.upper) == (None, None)
    assert "falls at no scale tried" in doubtful.message
    assert "and rests at none" in doubtful.message


def test_wall_that_falls_at_the_first_scale_is_tried_below_it(search: Callable[[KnownVerdict], Outcome]) -> None:
    edge = START * UNIT / 7
    outcome = search(stands_below(edge))
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower < edge <= outcome.upper


@pytest.mark.parametrize("end", ["lower", "upper"])
def test_bracket_fails_if_either_end_has_an_energy_error(end: str, search: Callable[[KnownVerdict], Outcome]) -> None:
    def told(scale: float) -> tuple[ResponseVerdict, float]:
        falls = scale >= 1.0
        return "collapse" if falls else "stands", 0.2 if falls == (end == "upper") else 0.0

    outcome = search(told)
    assert outcome.status == "failed"
    assert "20.0% of the energy supplied is unaccounted for at λ = " in outcome.message


def test_windows_span_the_scales_at_which_a_wall_stands_again() -> None:
    """An undecided scale ends a window; scales below the first collapse form none."""
    verdicts: dict[float, ResponseVerdict] = dict.fromkeys((1.0, 1.1, 1.4, 1.5, 1.6, 1.8, 2.0), "stands")
    verdicts |= {1.2: "collapse", 1.3: "undecided", 1.7: "undecided", 1.9: "collapse"}
    tried = {scale: replace(known(), scale=scale, verdict=verdict) for scale, verdict in verdicts.items()}
    assert ScaleSearch(lambda scale: tried[scale], tried).windows() == [(1.4, 1.6), (1.8, 1.8), (2.0, 2.0)]


def test_no_bisection_next_to_undecided_scales(search: Callable[[KnownVerdict], Outcome]) -> None:
    """It would not locate the onset of collapse. A single undecided scale far below does not matter."""
    outcome = search(lambda scale: ("stands" if scale < 1 else "undecided" if scale < 2 else "collapse", 0.0))
    assert outcome.status == "undecided"
    assert np.diff(np.log(outcome.curve[:, 1])) == pytest.approx(np.log(RATIO))
    unsure = START * UNIT * RATIO**2
    outcome = search(lambda x: ("undecided" if abs(x - unsure) < 1e-9 else "stands" if x < 2 else "collapse", 0.0))
    assert outcome.status == "collapse"
    assert f"at all others but {unsure:.4f}, where it neither rests nor falls, below it" in outcome.message


def test_wall_that_falls_at_every_scale_has_no_lower_bound(search: Callable[[KnownVerdict], Outcome]) -> None:
    outcome = search(lambda scale: ("collapse", 0.0))
    assert (outcome.status, outcome.lower, outcome.upper) == ("undecided", None, outcome.curve[0, 1])
    assert outcome.curve[0, 1] < 1e-9 * LARGEST_SCALE * UNIT
    assert outcome.message.startswith("no scale was found at which the wall comes to rest below one at which it falls")
