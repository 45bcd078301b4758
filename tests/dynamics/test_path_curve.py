"""What curves of drives and of settlements say, on curves with known growth."""

from typing import Any

import numpy as np
import pytest

from runningbond.dynamics.path_curve import formed, goes_both_ways, growth_left, late_growth, other_way, shedding
from runningbond.results.outcome import number
from runningbond.scene import Array

X = np.linspace(0.0, 1.0, 401)


@pytest.mark.parametrize(
    ("force", "expected"),
    [([1.0, 2.0, 3.0], False), ([1.0, 3.0, 2.0], True), ([2.0, 3.0, 3.001], True), ([0.0, 0.0, 0.0], True)],
)
def test_mechanism_has_formed_if_force_no_longer_grows(force: list[float], expected: bool) -> None:
    x: Array = np.array([0.0, 0.5, 1.0])
    assert (growth_left(np.column_stack([x, force])) <= 0.01 * max(force)) == expected


@pytest.mark.parametrize(
    ("force", "left"),
    [
        (3.0 * X, 3.0),
        (1.0 - 0.001 / (X + 0.001), 0.00111),
        (np.minimum(X, 0.85), 0.0),  # a plateau that has just begun
        (np.minimum(X, 0.85) + 1e-12 * X, 1e-12),
        (np.minimum(X, 0.5) + 1e-3 * np.sin(1e4 * X), 0.0),
        (X * (1.5 - X), 0.0),
        (np.interp(X, [0, 0.94, 1], [0, 1, 0.9]), 0.0),  # a peak that is just passed
        (np.interp(X, [0, 0.9, 0.96, 1], [0, 0.5, 1, 0.8]), 0.0),  # and the last part still rises on average
        (np.where(X < 0.3, 4.0 * X, 0.5 + X), 1.0),  # a peak, a loss, and as stiff as before
        (np.where(X < 0.3, 4.0 * X, 0.1 + X), 0.91),  # below the peak: 1.19 on the way, 1.1 at its end, then 2.1
    ],
    ids=["line", "hyperbola", "flat", "nearly flat", "noisy", "peak", *["late peak"] * 2, *["hardens again"] * 2],
)
def test_growth_beyond_a_path_follows_its_end(force: Array, left: float) -> None:
    """On a path twice as long; a line doubles, c / x has a little more than c / x left; a path may go to and fro."""
    curve = np.column_stack([X, force])
    assert growth_left(curve) == pytest.approx(left, rel=0.01, abs=1e-12)
    loop = np.concatenate([curve[:200], curve[200::-1] * (1, -1) - (0, 1), curve])
    assert growth_left(loop) == pytest.approx(growth_left(curve), rel=1e-9)


@pytest.mark.parametrize(("errors", "grows"), [(2.5, False), (3.5, True)])
def test_slope_within_three_standard_errors_is_none(errors: float, grows: bool) -> None:
    """40 forces that alternate by ±1e-3 about a line: the standard error of its slope is 1e-3 √(12 / 40) per part."""
    share = np.linspace(0.0, 1.0, 40)
    scatter = 1e-3 * np.tile([1.0, -1.0, -1.0, 1.0], 10)
    force = 1 + errors * 1e-3 * np.sqrt(12 / 40) * share + scatter
    curve = np.column_stack([np.append(0.0, 0.9 + 0.1 * share), np.append(0.0, force)])
    assert (growth_left(curve) > 0) == grows


@pytest.mark.parametrize("again", [1.0, np.nextafter(1.0, 2.0), 1 + 1e-12])
def test_repeated_amplitude_does_not_change_the_growth_left(again: float) -> None:
    """The wall is pushed back to the same place, except for rounding, and has lost half its strength."""
    cycle = np.concatenate([X, X[-2::-1], X[1:-1], [again]])
    force = np.concatenate([3 * X, -3 * X[-2::-1], 1.5 * X[1:]])
    assert growth_left(np.column_stack([cycle, force])) == pytest.approx(3.0, rel=1e-6)


@pytest.mark.parametrize(("force", "grown"), [(X, 0.1), (np.minimum(X, 0.8), 0.0), (X * (1.2 - X), 0.0)])
def test_late_growth_is_that_over_the_last_tenth(force: Array, grown: float) -> None:
    """A line grows by a tenth; on a plateau and past its peak a force does not grow."""
    assert late_growth(np.column_stack([X, force])) == pytest.approx(grown, abs=0.003)
    assert late_growth(np.column_stack([X, force])) >= 0


@pytest.mark.parametrize(
    ("late", "tolerance", "still", "expected"),
    [
        *[(0.03, 0.05, 0.0, True), (0.03, 0.01, 0.0, False), (0.03, 0.01, 0.04, True), (0.03, 0.01, 0.021, True)],
        *[(0.03, 0.01, 0.019, False), (0.07, 0.3, 0.0, False), (0.1, 0.3, 0.0, False), (0.0, 0.0, 0.0, True)],
    ],
)
def test_share_that_still_changes_is_of_no_mechanism(
    late: float, tolerance: float, still: float, expected: bool
) -> None:
    """It falls by 1, of which `late` in the last tenth; no tolerance is above half a tenth. Motion may change it.

    At small displacements ten times `late`, the change on a path twice as long, must be within the tolerance.
    """
    share = np.interp(X, [0, 0.9, 1], [1, late, 0])
    back = np.column_stack([np.concatenate([X, X[-2::-1]]), np.concatenate([share[::-1], share[1:]])])
    small = late <= 0.1 * tolerance + still + 1e-12
    for curve in (np.column_stack([X, share]), back):
        assert formed(curve, tolerance, still=still, is_small=False) == expected
        assert formed(curve, tolerance, still=still) == small
        assert formed(curve, 10.1 * late, still=still)


def test_share_that_rises_slowly_after_a_large_fall_takes_up_load() -> None:
    """By half a percent of its change over the last tenth, which no formed mechanism does: its end is a lower bound."""
    share = np.interp(X, [0, 0.3, 0.9, 1], [0.5, -0.02, 0.03, 0.0326])
    assert not formed(np.column_stack([X, share]), 0.01)
    assert shedding(np.column_stack([X, share])) == (False, "takes up load")


@pytest.mark.parametrize("rows", [2, 3, 7])
def test_even_change_in_few_rows_is_of_no_mechanism(rows: int) -> None:
    """Only the last row lies in the last tenth, and a single row does not change."""
    x = np.linspace(0.0, 1.0, rows)
    assert not formed(np.column_stack([x, 1 - x]), 0.01)


@pytest.mark.parametrize(
    ("at", "falls", "change"),
    [
        ((0.5, 0.3, 0.2), True, "sheds load"),
        ((0.5, 0.2, 0.3), False, "takes up load"),  # at the end, whatever it was before
        ((0.5, 0.3, 0.3), True, "sheds load"),  # the whole leg, if the end does not change
        ((0.3, 0.5, 0.5), False, "takes up load"),
        ((-0.3, -0.4, -0.5), True, "takes up load"),  # pulled along the motion, and more and more
        ((-0.5, -0.4, -0.3), False, "sheds load"),
    ],
)
def test_change_of_share_is_that_at_the_end_of_its_last_leg(
    at: tuple[float, float, float], falls: bool, change: str
) -> None:
    """The share at the start of a leg, at nine tenths of it, and at its end; the leg may follow one the other way."""
    share = np.interp(X, [0, 0.9, 1], at)
    assert shedding(np.column_stack([X, share])) == (falls, change)
    back = np.column_stack([np.concatenate([X, X[-2::-1]]), np.concatenate([share[::-1], share[1:]])])
    assert shedding(back) == (falls, change)


@pytest.mark.parametrize(
    ("goals", "least", "note"),
    [([1, -1], -3.0, f"the other way it takes {number(3.0)}"), ([1, 0], -3.0, ""), ([1, -1], 0.0, "")],
)
def test_largest_force_of_the_other_way_is_told_if_there_is_one(goals: list[float], least: float, note: str) -> None:
    """5 one way and 3 the other; unloading against friction, or a push back without resistance, is not told."""
    curve = np.array([[0.0, 0.0], [1.0, 5.0], [goals[1], least]])
    assert other_way(np.array(goals, dtype=float), curve) == note


@pytest.mark.parametrize(
    ("place", "force"),
    [
        ([0, 0.5, 0.6, 1], [0, 1, 0.6, 0.999]),
        ([0, 0.5, 0.6, 1], [0, 1, 0.6, 1.001]),
        ([0, 0.85, 0.9, 1], [0, 1, 0.5, 0.99]),
    ],
)
def test_wall_that_hardens_again_to_about_its_peak_has_formed_no_mechanism(place: Any, force: Any) -> None:
    """It goes on as steeply on a path twice as long, by as much as it has borne or more."""
    assert growth_left(np.column_stack([X, np.interp(X, place, force)])) > 0.99


@pytest.mark.parametrize(
    ("goals", "expected"),
    [
        *[([1.0], False), ([0.0, 1.0], False), ([0.0, -1.0, -2.0], False), ([0.0, 1.0, -1.0], True)],
        *[([1.0, 0.0], False), ([-2.0, 0.1, -4.0], False), ([0.0], False), ([], False)],
        *[([1.0, -0.04], False), ([1.0, -0.06], True)],  # a return may go beyond its start by a twentieth
    ],
)
def test_one_sided_drive_path_does_not_go_both_ways(goals: list[float], expected: bool) -> None:
    """One-sided cycles were once taken for two-sided ones, because friction resists unloading too."""
    assert goes_both_ways(np.array(goals)) == expected
