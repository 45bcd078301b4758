"""Test walls of deformable blocks, and measurements on them."""

from typing import Any

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import csr_array

from fem_interface.modes import rigid_motions
from fem_interface.operators import mass_matrix, stiffness_matrix
from fem_interface.templates import nodes_of, triangles_of
from meshing import WallMesh
from runningbond.dynamics import BlockSystem, Run, State
from runningbond.joints.law import FRICTION_WORK
from runningbond.scene import Array, BlockMaterial, JointMaterial, Load, Scene, Stiffness, build_scene
from tests.walls import panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
GLUE = {"friction": 0.6, "cohesion": 1e12, "mortar": MORTAR}


def wall(young: float = 1e10, poisson: float = 0.2, **changes: Any) -> Scene:
    """A small wall with deformable blocks."""
    size = {"wall__length": 0.48, "wall__height": 0.24}
    return panel(**{**size, "joint__mortar": MORTAR, "block__young": young, "block__poisson": poisson, **changes})


def patch() -> Scene:
    """Four irregular quadrilaterals around one point, on a base: every block has its own shape."""
    x = np.array([[0.0, 0.6, 1.0], [0.0, 0.37, 1.0], [0.0, 0.55, 1.0]])
    y = np.array([[0.0, 0.0, 0.0], [0.45, 0.62, 0.5], [1.0, 1.0, 1.0]])
    corner = np.stack([x, y], axis=2)
    quads = [corner[[i, i, i + 1, i + 1], [j, j + 1, j + 1, j]] for i in (0, 1) for j in (0, 1)]
    return build_scene(
        "patch",
        quads,
        thickness=0.1,
        block=BlockMaterial(2000.0, 3e9, 0.3),
        joint=JointMaterial(0.6, 1e3, 1e3, Stiffness(1e11, 4e10)),
        load=Load(),
    )


def triangle_wall() -> Scene:
    """A triangular block leaning on a square one."""
    blocks = [np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), np.array([[1.0, 0], [2, 0], [1, 0.8]])]
    return replace_blocks(patch(), blocks)


def replace_blocks(scene: Scene, blocks: list[Array]) -> Scene:
    return build_scene(
        "blocks", blocks, thickness=scene.thickness, block=scene.block, joint=scene.joint, load=scene.load
    )


def rigid_of_nodes(mesh: WallMesh, scene: Scene) -> Array:
    """Nodal displacements of rigid motions of all blocks, ``(2 nn, 3 nb)``."""
    parts = []
    for block in range(len(scene.blocks)):
        points, triangles = mesh.points[nodes_of(mesh, block)], triangles_of(mesh, block)
        parts.append(rigid_motions(points, mass_matrix(points, triangles, 1.0, 1.0).toarray()))
    return np.asarray(block_diag(*parts))


def whole(mesh: WallMesh, scene: Scene) -> tuple[csr_array, csr_array]:
    """Stiffness and mass matrices of all blocks, assembled at once."""
    material = scene.block
    assert material.young is not None
    K = stiffness_matrix(mesh.points, mesh.triangles, material.young, material.poisson, scene.thickness)
    return K, mass_matrix(mesh.points, mesh.triangles, material.density, scene.thickness)


def check_damping_dissipates(run: Run, state: State, load: float) -> None:
    """Follow a sudden load for 4000 steps: damping never returns energy, and less than 2 % of it is unaccounted for."""
    damped = 0.0
    for _ in range(40):
        run.hold(state, load, 100, given=0.0)
        ledger = run.ledger(state)
        assert ledger.damped >= damped * (1 - 1e-12)
        damped = ledger.damped
    assert ledger.kinetic >= 0
    assert run.unaccounted(state) < 0.02


def joint_stiffness_of(system: BlockSystem, opening: Any, slip: Any) -> csr_array:
    k_n, k_t = (
        system.interface.law.normal_stiffness * system.interface.area,
        system.interface.law.shear_stiffness * system.interface.area,
    )
    return csr_array(opening.T @ (opening * k_n[:, None]) + slip.T @ (slip * k_t[:, None]))


def check_dissipation(run: Run, steps: int) -> State:
    """Increase the load until the wall collapses: no point returns dissipated work, and the energy balance closes."""
    state = State.at_rest(run.system)
    spent, damped = state.history[FRICTION_WORK].copy(), 0.0
    for k in range(60):
        run.hold(state, 0.05 * k, steps)
        assert (state.history[FRICTION_WORK] >= spent - 1e-12 * np.abs(spent).max()).all()
        spent = state.history[FRICTION_WORK].copy()
        ledger = run.ledger(state)
        assert ledger.damped >= damped
        damped = ledger.damped
        assert np.isfinite(state.motion).all()
    assert abs(ledger.residual) < 0.01 * abs(ledger.external)
    return state


def pushed(system: BlockSystem) -> tuple[Array, State]:
    """Motion of the blocks ``(nb, 3)`` after 100 steps without local damping under 0.7 times the live load."""
    run, state = Run(system, local=0.0), State.at_rest(system)
    run.hold(state, 0.7, 100)
    return run.system.motion_of_blocks(state.motion), state
