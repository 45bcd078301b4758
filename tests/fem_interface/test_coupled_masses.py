"""Soft blocks with masses coupled across their joints: statics, frequencies, steps and collapse."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from fem_interface.coupled_masses import with_coupled_masses
from fem_interface.frequency_shift import modal_stiffness
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.dynamics import BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.run import CALMING
from runningbond.scene import Array, Closure, Indices, Scene, Stiffness
from tests.walls import courses, panel

from .walls import GLUE, MORTAR, check_damping_dissipates, patch, wall

SOFT = [5e8, 2e9, 1e10]


def coupled(scene: Scene) -> tuple[ModalWall, BlockSystem]:
    """A wall, and its system with coupled masses."""
    found = modal_wall(scene)
    system = with_coupled_masses(found, system_of(found))
    assert len(system.coupling.freedom) == 3 * (~scene.fixed).sum()
    return found, system


def masses(system: BlockSystem) -> tuple[Indices, Array]:
    """Indices of the moving freedoms, and their mass matrix."""
    moving = np.flatnonzero(np.isfinite(system.mass))
    M = np.diag(system.mass)
    M[np.ix_(system.coupling.freedom, system.coupling.freedom)] += system.coupling.inertia
    return moving, M[np.ix_(moving, moving)]


@pytest.mark.parametrize("young", SOFT)
@pytest.mark.parametrize("name", ["wall", "patch", "wall-w1"])
def test_coupled_masses_bound_frequency_and_reduce_steps_per_period(name: str, young: float) -> None:
    """An upper bound on the eigenvalues of the whole wall; far fewer steps than with mass scaling by modes."""
    scene = {"wall": wall(), "patch": patch(), "wall-w1": published_scene("wall-w1")}[name].with_block(young=young)
    found, system = coupled(scene)
    K, (_, M) = modal_stiffness(found).toarray(), masses(system)
    last = len(K) - 1
    slowest, fastest = (eigh(K, M, eigvals_only=True, subset_by_index=(k, k))[0] for k in (0, last))
    assert 0.7 * system.interface.frequency_squared < fastest <= system.interface.frequency_squared
    steps = 2 * np.pi / np.sqrt(slowest) / Run(system, local=CALMING).dt
    plain = system_of(found)
    first = eigh(K, np.diag(plain.mass[np.isfinite(plain.mass)]), eigvals_only=True, subset_by_index=(0, 0))[0]
    assert slowest <= first * (1 + 1e-9)
    assert steps < 2 * np.pi / np.sqrt(first) / Run(plain).dt / 2
    assert steps < 300


def test_coupled_masses_bound_frequency_of_closed_joints() -> None:
    """The step allows for joints at their largest stiffness, a hundred times that of the unloaded joints."""
    scene = wall(5e8).with_joint(closure=Closure(growth=1e5, stiffest=1e12), elasticity=Stiffness(1e10, 4e9))
    found, system = coupled(scene)
    K, (_, M) = modal_stiffness(found, closed=True).toarray(), masses(system)
    fastest = eigh(K, M, eigvals_only=True, subset_by_index=(len(K) - 1, len(K) - 1))[0]
    assert fastest <= system.interface.frequency_squared


@pytest.mark.parametrize("young", SOFT)
def test_statics_do_not_depend_on_coupled_masses(young: float) -> None:
    """A bonded wall at rest has the displacements of its stiffness matrix, to 1e-6 of the largest."""
    found, system = coupled(wall(young, joint={**GLUE}))
    run, state = Run(system, local=CALMING), State.at_rest(system)
    assert settle(run, state, 0.7, Criteria(collapse=1.0, rest=1e-9)) == "stable"
    moving, _ = masses(system)
    exact = spsolve(modal_stiffness(found).tocsc(), (system.dead + 0.7 * system.live)[moving])
    assert np.abs(state.motion[moving] - exact).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.parametrize("local", [0.0, CALMING])
def test_coupled_step_equals_dense_solution(local: float) -> None:
    """M a = f − α m |M⁻¹ f| sign v while the acceleration changes against the velocity, for a hundred steps."""
    found, system = coupled(wall(1e9, joint={**GLUE}))
    run, state = Run(system, local=local, viscous=0.0), State.at_rest(system)
    moving, M = masses(system)
    K, load = modal_stiffness(found).toarray(), (system.dead + 0.7 * system.live)[moving]
    joined, own = np.isin(moving, system.coupling.freedom), system.mass[moving]
    q: Any = np.zeros(len(K))
    v: Any = q
    last: Any = q
    for _ in range(100):
        f = load - K @ q - system.viscosity[moving] * v
        free = np.linalg.solve(M, f)
        against = np.where(joined, v * (free - last) < 0, True)
        v = v + run.dt * np.linalg.solve(M, f - local * own * np.abs(free) * np.sign(v) * against)
        q, last = q + run.dt * v, free
    run.hold(state, 0.7, 100)
    assert np.abs(state.motion[moving] - q).max() < 1e-9 * np.abs(q).max()


@pytest.mark.parametrize(("local", "viscous"), [(0.0, 0.0), (CALMING, 0.1)])
@pytest.mark.parametrize("make", [wall, patch])
def test_energy_balance_closes_with_coupled_masses(make: Any, local: float, viscous: float) -> None:
    """A dry wall under a sudden load: no energy is gained, and damping never returns energy."""
    _, system = coupled(make().with_block(young=1e9))
    check_damping_dissipates(Run(system, local=local, viscous=viscous), State.at_rest(system), 0.2)


def test_coupled_masses_refuse_displacement_control() -> None:
    """Displacement control needs the diagonal masses of the modes."""
    _, system = coupled(wall().with_block(young=2e9))
    with pytest.raises(ValueError, match="in common"):
        Run(system).drive(State.at_rest(system), 1.0, 1)


@pytest.mark.parametrize("name", ["wall-w1", "wall-w2", "wall-w3", "panel-04", "point-load-1"])
def test_published_walls_have_no_coupled_masses(name: str) -> None:
    """Their blocks are stiffer than their joints: a period takes about as many steps as for rigid blocks."""
    found = modal_wall(published_scene(name))
    system = system_of(found)
    assert with_coupled_masses(found, system) is system


def test_soft_blocks_without_joints_fall() -> None:
    """Two blocks apart, each held at a corner; frequencies of the joints that they do not have were divided by."""
    soft = {"density": 1.0, "young": 1e7, "poisson": 0.0}
    outcome = fem(courses([[1, -0.5, 1]], block=soft, joint__mortar=MORTAR, support__kind="corners"), budget=1000)
    assert outcome.status == "infeasible"


def test_large_walls_have_no_coupled_masses(monkeypatch: pytest.MonkeyPatch) -> None:
    """The dense mass matrix couples all blocks, at a cost that grows with the square of their number."""
    found = modal_wall(wall(1e9))
    system = system_of(found)
    monkeypatch.setattr("fem_interface.coupled_masses.MOST_BLOCKS", 2)
    assert with_coupled_masses(found, system) is system


@pytest.mark.long
def test_soft_and_stiff_blocks_have_same_limit_load() -> None:
    """A pier one block wide has the same limit load, to the width of its brackets; the message reports the coupling."""
    pier = panel(wall__length=0.24, wall__height=0.36, joint__mortar=MORTAR)
    soft, stiff = (fem(pier.with_block(young=young), 0.03) for young in (1e9, 1e12))
    low, high = np.array([[found.lower, found.upper] for found in (soft, stiff)], dtype=float).T
    assert low.max() <= high.min()
    assert "coupled across joints" in soft.message
