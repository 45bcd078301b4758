"""Blocks that may crack: inner joints on their vertical axes, with their own strength."""

import itertools
from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from homog import homog
from runningbond.limit import limit
from runningbond.scene import Scene, SceneError, scene_from_dict
from runningbond.scene.cracks import cut_in_half
from tests.walls import content, panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
WEAK: dict[str, Any] = {"friction": 0.6, "mortar": MORTAR}
STRONG = {**WEAK, "cohesion": 1e6}


def wall(inner: dict[str, Any] | None, **changes: Any) -> Scene:
    size = {"wall__length": 0.96, "wall__height": 0.48, "joint__mortar": MORTAR, **changes}
    return panel(**size) if inner is None else panel(**size, inner_joint=inner)


def test_whole_blocks_are_cut_on_their_axis_half_blocks_are_not() -> None:
    plain, cracked = wall(None), wall(WEAK)
    width = np.array([np.ptp(plain.blocks.polygon(i)[:, 0]) for i in np.flatnonzero(plain.wall).tolist()])
    whole = int((width > 0.2).sum())
    assert cracked.joints.inner.sum() == whole
    assert cracked.wall.sum() == plain.wall.sum() + whole
    inner = cracked.joints.ends[cracked.joints.inner]
    assert np.ptp(inner[:, :, 0], axis=1) == pytest.approx(0, abs=1e-12)
    assert cracked.joints.length[cracked.joints.inner] == pytest.approx(0.06)
    assert cracked.mass.sum() == pytest.approx(plain.mass.sum(), rel=1e-12)
    assert not cracked.joints.inner[: len(plain.joints)].any()


def test_strong_inner_joints_give_limit_load_of_whole_blocks() -> None:
    """Sufficiently strong halves have the limit load of whole blocks in `limit` and `dem-static`."""
    assert limit(wall(STRONG)).multiplier == pytest.approx(limit(wall(None)).multiplier, rel=1e-8)
    assert dem_static(wall(STRONG)).multiplier == pytest.approx(dem_static(wall(None)).multiplier, rel=1e-6)


def test_cut_block_topples_at_load_of_its_halves() -> None:
    """b × h cut into two dry halves: the leading half topples alone at (b/2) / h, the whole block at b / h."""
    size = {"wall__length": 0.12, "wall__height": 0.24, "wall__block_width": 0.12, "wall__block_height": 0.24}
    rough = {"joint__friction": 2.0}
    smooth = {**WEAK, "friction": 0.0}
    for inner, exact in ((smooth, 0.06 / 0.24), (STRONG, 0.12 / 0.24)):
        scene = wall(inner, **size, **rough)
        assert limit(scene).multiplier == pytest.approx(exact, rel=1e-8)
        for found in (dem_static(scene), dem_dynamic(scene)):
            assert found.status == "collapse"
            assert found.lower is not None
            assert found.upper is not None
            assert found.lower <= exact * (1 + 1e-3)
            assert found.upper >= exact * (1 - 1e-3)


def test_weaker_inner_joints_reduce_limit_load() -> None:
    """λ decreases with the inner joints' cohesion from the value of whole blocks to that of dry halves."""
    found = [limit(wall({**WEAK, "cohesion": c})).upper for c in (1e6, 3e3, 1e3, 0.0)]
    assert all(a is not None and b is not None and b <= a + 1e-9 for a, b in itertools.pairwise(found))
    assert found[-1] is not None
    assert found[0] is not None
    assert found[-1] < 0.6 * found[0]


def test_drawn_block_is_cut_through_its_centroid() -> None:
    """A trapezium keeps its area, and both pieces stay counter-clockwise."""
    trapezium = np.array([[0.0, 0.0], [3.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    pieces, whole = cut_in_half([trapezium], 0.0)

    def area(p: np.ndarray[Any, Any]) -> float:
        x, y = p.T
        return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))

    assert whole.tolist() == [0, 0]
    assert all(area(piece) > 0 for piece in pieces)
    assert sum(map(area, pieces)) == pytest.approx(area(trapezium), rel=1e-12)


@pytest.mark.parametrize(
    ("inner", "message"),
    [
        ({"friction": -1.0}, "inner_joint.friction = -1.0"),
        ({**WEAK, "inset": 0.03}, "inner_joint.inset = 0.03: must be less than half the shortest joint, 0.06 m long"),
        (
            {**WEAK, "cohesoin": 1.0},
            'inner_joint.cohesoin = 1.0: is not a key of [inner_joint]; did you mean "cohesion"',
        ),
        ({**WEAK, "cohesion": 1.0, "tensile_strength": 9.0}, "inner_joint.tensile_strength = 9.0"),
        ({"friction": 0.6}, "inner_joint.mortar: is missing; joint has a stiffness"),
    ],
)
def test_invalid_inner_joints_are_refused_by_key(inner: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene_from_dict(content(inner_joint=inner, joint__mortar=MORTAR))
    assert message in str(refused.value)


def test_homog_refuses_inner_joints() -> None:
    with pytest.raises(SceneError, match="inner_joint"):
        homog(wall(WEAK))
