"""Lines and open curves joined into outlines: the enclosed areas that are blocks."""

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from scipy.spatial import cKDTree

from ..arrays import Array, Indices, Mask, components
from ..errors import SceneError, place
from .dxf import KEY

NEAR_MISS = 0.01
"""Gap between a line's end and the next line, relative to the longest line, below which they were meant to meet."""


def join(
    layer: str, curves: Sequence[Array], outlines: Sequence[Array], tolerance: float
) -> tuple[list[Array], list[int], str]:
    """Join the open curves of one layer into outlines.

    If every line was drawn once for each block beside it, every block has its own outline, and an enclosed area
    without an outline is an opening. Otherwise neighbours share lines, and every enclosed area is a block.

    Parameters
    ----------
    layer
        Name of the layer.
    curves : list of (n, 2) float
        Open curves.
    outlines : list of (n, 2) float
        Closed curves of the layer, which are cut where lines end on them.
    tolerance
        Distance up to which ends count as meeting.

    Returns
    -------
    found : list of (n, 2) float
        Outlines.
    cut : list of int
        Numbers of the given outlines that `found` replaces.
    note
        How the lines were interpreted.

    Raises
    ------
    SceneError
        For a loop that is not closed, with the positions of its ends.
    """
    edges, loose = _network(curves, tolerance)
    size = float(np.ptp(np.vstack(curves), axis=0).max())
    cut: list[int] = []
    closed: list[Array] = []
    if len(loose) and outlines:
        rings = shapely.linearrings([np.vstack([o, o[:1]]) for o in outlines])
        _, at = shapely.STRtree(rings).query(shapely.points(loose), predicate="dwithin", distance=tolerance)
        cut = sorted({int(k) for k in at})
        closed = [np.vstack([outlines[k], outlines[k][:1]]) for k in cut]
        edges, loose = _network([*curves, *closed], tolerance)
    if len(loose):
        places = " and ".join(place(at, size, 6) for at in loose[:2].round(9) + 0.0)
        more = f" and {len(loose) - 2} more" if len(loose) > 2 else ""
        remedy = "each block needs a closed outline; what is no block may lie on a layer that is off"
        raise SceneError(f"{KEY}, layer {layer}", f"is open at {places}{more}{_missed(loose[0], edges)}; {remedy}")
    faces = shapely.get_parts(shapely.polygonize(list(shapely.linestrings(edges))))
    if any(len(face.interiors) for face in faces):
        at = next(face for face in faces if len(face.interiors)).interiors[0].coords[0]
        raise SceneError(f"{KEY}, layer {layer}", f"has a block with a hole, at {place(at, size, 6)}")
    own = _own_outlines(faces, edges, [*curves, *closed], tolerance)
    chosen = faces if own is None else faces[own]
    ways = f"{len(curves)} lines and curves are joined into {len(chosen)} outline{'s' * (len(chosen) > 1)}"
    if own is None and len(faces) > 1:
        ways += "; neighbours share lines, so every area that they enclose is a block, an opening too"
    elif own is not None and not own.all():
        holes = int(np.sum(~own))
        ways += "; one area within them is an opening" if holes == 1 else f"; {holes} areas within them are openings"
    return [np.array(face.exterior.coords)[:-1] for face in chosen], cut, f"layer {layer}: {ways}"


def _missed(end: Array, edges: Array) -> str:
    """Text for the gap between an end ``(2,)`` and the nearest of the edges ``(n, 2, 2)``; empty if it is wide."""
    own = (edges == end).all(axis=2).any(axis=1)
    if own.all():
        return ""
    gap = float(shapely.distance(shapely.Point(end), shapely.linestrings(edges[~own])).min())
    length = float(np.hypot(*np.ptp(edges[~own], axis=1).T).max())
    return f", where a line ends {gap:.2g} drawing units from the next one" if gap < NEAR_MISS * length else ""


def _network(curves: Sequence[Array], tolerance: float) -> tuple[Array, Array]:
    """Edges ``(n, 2, 2)`` between all crossings and corners of curves, and the loose ends ``(m, 2)``."""
    points = np.vstack(curves)
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    group = components(pairs, len(points))
    _, first = np.unique(group, return_index=True)
    corner = first[group]
    stop = np.cumsum([len(curve) for curve in curves])
    here = np.setdiff1d(np.arange(len(points)), stop - 1)
    ends = np.column_stack([corner[here], corner[here + 1]])
    ends = ends[ends[:, 0] != ends[:, 1]]
    if not len(ends):
        return np.zeros((0, 2, 2)), points[:1]
    split = _split_at_corners(points, np.unique(corner), ends, tolerance)
    noded = shapely.get_parts(shapely.line_merge(shapely.unary_union(shapely.linestrings(points[split]))))
    edges = np.vstack([np.stack([line[:-1], line[1:]], axis=1) for line in map(shapely.get_coordinates, noded)])
    count = Counter(tuple(p) for p in edges.reshape(-1, 2).tolist())
    return edges, np.array([p for p, times in count.items() if times == 1]).reshape(-1, 2)


def _split_at_corners(points: Array, corners: Indices, ends: Indices, tolerance: float) -> Indices:
    """Split edges (pairs of point numbers) at corners that lie on them to within the tolerance, ``(n, 2)``."""
    lines = shapely.linestrings(points[ends])
    line, at = shapely.STRtree(shapely.points(points[corners])).query(lines, predicate="dwithin", distance=tolerance)
    at = corners[at]
    between = (at != ends[line, 0]) & (at != ends[line, 1])
    line, at = line[between], at[between]
    along = points[ends[line, 1]] - points[ends[line, 0]]
    place = ((points[at] - points[ends[line, 0]]) * along).sum(axis=1)
    owner = np.concatenate([np.arange(len(ends)), line, np.arange(len(ends))])
    order = np.lexsort((np.concatenate([np.full(len(ends), -np.inf), place, np.full(len(ends), np.inf)]), owner))
    chain = np.concatenate([ends[:, 0], at, ends[:, 1]])[order]
    owner = owner[order]
    within = owner[:-1] == owner[1:]
    return np.column_stack([chain[:-1][within], chain[1:][within]])


def _own_outlines(faces: Array, edges: Array, curves: Sequence[Array], tolerance: float) -> Mask | None:
    """Whether each face has an outline of its own, ``(nf,)`` bool; None if neighbours share lines.

    If no lines are shared, an edge was drawn once for each block beside it. These counts then decide which faces are
    blocks, from the outermost edges inwards. Shared lines lead to a contradiction.
    """
    drawn = shapely.linestrings(np.vstack([np.stack([curve[:-1], curve[1:]], axis=1) for curve in curves]))
    middle = shapely.points(edges.mean(axis=1))
    edge, _ = shapely.STRtree(drawn).query(middle, predicate="dwithin", distance=tolerance)
    times = np.bincount(edge, minlength=len(edges)).tolist()
    beside: dict[tuple[tuple[float, ...], ...], list[int]] = {}
    for k, face in enumerate(faces):
        ring = list(face.exterior.coords)
        for p, q in pairwise(ring):
            beside.setdefault((min(p, q), max(p, q)), []).append(k)
    links: list[list[tuple[int, int]]] = [[] for _ in range(len(faces) + 1)]
    for (p, q), m in zip(edges.tolist(), times, strict=True):
        a, b = [*beside.get((min(tuple(p), tuple(q)), max(tuple(p), tuple(q))), []), -1, -1][:2]
        links[a].append((b, m))
        links[b].append((a, m))
    share = {-1: 0}
    ahead = [-1]
    while ahead:
        a = ahead.pop()
        for b, m in links[a]:
            wanted = m - share[a]
            if wanted not in (0, 1) or share.get(b, wanted) != wanted:
                return None
            if b not in share:
                share[b] = wanted
                ahead.append(b)
    return np.array([share[k] == 1 for k in range(len(faces))])
