"""Material points of rotating blocks: ties between them and dead forces at them, at large rotations."""

import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import pytest
from scipy.optimize import brentq

from dem.dynamic import dem_dynamic
from dem.finite_system import finite_system
from fem_interface.finite_system import finite_system as deformable_system
from fem_interface.model import fem
from fem_interface.node_outline import node_outline
from runningbond.dynamics import BlockSystem, State
from runningbond.dynamics.contact_update import MOST_STEPS, ContactUpdate, contacts_of
from runningbond.dynamics.ties import TieRows, pull
from runningbond.dynamics.turning_loads import turn_live, turn_loads, work_of_turned
from runningbond.scene import Array, Scene
from tests.at_length import at_length
from tests.dynamics.test_led import block

Blocks: TypeAlias = Callable[[Scene], BlockSystem]

TIES = [
    {"from": [0.05, 0.05], "to": [-0.4, 0.6], "area": 1e-4, "young": 1e9, "yield": 1e12, "preload": 300.0},
    {"from": [0.2, 0.02], "to": [0.1, -0.2], "area": 2e-4, "young": 1e9, "yield": 1e12},
]


def rigid(scene: Scene) -> BlockSystem:
    return finite_system(scene)


def deformable(scene: Scene) -> BlockSystem:
    return deformable_system(node_outline(scene, 2))


def turned(system: BlockSystem, seed: int) -> Array:
    """Random motion with large displacements and rotations of the block and small deformations."""
    motion = np.random.default_rng(seed).normal(0.0, 1.0, len(system.mass))
    motion[np.isin(np.arange(len(motion)), system.rigid, invert=True)] *= 1e-2
    motion[np.isinf(system.mass)] = 0.0
    return motion


def is_gradient(force: Array, energy: Callable[[Array], float], motion: Array, moving: Array) -> None:
    """Assert that the forces on the moving coordinates are the gradient of an energy, by central differences."""
    step = 1e-6
    slope = [(energy(motion + step * way) - energy(motion - step * way)) / (2 * step) for way in np.eye(len(motion))]
    np.testing.assert_allclose(force[moving], np.array(slope)[moving], rtol=1e-6, atol=1e-6 * np.abs(force).max())


@pytest.mark.parametrize("blocks", [rigid, deformable])
@pytest.mark.parametrize("seed", range(4))
def test_tie_forces_are_gradient_of_tie_energy(blocks: Blocks, seed: int) -> None:
    """F = −∂/∂q Σ (T² − P²) / 2 k for taut ties, at rotations of the order of one radian."""
    system = blocks(block(tie=TIES))
    motion, stretch = turned(system, seed), np.zeros(2)
    force = np.zeros_like(motion)
    pull((*system.ties[:4], system.ties.ends.arrays, system.ties.length, stretch), motion, force)
    assert np.abs(force).max() > 1e4
    is_gradient(force, lambda at: -system.ties.stored(system.ties.force(at, stretch)), motion, np.isfinite(system.mass))


@pytest.mark.parametrize("blocks", [rigid, deformable])
@pytest.mark.parametrize("seed", range(4))
def test_generalized_dead_forces_are_gradient_of_their_work(blocks: Blocks, seed: int) -> None:
    """The generalized forces are the gradient of Σ F · x, with points x that rotate and deform with the block."""
    at, forces = np.array([[0.05, 0.06], [0.2, 0.03]]), np.array([[300.0, -400.0], [-50.0, 200.0]])
    loads = [{"kind": "point", "at": p.tolist(), "force": f.tolist()} for p, f in zip(at, forces, strict=True)]
    scene = block(load__dead=loads)
    system, weight = blocks(scene), 9.81 * scene.mass[0]
    motion, force, turning = turned(system, seed), system.dead.copy(), system.turning_dead
    assert turning is not None
    turn_loads((turning.points.arrays, *turning[1:]), motion, force)
    np.testing.assert_allclose(turning.points.places(np.zeros_like(motion)), at, rtol=1e-12)

    def work(place: Array) -> float:
        height = place[system.rigid[0, 1]]
        return float((turning.force * turning.points.places(place)).sum() - weight * height)

    is_gradient(force, work, motion, np.isfinite(system.mass))


@pytest.mark.parametrize("blocks", [rigid, deformable])
def test_work_of_turned_dead_forces_is_that_of_their_change(blocks: Blocks) -> None:
    """W = Δt v · (f − f₀), for rotations and deformations alike."""
    system = blocks(block(load__dead=[{"kind": "point", "at": [0.05, 0.06], "force": [300.0, -400.0]}]))
    turning, change = system.turning_dead, np.zeros(len(system.mass))
    assert turning is not None
    arrays = (turning.points.arrays, *turning[1:])
    turn_loads(arrays, turned(system, 0), change)
    velocity = turned(system, 1)
    assert work_of_turned(arrays, velocity, 1e-3) == pytest.approx(1e-3 * float(change @ velocity))


@pytest.mark.parametrize("blocks", [rigid, deformable])
def test_finite_tie_elongation_tends_to_linear_one(blocks: Blocks) -> None:
    """The elongations at finite and at small displacements differ only by a term quadratic in the motion."""
    system = blocks(block(tie=TIES))
    way, small = turned(system, 0), TieRows(*system.ties[:4])
    errors = [np.abs(system.ties.elongation(h * way) - small.elongation(h * way)).max() for h in (1e-3, 1e-4)]
    assert errors[1] == pytest.approx(1e-2 * errors[0], rel=0.01)
    assert errors[0] < 1e-4


@pytest.mark.parametrize(
    ("model", "young", "most"),
    [(dem_dynamic, 2.1e11, 5.0), (dem_dynamic, 1e8, 1e9), (fem, 1e8, 1e9), *at_length((fem, 2.1e11, 5.0))],
)
def test_block_toppling_against_tie_follows_moment_balance_about_toe(model: Any, young: float, most: float) -> None:
    """λ W (height of centroid) = W (arm) + T (arm), with the tie at its current angle, yielded or elastic: to 1e-4.

    The corner above the toe moves by 20 mm; λ goes from .57 to .49 if the tie yields and to .43 if it stays elastic.
    """
    b, h, far = 0.06, 0.24, 0.5
    tie = {"from": [0.0, h], "to": [-far, h], "area": 1e-6, "young": young, "yield": most}
    scene = block(b, h, tie=[tie])
    weight, stiffness = 9.81 * scene.mass[0], scene.ties.stiffness[0]

    def turned_by(angle: float) -> tuple[float, float]:
        """Displacement of the corner above the toe, and λ."""
        c, s = math.cos(angle), math.sin(angle)
        about = np.array([[c, s], [-s, c]])
        middle, end = about @ [-b / 2, h / 2], about @ [-b, h]
        span = np.array([-far - b, h]) - end
        length = math.hypot(*span)
        pull = min(max(stiffness * (length - far), 0.0), most) * span / length
        moment = end[0] * pull[1] - end[1] * pull[0] - weight * middle[0]
        return float((about @ [0.0, h])[0]), float(moment / (weight * middle[1]))

    curve = model(scene, displacements="finite", distance=0.02, budget=300_000).curve
    # after the push has accelerated, excluding the peak, which lies within a row
    followed = [(at, multiplier) for at, multiplier in curve.tolist() if 0.012 < at < 0.0195]
    assert len(followed) > 20
    for at, multiplier in followed:
        angle = brentq(lambda angle, at=at: turned_by(angle)[0] - at, 0.0, 0.5)
        assert multiplier == pytest.approx(turned_by(angle)[1], rel=1e-4)


@pytest.mark.parametrize("blocks", [rigid, deformable])
@pytest.mark.parametrize("seed", range(4))
def test_tie_frequency_bound_holds_at_large_rotations(blocks: Blocks, seed: int) -> None:
    """ω² of ties strained by 4 %, from differences of their forces, is below the bound at any rotation."""
    system = blocks(block(tie=TIES))
    motion, moving = turned(system, seed), np.isfinite(system.mass)
    stretch = system.ties.elongation(motion) - 0.04 * system.ties.length

    def forces(place: Array) -> Array:
        force = np.zeros_like(place)
        pull((*system.ties[:4], system.ties.ends.arrays, system.ties.length, stretch), place, force)
        return force[moving]

    step, ways = 1e-7, np.eye(len(motion))[moving]
    stiffness = [(forces(motion - step * way) - forces(motion + step * way)) / (2 * step) for way in ways]
    root = np.sqrt(system.mass[moving])
    own = float(np.linalg.eigvalsh(np.array(stiffness) / root / root[:, None])[-1])
    alone = 1e-9 * own  # joints of negligible stiffness
    assert own <= system.ties.frequency_squared(alone, system.mass) * (1 + 1e-6)
    assert system.ties.frequency_squared(alone, system.mass) < 8 * own


@pytest.mark.parametrize("seed", range(4))
def test_tie_acceleration_bound_holds_for_block_corners(seed: int) -> None:
    """Contact detection relies on this bound at any rotation; at rest it is at most three times too large."""
    scene = block(tie=TIES)
    system = finite_system(scene)
    reach = np.hypot(*(scene.blocks.vertices[:4] - scene.blocks.centroid[0]).T).max()
    most = system.ties.accelerations(system.mass, np.array([reach, reach]))
    for motion, least in ((turned(system, seed), 0.0), (np.zeros_like(system.mass), 1 / 3)):
        force, stretch = np.zeros_like(motion), system.ties.elongation(motion) - 1e-3
        pull((*system.ties[:4], system.ties.ends.arrays, system.ties.length, stretch), motion, force)
        drawn = force[:3] / system.mass[:3]
        fastest = math.hypot(drawn[0], drawn[1]) + abs(drawn[2]) * reach
        allowed = float(most @ system.ties.force(motion, stretch))
        assert least * allowed <= fastest <= allowed


def test_contacts_are_searched_before_taut_ties_draw_blocks_beyond_the_margin() -> None:
    """From rest, without loads: ½ a t² with the acceleration by the ties is at most half the margin."""
    system = finite_system(block(tie=TIES))
    assert system.contacts is not None
    state, dt = State.at_rest(system), 1e-4
    state.stretch -= 1e-3
    reach = system.contacts.outline.reach
    drawn = float(system.ties.accelerations(system.mass, reach) @ system.ties.force(state.motion, state.stretch))
    steps = ContactUpdate(system, system.contacts).steps_until_next_look(state, dt, 0.0)
    assert steps < MOST_STEPS
    assert drawn * (steps * dt) ** 2 / 2 <= contacts_of(state).margin / 2


@pytest.mark.parametrize("blocks", [rigid, deformable])
@pytest.mark.parametrize("seed", range(4))
def test_generalized_live_forces_are_gradient_of_their_work(blocks: Blocks, seed: int) -> None:
    """As for dead forces, plus a couple, whose moment does not depend on the rotation; updated in every step."""
    at, forces = np.array([[0.05, 0.06], [0.2, 0.03]]), np.array([[300.0, -400.0], [-50.0, 200.0]])
    loads = [{"kind": "point", "at": p.tolist(), "force": f.tolist()} for p, f in zip(at, forces, strict=True)]
    loads.append({"kind": "moment", "at": [0.12, 0.03], "moment": 20.0})
    system = blocks(block(load__live=loads))
    live, pushing = system.live.copy(), system.turning_live
    assert pushing is not None
    for motion in (turned(system, seed + 10), turned(system, seed)):
        turn_live((pushing.points.arrays, *pushing[1:]), motion, live)

    def work(place: Array) -> float:
        rest = 20.0 * place[system.rigid[0, 2]]
        return float((pushing.force * pushing.points.places(place)).sum() + rest) if pushing else 0.0

    is_gradient(live, work, motion, np.isfinite(system.mass))
