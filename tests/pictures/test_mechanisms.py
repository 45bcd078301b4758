"""Mechanisms are drawn only if the loads can drive them; joint states follow from the jumps."""

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest
from matplotlib.text import Text

from dem.static import dem_static
from meshing import wall_mesh
from runningbond import Wall
from runningbond.compare.published import published_scene
from runningbond.joints import wall_points
from runningbond.limit import limit
from runningbond.limit.kinematics import dead_load, live_load
from runningbond.models import run_model
from runningbond.pictures.captions import mechanism_caption, to_png
from runningbond.pictures.curve import curve_figure
from runningbond.pictures.flat import figure_of
from runningbond.pictures.frame import Discretisation, Frame, Triangles
from runningbond.pictures.inline import inline_mechanism
from runningbond.pictures.joint_state import VISIBLE_JUMP, JointState
from runningbond.pictures.mechanism import mechanism_frame, mechanism_shape, mechanism_warning, outcome_check
from runningbond.pictures.resultants import resultants
from runningbond.pictures.style import CRUSHED
from runningbond.pictures.vtk_grids import GridBuilder, shape_of_grids
from runningbond.results import Outcome, check_mechanism
from runningbond.results.mechanism import MAX_OVERLAP, carried
from runningbond.scene import Array, Scene, scene_from_dict
from tests.at_length import at_length
from tests.fem_interface.walls import MORTAR
from tests.walls import content, courses, panel

from .scenes import turning_support

DRIVE = {"displacement": [0.12, 0.0]}
POINT = {"kind": "point", "at": [0.2, 0.35], "force": [0.0, -1.0]}


@pytest.mark.parametrize("model", ["limit", "limit-nonassociated", "dem-static"])
@pytest.mark.parametrize("name", ["panel-01", "panel-04", "point-load-4", "wall-w1", "wall-w2", "wall-w3"])
def test_loads_drive_mechanisms_of_published_walls(name: str, model: str) -> None:
    """The live load does positive work, the net work with friction is not negative, and blocks do not overlap.

    In `dem-static`, a weightless wall whose slip compresses its joints creeps steadily while its springs still deform.
    """
    scene = published_scene(name)
    settings: dict[str, Any] = {"starts": 1} if model == "limit-nonassociated" else {}
    outcome = run_model(model, scene, 0.01, **settings)
    check = outcome_check(scene, outcome)
    assert check is not None
    assert check.live is not None
    assert check.live > 0
    assert check.total >= -1e-6 * check.scale
    gives = model == "dem-static" and not scene.dead_forces.acceleration.any()
    assert check.overlap < (1e-3 if gives else 1e-6)
    assert check.warning == ""
    backwards = replace(outcome, motion=-outcome.motion)
    assert mechanism_shape(scene, backwards) is None
    assert mechanism_warning(scene, backwards) == "mechanism not drawn: the live load does negative work on this motion"


def moving(scene: Scene, x: float, y: float, spin: float = 0.0) -> Array:
    """Motion of the highest block only."""
    motion = np.zeros((len(scene.blocks), 3))
    motion[int(np.argmax(scene.blocks.centroid[:, 1] * scene.wall))] = x, y, spin
    return motion


def test_works_and_overlap_of_block_by_hand() -> None:
    """A block of 0.4 × 0.2 × 0.12 m and 1800 kg/m³ moves sideways by 0.6 m and sinks 0.8 m into the one below."""
    scene = courses([[1], [1]], height=0.2)
    weight = 0.4 * 0.2 * 0.12 * 1800 * 9.81
    check = check_mechanism(scene, 5 * moving(scene, 0.6, -0.8), dead_load(scene), live_load(scene), 0.5)
    assert check.live == pytest.approx(0.6 * weight, rel=1e-12)
    assert check.total == pytest.approx((0.8 + 0.5 * 0.6) * weight, rel=1e-12)
    assert check.overlap == pytest.approx(0.8, rel=1e-12)
    assert check.is_driven
    assert check.warning == "blocks overlap by up to 80% of the largest displacement"
    lifted = check_mechanism(scene, moving(scene, 0.1, 1.0), dead_load(scene), live_load(scene), 0.5)
    assert lifted.warning == "the loads do negative work on this motion"


def test_warning_of_overlap_has_threshold() -> None:
    scene = courses([[1], [1]])
    for depth, drawn in ((0.9 * MAX_OVERLAP, ""), (0.1, "blocks overlap by up to 10% of the largest displacement")):
        outcome = Outcome("", "a model", "collapse", 0.6, motion=moving(scene, 1.0, -depth))
        assert mechanism_shape(scene, outcome) is not None
        assert mechanism_warning(scene, outcome) == drawn


def test_load_without_work_drives_no_mechanism() -> None:
    scene = courses([[1], [1]], load__live=POINT)
    outcome = Outcome("", "a model", "collapse", 1.0, motion=moving(scene, 1.0, 0.0))
    assert mechanism_warning(scene, outcome) == "mechanism not drawn: the live load does no work on this motion"


def test_fall_under_dead_load_needs_no_live_work() -> None:
    scene = courses([[1], [1]])
    falling = Outcome("", "a model", "infeasible", motion=moving(scene, -0.6, -0.01))
    check = outcome_check(scene, falling)
    assert check is not None
    assert check.live is None
    assert check.is_driven


@pytest.mark.parametrize("load", [{"kind": "lateral"}, {"kind": "point", "at": [0.2, 0.35], "force": [0, -1]}])
def test_live_load_is_not_drawn_for_fall_under_dead_load(load: dict[str, Any]) -> None:
    scene = courses([[1], [1]], load__live=load)
    answers: tuple[tuple[Literal["collapse", "infeasible"], int], ...] = (("collapse", 1), ("infeasible", 0))
    for status, drawn in answers:
        outcome = Outcome("", "a model", status, 0.6 if drawn else None, motion=moving(scene, 0.6, -0.01))
        shape = mechanism_shape(scene, outcome)
        assert shape is not None
        assert len(shape.scene.load.live) == drawn
        said = mechanism_caption(scene, outcome, [], shape).notes[0]
        assert said.startswith("under dead load; its fastest corner is drawn to move") == (status == "infeasible")


@pytest.mark.parametrize(
    "changes",
    [
        {"load__live": {"kind": "settlement", "box": [[-5, -5], [5, 1e-4]], "rotation_angle": 9.0, "about": [0.2, 0]}},
        {"load__live": None, "beam": {"height": 0.1, "condition": "level", "force": [0, -2e3], "drive": DRIVE}},
    ],
    ids=["turned ground", "driven beam"],
)
def test_blocks_that_turn_together_by_large_angles_stay_in_contact(changes: dict[str, Any]) -> None:
    """Joints under pressure are closed: linear in rotations of 0.1 they would overlap by percents of the motion."""
    stiff = {"joint__normal_stiffness": 1e10, "joint__shear_stiffness": 4e9, "joint__friction": 0.9}
    size = {"block_width": 0.3, "block_height": 0.3, "thickness": 0.3, "courses": [[1]] * 3}
    wall = Wall(content(wall=size, **stiff, **changes))
    scene, result = wall.scene, wall.run("dem-dynamic", tolerance=0.05, displacements="finite")
    assert result.outcome.moved is not None
    joints = result.joints
    pressed = joints["normal_force"] < -0.05 * np.abs(joints["normal_force"]).max()
    assert pressed.sum() >= 2
    assert np.abs(joints["opening"][pressed]).max() < 1e-3
    assert mechanism_warning(scene, result.outcome) == ""
    shape = mechanism_shape(scene, result.outcome)
    assert shape is not None
    drawn = float(np.hypot(*(shape.placed - shape.points).T).max())
    assert f"is drawn to move {drawn:.2g} m" in mechanism_caption(scene, result.outcome, [], shape).notes[0]
    edges = np.diff(shape.placed.reshape(-1, 4, 2), axis=1)
    assert np.hypot(*edges.T) == pytest.approx(np.hypot(*np.diff(shape.points.reshape(-1, 4, 2), axis=1).T), rel=1e-2)
    if scene.settlement is None:
        assert len(shape.hinges) == 2
    else:
        lines, _, _ = resultants(shape, result.outcome)
        assert np.abs(lines[:, 1, 0] - lines[:, 0, 0]) == pytest.approx(0.0, abs=1e-3)  # weights are vertical


def states(scene: Scene, x: float, y: float) -> set[int]:
    """States of the joint under the highest block."""
    frame = mechanism_frame(scene, Outcome("", "a model", "collapse", 0.6, motion=moving(scene, x, y)))
    assert frame is not None
    upper = np.argmax(scene.blocks.centroid[:, 1] * scene.wall)
    return set(frame.state[(wall_points(scene).block == upper).any(axis=1)].tolist())


def test_visibly_open_joint_is_open_at_any_slip() -> None:
    """Friction is 0.6. Without dilatancy a joint that opens by 0.2 and slides by 0.8 is open."""
    scene = courses([[1], [1]])
    assert states(scene, 0.8, 0.2) == {JointState.OPEN}
    assert states(scene, 0.8, 0.5 * VISIBLE_JUMP) == {JointState.SLIDE}
    assert states(scene, 0.5 * VISIBLE_JUMP, 0.0) == {JointState.STICK}


CRUSHING = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9, "compressive_strength": 2e6}


@pytest.mark.parametrize(("crushed", "crosses"), [([0.0, 1e-3], 1), ([0.0, 1e-7], 0), ([1e-3, 0.0], 0)])
def test_closing_gap_is_not_crushed(crushed: list[float], crosses: int) -> None:
    """A turning block closes the right end of its joint, which was crushed by 1 mm or 0.1 µm, or only at the left.

    Walls that spring back during collapse close gaps everywhere, and were drawn as if they were crushed everywhere.
    """
    scene = courses([[1]], width=0.4, height=0.8, joint=CRUSHING)
    motion = np.array([[0.4, -0.2, -1.0], [0.0, 0.0, 0.0]])
    outcome = Outcome("", "dem-dynamic", "collapse", 0.4, motion=motion, crushed=np.array([crushed]))
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    assert len(shape.crosses) == crosses


def test_crushed_ends_are_crosses_without_warning() -> None:
    """A block turns about a point a quarter of its width from its toe: the heel opens, the toe crushes the joint."""
    scene = courses([[1]], width=0.4, height=0.8, joint=CRUSHING)
    low, turn = scene.blocks.extent(scene.wall)[0], np.array([0.3, 0.0])
    arm = scene.blocks.centroid[0] - low - turn
    outcome = Outcome("", "limit", "collapse", 0.4, motion=np.array([[arm[1], -arm[0], -1.0], [0.0, 0.0, 0.0]]))
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    assert shape.state == [JointState.OPEN]
    assert len(shape.hinges) == 0
    toe = shape.placed[np.argmax(shape.points @ [1, -1])]
    assert shape.crosses == pytest.approx(((toe + low + [0.4, 0.0]) / 2)[None], abs=1e-12)
    assert mechanism_warning(scene, outcome) == ""
    dry = courses([[1]], width=0.4, height=0.8, joint={"friction": 0.6})
    assert "overlap" in mechanism_warning(dry, outcome)
    key = figure_of(scene, outcome).axes[0].get_legend()
    assert key is not None
    assert "crushes" in [text.get_text() for text in key.get_texts()]
    grids = GridBuilder(Discretisation.of_rigid_blocks(scene))
    frame = mechanism_frame(scene, outcome)
    assert frame is not None
    frame = frame.scaled(1e-3)  # only small motions are enlarged
    read = shape_of_grids(scene, grids.blocks(frame), grids.joints(frame))
    assert read.crosses == pytest.approx(shape.crosses, abs=1e-6)
    seen = inline_mechanism(shape, shape.extent, "rest")
    assert seen.count(CRUSHED) == 1


@pytest.mark.parametrize("title", [r"$\frac{a}{b$", "one $ alone", *at_length("from $5 to $10 a brick", "a_b^c")])
def test_title_is_not_parsed_as_formula(title: str) -> None:
    """Dollar signs are printed as they are in every picture with a title."""
    scene = panel(wall__length=0.48, wall__height=0.12, joint__mortar=MORTAR, title=title)
    outcome = dem_static(scene)
    for figure in (figure_of(scene, outcome), curve_figure(scene, outcome)):
        assert to_png(figure)
        texts = [*figure.findobj(Text)]
        assert [each for each in texts if title in each.get_text() and not each.get_parse_math()]


@pytest.mark.parametrize("of", ["polygons", "triangles"])
def test_frame_of_file_contains_support_motion(of: str) -> None:
    """A support that translates and rotates, to first order; its far corners are cut off in the file."""
    scene = scene_from_dict(turning_support())
    motion = scene.support_motion
    assert np.count_nonzero(motion.any(axis=1)) == 1
    discretisation = Discretisation.of_rigid_blocks(scene)
    nothing = np.zeros(len(discretisation.points))
    frame = Frame(1.0, motion, nothing, nothing, nothing, nothing, nothing.astype(np.int64))
    if of == "triangles":
        mesh = wall_mesh(scene)
        discretisation = replace(discretisation, triangles=Triangles(mesh.points, mesh.triangles, mesh.triangle_block))
        frame = replace(frame, displacement=carried(scene.blocks, mesh.block, mesh.points, motion))
    grids = GridBuilder(discretisation)
    read = shape_of_grids(scene, grids.blocks(frame), grids.joints(frame))
    assert read.motion == pytest.approx(motion, rel=1e-5, abs=1e-8)


def test_joint_that_opens_by_its_dilatancy_slides() -> None:
    scene = courses([[1], [1]])
    assert states(scene, 0.8, 0.6 * 0.8) == {JointState.SLIDE}
    assert states(scene, 0.5, 0.8) == {JointState.OPEN}


@pytest.mark.parametrize("name", ["wall-w3", *(pytest.param(f"panel-{k:02d}", marks=pytest.mark.long) for k in (1, 4))])
def test_joint_states_in_limit_analysis(name: str) -> None:
    """Associated joints that slide open by their dilatancy; otherwise sliding joints open by at most `VISIBLE_JUMP`."""
    scene = published_scene(name)
    associated = mechanism_frame(scene, limit(scene))
    other = mechanism_frame(scene, run_model("limit-nonassociated", scene, 0.01))
    assert associated is not None
    assert other is not None
    slides = associated.state == JointState.SLIDE
    assert slides.any()
    assert associated.opening[slides] == pytest.approx(
        scene.joint.friction * np.abs(associated.slip[slides]), abs=0.011
    )
    assert (other.opening[other.state == JointState.SLIDE] <= VISIBLE_JUMP).all()
    assert (other.opening[other.state == JointState.OPEN] > VISIBLE_JUMP).all()


def test_outcome_without_mechanism_is_not_checked() -> None:
    scene = panel()
    assert outcome_check(scene, Outcome("", "homog", "collapse", 0.5)) is None
    assert mechanism_warning(scene, Outcome("", "homog", "collapse", 0.5)) == ""
