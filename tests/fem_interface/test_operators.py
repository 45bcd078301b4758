"""Operators of deformable blocks: against rigid kinematics and scikit-fem."""

import math
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import null_space
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementTriP1, MeshTri

from dem.rigid_system import contact_points
from fem_interface.joint_elements import joint_elements, nodal_jump
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import rigid_motions
from fem_interface.operators import lumped_mass, mass_matrix, stiffness_matrix
from fem_interface.templates import nodes_of, triangles_of
from meshing import wall_mesh
from runningbond.joints import JointPoints, Rule, gauss, lobatto, wall_points
from runningbond.limit.kinematics import jump_operator, mass_matrix_diagonal
from runningbond.scene import Array, SceneError
from tests.walls import courses, panel

from .walls import MORTAR, patch, replace_blocks, rigid_of_nodes, triangle_wall, wall, whole


@st.composite
def course_patterns(draw: st.DrawFn) -> list[list[float]]:
    """Walls three blocks long, of whole, half and one-and-a-half blocks."""
    pattern = []
    for _ in range(draw(st.integers(2, 4))):
        course: list[float] = []
        while (left := 3 - sum(course)) > 0:
            course.append(draw(st.sampled_from([w for w in (0.5, 1, 1.5) if w <= left])))
        pattern.append(course)
    return pattern


@given(
    pattern=course_patterns(),
    inset=st.sampled_from([0.0, 0.02]),
    cells=st.sampled_from([1, 2]),
    on=st.sampled_from(["elements", "joints"]),
)
@settings(max_examples=30, derandomize=True)
def test_rigid_motions_give_jumps_of_rigid_blocks(
    pattern: list[list[float]], inset: float, cells: int, on: Literal["elements", "joints"]
) -> None:
    """B_fem R = B_dem at the same points, and RᵀMR = diag(m, m, J) with the consistent mass, K R = 0; all to 1e-12."""
    scene = courses(pattern, joint__mortar=MORTAR, joint__inset=inset, block__young=1e10, block__poisson=0.3)
    found = modal_wall(scene, cells, points=on)
    mesh, points = found.mesh, found.elements.points
    R = rigid_of_nodes(mesh, scene)
    ours, rigid = nodal_jump(found.elements, len(mesh.points)), jump_operator(points, scene.blocks.centroid)
    assert np.abs(ours.opening @ R - rigid.opening.toarray()).max() < 1e-12
    assert np.abs(ours.slip @ R - rigid.slip.toarray()).max() < 1e-12

    K, M = whole(mesh, scene)
    inertia = R.T @ (M @ R)
    exact = mass_matrix_diagonal(scene)
    free = np.flatnonzero(np.repeat(~scene.fixed, 3))
    assert np.abs(inertia - np.diag(exact))[np.ix_(free, free)].max() < 1e-12 * exact[free].max()
    assert np.diag(inertia)[free] == pytest.approx(exact[free], rel=1e-12)
    assert np.abs(K @ R).max() < 1e-12 * np.abs(K.data).max()


def same_points(ours: JointPoints, theirs: JointPoints) -> bool:
    """Whether two sets of points are equal to 1e-12, in any order."""

    def rows(points: JointPoints) -> Array:
        found = np.column_stack(
            [points.joint, points.block, points.position, points.normal, points.tangent, points.area]
        )
        return found[np.lexsort(np.round(found[:, [4, 3, 0]].T, 9))]

    return len(ours) == len(theirs) and bool(np.abs(rows(ours) - rows(theirs)).max() < 1e-12)


@pytest.mark.parametrize("changes", [{}, {"joint__inset": 0.01}])
def test_one_element_per_joint_has_points_of_rigid_blocks(changes: dict[str, Any]) -> None:
    scene = wall(support__kind="fixed-first-course", **changes)
    assert same_points(modal_wall(scene).elements.points, contact_points(scene))


@pytest.mark.parametrize("cells", [1, 2, 3])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_points_on_joints_are_those_of_rigid_blocks(make: Any, cells: int) -> None:
    """For any mesh and support, also with an inset wider than an element."""
    scene = make()
    assert same_points(modal_wall(scene, cells, 3, points="joints").elements.points, contact_points(scene))
    inset = 0.45 * scene.joints.length.min()
    scene = scene.with_joint(inset=inset)
    for rule in (lobatto(3), gauss(2)):
        found = modal_wall(scene, cells, 3, rule, "joints").elements
        assert same_points(found.points, wall_points(scene, rule))
        listed = found.points.joint[found.listing]
        assert (listed == np.sort(listed)).all()
        along = (found.points.position * found.points.tangent).sum(axis=1)[found.listing]
        assert (np.diff(along)[np.diff(listed) == 0] > 0).all()


def test_unknown_point_placement_is_refused() -> None:
    with pytest.raises(ValueError, match="points = 'nodes'"):
        modal_wall(wall(), points="nodes")  # type: ignore[arg-type]


@pytest.mark.parametrize("on", ["elements", "joints"])
@pytest.mark.parametrize("rule", [lobatto(), lobatto(3), gauss(1), gauss(2), gauss(3)])
@pytest.mark.parametrize("inset", [0.0, 0.004])
@pytest.mark.parametrize("make", [wall, patch, triangle_wall])
def test_jumps_equal_scikit_fem_interpolation(
    make: Any, inset: float, rule: Rule, on: Literal["elements", "joints"]
) -> None:
    """Displacements of both sides, evaluated in the blocks' own meshes, for each rule."""
    scene = make()
    scene = scene.with_joint(inset=inset)
    found = modal_wall(scene, 2, 3, rule, on)
    mesh, points = found.mesh, found.elements.points
    assert points.area.sum() == pytest.approx(scene.thickness * scene.joints.length.sum(), rel=1e-12)
    u = np.random.default_rng(0).normal(size=mesh.points.shape)
    jump = nodal_jump(found.elements, len(mesh.points))
    expected = np.zeros((len(points), 2))
    for block in range(len(scene.blocks)):
        nodes = nodes_of(mesh, block)
        own = MeshTri(mesh.points[nodes].T.copy(), triangles_of(mesh, block).T.copy())
        centre = mesh.points[nodes].mean(axis=0)
        for side, sense in ((0, -1), (1, 1)):
            here = np.flatnonzero(points.block[:, side] == block)
            inside = points.position[here] + 1e-10 * (centre - points.position[here])
            if len(here):
                expected[here] += sense * (Basis(own, ElementTriP1()).probes(inside.T) @ u[nodes])
    assert jump.opening @ u.ravel() == pytest.approx((expected * points.normal).sum(axis=1), abs=1e-7)
    assert jump.slip @ u.ravel() == pytest.approx((expected * points.tangent).sum(axis=1), abs=1e-7)


def test_an_inset_wider_than_a_joint_element_is_refused() -> None:
    scene = wall(joint__inset=0.02)
    modal_wall(scene, 1)
    with pytest.raises(SceneError, match="joint.inset"):
        modal_wall(scene, 8)


@pytest.mark.parametrize("strain", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.3, -1, 0.7)])
def test_patch_of_irregular_blocks_carries_uniform_strain_exactly(strain: tuple[float, float, float]) -> None:
    """Welded together and held along the outline, they have uniform stress everywhere, to 1e-12."""
    scene = patch()
    mesh = wall_mesh(scene)
    moving = ~scene.fixed[mesh.block]
    assert np.flatnonzero(moving).max() < moving.sum()  # the ground's nodes come last
    points = mesh.points[moving]
    triangles = mesh.triangles[~scene.fixed[mesh.triangle_block]]
    young, poisson = 3e9, 0.3
    K = stiffness_matrix(points, triangles, young, poisson, scene.thickness)
    _, place = np.unique(np.round(points, 9), axis=0, return_inverse=True)
    place = place.ravel()
    weld = csr_array((np.ones(len(points)), (np.arange(len(points)), place)))
    both = csr_array(np.kron(weld.toarray(), np.eye(2)))
    e_x, e_y, e_xy = strain
    exact = (points @ [[e_x, e_xy], [e_xy, e_y]]).ravel()
    outer = np.asarray(np.abs(points - 0.5).max(axis=1) > 0.5 - 1e-9)
    assert 0 < (~outer).sum() < len(points)
    at = np.zeros(weld.shape[1], dtype=np.int64)
    at[place] = np.arange(len(points))
    exact_welded = exact.reshape(-1, 2)[at].ravel()
    free = np.repeat(~outer[at], 2)
    welded = csr_array(both.T @ K @ both)
    u = exact_welded.copy()
    u[free] = spsolve(welded[free][:, free].tocsc(), -(welded[free][:, ~free] @ exact_welded[~free]))
    displacement = (both @ u).reshape(-1, 2)
    edge = points[triangles[:, 1:]] - points[triangles[:, :1]]
    change = displacement[triangles[:, 1:]] - displacement[triangles[:, :1]]
    gradient = np.linalg.solve(edge, change).transpose(0, 2, 1)
    found = np.column_stack([gradient[:, 0, 0], gradient[:, 1, 1], (gradient[:, 0, 1] + gradient[:, 1, 0]) / 2])
    C = young / (1 - poisson**2) * np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, 1 - poisson]])
    assert np.abs((found - strain) @ C).max() < 1e-12 * young


def test_lumped_mass_is_exact_in_translation_and_too_much_in_rotation() -> None:
    scene = wall()
    mesh = wall_mesh(scene)
    points, triangles = mesh.points[nodes_of(mesh, 0)], triangles_of(mesh, 0)
    M = mass_matrix(points, triangles, 1800.0, 0.12).toarray()
    R = rigid_motions(points, M)
    lumped = R.T @ np.diag(lumped_mass(points, triangles, 1800.0, 0.12)) @ R
    exact = R.T @ M @ R
    assert np.diag(lumped)[:2] == pytest.approx(np.diag(exact)[:2], rel=1e-12)
    assert lumped[2, 2] > 1.15 * exact[2, 2]


BRICK, DEPTH, YOUNG = (0.24, 0.06), 0.12, 1e9


def _beam(height: float) -> float:
    """Deflection of a brick 240 mm long as a Timoshenko cantilever under a force of 1 N [m]."""
    length = BRICK[0]
    bending = length**3 / (3 * YOUNG * DEPTH * height**3 / 12)
    return bending + length / (5 / 6 * YOUNG / 2 * DEPTH * height)


def test_bending_error_of_constant_strain_falls_with_the_mesh(capsys: pytest.CaptureFixture[str]) -> None:
    """A brick as a cantilever, with all modes of its triangles: below 20 % from four cells on, order 2."""
    length, height = BRICK
    scene = panel(wall__length=length, wall__height=height)
    errors = []
    for cells in (1, 2, 4, 8):
        mesh = wall_mesh(scene, cells)
        points, triangles = mesh.points[nodes_of(mesh, 0)], triangles_of(mesh, 0)
        K = stiffness_matrix(points, triangles, YOUNG, 0.0, DEPTH).tocsr()
        free = np.repeat(points[:, 0] > 1e-9, 2)
        tip = np.flatnonzero(points[:, 0] > length - 1e-9)
        force = np.zeros((len(points), 2))
        inner = (points[tip, 1] > 1e-9) & (points[tip, 1] < height - 1e-9)
        force[tip, 1] = np.where(inner, 1.0, 0.5) / cells
        u = np.zeros(2 * len(points))
        u[free] = spsolve(K[free][:, free].tocsc(), force.ravel()[free])
        errors.append(1 - u.reshape(-1, 2)[tip, 1].mean() / _beam(height))
    with capsys.disabled():
        print("\nbending error of a brick, 1, 2, 4, 8 cells high:", " ".join(f"{error:.1%}" for error in errors))
    assert errors[2] < 0.2
    assert math.log2(errors[2] / errors[3]) > 1.7


@pytest.mark.parametrize(("height", "most"), [(BRICK[1], 0.06), (2 * BRICK[1], 0.15)])
def test_bending_error_of_a_brick_on_the_default_mesh(
    height: float, most: float, capsys: pytest.CaptureFixture[str]
) -> None:
    """Held and loaded at the ends of its head joints, with the modes that `fem` uses."""
    size = {"wall__block_height": height, "wall__length": BRICK[0], "wall__height": height}
    scene = panel(**size, joint__mortar=MORTAR, block__young=YOUNG)
    errors = {}
    for count in (6, None, 20):
        found = modal_wall(scene, modes=count)
        points, modes = found.mesh.points, found.templates[0].modes
        shape = modes.shape[: 2 * len(points)].reshape(-1, 2, len(modes.mass))
        corner = np.flatnonzero(np.abs(shape[:, 0, 2]) > height / 2 - 1e-9)
        left, right = (
            corner[side(points[corner, 0] - BRICK[0] / 2) > BRICK[0] / 2 - 1e-9] for side in (np.negative, abs)
        )
        held, tip = shape[left].reshape(4, -1), shape[np.setdiff1d(right, left), 1].mean(axis=0)
        errors[count] = 1 - tip @ _held_response(modes.stiffness, held, tip) / _beam(height)
    printed = " ".join(f"{error:.1%}" for error in errors.values())
    with capsys.disabled():
        print(f"\nbending error of a brick of 240 × {1000 * height:.0f} mm, 6, 10, 20 modes: {printed}")
    assert 0 < errors[20] < 0.01 < errors[None] < most


def _held_response(stiffness: Array, held: Array, force: Array) -> Array:
    """Modal coordinates ``(m,)`` under a modal force, with some displacements ``(n, m)`` held at zero."""
    free = null_space(held)
    return np.asarray(free @ np.linalg.solve(free.T @ (stiffness[:, None] * free), free.T @ force))


@pytest.mark.parametrize("share", [-0.45, 0.5, 0.99])
def test_gap_of_slanted_joint_may_equal_contact_tolerance(share: float) -> None:
    """Gap measured across the joint; vertically it is larger. The weights are those without a gap."""
    lower = np.array([[0.0, 0.0], [0.2, 0.0], [0.2, 0.4], [0.0, 0.2]])
    upper = np.array([[0.0, 0.2], [0.2, 0.4], [0.2, 0.6], [0.0, 0.6]])
    shut = replace_blocks(patch(), [lower, upper])
    apart = share * shut.blocks.tolerance * math.sqrt(2)
    scene = replace_blocks(patch(), [lower, upper + [0.0, apart]])
    found, exact = (joint_elements(wall_mesh(each), each) for each in (scene, shut))
    assert len(found.points) == len(exact.points)
    assert found.weights == pytest.approx(exact.weights, abs=1e-3)
    assert found.points.area.sum() == pytest.approx(exact.points.area.sum(), rel=1e-3)
