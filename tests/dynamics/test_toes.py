"""Which points are in the toes of a wall, and what breaks there."""

import numpy as np
import pytest

from runningbond.dynamics.toes import Toes
from runningbond.joints import wall_points
from runningbond.scene import Array, JointMaterial, Load, Mortar, build_scene
from tests.dynamics.test_led import OAK, N
from tests.fem_interface.walls import MORTAR
from tests.walls import panel


@pytest.mark.parametrize(("width", "height", "courses"), [(0.1, 0.1, 2), (0.1, 0.3, 4), (0.3, 0.1, 14), (0.7, 0.7, 14)])
def test_toes_of_symmetric_wall_are_mirror_images(width: float, height: float, courses: int) -> None:
    """Some joint points lie exactly at a quarter of the length; those of the joint at mid height are in both toes."""
    size = {"block_width": width, "block_height": height, "length": 4 * width, "height": courses * height}
    beam = {"height": 0.1, "condition": "free", "force": [0, -N], "drive": {"displacement": [1e-3, 0]}}
    scene = panel(wall=size | {"thickness": 0.1}, joint__mortar=MORTAR, load__live=None, beam=beam)
    points = wall_points(scene)
    wall_toes = Toes(scene, points)
    toes: list[Array] = []
    for towards in (False, True):
        whole = np.zeros(len(points))
        broken = [wall_toes.broken(whole, whole, crushed, right=towards) > 0 for crushed in np.eye(len(points))]
        toes.append(points.position[broken] / [4 * width, courses * height])
    left, right = (sorted(map(tuple, np.round(places, 6).tolist())) for places in (toes[0], toes[1] * [-1, 1] + [1, 0]))
    assert left == right
    all_of_it = points.position / [4 * width, courses * height] <= [0.25 + 1e-6, 0.5 + 1e-6]
    assert len(left) == all_of_it.all(axis=1).sum()


@pytest.mark.parametrize("at", [(0.0, 0.0), (-3.0, 2.0), (5.0, -7.0)])
def test_toes_of_column_are_its_lower_outer_quarters_wherever_it_stands(at: tuple[float, float]) -> None:
    """Two blocks of 1 m: only the lower one's base and the joint between them, at mid height, have points of toes."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) + at
    dry = JointMaterial(0.6, elasticity=Mortar(**MORTAR))
    blocks = [corners + (0.0, k) for k in range(3)]
    scene = build_scene("column", blocks, thickness=0.12, block=OAK, joint=dry, load=Load())
    points = wall_points(scene)
    wall_toes, whole = Toes(scene, points), np.zeros(len(points))
    x, y = (points.position - at).T
    for right, outer in ((False, x <= 0.25 + 1e-9), (True, x >= 0.75 - 1e-9)):
        broken = [wall_toes.broken(whole, whole, crushed, right=right) > 0 for crushed in np.eye(len(points))]
        assert broken == (outer & (y <= 1.5)).tolist()


def test_toe_is_broken_by_open_cracks_through_its_blocks_or_by_crushing() -> None:
    """The larger one counts; joints between blocks open without harm, and a crack that still holds is none."""
    inner_joint = {"friction": 0.6, "cohesion": 1e6, "mortar": MORTAR}
    scene = panel(wall__length=0.96, wall__height=0.48, joint__mortar=MORTAR, inner_joint=inner_joint)
    points = wall_points(scene)
    toes, one = Toes(scene, points), np.ones(len(points))
    for side, right in (((points.position[:, 0] < 0.48) * one, False), ((points.position[:, 0] > 0.48) * one, True)):
        assert toes.broken(1e-3 * side, one, 0.0 * one, right=right) == 1e-3
        assert toes.broken(1e-3 * side, one, 0.0 * one, right=not right) == 0.0
        assert toes.broken(1e-3 * side, 0.99 * one, 0.0 * one, right=right) == 0.0
        assert toes.broken(1e-3 * side * ~toes.is_inner, one, 0.0 * one, right=right) == 0.0
        assert toes.broken(-1e-3 * side, one, 0.0 * one, right=right) == 0.0
        assert toes.broken(1e-3 * side, one, 5e-4 * side, right=right) == 1e-3
        assert toes.broken(1e-3 * side, one, 2e-3 * side, right=right) == 2e-3
