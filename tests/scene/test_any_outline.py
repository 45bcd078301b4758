"""Blocks of any outline, convex or not: one body each in every model."""

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from fem_interface.model import fem
from meshing import wall_mesh
from runningbond.limit import limit, limit_nonassociated
from runningbond.results import Outcome
from runningbond.scene import (
    Array,
    BlockMaterial,
    Blocks,
    JointMaterial,
    Lateral,
    Load,
    Mortar,
    Scene,
    SceneError,
    build_scene,
    find_joints,
)
from runningbond.scene.cracks import cut_in_half

ELL = [(0, 0), (0.5, 0), (0.5, 0.25), (0.2, 0.25), (0.2, 1.2), (0, 1.2)]
PORTAL = [(0, 0), (0.2, 0), (0.2, 0.5), (0.8, 0.5), (0.8, 0), (1, 0), (1, 1), (0, 1)]
TEE = [(0, 0), (0.6, 0), (0.6, 0.2), (0.4, 0.2), (0.4, 1.0), (0.2, 1.0), (0.2, 0.2), (0, 0.2)]
ELASTIC = Mortar(1e10, 0.2, 0.01)
DRY = JointMaterial(0.0, elasticity=ELASTIC)


def box(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float]]:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def wall(*outlines: Any, friction: float = 2.0, direction: tuple[float, float] = (1.0, 0.0), **keys: Any) -> Scene:
    return build_scene(
        "outlines",
        [np.array(outline, dtype=float) for outline in outlines],
        thickness=0.1,
        block=BlockMaterial(2000.0, 1e12),
        joint=JointMaterial(friction, elasticity=ELASTIC),
        load=Load(live=(Lateral(direction),)),
        **keys,
    )


def holds(found: Outcome, exact: float) -> bool:
    assert found.status == "collapse"
    assert found.lower is not None
    assert found.upper is not None
    return found.lower <= exact * (1 + 1e-3) and found.upper >= exact * (1 - 1e-3)


@st.composite
def stars(draw: st.DrawFn) -> Array:
    """Star-shaped polygons, mostly not convex."""
    n = draw(st.integers(5, 12))
    turns = np.array(draw(st.lists(st.floats(0.5, 1.0), min_size=n, max_size=n)))
    radius = np.array(draw(st.lists(st.floats(0.1, 1.0), min_size=n, max_size=n)))
    angle = 2 * np.pi * np.cumsum(turns) / turns.sum()
    at = np.array([draw(st.floats(-50, 50)), draw(st.floats(-50, 50))])
    return np.asarray(at + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


@given(stars())
def test_area_moments_are_the_sum_over_triangles(star: Array) -> None:
    """Each triangle has J = A (a² + b² + c²) / 36 about its centroid."""
    blocks = Blocks.from_polygons([star])
    blocks.check()
    polygon = shapely.Polygon(star)
    middle = star.mean(axis=0)
    corners = np.stack([np.tile(middle, (len(star), 1)), star, np.roll(star, -1, axis=0)], axis=1)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    sides = sum(((corners[:, i] - corners[:, i - 1]) ** 2).sum(axis=1) for i in range(3))
    arm = corners.mean(axis=1) - blocks.centroid[0]
    assert blocks.area[0] == pytest.approx(polygon.area, rel=1e-9)
    assert blocks.centroid[0] == pytest.approx([polygon.centroid.x, polygon.centroid.y], rel=1e-9, abs=1e-9)
    assert blocks.polar_moment[0] == pytest.approx(float((area * (sides / 36 + (arm**2).sum(axis=1))).sum()), rel=1e-7)


@given(stars(), st.floats(-1.2, 1.2), st.floats(-1.2, 1.2))
def test_points_in_a_block_agree_with_shapely(star: Array, x: float, y: float) -> None:
    blocks = Blocks.from_polygons([star])
    point = star.mean(axis=0) + [x, y]
    away = shapely.Polygon(star).distance(shapely.Point(point))
    if away == 0 or away > 5 * blocks.tolerance:
        assert (len(blocks.containing(point)) == 1) == (away == 0)


@pytest.mark.parametrize(
    ("corners", "fault"),
    [
        ([(0, 0), (2, 0), (2, 2), (1, -0.5), (0, 2)], "crosses or touches itself"),
        ([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)], "crosses or touches itself"),
        ([(0, 0), (2, 0), (3, 0), (2, 0), (2, 2), (0, 2)], "crosses or touches itself"),
        ([(0, 0), (2, 0), (2, 0), (2, 2), (0, 2)], "has the same corner twice"),
        ([(0, 0), (2, 0), (2, 2), (0, 2), (float("nan"), 1)], "encloses no area"),
        (ELL[::-1], "encloses no area"),
    ],
)
def test_invalid_outlines_are_refused(corners: Any, fault: str) -> None:
    with pytest.raises(SceneError, match=fault):
        Blocks.from_polygons([np.array(box(5, 0, 6, 1), dtype=float), np.array(corners, dtype=float)]).check()


@pytest.mark.parametrize(
    ("other", "joints"),
    [
        (box(0.2, 0, 0.8, 0.5), [0.5, 0.5, 0.6]),  # fills the portal
        (box(0.3, 0, 0.7, 0.4), []),  # stands free in it
        (box(0.2, 0, 0.5, 0.4), [0.4]),
        (box(0.2, 0, 0.8, 0.6), None),  # overlaps its top, and touches both legs
        (box(0.1, -0.5, 0.8, 0.0), [0.1]),
        (box(0.1, -0.5, 0.9, 0.1), None),
    ],
)
def test_joints_on_several_sides_and_refused_overlaps(other: Any, joints: list[float] | None) -> None:
    blocks = Blocks.from_polygons([np.array(PORTAL, dtype=float), np.array(other, dtype=float)])
    if joints is None:
        with pytest.raises(SceneError, match="overlaps"):
            find_joints(blocks)
    else:
        assert sorted(find_joints(blocks).length.tolist())[: len(joints)] == pytest.approx(joints)


@pytest.mark.parametrize("model", [limit, limit_nonassociated, dem_static, dem_dynamic])
@pytest.mark.parametrize("outline", [ELL, PORTAL, TEE])
def test_overturning_and_sliding_of_a_block_of_any_outline(model: Any, outline: Any) -> None:
    """It overturns about its right or left corner at the ratio of its centroid's lever arms, or slides at λ = tan φ."""
    block = Blocks.from_polygons([np.array(outline, dtype=float)])
    (x, y), width = block.centroid[0], max(corner[0] for corner in outline)
    assert holds(model(wall(outline)), (width - x) / y)
    assert holds(model(wall(outline, direction=(-1.0, 0.0))), x / y)
    assert holds(model(wall(outline, friction=0.15)), 0.15)


def test_overturning_and_sliding_of_a_deformable_block() -> None:
    block = Blocks.from_polygons([np.array(ELL, dtype=float)])
    (x, y), width = block.centroid[0], 0.5
    assert holds(fem(wall(ELL), 0.05), (width - x) / y)
    assert holds(fem(wall(ELL, direction=(-1.0, 0.0)), 0.05), x / y)
    assert holds(fem(wall(ELL, friction=0.15), 0.05), 0.15)


CAP = [(0, 1), (0.4, 1), (0.4, 0.7), (0.8, 0.7), (0.8, 1), (1.2, 1), (1.2, 1.3), (0, 1.3)]
PIERS = [box(0, 0, 0.3, 1), box(0.9, 0, 1.2, 1)]
STEP = np.array([(-1, -1), (3, -1), (3, 0.25), (0.5, 0.25), (0.5, 0), (-1, 0)])
TROUGH = [(0, 0), (1, 0), (1, 2), (0.75, 2), (0.75, 0.5), (0.25, 0.5), (0.25, 2), (0, 2)]


@pytest.mark.parametrize("model", [limit, limit_nonassociated, dem_static, dem_dynamic])
def test_cap_on_two_piers_and_block_in_a_trough(model: Any) -> None:
    """Piers rock in parallel, λ = p / h, and the cap on them only translates, even with a part hanging between them; a
    block that a trough encloses on three sides overturns with it."""
    assert holds(model(wall(*PIERS, CAP, friction=1.0)), 0.3)
    assert holds(model(wall(TROUGH, box(0.25, 0.5, 0.75, 2), friction=1.0)), 0.5)


@pytest.mark.parametrize("model", [limit, limit_nonassociated, dem_static, dem_dynamic])
def test_frictionless_block_overturns_over_a_step_of_the_ground(model: Any) -> None:
    """A block b × h behind a step of height s: λ (h / 2 − s) = b / 2."""
    assert holds(model(wall(box(0, 0, 0.5, 1), friction=0.0, grounds=[STEP])), 0.25 / (0.5 - 0.25))


def test_deformable_block_in_a_trough() -> None:
    assert holds(fem(wall(TROUGH, box(0.25, 0.5, 0.75, 2), friction=1.0), 0.05), 0.5)


def test_a_mirrored_wall_has_the_same_multiplier() -> None:
    outlines = [*PIERS, CAP, [(x + 0.1, y + 1.3) for x, y in ELL]]
    mirrored = [[(-x, y) for x, y in reversed(outline)] for outline in outlines]
    for model in (limit, dem_static):
        right, left = model(wall(*outlines)), model(wall(*mirrored, direction=(-1.0, 0.0)))
        assert left.multiplier == pytest.approx(right.multiplier, rel=1e-8)


# --- cracks --------------------------------------------------------------------------------------------------------


@given(stars())
def test_halves_of_a_cut_block_have_its_whole_area(star: Array) -> None:
    pieces, whole = cut_in_half([star], 0.0)
    blocks = Blocks.from_polygons(pieces)
    blocks.check()
    assert not whole.any()
    assert len(pieces) >= 2
    assert blocks.area.sum() == pytest.approx(shapely.Polygon(star).area, rel=1e-9)
    assert find_joints(blocks).length.size >= len(pieces) - 1


def test_inner_joints_run_along_the_whole_vertical_axis() -> None:
    """A C is cut through both arms; the halves of a T with a frictionless cut overturn separately, at half width."""
    ring = [(0, 0), (1, 0), (1, 3), (0, 3), (0, 2), (0.8, 2), (0.8, 1), (0, 1)]
    scene = wall(ring, inner_joint=DRY)
    assert scene.joints.length[scene.joints.inner] == pytest.approx([1, 1])
    halves = wall(TEE, inner_joint=DRY)
    weak, strong = 0.15 / halves.blocks.centroid[1, 1], limit(wall(TEE)).multiplier
    glued = JointMaterial(0.6, 1e8, elasticity=ELASTIC)
    for model in (limit, dem_static, dem_dynamic):
        assert holds(model(halves), weak)
        assert holds(model(wall(TEE, inner_joint=glued)), strong or 0.0)


# --- deformable blocks ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cells", [1, 3])
def test_triangles_cover_each_block_exactly(cells: int) -> None:
    scene = wall(*PIERS, CAP, [(x + 0.1, y + 1.3) for x, y in ELL], grounds=[STEP + [0.7, 0]])
    mesh = wall_mesh(scene, cells)
    corners = mesh.points[mesh.triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    assert (area > 0).all()
    assert np.bincount(mesh.triangle_block, area) == pytest.approx(scene.blocks.area, rel=1e-9)
