"""Loads: several of them, of a user's own, and what a file and Python may say of them."""

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
from runningbond.limit.kinematics import dead_load, live_load
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
    """A pressure [Pa] on the left side of the wall: a load of one's own, which nothing in the package knows of."""

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


def test_a_load_of_ones_own_runs_in_every_model() -> None:
    """Wind on a tower b wide and h high of weight G: p h t h/2 = G b/2, whichever model is asked."""
    scene = tower(load__live=Wind(1.0))
    exact = scene.mass[scene.wall].sum() * 9.81 * 0.24 / (0.36**2 * 0.12)
    assert limit(scene).multiplier == pytest.approx(exact, rel=1e-8)
    outcome = dem_dynamic(scene)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= exact * (1 + 1e-3)
    assert outcome.upper >= exact * (1 - 1e-3)
    assert homog_says(scene).startswith("model homog: has no closed form for this scene: it needs load.live.kind")
    held = tower(load__live=Wind(1.0), support__kind="fixed-first-course")
    assert live_load(held)[0::3] == pytest.approx([0.0, 0.0144, 0.0144])
    assert held.control_point[1].tolist() == pytest.approx([0.0, 0.18])
    _, at, direction = scene.control_point
    assert (at.tolist(), direction.tolist()) == ([0.0, 0.06], [1.0, 0.0])
    assert len(scene.load.live[0].arrows(scene)) == 3


def homog_says(scene: Scene) -> str:
    with pytest.raises(SceneError) as refused:
        homog(scene)
    return str(refused.value)


def test_a_result_keeps_the_forces_of_a_load_of_ones_own(tmp_path: Path) -> None:
    scene = tower(load__live=Wind(2.0), load__dead=[Wind(1.0), Lateral((0.0, 1.0))])
    save_outcome(Outcome("tower", "limit", "undecided"), tmp_path, scene=scene)
    again = load_scene(tmp_path)
    assert np.array_equal(live_load(again), live_load(scene))
    assert np.array_equal(dead_load(again), dead_load(scene))
    assert all(map(np.array_equal, again.control_point, scene.control_point))


def test_live_loads_share_one_multiplier_and_dead_ones_have_none() -> None:
    """A lateral load and as much body force are two, which half the multiplier takes; a dead load is no live one."""
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
def test_a_lateral_load_has_any_direction(to: Any) -> None:
    scene = panel(load__live={"kind": "lateral", "direction": to})
    x, y = (-1.0 if to == "left" else 1.0, 0.0) if isinstance(to, str) else to
    unit = np.array([x, y]) / np.hypot(x, y)
    assert scene.load.live == (Lateral((x, y)),)
    assert live_load(scene).reshape(-1, 3)[:, :2] == pytest.approx(9.81 * scene.mass[:, None] * unit)


def test_a_block_is_pushed_by_all_of_its_weight_where_that_leans() -> None:
    scene = panel(load__gravity=[3.0, -4.0])
    assert live_load(scene).reshape(-1, 3)[:, :2] == pytest.approx(5.0 * scene.mass[:, None] * [1.0, 0.0])


def test_ground_that_is_tilted_by_one_in_one_is_by_45_degrees() -> None:
    """It turns about nothing that leans against the weight, by half a degree or more."""
    assert Tilt().note(1.0) == "the ground is tilted by 45°"
    assert Tilt().note(-(3**-0.5)) == "the ground is tilted by -30°"
    with pytest.raises(SceneError, match="must be across gravity, along the ground; to the right that is"):
        panel(load__live={"kind": "tilt", "direction": [1.0, 0.01]})


def test_a_wall_pushed_to_the_left_is_the_mirror_image_of_one_pushed_to_the_right() -> None:
    right, left = (limit(panel(load__live={"kind": "lateral", "direction": to})).multiplier for to in ("right", "left"))
    assert left == pytest.approx(right, rel=1e-8)


def test_a_direction_that_is_no_unit_vector_is_one_in_python_too() -> None:
    assert Lateral((1.0, 1.0)).direction == pytest.approx((0.5**0.5, 0.5**0.5))


def test_a_direction_may_be_a_computed_one() -> None:
    assert Lateral((math.cos(math.pi / 2), 1.0)).direction == (0.0, 1.0)


def test_gravity_may_be_a_vector() -> None:
    assert panel(load__gravity=[0.0, -9.81]).load == panel().load
    with pytest.raises(SceneError, match=r"load\.gravity = \[0, nan\]"):
        panel(load__gravity=[0, float("nan")])


def test_forces_are_the_same_to_rigid_and_to_deformable_blocks() -> None:
    """Resultants of every kind of force, block by block; a moment too."""
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

    moment: float

    def forces(self, scene: Scene) -> Forces:
        """The same on each."""
        return Forces.on(scene, moment=self.moment)


@dataclass(frozen=True)
class Push(Action):
    """A push of 1 N to the right on some blocks, at a point; or what is given, by mistake, in place of forces."""

    block: Any
    at: tuple[float, float] = (0.0, 0.0)
    given: Any = ()

    def forces(self, scene: Scene) -> Forces:
        """The push, unless something else is given."""
        return Forces.on(scene, block=self.block, at=self.at, force=(1.0, 0.0)) if self.given == () else self.given


def test_a_point_beside_the_wall_is_told_the_nearest_place_where_its_load_is_taken() -> None:
    """On an arch of chords, where a drawn curve says little of where a voussoir's side is."""
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


def test_a_force_where_a_block_stands_on_its_ground_is_all_on_the_block() -> None:
    """The ground bears none of it, and of two blocks that meet there each has half."""
    for x, blocks in ((0.12, [0]), (0.24, [0, 1])):
        forces = panel(load__live={"kind": "point", "at": [x, 0.0], "force": [4.0, -2.0]}).live_forces
        assert forces.block.tolist() == blocks
        assert forces.force == pytest.approx(np.tile([4.0, -2.0], (len(blocks), 1)) / len(blocks))


@pytest.mark.parametrize(("moment", "x"), [(2.0, 0.24), (-2.0, 0.48)])
def test_the_arrow_of_a_moment_is_on_the_side_that_it_moves_down(moment: float, x: float) -> None:
    """On the left of its block where it is counter-clockwise."""
    scene = panel(load__live={"kind": "moment", "at": [0.3, 0.03], "moment": moment})
    (arrow,) = scene.load.live[0].arrows(scene)
    assert arrow.at == pytest.approx([x, 0.06])
    assert arrow.direction.tolist() == [0.0, -1.0]


def test_moments_add_and_are_forces_neither_on_mass_nor_at_points_alone() -> None:
    """So that λ beside one is no force in newtons, and a wall under one is none that is pushed by its weight."""
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
        (Push([78]), "must put finite forces on the blocks, not all of them zero on those that move"),
        ([DOWN, Push([79])], "load.live[1].block = [79]: must be numbers of blocks, 0 … 78"),
        (Push(-1), "load.live.block = -1: must be numbers of blocks, 0 … 78"),
        (Push([True, False]), "load.live.block = [True, False]: must be numbers of blocks, 0 … 78"),
        (Push([0], (float("nan"), 0.0)), "load.live.at = [[nan, 0.0]]: must be finite"),
        (Push([0], given=None), "load.live: Push.forces: must return Forces"),
    ],
)
def test_loads_that_are_none(live: Any, said: str) -> None:
    with pytest.raises(SceneError) as refused:
        panel(load__live=live)
    assert said in str(refused.value)


def test_what_is_no_load_is_refused_in_python() -> None:
    with pytest.raises(SceneError, match=r"load\.live"):
        Load(live=(3,))  # type: ignore[arg-type]
    assert Load(live=Lateral()) == Load()  # type: ignore[arg-type]


@pytest.mark.parametrize("ends", [(0.0, 1.44), (0.1, 0.5), (0.3, 1.2)])
def test_a_line_load_is_cut_at_the_joints_to_the_last_digit(ends: tuple[float, float]) -> None:
    """Along the top each block gets the force per length times the length on it, about its own middle."""
    live = {"kind": "line", "from": [ends[0], 0.72], "to": [ends[1], 0.72], "force": [20.0, -100.0]}
    scene = panel(load__live=live)
    load = live_load(scene).reshape(-1, 3)
    low, high = (corner[:, 0].clip(*ends) for corner in scene.blocks.boxes)
    on = scene.wall & (scene.blocks.boxes[1][:, 1] > 0.719)
    run, middle = (high - low) * on, (high + low) / 2 - scene.blocks.centroid[:, 0]
    expected = np.column_stack([20.0 * run, -100.0 * run, -100.0 * run * middle - 20.0 * run * 0.03])
    assert load == pytest.approx(expected, abs=1e-12)


def test_a_line_load_bends_a_block_as_it_does_spread_out() -> None:
    """Its forces have q l³ / 12 about the middle of the line as well: in strains that are even they work as it does."""
    live = {"kind": "line", "from": [0.38, 0.72], "to": [0.52, 0.72], "force": [0.0, -100.0]}
    forces = panel(load__live=live).live_forces
    assert len(np.unique(forces.block)) == 1
    arm = forces.at[:, 0] - 0.45
    assert [(forces.force[:, 1] * arm**k).sum() for k in range(3)] == pytest.approx([-14.0, 0.0, -100 * 0.14**3 / 12])


def test_a_line_load_is_cut_where_it_meets_the_edges_of_pieces() -> None:
    """Where it crosses one, and where one ends on it; not where it would beyond its own ends."""
    scene = courses([[1]], load__live={"kind": "line", "from": [0.1, 0.1], "to": [0.3, 0.1], "force": [0.0, -1e3]})
    crossing, ending = [[0.2, 0.0], [0.1, 0.4]], [[0.25, 0.1], [0.3, 0.17]]
    beyond = [[0.35, 0.0], [0.35, 0.17]]
    forces = scene.load.live[0].forces_by_piece(scene, np.array([crossing, ending, beyond]))
    lengths = np.array([0.075, 0.075, 0.05])  # from 0.1 to 0.175, where the first one's first quarter ends, to 0.25
    assert forces.force[:, 1] == pytest.approx(np.repeat(-1e3 * lengths / 2, 2), rel=1e-9)
    assert forces.at[:, 0].reshape(3, 2).mean(axis=1) == pytest.approx([0.1375, 0.2125, 0.275])


@pytest.mark.parametrize("ends", [(0.0, 1.44), (1.2, 0.3)])
def test_arrows_of_a_line_load_are_spread_along_it_each_on_the_block_beneath(ends: tuple[float, float]) -> None:
    live = {"kind": "line", "from": [ends[0], 0.72], "to": [ends[1], 0.72], "force": [0.0, -100.0]}
    scene = panel(load__live=live)
    arrows = scene.load.live[0].arrows(scene)
    tips = np.array([arrow.at for arrow in arrows])
    assert tips[:, 0] == pytest.approx(ends[0] + np.array([1, 3, 5, 7]) / 8 * (ends[1] - ends[0]))
    assert [arrow.block.tolist() for arrow in arrows] == [scene.blocks.containing(tip).tolist() for tip in tips]


@pytest.mark.parametrize(("ends", "on"), [((0.0, 1.44), 1), ((0.12, 0.6), 2), ((0.3, 1.2), 1), ((1.2, 0.3), 1)])
def test_displacements_under_a_line_load_are_read_at_its_middle(ends: tuple[float, float], on: int) -> None:
    """On the block of the top course there, or the mean of the two that meet there."""
    live = {"kind": "line", "from": [ends[0], 0.72], "to": [ends[1], 0.72], "force": [30.0, -40.0]}
    scene = panel(load__live=live)
    block, at, direction = scene.control_point
    assert at.tolist() == pytest.approx([sum(ends) / 2, 0.72])
    assert direction.tolist() == pytest.approx([0.6, -0.8])
    assert set(block) == set(scene.blocks.containing(at))
    assert len(block) == on


@pytest.mark.parametrize("angle", [80.0, 40.0, 10.0, 1.0])
@pytest.mark.parametrize("along", [True, False])
def test_a_line_load_that_crosses_a_joint_is_cut_there_however_flat(angle: float, along: bool) -> None:
    """Half of a line whose middle is on a head joint is on either block, about the middle of its own half.

    Contact reaches along the joint the farther the flatter the line: all of that was on the block that the force
    presses on, and of a force along the line it was refused as on neither.
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
def test_a_line_load_through_a_corner_that_it_touches_is_cut_there(angle: float, sense: float, along: bool) -> None:
    """Where a head joint ends at the stone above, a line comes from that beside it and passes the other's corner.

    Contact with that one reaches along the line the farther the flatter that is: a force along it was refused.
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


def test_a_line_load_on_slanting_blocks_is_cut_at_their_corners() -> None:
    """Two blocks on the ground with a slanting joint, a gap, and a third: each has what lies on its top, to rounding.

    Contact reaches beyond a slanting side to one side only, and past a corner beside a gap.
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
def test_a_line_load_in_a_bed_joint_is_on_the_block_that_its_part_across_presses_on(along: float) -> None:
    """However inclined it is, as a hair below the joint; inclined ones went to the course above and below by turns."""
    borne = []
    for y in (0.12, 0.1199):
        line = {"kind": "line", "force": [along, -1000.0], "from": [0.1, y], "to": [0.9, y]}
        scene = panel(load__live=[line])
        forces = scene.load.live[0].forces(scene)
        borne.append([np.bincount(forces.block, part, len(scene.blocks)) for part in forces.force.T])
    assert borne[0] == pytest.approx(np.array(borne[1]), rel=1e-9, abs=1e-9)


def test_a_line_load_along_a_joint_presses_on_neither_side() -> None:
    """Nor does it by rounding."""
    for low, high in ((0.005, 0.055), (0.01, 0.03)):
        live = {"kind": "line", "from": [0.24, low], "to": [0.24, high], "force": [1e-13, -1000.0]}
        with pytest.raises(SceneError, match="presses on neither alone"):
            limit(panel(load__live=[live]))


def test_a_line_load_along_a_slanting_joint_presses_on_neither_side() -> None:
    """Whichever side rounding of its parts is on."""
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
def test_a_line_load_on_a_block_that_is_not_convex_is_on_the_side_that_it_presses_on(force: float, block: int) -> None:
    """An L, whose centroid lies above the joint with a small block in its corner."""
    outlines = [
        np.array([[0, 0], [1, 0], [1, 0.2], [0.3, 0.2], [0.3, 1], [0, 1]]),
        np.array([[0.3, 0.2], [1, 0.2], [1, 0.4], [0.3, 0.4]]),
    ]
    line = LineLoad((0.4, 0.2), (0.9, 0.2), (0.0, force))
    load = Load((0.0, -9.81), (Lateral(),), (line,))
    scene = build_scene("L", outlines, thickness=0.1, block=BlockMaterial(1800.0), joint=JointMaterial(0.6), load=load)
    assert np.unique(line.parts(scene)[0]).tolist() == [block]
