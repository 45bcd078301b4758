"""Assemblies of COMPAS, as its packages write them in JSON, read without them.

The layouts are those of compas_assembly 0.7 (COMPAS 1 and 2), of its files before there were types in them, and of
the BlockModel of compas_dem 0.3.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from ..arrays import Array
from ..errors import SceneError
from .dxf import KEY

ASSEMBLY, MODEL = "compas_assembly.datastructures/Assembly", "compas_dem.models/BlockModel"

AXES = {"y": (0, 2), "x": (1, 2), "z": (0, 1)}
"""The wall's plane for each direction of its thickness; up is z, but for a wall that lies flat."""

SAME = 1e-6
"""Difference of two coordinates that are one, in sizes of the assembly."""


def read_compas(path: Path) -> tuple[list[Array], list[Array], str]:
    """Read an assembly whose blocks are prisms across the wall, or flat.

    Returns
    -------
    blocks, supports : list of (n, 2) float
        Outlines, in the file's unit.
    note
        How the assembly lies in its space.

    Raises
    ------
    SceneError
        For what is no assembly, or none in a plane.
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
        found = [(name, *_mesh(block, name), held) for name, block, held in _blocks(content)]
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(KEY, f"is not a COMPAS assembly: {type(error).__name__}, {error}", str(path)) from error
    if not found:
        raise SceneError(KEY, "is an assembly without blocks", str(path))
    across, plane, size = _plane([(name, points) for name, points, *_ in found])
    outlines = [(_outline(name, points, faces, across, plane, size), held) for name, points, faces, held in found]
    thick = float(np.ptp(found[0][1][:, across]))
    note = f"assembly: read in its {'xyz'[plane[0]]}-{'xyz'[plane[1]]} plane"
    note += f"; {thick:.6g} thick in the file's unit, in place of which wall.thickness counts" if thick else ""
    return [o for o, held in outlines if not held], [o for o, held in outlines if held], note


def _payload(value: Any) -> Any:
    """What COMPAS wraps in a type and, in its first version, in a table of its own."""
    while isinstance(value, dict) and not {"vertex", "node"} & value.keys():
        inner = value.get("data", value.get("value"))
        if not isinstance(inner, dict):
            break
        value = inner
    return value


def _blocks(content: Any) -> Iterator[tuple[str, Any, bool]]:
    """Name, mesh and support of each block, with a model's motion of it."""
    if isinstance(content, dict) and {"assembly", "blocks"} <= content.keys():
        assembly = _payload(content["assembly"])
        usual = assembly.get("dva", {}).get("is_support", False)
        for key, block in content["blocks"].items():
            yield f"block {key}", (_payload(block), None), assembly["vertex"][key].get("is_support", usual)
        return
    kind = content.get("dtype") if isinstance(content, dict) else None
    if kind not in (ASSEMBLY, MODEL):
        raise SceneError(f"{KEY}, dtype", f'must be "{ASSEMBLY}" or "{MODEL}"', kind if kind else "(none)")
    if kind == ASSEMBLY:
        graph = _payload(content.get("data", content.get("value"))["graph"])
        usual = graph.get("default_node_attributes", graph.get("dna", {})).get("is_support", False)
        for key, node in graph["node"].items():
            yield f"node {key}", (_payload(node["block"]), None), node.get("is_support", usual)
        return
    model = content["data"]
    for element in model["elements"].values():
        data = element["data"]
        if "geometry" not in data or model.get("transformation") is not None:
            what = "is moved as a whole, or in groups; apply the transformations before it is written"
            raise SceneError(f"{KEY}, element {data.get('name')}", what)
        yield f"element {data.get('name')}", (_payload(data["geometry"]), data["transformation"]), data["is_support"]


def _mesh(block: tuple[Any, Any], name: str) -> tuple[Array, list[list[int]]]:
    """Corners ``(n, 3)`` and faces, by numbers of corners."""
    mesh, motion = block
    keys = {key: k for k, key in enumerate(mesh["vertex"])}
    points = np.array([[vertex[axis] for axis in "xyz"] for vertex in mesh["vertex"].values()], dtype=float)
    if motion is not None:
        matrix = np.array(motion["data"]["matrix"], dtype=float)
        points = points @ matrix[:3, :3].T + matrix[:3, 3]
    if not np.isfinite(points).all() or not len(points):
        raise SceneError(f"{KEY}, {name}", "must have its corners at finite coordinates")
    return points, [[keys[str(corner)] for corner in face] for face in mesh["face"].values()]


def _plane(meshes: list[tuple[str, Array]]) -> tuple[int, tuple[int, int], float]:
    """Direction of the thickness, in which all blocks reach from one plane to one other, and the wall's own two."""
    low, high = (np.array([reach(points, axis=0) for _, points in meshes]) for reach in (np.min, np.max))
    size = float((high.max(axis=0) - low.min(axis=0)).max())
    scatter = np.maximum(np.ptp(low, axis=0), np.ptp(high, axis=0))
    for name, plane in AXES.items():
        across = "xyz".index(name)
        if scatter[across] <= SAME * size:
            return across, plane, size
    across = int(np.argmin(scatter))
    odd = int(np.argmax(np.maximum(abs(low - np.median(low, axis=0)), abs(high - np.median(high, axis=0)))[:, across]))
    what = "is not as thick along any axis, or not in one plane with the others; read are walls in a plane"
    raise SceneError(f"{KEY}, {meshes[odd][0]}", what)


def _outline(
    name: str, points: Array, faces: list[list[int]], across: int, plane: tuple[int, int], size: float
) -> Array:
    """Outline of a prism: what its faces on one side cover, and those on the other side too."""
    depth, flat = points[:, across], points[:, list(plane)]
    sides = []
    for level in (depth.min(), depth.max()):
        on = np.abs(depth - level) <= SAME * size
        parts = [shapely.Polygon(flat[face]) for face in faces if len(face) > 2 and on[face].all()]
        sides.append(shapely.union_all(parts) if all(part.is_valid for part in parts) else shapely.Polygon())
    front, back = sides
    thin = SAME * size * max(front.length, SAME * size)
    if (
        front.geom_type != "Polygon"
        or front.is_empty
        or front.interiors
        or front.symmetric_difference(back).area > thin
    ):
        raise SceneError(f"{KEY}, {name}", "is not a prism across the wall, with one outline a side and no hole")
    return np.array(front.exterior.coords)[:-1]
