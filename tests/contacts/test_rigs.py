"""Walls driven by a test rig through finite displacements, against exact solutions."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from dem.dynamic import dem_dynamic
from dem.finite_system import finite_system
from runningbond.dynamics import Carried, Run, State
from runningbond.dynamics.contact_update import contacts_of
from runningbond.dynamics.path_curve import failing
from runningbond.joints import wall_rule
from runningbond.models import run_model
from runningbond.pictures.recording import MotionRecorder
from runningbond.results import Outcome
from runningbond.scene import Array, Scene, SceneError, scene_from_dict
from tests.at_length import at_length

STIFFNESS = 1e10
WALL = {"block_width": 0.4, "block_height": 0.6, "thickness": 0.2}


def rig(courses: int = 1, length: float = 0.4, height: float = 0.6, **changes: Any) -> Scene:
    """Stacked blocks as long as the wall under a beam of 0.1 m and 20 kN that is pushed at the top of the blocks."""
    block = height / courses
    tables: dict[str, Any] = {
        "wall": {"block_width": length, "block_height": block, "thickness": 0.2, "courses": [[1]] * courses},
        "block": {"density": 1000.0},
        "joint": {"friction": 0.9, "normal_stiffness": STIFFNESS, "shear_stiffness": STIFFNESS},
        "support": {"kind": "base"},
        "load": {"gravity": 0.0},
        "beam": {"height": 0.1, "force": [0, -2e4], "drive": {"displacement": [0.03, 0], "at": height}},
    }
    for name, value in changes.items():
        *path, key = name.split("__")
        table = tables
        for step in path:
            table = table.setdefault(step, {})
        table[key] = value
    return scene_from_dict(tables)


def finite(scene: Scene, tolerance: float = 0.01) -> Outcome:
    outcome = dem_dynamic(scene, tolerance, displacements="finite")
    assert "finite displacements" in outcome.message, outcome.message
    return outcome


def column(outcome: Outcome, name: str) -> Array:
    return np.asarray(outcome.path[:, outcome.path_columns.index(name)])


def force_at(outcome: Outcome, displacement: float) -> float:
    return float(np.interp(displacement, *outcome.curve.T))


@pytest.mark.parametrize(("line", "at"), [("moving", 0.6), ("fixed", 0.9), *at_length(("fixed", 0.6))])
def test_rocking_block_resists_by_the_lever_of_its_force(line: str, at: float) -> None:
    """The block (half length b) turns by θ about its toe until the driven point has moved by d.

    d = at sin θ + b (1 − cos θ). A force N that moves with the beam has the lever of its centre, one on a fixed line
    has b, and the drive that of its point above the toe, at cos θ + b sin θ: exact at any rotation. Compliant joints
    shift the rotation centre inwards by at most N / (2 k thickness b), here 1e-5 of b.
    """
    b, top, n = 0.2, 0.65, 2e4
    outcome = finite(rig(beam__force_line=line, beam__drive={"displacement": [0.05, 0], "at": at}), 0.02)
    for d in (0.02, 0.035, 0.05):
        theta = brentq(lambda x, d=d: at * math.sin(x) + b * (1 - math.cos(x)) - d, 0.0, 0.5)
        lever = b * math.cos(theta) - top * math.sin(theta) if line == "moving" else b
        exact = n * lever / (at * math.cos(theta) + b * math.sin(theta))
        assert force_at(outcome, d) == pytest.approx(exact, rel=2e-3)
        assert np.interp(d, outcome.curve[:, 0], column(outcome, "beam rotation [rad]")) == pytest.approx(
            -theta, rel=5e-3
        )


def test_dead_point_and_line_loads_move_with_their_block() -> None:
    """A block rocks about its toe under a beam, a point load at its side and a line load on part of its top.

    By virtual work, exact at any rotation: work of the dead forces as they rise over the displacement of the driven
    point.
    """
    b, h, drive, beam, side, line = 0.25, 1.0, 0.95, 2e4, 5e3, 1.5e4
    scene = rig(
        length=2 * b,
        height=h,
        beam__force=[0, -beam],
        beam__drive={"displacement": [0.2, 0], "at": drive},
        load__dead=[
            {"kind": "point", "at": [0.0, 0.9], "force": [0, -side]},
            {"kind": "line", "from": [0.1, h], "to": [0.3, h], "force": [0, -line]},
        ],
    )
    outcome = finite(scene, 0.02)
    for d in (0.05, 0.1, 0.2):
        theta = brentq(lambda x, d=d: drive * math.sin(x) + b * (1 - math.cos(x)) - d, 0.0, 0.5)
        # a point at (−x, y) from the toe lies y cos θ + x sin θ above it
        moment = sum(
            force * (x * math.cos(theta) - y * math.sin(theta))
            for force, x, y in ((beam, b, h + 0.05), (side, 2 * b, 0.9), (line * 0.2, 2 * b - 0.2, h))
        )
        exact = moment / (drive * math.cos(theta) + b * math.sin(theta))
        assert force_at(outcome, d) == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("to", [[-1.0, 0.9], *at_length([0.25, -0.02])])
def test_ties_of_a_rocking_block_pull_along_their_current_direction(to: list[float]) -> None:
    """To an anchor and to the ground: drive by virtual work, exact at any rotation, and the ground reactions.

    The ground does not carry the force of a tie to an anchor.
    """
    b, h, drive, beam, at = 0.25, 1.0, 0.95, 2e4, [0.0, 0.9]
    tie = {"from": at, "to": to, "area": 1e-5, "young": 2e9, "yield": 1.5e3}
    scene = rig(
        length=2 * b,
        height=h,
        beam__force=[0, -beam],
        beam__drive={"displacement": [0.2, 0], "at": drive},
        tie=[tie],
    )
    outcome, (anchored,) = finite(scene, 0.05), scene.ties.block[:, 1] < 0
    assert anchored == (to[1] > 0)
    for d in (0.05, 0.1, 0.2):
        theta = brentq(lambda x, d=d: drive * math.sin(x) + b * (1 - math.cos(x)) - d, 0.0, 0.5)
        turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
        place, top = turn @ [-2 * b, at[1]], turn @ [-b, h + 0.05]
        span = np.array(to) - [2 * b, 0.0] - place
        longer = math.hypot(*span) - float(scene.ties.length[0])
        pull = min(1.5e3, longer * float(scene.ties.stiffness[0])) * span / math.hypot(*span)
        moment = place[0] * pull[1] - place[1] * pull[0] - beam * top[0]
        exact = moment / (drive * math.cos(theta) + b * math.sin(theta))
        assert force_at(outcome, d) == pytest.approx(exact, rel=2e-3)
        # Balances beam and drive, and the tie if it goes to an anchor.
        on_ground = np.array([-exact, beam]) - (pull if anchored else 0.0)
        for name, force in zip(("ground horizontal [N]", "ground vertical [N]"), on_ground, strict=True):
            assert np.interp(d, outcome.curve[:, 0], column(outcome, name)) == pytest.approx(force, abs=0.01 * beam)
        known = np.interp(d, outcome.curve[:, 0], column(outcome, "tie 0 [N]"))
        assert known == pytest.approx(math.hypot(*pull), abs=2.0)  # joints compress by 0.05 mm


def test_block_between_level_plates_resists_twice_as_much() -> None:
    """The force runs from corner to corner: V = N x / y with their distances x = l cos θ − h sin θ and y."""
    length, height, n = 0.3, 0.6, 2e4
    outcome = finite(rig(length=length, height=height, beam__condition="level"))
    for d in (0.015, 0.03):
        theta = brentq(lambda x, d=d: height * math.sin(x) + length * (1 - math.cos(x)) - d, 0.0, 0.5)
        x = length * math.cos(theta) - height * math.sin(theta)
        exact = n * x / (height * math.cos(theta) + length * math.sin(theta))
        assert force_at(outcome, d) == pytest.approx(exact, rel=2e-3)
        uplift, overlap = height * math.cos(theta) + length * math.sin(theta) - height, 2 * n / (STIFFNESS * 0.03)
        assert np.interp(d, outcome.curve[:, 0], column(outcome, "beam uplift [m]")) == pytest.approx(
            uplift, abs=overlap
        )
    assert not column(outcome, "beam rotation [rad]").any()
    horizontal, vertical = column(outcome, "ground horizontal [N]"), column(outcome, "ground vertical [N]")
    late = slice(len(vertical) // 2, None)
    assert vertical[late] == pytest.approx(n, rel=2e-2)
    assert horizontal[late] == pytest.approx(-outcome.curve[late, 1], abs=2e-2 * n)


def test_small_drifts_agree_with_small_displacements() -> None:
    """A wall of three courses to 0.1 mm: V to 1e-3; joint forces, reactions and works to 5e-3 of the largest."""
    changes = {"wall__courses": [[1, 1], [0.5, 1, 0.5], [1, 1]], "joint__friction": 0.6}
    scene = rig(3, 0.2, 0.3, **changes, beam__drive={"displacement": [1e-4, 0], "at": 0.3})
    far, near = finite(scene), dem_dynamic(scene)
    for d in (2e-5, 5e-5, 1e-4):
        assert force_at(far, d) == pytest.approx(force_at(near, d), rel=1e-3)
    assert far.path_columns == near.path_columns
    assert far.force == pytest.approx(near.force, abs=5e-3 * np.abs(near.force).max())
    for name, scale in (
        ("ground vertical [N]", 2e4),
        ("ground horizontal [N]", 2e4),
        ("work of the live load [J]", 0.1),
    ):
        assert column(far, name)[-1] == pytest.approx(column(near, name)[-1], abs=5e-3 * scale)


@pytest.mark.parametrize(("joint", "arm"), [({}, 4), ({"compressive_strength": 1e12}, 12)])
def test_points_along_a_joint_have_the_stiffness_of_a_line(joint: dict[str, float], arm: int) -> None:
    """A block before uplift: d = 2 V / (k A) + V h² / (k t L³ / 12), with L³ / 4 for springs at the ends only."""
    changes: dict[str, Any] = {f"joint__{name}": value for name, value in joint.items()}
    outcome = finite(rig(**changes, beam__drive={"displacement": [1e-5, 0], "at": 0.6}))
    force, length, height = float(outcome.curve[-1, 1]), 0.4, 0.6
    assert column(outcome, "ground vertical [N]") == pytest.approx(2e4, rel=1e-3)
    exact = 2 * force / (STIFFNESS * 0.2 * length) + force * height**2 / (STIFFNESS * 0.2 * length**3 / arm)
    assert outcome.curve[-1, 0] == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize(
    ("side", "displacements"), [(1, "small"), (-1, "finite"), *at_length((-1, "small"), (1, "finite"))]
)
def test_outcome_locates_crushed_joint_ends(side: int, displacements: Any) -> None:
    """A rocking block crushes only the toe it is pushed to, at the base and nowhere else, because its beam is loose."""
    scene = rig(joint__compressive_strength=1e6, beam__drive={"displacement": [0.02 * side, 0], "at": 0.6})
    outcome = dem_dynamic(scene, displacements=displacements)
    places = scene.joints.ends[outcome.crushed > 1e-4]
    assert places == pytest.approx(scene.blocks.extent(scene.wall)[0] + np.array([[0.4 if side > 0 else 0.0, 0.0]]))
    assert outcome.crushed.max() == pytest.approx(column(outcome, "broken toe [m]")[failing(outcome.curve)])
    assert len(dem_dynamic(rig(), displacements=displacements).crushed) == 0


def test_crushing_toe_shortens_the_lever() -> None:
    """The toe's points carry the strength of their area, the last of them the rest of N = f_m A / 10.

    Their resultant acts at x from the toe, hence V = N (b − x) / h for a force on a fixed line.
    """
    joint: dict[str, Any] = {"joint__compressive_strength": 2.5e6, "joint__cap_shear": 0.0}
    scene = rig(**joint, beam__force_line="fixed", beam__drive={"displacement": [0.02, 0], "at": 0.6})
    rule, share = wall_rule(scene), 0.1
    full = rule.weights / 2
    carried = np.minimum(full, np.maximum(0.0, share - (np.cumsum(full) - full)))
    inside = 0.4 * float(carried @ (1 + rule.nodes)) / 2 / share
    exact = 2e4 * (0.2 - inside) / 0.6
    assert force_at(finite(scene), 0.018) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    ("model", "strength"), [("dem-dynamic", None), *at_length(("dem-dynamic", 1e12), ("fem", None), ("fem", 1e12))]
)
def test_frames_of_a_rig_have_its_joint_tractions(model: str, strength: float | None) -> None:
    """The last frame's tractions carry the load on the ground, and the joint opening matches the rotation."""
    changes: dict[str, Any] = {"block": {"density": 1000.0, "young": 1e12}}
    if strength:
        changes["joint__compressive_strength"] = strength
    scene = rig(**changes, beam__drive={"displacement": [0.003, 0], "at": 0.6})
    recorder = MotionRecorder(scene, None)
    outcome = run_model(model, scene, observe=recorder, displacements="finite")
    frame, points = recorder.frames[-1], recorder.discretisation.points
    ground = (points.block == 2).any(axis=1)
    assert (frame.normal * points.area)[ground].sum() == pytest.approx(-2e4, rel=0.01)
    rotation = abs(column(outcome, "beam rotation [rad]")[-1])
    assert np.ptp(frame.opening[ground]) == pytest.approx(0.4 * rotation, rel=0.01)
    assert outcome.force[:, 0].sum() == pytest.approx(-4e4, rel=0.02)


@pytest.mark.parametrize(
    ("model", "strength"), [("dem-dynamic", None), *at_length(("fem", None), ("dem-dynamic", 1e12))]
)
def test_frame_tractions_balance_a_rotated_wall(model: str, strength: float | None) -> None:
    """A block leans by 5° on its toe: the ground reacts with its weight and the force of the drive.

    The contact lies on the ground's side, whose normal has not rotated.
    """
    joint: dict[str, Any] = {"joint__compressive_strength": strength} if strength else {}
    drive = {"displacement": [0.05, 0], "at": 0.6}
    scene = rig(**joint, block={"density": 1000.0, "young": 1e12}, beam__drive=drive)
    recorder = MotionRecorder(scene, None)
    outcome = run_model(model, scene, 0.05, observe=recorder, displacements="finite")
    frame, points = recorder.frames[-1], recorder.discretisation.points
    assert frame.motion[0, 2] == pytest.approx(-0.08, abs=0.01)
    ground = (points.block == 2).any(axis=1)
    held = (frame.traction * points.area[:, None])[ground].sum(axis=0)
    assert held == pytest.approx([-outcome.curve[-1, 1], 2e4], rel=0.01, abs=20.0)


@pytest.mark.parametrize("displacements", ["small", "finite"])
def test_run_ends_when_the_beam_falls_on_a_crushed_wall(displacements: Any) -> None:
    """The joint is loaded to 0.98 of its compressive strength and pushed: it crushes completely and the beam drops."""
    joint: dict[str, Any] = {"joint__compressive_strength": 1e6, "joint__compressive_fracture_energy": 500.0}
    scene = rig(
        height=0.25,
        **joint,
        beam__condition="level",
        beam__force=[0, -0.98 * 1e6 * 0.4 * 0.2],
        beam__drive={"displacement": [[0.0, 1e-3]], "at": 0.25, "rate": 1e-3},
    )
    outcome = dem_dynamic(scene, displacements=displacements)
    assert outcome.status == "collapse", outcome.message
    assert "the wall falls beyond" in outcome.message
    assert "last rest" not in outcome.message
    assert "the other way" not in outcome.message
    assert outcome.curve[-1, 0] < 5e-4
    assert -10.0 < column(outcome, "beam uplift [m]")[-1] < -0.1


def splitting(drive: dict[str, Any]) -> Scene:
    """A wall of four courses, of which some blocks drift apart."""
    courses = [[1, 1], [0.5, 1, 0.5]] * 2
    return rig(
        wall={"block_width": 0.3, "block_height": 0.15, "thickness": 0.2, "courses": courses},
        joint__friction=0.4,
        joint__inset=0.003,
        load__gravity=9.81,
        beam__drive={"at": 0.65, **drive},
    )


def test_beam_ends_where_its_path_does() -> None:
    """Time steps depend on the contacts: with those of the beginning of each leg it went too far."""
    assert finite(splitting({"displacement": [0.08, 0], "rate": 0.2}), 0.1).curve[-1, 0] == pytest.approx(
        0.08, rel=1e-6
    )


@pytest.mark.long
def test_beam_turns_and_ends_where_its_path_does() -> None:
    """With the time steps of the beginning of each leg it did not return to its start."""
    scene = splitting({"amplitudes": [0.0002, 0.002, 0.01, 0.02], "rate": 0.4})
    moved = finite(scene, 0.2).curve[:, 0]
    assert scene.drive_path[-3:] == (0.02, -0.02, 0.0)
    assert (moved.max(), moved.min(), moved[-1]) == pytest.approx((0.02, -0.02, 0.0), abs=2e-8)


def test_rotated_beam_is_pushed_at_the_current_position_of_its_point() -> None:
    """A push of 1 N has a moment about the origin equal to the current height of the point."""
    scene = rig(beam__drive={"displacement": [0.03, 0], "at": 0.6})
    run, lifted = Run(finite_system(scene)), 1.0
    assert scene.beam is not None
    beam = scene.beam.block
    state = State.at_rest(run.system)
    state.motion[run.system.rigid[beam]] = 0.0, lifted, 0.5
    push = run.resultants(state, 1.0)[beam] - run.resultants(state, 0.0)[beam]
    height = 0.65 + lifted - 0.05 * np.cos(0.5)
    assert push == pytest.approx([1.0, 0.0, -height], rel=1e-9, abs=1e-9)


@pytest.mark.long
def test_mirrored_push_gives_the_mirrored_response() -> None:
    changes = {"wall__courses": [[1, 1], [0.5, 1, 0.5], [1, 1]], "inner_joint": GLUE}
    outcomes = [
        finite(rig(3, 0.2, 0.3, **changes, beam__drive={"displacement": [sign * 0.003, 0], "at": 0.3}))
        for sign in (1, -1)
    ]
    right, left = outcomes
    assert left.curve == pytest.approx(right.curve, abs=1e-2 * right.curve[:, 1].max())
    assert column(left, "beam rotation [rad]")[-1] == pytest.approx(-column(right, "beam rotation [rad]")[-1], rel=1e-2)


def test_rocking_loop_closes() -> None:
    """Forwards, back and to the other side: the same force each time, and net work below 2 % of the largest."""
    outcome = finite(rig(beam__drive={"displacement": [[0.0, 0.01, -0.01, 0.0]], "at": 0.6}))
    moved, force = outcome.curve.T
    there, back = np.argmax(moved), np.argmin(moved)
    for d in (0.003, 0.007):
        out = np.interp(d, moved[: there + 1], force[: there + 1])
        again = np.interp(-d, moved[there : back + 1][::-1], force[there : back + 1][::-1])
        assert np.interp(d, moved[there : back + 1][::-1], force[there : back + 1][::-1]) == pytest.approx(
            out, rel=1e-2
        )
        assert again == pytest.approx(-out, rel=1e-2)
    work = column(outcome, "work of the live load [J]")
    assert abs(work[-1]) < 0.02 * work.max()
    assert abs(moved[-1]) < 1e-6


GLUE = {
    "friction": 0.7,
    "cohesion": 3e5,
    "tensile_strength": 2e5,
    "fracture_energy_1": 500.0,
    "fracture_energy_2": 5000.0,
    "normal_stiffness": 1e11,
    "shear_stiffness": 1e11,
}


def split(displacement: float, **joint: Any) -> tuple[Run, State, float]:
    """A block whose right half is drawn away from its left one, both motions prescribed; and the largest force [N]."""
    scene = rig(**{f"joint__{name}": value for name, value in joint.items()}, inner_joint=GLUE)
    system = finite_system(scene)
    motion = np.zeros_like(system.mass)
    motion[3] = 1.0
    held = replace(system, mass=np.full_like(system.mass, np.inf), carried=Carried(motion), dead=0 * system.dead)
    run, most = Run(held), 0.0
    state, steps = State.at_rest(held), 20_000
    for _ in range(100):
        most = max(most, -run.carry(state, displacement / (steps * run.dt), steps // 100))
    return run, state, most


@pytest.mark.parametrize("joint", [{}, {"compressive_strength": 1e12}])
def test_splitting_block_spends_its_fracture_energy_and_is_dry_afterwards(joint: dict[str, Any]) -> None:
    """Spends G_I times the area to 1e-6 over contact searches that transfer the damage; the peak force is f_t A."""
    area = 0.6 * 0.2
    run, state, most = split(0.0095, **joint)  # complete separation needs 2 G_I / f_t = 5 mm
    search = run.system.contacts
    assert search is not None
    assert contacts_of(state) is not search.undeformed
    assert run.ledger(state).friction == pytest.approx(GLUE["fracture_energy_1"] * area, rel=1e-6)
    assert state.external == pytest.approx(GLUE["fracture_energy_1"] * area, rel=1e-3)
    assert most == pytest.approx(GLUE["tensile_strength"] * area, rel=0.03)

    back = 0.0095 + 1e-5
    for _ in range(100):
        run.carry(state, -back / (20_000 * run.dt), 200)
    assert -run.forces(state)[0].sum() == pytest.approx(-GLUE["normal_stiffness"] * state.motion[3] * area, rel=1e-6)
    assert run.ledger(state).friction == pytest.approx(GLUE["fracture_energy_1"] * area, rel=1e-6)


def test_weak_base_joint_uses_its_own_cohesion_and_friction() -> None:
    """Only the base is weak: peak V = c A + μ N, then μ N, and it spends G_II A in addition to friction."""
    weak = {
        "friction": 0.3,
        "cohesion": 5e4,
        "fracture_energy_1": 20.0,
        "fracture_energy_2": 20.0,
        "normal_stiffness": STIFFNESS,
        "shear_stiffness": STIFFNESS,
    }
    scene = rig(
        length=0.6,
        height=0.2,
        joints={"weak": weak},
        assign=[{"joint": "weak", "between": ["ground", "*"]}],
        beam__drive={"displacement": [0.01, 0], "at": 0.2},
    )
    outcome = finite(scene, 0.05)
    n, area = 2e4, 0.12
    assert outcome.curve[:, 1].max() == pytest.approx(weak["cohesion"] * area + 0.3 * n, rel=0.03)
    assert force_at(outcome, 0.008) == pytest.approx(0.3 * n, rel=2e-3)
    spent = column(outcome, "work spent in joints [J]")
    end = int(np.searchsorted(outcome.curve[:, 0], 0.008))
    slip = outcome.curve[end, 0] - 2 * 0.3 * n / (STIFFNESS * area)
    assert spent[end] == pytest.approx(0.3 * n * slip + weak["fracture_energy_2"] * area, rel=5e-3)


def test_block_that_leaves_its_joint_slides_with_the_default_friction() -> None:
    """A block moves from its own half of the ground to the top of a neighbour and keeps the default friction."""
    changes = {"wall__courses": [[1, 1], [0.5, 1, 0.5], [1, 1]]}
    scene = rig(3, 0.2, 0.3, **changes, beam__drive={"displacement": [0.03, 0], "at": 0.3}, joint__friction=0.3)
    assert finite(scene).curve[-1, 1] == pytest.approx(0.3 * 2e4, rel=0.01)


@pytest.mark.parametrize(
    ("changes", "displacements", "message"),
    [
        ({}, "big", 'model dem-dynamic: displacements = .big.: must be one of "small", "finite"'),
        ({}, "finit", 'did you mean "finite"'),
        ({}, 2, "must be one of"),
        (
            {"beam__drive": {"force": [1, 0]}},
            "finite",
            "^beam: is not supported at finite displacements where live loads",
        ),
        ({"joint__cohesion": 1e4}, "finite", "joint.cohesion = 10000"),
        ({"joint__cohesion": 1e4, "joint__fracture_energy_1": 10.0}, "finite", "joint.cohesion"),
        ({"inner_joint": {k: v for k, v in GLUE.items() if "energy" not in k}}, "finite", "inner_joint.cohesion"),
        ({"inner_joint": GLUE | {"inset": 0.01}}, "finite", "inner_joint.inset = 0.01: finite displacements need one"),
        ({"joint__inset": 0.01, "inner_joint": GLUE}, "finite", "inner_joint.inset = 0"),
        ({"joint": {"friction": 0.6}}, "finite", "joint.mortar"),
        ({"wall": {**WALL, "courses": [[1, 1]]}, "support__kind": "corners"}, "finite", "support.kind"),
    ],
)
def test_unsupported_finite_displacement_cases_are_refused(
    changes: dict[str, Any], displacements: Any, message: str
) -> None:
    with pytest.raises(SceneError, match=message):
        run_model("dem-dynamic", rig(**changes), displacements=displacements)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"beam__force_line": "fix"},
            'beam.force_line = .fix.: must be one of "moving", "fixed"; did you mean "fixed"',
        ),
        ({"beam__force_line": True}, "beam.force_line = True"),
        ({"beam__force_line": ["fixed"]}, "beam.force_line"),
        ({"beam__force_line": "fixed", "beam__force": [0, 0]}, "beam.force = .*: is missing"),
        ({"beam__forceline": "fixed"}, 'did you mean "force_line"'),
    ],
)
def test_invalid_force_lines_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        rig(**changes)
