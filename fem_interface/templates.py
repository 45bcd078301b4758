"""Templates: what congruent blocks, held alike, have in common: one mesh, one set of modes."""

from dataclasses import dataclass, replace

import numpy as np

from meshing import WallMesh
from runningbond.scene import Array, Indices, Mask, Scene, SceneError, table_of

from .modes import ModeCount, Modes, block_modes, degree_of
from .operators import mass_matrix, nodes_of_degree, stiffness_matrix, strain_matrix

LARGE = 200_000
"""Multiplications of one matrix product; larger ones are cut up, or the library would start threads."""


@dataclass(frozen=True, eq=False)
class Template:
    """Congruent blocks.

    Parameters
    ----------
    blocks : (n,) int
        The blocks, column by column.
    modes
        Modes that all of them have.
    strain : (3 nt, m) float
        Mean strains ε_x, ε_y and γ_xy of each of their triangles per coordinate [1/m].
    """

    blocks: Indices
    modes: Modes
    strain: Array


def templates(mesh: WallMesh, scene: Scene, count: ModeCount) -> list[Template]:
    """Templates of the blocks that move, a beam and supports in rigid modes alone.

    Where there are very many blocks of one kind, several templates have the same modes.

    Raises
    ------
    SceneError
        If blocks are to deform and the scene does not say how stiff they are.
    """
    alike: dict[tuple[int, int, bytes, int], list[int]] = {}
    order = scene.column_by_column
    carried: Mask = np.asarray(scene.support_motion.any(axis=1))
    stiff = carried | (np.arange(len(scene.blocks)) == (scene.beam.block if scene.beam else -1))
    for block in order[~scene.fixed[order] | carried[order]].tolist():
        # Congruent blocks of one material that are held alike; each stiff one by itself.
        held = held_displacements(mesh, scene, block).tobytes()
        key = int(mesh.shape[block]), int(scene.material_of_block[block]), held, block if stiff[block] else -1
        alike.setdefault(key, []).append(block)
    result = []
    for blocks in alike.values():
        modes, strain = _modes(mesh, scene, blocks[0], 3 if stiff[blocks[0]] else count)
        if carried[blocks[0]]:
            modes = replace(modes, mass=np.full(3, np.inf), inert=np.zeros((3, 2)))
        most = max(4, LARGE // modes.shape.size)
        result += [Template(np.array(blocks[i : i + most]), modes, strain) for i in range(0, len(blocks), most)]
    return result


def nodes_of(mesh: WallMesh, block: int) -> slice:
    """Nodes of a block."""
    return slice(int(mesh.first_node[block]), int(mesh.first_node[block + 1]))


def triangles_of(mesh: WallMesh, block: int) -> Indices:
    """Triangles of a block, in numbers of its own nodes, ``(nt, 3)``."""
    return np.asarray(mesh.triangles[mesh.triangle_block == block] - mesh.first_node[block])


def rows_of(shape: Array, nodes: Indices) -> Array:
    """Rows of nodal displacements ``(2 nn, m)`` that some nodes have."""
    return np.asarray(shape[(2 * nodes[:, None] + [0, 1]).ravel()])


def held_displacements(mesh: WallMesh, scene: Scene, block: int) -> Array:
    """Displacements of a block that its pins keep at zero, per nodal displacement, ``(np, 2 nn)``.

    Raises
    ------
    SceneError
        Where a pin is not at a node.
    """
    points = mesh.points[nodes_of(mesh, block)]
    own = np.flatnonzero(scene.pins.block == block)
    rows = np.zeros((len(own), len(points), 2))
    for row, pin in zip(rows, own, strict=True):
        distance = np.hypot(*(points - scene.pins.point[pin]).T)
        if scene.pins.turn[pin]:
            # The rotation of a stiff body, from two nodes of it.
            other = int(np.argmax(np.hypot(*(points - points[0]).T)))
            x, y = points[other] - points[0]
            row[other] = np.array([-y, x]) / (x**2 + y**2)
            row[0] = -row[other]
            continue
        node = int(np.argmin(distance))
        if distance[node] > scene.blocks.tolerance:
            raise SceneError(scene.blocks.name(block), "is pinned where its mesh has no node")
        row[node] = scene.pins.direction[pin]
    return rows.reshape(len(own), 2 * len(points))


def _modes(mesh: WallMesh, scene: Scene, block: int, count: ModeCount) -> tuple[Modes, Array]:
    """Modes of a block, found on triangles of their own degree and taken at the nodes of the mesh; their strains."""
    material = scene.block_materials[scene.material_of_block[block]]
    degree = degree_of(count)
    corners, triangles = mesh.points[nodes_of(mesh, block)], triangles_of(mesh, block)
    points = nodes_of_degree(corners, triangles, degree)
    if count == 3:
        K = np.zeros((2 * len(points), 2 * len(points)))
    elif material.young is None:
        raise SceneError(f"{table_of(material)}.young", "is missing; this model needs it unless its blocks are rigid")
    else:
        K = stiffness_matrix(corners, triangles, material.young, material.poisson, scene.thickness, degree).toarray()
    density = float(scene.inertial_density[block])
    M = mass_matrix(corners, triangles, density, scene.thickness, degree).toarray()
    held = held_displacements(mesh, scene, block)
    further = np.zeros((len(held), len(M) - held.shape[1]))
    modes = block_modes(points, K, M, np.hstack([held, further]), count)
    modes = replace(modes, inert=modes.inert * (scene.density[block] / density))
    strain = strain_matrix(corners, triangles, degree) @ modes.shape
    return replace(modes, rigid=modes.rigid[: 2 * len(corners)], shape=modes.shape[: 2 * len(corners)]), strain
