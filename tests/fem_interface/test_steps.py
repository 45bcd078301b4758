"""Time steps of deformable blocks: against nodal steps, rigid blocks, and bounds on the frequency."""

import math
from typing import Any, Literal

import numpy as np
import pytest

from dem.rigid_system import rigid_system
from fem_interface.frequency_shift import modal_stiffness
from fem_interface.mass_scaling import scaled_modes
from fem_interface.modal_wall import modal_wall
from fem_interface.system import system_of
from runningbond.dynamics import Run, State
from runningbond.joints.law import FRICTION_WORK
from runningbond.scene import Mortar
from tests.walls import panel

from .nodal_steps import NodalSteps
from .walls import MORTAR, patch, pushed, triangle_wall, wall


@pytest.mark.parametrize("changes", [{}, {"joint__cohesion": 50.0, "joint__inset": 0.01}])
def test_modal_step_equals_nodal_step(changes: dict[str, Any]) -> None:
    """All modes, no mass scaling: the same displacements to 1e-12 for 500 steps, while joints slide and open."""
    scene = wall(5e9, **changes)
    found = modal_wall(scene, modes="all")
    system = system_of(found, damping=0.0, mass_scaling=False)
    run = Run(system, local=0.0, viscous=0.1)
    state = State.at_rest(system)
    nodal = NodalSteps(found, system)
    dt, viscosity = run.dt, 2 * 0.1 / math.sqrt(system.interface.frequency_squared) / run.dt
    run.hold(state, 1.5, 500)
    nodal.take(500, dt, viscosity, 1.5)
    u = found.displacement(state.motion).ravel()[nodal.free]
    assert np.abs(u - nodal.u).max() < 1e-12 * np.abs(u).max()
    opening, slip = nodal.opening @ u, nodal.slip @ u
    assert state.history[4].max() > 1e-3 * np.abs(slip).max()  # slid
    assert opening.max() > 1e-3 * np.abs(u).max()  # opened


@pytest.mark.parametrize(
    ("support", "cells", "on"),
    [("fixed-first-course", 1, "elements"), ("base", 1, "joints"), ("base", 2, "joints")],
)
@pytest.mark.parametrize("changes", [{}, {"joint__inset": 0.01}, {"wall__block_height": 0.24, "joint__cohesion": 10.0}])
def test_three_modes_step_as_rigid_blocks(
    changes: dict[str, Any], support: str, cells: int, on: Literal["elements", "joints"]
) -> None:
    """The same points, masses, loads, frequency bound and steps as `dem-dynamic`, to 1e-12, with slip and opening.

    Without local damping, which would depend on the arbitrary sign of velocities that are zero to rounding.
    """
    scene = panel(joint__mortar=MORTAR, support__kind=support, **changes)
    ours, theirs = system_of(modal_wall(scene, cells, modes=3, points=on)), rigid_system(scene)
    free = ~scene.fixed
    for name in ("mass", "dead", "live", "control", "force_unit"):
        a, b = (getattr(system, name)[system.rigid][free] for system in (ours, theirs))
        assert np.abs(a - b).max() < 1e-12 * np.abs(b).max()
    assert ours.interface.frequency_squared == pytest.approx(theirs.interface.frequency_squared, rel=1e-12)
    assert ours.freedoms == theirs.freedoms
    (motion, state), (rigid, its) = pushed(ours), pushed(theirs)
    assert state.history[FRICTION_WORK].max() > 0
    assert its.history[FRICTION_WORK].max() > 0
    assert np.abs(motion - rigid).max() < 1e-12 * np.abs(rigid).max()


@pytest.mark.parametrize("young", [1e8, 1e10, 1e12])
@pytest.mark.parametrize("mass_scaling", [True, False])
@pytest.mark.parametrize("changes", [{}, {"wall__block_height": 0.24}, {"joint__inset": 0.01}])
def test_single_block_frequency_bound_is_close(changes: dict[str, Any], mass_scaling: bool, young: float) -> None:
    """Upper bound, and close to the exact value."""
    found = modal_wall(wall(young, **changes))
    scaled = scaled_modes(found, 0.0, mass_scaling=mass_scaling)
    root = 1 / np.sqrt(scaled.mass[np.isfinite(scaled.mass)])
    exact = np.linalg.eigvalsh(modal_stiffness(found).toarray() * root[:, None] * root)[-1]
    assert exact <= scaled.frequency_squared
    assert math.sqrt(exact / scaled.frequency_squared) > 0.75


@pytest.mark.parametrize("young", [1e9, 1e12])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_wall_at_stable_step_stays_bounded(make: Any, young: float) -> None:
    """With local, joint and modal damping, and joints that never break."""
    scene = make()
    glue = {"friction": 0.6, "cohesion": 1e9, "tensile_strength": 1e9, "elasticity": Mortar(1e9, 0.2, 0.01)}
    scene = scene.with_block(young=young).with_joint(**glue)
    run = Run(system_of(modal_wall(scene)))
    state = State.at_rest(run.system)
    moving = np.isfinite(run.system.mass)
    state.velocity[moving] = np.random.default_rng(5).normal(size=moving.sum()) * 1e-3

    def energy() -> float:
        return float(0.5 * (run.system.mass[moving] * state.velocity[moving] ** 2).sum())

    before = energy()
    run.hold(state, 0.0, 3000, dead=0.0)
    assert energy() < 1e-3 * before
