"""Block pieces with more inertia against one another: frequencies, time steps, energies and limit loads."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from fem_interface.frequency_shift import modal_stiffness
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.piece_masses import STEP_FACTOR, with_heavier_pieces
from fem_interface.system import system_of
from runningbond.dynamics import BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.run import LOCAL
from runningbond.scene import Array, Indices, Scene

from .walls import check_damping_dissipates, wall

STRONG = {"friction": 0.75, "cohesion": 1e12, "tensile_strength": 1e12}
WEAK = {"friction": 0.75, "cohesion": 4e5, "tensile_strength": 2e5, "fracture_energy_1": 5.0, "fracture_energy_2": 50.0}
SIZE = {"wall__length": 0.24, "wall__height": 0.24, "wall__block_width": 0.12, "wall__block_height": 0.12}
HEAVIER = STEP_FACTOR**2 - 1
PRESSED = 2e4
"""Force by which a beam presses on a wall [N]."""


def pressed(inner: dict[str, Any] | None = None, **changes: Any) -> Scene:
    """A wall of a few blocks that may crack, under a driven beam."""
    beam = {"height": 0.1, "condition": "fixed-height", "force": [0, -PRESSED]}
    beam["drive"] = {"displacement": [2e-4, 0], "rate": 1e-3, "at": 0.24}
    joint = {**(inner or STRONG), "normal_stiffness": 1e13, "shear_stiffness": 4e12}
    return wall(**{**SIZE, "inner_joint": joint, "load": {"gravity": 9.81}, "beam": beam, **changes})


def heavier(scene: Scene, cells: int = 1) -> tuple[ModalWall, BlockSystem, BlockSystem]:
    """A wall in triangles, with its pieces' own masses and with heavier pieces."""
    found = modal_wall(scene, cells, cracks="blocks")
    system = system_of(found)
    return found, system, with_heavier_pieces(found, system)


def rigid_motions(found: ModalWall, system: BlockSystem, cluster: int) -> tuple[Indices, Array]:
    """Indices ``(m,)`` of the freedoms of a cluster's pieces, and the rigid motions of the whole cluster ``(m, 3)``."""
    own = system.clusters.freedom[system.clusters.cluster == cluster].astype(np.int64)
    pieces = [int(np.flatnonzero((found.rigid == freedom).all(axis=1))[0]) for freedom in own]
    x, y = found.scene.blocks.centroid[pieces].T
    each = np.tile(np.eye(3), (len(own), 1, 1))
    each[:, 0, 2], each[:, 1, 2] = -y, x
    return own.ravel(), each.reshape(-1, 3)


def masses(found: ModalWall, system: BlockSystem) -> Array:
    """Mass matrix M* of the moving freedoms, by least squares on the rigid motions of each block."""
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
    """An upper bound on the eigenvalues of the whole wall; steps are more than six times as long."""
    found, plain, system = heavier(pressed(**changes), cells)
    K, M = modal_stiffness(found).toarray(), masses(found, system)
    last = len(K) - 1
    highest = eigh(K, M, eigvals_only=True, subset_by_index=(last, last))[0]
    assert 0.4 * system.interface.frequency_squared < highest <= system.interface.frequency_squared
    assert Run(system).dt > 6 * Run(plain).dt


def test_whole_block_keeps_its_inertia() -> None:
    """Rigid motions of a block have the kinetic energy of its own masses; motions without momentum 1 + β times that."""
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
    """Kinetic energy with the diagonal masses only [J]."""
    moving = np.isfinite(system.mass)
    return float(0.5 * (system.mass[moving] * velocity[moving] ** 2).sum())


@pytest.mark.parametrize("local", [0.0, LOCAL])
def test_step_with_heavier_pieces_equals_dense_solution(local: float) -> None:
    """M* a = f without damping; with it, α resists a block's acceleration and the remaining relative acceleration."""
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
    # Random start so that nothing is at rest by symmetry: the sign of a rounding error would be arbitrary.
    v: Any = 1e-3 * np.random.default_rng(7).normal(size=len(K))
    state.velocity[moving], q = v, np.zeros(len(K))
    for _ in range(100):
        a = (load - K @ q - system.viscosity[moving] * v) / m
        beside = a - P @ a - local * np.abs(a - P @ a) * np.sign(v - P @ v)
        # The mean acceleration of a block is damped, here computed in its three rigid motions.
        whole = P @ a if local == 0.0 else damped_whole(found, system, a, v, local, number)
        v = v + run.dt * np.linalg.solve(M, m * (whole + beside - P @ beside))
        q = q + run.dt * v
    run.hold(state, 1e3, 100)
    assert np.abs(state.motion[moving] - q).max() < 1e-9 * np.abs(q).max()


def damped_whole(found: ModalWall, system: BlockSystem, a: Array, v: Array, local: float, number: Any) -> Array:
    """Piece accelerations of blocks, the translations and rotation of which are locally damped."""
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
def test_energy_balance_closes_with_heavier_pieces(local: float, viscous: float) -> None:
    """A wall that cracks under a sudden load: no energy is gained, and damping never returns energy."""
    _, _, system = heavier(pressed(WEAK), 2)
    run, state = Run(system, local=local, viscous=viscous), State.at_rest(system)
    check_damping_dissipates(run, state, 1.5e4)
    assert run.ledger(state).friction > 0


def test_statics_do_not_depend_on_heavier_pieces() -> None:
    """A bonded wall at rest has the displacements of its stiffness matrix, to 1e-6 of the largest."""
    found, _, system = heavier(pressed(joint__friction=1e6, joint__cohesion=1e12), 2)
    run, state = Run(system), State.at_rest(system)
    assert settle(run, state, 0.0, Criteria(collapse=1.0, rest=1e-9)) == "stable"
    moving = np.isfinite(system.mass)
    exact = spsolve(modal_stiffness(found).tocsc(), system.dead[moving])
    assert np.abs(state.motion[moving] - exact).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.long
def test_heavier_pieces_keep_curve_of_cracking_wall(monkeypatch: pytest.MonkeyPatch) -> None:
    """The force along the curve to 3e-3 of its maximum, well below that of the uncracked wall; in far fewer steps."""
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


def test_pieces_of_pinned_blocks_keep_their_inertia() -> None:
    """Held at a corner, a block has no rigid motion against which its pieces could be heavier."""
    found, plain, system = heavier(pressed(support__kind="pinned-corners"))
    pinned = found.rigid[found.scene.pins.block]
    assert pinned.size
    assert system.clusters.number
    assert not np.isin(system.clusters.freedom, pinned).any()
    assert np.isfinite(system.clusters.part).all()
    assert np.array_equal(system.mass[pinned], plain.mass[pinned])


def test_undriven_walls_have_no_heavier_pieces() -> None:
    """They collapse freely, in physical time."""
    scene = pressed(beam={"height": 0.1, "drive": {"force": [1, 0]}})
    found = modal_wall(scene, cracks="blocks")
    system = system_of(found)
    assert with_heavier_pieces(found, system) is system


def test_faster_drive_makes_pieces_less_heavy() -> None:
    """Waves (2236 m/s, slowed by the mass) must cross a block of 0.12 m a hundred times within a drive of 2e-4 m."""
    clusters = {}
    for rate in (1e-3, 5e-3, 0.02):
        drive = {"displacement": [2e-4, 0], "rate": rate, "at": 0.24}
        clusters[rate] = heavier(pressed(block__density=2000.0, beam__drive=drive))[2].clusters
    crossed = math.sqrt(1e10 / 2000.0) * 2e-4 / (2 * 0.12)
    assert clusters[1e-3].more == pytest.approx(HEAVIER)
    assert 1 + clusters[5e-3].more == pytest.approx((crossed / 5e-3 / 100) ** 2, rel=1e-6)
    assert not len(clusters[0.02].cluster)


def test_rigid_pieces_need_no_time_for_waves() -> None:
    drive = {"displacement": [2e-4, 0], "rate": 0.02, "at": 0.24}
    found = modal_wall(pressed(beam__drive=drive).with_block(young=None), modes=3, cracks="blocks")
    assert with_heavier_pieces(found, system_of(found)).clusters.more == pytest.approx(HEAVIER)


def test_note_on_heavier_pieces_begins_without_a_separator() -> None:
    """Pieces of three modes have no scaled masses, whose note came before it: the message had "; , pieces"."""
    scene = pressed(beam__drive={"displacement": [2e-4, 0], "rate": 0.02, "at": 0.24}).with_block(young=None)
    message = fem(scene, modes=3, cracks="blocks", budget=200).message
    assert "; pieces of blocks heavier against one another" in message


def test_walls_of_whole_blocks_have_no_heavier_pieces() -> None:
    found = modal_wall(pressed())
    system = system_of(found)
    assert with_heavier_pieces(found, system) is system
