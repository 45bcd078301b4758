"""Pieces of blocks with more inertia against one another: frequencies, steps, energies, and what walls bear."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from fem_interface.frequency_shift import modal_stiffness
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.piece_masses import LONGER, with_heavier_pieces
from fem_interface.system import system_of
from runningbond.dynamics import BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.run import LOCAL
from runningbond.scene import Array, Indices, Scene

from .walls import damped_without_giving_back, wall

STRONG = {"friction": 0.75, "cohesion": 1e12, "tensile_strength": 1e12}
WEAK = {"friction": 0.75, "cohesion": 4e5, "tensile_strength": 2e5, "fracture_energy_1": 5.0, "fracture_energy_2": 50.0}
SIZE = {"wall__length": 0.24, "wall__height": 0.24, "wall__block_width": 0.12, "wall__block_height": 0.12}
HEAVIER = LONGER**2 - 1
PRESSED = 2e4
"""What a beam presses with on a wall [N]."""


def pressed(inner: dict[str, Any] | None = None, **changes: Any) -> Scene:
    """A wall of a few blocks that may crack, under a beam which is driven."""
    beam = {"height": 0.1, "condition": "fixed-height", "force": [0, -PRESSED]}
    beam["drive"] = {"displacement": [2e-4, 0], "rate": 1e-3, "at": 0.24}
    joint = {**(inner or STRONG), "normal_stiffness": 1e13, "shear_stiffness": 4e12}
    return wall(**{**SIZE, "inner_joint": joint, "load": {"gravity": 9.81}, "beam": beam, **changes})


def heavier(scene: Scene, cells: int = 1) -> tuple[ModalWall, BlockSystem, BlockSystem]:
    """A wall in triangles, its pieces as they are, and heavier against one another."""
    found = modal_wall(scene, cells, cracks="blocks")
    system = system_of(found)
    return found, system, with_heavier_pieces(found, system)


def rigid_motions(found: ModalWall, system: BlockSystem, cluster: int) -> tuple[Indices, Array]:
    """Where the freedoms of a cluster's pieces stand ``(m,)``, and the rigid motions of all of it ``(m, 3)``."""
    own = system.clusters.freedom[system.clusters.cluster == cluster].astype(np.int64)
    pieces = [int(np.flatnonzero((found.rigid == freedom).all(axis=1))[0]) for freedom in own]
    x, y = found.scene.blocks.centroid[pieces].T
    each = np.tile(np.eye(3), (len(own), 1, 1))
    each[:, 0, 2], each[:, 1, 2] = -y, x
    return own.ravel(), each.reshape(-1, 3)


def masses(found: ModalWall, system: BlockSystem) -> Array:
    """M* of what moves: without a formula for centres, by least squares on the rigid motions of each block."""
    moving = np.isfinite(system.mass)
    M = np.diag(np.where(moving, system.mass, 0.0))
    for cluster in range(system.clusters.number):
        places, R = rigid_motions(found, system, cluster)
        m = np.diag(system.mass[places])
        M[np.ix_(places, places)] += HEAVIER * (m - m @ R @ np.linalg.solve(R.T @ m @ R, R.T @ m))
    return np.asarray(M[np.ix_(moving, moving)])


@pytest.mark.parametrize("cells", [1, 2])
@pytest.mark.parametrize("changes", [{}, {"block__young": 1e9}, {"wall__height": 0.36, "beam__condition": "free"}])
def test_heavier_pieces_bound_the_frequency(cells: int, changes: dict[str, Any]) -> None:
    """From above, by the eigenvalues of the whole wall; steps are more than six times as long."""
    found, plain, system = heavier(pressed(**changes), cells)
    K, M = modal_stiffness(found).toarray(), masses(found, system)
    last = len(K) - 1
    highest = eigh(K, M, eigvals_only=True, subset_by_index=(last, last))[0]
    assert 0.4 * system.interface.frequency_squared < highest <= system.interface.frequency_squared
    assert Run(system).dt > 6 * Run(plain).dt


def test_a_block_as_a_whole_keeps_its_inertia() -> None:
    """Rigid motions of a block have the energy of its own masses; what has no momentum 1 + β times as much."""
    found, plain, system = heavier(pressed(), 2)
    velocity, draw = np.zeros_like(plain.mass), np.random.default_rng(5)
    places, R = rigid_motions(found, system, 3)
    velocity[places] = R @ draw.normal(size=3)
    assert abs(system.clusters.energy(velocity, system.mass)) < 1e-12 * kinetic(plain, velocity)
    m = plain.mass[places]
    apart = draw.normal(size=len(places))
    velocity[places] = apart - R @ np.linalg.solve(R.T * m @ R, R.T * m @ apart)
    assert system.clusters.energy(velocity, system.mass) == pytest.approx(HEAVIER * kinetic(plain, velocity), rel=1e-9)


def kinetic(system: BlockSystem, velocity: Array) -> float:
    """Kinetic energy of masses one by one [J]."""
    moving = np.isfinite(system.mass)
    return float(0.5 * (system.mass[moving] * velocity[moving] ** 2).sum())


@pytest.mark.parametrize("local", [0.0, LOCAL])
def test_a_step_is_that_of_dense_matrices(local: float) -> None:
    """M* a = f where nothing is damped; with damping α resists a block's acceleration, and what is left beside it."""
    found, _, system = heavier(pressed(joint__friction=1e6, joint__cohesion=1e12))
    run, state = Run(system, local=local, viscous=0.0), State.at_rest(system)
    moving, M = np.isfinite(system.mass), masses(found, system)
    K, m = modal_stiffness(found).toarray(), system.mass[moving]
    P = np.zeros_like(K)
    number = np.cumsum(moving) - 1
    for cluster in range(system.clusters.number):
        places, R = rigid_motions(found, system, cluster)
        own = system.mass[places]
        P[np.ix_(number[places], number[places])] = R @ np.linalg.solve(R.T * own @ R, R.T * own)
    load = (system.dead + 1e3 * system.live)[moving]
    # Set off so that nothing rests by symmetry: the sign of a rounding error is nobody's.
    v: Any = 1e-3 * np.random.default_rng(7).normal(size=len(K))
    state.velocity[moving], q = v, np.zeros(len(K))
    for _ in range(100):
        a = (load - K @ q - system.viscosity[moving] * v) / m
        beside = a - P @ a - local * np.abs(a - P @ a) * np.sign(v - P @ v)
        # Of a block the mean acceleration is resisted, here read off where its pieces are: in its three numbers.
        whole = P @ a if local == 0.0 else damped_whole(found, system, a, v, local, number)
        v = v + run.dt * np.linalg.solve(M, m * (whole + beside - P @ beside))
        q = q + run.dt * v
    run.hold(state, 1e3, 100)
    assert np.abs(state.motion[moving] - q).max() < 1e-9 * np.abs(q).max()


def damped_whole(found: ModalWall, system: BlockSystem, a: Array, v: Array, local: float, number: Any) -> Array:
    """What pieces have of their blocks' accelerations, whose translations and rotation local damping resists."""
    result = np.zeros_like(a)
    for cluster in range(system.clusters.number):
        places, R = rigid_motions(found, system, cluster)
        own, here = system.mass[places], number[places]
        weight = own[::3] / own[::3].sum()
        x, y = weight @ R[1::3, 2], -weight @ R[::3, 2]
        R = R.copy()
        R[::3, 2] += y
        R[1::3, 2] -= x
        pace, drift = (np.linalg.solve(R.T * own @ R, R.T * own @ u[here]) for u in (a, v))
        result[here] = R @ (pace - local * np.abs(pace) * np.sign(drift))
    return result


@pytest.mark.parametrize(("local", "viscous"), [(0.0, 0.0), (LOCAL, 0.1)])
def test_steps_account_for_their_energy(local: float, viscous: float) -> None:
    """A wall that cracks under a load put on at once: no energy is made, and damping never gives any back."""
    _, _, system = heavier(pressed(WEAK), 2)
    run, state = Run(system, local=local, viscous=viscous), State.at_rest(system)
    damped_without_giving_back(run, state, 1.5e4)
    assert run.ledger(state).friction > 0


def test_statics_do_not_feel_heavier_pieces() -> None:
    """A glued wall at rest has the displacements that its stiffness gives, to 1e-6 of the largest."""
    found, _, system = heavier(pressed(joint__friction=1e6, joint__cohesion=1e12), 2)
    run, state = Run(system), State.at_rest(system)
    assert settle(run, state, 0.0, Criteria(collapse=1.0, rest=1e-9)) == "stable"
    moving = np.isfinite(system.mass)
    exact = spsolve(modal_stiffness(found).tocsc(), system.dead[moving])
    assert np.abs(state.motion[moving] - exact).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.long
def test_a_wall_that_cracks_bears_what_it_does_with_pieces_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its force all along, to 3e-3 of the largest, which is far less than where it stays whole; in far fewer steps."""
    drive = {"displacement": [2e-4, 0], "rate": 2e-3, "at": 0.24}
    changes: dict[str, Any] = {"joint__friction": 1.5, "joint__compressive_strength": 1e9, "beam__drive": drive}
    whole = fem(pressed(**changes), cracks="blocks")
    fast = fem(pressed(WEAK, **changes), cracks="blocks")
    monkeypatch.setattr("fem_interface.model.with_heavier_pieces", lambda wall, system: system)
    slow = fem(pressed(WEAK, **changes), cracks="blocks")
    assert fast.steps is not None
    assert slow.steps is not None
    assert fast.steps < slow.steps / 5
    assert "heavier against one another" in fast.message
    most = slow.curve[:, 1].max()
    assert np.abs(fast.curve[:, 1] - np.interp(fast.curve[:, 0], *slow.curve.T)).max() < 0.003 * most
    assert most < 0.8 * whole.curve[:, 1].max()


def test_walls_that_no_beam_leads_are_left_alone() -> None:
    """They fall by themselves, at their own pace."""
    scene = pressed(beam={"height": 0.1, "drive": {"force": [1, 0]}})
    found = modal_wall(scene, cracks="blocks")
    system = system_of(found)
    assert with_heavier_pieces(found, system) is system


def test_the_faster_a_beam_is_led_the_less_heavy_pieces_are() -> None:
    """Waves cross a block of 0.12 m at 2236 m/s a hundred times, at the pace that is left to them, in 2e-4 m."""
    clusters = {}
    for rate in (1e-3, 5e-3, 0.02):
        drive = {"displacement": [2e-4, 0], "rate": rate, "at": 0.24}
        clusters[rate] = heavier(pressed(block__density=2000.0, beam__drive=drive))[2].clusters
    crossed = math.sqrt(1e10 / 2000.0) * 2e-4 / (2 * 0.12)
    assert clusters[1e-3].more == pytest.approx(HEAVIER)
    assert 1 + clusters[5e-3].more == pytest.approx((crossed / 5e-3 / 100) ** 2, rel=1e-6)
    assert not len(clusters[0.02].cluster)


def test_rigid_pieces_have_no_waves_to_wait_for() -> None:
    drive = {"displacement": [2e-4, 0], "rate": 0.02, "at": 0.24}
    found = modal_wall(pressed(beam__drive=drive).with_block(young=None), modes=3, cracks="blocks")
    assert with_heavier_pieces(found, system_of(found)).clusters.more == pytest.approx(HEAVIER)


def test_walls_of_whole_blocks_are_left_alone() -> None:
    found = modal_wall(pressed())
    system = system_of(found)
    assert with_heavier_pieces(found, system) is system
