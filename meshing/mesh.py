"""The mesh of a wall: triangulated blocks, and joints as zero-thickness elements between the blocks' own nodes."""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array, Indices, Scene, SceneError, frozen
from runningbond.scene.ranges import check_whole_number

from .outline import NodeOutlines, outlines
from .shapes import shape_of_blocks, triangulate

MOST_TRIANGLES = 10_000_000
GROUPS = ("block", "ground", "bed", "head", "base", "inner")
"""Groups of elements: triangles belong to the wall's blocks or the ground, joint elements to four kinds of joint."""


@dataclass(frozen=True, eq=False)
class WallMesh:
    """Triangles of all blocks and the joint elements between them.

    Every node belongs to one block, so blocks are connected only through their joints. Blocks, nodes and triangles are
    in the order of the scene's blocks, joint elements in the order of its joints and along their tangents. Blocks of
    one shape have the same nodes and triangles in the same order. Contacts of single corners have no elements.

    Parameters
    ----------
    points : (nn, 2) float
        Nodes [m]. Those of a block's outline come first, counter-clockwise from the corner with the smallest 0.3 x + y,
        the lower left one of a rectangle.
    first_node : (nb + 1,) int
        Block ``i`` owns the nodes ``first_node[i]`` to ``first_node[i + 1]``, excluding the last.
    block : (nn,) int
        Block of each node.
    shape : (nb,) int
        Shape of each block: blocks with the same number are congruent, including their nodes.
    triangles : (nt, 3) int
        Nodes of each triangle, counter-clockwise.
    triangle_block : (nt,) int
        Block of each triangle.
    interfaces : (ne, 4) int
        Nodes a0, a1, b1, b0 of each joint element: a0 → a1 along the joint's tangent on the side of block a, b0 and b1
        opposite on block b. As a quadrilateral it has zero area.
    joint : (ne,) int
        Joint of each joint element.
    """

    points: Array
    first_node: Indices
    block: Indices
    shape: Indices
    triangles: Indices
    triangle_block: Indices
    interfaces: Indices
    joint: Indices

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points))
        for name in ("first_node", "block", "shape", "triangles", "triangle_block", "interfaces", "joint"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))


def wall_mesh(scene: Scene, cells: int = 1) -> WallMesh:
    """Mesh a wall with gmsh.

    Parameters
    ----------
    scene
        The wall.
    cells
        Number of cells in half a block along the course, and in a block's height: a full block of running bond has 2
        `cells` by `cells` cells of four triangles. Blocks that do not form such a grid, e.g. irregular ones, get
        triangles of about that size.

    Raises
    ------
    SceneError
        For an invalid or too large number of cells, and if gmsh cannot be loaded or has a session open.
    """
    check_whole_number("cells", cells)
    if 8 * cells**2 * len(scene.blocks) > MOST_TRIANGLES:
        raise SceneError("cells", f"gives more than {MOST_TRIANGLES} triangles; take fewer cells", cells)
    outline = outlines(scene, cells)
    shape, example = shape_of_blocks(outline)
    meshes = triangulate(outline, example)

    n_inner = np.array([len(mesh.inner) for mesh in meshes])[shape]
    n_triangles = np.array([len(mesh.triangles) for mesh in meshes])[shape]
    first_node, first_triangle = _offsets(outline.count + n_inner), _offsets(n_triangles)
    points = np.empty((first_node[-1], 2))
    triangles = np.empty((first_triangle[-1], 3), dtype=np.int64)
    origin = outline.points[outline.first[:-1]]
    points[_runs(first_node[:-1], outline.count)] = outline.points
    of_shape = np.split(np.argsort(shape, kind="stable"), np.cumsum(np.bincount(shape))[:-1])
    for mesh, blocks in zip(meshes, of_shape, strict=True):
        start = first_node[blocks] + outline.count[blocks]
        points[start[:, None] + np.arange(len(mesh.inner))] = origin[blocks][:, None] + mesh.inner
        rows = first_triangle[blocks][:, None] + np.arange(len(mesh.triangles))
        triangles[rows] = first_node[blocks][:, None, None] + mesh.triangles
    interfaces, joint = _interfaces(scene, outline, first_node)
    every = np.arange(len(shape))
    return WallMesh(
        points,
        first_node,
        np.repeat(every, np.diff(first_node)),
        shape,
        triangles,
        np.repeat(every, n_triangles),
        interfaces,
        joint,
    )


def not_meshed(scene: Scene) -> str:
    """What holds a wall together but has no element in its mesh, for the user; empty if there is nothing."""
    held = (int(scene.joints.at_corner.sum()), "corner that bears on a side", "corners that bear on sides")
    ties = (len(scene.ties), "tie", "ties")
    found = [f"{n} {one if n == 1 else several}" for n, one, several in (held, ties) if n]
    return " and ".join(found) + f" {'has' if held[0] + ties[0] == 1 else 'have'} no element" if found else ""


def _interfaces(scene: Scene, outline: NodeOutlines, first_node: Indices) -> tuple[Indices, Indices]:
    """Nodes of the joint elements ``(ne, 4)`` and the joint of each ``(ne,)``."""
    joint = np.repeat(np.arange(len(outline.divisions)), outline.divisions)
    step = _runs(np.zeros_like(outline.divisions), outline.divisions)
    a, b = scene.joints.block[joint].T
    start_a, start_b = outline.start[joint].T
    # The outline of block b runs against the tangent: its first node on the joint faces the last one of block a.
    last = outline.divisions[joint] - step
    a0, a1 = ((start_a + i) % outline.count[a] + first_node[a] for i in (step, step + 1))
    b1, b0 = ((start_b + i) % outline.count[b] + first_node[b] for i in (last - 1, last))
    return np.column_stack([a0, a1, b1, b0]), joint


def joint_group(scene: Scene) -> Indices:
    """Group of each joint as an index into `GROUPS`, ``(nj,)``.

    An inner joint is a potential crack inside a block; a base joint touches a block that does not move. The others are
    bed joints if at most 45° from the horizontal, else head joints.
    """
    run = np.abs(scene.joints.ends[:, 1] - scene.joints.ends[:, 0])
    bed, head, base, inner = (GROUPS.index(word) for word in ("bed", "head", "base", "inner"))
    kind = np.where(run[:, 0] >= run[:, 1], bed, head)
    kind = np.where(scene.fixed[scene.joints.block].any(axis=1), base, kind)
    return np.where(scene.joints.inner, inner, kind)


def _offsets(count: Indices) -> Indices:
    return np.concatenate([[0], np.cumsum(count)])


def _runs(start: Indices, count: Indices) -> Indices:
    """Concatenated runs of consecutive numbers start, start + 1, … of the given lengths."""
    return np.asarray(np.arange(count.sum()) + np.repeat(start - _offsets(count)[:-1], count))
