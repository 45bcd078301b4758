"""Reader for DXF files: curves by layer, with INSERTs exploded, and a count of all other entities."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISREG
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import SceneError
from .curves import TURN, Arc, spline_points

KEY = "wall.drawing"

MAX_ENTITIES = 300_000
"""Maximum number of entities once INSERTs are exploded: a few nested INSERTs can multiply to any number."""

MAX_INSERT_DEPTH = 32
"""Maximum nesting depth of INSERTs."""

FLAT = 1e-6
"""Height above the drawing's plane, relative to the extent of a curve, up to which a curve lies in a plane."""

VIEWPORT = "VIEWPORT"
"""Entity that shows the model on a sheet of the paper space; it draws nothing itself."""

UNITS_KEY = "$INSUNITS"

HEADER_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
"""Units by their code in $INSUNITS."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """One curve of arcs and polylines ``(n, 2)`` in drawing units; each piece starts where the last one ends."""

    layer: str
    name: str
    pieces: tuple[Array | Arc, ...]
    closed: bool

    @property
    def has_length(self) -> bool:
        """Whether the curve is more than a single point."""
        return any(isinstance(piece, Arc) or (piece != piece[:1]).any() for piece in self.pieces)


@dataclass(frozen=True)
class ModelSpace:
    """Curves of a drawing, the number of omitted entities by type and place, and the units given in the header."""

    drawn: list[Drawn]
    left_out: Counter[tuple[str, str]]
    units: str | None


def read_dxf(path: Path) -> ModelSpace:
    """Read the model space of a DXF file.

    Layers that are off or frozen are not read, as a CAD program does not show them. Entities on layer 0 of a DXF block
    are on the layer of its INSERT.

    Raises
    ------
    SceneError
        For a file that is not DXF, for meshes, and for curves outside the plane of the drawing.
    """
    try:
        if not S_ISREG(path.stat().st_mode):  # reading a device never ends, and a pipe may have no writer
            raise SceneError(KEY, "cannot be read as DXF: it is not a regular file", str(path))
        try:
            from ezdxf.filemanagement import readfile  # slow import, so only once the file is known to exist
        except Exception as error:  # importing it reads user settings, and may fail without a home folder
            raise SceneError(KEY, f"cannot be read, for ezdxf cannot be imported: {error}", str(path)) from error
        document = readfile(path)
        left_out: Counter[tuple[str, str]] = Counter()
        drawn = []
        for entity, layer, name, placed in _Walk(document, left_out).all():
            curve = _curve(entity, layer, name, placed)
            if curve is None:
                left_out[entity.dxftype(), f"on layer {layer}"] += 1
            elif curve.has_length:
                drawn.append(curve)
            else:
                left_out[f"{entity.dxftype()} of no length", f"on layer {layer}"] += 1
        for sheet in document.layouts:
            if not sheet.is_modelspace:
                left_out.update(
                    (entity.dxftype(), "in paper space") for entity in sheet if entity.dxftype() != VIEWPORT
                )
        said = UNITS_KEY.encode() in path.read_bytes()  # ezdxf assumes metres if a file has no units
        return ModelSpace(drawn, left_out, HEADER_UNITS.get(document.header.get(UNITS_KEY, 0)) if said else None)
    except SceneError:
        raise
    except OSError as error:
        if error.strerror is None:  # raised by ezdxf for a file of another kind
            dwg = path.read_bytes()[:4] == b"AC10"
            what = "is a DWG file; save the drawing as DXF" if dwg else "is not a DXF file"
            raise SceneError(KEY, what, str(path)) from error
        raise SceneError(KEY, f"cannot be read as DXF: {error.strerror}", str(path)) from error
    except Exception as error:  # its parsers may raise anything on a damaged file
        raise SceneError(KEY, f"is not a valid DXF file: {str(error) or type(error).__name__}", str(path)) from error


class _Walk:
    """Iteration over the entities of a model space, with INSERTs exploded, each with its layer, name and placement.

    Placements ``(4, 4)`` multiply row vectors (x, y, z, 1) from the right. ezdxf does not explode INSERTs here, because
    it ignores the shear of one that is rotated within another that is stretched.
    """

    def __init__(self, document: Any, left_out: Counter[tuple[str, str]]) -> None:
        self._document, self._left_out, self._seen = document, left_out, 0
        self._layers = {_decoded(layer.dxf.name).lower(): layer for layer in document.layers}

    def all(self) -> Iterator[tuple[Any, str, str, Array]]:
        """All visible entities."""
        return self._within(self._document.modelspace(), None, "", np.eye(4), 0)

    def _within(
        self, entities: Any, owner: str | None, within: str, placed: Array, depth: int
    ) -> Iterator[tuple[Any, str, str, Array]]:
        for entity in entities:
            self._count(1)
            kind, own = entity.dxftype(), entity.dxf.get("layer", "0")
            if kind == "ATTDEF" and owner is not None:  # shown are the attributes of the INSERT
                continue
            layer = owner if owner is not None and own == "0" else self._spelt(own)
            name = f"{KEY}, {kind} {entity.dxf.handle}" if not within else f"{within}, {kind}"
            hidden = self._hidden(layer)
            if entity.dxf.get("invisible", 0) or (hidden and (kind != "INSERT" or hidden == "frozen")):
                self._left_out[kind, f"on layer {layer}, " + (f"which is {hidden}" if hidden else "invisible")] += 1
            elif kind == "INSERT":
                yield from self._exploded(entity, layer, name, placed, depth)
            else:
                yield entity, layer, name, placed

    def _exploded(
        self, insert: Any, layer: str, name: str, placed: Array, depth: int
    ) -> Iterator[tuple[Any, str, str, Array]]:
        if depth == MAX_INSERT_DEPTH:
            raise SceneError(name, f"nests INSERTs more than {MAX_INSERT_DEPTH} deep, or in themselves")
        if insert.block() is None or insert.block().block.is_xref:
            self._left_out["INSERT of another file", f"on layer {layer}"] += 1
            return
        several = insert.mcount > 1
        self._count(insert.dxf.row_count * insert.dxf.column_count if several else 1)
        for attribute in insert.attribs:
            self._left_out[attribute.dxftype(), f"on layer {layer}"] += 1
        for one in insert.multi_insert() if several else [insert]:
            own = np.array(list(one.matrix44())).reshape(4, 4)
            yield from self._within(insert.block(), layer, name, own @ placed, depth + 1)

    def _spelt(self, layer: str) -> str:
        """Name of a layer as spelt in the layer table: names that differ only in case are the same layer."""
        entry = self._layers.get(_decoded(layer).lower())
        return _decoded(layer if entry is None else entry.dxf.name)

    def _hidden(self, layer: str) -> str:
        entry = self._layers.get(layer.lower())
        if entry is None:
            return ""
        return "frozen" if entry.is_frozen() else "off" if entry.is_off() else ""

    def _count(self, more: int) -> None:
        self._seen += more
        if self._seen > MAX_ENTITIES:
            raise SceneError(KEY, f"holds more than {MAX_ENTITIES} entities, its INSERTs exploded")


def _decoded(name: str) -> str:
    """Decode a name: files before DXF 2007 escape characters missing in their code page as a backslash and U+XXXX."""
    from ezdxf.lldxf.encoding import decode_dxf_unicode

    return str(decode_dxf_unicode(name))


def _curve(entity: Any, layer: str, name: str, placed: Array) -> Drawn | None:
    """An entity as a curve; None if it is not a curve."""
    kind = entity.dxftype()
    closed = False
    if kind == "LINE":
        pieces: list[Array | Arc] = [_flat([entity.dxf.start, entity.dxf.end], name, placed)]
    elif kind in ("LWPOLYLINE", "POLYLINE"):
        pieces, closed = _polyline(entity, name, placed)
    elif kind in ("ARC", "CIRCLE", "ELLIPSE"):
        arc = _ellipse(entity, name, placed) if kind == "ELLIPSE" else _circle(entity, name, placed)
        pieces, closed = [arc], arc.closed
    elif kind == "SPLINE":
        from ezdxf.math import Matrix44

        points = spline_points(entity.construction_tool().transform(Matrix44(placed.ravel())))
        pieces, closed = [_flat(points, name, np.eye(4))], bool(entity.closed)
    else:
        return None
    return Drawn(layer, name, tuple(pieces), closed)


def _polyline(entity: Any, name: str, placed: Array) -> tuple[list[Array | Arc], bool]:
    if entity.dxftype() == "LWPOLYLINE":
        points, bulges = list(entity.vertices_in_wcs()), [row[0] for row in entity.get_points("b")]
        closed = entity.closed
    elif entity.is_2d_polyline or entity.is_3d_polyline:
        corners = [v for v in entity.vertices if not v.dxf.flags & 16]  # 16: spline control point
        places = [v.dxf.location for v in corners]
        points = places if entity.is_3d_polyline else list(entity.ocs().points_to_wcs(places))
        bulges, closed = [v.dxf.bulge for v in corners], entity.is_closed
    else:
        raise SceneError(KEY, "holds a mesh; each block is one closed polyline")
    flat = _flat(points, name, placed)
    own = _finite(np.array([tuple(p) for p in entity.ocs().points_from_wcs(points)]).reshape(-1, 3), name)
    pieces: list[Array | Arc] = []
    for k in range(len(flat) if closed else len(flat) - 1):
        following = (k + 1) % len(flat)
        if (flat[k] == flat[following]).all():
            continue
        if abs(bulges[k]) > 1e-12:
            arc = Arc.from_bulge(own[k, :2], own[following, :2], bulges[k])
            pieces.append(_placed_arc(entity, arc, float(own[k, 2]), name, placed))
        else:
            pieces.append(flat[[k, following]])
    return pieces, bool(closed)


def _circle(entity: Any, name: str, placed: Array) -> Arc:
    x, y, z = entity.dxf.center
    start, sweep = 0.0, TURN
    if entity.dxftype() == "ARC":
        start = float(np.radians(entity.dxf.start_angle))
        sweep = _sweep(start, float(np.radians(entity.dxf.end_angle)))
    arc = Arc(np.array([x, y]), entity.dxf.radius * np.eye(2), start, sweep)
    return _placed_arc(entity, arc, z, name, placed)


def _placed_arc(entity: Any, arc: Arc, elevation: float, name: str, placed: Array) -> Arc:
    """An arc in the coordinate system of an entity, at a height above its plane, as an arc of the drawing."""
    system = entity.ocs()
    centre, along, up = (
        system.to_wcs((x, y, z)) for (x, y), z in [(arc.centre, elevation), (arc.axes[0], 0), (arc.axes[1], 0)]
    )
    return _arc(centre, along, up, arc.start, arc.sweep, name, placed)


def _ellipse(entity: Any, name: str, placed: Array) -> Arc:
    start, sweep = entity.dxf.start_param, _sweep(entity.dxf.start_param, entity.dxf.end_param)
    return _arc(entity.dxf.center, entity.dxf.major_axis, entity.minor_axis, start, sweep, name, placed)


def _arc(centre: Any, along: Any, up: Any, start: float, sweep: float, name: str, placed: Array) -> Arc:
    _finite(np.array([start, sweep]), name)
    middle = _moved([centre], placed, name)[0]
    axes = _moved([along, up], placed * np.array([[1], [1], [1], [0]]), name)
    if (np.abs(axes[:, 2]) > FLAT * np.abs(axes[:, :2]).max()).any():
        raise SceneError(name, "does not lie in the drawing's plane")
    if not abs(np.linalg.det(axes[:, :2])) > 0:
        raise SceneError(name, "has no radius")
    return Arc.along(middle[:2], axes[:, :2], start, sweep)


def _sweep(start: float, end: float) -> float:
    sweep = (end - start) % TURN
    return TURN if sweep < 1e-12 or sweep > TURN - 1e-12 else float(sweep)


def _flat(points: Any, name: str, placed: Array) -> Array:
    """Points in space as points ``(n, 2)`` of the drawing's plane; they must lie in it or in a parallel plane."""
    found = _moved(points, placed, name)
    if len(found) and np.ptp(found[:, 2]) > FLAT * np.ptp(found[:, :2], axis=0).max():
        raise SceneError(name, "does not lie in the drawing's plane")
    return found[:, :2]


def _moved(points: Any, placed: Array, name: str) -> Array:
    """Points in space ``(n, 3)`` after a placement."""
    rows = _finite(np.array([(p[0], p[1], p[2]) for p in points], dtype=float).reshape(-1, 3), name)
    with np.errstate(over="ignore", invalid="ignore"):
        return _finite(rows @ placed[:3, :3] + placed[3, :3], name)


def _finite(values: Array, name: str) -> Array:
    if not np.isfinite(values).all():
        raise SceneError(name, "must have its corners at finite coordinates")
    return values
