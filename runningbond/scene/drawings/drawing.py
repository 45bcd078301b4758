"""Blocks from a drawing (DXF or COMPAS assembly) or from listed outlines: closed, cleaned, expanded and healed."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
import shapely

from ..arrays import Array
from ..blocks import Blocks
from ..errors import SceneError, place
from ..ground import strip_below
from ..polygons import smaller_sides, without_spikes
from ..ranges import one_of
from .compas import read_compas
from .curves import ROUNDING, Arc, Chords
from .dxf import KEY, Drawn, ModelSpace, read_dxf
from .expanding import expand as expanded
from .healing import heal as healed
from .healing import missed_joints
from .loops import join

STRAIGHT = 2e-5
"""Deviation from a side, in sizes of the smallest block, up to which a corner is removed: below contact tolerance."""

MAX_ROUNDING = 1e-4
"""Largest tolerance, in median sizes of drawn pieces: `ROUNDING` is too large if far-off strays enlarge a drawing."""

COLLINEAR_AREA = 1e-9
"""Area of an outline's convex hull, in squares of its larger extent, up to which its corners count as collinear."""

SLIVER = 0.01
"""Smaller side of an outline, relative to the median of all, below which it is a left-over sliver and not a stone."""

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}

GROUND_LAYERS = ("ground", "soil", "support", "base", "terrain")
"""Names, in lower or upper case, of the layers on which every outline is a piece of the ground."""


Corners: TypeAlias = Sequence[tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Drawing:
    """Content of a drawing.

    Parameters
    ----------
    blocks : list of (n, 2) float
        Outlines of the wall's blocks [m], counter-clockwise.
    layers
        Layer of each block; empty for an assembly and for listed outlines.
    grounds : list of (n, 2) float
        Outlines of the ground [m].
    notes
        What was joined, cut, moved and omitted, for the user.
    """

    blocks: list[Array]
    layers: tuple[str, ...]
    grounds: list[Array]
    notes: tuple[str, ...]


def read_drawing(
    path: Path,
    units: str,
    *,
    expand: float | None = None,
    heal: float | None = None,
    thickness: float | None = None,
    strip: float | None = None,
) -> Drawing:
    """Read a DXF drawing or, if the name of the file ends in .json, a COMPAS assembly.

    The ground is every outline on a layer of `GROUND_LAYERS` or, if there is none, the outline with the lowest mean
    height of its corners. For an assembly, the ground is its supports.

    Parameters
    ----------
    units
        A key of `METRES`.
    expand
        Stones are expanded to the middle of mortar joints up to this width [m]; None leaves them unchanged.
    heal
        Gaps and overlaps up to this width are closed afterwards [m]; None leaves them unchanged.
    thickness
        Thickness of the wall [m], which decides along which axis an assembly is viewed if several are possible.
    strip
        Reach, in sizes of the wall, of the strip of ground that is laid below an assembly without supports; None for
        none.

    Raises
    ------
    SceneError
        For a file of another kind, or a drawing that does not show a wall.
    """
    scale = METRES[one_of("wall.units", units, METRES)]
    if path.suffix.lower() == ".json":
        blocks, grounds, note = read_compas(path, scale, thickness)
        layers: list[str] = []
        notes = [note]
        if not grounds:
            notes.append("assembly: no block is a support; the wall stands on what [support] says")
        names = [f"{KEY}, assembly"] * (len(blocks) + len(grounds))
    else:
        space = read_dxf(path)
        blocks, layers, names, notes = _outlines(space)
        grounds = []
        if space.units not in (None, units):
            notes.append(f"units: the drawing's header says {space.units}, wall.units says {units}, which counts")
    outlines, spikes = _cleaned([scale * outline for outline in [*blocks, *grounds]], names)
    notes += [spikes] if spikes else []
    blocks, grounds = outlines[: len(blocks)], outlines[len(blocks) :]
    if path.suffix.lower() != ".json":
        passed_over = f" (left out: {_listed(space.left_out)})" if space.left_out else ""
        blocks, layers, grounds, more = _without_ground(blocks, layers, str(path), passed_over)
        notes += more
    if not blocks:
        raise SceneError(KEY, "is an assembly of supports; it needs at least one block", str(path))
    return _together(Drawing(blocks, tuple(layers), grounds, tuple(notes)), expand, heal, strip)


def listed_outlines(
    blocks: Sequence[Corners],
    grounds: Sequence[Corners],
    scale: float,
    *,
    expand: float | None = None,
    heal: float | None = None,
    strip: float | None = None,
) -> Drawing:
    """Clean, expand and heal the outlines listed in a scene file, in units of `scale` [m], like those of a drawing.

    Without ground, they may rest on a strip below the lowest of them, of a reach in sizes of the wall.
    """
    outlines = [np.array(corners) * scale for corners in (*blocks, *grounds)]
    names = [f"wall.{key}[{k}]" for key, of in (("outlines", blocks), ("ground", grounds)) for k in range(len(of))]
    cleaned, spikes = _cleaned(outlines, names)
    drawing = Drawing(cleaned[: len(blocks)], (), cleaned[len(blocks) :], (spikes,) if spikes else ())
    return _together(drawing, expand, heal, strip)


def _together(drawing: Drawing, expand: float | None, heal: float | None, strip: float | None) -> Drawing:
    """Expand the stones of a drawing, heal stones and ground, and add notes on remaining gaps and on slivers."""
    blocks, count, notes = drawing.blocks, len(drawing.blocks), drawing.notes
    if expand is not None:
        blocks, note = expanded(blocks, drawing.grounds, expand)
        blocks, notes = _cleaned(blocks, ["wall.expand"] * count)[0], (*notes, note)
    laid = [] if strip is None or drawing.grounds else [strip_below(Blocks.from_polygons(blocks), strip)]
    outlines = [*blocks, *drawing.grounds, *laid]
    if heal is not None:
        outlines, note = healed(outlines, heal, len(laid))
        notes = (*notes, note) if note else notes
    grounds = drawing.grounds if heal is None else outlines[count:]  # stones are healed onto the strip
    said = (missed_joints(outlines, heal or 0.0), _slivers(outlines))
    return Drawing(
        outlines[:count],
        drawing.layers,
        grounds,
        (*notes, *(note for note in said if note)),
    )


def _outlines(space: ModelSpace) -> tuple[list[Array], list[str], list[str], list[str]]:
    """Closed outlines of a model space, their layers and names, and notes."""
    pieces = [piece for curve in space.drawn for piece in curve.pieces]
    corners = np.vstack([np.zeros((0, 2)), *(piece.ends if isinstance(piece, Arc) else piece for piece in pieces)])
    tolerance = 0.0
    if len(corners):
        along = [piece.samples if isinstance(piece, Arc) else piece for piece in pieces]  # ends of circles coincide
        strokes = np.array([np.ptp(points, axis=0).max() for points in along])
        stroke = float(np.median(strokes[strokes > 0])) if strokes.any() else np.inf
        tolerance = min(ROUNDING * float(np.ptp(np.vstack(along), axis=0).max()), MAX_ROUNDING * stroke)
    arcs = [piece for piece in pieces if isinstance(piece, Arc)]
    chords = Chords(arcs, corners, tolerance)
    found: list[tuple[Array, str, str]] = []
    loose: dict[str, list[Array]] = {}
    for curve in space.drawn:
        points = _traced(curve, chords)
        again = np.hypot(*(points[0] - points[-1])) <= tolerance
        if curve.closed or (again and len(points) > 3):
            found.append((points[:-1] if again else points, curve.layer, curve.name))
        elif len(points) > 1:
            loose.setdefault(curve.layer, []).append(points)
    notes = []
    for layer, curves in loose.items():
        whole = [k for k, (_, its_layer, _) in enumerate(found) if its_layer == layer]
        joined, cut, note = join(layer, curves, [found[k][0] for k in whole], tolerance)
        notes.append(note)
        gone = {whole[k] for k in cut}
        found = [one for k, one in enumerate(found) if k not in gone]
        found += [(outline, layer, f"{KEY}, layer {layer}") for outline in joined]
    if arcs:
        notes.append(
            f"arcs: {len(arcs)} are cut into {chords.number} chords, which leave them by at most {chords.sagitta:.2g}"
            " drawing units, at the same corners for all who share one"
        )
    if space.left_out:
        notes.append(f"left out: {_listed(space.left_out)}")
    return [one[0] for one in found], [one[1] for one in found], [one[2] for one in found], notes


def _traced(curve: Drawn, chords: Chords) -> Array:
    parts = [chords.cut(piece) if isinstance(piece, Arc) else piece for piece in curve.pieces]
    return np.vstack([parts[0], *(part[1:] for part in parts[1:])])


def _listed(left_out: Counter[tuple[str, str]]) -> str:
    by_place: dict[str, list[str]] = {}
    for (kind, where), number in left_out.items():
        by_place.setdefault(where, []).append(f"{number} {kind}")
    return "; ".join(f"{', '.join(kinds)} {where}" for where, kinds in by_place.items())


def _without_ground(
    outlines: list[Array], layers: list[str], path: str, passed_over: str
) -> tuple[list[Array], list[str], list[Array], list[str]]:
    """Blocks, their layers, pieces of the ground, and notes if the ground was guessed or is on several layers."""
    if len(outlines) < 2:
        number = f"{len(outlines) or 'no'} closed outline{'s' * (len(outlines) != 1)}"
        what = f"holds {number}{passed_over}; it needs the ground and at least one block"
        raise SceneError(KEY, what, path)
    ground = [k for k, layer in enumerate(layers) if layer.lower() in GROUND_LAYERS]
    notes, own = list[str](), list(dict.fromkeys(layers[k] for k in ground))
    if len(own) > 1:  # with both a ground and a base, the base may be a plinth, and thus a stone
        notes.append(f"ground: all that lies on layers {' and '.join(own)} is ground, {len(ground)} outlines")
    if not ground:
        middle = np.array([outline[:, 1].mean() for outline in outlines])
        ground = [int(middle.argmin())]
        lowest = np.array([outline[:, 1].min() for outline in outlines])
        beside = int((lowest < middle[ground[0]]).sum())
        if beside > 1:
            what = f"has no outline on a layer named ground{passed_over}, and {beside} outlines lie as low"
            raise SceneError(KEY, f"{what}; put the ground on one of that name", path)
        at = place(outlines[ground[0]].mean(axis=0), float(np.ptp(np.vstack(outlines), axis=0).max()))
        notes.append(f"ground: no layer is named ground, so it is the lowest outline, at {at}")
    if len(ground) == len(outlines):
        raise SceneError(KEY, f"has all its outlines on layer {layers[0]}, which is the ground's", path)
    wall = [k for k in range(len(outlines)) if k not in set(ground)]
    if own:  # the ground was found by its layer, whose name may be meant for a plinth
        low = [float(outline[:, 1].min()) for outline in outlines]
        under = min(wall, key=low.__getitem__)
        if low[under] < min(low[k] for k in ground) - STRAIGHT * float(np.ptp(outlines[under][:, 1])):
            named = f"block {wall.index(under)}, on layer {layers[under]}"
            notes.append(f"ground: layer {' and '.join(own)}; {named}, lies lower")
    return [outlines[k] for k in wall], [layers[k] for k in wall], [outlines[k] for k in ground], notes


def _slivers(polygons: list[Array]) -> str:
    """Note on outlines that are too thin to be stones; empty if there are none."""
    sides = smaller_sides([shapely.Polygon(polygon) for polygon in polygons])
    thin = int(np.sum(sides < SLIVER * np.median(sides)))
    if not thin:
        return ""
    blocks, k = Blocks.from_polygons(polygons), int(sides.argmin())
    which = f"{blocks.name(k)} is {sides[k]:.2g} m thin" + (f", and {thin - 1} more are so" if thin > 1 else "")
    return f"slivers: {which}; the smallest block sets how wide a gap is contact, {blocks.tolerance:.2g} m"


def _where(polygon: shapely.Polygon) -> str:
    """Text for the point where a polygon crosses itself; empty if Shapely does not report one."""
    found = re.search(r"\[(\S+) (\S+)\]$", shapely.is_valid_reason(polygon))
    at = np.array(found.groups() if found else (np.nan, np.nan), dtype=float)
    low, high = np.reshape(polygon.bounds, (2, 2))
    return f" at {place(at, float((high - low).max()))} m" if np.isfinite(at).all() else ""


def _cleaned(outlines: list[Array], names: list[str]) -> tuple[list[Array], str]:
    """Outlines counter-clockwise, without spikes and without corners on straight sides; and a note on spikes.

    Such corners would divide a joint in two, and spikes would make joints with stones that they do not belong to.
    """
    for outline, name in zip(outlines, names, strict=True):
        if len(outline) < 3:
            raise SceneError(name, "must have at least three corners at finite coordinates")
    if not outlines:
        return [], ""
    hulls = shapely.area(shapely.convex_hull([shapely.Polygon(outline) for outline in outlines]))
    for outline, name, area in zip(outlines, names, hulls, strict=True):
        span = float(np.ptp(outline, axis=0).max())
        if area <= COLLINEAR_AREA * span**2:
            at = place(outline[0], span)
            raise SceneError(name, f"has no area: its corners, the first at {at} m, lie on one line or in one point")
    least = STRAIGHT * float(np.sqrt(shapely.area([shapely.Polygon(outline) for outline in outlines]).min()))
    polygons, tips = [], []
    for outline, name in zip(outlines, names, strict=True):
        ring, its_tips = without_spikes(outline, least)
        tips.append(its_tips)
        # Simplification keeps the first corner of a ring, so it must not lie in the middle of a straight side.
        first = int(np.lexsort(ring.T[::-1])[0])
        polygon = shapely.Polygon(np.roll(ring, -first, axis=0))
        if not polygon.is_valid:
            raise SceneError(name, f"crosses itself{_where(polygon)}")
        polygons.append(polygon)
    straight = shapely.simplify(polygons, least)
    cleaned = [np.array(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1] for polygon in straight]
    return cleaned, _spikes(np.vstack(tips), float(np.ptp(np.vstack(outlines), axis=0).max()))


def _spikes(tips: Array, span: float) -> str:
    """Note on the spikes removed from a wall of the size `span` [m], by their tips; empty if there are none."""
    if not len(tips):
        return ""
    where = f"{len(tips)} places, the first at " * (len(tips) > 1) + place(tips[0], span)
    return f"spikes: an outline turns back on itself at {where} m; what has no width is left out"
