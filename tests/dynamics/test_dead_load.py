"""Dead loads near the strength of joints that soften or crush."""

from typing import Any

import pytest

from dem.dynamic import dem_dynamic, quasi_static_run
from dem.static import dem_static
from fem_interface.model import fem
from runningbond import Wall
from runningbond.dynamics import Criteria, put_on_dead_load
from runningbond.joints import lobatto
from runningbond.limit import limit
from runningbond.models import respond
from runningbond.results import Outcome
from runningbond.scene import Scene, scene_from_dict
from tests.at_length import at_length
from tests.walls import content, courses

GRAVITY, DENSITY, HEIGHT = 9.81, 2000.0, 0.2
STRESS = DENSITY * GRAVITY * HEIGHT
MODELS = (dem_dynamic, fem)


def block(gravity: tuple[float, float], height: float = HEIGHT, tie: Any = (), **joint: float) -> Scene:
    """A block 0.2 m wide whose weight [m/s²] and live load act in the same direction."""
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
    """The weight and a long soft bar, which pulls with three times the weight, use up a share of the strength."""
    strength, weight = 4 * STRESS / share, STRESS * 0.2 * 0.1
    energies = {"fracture_energy_1": 1e-3, "fracture_energy_2": 1e-3}
    size = {"area": 1e-6, "young": 1e5, "yield": 10 * weight, "preload": 3 * weight}
    bar = {"from": [0.1, 0.1], "to": [0.1, 10.0], **size}
    return block((0.0, GRAVITY), tie=[bar], cohesion=strength, tensile_strength=strength, **energies)


def sheared(share: float) -> Scene:
    """Weight along the joint, as in a wall laid on its side: the joint tears from its edge before all of it slides."""
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


LEANING = [
    [(0.44, 0.06), (0.45, 0.0), (0.6, 0.0), (0.6, 0.39), (0.52, 0.37)],
    [(0.0, 0.6), (0.36, 0.6), (0.4, 0.4), (0.28, 0.32), (0.26, 0.32), (0.0, 0.58)],
    [(0.28, 0.32), (0.4, 0.4), (0.52, 0.37), (0.44, 0.06)],
    [(0.26, 0.32), (0.0, 0.58), (0.0, 0.01)],
    [(0.36, 0.6), (0.4, 0.4), (0.52, 0.37), (0.6, 0.39), (0.6, 0.6)],
    [(0.28, 0.32), (0.26, 0.32), (0.0, 0.01), (0.0, 0.0), (0.45, 0.0), (0.44, 0.06)],
]
"""Stones of which one has no support on its left."""


def test_fall_of_soft_joints_under_the_dead_load_is_no_lack_of_stiffness() -> None:
    """The overlap at a toe far into the fall says nothing about the joints; on stiffer ones the wall falls likewise."""
    wall = Wall.outlines(
        LEANING,
        thickness=0.2,
        density=2000.0,
        friction=0.5,
        normal_stiffness=3e8,
        shear_stiffness=1.2e8,
        compressive_strength=1e9,
        live={"kind": "lateral", "direction": "left"},
    )
    assert wall.run("limit").status == "infeasible"
    assert wall.run("dem-dynamic").status == "infeasible"


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("wall", [hanging, crushed])
@pytest.mark.parametrize("share", [0.6, 0.8, 0.96, 0.97, 0.98, 0.985, 0.99])
def test_limit_load_is_strength_left_by_weight(model: Any, wall: Any, share: float) -> None:
    """A joint whose dead load takes a share of its strength fails at λ = 1 / share − 1."""
    assert is_bracketed(model(wall(share)), 1 / share - 1)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("share", [0.6, 0.9, 0.97])
def test_limit_load_is_strength_left_by_preload_and_weight(model: Any, share: float) -> None:
    """Applied suddenly, a bar's preload tears off a joint at half of its strength."""
    assert is_bracketed(model(pulled(share)), 4 * (1 / share - 1))


@pytest.mark.parametrize("model", [dem_static, *MODELS])
def test_preload_slides_block_until_tie_force_equals_friction(model: Any) -> None:
    """A bar with a preload of three times the friction pulls the block until its force equals the friction.

    Applied suddenly, the bar went slack. Dynamic models tighten it in 200 increments and know its force to two of them.
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


def test_energy_balance_is_relative_to_work_of_preloads_too() -> None:
    """A bar that pulls a block off its base against most of the live load does nearly all of the external work."""
    strength, weight = 1e5, STRESS * 0.2 * 0.1
    size = {"area": 1e-6, "young": 1e5, "yield": 1e4, "preload": 15 * weight}
    bar = {"from": [0.1, 0.1], "to": [0.1, 10.0], **size}
    energies = {"fracture_energy_1": 1.0, "fracture_energy_2": 1.0}
    scene = block((0.0, GRAVITY), tie=[bar], cohesion=strength, tensile_strength=strength, **energies)
    assert is_bracketed(dem_dynamic(scene), strength / STRESS - 16)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("wall", [hanging, crushed])
def test_weight_beyond_strength_is_infeasible(model: Any, wall: Any) -> None:
    assert model(wall(1.02)).status == "infeasible"


@pytest.mark.parametrize("model", MODELS)
def test_dead_load_application_does_not_spoil_energy_balance_of_collapse(model: Any) -> None:
    """A thrust leaves a limit load of b / h / 1000, where the works nearly cancel; another block has no friction.

    A tenth of the work during dead loading is not accounted for, which made 3 % or 5 % of the sum of all works.
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
        assert outcome.lower == pytest.approx(exact, abs=1e-5)  # residual forces below the criterion of rest
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
def test_dead_load_collapse_is_undecided_if_equilibrium_exists(model: Any, load: str, further: Any) -> None:
    """A block between two cantilevers: equilibrium forces exist, but the loading does not bring them about.

    A fracture energy of dry joints, or a compressive strength far above all stresses, does not change the result.
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
def test_dead_load_collapse_before_shaking_is_undecided_too(joint: dict[str, float], verdict: str) -> None:
    """Infeasible if nothing can hold the middle block: without friction, or if the joints crush under the weight."""
    pulse = {"pulse": {"kind": "sine", "amplitude": 0.2, "period": 0.3}, "quantity": "g"}
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9, **joint}
    scene = courses(CANTILEVERS, 0.5, 0.2, joint=joint, load={"gravity": GRAVITY, "history": pulse})
    found = respond("dem-dynamic", scene)
    assert found.verdict == verdict
    assert found.message.startswith("collapses under its dead load")
    assert ("though forces exist" in found.message) == (verdict == "undecided")


@pytest.mark.parametrize("model", MODELS)
def test_total_load_does_not_depend_on_share_of_dead_load(model: Any) -> None:
    """A joint that tears from its edge carries the same total load for any share of weight, within the brackets."""
    first, *more = (
        [(1 + bound) * share for bound in (outcome.lower, outcome.upper)]
        for share in (0.3, 0.6, 0.8)
        for outcome in [model(sheared(share), 0.002)]
    )
    for lower, upper in more:
        assert lower <= first[1] * 1.002
        assert first[0] <= upper * 1.002


def held(courses: list[list[float]], pressed: float, height: float = 0.2, **joint: float) -> Scene:
    """Dry blocks on two pins, under a beam that is pushed after its height has been fixed."""
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
def test_fixed_height_beam_keeps_thrust_of_slow_dead_load(courses: Any, pressed: float, friction: float) -> None:
    """Thrust and strength agree with `dem-static`; a suddenly applied load slid joints back because of its overshoot.

    All models use the same joint points. In the arch the thrust was a third too small, the strength a fifth too large.
    """
    scene = held(courses, pressed, friction=friction)
    exact = dem_static(scene)
    for outcome in (dem_dynamic(scene), fem(scene, points="joints")):
        assert outcome.multiplier == pytest.approx(exact.multiplier, rel=5e-3)
        thrust = [each.path[0, each.path_columns.index("pinned block 0 horizontal [N]")] for each in (outcome, exact)]
        assert thrust[0] == pytest.approx(thrust[1], rel=2e-3)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(
    ("pattern", "height", "friction", "support", "by"),
    [
        ([[1, 1], [0.5, 1, 0.5]], 0.1, 1.2, "base", [0.0, -0.002]),
        ([[1, 1], [0.5, 1, 0.5], [1, 1]], 0.3, 0.7, "fixed-first-course", [-0.001, 0.0]),
    ],
)
def test_share_on_a_settlement_is_that_after_a_slowly_applied_dead_load(
    pattern: list[list[float]], height: float, friction: float, support: str, by: list[float], model: Any
) -> None:
    """A load applied at once made joints slide, and the share where the settlement ends was another one."""
    corner = {"kind": "point", "at": [0.6, height * len(pattern)], "force": [0.0, -1000.0]}
    scene = courses(
        pattern,
        0.3,
        height,
        wall__thickness=0.2,
        block={"density": 2000.0, "young": 1e12},
        joint={"friction": friction, "normal_stiffness": 1e9, "shear_stiffness": 4e8},
        support__kind=support,
        load__dead=[corner],
        load__live={"kind": "settlement", "box": [[-9.0, -9.0], [0.312, height / 2]], "by": by},
    )
    assert model(scene).multiplier == pytest.approx(dem_static(scene).multiplier, rel=5e-3)


def test_load_from_rest_starts_after_a_slowly_applied_dead_load() -> None:
    """Heavy stones on rough beds: after a sudden dead load `dem-dynamic` found more than `dem-static`."""
    scene = courses(
        [[0.5, 1, 1, 1, 0.5], [1, 1, 1, 1], [0.5, 1, 1, 1, 0.5], [1, 1, 1, 1]],
        0.3,
        0.3,
        wall__thickness=0.2,
        block={"density": 2000.0},
        materials={"heavy": {"density": 20000.0}},
        joint={"friction": 0.553, "cohesion": 4110.0, "normal_stiffness": 1e9, "shear_stiffness": 4e8},
        joints={"rough": {"friction": 1.762, "inset": 0.02, "normal_stiffness": 1e9, "shear_stiffness": 4e8}},
        assign=[
            {"block": "heavy", "box": [[0.599, 0.899], [1.08, 1.3]]},
            {"joint": "rough", "orientation": "bed"},
        ],
        load={"gravity": [0.96, -9.81], "live": {"kind": "lateral", "direction": "left"}},
    )
    assert dem_dynamic(scene).multiplier == pytest.approx(dem_static(scene).multiplier, rel=0.01)


@pytest.mark.parametrize(("points", "lever"), [(2, 1.0), (3, 2 / 3), *at_length((9, 2 / 3))])
def test_strut_under_fixed_height_beam_locks_by_centre_of_pressure(points: int, lever: float) -> None:
    """Under a block rotating about its pin, pressure on top varies linearly from one end: its centre is at 2/3 width.

    The strut from there to the pin locks if friction exceeds its slope. With two points the far one carries everything.
    """
    for friction, status in ((0.95 * lever, "collapse"), (1.05 * lever, "unbounded")):
        scene = held([[1, 1], [2]], 1e4, friction=friction, height=0.4)
        assert fem(scene, modes=3, rule=lobatto(points), points="joints").status == status


@pytest.mark.parametrize("model", [dem_static, dem_dynamic, fem])
def test_note_on_few_joint_points_under_fixed_height_beam(model: Any) -> None:
    """In `fem` also if a block lies on two blocks: its joints are split, and each part has only its two ends."""
    note = "and slide under a beam held at its height"
    patterns: tuple[list[list[float]], ...] = ([[1, 1], [2]], [[1], [1]])
    for pattern in patterns:
        assert note in model(held(pattern, 1e4)).message
        if model is not dem_static:
            assert note not in model(held(pattern, 1e4, compressive_strength=1e9)).message


def test_energy_balance_closes_for_gradual_preload() -> None:
    """The work that a slow preload does not do counts as damped; an elastic bar ends without plastic elongation."""
    scene = pulled(0.9)
    run = quasi_static_run(scene)
    state = put_on_dead_load(run, Criteria(collapse=0.05 * scene.block_size)).state
    assert run.system.ties.force(state.motion, state.stretch) == pytest.approx(scene.ties.preload, rel=1e-4)
    assert abs(state.stretch) == pytest.approx(0.0, abs=1e-9 * run.system.ties.slack[0])
    assert state.absorbed > 0
    assert run.unaccounted(state) < 1e-3


def test_what_a_gradual_dead_load_does_not_do_counts_as_damped() -> None:
    """The quarter that is applied at once does 1/16 of the work of a sudden load; the energy balance closes."""
    scene = hanging(0.9)
    run = quasi_static_run(scene)
    state = put_on_dead_load(run, Criteria(collapse=0.05 * scene.block_size)).state
    whole = float(run.system.dead @ state.motion)
    assert state.absorbed == pytest.approx(whole * (1 - 1 / 16) / 2, rel=1e-2)
    assert state.external == pytest.approx(whole, rel=1e-9)
    assert run.dead_work(state) == pytest.approx(whole, rel=1e-9)
    assert run.unaccounted(state) < 1e-3


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_work_of_the_dead_load_is_that_of_the_constant_load(model: str) -> None:
    """Whether it was applied at once or, because a preloaded bar makes joints slide, slowly."""
    bar = {"from": [0.0, 1.1], "to": [2.4, 1.1], "area": 3e-4, "young": 2e11, "yield": 3e4, "preload": 1e4}
    size = {"length": 2.4, "height": 1.2, "block_width": 0.4, "block_height": 0.2, "thickness": 0.3}
    joint = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    wall = Wall(content(wall=size, joint=joint, tie=[bar]))
    result = wall.run(model, tolerance=0.1, states=True)
    sinks = result.states[0].motion[:, 1]
    done = float(result.curve["work of the dead load [J]"][0])
    assert done == pytest.approx(-9.81 * float(wall.scene.mass @ sinks), rel=1e-6)


@pytest.mark.parametrize("share", [0.9, 0.95])
def test_brittle_block_near_its_strength_stands_on_weakly_moving_ground(share: float) -> None:
    """Uniform compression at a share of the strength: a load that grows too fast overshoots and crushes for good."""
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
def test_swaying_of_slender_pier_under_dead_load_is_not_collapse(model: Any, leans: float, strength: float) -> None:
    """A suddenly applied load moves the top by twice its final displacement, which was taken for collapse."""
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


@pytest.mark.parametrize("joint", [{}, {"compressive_strength": 1e9}])
def test_lintel_that_tips_onto_the_ground_is_no_wall_that_stands(joint: dict[str, Any]) -> None:
    """Its centroid comes down by a ninth of its size before its free end lands, where it would come to rest."""
    stones = [[(0, 0), (0.4, 0), (0.4, 0.2), (0, 0.2)], [(0, 0.2), (1.6, 0.2), (1.6, 0.4), (0, 0.4)]]
    springs: dict[str, Any] = {"friction": 0.7, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    wall = Wall.outlines(stones, thickness=0.2, density=2000.0, live={"kind": "lateral"}, **springs, **joint)
    for displacements in ("small", "finite"):
        assert wall.run("dem-dynamic", displacements=displacements).status == "infeasible"
