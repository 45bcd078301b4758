"""Fictitious inertia: longer time steps without effect on statics."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from dem.dynamic import dem_dynamic, quasi_static_run
from dem.rigid_system import contact_points, held_masses, rigid_system, with_fictitious_inertia
from fem_interface import fictitious_inertia
from fem_interface.modal_wall import modal_wall
from fem_interface.model import fem, run_of_longer_steps
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.dynamics import (
    CALMER,
    BlockSystem,
    Criteria,
    Run,
    State,
    inertia_factors,
    settle,
    with_highest_frequency,
)
from runningbond.dynamics.run import LOCAL
from runningbond.dynamics.time_step import rigid_stiffness, stable_step
from runningbond.dynamics.vibrations import elastic_stiffness, vibrations
from runningbond.joints.wall_points import wall_stiffness
from runningbond.scene import Array, Scene
from tests.at_length import at_length
from tests.walls import panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
STONE = {"block__young": 1e10, "block__poisson": 0.2, "joint__mortar": MORTAR}


def rigid(scene: Scene) -> tuple[BlockSystem, BlockSystem]:
    """Rigid blocks with their own inertia, and with fictitious inertia."""
    system = rigid_system(scene)
    return system, with_fictitious_inertia(scene, system)


def deformable(scene: Scene) -> tuple[BlockSystem, BlockSystem]:
    """Deformable blocks with their own inertia, and with fictitious inertia."""
    wall = modal_wall(scene)
    system = system_of(wall)
    return system, fictitious_inertia.with_fictitious_inertia(wall, system)


BOTH = pytest.mark.parametrize("systems", [rigid, deformable])


def factors_of(scene: Scene, heavier: float = 1.0) -> tuple[Array, Array]:
    """Inertia factors of the blocks, and ω² of their three motions on their own joints [1/s²]."""
    points, mass = contact_points(scene), heavier * held_masses(scene).reshape(-1, 3)
    normal, shear = wall_stiffness(scene, points.joint)
    own = rigid_stiffness(points, points.block, scene.blocks.centroid, mass, normal, shear)
    return inertia_factors(scene, points, mass), np.diagonal(own, axis1=1, axis2=2) / mass


@pytest.mark.parametrize("changes", [{}, {"wall__block_height": 0.24}, {"wall__height": 0.24}])
def test_fictitious_inertia_limits_block_frequencies_to_median_of_slowest_motion(changes: dict[str, Any]) -> None:
    scene = panel(joint__mortar=MORTAR, **changes)
    factors, square = factors_of(scene)
    moving = ~scene.fixed
    slowest = np.median(square[moving], axis=0).min()
    assert (square / factors)[moving] == pytest.approx(np.minimum(square, slowest)[moving])
    assert (factors >= 1).all()
    assert (factors[scene.fixed] == 1).all()
    # At least half of the blocks keep their mass in one direction.
    assert (factors[moving] == 1).mean(axis=0).max() >= 0.5
    stiffer = panel(joint__mortar={**MORTAR, "young": 1e12}, **changes)
    assert factors_of(stiffer, heavier=1e-4)[0] == pytest.approx(factors)


@BOTH
@pytest.mark.parametrize(("name", "times"), [("panel-01", 1.6), ("panel-04", 2.0), ("wall-w1", 1.5)])
def test_fictitious_inertia_lengthens_steps(systems: Any, name: str, times: float) -> None:
    own, heavier = systems(published_scene(name))
    assert Run(with_highest_frequency(heavier)).dt > times * Run(with_highest_frequency(own)).dt


@pytest.mark.parametrize(("name", "rigid_times", "times"), [("panel-04", 1.5, 2.2), ("panel-01", 1.1, 1.4)])
def test_model_steps_are_longer_including_dashpots(name: str, rigid_times: float, times: float) -> None:
    """Steps as the models use them, against blocks with their own inertia and the usual dashpots."""
    scene = published_scene(name)
    wall = modal_wall(scene)
    system = system_of(wall)
    assert quasi_static_run(scene).dt > rigid_times * Run(with_highest_frequency(rigid_system(scene))).dt
    assert run_of_longer_steps(wall, system).dt > times * Run(system).dt


@BOTH
@pytest.mark.parametrize("name", ["panel-01", "wall-w1"])
def test_step_frequency_is_highest_of_wall_with_fictitious_inertia(systems: Any, name: str) -> None:
    """Against eigenvalues of full matrices; the blocks' viscosity counts as stiffness."""
    _, system = systems(published_scene(name))
    interface = with_highest_frequency(system, CALMER).interface
    stiffness, mass = elastic_stiffness(system)
    moving = np.isfinite(system.mass)
    damped = 2 / stable_step(interface.frequency_squared, CALMER, LOCAL) * system.viscosity[moving]
    exact = float(eigh(stiffness + np.diag(damped), np.diag(mass), eigvals_only=True)[-1])
    assert interface.closer == pytest.approx(exact, rel=1e-3)
    assert exact <= interface.frequency_squared * (1 + 1e-9)


@pytest.mark.parametrize("young", [1e10, 1e12])
@pytest.mark.parametrize("name", ["panel-04", "wall-w1", *at_length("panel-01")])
def test_fictitious_inertia_of_deformations_keeps_lowest_frequency(name: str, young: float) -> None:
    """To 1 %, against the same wall with fictitious inertia of rigid motions only."""
    wall = modal_wall(published_scene(name).with_block(young=young))
    heavier = fictitious_inertia._heavier(wall)
    alone = replace(system_of(wall), mass=heavier.mass)
    both = fictitious_inertia.with_fictitious_inertia(wall, system_of(wall))
    lowest, slowed = (vibrations(system)[0][0] for system in (alone, both))
    assert 0.99 * lowest <= slowed <= lowest * (1 + 1e-9)


@BOTH
def test_static_equilibrium_does_not_depend_on_masses(systems: Any) -> None:
    """The same rest under self weight, to the residual; bonded joints, so that nothing slips."""
    scene = panel(joint__cohesion=1e9, **STONE)
    rests = []
    for system in systems(scene):
        run, state = Run(system), State.at_rest(system)
        assert settle(run, state, 0.0, Criteria(collapse=1.0, rest=1e-9), sudden=True) == "stable"
        rests.append(run.system.motion_of_blocks(state.motion))
    assert np.abs(rests[0]).max() > 0
    assert rests[1] == pytest.approx(rests[0], abs=1e-6 * np.abs(rests[0]).max())


@pytest.mark.parametrize("pinned", [False, True])
def test_blocks_on_pins_keep_their_masses(pinned: bool) -> None:
    scene = panel(**STONE, **({"support__kind": "pinned-corners"} if pinned else {}))
    held = np.unique(scene.pins.block)
    assert bool(len(held)) is pinned
    for own, heavier in (rigid(scene), deformable(scene)):
        freedom = own.rigid[held]
        assert (heavier.mass[freedom] == own.mass[freedom]).all()
        assert (heavier.mass[own.rigid] > own.mass[own.rigid]).any()


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_message_reports_inertia_factor(model: Any) -> None:
    """Both models have the same joint points on this wall."""
    scene = published_scene("wall-w1")
    said = model(scene).message
    factors, _ = factors_of(scene)
    assert f"inertia of blocks scaled up to {factors.max():.3g} times" in said


def test_driven_walls_keep_their_own_inertia() -> None:
    """The drive path takes physical time, in which the blocks have to move."""
    beam = {"height": 0.1, "condition": "level", "force": [0, -2e3], "drive": {"displacement": [1e-3, 0]}}
    scene = panel(load__live=None, beam=beam, **STONE)
    run = quasi_static_run(scene)
    assert run.system.inertia_scaling == 1
    assert (run.system.mass == rigid_system(scene).mass).all()
    wall = modal_wall(scene)
    system = system_of(wall)
    assert (run_of_longer_steps(wall, system).system.mass == system.mass).all()
