"""Blocks from a DXF drawing: one closed polyline a block, the lowest is the ground."""

from pathlib import Path
from typing import Any

import numpy as np
import shapely

from .arrays import Array
from .errors import SceneError

STRAIGHT = 2e-5
"""How far a corner may lie off a straight side, in sizes of its block: the rounding of a drawing, below any contact."""

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}


def read_drawing(path: Path, units: str) -> tuple[list[Array], Array]:
    """Read closed polylines from a drawing's model space.

    Units are a key of `METRES`.

    Returns
    -------
    blocks : list of (n, 2) float
        Outlines of the wall's blocks [m], counter-clockwise.
    ground : (n, 2) float
        Outline of the ground, the polyline whose centre lies lowest.

    Raises
    ------
    SceneError
        For what is no DXF file, or no drawing of a wall.
    """
    key = "wall.drawing"
    outlines = [_outline(entity, METRES[units]) for entity in _polylines(path, key)]
    if len(outlines) < 2:
        raise SceneError(key, f"holds {len(outlines)} polylines; it needs the ground and at least one block", str(path))
    lowest = min(range(len(outlines)), key=lambda i: outlines[i][:, 1].mean())
    ground = outlines.pop(lowest)
    return outlines, ground


def _polylines(path: Path, key: str) -> list[Any]:
    # A device has no end, and a pipe may have no other one.
    if path.exists() and not path.is_file():
        raise SceneError(key, "cannot be read as DXF: it is no regular file", str(path))
    try:
        from ezdxf.filemanagement import readfile
    except Exception as error:  # its import reads settings of the user's, who may have no home
        raise SceneError(key, f"cannot be read, for ezdxf cannot be imported: {error}", str(path)) from error
    try:
        return list(readfile(path).modelspace().query("LWPOLYLINE POLYLINE"))
    except OSError as error:
        raise SceneError(key, f"cannot be read as DXF: {error.strerror or error}", str(path)) from error
    except Exception as error:  # whatever its parsers raise on a file that is damaged
        raise SceneError(key, f"is no valid DXF file: {error}", str(path)) from error


def _outline(entity: Any, scale: float) -> Array:
    # World coordinates: a polyline that was mirrored has axes of its own.
    if entity.dxftype() == "LWPOLYLINE":
        points, closed = list(entity.vertices_in_wcs()), entity.closed
    elif entity.is_2d_polyline or entity.is_3d_polyline:
        points, closed = list(entity.points_in_wcs()), entity.is_closed
    else:
        raise SceneError("wall.drawing", "holds a mesh; each block is one closed polyline")
    name = f"wall.drawing, polyline {entity.dxf.handle}"
    corners = np.array([(p.x, p.y) for p in points], dtype=float).reshape(-1, 2) * scale
    if np.ptp([p.z for p in points] or [0.0]) * scale > 1e-6:
        raise SceneError(name, "does not lie in the drawing's plane")
    if len(corners) > 1 and np.allclose(corners[0], corners[-1], rtol=0, atol=0):
        corners, closed = corners[:-1], True
    if not closed:
        raise SceneError(name, "is open; each block is one closed polyline")
    if entity.has_arc:
        raise SceneError(name, "has an arc; blocks have straight sides")
    if len(corners) < 3 or not np.isfinite(corners).all():
        raise SceneError(name, "must have at least three corners at finite coordinates")
    polygon = shapely.Polygon(corners)
    if not polygon.is_valid:
        raise SceneError(name, "crosses itself")
    # Corners in the middle of a straight side would cut one joint into two.
    straight = shapely.simplify(polygon, STRAIGHT * np.sqrt(polygon.area))
    return np.array(shapely.geometry.polygon.orient(straight).exterior.coords)[:-1]
