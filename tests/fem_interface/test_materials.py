"""Walls of several materials: stiffness and mass per block, strength, inset and fracture energies per joint."""

from typing import Any

import numpy as np
import pytest

from fem_interface.fracture import corrected_energies, fractured
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.system import system_of
from runningbond.dynamics import Criteria, Run, State, settle
from runningbond.joints import joint_stiffness
from runningbond.scene import Scene, SceneError
from tests.walls import courses

from .walls import MORTAR

LIME = {"young": 2e8, "poisson": 0.1, "thickness": 0.01}
OAK = {"density": 700.0, "young": 5e8}
PUSHED = {"gravity": 0.0, "live": {"kind": "point", "at": [0.0, 0.1], "force": [1, 0]}}


def column(**changes: Any) -> Scene:
    """A stone block on cement mortar under an oak block on lime mortar, both 0.4 × 0.175 m and 0.12 m thick."""
    tables: dict[str, Any] = {
        "block": {"density": 1800.0, "young": 2e9},
        "joint": {"friction": 0.6, "mortar": MORTAR},
        "materials": {"oak": OAK},
        "joints": {"lime": {"friction": 0.5, "cohesion": 1e4, "tensile_strength": 1e4, "inset": 0.02, "mortar": LIME}},
        "assign": [
            {"block": "oak", "box": [[0, 0.2], [1, 0.3]]},
            {"joint": "lime", "between": ["oak", "block"]},
        ],
    }
    return courses([[1.0], [1.0]], **{**tables, **changes})


@pytest.mark.parametrize("modes", [6, "all"])
def test_shortening_of_column_is_sum_of_its_parts(modes: Any) -> None:
    """u = N Σ h / (E A) + N Σ 1 / (k A), under uniform pressure of a beam."""
    beam = {"height": 0.1, "condition": "level", "force": [0, -1e4]}
    scene = column(beam=beam, load=PUSHED, joints={"lime": {"friction": 0.5, "mortar": LIME}})
    run = Run(system_of(modal_wall(scene, modes=modes)))
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=1.0, rest=1e-7)) == "stable"
    area = 0.4 * 0.12
    blocks = 0.175 / (2e9 * area) + 0.175 / (OAK["young"] * area)
    joints = sum(
        1 / (joint_stiffness(scene.joint_materials[k]).normal * area) for k in scene.material_of_joint.tolist()
    )
    assert sorted(scene.joint_materials[k].name for k in scene.material_of_joint) == ["joint", "joint", "lime"]
    assert scene.beam is not None
    sunk = run.system.motion_of_blocks(state.motion)[scene.beam.block or 0, 1]
    assert sunk == pytest.approx(-1e4 * (blocks + joints), rel=1e-5)


def _mass(wall: ModalWall) -> float:
    """Mass of the moving blocks."""
    return float(sum(wall.mass[wall.rigid[block, 0]] for block in np.flatnonzero(~wall.scene.fixed)))


@pytest.mark.parametrize("loads", ["consistent", "inner"])
def test_pieces_of_cracking_blocks_have_weight_of_their_block(loads: Any) -> None:
    scene = column(inner_joint={"friction": 0.6, "cohesion": 1e9, "tensile_strength": 1e9, "mortar": MORTAR})
    wall = modal_wall(scene, 2, cracks="blocks")
    exact = scene.mass[~scene.fixed].sum()
    assert _mass(wall) == pytest.approx(exact, rel=1e-12)
    weight = wall.load(wall.scene.dead_forces, loads)[wall.rigid[~wall.scene.fixed, 1]].sum()
    assert weight == pytest.approx(-9.81 * exact, rel=1e-9)
    names = [wall.scene.joint_materials[k].name for k in wall.scene.material_of_joint]
    inner = wall.scene.joints.inner
    assert {name for name, cut in zip(names, inner, strict=True) if cut} == {"inner_joint"}
    assert {name for name, cut in zip(names, inner, strict=True) if not cut} == {"joint", "lime"}


def test_each_joint_keeps_its_own_inset() -> None:
    scene = column()
    points = modal_wall(scene, 2).elements.points
    lime = np.flatnonzero([scene.joint_materials[k].inset > 0 for k in scene.material_of_joint])
    for joint in range(len(scene.joints)):
        x = points.position[points.joint == joint, 0]
        inset = 0.02 if joint in lime else 0.0
        assert np.ptp(x) == pytest.approx(0.4 - 2 * inset)


def test_fracture_energies_follow_from_each_joints_own_mortar() -> None:
    scene = column(joint__cohesion=2e4, joint__tensile_strength=2e4)
    materials, of_joint = fractured(scene, "corrected")
    for joint, length in enumerate(scene.joints.length):
        own = scene.joint_materials[scene.material_of_joint[joint]]
        young = LIME["young"] if own.name == "lime" else MORTAR["young"]
        exact = corrected_energies(length, own.cohesion, own.tensile_strength, young)
        found = materials[of_joint[joint]]
        assert (found.fracture_energy_1, found.fracture_energy_2) == pytest.approx(exact)


def test_missing_mortar_is_refused_by_joint_name() -> None:
    lime = {"friction": 0.5, "normal_stiffness": 1e10, "shear_stiffness": 1e10}
    with pytest.raises(SceneError, match=r"joints\.lime\.mortar: is missing"):
        fractured(column(joints={"lime": lime}), "corrected")


def test_block_slides_on_weaker_joint() -> None:
    """Oak on dry lime mortar slides at 0.3; the stone block below, at 0.6, does not move."""
    scene = column(joints={"lime": {"friction": 0.3, "mortar": LIME}})
    outcome = fem(scene, 3e-3)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= 0.3 * (1 + 1e-6)
    assert outcome.upper >= 0.3 * (1 - 1e-6)
    assert outcome.motion[0] == pytest.approx(0.0, abs=1e-3)
