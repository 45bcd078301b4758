"""Two stacked blocks: the pattern of Psycharis in which they start, and their accelerations."""

import numpy as np
import pytest

from runningbond.dynamics import Run
from runningbond.models import respond
from runningbond.response.ground import Ground
from runningbond.response.resting import VISCOUS
from runningbond.scene import Array, BlockMaterial, History, JointMaterial, Load, Scene, Stiffness, build_scene
from runningbond.scene.history import pulse
from tests.at_length import at_length
from tests.limit.test_limit import rectangle

from .housner import GRAVITY
from .psycharis import BOTH_AND_UPPER_MORE, ONE_BODY, REST, UPPER_ALONE, UPPER_LAGS, Pattern, TwoBlocks
from .walls import resting

SLENDER = TwoBlocks((0.25, 0.05), (1.0, 0.3))
FLAT = TwoBlocks((0.5, 0.15), (0.5, 0.3))
ALIKE = TwoBlocks((0.25, 0.25), (0.5, 0.5))
STARTS = [
    # pair, acceleration of the ground in g, pattern
    (SLENDER, 0.15, REST),
    (SLENDER, 0.2, UPPER_ALONE),
    (SLENDER, 0.3, BOTH_AND_UPPER_MORE),
    (SLENDER, 0.5, ONE_BODY),
    (SLENDER, 2.0, UPPER_LAGS),
    (FLAT, 0.7, UPPER_ALONE),
    (FLAT, 1.5, BOTH_AND_UPPER_MORE),
    (FLAT, 3.0, ONE_BODY),
    (ALIKE, 0.3, ONE_BODY),
]


def built(pair: TwoBlocks, history: History, stiffness: float) -> Scene:
    """The pair on the ground, with too much friction to slide."""
    (b1, b2), (h1, h2) = pair.b, pair.h
    return build_scene(
        "two blocks",
        [rectangle(-b1, 0, 2 * b1, 2 * h1), rectangle(-b2, 2 * h1, 2 * b2, 2 * h2)],
        thickness=0.12,
        block=BlockMaterial(1800.0),
        joint=JointMaterial(9.0, elasticity=Stiffness(stiffness, stiffness)),
        load=Load(live=(history,)),
    )


def least_acceleration(pair: TwoBlocks) -> tuple[float, Pattern]:
    """Smallest ground acceleration that causes rotation [m/s²], with its pattern.

    The upper block rotates from g b2 / h2, the pair from g b1 over the height of its centroid.
    """
    centroid = pair.mass @ [pair.h[0], 2 * pair.h[0] + pair.h[1]] / pair.mass.sum()
    alone, as_one = GRAVITY * pair.b[1] / pair.h[1], GRAVITY * pair.b[0] / float(centroid)
    return (alone, UPPER_ALONE) if alone < as_one else (as_one, ONE_BODY)


def test_initial_pattern_is_unique() -> None:
    """For 100 random pairs and accelerations, and mirrored; statics determines the first pattern."""
    random = np.random.default_rng(1)
    for upper, lower, h1, h2, ground in random.uniform(0.05, 1.0, (100, 5)):
        pair = TwoBlocks((lower, upper * lower), (h1, h2))
        limit, first = least_acceleration(pair)
        assert pair.starts(0.999 * limit) == [REST]
        assert pair.starts((1 + 1e-6) * limit) == [first]
        (pattern,) = pair.starts(8 * GRAVITY * ground)
        assert pair.starts(-8 * GRAVITY * ground) == [(-pattern.lower, -pattern.upper)]


@pytest.mark.parametrize(("pair", "ground", "pattern"), STARTS)
def test_two_blocks_start_in_their_pattern(pair: TwoBlocks, ground: float, pattern: Pattern) -> None:
    """Under sudden ground acceleration: the pattern, and θ̈ of both blocks initially and over 0.1 s, to 0.3 %.

    By second differences, because compliant joints have less compression where they open and cause an initial velocity.
    """
    span, none = 0.1, np.zeros(2)
    assert pair.starts(ground * GRAVITY) == [pattern]
    constant = History(np.array([0.0, span]), np.array([[ground, 0.0]] * 2), "g", GRAVITY / 9.80665, interval=1e-4)
    rest = resting(built(pair, constant, 1e13))
    run, state = Run(rest.system, local=0.0, viscous=VISCOUS), rest.state.copy()
    follower, rows = Ground(run, constant, 1.0, state.time), []
    for quarter in range(5):
        follower.bring(state, quarter * span / 4)
        rows.append((follower.time(state), *(state.motion - rest.state.motion)[[2, 5]]))
    time, found = np.array(rows)[:, 0], np.array(rows)[:, 1:].T
    exact = pair.rotations(pattern, ground * GRAVITY, time)
    scale = max(float(np.abs(second_difference(exact, time, 2)).max()), 1e-2)
    assert second_difference(found, time, 2) == pytest.approx(second_difference(exact, time, 2), abs=3e-3 * scale)
    start = (4 * second_difference(found, time, 1) - second_difference(found, time, 2)) / 3
    alpha = pair.accelerations(pattern, ground * GRAVITY, none, none)
    assert start == pytest.approx(alpha, abs=3e-3 * max(float(np.abs(alpha).max()), 0.1))
    apart = np.array([start[0], start[1] - start[0]]) / max(float(np.abs(alpha).max()), 0.1)
    assert np.array_equal(np.where(np.abs(apart) < 0.01, 0, -np.sign(apart)), pattern)


def second_difference(of: Array, time: Array, step: int) -> Array:
    """Mean acceleration over the first two intervals of `step` rows each."""
    first = (of[:, step] - of[:, 0]) / time[step]
    second = (of[:, 2 * step] - of[:, step]) / (time[2 * step] - time[step])
    return np.asarray(2 * (second - first) / time[2 * step])


def test_blocks_may_start_in_opposite_senses() -> None:
    """The head of a tall block below a small one moves back faster than the ground comes: θ1 > 0 > θ2."""
    lower, upper = SLENDER.accelerations(UPPER_LAGS, 2 * GRAVITY, np.zeros(2), np.zeros(2))
    assert lower > 10 > -3 > upper


@pytest.mark.parametrize("pair", [SLENDER, FLAT, *at_length(ALIKE)])
def test_slow_ground_acceleration_starts_the_static_pattern(pair: TwoBlocks) -> None:
    """The acceleration grows for 3 s and stays: 3 % below the limit all stand, 3 % above the pattern's blocks fall."""
    least, pattern = least_acceleration(pair)
    time, values = pulse("ramp", least, 3.0)
    scene = built(pair, History(time, values, holds=True, interval=0.02), 3e10)
    assert respond("dem-dynamic", scene, 0.97, rows=50).verdict == "stands"
    response = respond("dem-dynamic", scene, 1.03, rows=50)
    assert response.verdict == "collapse"
    lower, upper = response.shape[:2, 2]  # before large displacements
    assert upper > 0.03
    if pattern == UPPER_ALONE:
        assert response.first.tolist() == [1]
        assert abs(lower) < 1e-4
    else:
        assert lower == pytest.approx(upper, rel=1e-3)
