"""Peaks of forces whose means over windows are known."""

from dataclasses import replace

import numpy as np
import pytest

from dem.rigid_system import rigid_system
from runningbond.dynamics import State
from runningbond.dynamics.peaks import Peaks
from runningbond.scene import Array
from tests.dynamics.test_led import block, under_beam


@pytest.mark.parametrize("steps", [200.0, np.nextafter(200.0, 0.0), np.nextafter(200.0, np.inf)])
def test_number_of_windows_is_robust_to_rounding_of_time_step(steps: float) -> None:
    """The step of the joint above varies with the processor; two windows per row would miss 0.2 % of its strength."""
    state = State.at_rest(rigid_system(under_beam("free", {"displacement": [1e-3, 0]})))
    assert Peaks(state, steps).windows == 4


def seen_by_peaks(force: Array, inertia: Array | None = None, *, row: int = 200, most: float = np.inf) -> Peaks:
    """Peaks of mean forces in the windows of rows of so many steps; states have the numbers of windows, from 1."""
    state = State.at_rest(rigid_system(block()))
    peaks = Peaks(state, row, most)
    inertia = np.zeros(len(force)) if inertia is None else inertia
    for k, (one, other) in enumerate(zip(force.tolist(), inertia.tolist(), strict=True)):
        at = 1 + k // peaks.windows
        peaks.see(one, other, row // peaks.windows, replace(state.copy(), steps=k + 1), at)
    return peaks


@pytest.mark.parametrize(
    ("slope", "shorter", "resolved"),
    [(0.0032, False, True), (0.0035, True, True), (0.0065, True, True), (0.0075, True, False)],
)
def test_peak_of_growing_force_and_what_it_misses_add_up_to_the_force_at_the_end(
    slope: float, shorter: bool, resolved: bool
) -> None:
    """1 at the end after growing by `slope` a row, of which means over whole rows show 3/4 more than half rows do.

    The median of three windows is 1.5 windows behind. Half as long windows must add no more than 0.25 %.
    """
    row = (np.arange(40) + 0.5) / 4
    peak, between, unseen, enough = seen_by_peaks(1 + slope * (row - 10)).resolved()
    assert (between, enough) == (shorter, resolved)
    assert peak.force == pytest.approx(1 - slope * (0.75 if shorter else 1.5), rel=1e-12)
    assert peak.force + unseen == pytest.approx(1.0, rel=1e-12)


def test_peak_is_the_median_of_three_windows_with_the_state_of_the_middle_one() -> None:
    """Half rows with 7, 9 and 8 follow each other; single ones with 20 fluctuate. Rows have 8, 4.5 and 1."""
    force, inertia = np.ones(20), np.zeros(20)
    force[12:15], inertia[12:15] = (7.0, 9.0, 8.0), (1.0, -3.0, 2.0)
    force[[4, 18]] = 20.0
    peaks = seen_by_peaks(np.repeat(force, 2), np.repeat(inertia, 2))
    peak, between, _, resolved = peaks.resolved()
    assert (between, resolved, peaks.longest.force) == (True, False, 4.5)
    assert (peak.force, peak.state.steps, peak.row, peak.inertia) == (8.0, 28, 8, 3.0)


def test_windows_in_which_a_force_fluctuates_do_not_raise_its_peak() -> None:
    """Two rows of 3 whose outer halves are 6: no three half rows in succession have a median above 0."""
    force = np.concatenate([np.zeros(4), [6.0, 0.0, 0.0, 6.0], np.zeros(4)])
    rows = np.concatenate([force, [3.0, 3.0], np.zeros(4)])
    peak, between, unseen, resolved = seen_by_peaks(rows, row=100).resolved()
    assert (peak.force, between, unseen, resolved) == (3.0, False, 0.0, True)


@pytest.mark.parametrize(("row", "resolved"), [(20, True), (98, True), (100, False)])
def test_windows_of_fewer_than_fifty_steps_are_whole_rows(row: int, resolved: bool) -> None:
    """Half rows show more of a force that doubles from one to the next, if they are long enough to be counted."""
    peaks = seen_by_peaks(np.array([2.0**k for k in range(12)]), row=row)
    assert peaks.longest.force == pytest.approx(1.5 * 2**8)  # the last row but one
    assert peaks.resolved()[1:] == (False, 0.0 if resolved else pytest.approx(2 * (2**10 - 1.5 * 2**8)), resolved)


def test_number_of_windows_may_be_limited() -> None:
    assert seen_by_peaks(np.ones(4), row=2000).windows == 32
    assert seen_by_peaks(np.ones(4), row=2000, most=4).windows == 4


def test_energy_that_a_crack_sets_free_in_one_window_is_not_taken_from_the_drive() -> None:
    """Motion takes 2 in each row, and 500 in the one after the largest force, as a stone splits."""
    state = State.at_rest(rigid_system(block()))
    peaks = Peaks(state, 200, 1)
    for k, (force, spent) in enumerate([(7.0, 2.0), (8.0, 2.0), (9.0, 500.0), (1.0, 2.0)]):
        for _ in range(peaks.windows):
            peaks.see(force, 0.0, 200 // peaks.windows, state, k + 1, spent=spent)
    assert (peaks.longest.force, peaks.longest.spent) == (8.0, 2.0)
