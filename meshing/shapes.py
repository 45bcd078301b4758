"""Block shapes and their triangulations by gmsh; blocks with congruent outline nodes share one shape.

A shape with the same nodes on opposite sides is a grid of cells (gmsh's transfinite surface), each cell cut by both of
its diagonals, so that a block is equally stiff to the left and to the right. Any other shape gets gmsh's triangulation
of the polygon.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from runningbond.scene import Array, Indices, Mask

from .outline import NodeOutlines
from .session import gmsh_session

CONGRUENCE_TOLERANCE = 1e-9
"""Difference up to which nodes of congruent outlines coincide, as a fraction of the smallest block's size."""

TRIANGLE = 2
"""gmsh's number for a triangle of three nodes."""

GRID_TOLERANCE = 1e-3
"""Largest deviation of a grid's sides from a parallelogram, as a fraction of the shortest part of its outline."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Triangulation of a block, with the first node of its outline at the origin.

    Parameters
    ----------
    inner : (n, 2) float
        Nodes inside [m], numbered after those of the outline.
    triangles : (nt, 3) int
        Nodes of each triangle, counter-clockwise.
    """

    inner: Array
    triangles: Indices


def shape_of_blocks(outline: NodeOutlines) -> tuple[Indices, Indices]:
    """Sort blocks by shape.

    Returns
    -------
    shape : (nb,) int
        Shape of each block; congruent outlines, node by node, are one shape.
    example : (ns,) int
        One block of each shape.
    """
    count = outline.count
    local = outline.points - np.repeat(outline.points[outline.first[:-1]], count, axis=0)
    size = np.maximum.reduceat(np.abs(local).max(axis=1), outline.first[:-1])
    # The rounding step is incommensurable with usual lengths, so no coordinate lies at a rounding threshold.
    rounded = np.rint(local / (np.sqrt(2) * CONGRUENCE_TOLERANCE * size.min()))
    key = np.column_stack([rounded, outline.corner])
    shape, example = np.empty(len(count), dtype=np.int64), np.zeros(0, dtype=np.int64)
    for n in np.unique(count):
        members = np.flatnonzero(count == n)
        keys = key[outline.first[members][:, None] + np.arange(n)].reshape(len(members), -1)
        _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        shape[members] = len(example) + number.ravel()
        example = np.concatenate([example, members[first]])
    return shape, example


def triangulate(outline: NodeOutlines, blocks: Indices) -> list[Shape]:
    """Triangulate some blocks with gmsh, which adds no node on their outlines."""
    with gmsh_session() as gmsh:
        gmsh.option.setNumber("Geometry.AutoCoherence", 0)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
        rings = [slice(outline.first[block], outline.first[block + 1]) for block in blocks]
        surfaces = [_add_surface(gmsh, outline.points[ring], outline.corner[ring]) for ring in rings]
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(2)
        return [_read(gmsh, *surface) for surface in surfaces]


def _add_surface(gmsh: Any, points: Array, corner: Mask) -> tuple[int, list[int], float]:
    """Add a closed ring of nodes with its corners; return the surface, its points and their unit of length."""
    geo = gmsh.model.geo
    # In units of the block's own size, because gmsh has absolute tolerances.
    size = np.abs(points - points[0]).max()
    ring = [geo.addPoint(x, y, 0.0) for x, y in (points - points[0]) / size]
    lines = [geo.addLine(here, there) for here, there in zip(ring, ring[1:] + ring[:1], strict=True)]
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    if _is_grid(points, corner):
        geo.mesh.setTransfiniteSurface(surface, "Left", [ring[i] for i in np.flatnonzero(corner)])
        geo.mesh.setRecombine(2, surface)
    return surface, ring, float(size)


def _is_grid(points: Array, corner: Mask) -> bool:
    """Whether opposite sides of a four-cornered ring have the same nodes, so that straight lines can connect them."""
    corners = np.flatnonzero(corner)
    if len(corners) != 4:
        return False
    south, east, north, west = (
        points[np.arange(a, b + 1) % len(points)] for a, b in zip(corners, [*corners[1:], len(points)], strict=True)
    )
    tolerance = GRID_TOLERANCE * np.hypot(*(np.roll(points, -1, axis=0) - points).T).min()
    return all(
        len(near) == len(far) and np.abs((far[::-1] - near) - (far[-1] - near[0])).max() <= tolerance
        for near, far in ((south, north), (west, east))
    )


def _read(gmsh: Any, surface: int, ring: list[int], size: float) -> Shape:
    """Triangles of one surface; cells are cut by both of their diagonals."""
    mesh = gmsh.model.mesh
    nodes_of = [*(mesh.getNodes(0, point)[:2] for point in ring), mesh.getNodes(2, surface)[:2]]
    tag, coordinates = (np.concatenate(parts) for parts in zip(*nodes_of, strict=True))
    points = size * coordinates.reshape(-1, 3)[:, :2]
    (kind,), _, (nodes,) = mesh.getElements(2, surface)
    order = np.argsort(tag)
    cells = order[np.searchsorted(tag, nodes, sorter=order)].reshape(-1, 3 if kind == TRIANGLE else 4)
    if kind == TRIANGLE:
        return Shape(points[len(ring) :], cells)
    centre = len(points) + np.arange(len(cells))
    triangles = [np.column_stack([cells[:, i], cells[:, (i + 1) % 4], centre]) for i in range(4)]
    inner = np.concatenate([points[len(ring) :], points[cells].mean(axis=1)])
    return Shape(inner, np.stack(triangles, axis=1).reshape(-1, 3))
