"""How walls are pushed to large displacements by their live load: its power is prescribed, the multiplier follows.

The blocks that move farthest keep the same speed from row to row, whichever they are, so a push takes as long if few
blocks fall as if all do. It begins slowly, in short rows, because most walls reach their peak at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from runningbond.results.outcome import joined, number, two_digits
from runningbond.scene import Array, Indices, Scene

from .lead import ROWS, STRIDE, Lead
from .path_curve import FINAL_PART, LITTLE, LOAD_DIFFERS, LOSS
from .peaks import Peaks
from .run import CALMING, MOVING, Run
from .state import State
from .system import BlockSystem
from .traverse import Traverse

MOST_ROWS = 4
"""Most rows of a push, relative to the number needed if no block moves farther than the control point."""

MARGIN = 1.25
"""Expected displacement of blocks before a fall, relative to the last traverse: in a slower one walls fall later."""

LEAST_REACH = 0.5
"""Smallest ratio of expected displacements of two traverses: a much too fast push throws blocks off and ends early."""

START_SPEED, SPEED_GROWTH, LARGEST_GAIN = 0.01, 1.05, 0.01
"""Fraction of the speed at which a push begins, factor by which it grows per row, and largest fraction gained per row.

Acceleration takes a load that nothing balances: it is smaller the longer the acceleration takes, and least at the peak.
"""

POWER_GROWTH = 2.0
"""Largest growth of the power from one row to the next, as the displacements of the blocks become known."""

COMPARED_DOWN_TO = 0.5
"""Fraction of the largest multiplier down to which curves must converge: at the end walls fall in different ways."""

WINDOWS = 4
"""Most windows of a row whose mean multipliers are used: all blocks are pushed, and the push fluctuates with them."""

EARLY_PEAK = 0.01
"""Fraction of the path within which only the few short rows, in which a push accelerates, show a peak."""

PEAK_MULTIPLE = 5
"""Length of a shorter path that shows an early peak, relative to the displacement of that peak."""

RELAXATION_PART = 1e-6
"""Fraction of the distance by which a control point that stays in place moves because its springs relax."""

SNAP_PART, SNAP_ROWS, SNAP_LOAD = 0.002, 4, 0.05
"""A wall snaps if, in the last part of its control point's path, it moves on for some rows and loses some of its load.

Parts are relative to the path and to the largest load. It has lost its equilibrium: what blocks take as they are thrown
is no strength. A wall that tips loses its load evenly.
"""

STATIONARY_PART = 0.01
"""Largest displacement of a control point that stays in place, relative to the path of the farthest-moving blocks."""

ControlPoint: TypeAlias = tuple[Indices, Array, Array]
"""Blocks ``(n,)``, a point of each and a direction there, both ``(n, 2)``, as in `Scene.control_point`."""


def finite_run(system: BlockSystem, scene: Scene) -> Run:
    """A run of a scene's bodies at finite displacements, with the damping that suits their control.

    If a live load pushes the wall, all vibrations are damped, and drift is not slowed down.
    """
    return Run(system, local=MOVING) if scene.is_led else Run(system, local=CALMING, damping="combined")


@dataclass(frozen=True, eq=False)
class Push(Lead):
    """How a wall is pushed, from the rest under its dead load, until its control point has moved by a `distance` [m].

    The push ends earlier if the multiplier has fallen to zero: there the wall is at the limit of stability by itself.
    """

    answer = "largest multiplier along the path"

    distance: float = np.inf
    most: float = np.inf  # multiplier above which the wall is not pushed farther
    reach: float = np.inf  # expected displacement of the blocks that move farthest [m]; the distance, if unknown
    elsewhere: ControlPoint | None = None  # where displacements are read if the control point stays

    @property
    def least(self) -> float:
        """Multiplier below which brackets need not be relatively narrow."""
        system = self.run.system
        return LITTLE / (system.measure(system.live) or 1.0)

    @property
    def least_work(self) -> float:
        """Least work [J] to which the ledger's residual is relative: loads do no work if nothing resists them."""
        return LITTLE * self.work_of_a_block

    @property
    def least_friction(self) -> float:
        """None: up to the largest multiplier stiff joints let the load do little work."""
        return 0.0

    @property
    def goals(self) -> Array:
        """Expected displacement of the blocks that move farthest [m]."""
        return np.array([self.distance if np.isinf(self.reach) else self.reach])

    def moved(self, state: State) -> float:
        """Displacement of the control point along the live load since the rest under the dead load [m]."""
        return self._control(state.motion) - self._at_rest

    @cached_property
    def _at_rest(self) -> float:
        return self._control(self.start.motion)

    def _control(self, motion: Array) -> float:
        block, at, direction = self.elsewhere or self.scene.control_point
        return float(((self._places(block, at, motion) - at) * direction).sum(axis=1).mean())

    def _places(self, block: Indices, at: Array, motion: Array) -> Array:
        """Positions of points of blocks ``(n,)``, ``(n, 2)`` [m], after a motion ``(nd,)``, ``(n, 2)`` [m]."""
        contacts = self.run.system.contacts
        if contacts is None:
            raise TypeError("walls are pushed at finite displacements")
        return contacts.outline.points(block, at, self.run.system.motion_of_blocks(motion).ravel())

    @property
    def read_at(self) -> str:
        """Note on where displacements are read, if the control point stays in place."""
        if self.elsewhere is None:
            return ""
        where = self.scene.blocks.place(self.elsewhere[1][0])
        return f"displacements are read at {where}, for the control point of the first live load stays where it is"

    def _read_where_it_moves(self, traverse: Traverse, motions: list[Array]) -> None:
        """Read the displacements of a traverse at the control point, or elsewhere if that stays, from its rows."""
        traverse.elsewhere = self.elsewhere
        if traverse.verdict == "stable" and self.elsewhere is None:
            return
        for place in (None, *filter(None, [self.elsewhere]), *self._others(motions[-1])):
            lead = replace(self, elsewhere=place)
            moved = [lead._control(motion) - lead._at_rest for motion in motions]
            if np.abs(moved).max() > STATIONARY_PART * traverse.gone:
                traverse.elsewhere = place
                traverse.rows[:] = [row._replace(moved=at) for row, at in zip(traverse.rows, moved, strict=True)]
                return

    def _others(self, motion: Array) -> Iterator[ControlPoint]:
        """Control points of all live loads, then the corners that move farthest along each in a motion ``(nd,)``."""
        points = [load.control(self.scene) for load in self.scene.load.live]
        yield from points
        owner, corner = self.scene.blocks.owner, self.scene.blocks.vertices
        gone = self._places(owner, corner, motion) - self._places(owner, corner, self.start.motion)
        for _, _, (direction, *_) in points:
            farthest = int(np.abs(gone @ direction).argmax())
            yield owner[[farthest]], corner[[farthest]], direction[None]

    @cached_property
    def _load(self) -> float:
        """The live load on all moving modes at λ = 1 [N]; for couples alone, as forces one block size apart."""
        system = self.run.system
        x, y, moment = np.where(np.isfinite(system.mass), system.live, 0.0)[system.rigid].T
        couples = np.abs(moment) / self.scene.block_sizes[system.owner]
        return float(np.hypot(x, y).sum() or couples.sum() or 1.0)

    def after(self, traverse: Traverse) -> Lead:
        """Set the expected displacement from how far blocks moved before the wall fell, plus a margin.

        If the wall did not fall and its control point did not reach the distance, extrapolate to that distance.
        """
        lead = replace(self, elsewhere=traverse.elsewhere)
        if traverse.verdict == "collapse" and traverse.gone:
            return replace(lead, reach=self.longest * min(1.0, max(LEAST_REACH, MARGIN * traverse.gone / self.longest)))
        if traverse.verdict == "undecided":
            came = abs(traverse.rows[-1].moved) / self.distance
            return replace(lead, reach=traverse.gone * min(MARGIN / max(came, LITTLE), MOST_ROWS))
        return lead

    def kept(self, traverses: list[Traverse]) -> Traverse:
        """The last complete traverse, if there is one: each traverse begins more slowly than the one before."""
        return traverses[-2] if len(traverses) > 1 else traverses[-1]

    def onward(self, curve: Array) -> Array:
        """The curve, positive towards the final side of the control point: other loads may push the point back."""
        return curve * (np.sign(curve[-1, 0]) or 1.0, 1.0)

    def apart(self, fast: Traverse, slow: Traverse) -> float:
        """Mean distance of the curves at two speeds, until half of the answer is left, relative to the answer."""
        (at, force), (other, before) = self.onward(slow.curve).T, self.onward(fast.curve).T
        told = slice(self._falling(slow.curve).stop)
        apart = np.abs(np.interp(at[told], np.maximum.accumulate(other), before) - force[told])
        return float(apart.mean()) / slow.answer if slow.answer > self.least else 0.0

    @staticmethod
    def _falling(curve: Array) -> slice:
        """Rows of a curve ``(n, 2)`` from its largest multiplier to half of that."""
        force = curve[:, 1]
        top = int(force.argmax())
        lost = top + np.flatnonzero(force[top:] < COMPARED_DOWN_TO * force[top])
        return slice(top, int(lost[0]) if len(lost) else None)

    def failing(self, curve: Array) -> int:
        """Row of a curve ``(n, 2)`` in which the wall fails: just after the peak, while it is nearly undeformed."""
        return min(len(curve) - 1, int(curve[:, 1].argmax()) + STRIDE)

    def before(self, curve: Array) -> str:
        """Note on a first peak, if the multiplier fell far from it before rising to its largest: a wall may lean."""
        moved, load = curve[: curve[:, 1].argmax()].T
        fallen = np.flatnonzero(load < LOSS * np.maximum.accumulate(load))
        first = int(load[: fallen[0]].argmax()) if len(fallen) else 0
        if not len(fallen) or load[first] < self.least:
            return ""
        low = number(float(load[fallen[0] :].min()))
        peak = f"{number(float(load[first]))} at {two_digits(abs(moved[first]))} m"
        return f"the multiplier had fallen from {peak} to {low} before"

    def remedy(self, fast: Traverse, slow: Traverse, tolerance: float) -> str:
        """Advice to shorten the path: to where both speeds agree, or if only its first few rows show the peak."""
        curve = self.onward(slow.curve)
        if peak := self._early_peak(curve):
            return f"the peak is at {two_digits(peak)} m: a shorter distance shows it"
        agreed, most = self._agreed(self.onward(fast.curve), curve, tolerance)
        if agreed:
            return f"up to {two_digits(agreed)} m it is {number(most)} at both: a shorter distance may answer"
        return ""

    def nearer(self, fast: Traverse, slow: Traverse, tolerance: float) -> float | None:
        """A distance within which more rows show an early peak, or up to which both speeds agree."""
        curve = self.onward(slow.curve)
        if peak := self._early_peak(curve):
            return PEAK_MULTIPLE * peak
        return self._agreed(self.onward(fast.curve), curve, tolerance)[0] or None

    @staticmethod
    def _early_peak(curve: Array) -> float:
        """Displacement [m] at the largest multiplier of a curve ``(n, 2)`` if only its first few rows show it; or 0."""
        peak = abs(float(curve[curve[:, 1].argmax(), 0]))
        return peak if peak <= EARLY_PEAK * np.abs(curve[:, 0]).max() else 0.0

    def shorter(self, traverse: Traverse) -> str:
        """Advice on a traverse that failed after a peak."""
        curve = traverse.curve
        if not len(curve):
            return ""
        if earlier := self.before(curve):
            return f"{earlier}: take a shorter distance"
        if curve[-1, 1] >= curve[:, 1].max():
            return ""
        came = two_digits(abs(curve[-1, 0]))
        return f"the wall had passed its largest multiplier, and came to {came} m: take a shorter distance"

    @staticmethod
    def _agreed(fast: Array, slow: Array, tolerance: float) -> tuple[float, float]:
        """Displacement [m] up to which another speed and a longer path hardly change a largest load, and that load.

        Zeros if there is none, or if it is the largest displacement of the slow curve; curves are ``(n, 2)``. A control
        point may go back on its way.
        """
        (other, before), (at, force) = np.maximum.accumulate(fast).T, np.maximum.accumulate(slow).T
        changed = np.abs(np.interp(at, other, before) - force)
        grown = force - np.interp((1 - FINAL_PART) * at, at, force)
        alike = np.maximum(changed, grown) <= tolerance * force
        agreed = int(np.flatnonzero(alike & (force > 0) & (at > EARLY_PEAK * at[-1]))[-1:].sum())
        came = np.maximum.accumulate(np.abs(slow[:, 0]))
        if came[agreed] > (1 - EARLY_PEAK) * came[-1]:
            return 0.0, 0.0
        return float(came[agreed]), float(force[agreed])

    def fall(self, traverse: Traverse) -> str:
        """Note on how a wall has fallen at the end of a traverse."""
        (before, above), (after, below) = traverse.curve[-2:].tolist()
        if below > 0:
            return super().fall(traverse)
        brink = before + (after - before) * above / (above - below)
        if abs(brink) < RELAXATION_PART * self.distance:
            return "the multiplier falls to nothing while the control point stays where it is"
        moved, load = traverse.curve.T
        going = np.abs(moved) < (1 - SNAP_PART) * abs(brink)
        last = float(load[going][-1:].sum())
        if np.count_nonzero(~going) < SNAP_ROWS or last <= SNAP_LOAD * traverse.answer:
            return f"the multiplier falls to nothing at {brink:.4g} m"
        return f"the multiplier falls from {number(last)} to nothing at {brink:.4g} m, where the wall snaps"

    def doubt(self, traverse: Traverse, tolerance: float) -> str:
        """Note on a load that depends on how joints slid, and on blocks that vibrate without end."""
        slid = self.friction_note(traverse, tolerance, LOAD_DIFFERS, until=traverse.largest + 1)
        return joined(slid, self._vibrating(traverse, tolerance))

    def _vibrating(self, traverse: Traverse, tolerance: float) -> str:
        """Note on blocks that vibrate without end, as friction can make them: damping takes a part of the load."""
        least, answer = tolerance * traverse.answer, traverse.answer
        if traverse.drag > least:
            taken = f"takes {two_digits(100 * traverse.drag / answer)} % of the load at its largest"
            return f"blocks vibrate: damping {taken}, and the wall may bear less by as much"
        if traverse.late_drag > least:
            taken = f"takes up to {two_digits(100 * traverse.late_drag / answer)} % of its largest"
            return f"blocks vibrate as the multiplier falls: damping {taken}, by which the curve there may be too high"
        return ""

    def _damped(self, state: State) -> float:
        """Work of the damping of all bodies [J]."""
        return float(state.damped[np.isfinite(self.run.system.mass)].sum())

    def go(self, traverse: Traverse, speed: float) -> State:
        """Push at a speed of the blocks that move farthest [m/s]; return the state at the end."""
        run, state = self.run, self.start.copy()
        self.observe(run, state, 0.0)
        self.note(traverse, state, 0.0, 0.0)
        given, seen = run.given(state), [(state.motion.copy(), self.crushed(state))]
        row_steps = self.longest / (ROWS * speed * run.dt)
        peaks = Peaks(traverse.best, row_steps, WINDOWS)
        steps = max(peaks.windows, round(row_steps))
        lengths = np.diff(np.arange(peaks.windows + 1) * steps // peaks.windows).tolist()
        most = power = speed * self._load
        drags = list[float]()
        for parts in _parts(peaks.windows):
            before, full_way, taken = state.motion.copy(), 0.0, self._damped(state)
            for window, (part, length) in enumerate(zip(parts, lengths, strict=True), start=1):
                since, damped = state.time, self._damped(state)
                multiplier = run.drive(state, part * power, length, given=given)
                full_way += part * speed * (state.time - since)
                drag = max(0.0, self._damped(state) - damped) / (part * power * (state.time - since))
                drag = min(drag, max(multiplier, 0.0))  # of a fall it is many times the work of the load
                peaks.see(multiplier, drag, length, state, len(traverse.rows) + (window > peaks.windows // 2))
                if window == peaks.windows // 2:
                    middle = state.copy()
            # The mean multiplier of a row belongs to the middle of the row.
            self.note(traverse, middle, self.moved(middle), peaks.mean(peaks.windows))
            drags.append((self._damped(state) - taken) / (full_way * power / speed))
            seen.append((middle.motion, self.crushed(middle)))
            if len(traverse.rows) % STRIDE == 0:
                self.observe(run, middle, traverse.rows[-1].force)
            went = run.system.farthest(state.motion - before)
            traverse.gone += went
            if (traverse.rows[-1].force <= 0 and traverse.answer > self.least) or self.falls(state):
                traverse.verdict = "collapse"
                break
            if abs(self.moved(state)) >= self.distance or traverse.rows[-1].force > self.most:
                break
            power = min(most, power / max(went / full_way, 1 / POWER_GROWTH))
        else:
            traverse.verdict = "undecided"
        # Where a wall snaps, the work of its fall is damped, many times that of the load: no more than λ can be lost.
        loads = traverse.curve[1:]
        lost = np.minimum(drags, np.maximum(loads[:, 1], 0.0))[self._falling(loads)]
        traverse.late_drag = float(lost.max(initial=0.0))
        self.conclude(traverse, peaks, seen)
        # The drag was seen in place of the inertia, which is no part of a push whose power is kept.
        traverse.drag, traverse.inertia = traverse.inertia, 0.0
        self._read_where_it_moves(traverse, [motion for motion, _ in seen])
        return state


def _parts(windows: int) -> Array:
    """Fraction of the speed in each window of each row, ``(rows, windows)``."""
    parts = [START_SPEED]
    while len(parts) < MOST_ROWS * ROWS * windows:
        parts.append(min(1.0, parts[-1] * SPEED_GROWTH ** (1 / windows), parts[-1] + LARGEST_GAIN / windows))
    return np.reshape(parts, (-1, windows))
