"""Elastic moduli of a periodic cell of running bond: two blocks, rigid or deformable, and the joints they own.

A block moves like its image in the cell, plus the macroscopic strain times the distance between the two. The moduli
follow from the energy that the cell stores under that strain when its own coordinates are in equilibrium.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from runningbond.joints import JointPoints, lobatto, wall_points, wall_stiffness
from runningbond.limit.kinematics import Jump, jump_operator
from runningbond.scene import Array, Indices, Scene

from .joint_elements import nodal_jump
from .modal_wall import modal_wall
from .modes import ModeCount

RULE = lobatto(3)  # exact for the squared jumps of rigid blocks


class _Modes(NamedTuple):
    """A block's degrees of freedom per mode ``(f, m)`` and per translation ``(f, 2)``, and modal stiffness ``(m,)``."""

    shape: Array
    translation: Array
    stiffness: Array


def rigid_cell(scene: Scene) -> tuple[Array, int]:
    """Moduli of rigid blocks for strains E11, E22 and E12, ``(3, 3)`` [Pa], and the number of coordinates."""
    points = wall_points(scene, RULE)
    block = _Modes(np.eye(3), np.eye(3)[:, :2], np.zeros(3))
    return _moduli(scene, points, jump_operator(points, scene.blocks.centroid), [block] * len(scene.blocks))


def deformable_cell(scene: Scene, cells: int = 1, modes: ModeCount | None = None) -> tuple[Array, int]:
    """Moduli of blocks of triangles with as many modes as in `fem`, and the number of coordinates; see `rigid_cell`."""
    wall = modal_wall(scene, cells, modes, RULE)
    blocks = []
    for template, nodes in zip(wall.place[:, 0], np.diff(wall.mesh.first_node), strict=True):
        shape, stiffness = np.zeros((2 * nodes, 0)), np.zeros(0)  # for the ground, which no block of the cell touches
        if template >= 0:
            shape, stiffness = wall.templates[template].modes.shape, wall.templates[template].modes.stiffness
        blocks.append(_Modes(shape, np.tile(np.eye(2), (nodes, 1)), stiffness))
    return _moduli(scene, wall.elements.points, nodal_jump(wall.elements, len(wall.mesh.points)), blocks)


def _images(scene: Scene) -> tuple[Indices, Indices]:
    """Two whole blocks in the middle of a wall, and which of the two each block is an image of, −1 for none."""
    if scene.bond is None:
        raise ValueError("a cell is cut out of running bond")
    width, height = scene.bond.width, scene.bond.height
    centroid = scene.blocks.centroid
    whole = np.isclose(scene.blocks.area, width * height)
    middle = np.abs(centroid - [3.25 * width, 3 * height])
    inside = np.flatnonzero(whole & (middle[:, 0] < 0.5 * width) & (middle[:, 1] < height))
    if len(inside) != 2:
        raise ValueError("the wall is too small to cut a cell out of it")
    steps = (centroid[:, None] - centroid[inside]) / [width, 2 * height]
    alike = (np.abs(steps - np.rint(steps)).max(axis=2) < 1e-9) & whole[:, None]
    return inside, np.where(alike.any(axis=1), alike.argmax(axis=1), -1)


def _moduli(scene: Scene, points: JointPoints, jump: Jump, blocks: Sequence[_Modes]) -> tuple[Array, int]:
    """Stiffness for macroscopic strain with the cell's coordinates condensed out, and the number of coordinates n."""
    inside, images = _images(scene)
    row = np.cumsum([0, *(len(block.shape) for block in blocks)])
    column = np.cumsum([0, *(blocks[block].shape.shape[1] for block in inside)])
    spread = np.zeros((row[-1], column[-1] + 3))  # degrees of freedom of all blocks per coordinate and strain
    for block, image in enumerate(images):
        if image >= 0:
            own = slice(row[block], row[block + 1])
            spread[own, column[image] : column[image + 1]] = blocks[block].shape
            x, y = scene.blocks.centroid[block] - scene.blocks.centroid[inside[image]]
            spread[own, -3:] = blocks[block].translation @ [[x, 0, y], [0, y, x]]
    belongs = np.isin(points.block[:, 0], inside)
    normal, shear = ((k * points.area)[belongs, None] for k in wall_stiffness(scene, points.joint))
    opening, slip = (jump.opening @ spread)[belongs], (jump.slip @ spread)[belongs]
    energy, n = opening.T @ (normal * opening) + slip.T @ (shear * slip), int(column[-1])
    energy[:n, :n] += np.diag(np.concatenate([blocks[block].stiffness for block in inside]))
    # Scaled, because modal stiffnesses differ widely; pseudo-inverse, because the cell is free to translate.
    scale = 1 / np.sqrt(np.diag(energy)[:n])
    inner, coupling = energy[:n, :n] * scale[:, None] * scale, energy[:n, n:] * scale[:, None]
    condensed = energy[n:, n:] - coupling.T @ np.linalg.pinv(inner, 1e-12, hermitian=True) @ coupling
    return np.asarray(condensed / (scene.blocks.area[inside] @ scene.thickness_of_blocks[inside])), n
