"""The energy ledger of falls in which blocks chatter."""

from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.rigid_system import rigid_system
from runningbond.dynamics import Criteria, Run, State
from runningbond.dynamics.fall import Fall
from runningbond.scene import Scene
from tests.walls import panel

FRICTION, WIDTH = 0.428, 0.32


def pillar(inclined: int, dip: float, **joint: Any) -> Scene:
    """Six stones of which one joint is inclined, pushed down its slope."""
    left = 0.2 * np.arange(7)
    right = left + dip * (np.arange(7) == inclined)
    stones = [[[0, left[i]], [WIDTH, right[i]], [WIDTH, right[i + 1]], [0, left[i + 1]]] for i in range(6)]
    return panel(
        wall={"thickness": 0.33, "outlines": [np.asarray(stone).tolist() for stone in stones]},
        joint={"friction": FRICTION, "normal_stiffness": 1e11, "shear_stiffness": 4e10} | joint,
        load={"gravity": 9.81, "live": {"kind": "lateral", "direction": "left"}},
    )


@pytest.mark.parametrize(("inclined", "dip"), [(3, 0.087), (3, 0.1)])
def test_stones_that_chatter_as_they_slide_have_the_exact_load(inclined: int, dip: float) -> None:
    """λ = (μ - s) / (1 + μ s) on a slope s. The work of viscosity, counted by its last traction, failed these falls."""
    outcome, slope = dem_dynamic(pillar(inclined, dip)), dip / WIDTH
    assert outcome.status == "collapse", outcome.message
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower < (FRICTION - slope) / (1 + FRICTION * slope) < outcome.upper


def test_interrupt_while_a_fall_is_counted_again_keeps_the_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any) -> float:
        raise KeyboardInterrupt

    monkeypatch.setattr(Fall, "unaccounted", interrupted)
    outcome = dem_dynamic(pillar(3, 0.087))
    assert outcome.status == "undecided"
    assert outcome.message.startswith("interrupted: the bracket so far")
    assert outcome.lower is not None
    assert outcome.upper is not None


def test_falls_of_laws_without_another_ledger_are_not_counted_again() -> None:
    system = rigid_system(
        pillar(3, 0.087, cohesion=1e4, tensile_strength=1e3, fracture_energy_1=10.0, fracture_energy_2=10.0)
    )
    run = Run(system)
    state = State.at_rest(system)
    assert Fall(run, state, 0.1, Criteria(collapse=0.01)).unaccounted(state) is None
