"""Overestimated collapse loads under fast loading, against theory."""

import numpy as np
import pytest

from dem.dynamic import quasi_static_run
from runningbond.compare.published import published_scene
from runningbond.dynamics import Criteria, State, load_steps, settle
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.dynamics.load_stepping import LOADING
from runningbond.dynamics.run import LOCAL
from runningbond.limit import limit_nonassociated
from runningbond.scene import Array
from runningbond.studies.pushover import drive
from runningbond.studies.stability.loading_rate import BRACKET, at_no_speed, excess, order, push_row, ramp_row, step_row
from runningbond.studies.walls import SLIDING, TOPPLING, W1, known_wall


def ramped(wall: str, rates: tuple[float, ...], local: float = LOCAL) -> tuple[Array, Array]:
    """Loading rates, and the λ at which collapse of the wall is detected."""
    return np.array(rates), np.array([ramp_row(wall, rate, local)["λ"] for rate in rates])


def test_inertia_of_blocks_in_their_motion() -> None:
    """M / F: 1/g for a sliding block; for a toppling one, (b² + h²)/3 over (h/2)² g."""
    assert known_wall(SLIDING).inertia == pytest.approx(1 / 9.81, rel=1e-12)
    b, h = 0.12, 0.24
    assert known_wall(TOPPLING).inertia == pytest.approx((b**2 + h**2) / 3 / (h / 2) ** 2 / 9.81, rel=1e-9)


@pytest.mark.parametrize("wall", [SLIDING, TOPPLING])
def test_limit_analysis_certifies_the_exact_load_of_blocks(wall: str) -> None:
    known = known_wall(wall)
    assert limit_nonassociated(known.scene, starts=4).multiplier == pytest.approx(known.multiplier, rel=1e-9)


@pytest.mark.parametrize("local", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("wall", [SLIDING, TOPPLING])
def test_ramp_overshoots_with_its_rate_to_the_power_two_thirds(wall: str, local: float) -> None:
    """λ − λ_c = (6 u r² (M / F) / (1 − α))^{1/3}, whatever the local damping."""
    rate, multiplier = ramped(wall, (1.0, 0.3, 0.1), local)
    known = known_wall(wall).multiplier
    assert multiplier - known == pytest.approx([excess(wall, r, local) for r in rate], rel=5e-3)
    assert order(wall, rate, multiplier) == pytest.approx(2 / 3, rel=2e-3)
    assert at_no_speed(rate, multiplier)[0] == pytest.approx(known, rel=1e-3)


@pytest.mark.long
def test_ramps_on_a_wall_converge_to_the_certified_load() -> None:
    """W1 with rounded corners: above its unique load; extrapolated to zero rate, within three standard errors."""
    rate, multiplier = ramped(W1, (0.464, 0.215, 0.1, 0.0464, 0.0215))
    known = known_wall(W1).multiplier
    assert (multiplier > known).all()
    assert (np.diff(multiplier) < 0).all()
    limit, error = at_no_speed(rate, multiplier)
    assert abs(limit - known) < 3 * error < 0.05 * known


@pytest.mark.parametrize("wall", [SLIDING, TOPPLING])
def test_slowly_pushed_block_has_its_exact_load(wall: str) -> None:
    known = known_wall(wall).multiplier
    assert push_row(wall, 2000)["λ"] > 1.5 * known
    assert push_row(wall, 256_000)["λ"] == pytest.approx(known, rel=1e-6)


def test_slowly_pushed_wall_peaks_at_a_certified_load() -> None:
    """W1: rounded, within 1 % of its unique load; sharp, inside the certified interval."""
    for steps in (512_000, 1_024_000):
        assert push_row(W1, steps)["λ"] == pytest.approx(0.58558, rel=0.01)
    scene = published_scene("wall-w1")
    certified = limit_nonassociated(scene, starts=4)
    run = quasi_static_run(scene)
    rest = State.at_rest(run.system)
    assert settle(run, rest, 0.0, Criteria(collapse=0.01)) == "stable"
    assert certified.lower is not None
    assert certified.upper is not None
    assert certified.lower <= drive(run, rest, 0.009, 1_280_000).peak <= certified.upper


@pytest.mark.parametrize("loading", [0, 1, LOADING])
def test_load_steps_bracket_a_unique_load_at_any_loading_rate(loading: float) -> None:
    """Even if the load is applied at once."""
    row = step_row(W1, loading)
    assert row["λ lower"] <= known_wall(W1).multiplier <= row["λ upper"]


@pytest.mark.long
def test_slender_dry_wall_has_a_higher_load_when_loaded_fast() -> None:
    """Panel-12, loaded four times as fast: more than 5 % higher."""
    hasty, slow = step_row("panel-12", LOADING / 4), step_row("panel-12", LOADING)
    assert hasty["λ lower"] > 1.05 * slow["λ upper"]


@pytest.mark.long
@pytest.mark.parametrize("first_step", [0.8 * FIRST_STEP, FIRST_STEP, 1.4 * FIRST_STEP])
def test_slender_dry_wall_loaded_slowly_has_one_load(first_step: float) -> None:
    """Panel-12 at a quarter of the default rate, with any load steps: 0.077 to 2 %."""
    scene = published_scene("panel-12")
    run = quasi_static_run(scene)
    first, criteria = first_step / run.system.measure(run.system.live), Criteria(U_CRIT * scene.block_sizes)
    result = load_steps(run, first, BRACKET, criteria, loading=4 * LOADING)
    assert result.lower == pytest.approx(0.077, rel=0.02)
