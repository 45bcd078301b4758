"""Middle lines between stones: points equidistant from two stones, straightened like joints."""

from collections import defaultdict
from typing import Any, TypeAlias

import numpy as np
import shapely
from scipy.spatial import Voronoi

from ..arrays import Array, Indices

SAMPLED = 1 / 6
"""Spacing of the samples on the sides of stones, relative to the width of the widest joint: in a wide joint, lines
between their Voronoi cells are off the middle by less than a hundredth of that width."""

STRAIGHTENED = 0.1
"""Largest deviation of a joint's line from the middle of the mortar, relative to the width of the widest joint."""

BUMP_RADIUS = 0.8
"""Distance from a junction, in widths of the widest joint, within which the middle of a joint that continues through it
is ignored: at a head joint's end it bulges by an eighth of a width, an obstacle to sliding. It bends at faces too."""

CONTINUOUS_COSINE = -0.8
"""Cosine of the angle between two lines at a junction of three or more, below which they are one continuous line."""

EXTENSION, EXTENSION_AT_FACES = 1.0, 1.5
"""Extension of a line past its end on another line or near a face, in widths of the widest joint; it is cut there."""

REACH = 2.5
"""Distance from other stones up to which samples are used, in widths of the widest joint."""

Junction: TypeAlias = tuple[float, float]
"""Point where lines end [m]."""

End: TypeAlias = tuple[int, int]
"""Number of a line, and which of its ends: 0 is its start, 1 its stop."""


def middle_lines(inner: Any, whole: Any, width: float) -> list[Any]:
    """Lines between junctions, equidistant from two stones, inside the wall and a little beyond it."""
    at, owner = _samples(inner, width)
    if not len(at):
        return []
    segments, pair = _between_cells(at, owner, width)
    region = shapely.buffer(whole, width / 2)
    shapely.prepare(region)
    middle = segments.mean(axis=1)
    there = shapely.contains_xy(region, middle[:, 0], middle[:, 1]) & (segments[:, 0] != segments[:, 1]).any(axis=1)
    stones, of = np.unique(pair[there], axis=0, return_inverse=True)
    order = np.argsort(of.ravel(), kind="stable")
    pieces = shapely.linestrings(segments[there][order])
    merged = shapely.line_merge(shapely.multilinestrings(pieces, indices=of.ravel()[order]))
    lines, of = shapely.get_parts(merged, return_index=True)
    return list(_in_the_middle(lines, inner[stones[of]]))


def _samples(inner: Any, width: float) -> tuple[Array, Indices]:
    """Points ``(n, 2)`` [m] on the sides of stones that are near other stones, and their stones ``(n,)``."""
    rings = shapely.boundary(shapely.segmentize(inner, SAMPLED * width))
    at, owner = shapely.get_coordinates(rings, return_index=True)
    near, stone = shapely.STRtree(inner).query(shapely.points(at), predicate="dwithin", distance=REACH * width)
    useful = np.unique(near[owner[near] != stone])
    return at[useful], owner[useful]


def _between_cells(at: Array, owner: Indices, width: float) -> tuple[Array, Indices]:
    """Sides ``(n, 2, 2)`` [m] shared by Voronoi cells of two stones' samples, and these stones ``(n, 2)``, sorted."""
    low, high = at.min(axis=0), at.max(axis=0)
    far = float((high - low).max()) + width
    frame = (low + high) / 2 + 2 * far * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    diagram = Voronoi(np.vstack([at, frame]))
    pair = np.append(owner, np.full(len(frame), -1))[diagram.ridge_points]
    ends = np.array(diagram.ridge_vertices)
    between = (pair[:, 0] != pair[:, 1]) & (pair >= 0).all(axis=1) & (ends >= 0).all(axis=1)
    # If four samples lie on a circle, two corners of their cells coincide except for rounding errors.
    segments = np.round(diagram.vertices[ends[between]] / far, 12) * far
    return segments, np.sort(pair[between], axis=1)


def _in_the_middle(lines: Any, stones: Any) -> Any:
    """Lines, each between two stones ``(n, 2)``, with all corners except the ends moved to equal distance from both.

    Corners of the samples' cells are off by up to a hundredth of the widest joint, which would tilt bed joints.
    """
    corners, line = shapely.get_coordinates(lines, return_index=True)
    inner = np.zeros(len(corners), dtype=bool)
    inner[1:-1] = (line[:-2] == line[1:-1]) & (line[1:-1] == line[2:])
    at, sides = corners[inner], stones[line[inner]]
    shapely.prepare(stones)
    for _ in range(2):  # between straight sides the first step is exact
        apart, away = [], []
        for stone in sides.T:
            line_there = shapely.shortest_line(stone, shapely.points(at))
            off = np.diff(shapely.get_coordinates(line_there).reshape(-1, 2, 2), axis=1)[:, 0]
            apart.append(np.hypot(*off.T))
            away.append(off / np.maximum(apart[-1], np.finfo(float).tiny)[:, None])
        slope = away[0] - away[1]
        steep = (slope**2).sum(axis=1)
        at = at - np.where(steep > 1, (apart[0] - apart[1]) / steep.clip(1.0), 0.0)[:, None] * slope
    corners[inner] = at
    return shapely.set_coordinates(lines, corners)


def straightened(lines: list[Any], width: float) -> list[Any]:
    """Straighten the lines, after joining those that continue each other through a junction."""
    ends = _ends(lines, width)
    partner = _partners(ends)
    bumps = {at for at, there in ends.items() if any(end in partner for end, _ in there)}
    faces = {at for at, there in ends.items() if len(there) == 1}
    free = dict.fromkeys(bumps, EXTENSION) | dict.fromkeys(faces, EXTENSION_AT_FACES)
    found, seen = [], set[int]()
    # Paths start at ends without a continuation; the lines left over form closed loops.
    starts = [(k, side) for k in range(len(lines)) for side in (0, 1) if (k, side) not in partner]
    for start in (*starts, *((k, 0) for k in range(len(lines)))):
        if start[0] not in seen:
            path = _path(lines, partner, start, seen)
            inner = [at for at in map(tuple, path[1:-1]) if at in bumps]
            outer = [at for at in map(tuple, path[[0, -1]]) if at in faces]
            found.append(_simplified(path, np.array([*inner, *outer]).reshape(-1, 2), free, width))
    return found


def _ends(lines: list[Any], width: float) -> dict[Junction, list[tuple[End, Array]]]:
    """All points where lines end, each with the ends of lines there and their unit directions away from it."""
    found: dict[Junction, list[tuple[End, Array]]] = defaultdict(list)
    for k, line in enumerate(lines):
        corners, length = shapely.get_coordinates(line), min(width, float(line.length) / 2)
        for side, at, along in ((0, corners[0], length), (1, corners[-1], -length)):
            away = shapely.get_coordinates(shapely.line_interpolate_point(line, along))[0] - at
            found[(float(at[0]), float(at[1]))].append(((k, side), away / (np.hypot(*away) or 1.0)))
    return found


def _partners(ends: dict[Junction, list[tuple[End, Array]]]) -> dict[End, End]:
    """The end that continues each end of a line, if there is one, at junctions of three or more lines."""
    partner: dict[End, End] = {}
    for there in ends.values():
        if len(there) < 3:
            continue
        pairs = [(float(u @ v), a, b) for i, (a, u) in enumerate(there) for b, v in there[i + 1 :]]
        for cosine, a, b in sorted(pairs):
            if cosine < CONTINUOUS_COSINE and a not in partner and b not in partner:
                partner |= {a: b, b: a}
    return partner


def _path(lines: list[Any], partner: dict[End, End], start: End, seen: set[int]) -> Array:
    """Corners ``(n, 2)`` of the continuous line that begins with an end."""
    parts, end = list[Array](), start
    while end[0] not in seen:
        k, side = end
        seen.add(k)
        corners = shapely.get_coordinates(lines[k])
        parts.append((corners if side == 0 else corners[::-1])[len(parts) > 0 :])
        end = partner.get((k, 1 - side), end)
    return np.vstack(parts)


def _simplified(corners: Array, bumps: Array, free: dict[Junction, float], width: float) -> Any:
    """A line with as few corners as possible, none of them near bumps ``(k, 2)``, extended past its free ends."""
    past = [width * free.get(tuple(at), 0.0) for at in corners[[0, -1]]]
    apart = np.hypot(*(corners[:, None] - bumps).transpose(2, 0, 1)).min(axis=1, initial=np.inf)
    stays = apart > BUMP_RADIUS * width
    stays[[0, -1]] |= apart[[0, -1]] > 0
    stays[[0, -1]] |= stays.sum() < 2
    straight = shapely.get_coordinates(shapely.simplify(shapely.linestrings(corners[stays]), STRAIGHTENED * width))
    if past[0]:
        straight[0] = _beyond(straight[1], straight[0], corners[0], past[0])
    if past[1]:
        straight[-1] = _beyond(straight[-2], straight[-1], corners[-1], past[1])
    return shapely.linestrings(straight)


def _beyond(start: Array, end: Array, to: Array, past: float) -> Array:
    """Point on the extension of a side, at the distance `past` [m] beyond the projection of a point ``(2,)`` on it."""
    along = (end - start) / np.hypot(*(end - start))
    return np.asarray(start + (max(0.0, float((to - start) @ along)) + past) * along)
