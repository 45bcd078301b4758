"""Natural vibrations of stacked blocks compared with closed forms."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from dem.dynamic import dem_vibration
from dem.rigid_system import contact_points, rigid_system
from fem_interface.model import fem_vibration
from runningbond.dynamics import Criteria, Run, put_on_dead_load
from runningbond.response import Vibration
from runningbond.response.vibration import vibration
from runningbond.scene import Array, Closure, JointMaterial, Scene, SceneError, Stiffness, scene_from_dict
from runningbond.studies.walls import boxes
from tests.walls import content

THICKNESS, DENSITY = 0.12, 1800.0


def stack(n: int, width: float, height: float, normal: float, shear: float, **changes: object) -> Scene:
    """A stack of `n` blocks, compressed by their weight."""
    size = {"wall__length": None, "wall__height": None, "wall__courses": [[1]] * n}
    block = {"wall__block_width": width, "wall__block_height": height}
    scene = scene_from_dict(content(**size, **block, **changes))
    return scene.with_joint(elasticity=Stiffness(normal, shear))


def swaying(found: Vibration) -> list[float]:
    """Frequencies of modes that move the wall sideways [Hz]."""
    return [f for f, share in zip(found.frequency, found.share, strict=True) if share[0] > 10 * share[1]]


def test_shear_column_has_its_closed_form_frequencies() -> None:
    """N flat blocks on N joints with low shear stiffness: ω_j = 2 √(k/m) sin((2 j − 1) π / (2 (2 N + 1)))."""
    n, width, height, shear = 8, 1.0, 0.05, 1e6
    found = swaying(dem_vibration(stack(n, width, height, 1e10, shear), 24))
    mass, spring = DENSITY * THICKNESS * width * height, shear * THICKNESS * width
    j = np.arange(1, n + 1)
    exact = 2 * math.sqrt(spring / mass) * np.sin((2 * j - 1) * np.pi / (2 * (2 * n + 1))) / (2 * np.pi)
    assert found[:4] == pytest.approx(exact[:4], rel=1e-3)


@pytest.mark.parametrize("count", [0, -1, 1.5, "all"])
@pytest.mark.parametrize("vibrate", [dem_vibration, fem_vibration])
def test_invalid_number_of_vibrations_is_refused(vibrate: Any, count: Any) -> None:
    with pytest.raises(SceneError, match="count = .*: must be a whole number, at least 1"):
        vibrate(stack(2, 0.4, 0.2, 1e9, 1e9, block__young=1e10), count)


def test_modal_masses_add_up_to_the_whole_mass() -> None:
    found = dem_vibration(stack(3, 0.4, 0.2, 1e9, 1e9), 9)
    assert found.loose == 0
    assert found.share.sum(axis=0) == pytest.approx([1.0, 1.0], rel=1e-9)


def test_unloaded_grains_do_not_change_the_vibrations_of_a_stack() -> None:
    """90 grains of 2 µm with pressure below `PRESSED`: 270 loose motions, all slower than those of the stack."""
    tower = [(0.0, float(k), 0.5, 1.0) for k in range(4)]
    grains = [(1.0 + 0.001 * k, 0.0, 2e-6, 2e-6) for k in range(90)]
    joint = JointMaterial(0.6, elasticity=Stiffness(1e9, 4e8))
    alone, beside = (dem_vibration(boxes(*tower, *some, joint=joint), 5) for some in ([], grains))
    assert (alone.loose, beside.loose) == (0, 270)
    assert beside.frequency == pytest.approx(alone.frequency, rel=1e-6)


def timoshenko(length: float, depth: float, stiff: tuple[float, float], number: int) -> float:
    """Natural frequency [Hz] of a cantilever with EI and κGA, rotary inertia included (Timoshenko 1922; Huang 1961)."""
    bending, shear = stiff
    mass, inertia = DENSITY * THICKNESS * depth, DENSITY * THICKNESS * depth**3 / 12

    def determinant(omega: float) -> float:
        # Solutions e^(s x) of w and ψ: from κGA (w'' − ψ') + m ω² w = 0, EI ψ'' + κGA (w' − ψ) + ρI ω² ψ = 0.
        a, b = mass * omega**2 / shear, inertia * omega**2 / bending
        roots = np.roots([1.0, 0.0, a + b, 0.0, a * b - mass * omega**2 / bending]).astype(complex)
        ratio = (roots**2 + a) / roots  # ψ = ratio w
        at_end = np.exp(roots * length)
        rows = [np.ones(4), ratio, ratio * roots * at_end, (roots - ratio) * at_end]
        value = np.linalg.det(np.array(rows)) / np.prod(np.exp(np.abs(roots.real) * length / 2))
        order = np.array(np.sort_complex(roots))
        return float((value / np.prod([y - x for k, x in enumerate(order) for y in order[k + 1 :]])).real)

    guess = [1.875104, 4.694091][number] ** 2 / length**2 * math.sqrt(bending / mass)
    grid = np.linspace(0.2 * guess, 1.1 * guess, 60)
    values = [determinant(omega) for omega in grid]
    at = max(k for k in range(59) if values[k] * values[k + 1] < 0)
    return float(brentq(determinant, grid[at], grid[at + 1])) / (2 * math.pi)


@pytest.mark.parametrize("number", [0, 1])
def test_stack_of_rigid_blocks_vibrates_as_a_timoshenko_cantilever(number: int) -> None:
    """Rigid blocks on compliant joints: the two points of a joint have EI = k_n t b³ / 4 · a."""
    n, width, height, k = 64, 0.4, 0.03125, 1e10
    found = swaying(dem_vibration(stack(n, width, height, k, 0.4 * k), 8))
    bending, shear = k * THICKNESS * width**3 / 4 * height, 0.4 * k * THICKNESS * width * height
    assert found[number] == pytest.approx(timoshenko(n * height, width, (bending, shear), number), rel=0.02)


@pytest.mark.long
def test_deformable_blocks_on_stiff_joints_vibrate_as_a_timoshenko_cantilever() -> None:
    """E b³ t / 12 and κ = 5/6, in plane stress; triangular cells lock slightly."""
    n, width, height, young = 10, 0.4, 0.2, 1e9
    scene = stack(n, width, height, 1e12, 1e12, block__young=young, block__poisson=0.0)
    found = swaying(fem_vibration(scene, 4, cells=3, modes="all"))
    stiff = (young * THICKNESS * width**3 / 12, 5 / 6 * young / 2 * THICKNESS * width)
    assert found[0] == pytest.approx(timoshenko(n * height, width, stiff, 0), rel=0.02)


@pytest.mark.parametrize("growth", [1e5, 1e7])
def test_closing_joint_has_the_stiffness_at_its_pressure(growth: float) -> None:
    """A block with k = k_n + g p up to k_∞ bounces at √(k A / m); p = m g / A is the pressure by its weight."""
    width, height, first, last = 0.4, 0.2, 1e8, 5e9
    scene = stack(1, width, height, first, first)
    scene = scene.with_joint(closure=Closure(growth, last))
    found = dem_vibration(scene, 3)
    bounce = next(f for f, share in zip(found.frequency, found.share, strict=True) if share[1] > 0.5)
    area, mass = width * THICKNESS, DENSITY * width * height * THICKNESS
    stiffness = min(first + growth * mass * 9.81 / area, last)
    assert stiffness > 3 * first
    assert bounce == pytest.approx(math.sqrt(stiffness * area / mass) / (2 * math.pi), rel=1e-6)


@pytest.mark.parametrize("others", [0, 1])
def test_taut_tie_is_a_spring_and_slack_tie_is_not(others: int) -> None:
    """A rod holds a block sideways; a second rod without preload is slackened by the first and adds nothing."""
    width, height, shear, rod = 0.4, 0.2, 1e6, 4e4
    tie = {"from": [width, height / 2], "to": [width + 1.0, height / 2], "area": 1e-4, "young": rod / 1e-4}
    ties = [tie | {"yield": 1e5, "preload": preload} for preload in (10.0, *[0.0] * others)]
    slowest = swaying(dem_vibration(stack(1, width, height, 1e11, shear, tie=ties), 3))[0]
    mass, spring = DENSITY * width * height * THICKNESS, shear * width * THICKNESS + rod
    assert slowest == pytest.approx(math.sqrt(spring / mass) / (2 * math.pi), rel=1e-3)


@pytest.mark.parametrize(("way", "rod"), [(2.0e-4, 4e4), (3.0e-4, 0.0)])
def test_yielding_tie_is_no_spring(way: float, rod: float) -> None:
    """A rod of 4e4 N/m with a yield force of 10 N, stretched elastically to 8 N and beyond yield (12 N)."""
    width, height, shear = 0.4, 0.2, 1e6
    tie = {"from": [width, height / 2], "to": [width + 1.0, height / 2], "area": 1e-4, "young": 4e8, "yield": 10.0}
    run = Run(rigid_system(stack(1, width, height, 1e11, shear, tie=[tie])))
    state = put_on_dead_load(run, Criteria(collapse=np.array([0.1]))).state
    state.motion[run.system.rigid[0, 0]] -= way
    mass, spring = DENSITY * width * height * THICKNESS, shear * width * THICKNESS + rod
    found = swaying(vibration(run, state, 3))[0]
    assert found == pytest.approx(math.sqrt(spring / mass) / (2 * math.pi), rel=1e-3)


def test_walls_that_fall_or_are_not_compressed_do_not_vibrate() -> None:
    with pytest.raises(SceneError, match="does not come to rest under its dead load"):
        dem_vibration(stack(2, 0.1, 0.2, 1e9, 4e8, load__gravity=[9.0, -3.0]), 3)
    hung = {"from": [0.2, 0.2], "to": [0.2, 1.2], "area": 1e-4, "young": 2e11, "yield": 1e4, "preload": 400.0}
    with pytest.raises(SceneError, match="closes no joint: a wall that is not pressed together does not vibrate"):
        dem_vibration(stack(1, 0.4, 0.2, 1e9, 4e8, tie=[hung]), 3)


def test_beam_vibrates_with_its_own_mass() -> None:
    """Like a course of equal mass; the beam once had the mass of masonry of its size instead."""
    beam = {"height": 0.05, "mass": 2.0}
    under = dem_vibration(stack(2, 0.4, 0.2, 1e9, 4e8, beam=beam), 9)
    heights = {"wall__block_height": None, "wall__course_heights": [0.2, 0.2, 0.05]}
    light = {
        "materials": {"light": {"density": 2.0 / (THICKNESS * 0.4 * 0.05)}},
        "assign": [{"block": "light", "blocks": [2]}],
    }
    over = scene_from_dict(
        content(
            wall__length=None,
            wall__height=None,
            wall__courses=[[1]] * 3,
            wall__block_width=0.4,
            **heights,
            **light,
        )
    ).with_joint(elasticity=Stiffness(1e9, 4e8))
    assert under.frequency == pytest.approx(dem_vibration(over, 9).frequency, rel=1e-6)


STIFF = Stiffness(1e9, 4e8)


def frequencies(scene: Scene, count: int, springs: Array) -> Array:
    """Natural frequencies [Hz] of rigid blocks on normal and shear springs ``(np, 2)`` [Pa/m] at joint points."""
    points, blocks, mass = contact_points(scene), scene.blocks, scene.density * scene.thickness
    stiffness = np.zeros((3 * len(blocks), 3 * len(blocks)))
    for k, (block, at, area) in enumerate(zip(points.block, points.position, points.area, strict=True)):
        for direction, spring in zip((points.normal[k], points.tangent[k]), springs[k], strict=True):
            row = np.zeros(3 * len(blocks))
            for body, sense in zip(block, (-1.0, 1.0), strict=True):
                arm = at - blocks.centroid[body]
                turn = direction[1] * arm[0] - direction[0] * arm[1]
                row[3 * body : 3 * body + 3] = sense * np.array([*direction, turn])
            stiffness += area * spring * np.outer(row, row)
    inertia = np.repeat(mass * blocks.area, 3)
    inertia[2::3] = mass * blocks.polar_moment
    free = np.flatnonzero(np.repeat(~scene.fixed, 3))
    square = eigh(stiffness[np.ix_(free, free)], np.diag(inertia[free]), eigvals_only=True)
    return np.asarray(np.sqrt(square[:count]) / (2 * np.pi))


@pytest.mark.parametrize("density", [1800.0, 1800.001, 1801.0])
def test_unloaded_joints_are_no_springs(density: float) -> None:
    """Head joints of a dry wall carry only rounding errors: the frequencies are those of blocks on bed joints alone."""
    scene = scene_from_dict(content(block__density=density)).with_joint(elasticity=STIFF)
    beds = np.abs(contact_points(scene).normal[:, 1]) > 0.5
    own = frequencies(scene, 6, beds[:, None] * np.array([1e9, 4e8]))
    assert dem_vibration(scene, 6).frequency == pytest.approx(own, rel=1e-6)


def test_beam_of_fixed_height_only_moves_sideways() -> None:
    """It has one degree of freedom, and the blocks below vibrate beneath a ceiling."""
    beam = {"height": 0.1, "mass": 3.0, "condition": "fixed-height", "force": [0, -1e3]}
    found = dem_vibration(stack(2, 0.4, 0.2, 1e9, 4e8, beam=beam), 9)
    assert len(found.frequency) == 7
    assert found.shape[:, -1, 1:] == pytest.approx(0.0, abs=1e-12)
    # Vertically, two masses on three springs between the ground and the ceiling.
    springs, mass = 1e9 * 0.4 * THICKNESS, DENSITY * 0.4 * 0.2 * THICKNESS
    upright = [f for f, share in zip(found.frequency, found.share, strict=True) if share[1] > 10 * share[0]]
    assert upright[0] == pytest.approx(math.sqrt(springs / mass) / (2 * math.pi), rel=1e-6)


def test_softened_joint_has_its_secant_stiffness() -> None:
    """A block leans on partly cracked mortar: each open point has the stiffness traction over opening."""
    glue = {"cohesion": 6e4, "tensile_strength": 3e4, "fracture_energy_1": 30.0, "fracture_energy_2": 300.0}
    push = {"kind": "point", "at": [0.0, 1.2], "force": [200.0, 0.0]}
    scene = stack(1, 0.4, 1.2, 1e9, 4e8, joint={"friction": 0.6, **glue}, load__dead=[push])
    run = Run(rigid_system(scene))
    state = put_on_dead_load(run, Criteria(collapse=np.array([0.1]))).state
    opening, _, normal, _ = run.tractions(state)
    assert run.interface.law.damage(state.history).max() > 0.01
    secant = np.where(opening > 0, normal / opening, 1e9)
    own = frequencies(scene, 3, np.column_stack([secant, np.full(len(secant), 4e8)]))
    found = dem_vibration(scene, 3).frequency
    assert found == pytest.approx(own, rel=1e-6)
    assert found[0] < 0.95 * frequencies(scene, 3, np.tile([1e9, 4e8], (len(secant), 1)))[0]


def test_fully_cracked_open_joint_has_no_stiffness() -> None:
    """A block is pushed until little more than its toe is compressed; cracked open points have no stiffness."""
    glue = {"cohesion": 600.0, "tensile_strength": 300.0, "fracture_energy_1": 1e-4, "fracture_energy_2": 1e-3}
    push = {"kind": "point", "at": [0.0, 1.2], "force": [155.0, 0.0]}
    scene = stack(1, 0.4, 1.2, 1e9, 4e8, joint={"friction": 0.6, **glue}, load__dead=[push])
    run = Run(rigid_system(scene))
    state = put_on_dead_load(run, Criteria(collapse=np.array([0.1]))).state
    opening, _, normal, _ = run.tractions(state)
    torn = (run.interface.law.damage(state.history) >= 1) & (opening > 0)
    assert torn.any()
    assert (normal[~torn] < 0).all()
    own = frequencies(scene, 3, np.where(torn[:, None], 0.0, [1e9, 4e8]))
    assert dem_vibration(scene, 3).frequency == pytest.approx(own, rel=1e-6)


def test_equal_stacks_have_multiple_frequencies() -> None:
    """Thirty stacks of four blocks, 360 motions: a Lanczos method finds one of equal modes and stops early."""
    joint = JointMaterial(0.6, elasticity=Stiffness(1e9, 4e8))
    stack = [(0.0, float(k), 0.5, 1.0) for k in range(4)]
    stacks = [(x + 2.0 * number, *box) for number in range(30) for x, *box in stack]
    alone, beside = (dem_vibration(boxes(*some, joint=joint), count) for some, count in ((stack, 2), (stacks, 60)))
    assert beside.frequency == pytest.approx(np.repeat(alone.frequency, 30), rel=1e-9)
    assert np.linalg.matrix_rank(beside.shape.reshape(60, -1)) == 60
