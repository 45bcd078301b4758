"""Supports that move so far that the walls on them change their shape, against exact solutions."""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from runningbond.dynamics import Run, State
from runningbond.models import run_model
from runningbond.results import Outcome
from runningbond.scene import (
    Array,
    BlockMaterial,
    JointMaterial,
    Load,
    Scene,
    Settlement,
    Stiffness,
    Tie,
    build_scene,
)
from tests.at_length import at_length
from tests.limit.test_limit import rectangle

RISE, SKEW = 0.4, 0.15


def on_two_grounds(blocks: list[Array], grounds: list[Array], by: tuple[float, float], **joint: Any) -> Scene:
    """Blocks on two pieces of ground; the right one moves."""
    left = float(grounds[1][:, 0].min())
    given: dict[str, Any] = {"friction": 0.8, "elasticity": Stiffness(3e10, 3e10)} | joint
    return build_scene(
        "moving support",
        blocks,
        thickness=0.2,
        block=BlockMaterial(2000.0, young=1e12, poisson=0.2),
        joint=JointMaterial(**given),
        grounds=grounds,
        load=Load(live=(Settlement(box=((left - 0.01, -2.0), (5.0, 2.0)), by=by),)),
    )


def arch(spread: float, **joint: Any) -> Scene:
    """Two blocks of 1 m between skewed abutments; the right abutment moves away."""
    left = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, RISE], [-SKEW, RISE]])
    abutment = np.array([[-1.0, -1.0], [0.0, -1.0], [0.0, 0.0], [-SKEW, RISE], [-1.0, RISE]])
    across = [np.column_stack([2.0 - outline[::-1, 0], outline[::-1, 1]]) for outline in (left, abutment)]
    return on_two_grounds([left, across[0]], [abutment, across[1]], (spread, 0.0), **joint)


def thrust(spread: float, centroid: Array) -> float:
    """Thrust of the two blocks, as a share of their weight, after the support has moved by `spread`.

    Each block turns about its lower corner at the abutment, and their upper corners press on each other: with half the
    span b + s / 2 the rise follows from the diagonal, and H = W (arm of its middle) / rise.
    """
    half = 1.0 + spread / 2
    rise = math.sqrt(1.0 + RISE**2 - half**2)
    turn = math.atan2(rise, half) - math.atan2(RISE, 1.0)
    return float(centroid[0] * math.cos(turn) - centroid[1] * math.sin(turn)) / rise / 2


def far(scene: Scene, model: Any = dem_dynamic) -> Outcome:
    outcome: Outcome = model(scene, 0.01, displacements="finite")
    assert "finite displacements" in outcome.message, outcome.message
    return outcome


def fall_interval(outcome: Outcome) -> Array:
    """Settlements [m] of the last rest and of the fall ``(2,)``, as the message has them."""
    found = re.search(r"falls between (\S+) and (\S+) m", outcome.message)
    assert found is not None, outcome.message
    return np.array([float(found[1]), float(found[2])])


def voussoirs(spread: float) -> Scene:
    """Half a ring of 11 voussoirs on two grounds, of which the right one moves away."""
    ray = np.linspace(math.pi, 0.0, 12)
    inner, outer = (r * np.column_stack([np.cos(ray), np.sin(ray)]) for r in (1.8, 2.2))
    blocks = [np.array([outer[k], inner[k], inner[k + 1], outer[k + 1]]) for k in range(11)]
    return build_scene(
        "ring",
        blocks,
        thickness=0.5,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.7, elasticity=Stiffness(1e9, 4e8), inset=0.003),
        grounds=[rectangle(-3.0, -0.3, 1.8, 0.3), rectangle(1.2, -0.3, 1.8, 0.3)],
        load=Load(live=(Settlement(box=((1.0, -1.0), (5.0, 0.0)), by=(spread, 0.0)),)),
    )


@pytest.mark.long
def test_fall_does_not_depend_on_how_far_supports_would_move() -> None:
    """In stages of up to a tenth of the way, the way to .9 m ends in rubble that a ledger cannot account for."""
    intervals = [fall_interval(far(voussoirs(spread))) for spread in (0.6, 0.9)]
    assert max(rest for rest, _ in intervals) == pytest.approx(min(fall for _, fall in intervals), rel=0.01)


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_arch_on_a_spreading_support_has_the_thrust_of_its_moved_hinges(model: Any) -> None:
    """From .577 of its weight to .72 at a fortieth of the span, to 2e-3; each ground carries half the weight."""
    scene = arch(0.05)
    outcome = far(scene, model)
    for moved, share in outcome.curve:
        assert share == pytest.approx(thrust(moved, scene.blocks.centroid[0]), rel=2e-3)
    weight = 9.81 * float(scene.mass[~scene.fixed].sum())
    known = dict(zip(outcome.path_columns, outcome.path[-1], strict=True))
    for ground, sense in (("ground 1", 1.0), ("ground 2", -1.0)):
        assert known[f"{ground} vertical [N]"] == pytest.approx(weight / 2, rel=1e-3)
        assert known[f"{ground} horizontal [N]"] == pytest.approx(sense * weight * outcome.curve[-1, 1], rel=1e-3)


def test_arch_falls_once_its_hinges_are_collinear() -> None:
    """The distance between a block's hinges equals half the span at a spread of 0.1511 m; corners are rounded by 2 mm.

    At small displacements it never falls, and its thrust stays constant.
    """
    inset = 0.002
    along = inset / math.hypot(SKEW, RISE)
    line = 2 * (math.hypot(1.0 + along * SKEW, RISE - inset - along * RISE) - 1.0 - along * SKEW)
    outcome = far(arch(0.2, inset=inset))
    rest, fall = fall_interval(outcome)
    assert 0.998 * line < rest < fall < 1.004 * line  # joints deform: thrusts grow without bound up to there
    # Its thrust grows without bound up to there, so no share is its answer.
    assert outcome.status == "undecided"
    assert outcome.upper is not None
    assert outcome.upper > 1.5 * outcome.curve[-3, 1]
    left, right = outcome.motion[:2]  # at the last rest: only hinges open
    assert left[2] < -0.3 < 0.3 < right[2]
    assert left[1] == pytest.approx(right[1], rel=1e-2)
    assert outcome.path[:, outcome.path_columns.index("at rest")].all()
    small = dem_dynamic(arch(0.2, inset=inset), 0.01)
    assert small.curve[-1] == pytest.approx([0.2, small.curve[0, 1]], rel=0.02)


def test_support_is_where_its_path_ends_although_blocks_turn() -> None:
    """Time steps depend on the contacts: with those of the beginning of each stage it fell short of that."""
    seen: list[Array] = []

    def observe(run: Run, state: State, share: float) -> None:
        seen.append(run.system.motion_of_blocks(state.motion)[-1])

    outcome = dem_dynamic(arch(0.04, inset=0.002), 0.01, displacements="finite", observe=observe)
    assert outcome.curve[-1, 0] == pytest.approx(0.04, rel=1e-9)
    assert seen[-1] == pytest.approx([0.04, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("spread", "falls"), [(0.09, False), (0.25, True)])
def test_lintel_falls_when_a_support_slides_from_under_it(spread: float, falls: bool) -> None:
    """It rests on 0.1 m at either end and moves along with one support until the other has slid out."""
    grounds = [rectangle(-0.5, -0.3, 0.6, 0.3), rectangle(0.9, -0.3, 0.6, 0.3)]
    outcome = far(on_two_grounds([rectangle(0.0, 0.0, 1.0, 0.2)], grounds, (spread, 0.0)))
    end = outcome.curve[-1, 0]
    assert 0.08 < end < 0.22 if falls else end == pytest.approx(spread)


def test_beam_on_three_supports_leaves_the_one_that_sinks() -> None:
    """The middle support sinks from under a block that spans a pit, and carries nothing."""
    grounds = [rectangle(-0.5, -0.5, 0.6, 0.5), rectangle(0.4, -0.5, 0.2, 0.5), rectangle(0.9, -0.5, 0.6, 0.5)]
    blocks = [rectangle(0.0, 0.0, 1.0, 0.2)]
    scene = build_scene(
        "three supports",
        blocks,
        thickness=0.2,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.6, elasticity=Stiffness(1e10, 1e10)),
        grounds=grounds,
        load=Load(live=(Settlement(box=((0.35, -1.0), (0.65, 0.1)), by=(0.0, -0.05)),)),
    )
    outcome = far(scene)
    assert outcome.status == "unbounded"
    assert "bears nothing" in outcome.message


def leaning(width: float, height: float, **joint: Any) -> Scene:
    """A block on ground that turns by 10° about a point below and beside it, and another block on fixed ground."""
    blocks = [rectangle(0.0, 0.0, 0.3, 0.1), rectangle(1.0, 0.0, width, height)]
    grounds = [rectangle(-0.2, -0.3, 0.7, 0.3), rectangle(0.8, -0.3, 0.7, 0.3)]
    turns = Settlement(box=((0.79, -2.0), (5.0, 2.0)), rotation_angle=-10.0, about=(0.9, -0.2))
    return replace(on_two_grounds(blocks, grounds, (0.1, 0.0), **joint), load=Load(live=(turns,)))


@pytest.mark.parametrize(
    ("model", "width", "friction", "tangent"),
    [
        (dem_dynamic, 0.06, 0.8, 0.12),
        (dem_dynamic, 0.4, 0.1, 0.1),
        *at_length((fem, 0.4, 0.1, 0.1), (fem, 0.06, 0.8, 0.12)),
    ],
)
def test_block_on_tilting_ground_topples_or_slides_at_the_exact_angle(
    model: Any, width: float, friction: float, tangent: float
) -> None:
    """At tan θ = b / h, or tan φ, between its last rest and its fall, at speeds at which these agree to 5 %."""
    outcome = model(leaning(width, 0.5, friction=friction), 0.05, displacements="finite")
    whole = 400 * outcome.curve[1, 0]  # the first of 20 stages, whose lengths grow linearly
    rest, fall = 10.0 * fall_interval(outcome) / whole
    exact = math.degrees(math.atan(tangent))  # of rigid joints; soft ones tip over .1 % earlier
    assert rest < exact < 1.002 * fall
    assert fall < 1.035 * rest


@pytest.mark.parametrize("angle", [-10.0, *at_length(10.0)])
def test_upright_block_alone_topples_on_its_ground_before_it_lands(angle: float) -> None:
    """At 8.13°; it lands after a descent of less than half its height, and lay at rest on its side as if it stood."""
    turns = Settlement(box=((-3.0, -3.0), (3.0, 1e-4)), rotation_angle=angle, about=(0.05, 0.0))
    scene = build_scene(
        "pillar",
        [rectangle(0.0, 0.0, 0.1, 0.7)],
        thickness=0.2,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.8, elasticity=Stiffness(2e10, 1e10)),
        grounds=[rectangle(-1.0, -0.5, 2.1, 0.5)],
        load=Load(live=(turns,)),
    )
    outcome = far(scene)
    assert outcome.status == "collapse"
    rest, fall = fall_interval(outcome) / (400 * outcome.curve[1, 0])
    assert rest < math.degrees(math.atan(1 / 7)) / 10 < fall < 1.004 * rest


@pytest.mark.long
@pytest.mark.parametrize("angle", [-6.84, -6.7])
def test_block_stands_on_ground_that_tilts_by_less_than_its_slope(angle: float) -> None:
    """Below 6.843°; the last of 20 stages shakes it so that it falls, and a fall counts only in a short one."""
    scene = leaning(0.06, 0.5, friction=0.8)
    turns = replace(scene.load.live[0], rotation_angle=angle)  # type: ignore[type-var]
    outcome = dem_dynamic(replace(scene, load=Load(live=(turns,))), 0.005, displacements="finite")
    assert "falls" not in outcome.message
    assert outcome.curve[-1, 0] == pytest.approx(400 * outcome.curve[1, 0])


@pytest.mark.long
def test_block_that_nearly_falls_returns_and_falls_later() -> None:
    """Tilted to 6.8°, back to 2°, and then beyond 6.843°: it tips over slowly, which must not count as a rest."""
    scene = leaning(0.06, 0.5, friction=0.8)
    turns = replace(scene.load.live[0], path=(0.68, 0.2, 0.7))  # type: ignore[type-var]
    outcome = dem_dynamic(replace(scene, load=Load(live=(turns,))), 0.05, displacements="finite")
    assert outcome.status == "collapse", outcome.message
    whole = 400 * outcome.curve[1, 0] / 0.68
    rest, fall = 10.0 * fall_interval(outcome) / whole
    assert rest < math.degrees(math.atan(0.12)) < fall < 1.01 * rest
    assert len(outcome.curve) > 60


def test_fall_that_the_budget_leaves_open_is_no_collapse() -> None:
    outcome = dem_dynamic(arch(0.2, inset=0.002), 0.05, displacements="finite", budget=2000)
    assert outcome.status == "undecided"
    assert "neither rested nor fell" in outcome.message


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_block_rotates_with_its_ground(model: Any) -> None:
    """Its centroid moves on an arc of 10° about the ground's centre; along a line it would go 0.5 % farther."""
    scene = leaning(0.2, 0.3)
    seen: list[Array] = []

    def observe(run: Run, state: State, share: float) -> None:
        seen.append(run.system.motion_of_blocks(state.motion))

    model(scene, 0.05, displacements="finite", observe=observe)
    arm, c, s = scene.blocks.centroid[1] - (0.9, -0.2), math.cos(math.radians(10)), math.sin(math.radians(10))
    gone = np.array([[c, s], [-s, c]]) @ arm - arm
    assert seen[-1][1, 2] == pytest.approx(-math.radians(10), rel=1e-4)
    assert seen[-1][1, :2] == pytest.approx(gone, rel=1e-4)


@pytest.mark.parametrize(("model", "order"), [(dem_dynamic, 1), *at_length((dem_dynamic, -1), (fem, 1), (fem, -1))])
def test_anchors_stay_fixed_while_supports_move(model: Any, order: int) -> None:
    """A block on the moving ground is tied to an anchor 2 m above: the tie stretches by √(4 + d²) − 2 m."""
    by, stiffness = (0.05 * order, 0.0), 1e9 * 1e-6 / 2.0
    grounds = [rectangle(-0.5, -0.3, 0.9, 0.3), rectangle(0.6, -0.3, 0.9, 0.3)][::order]
    beside = [rectangle(-0.2, 0.0, 0.5, 0.3), rectangle(0.7, 0.0, 0.5, 0.3)][::order]
    scene = build_scene(
        "anchor",
        beside,
        thickness=0.2,
        block=BlockMaterial(2000.0, young=1e12, poisson=0.2),
        joint=JointMaterial(0.8, elasticity=Stiffness(1e10, 1e10), inset=0.002),
        grounds=grounds,
        load=Load(live=(Settlement(box=((-0.6, -1.0), (0.5, 0.1)), by=by),)),
        ties=[Tie((0.0, 0.2), (0.0, 2.2), area=1e-6, young=1e9, yield_force=300.0)],
    )
    outcome = model(scene, 0.01, displacements="finite")
    stretched = math.hypot(2.0, 0.05) - 2.0
    assert outcome.path[-1, outcome.path_columns.index("tie 0 [N]")] == pytest.approx(stiffness * stretched, rel=0.02)


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_anchor_stays_fixed_while_all_ground_sinks(model: Any) -> None:
    """The tie above a block stretches by the settlement, and the block does not turn."""
    scene = build_scene(
        "anchor",
        [rectangle(-0.25, 0.0, 0.5, 0.3)],
        thickness=0.2,
        block=BlockMaterial(2000.0, young=1e12, poisson=0.2),
        joint=JointMaterial(0.8, elasticity=Stiffness(1e10, 1e10), inset=0.002),
        grounds=[rectangle(-0.5, -0.3, 1.0, 0.3)],
        load=Load(live=(Settlement(box=((-0.6, -1.0), (0.6, 0.1)), by=(0.0, -0.4)),)),
        ties=[Tie((0.0, 0.2), (0.0, 2.2), area=1e-6, young=1e9, yield_force=300.0)],
    )
    outcome = model(scene, 0.01, displacements="finite")
    pull = outcome.path[-1, outcome.path_columns.index("tie 0 [N]")]
    assert pull == pytest.approx(0.4 * 1e9 * 1e-6 / 2.0, rel=1e-3)


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_large_support_motion_is_reported_as_beyond_small_displacements(model: str) -> None:
    """50 mm of an arch of 0.4 m are, 5 mm are not; a model with finite displacements says how to use them."""
    far_off, near = (run_model(model, arch(spread)).message for spread in (0.05, 0.005))
    said = "the support goes by 12 % of the wall's smaller side, beyond small displacements"
    assert said in far_off
    assert ("finite ones follow it" in far_off) == (model == "dem-dynamic")
    assert "beyond" not in near


def crushed_bearing(strength: float, cap_shear: float) -> tuple[Scene, float]:
    """A lintel on pads of .3 m, of which the right one is pulled out: and how far until what is left of it crushes.

    Moments about the middle of the left pad's pressure, of which all .3 m bear, give the right pad's reaction R. It has
    the pressure R / (a t) on the length a left, and the cap is reached at p (1 + C tan² φ)^½ = f as the pad slides.
    """
    energy = 1.02 * strength**2 / 1e9  # barely more than what is stored at the peak: the joint breaks at once
    joint = {"friction": 0.6, "elasticity": Stiffness(1e9, 5e8), "cap_shear": cap_shear}
    scene = on_two_grounds(
        [rectangle(0, 0, 2, 0.3)],
        [rectangle(-0.2, -0.5, 0.5, 0.5), rectangle(1.7, -0.5, 0.5, 0.5)],
        (0.3, 0.0),
        compressive_strength=strength,
        compressive_fracture_energy=energy,
        **joint,
    )
    weight, pressure = 2000.0 * 9.81 * 2 * 0.3 * 0.2, strength / math.hypot(1.0, 0.6 * math.sqrt(cap_shear))

    def excess(moved: float) -> float:
        left = 0.3 - moved
        return weight * 0.85 / (0.85 + 0.85 + moved / 2) - pressure * left * 0.2

    return scene, float(brentq(excess, 0.0, 0.3))


@pytest.mark.parametrize(
    ("model", "strength", "cap_shear"),
    [
        (dem_dynamic, 4e4, 0.0),
        *at_length((dem_dynamic, 8e4, 0.0), (dem_dynamic, 8e4, 9.0)),
        *at_length((fem, 4e4, 0.0), (fem, 8e4, 0.0), (fem, 8e4, 9.0)),
    ],
)
def test_bearing_crushes_once_too_little_of_it_is_left(model: Any, strength: float, cap_shear: float) -> None:
    """The fall is within 8 mm of the exact place: contacts are found again every 6 mm, and pressures are not all alike.

    With the area of the undeformed joint the lintel would lie on the pad to its end.
    """
    scene, exact = crushed_bearing(strength, cap_shear)
    rest, fall = fall_interval(far(scene, model))
    assert 0.05 < exact < 0.25
    assert rest - 8e-3 < exact < fall + 8e-3
