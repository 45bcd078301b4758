"""How walls are led: a beam along its path at a slow speed, supports to their settlement from rest to rest."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from runningbond.joints import JointPoints, wall_caps
from runningbond.scene import Array, Indices, Mask, Scene

from .collapse import Criteria, Verdict, hold_load
from .growth import NEARLY_AT_REST
from .peaks import Peaks
from .run import Observer, Run
from .state import State

ROWS, LEAST_ROWS = 200, 40
"""Rows of the curve in the longest leg of a drive, and at least in each."""

SOFT = 10
"""Rows in which a leg gathers its speed, and in which it slows down to turn."""

SEEN = 10
"""Rows between two looks of an observer, and over which a mechanism is drawn."""

STAGES = 20
"""Rests along the path of a settlement."""

WINDOW = 25
"""Least steps between two changes of the speed of supports: each is a knock, and knocks shake friction loose."""


LOSS = 0.8
"""Share of the largest force to which it falls where the wall has failed, and its mechanism is drawn."""

LAST = 0.1
"""Part of a path over which a force that has formed a mechanism no longer changes."""

STILL = 1e-6
"""Change of a share that counts as none, beside the tolerance's part of all its change."""

SAME = 1e-9
"""Part of a path by which rounding may set places apart that are one."""

ASIDE = 0.05
"""Part of a path to one side that still counts as coming back to rest, if it is to the other side."""

COME_DOWN = 0.5
"""Sizes of a block by which all of the dead load has come down, or what would do as much work, once a wall falls."""

IN_MOTION = 0.5
"""Part of that work, less what damping takes, which is in motion then."""

LAG = 5e-3
"""Part of that work which one time step may do: velocities are half a step behind, and the ledger misses half of it."""

LITTLE = 0.01
"""Share of the dead load below which a reaction need not be relatively accurate."""

TOE = "broken toe [m]"
BEAM = ("beam rotation [rad]", "beam uplift [m]", "work spent in joints [J]", TOE)
"""What else is known of each row of a beam's path."""


class TraverseRow(NamedTuple):
    """What was seen at one place of the path."""

    moved: float  # displacement [m], or part of a settlement
    force: float  # reaction [N], or share of the dead load
    carried: Array  # (np, 2) forces of joint points [N], or, at finite displacements, (n, 3) `Run.resultants`
    tie: Array  # (nt,) forces of the ties [N]
    works: tuple[float, float]  # of the dead load and of what leads [J]
    beam: tuple[float, ...]  # `BEAM` of one that is driven, else nothing


@dataclass
class Traverse:
    """One traverse of the path from a state at rest: what was seen, and the answer."""

    best: State  # where the answer is
    motion: Array  # (nd,) how the wall moved where it had come farthest
    moves: bool  # whether forces are means of a motion, and not of rests
    rows: list[TraverseRow] = field(default_factory=list)
    verdict: Verdict = "stable"
    unseen: float = 0.0  # what the answer may be larger, for means over windows take from peaks
    inertia: float = 0.0  # and smaller, for bodies that speed up; or either, where motion takes from friction
    crushed: Array = field(default_factory=lambda: np.zeros((0, 2)))  # of joints' ends there [m], closed for good
    gone: float = 0.0  # how far the blocks that go farthest have gone in each row of a push, in all [m]
    elsewhere: tuple[Indices, Array, Array] | None = None  # where its displacements are, if the control point stays
    lasting: float = 0.0  # largest mean force over a whole row of a motion
    resolved: bool = True  # whether means over ever shorter parts of its path add next to nothing to the answer

    @property
    def curve(self) -> Array:
        """Displacement [m] and force, ``(n, 2)``."""
        return np.array([(row.moved, row.force) for row in self.rows])

    @property
    def answer(self) -> float:
        """The force at the end of a path from rest to rest, the largest one of a motion."""
        return float(self.curve[:, 1].max() if self.moves else self.curve[-1, 1])

    def calm(self) -> None:
        """Take the middle one of three forces for each row of a motion but the first and the last, in place."""
        force = np.array([row.force for row in self.rows])
        for k in range(1, len(force) - 1) if self.moves else ():
            self.rows[k] = self.rows[k]._replace(force=float(np.median(force[k - 1 : k + 2])))


@dataclass(frozen=True, eq=False)
class Lead:
    """How a wall is led, from its rest under the dead load."""

    scene: Scene
    run: Run
    start: State
    criteria: Criteria
    observe: Observer
    points: JointPoints  # of the joints, in the order of `Run.at_joints`
    most: float = np.inf  # force beyond which the wall is led no more

    @property
    def answer(self) -> str:
        """What the answer of a traverse is."""
        share, reaction = "share of the dead load on the support", "largest reaction of the drive along its path"
        return share if self.settles else reaction

    @property
    def read_at(self) -> str:
        """What is to be said of where displacements are read."""
        return ""

    @property
    def settles(self) -> bool:
        """Whether supports are led, not the beam."""
        return self.scene.settlement is not None

    @property
    def least(self) -> float:
        """Answer below which brackets need not be relatively narrow: a share of the dead load, or none of a force."""
        return LITTLE if self.settles else 0.0

    @property
    def least_work(self) -> float:
        """Work [J] beside which the energy ledger has to add up, where the loads do less."""
        return LITTLE * self.run.system.carried.work

    @property
    def goals(self) -> Array:
        """Displacements along the first move [m], or parts of the settlement, one after the other."""
        drive = self.scene.drive
        if self.scene.settlement is not None:
            return np.array(self.scene.settlement.path)
        return np.ones(1) if drive is None else drive.force[0] * np.array(drive.path)

    @property
    def beam(self) -> int:
        """The block that is the beam."""
        if self.scene.beam is None or self.scene.beam.block is None:
            raise TypeError("only a beam is driven")
        return self.scene.beam.block

    @property
    def longest(self) -> float:
        """Longest leg."""
        return float(np.abs(np.diff(self.goals, prepend=0.0)).max())

    def share(self, state: State, speed: float, steps: int, given: float) -> float:
        """Move supports, in place; the share of the dead load that they bear meanwhile."""
        return self.run.carry(state, speed, steps, given=given) / self.run.system.carried.work

    def note(self, traverse: Traverse, state: State, moved: float, force: float) -> None:
        """Add a row of a state to a traverse."""
        run, beam = self.run, tuple[float, ...]()
        small = run.system.contacts is None
        carried = np.column_stack(run.forces(state)) if small else run.resultants(state, force)
        if not self.settles and self.scene.beam is not None:
            _, uplift, rotation = run.system.motion_of_blocks(state.motion - self.start.motion)[self.beam]
            beam = rotation, uplift, run.ledger(state).friction, self.broken_toe(state, moved)
        dead = run.dead_work(state)
        tie = run.system.ties.force(state.motion, state.stretch)
        traverse.rows.append(TraverseRow(moved, force, carried, tie, (dead, state.external - dead), beam))

    def broken_toe(self, state: State, moved: float) -> float:
        """How far a toe has been crushed, or blocks have split there [m], whichever is more.

        The toe is the lower half of the outer quarter of the wall, on the side that it is pushed to.
        """
        opening, *_, damage, crushed = self.run.at_joints(state)
        split = np.where(self._is_inner & (damage >= 1), np.maximum(opening, 0.0), 0.0)
        drive = self.scene.drive
        right = drive is None or moved * drive.force[0] >= 0
        return float(np.maximum(crushed, split)[self._toes[int(right)]].max(initial=0.0))

    @cached_property
    def _is_inner(self) -> Mask:
        inner, joint = self.scene.joints.inner, self.points.joint
        return np.append(inner, True)[np.minimum(joint, len(inner))]  # joints beyond the scene's are between triangles

    @cached_property
    def _toes(self) -> tuple[Mask, Mask]:
        """The points of the left and of the right toe."""
        (left, bottom), (right, top) = self.scene.blocks.extent(self.scene.masonry)
        x, y = self.points.position.T
        # Joints at half the height, and points at the quarters, are of a toe, whatever the last bit of a sum of sizes.
        reach = self.scene.blocks.tolerance
        low, width = y <= (bottom + top) / 2 + reach, (right - left) / 4 + reach
        return low & (x <= left + width), low & (x >= right - width)

    def go(self, traverse: Traverse, speed: float) -> State:
        """Go through the path, at a largest speed [m/s, or settlements/s], to the state at its end."""
        state = self.start.copy()
        (self._settle if self.settles else self._drive)(traverse, state, speed)
        return state

    def after(self, traverse: Traverse) -> "Lead":
        """How it is led the next time, after a traverse."""
        return self

    def kept(self, traverses: list[Traverse]) -> Traverse:
        """What is kept of traverses of which the last was interrupted."""
        return traverses[-1]

    def apart(self, fast: Traverse, slow: Traverse) -> float:
        """How far curves of two speeds are apart, relative to the answer, where they are told beside it."""
        return 0.0

    def failing(self, curve: Array) -> int:
        """The row of a curve ``(n, 2)`` in which the wall is seen to fail."""
        return failing(curve)

    def onward(self, curve: Array) -> Array:
        """A curve ``(n, 2)`` with its displacement counted towards where walls are to fail."""
        return curve

    def before(self, curve: Array) -> str:
        """What is to be said of a curve ``(n, 2)`` on its way to the answer."""
        return ""

    def remedy(self, curve: Array) -> str:
        """What to do where speeds differ on the answer of a curve ``(n, 2)``."""
        return ""

    def fall(self, curve: Array) -> str:
        """How a wall has fallen at the end of its curve ``(n, 2)``."""
        if self.settles:
            return f"the wall falls beyond {abs(curve[-1, 0]):.4g} m, this is of its last rest"
        return f"the wall falls beyond {np.abs(curve[:, 0]).max():.4g} m"

    def crushed(self, state: State) -> Array:
        """How far joints have closed for good at their ends [m], ``(nj, 2)``; empty where none crushes."""
        return np.asarray(self.run.at_joints(state)[5, self._ends]) if self._has_caps else np.zeros((0, 2))

    @cached_property
    def _has_caps(self) -> bool:
        """Whether a joint of the scene crushes."""
        return bool(np.isfinite(wall_caps(self.scene, self.points.joint[self._ends].ravel())[0]).any())

    @cached_property
    def _ends(self) -> Indices:
        """The first and the last point of each joint of the scene ``(nj, 2)``."""
        own = np.flatnonzero(self.points.joint < len(self.scene.joints))
        joint, (start, end) = self.points.joint[own], self.scene.joints.ends.swapaxes(0, 1)
        along = ((self.points.position[own] - start[joint]) * (end - start)[joint]).sum(axis=1)
        order = np.lexsort((along, joint))
        last = np.cumsum(np.bincount(joint, minlength=len(start)))
        return np.asarray(own[order[np.column_stack([np.append(0, last[:-1]), last - 1])]])

    def _drive(self, traverse: Traverse, state: State, speed: float) -> None:
        run, at = self.run, 0.0
        self.observe(run, state, 0.0)
        # At finite displacements blocks knock at one another all along, which means over rows leave out.
        knock = run.system.contacts is not None
        self.note(traverse, state, 0.0, 0.0)
        mobility = float((run.system.live**2 / run.system.mass).sum())
        given, seen = run.given(state), [(state.motion.copy(), self.crushed(state))]
        peaks = Peaks(traverse.best, self.longest / (ROWS * speed * run.dt))
        for goal in self.goals.tolist():
            if goal == at or traverse.verdict != "stable":
                continue
            n = max(LEAST_ROWS, round(ROWS * abs(goal - at) / self.longest))
            pace = _pace(n, peaks.windows)
            steps = max(peaks.windows, round(abs(goal - at) / (speed * run.dt * pace.mean(axis=1).sum())))
            lengths = np.diff(np.arange(peaks.windows + 1) * steps // peaks.windows)
            top = (goal - at) / (run.dt * float((pace @ lengths).sum()))
            for k, parts in enumerate(pace.tolist()):
                for window, (part, length) in enumerate(zip(parts, lengths.tolist(), strict=True), start=1):
                    before, gathered = run.driven_speed(state), self._gathered(state)
                    force = run.drive(state, top * part, length, given=given)
                    force -= (top * part - before) / (mobility * length * run.dt)  # the driven body's own inertia
                    inertia = 0.0 if knock and k >= SOFT else (self._gathered(state) - gathered) / (length * run.dt)
                    peaks.see(force, inertia, length, state, len(traverse.rows) + (window > peaks.windows // 2))
                    if window == peaks.windows // 2:
                        middle = state.copy()
                # What a row's forces are the mean of is there in its middle.
                self.note(traverse, middle, self.moved(middle), peaks.mean(peaks.windows))
                seen.append((middle.motion, self.crushed(middle)))
                if (k + 1) % SEEN == 0:
                    self.observe(run, state, traverse.rows[-1].force)
                if self.falls(state):
                    traverse.verdict = "collapse"
                    break
            at = goal
            self.note(traverse, state, self.moved(state), traverse.rows[-1].force)
            seen.append((state.motion.copy(), self.crushed(state)))
        self.conclude(traverse, peaks, seen)

    def conclude(self, traverse: Traverse, peaks: Peaks, seen: list[tuple[Array, Array]]) -> None:
        """Take the answer of a traverse from its peaks, its mechanism from motions and crushing `seen` at its rows."""
        traverse.calm()
        peak, between, traverse.unseen, traverse.resolved = peaks.resolved()
        traverse.best, traverse.inertia, traverse.lasting = peak.state, peak.inertia, peaks.longest.force
        if between:
            self.note(traverse, peak.state, self.moved(peak.state), peak.force)
            traverse.rows.insert(peak.row, traverse.rows.pop())
            seen.insert(peak.row, (peak.state.motion, self.crushed(peak.state)))
        row = self.failing(traverse.curve)
        traverse.motion = seen[row][0] - seen[max(0, row - SEEN)][0]
        # The most so far: joints that have parted since have been crushed too.
        traverse.crushed = np.max([crushed for _, crushed in seen[: row + 1]], axis=0)

    def falls(self, state: State) -> bool:
        """Whether the dead load has come down far, and most of its work is in motion: what is led does little of any.

        A beam that nothing bears any more would be followed through the wall and the ground.
        """
        run, system = self.run, self.run.system
        given = run.dead_work(state) - run.dead_work(self.start)
        if given <= max(COME_DOWN * self.work_of_a_block, run.dt * float(system.dead @ state.velocity) / LAG):
            return False
        return system.kinetic_energy(state.velocity) > IN_MOTION * (1 - run.local) * given

    @cached_property
    def work_of_a_block(self) -> float:
        """Work of the dead load [J] where all that moves comes down by the size of a block."""
        system = self.run.system
        load = np.where(np.isfinite(system.mass), system.dead, 0.0)[system.rigid[:, :2]]
        return float(np.hypot(*load.T).sum() * self.scene.block_size)

    def _gathered(self, state: State) -> float:
        """Momentum along the drive of all bodies but the one driven, and what damping takes as they gather it [N s]."""
        system = self.run.system
        along = system.rigid[system.owner != self.beam, 0]
        along = along[np.isfinite(system.mass[along])]
        return float(system.mass[along] @ state.velocity[along]) / (1 - self.run.local)

    def moved(self, state: State) -> float:
        """How far what is driven has gone since the rest under the dead load [m]."""
        return self.run.driven(state) - self.run.driven(self.start)

    def _settle(self, traverse: Traverse, state: State, speed: float) -> None:
        run, given = self.run, self.run.given(state)
        motion, far, _ = run.system.carried
        self.note(traverse, state, 0.0, self.share(state, 0.0, self.criteria.interval, given))
        self.observe(run, state, traverse.rows[-1].force)
        rows = 2 * SOFT
        stage = rows / (STAGES * speed * run.dt * _pace(rows).sum())
        windows = windows_of_stage(stage)
        pace = _pace(rows, windows).ravel()
        steps = max(1, round(stage / len(pace)))
        # Small at first on each leg, where reactions change most.
        shares, legs = np.linspace(0.0, 1.0, STAGES + 1) ** 2, pairwise([0.0, *self.goals.tolist()])
        stages = [0.0, *(at + (goal - at) * share for at, goal in legs if goal != at for share in shares.tolist()[1:])]
        for number, (before, settled) in enumerate(pairwise(stages), start=2):
            top = (settled - before) / (run.dt * steps * pace.sum())
            moving = [self.share(state, top * part, steps, given) for part in pace.tolist()]
            state.velocity[motion != 0] = 0.0
            rest = self.criteria.rest if number == len(stages) else NEARLY_AT_REST
            traverse.verdict, _ = hold_load(run, state, 0.0, replace(self.criteria, rest=rest))
            fell = traverse.verdict != "stable"
            # Of a fall through finite displacements the last rest is shown, for blocks may have turned by any angle.
            if not fell or run.system.contacts is None:
                traverse.motion, traverse.crushed = state.motion - self.start.motion, self.crushed(state)
            if fell:
                return
            bears = self.share(state, 0.0, self.criteria.interval, given)
            # In the end supports hardly move. What changes as they stop is friction that motion has shaken loose.
            traverse.unseen = traverse.inertia = abs(bears - float(np.mean(moving[-max(1, windows // 4) :])))
            self.note(traverse, state, far * settled, bears)
            traverse.best = state.copy()
            self.observe(run, state, bears)


def windows_of_stage(steps: float) -> int:
    """Windows of one speed in each row of a stage of so many steps, whole but for rounding."""
    # Four windows stay four where a time step's last bit makes 1999.999 steps of 2000.
    return max(1, round(steps) // (2 * SOFT * WINDOW))


def goes_both_ways(goals: Array) -> bool:
    """Whether a path from zero to some goals ``(n,)``, one after the other, goes to both sides.

    It does not where it comes back to where it began, if a little beyond.
    """
    most = float(np.abs(goals).max(initial=0.0))
    return bool(goals.max(initial=0.0) > ASIDE * most and goals.min(initial=0.0) < -ASIDE * most)


def last_leg(curve: Array) -> Array:
    """The rows of a path's curve ``(n, 2)`` since it last turned round, its displacement counted from there."""
    senses = np.sign(np.diff(curve[:, 0]))
    start = int(np.flatnonzero(senses != senses[-1])[-1]) + 1 if (senses != senses[-1:]).any() else 0
    return np.column_stack([np.abs(curve[start:, 0] - curve[start, 0]), curve[start:, 1]])


def formed(curve: Array, tolerance: float, *, settles: bool, least: float = 0.0, still: float = 0.0) -> bool:
    """Whether a mechanism has formed: whether nothing grows, or changes, over the last part of a path.

    Parameters
    ----------
    curve : (n, 2) float
        Displacement and force, or share of the dead load.
    tolerance
        Part of the force by which it may still grow; of all its change, by which a share may still change.
    settles
        Whether supports are led. An elastic wall sheds load too: of a short path hardly any, and the same all along.
    least
        Force below which growth need not be small.
    still
        Change of a share that motion may have made, which counts as none: one that was there from the start may be all.
    """
    value, force = (last_leg(curve) if settles else curve).T
    late = value >= (1 - LAST) * value.max()
    if settles:
        return bool(np.ptp(force[late]) <= tolerance * np.ptp(force) + max(still, STILL))
    most = float(force[late].max())
    return most - float(force[~late].max(initial=0.0)) <= tolerance * max(most, least)


def shedding(curve: Array) -> tuple[bool, str]:
    """Whether the share on a support falls where a path ends, and what that is called: it may be negative.

    Where it changes no more over the last part, by the whole leg.
    """
    value, share = last_leg(curve).T
    late = share[value >= (1 - LAST) * value.max()]
    first, last = late[0] if abs(late[-1] - late[0]) > STILL else share[0], share[-1]
    return bool(last <= first), "sheds load" if abs(last) <= abs(first) else "takes up load"


def failing(curve: Array) -> int:
    """The row of a curve of a drive ``(n, 2)`` in which a wall is seen to fail.

    Where the force has first fallen to `LOSS` of its largest on the way farther; else the farthest one.
    """
    moved, force = curve.T
    same = SAME * np.abs(moved).max()  # an amplitude that comes again is no farther than before, but for rounding
    onward = np.append(True, moved[1:] > np.maximum.accumulate(moved)[:-1] + same)
    top = int(force.argmax())
    fallen = top + np.flatnonzero(onward[top:] & (force[top:] <= LOSS * force[top]))
    return int(fallen[0]) if len(fallen) else int(np.argmax(moved >= moved.max() - same))


def _pace(rows: int, windows: int = 1) -> Array:
    """Part of the top speed in each window of each row ``(rows, windows)`` of a leg, which starts and ends softly."""
    k = (np.arange(rows * windows) + 0.5) / windows
    return np.asarray(np.minimum(1.0, np.minimum(k, rows - k) / SOFT)).reshape(rows, windows)
