"""Stones that were drawn with the mortar between them, expanded to the middle of the joints.

That is what simplified micro-models ask for (lourenco1997): mortar becomes a part of the stones, and a joint a line
without thickness. Its line is that of points as far from one stone as from another.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from scipy.spatial import Voronoi

from ..arrays import Array
from ..errors import SceneError, place
from ..polygons import polygonal_parts, smaller_sides

KEY = "wall.expand"

SHRUNK, SAMPLED = 0.1, 1 / 6
"""How far stones stand back from what was drawn, so that none touch, and how far their samples are apart, in joints'
largest widths: a middle line leaves the true one by less than a hundredth of that in a wide joint."""

STRAIGHTENED = 0.1
"""How far a joint's line may be from the middle of the mortar, in joints' largest widths."""

BUMP = 0.8
"""How far from a junction the middle of a joint that goes on through it is no part of its line, in largest widths: at
the end of a head joint it is an eighth of a width higher, on which nothing has to climb. At faces it bends as well."""

THROUGH = -0.8
"""Cosine of the angle between two of the lines that meet in a point from which on they are one, with a third beside."""

PAST, PAST_FACES = 1.0, 1.5
"""How far a line goes on past its end on another one, or near a face, which cuts it there, in largest widths."""

REACH = 2.5
"""How far from other stones samples are of use, in largest widths."""

MOST_SAMPLES = 2e6
"""Of all stones together, for which memory and a minute or two suffice."""

SHARED = 0.1
"""Of a stone's area that is in another one: what is more is no inaccuracy of a survey."""

GRID = 1e-6
"""What corners are rounded to, in largest widths: without, GEOS now and then takes shapes whose sides all but coincide
for ones that share nothing."""


def expand(stones: Sequence[Array], grounds: Sequence[Array], width: float) -> tuple[list[Array], str]:
    """Expand stones to the middle of the mortar between them, and to the ground, which stays.

    Parameters
    ----------
    stones, grounds : list of (n, 2) float
        Outlines, counter-clockwise [m].
    width
        Of the widest joint [m]; what is wider stays open, but for pockets between stones twice as wide.

    Returns
    -------
    expanded : list of (n, 2) float
        Outlines of the stones in their order, neighbours with the same line between them.
    note
        How wide joints are on average.

    Raises
    ------
    SceneError
        For a width above the smallest stone's smaller side or next to nothing beside all stones' sides, and for stones
        that lie in others or in the ground, or would go all around others.
    """
    origin = np.vstack([*stones]).mean(axis=0)  # corners far from zero would be rounded by more than they should
    drawn = np.array([shapely.Polygon(stone - origin) for stone in stones])
    sides = smaller_sides(list(drawn))
    if width > sides.min():
        what = f"must be at most the smallest block's smaller side, {sides.min():.4g}: that of {_name(sides, stones)}"
        raise SceneError(KEY, what, width)
    length = float(shapely.length(drawn).sum())
    if length > MOST_SAMPLES * SAMPLED * width:
        what = f"must be at least {length / (MOST_SAMPLES * SAMPLED):.2g} m for blocks with {length:.3g} m of sides"
        raise SceneError(KEY, what, width)
    grid = GRID * width
    ground = shapely.union_all([shapely.Polygon(outline - origin) for outline in grounds], grid_size=grid)
    whole = _mortared(drawn, ground, width)
    inner = shapely.buffer(_apart(drawn, grid), -SHRUNK * width, join_style="mitre")
    lines = _straightened(_middle_lines(inner, whole, width), width)
    network = shapely.union_all([whole.boundary, *lines], grid_size=grid)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(network)))
    faces = faces[shapely.contains(whole, shapely.point_on_surface(faces))]
    owner = shapely.STRtree(inner).nearest(shapely.point_on_surface(faces))
    expanded = []
    for k, stone in enumerate(stones):
        parts = shapely.get_parts(shapely.union_all(faces[owner == k], grid_size=grid))
        largest = max(parts, key=lambda part: float(part.area), default=None)
        if largest is None or largest.interiors or largest.area < drawn[k].area / 2:
            named = f"block {k} at {_place(stone, stones)}"
            raise SceneError(KEY, _unfit(named, k, drawn, ground, bool(largest and largest.interiors)), width)
        expanded.append(np.array(shapely.geometry.polygon.orient(largest).exterior.coords)[:-1] + origin)
    around = sum(shapely.Polygon(outline).length for outline in expanded)
    filled = whole.area - shapely.difference(shapely.union_all(drawn, grid_size=grid), ground, grid_size=grid).area
    bed = shapely.intersection(shapely.boundary(ground), whole.boundary, grid_size=grid).length if grounds else 0.0
    length = (around - whole.length) / 2 + bed
    if length < SHRUNK * np.sqrt(whole.area) or filled < 10 * grid * length:
        return expanded, "expand: there is no mortar between stones"
    return expanded, f"expand: stones take the mortar between them, {filled / length:.2g} m wide on average"


def _name(sides: Array, stones: Sequence[Array]) -> str:
    k = int(sides.argmin())
    return f"block {k} at {_place(stones[k], stones)}"


def _unfit(named: str, k: int, drawn: Any, ground: Any, around: bool) -> str:
    """Why a stone cannot be expanded: what it lies in, if it does, what it goes around, or that it comes apart."""
    shared = shapely.area(shapely.intersection(drawn, drawn[k]))
    shared[k] = shapely.area(shapely.intersection(ground, drawn[k]))
    other = int(shared.argmax())
    if shared[other] > SHARED * drawn[k].area:
        what = "the ground" if other == k else f"block {other}"
        return f"finds {shared[other] / drawn[k].area:.0%} of {named} in {what}; draw each where it ends"
    if around:
        return f"has {named} go all around what it encloses; cut it in two, or give a smaller width"
    return f"leaves {named} in pieces; draw it anew"


def _place(stone: Array, stones: Sequence[Array]) -> str:
    return place(stone.mean(axis=0), float(np.ptp(np.vstack([*stones]), axis=0).max()))


def _mortared(drawn: Any, ground: Any, width: float) -> Any:
    """Stones with the mortar between them and on the ground: all gaps up to a width, and pockets twice as wide."""
    grid = GRID * width
    stones = shapely.union_all(drawn, grid_size=grid)
    closed = _closed(shapely.union(stones, ground, grid_size=grid), width)
    # What is between pieces of the ground is as little a stone's.
    ground = shapely.union(ground, shapely.difference(_closed(ground, width), stones, grid_size=grid), grid_size=grid)
    parts = []
    for part in polygonal_parts(closed):
        holes = [ring for ring in part.interiors if not shapely.Polygon(ring).buffer(-width).is_empty]
        parts.append(shapely.Polygon(part.exterior, holes))
    return shapely.difference(shapely.union_all(parts, grid_size=grid), ground, grid_size=grid)


def _closed(shape: Any, width: float) -> Any:
    """A shape with its gaps up to a width."""
    grown = shapely.buffer(shape, width / 2, join_style="mitre")
    return shapely.union(shapely.buffer(grown, -width / 2, join_style="mitre"), shape, grid_size=GRID * width)


def _apart(drawn: Any, grid: float) -> Any:
    """Stones without what they share with others, which is between them as mortar is."""
    one, other = shapely.STRtree(drawn).query(drawn, predicate="intersects")
    shared: dict[int, list[Any]] = defaultdict(list)
    for a, b in zip(one, other, strict=True):
        if a != b:
            shared[a].append(shapely.intersection(drawn[a], drawn[b], grid_size=grid))
    return np.array(
        [shapely.difference(stone, shapely.union_all(shared[k]), grid_size=grid) for k, stone in enumerate(drawn)]
    )


def _middle_lines(inner: Any, whole: Any, width: float) -> list[Any]:
    """Lines of points as far from one stone as from another, within the wall and a little beyond, between junctions."""
    rings = shapely.boundary(shapely.segmentize(inner, SAMPLED * width))
    at, owner = shapely.get_coordinates(rings, return_index=True)
    near, stone = shapely.STRtree(inner).query(shapely.points(at), predicate="dwithin", distance=REACH * width)
    useful = np.unique(near[owner[near] != stone])
    if not len(useful):
        return []
    at, owner = at[useful], owner[useful]
    low, high = at.min(axis=0), at.max(axis=0)
    far = float((high - low).max()) + width
    frame = (low + high) / 2 + 2 * far * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    diagram = Voronoi(np.vstack([at, frame]))
    pair = np.append(owner, np.full(len(frame), -1))[diagram.ridge_points]
    ends = np.array(diagram.ridge_vertices)
    between = (pair[:, 0] != pair[:, 1]) & (pair >= 0).all(axis=1) & (ends >= 0).all(axis=1)
    # Where four samples lie on a circle, corners of their cells differ by rounding alone.
    segments = np.round(diagram.vertices[ends[between]] / far, 12) * far
    pair = np.sort(pair[between], axis=1)
    region = shapely.buffer(whole, width / 2)
    shapely.prepare(region)
    middle = segments.mean(axis=1)
    there = shapely.contains_xy(region, middle[:, 0], middle[:, 1]) & (segments[:, 0] != segments[:, 1]).any(axis=1)
    stones, of = np.unique(pair[there], axis=0, return_inverse=True)
    order = np.argsort(of.ravel(), kind="stable")
    merged = shapely.line_merge(
        shapely.multilinestrings(shapely.linestrings(segments[there][order]), indices=of.ravel()[order])
    )
    lines, of = shapely.get_parts(merged, return_index=True)
    return list(_in_the_middle(lines, inner[stones[of]]))


def _in_the_middle(lines: Any, stones: Any) -> Any:
    """Lines, each between its two stones ``(n, 2)``, whose corners but the ends are as far from one as from the other.

    Those of samples' cells are so within a hundredth of the widest joint, of which a bed's line would lean.
    """
    corners, line = shapely.get_coordinates(lines, return_index=True)
    inner = np.zeros(len(corners), dtype=bool)
    inner[1:-1] = (line[:-2] == line[1:-1]) & (line[1:-1] == line[2:])
    at, sides = corners[inner], stones[line[inner]]
    shapely.prepare(stones)
    for _ in range(2):  # the first time, it is there already between straight sides
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


def _straightened(lines: list[Any], width: float) -> list[Any]:
    """The lines, each as straight as it may be, those that are one through a junction as one."""
    ends = _ends(lines, width)
    partner = _partners(ends)
    bumps = {at for at, there in ends.items() if any(end in partner for end, _ in there)}
    faces = {at for at, there in ends.items() if len(there) == 1}
    free = dict.fromkeys(bumps, PAST) | dict.fromkeys(faces, PAST_FACES)
    found, seen = [], set[int]()
    # From ends that nothing goes on from; what is left over runs in circles.
    starts = [(k, side) for k in range(len(lines)) for side in (0, 1) if (k, side) not in partner]
    for start in (*starts, *((k, 0) for k in range(len(lines)))):
        if start[0] not in seen:
            path = _path(lines, partner, start, seen)
            inner = [at for at in map(tuple, path[1:-1]) if at in bumps]
            outer = [at for at in map(tuple, path[[0, -1]]) if at in faces]
            found.append(_simplified(path, np.array([*inner, *outer]).reshape(-1, 2), free, width))
    return found


def _ends(lines: list[Any], width: float) -> dict[tuple[float, float], list[tuple[tuple[int, int], Array]]]:
    """Where lines end: the number and the side of each line that does there, and its direction away from there."""
    found: dict[tuple[float, float], list[tuple[tuple[int, int], Array]]] = defaultdict(list)
    for k, line in enumerate(lines):
        corners, length = shapely.get_coordinates(line), min(width, float(line.length) / 2)
        for side, at, along in ((0, corners[0], length), (1, corners[-1], -length)):
            away = shapely.get_coordinates(shapely.line_interpolate_point(line, along))[0] - at
            found[(float(at[0]), float(at[1]))].append(((k, side), away / (np.hypot(*away) or 1.0)))
    return found


def _partners(
    ends: dict[tuple[float, float], list[tuple[tuple[int, int], Array]]],
) -> dict[tuple[int, int], tuple[int, int]]:
    """The end with which each end of a line goes on, if it does, at junctions of three lines or more."""
    partner: dict[tuple[int, int], tuple[int, int]] = {}
    for there in ends.values():
        if len(there) < 3:
            continue
        pairs = [(float(u @ v), a, b) for i, (a, u) in enumerate(there) for b, v in there[i + 1 :]]
        for cosine, a, b in sorted(pairs):
            if cosine < THROUGH and a not in partner and b not in partner:
                partner |= {a: b, b: a}
    return partner


def _path(
    lines: list[Any], partner: dict[tuple[int, int], tuple[int, int]], start: tuple[int, int], seen: set[int]
) -> Array:
    """Corners of the lines that are one from an end on, ``(n, 2)``."""
    parts, end = list[Array](), start
    while end[0] not in seen:
        k, side = end
        seen.add(k)
        corners = shapely.get_coordinates(lines[k])
        parts.append((corners if side == 0 else corners[::-1])[len(parts) > 0 :])
        end = partner.get((k, 1 - side), end)
    return np.vstack(parts)


def _simplified(corners: Array, bumps: Array, free: dict[tuple[float, float], float], width: float) -> Any:
    """A line with as few corners ``(n, 2)`` as it may have, without those near bumps ``(k, 2)``, past its free ends."""
    past = [width * free.get(tuple(at), 0.0) for at in corners[[0, -1]]]
    apart = np.hypot(*(corners[:, None] - bumps).transpose(2, 0, 1)).min(axis=1, initial=np.inf)
    stays = apart > BUMP * width
    stays[[0, -1]] |= apart[[0, -1]] > 0
    stays[[0, -1]] |= stays.sum() < 2
    straight = shapely.get_coordinates(shapely.simplify(shapely.linestrings(corners[stays]), STRAIGHTENED * width))
    if past[0]:
        straight[0] = _beyond(straight[1], straight[0], corners[0], past[0])
    if past[1]:
        straight[-1] = _beyond(straight[-2], straight[-1], corners[-1], past[1])
    return shapely.linestrings(straight)


def _beyond(start: Array, end: Array, to: Array, past: float) -> Array:
    """Where a side that goes on in its own direction is so far past a point ``(2,)`` [m]."""
    along = (end - start) / np.hypot(*(end - start))
    return np.asarray(start + (max(0.0, float((to - start) @ along)) + past) * along)
