"""Columns of drums under pulses, compared with non-smooth contact dynamics, a method without springs."""

import numpy as np
import pytest

from runningbond.response import follow
from runningbond.scene import BlockMaterial, JointMaterial, Load, Scene, Stiffness, build_scene
from tests.at_length import at_length
from tests.limit.test_limit import rectangle

from .nonsmooth import column_in_motion
from .walls import resting, shaken

GRAVITY, STEP, EVERY = 9.81, 2e-5, 50


def column(half: list[tuple[float, float]], friction: float, amplitude: float, period: float) -> Scene:
    """Stacked blocks of half widths and half heights [m] under a sine."""
    height, drums = 0.0, []
    for b, h in half:
        drums.append(rectangle(-b, height, 2 * b, 2 * h))
        height += 2 * h
    return build_scene(
        "column",
        drums,
        thickness=0.12,
        block=BlockMaterial(1800.0),
        joint=JointMaterial(friction, elasticity=Stiffness(1e10, 1e10)),
        load=Load(live=(shaken("sine", amplitude, period),)),
    )


@pytest.mark.parametrize(
    ("half", "friction", "amplitude", "span", "verdict"),
    [
        *at_length(
            ([(0.25, 0.25)] * 3, 0.35, 5.0, 0.38, "stands"),
            ([(0.25, 0.5)], 0.4, 7.0, 2.0, "stands"),  # slides and rocks at the same time
            ([(0.25, 0.5)] * 2, 0.6, 4.0, 1.5, "stands"),
            ([(0.2, 0.2)] * 4, 0.7, 5.0, 1.5, "collapse"),
        ),
    ],
)
def test_drums_follow_nonsmooth_contact_dynamics(
    half: list[tuple[float, float]], friction: float, amplitude: float, span: float, verdict: str
) -> None:
    """Displacements of all upper corners to 2 % of the largest, through impacts and into the fall.

    For drums that slide during impacts (friction 0.35) only the time until the first impact is compared: which corner
    slips then depends on which is hit first, and rigid blocks leave that undetermined.
    """
    scene = column(half, friction, amplitude, 0.6)
    size = np.array(half)
    tops = np.cumsum(2 * size[:, 1])
    response = follow(resting(scene), 1.0, points=np.column_stack([-size[:, 0], tops]), after=0.5)
    time = STEP * (np.arange(round(span / STEP)) + 0.5)
    ground = np.interp(time, scene.history.time, scene.history.values[:, 0], right=0.0) if scene.history else time
    mass = scene.mass[scene.wall]
    inertia = mass * (size**2).sum(axis=1) / 3
    motion = column_in_motion(size, mass, inertia, friction, ground, GRAVITY, STEP, EVERY)
    moments = EVERY * STEP * (np.arange(len(motion)) + 1)
    turn = motion[:, :, 2]
    across = motion[:, :, 0] - size[:, 0] * (np.cos(turn) - 1) - size[:, 1] * np.sin(turn)
    there = moments <= response.time[-1]
    found = np.column_stack([np.interp(moments, response.time, way) for way in response.displacement[:, :, 0].T])
    assert response.verdict == verdict
    assert there.sum() > 300
    assert found[there] == pytest.approx(across[there], abs=0.02 * np.abs(across[there]).max())
