"""Blocks with individual thicknesses, as in walls that are thicker below than above."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import runningbond as rb
from fem_interface.cracks import pieces
from fem_interface.finite_system import DeformableContacts
from fem_interface.modal_wall import modal_wall
from fem_interface.node_outline import node_outline
from meshing import wall_mesh
from runningbond.commands.command_line import command
from runningbond.contacts.outline import Outline
from runningbond.contacts.search import find_contacts
from runningbond.joints import wall_points
from runningbond.limit import limit
from runningbond.results import save_outcome
from runningbond.scene import SceneError
from runningbond.scene.plausibility import warnings
from tests.at_length import at_length
from tests.checker import check
from tests.walls import content, courses, write_toml

THIN, THICK, DENSITY, GRAVITY = 0.12, 0.3, 1800.0, 9.81
WIDTH, HEIGHT = 0.4, 0.2
STRENGTH = 1e4
MODELS = ("limit", "dem-static", "dem-dynamic", "fem")
PATTERN: list[list[float]] = [[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]]


def stepped(*, lower: float, upper: float, live: Any, **joint: Any) -> rb.Wall:
    """A block on a block of another thickness."""
    return rb.Wall.courses(
        [[1], [1]],
        block_width=WIDTH,
        block_height=HEIGHT,
        thickness=lower,
        block={"density": DENSITY, "young": 1e10, "poisson": 0.2},
        materials={"upper": {"density": DENSITY, "young": 1e10, "poisson": 0.2, "thickness": upper}},
        assign=[{"block": "upper", "blocks": [1]}],
        joint={"normal_stiffness": 1e9, "shear_stiffness": 4e8, **joint},
        live=live,
    )


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("lower", "upper"), [(THICK, THIN), (THIN, THICK)])
def test_joint_has_thickness_of_thinner_block(model: str, lower: float, upper: float) -> None:
    """Uplift of the upper block takes f_t L t and its weight, which depends on its own thickness."""
    lift = {"kind": "point", "at": [WIDTH / 2, 2 * HEIGHT], "force": [0.0, 1.0]}
    wall = stepped(lower=lower, upper=upper, live=lift, friction=0.6, cohesion=STRENGTH, tensile_strength=STRENGTH)
    outcome = wall.run(model, tolerance=0.005)
    exact = STRENGTH * WIDTH * min(lower, upper) + DENSITY * GRAVITY * WIDTH * HEIGHT * upper
    assert outcome.status == "collapse"
    assert outcome.lower == pytest.approx(exact, rel=0.006)
    assert outcome.upper == pytest.approx(exact, rel=0.006)


def pile(thickness: Sequence[float], **keys: Any) -> rb.Wall:
    """A stack of blocks with individual thicknesses, none of which is that of the wall."""
    stone = {"density": DENSITY, "young": 1e10, "poisson": 0.2}
    return rb.Wall.courses(
        [[1]] * len(thickness),
        block_width=WIDTH,
        block_height=HEIGHT,
        thickness=7.0,
        block=stone,
        materials={f"m{k}": {**stone, "thickness": t} for k, t in enumerate(thickness)},
        assign=[{"block": f"m{k}", "blocks": [k]} for k in range(len(thickness))],
        **keys,
    )


@pytest.mark.parametrize("model", [*MODELS, "limit-nonassociated"])
def test_each_bed_of_stack_has_thickness_of_its_blocks(model: str) -> None:
    """Lifted at its top, the stack parts at the bed with the smallest f_t L t plus weight above."""
    thickness = [0.4, 0.1, 0.3, 0.15]
    lift = {"kind": "point", "at": [WIDTH / 2, 4 * HEIGHT], "force": [0.0, 1.0]}
    joint = {"friction": 0.6, "cohesion": STRENGTH, "tensile_strength": STRENGTH}
    wall = pile(thickness, joint={**joint, "normal_stiffness": 1e9, "shear_stiffness": 4e8}, live=lift)
    weight = DENSITY * GRAVITY * WIDTH * HEIGHT * np.array(thickness)
    bed = [thickness[0], *np.minimum(thickness[1:], thickness[:-1])]
    exact = min(STRENGTH * WIDTH * t + weight[k:].sum() for k, t in enumerate(bed))
    outcome = wall.run(model, tolerance=0.005)
    assert outcome.status == "collapse"
    assert outcome.lower == pytest.approx(exact, rel=0.006)
    assert outcome.upper == pytest.approx(exact, rel=0.006)


@pytest.mark.parametrize("model", ["limit", "limit-nonassociated"])
def test_checker_accounts_for_block_thickness(model: str, tmp_path: Path) -> None:
    """With the checker's own sums of weights and strengths, including a beam and the ground."""
    joint: dict[str, Any] = {"friction": 0.6, "cohesion": 3e3, "tensile_strength": 2e3}
    if model == "limit":
        joint["compressive_strength"] = 2e5
    beam = {"height": 0.1, "mass": 40.0, "drive": {"force": [1.0, 0.0]}}
    wall = pile([0.2, 0.1, 0.3], joint=joint, beam=beam, live="lateral")
    save_outcome(wall.run(model).outcome, tmp_path, "", wall.scene)
    assert check(tmp_path)


def test_bed_between_two_thicknesses_crushes_on_common_area() -> None:
    """Pressed vertically: f_m L t less the weight of the block above."""
    press = {"kind": "point", "at": [WIDTH / 2, 2 * HEIGHT], "force": [0.0, -1.0]}
    wall = stepped(lower=THICK, upper=THIN, live=press, friction=0.6, compressive_strength=1e6)
    exact = 1e6 * WIDTH * THIN - DENSITY * GRAVITY * WIDTH * HEIGHT * THIN
    assert wall.run("limit").multiplier == pytest.approx(exact, rel=1e-5)


@settings(max_examples=30)
@given(st.lists(st.floats(0.05, 1.0), min_size=10, max_size=10))
def test_dry_walls_depend_on_thickness_through_weights_only(thickness: list[float]) -> None:
    """Limit analysis of dry joints uses only density times thickness."""
    assign = [{"block": f"m{k}", "blocks": [k]} for k in range(len(thickness))]
    own = {f"m{k}": {"density": DENSITY, "thickness": t} for k, t in enumerate(thickness)}
    heavy = {f"m{k}": {"density": DENSITY * t / THIN} for k, t in enumerate(thickness)}
    one, other = (
        limit(courses(PATTERN, wall__thickness=THIN, materials=materials, assign=assign)) for materials in (own, heavy)
    )
    assert one.status == other.status == "collapse"
    assert one.multiplier == pytest.approx(other.multiplier, rel=1e-7)


@pytest.mark.parametrize(
    ("model", "displacements"),
    [
        *((model, "small") for model in ("limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem")),
        ("dem-dynamic", "finite"),
        *at_length(("fem", "finite")),
    ],
)
def test_result_does_not_depend_on_key_of_thickness(model: str, displacements: str) -> None:
    """Bitwise: thickness of the blocks instead of that of the wall."""
    settings: dict[str, Any] = {"displacements": "finite", "distance": 1e-3} if displacements == "finite" else {}
    size: dict[str, Any] = {"block_width": WIDTH, "block_height": HEIGHT, "live": "lateral"}
    block = {"density": DENSITY, "young": 1e9, "poisson": 0.2}
    joint = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    if displacements == "small":
        joint["cohesion"] = 1e3
    one = rb.Wall.courses([[1]], thickness=THICK, block=block, joint=joint, **size)
    other = rb.Wall.courses([[1]], thickness=THIN, block=block | {"thickness": THICK}, joint=joint, **size)
    said, says = (wall.run(model, **settings) for wall in (one, other))
    assert (said.status, said.lower, said.upper) == (says.status, says.lower, says.upper)
    assert said.upper is not None


@pytest.mark.parametrize(("lower", "upper"), [(THICK, THIN), (THIN, THICK)])
def test_points_and_contacts_have_area_of_their_joint(lower: float, upper: float) -> None:
    """Rigid and deformable blocks, small and finite displacements: L min(t, t'), and L t for the lowest bed."""
    scene = stepped(lower=lower, upper=upper, live="lateral", friction=0.6).scene
    exact = np.where((scene.joints.block == 1).any(axis=1), min(lower, upper), lower) * scene.joints.length
    points, outline = wall_points(scene), Outline.of(scene)
    assert np.bincount(points.joint, points.area) == pytest.approx(exact)
    elements = modal_wall(scene, cells=3).elements.points
    assert np.bincount(elements.joint, elements.area) == pytest.approx(exact)
    rigid = find_contacts(outline, np.zeros(3 * len(scene.blocks)), outline.margin)
    deformable = DeformableContacts(node_outline(scene, 3)).undeformed
    for contacts in (rigid, deformable):
        own = contacts.joint >= 0
        assert np.bincount(contacts.joint[own], contacts.area[own]) == pytest.approx(exact)


def test_new_contacts_have_thickness_of_thinner_block() -> None:
    """The upper block has come down on the ground: contacts of half a side, as in running bond, halved at the ends."""
    scene = stepped(lower=THICK, upper=THIN, live="lateral", friction=0.6).scene
    outline, motion = Outline.of(scene), np.zeros((len(scene.blocks), 3))
    motion[0, 0] = 3 * WIDTH  # the lower one is moved aside
    motion[1, 1] = -HEIGHT
    contacts = find_contacts(outline, motion.ravel(), outline.margin)
    owner = outline.blocks.owner[contacts.ends[:, 4:].astype(np.int64)]
    of_upper = (owner == 1).any(axis=1)
    assert contacts.area[of_upper] == pytest.approx(WIDTH / 2 * THIN / 2)
    assert contacts.area[~of_upper] == pytest.approx(WIDTH * THICK / 2)


def test_stiffness_and_mass_of_deformable_blocks_scale_with_thickness() -> None:
    wall = modal_wall(stepped(lower=THICK, upper=THIN, live="lateral", friction=0.6).scene)
    lower, upper = (wall.block == k for k in (0, 1))
    assert wall.mass[lower] == pytest.approx(THICK / THIN * wall.mass[upper])
    assert wall.stiffness[lower] == pytest.approx(THICK / THIN * wall.stiffness[upper])
    assert wall.stiffness.max() > 0


def test_halves_and_triangles_have_thickness_of_their_block() -> None:
    inner = {"friction": 0.7, "normal_stiffness": 1e12, "shear_stiffness": 1e12, "cohesion": 1e6}
    wall = stepped(lower=THICK, upper=THIN, live="lateral", friction=0.6)
    scene = rb.Wall({**wall.description, "inner_joint": inner}).scene
    cracks = scene.joints.inner
    of_upper = scene.part_of[scene.joints.block[cracks, 0]] == 1
    assert scene.thickness_of_joints[cracks] == pytest.approx(np.where(of_upper, THIN, THICK))
    mesh = wall_mesh(scene, 1)
    parted = pieces(scene, mesh, "blocks").scene
    assert parted.mass[parted.wall].sum() == pytest.approx(scene.mass[scene.wall].sum())


def test_beam_and_ground_do_not_reduce_joint_thickness() -> None:
    beam = {"height": 0.1, "mass": 50.0}
    wall = stepped(lower=THIN, upper=THICK, live="lateral", friction=0.6)
    scene = rb.Wall({**wall.description, "beam": beam}).scene
    (own,) = np.flatnonzero(scene.is_beam)
    assert scene.thickness_of_joints[(scene.joints.block == own).any(axis=1)] == pytest.approx(THICK)
    assert scene.mass[own] == pytest.approx(50.0)


@pytest.mark.parametrize("key", ["block", "materials.upper"])
def test_invalid_thickness_is_refused_by_key(key: str) -> None:
    wall = stepped(lower=THICK, upper=THIN, live="lateral", friction=0.6)
    with pytest.raises(SceneError, match=rf"^{key}.thickness = -0.1: must be a number above 0"):
        wall.with_({f"{key}.thickness": -0.1})


def test_thickness_in_millimetres_is_reported() -> None:
    wall = stepped(lower=THICK, upper=120.0, live="lateral", friction=0.6)
    (said,) = warnings(wall.scene)
    assert said.startswith("materials.upper.thickness = 120: is odd")
    assert said.endswith("are 120 mm meant?")


def test_show_lists_thickness_by_material(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tables = content(
        materials={"pier": {"density": 2000.0, "thickness": 0.5}}, assign=[{"block": "pier", "blocks": [0]}]
    )
    assert command(["show", str(write_toml(tables, tmp_path / "wall.toml"))]) == 0
    printed = capsys.readouterr().out
    assert "0.12 … 0.5 m thick" in printed
    assert "1 block of 2000 kg/m³ and 0.5 m, " in printed
