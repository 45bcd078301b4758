"""Time steps by a wall's own highest frequency: that of its matrices, and dashpots as before."""

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
    """ω² that time steps of a system go by, and the bound from each block alone [1/s²]."""
    interface = with_highest_frequency(system).interface
    return interface.closer, interface.frequency_squared


def largest_of_matrices(scene: Scene) -> float:
    """Largest ω² [1/s²] of rigid blocks by full matrices, in the motions that leave pins alone."""
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
def test_it_is_the_highest_of_all_vibrations(scene: Scene) -> None:
    """By Lanczos' method against the eigenvalues of full matrices."""
    square, bound = square_and_bound(rigid_system(scene))
    assert square is not None
    assert square == pytest.approx(largest_of_matrices(scene), rel=1e-3)
    assert square <= bound


def test_steps_are_longer_where_joints_do_not_line_up_and_dashpots_stay() -> None:
    """At one time step a run is the same to the last bit; by itself it takes a sixth less."""
    system = rigid_system(published_scene("wall-w1"))
    closer = with_highest_frequency(system)
    assert Run(closer).dt > 1.15 * Run(system).dt
    motions = []
    for each in (system, closer):
        run, state = Run(each, dt=Run(system).dt), State.at_rest(each)
        run.hold(state, 0.3, 500)
        motions.append(state.motion)
    assert np.array_equal(motions[0], motions[1])


def test_what_does_not_move_has_none() -> None:
    system = rigid_system(published_scene("wall-w1"))
    assert square_and_bound(replace(system, mass=np.full_like(system.mass, math.inf)))[0] is None
