"""When a wall is calm, sways, slides away or comes to rest: rows that are known, of a block 0.5 m wide and 2 m high."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from runningbond.dynamics import Run
from runningbond.response import follow
from runningbond.response.follow import GATHERS, PART, RISE, SPENT, STILL, _is_past_the_ground, _Log, _Row
from runningbond.response.ground import Ground
from runningbond.scene import ANCHOR, NO_TIES, Array, History, SceneError, Ties
from runningbond.scene.history import pulse

from ..walls import panel
from .housner import GRAVITY
from .walls import block, resting, shaken, still

WIDTH = 0.5
CALM = RISE * GRAVITY * 1800.0 * 0.12 * WIDTH * 2.0 * WIDTH
"""Energy [J] that lifts the block by so much of its width, over which it falls."""


@cache
def _log() -> Any:
    rest = resting(block(WIDTH / 2, 1.0, still()))
    run = Run(replace(rest.system, live=0.0 * rest.system.live), local=0.0)
    return _Log(rest, Ground(run, rest.history, 1.0, rest.state.time), rest.state.copy(), rest.top)


def log(kinetic: Sequence[float] | Array = (0.0,) * 40, way: Any = 0.0, works: tuple[float, float] = (0.0, 0.0)) -> Any:
    """Rows a tenth of a second apart with their kinetic energies [J] and ways of the top [m].

    And with the works of joints and of viscosity at the end [J], which grow evenly.
    """
    ways = np.broadcast_to(way, len(kinetic))
    rows = []
    for k, (energy, x) in enumerate(zip(kinetic, ways.tolist(), strict=True)):
        spent, damped = (work * k / (len(kinetic) - 1) for work in works)
        places = np.array([[x, 0.0], [x, 0.0]])
        ledger = np.array([energy + spent + damped, 0.0, energy, 0.0, spent, damped])
        rows.append(_Row(0.1 * k, np.zeros(2), places, x / 2.0, np.zeros(2), ledger, 0))
    found = _log()
    found.rows = rows
    return found


def test_a_wall_is_calm_whose_energy_would_hardly_lift_it() -> None:
    """By a part of the width of a slender block; what there was before the time that is asked about is no matter."""
    assert _log().calm == pytest.approx(CALM)
    assert log([0.99 * CALM] * 40).is_calm(0.0)
    assert not log([0.0] * 30 + [1.01 * CALM] + [0.0] * 9).is_calm(0.0)
    assert log([1.01 * CALM] + [0.0] * 39).is_calm(0.1)
    assert not log([1.01 * CALM] + [0.0] * 39).is_calm(0.0)


def test_a_wall_that_gathers_energy_or_moves_on_is_not_calm() -> None:
    """However little it is in motion; but for what is next to nothing."""
    growing = np.linspace(0.1, 0.9, 40) * CALM
    assert not log(growing).is_calm(0.0)
    assert log(growing[::-1]).is_calm(0.0)
    assert log(growing * GATHERS).is_calm(0.0)
    far = STILL * WIDTH
    assert log(way=np.linspace(0.0, 0.99 * far, 40)).is_calm(0.0)
    assert not log(way=np.linspace(0.0, 1.01 * far, 40)).is_calm(0.0)
    assert not log(way=0.99 * far).is_elsewhere
    assert log(way=1.01 * far).is_elsewhere


def test_a_wall_sways_that_stays_within_where_it_was_and_loses_energy_to_viscosity() -> None:
    """A damped oscillation; not one that grows, or grows to one side, or whose joints take a part of what is lost."""
    time = np.arange(40.0)
    damped, energy = 0.05 * 0.97**time * np.cos(time), [CALM] * 40
    assert log(energy, damped, (0.5 * SPENT, 1.0)).swaying(0.0) == pytest.approx(
        [damped[20:].min() / 2, damped[20:].max() / 2]
    )
    assert log(energy, damped, (2.0 * SPENT, 1.0)).swaying(0.0) is None
    assert log(energy, damped[::-1], (0.0, 1.0)).swaying(0.0) is None
    for sense in (1.0, -1.0):
        leaning = np.where(time < 20, 1.0, 0.5) * np.cos(time) + sense * np.where(time < 20, 0.0, 0.8)
        assert log(energy, leaning, (0.0, 1.0)).swaying(0.0) is None


def test_a_wall_slides_away_that_gathers_energy_in_each_quarter() -> None:
    """As under a force that stays on, v ~ t: not one that goes on as it is, rocks, or hardly moves."""
    sliding = CALM * np.linspace(1.0, 2.0, 40) ** 2
    assert log(sliding).runs_away(0.0)
    assert log(np.append([1e3 * CALM] * 10, sliding)).runs_away(1.0)
    assert not log([CALM] * 40).runs_away(0.0)
    assert not log(sliding[::-1]).runs_away(0.0)
    assert not log(CALM * np.repeat([1.0, 2.0, 1.5, 3.0], 10)).runs_away(0.0)
    assert not log(0.1 * GATHERS * sliding).runs_away(0.0)


def test_a_motion_dies_away_whose_later_half_has_less_energy() -> None:
    decay = CALM * np.exp(-0.01 * np.arange(40.0))
    assert log(decay).dies_away(0.0)
    assert not log(decay[::-1]).dies_away(0.0)


@pytest.mark.parametrize(("missed", "lost"), [(0.9, False), (1.1, True), (-1.1, True), (math.nan, True)])
def test_a_ledger_that_misses_more_than_works_have_gone_through_is_lost(missed: float, lost: bool) -> None:
    found = log()
    found._gone = 50.0
    found.rows[-1].energy[2] = missed * (50.0 + CALM)
    assert found.is_lost == lost
    found._gone = 0.0


def looked(*motions: Sequence[float], external: Sequence[float] = (), ties: Ties = NO_TIES) -> Any:
    """A log of states in which the block has moved by so much since it was at rest [m, m, rad], and works [J]."""
    rest = resting(replace(block(WIDTH / 2, 1.0, still()), ties=ties))
    ground = Ground(Run(rest.system, local=0.0), rest.history, 1.0, rest.state.time)
    found, state = _Log(rest, ground, rest.state.copy(), rest.top), rest.state.copy()
    for moved, work in zip(motions, external or [0.0] * len(motions), strict=True):
        state.motion[:3] = rest.state.motion[:3] + moved
        state.external = rest.state.external + work
        found.look(state)
    return found


def test_a_block_has_fallen_that_is_lower_by_half_of_its_size_or_turned_by_60_degrees() -> None:
    """Either way round; one that is lifted, or was pushed aside, has not."""
    size = float(block(WIDTH / 2, 1.0, still()).block_sizes[0])
    turned = [math.radians(angle) for angle in (59.0, -59.0, 61.0, -61.0)]
    cases = [(0.0, -0.49 * size, 0.0), (0.0, 3.0 * size, 0.0), (3.0 * size, 0.0, 0.0), (0.0, -0.51 * size, 0.0)]
    assert [looked(moved).first for moved in cases] == [[], [], [], [0]]
    assert [looked((0.0, 0.0, angle)).first for angle in turned] == [[], [], [0], [0]]
    again = looked(cases[3], cases[0])  # what has fallen stays so
    assert [row.fallen for row in again.rows] == [0, 1, 1]


def test_the_shape_of_a_motion_is_the_last_at_which_no_corner_has_gone_far() -> None:
    """A tenth of the wall's size; here of a block that is pushed on, and comes back in the end."""
    far = 0.1 * block(WIDTH / 2, 1.0, still()).size
    found = looked((0.5 * far, 0.0, 0.0), (0.99 * far, 0.0, 0.0), (1.01 * far, 0.0, 0.0))
    assert found.shape[0] == pytest.approx([0.99 * far, 0.0, 0.0])


def test_works_have_gone_as_far_as_they_went_to_and_fro() -> None:
    """5 J, back to 2 J, where they stay, and to 6 J: 12 J; two rows that are alike add none."""
    none = (0.0, 0.0, 0.0)
    assert looked(*[none] * 4, external=[5.0, 2.0, 2.0, 6.0])._gone == pytest.approx(12.0, rel=1e-6)


def test_a_tie_that_is_drawn_stores_half_of_its_force_times_its_way() -> None:
    """E A / l = 2e5 N/m of a rod to the left, as the block is lifted off its joint and pushed to the right."""
    ends = np.array([[[0.0, 2.0], [-1.0, 2.0]]])
    rod = Ties(np.array([[0, ANCHOR]]), ends, np.array([1e-4]), np.array([2e9]), np.array([1e4]), np.array([0.0]))
    with_it, without = (looked((2e-3, 1e-2, 0.0), ties=ties).rows[-1].energy for ties in (rod, NO_TIES))
    drawn = math.hypot(1.002, 0.01) - 1.0
    assert with_it - without == pytest.approx([0, 0, 0, 0.5 * 2e5 * drawn**2, 0, 0], rel=1e-3, abs=1e-6)


def test_points_are_above_the_ground_wherever_that_is() -> None:
    """Of a wall that stands 5 m up, a hair below its base is none of which a drift is a share."""
    high = panel(
        wall={"outlines": [[[0, 5], [0.5, 5], [0.5, 7], [0, 7]]], "thickness": 0.12},
        joint={"friction": 2.0, "normal_stiffness": 1e9, "shear_stiffness": 1e9},
        load__live=None,
        load__history={"pulse": {"kind": "half-sine", "amplitude": 0.1, "period": 0.01}, "quantity": "acceleration"},
    )
    rest = resting(high)
    with pytest.raises(SceneError, match="points = .*: must be a list of points .*, higher than 5"):
        follow(rest, 1.0, points=np.array([[0.2, 4.9]]))
    assert follow(rest, 1.0, points=np.array([[0.2, 5.1]]), rows=50).verdict == "stands"


@pytest.mark.parametrize("falls_first", [True, False])
def test_a_ledger_that_is_lost_after_a_fall_alters_nothing_of_it(
    falls_first: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Debris is followed no farther; what is lost before is no answer."""
    lost = property(lambda log: log.rows[-2:][0].fallen > 0 if falls_first else len(log.rows) > 2)
    monkeypatch.setattr(_Log, "is_lost", lost)
    rest = resting(block(WIDTH / 2, 1.0, shaken("half-sine", 6.0, 1.0), stiffness=1e8))
    response = follow(rest, 1.0, rows=50, after=60.0)
    assert response.verdict == ("collapse" if falls_first else "undecided")
    assert response.time[-1] < 3.0
    assert response.message.startswith("falls: block 0" if falls_first else "more energy is missing than was supplied")


def test_a_record_is_followed_to_its_end_however_quiet_it_begins() -> None:
    """Nothing for two seconds, more than the block is to be calm for, and then a pulse that brings it down."""
    time, values = pulse("half-sine", 6.0, 1.0)
    late = History(np.append(0.0, 2.0 + time[::10]), np.vstack([[0.0, 0.0], values[::10]]), interval=1 / 200)
    rest = resting(block(WIDTH / 2, 1.0, late, stiffness=1e8))
    assert rest.swing == pytest.approx(2 * math.sqrt(2.0 / GRAVITY))
    response = follow(rest, 1.0, rows=50)
    assert rest.swing < 2.0 < response.time[-1]
    assert response.verdict == "collapse"
    step = Run(rest.system, local=0.0, viscous=rest.viscous, part=PART).dt
    assert response.steps == pytest.approx(response.time[-1] / step, rel=0.01)  # not those until it was at rest
    assert response.scale == 1.0


def test_a_block_is_past_the_ground_on_either_side_of_what_is_modelled() -> None:
    """Ground from −1 m to 10 m; where held blocks are all that there is, nothing is said of ground."""
    ground = [[[-1, -1], [10, -1], [10, 0], [-1, 0]]]
    scene = panel(wall={"outlines": [[[0, 0], [1, 0], [1, 1], [0, 1]]], "ground": ground, "thickness": 0.1})
    held = panel(support__kind="fixed-first-course")
    for way, past in ((5.0, False), (9.6, True), (-1.4, False), (-1.6, True)):
        assert _is_past_the_ground(scene, np.array([[way, 0.0, 0.0]]), 0) == past
        assert not _is_past_the_ground(held, np.full((len(held.blocks), 3), 9.0), 20)


def test_a_short_record_has_as_many_rows_as_a_second() -> None:
    """Fifty in a tenth of a second, and fifty a second after it."""
    rest = resting(block(WIDTH / 2, 1.0, shaken("sine", 0.5, 0.1)))
    time = follow(rest, 1.0, rows=50).time
    assert int((time <= 0.1).sum()) == pytest.approx(50, abs=2)
    assert int(((time > 0.2) & (time <= 0.7)).sum()) == pytest.approx(25, abs=1)
