"""Loads: several at once, user-defined kinds, and what files and Python accept."""

import math
import re
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.rigid_system import rigid_system
from fem_interface.modal_wall import modal_wall
from fem_interface.system import system_of
from homog import homog
from runningbond.limit import limit
from runningbond.limit.kinematics import control_row, dead_load, live_load
from runningbond.results import Outcome
from runningbond.results.store import load_scene, save_outcome
from runningbond.scene import (
    Action,
    BlockMaterial,
    Body,
    Forces,
    JointMaterial,
    Lateral,
    LineLoad,
    Load,
    PointLoad,
    Scene,
    SceneError,
    Tilt,
    build_scene,
    scene_from_dict,
)
from tests.walls import courses, panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
DOWN = {"kind": "point", "at": [0.72, 0.72], "force": [0, -1e3]}


@dataclass(frozen=True)
class Wind(Action):
    """A pressure [Pa] on the left side of the wall: a user-defined load that the package does not contain."""

    pressure: float

    def forces(self, scene: Scene) -> Forces:
        """The pressure on the left end of each course, at its middle."""
        low, _ = scene.blocks.extent(scene.wall)
        ends = [(scene.blocks.extent(int(block)), block) for block in np.flatnonzero(scene.wall)]
        left = [(block, (a + b) / 2, b[1] - a[1]) for (a, b), block in ends if a[0] < low[0] + 1e-9]
        return Forces.on(
            scene,
            block=[block for block, _, _ in left],
            at=[(low[0], middle[1]) for _, middle, _ in left],
            force=[(self.pressure * scene.thickness * height, 0.0) for _, _, height in left],
        )


def tower(**changes: Any) -> Scene:
    """Three blocks of 0.24 × 0.12 × 0.12 m on each other."""
    joint = {"friction": 2.0, "mortar": MORTAR}
    return courses([[1], [1], [1]], width=0.24, height=0.12, joint=joint, **changes)


def test_user_defined_load_runs_in_every_model() -> None:
    """Wind on a tower of width b, height h and weight G overturns it at p h t h/2 = G b/2 (`homog` refuses it)."""
    scene = tower(load__live=Wind(1.0))
    exact = scene.mass[scene.wall].sum() * 9.81 * 0.24 / (0.36**2 * 0.12)
    assert limit(scene).multiplier == pytest.approx(exact, rel=1e-8)
    outcome = dem_dynamic(scene)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= exact * (1 + 1e-3)
    assert outcome.upper >= exact * (1 - 1e-3)
    assert homog_refusal(scene).startswith("model homog: has no closed form for this scene: it needs load.live.kind")
    held = tower(load__live=Wind(1.0), support__kind="fixed-first-course")
    assert live_load(held)[0::3] == pytest.approx([0.0, 0.0144, 0.0144])
    assert held.control_point[1][0].tolist() == pytest.approx([0.0, 0.18])
    _, (at,), (direction,) = scene.control_point
    assert (at.tolist(), direction.tolist()) == ([0.0, 0.06], [1.0, 0.0])
    assert len(scene.load.live[0].arrows(scene)) == 3


def homog_refusal(scene: Scene) -> str:
    with pytest.raises(SceneError) as refused:
        homog(scene)
    return str(refused.value)


def test_stored_scene_keeps_the_forces_of_user_defined_loads(tmp_path: Path) -> None:
    scene = tower(load__live=Wind(2.0), load__dead=[Wind(1.0), Lateral((0.0, 1.0))])
    save_outcome(Outcome("tower", "limit", "undecided"), tmp_path, scene=scene)
    again = load_scene(tmp_path)
    assert np.array_equal(live_load(again), live_load(scene))
    assert np.array_equal(dead_load(again), dead_load(scene))
    assert all(map(np.array_equal, again.control_point, scene.control_point))


def test_multiplier_scales_all_live_loads_and_no_dead_load() -> None:
    """A lateral load plus an equal body force halve the multiplier; a dead load leaves the live load unchanged."""
    halves = [{"kind": "lateral"}, {"kind": "body", "acceleration": [9.81, 0.0]}]
    both = panel(load__live=halves)
    one, two = limit(panel()).multiplier, limit(both).multiplier
    assert one is not None
    assert two == pytest.approx(one / 2, rel=1e-8)
    assert live_load(both) == pytest.approx(2 * live_load(panel()))
    pressed = panel(load__dead=[DOWN])
    assert np.array_equal(live_load(pressed), live_load(panel()))
    assert (dead_load(pressed) - dead_load(panel()))[1::3].sum() == pytest.approx(-1e3)
    alone = panel(load__dead=DOWN)
    assert np.array_equal(dead_load(alone), dead_load(pressed))


@pytest.mark.parametrize("to", ["right", "left", [3.0, 4.0], [0.0, -2.0]])
def test_lateral_load_in_any_direction(to: Any) -> None:
    scene = panel(load__live={"kind": "lateral", "direction": to})
    x, y = (-1.0 if to == "left" else 1.0, 0.0) if isinstance(to, str) else to
    unit = np.array([x, y]) / np.hypot(x, y)
    assert scene.load.live == (Lateral((x, y)),)
    assert live_load(scene).reshape(-1, 3)[:, :2] == pytest.approx(9.81 * scene.mass[:, None] * unit)


def test_lateral_load_is_the_full_weight_if_gravity_is_inclined() -> None:
    scene = panel(load__gravity=[3.0, -4.0])
    assert live_load(scene).reshape(-1, 3)[:, :2] == pytest.approx(5.0 * scene.mass[:, None] * [1.0, 0.0])


def test_tilt_multiplier_is_the_tangent_of_the_angle() -> None:
    """A tilt direction that is not perpendicular to gravity, here by half a degree, is refused."""
    assert Tilt().note(1.0) == "the ground is tilted by 45°"
    assert Tilt().note(-(3**-0.5)) == "the ground is tilted by -30°"
    with pytest.raises(SceneError, match="must be across gravity, along the ground; to the right that is"):
        panel(load__live={"kind": "tilt", "direction": [1.0, 0.01]})


def test_symmetric_wall_has_the_same_multiplier_to_the_left_and_right() -> None:
    right, left = (limit(panel(load__live={"kind": "lateral", "direction": to})).multiplier for to in ("right", "left"))
    assert left == pytest.approx(right, rel=1e-8)


def test_direction_is_normalised_in_python() -> None:
    assert Lateral((1.0, 1.0)).direction == pytest.approx((0.5**0.5, 0.5**0.5))


def test_rounding_errors_are_removed_from_directions() -> None:
    assert Lateral((math.cos(math.pi / 2), 1.0)).direction == (0.0, 1.0)


def test_gravity_may_be_a_vector() -> None:
    assert panel(load__gravity=[0.0, -9.81]).load == panel().load
    with pytest.raises(SceneError, match=r"load\.gravity = \[0, nan\]"):
        panel(load__gravity=[0, float("nan")])


def test_loads_have_the_same_resultants_on_rigid_and_deformable_blocks() -> None:
    """Block by block, for point loads, body forces and moments."""
    loads = (PointLoad((0.12, 0.36), (3.0, -4.0)), Body((1.0, -2.0)), Moments(5.0))
    scene = tower(block__young=1e9)
    scene = replace(scene, load=Load(scene.load.gravity, loads))
    rigid, deformable = rigid_system(scene), system_of(modal_wall(scene))
    for system in (rigid, deformable):
        moved = system.live[system.rigid]
        assert moved[:-1] == pytest.approx(live_load(scene).reshape(-1, 3)[:-1], rel=1e-9, abs=1e-9)


@dataclass(frozen=True)
class Moments(Action):
    """A moment [N m] on every block."""

    moment: Any

    def forces(self, scene: Scene) -> Forces:
        """The same moment on each block."""
        return Forces.on(scene, moment=self.moment)


@dataclass(frozen=True)
class Push(Action):
    """A force of 1 N to the right on some blocks, at a point; or `given`, an invalid return value, in its place."""

    block: Any
    at: tuple[float, float] = (0.0, 0.0)
    given: Any = ()

    def forces(self, scene: Scene) -> Forces:
        """The force, or `given` if that is set."""
        return Forces.on(scene, block=self.block, at=self.at, force=(1.0, 0.0)) if self.given == () else self.given


OF_ONE_BLOCK = Forces(np.ones((1, 2)), np.zeros(1), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros((0, 2)))
OF_NO_BLOCK = Forces(np.ones((79, 2)), np.zeros(79), np.array([-1]), np.zeros((1, 2)), np.ones((1, 2)))


def test_point_load_beside_the_wall_is_refused_with_the_nearest_valid_point() -> None:
    """On an arch made of chords, whose sides are not exactly where the drawn curve is."""
    walls = Path(__file__).parents[2] / "examples" / "walls"
    arch = tomllib.loads((walls / "arch_with_tie.toml").read_text(encoding="utf-8"))
    load = arch["load"]["live"][0]
    load["at"] = [1.47, 4.6]
    with pytest.raises(SceneError, match="touches no block that can move") as refused:
        scene_from_dict(arch, folder=walls)
    said = re.search(r"the nearest is block (\d+) at \((\S+), (\S+)\)", str(refused.value))
    assert said is not None
    load["at"] = [float(said[2]), float(said[3])]
    scene = scene_from_dict(arch, folder=walls)
    assert scene.load.live[0].blocks(scene).tolist() == [int(said[1])]  # type: ignore[attr-defined]


def test_point_load_at_the_base_acts_on_blocks_only() -> None:
    """The ground carries none of it; if two blocks meet there, each carries half."""
    for x, blocks in ((0.12, [0]), (0.24, [0, 1])):
        forces = panel(load__live={"kind": "point", "at": [x, 0.0], "force": [4.0, -2.0]}).live_forces
        assert forces.block.tolist() == blocks
        assert forces.force == pytest.approx(np.tile([4.0, -2.0], (len(blocks), 1)) / len(blocks))


@pytest.mark.parametrize(("moment", "x"), [(2.0, 0.24), (-2.0, 0.48)])
def test_moment_arrow_is_on_the_side_that_moves_down(moment: float, x: float) -> None:
    """On the left of its block if the moment is counter-clockwise."""
    scene = panel(load__live={"kind": "moment", "at": [0.3, 0.03], "moment": moment})
    (arrow,) = scene.load.live[0].arrows(scene)
    assert arrow.at == pytest.approx([x, 0.06])
    assert arrow.direction.tolist() == [0.0, -1.0]


@pytest.mark.parametrize("moment", [2.0, -2.0])
@pytest.mark.parametrize("about", [(0.24, 0.06), (0.24, 0.0), (0.48, 0.06), (0.48, 0.0), (-7.0, 3.0)])
def test_displacement_of_a_moment_is_the_same_about_every_centre(moment: float, about: tuple[float, float]) -> None:
    """Its rotation times half the diagonal of its block, of .24 × .06 m: above 0, and the work is proportional."""
    scene = panel(load__live={"kind": "moment", "at": [0.3, 0.03], "moment": moment})
    (block,) = set(scene.control_point[0].tolist())
    arm, turn = scene.blocks.centroid[block] - about, 1e-3 * np.sign(moment)
    motion = np.zeros((len(scene.blocks), 3))
    motion[block] = -turn * arm[1], turn * arm[0], turn
    assert control_row(scene) @ motion.ravel() == pytest.approx(1e-3 * np.hypot(0.24, 0.06) / 2)


def test_moments_add_and_are_neither_mass_nor_point_forces() -> None:
    """With a moment in the live load λ is neither a force in newtons nor a multiple of the weight."""
    scene = tower()
    push = Forces.on(scene, block=[0], at=(0.1, 0.1), force=(0.6, -0.8))
    two, three = (Forces.on(scene, moment=size) for size in (2.0, 3.0))
    assert (two + three).resultants(scene)[:, 2].tolist() == [5.0] * len(scene.blocks)
    assert Forces.on(scene, (1.0, 0.0)).on_mass_alone
    assert not (two + Forces.on(scene, (1.0, 0.0))).on_mass_alone
    assert push.at_points_alone
    assert not (push + two).at_points_alone


@pytest.mark.parametrize(
    ("live", "said"),
    [
        ([DOWN, {"kind": "point", "at": [9, 9], "force": [0, -1]}], "load.live[1].at = [9.0, 9.0]: touches no block"),
        ([DOWN, {"kind": "point", "at": [0, 0], "force": [0, 0]}], "load.live[1].force = [0.0, 0.0]: must not be zero"),
        ([], "load.live = []: must be a load, or some"),
        ([DOWN, []], "load.live[1] = []: must be a load, or some"),
        ("lateral", "load.live = 'lateral': must be a table"),
        ({"kind": "latteral"}, 'did you mean "lateral"?'),
        ({"kind": "lateral", "direction": "up"}, 'load.live.direction = \'up\': must be "right", "left" or a vector'),
        ({"kind": "lateral", "direction": [0, 0]}, "load.live.direction = [0.0, 0.0]: must not be zero"),
        ({"kind": "body"}, "load.live.acceleration: is missing"),
        (Moments(0.0), "load.live = Moments(moment=0.0): must put finite forces on the blocks, not all of them zero"),
        (Moments(float("nan")), "must put finite forces on the blocks"),
        (Moments(float("inf")), "must put finite forces on the blocks"),
        (Push([78]), "must put finite forces on the blocks, not all of them zero on those that move"),
        # what is left acts on the ground, which does not move
        ([Push([0, 78]), {"kind": "point", "at": [0, 0], "force": [-1, 0]}], "load.live: must not cancel out"),
        ([DOWN, Push([79])], "load.live[1].block = [79]: must be numbers of blocks, 0 … 78"),
        (Push(-1), "load.live.block = -1: must be numbers of blocks, 0 … 78"),
        (Push([True, False]), "load.live.block = [True, False]: must be numbers of blocks, 0 … 78"),
        (Push([0], (float("nan"), 0.0)), "load.live.at = [[nan, 0.0]]: must be finite"),
        (Push([0], given=None), "load.live: Push.forces: must return Forces"),
        (Push([0], given=OF_ONE_BLOCK), "load.live: Push.forces: must return Forces.on the scene: of 79 blocks"),
        (Push([0], given=OF_NO_BLOCK), "load.live: Push.forces = [-1]: must name blocks by numbers, 0 … 78"),
        (Moments((1.0, 2.0)), "load.live: Moments.forces: raises ValueError: operands could not be broadcast"),
        ([DOWN, Moments("N m")], "load.live[1]: Moments.forces: raises "),
    ],
)
def test_invalid_loads_are_refused(live: Any, said: str) -> None:
    with pytest.raises(SceneError) as refused:
        panel(load__live=live)
    assert said in str(refused.value)


def test_python_refuses_objects_that_are_no_loads() -> None:
    with pytest.raises(SceneError, match=r"load\.live"):
        Load(live=(3,))  # type: ignore[arg-type]
    assert Load(live=Lateral()) == Load()  # type: ignore[arg-type]


def test_wall_without_any_live_load_is_refused() -> None:
    square = [np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])]
    with pytest.raises(SceneError, match=r"load\.live: is missing: nothing is multiplied by λ"):
        build_scene(
            "dead",
            square,
            thickness=0.1,
            block=BlockMaterial(1800.0),
            joint=JointMaterial(0.6),
            load=Load(live=()),
        )


@pytest.mark.parametrize("ends", [(0.0, 1.44), (0.1, 0.5), (0.3, 1.2)])
def test_line_load_is_divided_exactly_at_the_joints(ends: tuple[float, float]) -> None:
    """Each block of the top course gets the force per length times its loaded length, at the middle of that length."""
    live = {"kind": "line", "from": [ends[0], 0.72], "to": [ends[1], 0.72], "force": [20.0, -100.0]}
    scene = panel(load__live=live)
    load = live_load(scene).reshape(-1, 3)
    low, high = (corner[:, 0].clip(*ends) for corner in scene.blocks.boxes)
    on = scene.wall & (scene.blocks.boxes[1][:, 1] > 0.719)
    run, middle = (high - low) * on, (high + low) / 2 - scene.blocks.centroid[:, 0]
    expected = np.column_stack([20.0 * run, -100.0 * run, -100.0 * run * middle - 20.0 * run * 0.03])
    assert load == pytest.approx(expected, abs=1e-12)


def test_line_load_forces_do_the_work_of_the_distributed_load() -> None:
    """Their second moment about the line's middle is q l³ / 12, so their work in uniform strains is exact."""
    live = {"kind": "line", "from": [0.38, 0.72], "to": [0.52, 0.72], "force": [0.0, -100.0]}
    forces = panel(load__live=live).live_forces
    assert len(np.unique(forces.block)) == 1
    arm = forces.at[:, 0] - 0.45
    assert [(forces.force[:, 1] * arm**k).sum() for k in range(3)] == pytest.approx([-14.0, 0.0, -100 * 0.14**3 / 12])


def test_line_load_is_divided_at_the_edges_of_pieces() -> None:
    """Where it crosses an edge and where an edge ends on it, but not at edges beyond the ends of the load."""
    scene = courses([[1]], load__live={"kind": "line", "from": [0.1, 0.1], "to": [0.3, 0.1], "force": [0.0, -1e3]})
    crossing, ending = [[0.2, 0.0], [0.1, 0.4]], [[0.25, 0.1], [0.3, 0.17]]
    beyond = [[0.35, 0.0], [0.35, 0.17]]
    forces = scene.load.live[0].forces_by_piece(scene, np.array([crossing, ending, beyond]))
    lengths = np.array([0.075, 0.075, 0.05])  # from 0.1 to 0.175, where the first one's first quarter ends, to 0.25
    assert forces.force[:, 1] == pytest.approx(np.repeat(-1e3 * lengths / 2, 2), rel=1e-9)
    assert forces.at[:, 0].reshape(3, 2).mean(axis=1) == pytest.approx([0.1375, 0.2125, 0.275])


@pytest.mark.parametrize("ends", [(0.0, 1.44), (1.2, 0.3)])
def test_line_load_arrows_are_evenly_spaced_on_the_blocks_beneath(ends: tuple[float, float]) -> None:
    live = {"kind": "line", "from": [ends[0], 0.72], "to": [ends[1], 0.72], "force": [0.0, -100.0]}
    scene = panel(load__live=live)
    arrows = scene.load.live[0].arrows(scene)
    tips = np.array([arrow.at for arrow in arrows])
    assert tips[:, 0] == pytest.approx(ends[0] + np.array([1, 3, 5, 7]) / 8 * (ends[1] - ends[0]))
    assert [arrow.block.tolist() for arrow in arrows] == [scene.blocks.containing(tip).tolist() for tip in tips]


@pytest.mark.parametrize(("ends", "on"), [((0.0, 1.44), 1), ((0.12, 0.6), 2), ((0.3, 1.2), 1), ((1.2, 0.3), 1)])
def test_control_point_of_a_line_load_is_its_middle(ends: tuple[float, float], on: int) -> None:
    """On the top-course block there, or on both blocks if two meet there."""
    live = {"kind": "line", "from": [ends[0], 0.72], "to": [ends[1], 0.72], "force": [30.0, -40.0]}
    scene = panel(load__live=live)
    block, at, direction = scene.control_point
    assert at == pytest.approx(np.tile([sum(ends) / 2, 0.72], (on, 1)))
    assert direction == pytest.approx(np.tile([0.6, -0.8], (on, 1)))
    assert set(block) == set(scene.blocks.containing(at[0]))
    assert len(block) == on


@pytest.mark.parametrize("angle", [80.0, 40.0, 10.0, 1.0])
@pytest.mark.parametrize("along", [True, False])
def test_line_load_across_a_joint_is_divided_there_at_any_angle(angle: float, along: bool) -> None:
    """A line load at an angle to a head joint, with its middle on it: each block carries the half that lies on it.

    The smaller that angle, the longer the part of the line within contact distance of the joint. All of that part once
    went to the block that the force presses on, and for a force along the line the load was refused.
    """
    run = 0.02 * np.array([np.sin(np.radians(angle)), -np.cos(np.radians(angle))])
    middle, force = np.array([0.24, 0.03]), 5000 * run if along else np.array([0.0, -100.0])
    live = {"kind": "line", "from": list(middle - run), "to": list(middle + run), "force": list(force)}
    scene = panel(load__live=live)
    load = live_load(scene).reshape(-1, 3)
    for block, half in ((0, middle - run / 2), (1, middle + run / 2)):
        arm = half - scene.blocks.centroid[block]
        expected = 0.02 * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
        assert load[block] == pytest.approx(expected, abs=1e-12)
    assert not load[2:].any()


@pytest.mark.parametrize("angle", [60.0, 20.0, 4.0, 0.5])
@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("along", [True, False])
def test_line_load_through_a_corner_is_divided_there(angle: float, sense: float, along: bool) -> None:
    """The line enters the stone above at the end of a head joint and passes the corner of the block beyond that joint.

    The flatter the line, the longer its part within contact distance of that block: a force along the line was refused.
    """
    corner, run = np.array([0.24, 0.06]), 0.02 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    run[0] *= sense
    force = 5000 * run if along else np.array([0.0, 100.0])
    scene = panel(
        load__live={"kind": "line", "from": list(corner - run), "to": list(corner + run), "force": list(force)}
    )
    load = live_load(scene).reshape(-1, 3)[:, :2]
    halves = [int(scene.blocks.containing(corner + part * run)[0]) for part in (-0.5, 0.5)]
    assert load[halves] == pytest.approx(0.02 * np.array([force, force]), abs=1e-12)
    assert np.flatnonzero(load.any(axis=1)).tolist() == sorted(halves)


def test_line_load_over_inclined_joint_and_gap_is_divided_at_corners() -> None:
    """Two blocks with an inclined joint, a gap and a third block: each carries the load on its top, to rounding.

    The contact distance reaches past an inclined joint on one side only, and past a corner beside a gap.
    """
    tops = [(0.0, 0.4), (0.4, 0.7), (0.9, 1.3)]
    outlines = [
        np.array([[0, 0], [0.2, 0], [0.4, 0.3], [0, 0.3]]),
        np.array([[0.2, 0], [0.7, 0], [0.7, 0.3], [0.4, 0.3]]),
        np.array([[0.9, 0], [1.3, 0], [1.3, 0.3], [0.9, 0.3]]),
        np.array([[0.0, 0.3], [1.3, 0.3], [1.3, 0.5], [0.0, 0.5]]),
    ]
    line = LineLoad((0.1, 0.3), (1.2, 0.3), (0.0, -1000.0))
    load = Load((0.0, -9.81), (Lateral(),), (line,))
    scene = build_scene(
        "gap", outlines, thickness=0.1, block=BlockMaterial(1800.0), joint=JointMaterial(0.6), load=load
    )
    forces = line.forces(scene)
    borne = -np.bincount(forces.block, forces.force[:, 1], len(scene.blocks))[:4]
    under = [1000 * (min(high, 1.2) - max(low, 0.1)) for low, high in tops]
    assert borne == pytest.approx(np.array([*under, 1100 - sum(under)]), abs=1e-9)


@pytest.mark.parametrize("along", [0.0, 800.0, -3000.0, 1e5])
def test_line_load_in_a_bed_joint_acts_on_the_block_it_presses_on(along: float) -> None:
    """At any inclination, as just below the joint; inclined loads once alternated between the courses."""
    borne = []
    for y in (0.12, 0.1199):
        line = {"kind": "line", "force": [along, -1000.0], "from": [0.1, y], "to": [0.9, y]}
        scene = panel(load__live=[line])
        forces = scene.load.live[0].forces(scene)
        borne.append([np.bincount(forces.block, part, len(scene.blocks)) for part in forces.force.T])
    assert borne[0] == pytest.approx(np.array(borne[1]), rel=1e-9, abs=1e-9)


def test_line_load_along_a_joint_is_refused() -> None:
    """Not even by rounding errors of the force; such a load is refused."""
    for low, high in ((0.005, 0.055), (0.01, 0.03)):
        live = {"kind": "line", "from": [0.24, low], "to": [0.24, high], "force": [1e-13, -1000.0]}
        with pytest.raises(SceneError, match="presses on neither alone"):
            limit(panel(load__live=[live]))


def test_line_load_along_an_inclined_joint_is_refused() -> None:
    """Whatever the rounding of its components."""
    outlines = [
        np.array([[0, 0], [0.2, 0], [0.4, 0.3], [0, 0.3]]),
        np.array([[0.2, 0], [0.7, 0], [0.7, 0.3], [0.4, 0.3]]),
    ]
    own = {"thickness": 0.1, "block": BlockMaterial(1800.0), "joint": JointMaterial(0.6)}
    for size in range(100, 110):
        line = LineLoad((0.22, 0.03), (0.38, 0.27), (size / 3 * 0.16, size / 3 * 0.24))
        with pytest.raises(SceneError, match="presses on neither alone"):
            build_scene("slanting", outlines, load=Load(live=(line,)), **own)  # type: ignore[arg-type]


@pytest.mark.parametrize(("force", "block"), [(-1e3, 0), (1e3, 1)])
def test_line_load_on_a_non_convex_block_acts_on_the_block_it_presses_on(force: float, block: int) -> None:
    """An L-shaped block, whose centroid lies above its joint with the small block in its corner."""
    outlines = [
        np.array([[0, 0], [1, 0], [1, 0.2], [0.3, 0.2], [0.3, 1], [0, 1]]),
        np.array([[0.3, 0.2], [1, 0.2], [1, 0.4], [0.3, 0.4]]),
    ]
    line = LineLoad((0.4, 0.2), (0.9, 0.2), (0.0, force))
    load = Load((0.0, -9.81), (Lateral(),), (line,))
    scene = build_scene("L", outlines, thickness=0.1, block=BlockMaterial(1800.0), joint=JointMaterial(0.6), load=load)
    assert np.unique(line.parts(scene)[0]).tolist() == [block]
