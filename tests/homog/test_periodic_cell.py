"""One periodic cell of rigid blocks, cut out of a generated wall, reproduces the closed forms of `homog`.

The rigid kinematics is that of limit analysis, the bond and joints come from `scene`; the closed forms share only the
stiffness and strength of the joints with them.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import linprog

from homog import StrengthDomain, elastic_moduli
from runningbond.joints import JointPoints, joint_points, lobatto, point_strength
from runningbond.limit.kinematics import jump_operator
from runningbond.scene import Array, Bond, JointMaterial, Joints
from tests.walls import panel


@dataclass(frozen=True)
class Cell:
    """Two blocks of an infinite wall and their joints.

    `opening` and `slip` are the jumps at the points per unit of (six motions of the blocks, E11, E22, E12).
    """

    points: JointPoints
    opening: Array
    slip: Array
    area: float


def cell(width: float, height: float) -> Cell:
    """Cut the cell b × 2a out of a wall that contains it with all its neighbours."""
    size = {"wall__block_width": width, "wall__block_height": height}
    scene = panel(**size, wall__length=6 * width, wall__height=6 * height)
    centroid = scene.blocks.centroid
    inside = np.flatnonzero(
        (np.abs(centroid[:, 0] - 3.25 * width) < 0.5 * width) & (np.abs(centroid[:, 1] - 3 * height) < height)
    )
    assert len(inside) == 2
    owned = np.isin(scene.joints.block[:, 0], inside)
    joints = Joints(scene.joints.block[owned], scene.joints.ends[owned])
    points = joint_points(joints, 1.0, lobatto(3))
    jump = jump_operator(points, centroid)

    # A block moves like its image in the cell, plus the macroscopic strain times the distance between them.
    lattice = np.array([[width, 0.0], [0.0, 2 * height]])
    spread = np.zeros((3 * len(centroid), 9))
    for block, centre in enumerate(centroid):
        cells = (centre - centroid[inside]) @ np.linalg.inv(lattice)
        images = np.flatnonzero(np.abs(cells - np.rint(cells)).max(axis=1) < 1e-9)
        if len(images) == 0:
            continue  # half blocks at the ends of the wall
        x, y = centre - centroid[inside[images[0]]]
        spread[3 * block : 3 * block + 3, 3 * images[0] : 3 * images[0] + 3] = np.eye(3)
        spread[3 * block, 6:] = x, 0, y
        spread[3 * block + 1, 6:] = 0, y, x
    return Cell(points, jump.opening @ spread, jump.slip @ spread, 2 * width * height)


@pytest.mark.parametrize("block", [(0.24, 0.06), (0.12, 0.06), (0.06, 0.06), (0.06, 0.24)])
def test_elastic_energy_of_the_cell_gives_the_closed_form_moduli(block: tuple[float, float]) -> None:
    """Condensing the blocks' motions out of the cell's energy leaves diag(A1111, A2222, 4 A1212)."""
    k_nh, k_th, k_nv, k_tv = 80.0, 30.0, 50.0, 20.0
    unit = cell(*block)
    bed = np.abs(unit.points.normal[:, 1]) > 0.5
    k_n, k_t = np.where(bed, k_nh, k_nv) * unit.points.area, np.where(bed, k_th, k_tv) * unit.points.area
    energy = (unit.opening.T * k_n) @ unit.opening + (unit.slip.T * k_t) @ unit.slip
    blocks, strain = slice(0, 6), slice(6, 9)
    condensed = (
        energy[strain, strain]
        - energy[strain, blocks] @ np.linalg.pinv(energy[blocks, blocks]) @ (energy[blocks, strain])
    )
    moduli = elastic_moduli(*block, bed_normal=k_nh, bed_shear=k_th, head_normal=k_nv, head_shear=k_tv)
    expected = np.diag([moduli.a1111, moduli.a2222, 4 * moduli.a1212])
    assert condensed / unit.area == pytest.approx(expected, rel=1e-10, abs=1e-10 * moduli.a1111)


@pytest.mark.parametrize("block", [(0.24, 0.06), (0.06, 0.06), (0.06, 0.24)])
@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -1, 1), (-1, -1, 1), (0.3, -2, 1)])
@pytest.mark.parametrize("head", [JointMaterial(0.6, 1.0, 1 / 0.6), JointMaterial(0.4, 0.3, 0.5)])
def test_limit_analysis_of_the_cell_gives_the_strength_domain(
    block: tuple[float, float], direction: tuple[float, float, float], head: JointMaterial
) -> None:
    """Minimum dissipation of the cell over all mechanisms with unit power of Σ (kinematic theorem)."""
    joint = JointMaterial(0.6, 1.0, 1 / 0.6)
    unit = cell(*block)
    n = len(unit.points)
    bed = np.abs(unit.points.normal[:, 1]) > 0.5
    beds, heads = (point_strength(each, unit.points.area) for each in (joint, head))
    tension, shear = np.where(bed, beds.tension, heads.tension), np.where(bed, beds.shear, heads.shear)
    friction = np.where(bed, joint.friction, head.friction)
    power = np.zeros(9 + n)
    power[6:9] = direction[0], direction[1], 2 * direction[2]
    no_translation = np.zeros((2, 9 + n))
    no_translation[0, 0] = no_translation[1, 1] = 1  # translation of the cell causes no jumps
    split = np.hstack([np.zeros((n, 9)), np.eye(n)])  # bounds |slip|
    found = linprog(
        np.concatenate([tension @ unit.opening, shear]) / unit.area,
        A_ub=np.vstack(
            [
                np.hstack([unit.slip, -np.eye(n)]),
                np.hstack([-unit.slip, -np.eye(n)]),
                friction[:, None] * split - np.hstack([unit.opening, np.zeros((n, n))]),
            ]
        ),
        b_ub=np.zeros(3 * n),
        A_eq=np.vstack([power, no_translation]),
        b_eq=[1.0, 0, 0],
        bounds=[(None, None)] * 9 + [(0, None)] * n,
    )
    assert found.fun == pytest.approx(StrengthDomain(Bond(*block), joint, head).strength(direction), rel=1e-9)
