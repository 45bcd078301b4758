"""Expansion of stones that were drawn with mortar between them, up to the middle of the mortar.

Simplified micro-models require this (lourenco1997): mortar becomes part of the stones, and a joint a line of zero
thickness.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from ..arrays import Array
from ..errors import SceneError, place
from ..polygons import polygonal_parts, smaller_sides
from .middle_lines import SAMPLED, middle_lines, straightened

KEY = "wall.expand"

SHRUNK = 0.1
"""Distance by which stones are shrunk at first so that none touch, relative to the width of the widest joint."""

MAX_SAMPLES = 2e6
"""Maximum number of samples on all stones; a width that needs more is surely a slip, and would exhaust the memory."""

MAX_OVERLAP = 0.1
"""Overlap, relative to a stone's area, above which it is reported as the reason why expansion fails."""

GRID = 1e-6
"""Grid that corners are rounded to, relative to the width of the widest joint: without it, GEOS sometimes treats shapes
with almost coincident sides as disjoint."""


def expand(stones: Sequence[Array], grounds: Sequence[Array], width: float) -> tuple[list[Array], str]:
    """Expand stones to the middle of the mortar between them, and up to the ground, which is not changed.

    Parameters
    ----------
    stones, grounds : list of (n, 2) float
        Outlines, counter-clockwise [m].
    width
        Width of the widest joint [m]. Wider gaps stay open, except pockets between stones up to twice as wide.

    Returns
    -------
    expanded : list of (n, 2) float
        Outlines of the stones, in the given order; neighbours share the same line.
    note
        Mean width of the joints, and where gaps remain that are at most twice as wide as the widest joint.

    Raises
    ------
    SceneError
        For a width above the smaller side of the narrowest stone or negligible beside the length of all sides, and for
        stones that lie in others or in the ground, would enclose others, or fall into pieces.
    """
    corners = np.vstack([*stones])
    grid = GRID * width
    # Errors of coordinates by rounding grow with their size. Zero, where the ground often lies, is on the grid.
    origin = np.round(corners.mean(axis=0) / grid) * grid
    drawn = np.array([shapely.Polygon(stone - origin) for stone in stones])
    size = float(np.ptp(corners, axis=0).max())
    names = [f"block {k} at {place(stone.mean(axis=0), size)}" for k, stone in enumerate(stones)]
    _check(drawn, names, width)
    ground = shapely.union_all([shapely.Polygon(outline - origin) for outline in grounds], grid_size=grid)
    whole = _mortared(drawn, ground, width)
    cells = _cells(_apart(drawn, grid), whole, width)
    for k, cell in enumerate(cells):
        if cell.is_empty or cell.interiors or cell.area < drawn[k].area / 2:
            raise SceneError(KEY, _unfit(names[k], k, drawn, ground, bool(cell.interiors)), width)
    expanded = [np.array(shapely.geometry.polygon.orient(cell).exterior.coords)[:-1] + origin for cell in cells]
    return expanded, _note(drawn, ground, whole, cells, grid) + _left_open(ground, whole, width, origin, size)


def _check(drawn: Any, names: Sequence[str], width: float) -> None:
    """Refuse widths that are too large for joints between these stones, or so small that they need too many samples."""
    sides = smaller_sides(list(drawn))
    if width > sides.min():
        smallest = names[int(sides.argmin())]
        what = f"must be at most the smallest block's smaller side, {sides.min():.4g}: that of {smallest}"
        raise SceneError(KEY, what, width)
    length = float(shapely.length(drawn).sum())
    if length > MAX_SAMPLES * SAMPLED * width:
        what = f"must be at least {length / (MAX_SAMPLES * SAMPLED):.2g} m for blocks with {length:.3g} m of sides"
        raise SceneError(KEY, what, width)


def _cells(stones: Any, whole: Any, width: float) -> list[Any]:
    """Each stone's part of the wall, up to the middle of the mortar; an empty polygon for a stone without any."""
    inner = shapely.buffer(stones, -SHRUNK * width, join_style="mitre")
    lines = straightened(middle_lines(inner, whole, width), width)
    network = shapely.union_all([whole.boundary, *lines], grid_size=GRID * width)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(network)))
    faces = faces[shapely.contains(whole, shapely.point_on_surface(faces))]
    owner = shapely.STRtree(inner).nearest(shapely.point_on_surface(faces))
    together = [shapely.union_all(faces[owner == k], grid_size=GRID * width) for k in range(len(stones))]
    return [max(polygonal_parts(one), key=lambda part: float(part.area), default=shapely.Polygon()) for one in together]


def _note(drawn: Any, ground: Any, whole: Any, cells: Sequence[Any], grid: float) -> str:
    """Note on the mean width of the joints."""
    filled = whole.area - shapely.difference(shapely.union_all(drawn, grid_size=grid), ground, grid_size=grid).area
    bed = shapely.intersection(ground.boundary, whole.boundary, grid_size=grid).length if ground.area else 0.0
    length = (sum(cell.length for cell in cells) - whole.length) / 2 + bed
    if length < SHRUNK * np.sqrt(whole.area) or filled < 10 * grid * length:
        return "expand: there is no mortar between stones"
    return f"expand: stones take the mortar between them, {filled / length:.2g} m wide on average"


def _left_open(ground: Any, whole: Any, width: float, origin: Array, size: float) -> str:
    """Note on remaining gaps that are up to twice as wide as the widest joint; empty if there are none."""
    grid = GRID * width
    shut = _closed(shapely.union(whole, ground, grid_size=grid), 2 * width)
    known = shapely.union(whole, _closed(ground, 2 * width), grid_size=grid)
    left = polygonal_parts(shapely.difference(shut, known, grid_size=grid))
    gaps = sorted((gap for gap in left if gap.area > width**2), key=lambda gap: -float(gap.area))
    if not gaps:
        return ""
    at = place(shapely.get_coordinates(shapely.point_on_surface(gaps[0]))[0] + origin, size)
    if len(gaps) == 1:
        return f"; a gap wider than {width:g} m stays open at {at}"
    return f"; {len(gaps)} gaps wider than {width:g} m stay open, the largest at {at}"


def _unfit(named: str, k: int, drawn: Any, ground: Any, around: bool) -> str:
    """Reason why a stone cannot be expanded: it lies in something else, encloses something, or falls into pieces."""
    shared = shapely.area(shapely.intersection(drawn, drawn[k]))
    shared[k] = shapely.area(shapely.intersection(ground, drawn[k]))
    other = int(shared.argmax())
    if shared[other] > MAX_OVERLAP * drawn[k].area:
        what = "the ground" if other == k else f"block {other}"
        return f"finds {shared[other] / drawn[k].area:.0%} of {named} in {what}; draw each where it ends"
    if around:
        return f"has {named} go all around what it encloses; cut it in two, or give a smaller width"
    return f"leaves {named} in pieces; draw it anew"


def _mortared(drawn: Any, ground: Any, width: float) -> Any:
    """Stones with the mortar between them and on the ground: gaps up to a width, and pockets up to twice as wide."""
    grid = GRID * width
    stones = shapely.union_all(drawn, grid_size=grid)
    closed = _closed(shapely.union(stones, ground, grid_size=grid), width)
    # Gaps between pieces of the ground do not belong to the stones either.
    ground = shapely.union(ground, shapely.difference(_closed(ground, width), stones, grid_size=grid), grid_size=grid)
    parts = []
    for part in polygonal_parts(closed):
        holes = [ring for ring in part.interiors if not shapely.Polygon(ring).buffer(-width).is_empty]
        parts.append(shapely.Polygon(part.exterior, holes))
    return shapely.difference(shapely.union_all(parts, grid_size=grid), ground, grid_size=grid)


def _closed(shape: Any, width: float) -> Any:
    """Morphological closing of a shape: its gaps up to a width are filled."""
    grown = shapely.buffer(shape, width / 2, join_style="mitre")
    closed = shapely.union(shapely.buffer(grown, -width / 2, join_style="mitre"), shape, grid_size=GRID * width)
    return shapely.MultiPolygon(polygonal_parts(closed))  # without narrow parts, which the grid reduces to lines


def _apart(drawn: Any, grid: float) -> Any:
    """Stones without their overlaps with others; an overlap is divided between two stones like mortar."""
    one, other = shapely.STRtree(drawn).query(drawn, predicate="intersects")
    shared: dict[int, list[Any]] = defaultdict(list)
    for a, b in zip(one, other, strict=True):
        if a != b:
            shared[a].append(shapely.intersection(drawn[a], drawn[b], grid_size=grid))
    return np.array(
        [shapely.difference(stone, shapely.union_all(shared[k]), grid_size=grid) for k, stone in enumerate(drawn)]
    )
