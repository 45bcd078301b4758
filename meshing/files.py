"""Mesh files that other programs read: MSH 4.1 written by gmsh, or VTU written by meshio."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from runningbond.results.store import replacing
from runningbond.scene import Indices, Scene, SceneError

from .materials import element_data
from .mesh import GROUPS, WallMesh, joint_group
from .session import gmsh_session

TRIANGLE, QUADRILATERAL = 2, 3
"""gmsh's numbers for the two element types."""

LAST_LINE = b"$EndElementData\n"


def write_mesh(mesh: WallMesh, scene: Scene, path: str | Path) -> None:
    """Write a mesh; after an error the file is as it was before.

    Parameters
    ----------
    mesh, scene
        The mesh and the wall that it was made of.
    path
        Output file; its suffix, ``.msh`` or ``.vtu``, determines the format. Its folder is created if missing.

    Raises
    ------
    SceneError
        For any other suffix.
    """
    path = Path(path)
    check_suffix(path)
    with replacing(path) as beside:
        _WRITERS[path.suffix.lower()](mesh, scene, str(beside))


def check_suffix(path: Path) -> None:
    """Refuse a file name whose suffix is not that of a mesh format."""
    if path.suffix.lower() not in _WRITERS:
        raise SceneError(str(path), f"must end in {' or '.join(_WRITERS)}, the formats of a mesh")


def _write_msh(mesh: WallMesh, scene: Scene, name: str) -> None:
    triangle_group, interface_group = _groups(mesh, scene)
    # Sorted by group, because some readers assume element data in the order of the file.
    order = np.argsort(interface_group, kind="stable")
    interfaces, interface_group = mesh.interfaces[order], interface_group[order]
    n_triangles, n_interfaces = len(mesh.triangles), len(interfaces)
    data = {
        title: np.concatenate([triangles, joints[order]])
        for title, (triangles, joints) in element_data(mesh, scene).items()
    }
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    node_group = _block_group(scene)[mesh.block]
    with gmsh_session() as gmsh:
        # One entity per group: with one per block, gmsh takes minutes for 20 000 blocks.
        for group in np.unique(np.concatenate([triangle_group, interface_group])):
            entity = gmsh.model.addDiscreteEntity(2, group + 1)
            nodes = np.flatnonzero(node_group == group)
            gmsh.model.mesh.addNodes(2, entity, nodes + 1, points[nodes].ravel())
            rows = np.flatnonzero(triangle_group == group)
            gmsh.model.mesh.addElementsByType(entity, TRIANGLE, rows + 1, mesh.triangles[rows].ravel() + 1)
            rows = np.flatnonzero(interface_group == group)
            corners = interfaces[rows].ravel() + 1
            gmsh.model.mesh.addElementsByType(entity, QUADRILATERAL, n_triangles + rows + 1, corners)
            gmsh.model.addPhysicalGroup(2, [entity], entity, GROUPS[group])
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.option.setNumber("Mesh.Binary", 1)  # text would round the coordinates
        gmsh.write(name)
        gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
        tags = np.arange(n_triangles + n_interfaces) + 1
        for title, values in data.items():
            view = gmsh.view.add(title)
            model = gmsh.model.getCurrent()
            gmsh.view.addHomogeneousModelData(view, 0, model, "ElementData", tags, values.astype(np.float64))
            gmsh.view.write(view, name, append=True)
    with open(name, "rb") as file:
        file.seek(max(0, os.path.getsize(name) - len(LAST_LINE)))
        if file.read() != LAST_LINE:  # gmsh does not check whether the disk is full
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), name)


def _write_vtu(mesh: WallMesh, scene: Scene, name: str) -> None:
    import meshio

    cells = [("triangle", mesh.triangles), ("quad", mesh.interfaces)]
    data = {name: list(values) for name, values in element_data(mesh, scene).items()}
    data["group"] = [group + 1 for group in _groups(mesh, scene)]
    if not len(mesh.interfaces):
        cells, data = cells[:1], {key: values[:1] for key, values in data.items()}
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    meshio.Mesh(points, cells, cell_data=data).write(name, file_format="vtu")


def _groups(mesh: WallMesh, scene: Scene) -> tuple[Indices, Indices]:
    """Groups of the triangles ``(nt,)`` and of the joint elements ``(ne,)``, as indices into `GROUPS`."""
    return _block_group(scene)[mesh.triangle_block], joint_group(scene)[mesh.joint]


def _block_group(scene: Scene) -> Indices:
    return np.where(scene.wall, GROUPS.index("block"), GROUPS.index("ground"))


_WRITERS: dict[str, Callable[[WallMesh, Scene, str], None]] = {".msh": _write_msh, ".vtu": _write_vtu}
