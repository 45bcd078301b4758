"""Gaps and overlaps between blocks as they were drawn: found, and closed where that is asked for."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import lsqr
from scipy.spatial import cKDTree

from ..arrays import Array, Indices
from ..blocks import Blocks, touching_boxes
from ..errors import SceneError

KEY = "wall.heal"

SWEEPS = 20
"""Corrections of the corners; each leaves a share of about the gap over the block's size of the one before."""

NOTICED = 0.01
"""Gap between facing edges, in sizes of the smaller block, below which a joint was surely meant."""


@dataclass(frozen=True, eq=False)
class _Touches:
    """What is to coincide: a corner, and a point on an edge of another block or one of its corners.

    Parameters
    ----------
    corner, low, high : (n,) int
        The corner, and the ends of the edge; the same one twice for a corner.
    """

    corner: Indices
    low: Indices
    high: Indices


def heal(polygons: Sequence[Array], reach: float) -> tuple[list[Array], str]:
    """Close gaps and overlaps up to `reach` between neighbours.

    Corners that are nearest to each other are to coincide, and those near another block's edge are to lie on it; of
    all shapes in which they do, corners take the one to which they move least (in the sum of squares), so that a
    joint along many blocks becomes one straight line.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks and ground, counter-clockwise [m].
    reach
        Largest gap or overlap [m].

    Returns
    -------
    healed : list of (n, 2) float
    note
        How many corners moved, and how far.

    Raises
    ------
    SceneError
        For a reach above a tenth of the smallest block's smaller side, and where corners would have to move further.
    """
    boxes = shapely.get_coordinates(shapely.oriented_envelope([shapely.Polygon(p) for p in polygons])).reshape(-1, 5, 2)
    least = float(np.hypot(*(boxes[:, 1:3] - boxes[:, :2]).T).min())
    if reach > least / 10:
        what = f"must be at most a tenth of the smallest block's smaller side, {least / 10:.4g}"
        raise SceneError(KEY, what, reach)
    blocks = Blocks.from_polygons(polygons)
    drawn = blocks.vertices
    touches = _touches(blocks, reach)
    corners, gap, size = drawn.copy(), np.zeros(0), float(np.ptp(drawn, axis=0).max())
    for sweep in range(SWEEPS):
        apart = _apart(touches, corners)
        gap = np.hypot(*apart.T) if sweep == 0 else gap
        if np.abs(apart).max(initial=0.0) <= 1e-12 * size:
            break
        corners = corners + _least_motion(touches, corners, apart)
    moved = np.hypot(*(corners - drawn).T)
    worst = int(np.argmax(moved))
    x, y = drawn[worst]
    if moved[worst] > 2 * reach or np.abs(_apart(touches, corners)).max(initial=0.0) > blocks.tolerance / 10:
        what = f"closes no gaps near ({x:.4g}, {y:.4g}): the corner would move by {moved[worst]:.2g} m; draw it anew"
        raise SceneError(KEY, what, reach)
    healed = np.split(corners, blocks.first[1:-1])
    for k in np.flatnonzero(~shapely.is_valid([shapely.Polygon(p) for p in healed])):
        raise SceneError(KEY, f"makes {blocks.name(int(k))} cross itself; choose a smaller one", reach)
    changed = int(np.sum(moved > blocks.tolerance / 100))
    note = f"heal: {changed} corners moved, by at most {moved[worst]:.2g} m"
    return healed, f"{note}, to close gaps and overlaps of up to {gap.max(initial=0.0):.2g} m"


def _touches(blocks: Blocks, reach: float) -> _Touches:
    corner, other = _twins(blocks, reach)
    start = blocks.vertices
    stop = start[blocks.successor]
    lines = shapely.linestrings(np.stack([start, stop], axis=1))
    c, e = shapely.STRtree(lines).query(shapely.points(start), predicate="dwithin", distance=reach)
    along = stop[e] - start[e]
    place = ((start[c] - start[e]) * along).sum(axis=1) / (along**2).sum(axis=1)
    # A corner that has a twin on the edge's block meets it there, not beside it.
    n = len(blocks)
    taken = np.isin(
        c * n + blocks.owner[e], np.concatenate([corner * n + blocks.owner[other], other * n + blocks.owner[corner]])
    )
    inside = (blocks.owner[c] != blocks.owner[e]) & (place > 0) & (place < 1) & ~taken
    c, e = c[inside], e[inside]
    return _Touches(
        np.concatenate([corner, c]), np.concatenate([other, e]), np.concatenate([other, blocks.successor[e]])
    )


def _twins(blocks: Blocks, reach: float) -> tuple[Indices, Indices]:
    """Corners of two blocks each of which is the other block's nearest."""
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


def _apart(touches: _Touches, corners: Array) -> Array:
    """From what each corner is to touch to the corner itself, ``(n, 2)`` [m]."""
    start, along = corners[touches.low], corners[touches.high] - corners[touches.low]
    return corners[touches.corner] - start - _place(touches, corners)[:, None] * along


def _place(touches: _Touches, corners: Array) -> Array:
    start, along = corners[touches.low], corners[touches.high] - corners[touches.low]
    square = (along**2).sum(axis=1)
    place: Array = ((corners[touches.corner] - start) * along).sum(axis=1) / np.where(square > 0, square, 1.0)
    return place


def _least_motion(touches: _Touches, corners: Array, apart: Array) -> Array:
    """Smallest motion of all corners that closes what is apart, to first order, ``(nv, 2)`` [m]."""
    edge = touches.low != touches.high
    along = corners[touches.high] - corners[touches.low]
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.where(edge, np.hypot(*along.T), 1.0)[:, None]
    first = np.where(edge[:, None], normal, [1.0, 0.0])
    rows = [(np.arange(len(edge)), first), (np.flatnonzero(~edge), np.tile([0.0, 1.0], (len(edge), 1)))]
    place = _place(touches, corners)
    i, j, values, wanted = [], [], [], []
    base = 0
    for chosen, direction in rows:
        for points, share in ((touches.corner, np.ones_like(place)), (touches.low, place - 1), (touches.high, -place)):
            for axis in (0, 1):
                i.append(base + np.arange(len(chosen)))
                j.append(2 * points[chosen] + axis)
                values.append((share[:, None] * direction)[chosen, axis])
        wanted.append(-(apart * direction).sum(axis=1)[chosen])
        base += len(chosen)
    shape = (base, 2 * len(corners))
    system = csr_array(coo_array((np.concatenate(values), (np.concatenate(i), np.concatenate(j))), shape=shape))
    motion = lsqr(system, np.concatenate(wanted), atol=1e-14, btol=1e-14, iter_lim=20 * len(corners) + 1000)[0]
    return np.asarray(motion).reshape(-1, 2)


def missed_joints(polygons: Sequence[Array]) -> str:
    """Say what the widest gap is that keeps facing edges from a joint, where there is one too small to be meant."""
    blocks = Blocks.from_polygons(polygons)
    start = blocks.vertices
    stop = start[blocks.successor]
    reach = NOTICED * np.sqrt(blocks.area)[blocks.owner][:, None]
    a, b = touching_boxes(np.minimum(start, stop) - reach, np.maximum(start, stop) + reach)
    a, b = a[blocks.owner[a] != blocks.owner[b]], b[blocks.owner[a] != blocks.owner[b]]
    along, length = stop - start, np.hypot(*(stop - start).T)
    along = along / length[:, None]
    facing = (along[a] * along[b]).sum(axis=1) < -1 + NOTICED**2
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
    return f"a gap of {gap[k]:.2g} m between {between} leaves no joint there; [wall] heal = {enough:.2g} would close it"
