"""Loaded too fast, a wall bears too much: by how much, against theory."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from dem import limit_nonassociated
from dem.rigid_system import rigid_system
from runningbond.compare.published import published_scene
from runningbond.dynamics import Criteria, Run, State, drive, load_steps, settle
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.dynamics.load_stepping import LOADING
from runningbond.studies.stability.literature import KnownWall, rounded_wall, sliding_block, toppling_block
from runningbond.studies.stability.loading_rate import BRACKET, bracket, excess, experiment, pushed, ramped


def test_inertia_of_blocks_in_their_motion() -> None:
    """M / F: 1/g of a block that slides; of one that topples, (b² + h²)/3 over (h/2)² g."""
    assert sliding_block().inertia == pytest.approx(1 / 9.81, rel=1e-12)
    b, h = 0.12, 0.24
    assert toppling_block().inertia == pytest.approx((b**2 + h**2) / 3 / (h / 2) ** 2 / 9.81, rel=1e-9)


@pytest.mark.parametrize("wall", [sliding_block(), toppling_block()], ids=lambda wall: str(wall.name))
def test_limit_analysis_certifies_the_exact_load_of_blocks(wall: KnownWall) -> None:
    assert limit_nonassociated(wall.scene).multiplier == pytest.approx(wall.multiplier, rel=1e-9)


@pytest.mark.parametrize("local", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("wall", [sliding_block(), toppling_block()], ids=lambda wall: str(wall.name))
def test_a_ramp_overshoots_by_its_rate_to_two_thirds(wall: KnownWall, local: float) -> None:
    """λ − λ_c = (6 u r² (M / F) / (1 − α))^{1/3}, whatever the local damping."""
    found = ramped(wall, (1.0, 0.3, 0.1), local)
    assert found.multiplier - wall.multiplier == pytest.approx(excess(wall, found.rate, local), rel=5e-3)
    assert found.order == pytest.approx(2 / 3, rel=2e-3)
    assert found.at_no_speed[0] == pytest.approx(wall.multiplier, rel=1e-3)


def test_ramps_of_masonry_come_down_to_the_certified_load() -> None:
    """W1 with rounded corners falls at one load: never below it, and at no speed within three standard errors."""
    found = ramped(rounded_wall("wall-w1"), (0.464, 0.215, 0.1, 0.0464, 0.0215))
    assert (found.multiplier > found.wall.multiplier).all()
    assert (np.diff(found.multiplier) < 0).all()
    limit, error = found.at_no_speed
    assert abs(limit - found.wall.multiplier) < 3 * error < 0.05 * found.wall.multiplier


@pytest.mark.parametrize("wall", [sliding_block(), toppling_block()], ids=lambda wall: str(wall.name))
def test_pushed_slowly_a_block_shows_its_exact_load(wall: KnownWall) -> None:
    found = pushed(wall, (2000, 16_000, 256_000))
    assert found.multiplier[0] > 1.5 * wall.multiplier
    assert found.multiplier[-1] == pytest.approx(wall.multiplier, rel=1e-6)


def test_pushed_slowly_walls_peak_at_what_is_certified() -> None:
    """W1: rounded, within 1 % of one number; sharp, inside the interval of certified loads."""
    assert pushed(rounded_wall("wall-w1"), (512_000, 1_024_000)).multiplier == pytest.approx(0.58558, rel=0.01)
    scene = published_scene("wall-w1")
    certified = limit_nonassociated(scene)
    run = Run(rigid_system(scene))
    rest = State.at_rest(run.system)
    assert settle(run, rest, 0.0, Criteria(collapse=0.01)) == "stable"
    assert certified.lower is not None
    assert certified.upper is not None
    assert certified.lower <= drive(run, rest, 0.009, 1_280_000).peak <= certified.upper


@pytest.mark.parametrize("loading", [0, 1, LOADING])
def test_load_steps_do_not_mind_how_fast_the_load_comes_where_it_is_unique(loading: float) -> None:
    """Not even where it comes at once: the load that is known lies in the bracket."""
    wall = rounded_wall("wall-w1")
    lower, upper = bracket(wall.system, wall.far, loading)
    assert lower <= wall.multiplier <= upper


def test_a_slender_dry_wall_bears_another_load_in_haste() -> None:
    """Panel-12, loaded four times as fast: more than 5 % more."""
    scene = published_scene("panel-12")
    system, far = rigid_system(scene), U_CRIT * scene.block_sizes
    hasty, slow = bracket(system, far, LOADING / 4), bracket(system, far)
    assert hasty[0] > 1.05 * slow[1]


@pytest.mark.long
@pytest.mark.parametrize("first_step", [0.8 * FIRST_STEP, FIRST_STEP, 1.4 * FIRST_STEP])
def test_a_slender_dry_wall_loaded_slower_still_bears_one_load(first_step: float) -> None:
    """Panel-12 at a quarter of the suite's speed, in any load steps: 0.077 to 2 %."""
    scene = published_scene("panel-12")
    run = Run(rigid_system(scene))
    first, criteria = first_step / run.system.measure(run.system.live), Criteria(U_CRIT * scene.block_sizes)
    found = load_steps(run, first, BRACKET, criteria, loading=4 * LOADING)
    assert found.lower == pytest.approx(0.077, rel=0.02)


@pytest.mark.long
def test_every_edge_lies_where_theory_has_it() -> None:
    found = experiment()
    assert not [edge for edge in found.edges if edge.agrees is False]
    found.draw(Figure(layout="constrained"))
