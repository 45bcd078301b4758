"""Loads of deformable blocks, and masses that are scaled."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import eigsh, spsolve

from dynamics import Criteria, Run, State, settle
from fem_interface.loads import inner_mass
from fem_interface.modes import ModeCount
from fem_interface.runs import modal_wall
from fem_interface.stable import scaled_modes
from fem_interface.system import fem_system, system_of
from scene import Array, SceneError
from tests.fem_interface.nodal_steps import NodalSteps
from tests.fem_interface.walls import (
    GLUE,
    MORTAR,
    joint_stiffness_of,
    modal_stiffness,
    patch,
    pushed,
    triangle_wall,
    wall,
)
from tests.walls import panel


def _lowest_frequencies(K: csr_array, mass: Array) -> Array:
    """Twenty of them [1/s], ascending."""
    found = eigsh(K.tocsc(), 20, diags_array(mass).tocsc(), sigma=0, return_eigenvectors=False)
    return np.sqrt(np.sort(found))


@pytest.mark.parametrize("cells", [2, 3])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_loads_lumped_at_inner_nodes_have_the_resultant_of_each_block(make: Any, cells: int) -> None:
    """Force and moment of every block, and nothing on its outline; what they do to its shape is another matter."""
    found = modal_wall(make(), cells)
    consistent, lumped = (system_of(found, loads=loads) for loads in ("consistent", "inner"))
    for a, b in ((consistent.dead, lumped.dead), (consistent.live, lumped.live)):
        assert np.abs(a - b)[found.rigid].max() < 1e-12 * np.abs(a).max()
        assert np.abs(a - b).max() > 0.1 * np.abs(a).max()
    at_nodes = inner_mass(found.pieces)
    on_joint = np.unique(found.interface.nodes)
    assert not at_nodes[on_joint].any()
    moving = ~found.scene.fixed
    mass = np.bincount(found.mesh.block, at_nodes, minlength=len(moving))
    assert mass[moving] == pytest.approx(found.scene.mass[moving], rel=1e-12)
    assert not mass[~moving].any()


def test_rigid_blocks_do_not_feel_where_their_loads_act() -> None:
    scene = panel(joint__mortar=MORTAR)
    consistent, lumped = (pushed(fem_system(scene, modes=3, loads=loads))[0] for loads in ("consistent", "inner"))
    assert np.abs(consistent - lumped).max() < 1e-12 * np.abs(lumped).max()


def test_a_block_without_inner_nodes_bears_no_lumped_load() -> None:
    with pytest.raises(SceneError, match="has no inner nodes"):
        fem_system(patch(), loads="inner")


# --- mass scaling --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("young", [5e9, 5e10, 2e11, 1e12])
@pytest.mark.parametrize(("height", "modes"), [(1.44, "all"), (1.44, None), (0.72, None)])
def test_mass_scaling_keeps_the_first_twenty_frequencies(height: float, modes: ModeCount | None, young: float) -> None:
    """Of the square panel and of one half as high, within 2e-3."""
    found = modal_wall(panel(wall__height=height, joint__mortar=MORTAR, block__young=young), modes=modes)
    scaled = scaled_modes(found, 0.05)
    K = modal_stiffness(found)
    exact, slowed = (_lowest_frequencies(K, mass[np.isfinite(mass)]) for mass in (found.mass, scaled.mass))
    assert slowed == pytest.approx(exact, rel=2e-3)
    assert (slowed <= exact * (1 + 1e-9)).all()


@pytest.mark.parametrize(("modes", "shorter"), [(6, 0.01), ("all", 0.01), (None, 0.15)])
def test_stiff_blocks_take_the_step_of_rigid_ones(modes: ModeCount | None, shorter: float) -> None:
    """At 1000 GPa mass scaling gives the step of rigid blocks; without it it is twenty times shorter.

    Where blocks bend as they should they do so at less than twice the frequency of rigid ones on their joints, and
    the damping of such a mode costs a little of the step.
    """
    scene = panel(joint__mortar=MORTAR, block__young=1e12)
    rigid = fem_system(scene, modes=3).block_frequency_squared
    scaled = fem_system(scene, modes=modes).block_frequency_squared
    assert 1 < math.sqrt(scaled / rigid) < 1 + shorter
    assert math.sqrt(fem_system(scene, mass_scaling=False).block_frequency_squared / rigid) > 15


@pytest.mark.parametrize("young", [1e9, 1e12])
def test_statics_do_not_feel_the_mass(young: float) -> None:
    """A glued wall at rest has the displacements of the sparse solution, to 1e-6 of the largest."""
    scene = wall(young, joint={**GLUE})
    found = modal_wall(scene, modes="all")
    system = system_of(found)
    run = Run(system)
    state = State.at_rest(system)
    assert settle(run, state, 0.7, Criteria(collapse=1.0, rest=1e-9)) == "stable"
    nodal = NodalSteps(found, system)
    K = csr_array(nodal.K + joint_stiffness_of(system, nodal.opening, nodal.slip))
    exact = spsolve(K.tocsc(), nodal.dead + 0.7 * nodal.live)
    u = found.displacement(state.motion).ravel()[nodal.free]
    assert np.abs(u - exact).max() < 1e-6 * np.abs(exact).max()


def test_mass_scaling_leaves_a_pushed_wall_where_it_is() -> None:
    """Displacement under increasing loads, joints opening and sliding: with and without it the same to 0.2 %."""
    scene = wall(1e11, wall__height=0.36)
    rows = []
    for on in (True, False):
        run = Run(fem_system(scene, mass_scaling=on))
        state = State.at_rest(run.system)
        row = []
        for multiplier in (0.0, 0.1, 0.2, 0.3):
            assert settle(run, state, multiplier, Criteria(collapse=1.0, rest=1e-6, budget=20_000_000)) == "stable"
            row.append(run.system.control @ state.motion)
        rows.append(row[1:])
    assert rows[0] == pytest.approx(rows[1], rel=2e-3)
