"""Time steps from the wall's own highest frequency: against full matrices, with unchanged dashpots."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

from dem.rigid_system import contact_points, rigid_system
from runningbond.compare import published_scene
from runningbond.dynamics import BlockSystem, Run, State, with_highest_frequency
from runningbond.joints.stiffness import joint_stiffness
from runningbond.limit.kinematics import jump_operator, mass_matrix_diagonal, movable_freedoms, pin_operator
from runningbond.scene import Scene
from tests.walls import courses, panel


def square_and_bound(system: BlockSystem) -> tuple[float | None, float]:
    """ω² that sets the time step, and the bound from each block separately [1/s²]."""
    interface = with_highest_frequency(system).interface
    return interface.closer, interface.frequency_squared


def largest_of_matrices(scene: Scene) -> float:
    """Largest ω² [1/s²] of rigid blocks from full matrices, for the motions that pins allow."""
    points, stiffness = contact_points(scene), joint_stiffness(scene.joint)
    jump = jump_operator(points, scene.blocks.centroid)
    B = np.vstack([jump.opening.toarray(), jump.slip.toarray()])
    springs = np.concatenate([stiffness.normal * points.area, stiffness.shear * points.area])
    free = movable_freedoms(scene)
    Z = null_space(np.vstack([pin_operator(scene).toarray(), np.zeros((1, B.shape[1]))])[:, free])
    M = np.diag(mass_matrix_diagonal(scene)[free])
    return float(eigh(Z.T @ B[:, free].T @ (springs[:, None] * B[:, free]) @ Z, Z.T @ M @ Z, eigvals_only=True)[-1])


MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
WALLS: dict[str, Scene] = {
    "bricks": panel(joint__mortar=MORTAR),
    "upright": panel(joint__mortar=MORTAR, wall__block_height=0.24),
    "half bricks at the ends": published_scene("wall-w1"),
    "on pins": panel(joint__mortar=MORTAR, support__kind="pinned-corners"),
    "a column": courses([[1]] * 5, joint__mortar=MORTAR),
}


@pytest.mark.parametrize("scene", WALLS.values(), ids=WALLS)
def test_frequency_is_largest_eigenvalue(scene: Scene) -> None:
    """Lanczos' method against the eigenvalues of full matrices."""
    square, bound = square_and_bound(rigid_system(scene))
    assert square is not None
    assert square == pytest.approx(largest_of_matrices(scene), rel=1e-3)
    assert square <= bound


def test_steps_are_longer_in_irregular_bond_with_same_dashpots() -> None:
    """At the same time step a run is identical to the last bit; the own step is more than 15 % longer."""
    system = rigid_system(published_scene("wall-w1"))
    closer = with_highest_frequency(system)
    assert Run(closer).dt > 1.15 * Run(system).dt
    motions = []
    for each in (system, closer):
        run, state = Run(each, dt=Run(system).dt), State.at_rest(each)
        run.hold(state, 0.3, 500)
        motions.append(state.motion)
    assert np.array_equal(motions[0], motions[1])


def test_fixed_wall_has_no_frequency() -> None:
    system = rigid_system(published_scene("wall-w1"))
    assert square_and_bound(replace(system, mass=np.full_like(system.mass, math.inf)))[0] is None
