"""How a beam is driven along its path at a slow speed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runningbond.results.outcome import joined, number, two_digits
from runningbond.scene import Array

from .lead import RAMP, ROWS, STRIDE, Lead, pace
from .path_curve import BEAM_ANSWER, BEAM_DIFFERS, growth_left, other_way
from .peaks import LEAST_WINDOWS, Peaks
from .state import State
from .toes import Toes
from .traverse import Traverse

LEAST_ROWS = 40
"""Smallest number of rows in any leg."""

NOTHING = 1e-9
"""Force of a drive, relative to the dead load, up to which it is rounding: nothing resists the drive."""

BELOW = 0.95
"""Part of a number that two digits never round up above the number itself."""


@dataclass(frozen=True, eq=False)
class BeamDrive(Lead):
    """How the beam of a scene is driven."""

    answer = BEAM_ANSWER

    @cached_property
    def first_move(self) -> float:
        """Sense of the first move: 1, or -1 to the left."""
        if self.scene.drive is None:
            raise TypeError("the scene has no driven beam")
        return self.scene.drive.force[0]

    @cached_property
    def goals(self) -> Array:
        """Displacements along the first move [m], one after the other."""
        return self.first_move * np.array(self.scene.drive_path)

    @property
    def least(self) -> float:
        """Force [N] below which brackets need not be relatively narrow."""
        return NOTHING * self.dead_load

    @cached_property
    def beam(self) -> int:
        """Number of the block that is the beam."""
        if self.scene.beam is None or self.scene.beam.block is None:
            raise TypeError("only a beam is driven")
        return self.scene.beam.block

    @cached_property
    def _toes(self) -> Toes:
        return Toes(self.scene, self.points)

    def of_beam(self, state: State, moved: float) -> tuple[float, ...]:
        """`BEAM` in a state; the toe is the one on the side towards which the wall is pushed."""
        run = self.run
        _, uplift, rotation = run.system.motion_of_blocks(state.motion - self.start.motion)[self.beam]
        opening, *_, damage, crushed = run.at_joints(state)
        broken = self._toes.broken(opening, damage, crushed, right=moved * self.first_move >= 0)
        return rotation, uplift, run.ledger(state).friction, broken

    def reached(self, curve: Array) -> float:
        """Largest displacement [m] along the first move, to which the answer belongs."""
        return float(curve[:, 0].max())

    def other_way(self, curve: Array) -> str:
        """Note on the largest reaction in the other direction of a cyclic drive."""
        return other_way(self.goals, curve)

    def too_fast(self) -> str:
        """Note on a rate whose double, at which the path is also followed, has not two time steps for each row.

        Rows have two steps at least: the drive is then slower than that, as slow at both speeds, and they would agree.
        """
        rate = self.rate
        most = self.longest / (2 * ROWS * LEAST_WINDOWS * self.run.dt)
        if rate is None or rate <= most:
            return ""
        told = two_digits(BELOW * most)
        return f"beam.drive.rate = {rate:g}: is too fast for its time steps; give at most {told} m/s, or none"

    def growth_left(self, traverse: Traverse) -> float:
        """Force [N] by which the answer may grow beyond the end of the path, at small displacements.

        At finite ones collisions and cracks make forces rise and fall, so that their slope is uncertain: see `doubt`.
        """
        return self._growth_along_slope(traverse) if self.is_small else 0.0

    def doubt(self, traverse: Traverse, tolerance: float) -> str:
        """Note on a force that depends on how joints slid, or that grows on a longer path, at finite displacements."""
        if traverse.answer <= self.least:
            return "nothing resists the drive"
        slid = self.friction_note(traverse, tolerance, BEAM_DIFFERS, until=traverse.largest + 1)
        told = joined(self.moving(traverse, tolerance), slid)
        grown = traverse.answer + self._growth_along_slope(traverse)
        if self.is_small or grown <= (1 + tolerance) * traverse.answer:
            return told
        rising = f"still rising at the end, along its slope to {number(grown)} on a path twice as long"
        return joined(told, rising)

    def moving(self, traverse: Traverse, tolerance: float) -> str:
        """Note on a beam that moves so fast that inertia and damping take a part of the force."""
        taken = traverse.answer - traverse.still
        if taken <= tolerance * traverse.answer:
            return ""
        part = two_digits(100 * taken / traverse.answer)
        return f"inertia and damping take {part} % of the force at this speed: a wall at rest may bear less by as much"

    def _growth_along_slope(self, traverse: Traverse) -> float:
        return 0.0 if traverse.verdict == "collapse" else growth_left(self._unbraked(traverse.curve))

    def _unbraked(self, curve: Array) -> Array:
        """A curve ``(n, 2)`` without the rows in which the drive brakes before it turns or ends: blocks push it on."""
        senses = np.sign(np.diff(curve[:, 0]))
        turns = np.append(np.flatnonzero(senses[1:] * senses[:-1] < 0) + 1, len(curve) - 1)
        braking = turns[:, None] - np.arange(RAMP + 1)
        return np.delete(curve, braking[braking > 0], axis=0)

    def go(self, traverse: Traverse, speed: float) -> State:
        """Drive the beam along its path at a largest speed [m/s]; return the state at its end."""
        run, state, at = self.run, self.start.copy(), 0.0
        run.return_to(state)
        self.observe(run, state, 0.0)
        self.note(traverse, state, 0.0, 0.0)
        mobility = float((run.system.live**2 / run.system.mass).sum())
        given, seen = run.given(state), [(state.motion.copy(), self.crushed(state))]
        peaks = Peaks(traverse.best, self.longest / (ROWS * speed * run.dt))
        for goal in self.goals.tolist():
            if goal == at or traverse.verdict != "stable":
                continue
            n = max(LEAST_ROWS, round(ROWS * abs(goal - at) / self.longest))
            paces = pace(n, peaks.windows)
            steps = max(peaks.windows, round(abs(goal - at) / (speed * run.dt * paces.mean(axis=1).sum())))
            lengths = np.diff(np.arange(peaks.windows + 1) * steps // peaks.windows)
            ahead, step, until = float((paces @ lengths).sum()), run.dt, state.time
            top = (goal - at) / (step * ahead)
            for k, parts in enumerate(paces.tolist()):
                for window, (part, length) in enumerate(zip(parts, lengths.tolist(), strict=True), start=1):
                    before, gathered, since = run.driven_speed(state), self._gathered(state), state.time
                    spent, moved = self._spent(state), run.driven(state)
                    until += length * step
                    taken = run.steps_until(until, state)  # time steps change with the contacts
                    if not self.is_small and k >= n - RAMP:  # braking takes up what whole steps have left
                        top = (goal - self.moved(state)) / (step * ahead)
                    ahead -= part * length
                    force = run.drive(state, top * part, taken, given=given)
                    own = (top * part - before) / (mobility * (state.time - since))  # the driven body's own inertia
                    force -= own
                    # At finite displacements blocks collide all the time, which means over rows average out.
                    knock = not self.is_small and k >= RAMP
                    inertia = 0.0 if knock else (self._gathered(state) - gathered) / (state.time - since)
                    spent = self._spent(state) - spent
                    share = spent / (run.driven(state) - moved) - own
                    row = len(traverse.rows) + (window > peaks.windows // 2)
                    peaks.see(force, inertia, taken, state, row, spent=share)
                    if window == peaks.windows // 2:
                        middle = state.copy()
                # The mean force of a row belongs to the middle of the row.
                self.note(traverse, middle, self.moved(middle), peaks.mean(peaks.windows))
                seen.append((middle.motion, self.crushed(middle)))
                if (k + 1) % STRIDE == 0 and k + 1 < n:
                    self.observe(run, middle, traverse.rows[-1].force)
                if self.falls(state):
                    traverse.verdict = "collapse"
                    break
            at = goal
            self.note(traverse, state, self.moved(state), traverse.rows[-1].force)
            self.observe(run, state, traverse.rows[-1].force)
            seen.append((state.motion.copy(), self.crushed(state)))
        self.conclude(traverse, peaks, seen)
        return state

    def _spent(self, state: State) -> float:
        """Kinetic energy of all bodies, and what damping has taken of it so far [J]."""
        return self.run.system.kinetic_energy(state.velocity) + self.run.damped(state)

    def _gathered(self, state: State) -> float:
        """Momentum along the drive of all bodies except the beam, including what damping dissipates meanwhile [N s]."""
        system = self.run.system
        along = system.rigid[system.owner != self.beam, 0]
        along = along[np.isfinite(system.mass[along])]
        return float(system.mass[along] @ state.velocity[along]) / (1 - self.run.local)
