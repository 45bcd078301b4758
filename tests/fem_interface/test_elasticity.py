"""Added compliance of deformable blocks, as a function of their stiffness."""

import numpy as np
import pytest

from fem_interface.joint_elements import nodal_jump
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.periodic_cell import deformable_cell
from homog import elastic_moduli
from meshing import wall_mesh
from runningbond.joints import lobatto
from runningbond.scene import Array
from tests.walls import panel

from .walls import whole


def _cell_moduli(width: float, height: float, young: float) -> Array:
    """Moduli of one periodic cell, ``(3, 3)`` [Pa]: two blocks and the joints they own, per unit thickness."""
    size = {"wall__block_width": width, "wall__block_height": height, "wall__thickness": 1.0}
    stiff = {"friction": 0.6, "normal_stiffness": 80e9, "shear_stiffness": 30e9}
    scene = panel(**size, wall__length=6 * width, wall__height=6 * height, block__young=young, joint=stiff)
    mesh, centroid = wall_mesh(scene), scene.blocks.centroid
    inside = np.flatnonzero(
        (np.abs(centroid[:, 0] - 3.25 * width) < 0.5 * width) & (np.abs(centroid[:, 1] - 3 * height) < height)
    )
    assert len(inside) == 2
    K, _ = whole(mesh, scene)
    jump = nodal_jump(modal_wall(scene, 1, 3, lobatto(3)).elements, len(mesh.points))
    points = modal_wall(scene, 1, 3, lobatto(3)).elements.points
    owned = np.isin(points.block[:, 0], inside)

    lattice = np.array([[width, 0.0], [0.0, 2 * height]])
    count = [2 * (mesh.first_node[b + 1] - mesh.first_node[b]) for b in inside]
    spread = np.zeros((2 * len(mesh.points), sum(count) + 3))
    for block, centre in enumerate(centroid):
        cells = (centre - centroid[inside]) @ np.linalg.inv(lattice)
        images = np.flatnonzero(np.abs(cells - np.rint(cells)).max(axis=1) < 1e-9)
        rows = slice(2 * mesh.first_node[block], 2 * mesh.first_node[block + 1])
        if len(images) == 0 or mesh.shape[block] != mesh.shape[inside[images[0]]]:
            continue
        image = int(images[0])
        own = slice(sum(count[:image]), sum(count[: image + 1]))
        spread[rows, own] = np.eye(count[image])
        x, y = centre - centroid[inside[image]]
        spread[rows, -3:] = np.tile([[x, 0, y], [0, y, x]], (count[image] // 2, 1))
    dofs = np.concatenate([np.arange(2 * mesh.first_node[b], 2 * mesh.first_node[b + 1]) for b in inside])
    blocks = spread[dofs].T @ K[dofs][:, dofs] @ spread[dofs]
    opening, slip = jump.opening[owned] @ spread, jump.slip[owned] @ spread
    area = points.area[owned, None]
    energy = blocks + opening.T @ (80e9 * area * opening) + slip.T @ (30e9 * area * slip)
    inner, strain = slice(0, -3), slice(-3, None)
    condensed = (
        energy[strain, strain]
        - energy[strain, inner] @ np.linalg.pinv(energy[inner, inner], 1e-13) @ (energy[inner, strain])
    )
    return np.asarray(condensed / (2 * width * height))


@pytest.mark.parametrize("block", [(0.24, 0.06), (0.06, 0.06), (0.06, 0.24)])
def test_added_compliance_falls_as_one_over_block_stiffness(block: tuple[float, float]) -> None:
    """Slope −1 ± 0.02 over three decades, in each of the three macroscopic strains."""
    moduli = elastic_moduli(*block, bed_normal=80e9, bed_shear=30e9, head_normal=80e9, head_shear=30e9)
    rigid = np.array([1 / moduli.a1111, 1 / moduli.a2222, 1 / (4 * moduli.a1212)])
    stiffness = np.array([1e12, 1e13, 1e14, 1e15])
    extra = np.array([np.diag(np.linalg.inv(_cell_moduli(*block, young))) - rigid for young in stiffness])
    assert (extra > 0).all()
    slopes = np.diff(np.log10(extra), axis=0)
    assert slopes == pytest.approx(-1.0, abs=0.02)


@pytest.mark.parametrize(
    ("modes", "cells", "ratio"),
    [(6, 1, 1.0), ("all", 1, 1.0), (10, 1, 0.852), (10, 2, 0.997), (20, 1, 0.810), (20, 2, 0.992)],
)
def test_third_degree_modes_are_too_soft_between_the_nodes_of_a_joint(
    modes: ModeCount, cells: int, ratio: float
) -> None:
    """Compressed cell of 240 × 120 mm: blocks and joints in series, but joints press a cubic edge at its nodes only."""
    size = {"wall__block_width": 0.24, "wall__block_height": 0.12, "wall__length": 1.44, "wall__height": 0.72}
    joint = {"friction": 0.6, "normal_stiffness": 1e11, "shear_stiffness": 4e10}
    scene = panel(**size, block__young=1e9, block__poisson=0.0, joint=joint)
    in_series = 1 / (1 / (0.12 * 1e11) + 1 / 1e9)
    moduli, _ = deformable_cell(scene, cells, modes)
    assert moduli[1, 1] / in_series == pytest.approx(ratio, abs=5e-4 if ratio < 1 else 1e-9)
