"""Moduli of a periodic cell of running bond: two blocks, rigid or deformable, and the joints that are theirs.

A block moves like its image in the cell, plus the macroscopic strain times the distance between the two. What the
cell stores of that strain, once its own coordinates have found their equilibrium, are the moduli.
"""

from collections.abc import Sequence

import numpy as np

from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.operators import nodal_jump
from runningbond.joints import JointPoints, lobatto, wall_points, wall_stiffness
from runningbond.limit.kinematics import jump_operator
from runningbond.scene import Array, Indices, Scene

RULE = lobatto(3)  # exact for the squared jumps of rigid blocks


def rigid_cell(scene: Scene) -> tuple[Array, int]:
    """Moduli per strain E11, E22 and E12, ``(3, 3)`` [Pa], of rigid blocks, and the number of coordinates."""
    points = wall_points(scene, RULE)
    jump = jump_operator(points, scene.blocks.centroid)
    shapes = [np.eye(3)] * len(scene.blocks)
    translations = [np.eye(3)[:, :2]] * len(scene.blocks)
    inside, images = _images(scene)
    spread = _spread(scene, inside, images, shapes, translations)
    return _condensed(scene, points, inside, jump.opening @ spread, jump.slip @ spread, np.zeros(6)), 6


def deformable_cell(scene: Scene, cells: int = 1, modes: ModeCount | None = None) -> tuple[Array, int]:
    """The same of blocks in triangles, in as many modes as `fem` takes."""
    wall = modal_wall(scene, cells, modes, RULE)
    jump = nodal_jump(wall.elements, len(wall.mesh.points))
    shapes, translations = [], []
    for template, nodes in zip(wall.place[:, 0], np.diff(wall.mesh.first_node), strict=True):
        # The ground has no template; no block of the cell touches it.
        shapes.append(np.zeros((2 * nodes, 0)) if template < 0 else wall.templates[template].modes.shape)
        translations.append(np.tile(np.eye(2), (nodes, 1)))
    inside, images = _images(scene)
    spread = _spread(scene, inside, images, shapes, translations)
    own = np.concatenate([wall.templates[wall.place[block, 0]].modes.stiffness for block in inside])
    opening, slip = jump.opening @ spread, jump.slip @ spread
    return _condensed(scene, wall.elements.points, inside, opening, slip, own), len(own)


def _images(scene: Scene) -> tuple[Indices, Indices]:
    """Two whole blocks in the middle of a wall, and which of them each block is an image of, −1 for none."""
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


def _spread(
    scene: Scene, inside: Indices, images: Indices, shapes: Sequence[Array], translations: Sequence[Array]
) -> Array:
    """Freedoms of all blocks per coordinate of the cell and macroscopic strain."""
    row = np.cumsum([0, *(len(shape) for shape in shapes)])
    column = np.cumsum([0, *(shapes[block].shape[1] for block in inside)])
    spread = np.zeros((row[-1], column[-1] + 3))
    for block, image in enumerate(images):
        if image < 0:
            continue
        own = slice(row[block], row[block + 1])
        spread[own, column[image] : column[image + 1]] = shapes[block]
        x, y = scene.blocks.centroid[block] - scene.blocks.centroid[inside[image]]
        spread[own, -3:] = translations[block] @ [[x, 0, y], [0, y, x]]
    return spread


def _condensed(scene: Scene, points: JointPoints, inside: Indices, opening: Array, slip: Array, own: Array) -> Array:
    """Stiffness against macroscopic strain once the cell's coordinates are at rest, ``(3, 3)`` [Pa].

    Of jumps per coordinate and strain, ``(np, n + 3)``, and the stiffness of the coordinates themselves, ``(n,)``.
    """
    belongs = np.isin(points.block[:, 0], inside)
    normal, shear = ((k * points.area)[belongs, None] for k in wall_stiffness(scene, points.joint))
    opening, slip = opening[belongs], slip[belongs]
    energy = opening.T @ (normal * opening) + slip.T @ (shear * slip)
    n = len(own)
    energy[:n, :n] += np.diag(own)
    # Scaled, for the stiffnesses of modes lie far apart; the cell's translation alone is stopped by nothing.
    scale = 1 / np.sqrt(np.diag(energy)[:n])
    inner = energy[:n, :n] * scale[:, None] * scale
    coupling = energy[:n, n:] * scale[:, None]
    condensed = energy[n:, n:] - coupling.T @ np.linalg.pinv(inner, 1e-12, hermitian=True) @ coupling
    volume = scene.blocks.area[inside].sum() * scene.thickness
    return np.asarray(condensed / volume)
