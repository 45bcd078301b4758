"""Simulation of a wall through a ground motion: the record, then free motion until the wall rests or has fallen.

A block has fallen once it is lower than at rest under its weight by half its size (`Scene.block_sizes`), or has rotated
by more than `TURNED`. If the energy ledger misses more than the loads have supplied, the run stops, undecided unless a
block has fallen before. A wall stands if, for the duration of a rocking swing, its kinetic energy could not lift it by
more than `RISE` of a block and does not increase, and no point moves by more than `STILL`. A wall whose energy
increases to the end slides away, which also counts as collapse.
"""

import math
import time
from bisect import bisect_left
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.dynamics import Observer, Run, State, no_observer
from runningbond.results.mechanism import carried
from runningbond.scene import Array, Scene, SceneError

from .ground import Ground
from .response import ENERGIES, MISSED, Response, ResponseVerdict, supplied, unaccounted, until_fallen
from .resting import Resting

TURNED = math.radians(60)
"""Rotation beyond which a block has fallen [rad]."""

RISE = 1e-4
"""Largest height, in block sizes, to which the kinetic energy of a wall that stands could lift it."""

STILL = 0.02
"""Largest range of motion, in block sizes, of any point of a wall that stands: a block near unstable equilibrium may
reverse so slowly that it has almost no kinetic energy, and still fall."""

DISPLACED_SWINGS = 4
"""Number of swings for which a wall must be calm if it is farther than `STILL` from where it stood; otherwise one.

A block near unstable equilibrium may be calm for one swing. In each swing the distance of a slender block from that
equilibrium grows by the factor e^√6.
"""

ROWS = 200
"""Rows of a response per second, or per record if that is shorter than one second; at most one per time step. `follow`
accepts other numbers."""

PART = 0.9
"""Time step relative to the stable one: the energy error of an impact grows with the square of the step."""

SHAPE = 0.1
"""Largest corner displacement, relative to the size of the wall, at the moment whose shape a response keeps; or largest
growth of it since the wall last swung back, if it was nowhere as small any more."""

AFTER = 0.5
"""Time [s] for which a wall that falls is recorded after its first block has fallen."""

GROWTH_FLOOR = 1e-3
"""Kinetic energy, relative to the level that counts as calm, above which a wall whose energy increases is not at
rest."""

PARTS, GROWTH = 4, 1.1
"""Number of parts of the last ``PATIENCE / 2`` swings, and ratio of mean kinetic energy from part to part above which a
wall slides away instead of being undecided: under a constant force the energy increases by a third to a half."""

PATIENCE, AT_MOST = 30, 120
"""Swings (`Resting.swing`) after the record until a wall that neither rests nor falls is left undecided, and the
maximum for a wall that rocks with decreasing energy, whose time is extended by half of the first number at a time.

A wall that only sways stands: in the last quarter of the first number its drift stays within the range of the quarter
before, and the energy it loses in both goes into viscous damping, not into sliding, cracking or crushing of joints.
"""

JOINT_SHARE = 0.01
"""Largest energy that friction, cracking and crushing dissipate in a wall that only sways, relative to damping."""


class _Row(NamedTuple):
    """Values observed at one time: a row of a `Response`, with `places` the displacements of its points."""

    time: float
    ground: Array
    places: Array
    drift: float
    reaction: Array
    energy: Array
    fallen: int

    @property
    def kinetic(self) -> float:
        """Kinetic energy [J]."""
        return float(self.energy[ENERGIES.index("kinetic")])


class _Log:
    """Rows of a response as they are recorded, and the blocks that have fallen."""

    def __init__(self, rest: Resting, ground: Ground, state: State, points: Array) -> None:
        system = ground.run.system
        if system.contacts is None:
            raise TypeError("a wall follows its ground at finite displacements")
        self.ground, self._run, self.points = ground, ground.run, points
        self._outline, self._block = system.contacts.outline, np.array([rest.block_at(point) for point in points])
        self._size, self._movable = rest.scene.block_sizes[system.owner], ~rest.scene.fixed[system.owner]
        size = rest.scene.overturning_size
        self._still, self.calm = STILL * size, RISE * rest.gravity * float(ground.inertia[0].sum()) * size
        self._dead = ground.dead()
        self._height = np.maximum(points[:, 1] - rest.top[:, 1].min() + rest.height, 1e-9).mean()
        self._blocks, self._far = rest.scene.blocks, SHAPE * rest.scene.size
        self.shape = np.zeros((len(self._blocks), 3))
        self._lowest = self._highest = 0.0  # farthest corner at the last turn, and the most since then [m]
        self._motion, self._places, self._energies = state.motion.copy(), self._where(state), self._energy(state)
        self._momentum, self._time = ground.momentum(state), state.time
        self.rows: list[_Row] = []
        self.first: list[int] = []
        self._gone = 0.0
        self.look(state)

    def look(self, state: State) -> None:
        """Add a row."""
        system, now = self._run.system, self.ground.time(state)
        moved = system.motion_of_bodies(state.motion - self._motion)
        fell = self._movable & ((-moved[:, 1] > self._size / 2) | (np.abs(moved[:, 2]) > TURNED))
        self._keep_shape(system.motion_of_blocks(state.motion - self._motion))
        self.first += [block for block in dict.fromkeys(system.owner[fell].tolist()) if block not in self.first]
        momentum, span = self.ground.momentum(state), state.time - self._time
        pushed = (momentum - self._momentum) / span if span else np.zeros(2)
        self._momentum, self._time = momentum, state.time
        places = self._where(state) - self._places
        ground, drift = self.ground.acceleration(now), float(places[:, 0].mean() / self._height)
        energy = self._energy(state) - self._energies
        self._gone += float(np.abs(energy[:2] - (self.rows[-1].energy[:2] if self.rows else 0.0)).sum())
        self.rows.append(_Row(now, ground, places, drift, pushed - self._dead, energy, len(self.first)))

    def _keep_shape(self, shape: Array) -> None:
        """Keep a shape ``(nb, 3)`` as the wall's way to fall unless it has moved too far, or blocks have fallen."""
        if self.first:
            return  # debris swings back as well
        farthest = float(np.hypot(*carried(self._blocks, self._blocks.owner, self._blocks.vertices, shape).T).max())
        if farthest < max(self._lowest, self._highest - self._far / 2):  # it swings back
            self._lowest = self._highest = farthest
        self._highest = max(self._highest, farthest)
        if farthest <= max(self._far, self._lowest + self._far):
            self.shape = shape

    @property
    def is_lost(self) -> bool:
        """Whether the missing energy exceeds the sum of all |increments of work| plus what a wall at rest may have."""
        energy = self.rows[-1].energy
        return not abs(supplied(energy[None])[0] - energy[2:].sum()) <= self._gone + self.calm

    def is_calm(self, since: float) -> bool:
        """Whether since a time [s] there was almost no kinetic energy, it did not increase, and no point moved far."""
        rows = self._since(since)
        energy = np.array([row.kinetic for row in rows])
        before, late = energy[: len(energy) // 2].max(initial=0.0), energy[len(energy) // 2 :].max(initial=0.0)
        if max(before, late) > self.calm or late > max(before, GROWTH_FLOOR * self.calm):
            return False
        return bool(np.ptp([row.places for row in rows], axis=0).max() <= self._still)

    @property
    def is_elsewhere(self) -> bool:
        """Whether a point is away from its position before the ground motion."""
        return bool(np.hypot(*self.rows[-1].places.T).max() > self._still)

    def swaying(self, since: float) -> Array | None:
        """Range of drift ``(2,)`` in the later half since a time [s] if the wall only sways, less and less; or None."""
        rows = self._since(since)
        drift, energy = np.array([row.drift for row in rows]), np.array([row.energy for row in rows])
        before, late = drift[: len(rows) // 2], drift[len(rows) // 2 :]
        spent, damped = energy[-1, 4:] - energy[0, 4:]
        within = before.min() < late.min() <= late.max() < before.max()
        return np.array([late.min(), late.max()]) if within and spent <= JOINT_SHARE * damped else None

    def runs_away(self, since: float) -> bool:
        """Whether kinetic energy has grown steadily since a time [s], as in sliding under a constant load."""
        energy = np.array([row.kinetic for row in self._since(since)])
        parts = [float(part.mean()) for part in np.array_split(energy, PARTS)]
        return all(later > GROWTH * before for before, later in pairwise(parts)) and parts[0] > GROWTH_FLOOR * self.calm

    def dies_away(self, since: float) -> bool:
        """Whether the mean kinetic energy since a time [s] was lower in the second half than in the first."""
        before, late = np.array_split([row.kinetic for row in self._since(since)], 2)
        return bool(late.mean() < before.mean())

    def _since(self, time: float) -> list[_Row]:
        return self.rows[bisect_left(self.rows, time, key=lambda row: row.time) :]

    def _where(self, state: State) -> Array:
        return self._outline.points(self._block, self.points, state.motion[self._run.system.rigid].ravel())

    def _energy(self, state: State) -> Array:
        ledger, dead = self._run.ledger(state, self.ground.load), self._run.dead_work(state)
        stored = ledger.elastic + ledger.joint + ledger.ties
        return np.array([ledger.external - dead, dead, ledger.kinetic, stored, ledger.friction, ledger.damped])


def follow(
    rest: Resting,
    scale: float,
    *,
    after: float = 0.0,
    points: Array | None = None,
    rows: int = ROWS,
    observe: Observer = no_observer,
) -> Response:
    """Simulate a wall through its ground motion.

    If the energy ledger misses more than `MISSED`, the run is repeated at half the time step, which misses a quarter to
    a half as much, and then at a quarter.

    Parameters
    ----------
    rest
        The wall at rest.
    scale
        Factor on the record, λ.
    after
        Time for which the run continues once a block has fallen [s].
    points : (k, 2) float, optional
        Points to follow [m], within a block's size of the wall, each fixed to the movable block that contains it or
        has the nearest corner, and none on a fixed block; by default the wall's upper corners.
    rows
        Rows per second, or per record if that is shorter than one second.
    observe
        Called with the run, its state and λ at the beginning and at every row, for each run.

    Returns
    -------
    Response
        Without rows if the wall does not come to rest under its dead load: ``infeasible`` or ``undecided``.
    """
    places = rest.top if points is None else _places(rest, points)
    if rest.trouble:
        return _not_shaken(rest, scale, places, *rest.trouble)
    response = _followed(rest, scale, PART, after, places, rows, observe)
    for part in (PART / 2, PART / 4):
        if response.unaccounted <= MISSED:
            break
        again = _followed(rest, scale, part, after, places, rows, observe)
        response = replace(again, steps=response.steps + again.steps, seconds=response.seconds + again.seconds)
    return response


def _places(rest: Resting, points: Array) -> Array:
    """Checked points to follow, ``(k, 2)`` [m], on no fixed block.

    They are above the ground, because drifts are relative to their heights.
    """
    try:
        places = np.array(points, dtype=float)
    except (TypeError, ValueError):
        places = np.zeros(0)
    above = rest.top[:, 1].min() - rest.height
    are_points = places.ndim == 2 and places.shape[1] == 2 and len(places) and np.isfinite(places).all()
    if not are_points or places[:, 1].min() <= above:
        raise SceneError("points", f"must be a list of points [x, y] in metres, higher than {above:.4g}", points)
    corners, near = rest.scene.blocks.vertices[rest.scene.wall[rest.scene.blocks.owner]], rest.scene.block_size
    low, high = corners.min(axis=0), corners.max(axis=0)
    for k, place in enumerate(places):
        if (place < low - near).any() or (place > high + near).any():
            box = " and ".join("[{:.4g}, {:.4g}]".format(*corner) for corner in (low, high))
            raise SceneError(f"points[{k}]", f"must lie on the wall, which is between {box} m", place.tolist())
        if (holding := rest.scene.blocks.containing(place)).size and rest.scene.fixed[holding].all():
            raise SceneError(f"points[{k}]", "must lie on a block that can move, not on what is fixed", place.tolist())
    return places


def _followed(
    rest: Resting, scale: float, part: float, after: float, points: Array, rows: int, observe: Observer
) -> Response:
    begin, history = time.perf_counter(), rest.history
    run = Run(replace(rest.system, live=scale * rest.system.live), local=0.0, viscous=rest.viscous, part=part)
    run.is_driven, state = True, rest.state.copy()
    ground = Ground(run, history, scale, state.time)
    log = _Log(rest, ground, state, points)
    verdict: ResponseVerdict = "undecided"
    fell, now, swing, sway = math.inf, 0.0, rest.swing, None
    end, last = (history.duration + swings * swing for swings in (PATIENCE, AT_MOST))
    observe(run, state, scale)
    with threadpool_limits(limits=1, user_api="blas"):
        while verdict == "undecided" and (now < end or log.first):
            row = min(1.0, history.duration if now < history.duration else 1.0) / rows
            ground.bring(state, now + max(row, run.dt))
            log.look(state)
            observe(run, state, scale)
            now = ground.time(state)
            if log.is_lost:
                verdict = "collapse" if fell <= now else "undecided"  # energy errors of debris do not matter
                break
            if log.first:
                fell = min(fell, now)
                verdict = "collapse" if now >= fell + after else "undecided"
            else:
                calm = now - swing * (DISPLACED_SWINGS if log.is_elsewhere else 1)
                verdict = "stands" if calm >= history.duration and log.is_calm(calm) else "undecided"
            if now >= end and verdict == "undecided" and not log.first:
                of_late = now - PATIENCE / 2 * swing
                sway = log.swaying(of_late)
                if sway is not None:
                    verdict = "stands"
                elif log.runs_away(of_late):
                    verdict = "collapse"
                elif end < last and log.dies_away(of_late):
                    end += PATIENCE / 2 * swing
    return _response(rest, scale, log, run, state, (verdict, fell, sway), time.perf_counter() - begin)


def _not_shaken(rest: Resting, scale: float, points: Array, verdict: ResponseVerdict, message: str) -> Response:
    """Response of a wall that does not come to rest under its dead load."""
    none, nowhere = np.zeros((0, 2)), np.zeros((len(rest.scene.blocks), 3))
    return Response(
        *(rest.scene.title, rest.model, scale, verdict, message, points),
        *(none[:, 0], none, np.zeros((0, len(points), 2)), none[:, 0], none, np.zeros((0, len(ENERGIES)))),
        *(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), nowhere, nowhere, math.nan, rest.state.steps),
    )


def _response(
    rest: Resting,
    scale: float,
    log: _Log,
    run: Run,
    state: State,
    end: tuple[ResponseVerdict, float, Array | None],
    seconds: float,
) -> Response:
    times, ground, places, drift, reaction, energy, fallen = map(np.array, zip(*log.rows, strict=True))
    verdict, fell, sway = end
    left = f"with a residual drift of {drift[-1]:.3g}"
    if sway is not None:
        left = f"and sways on by drifts from {sway[0]:.3g} to {sway[1]:.3g}"
    first = log.first[: until_fallen(fallen, fallen)[-1]]
    names = ", ".join(rest.scene.blocks.name(block) for block in first[:3])
    undecided = "neither rests nor falls within" if not log.is_lost else "more energy is missing than was supplied at"
    motion = run.system.motion_of_blocks(state.motion - rest.state.motion)
    order = " first" if len(first) > 3 else ""
    place = ", past the end of the ground" if first and _is_past_the_ground(rest.scene, motion, first[0]) else ""
    message = {
        "stands": f"stands, {left}",
        "collapse": f"falls: {names} at {fell:.3g} s{order}{place}"
        if first
        else f"slides faster and faster until {times[-1]:.3g} s",
        "undecided": f"{undecided} {times[-1]:.3g} s",
    }[verdict]
    lost = unaccounted(until_fallen(energy, fallen), log.calm)
    close = f"energy accounted for to {max(lost, 1e-6):.0e}"
    if not lost <= MISSED:
        close = f"{lost:.1%} of the energy supplied is unaccounted for: beyond {MISSED:.0%} the result is not reliable"
    return Response(
        scene=rest.scene.title,
        model=rest.model,
        scale=scale,
        verdict=verdict,
        message=f"{message}; peak drift {np.abs(until_fallen(drift, fallen)).max():.3g}; {close}",
        points=log.points,
        time=times,
        ground=ground,
        displacement=places,
        drift=drift,
        reaction=reaction,
        energy=energy,
        fallen=fallen,
        first=np.array(log.first, dtype=np.int64),
        motion=motion,
        shape=log.shape,
        unaccounted=lost,
        steps=state.steps - rest.state.steps,
        seconds=seconds,
    )


def _is_past_the_ground(scene: Scene, motion: Array, block: int) -> bool:
    """Whether a block has slid beyond the end of the ground, of which only a limited length is modelled."""
    ground = scene.fixed & ~scene.wall
    if not ground.any():
        return False
    (left, _), (right, _) = scene.blocks.extent(ground)
    return not left <= scene.blocks.centroid[block, 0] + motion[block, 0] <= right
