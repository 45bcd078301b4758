"""Meshes of walls: areas of blocks, lengths of joints, no nodes shared between blocks; files; commands."""

import runpy
import signal
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from skfem import MeshTri
from skfem.io.meshio import from_meshio

from meshing import GROUPS, WallMesh, joint_group, wall_mesh, write_mesh
from meshing.session import gmsh_session
from runningbond.commands.command_line import command
from runningbond.scene import (
    Array,
    BlockMaterial,
    Indices,
    JointMaterial,
    Load,
    Scene,
    SceneError,
    build_scene,
    read_scene,
)
from tests.scene.test_scene import GROUND, drawing
from tests.walls import content, courses, panel, write_toml

ROOT = Path(__file__).parents[2]

DOOR: list[list[float]] = [
    [1, 1, -1, 1, 1],
    [0.5, 1, 0.5, -1, 0.5, 1, 0.5],
    [1, 1, -1, 1, 1],
    [0.5, 1, 2, 1, 0.5],
    [1, 1, 1, 1, 1],
]
WALLS = {
    "panel": panel(),
    "half first": panel(wall__first_course="half"),
    "toothed": panel(wall__ends="toothed"),
    "fixed first course": panel(support__kind="fixed-first-course"),
    "corners": panel(support__kind="corners"),
    "door": courses(DOOR),
    "stacked": courses([[1, 1], [1, 1], [1, 1]]),
    "off the lattice": courses([[0.75, 1.25, 0.3, 0.7], [1, 1, 1], [0.6, 0.9, 1.5]]),
    "cracked": panel(inner_joint={"friction": 1.0, "cohesion": 1e6}),
    "one block": courses([[1]], support__kind="corners"),
}


def edges(triangles: Indices) -> Indices:
    """Directed edges of triangles, ``(3 nt, 2)``."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def areas(mesh: WallMesh) -> Array:
    first, second, third = np.moveaxis(mesh.points[mesh.triangles], 1, 0)
    across, along = second - first, third - first
    area: Array = (across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0]) / 2
    return area


def outline_edges(mesh: WallMesh) -> set[tuple[int, int]]:
    """Edges of only one triangle, in its sense."""
    directed = set(map(tuple, edges(mesh.triangles).tolist()))
    assert len(directed) == 3 * len(mesh.triangles), "two triangles run along an edge in the same sense"
    return {(i, j) for i, j in directed if (j, i) not in directed}


def check_mesh(mesh: WallMesh, scene: Scene, gap: float = 0.0) -> None:
    """Check what must hold for the mesh of any wall."""
    n_blocks, size = len(scene.blocks), np.abs(scene.blocks.vertices).max()
    # Triangles have positive areas and fill their blocks.
    area = areas(mesh)
    assert (area > 0).all()
    assert np.bincount(mesh.triangle_block, area) == pytest.approx(scene.blocks.area, rel=1e-12)
    # Blocks share no nodes and are numbered consecutively.
    assert (np.diff(mesh.block) >= 0).all()
    assert (np.diff(mesh.triangle_block) >= 0).all()
    assert (mesh.block[mesh.triangles] == mesh.triangle_block[:, None]).all()
    assert np.array_equal(mesh.first_node, np.searchsorted(mesh.block, np.arange(n_blocks + 1)))
    # Each block is one piece without a hole: V − E + F = 1, and its outline is one ring.
    unique = np.unique(np.sort(edges(mesh.triangles), axis=1), axis=0)
    count = np.bincount(mesh.block) - np.bincount(mesh.block[unique[:, 0]]) + np.bincount(mesh.triangle_block)
    assert (count == 1).all()
    assert np.array_equal(np.unique(mesh.triangles), np.arange(len(mesh.points)))
    boundary = outline_edges(mesh)
    assert len({i for i, _ in boundary}) == len(boundary)
    # Joint elements run along their joint, with nodes on the outlines of a and b, and have zero thickness.
    a0, a1, b1, b0 = mesh.interfaces.T
    assert (np.diff(mesh.joint) >= 0).all()
    assert np.array_equal(np.unique(mesh.joint), np.arange(len(scene.joints)))
    assert set(zip(a0.tolist(), a1.tolist(), strict=True)) <= boundary
    assert set(zip(b1.tolist(), b0.tolist(), strict=True)) <= boundary
    for near, far in ((a0, b0), (a1, b1)):
        assert np.array_equal(np.column_stack([mesh.block[near], mesh.block[far]]), scene.joints.block[mesh.joint])
        assert np.abs(mesh.points[near] - mesh.points[far]).max(initial=0) <= max(gap, 1e-15 * size)
    run = mesh.points[a1] - mesh.points[a0]
    length = np.bincount(mesh.joint, np.hypot(*run.T), minlength=len(scene.joints))
    assert length == pytest.approx(scene.joints.length, rel=1e-12, abs=2 * gap)
    # The normal, the tangent turned by −90°, points from a to b.
    a, b = scene.joints.block[mesh.joint].T
    across = scene.blocks.centroid[b] - scene.blocks.centroid[a]
    assert (run[:, 1] * across[:, 0] - run[:, 0] * across[:, 1] > 0).all()
    # The elements of a joint are ordered from one end to the other.
    follows = np.diff(mesh.joint) == 0
    assert np.array_equal(a1[:-1][follows], a0[1:][follows])
    assert np.array_equal(b1[:-1][follows], b0[1:][follows])
    # Congruent blocks have equal meshes, node by node.
    for shape in np.unique(mesh.shape):
        members = np.flatnonzero(mesh.shape == shape)
        spans = [slice(*mesh.first_node[block : block + 2]) for block in members]
        local = [mesh.points[span] - scene.blocks.centroid[block] for span, block in zip(spans, members, strict=True)]
        cut = [
            mesh.triangles[slice(*np.searchsorted(mesh.triangle_block, [block, block + 1]))] - mesh.first_node[block]
            for block in members
        ]
        for other, triangles in zip(local, cut, strict=True):
            assert other == pytest.approx(local[0], abs=max(gap, 1e-12 * size))
            assert np.array_equal(triangles, cut[0])


# --- walls on the lattice ------------------------------------------------------------------------------------


@pytest.mark.parametrize("cells", [1, 2, 3])
@pytest.mark.parametrize("name", WALLS)
def test_mesh_matches_the_wall(name: str, cells: int) -> None:
    check_mesh(wall_mesh(WALLS[name], cells), WALLS[name])


@pytest.mark.parametrize("cells", [1, 2, 3, 5])
def test_full_block_is_two_by_one_cells_of_four_triangles(cells: int) -> None:
    """2c × c cells: 8 c² equal triangles, (2c + 1)(c + 1) nodes at the corners of cells and 2 c² at their centres."""
    scene = panel()
    mesh = wall_mesh(scene, cells)
    full = scene.blocks.area[:-1] > 0.01
    assert set(mesh.shape[:-1].tolist()) == {*mesh.shape[:1], *mesh.shape[6:7]}, "a wall of full and half blocks"
    n_triangles, n_nodes = np.bincount(mesh.triangle_block)[:-1], np.bincount(mesh.block)[:-1]
    assert (n_triangles == np.where(full, 8, 4) * cells**2).all()
    along = np.where(full, 2, 1) * cells
    assert (n_nodes == (along + 1) * (cells + 1) + along * cells).all()
    wall = mesh.triangle_block < len(scene.blocks) - 1
    assert areas(mesh)[wall] == pytest.approx(0.24 * 0.06 / (8 * cells**2), rel=1e-12)


@pytest.mark.parametrize("cells", [1, 2, 3])
def test_half_block_joints_have_one_element_per_cell(cells: int) -> None:
    scene = panel()
    mesh = wall_mesh(scene, cells)
    names = np.array(GROUPS)[joint_group(scene)]
    elements = np.bincount(mesh.joint)
    assert (elements[names == "bed"] == cells).all()
    assert (elements[names == "head"] == cells).all()
    assert (elements[names == "base"] == 2 * cells).all()
    assert {name: int((names == name).sum()) for name in GROUPS[2:]} == {"bed": 132, "head": 66, "base": 6, "inner": 0}


def test_joints_of_a_fixed_course_are_the_base() -> None:
    scene = WALLS["fixed first course"]
    base = joint_group(scene) == GROUPS.index("base")
    assert np.array_equal(base, scene.fixed[scene.joints.block].any(axis=1))
    assert base.sum() == 12


def test_inner_joints_are_a_separate_group() -> None:
    scene = WALLS["cracked"]
    inner = joint_group(scene) == GROUPS.index("inner")
    assert np.array_equal(inner, scene.joints.inner)
    assert inner.sum() == 66


def test_ground_has_nodes_only_at_its_corners_and_joints() -> None:
    scene = panel()
    mesh = wall_mesh(scene, 2)
    ground = mesh.points[mesh.first_node[-2] :]
    level = np.sort(ground[np.abs(ground[:, 1]) < 1e-12, 0])
    assert level == pytest.approx([-1.44, *np.linspace(0, 1.44, 25), 2.88])
    assert (ground[:, 1] == ground[:, 1].min()).sum() == 2


@given(
    st.lists(
        st.lists(st.sampled_from([0.5, 1.0, 1.5, 0.8, -0.5, -1.0]), min_size=1, max_size=5), min_size=1, max_size=4
    ),
    st.integers(1, 3),
)
@settings(max_examples=25)
def test_any_pattern_of_courses_is_meshed(pattern: list[list[float]], cells: int) -> None:
    try:
        scene = courses(pattern)
    except SceneError:
        assume(False)
    check_mesh(wall_mesh(scene, cells), scene)


@pytest.mark.parametrize("scale", [2.0**-20, 2.0**17])
def test_mesh_does_not_depend_on_the_unit_of_length(scale: float) -> None:
    sizes = {key: scale * value for key, value in content()["wall"].items()}
    mesh, scaled = wall_mesh(panel(), 2), wall_mesh(panel(wall=sizes), 2)
    assert np.array_equal(mesh.triangles, scaled.triangles)
    assert np.array_equal(scaled.points, scale * mesh.points)


def test_meshing_is_deterministic() -> None:
    first, second = wall_mesh(WALLS["off the lattice"], 2), wall_mesh(WALLS["off the lattice"], 2)
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.triangles, second.triangles)


def test_arrays_of_a_mesh_are_read_only() -> None:
    mesh = wall_mesh(WALLS["one block"])
    for name, array in vars(mesh).items():
        assert not array.flags.writeable, name


# --- blocks of any shape -------------------------------------------------------------------------------------


def built(polygons: list[Array], ground: Array | None = None) -> Scene:
    return build_scene(
        "blocks",
        polygons,
        thickness=0.1,
        block=BlockMaterial(1800.0),
        joint=JointMaterial(friction=0.6),
        load=Load(),
        grounds=() if ground is None else [ground],
    )


def turned(points: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    rotated: Array = points @ np.array([[c, s], [-s, c]])
    return rotated


GROUND_OF_BLOCKS = np.array([[-0.5, -0.2], [1.5, -0.2], [1.5, 0.0], [-0.5, 0.0]])


def blocks_with_inclined_heads(seed: int) -> list[Array]:
    """Courses on [0, 1] of blocks with randomly inclined head joints."""
    random = np.random.default_rng(seed)
    height = random.uniform(0.05, 0.5)
    blocks = []
    for course in range(random.integers(1, 5)):
        width = random.uniform(0.3, 1.0, random.integers(1, 6))
        cuts = np.concatenate([[0.0], np.cumsum(width) / width.sum()])
        lean = random.uniform(-0.04, 0.04, len(cuts))
        low, high = np.full_like(cuts, course * height), np.full_like(cuts, (course + 1) * height)
        foot, head = np.column_stack([cuts - lean, low]), np.column_stack([cuts + lean, high])
        blocks += [np.array([foot[i], foot[i + 1], head[i + 1], head[i]]) for i in range(len(width))]
    return blocks


@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("seed", range(5))
def test_mesh_of_irregular_blocks(seed: int, angle: float) -> None:
    blocks = [turned(block, angle) for block in blocks_with_inclined_heads(seed)]
    scene = built(blocks, turned(GROUND_OF_BLOCKS, angle))
    for cells in (1, 3):
        check_mesh(wall_mesh(scene, cells), scene)


@pytest.mark.parametrize("seed", range(5))
def test_gaps_within_contact_tolerance_stay_in_the_mesh(seed: int) -> None:
    """Corners displaced by less than the contact tolerance: outlines stay, and nodes face each other across gaps."""
    blocks = blocks_with_inclined_heads(seed)
    random = np.random.default_rng(seed)
    off = 0.4 * built(blocks, GROUND_OF_BLOCKS).blocks.tolerance
    scene = built([block + random.uniform(-off, off, block.shape) for block in blocks], GROUND_OF_BLOCKS)
    mesh = wall_mesh(scene, 2)
    check_mesh(mesh, scene, gap=2 * scene.blocks.tolerance)
    side = np.array([mesh.points[j] - mesh.points[i] for i, j in outline_edges(mesh)])
    assert np.hypot(*side.T).min() > 2 * scene.blocks.tolerance, "a gap has made a sliver"


def test_mesh_of_a_drawing_with_various_blocks(tmp_path: Path) -> None:
    """A triangle, a pentagon and an inclined joint, drawn in millimetres, clockwise and counter-clockwise."""
    outlines = [
        GROUND,
        [(0.0, 0.0), (0.0, 100.0), (200.0, 130.0), (200.0, 0.0)],
        [(0.0, 100.0), (200.0, 130.0), (200.0, 200.0), (100.0, 260.0), (0.0, 200.0)],
        [(200.0, 0.0), (300.0, 0.0), (200.0, 90.0)],
    ]
    drawing(tmp_path / "wall.dxf", outlines)
    wall = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    scene = read_scene(write_toml(content(wall=wall), tmp_path / "wall.toml"))
    for cells in (1, 2, 4):
        mesh = wall_mesh(scene, cells)
        check_mesh(mesh, scene)
        # Sides without a joint are divided too: no edge is longer than the block's target size.
        side = np.array([mesh.points[j] - mesh.points[i] for i, j in outline_edges(mesh) if mesh.block[i] < 3])
        assert np.hypot(*side.T).max() < 1.5 * np.sqrt(scene.blocks.area[:-1].max() / 2) / cells


def test_congruent_blocks_share_a_shape_for_any_first_corner() -> None:
    brick = np.array([[0.0, 0.0], [0.24, 0.0], [0.24, 0.06], [0.0, 0.06]])
    scene = built([brick, np.roll(brick, 1, axis=0) + [0, 0.06], np.roll(brick, 2, axis=0) + [0, 0.12]])
    mesh = wall_mesh(scene)
    assert len(set(mesh.shape[:3].tolist())) == 1
    check_mesh(mesh, scene)


def test_small_block_refines_a_large_one_only_at_their_joint() -> None:
    large = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    small = np.array([[5.0, 10], [5.1, 10], [5.1, 10.1], [5, 10.1]])
    scene = built([large, small])
    mesh = wall_mesh(scene)
    check_mesh(mesh, scene)
    assert (mesh.triangle_block == 0).sum() < 100
    # The small block's size determines the elements of their joint: 0.1 / (0.1 / √2 / 4) = 5.7.
    assert (wall_mesh(scene, 4).joint == np.argmin(scene.joints.length)).sum() == 6


def test_rounding_does_not_change_the_number_of_cells() -> None:
    """Blocks of 0.75 widths are 1.5 cells long; their lengths are 0.18 ± 1e-16, and all must be divided equally."""
    scene = courses([[0.75] * 7] * 4, width=0.24, height=0.06)
    assert len(set(scene.joints.length.tolist())) > 2
    assert set(wall_mesh(scene).shape[:-1].tolist()) == {0}


# --- gmsh ----------------------------------------------------------------------------------------------------


def test_gmsh_is_finalized_after_meshing() -> None:
    import gmsh

    wall_mesh(WALLS["door"])
    assert not gmsh.isInitialized()
    with pytest.raises(RuntimeError, match="stop"), gmsh_session():
        raise RuntimeError("stop")
    assert not gmsh.isInitialized()


def test_gmsh_session_keeps_pythons_sigint_handler() -> None:
    """gmsh's own handler would end the process at once and leave half-written files."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with gmsh_session():
            assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_gmsh_session_keeps_pythons_sigterm_handler() -> None:
    """gmsh replaces it on initialization; SIGTERM would end the process, during and after meshing, without cleanup."""
    said = """
import signal
import subprocess
import sys
from meshing.session import gmsh_session
signal.signal(signal.SIGTERM, lambda number, frame: print("heard"))
with gmsh_session():
    signal.raise_signal(signal.SIGTERM)
signal.raise_signal(signal.SIGTERM)
"""
    done = subprocess.run([sys.executable, "-c", said], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "heard\nheard\n")


def test_open_gmsh_session_of_the_caller_is_kept() -> None:
    import gmsh

    gmsh.initialize(interruptible=False, readConfigFiles=False)
    try:
        gmsh.model.add("mine")
        with pytest.raises(SceneError, match="has a session open"):
            wall_mesh(WALLS["one block"])
        assert gmsh.isInitialized()
        assert gmsh.model.getCurrent() == "mine"
    finally:
        gmsh.finalize()


@pytest.mark.parametrize(("cells", "fault"), [(0, "at least 1"), (-2, "at least 1"), (400, "more than 10000000")])
def test_invalid_cells_are_refused(cells: int, fault: str) -> None:
    with pytest.raises(SceneError, match=fault):
        wall_mesh(panel(), cells)


# --- files ---------------------------------------------------------------------------------------------------

KINDS = ("triangle", "quad")
STIFFNESS = {"normal_stiffness": 2e9, "shear_stiffness": 1e9}
WRITTEN = ("panel", "fixed first course", "off the lattice", "cracked", "one block")


@pytest.mark.parametrize("name", WRITTEN)
def test_written_mesh_is_read_by_gmsh(name: str, tmp_path: Path) -> None:
    """Coordinates are exact; every group has its own elements."""
    scene, path = WALLS[name], tmp_path / "wall.msh"
    mesh = wall_mesh(scene, 2)
    write_mesh(mesh, scene, path)
    assert path.read_bytes().startswith(b"$MeshFormat\n4.1 ")
    interface_group = joint_group(scene)[mesh.joint]
    with gmsh_session() as gmsh:
        gmsh.open(str(path))
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        points = coordinates.reshape(-1, 3)[np.argsort(tags)]
        groups = {gmsh.model.getPhysicalName(2, tag): tag for _, tag in gmsh.model.getPhysicalGroups()}
        entities = {word: gmsh.model.getEntitiesForPhysicalGroup(2, tag) for word, tag in groups.items()}
        elements = {
            word: [gmsh.model.mesh.getElements(2, entity) for entity in found] for word, found in entities.items()
        }
    assert np.array_equal(points[:, :2], mesh.points)
    assert not points[:, 2].any()
    wall = scene.wall[mesh.triangle_block]
    expected = {"block": mesh.triangles[wall], "ground": mesh.triangles[~wall]}
    expected |= {word: mesh.interfaces[interface_group == GROUPS.index(word)] for word in GROUPS[2:]}
    assert set(elements) == {word for word, nodes in expected.items() if len(nodes)}
    for word, found in elements.items():
        ((kinds, _, (nodes,)),) = found
        assert kinds.tolist() == [2 if word in ("block", "ground") else 3]
        assert np.array_equal(nodes.reshape(len(expected[word]), -1) - 1, expected[word])


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
@pytest.mark.parametrize("name", WRITTEN)
def test_written_mesh_is_read_by_meshio(name: str, suffix: str, tmp_path: Path) -> None:
    """Coordinates are exact; block, joint and group of every element agree."""
    scene, path = WALLS[name], tmp_path / f"wall{suffix}"
    mesh = wall_mesh(scene, 2)
    write_mesh(mesh, scene, path)
    read = meshio.read(path)
    assert np.array_equal(read.points[:, :2], mesh.points)
    assert np.array_equal(read.cells_dict["triangle"], mesh.triangles)
    assert np.array_equal(read.cell_data_dict["block"]["triangle"], mesh.triangle_block)
    group = read.cell_data_dict["group" if suffix == ".vtu" else "gmsh:physical"]
    if suffix == ".msh":
        named = {int(tag): name for name, (tag, _) in read.field_data.items()}
        assert all(GROUPS[tag - 1] == name for tag, name in named.items())
    assert np.array_equal(group["triangle"], np.where(scene.wall, 1, 2)[mesh.triangle_block])
    assert set(read.cells_dict) == ({"triangle", "quad"} if len(mesh.interfaces) else {"triangle"})
    if len(mesh.interfaces):
        joint = read.cell_data_dict["joint"]["quad"].astype(int)
        order = np.argsort(joint, kind="stable")
        assert np.array_equal(read.cells_dict["quad"][order], mesh.interfaces)
        assert np.array_equal(joint[order], mesh.joint)
        assert np.array_equal(group["quad"][order], joint_group(scene)[mesh.joint] + 1)
        assert (read.cell_data_dict["joint"]["triangle"] == -1).all()
        assert (read.cell_data_dict["block"]["quad"] == -1).all()


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_written_elements_have_the_parameters_of_their_materials(suffix: str, tmp_path: Path) -> None:
    """Thickness times area times density is the wall's mass; dry heads differ from beds in mortar, oak from stone."""
    scene = courses(
        [[1, 1], [0.5, 1, 0.5]],
        block={"density": 1800.0, "young": 5e9, "poisson": 0.2},
        materials={"oak": {"density": 700.0, "thickness": 0.3}},
        joints={"dry": {"friction": 0.4, **STIFFNESS}},
        assign=[{"block": "oak", "blocks": [2, 3]}, {"joint": "dry", "orientation": "head"}],
        joint={"friction": 0.6, "cohesion": 1200.0, "mortar": {"young": 1e9, "poisson": 0.0, "thickness": 0.01}},
    )
    path, mesh = tmp_path / f"wall{suffix}", wall_mesh(scene)
    write_mesh(mesh, scene, path)
    read = meshio.read(path)
    of_triangles, of_joints = ({name: data[kind] for name, data in read.cell_data_dict.items()} for kind in KINDS)
    area = np.abs(np.linalg.det(read.points[read.cells_dict["triangle"]] + (0.0, 0.0, 1.0))) / 2
    mass = of_triangles["thickness"] * area * of_triangles["density"]
    oak, ground = np.isin(of_triangles["block"], (2, 3)), ~scene.wall[of_triangles["block"].astype(int)]
    assert mass[oak].sum() == pytest.approx(0.6 * 0.175 * 0.3 * 700)
    assert mass[~ground].sum() == pytest.approx(scene.mass[scene.wall].sum())
    assert set(of_triangles["young"][~oak & ~ground]) == {5e9}
    assert not of_triangles["young"][oak | ground].any()
    assert not of_triangles["density"][ground].any()
    assert set(of_triangles["poisson"][~oak & ~ground]) == {0.2}
    joint = of_joints["joint"].astype(int)
    head = ~scene.joints.is_bed[joint]
    expected = {
        "friction": (0.4, 0.6),
        "cohesion": (0.0, 1200.0),
        "tensile_strength": (0.0, 2000.0),
        "normal_stiffness": (2e9, 1e11),
        "shear_stiffness": (1e9, 5e10),
    }
    for name, (of_heads, of_beds) in expected.items():
        assert of_joints[name] == pytest.approx(np.where(head, of_heads, of_beds))
    both_of_oak = np.isin(scene.joints.block[joint], (2, 3)).all(axis=1)
    assert both_of_oak.any()
    assert of_joints["thickness"] == pytest.approx(np.where(both_of_oak, 0.3, scene.thickness))
    assert not any(of_triangles[name].any() for name in ("friction", "cohesion", "normal_stiffness"))
    assert not any(of_joints[name].any() for name in ("density", "young", "poisson"))


def test_written_mesh_is_read_by_scikit_fem(tmp_path: Path) -> None:
    """Its boundary is the outlines of all blocks, and the groups are subdomains."""
    scene, path = WALLS["door"], tmp_path / "wall.msh"
    mesh = wall_mesh(scene, 2)
    write_mesh(mesh, scene, path)
    read = from_meshio(meshio.read(path))
    assert isinstance(read, MeshTri)
    assert np.array_equal(read.p.T, mesh.points)
    assert np.array_equal(read.t.T, np.sort(mesh.triangles, axis=1))  # MeshTri sorts
    assert np.array_equal(read.subdomains["block"], np.flatnonzero(scene.wall[mesh.triangle_block]))
    assert np.array_equal(read.subdomains["ground"], np.flatnonzero(~scene.wall[mesh.triangle_block]))
    own = {tuple(sorted(edge)) for edge in outline_edges(mesh)}
    assert set(map(tuple, np.sort(read.facets[:, read.boundary_facets()].T, axis=1).tolist())) == own


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_failed_write_leaves_the_old_file(suffix: str, tmp_path: Path) -> None:
    """For a full disk, here simulated by a limit on file size: exit code 2, one line, the old file unchanged."""
    path = tmp_path / f"wall{suffix}"
    path.write_text("before")
    lines = (
        "import resource, sys; from runningbond.commands.command_line import main;"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192));"
        f"main(['mesh', 'panel-01', '-o', {str(path)!r}])"
    )
    done = subprocess.run([sys.executable, "-c", lines], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith(f"runningbond: {path}: ")
    assert done.stderr.count("\n") == 1
    assert path.read_text() == "before"
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


# --- the command line and the example ------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_command_writes_a_mesh(suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "meshes" / f"wall{suffix}"
    assert command(["mesh", "panel-01", "-o", str(path), "--cells", "2"]) == 0
    mesh = wall_mesh(panel(), 2)
    said = capsys.readouterr().out
    assert said == f"{path}: {len(mesh.points)} nodes, {len(mesh.triangles)} triangles, 420 joint elements\n"
    assert np.array_equal(meshio.read(path).points[:, :2], mesh.points)


@pytest.mark.parametrize(
    ("ties", "said"),
    [
        (0, "1 corner that bears on a side has no element"),
        (2, "1 corner that bears on a side and 2 ties have no element"),
    ],
)
def test_command_tells_what_has_no_element(
    ties: int, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A stone that stands on its corner, with no joint at all."""
    stones = [[[0, 0], [1, 0], [1, 0.5], [0, 0.5]], [[0.5, 0.5], [0.8, 0.8], [0.5, 1.1], [0.2, 0.8]]]
    wall = content(wall={"outlines": stones, "thickness": 0.2})
    bar = {"from": [0.5, 0.8], "to": [2, 0.8], "area": 1e-4, "young": 2e11, "yield": 1e4}
    file = write_toml(wall | ({"tie": ties * [bar]} if ties else {}), tmp_path / "wall.toml")
    assert command(["mesh", str(file), "-o", str(tmp_path / "wall.vtu")]) == 0
    assert f"note: {said}\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["panel-01", "-o", "wall.stl"], "wall.stl: must end in .msh or .vtu, the formats of a mesh"),
        (["panel-01", "-o", "wall"], "wall: must end in .msh or .vtu"),
        (["panel-01", "-o", "wall.msh", "--cells", "0"], "cells = 0: must be a whole number, at least 1"),
        (["panel-01", "-o", "wall.msh", "--cells", "1.5"], "--cells: '1.5' is not a whole number"),
        (["panel-01", "-o", "wall.msh", "--cells", "99999"], "cells = 99999: gives more than 10000000 triangles"),
        (["panel-99", "-o", "wall.msh"], "panel-99: there is no such file"),
        (["panel-01"], "--out"),
    ],
)
def test_command_refuses_in_one_line(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command(["mesh", *arguments]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert said in error
    assert not list(tmp_path.iterdir())


def test_missing_libraries_are_reported_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On a minimal system the wheel of gmsh does not find libGLU and raises OSError on import."""
    fault = "libGLU.so.1: cannot open shared object file: No such file or directory"
    (tmp_path / "gmsh.py").write_text(f"raise OSError({fault!r})")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "gmsh", raising=False)
    assert command(["mesh", "panel-01", "-o", str(tmp_path / "wall.msh")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"runningbond: gmsh: cannot be loaded ({fault}); ")
    assert error.count("\n") == 1
    assert not (tmp_path / "wall.msh").exists()


def test_example_makes_a_mesh(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(ROOT / "examples" / "make_mesh.py"))
    assert capsys.readouterr().out == "1703 nodes, 2331 triangles, 420 joint elements\n"
    assert {path.name for path in tmp_path.iterdir()} == {"panel-01.msh", "panel-01.vtu"}
