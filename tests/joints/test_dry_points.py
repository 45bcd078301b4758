"""Vectorized dry joint points equal the general loop; contacts are grouped by material."""

import numpy as np
import pytest

from runningbond.contacts.materials import ContactMaterials
from runningbond.contacts.outline import Outline
from runningbond.contacts.search import find_contacts
from runningbond.joints import joint_stiffness
from runningbond.joints.dry_points import dry_points, dry_within, is_beyond
from runningbond.joints.interface import HISTORY, any_points, interface_constants
from runningbond.scene import Closure, JointMaterial, Stiffness
from tests.at_length import at_length
from tests.walls import courses

SANDSTONE = Closure(5650.0, 155e9)
ROWS = (np.uint64(0), np.uint64(200))


def dry(**changes: object) -> JointMaterial:
    given: dict[str, object] = {"elasticity": Stiffness(5e9, 4e9), "compressive_strength": 57e6, "closure": SANDSTONE}
    return JointMaterial(0.62, **(given | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "material",
    [
        dry(),
        dry(closure=None),
        *at_length(dry(closure=Closure(1e3, 4e9 * np.e**7.9)), dry(compressive_strength=None), dry(peak_closure=1e-4)),
    ],
    ids=["closing", "stiff", "much stiffer", "strong", "hardening"],
)
def test_dry_points_within_cap_equal_general_loop(material: JointMaterial) -> None:
    """Random jumps around a pressure below the cap, step by step: opening, closing and sliding in both directions."""
    rng, of = np.random.default_rng(1), np.array(interface_constants(material))
    stiff = joint_stiffness(material).normal
    deepest = np.log1p(0.2 * 57e6 * 5650 / stiff) / 5650 if material.closure else 0.2 * 57e6 / stiff
    fast, slow = np.zeros((2, len(HISTORY), 200))
    opening, slip = np.zeros((2, 200))
    for _ in range(50):
        opening = np.clip(opening + 0.02 * deepest * rng.normal(size=200), -deepest, deepest / 4)
        slip = slip + 0.1 * deepest * rng.normal(size=200)
        (n, t), (n_slow, t_slow) = np.zeros((2, 2, 200))
        bounds = dry_within(of, 1e-3)
        assert not is_beyond(ROWS, opening, fast, bounds)
        dry_points(ROWS, of, opening, slip, fast, 1e-3, n, t)
        any_points(ROWS, of, opening, slip, slow, 1e-3, n_slow, t_slow)
        assert n == pytest.approx(n_slow, rel=1e-13, abs=1e-6)
        assert t == pytest.approx(t_slow, rel=1e-12, abs=1e-5)
        slow[HISTORY.index("damage")] = 0.0  # damage of a strength that dry joints do not have
        assert fast == pytest.approx(slow, rel=1e-11, abs=1e-18 * stiff)
    assert (n < 0).any()
    assert (n == 0).any()
    assert (np.abs(t) >= 0.62 * -n * (1 - 1e-12)).any()


def test_points_beyond_cap_or_with_strength_need_general_loop() -> None:
    history, shallow = np.zeros((len(HISTORY), 200)), np.full(200, -1e-5)
    of = np.array(interface_constants(dry()))
    history[2] = shallow
    bounds = dry_within(of, 0.1)
    assert not is_beyond(ROWS, shallow, history, bounds)
    deep = shallow.copy()
    deep[17] = -1e-3  # 57 MPa is reached at 0.74 mm
    assert is_beyond(ROWS, deep, history, bounds)
    history[HISTORY.index("crushed"), 5] = 1e-9
    assert is_beyond(ROWS, shallow, history, bounds)
    for strong in (
        dry(cohesion=1e5),
        dry(tensile_strength=1e4, cohesion=1e5),
        dry(closure=Closure(1e3, 5e9 * np.e**9)),
    ):
        assert dry_within(np.array(interface_constants(strong)), 0.1)[0] < 0


def test_contacts_of_equal_materials_form_one_row() -> None:
    """For the law, dry joints and sides that meet later are equal, in any order."""
    scene = courses([[1, 1], [1, 1]]).with_joint(elasticity=Stiffness(1e9, 4e8))
    outline = Outline.of(scene)
    contacts = find_contacts(outline, np.zeros(3 * len(scene.blocks)), outline.margin)
    assert (contacts.joint < 0).any()
    mixed = contacts.chosen(np.random.default_rng(0).permutation(len(contacts)))
    glued = mixed.chosen(np.arange(len(mixed)))
    object.__setattr__(glued, "glued", glued.joint >= 0)
    assert len(np.unique(ContactMaterials(scene).number(glued))) == 2
    assert len(ContactMaterials(scene).law(glued).constants) == 1
