"""Non-convex blocks at finite displacements: corners in notches, interlocked stones, convex parts."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from dem.dynamic import dem_dynamic
from dem.finite_system import finite_system
from fem_interface.model import fem
from runningbond.contacts.outline import Outline
from runningbond.contacts.reentrant import RUN_ON, ConvexParts, RunOn
from runningbond.contacts.search import find_contacts, jumps
from runningbond.limit import limit_nonassociated
from runningbond.response import follow
from runningbond.response.resting import Resting
from runningbond.scene import (
    Array,
    BlockMaterial,
    Blocks,
    History,
    JointMaterial,
    Lateral,
    Load,
    Mortar,
    PointLoad,
    Scene,
    build_scene,
)
from runningbond.scene.history import pulse
from tests.at_length import at_length
from tests.dynamics.test_led import brackets
from tests.dynamics.test_push import angles, follows
from tests.scene.test_any_outline import ELL, PORTAL, TEE, box, stars

MORTAR = Mortar(1e9, 0.2, 0.01)
LATERAL = Lateral((1.0, 0.0))


def stones(*outlines: Any, friction: float, inset: float = 0.0, live: Any = LATERAL, grounds: Any = None) -> Scene:
    return build_scene(
        "stones",
        [np.array(outline, dtype=float) for outline in outlines],
        grounds=grounds,
        thickness=0.1,
        block=BlockMaterial(2000.0, 1e10),
        joint=JointMaterial(friction, elasticity=MORTAR, inset=inset),
        load=Load(live=(live,)),
    )


@given(stars())
def test_blocks_are_cut_into_convex_parts_that_share_no_area(star: Array) -> None:
    """The parts use only the block's corners, and each side of the block is a full side of one part."""
    blocks = Blocks.from_polygons([np.array(box(60.0, 60.0, 61.0, 61.0)), star])
    parts = ConvexParts.of(blocks, np.zeros_like(blocks.vertices))
    rings = [parts.corner[start:stop] for start, stop in zip(parts.first[:-1], parts.first[1:], strict=True)]
    cut = Blocks.from_polygons([blocks.vertices[ring] for ring in rings])
    assert cut.convex.all()
    assert (len(cut) == 2) == bool(blocks.convex.all())
    owner = blocks.owner[[ring[0] for ring in rings]]
    assert np.bincount(owner, cut.area) == pytest.approx(blocks.area, rel=1e-9)
    for side, part in enumerate(parts.of_side):
        at = np.flatnonzero(rings[part] == side)
        assert np.roll(rings[part], -1)[at] == [blocks.successor[side]]


def turned_by(turn: float, outline: Any) -> Array:
    corners = np.array(outline, dtype=float)
    return np.asarray(corners @ [[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])


def extensions(outline: Array) -> RunOn:
    """Extensions of the sides of a block behind its re-entrant corners; the second block plays no role."""
    blocks = Blocks.from_polygons([outline, np.array(box(9, 9, 10, 10), dtype=float)])
    run = blocks.vertices[blocks.successor] - blocks.vertices
    return RunOn.of(blocks, run / np.hypot(*run.T)[:, None])


CROSS = [(1, 0), (2, 0), (2, 3), (6, 3), (6, 4), (2, 4), (2, 7), (1, 7), (1, 4), (-3, 4), (-3, 3), (1, 3)]


@given(st.floats(-3.1, 3.1))
def test_side_extends_half_way_to_the_side_in_line_with_it(turn: float) -> None:
    """For a rotated cross whose centre is 1 m by 1 m; sides do not extend beneath the opposite arm."""
    ways = extensions(turned_by(turn, CROSS))
    assert ways.far == pytest.approx(np.full(8, RUN_ON), rel=1e-9)


@given(st.floats(-3.1, 3.1), st.floats(1e-6, 1.0))
def test_side_extension_stays_inside_a_thin_block(turn: float, neck: float) -> None:
    """A notch leaves only a neck, which may be thinner than the contact tolerance."""
    outline = turned_by(turn, [(0, 0), (5, 0), (5, 3), (3, 3), (3, neck), (2, neck), (2, 3), (0, 3)])
    ways = extensions(outline)
    assert len(ways.far) == 4
    inside = shapely.Polygon(outline).buffer(1e-9)
    assert all(inside.covers(shapely.Point(point)) for point in ways.point)


FORMS = [np.array(outline, dtype=float) for outline in (ELL, PORTAL, TEE)]


def beside(inset: float, forms: tuple[int, int], at: tuple[float, float], turned: tuple[float, float]) -> Any:
    """Scene, outline and motion of two rotated non-convex stones; `at` is from centroid to centroid."""
    scene = stones(FORMS[forms[0]], FORMS[forms[1]] + [3.0, 0.0], friction=0.6, inset=inset)
    one, other = np.flatnonzero(scene.wall)
    motion = np.zeros((len(scene.blocks), 3))
    motion[one], motion[other] = (0.0, 9.0, turned[0]), (*at, turned[1])
    motion[other, :2] += scene.blocks.centroid[one] + [0.0, 9.0] - scene.blocks.centroid[other]
    return scene, Outline.of(scene), motion


def polygons(scene: Scene, outline: Outline, motion: Array) -> list[shapely.Polygon]:
    corners, first = outline.corners(motion.ravel()), scene.blocks.first
    return [shapely.Polygon(corners[first[k] : first[k + 1]]) for k in range(len(scene.blocks))]


SOMEWHERE = {
    "forms": st.tuples(st.integers(0, 2), st.integers(0, 2)),
    "at": st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2)),
    "turned": st.tuples(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1)),
}


@given(**SOMEWHERE, margin=st.floats(0.005, 0.2))
@settings(max_examples=100)
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_separate_stones_do_not_press_on_each_other(
    inset: float, forms: tuple[int, int], at: tuple[float, float], turned: tuple[float, float], margin: float
) -> None:
    """One stone is above, beside or in the notch of the other."""
    do_not_press(inset, forms, at, turned, margin)


@pytest.mark.long
@given(**SOMEWHERE, margin=st.floats(0.005, 0.2))
@settings(max_examples=2000)
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_separate_stones_do_not_press_on_each_other_at_length(
    inset: float, forms: tuple[int, int], at: tuple[float, float], turned: tuple[float, float], margin: float
) -> None:
    do_not_press(inset, forms, at, turned, margin)


def do_not_press(
    inset: float, forms: tuple[int, int], at: tuple[float, float], turned: tuple[float, float], margin: float
) -> None:
    scene, outline, motion = beside(inset, forms, at, turned)
    one, other = np.array(polygons(scene, outline, motion))[scene.wall]
    assume(one.distance(other) > 1e-3)
    contacts = find_contacts(outline, motion.ravel(), margin)
    opening, _ = jumps(outline, contacts, motion.ravel())
    assert opening.min(initial=0.0) > -1e-9


@given(**SOMEWHERE, deep=st.floats(1e-7, 1e-5))
@settings(
    max_examples=200, suppress_health_check=[HealthCheck.filter_too_much]
)  # most corners face no middle of a side
def test_corner_contact_opening_equals_its_penetration(
    forms: tuple[int, int], at: tuple[float, float], turned: tuple[float, float], deep: float
) -> None:
    """Stones are moved together along the shortest line between them, a corner of one onto the middle of a side."""
    scene, outline, motion = beside(0.0, forms, at, turned)
    (one, other), numbers = np.array(polygons(scene, outline, motion))[scene.wall], np.flatnonzero(scene.wall)
    start, stop = shapely.get_coordinates(shapely.shortest_line(other, one))
    apart = np.hypot(*(stop - start))
    away = [
        shapely.distance(shapely.MultiPoint(shapely.get_coordinates(each)), shapely.Point(end))
        for each, end in ((other, start), (one, stop))
    ]
    assume(apart > 1e-3 and max(away) > 0.01)
    motion[numbers[1], :2] += (stop - start) * (1 + deep / apart)
    contacts = find_contacts(outline, motion.ravel(), outline.margin)
    opening, _ = jumps(outline, contacts, motion.ravel())
    assert -opening.min() == pytest.approx(deep, abs=1e-10)


@pytest.mark.parametrize(
    ("model", "slope"), [(dem_dynamic, 30), *at_length((dem_dynamic, 45), (dem_dynamic, 60), (fem, 45))]
)
def test_block_with_its_toe_in_a_notch_topples_as_on_rough_ground(model: Any, slope: float) -> None:
    """λ = tan(α − θ): floor and slope of the notch hold a corner that would slide at λ = 0.1 by friction alone."""
    width, height = 0.06, 0.24
    away = width + 0.1 / math.tan(math.radians(slope))
    notched = np.array([(-1, -0.3), (2, -0.3), (2, 0.1), (away, 0.1), (width, 0.0), (-1, 0)])
    scene = stones(box(0, 0, width, height), friction=0.1, grounds=[notched])
    outcome = model(scene, 0.005, displacements="finite")
    alpha, corner = math.atan(width / height), np.array([width, height])
    follows(outcome, np.tan(alpha - angles(outcome.curve, corner[None], np.array([[1.0, 0.0]]))))


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_portal_topples_about_the_toe_of_its_leg(model: Any) -> None:
    """λ = tan(α − θ), where tan α is the horizontal arm of the centroid over its height."""
    side = 0.2
    scene = stones(side * np.array(PORTAL), friction=2.0)
    outcome = model(scene, 0.005, displacements="finite")
    x, y = scene.blocks.centroid[scene.wall][0]
    turned = np.arcsin(outcome.curve[:, 0] / side)  # displacement of the upper corner above the toe
    follows(outcome, np.tan(math.atan2(side - x, y) - turned))


@pytest.mark.parametrize("turn", [0.01, 0.05, 0.2])
def test_stones_on_a_crooked_bed_have_the_contact_area_of_their_joints(turn: float) -> None:
    """Sides next to those in contact add no more than the area onto which a corner may lean."""
    x = np.linspace(-0.2, 0.2, 9)
    bed = np.column_stack([x, 0.5 + 0.025 * turn * (1 - np.arange(9) % 2)])
    scene = stones([(-0.2, 0), (0.2, 0), *bed[::-1]], [*bed, (0.2, 1), (-0.2, 1)], friction=1.5)
    outline, motion = Outline.of(scene), np.zeros(3 * len(scene.blocks))
    contacts = find_contacts(outline, motion, outline.margin)
    closed = np.abs(jumps(outline, contacts, motion)[0]) < 1e-9
    borne = contacts.area[closed & (contacts.joint >= 0)].sum()
    assert borne == pytest.approx(scene.thickness * scene.joints.length.sum())
    assert contacts.area[closed].sum() < 1.08 * borne


@pytest.mark.parametrize("model", [dem_dynamic, fem])
def test_hooked_stone_breaks_at_the_strength_of_its_stem(model: Any) -> None:
    """A tee with its arms behind two jaws is pulled at its stem, which breaks across its whole section at once."""
    tee = [(0, 0), (0.1, 0), (0.1, 0.2), (0.9, 0.2), (0.9, 0.4), (0.1, 0.4), (0.1, 0.6), (0, 0.6)]
    jaws = box(0.1, -0.2, 2.0, 0.2), box(0.1, 0.4, 0.3, 0.8)
    strength, friction, height, width = 1e5, 0.01, 0.2, 0.1
    glue = JointMaterial(0.6, 5 * strength, strength, elasticity=Mortar(1e10, 0.2, 0.01))
    scene = build_scene(
        "tee",
        [np.array(tee, dtype=float)],
        grounds=[np.array(jaw, dtype=float) for jaw in jaws],
        thickness=width,
        block=BlockMaterial(2000.0, 1e10),
        joint=JointMaterial(friction, elasticity=MORTAR),
        inner_joint=replace(glue, fracture_energy_1=5.0, fracture_energy_2=50.0),
        load=Load(live=(PointLoad((0.9, 0.3), (1.0, 0.0)),)),
    )
    outcome = model(scene, 0.02, displacements="finite", distance=1e-3)
    assert outcome.status == "collapse"
    beyond = scene.blocks.centroid[scene.wall, 0].argmax()
    dragged = friction * 9.81 * scene.mass[scene.wall][beyond]
    assert outcome.multiplier == pytest.approx(strength * height * width + dragged, rel=0.01)


def interlocked(cells: list[str], **keys: Any) -> Scene:
    """Stones made of cells of 0.3 by 0.2 m; rows from the top, one letter per stone."""
    places = [
        (letter, column, len(cells) - row) for row, line in enumerate(cells) for column, letter in enumerate(line)
    ]
    boxes = [(letter, shapely.box(0.3 * x, 0.2 * y, 0.3 * x + 0.3, 0.2 * y + 0.2)) for letter, x, y in places]
    unions = [shapely.union_all([cell for of, cell in boxes if of == letter]) for letter in sorted(set("".join(cells)))]
    rings = [shapely.geometry.polygon.orient(shapely.simplify(union, 0)).exterior for union in unions]
    return stones(*[np.array(ring.coords)[:-1] for ring in rings], **keys)


# Interlocked ells and a tee.
WALL = ["eff", "eef", "cdd", "ccd", "aab"]


@pytest.mark.long
def test_interlocked_stones_peak_at_the_lowest_certified_load() -> None:
    scene = interlocked(WALL, friction=0.6)
    lowest, outcome = limit_nonassociated(scene), dem_dynamic(scene, 0.01, displacements="finite")
    assert lowest.lower is not None
    brackets(outcome, lowest.lower, 2e-3)


@pytest.mark.parametrize(("scale", "verdict"), [(2.0, "stands"), (3.0, "collapse")])
def test_shaken_interlocked_stones_do_not_overlap(scale: float, verdict: str) -> None:
    """The energy balance closes to 1 %, and stones overlap only by the compression of their joints."""
    time, values = pulse("half-sine", 0.8 * 9.81, 0.5)
    scene = interlocked(WALL, friction=1.5, live=History(time, values))
    response = follow(Resting.of(scene, "dem-dynamic", finite_system(scene)), scale, after=0.5)
    assert response.verdict == verdict
    assert response.unaccounted < 0.01
    bodies = polygons(scene, Outline.of(scene), np.ascontiguousarray(response.motion))
    common = [one.intersection(other) for k, one in enumerate(bodies) for other in bodies[:k]]
    wide = [2 * part.area / part.length for each in common for part in shapely.get_parts(each) if part.area > 0]
    assert max(wide) < 1e-4
