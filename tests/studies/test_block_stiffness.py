"""What mass scaling preserves, and what one factor for all deformable modes does not."""

import numpy as np
import pytest

from fem_interface.mass_scaling import IN_TIME
from fem_interface.modal_wall import modal_wall
from fem_interface.model import fem
from fem_interface.system import system_of
from runningbond.dynamics.vibrations import vibrations
from runningbond.studies.stability.block_stiffness import uniformly_scaled, wall
from runningbond.studies.walls import INSET


@pytest.mark.parametrize("young", [1e10, 1e12])
def test_uniform_mass_scaling_spoils_the_lowest_frequencies(young: float) -> None:
    """Scaling each mode by its own factor keeps the lowest frequencies; one factor for all shifts them by 25 %."""
    result, rigid = modal_wall(wall(young)), system_of(modal_wall(wall(young), 1, 3))
    none, each = (system_of(result, mass_scaling=on) for on in (False, True))
    uniform = uniformly_scaled(result, none, rigid.interface.frequency_squared)
    exact, own, all_alike = (vibrations(system)[0] for system in (none, each, uniform))
    band = vibrations(rigid)[0][-1] * (1 + 1e-9)
    assert all_alike[-1] ** 2 <= rigid.interface.frequency_squared < none.interface.frequency_squared / 5
    assert np.abs(own / exact - 1)[: IN_TIME.lowest].max() < IN_TIME.lost * (1 + 1e-6)
    assert np.abs(all_alike / exact - 1)[: IN_TIME.lowest].max() > 0.25
    assert (exact <= band).sum() < 0.5 * (all_alike <= band).sum()
    # Heavier masses lower every frequency (Rayleigh).
    assert (own <= exact * (1 + 1e-9)).all()
    assert (all_alike <= exact * (1 + 1e-9)).all()


def test_unscaled_time_step_falls_with_the_root_of_block_stiffness() -> None:
    """To 1 %, because joints still stiffen softer blocks slightly. With scaling the step is that of rigid blocks."""
    steps = [
        system_of(modal_wall(wall(E)), mass_scaling=False).interface.frequency_squared ** -0.5 for E in (1e12, 1e13)
    ]
    assert steps[0] / steps[1] == pytest.approx(10**0.5, rel=0.01)
    scaled, rigid = (system_of(modal_wall(wall(1e13), 1, modes)).interface.frequency_squared for modes in ("all", 3))
    assert scaled == pytest.approx(rigid, rel=0.005)


@pytest.mark.long
@pytest.mark.parametrize("young", [1e10, 1e13])
def test_multiplier_does_not_depend_on_block_stiffness(young: float) -> None:
    """W1 with joints inset by 20 mm, which has a unique load: 0.58558, certified by linear programs."""
    assert INSET == 0.02
    outcome = fem(wall(young))
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= 0.58558 <= outcome.upper
