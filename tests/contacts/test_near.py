"""Contact search and placement kernels against direct calculations."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem.finite_frequency import frequencies_squared
from dem.finite_system import finite_system
from runningbond.contacts.outline import Outline
from runningbond.contacts.rigid_sides import gather_sharp, gather_sides, turn
from runningbond.contacts.search import facing_sides, find_contacts
from runningbond.dynamics import State
from runningbond.dynamics.contact_update import ContactUpdate, contacts_of
from runningbond.limit.kinematics import mass_matrix_diagonal
from runningbond.scene import Array
from tests.dynamics.test_dynamics import STIFF
from tests.walls import panel

WALL = panel(wall__height=0.18, wall__length=0.72, joint__mortar=STIFF)


def moved(seed: int, far: float, turned: float) -> Array:
    """Random motion of the free blocks of `WALL`."""
    motion = np.random.default_rng(seed).normal(size=(len(WALL.blocks), 3)) * [far, far, turned]
    motion[WALL.fixed] = 0.0
    return motion.ravel()


@given(spins=st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=40))
@settings(max_examples=60)
def test_turn_kernel_matches_library_cosine_and_sine(spins: list[float]) -> None:
    motion = np.zeros((len(spins), 3))
    motion[:, 2] = spins
    cosine, sine = np.zeros((2, len(spins)))
    turn(motion.ravel(), cosine, sine)
    assert cosine == pytest.approx([math.cos(spin) for spin in spins], abs=3e-16)
    assert sine == pytest.approx([math.sin(spin) for spin in spins], abs=3e-16)


@given(seed=st.integers(0, 10**6), far=st.sampled_from([0.0, 2e-3, 0.1]), turned=st.sampled_from([0.0, 0.1, 3.0]))
@settings(max_examples=40)
def test_facing_sides_match_a_search_over_all_pairs(seed: int, far: float, turned: float) -> None:
    outline, motion, margin = Outline.of(WALL), moved(seed, far, turned), 0.01
    corners, normal, owner = outline.corners(motion), outline.placed(motion).arcs[:, 2:], outline.blocks.owner
    after = corners[outline.blocks.successor]
    low, high = np.minimum(corners, after) - margin / 2, np.maximum(corners, after) + margin / 2
    near = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2) & (normal @ normal.T < 0)
    held = outline.held[owner]
    e, f = np.nonzero(near & (owner[:, None] > owner) & ~(held[:, None] & held))
    assert np.array_equal(facing_sides(outline, motion, margin), (e, f))


@given(seed=st.integers(0, 10**6), turned=st.sampled_from([0.0, 0.02, 0.3]))
@settings(max_examples=40)
def test_sharp_kernel_matches_the_rounded_one_at_zero_radius(seed: int, turned: float) -> None:
    outline, motion = Outline.of(WALL), moved(seed, 2e-3, turned)
    contacts = find_contacts(outline, motion, 4 * outline.margin)
    found = []
    for gather in (gather_sides, gather_sharp):
        geometry, jumps = contacts.geometry(outline), np.zeros((2, len(contacts)))
        gather(motion, tuple(geometry), *jumps)
        found.append((*jumps, *geometry.contact.T, geometry.out))
    assert np.array_equal(found[0], found[1])


@pytest.mark.parametrize("seed", range(6))
def test_frequency_bound_and_estimate_with_all_contacts_closed(seed: int) -> None:
    """Each contact has its own stiffness; derivatives of the jumps are taken by central differences."""
    outline, motion = Outline.of(WALL), moved(seed, 2e-3, 0.02 * seed)
    contacts = find_contacts(outline, motion, outline.margin)
    sides, n, size = contacts.geometry(outline), len(contacts), len(motion)
    mass = np.where(np.repeat(WALL.fixed, 3), np.inf, mass_matrix_diagonal(WALL))
    spring = np.random.default_rng(seed).uniform(0.5e9, 1e9, (2, n))
    rows = np.zeros((size, 2 * n))
    for row, step in zip(rows, 1e-7 * np.eye(size), strict=True):
        jumps = np.zeros((2, 2, n))
        for side, sense in zip(jumps, (1.0, -1.0), strict=True):
            gather_sides(motion + sense * step, tuple(sides), *side)
        row[:] = (jumps[0] - jumps[1]).ravel() / 2e-7
    gather_sides(motion, tuple(sides), *np.zeros((2, n)))
    scaled = rows * np.sqrt(np.tile(sides.area, 2) * spring.ravel()) / np.sqrt(mass)[:, None]
    largest = np.linalg.eigvalsh(scaled @ scaled.T)[-1]
    bound, closer = frequencies_squared(sides, spring[0], spring[1], mass)
    assert closer == pytest.approx(largest, rel=0.01)
    assert largest < bound * (1 + 1e-5)


def test_common_translation_doubles_the_distance_before_the_next_search() -> None:
    """Only relative motion counts: a common translation u beside fixed ground uses up u / 2, opposite motions u."""
    system = finite_system(WALL)
    assert system.contacts is not None
    update, state = ContactUpdate(system, system.contacts), State.at_rest(system)
    margin = contacts_of(state).margin
    for far, due in ((0.74, False), (0.76, True)):
        state.motion[system.rigid[~WALL.fixed, 0]] = far * margin
        assert (update.steps_until_next_look(state, 1e-5, 9.81) == 0) == due
    state.motion[:] = 0.0
    for far, due in ((0.37, False), (0.38, True)):
        one, other = np.flatnonzero(~WALL.fixed)[:2]
        state.motion[system.rigid[[one, other], 0]] = far * margin, -far * margin
        assert (update.steps_until_next_look(state, 1e-5, 9.81) == 0) == due
