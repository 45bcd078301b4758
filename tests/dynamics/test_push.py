"""Walls pushed far by live loads: blocks rotating about their toes, walls from their limit load on, how pushes end."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.figure import Figure

from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from runningbond import Wall
from runningbond.dynamics import Run, State, Unstable, led
from runningbond.dynamics.contact_update import ContactUpdate
from runningbond.dynamics.lead import STRIDE
from runningbond.dynamics.led import _narrowed
from runningbond.dynamics.push import Push
from runningbond.dynamics.traverse import Traverse, TraverseRow
from runningbond.joints import wall_points
from runningbond.limit import limit, limit_nonassociated
from runningbond.limit.kinematics import jump_operator
from runningbond.pictures.curve import draw_curve
from runningbond.pictures.recording import MotionRecorder
from runningbond.results import Outcome
from runningbond.scene import Array, Scene, SceneError, scene_from_dict
from tests.at_length import at_length
from tests.dynamics.test_led import block, brackets
from tests.fem_interface.walls import MORTAR
from tests.walls import courses, panel

WIDTH, HEIGHT = 0.06, 0.24
TOE = np.array([WIDTH, 0.0])


def about_its_toe(at: Array, angle: float) -> Array:
    """Position of a point of a block relative to the toe about which the block has turned clockwise."""
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(np.array([[c, s], [-s, c]]) @ (at - TOE))


def slender(live: dict[str, Any] | list[dict[str, Any]]) -> Scene:
    return block(WIDTH, HEIGHT, joint__friction=1.4, load__live=live)


def angles(curve: Array, at: Array, direction: Array) -> Array:
    """Rotations at which points of the block ``(n, 2)`` have the mean displacements of a curve in directions."""
    every = np.linspace(0.0, math.atan(WIDTH / HEIGHT) + 0.05, 2000)
    ways = list(zip(at, direction, strict=True))
    gone = [np.mean([(about_its_toe(here, angle) - (here - TOE)) @ way for here, way in ways]) for angle in every]
    return np.interp(curve[:, 0], gone, every)


def follows(outcome: Outcome, exact: Array) -> None:
    """Agrees at every row: to the tolerance while the push accelerates, then to 5e-4 until the load vanishes."""
    moved, load = outcome.curve.T
    brackets(outcome, exact[0], 5e-3)
    given = moved > 1e-5  # before that the joint deforms elastically
    assert load[given] == pytest.approx(exact[given], abs=5e-3 * exact[0])
    steady = moved > 0.6 * moved[-1]
    assert steady.sum() > 30
    assert load[steady] == pytest.approx(exact[steady], abs=5e-4 * exact[0])


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_lateral_push_of_block_follows_tan_until_balance_on_corner(model: Any) -> None:
    """λ = tan(α − θ), tan α = b / h; zero once the corner above the toe has moved by h sin α."""
    outcome = model(slender({"kind": "lateral"}), 0.005, displacements="finite")
    corner, alpha = np.array([WIDTH, HEIGHT]), math.atan(WIDTH / HEIGHT)
    follows(outcome, np.tan(alpha - angles(outcome.curve, corner[None], np.array([[1.0, 0.0]]))))
    assert f"falls to nothing at {HEIGHT * math.sin(alpha):.4g} m" in outcome.message
    assert outcome.curve[-1, 1] <= 0


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_point_force_follows_its_material_point(model: Any) -> None:
    """Pushed at the corner farther from the toe, which rises: λ F (its height) = W (arm of the centroid)."""
    at, middle, direction = np.array([0.0, HEIGHT]), np.array([WIDTH / 2, HEIGHT / 2]), np.array([1.0, 0.0])
    scene = slender({"kind": "point", "at": at.tolist(), "force": direction.tolist()})
    outcome, weight = model(scene, 0.005, displacements="finite"), 9.81 * scene.mass[0]
    turned = angles(outcome.curve, at[None], direction[None])
    exact = [-weight * about_its_toe(middle, angle)[0] / about_its_toe(at, angle)[1] for angle in turned]
    follows(outcome, np.array(exact))


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_couple_does_not_depend_on_block_rotation(model: Any) -> None:
    middle = np.array([WIDTH / 2, HEIGHT / 2])
    scene = slender({"kind": "moment", "at": middle.tolist(), "moment": -1.0})
    outcome, weight = model(scene, 0.005, displacements="finite"), 9.81 * scene.mass[0]
    _, at, direction = scene.control_point
    exact = [-weight * about_its_toe(middle, angle)[0] for angle in angles(outcome.curve, at, direction)]
    follows(outcome, np.array(exact))


def test_wall_peaks_at_limit_load_and_then_softens() -> None:
    """The smallest certified load of non-associated limit analysis; the associated one is a quarter larger."""
    scene = panel(wall__length=0.36, wall__height=0.36, joint__friction=1.2, joint__mortar=MORTAR)
    outcome = dem_dynamic(scene, displacements="finite", distance=0.02)
    exact = limit_nonassociated(scene).multiplier
    assert exact is not None
    brackets(outcome, exact, 0.01)
    peak = int(outcome.curve[:, 1].argmax())
    assert np.diff(outcome.curve[peak:, 1]).max() < 1e-3 * exact
    assert outcome.curve[-1, 1] < 0.95 * exact
    # The mechanism is that of the wall as built, without overlap; the fall of the curve shows on a linear axis.
    jumps = jump_operator(wall_points(scene), scene.blocks.centroid).opening @ outcome.motion.ravel()
    assert jumps.min() > -0.01
    axes = Figure().add_subplot()
    draw_curve(axes, scene, outcome)
    assert axes.get_xscale() == "linear"


def test_ground_reactions_balance_push_and_weight() -> None:
    scene = panel(wall__length=0.36, wall__height=0.36, joint__mortar=MORTAR)
    outcome = dem_dynamic(scene, 0.1, displacements="finite", distance=0.01)
    weight = 9.81 * scene.mass[~scene.fixed].sum()
    columns = [*outcome.path_columns]
    along, up = (outcome.path[20:, columns.index(f"ground {axis} [N]")] for axis in ("horizontal", "vertical"))
    assert -along == pytest.approx(outcome.curve[20:, 1] * weight, abs=0.1 * weight)  # instant against row mean
    assert -along.mean() == pytest.approx(outcome.curve[20:, 1].mean() * weight, rel=0.01)
    assert up.mean() == pytest.approx(weight, rel=0.01)
    rests = outcome.curve_columns()["at rest"]
    assert rests[0] == 1
    assert not rests[1:].any()


CHATTERS: dict[str, Any] = {
    "wall": {
        "outlines": [
            [[-0.391, 0.805], [-0.483, 0.994], [-0.869, 0.683], [-0.703, 0.553]],
            [[0.0, 0.895], [0.0, 1.105], [-0.483, 0.994], [-0.391, 0.805]],
            [[0.391, 0.805], [0.483, 0.994], [0.0, 1.105], [0.0, 0.895]],
            [[0.703, 0.553], [0.869, 0.683], [0.483, 0.994], [0.391, 0.805]],
        ],
        "ground": [
            [[-1.669, -0.047], [-0.703, -0.047], [-0.703, 0.553], [-0.869, 0.683], [-1.669, 0.683]],
            [[1.669, 0.683], [0.869, 0.683], [0.703, 0.553], [0.703, -0.047], [1.669, -0.047]],
        ],
        "thickness": 0.3,
    },
    "block": {"density": 2000.0},
    "joint": {"friction": 0.34, "normal_stiffness": 1e11, "shear_stiffness": 7e10, "inset": 0.005},
    "load": {
        "gravity": 9.81,
        "live": {"kind": "lateral"},
        "dead": {"kind": "point", "at": [-0.2415, 1.0495], "force": [0, -1177.2]},
    },
}


def test_what_damping_takes_is_no_strength() -> None:
    """Two parts of an arch slide on inclined joints, and chatter. Equilibrium at the limit of friction has λ = .8134.

    That does not change while they slide, and the mean of fluctuating forces obeys it too; damping takes the rest.
    """
    scene = panel(**CHATTERS)
    outcome, bound = dem_dynamic(scene, 0.02, displacements="finite", distance=0.004), limit(scene).multiplier or 0.0
    assert bound == pytest.approx(0.8134, rel=1e-3)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower < bound < outcome.upper
    assert "blocks vibrate: damping takes" in outcome.message


def test_push_does_not_depend_on_load_unit(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many steps and contact updates, and λ scales with 1 / unit, bit for bit.

    This holds for a unit that is a power of two, which leaves all digits unchanged.
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


def test_push_ends_at_requested_distance() -> None:
    """To within one row, which is 1/200 of the distance."""
    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=0.004)
    assert outcome.curve[-1, 0] == pytest.approx(0.004, rel=0.01)


def test_interrupt_keeps_last_complete_push() -> None:
    """Interrupted in the second push, just after its start."""
    pushes: list[float] = []

    def stop(run: Run, state: State, multiplier: float) -> None:
        pushes.extend([multiplier] if run.is_driven and multiplier == 0 else [])
        if len(pushes) == 2:
            raise KeyboardInterrupt

    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=0.004, observe=stop)
    assert (outcome.status, outcome.multiplier) == ("undecided", None)
    assert "interrupted" in outcome.message
    assert outcome.curve[-1, 0] == pytest.approx(0.004, rel=0.05)


def test_push_that_becomes_unstable_keeps_its_path() -> None:
    """Far beyond the peak, which is at the start, and a third of the way to where the load vanishes."""
    brink = HEIGHT * math.sin(math.atan(WIDTH / HEIGHT))

    def blow_up(run: Run, state: State, multiplier: float) -> None:
        if run.is_driven and abs(state.motion[0]) > brink / 3:
            raise Unstable(state.steps, run.dt, run.dt)

    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", observe=blow_up)
    assert outcome.status == "failed"
    assert outcome.multiplier is None
    assert "unstable" in outcome.message
    assert "m: take a shorter distance" in outcome.message
    assert outcome.curve[:, 1].max() == pytest.approx(WIDTH / HEIGHT, rel=0.03)  # with the inertia of a fast push


def test_push_ends_if_wall_falls_while_push_accelerates() -> None:
    """The block topples within a twentieth of the distance; the message still reports where its load vanishes."""
    outcome = dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=20 * WIDTH)
    brink = HEIGHT * math.sin(math.atan(WIDTH / HEIGHT))
    assert outcome.curve[-1, 0] == pytest.approx(brink, rel=0.02)
    assert f"falls to nothing at {brink:.4g} m" in outcome.message
    assert (outcome.curve[:-1, 1] >= 0).all()


@pytest.mark.long
def test_unreachable_distance_does_not_change_push() -> None:
    """The push must not start so fast that it misses the peak: for 100 m the bracket did not contain tan α."""
    near, far = (dem_dynamic(slender({"kind": "lateral"}), displacements="finite", distance=d) for d in (None, 100.0))
    assert np.array_equal(near.curve, far.curve)
    brackets(far, WIDTH / HEIGHT, 0.01)


def pushed_along(curve: Array) -> Traverse:
    rows = [TraverseRow(moved, force, np.empty(0), np.empty(0), (0.0, 0.0), ()) for moved, force in curve.tolist()]
    return Traverse(cast(State, None), np.empty(0), moves=True, rows=rows)


@pytest.mark.parametrize(
    ("peak", "late", "said", "nearer"),
    [
        (8.9e-5, 0.3, "the peak is at 8.9e-05 m: a shorter distance", 5 * 8.9e-5),
        (0.01, 0.3, "", None),
        (0.01, 0.5, "up to 0.15 m it is 0.4000 at both: a shorter distance", 0.15),
    ],
)
def test_message_asks_for_shorter_distance_if_peak_is_at_start_or_speeds_part(
    peak: float, late: float, said: str, nearer: float | None
) -> None:
    nothing: Any = None
    lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
    curve = np.array([[0.0, 0.0], [peak, 0.4], [0.1, 0.3], [0.15, 0.3], [0.2, 0.3]])
    for side in (1.0, -1.0):
        fast, slow = (pushed_along(np.vstack([curve[:-1], [0.2, end]]) * (side, 1.0)) for end in (0.3, late))
        assert lead.remedy(fast, slow, 0.01).startswith(said)
        assert bool(lead.remedy(fast, slow, 0.01)) == bool(said)
        assert lead.nearer(fast, slow, 0.01) == pytest.approx(nearer)


def test_shorter_path_ends_where_a_control_point_that_goes_back_has_been() -> None:
    """Both speeds agree until it is behind its place at rest; a push over that distance, −0.03 m, ended at once."""
    nothing: Any = None
    lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
    there_and_back = [[0.0, 0.0], [0.02, 0.4], [0.05, 0.4], [0.02, 0.3], [-0.03, 0.2]]
    for side in (1, -1):
        fast, slow = (
            pushed_along(np.array([*there_and_back, [0.3, late], [1.0, late]]) * (side, 1.0)) for late in (0.8, 0.5)
        )
        assert lead.nearer(fast, slow, 0.01) == pytest.approx(0.05)
        assert lead.remedy(fast, slow, 0.01).startswith("up to 0.05 m it is 0.4000 at both")


def torn_block() -> Scene:
    """A glued block that tears off within a thousandth of the way on which it topples."""
    size = {"length": 1.0, "height": 2.0, "block_width": 1.0, "block_height": 2.0, "thickness": 0.12}
    energies = {"joint__fracture_energy_1": 2.0, "joint__fracture_energy_2": 2.0}
    strength = {"joint__cohesion": 5e4, "joint__tensile_strength": 3e4, **energies}
    return panel(wall=size, joint__normal_stiffness=1e10, joint__shear_stiffness=1e10, **strength)


def test_push_without_a_distance_finds_its_early_peak_on_a_shorter_path() -> None:
    """Each speed shows another peak."""
    scene = torn_block()
    free, near = (dem_dynamic(scene, displacements="finite", budget=200_000, distance=d) for d in (None, 0.0012))
    assert free.status == near.status == "collapse"
    assert free.multiplier == pytest.approx(near.multiplier, rel=0.005)
    assert "; pushed to 0.0012 m: over the whole distance it is between" in free.message
    assert (free.steps or 0) > 2 * (near.steps or 0)
    far = dem_dynamic(scene, displacements="finite", budget=200_000, distance=1.0)
    assert (far.status, far.multiplier) == ("undecided", None)
    assert "a shorter distance shows it" in far.message


@pytest.mark.parametrize(
    ("lower", "upper", "message", "status", "said"),
    [
        (0.64, 0.66, "", "collapse", "pushed to 0.18 m: over the whole distance it is between 0.6200 and 0.6800"),
        # The wall is borne anew farther on, and bears more.
        (0.1, 0.2, "", "undecided", "no answer; pushed to 0.18 m it is between 0.1000 and 0.2000"),
        (0.8, 0.9, "", "undecided", "no answer; pushed to 0.18 m it is between 0.8000 and 0.9000"),
        (0.64, 0.66, "interrupted: the path so far", "undecided", "no answer; interrupted on a shorter path"),
    ],
)
def test_shorter_push_counts_if_it_agrees_with_the_whole_path(
    lower: float, upper: float, message: str, status: str, said: str
) -> None:
    whole = Outcome("wall", "dem-dynamic", "undecided", lower=0.62, upper=0.68, steps=7, message="no answer")
    answer = (lower + upper) / 2
    near = Outcome("wall", "dem-dynamic", "collapse", answer, lower=lower, upper=upper, steps=5, message=message)
    narrowed = _narrowed(whole, near, 0.18)
    assert (narrowed.status, narrowed.steps) == (status, 12)
    assert narrowed.multiplier == (answer if status == "collapse" else None)
    assert narrowed.message == said
    failed = replace(near, status="failed", multiplier=None)
    if not message:
        assert _narrowed(whole, failed, 0.18).message == "no answer; pushed to 0.18 m there is no answer either"


@pytest.mark.parametrize("is_stopped", [True, False])
def test_recorded_states_are_those_of_the_curve_if_a_shorter_push_does_not_count(
    is_stopped: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A series for ParaView ended after half a millimetre, beside a curve of almost a metre."""
    recorder, whole, seen = MotionRecorder(scene := torn_block(), None), list[float](), list[float]()

    def nearer(self: Push, fast: Traverse, slow: Traverse, tolerance: float) -> float:
        whole.extend(slow.curve[:, 1])
        return 0.001

    def observe(run: Run, state: State, multiplier: float) -> None:
        recorder(run, state, multiplier)
        seen.extend([multiplier] if run.is_driven and whole else [])
        if is_stopped and len(seen) == 5:
            raise KeyboardInterrupt

    monkeypatch.setattr(Push, "nearer", nearer)
    monkeypatch.setattr(led, "_bounds", lambda outcome: (np.nan, np.nan))  # brackets that do not overlap
    outcome = dem_dynamic(scene, displacements="finite", budget=200_000, observe=observe)
    recorder.finish(outcome)
    assert outcome.status == "undecided"
    assert ("interrupted" in outcome.message) == is_stopped
    assert outcome.curve[:, 1].tolist() == whole
    told = [frame.multiplier for frame in recorder.frames]  # the curve has medians of three rows
    assert told == pytest.approx([0.0, *whole[STRIDE - 1 :: STRIDE]], abs=0.005)


@pytest.mark.parametrize(
    ("low", "said"), [(0.1, "the multiplier had fallen from 0.4000 at 0.02 m to 0.1000"), (0.39, "")]
)
def test_note_on_a_first_peak_needs_a_fall_before_the_largest_multiplier(low: float, said: str) -> None:
    nothing: Any = None
    system: Any = SimpleNamespace(live=0.0, measure=lambda load: 1.0)
    lead = Push(nothing, cast(Run, SimpleNamespace(system=system)), nothing, nothing, nothing, nothing)
    for side in (1, -1):
        curve = np.array([[0.0, 0.0], [0.02, 0.4], [0.05, low], [0.1, 0.8], [0.2, 0.5]]) * (side, 1.0)
        assert lead.before(curve).startswith(said)
        assert bool(lead.before(curve)) == bool(said)


@pytest.mark.long
def test_message_reports_peak_before_wall_lands_on_ground() -> None:
    """A slab on a pier tips at W a / c, and carries far more once its corner rests on the ground."""
    at_end = {"kind": "point", "at": [0.6, 0.2], "force": [0.0, -1.0]}
    soft = MORTAR | {"young": 1e8}
    scene = courses([[1], [1.5]], 0.4, 0.1, joint__mortar=soft, load__live=at_end)
    outcome = dem_dynamic(scene, 0.2, displacements="finite")
    assert outcome.curve[:, 1].max() > 400
    peak = float(outcome.message.split("had fallen from ")[1].split()[0])
    assert peak == pytest.approx(9.81 * scene.mass[1] * 0.1 / 0.2, rel=5e-3)
    alone = dem_dynamic(scene, 0.02, displacements="finite", distance=0.02)
    assert "had fallen" not in alone.message


def test_locked_wall_is_unbounded() -> None:
    outcome = dem_dynamic(block(load__live={"kind": "body", "acceleration": [0, -9.81]}), displacements="finite")
    assert outcome.status == "unbounded", outcome.message
    assert "more than 20 times its largest dead load" in outcome.message
    assert abs(outcome.curve[:, 0]).max() < 1e-3


def test_frictionless_block_collapses_at_zero_load() -> None:
    scene = slender({"kind": "lateral"}).with_joint(friction=0.0)
    outcome = dem_dynamic(scene, displacements="finite", distance=0.005)
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(("times", "is_told"), [(100.0, True), (400.0, False)])
def test_toe_near_its_strength_is_told(times: float, is_told: bool) -> None:
    """All weight on an end point, which stands for a 72nd of the joint: λ = b / h. A continuous toe is W / f t wide.

    The strength is a multiple of the mean pressure. The load is too large by its inverse, at most 1 / 72.
    """
    strength = times * 9.81 * float(block(WIDTH, HEIGHT).mass[0]) / WIDTH / 0.12
    joint = {"joint__friction": 1.4, "joint__compressive_strength": strength, "joint__cap_shear": 0.0}
    scene = block(WIDTH, HEIGHT, **joint, load__live={"kind": "lateral"})
    outcome = dem_dynamic(scene, 0.002)
    assert outcome.multiplier == pytest.approx(WIDTH / HEIGHT, rel=0.003)
    assert limit(scene).multiplier == pytest.approx((1 - 1 / times) * WIDTH / HEIGHT, rel=1e-4)
    assert ("joints near their compressive strength carry bending at points" in outcome.message) == is_told


def test_block_with_crushing_toe_pushed_at_point() -> None:
    """The dead load is applied slowly. The toe is at its full strength f: λ F h = W (b − W / f t) / 2."""
    at, crushing = {"kind": "point", "at": [0.0, HEIGHT], "force": [1.0, 0.0]}, 6000.0
    scene = block(WIDTH, HEIGHT, joint__friction=1.4, joint__compressive_strength=crushing, load__live=at)
    weight = 9.81 * scene.mass[0]
    outcome = dem_dynamic(scene, displacements="finite", distance=0.01)
    exact = weight * (WIDTH - weight / (crushing * 0.12)) / 2 / HEIGHT
    assert outcome.multiplier == pytest.approx(exact, rel=0.03)  # the joint points resolve crushing to 3 %
    assert "crushed joints carry bending at points" in outcome.message
    strong = scene.with_joint(compressive_strength=1e9)
    assert "crushed" not in dem_dynamic(strong, 0.1, displacements="finite", distance=0.001).message


@pytest.mark.parametrize("stiffness", [1e10, *at_length(1e12)])
def test_block_that_turns_on_a_crushing_toe_follows_its_exact_curve(stiffness: float) -> None:
    """A length c = W / (f t) of the toe is crushed, about whose inner end the block turns; W acts in its middle.

    Stiff points of the toe stick and slide in turns, and the message tells what damping takes of the load.
    """
    width, height, thickness, crushing = 0.5, 1.5, 0.3, 3e5
    springs = {"joint__normal_stiffness": stiffness, "joint__shear_stiffness": 0.4 * stiffness}
    toe = {"joint__compressive_strength": crushing, "joint__cap_shear": 0, "joint__friction": 1.2}
    scene = courses([[1]], width, height, wall__thickness=thickness, block__density=2000.0, **springs, **toe)
    outcome = dem_dynamic(scene, displacements="finite")
    c = scene.mass[0] * 9.81 / (crushing * thickness)
    angle = np.linspace(0.0, 0.4, 1000)
    cosine, sine, arm = np.cos(angle), np.sin(angle), width / 2 - c
    exact = (arm * cosine - height / 2 * sine + c / 2) / (arm * sine + height / 2 * cosine)
    moved, load = outcome.curve[outcome.curve[:, 1].argmax() :].T
    error = load / exact[0] - np.interp(moved, c * cosine + height * sine - c, exact / exact[0])
    damped = re.search(r"vibrate as the multiplier falls: damping takes up to (\S+) %", outcome.message)
    assert (damped is None) == (stiffness < 1e11)
    told = 0.0 if damped is None else float(damped[1]) / 100
    assert -0.005 < error.min() < error.max() < 0.015 + told


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
def test_duration_of_next_push_follows_path_of_blocks(verdict: Any, gone: float, moved: float, expected: float) -> None:
    """The duration does not follow the path of the control point, which need not move with the blocks."""
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
def test_message_on_vanishing_load_depends_on_control_point_motion(ends: tuple[float, float], said: str) -> None:
    """If another block falls, the control point moves only by the elastic deformation of its joints."""
    nothing: Any = None
    lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
    rows = [
        TraverseRow(moved, force, np.zeros((0, 2)), np.zeros(0), (0.0, 0.0), ())
        for moved, force in zip(ends, (0.3, -0.1), strict=True)
    ]
    assert said in lead.fall(Traverse(nothing, np.zeros(0), True, rows))


@pytest.mark.parametrize(
    ("late", "said"),
    [
        ([0.02, 0.015, 0.01, 0.005], "the multiplier falls to nothing at 0.3 m"),
        ([0.29, 0.33, 0.2, 0.1], "the multiplier falls from 0.3000 to nothing at 0.3 m, where the wall snaps"),
    ],
)
def test_wall_that_loses_much_of_its_load_at_one_place_snaps(late: list[float], said: str) -> None:
    """The control point stops while other blocks move on: an arch that is pushed down until three hinges fold."""
    early = [(0.0, 1.0), (0.1, 0.6), (0.29, late[0] + 0.01)]
    curve = np.array(
        [*early, *((0.3 - 1e-6 * k, load) for k, load in zip((4, 3, 2, 1), late, strict=True)), (0.3, -0.1)]
    )
    nothing: Any = None
    for side in (1.0, -1.0):
        lead = Push(nothing, nothing, nothing, nothing, nothing, nothing, distance=1.0)
        assert lead.fall(pushed_along(curve * (side, 1.0))) == said.replace("at 0.3 m", f"at {side * 0.3:g} m")


def test_low_load_pushes_block_to_balance() -> None:
    """A point near the ground moves a twelfth as far as the top; λ vanishes where the block balances on its toe."""
    at = np.array([0.0, 0.05 * HEIGHT])
    scene = slender({"kind": "point", "at": at.tolist(), "force": [1, 0]}).with_joint(friction=8.0)
    outcome = dem_dynamic(scene, 0.05, displacements="finite")
    brink = (about_its_toe(at, math.atan(WIDTH / HEIGHT)) - (at - TOE))[0]
    assert outcome.curve[-1, 1] <= 0
    assert outcome.curve[-1, 0] == pytest.approx(brink, rel=0.01)


@pytest.mark.long
def test_slower_push_that_goes_farther_continues_to_its_end() -> None:
    """Parts of this wall fall one after the other, and the later the slower it is pushed."""
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


def test_control_point_moving_backwards_gives_same_limit_load() -> None:
    """As for the block under its lateral load alone, of whose λ the backward point load takes a hundredth."""
    weight = 9.81 * slender({"kind": "lateral"}).mass[0]
    back = {"kind": "point", "at": [0.0, HEIGHT], "force": [-0.005 * weight, 0.0]}
    alone = dem_dynamic(slender({"kind": "lateral"}), displacements="finite")
    outcome = dem_dynamic(slender([back, {"kind": "lateral"}]), displacements="finite")
    assert alone.multiplier is not None
    assert outcome.multiplier == pytest.approx(alone.multiplier / 0.99, rel=2e-3)
    assert outcome.curve[-1, 0] < 0
    assert outcome.motion == pytest.approx(alone.motion, abs=0.02)
    apart = float(outcome.message.split("curves differ by ")[1].split()[0])
    assert apart < 1
    short = dem_dynamic(slender([back, {"kind": "lateral"}]), displacements="finite", distance=0.01)
    assert short.curve[-1, 0] == pytest.approx(-0.01, rel=0.02)


ON_STOUT_BLOCK: dict[str, Any] = {"kind": "point", "at": [6 * WIDTH, HEIGHT], "force": [0.01, 0]}
AT_CORNER: dict[str, Any] = {"kind": "point", "at": [0.0, HEIGHT], "force": [1, 0]}


def slender_and_stout(live: Any, **changes: Any) -> Scene:
    """The slender block, and at a distance one three times as wide, which does not move."""
    rows: list[list[float]] = [[1, -2, 3]]
    return courses(rows, WIDTH, HEIGHT, joint__friction=1.4, joint__mortar=MORTAR, load__live=live, **changes)


@pytest.mark.parametrize("live", [[ON_STOUT_BLOCK, AT_CORNER], {"kind": "lateral"}], ids=["first load", "lateral"])
def test_displacements_are_read_at_moving_block(live: Any) -> None:
    """A block at rest has no curve: it is read at the corner of the toppling one, tan(α − θ) or as a force there."""
    outcome, corner = dem_dynamic(slender_and_stout(live), 0.005, displacements="finite"), np.array([0.0, HEIGHT])
    weight, middle = 9.81 * slender({"kind": "lateral"}).mass[0], np.array([WIDTH / 2, HEIGHT / 2])
    turned = angles(outcome.curve, corner[None], np.array([[1.0, 0.0]]))
    arms = [(about_its_toe(middle, angle), about_its_toe(corner, angle)) for angle in turned]
    at_corner = np.array([-weight * toe[0] / there[1] for toe, there in arms])
    follows(outcome, at_corner if isinstance(live, list) else np.tan(math.atan(WIDTH / HEIGHT) - turned))
    assert "displacements are read at (0, 0.24), for the control point of the first live load stays" in outcome.message
    assert f"falls to nothing at {WIDTH:.4g} m" in outcome.message


def test_displacements_return_to_control_point_once_it_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """A far too fast push has thrown blocks about but left the control point in place; the next push moves it."""
    after, heel = Push.after, (np.zeros(1, dtype=np.int64), np.zeros((1, 2)), np.array([[0.0, 1.0]]))

    def astray(lead: Push, traverse: Traverse) -> Push:
        return replace(cast(Push, after(lead, traverse)), elsewhere=heel)

    monkeypatch.setattr(Push, "after", astray)
    led = dem_dynamic(slender({"kind": "lateral"}), displacements="finite")
    monkeypatch.undo()
    alone = dem_dynamic(slender({"kind": "lateral"}), displacements="finite")
    assert np.array_equal(led.curve, alone.curve)


def test_distance_is_measured_at_moving_block() -> None:
    outcome = dem_dynamic(slender_and_stout({"kind": "lateral"}), displacements="finite", distance=0.01)
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
def test_invalid_distances_are_refused(model: Any, distance: float, settings: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        model(slender({"kind": "lateral"}), distance=distance, **settings)


def test_distance_is_refused_for_settlement() -> None:
    live = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -1e-3]}
    with pytest.raises(SceneError, match="distance = 0.1: goes with"):
        dem_dynamic(block(load__live=live), displacements="finite", distance=0.1)


def test_damping_of_a_wall_that_snaps_takes_no_more_than_the_load() -> None:
    """An arch on piers with a soft tie snaps through: the work of its fall is damped, which is no part of its load."""
    corners = [np.exp(1j * np.pi * k / 12) for k in range(13)]
    rings = [[1.3 + 2j + r * corner for corner in corners] for r in (1.0, 1.25)]
    voussoirs = [[rings[0][k], rings[1][k], rings[1][k + 1], rings[0][k + 1]] for k in range(12)]
    piers = [[[x, 0], [x + 0.6, 0], [x + 0.6, 2], [x, 2]] for x in (-0.3, 2.3)]
    outlines = piers + [[[z.real, z.imag] for z in each] for each in voussoirs]
    tie = {"from": [0.3, 1.9], "to": [2.3, 1.9], "area": 1e-4, "young": 1e9, "yield": 4000.0}
    tables = {
        "wall": {"outlines": outlines, "thickness": 0.5},
        "block": {"density": 2000.0},
        "joint": {"friction": 0.7, "normal_stiffness": 1e10, "shear_stiffness": 4e9},
        "support": {"kind": "base"},
        "load": {"gravity": 10.0, "live": {"kind": "point", "at": [1.3, 3.25], "force": [0.0, -1.0]}},
        "tie": [tie],
    }
    outcome = dem_dynamic(scene_from_dict(tables), 0.05, displacements="finite", distance=0.2378)
    assert outcome.status == "collapse"
    damped = re.search(r"damping takes up to (\S+) %", outcome.message)
    assert damped is not None
    assert float(damped[1]) <= 100.0


def test_damping_of_a_wall_that_is_lifted_takes_no_more_than_the_load() -> None:
    """A live load that lifts a pier as it leans: its multiplier is largest where the pier falls."""
    joint = {"friction": 0.8, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    lifted = {"kind": "point", "at": [0.25, 4.0], "force": [0.0, 2e4]}
    scene = courses([[1]] * 2, 0.5, 2.0, joint=joint, load={"gravity": 9.81, "live": [{"kind": "lateral"}, lifted]})
    outcome = dem_dynamic(scene, displacements="finite")
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower > -0.01 * outcome.upper
    assert "damping takes 100 % of the load" in outcome.message
