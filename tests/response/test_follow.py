"""Criteria for calm, swaying, sliding and rest, on made-up rows of a block 0.5 m wide and 2 m high."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from runningbond.dynamics import Run
from runningbond.response import follow
from runningbond.response.follow import GROWTH_FLOOR, JOINT_SHARE, PART, RISE, STILL, _is_past_the_ground, _Log, _Row
from runningbond.response.ground import Ground
from runningbond.scene import ANCHOR, NO_TIES, Array, History, SceneError, Ties
from runningbond.scene.history import pulse

from ..walls import panel
from .housner import GRAVITY
from .walls import block, resting, shaken, still

WIDTH = 0.5
CALM = RISE * GRAVITY * 1800.0 * 0.12 * WIDTH * 2.0 * WIDTH
"""Energy [J] that lifts the block by `RISE` of its width, across which it overturns."""


@cache
def _log() -> Any:
    rest = resting(block(WIDTH / 2, 1.0, still()))
    run = Run(replace(rest.system, live=0.0 * rest.system.live), local=0.0)
    return _Log(rest, Ground(run, rest.history, 1.0, rest.state.time), rest.state.copy(), rest.top)


def log(kinetic: Sequence[float] | Array = (0.0,) * 40, way: Any = 0.0, works: tuple[float, float] = (0.0, 0.0)) -> Any:
    """Rows 0.1 s apart with given kinetic energies [J] and displacements of the top [m].

    `works` are those of joints and of viscosity at the end [J]; they grow linearly.
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


def test_wall_is_calm_below_the_energy_that_lifts_it() -> None:
    """The limit refers to the width of a slender block; energy before the observed time does not count."""
    assert _log().calm == pytest.approx(CALM)
    assert log([0.99 * CALM] * 40).is_calm(0.0)
    assert not log([0.0] * 30 + [1.01 * CALM] + [0.0] * 9).is_calm(0.0)
    assert log([1.01 * CALM] + [0.0] * 39).is_calm(0.1)
    assert not log([1.01 * CALM] + [0.0] * 39).is_calm(0.0)


def test_wall_with_growing_energy_or_drift_is_not_calm() -> None:
    """However little energy it has, except below `GROWTH_FLOOR`."""
    growing = np.linspace(0.1, 0.9, 40) * CALM
    assert not log(growing).is_calm(0.0)
    assert log(growing[::-1]).is_calm(0.0)
    assert log(growing * GROWTH_FLOOR).is_calm(0.0)
    far = STILL * WIDTH
    assert log(way=np.linspace(0.0, 0.99 * far, 40)).is_calm(0.0)
    assert not log(way=np.linspace(0.0, 1.01 * far, 40)).is_calm(0.0)
    assert not log(way=0.99 * far).is_elsewhere
    assert log(way=1.01 * far).is_elsewhere


def test_wall_sways_within_its_range_and_loses_energy_by_viscosity() -> None:
    """A damped oscillation; not a growing or drifting one, nor one in which joints dissipate a notable share."""
    time = np.arange(40.0)
    damped, energy = 0.05 * 0.97**time * np.cos(time), [CALM] * 40
    assert log(energy, damped, (0.5 * JOINT_SHARE, 1.0)).swaying(0.0) == pytest.approx(
        [damped[20:].min() / 2, damped[20:].max() / 2]
    )
    assert log(energy, damped, (2.0 * JOINT_SHARE, 1.0)).swaying(0.0) is None
    assert log(energy, damped[::-1], (0.0, 1.0)).swaying(0.0) is None
    for sense in (1.0, -1.0):
        leaning = np.where(time < 20, 1.0, 0.5) * np.cos(time) + sense * np.where(time < 20, 0.0, 0.8)
        assert log(energy, leaning, (0.0, 1.0)).swaying(0.0) is None


def test_wall_with_growing_energy_in_each_quarter_slides_away() -> None:
    """As under a constant force, v ~ t; not at constant energy, in rocking or with negligible energy."""
    sliding = CALM * np.linspace(1.0, 2.0, 40) ** 2
    assert log(sliding).runs_away(0.0)
    assert log(np.append([1e3 * CALM] * 10, sliding)).runs_away(1.0)
    assert not log([CALM] * 40).runs_away(0.0)
    assert not log(sliding[::-1]).runs_away(0.0)
    assert not log(CALM * np.repeat([1.0, 2.0, 1.5, 3.0], 10)).runs_away(0.0)
    assert not log(0.1 * GROWTH_FLOOR * sliding).runs_away(0.0)


def test_motion_with_less_energy_in_its_second_half_dies_away() -> None:
    decay = CALM * np.exp(-0.01 * np.arange(40.0))
    assert log(decay).dies_away(0.0)
    assert not log(decay[::-1]).dies_away(0.0)


@pytest.mark.parametrize(("missed", "lost"), [(0.9, False), (1.1, True), (-1.1, True), (math.nan, True)])
def test_ledger_is_lost_if_it_misses_more_than_the_work_done(missed: float, lost: bool) -> None:
    found = log()
    found._gone = 50.0
    found.rows[-1].energy[2] = missed * (50.0 + CALM)
    assert found.is_lost == lost
    found._gone = 0.0


def looked(*motions: Sequence[float], external: Sequence[float] = (), ties: Ties = NO_TIES) -> Any:
    """A log of states, given as motions of the block since rest [m, m, rad] and works of the loads [J]."""
    rest = resting(replace(block(WIDTH / 2, 1.0, still()), ties=ties))
    ground = Ground(Run(rest.system, local=0.0), rest.history, 1.0, rest.state.time)
    found, state = _Log(rest, ground, rest.state.copy(), rest.top), rest.state.copy()
    for moved, work in zip(motions, external or [0.0] * len(motions), strict=True):
        state.motion[:3] = rest.state.motion[:3] + moved
        state.external = rest.state.external + work
        found.look(state)
    return found


def test_block_has_fallen_by_half_its_size_or_60_degrees() -> None:
    """In either sense of rotation; a block that is lifted or pushed aside has not fallen."""
    size = float(block(WIDTH / 2, 1.0, still()).block_sizes[0])
    turned = [math.radians(angle) for angle in (59.0, -59.0, 61.0, -61.0)]
    cases = [(0.0, -0.49 * size, 0.0), (0.0, 3.0 * size, 0.0), (3.0 * size, 0.0, 0.0), (0.0, -0.51 * size, 0.0)]
    assert [looked(moved).first for moved in cases] == [[], [], [], [0]]
    assert [looked((0.0, 0.0, angle)).first for angle in turned] == [[], [], [0], [0]]
    again = looked(cases[3], cases[0])  # a fallen block stays fallen
    assert [row.fallen for row in again.rows] == [0, 1, 1]


def test_kept_shape_is_the_last_within_a_tenth_of_the_wall_size() -> None:
    """The block is pushed to just below and then just beyond a tenth of the wall's size."""
    far = 0.1 * block(WIDTH / 2, 1.0, still()).size
    found = looked((0.5 * far, 0.0, 0.0), (0.99 * far, 0.0, 0.0), (1.01 * far, 0.0, 0.0))
    assert found.shape[0] == pytest.approx([0.99 * far, 0.0, 0.0])


def test_work_done_adds_up_its_changes_of_either_sign() -> None:
    """From 0 to 5 J, back to 2 J, constant, and to 6 J: 12 J."""
    none = (0.0, 0.0, 0.0)
    assert looked(*[none] * 4, external=[5.0, 2.0, 2.0, 6.0])._gone == pytest.approx(12.0, rel=1e-6)


def test_stretched_tie_stores_half_its_force_times_its_elongation() -> None:
    """E A / l = 2e5 N/m for a rod to the left of a block that is lifted off its joint and pushed to the right."""
    ends = np.array([[[0.0, 2.0], [-1.0, 2.0]]])
    rod = Ties(np.array([[0, ANCHOR]]), ends, np.array([1e-4]), np.array([2e9]), np.array([1e4]), np.array([0.0]))
    with_it, without = (looked((2e-3, 1e-2, 0.0), ties=ties).rows[-1].energy for ties in (rod, NO_TIES))
    drawn = math.hypot(1.002, 0.01) - 1.0
    assert with_it - without == pytest.approx([0, 0, 0, 0.5 * 2e5 * drawn**2, 0, 0], rel=1e-3, abs=1e-6)


def test_points_must_lie_above_the_ground_of_the_wall() -> None:
    """For a wall that stands at y = 5 m, drift has no meaning for a point just below its base."""
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


def test_points_on_a_fixed_course_are_refused() -> None:
    """They were once attached to a block above, whose motion they reported."""
    joint = {"friction": 2.0, "normal_stiffness": 1e9, "shear_stiffness": 1e9}
    size = {"wall__length": 0.24, "wall__height": 0.12, "support__kind": "fixed-first-course"}
    history = {"pulse": {"kind": "half-sine", "amplitude": 0.1, "period": 0.01}, "quantity": "acceleration"}
    rest = resting(panel(**size, joint=joint, load__live=None, load__history=history))
    with pytest.raises(SceneError, match=r"points\[1\] = \[0.12, 0.03\]: must lie on a block that can move"):
        follow(rest, 1.0, points=np.array([[0.12, 0.06], [0.12, 0.03]]))
    assert len(follow(rest, 1.0, points=np.array([[0.12, 0.06]]), rows=50).points) == 1


@pytest.mark.parametrize("falls_first", [True, False])
def test_ledger_lost_after_a_fall_does_not_change_the_verdict(
    falls_first: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run ends and the fall counts; if the ledger is lost before any fall, the wall is undecided."""
    lost = property(lambda log: log.rows[-2:][0].fallen > 0 if falls_first else len(log.rows) > 2)
    monkeypatch.setattr(_Log, "is_lost", lost)
    rest = resting(block(WIDTH / 2, 1.0, shaken("half-sine", 6.0, 1.0), stiffness=1e8))
    response = follow(rest, 1.0, rows=50, after=60.0)
    assert response.verdict == ("collapse" if falls_first else "undecided")
    assert response.time[-1] < 3.0
    assert response.message.startswith("falls: block 0" if falls_first else "more energy is missing than was supplied")


def test_record_is_followed_to_its_end_after_a_quiet_start() -> None:
    """Two quiet seconds, longer than the block has to be calm, and then a pulse that overturns it."""
    time, values = pulse("half-sine", 6.0, 1.0)
    late = History(np.append(0.0, 2.0 + time[::10]), np.vstack([[0.0, 0.0], values[::10]]), interval=1 / 200)
    rest = resting(block(WIDTH / 2, 1.0, late, stiffness=1e8))
    assert rest.swing == pytest.approx(2 * math.sqrt(2.0 / GRAVITY))
    response = follow(rest, 1.0, rows=50)
    assert rest.swing < 2.0 < response.time[-1]
    assert response.verdict == "collapse"
    step = Run(rest.system, local=0.0, viscous=rest.viscous, part=PART).dt
    assert response.steps == pytest.approx(response.time[-1] / step, rel=0.01)  # without the steps until it was at rest
    assert response.scale == 1.0


def test_block_is_past_either_end_of_the_modelled_ground() -> None:
    """The ground reaches from −1 m to 10 m; a scene with held blocks only has no end of the ground."""
    ground = [[[-1, -1], [10, -1], [10, 0], [-1, 0]]]
    scene = panel(wall={"outlines": [[[0, 0], [1, 0], [1, 1], [0, 1]]], "ground": ground, "thickness": 0.1})
    held = panel(support__kind="fixed-first-course")
    for way, past in ((5.0, False), (9.6, True), (-1.4, False), (-1.6, True)):
        assert _is_past_the_ground(scene, np.array([[way, 0.0, 0.0]]), 0) == past
        assert not _is_past_the_ground(held, np.full((len(held.blocks), 3), 9.0), 20)


def test_short_record_has_the_rows_of_a_second() -> None:
    """Fifty rows within a record of 0.1 s, and fifty per second after it."""
    rest = resting(block(WIDTH / 2, 1.0, shaken("sine", 0.5, 0.1)))
    time = follow(rest, 1.0, rows=50).time
    assert int((time <= 0.1).sum()) == pytest.approx(50, abs=2)
    assert int(((time > 0.2) & (time <= 0.7)).sum()) == pytest.approx(25, abs=1)
