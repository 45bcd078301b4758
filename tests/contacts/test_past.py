"""Blocks that pass each other's ends: they lie below a side without having penetrated it."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from dem.finite_system import finite_system
from runningbond.contacts.outline import Outline
from runningbond.contacts.search import CHECKED_DEPTH, FASTEST_OPENING, find_contacts, jumps
from runningbond.joints.wall_law import with_impacts
from runningbond.response import follow
from runningbond.response.resting import Resting
from runningbond.scene import Array, History, Load, Scene
from runningbond.scene.history import pulse
from tests.walls import courses

GRAVITY = 9.81
FALL = 1.0  # m, about
STIFF = {"friction": 0.7, "normal_stiffness": 1e8, "shear_stiffness": 1e8}


def falling_off() -> Scene:
    """Two stacked blocks that are thrown off the end of the ground, one and a half block lengths away."""
    scene = courses([[1], [1]], width=0.5, height=0.5, wall__thickness=0.3, block__density=2000.0, joint=STIFF)
    time, values = pulse("half-sine", GRAVITY, 1.0)
    return replace(scene, load=Load(live=(History(time, values),)))


def test_blocks_falling_past_the_end_of_the_ground_gain_no_energy() -> None:
    """No contact is deeper than the overlap of the blocks: stored energy stays far below weight times fall."""
    scene = falling_off()
    rest = Resting.of(scene, "dem-dynamic", finite_system(scene))
    response = follow(rest, 0.9, after=0.5)
    assert response.verdict == "collapse"
    kinetic, stored = response.energy[:, 2], response.energy[:, 3]
    weight = GRAVITY * float(scene.mass[~scene.fixed].sum())
    assert response.displacement[-1, :, 1].min() < -0.4
    assert stored.max() < 0.2 * weight * FALL
    assert kinetic.max() < 1.5 * weight * FALL
    assert response.unaccounted == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("scale", [1.5, 2.0, 3.0])
def test_block_riding_on_another_does_not_press_on_its_underside(scale: float) -> None:
    """Two stacked cubes tip over; a false contact with the lower one's bottom would upset the energy balance."""
    scene = falling_off()
    rest = Resting.of(scene, "dem-dynamic", finite_system(with_impacts(scene)))
    response = follow(rest, scale)
    assert response.verdict == "collapse"
    assert response.unaccounted < 0.02  # the impacts' energy error; a seventh of it at half the time step


@given(x=st.floats(0.02, 0.5), y=st.floats(-1.2, 1.0), turned=st.floats(-3.1, 3.1), margin=st.floats(0.02, 0.4))
@settings(max_examples=60)
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_separate_blocks_do_not_press_on_each_other(
    inset: float, x: float, y: float, turned: float, margin: float
) -> None:
    """A block entirely to the right of the ground's end, at any height: no contact is deep, for any search margin."""
    scene = courses([[1]], width=0.5, height=0.5, joint={**STIFF, "inset": inset})
    outline = Outline.of(scene)
    (block,) = np.flatnonzero(scene.wall)
    (_, _), (end, _) = scene.blocks.extent(scene.fixed)
    reach = outline.reach[block]
    motion = np.zeros((len(scene.blocks), 3))
    motion[block] = end + reach + x - scene.blocks.centroid[block, 0], y, turned
    contacts = find_contacts(outline, motion.ravel(), margin)
    opening, _ = jumps(outline, contacts, motion.ravel())
    assert opening.min(initial=0.0) > -CHECKED_DEPTH * outline.margin


APART = given(
    at=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
    turned=st.tuples(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1)),
    step=st.tuples(*[st.floats(-1.0, 1.0)] * 6),
    margin=st.floats(0.005, 0.2),
)


@APART
@example(at=(0.25, 0.4375), turned=(0.0, 0.875), step=(0.0, 0.0, 1.0, 0.0, 0.0, -1.0), margin=0.1875)
@example(at=(-0.405, -0.092), turned=(2.183, -0.8605), step=(-0.958, 0.232, 0.802, 0.643, -0.466, -0.863), margin=0.149)
@settings(max_examples=100)
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_blocks_that_stay_apart_get_no_contact_force(
    inset: float, at: tuple[float, float], turned: tuple[float, float], step: tuple[float, ...], margin: float
) -> None:
    """One block is anywhere around the other; both move by at most half the margin after the search."""
    get_no_contact_force(inset, at, turned, step, margin)


@pytest.mark.long
@APART
@settings(max_examples=2000)
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_blocks_that_stay_apart_get_no_contact_force_at_length(
    inset: float, at: tuple[float, float], turned: tuple[float, float], step: tuple[float, ...], margin: float
) -> None:
    get_no_contact_force(inset, at, turned, step, margin)


def get_no_contact_force(
    inset: float, at: tuple[float, float], turned: tuple[float, float], step: tuple[float, ...], margin: float
) -> None:
    scene, outline, motion = two_blocks(inset, at, turned)
    moved = motion.copy()
    way = margin / 2 / (np.sqrt(2) + 1) * np.reshape(step, (2, 3))
    one, other = np.flatnonzero(scene.wall)
    moved[[one, other]] += way / np.column_stack([np.ones((2, 2)), outline.reach[[one, other]]])
    apart = [distance(scene, outline, where) for where in (motion, (motion + moved) / 2, moved)]
    assume(min(apart) > 1e-3)
    contacts = find_contacts(outline, motion.ravel(), margin)
    opening, _ = jumps(outline, contacts, moved.ravel())
    assert opening.min(initial=0.0) > -CHECKED_DEPTH * outline.margin


@given(
    at=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
    turned=st.tuples(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1)),
    margin=st.floats(0.005, 0.2),
)
@settings(max_examples=200)
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_far_contact_end_is_kept_only_with_a_near_partner(
    inset: float, at: tuple[float, float], turned: tuple[float, float], margin: float
) -> None:
    """An end without a near one once went from 0.7 m outside to 0.1 m inside as two sides rotated past each other."""
    _, outline, motion = two_blocks(inset, at, turned)
    contacts = find_contacts(outline, motion.ravel(), margin)
    opening, _ = np.abs(jumps(outline, contacts, motion.ravel()))
    assert opening[contacts.pairs].min(axis=1).max(initial=0.0) < FASTEST_OPENING * margin


def two_blocks(inset: float, at: tuple[float, float], turned: tuple[float, float]) -> tuple[Scene, Outline, Array]:
    """Two rotated blocks high above the ground, and their motion ``(nb, 3)``; `at` is from centroid to centroid."""
    scene = courses([[1], [1]], width=0.5, height=0.25, joint={**STIFF, "inset": inset})
    one, other = np.flatnonzero(scene.wall)
    motion = np.zeros((len(scene.blocks), 3))
    motion[one], motion[other] = (0.0, 9.0, turned[0]), (*at, turned[1])
    motion[other, :2] += scene.blocks.centroid[one] + [0.0, 9.0] - scene.blocks.centroid[other]
    return scene, Outline.of(scene), motion


def distance(scene: Scene, outline: Outline, motion: Array) -> float:
    """Distance of the two blocks [m]."""
    corners, first = outline.corners(motion.ravel()), scene.blocks.first
    one, other = (shapely.Polygon(corners[first[k] : first[k + 1]]) for k in np.flatnonzero(scene.wall))
    return float(one.distance(other))
