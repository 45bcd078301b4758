"""A rocking block compared with Housner's, and a sliding block with Newmark's."""

import math
from dataclasses import replace
from functools import cache
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from dem.finite_system import finite_system
from runningbond.dynamics import Run, State
from runningbond.joints import impact_note, lobatto
from runningbond.joints.wall_law import with_impacts
from runningbond.response import Resting, follow
from runningbond.response.resting import VISCOUS
from runningbond.scene import ANCHOR, Array, History, PointLoad, Scene, Ties
from runningbond.scene.history import pulse
from tests.at_length import at_length

from ..walls import panel
from .housner import GRAVITY, HousnerBlock
from .spring_bed import peak
from .walls import block, resting, shaken, still

BLOCK = HousnerBlock()
FOLLOW = import_module("runningbond.response.follow")


@cache
def rocking(share: float) -> tuple[Array, float]:
    """Times of three passages through θ = 0, the two turning points between in α, and the energy error.

    The block is released about its right corner at a share of the angle at which it would overturn.
    """
    system = finite_system(with_impacts(block(BLOCK.b, BLOCK.h, still())))
    angle = -share * BLOCK.alpha
    motion, arm = np.zeros(len(system.mass)), np.array([-BLOCK.b, BLOCK.h])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    motion[:3] = *(turn @ arm - arm), angle
    run, state = Run(system, local=0.0, viscous=VISCOUS), State.at_rest(system, motion)
    rows, passed = [(0.0, angle)], 0
    while passed < 3:
        run.bear(state, system.dead, 10)
        rows.append((state.time, state.motion[2]))
        passed += rows[-1][1] * rows[-2][1] < 0
    time, theta = np.array(rows).T
    at = np.flatnonzero(np.diff(np.sign(theta)))
    passages = time[at] - theta[at] * (time[at + 1] - time[at]) / (theta[at + 1] - theta[at])
    turns = [np.abs(theta[i:j]).max() / BLOCK.alpha for i, j in pairwise(at)]
    return np.array([*passages, *turns]), run.unaccounted(state, float(system.mass[1]) * GRAVITY * 0.01)


def quarter(share: float) -> float:
    """Time from rest at a share of α to θ = 0, from the energy, without small angles."""
    alpha, start = BLOCK.alpha, share * BLOCK.alpha

    def rate(u: float) -> float:  # θ = θ0 (1 − u²) removes the singularity at the turning point
        theta = start * (1 - u * u)
        return 2 * start * u / math.sqrt(2 * BLOCK.p**2 * (math.cos(alpha - start) - math.cos(alpha - theta)))

    return float(quad(rate, 0, 1)[0])


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_free_rocking_has_housners_period(share: float) -> None:
    """Quarter period from release to θ = 0, to 1e-3; for slender blocks arccosh(1 / (1 − θ0/α)) / p."""
    found, _ = rocking(share)
    assert found[0] == pytest.approx(quarter(share), rel=1e-3)
    assert found[0] == pytest.approx(math.acosh(1 / (1 - share)) / BLOCK.p, rel=0.01)


def quarter_of(scene: Scene, start: float) -> tuple[float, float]:
    """Time [s] from release about the right corner at a negative angle to θ = 0, and the relative energy error."""
    system = finite_system(with_impacts(scene))
    motion, arm = np.zeros(len(system.mass)), np.array([-BLOCK.b, BLOCK.h])
    turn = np.array([[math.cos(start), -math.sin(start)], [math.sin(start), math.cos(start)]])
    motion[:3] = *(turn @ arm - arm), start
    run, state = Run(system, local=0.0, viscous=VISCOUS), State.at_rest(system, motion)
    stiffness, most, _ = system.ties.constants.T
    state.stretch[:] = np.maximum(system.ties.elongation(motion) - most / stiffness, 0.0)
    given = -run.ledger(state).residual
    while state.motion[2] < 0:
        run.bear(state, system.dead, 10)
    after = state.motion[2] / state.velocity[2]
    missed = run.ledger(state, system.dead).residual + given
    return state.time - after, abs(missed) / (run.dead_work(state) + given)


def test_dead_load_on_top_moves_with_a_rocking_block() -> None:
    """Quarter period from the energy, I θ'² / 2 = W (height of the middle) + P (height of its point), to 1e-3.

    Released about the right corner at half the angle at which its weight W alone would overturn it, with P = W / 4
    above that corner and W / 2 above the other one, which acts as a restoring load for longer.
    """
    b, h, start = BLOCK.b, BLOCK.h, -BLOCK.alpha / 2
    bare = block(b, h, still())
    weight = float(bare.mass[0]) * GRAVITY
    loads = tuple(PointLoad((x, 2 * h), (0.0, -share * weight)) for x, share in ((0.0, 0.5), (2 * b, 0.25)))
    found, missed = quarter_of(replace(bare, load=replace(bare.load, dead=loads)), start)

    def height(theta: float) -> float:  # of the loads, in weights; points at (-x, y) from the corner
        points = ((1.0, b, h), (0.5, 2 * b, 2 * h), (0.25, 0.0, 2 * h))
        return sum(share * (y * math.cos(theta) + x * math.sin(theta)) for share, x, y in points)

    def rate(u: float) -> float:  # θ = θ0 (1 − u²) removes the singularity at the turning point
        theta = -start * (1 - u * u)
        inertia = 4 / 3 * (b * b + h * h)
        return -start * 2 * u / math.sqrt(2 * GRAVITY * (height(-start) - height(theta)) / inertia)

    assert found == pytest.approx(float(quad(rate, 0, 1)[0]), rel=1e-3)
    assert missed < 5e-3


@pytest.mark.parametrize("yields", [1e9, 0.5])
def test_tie_at_the_top_restores_a_rocking_block(yields: float) -> None:
    """Quarter period from the energy, I θ'² / 2 = W (height of the middle) + (energy of the tie), to 1e-3.

    Released about the right corner at half the overturning angle, with a tie from its upper left corner to an anchor as
    far to the left as the block is high. The force of an elastic tie is W / 2 there; a tie with half that yield force
    starts with the corresponding plastic elongation and goes slack on the way back.
    """
    b, h, start = BLOCK.b, BLOCK.h, BLOCK.alpha / 2
    bare = block(b, h, still())
    weight = float(bare.mass[0]) * GRAVITY

    def elongation(theta: float) -> float:
        x = 2 * b - 2 * b * math.cos(theta) + 2 * h * math.sin(theta)
        y = 2 * b * math.sin(theta) + 2 * h * math.cos(theta)
        return math.hypot(x + 2 * h, y - 2 * h) - 2 * h

    stiffness = weight / 2 / elongation(start)
    most = min(weight / 2, yields * weight / 2)
    ends = np.array([[[0.0, 2 * h], [-2 * h, 2 * h]]])
    numbers = np.array([[stiffness * 2 * h], [1.0], [yields * weight / 2], [0.0]])
    tied = replace(bare, ties=Ties(np.array([[0, ANCHOR]]), ends, *numbers))
    found, missed = quarter_of(tied, -start)

    def energy(theta: float) -> float:
        tension = max(0.0, most - stiffness * (elongation(start) - elongation(theta)))
        return weight * (h * math.cos(theta) + b * math.sin(theta)) + tension**2 / (2 * stiffness)

    def rate(u: float) -> float:  # θ = θ0 (1 − u²) removes the singularity at the turning point
        inertia = weight / GRAVITY * 4 / 3 * (b * b + h * h)
        return start * 2 * u / math.sqrt(2 * (energy(start) - energy(start * (1 - u * u))) / inertia)

    assert found == pytest.approx(float(quad(rate, 0, 1)[0]), rel=1e-3)
    assert missed < 5e-3


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_impact_loses_the_energy_of_housners(share: float) -> None:
    """Two turning points from the energy before them; the ratio of angular velocities is Housner's to 1 %.

    Corners are springs with dashpots without tension: the remaining bounce explains the difference.
    """
    found, _ = rocking(share)
    alpha = BLOCK.alpha

    def height(of: float) -> float:
        return math.cos(alpha - of * alpha) - math.cos(alpha)

    for before, after in ((share, found[3]), (found[3], found[4])):
        assert math.sqrt(height(after) / height(before)) == pytest.approx(BLOCK.restitution, rel=0.01)
    assert found[1] - found[0] == pytest.approx(2 * quarter(found[3]), rel=1e-2)


@pytest.mark.parametrize(("b", "h"), [(0.25, 0.5), *at_length((0.5, 0.1))])
def test_block_that_lands_flat_bounces_as_a_damped_spring(b: float, h: float) -> None:
    """The ground drops away and stops: the block is in free fall, and rebounds with e of its speed, to 0.06.

    For a mass on a spring and a dashpot of damping ratio ξ without tension, e = exp(−ξ φ / √(1 − ξ²)) with the contact
    time ω φ, φ = π − atan(2 ξ √(1 − ξ²) / (1 − 2 ξ²)); ξ is 1 at the wall's highest frequency and lower in proportion
    at this one.
    """
    time = np.array([0.0, 1e-4, 0.1, 0.1002, 0.2, 0.2001])
    fall = 2.5 * GRAVITY * np.array([0.0, -1.0, -1.0, 1.0, 1.0, 0.0])
    rest = resting(block(b, h, History(time, np.column_stack([0 * fall, fall])), 0.7))
    response = follow(rest, 1.0, rows=1000)
    now, above = response.time, response.displacement[:, 0, 1]
    lands = float(now[np.argmax((now > 0.15) & (above < 0))])
    flies = (now > 0.01) & (now < lands - 0.01)
    way = rest.history.velocity(np.linspace(0.0, 0.3, 30_001))[:, 1]
    ground = np.interp(now, np.linspace(0.0, 0.3, 30_001), np.cumsum(way) * 1e-5)
    assert above[flies] == pytest.approx(-0.5 * GRAVITY * now[flies] ** 2 - ground[flies], abs=1e-3)
    assert np.abs(response.reaction[flies]).max() < 1e-9 * float(rest.scene.mass[0]) * GRAVITY
    speed = GRAVITY * lands + float(rest.history.velocity(lands)[1])
    back = math.sqrt(2 * GRAVITY * above[now > lands + 0.01].max())
    own = 1e10 * 2 * b * rest.scene.thickness / float(rest.scene.mass[0])
    ratio = rest.viscous * math.sqrt(own / rest.system.interface.frequency_squared)
    root = math.sqrt(1 - ratio**2)
    contact = math.pi - math.atan2(2 * ratio * root, 1 - 2 * ratio**2)
    assert back / speed == pytest.approx(math.exp(-ratio * contact / root), abs=0.06)
    assert response.verdict == "stands"


SPECTRUM = [
    # cycles, ω / p, smallest amplitude in g tan α above which the block falls (negative: stands again)
    (0.5, 1.0, 1.3214),
    (0.5, 6.0, 3.8021),
    (1.0, 2.0, 1.2230),
    (1.0, 4.0, -5.0215),
    (1.0, 4.0, 5.3174),
    (1.0, 6.0, 4.5724),
]
"""Overturning spectrum with both modes: after an impact and, under stronger pulses, without impact."""


@cache
def at_rest() -> Resting:
    return resting(block(BLOCK.b, BLOCK.h, still()))


@pytest.mark.parametrize(("cycles", "ratio", "edge"), [*SPECTRUM[1:3], *at_length(SPECTRUM[0], *SPECTRUM[3:])])
def test_pulses_overturn_the_block_at_housners_amplitude(cycles: float, ratio: float, edge: float) -> None:
    """To 2 % on either side: Housner's equation and the model agree on which amplitudes overturn the block."""
    period = 2 * math.pi / (ratio * BLOCK.p)
    scene = block(BLOCK.b, BLOCK.h, shaken("sine" if cycles == 1 else "half-sine", GRAVITY * BLOCK.b / BLOCK.h, period))
    rest = Resting(scene, "dem-dynamic", at_rest().system, at_rest().state, "stable")
    for factor, falls in ((0.98, edge < 0), (1.02, edge > 0)):
        amplitude = factor * abs(edge)
        assert BLOCK.overturns(amplitude * GRAVITY * BLOCK.b / BLOCK.h, period, cycles) == falls
        response = follow(rest, amplitude, rows=50)
        assert response.verdict == ("collapse" if falls else "stands")
        assert response.unaccounted < 0.01


@pytest.mark.parametrize(("friction", "peak"), [(0.3, 1.0), (0.5, 0.8), (0.3, 3.5)])
def test_sliding_block_slips_as_newmarks(friction: float, peak: float) -> None:
    """Under half a sine, to 1e-3: a = μ g from when the ground accelerates faster until the velocities are equal.

    The last case slides by more than one and a half of its lengths, off the ground that was beside it at first.
    """
    period = 0.4
    rest = resting(block(0.5, 0.1, shaken("half-sine", peak * GRAVITY, period), friction, stiffness=1e11))
    response = follow(rest, 1.0)
    time = np.linspace(0, 3, 300_001)
    ground = np.where(time < period / 2, peak * GRAVITY * np.sin(2 * math.pi * time / period), 0.0)
    first = int(np.argmax(ground > friction * GRAVITY))
    step = time[1]
    apart = np.concatenate([[0.0], np.cumsum((ground[first:-1] + ground[first + 1 :]) / 2 - friction * GRAVITY)]) * step
    stop = int(np.argmax(apart[1:] <= 0)) + 1
    slid = float(np.trapezoid(apart[:stop], dx=step))
    assert response.verdict == "stands"
    assert response.displacement[-1, 0, 0] == pytest.approx(-slid, rel=1e-3)
    assert response.unaccounted < 0.01
    most = friction * float(rest.scene.mass[0]) * GRAVITY
    assert np.median(response.reaction[(response.time > 0.1) & (response.time < 0.2), 0]) == pytest.approx(
        most, rel=0.01
    )


@pytest.mark.parametrize("stiffness", [1e9, 1e11])
def test_block_that_slides_to_and_fro_errs_by_the_slip_of_its_soft_joint(stiffness: float) -> None:
    """Newmark's block, whose slip reverses four times without a rest: at each, friction grows in about a period of k_t.

    The largest error of its path is a millimetre at 1e9 Pa/m, and falls with the square root of the stiffness.
    """
    friction, time = 0.3, np.arange(0.0, 1.0001, 0.005)
    pushes = 6 * np.sin(4 * math.pi * time)
    history = History(time, np.column_stack([pushes, np.zeros_like(pushes)]))
    response = follow(resting(block(0.5, 0.25, history, friction, stiffness=stiffness)), 1.0)
    step, velocity, slid = 2e-5, 0.0, [0.0]
    moments = np.arange(0.0, 2.0, step) + step / 2
    for push in -np.interp(moments, time, pushes, right=0.0):
        before, velocity = velocity, velocity + push * step
        velocity -= float(np.clip(velocity, -friction * GRAVITY * step, friction * GRAVITY * step))
        slid.append(slid[-1] + (before + velocity) / 2 * step)
    path = response.displacement[:, :, 0].mean(axis=1)
    error = float(np.abs(path - np.interp(response.time, np.append(moments - step / 2, 2.0), slid)).max())
    assert np.abs(slid).max() > 0.05
    assert error == pytest.approx(1e-3 * math.sqrt(1e9 / stiffness), rel=0.2)


@pytest.mark.parametrize(("peak", "falls"), [(2.0, False), (20.0, True)])
def test_block_sliding_off_the_ground_is_reported(peak: float, falls: bool) -> None:
    """Such a fall depends only on the modelled ground, thirty sizes long; on longer ground the block would slide on."""
    response = follow(resting(block(0.5, 0.1, shaken("half-sine", peak * GRAVITY, 0.8), 0.3)), 1.0, rows=50)
    assert response.verdict == ("collapse" if falls else "stands")
    assert (", past the end of the ground;" in response.message) == falls


@pytest.mark.parametrize(("slope", "lifts"), [(0.0, 0.4), (0.14, 0.0), *at_length((0.0, -0.4), (0.14, 0.3))])
def test_block_slides_on_a_slope_and_on_vertically_moving_ground(slope: float, lifts: float) -> None:
    """Newmark's block with all terms, to 1e-3: v' = g sin β − a ∓ μ (g cos β + a_v), four pulses of 0.5 s.

    On level ground it slides farther to the side to which it is pushed while the ground is falling; on a slope of 8°
    each pulse moves it only downhill.
    """
    friction, angle = (0.4, slope) if slope else (0.3, 0.0)
    time = np.arange(0.0, 2.001, 0.005)
    shape = np.sin(4 * math.pi * time)
    motion = GRAVITY * np.column_stack([(0.35 if slope else 0.45) * shape, lifts * shape])
    bare = block(0.5, 0.1, History(time, motion), friction, stiffness=1e11)
    leaning = (GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle))
    response = follow(resting(replace(bare, load=replace(bare.load, gravity=leaning))), 1.0)
    step, velocity, slid = 2e-5, 0.0, 0.0
    moments = np.arange(0.0, 3.0, step) + step / 2
    across, up = (np.interp(moments, time, each, right=0.0) for each in motion.T)
    for push, most in zip(leaning[0] - across, friction * (up - leaning[1]), strict=True):
        before, velocity = velocity, velocity + push * step
        velocity -= float(np.clip(velocity, -most * step, most * step))
        slid += (before + velocity) / 2 * step
    assert abs(slid) > 0.02
    assert response.verdict == "stands"
    assert response.displacement[-1, 0] == pytest.approx([slid, 0.0], abs=1e-3 * abs(slid))
    assert response.unaccounted < 0.01


@pytest.mark.parametrize("period", [0.5, *at_length(5.0)])
def test_constant_force_slides_a_block_away(period: float) -> None:
    """At μ g, although it takes half a minute just above: a wall with growing energy does not stand."""
    friction = 0.15
    history = History(*pulse("ramp", 1.0, period), holds=True, interval=period / 200)
    rest = resting(block(0.25, 1.0, history, friction, stiffness=1e9))
    for factor, verdict in ((0.998, "stands"), (1.005, "collapse")):
        response = follow(rest, factor * friction * GRAVITY, rows=50)
        assert response.verdict == verdict, response.message


@pytest.mark.parametrize(("kind", "span"), [("half-sine", 0.5), *at_length(("sine", 1.0))])
def test_displaced_ground_starts_and_ends_at_rest(kind: str, span: float) -> None:
    """A block slides on ground with velocity jumps, compared with its own equation in small steps."""
    friction, amplitude = 0.3, 0.1
    history = History(*pulse(kind, amplitude, 1.0), "displacement", interval=1 / 200)
    response = follow(resting(block(0.5, 0.1, history, friction, stiffness=1e11)), 1.0)
    step, velocity, slid = 1e-5, 0.0, 0.0
    for moment in np.arange(0.0, span + 1.0, step) + step / 2:
        ground = 2 * math.pi * amplitude * math.cos(2 * math.pi * moment) if moment < span else 0.0
        velocity += float(np.clip(ground - velocity, -friction * GRAVITY * step, friction * GRAVITY * step))
        slid += (velocity - ground) * step
    assert response.verdict == "stands"
    assert response.displacement[-1, 0, 0] == pytest.approx(slid, abs=0.01 * amplitude)
    assert response.unaccounted < 0.01


@pytest.mark.parametrize("scale", [0.9595, *at_length(0.9585)])
def test_block_turning_round_near_balance_does_not_stand(scale: float) -> None:
    """It barely moves for as long as a rocking cycle; a quiet end of the record makes no difference."""
    time, values = pulse("half-sine", 1.0, 1.0)
    tail = np.arange(time[-1] + 0.01, 10.0, 0.01)
    quiet = History(np.append(time, tail), np.concatenate([values, np.zeros((len(tail), 2))]), interval=1 / 200)
    verdicts = {
        follow(resting(block(0.05, 1.0, history, 0.7, stiffness=1e10)), scale, rows=50).verdict
        for history in (History(time, values, interval=1 / 200), quiet)
    }
    assert verdicts == {"collapse"}


@pytest.mark.parametrize(("peak", "verdict"), [(1.4785, "stands"), (1.47852, "stands"), (1.47858, "collapse")])
def test_no_block_stands_on_its_corner(peak: float, verdict: str) -> None:
    """Within 3 % of its balance it is calm for a swing, and then comes back or falls."""
    squat = HousnerBlock(0.25, 0.35)
    balanced = math.sin(squat.alpha) + squat.b / (2 * squat.h) * (1 - math.cos(squat.alpha))
    rest = resting(block(squat.b, squat.h, shaken("half-sine", peak * GRAVITY, 0.6), stiffness=1e9))
    response = follow(rest, 1.0, rows=50)
    assert np.abs(response.drift[response.time < 2.0]).max() == pytest.approx(balanced, rel=0.03)
    assert response.verdict == verdict
    assert verdict == "collapse" or abs(response.drift[-1]) < 0.05 * balanced


def test_block_with_decaying_rocking_is_followed_to_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slender block on a bed of springs loses 1 % of its angular velocity per impact: half a minute is too short."""
    slender = HousnerBlock(0.1, 0.8)
    motion = shaken("half-sine", 1.4 * GRAVITY * math.tan(slender.alpha), math.pi / slender.p)
    rest = resting(block(slender.b, slender.h, motion, stiffness=1e9).with_joint(compressive_strength=1e9))
    patience = rest.history.duration + FOLLOW.PATIENCE * rest.swing
    response = follow(rest, 1.0, rows=50)
    assert response.verdict == "stands"
    assert response.time[-1] > 1.2 * patience
    before, after = (np.abs(response.drift[response.time > share * patience]).max() for share in (0.5, 1.0))
    assert after < before / 2
    monkeypatch.setattr(FOLLOW, "AT_MOST", FOLLOW.PATIENCE)
    assert follow(rest, 1.0, rows=50).verdict == "undecided"


def test_collapse_counts_if_time_ends_while_it_is_filmed(monkeypatch: pytest.MonkeyPatch) -> None:
    rest = resting(block(BLOCK.b, BLOCK.h, shaken("half-sine", 2.0 * GRAVITY * BLOCK.b / BLOCK.h, math.pi / BLOCK.p)))
    bare = follow(rest, 1.0, rows=50)
    assert bare.verdict == "collapse"
    monkeypatch.setattr(FOLLOW, "PATIENCE", (bare.time[-1] + 0.1 - rest.history.duration) / rest.swing)
    filmed = follow(rest, 1.0, rows=50, after=0.5)
    assert filmed.time[-1] > bare.time[-1] + 0.4
    assert (filmed.verdict, filmed.message) == (bare.verdict, bare.message)


def test_shape_of_the_fall_is_not_that_of_debris() -> None:
    """The upper course of a pier falls; if it is followed until its halves swing back on the ground, the shape is that
    of the fall nevertheless."""
    motion = {"pulse": {"kind": "sine", "amplitude": 0.6, "period": 0.8}, "quantity": "g"}
    pier = {"block_width": 0.5, "block_height": 1.0, "thickness": 0.3, "length": 0.5, "height": 2.0}
    joint = {"friction": 0.7, "normal_stiffness": 1e8, "shear_stiffness": 4e7}
    rest = resting(panel(wall=pier, joint=joint, load__live=None, load__history=motion))
    bare, filmed = (follow(rest, 1.0, rows=50, after=after) for after in (0.0, 0.5))
    assert filmed.message == bare.message
    assert np.abs(filmed.motion - bare.motion).max() > 0.5  # debris has moved on
    assert filmed.shape == pytest.approx(bare.shape, abs=1e-12)


@pytest.mark.long
def test_response_does_not_depend_on_rows_or_resampling() -> None:
    """A record at 50 Hz and its linear interpolation at 1 kHz, with different numbers of rows.

    To a thousandth of the largest drift after two seconds of impacts and the free motion that follows. Under other
    records single impacts depend on the last digits, and the block slips by one per cent or not. Rows are at the time
    steps nearest to their times.
    """
    time, finer = np.arange(0.0, 2.001, 0.02), np.linspace(0.0, 2.0, 2001)
    values = 4.0 * np.random.default_rng(7).standard_normal(len(time))
    records = [(time, values), (finer, np.interp(finer, time, values))]
    coarse, fine = (History(t, np.column_stack([x, np.zeros(len(t))])) for t, x in records)
    few, many, resampled = (
        follow(resting(block(0.25, 0.75, history)), 1.0, rows=rows)
        for history, rows in ((coarse, 100), (coarse, 1000), (fine, 1000))
    )
    size = many.peak_drift
    assert size > 0.02
    assert np.interp(few.time, many.time, many.drift) == pytest.approx(few.drift, abs=1e-3 * size)
    assert np.interp(many.time, resampled.time, resampled.drift) == pytest.approx(many.drift, abs=1e-3 * size)


@pytest.mark.long
def test_joints_with_strength_rock_as_beds_of_springs() -> None:
    """A strength that is never reached gives nine points for two: an impact loses far less than Housner's."""
    amplitude, period = 1.4 * GRAVITY * math.tan(BLOCK.alpha), math.pi / BLOCK.p
    scene = block(BLOCK.b, BLOCK.h, shaken("half-sine", amplitude, period))
    corners = ((0.0, 2 * BLOCK.h), (2 * BLOCK.b, 2 * BLOCK.h))
    found = {}
    for strength in (None, 1e9):
        crushing = scene.with_joint(compressive_strength=strength)
        response = follow(resting(crushing), 1.0, points=np.array(corners))
        base, height = np.diff(response.displacement, axis=1)[:, 0].T
        turn = np.abs(np.arctan2(height, 2 * BLOCK.b + base))
        found[strength] = float(turn[response.time < 1.2].max())
    rule = lobatto(9)
    bed = peak(BLOCK, (rule.nodes, rule.weights / 2), 1e10, (amplitude, period))
    assert found[None] == pytest.approx(BLOCK.peak(amplitude, period, 0.5), rel=0.01)
    assert found[1e9] == pytest.approx(bed, rel=0.02)
    assert bed > 1.3 * BLOCK.peak(amplitude, period, 0.5)
    assert "Housner's" in impact_note(scene.with_joint(compressive_strength=1e9))
    assert not impact_note(scene)


def test_benchmark_beside_other_engines_measures_the_rotation(monkeypatch: pytest.MonkeyPatch) -> None:
    """`benchmarks/peers/rocking_block.py`, which runs without the engines; the block turns by half of α."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks" / "peers"))
    beside = import_module("rocking_block")
    pulse = beside.Pulse(0.5, 2, 1.7)
    rotation, _, seconds = beside.ours(1e10)(pulse)
    assert rotation == pytest.approx(pulse.exact, rel=0.005)
    assert seconds > pulse.period
