"""Forces of the states along a path to large displacements, as vectors."""

import math
from typing import Any

import numpy as np
import pytest

import runningbond as rb


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
@pytest.mark.parametrize("strength", [{}, {"compressive_strength": 5e7}])
def test_pulls_on_a_block_that_tips_over_its_sharp_corner_balance_its_weight(
    model: str, strength: dict[str, Any]
) -> None:
    """Also past 22.5°, from where on the other corner, an obtuse one, does not face the ground."""
    stone, ground = [(0, 0), (1, 0), (0.4, 0.6), (-0.6, 0.6)], [(-3, -1), (4, -1), (4, 0), (-3, 0)]
    moment = {"kind": "moment", "at": [0.2, 0.3], "moment": -1.0}
    bed = {"normal_stiffness": 1e9, "shear_stiffness": 4e8, **strength}
    material: dict[str, Any] = {"thickness": 0.3, "density": 2000.0, "young": 1e10, "friction": 0.7}
    leaning = rb.Wall.outlines([stone], [ground], **material, **bed, live=moment)
    states = leaning.run(model, states=True, displacements="finite", distance=0.4).states
    weight = leaning.scene.mass[0] * 9.81
    assert states[-1].motion[0, 2] < -math.radians(25)
    for state in states:
        assert state.pull.sum(axis=0) == pytest.approx([0.0, weight], abs=0.01 * weight)
        assert state.force.sum(axis=0) == pytest.approx([-weight, 0.0], abs=0.01 * weight)


def test_pulls_are_forces_in_the_frame_of_the_block_whose_side_bears() -> None:
    """Of stones of a pier whose upper part leans on the lower one."""
    pier = rb.Wall.running_bond(
        length=0.5,
        height=1.5,
        block_width=0.5,
        block_height=0.5,
        thickness=0.3,
        density=2000.0,
        friction=0.7,
        normal_stiffness=1e8,
        shear_stiffness=4e7,
        live={"kind": "point", "at": [0.0, 1.5], "force": [1.0, 0.0]},
    )
    states = pier.run("dem-dynamic", tolerance=0.05, states=True, displacements="finite", distance=0.1).states
    assert np.ptp(states[-1].motion[:, 2]) > 0.05
    for state in states:
        points, turned = state.points, state.motion[state.points.block, 2]
        frames = np.array([points.normal @ [1, 1j], points.tangent @ [1, 1j]])
        undeformed = (state.force.T * frames).sum(axis=0)
        off = np.abs(undeformed[:, None] * np.exp(1j * turned) - (state.pull @ [1, 1j])[:, None])
        assert off.min(axis=1).max() < 1e-6 * np.abs(state.force).max()
