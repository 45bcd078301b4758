"""Driven walls of deformable blocks at finite displacements, against rigid blocks and exact solutions."""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import dem.finite_system
from fem_interface.deformable_sides import gather_deformable
from fem_interface.finite_system import DeformableContacts, finite_system
from fem_interface.model import fem
from fem_interface.node_outline import node_outline
from runningbond.dynamics import Carried, Run, State
from runningbond.joints.wall_points import spread_rule
from runningbond.models import run_model
from runningbond.scene import Scene, SceneError
from tests.at_length import at_length
from tests.contacts.test_rigs import GLUE, column, force_at, rig

STONE = {"density": 1000.0, "young": 1e10, "poisson": 0.2}


def stone(courses: int = 1, length: float = 0.4, height: float = 0.6, **changes: Any) -> Scene:
    """The `rig` with blocks of stone."""
    return rig(courses, length, height, block=STONE, **changes)


@pytest.mark.parametrize("line", ["moving", *at_length("fixed")])
def test_rocking_block_has_exact_resistance(line: str) -> None:
    """As a rigid block (`tests.contacts.test_rigs`), apart from its own deformation, which matters at small drifts."""
    b, at, n, d = 0.2, 0.6, 2e4, 0.04
    scene = stone(beam__force_line=line, beam__drive={"displacement": [0.05, 0], "at": at})
    outcome = fem(scene, 0.05, displacements="finite")
    theta = brentq(lambda x: at * math.sin(x) + b * (1 - math.cos(x)) - d, 0.0, 0.5)
    lever = b * math.cos(theta) - 0.65 * math.sin(theta) if line == "moving" else b
    exact = n * lever / (at * math.cos(theta) + b * math.sin(theta))
    assert force_at(outcome, d) == pytest.approx(exact, rel=5e-3)
    assert "finite displacements" in outcome.message
    vertical = column(outcome, "ground vertical [N]")
    assert vertical[len(vertical) // 2 :] == pytest.approx(n, rel=0.02)


@pytest.mark.long
def test_three_modes_equal_rigid_blocks() -> None:
    """A wall of several materials with blocks that split: the force to 1 % at three drifts."""
    weak = {"friction": 0.4, "normal_stiffness": 2e9, "shear_stiffness": 1e9}
    scene = stone(
        3,
        0.2,
        0.3,
        wall__courses=[[1, 1], [0.5, 1, 0.5], [1, 1]],
        inner_joint=GLUE,
        joints={"weak": weak},
        assign=[{"joint": "weak", "between": ["ground", "*"]}],
        beam__drive={"displacement": [0.0031, 0], "at": 0.3},
    )
    ours = fem(scene, displacements="finite", modes=3, cells=4)
    other = run_model("dem-dynamic", scene, displacements="finite")
    for d in (5e-4, 1e-3, 3e-3):
        assert force_at(ours, d) == pytest.approx(force_at(other, d), rel=0.01)
    assert ours.path_columns == other.path_columns


@pytest.mark.parametrize(
    ("far", "strength"),
    [
        (0.002, {"cohesion": 4e5, "tensile_strength": 1e5, "fracture_energy_1": 10.0, "fracture_energy_2": 10.0}),
        *at_length(*((0.02, {"compressive_strength": 1e6} | inset) for inset in ({}, {"inset": 0.03}))),
    ],
)
@pytest.mark.parametrize("cells", [1, *at_length(4)])
def test_crushing_and_softening_are_spread_along_joints(far: float, strength: dict[str, float], cells: int) -> None:
    """As along the joint of a rigid block, on any mesh: contacts at the nodes only would carry 20 and 43 % more."""
    joint = {"friction": 0.9, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    scene = stone(beam__drive={"displacement": [far, 0], "at": 0.6}, joint=joint | strength)
    other = run_model("dem-dynamic", scene, displacements="finite")
    ours = fem(scene, displacements="finite", cells=cells)
    assert ours.lower == pytest.approx(other.lower, rel=7e-3)
    assert ours.upper == pytest.approx(other.upper, rel=7e-3)


def test_message_reports_a_force_that_still_rises_at_the_end_of_a_path() -> None:
    """The points of a softening joint crack one after the other: 5 % more is borne on a path four times as long."""
    joint = {"friction": 0.9, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    joint |= {"cohesion": 4e5, "tensile_strength": 1e5, "fracture_energy_1": 10.0, "fracture_energy_2": 10.0}
    drives = [{"displacement": [far, 0], "at": 0.6} for far in (0.002, 0.008)]
    short, long = (
        run_model("dem-dynamic", stone(beam__drive=drive, joint=joint), displacements="finite") for drive in drives
    )
    assert short.lower is not None
    assert long.lower is not None
    assert long.lower > 1.05 * short.lower
    told = re.search(r"still rising at the end, along its slope to ([\d,]+) on a path twice as long", short.message)
    assert told is not None
    assert float(told[1].replace(",", "")) == pytest.approx(long.lower, rel=0.03)
    assert "still rising" not in long.message


@pytest.mark.parametrize("cells", [1, 2, 3])
@pytest.mark.parametrize("inset", [0.0, 0.002, 0.0075, 0.01, 0.013])
@pytest.mark.parametrize("strength", [{}, {"compressive_strength": 1e6}])
def test_contacts_have_the_area_of_their_joints(cells: int, inset: float, strength: dict[str, float]) -> None:
    """Also if the corner arcs take up several facets, or half of one: 3.75 mm and more here.

    Points less than half their space inside the arcs are open, and their area does not count.
    """
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9, "inset": inset}
    scene = stone(3, 0.6, 0.12, wall__courses=[[1, 1], [0.5, 1, 0.5], [1, 1]], joint=joint | strength)
    found = DeformableContacts(node_outline(scene, cells))
    contacts, opening = found.undeformed, np.zeros(len(found.undeformed))
    gather_deformable(np.zeros(len(found.blocks.wall.mass)), found.geometry(contacts), opening, opening.copy())
    own = (contacts.joint >= 0) & (opening < 1e-9)
    area = np.bincount(contacts.joint[own], contacts.area[own], len(scene.joints))
    assert area == pytest.approx(scene.joints.length * scene.thickness, rel=1e-9)


@pytest.mark.parametrize("cells", [1, 3])
@pytest.mark.parametrize("slid", [1e-4, 0.013, 0.06, -0.11, 0.19])
def test_areas_add_up_to_the_overlap_of_blocks_that_slide(cells: int, slid: float) -> None:
    """To 1.5 % of it, also where points have been lost; and no point bears that is lost before the next search."""
    scene = stone(2, 0.2, 0.4, joint__compressive_strength=1e6)
    found = DeformableContacts(node_outline(scene, cells))
    motion = np.zeros(len(found.blocks.wall.mass))
    motion[found.blocks.wall.rigid[np.flatnonzero(scene.wall)[1], 0]] = slid
    contacts = found.bearing(found.find(motion, found.outline.margin))
    between = int(np.flatnonzero((scene.joints.block == np.flatnonzero(scene.wall)[:2]).all(axis=1))[0])
    own = contacts.joint == between
    assert contacts.area[own].sum() / scene.thickness == pytest.approx(0.2 - abs(slid), rel=0.015)
    assert contacts.area.min() > 0
    motion[found.blocks.wall.rigid[np.flatnonzero(scene.wall)[1], 0]] += contacts.margin * 0.99 * math.copysign(1, slid)
    gather_deformable(motion, found.geometry(contacts), opening := np.zeros(len(contacts)), opening.copy())
    assert (opening[own & (contacts.inwards == 0)] < 1e-9).all()


@pytest.mark.parametrize("cells", [1, 3])
@pytest.mark.parametrize("lean", [0.1, 0.3])
def test_ends_of_blocks_that_lean_and_slide_do_not_bear_as_wide_as_flat_ones(cells: int, lean: float) -> None:
    """Not even if all points between them are lost or too far from the other side: each had half of the overlap."""
    scene = stone(2, 0.2, 0.4, joint__compressive_strength=1e6)
    found, upper = DeformableContacts(node_outline(scene, cells)), np.flatnonzero(scene.wall)[1]
    between = int(np.flatnonzero((scene.joints.block == np.flatnonzero(scene.wall)[:2]).all(axis=1))[0])
    blocks = scene.blocks
    corner = blocks.vertices[blocks.owner == upper] - blocks.centroid[upper]
    low = corner[(corner[:, 1] < 0) & (corner[:, 0] > 0)][0]
    turn = np.array([[math.cos(lean), math.sin(lean)], [-math.sin(lean), math.cos(lean)]])
    for slid in np.linspace(-0.015, 0.015, 31):
        motion = np.zeros(len(found.blocks.wall.mass))
        motion[found.blocks.wall.rigid[upper]] = *(low - turn @ low + [slid, -1e-5]), -lean
        contacts = found.bearing(found.find(motion, found.outline.margin))
        own = contacts.joint == between
        assert contacts.area[own].max() < 0.2 * scene.joints.length[between] * scene.thickness


def test_points_between_nodes_move_with_mesh() -> None:
    """On the straight line between two mesh nodes, for any motion."""
    scene = stone(2, 0.2, wall__courses=[[1, 1], [0.5, 1, 0.5]], joint__compressive_strength=1e6)
    blocks = node_outline(scene)
    motion = np.random.default_rng(3).normal(0.0, 1e-3, len(blocks.wall.mass))
    motion[-1] = 0.0
    contacts = DeformableContacts(blocks)
    found = contacts.undeformed.chosen(contacts.undeformed.inwards == 0)
    geometry = contacts.geometry(found)
    gather_deformable(motion, geometry, *np.zeros((2, len(found))))
    point = found.ends[:, 0].astype(np.int64) - len(contacts.outline.radius)
    facet, share = blocks.points.facet[point], blocks.points.share[point, None]
    assert len(found) > 7 * len(scene.joints)
    assert np.unique(share.round(12)) == pytest.approx((spread_rule().nodes[:-1] + 1) / 2)
    at, after = blocks.positions(motion)[blocks.node[[facet, blocks.nodes.following[facet]]]]
    assert geometry.contact[:, :2] == pytest.approx((1 - share) * at + share * after, abs=1e-12)


def test_small_drifts_agree_with_small_displacements() -> None:
    scene = stone(2, 0.4, 0.4, beam__drive={"displacement": [2e-5, 0], "at": 0.4}, joint__friction=0.6)
    far, near = fem(scene, displacements="finite"), fem(scene)
    assert force_at(far, 1.9e-5) == pytest.approx(force_at(near, 1.9e-5), rel=0.01)
    assert far.force.sum(axis=0) == pytest.approx(near.force.sum(axis=0), rel=0.01)


def test_splitting_block_dissipates_its_fracture_energy() -> None:
    """G_I times the area to 1e-6, at every node, through contact detections."""
    blocks = node_outline(stone(inner_joint=GLUE), 2, 3)
    system = finite_system(blocks)
    motion = np.zeros_like(system.mass)
    motion[system.rigid[1, 0]] = 1.0
    held = replace(system, mass=np.full_like(system.mass, np.inf), carried=Carried(motion), dead=0 * system.dead)
    run = Run(held)
    state = State.at_rest(held)
    for _ in range(100):
        run.carry(state, 0.0095 / (20_000 * run.dt), 200)
    assert run.ledger(state).friction == pytest.approx(GLUE["fracture_energy_1"] * 0.6 * 0.2, rel=1e-6)
    rigid = dem.finite_system.finite_system(blocks.scene).contacts
    assert rigid is not None
    assert system.contacts is not None
    ours, ends = system.contacts.undeformed, rigid.undeformed
    assert len(ours) > len(ends)
    assert set(ours.joint) == set(ends.joint)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"displacements": "large"}, "model fem: displacements = .large.: must be one of"),
        ({"cracks": "blocks"}, "model fem: cracks = .blocks.: is not supported at finite displacements"),
        ({"points": "joints"}, "model fem: points"),
        ({"loads": "inner"}, "model fem: loads"),
        ({"energies": "printed"}, "model fem: energies"),
    ],
)
def test_unsupported_parameters_are_refused(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        run_model("fem", stone(), **{"displacements": "finite", **parameters})


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"beam__drive": {"force": [1, 0]}}, "beam"),
        ({"joint__cohesion": 1e4}, "joint.cohesion"),
        ({"inner_joint": GLUE | {"inset": 0.01}}, "inner_joint.inset"),
    ],
)
def test_unsupported_scenes_are_refused(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(SceneError, match=key):
        run_model("fem", stone(**changes), displacements="finite")
