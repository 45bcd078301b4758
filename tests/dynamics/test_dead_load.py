"""Dead loads near the strength of joints that soften or crush."""

from typing import Any

import pytest

from dem.dynamic import dem_dynamic, quasi_static_run
from dem.static import dem_static
from fem_interface.model import fem
from runningbond.dynamics import Criteria, put_on_dead_load
from runningbond.joints import lobatto
from runningbond.limit import limit
from runningbond.models import respond
from runningbond.results import Outcome
from runningbond.scene import Scene, scene_from_dict
from tests.at_length import at_length
from tests.walls import courses

GRAVITY, DENSITY, HEIGHT = 9.81, 2000.0, 0.2
STRESS = DENSITY * GRAVITY * HEIGHT
MODELS = (dem_dynamic, fem)


def block(gravity: tuple[float, float], height: float = HEIGHT, tie: Any = (), **joint: float) -> Scene:
    """A block as wide as 0.2 m that its weight [m/s²] and its live load draw the same way."""
    size = {"block_width": 0.2, "block_height": height, "thickness": 0.1, "courses": [[1]]}
    live = {"kind": "body", "acceleration": list(gravity)}
    tables: dict[str, Any] = {
        "wall": size,
        "block": {"density": STRESS / GRAVITY / height, "young": 1e12},
        "joint": {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8, **joint},
        "support": {"kind": "base"},
        "load": {"gravity": list(gravity), "live": live},
        "tie": list(tie),
    }
    return scene_from_dict(tables)


def hanging(share: float) -> Scene:
    strength = STRESS / share
    energies = {"fracture_energy_1": 1e-4, "fracture_energy_2": 1e-4}
    return block((0.0, GRAVITY), cohesion=strength, tensile_strength=strength, **energies)


def pulled(share: float) -> Scene:
    """The weight and a long soft bar, which pulls with three times as much, take a share of the strength."""
    strength, weight = 4 * STRESS / share, STRESS * 0.2 * 0.1
    energies = {"fracture_energy_1": 1e-3, "fracture_energy_2": 1e-3}
    size = {"area": 1e-6, "young": 1e5, "yield": 10 * weight, "preload": 3 * weight}
    bar = {"from": [0.1, 0.1], "to": [0.1, 10.0], **size}
    return block((0.0, GRAVITY), tie=[bar], cohesion=strength, tensile_strength=strength, **energies)


def sheared(share: float) -> Scene:
    """Weight along the joint, as in a wall laid on its side: the edge tears before all of the joint slides."""
    strength = STRESS / share
    energies = {"fracture_energy_1": 1e-4, "fracture_energy_2": 1e-4}
    return block((GRAVITY, 0.0), 0.02, cohesion=strength, tensile_strength=strength, **energies)


def crushed(share: float) -> Scene:
    crushing = {"compressive_strength": STRESS / share, "compressive_fracture_energy": 0.05}
    return block((0.0, -GRAVITY), **crushing | {"normal_stiffness": 1e8, "shear_stiffness": 4e7})


def is_bracketed(outcome: Outcome, exact: float) -> bool:
    assert outcome.status == "collapse", outcome.message
    assert outcome.lower is not None
    assert outcome.upper is not None
    return outcome.lower <= exact * (1 + 1e-6) and exact * (1 - 1e-6) <= outcome.upper


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("wall", [hanging, crushed])
@pytest.mark.parametrize("share", [0.6, 0.8, 0.96, 0.97, 0.98, 0.985, 0.99])
def test_what_the_weight_leaves_of_a_strength_is_borne(model: Any, wall: Any, share: float) -> None:
    """A joint that bears its dead load at a share of its strength bears λ = 1 / share − 1 times as much more."""
    assert is_bracketed(model(wall(share)), 1 / share - 1)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("share", [0.6, 0.9, 0.97])
def test_what_a_preload_and_the_weight_leave_of_a_strength_is_borne(model: Any, share: float) -> None:
    """Put on at once, a bar's preload tears a joint off at half of what it bears."""
    assert is_bracketed(model(pulled(share)), 4 * (1 / share - 1))


@pytest.mark.parametrize("model", [dem_static, *MODELS])
def test_a_preload_draws_a_block_no_farther_than_friction_lets_it(model: Any) -> None:
    """A bar of thrice what friction bears draws a block until it pulls as much as that: put on at once it went slack.

    Models in motion tighten it in 200 turns, and know that pull to two of them.
    """
    size = {"width": 0.2, "height": 0.05, "wall__thickness": 0.1, "block__density": DENSITY, "block__young": 1e12}
    slides = 0.6 * 0.2 * 0.05 * 0.1 * DENSITY * GRAVITY
    bar = {"from": [0.15, 0.025], "to": [2.0, 0.025], "area": 1e-6, "young": 1e11, "yield": 1e3, "preload": 3 * slides}
    joint = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    load = {"gravity": GRAVITY, "live": {"kind": "lateral"}}
    outcome = model(courses([[1]], **size, joint=joint, load=load, tie=[bar]))
    assert is_bracketed(outcome, 0.6)
    path = outcome.curve_columns()
    assert path["tie 0 [N]"][0] == pytest.approx(slides, abs=2 / 200 * 3 * slides)
    assert path["ground horizontal [N]"][0] == pytest.approx(-path["tie 0 [N]"][0], rel=1e-3)


def test_what_preloads_give_is_work_that_the_ledger_is_measured_by() -> None:
    """A bar that pulls a block off its base against nearly all of the live load does nearly all the work there is."""
    strength, weight = 1e5, STRESS * 0.2 * 0.1
    size = {"area": 1e-6, "young": 1e5, "yield": 1e4, "preload": 15 * weight}
    bar = {"from": [0.1, 0.1], "to": [0.1, 10.0], **size}
    energies = {"fracture_energy_1": 1.0, "fracture_energy_2": 1.0}
    scene = block((0.0, GRAVITY), tie=[bar], cohesion=strength, tensile_strength=strength, **energies)
    assert is_bracketed(dem_dynamic(scene), strength / STRESS - 16)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("wall", [hanging, crushed])
def test_a_weight_beyond_the_strength_is_not_borne(model: Any, wall: Any) -> None:
    assert model(wall(1.02)).status == "infeasible"


@pytest.mark.parametrize("model", MODELS)
def test_how_the_dead_load_came_on_is_no_work_that_a_fall_misses(model: Any) -> None:
    """A thrust leaves a block a thousandth of b / h, where works nearly cancel; one slides without friction.

    Of what the weight did as it came on, a tenth is not accounted for: that was 3 % of all works, or 5 %.
    """
    load = {"gravity": GRAVITY, "live": {"kind": "lateral"}}
    stiff = {"normal_stiffness": 1e10, "shear_stiffness": 4e9, "friction": 0.6}
    thrust = {"kind": "point", "at": [0.0, 0.25], "force": [0.4 * 0.999 * 0.2 * 0.5 * 0.1 * GRAVITY * DENSITY, 0.0]}
    size = {"width": 0.2, "height": 0.5, "wall__thickness": 0.1, "block__density": DENSITY, "block__young": 1e10}
    pushed = model(courses([[1]], **size, joint=stiff, load=load | {"dead": [thrust]}))
    smooth = model(courses([[1]], **size, joint=stiff | {"friction": 0.0}, load=load))
    for outcome, exact in ((pushed, 0.4 * 0.001), (smooth, 0.0)):
        assert outcome.status == "collapse", outcome.message
        assert "unaccounted" not in outcome.message
        assert outcome.lower == pytest.approx(exact, abs=1e-5)  # forces that are not seen at rest
        assert exact < outcome.upper <= exact + 1.2e-4


CANTILEVERS: list[list[float]] = [[1, -2, 1], [1.5, 1, 1.5]]
SETTLES = {"kind": "settlement", "box": [[1.4, -1.0], [9.0, 0.01]], "by": [0.0, -0.01]}
PULLED_DOWN = {"kind": "point", "at": [0.25, 0.4], "force": [0.0, -1.0]}
LOADS: dict[str, dict[str, Any]] = {
    "lateral": {},
    "none that brings it down": {"load__live": PULLED_DOWN},
    "a settlement": {"load__live": SETTLES},
    "a beam that is driven": {
        "load": {"gravity": GRAVITY},
        "beam": {"height": 0.2, "mass": 10.0, "drive": {"displacement": [0.01, 0.0]}},
    },
}


@pytest.mark.parametrize("further", [{}, {"fracture_energy_1": 10.0}, {"compressive_strength": 1e9}])
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("model", MODELS)
def test_a_fall_of_joints_that_keep_their_strength_does_not_prove_that_nothing_bears_the_weight(
    model: Any, load: str, further: Any
) -> None:
    """A block between two cantilevers, which forces balance that nothing brings about, whatever else is to come.

    A fracture energy of dry joints, and a strength that no pressure comes near, do not make this another wall.
    """
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9, **further}
    scene = courses(CANTILEVERS, 0.5, 0.2, joint=joint, block__young=1e12, **LOADS[load])
    assert limit(scene).status in ("collapse", "unbounded")
    outcome = model(scene)
    assert outcome.status == "undecided"
    assert "though forces exist that balance it" in outcome.message


@pytest.mark.parametrize(
    ("joint", "verdict"),
    [
        *[({}, "undecided"), ({"compressive_strength": 1e9}, "undecided")],
        *[({"friction": 0.0}, "infeasible"), ({"compressive_strength": 1e3}, "infeasible")],
    ],
)
def test_neither_does_a_fall_before_the_ground_moves(joint: dict[str, float], verdict: str) -> None:
    """Without friction no forces balance the block in the middle, nor do any that joints bear which crush under it."""
    pulse = {"pulse": {"kind": "sine", "amplitude": 0.2, "period": 0.3}, "quantity": "g"}
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9, **joint}
    scene = courses(CANTILEVERS, 0.5, 0.2, joint=joint, load={"gravity": GRAVITY, "history": pulse})
    found = respond("dem-dynamic", scene)
    assert found.verdict == verdict
    assert found.message.startswith("collapses under its dead load")
    assert ("though forces exist" in found.message) == (verdict == "undecided")


@pytest.mark.parametrize("model", MODELS)
def test_weight_and_live_load_count_alike(model: Any) -> None:
    """A joint that tears from its edge on bears one load in all, however much of it is weight, to the brackets."""
    first, *more = (
        [(1 + bound) * share for bound in (outcome.lower, outcome.upper)]
        for share in (0.3, 0.6, 0.8)
        for outcome in [model(sheared(share), 0.002)]
    )
    for lower, upper in more:
        assert lower <= first[1] * 1.002
        assert first[0] <= upper * 1.002


def held(courses: list[list[float]], pressed: float, height: float = 0.2, **joint: float) -> Scene:
    """Dry blocks on two pins, under a beam that is pushed once it is held at its height."""
    tables: dict[str, Any] = {
        "wall": {"block_width": 0.4, "block_height": height, "thickness": 0.2, "courses": courses},
        "block": {"density": 1800.0, "young": 1e14, "poisson": 0.2},
        "joint": {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9, **joint},
        "support": {"kind": "pinned-corners"},
        "load": {"gravity": GRAVITY},
        "beam": {
            "height": 0.1,
            "condition": "fixed-height",
            "force": [0, -pressed],
            "drive": {"force": [1, 0]},
        },
    }
    return scene_from_dict(tables)


ARCH: list[list[float]] = [[1, -1, 1], [0.5, 0.5, -1, 0.5, 0.5], [3]]


@pytest.mark.parametrize(("courses", "pressed", "friction"), [([[1, 1]], 1e3, 0.6), *at_length((ARCH, 1.27e4, 0.3))])
def test_a_beam_held_at_its_height_keeps_the_thrust_of_a_load_that_came_slowly(
    courses: Any, pressed: float, friction: float
) -> None:
    """That of `dem-static`, and so its strength: put on at once, it slid joints back that bore the overshoot.

    With the same joint points. In the arch the thrust was a third too small, and the strength a fifth too large.
    """
    scene = held(courses, pressed, friction=friction)
    exact = dem_static(scene)
    for outcome in (dem_dynamic(scene), fem(scene, points="joints")):
        assert outcome.multiplier == pytest.approx(exact.multiplier, rel=5e-3)
        thrust = [each.path[0, each.path_columns.index("pinned block 0 horizontal [N]")] for each in (outcome, exact)]
        assert thrust[0] == pytest.approx(thrust[1], rel=2e-3)


@pytest.mark.parametrize(("points", "lever"), [(2, 1.0), (3, 2 / 3), *at_length((9, 2 / 3))])
def test_a_strut_under_a_beam_held_at_its_height_locks_by_where_its_joint_bears(points: int, lever: float) -> None:
    """A block that turns about its pin presses evenly less on its top from one end on, in the mean at 2/3 of its width.

    The strut from there to the pin locks once friction is its slope. Of two points the far one bears all of it.
    """
    for friction, status in ((0.95 * lever, "collapse"), (1.05 * lever, "unbounded")):
        scene = held([[1, 1], [2]], 1e4, friction=friction, height=0.4)
        assert fem(scene, modes=3, rule=lobatto(points), points="joints").status == status


@pytest.mark.parametrize("model", [dem_static, dem_dynamic, fem])
def test_models_say_under_a_beam_held_at_its_height_that_joints_bear_at_a_few_points(model: Any) -> None:
    """In `fem` where a block lies on two as well: its joints are in parts, and each of them has its ends alone."""
    note = "alone, and slide under a beam held at its height"
    patterns: tuple[list[list[float]], ...] = ([[1, 1], [2]], [[1], [1]])
    for pattern in patterns:
        assert note in model(held(pattern, 1e4)).message
        if model is not dem_static:
            assert note not in model(held(pattern, 1e4, compressive_strength=1e9)).message


def test_the_ledger_has_a_preload_that_grows_do_all_of_its_work() -> None:
    """What it does not do, for it came slowly, is as good as damped; an elastic bar ends unstretched."""
    scene = pulled(0.9)
    run = quasi_static_run(scene)
    state = put_on_dead_load(run, Criteria(collapse=0.05 * scene.block_size)).state
    assert run.system.ties.force(state.motion, state.stretch) == pytest.approx(scene.ties.preload, rel=1e-4)
    assert abs(state.stretch) == pytest.approx(0.0, abs=1e-9 * run.system.ties.slack[0])
    assert state.absorbed > 0
    assert run.unaccounted(state) < 1e-3


def test_a_load_that_grows_does_half_of_its_work() -> None:
    """On springs, and a quarter that comes at once a sixteenth of all; the ledger closes."""
    scene = hanging(0.9)
    run = quasi_static_run(scene)
    state = put_on_dead_load(run, Criteria(collapse=0.05 * scene.block_size)).state
    whole = float(run.system.dead @ state.motion)
    assert state.external == pytest.approx(whole * (1 + 1 / 16) / 2, rel=1e-2)
    assert run.dead_work(state) == pytest.approx(state.external, rel=1e-9)
    assert run.unaccounted(state) < 1e-3


@pytest.mark.parametrize("share", [0.9, 0.95])
def test_a_brittle_block_near_its_strength_stands_on_ground_that_hardly_moves(share: float) -> None:
    """Pressed by shares of its strength, evenly: what grows too fast overshoots, and does not come back."""
    stress = DENSITY * GRAVITY * 1.0
    wall = {"block_width": 0.5, "block_height": 1.0, "thickness": 0.3, "courses": [[1]]}
    joint = {"friction": 0.7, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    joint |= {"compressive_strength": stress / share, "compressive_fracture_energy": 50.0}
    pulse = {"kind": "half-sine", "amplitude": 1e-3, "period": 0.02}
    load = {"gravity": GRAVITY, "history": {"pulse": pulse, "quantity": "g"}}
    tables = {"wall": wall, "block": {"density": DENSITY}, "joint": joint, "support": {"kind": "base"}, "load": load}
    scene = scene_from_dict(tables)
    response = respond("dem-dynamic", scene)
    assert response.verdict == "stands", response.message


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
@pytest.mark.parametrize(("leans", "strength"), [(-0.8, 1.2e4), (-0.7, 8e3)])
def test_a_slender_pier_that_sways_as_its_dead_load_is_put_on_does_not_fall(
    model: Any, leans: float, strength: float
) -> None:
    """Put on at once the load moves its top by twice what it does in the end, and that was taken for a fall."""
    foot, pier = [[1, 1, 1], [0.5, 1, 1, 0.5]], [[-1, 0.5, 0.5, -1], [-1, 1, -1]]
    size = {"block_width": 0.25, "block_height": 0.5, "thickness": 0.2}
    scene = scene_from_dict(
        {
            "wall": size | {"courses": [*3 * foot, foot[0], *2 * pier, pier[0]]},
            "block": {"density": 2000.0, "young": 1e12},
            "joint": {
                "friction": 0.75,
                "cohesion": 3.5e4,
                "tensile_strength": strength,
                "normal_stiffness": 8.6e8,
                "shear_stiffness": 3.4e8,
            },
            "support": {"kind": "base"},
            "load": {"gravity": [leans, -9.81], "live": {"kind": "lateral", "direction": "left"}},
        }
    )
    outcome = model(scene)
    assert outcome.status == "collapse", outcome.message
    assert outcome.multiplier == pytest.approx(limit(scene).multiplier, rel=0.01)
