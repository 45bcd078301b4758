"""Loads on deformable blocks, and mass scaling."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import eigsh, spsolve

from fem_interface.cracks import Cracks
from fem_interface.frequency_shift import frequency_shift, modal_stiffness
from fem_interface.loads import inner_mass
from fem_interface.mass_scaling import scaled_modes
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.dynamics import BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.growth import ramp
from runningbond.dynamics.vibrations import elastic_stiffness
from runningbond.joints import lobatto
from runningbond.joints.law import FRICTION_WORK
from runningbond.scene import Array, Closure, Scene, SceneError, Stiffness
from tests.at_length import at_length
from tests.limit.test_limit import rectangle
from tests.walls import courses, panel

from .nodal_steps import NodalSteps
from .walls import GLUE, MORTAR, joint_stiffness_of, patch, pushed, replace_blocks, triangle_wall, wall

GROWTH_TIME = 0.2
"""Time in which a load grows by a fifth of the largest load, and the weight from zero [s]."""

MAX_FREQUENCY_LOSS = 2e-3 * (1 + 1e-6)
"""Largest relative decrease of a frequency by mass scaling (with rounding)."""


def of_stiffness(name: str, young: float) -> Scene:
    """A published wall with another Young's modulus of the blocks."""
    scene = published_scene(name)
    return scene.with_block(young=young)


def _lowest_frequencies(K: csr_array, mass: Array) -> Array:
    """The twenty lowest frequencies [1/s], ascending."""
    found = eigsh(K.tocsc(), 20, diags_array(mass).tocsc(), sigma=0, return_eigenvectors=False)
    return np.sqrt(np.sort(found))


def _dense_frequencies(system: BlockSystem, count: int) -> Array:
    """The lowest frequencies [1/s], as from `vibrations`, without the mode shapes."""
    stiffness, mass = elastic_stiffness(system)
    root = 1 / np.sqrt(mass)
    square = eigh(stiffness * root[:, None] * root, eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(np.sqrt(square))


@pytest.mark.parametrize("cells", [2, 3])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_loads_lumped_at_inner_nodes_have_block_resultants(make: Any, cells: int) -> None:
    """Force and moment on every block, with no load on its outline; the effect on deformations differs."""
    found = modal_wall(make(), cells)
    consistent, lumped = (system_of(found, loads=loads) for loads in ("consistent", "inner"))
    for a, b in ((consistent.dead, lumped.dead), (consistent.live, lumped.live)):
        assert np.abs(a - b)[found.rigid].max() < 1e-12 * np.abs(a).max()
        assert np.abs(a - b).max() > 0.1 * np.abs(a).max()
    at_nodes = inner_mass(found.pieces)
    on_joint = np.unique(found.elements.nodes)
    assert not at_nodes[on_joint].any()
    moving = ~found.scene.fixed
    mass = np.bincount(found.mesh.block, at_nodes, minlength=len(moving))
    assert mass[moving] == pytest.approx(found.scene.mass[moving], rel=1e-12)
    assert not mass[~moving].any()


def test_rigid_blocks_do_not_depend_on_load_lumping() -> None:
    scene = panel(joint__mortar=MORTAR)
    consistent, lumped = (
        pushed(system_of(modal_wall(scene, modes=3), loads=loads))[0] for loads in ("consistent", "inner")
    )
    assert np.abs(consistent - lumped).max() < 1e-12 * np.abs(lumped).max()


def test_lumped_load_on_block_without_inner_nodes_is_refused() -> None:
    with pytest.raises(SceneError, match="has no inner nodes"):
        system_of(modal_wall(patch()), loads="inner")


# --- mass scaling --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("young", [5e9, 5e10, 1e12, *at_length(1e10, 2e10, 2e11)])
@pytest.mark.parametrize(("height", "modes"), [(1.44, "all"), (1.44, None), (0.72, None)])
def test_mass_scaling_keeps_the_first_twenty_frequencies(height: float, modes: ModeCount | None, young: float) -> None:
    """For the square panel and for one of half its height."""
    scene = panel(wall__height=height, joint__mortar=MORTAR, block__young=young)
    assert _largest_slowing(scene, modes) < MAX_FREQUENCY_LOSS


@pytest.mark.parametrize("young", [5e9, 5e10, 1e12, *at_length(1e10, 2e10, 1e11)])
@pytest.mark.parametrize("name", ["panel-01", "panel-04", "panel-12", "wall-w1", "wall-w2", "wall-w3"])
def test_mass_scaling_keeps_the_first_twenty_frequencies_of_published_walls(name: str, young: float) -> None:
    assert _largest_slowing(of_stiffness(name, young)) < MAX_FREQUENCY_LOSS


@pytest.mark.parametrize("young", [5e9, 2e10, 1e11, 1e12])
@pytest.mark.parametrize(("length", "height"), [(0.48, 0.24), (0.48, 0.36), (0.72, 0.36), (0.24, 1.44), (2.4, 0.12)])
def test_mass_scaling_keeps_the_first_twenty_frequencies_of_small_walls(
    length: float, height: float, young: float
) -> None:
    """Ten blocks or more: the twentieth of thirty or more rigid modes is high in the spectrum, so masses scale less."""
    scene = panel(wall__length=length, wall__height=height, joint__mortar=MORTAR, block__young=young)
    assert (~scene.fixed).sum() >= 10
    assert _largest_slowing(scene) < MAX_FREQUENCY_LOSS


@pytest.mark.parametrize("pattern", [[[1]], [[1], [1]], [[1, 1], [0.5, 1, 0.5]]])
def test_mass_scaling_lengthens_steps_of_fewer_than_ten_stiff_blocks(pattern: list[list[float]]) -> None:
    """More than six times: only two thirds of their few rigid-body frequencies have to be preserved."""
    found = modal_wall(courses(pattern, joint__mortar=MORTAR, block__young=1e12))
    scaled, plain = (scaled_modes(found, 0.05, mass_scaling=scaling) for scaling in (True, False))
    assert math.sqrt(plain.frequency_squared / scaled.frequency_squared) > 6


@pytest.mark.parametrize("young", [1e11, *at_length(1e10, 1e12)])
def test_mass_scaling_of_large_walls_is_safe_without_check(monkeypatch: pytest.MonkeyPatch, young: float) -> None:
    """Panel-07, with 588 blocks: a quarter of the largest decrease that mass scaling may cause."""
    monkeypatch.setattr("fem_interface.mass_scaling.LARGE_WALL", 0)
    assert _largest_slowing(of_stiffness("panel-07", young)) < MAX_FREQUENCY_LOSS / 4


@pytest.mark.parametrize("young", [2e9, 1e10, 1e12])
@pytest.mark.parametrize(("piers", "courses"), [(2, 1), (6, 1), (8, 1), (3, 2), (20, 2), *at_length((2, 70))])
def test_mass_scaling_keeps_the_lowest_frequencies_of_equal_piers(piers: int, courses: int, young: float) -> None:
    """Each frequency occurs once per pier; for fewer than ten blocks, two thirds of the rigid-body frequencies.

    Frequencies are those of the dense matrices.
    """
    blocks = [rectangle(0.3 * pier, 0.12 * course, 0.24, 0.12) for course in range(courses) for pier in range(piers)]
    scene = replace_blocks(panel(joint__mortar=MORTAR, block__young=young), blocks)
    found = modal_wall(scene)
    scaled = scaled_modes(found, 0.05)
    system, bare = system_of(found), system_of(found, mass_scaling=False)
    assert system.mass == pytest.approx(scaled.mass, rel=1e-12)
    exact, slowed = (_dense_frequencies(each, min(20, 2 * piers * courses)) for each in (bare, system))
    assert (1 - slowed / exact).max() < MAX_FREQUENCY_LOSS
    slowing = frequency_shift(found, len(exact), scaled.frequency_squared)
    assert slowing(scaled.mass) == pytest.approx((1 - slowed / exact).max(), abs=1e-6)


@pytest.mark.parametrize("cracks", ["joints", "blocks"])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_modal_stiffness_is_that_of_time_steps(make: Any, cracks: Cracks) -> None:
    """Assembled from nodal jumps, against the jumps that each mode causes in a time step."""
    scene = make()
    if cracks == "blocks":
        scene = replace(scene, joint_materials=(scene.joint, replace(scene.joint, name="inner_joint")))
    found = modal_wall(scene, cracks=cracks)
    of_steps, _ = elastic_stiffness(system_of(found))
    assert np.abs(modal_stiffness(found).toarray() - of_steps).max() < 1e-12 * np.abs(of_steps).max()


def test_modal_stiffness_of_closed_joints_is_their_largest() -> None:
    closing = wall().with_joint(closure=Closure(growth=1e5, stiffest=1e12), elasticity=Stiffness(1e10, 4e9))
    stiffest = wall().with_joint(elasticity=Stiffness(1e12, 4e9))
    closed = modal_stiffness(modal_wall(closing, rule=lobatto()), closed=True)
    exact = modal_stiffness(modal_wall(stiffest, rule=lobatto()))
    assert np.abs((closed - exact).toarray()).max() <= 1e-12 * np.abs(exact.toarray()).max()


def _largest_slowing(scene: Scene, modes: ModeCount | None = None) -> float:
    """Largest relative decrease of one of the first twenty frequencies by mass scaling; none increases."""
    found = modal_wall(scene, modes=modes)
    scaled = scaled_modes(found, 0.05)
    K = modal_stiffness(found)
    exact, slowed = (_lowest_frequencies(K, mass[np.isfinite(mass)]) for mass in (found.mass, scaled.mass))
    assert (slowed <= exact * (1 + 1e-9)).all()
    return float((1 - slowed / exact).max())


@pytest.mark.parametrize(("modes", "shorter"), [(6, 0.01), ("all", 0.01), (None, 0.15)])
def test_stiff_blocks_have_step_of_rigid_blocks(modes: ModeCount | None, shorter: float) -> None:
    """At 1000 GPa mass scaling gives the step of rigid blocks; without it the step is more than 15 times shorter.

    With modes that bend accurately, blocks bend at less than twice the frequency of rigid blocks on their joints, and
    the damping of such a mode reduces the step slightly.
    """
    scene = panel(joint__mortar=MORTAR, block__young=1e12)
    rigid = system_of(modal_wall(scene, modes=3)).interface.frequency_squared
    scaled = system_of(modal_wall(scene, modes=modes)).interface.frequency_squared
    assert 1 < math.sqrt(scaled / rigid) < 1 + shorter
    assert math.sqrt(system_of(modal_wall(scene), mass_scaling=False).interface.frequency_squared / rigid) > 15


@pytest.mark.parametrize("young", [1e9, 1e12])
def test_statics_do_not_depend_on_mass(young: float) -> None:
    """A bonded wall at rest has the displacements of the sparse solution, to 1e-6 of the largest."""
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


@pytest.mark.parametrize(
    ("scene", "highest"),
    [
        *at_length(
            (of_stiffness("wall-w1", 1e10), 0.54),
            (wall(1e11, wall__height=0.36), 0.5),
            (of_stiffness("wall-w1", 1e11), 0.54),
            (of_stiffness("panel-04", 1e11), 0.075),
        ),
    ],
    ids=["wall-w1, 10 GPa", "2 x 6 bricks", "wall-w1, 100 GPa", "panel-04, 100 GPa"],
)
def test_mass_scaling_keeps_displacements_of_pushed_wall(scene: Scene, highest: float) -> None:
    """Under loads growing slowly to 85 % of collapse, with open and slipped joints: the same as without, to 0.2 %.

    Suddenly applied loads, including the weight, would make joints slip in another order for each time step.
    """
    rows = []
    loads = np.linspace(0.0, highest, 6)
    for on in (True, False):
        run = Run(system_of(modal_wall(scene), mass_scaling=on))
        state, criteria = State.at_rest(run.system), Criteria(collapse=1.0, rest=1e-6, budget=20_000_000)
        pieces = round(GROWTH_TIME / run.dt / 20)
        for piece in range(pieces):
            run.hold(state, 0.0, 20, dead=(piece + 0.5) / pieces)
        assert settle(run, state, 0.0, criteria) == "stable"
        row = [run.system.control @ state.motion]
        for before, multiplier in pairwise(loads):
            ramp(run, state, before, multiplier, round(GROWTH_TIME / run.dt))
            assert settle(run, state, multiplier, criteria) == "stable"
            row.append(run.system.control @ state.motion)
        rows.append(row)
        opening, _, _, _ = run.tractions(state)
        assert (opening > 0).any()
        assert state.history[FRICTION_WORK].max() > 0
    assert rows[0] == pytest.approx(rows[1], rel=2e-3)


@pytest.mark.parametrize("young", [1e10, 1e12])
def test_statics_of_default_modes_do_not_depend_on_mass_scaling(young: float) -> None:
    """A bonded wall at rest with and without mass scaling, to 1e-6 of the largest displacement."""
    motions = []
    for on in (True, False):
        run = Run(system_of(modal_wall(wall(young, joint={**GLUE})), mass_scaling=on))
        state = State.at_rest(run.system)
        assert settle(run, state, 0.7, Criteria(collapse=1.0, rest=1e-9, budget=20_000_000)) == "stable"
        motions.append(state.motion)
    assert motions[0] == pytest.approx(motions[1], abs=1e-6 * np.abs(motions[1]).max())
