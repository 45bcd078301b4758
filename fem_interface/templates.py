"""Templates: the mesh and the modes that congruent blocks with equal supports have in common."""

from dataclasses import dataclass, replace

import numpy as np

from meshing import WallMesh
from runningbond.scene import Array, Indices, Mask, Scene, SceneError, table_of

from .block_operators import BlockOperators, block_operators
from .modes import ModeCount, Modes, block_modes, degree_of

PRODUCT_SIZE = 200_000
"""Largest number of multiplications in one matrix product; larger products are split, or the library starts threads."""


@dataclass(frozen=True, eq=False)
class Template:
    """Congruent blocks with the same modes.

    Parameters
    ----------
    blocks : (n,) int
        The blocks, column by column.
    modes
        The modes of each block.
    strain : (3 nt, m) float
        Mean strains ε_x, ε_y and γ_xy of each triangle of a block per coordinate [1/m].
    """

    blocks: Indices
    modes: Modes
    strain: Array


def templates(mesh: WallMesh, scene: Scene, count: ModeCount) -> list[Template]:
    """Templates of the blocks that move; a beam and moving supports have rigid modes only.

    If there are very many blocks of one kind, several templates share the same modes.

    Raises
    ------
    SceneError
        If blocks are to deform and the scene does not give their Young's modulus.
    """
    alike: dict[tuple[int, int, bytes, int], list[int]] = {}
    order = scene.column_by_column
    carried: Mask = np.asarray(scene.support_motion.any(axis=1))
    stiff = carried | scene.is_beam
    for block in order[~scene.fixed[order] | carried[order]].tolist():
        # Congruent blocks of one material with equal supports; each stiff block by itself.
        held = held_displacements(mesh, scene, block).tobytes()
        key = int(mesh.shape[block]), int(scene.material_of_block[block]), held, block if stiff[block] else -1
        alike.setdefault(key, []).append(block)
    kinds = list(alike.values())
    counts: list[ModeCount] = [3 if stiff[blocks[0]] else count for blocks in kinds]
    result = []
    for blocks, (modes, strain) in zip(kinds, _modes(mesh, scene, [one[0] for one in kinds], counts), strict=True):
        if carried[blocks[0]]:
            modes = replace(modes, mass=np.full(3, np.inf), inert=np.zeros((3, 2)))
        most = max(4, PRODUCT_SIZE // modes.shape.size)
        result += [Template(np.array(blocks[i : i + most]), modes, strain) for i in range(0, len(blocks), most)]
    return result


def nodes_of(mesh: WallMesh, block: int) -> slice:
    """Nodes of a block."""
    return slice(int(mesh.first_node[block]), int(mesh.first_node[block + 1]))


def triangles_of(mesh: WallMesh, block: int) -> Indices:
    """Triangles of a block in the numbering of its own nodes, ``(nt, 3)``."""
    return np.asarray(mesh.triangles[mesh.triangle_block == block] - mesh.first_node[block])


def rows_of(shape: Array, nodes: Indices) -> Array:
    """Rows of nodal displacements ``(2 nn, m)`` that belong to given nodes ``(n,)``, ``(2 n, m)``."""
    return np.asarray(shape[(2 * nodes[:, None] + [0, 1]).ravel()])


def held_displacements(mesh: WallMesh, scene: Scene, block: int) -> Array:
    """Displacements of a block that its pins keep at zero, per nodal displacement, ``(np, 2 nn)``.

    Raises
    ------
    SceneError
        If a pin is not at a node.
    """
    points = mesh.points[nodes_of(mesh, block)]
    own = np.flatnonzero(scene.pins.block == block)
    rows = np.zeros((len(own), len(points), 2))
    for row, pin in zip(rows, own, strict=True):
        distance = np.hypot(*(points - scene.pins.point[pin]).T)
        if scene.pins.turn[pin]:
            # The rotation of a rigid body, from two of its nodes.
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


def _modes(mesh: WallMesh, scene: Scene, blocks: list[int], counts: list[ModeCount]) -> list[tuple[Modes, Array]]:
    """Modes of given blocks, and the strains of these modes."""
    young, poisson = _moduli(scene, blocks, counts)
    degrees = np.array([degree_of(count) for count in counts])
    found: dict[int, tuple[Modes, Array]] = {}
    for degree in np.unique(degrees).tolist():
        which = np.flatnonzero(degrees == degree)
        operators = block_operators(mesh, np.array(blocks)[which].tolist(), young[which], poisson[which], degree)
        for k, each in zip(which.tolist(), operators, strict=True):
            found[k] = _modes_of(mesh, scene, blocks[k], each, counts[k])
    return [found[k] for k in range(len(blocks))]


def _moduli(scene: Scene, blocks: list[int], counts: list[ModeCount]) -> Array:
    """Young's modulus [Pa], zero for blocks that do not deform, and Poisson's ratio, ``(2, n)``."""
    moduli = np.zeros((2, len(blocks)))
    for k, (block, count) in enumerate(zip(blocks, counts, strict=True)):
        material = scene.block_materials[scene.material_of_block[block]]
        if count != 3 and material.young is None:
            key = f"{table_of(material)}.young"
            raise SceneError(key, "is missing: fem needs the stiffness of the blocks; dem-dynamic has rigid ones")
        moduli[:, k] = 0.0 if count == 3 else material.young or 0.0, material.poisson
    return moduli


def _modes_of(
    mesh: WallMesh, scene: Scene, block: int, operators: BlockOperators, count: ModeCount
) -> tuple[Modes, Array]:
    """Modes of a block, computed on triangles of their own degree and evaluated at the mesh nodes; their strains."""
    points, K, M, strain = operators
    density, nodes = float(scene.inertial_density[block]), nodes_of(mesh, block)
    held = held_displacements(mesh, scene, block)
    further = np.zeros((len(held), len(M) - held.shape[1]))
    thickness = float(scene.thickness_of_blocks[block])
    K, M = thickness * K, density * thickness * M
    modes = block_modes(points, K, M, np.hstack([held, further]), count)
    modes = replace(modes, inert=modes.inert * (scene.density[block] / density))
    vertices = 2 * (nodes.stop - nodes.start)
    strains = np.asarray(strain @ modes.shape)
    return replace(modes, rigid=modes.rigid[:vertices], shape=modes.shape[:vertices]), strains
