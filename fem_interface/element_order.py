"""Runs of alike joint elements, along which a kernel walks through memory straight ahead.

A wall of equal blocks has few kinds of joint elements. Elements of one kind are put in the order of their blocks,
so that where element e lies between the blocks in rows p and q of their templates, element e + 1 as a rule lies
between p + 1 and q + 1.
"""

from dataclasses import replace

import numpy as np

from meshing import wall_mesh
from runningbond.joints import Rule
from runningbond.scene import Indices, Scene

from .cracks import Cracks, pieces
from .modal_wall import ModalWall
from .modes import BENDING, ModeCount
from .operators import PointsOn, joint_elements
from .templates import templates

RESOLUTION = 1e-9
"""Relative difference below which two elements are of one kind."""


def element_runs(wall: ModalWall) -> tuple[Indices, Indices]:
    """Find the runs of a wall.

    Returns
    -------
    (ne,) int
        Joint elements, run by run.
    (nr + 1,) int
        First element of each run in that order, then their number.
    """
    joint = wall.elements
    n, ne, _ = joint.weights.shape
    block = wall.mesh.block[joint.nodes[:, [0, 2]]]
    template, row = wall.place[block].transpose(2, 0, 1)
    held = template < 0
    local = np.where(held[:, [0, 0, 1, 1]], -1, joint.nodes - wall.mesh.first_node[block][:, [0, 0, 1, 1]])
    area = joint.points.area.reshape(n, ne).T
    values = [joint.normal, joint.weights.transpose(1, 0, 2).reshape(ne, 2 * n), area / area.max(initial=1e-300)]
    rounded = np.rint(np.column_stack(values) / RESOLUTION).astype(np.int64)
    material = wall.scene.material_of_joint[joint.points.joint[:ne]]
    _, kind = np.unique(np.column_stack([material, template, local, rounded]), axis=0, return_inverse=True)
    kind = kind.ravel()
    order = np.lexsort((np.where(held[:, 0], row[:, 1], row[:, 0]), kind))
    follows = (np.diff(row[order], axis=0) == 1) | held[order][1:]
    goes_on = np.zeros(ne, dtype=bool)
    goes_on[1:] = (np.diff(kind[order]) == 0) & follows.all(axis=1)
    return order, np.append(np.flatnonzero(~goes_on), ne)


def modal_wall(
    scene: Scene,
    cells: int = 1,
    modes: ModeCount | None = None,
    rule: Rule | None = None,
    points: PointsOn = "elements",
    cracks: Cracks = "joints",
) -> ModalWall:
    """Mesh a scene, find the modes of its blocks and put its joint elements in runs; see `fem_interface.model.fem`."""
    parts = pieces(scene, wall_mesh(scene, cells), cracks)
    joints = joint_elements(parts.mesh, parts.scene, rule, points)
    if modes is None:
        modes = BENDING if cracks == "joints" else "all"
    wall = ModalWall(parts, templates(parts.mesh, parts.scene, modes), joints)
    order, _ = element_runs(wall)
    return replace(wall, elements=joints.arranged(order))
