"""Reader for COMPAS assemblies in JSON that does not need the COMPAS packages.

Supported are the layouts of compas_assembly 0.7 (COMPAS 1 and 2), of its older files without data types, and of the
BlockModel of compas_dem 0.3 to 0.6, alone or within an Analysis.
"""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from ..arrays import Array
from ..errors import SceneError
from .dxf import KEY

ASSEMBLY, MODEL = "compas_assembly.datastructures/Assembly", "compas_dem.models/BlockModel"

ANALYSIS = "compas_dem.models/Analysis"
"""Type of a file that holds a model and the problems to be solved for it."""

GROUP = "compas_model.elements/Group"

AXES = {"y": (0, 2), "x": (1, 2), "z": (0, 1)}
"""Plane of the wall for each direction of its thickness; z is up, except for a wall that lies flat."""

SAME_COORDINATE = 1e-6
"""Difference, relative to the size of the assembly, up to which two coordinates count as equal."""

ALIKE = 1e-3
"""Relative difference up to which two thicknesses count as equal: allows for unit conversion and rounded decimals."""


def read_compas(path: Path, unit: float, thickness: float | None = None) -> tuple[list[Array], list[Array], str]:
    """Read an assembly whose blocks are flat, or prisms along the thickness of the wall.

    Parameters
    ----------
    unit
        Length unit of the file [m].
    thickness
        Thickness of the wall [m], which decides along which axis it is viewed if several are possible.

    Returns
    -------
    blocks, supports : list of (n, 2) float
        Outlines, in the unit of the file.
    note
        In which plane the assembly was read, and its thickness.

    Raises
    ------
    SceneError
        For a file that is not an assembly, or an assembly that is not a plane wall.
    """
    if path.exists() and not path.is_file():
        raise SceneError(KEY, "cannot be read as JSON: it is not a regular file", str(path))
    try:
        content = json.loads(path.read_bytes())
    except OSError as error:
        raise SceneError(KEY, f"cannot be read as JSON: {error.strerror or error}", str(path)) from error
    except (RecursionError, ValueError) as error:
        raise SceneError(KEY, f"is not a valid JSON file: {error}", str(path)) from error
    try:
        found = [(name, *_mesh(block, name), _is_held(held, name)) for name, block, held in _blocks(content)]
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(KEY, f"is not a COMPAS assembly: {type(error).__name__}, {error}", str(path)) from error
    if not found:
        raise SceneError(KEY, "is an assembly without blocks", str(path))
    across, plane, size = _plane([(name, points) for name, points, *_ in found], unit, thickness)
    outlines = [(_outline(name, points, faces, across, plane, size), held) for name, points, faces, held in found]
    thick = float(np.ptp(found[0][1][:, across]))
    note = f"assembly: read in its {'xyz'[plane[0]]}-{'xyz'[plane[1]]} plane"
    note += f"; {thick:.6g} thick in the file's unit, in place of which wall.thickness counts" if thick else ""
    return [o for o, held in outlines if not held], [o for o, held in outlines if held], note


def _is_held(value: Any, name: str) -> bool:
    """Whether a block is a support, by its attribute; None is no support."""
    if value is None or value in (0, 1):
        return bool(value)
    raise SceneError(f"{KEY}, {name}.is_support", "must be true or false", value)


def _payload(value: Any) -> Any:
    """Data of a COMPAS object, without its wrapping: a data type and, in COMPAS 1, another table."""
    while isinstance(value, dict) and not {"vertex", "node"} & value.keys():
        inner = value.get("data", value.get("value"))
        if not isinstance(inner, dict):
            break
        value = inner
    return value


def _blocks(content: Any) -> Iterator[tuple[str, Any, bool]]:
    """Name of each block, its mesh and the placement that a model gives it, and whether it is a support."""
    if isinstance(content, dict) and {"assembly", "blocks"} <= content.keys():
        assembly = _payload(content["assembly"])
        usual = assembly.get("dva", {}).get("is_support", False)
        for key, block in content["blocks"].items():
            yield f"block {key}", (_payload(block), None), assembly["vertex"][key].get("is_support", usual)
        return
    kind = content.get("dtype") if isinstance(content, dict) else None
    if kind == ANALYSIS:
        content = content["data"]["model"]
        kind = content["dtype"]
    if kind not in (ASSEMBLY, MODEL):
        raise SceneError(f"{KEY}, dtype", f'must be "{ASSEMBLY}" or "{MODEL}"', kind if kind else "(none)")
    if kind == ASSEMBLY:
        graph = _payload(content.get("data", content.get("value"))["graph"])
        usual = graph.get("default_node_attributes", graph.get("dna", {})).get("is_support", False)
        for key, node in graph["node"].items():
            yield f"node {key}", (_payload(node["block"]), None), node.get("is_support", usual)
        return
    yield from _elements(content["data"])


def _elements(model: Any) -> Iterator[tuple[str, Any, bool]]:
    """Name of each element of a model, its mesh and placement, and whether it is a support."""
    placed = _placed(model)
    for number, (key, element) in enumerate(model["elements"].items()):
        data = element["data"]
        name = f"element {number} ({data.get('name')})"
        if "geometry" in data:
            yield name, (_payload(data["geometry"]), placed[key]), data["is_support"]
        elif element["dtype"] != GROUP:
            raise SceneError(f"{KEY}, {name}", "has no geometry in the file; read are blocks, and groups of them")


def _placed(model: Any) -> dict[str, Array]:
    """Placement ``(4, 4)`` of each element: its own transformation, then those of its parents and of the model."""
    own = {key: _matrix(element["data"]["transformation"]) for key, element in model["elements"].items()}
    whole = _matrix(model.get("transformation"))
    placed = {key: whole @ matrix for key, matrix in own.items()}
    nested = [(node, whole) for node in model["tree"]["root"].get("children", [])]
    while nested:
        node, outer = nested.pop()
        key = node["element"]
        placed[key] = outer @ own[key]
        nested += [(child, placed[key]) for child in node.get("children", [])]
    return placed


def _matrix(transformation: Any) -> Array:
    """Matrix ``(4, 4)`` of an affine transformation; the identity if there is none."""
    if transformation is None:
        return np.eye(4)
    matrix = np.array(transformation["data"]["matrix"], dtype=float)
    # An inverse may have rounding in its last row.
    if matrix.shape != (4, 4) or not np.allclose(matrix[3], (0.0, 0.0, 0.0, 1.0), rtol=0.0, atol=1e-12):
        what = "must be a matrix of 4 × 4 whose last row is 0, 0, 0, 1"
        raise SceneError(f"{KEY}, transformation", what, matrix.tolist())
    return matrix


def _mesh(block: tuple[Any, Any], name: str) -> tuple[Array, list[list[int]]]:
    """Corners ``(n, 3)``, and faces as lists of corner numbers."""
    mesh, motion = block
    usual = mesh.get("default_vertex_attributes", mesh.get("dva", {}))  # COMPAS omits default values
    keys = {key: k for k, key in enumerate(mesh["vertex"])}
    points = np.array([[(usual | vertex)[axis] for axis in "xyz"] for vertex in mesh["vertex"].values()], dtype=float)
    if motion is not None:
        points = points @ motion[:3, :3].T + motion[:3, 3]
    if not np.isfinite(points).all() or not len(points):
        raise SceneError(f"{KEY}, {name}", "must have its corners at finite coordinates")
    return points, [[keys[str(corner)] for corner in face] for face in mesh["face"].values()]


def _plane(meshes: list[tuple[str, Array]], unit: float, thickness: float | None) -> tuple[int, tuple[int, int], float]:
    """Axis of the thickness, along which all blocks span the same interval; both axes of the wall; its size."""
    low, high = (np.array([reach(points, axis=0) for _, points in meshes]) for reach in (np.min, np.max))
    size = float((high.max(axis=0) - low.min(axis=0)).max())
    scatter = np.maximum(np.ptp(low, axis=0), np.ptp(high, axis=0))
    fits = [name for name in AXES if scatter["xyz".index(name)] <= SAME_COORDINATE * size]
    if fits:
        thick = {name: unit * float((high - low)[0, "xyz".index(name)]) for name in fits}
        name = _across(thick, thickness, SAME_COORDINATE * size * unit)
        return "xyz".index(name), AXES[name], size
    # For the error message, the thickness is taken along the axis on which most blocks have the same extent.
    off = np.maximum(abs(low - np.median(low, axis=0)), abs(high - np.median(high, axis=0)))
    alike = (off <= SAME_COORDINATE * size).mean(axis=0)
    across = int(np.argmax(alike))
    if alike[across] <= 0.5:
        what = (
            "is an assembly in no plane across x, y or z: along none of them do its blocks reach as far as one another"
        )
        raise SceneError(KEY, f"{what}; turn it until its thickness lies along one")
    odd = int(np.argmax(off[:, across]))
    what = "does not reach as far as the others do along x, y or z; read are walls in a plane across one of these"
    raise SceneError(f"{KEY}, {meshes[odd][0]}", what)


def _across(thick: dict[str, float], thickness: float | None, flat: float) -> str:
    """Axis of the wall's thickness, out of the axes along which all blocks are equally thick, by `thick` [m].

    An axis along which blocks have zero thickness is taken first. Otherwise, of several axes it is the one along which
    blocks are as thick as the wall. If these are x and y, the assembly is a square pier, the same seen along both.
    """
    without = [name for name in thick if thick[name] <= flat]
    if without or len(thick) == 1:
        return next(iter(without or thick))
    alike = [name for name in thick if thickness is not None and abs(thick[name] - thickness) <= ALIKE * thickness]
    if len(alike) == 1 or set(alike) == {"x", "y"}:
        return alike[0]
    if alike:
        along = " and ".join(alike)
        remedy = (
            f"is how thick all blocks are along {along}; stand the assembly up along z, on a support of another size"
        )
    else:
        sides = " or ".join(f"{thick[name]:.6g} (seen along {name})" for name in thick)
        remedy = f"must be {sides}: all blocks of the assembly reach between the same two planes along each"
    raise SceneError("wall.thickness", remedy, thickness)


def _outline(
    name: str, points: Array, faces: list[list[int]], across: int, plane: tuple[int, int], size: float
) -> Array:
    """Outline of a prism: the area covered by its front faces, which must equal that of its back faces."""
    depth, flat = points[:, across], points[:, list(plane)]
    on = [np.abs(depth - level) <= SAME_COORDINATE * size for level in (depth.min(), depth.max())]
    front, back = (_covered([flat[face] for face in faces if side[face].all()]) for side in on)
    thin = SAME_COORDINATE * size * max(front.length, SAME_COORDINATE * size)
    if (
        front.geom_type != "Polygon"
        or front.is_empty
        or front.interiors
        or front.symmetric_difference(back).area > thin
    ):
        raise SceneError(f"{KEY}, {name}", "is not a prism across the wall, with one outline a side and no hole")
    rims = [flat[[*face, face[0]]] for face in faces if not any(side[face].all() for side in on)]
    along = shapely.covers(front.exterior.buffer(SAME_COORDINATE * size), [shapely.LineString(rim) for rim in rims])
    if not along.all():
        raise SceneError(
            f"{KEY}, {name}", "is not a prism across the wall: between its two sides it has another outline"
        )
    return np.array(front.exterior.coords)[:-1]


def _covered(corners: Sequence[Array]) -> shapely.Geometry:
    """Union of the faces ``(n, 2)``; empty if one crosses itself."""
    parts = [shapely.Polygon(face) for face in corners if len(face) > 2]
    return shapely.union_all(parts) if all(part.is_valid for part in parts) else shapely.Polygon()
