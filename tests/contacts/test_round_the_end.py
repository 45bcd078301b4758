"""Corners that slide around the end of another block's side."""

import numpy as np
import pytest

from runningbond.contacts.outline import Outline
from runningbond.contacts.search import find_contacts, jumps
from runningbond.scene import Array, Scene
from tests.scene.test_any_outline import box

from .test_reentrant import stones

TURNS = np.tan([0.28, 0.19, 0.27])
"""Slopes of the side beyond the end, of the sliding stone's side on it, and of the stone's side around the corner."""

AWAY = 5.0


def pair(mirrored: bool, steep: float = 1.0) -> tuple[Scene, Outline]:
    """A stone hanging from a roof, and another one on the floor whose upper side ends at (0, 0)."""
    sense, (falls, rises, flank) = -1 if mirrored else 1, steep * TURNS
    edge = np.array([(-1, -1), (0.8, -1), (0.5, -0.5 * falls), (0, 0), (-1, 0)])
    stone = np.array([(0, 0), (0.8, 0.8 * flank), (0.8, 1.5), (-0.8, 1.5), (-0.8, 0.8 * rises)])
    outlines = edge, stone + [AWAY, 0.0], box(-2, -1.2, 2, -1.0), box(AWAY - 1, 1.5, AWAY + 1, 1.7)
    lower, upper, *grounds = [(np.array(outline) * [sense, 1])[::sense] for outline in outlines]
    scene = stones(lower, upper, friction=0.6, grounds=grounds)
    return scene, Outline.of(scene)


def moved(scene: Scene, mirrored: bool, along: float, up: float) -> Array:
    """A motion that takes the stone's corner to the end of the other one's side, and then outwards and up."""
    motion = np.zeros((len(scene.blocks), 3))
    motion[1, :2] = (-1 if mirrored else 1) * (along - AWAY), up
    return motion.ravel()


@pytest.mark.parametrize("mirrored", [False, True])
def test_corner_sliding_past_another_is_found_on_the_side_behind_it(mirrored: bool) -> None:
    """A small motion brings no contact that the search had left out, while one stone rests on the other's side."""
    scene, outline = pair(mirrored)
    outside, deep = 0.1 * outline.margin, 1e-5
    before = moved(scene, mirrored, outside, -outside * TURNS[1])
    after = moved(scene, mirrored, -outside, -deep)
    found, anew = find_contacts(outline, before, outline.margin), find_contacts(outline, after, outline.margin)
    assert jumps(outline, found, before)[0].min() == pytest.approx(0.0, abs=1e-12)
    for contacts in (anew, found):
        assert jumps(outline, contacts, after)[0].min() == pytest.approx(-deep, rel=1e-9)


@pytest.mark.parametrize("steep", [1.0, 0.2])
@pytest.mark.parametrize("mirrored", [False, True])
def test_corner_has_contact_area_before_it_arrives(mirrored: bool, steep: float) -> None:
    """Otherwise it would penetrate without resistance and be thrown back at the next contact search."""
    scene, outline = pair(mirrored, steep)
    outside = 0.1 * outline.margin
    before, after = (moved(scene, mirrored, along, 0.0) for along in (outside, -outside))
    found, anew = find_contacts(outline, before, outline.margin), find_contacts(outline, after, outline.margin)
    touching = np.abs(jumps(outline, anew, after)[0]) < 1e-12
    assert touching.any()
    for key, area in zip(anew.key[touching], anew.area[touching], strict=True):
        assert found.area[found.key == key] >= area / 2
