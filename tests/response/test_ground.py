"""Ground motion applied to a wall, and its state of rest before the record."""

import math
from typing import Any

import numpy as np
import pytest

from runningbond.dynamics import Run
from runningbond.response.ground import LONGEST, Ground
from runningbond.scene import Array, History

from ..walls import panel
from .housner import GRAVITY
from .walls import block, resting, still

TIME = np.arange(0.0, 0.201, 0.02)
VALUES = np.random.default_rng(2).uniform(-4.0, 4.0, (len(TIME), 2)) * [1.0, 0.2]


def applied(history: History, scale: float, times: Array) -> tuple[Array, Array, Ground]:
    """Times to which a block was integrated, the ground velocities applied by then, and its `Ground`."""
    rest = resting(block(0.25, 1.0, history, stiffness=1e10))
    state = rest.state.copy()
    ground = Ground(Run(rest.system, local=0.0, viscous=rest.viscous), history, scale, state.time)
    there = []
    for until in times:
        ground.bring(state, float(until))
        assert abs(ground.time(state) - until) <= ground.run.dt / 2 * (1 + 1e-9)
        there.append((ground.time(state), *ground.velocity))
    found = np.array(there)
    return found[:, 0], found[:, 1:], ground


@pytest.mark.parametrize("rows", [0.003, 0.05])
def test_applied_ground_velocity_follows_the_record(rows: float) -> None:
    """Within intervals of `LONGEST` up to the error of a chord for a parabola; exact at the end of the record."""
    history = History(TIME, VALUES)
    times, velocity, ground = applied(history, 1.5, np.arange(rows, 0.3, rows))
    jerk = 1.5 * float(np.abs(np.diff(VALUES, axis=0)).max()) / 0.02
    steps = LONGEST + ground.run.dt
    assert velocity == pytest.approx(1.5 * history.velocity(times), abs=jerk * steps**2 / 8)
    assert velocity[-1] == pytest.approx(1.5 * history.velocity(1.0), rel=1e-9)
    assert ground.acceleration(0.02) == pytest.approx(1.5 * VALUES[1])


def test_sudden_ground_velocity_is_reached_and_removed_in_one_step() -> None:
    """A displacement along a straight line, to 0.05 m in 0.1 s."""
    time = np.linspace(0.0, 0.1, 11)
    bent = 0.5 * time + 1e-3 * time**2  # a record must have some acceleration
    history = History(time, np.column_stack([bent, 0 * time]), "displacement")
    _, velocity, ground = applied(history, 1.0, np.array([0.0, 2e-4, 0.05, 0.0999, 0.1002]))
    assert ground.run.dt < 5e-4
    assert velocity[0].tolist() == [0.0, 0.0]
    assert velocity[1:4, 0] == pytest.approx(0.5, rel=1e-3)
    assert velocity[-1] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_wall_at_rest_has_no_velocity_and_its_ground_carries_the_weight() -> None:
    scene = block(0.25, 1.0, still())
    rest = resting(scene)
    assert not rest.state.velocity.any()
    ground = Ground(Run(rest.system), rest.history, 1.0, rest.state.time)
    weight = float(scene.mass[0]) * GRAVITY
    assert ground.dead() == pytest.approx([0.0, -weight])
    assert ground.momentum(rest.state).tolist() == [0.0, 0.0]
    ground.velocity = np.array([2.0, -1.0])  # at rest on ground that moves
    assert ground.momentum(rest.state) == pytest.approx(float(scene.mass[0]) * ground.velocity)


def test_top_of_a_wall_is_its_outermost_highest_corners() -> None:
    """Three towers, two of them equally high, on ground at y = 1 m; the swing time follows from the height."""
    towers: list[Any] = [[x, y, x + 0.5, y + h] for x, y, h in ((0, 1, 2), (1, 1, 3), (2, 1, 3))]
    outlines = [[[a, b], [c, b], [c, d], [a, d]] for a, b, c, d in towers]
    history = {"pulse": {"kind": "half-sine", "amplitude": 0.1, "period": 0.01}, "quantity": "acceleration"}
    stiff = {"friction": 0.6, "normal_stiffness": 1e8, "shear_stiffness": 1e8}
    rest = resting(
        panel(wall={"outlines": outlines, "thickness": 0.1}, joint=stiff, load__live=None, load__history=history)
    )
    assert rest.top == pytest.approx(np.array([[1.0, 4.0], [2.5, 4.0]]))
    assert rest.height == pytest.approx(3.0)
    assert rest.swing == pytest.approx(2 * math.sqrt(3.0 / GRAVITY))
    assert [rest.block_at(np.array(at)) for at in ((0.49, 1.1), (1.01, 1.1), (1.9, 5.0))] == [0, 1, 2]
