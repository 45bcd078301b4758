"""Blocks from a DXF drawing: one closed polyline a block, the lowest is the ground."""

from pathlib import Path

import numpy as np
import shapely
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from ezdxf.filemanagement import readfile
from ezdxf.lldxf.const import DXFError

from .arrays import Array
from .refusal import SceneError

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}


def read_drawing(path: Path, units: str) -> tuple[list[Array], Array]:
    """Read closed polylines from a drawing's model space.

    Parameters
    ----------
    path
        The DXF file.
    units
        A key of `METRES`.

    Returns
    -------
    blocks : list of (n, 2) float
        Outlines of the wall's blocks [m], counter-clockwise.
    ground : (n, 2) float
        Outline of the ground, the polyline whose centre lies lowest.
    """
    key = "wall.drawing"
    try:
        entities = list(readfile(path).modelspace().query("LWPOLYLINE POLYLINE"))
    except OSError as error:
        raise SceneError(key, f"cannot be read as DXF: {error.strerror or error}", str(path)) from error
    except DXFError as error:
        raise SceneError(key, f"is no valid DXF file: {error}", str(path)) from error
    outlines = [_outline(entity, METRES[units]) for entity in entities]
    if len(outlines) < 2:
        raise SceneError(key, f"holds {len(outlines)} polylines; it needs the ground and at least one block", str(path))
    lowest = min(range(len(outlines)), key=lambda i: outlines[i][:, 1].mean())
    ground = outlines.pop(lowest)
    return outlines, ground


def _outline(entity: object, scale: float) -> Array:
    if isinstance(entity, LWPolyline):
        points = [(x, y) for x, y in entity.get_points("xy")]
        curved, closed, handle = entity.has_arc, entity.closed, entity.dxf.handle
    elif isinstance(entity, Polyline):
        points = [(p.x, p.y) for p in entity.points()]
        curved, closed, handle = entity.has_arc, entity.is_closed, entity.dxf.handle
    else:  # pragma: no cover - the query yields nothing else
        raise TypeError(type(entity).__name__)
    name = f"wall.drawing, polyline {handle}"
    corners = np.array(points, dtype=float) * scale
    if len(corners) > 1 and np.allclose(corners[0], corners[-1], rtol=0, atol=0):
        corners, closed = corners[:-1], True
    if not closed:
        raise SceneError(name, "is open; each block is one closed polyline")
    if curved:
        raise SceneError(name, "has an arc; blocks have straight sides")
    if len(corners) < 3 or not np.isfinite(corners).all():
        raise SceneError(name, "must have at least three corners at finite coordinates")
    polygon = shapely.Polygon(corners)
    if not polygon.is_valid:
        raise SceneError(name, "crosses itself")
    # Corners in the middle of a straight side would cut one joint into two.
    straight = shapely.simplify(polygon, 1e-9 * np.sqrt(polygon.area))
    return np.array(shapely.geometry.polygon.orient(straight).exterior.coords)[:-1]
