"""Gaps and overlaps between blocks as drawn: they are detected, and closed on request."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array, csc_array, csr_array, eye_array
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from ..arrays import Array, Indices, components
from ..blocks import Blocks, touching_boxes
from ..errors import SceneError
from ..polygons import smaller_sides

KEY = "wall.heal"

MAX_ITERATIONS = 200
"""Maximum number of Gauss-Newton steps; about a dozen suffice for gaps as small as `heal` permits."""

ROUNDING = 1e-13
"""Distance, in sizes of the drawing, up to which two points coincide except for rounding errors."""

NARROW_GAP = 0.01
"""Gap between facing edges, in sizes of the smaller block, below which a joint was certainly intended."""


@dataclass(frozen=True, eq=False)
class _Touches:
    """Corners and edges that are to coincide.

    Parameters
    ----------
    node : (nv,) int
        Node of each corner; corners that are to be merged have the same node.
    lies, low, high : (n,) int
        A node, and the two end nodes of the edge that it is to lie on.
    """

    node: Indices
    lies: Indices
    low: Indices
    high: Indices


def heal(polygons: Sequence[Array], reach: float, laid: int = 0) -> tuple[list[Array], str]:
    """Close gaps and overlaps up to `reach` between neighbours.

    Two corners of different blocks that are each other's nearest are merged at their mean position. Corners near an
    edge of another block are moved onto it, by damped Gauss-Newton steps with the least sum of squared displacements.
    A joint along many blocks thus becomes one straight line that averages their edges.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks and ground, counter-clockwise [m].
    reach
        Largest gap or overlap to be closed, and largest displacement of a corner [m].
    laid
        Number of the last outlines that nobody drew, such as a strip of ground: their sides do not limit the reach.

    Returns
    -------
    healed : list of (n, 2) float
    note
        How many corners were moved, and how far.

    Raises
    ------
    SceneError
        For a reach above a tenth of the smallest block's smaller side, or that merges corners of one block, for gaps
        that corners would have to move further to close, and for a block that would cross itself.
    """
    blocks = Blocks.from_polygons(polygons)
    sides = smaller_sides([shapely.Polygon(p) for p in polygons[: len(polygons) - laid]])
    least = float(sides.min())
    if reach > least / 10:
        smallest = blocks.name(int(sides.argmin()))
        what = f"must be at most a tenth of the smallest block's smaller side, {least / 10:.4g}: that of {smallest}"
        raise SceneError(KEY, what, reach)
    # Relative to the middle of the drawing: in a map, a wall may be a million times its own size from the origin, where
    # rounding errors of corners are as large as the gaps to be closed.
    origin = blocks.vertices.mean(axis=0)
    drawn = blocks.vertices - origin
    touches, gap = _touches(blocks, reach)
    _check_corners(blocks, touches, reach)
    number = np.bincount(touches.node)[:, None]
    nodes = np.column_stack([np.bincount(touches.node, x) for x in drawn.T]) / number
    size = float(np.ptp(drawn, axis=0).max())
    for _ in range(MAX_ITERATIONS):
        apart = _apart(touches, nodes)
        if np.abs(apart).max(initial=0.0) <= ROUNDING * size:
            break
        nodes = nodes + _step(touches, nodes, apart, least)
    corners = nodes[touches.node]
    moved = np.hypot(*(corners - drawn).T)
    worst = int(np.argmax(moved))
    if moved[worst] > reach or np.abs(_apart(touches, nodes)).max(initial=0.0) > blocks.tolerance / 10:
        at = blocks.place(blocks.vertices[worst])
        what = f"closes no gaps near {at}: the corner would move by {moved[worst]:.2g} m; draw it anew"
        raise SceneError(KEY, what, reach)
    still = moved[:, None] <= ROUNDING * size
    healed = np.split(np.where(still, blocks.vertices, corners + origin), blocks.first[1:-1])
    for k in np.flatnonzero(~shapely.is_valid([shapely.Polygon(p) for p in healed])):
        raise SceneError(KEY, f"makes {blocks.name(int(k))} cross itself; choose a smaller one", reach)
    changed = int(np.sum(moved > blocks.tolerance / 100))
    if not changed:
        return healed, "heal: nothing to close"
    note = f"heal: {changed} corners moved, by at most {moved[worst]:.2g} m"
    return healed, f"{note}, to close gaps and overlaps of up to {gap:.2g} m"


def _check_corners(blocks: Blocks, touches: _Touches, reach: float) -> None:
    """Refuse a reach that merges two corners of the same block."""
    pair = np.column_stack([blocks.owner, touches.node])
    _, first, number = np.unique(pair, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[number.ravel()] != np.arange(len(pair)))
    if len(again):
        one, other = blocks.vertices[[first[number.ravel()[again[0]]], again[0]]]
        side = f"{np.hypot(*(other - one)):.2g} m apart, at {blocks.place(one)}"
        what = f"joins two corners of {blocks.name(int(pair[again[0], 0]))}, {side}; choose a smaller one"
        raise SceneError(KEY, what, reach)


def _touches(blocks: Blocks, reach: float) -> tuple[_Touches, float]:
    """Corners and edges that are to coincide within a reach, and the largest distance between them [m]."""
    corner, other = _twins(blocks, reach)
    start = blocks.vertices
    stop = start[blocks.successor]
    lines = shapely.linestrings(np.stack([start, stop], axis=1))
    c, e = shapely.STRtree(lines).query(shapely.points(start), predicate="dwithin", distance=reach)
    along = stop[e] - start[e]
    place = ((start[c] - start[e]) * along).sum(axis=1) / (along**2).sum(axis=1)
    # A corner that is merged with a twin on the edge's block is not moved onto the edge as well.
    n = len(blocks)
    pairs = np.concatenate([corner * n + blocks.owner[other], other * n + blocks.owner[corner]])
    taken = np.isin(c * n + blocks.owner[e], pairs)
    inside = (blocks.owner[c] != blocks.owner[e]) & (place > 0) & (place < 1) & ~taken
    c, e, place, along = c[inside], e[inside], place[inside, None], along[inside]
    gaps = [start[corner] - start[other], start[c] - start[e] - place * along]
    node = components(np.column_stack([corner, other]), len(start))
    rows = np.unique(np.column_stack([node[c], node[e], node[blocks.successor[e]]]), axis=0)
    rows = rows[(rows[:, :1] != rows[:, 1:]).all(axis=1)]
    return _Touches(node, *rows.T), float(np.hypot(*np.vstack(gaps).T).max(initial=0.0))


def _twins(blocks: Blocks, reach: float) -> tuple[Indices, Indices]:
    """Pairs of corners of two blocks, each being its block's nearest corner to the other."""
    pairs = cKDTree(blocks.vertices).query_pairs(reach, output_type="ndarray")
    pairs = np.vstack([pairs, pairs[:, ::-1]])
    a, b = pairs[blocks.owner[pairs[:, 0]] != blocks.owner[pairs[:, 1]]].T
    distance = np.hypot(*(blocks.vertices[a] - blocks.vertices[b]).T)
    order = np.lexsort((b, distance, blocks.owner[b], a))
    a, b = a[order], b[order]
    nearest = np.ones(len(a), dtype=np.bool_)
    nearest[1:] = (a[1:] != a[:-1]) | (blocks.owner[b[1:]] != blocks.owner[b[:-1]])
    a, b = a[nearest], b[nearest]
    n = len(blocks.vertices)
    both = np.isin(a * n + b, b * n + a) & (a < b)
    return a[both], b[both]


def _apart(touches: _Touches, nodes: Array) -> Array:
    """Signed distances ``(n,)`` [m] of nodes from the lines of the edges they are to lie on, positive to the left."""
    _, normal = _place(touches, nodes)
    found: Array = ((nodes[touches.lies] - nodes[touches.low]) * normal).sum(axis=1)
    return found


def _place(touches: _Touches, nodes: Array) -> tuple[Array, Array]:
    """Positions ``(n,)`` of nodes along their edges, relative to the edge lengths; normals of the edges ``(n, 2)``."""
    along = nodes[touches.high] - nodes[touches.low]
    length = np.hypot(*along.T)[:, None]
    place = ((nodes[touches.lies] - nodes[touches.low]) * along / length**2).sum(axis=1)
    return place, np.column_stack([-along[:, 1], along[:, 0]]) / length


def _step(touches: _Touches, nodes: Array, apart: Array, length: float) -> Array:
    """Gauss-Newton step ``(nn, 2)`` [m] of all nodes that closes the distances `apart`; its damping fades with these.

    Redundant conditions contradict each other slightly until the edges are collinear; without damping they would move
    the corners far.
    """
    place, normal = _place(touches, nodes)
    values, columns = [], []
    for node, share in ((touches.lies, np.ones_like(place)), (touches.low, place - 1), (touches.high, -place)):
        values.append(share[:, None] * normal)
        columns.append(2 * node[:, None] + [0, 1])
    row = np.tile(np.repeat(np.arange(len(place)), 2), 3)
    where = (row, np.concatenate(columns).ravel())
    system = csr_array(coo_array((np.concatenate(values).ravel(), where), shape=(len(place), nodes.size)))
    damping = max(10 * float(np.abs(apart).max()) / length, 1e-5)
    matrix = csc_array(system.T @ system + damping**2 * eye_array(nodes.size))
    return np.asarray(spsolve(matrix, -(system.T @ apart))).reshape(-1, 2)


def missed_joints(polygons: Sequence[Array], healed: float = 0.0) -> str:
    """Note on the widest gap that prevents a joint and is too narrow to be intended; empty if there is none.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks and ground, counter-clockwise [m].
    healed
        Gaps up to this width should already be closed [m].
    """
    blocks = Blocks.from_polygons(polygons)
    start = blocks.vertices
    stop = start[blocks.successor]
    reach = NARROW_GAP * np.sqrt(blocks.area)[blocks.owner][:, None]
    a, b = touching_boxes(np.minimum(start, stop) - reach, np.maximum(start, stop) + reach)
    a, b = a[blocks.owner[a] != blocks.owner[b]], b[blocks.owner[a] != blocks.owner[b]]
    along, length = stop - start, np.hypot(*(stop - start).T)
    along = along / length[:, None]
    facing = (along[a] * along[b]).sum(axis=1) < -1 + NARROW_GAP**2
    a, b = a[facing], b[facing]
    low, high = ((p[b] - start[a]) for p in (stop, start))
    s_low, s_high = (low * along[a]).sum(axis=1), (high * along[a]).sum(axis=1)
    overlap = np.minimum(s_high, length[a]) - np.maximum(s_low, 0.0)
    outward = np.column_stack([along[a][:, 1], -along[a][:, 0]])
    d_low, d_high = (low * outward).sum(axis=1), (high * outward).sum(axis=1)
    s = np.stack([np.maximum(s_low, 0.0), np.minimum(s_high, length[a])])
    gap = (d_low + (d_high - d_low) / (s_high - s_low) * (s - s_low)).max(axis=0)
    narrow = (overlap > 0.1 * np.minimum(length[a], length[b])) & (gap > blocks.tolerance)
    narrow &= gap < np.minimum(reach[a, 0], reach[b, 0])
    if not narrow.any():
        return ""
    k = int(np.flatnonzero(narrow)[np.argmax(gap[narrow])])
    unit = 10.0 ** (np.floor(np.log10(gap[k])) - 1)
    enough = np.ceil(1.1 * gap[k] / unit) * unit
    first, second = sorted((int(blocks.owner[a[k]]), int(blocks.owner[b[k]])))
    between = f"{blocks.name(first)} and {blocks.name(second)}"
    remedy = f"[wall] heal = {enough:.2g} would close it"
    if gap[k] <= healed:  # a corner past an edge's end has no corner to merge with and no edge to move onto
        remedy = f"{KEY} = {healed:.2g} leaves it open; draw the corners there anew"
    return f"a gap of {gap[k]:.2g} m between {between} leaves no joint there; {remedy}"
