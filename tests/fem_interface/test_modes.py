"""Modes and templates of blocks, and their kernels."""

from typing import Any

import numpy as np
import pytest

from fem_interface.joint_elements import nodal_jump
from fem_interface.modal_wall import element_runs, modal_wall
from fem_interface.modes import ModeCount, block_modes, degree_of, polynomials
from fem_interface.operators import mass_matrix, nodes_of_degree, stiffness_matrix
from fem_interface.system import system_of
from fem_interface.templates import nodes_of, triangles_of
from meshing import wall_mesh
from runningbond.dynamics import Run, State
from runningbond.joints import lobatto
from tests.walls import panel

from .walls import MORTAR, patch, triangle_wall, wall


@pytest.mark.parametrize("count", [3, 6, 9, 20, "all"])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_mass_and_stiffness_are_diagonal_in_the_modes(make: Any, count: ModeCount) -> None:
    """For elements of the modes' own degree; the wall's joints use their values at the vertices."""
    scene = make()
    found = modal_wall(scene, 1, count)
    assert scene.block.young is not None
    degree = degree_of(count)
    for template in found.templates:
        block, modes = int(template.blocks[0]), template.modes
        corners, triangles = found.mesh.points[nodes_of(found.mesh, block)], triangles_of(found.mesh, block)
        M = mass_matrix(corners, triangles, scene.block.density, scene.thickness, degree).toarray()
        K = stiffness_matrix(
            corners, triangles, scene.block.young, scene.block.poisson, scene.thickness, degree
        ).toarray()
        points = nodes_of_degree(corners, triangles, degree)
        assert (points[: len(corners)] == corners).all()
        whole = block_modes(points, K, M, np.zeros((0, len(M))), count)
        assert whole.shape.shape[1] == (len(M) if count == "all" else min(count, len(M)))
        assert whole.shape.T @ M @ whole.shape == pytest.approx(np.diag(whole.mass), abs=1e-11 * whole.mass.max())
        stiff = whole.shape.T @ K @ whole.shape
        assert np.abs(stiff - np.diag(whole.stiffness)).max() <= 1e-11 * np.abs(K).max()
        assert whole.mass[0] == pytest.approx(scene.mass[block], rel=1e-12)
        assert np.abs(modes.shape - whole.shape[: 2 * len(corners)]).max() < 1e-9 * np.abs(whole.shape).max()
        if count not in (3, "all"):  # exactly the polynomials of that degree, including all of degree 1
            span, first = polynomials(points, degree), polynomials(points, 1)
            left = whole.shape - span @ np.linalg.lstsq(span, whole.shape)[0]
            assert np.abs(left).max() < 1e-11 * np.abs(whole.shape).max()
            left = first - whole.shape @ np.linalg.lstsq(whole.shape, first)[0]
            assert np.abs(left).max() < 1e-11 * np.abs(first).max()


@pytest.mark.parametrize("count", range(7, 21))
def test_square_blocks_have_equal_flexibility_in_both_directions(count: int) -> None:
    """Of two equal modes both are taken, so a quarter turn leaves the block's flexibility unchanged."""
    side = {"wall__block_width": 0.06, "wall__length": 0.06, "wall__height": 0.06}
    found = modal_wall(panel(joint__mortar=MORTAR, block__young=1e10, **side), modes=count)
    points, modes = found.mesh.points[found.mesh.block == 0] - 0.03, found.templates[0].modes
    corner = np.flatnonzero(np.abs(points).min(axis=1) > 0.03 - 1e-9)
    points, shape = points[corner], modes.shape[:, 3:].reshape(len(points), 2, -1)[corner]
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    onto = np.argmin(np.hypot(*(points[:, None] @ quarter.T - points).transpose(2, 0, 1)), axis=1)
    turned = np.zeros_like(shape)
    turned[onto] = np.einsum("xy,nym->nxm", quarter, shape)
    flexibility, image = (s.reshape(2 * len(s), -1) / np.sqrt(modes.stiffness[3:]) for s in (shape, turned))
    assert image @ image.T == pytest.approx(flexibility @ flexibility.T, abs=1e-9 * (flexibility**2).max())


def test_modes_of_third_degree_contain_beam_bending() -> None:
    """Bending by a moment that varies with a shear force: displacements and energy to 1e-9.

    A beam with Poisson's ratio 0: u = −(M + S x / 2) x y / EI + (S / GI) (y³ / 6 − h² y / 8) and
    v = (M + S x / 3) x² / 2EI, energy ∫ (M + S x)² / 2EI + (6/5) S² / 2GA.
    """
    length, height, depth, young, moment, shear = 0.24, 0.06, 0.12, 1e9, 0.3, 2.0
    scene = panel(wall__length=length, wall__height=height, block__young=young)
    mesh = wall_mesh(scene)
    block = (mesh.points[nodes_of(mesh, 0)], triangles_of(mesh, 0))
    K = stiffness_matrix(*block, young, 0.0, depth, 3).toarray()
    M = mass_matrix(*block, 1800.0, depth, 3).toarray()
    points = nodes_of_degree(*block, 3)
    modes = block_modes(points, K, M, np.zeros((0, len(M))), 20)
    EI, GI, GA = young * depth * height**3 / 12, young / 2 * depth * height**3 / 12, young / 2 * depth * height
    x, y = (points - [length / 2, height / 2]).T
    u = -(moment + shear * x / 2) * x * y / EI + shear / GI * (y**3 / 6 - height**2 * y / 8)
    v = (moment + shear * x / 3) * x**2 / (2 * EI)
    exact = np.column_stack([u, v]).ravel()
    energy = (moment**2 * length + shear**2 * length**3 / 12) / (2 * EI) + 6 / 5 * shear**2 * length / (2 * GA)
    Q = np.linalg.lstsq(modes.shape, exact)[0]
    assert np.abs(modes.shape @ Q - exact).max() < 1e-9 * np.abs(exact).max()
    assert 0.5 * modes.stiffness @ Q**2 == pytest.approx(energy, rel=1e-9)


def test_congruent_blocks_share_a_template() -> None:
    assert len(modal_wall(wall()).templates) == 2  # whole and half blocks
    assert len(modal_wall(patch()).templates) == 4


@pytest.mark.parametrize("cells", [1, 2])
@pytest.mark.parametrize("count", [3, 6, 10, "all"])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_kernels_equal_nodal_jump_operator_and_its_transpose(make: Any, count: ModeCount, cells: int) -> None:
    found = modal_wall(make(), cells, count, lobatto(3), "joints" if count == 6 else "elements")
    system = system_of(found)
    jump = nodal_jump(found.elements, len(found.mesh.points))
    rng = np.random.default_rng(1)
    motion = rng.normal(size=len(system.mass))
    motion[np.isinf(system.mass)] = 0.0
    opening, slip, force = (
        np.zeros(system.interface.law.points),
        np.zeros(system.interface.law.points),
        np.zeros(len(motion)),
    )
    system.interface.gather(motion, tuple(system.interface.geometry), opening, slip)
    u = found.displacement(motion).ravel()
    assert opening == pytest.approx(jump.opening @ u, abs=1e-12)
    assert slip == pytest.approx(jump.slip @ u, abs=1e-12)
    normal, tangential = rng.normal(size=(2, len(opening)))
    system.interface.scatter(normal.copy(), tangential.copy(), tuple(system.interface.geometry), force)
    virtual = system.interface.area @ (normal * opening + tangential * slip)
    assert force @ motion == pytest.approx(-virtual, abs=1e-12 * np.abs(force).sum())


def test_elements_of_equal_blocks_come_in_long_runs() -> None:
    found = modal_wall(panel(joint__mortar=MORTAR, block__young=1e12))
    order, start = element_runs(found)
    assert (order == np.arange(len(order))).all()
    assert np.diff(start).sum() == len(found.mesh.joint)
    assert np.diff(start).mean() > 4
    assert (np.sort(found.elements.element) == np.arange(len(found.mesh.joint))).all()


@pytest.mark.parametrize("kind", ["corners", "pinned-corners"])
@pytest.mark.parametrize("count", [3, 6, 10, "all"])
def test_pinned_corners_do_not_move(kind: str, count: ModeCount) -> None:
    live = {"kind": "point", "at": [0.24, 0.24], "force": [0, -1]}
    scene = wall(joint__cohesion=1e5, support__kind=kind, load={"gravity": 0.0, "live": live})
    found = modal_wall(scene, 1, count)
    run = Run(system_of(found))
    state = State.at_rest(run.system)
    run.hold(state, 1e3, 2000)
    u = found.displacement(state.motion)
    for block, point, direction in zip(scene.pins.block, scene.pins.point, scene.pins.direction, strict=True):
        nodes = nodes_of(found.mesh, int(block))
        pinned = np.argmin(np.hypot(*(found.mesh.points[nodes] - point).T))
        assert abs(u[nodes][pinned] @ direction) < 1e-12 * np.abs(u).max()
    assert np.abs(u).max() > 0
    assert run.system.motion_of_blocks(state.motion).shape == (len(scene.blocks), 3)
