"""Blocks that come by each other's ends: below a side without having gone through it."""

from dataclasses import replace

import pytest

from dem.finite_system import finite_system
from runningbond.response import follow
from runningbond.response.resting import Resting
from runningbond.scene import History, Load, Scene
from runningbond.scene.history import pulse
from tests.walls import courses

GRAVITY = 9.81


def falling_off() -> Scene:
    """Two blocks that are thrown off the end of the ground, which is a block's length and a half away."""
    joint = {"friction": 0.7, "normal_stiffness": 1e8, "shear_stiffness": 1e8}
    scene = courses([[1], [1]], width=0.5, height=0.5, wall__thickness=0.3, block__density=2000.0, joint=joint)
    time, values = pulse("half-sine", GRAVITY, 1.0)
    return replace(scene, load=Load(live=(History(time, values),)))


def test_what_falls_past_the_end_of_the_ground_gets_no_energy() -> None:
    """No contact is deeper than the blocks overlap: stored energy stays far below the weight times the fall."""
    scene = falling_off()
    rest = Resting.of(scene, "dem-dynamic", finite_system(scene))
    response = follow(rest, 0.9, after=0.5)
    assert response.verdict == "collapse"
    kinetic, stored = response.energy[:, 2], response.energy[:, 3]
    weight = GRAVITY * float(scene.mass[~scene.fixed].sum())
    assert response.displacement[-1, :, 1].min() < -0.4
    assert stored.max() < 0.2 * weight
    assert kinetic.max() < 1.5 * weight
    assert response.unaccounted == pytest.approx(0.0, abs=0.05)
