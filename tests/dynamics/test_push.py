"""Walls that live loads push far: blocks about their toes, walls from the load of limit analysis on, what ends them."""

import math
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.figure import Figure

from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from runningbond import Wall
from runningbond.dynamics import Run, State
from runningbond.dynamics.contact_update import ContactUpdate
from runningbond.dynamics.lead import Traverse, TraverseRow
from runningbond.dynamics.push import Push
from runningbond.joints import wall_points
from runningbond.limit import limit_nonassociated
from runningbond.limit.kinematics import jump_operator
from runningbond.pictures.curve import draw_curve
from runningbond.results import Outcome
from runningbond.scene import Array, Scene, SceneError
from tests.dynamics.test_led import block, brackets
from tests.fem_interface.walls import MORTAR
from tests.walls import courses, panel

WIDTH, HEIGHT = 0.06, 0.24
TOE = np.array([WIDTH, 0.0])


def about_its_toe(at: Array, angle: float) -> Array:
    """Where a point of a block is from its toe, about which that has turned clockwise."""
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(np.array([[c, s], [-s, c]]) @ (at - TOE))


def slender(live: dict[str, Any] | list[dict[str, Any]]) -> Scene:
    return block(WIDTH, HEIGHT, joint__friction=1.4, load__live=live)


def angles(curve: Array, at: Array, direction: Array) -> Array:
    """Rotations at which a point of the block has gone by the displacements of a curve along a direction."""
    every = np.linspace(0.0, math.atan(WIDTH / HEIGHT) + 0.05, 2000)
    gone = [(about_its_toe(at, angle) - (at - TOE)) @ direction for angle in every]
    return np.interp(curve[:, 0], gone, every)


def follows(outcome: Outcome, exact: Array) -> None:
    """As exact at every row: to the tolerance while the push gathers speed, and to 5e-4 from there to the brink."""
    moved, load = outcome.curve.T
    brackets(outcome, exact[0], 5e-3)
    given = moved > 1e-5  # before that the joint gives
    assert load[given] == pytest.approx(exact[given], abs=5e-3 * exact[0])
    steady = moved > 0.6 * moved[-1]
    assert steady.sum() > 30
    assert load[steady] == pytest.approx(exact[steady], abs=5e-4 * exact[0])


@pytest.mark.parametrize("model", [dem_dynamic, fem])
def test_a_block_is_pushed_by_its_weight_until_it_stands_on_its_corner(model: Any) -> None:
    """λ = tan(α − θ), tan α = b / h, and nothing once the corner above the toe has gone by h sin α."""
    outcome = model(slender({"kind": "lateral"}), 0.005, displacements="finite")
    corner, alpha = np.array([WIDTH, HEIGHT]), math.atan(WIDTH / HEIGHT)
    follows(outcome, np.tan(alpha - angles(outcome.curve, corner, np.array([1.0, 0.0]))))
    assert f"falls to nothing at {HEIGHT * math.sin(alpha):.4g} m" in outcome.message
    assert outcome.curve[-1, 1] <= 0


@pytest.mark.parametrize("model", [dem_dynamic, fem])
def test_a_force_at_a_point_goes_along_with_it(model: Any) -> None:
    """Pushed at the corner farther from the toe, which rises: λ F (its height) = W (arm of the middle)."""
    at, middle, direction = np.array([0.0, HEIGHT]), np.array([WIDTH / 2, HEIGHT / 2]), np.array([1.0, 0.0])
    scene = slender({"kind": "point", "at": at.tolist(), "force": direction.tolist()})
    outcome, weight = model(scene, 0.005, displacements="finite"), 9.81 * scene.mass[0]
    turned = angles(outcome.curve, at, direction)
    exact = [-weight * about_its_toe(middle, angle)[0] / about_its_toe(at, angle)[1] for angle in turned]
    follows(outcome, np.array(exact))


@pytest.mark.parametrize("model", [dem_dynamic, fem])
def test_a_couple_is_the_same_however_far_its_block_has_turned(model: Any) -> None:
    middle = np.array([WIDTH / 2, HEIGHT / 2])
    scene = slender({"kind": "moment", "at": middle.tolist(), "moment": -1.0})
    outcome, weight = model(scene, 0.005, displacements="finite"), 9.81 * scene.mass[0]
    _, at, direction = scene.control_point
    exact = [-weight * about_its_toe(middle, angle)[0] for angle in angles(outcome.curve, at, direction)]
    follows(outcome, np.array(exact))


def test_a_wall_peaks_at_the_load_of_limit_analysis_and_bears_less_and_less() -> None:
    """The smallest that is certified; limit analysis whose slip opens joints has a quarter more."""
    scene = panel(wall__length=0.36, wall__height=0.36, joint__friction=1.2, joint__mortar=MORTAR)
    outcome = dem_dynamic(scene, displacements="finite", distance=0.02)
    exact = limit_nonassociated(scene).multiplier
    assert exact is not None
    brackets(outcome, exact, 0.01)
    peak = int(outcome.curve[:, 1].argmax())
    assert np.diff(outcome.curve[peak:, 1]).max() < 1e-3 * exact
    assert outcome.curve[-1, 1] < 0.95 * exact
    # Its mechanism is that of the wall as built, in which nothing overlaps; its curve falls where all can see it.
    jumps = jump_operator(wall_points(scene), scene.blocks.centroid).opening @ outcome.motion.ravel()
    assert jumps.min() > -0.01
    axes = Figure().add_subplot()
    draw_curve(axes, scene, outcome)
    assert axes.get_xscale() == "linear"


def test_the_ground_bears_the_push_and_the_weight() -> None:
    scene = panel(wall__length=0.36, wall__height=0.36, joint__mortar=MORTAR)
    outcome = dem_dynamic(scene, 0.02, displacements="finite", distance=0.01)
    weight = 9.81 * scene.mass[~scene.fixed].sum()
    columns = [*outcome.path_columns]
    along, up = (outcome.path[20:, columns.index(f"ground {axis} [N]")] for axis in ("horizontal", "vertical"))
    assert -along == pytest.approx(outcome.curve[20:, 1] * weight, abs=0.1 * weight)  # a moment's, and a row's mean
    assert -along.mean() == pytest.approx(outcome.curve[20:, 1].mean() * weight, rel=0.01)
    assert up.mean() == pytest.approx(weight, rel=0.01)


def test_a_push_is_the_same_whatever_the_unit_of_its_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many steps, and as many looks at how far blocks have come; λ is one over the unit, to the last bit.

    So it is for a unit that is a power of two, which leaves all digits as they are.
    """
    looks, look = [0], ContactUpdate.steps_until_next_look

    def counted(self: ContactUpdate, *arguments: Any) -> int:
        looks[0] += 1
        return look(self, *arguments)

    monkeypatch.setattr(ContactUpdate, "steps_until_next_look", counted)
    told = []
    for unit in (1.0, 2.0**20):
        looks[0] = 0
        scene = slender({"kind": "point", "at": [0.0, HEIGHT], "force": [unit, 0.0]})
        outcome = dem_dynamic(scene, 0.02, displacements="finite", distance=0.02)
        assert outcome.lower is not None
        assert outcome.upper is not None
        told.append((outcome.status, outcome.steps, looks[0], unit * outcome.lower, unit * outcome.upper))
    assert told[0] == told[1]
    assert told[0][0] == "collapse"


def test_a_push_ends_where_it_is_asked_to() -> None:
    """Within a row of a two hundredth of it."""
    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=0.004)
    assert outcome.curve[-1, 0] == pytest.approx(0.004, rel=0.01)


def test_ctrl_c_leaves_the_last_push_that_came_to_its_end() -> None:
    """In the second one, which has hardly begun."""
    pushes: list[float] = []

    def stop(run: Run, state: State, multiplier: float) -> None:
        pushes.extend([multiplier] if run.led and multiplier == 0 else [])
        if len(pushes) == 2:
            raise KeyboardInterrupt

    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=0.004, observe=stop)
    assert (outcome.status, outcome.multiplier) == ("undecided", None)
    assert "interrupted" in outcome.message
    assert outcome.curve[-1, 0] == pytest.approx(0.004, rel=0.05)


def test_a_wall_that_falls_as_the_push_gathers_speed_is_followed_no_further() -> None:
    """It leans by a twentieth of the distance: where its load comes to nothing is told all the same."""
    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=20 * WIDTH)
    brink = HEIGHT * math.sin(math.atan(WIDTH / HEIGHT))
    assert outcome.curve[-1, 0] == pytest.approx(brink, rel=0.02)
    assert f"falls to nothing at {brink:.4g} m" in outcome.message
    assert (outcome.curve[:-1, 1] >= 0).all()


def test_a_distance_that_no_wall_goes_is_no_other_push() -> None:
    """It is not begun so fast that its peak is missed: a hundred metres were, whose bracket did not have tan α."""
    near, far = (dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=d) for d in (None, 100.0))
    assert np.array_equal(near.curve, far.curve)
    brackets(far, WIDTH / HEIGHT, 0.01)


@pytest.mark.parametrize(("peak", "said"), [(8.9e-5, "the peak is at 8.9e-05 m: a shorter distance"), (0.01, "")])
def test_a_peak_at_the_very_beginning_asks_for_a_shorter_way(peak: float, said: str) -> None:
    nothing: Any = None
    lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
    for side in (1.0, -1.0):
        curve = np.array([[0.0, 0.0], [side * peak, 0.4], [side * 0.1, 0.3], [side * 0.2, 0.0]])
        assert lead.remedy(curve).startswith(said)
        assert bool(lead.remedy(curve)) == bool(said)


def test_a_wall_that_falls_onto_the_ground_tells_the_peak_before_it() -> None:
    """A slab on a pier tips at W a / c, and bears far more once its corner stands on the ground."""
    at_end = {"kind": "point", "at": [0.6, 0.2], "force": [0.0, -1.0]}
    scene = courses([[1], [1.5]], 0.4, 0.1, joint__mortar=MORTAR, load__live=at_end)
    outcome = dem_dynamic(scene, 0.2, displacements="finite")
    assert outcome.curve[:, 1].max() > 400
    peak = float(outcome.message.split("had fallen from ")[1].split()[0])
    assert peak == pytest.approx(9.81 * scene.mass[1] * 0.1 / 0.2, rel=5e-3)
    alone = dem_dynamic(scene, 0.02, displacements="finite", distance=0.02)
    assert "had fallen" not in alone.message


def test_a_wall_that_locks_is_not_pushed_through_the_ground() -> None:
    outcome = dem_dynamic(block(load__live={"kind": "body", "acceleration": [0, -9.81]}), displacements="finite")
    assert outcome.status == "unbounded", outcome.message
    assert "more than 20 times its largest dead load" in outcome.message
    assert abs(outcome.curve[:, 0]).max() < 1e-3


def test_what_nothing_resists_falls_under_no_load() -> None:
    outcome = dem_dynamic(slender({"kind": "lateral"}).with_joint(friction=0.0), displacements="finite")
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-4)


def test_what_is_crushed_under_its_dead_load_is_pushed_at_a_point_as_well() -> None:
    """The dead load comes slowly there. The toe bears with all its strength: λ F h = W (b − W / f t) / 2."""
    at, crushing = {"kind": "point", "at": [0.0, HEIGHT], "force": [1.0, 0.0]}, 6000.0
    scene = block(WIDTH, HEIGHT, joint__friction=1.4, joint__compressive_strength=crushing, load__live=at)
    weight = 9.81 * scene.mass[0]
    outcome = dem_dynamic(scene, displacements="finite", distance=0.01)
    exact = weight * (WIDTH - weight / (crushing * 0.12)) / 2 / HEIGHT
    assert outcome.multiplier == pytest.approx(exact, rel=0.05)  # on its points joints crush to 3 to 5 %


@pytest.mark.parametrize(
    ("verdict", "gone", "moved", "expected"),
    [
        ("collapse", 0.6, 0.6, 0.75),
        ("collapse", 0.01, 0.01, 0.5),  # thrown off by a push that was far too fast
        ("collapse", 0.9, 0.01, 1.0),
        ("stable", 1.0, 1.0, 1.0),
        ("undecided", 0.8, 0.5, 0.8 * 1.25 / 0.5),
        ("undecided", 0.8, 0.0, 3.2),
    ],
)
def test_a_push_takes_its_time_for_as_far_as_blocks_are_to_go(
    verdict: Any, gone: float, moved: float, expected: float
) -> None:
    """Not for the way of its control point, which may go anywhere."""
    nothing: Any = None
    lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
    rows = [TraverseRow(moved, 0.0, np.zeros((0, 2)), np.zeros(0), (0.0, 0.0), ())]
    after = lead.after(Traverse(nothing, np.zeros(0), True, rows, verdict, gone=gone))
    assert after.longest == pytest.approx(expected)


@pytest.mark.parametrize(
    ("ends", "said"),
    [
        ((0.2, 0.3), "falls to nothing at 0.275 m"),
        ((-1e-7, -3e-7), "falls to nothing while the control point stays where it is"),
    ],
)
def test_where_the_multiplier_falls_to_nothing_is_told_if_the_control_point_goes_there(
    ends: tuple[float, float], said: str
) -> None:
    """Another stone may fall: what a control point moves by meanwhile is its springs' alone."""
    nothing: Any = None
    lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
    assert said in lead.fall(np.column_stack([ends, (0.3, -0.1)]))


def test_a_load_low_on_a_wall_that_hardly_goes_itself_pushes_to_the_brink() -> None:
    """A point near the ground goes a twelfth as far as the top does: λ comes to nothing where the block balances."""
    at = np.array([0.0, 0.05 * HEIGHT])
    scene = slender({"kind": "point", "at": at.tolist(), "force": [1, 0]}).with_joint(friction=8.0)
    outcome = dem_dynamic(scene, displacements="finite")
    brink = (about_its_toe(at, math.atan(WIDTH / HEIGHT)) - (at - TOE))[0]
    assert outcome.curve[-1, 1] <= 0
    assert outcome.curve[-1, 0] == pytest.approx(brink, rel=0.01)


def test_a_slow_push_that_goes_farther_than_a_fast_one_goes_on_to_its_end() -> None:
    """Parts of this wall fall one after the other, the later the slower it is pushed."""
    size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2}
    rows: list[list[float]] = [
        [1, 1, -1, 1, 1],
        [0.5, 1, 0.5, -1, 0.5, 1, 0.5],
        [1, 1, -1, 1, 1],
        [0.5, 1, 2, 1, 0.5],
        [1, 1, 1, 1, 1],
    ]
    joint = {"friction": 0.65, "inset": 0.01, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    outcome = dem_dynamic(Wall.courses(rows, **size, joint=joint, density=2000.0).scene, displacements="finite")
    assert outcome.curve[-1, 1] <= 0, outcome.message
    assert "falls to nothing" in outcome.message


def test_a_point_that_other_loads_push_back_tells_as_much() -> None:
    """As the block is pushed by its weight alone, whose λ the load at the point takes a hundredth of."""
    weight = 9.81 * slender({"kind": "lateral"}).mass[0]
    back = {"kind": "point", "at": [0.0, HEIGHT], "force": [-0.005 * weight, 0.0]}
    alone = dem_dynamic(slender({"kind": "lateral"}), displacements="finite")
    outcome = dem_dynamic(slender([back, {"kind": "lateral"}]), displacements="finite")
    assert alone.multiplier is not None
    assert outcome.multiplier == pytest.approx(alone.multiplier / 0.99, rel=2e-3)
    assert outcome.curve[-1, 0] < 0
    assert outcome.motion == pytest.approx(alone.motion, abs=0.02)
    apart = float(outcome.message.split("curves are ")[1].split()[0])
    assert apart < 1
    short = dem_dynamic(slender([back, {"kind": "lateral"}]), displacements="finite", distance=0.01)
    assert short.curve[-1, 0] == pytest.approx(-0.01, rel=0.02)


BESIDE: dict[str, Any] = {"kind": "point", "at": [6 * WIDTH, HEIGHT], "force": [0.01, 0]}
AT_CORNER: dict[str, Any] = {"kind": "point", "at": [0.0, HEIGHT], "force": [1, 0]}


def beside_a_stout_one(live: Any, **changes: Any) -> Scene:
    """The slender block, and one three times as wide apart from it, which stays."""
    rows: list[list[float]] = [[1, -2, 3]]
    return courses(rows, WIDTH, HEIGHT, joint__friction=1.4, joint__mortar=MORTAR, load__live=live, **changes)


@pytest.mark.parametrize("live", [[BESIDE, AT_CORNER], {"kind": "lateral"}], ids=["first load", "lateral"])
def test_displacements_are_read_where_a_wall_moves(live: Any) -> None:
    """What stays beside it has no curve: the corner of the block that topples has, tan(α − θ) and as a force there."""
    outcome, corner = dem_dynamic(beside_a_stout_one(live), 0.005, displacements="finite"), np.array([0.0, HEIGHT])
    weight, middle = 9.81 * slender({"kind": "lateral"}).mass[0], np.array([WIDTH / 2, HEIGHT / 2])
    turned = angles(outcome.curve, corner, np.array([1.0, 0.0]))
    arms = [(about_its_toe(middle, angle), about_its_toe(corner, angle)) for angle in turned]
    at_corner = np.array([-weight * toe[0] / there[1] for toe, there in arms])
    follows(outcome, at_corner if isinstance(live, list) else np.tan(math.atan(WIDTH / HEIGHT) - turned))
    assert "displacements are read at (0, 0.24), for the control point of the first live load stays" in outcome.message
    assert f"falls to nothing at {WIDTH:.4g} m" in outcome.message


def test_displacements_are_read_at_the_control_point_again_once_it_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a push that was far too fast has thrown blocks about, and left it where it was."""
    after, heel = Push.after, (np.zeros(1, dtype=np.int64), np.zeros(2), np.array([0.0, 1.0]))

    def astray(lead: Push, traverse: Traverse) -> Push:
        return replace(cast(Push, after(lead, traverse)), elsewhere=heel)

    monkeypatch.setattr(Push, "after", astray)
    led = dem_dynamic(slender({"kind": "lateral"}), displacements="finite")
    monkeypatch.undo()
    alone = dem_dynamic(slender({"kind": "lateral"}), displacements="finite")
    assert np.array_equal(led.curve, alone.curve)


def test_a_distance_is_that_of_where_a_wall_moves() -> None:
    outcome = dem_dynamic(beside_a_stout_one({"kind": "lateral"}), displacements="finite", distance=0.01)
    assert outcome.curve[-1, 0] == pytest.approx(0.01, rel=0.02)


@pytest.mark.parametrize("model", [dem_dynamic, fem])
@pytest.mark.parametrize(
    ("distance", "settings", "message"),
    [
        (0.0, {"displacements": "finite"}, "distance = 0.0: must be a number above 0"),
        (math.nan, {"displacements": "finite"}, "distance = nan: must be a number above 0"),
        (0.1, {}, "distance = 0.1: goes with finite displacements of a wall that its live load pushes"),
    ],
)
def test_distances_that_mean_nothing_are_refused(
    model: Any, distance: float, settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(SceneError, match=message):
        model(slender({"kind": "lateral"}), distance=distance, **settings)


def test_a_support_goes_as_far_as_its_scene_says() -> None:
    live = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -1e-3]}
    with pytest.raises(SceneError, match="distance = 0.1: goes with"):
        dem_dynamic(block(load__live=live), displacements="finite", distance=0.1)
