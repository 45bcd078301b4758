"""How walls are pushed far by their live load: its power is kept as it goes, and the multiplier follows.

The blocks that go farthest go as fast as one another from row to row, whichever they are, so that a push takes as long
where few of them fall as where all do. It begins slowly, in short rows, for most walls peak at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from runningbond.results.outcome import number, two_digits
from runningbond.scene import Array, Indices, Scene

from .lead import LITTLE, LOSS, ROWS, SEEN, Lead, Traverse
from .peaks import Peaks
from .run import CALMING, MOVING, Run
from .state import State
from .system import BlockSystem

MOST_ROWS = 4
"""Rows of a push, in those that it takes if no block goes farther than the control point."""

BEYOND = 1.25
"""How much farther blocks are expected to go the next time than they went before the wall fell: slower, later."""

LESS = 0.5
"""Least part of how far they were expected to go: a push that is far too fast throws blocks off, and seems to end."""

SLOWEST, FASTER, GATHERED = 0.01, 1.05, 0.01
"""Part of its speed at which a push begins, how much faster it goes in each row, and the part that it gathers at most.

What gathers speed takes a load that holds nothing: it is the smaller the longer that takes, and least at the peak.
"""

QUICKER = 2.0
"""How much more power a row may have than the one before, as it turns out how far that moves blocks."""

HALF = 0.5
"""Part of the largest multiplier down to which a curve is to settle: in the end walls fall one way or another."""

WINDOWS = 4
"""Most windows of a row whose mean multipliers are looked at: all blocks are pushed, and the push shakes with them."""

EARLY = 0.01
"""Part of a path before which a peak is told by the few short rows in which a push gathers speed."""

AT_ONCE = 1e-6
"""Part of its distance by which a control point that stays moves as its springs relax."""

STAYS = 0.01
"""Part of the path of the blocks that go farthest by which a point that counts as staying where it is goes at most."""

ControlPoint: TypeAlias = tuple[Indices, Array, Array]
"""Blocks ``(n,)``, point and direction ``(2,)`` of a displacement, as of `Scene.control_point`."""


def finite_run(system: BlockSystem, scene: Scene) -> Run:
    """The bodies of a scene at finite displacements, damped as what leads them asks for.

    Of what a live load pushes, all is damped that shakes, and nothing drags on what drifts.
    """
    return Run(system, local=MOVING) if scene.is_led else Run(system, local=CALMING, damping="combined")


@dataclass(frozen=True, eq=False)
class Push(Lead):
    """How a wall is pushed, from its rest under the dead load, until its control point has gone a `distance` [m].

    It ends before that where the live load has fallen to nothing: there the wall stands on the brink by itself.
    """

    distance: float = np.inf
    reach: float = np.inf  # how far the blocks that go farthest are expected to go [m]; the distance, if not known
    elsewhere: ControlPoint | None = None  # where displacements are read in place of a control point that stays

    @property
    def answer(self) -> str:
        """What the answer of a traverse is."""
        return "largest multiplier along the path"

    @property
    def least(self) -> float:
        """Multiplier below which brackets need not be relatively narrow."""
        system = self.run.system
        return LITTLE / (system.measure(system.live) or 1.0)

    @property
    def least_work(self) -> float:
        """Work [J] beside which the energy ledger has to add up: loads do none where nothing resists them."""
        return LITTLE * self.work_of_a_block

    @property
    def goals(self) -> Array:
        """How far the blocks that go farthest are expected to go."""
        return np.array([self.distance if np.isinf(self.reach) else self.reach])

    def moved(self, state: State) -> float:
        """Displacement of the control point along the live load since the rest under the dead load [m]."""
        return self._control(state.motion) - self._at_rest

    @cached_property
    def _at_rest(self) -> float:
        return self._control(self.start.motion)

    def _control(self, motion: Array) -> float:
        block, at, direction = self.elsewhere or self.scene.control_point
        return float(((self._places(block, np.tile(at, (len(block), 1)), motion) - at) @ direction).mean())

    def _places(self, block: Indices, at: Array, motion: Array) -> Array:
        """Where points of blocks ``(n,)``, ``(n, 2)`` [m], are in a motion ``(nd,)``, ``(n, 2)`` [m]."""
        contacts = self.run.system.contacts
        if contacts is None:
            raise TypeError("walls are pushed at finite displacements")
        return contacts.outline.points(block, at, self.run.system.motion_of_blocks(motion).ravel())

    @property
    def read_at(self) -> str:
        """Where displacements are read, if the control point stays where it is."""
        if self.elsewhere is None:
            return ""
        where = self.scene.blocks.place(self.elsewhere[1])
        return f"displacements are read at {where}, for the control point of the first live load stays where it is"

    def _read_where_it_moves(self, traverse: Traverse, motions: list[Array]) -> None:
        """Read the displacements of a traverse at the control point, or elsewhere if that stays, from its rows."""
        traverse.elsewhere = self.elsewhere
        if traverse.verdict == "stable" and self.elsewhere is None:
            return
        for place in (None, *filter(None, [self.elsewhere]), *self._others(motions[-1])):
            lead = replace(self, elsewhere=place)
            moved = [lead._control(motion) - lead._at_rest for motion in motions]
            if np.abs(moved).max() > STAYS * traverse.gone:
                traverse.elsewhere = place
                traverse.rows[:] = [row._replace(moved=at) for row, at in zip(traverse.rows, moved, strict=True)]
                return

    def _others(self, motion: Array) -> Iterator[ControlPoint]:
        """Control points of all live loads, then the corners that go farthest along each in a motion ``(nd,)``."""
        points = [load.control(self.scene) for load in self.scene.load.live]
        yield from points
        owner, corner = self.scene.blocks.owner, self.scene.blocks.vertices
        gone = self._places(owner, corner, motion) - self._places(owner, corner, self.start.motion)
        for _, _, direction in points:
            farthest = int(np.abs(gone @ direction).argmax())
            yield owner[[farthest]], corner[farthest], direction

    @cached_property
    def _load(self) -> float:
        """The live load on all that moves, at λ = 1 [N]; of couples alone, as forces that are a block apart."""
        system = self.run.system
        x, y, moment = np.where(np.isfinite(system.mass), system.live, 0.0)[system.rigid].T
        couples = np.abs(moment) / self.scene.block_sizes[system.owner]
        return float(np.hypot(x, y).sum() or couples.sum() or 1.0)

    def after(self, traverse: Traverse) -> Lead:
        """Expect blocks to go as far the next time as they went before the wall fell, and a little farther.

        Where they went on without either end in sight, as far as the control point needs them to.
        """
        lead = replace(self, elsewhere=traverse.elsewhere)
        if traverse.verdict == "collapse" and traverse.gone:
            return replace(lead, reach=self.longest * min(1.0, max(LESS, BEYOND * traverse.gone / self.longest)))
        if traverse.verdict == "undecided":
            came = abs(traverse.rows[-1].moved) / self.distance
            return replace(lead, reach=traverse.gone * min(BEYOND / max(came, LITTLE), MOST_ROWS))
        return lead

    def kept(self, traverses: list[Traverse]) -> Traverse:
        """The last that was gone to its end, if one was: the others begin ever more slowly."""
        return traverses[-2] if len(traverses) > 1 else traverses[-1]

    def onward(self, curve: Array) -> Array:
        """The curve towards the side to which the control point goes in the end: other loads may push it back."""
        return curve * (np.sign(curve[-1, 0]) or 1.0, 1.0)

    def apart(self, fast: Traverse, slow: Traverse) -> float:
        """How far curves of two speeds are apart on the average until half of the answer is left, relative to it."""
        (at, force), (other, before) = self.onward(slow.curve).T, self.onward(fast.curve).T
        top = int(force.argmax())
        lost = top + np.flatnonzero(force[top:] < HALF * force[top])
        told = slice(int(lost[0]) if len(lost) else None)
        apart = np.abs(np.interp(at[told], np.maximum.accumulate(other), before) - force[told])
        return float(apart.mean()) / slow.answer if slow.answer > self.least else 0.0

    def failing(self, curve: Array) -> int:
        """The row of a curve ``(n, 2)`` in which the wall is seen to fail: just past the peak, while it is as built."""
        return min(len(curve) - 1, int(curve[:, 1].argmax()) + SEEN)

    def before(self, curve: Array) -> str:
        """A first peak, if the multiplier fell far from it before it rose to its largest: a wall may come to lean."""
        moved, load = curve[: curve[:, 1].argmax()].T
        fallen = np.flatnonzero(load < LOSS * np.maximum.accumulate(load))
        first = int(load[: fallen[0]].argmax()) if len(fallen) else 0
        if not len(fallen) or load[first] < self.least:
            return ""
        low = number(float(load[fallen[0] :].min()))
        peak = f"{number(float(load[first]))} at {two_digits(abs(moved[first]))} m"
        return f"the multiplier had fallen from {peak} to {low} before"

    def remedy(self, curve: Array) -> str:
        """Ask for a shorter path of a wall whose peak is told by a few rows at its beginning."""
        peak = abs(curve[curve[:, 1].argmax(), 0])
        if peak > EARLY * np.abs(curve[:, 0]).max():
            return ""
        return f"the peak is at {two_digits(peak)} m: a shorter distance shows it"

    def fall(self, curve: Array) -> str:
        """How a wall has fallen at the end of its curve ``(n, 2)``."""
        (before, above), (after, below) = curve[-2:].tolist()
        if below > 0:
            return super().fall(curve)
        brink = before + (after - before) * above / (above - below)
        if abs(brink) < AT_ONCE * self.distance:
            return "the multiplier falls to nothing while the control point stays where it is"
        return f"the multiplier falls to nothing at {brink:.4g} m"

    def go(self, traverse: Traverse, speed: float) -> State:
        """Push at a speed of the blocks that go farthest [m/s]; the state at the end."""
        run, state = self.run, self.start.copy()
        self.observe(run, state, 0.0)
        self.note(traverse, state, 0.0, 0.0)
        given, seen = run.given(state), [(state.motion.copy(), self.crushed(state))]
        row_steps = self.longest / (ROWS * speed * run.dt)
        peaks = Peaks(traverse.best, row_steps, WINDOWS)
        steps = max(peaks.windows, round(row_steps))
        lengths = np.diff(np.arange(peaks.windows + 1) * steps // peaks.windows).tolist()
        most = power = speed * self._load
        for parts in _parts(peaks.windows):
            before = state.motion.copy()
            for window, (part, length) in enumerate(zip(parts, lengths, strict=True), start=1):
                multiplier = run.drive(state, part * power, length, given=given)
                peaks.see(multiplier, 0.0, length, state, len(traverse.rows) + (window > peaks.windows // 2))
                if window == peaks.windows // 2:
                    middle = state.copy()
            # What a row's multiplier is the mean of is there in its middle.
            self.note(traverse, middle, self.moved(middle), peaks.mean(peaks.windows))
            seen.append((middle.motion, self.crushed(middle)))
            if len(traverse.rows) % SEEN == 0:
                self.observe(run, state, traverse.rows[-1].force)
            went = run.system.farthest(state.motion - before)
            traverse.gone += went
            if (traverse.rows[-1].force <= 0 and traverse.answer > self.least) or self.falls(state):
                traverse.verdict = "collapse"
                break
            if abs(self.moved(state)) >= self.distance or traverse.rows[-1].force > self.most:
                break
            power = min(most, power / max(went / (speed * run.dt * np.dot(parts, lengths)), 1 / QUICKER))
        else:
            traverse.verdict = "undecided"
        self.conclude(traverse, peaks, seen)
        self._read_where_it_moves(traverse, [motion for motion, _ in seen])
        return state


def _parts(windows: int) -> Array:
    """Part of the speed in each window of each row, ``(rows, windows)``."""
    parts = [SLOWEST]
    while len(parts) < MOST_ROWS * ROWS * windows:
        parts.append(min(1.0, parts[-1] * FASTER ** (1 / windows), parts[-1] + GATHERED / windows))
    return np.reshape(parts, (-1, windows))
