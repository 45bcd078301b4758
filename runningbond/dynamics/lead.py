"""How prescribed displacements are applied: to a beam along its path at a slow speed, to supports from rest to rest."""

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
"""Rows of the curve in the longest leg of a drive, and the smallest number of rows in any leg."""

RAMP = 10
"""Rows in which a leg accelerates to its speed, and in which it slows down before it turns."""

STRIDE = 10
"""Rows between two calls of an observer, and over which the motion of a mechanism is taken."""

STAGES = 20
"""Number of rests in each leg of the path of a settlement."""

FALL_PART = 0.003
"""Largest distance between the last rest of a settlement and its fall, relative to the settlement at the fall."""

SUPPORT_WINDOW_STEPS = 25
"""Least time steps between two changes of the speed of supports: each change is a shock that loosens friction."""


LOSS = 0.8
"""Fraction of the largest force: once the force has fallen to it the wall has failed, and its mechanism is drawn."""

FINAL_PART = 0.1
"""Last part of a path, over which a share no longer changes, and a force no longer grows, if a mechanism has formed."""

FINAL_ROWS = 40
"""Number of places in this part at which a force is read to find its slope."""

SCATTERS = 3.0
"""Ratio of a slope to its standard error below which it is none."""

UNCHANGED = 1e-6
"""Change of the share on a support that counts as none, in addition to the tolerance times its total change."""

PATH_ROUNDING = 1e-9
"""Difference of two displacements, relative to the largest one, that is only rounding."""

OVERSHOOT = 0.05
"""Displacement to the other side, relative to the largest one, up to which a path only returns to its start."""

FALL_DESCENT = 0.5
"""Descent of the whole dead load, in block sizes, whose work must at least be done before a wall counts as falling."""

FALL_KINETIC = 0.5
"""Fraction of that work, less what local damping dissipates, that must be kinetic energy in a fall."""

STEP_WORK = 5e-3
"""Largest fraction of that work in one time step: velocities lag by half a step, and the ledger misses half of it."""

LITTLE = 0.01
"""Fraction of the dead load below which a reaction need not be accurate relative to itself."""

TOE = "broken toe [m]"
BEAM = ("beam rotation [rad]", "beam uplift [m]", "work spent in joints [J]", TOE)
"""Further columns for each row of a beam's path."""


class Place(NamedTuple):
    """Place on the path of a settlement."""

    way: float  # length of the path up to there, as a fraction of the settlement
    settled: float  # fraction of the settlement


class TraverseRow(NamedTuple):
    """Observations at one place of the path."""

    moved: float  # displacement [m], or fraction of the settlement
    force: float  # reaction [N], or share of the dead load
    carried: Array  # (np, 2) forces of joint points [N], or, at finite displacements, (n, 3) `Run.resultants`
    tie: Array  # (nt,) forces of the ties [N]
    works: tuple[float, float]  # work of the dead load, and of the prescribed displacement or the live load [J]
    beam: tuple[float, ...]  # `BEAM` if the beam is driven, otherwise empty


@dataclass
class Traverse:
    """One traverse of the path from a state at rest: its observations and its answer."""

    best: State  # state at which the answer is reached
    motion: Array  # (nd,) motion of the wall at the farthest displacement, or where it fails
    moves: bool  # whether forces are means during motion, not values at rest
    rows: list[TraverseRow] = field(default_factory=list)
    verdict: Verdict = "stable"
    unseen: float = 0.0  # by how much the answer may be larger: means over windows flatten peaks
    inertia: float = 0.0  # by how much smaller, as bodies accelerate; in settlements both are due to loosened friction
    crushed: Array = field(default_factory=lambda: np.zeros((0, 2)))  # permanent closure at the joints' ends there [m]
    gone: float = 0.0  # sum over the rows of a push of how far the farthest blocks moved [m]
    elsewhere: tuple[Indices, Array, Array] | None = None  # where displacements are read if the control point stays
    lasting: float = 0.0  # largest mean force over a whole row during motion
    fall: tuple[Place, Place] | None = None  # of the last rest, and of the fall, on supports that move
    resolved: bool = True  # whether means over shorter and shorter windows add almost nothing to the answer

    @property
    def curve(self) -> Array:
        """Displacement [m] and force, ``(n, 2)``."""
        return np.array([(row.moved, row.force) for row in self.rows])

    @property
    def answer(self) -> float:
        """The force at the end of a path from rest to rest, or the largest force during a motion."""
        return float(self.curve[:, 1].max() if self.moves else self.curve[-1, 1])

    def calm(self) -> None:
        """Replace the force of each row of a motion, except the first and last, by the median of three, in place."""
        force = np.array([row.force for row in self.rows])
        for k in range(1, len(force) - 1) if self.moves else ():
            self.rows[k] = self.rows[k]._replace(force=float(np.median(force[k - 1 : k + 2])))


@dataclass(frozen=True, eq=False)
class Lead:
    """How prescribed displacements are applied, from the rest under the dead load on."""

    scene: Scene
    run: Run
    start: State
    criteria: Criteria
    observe: Observer
    points: JointPoints  # joint points, in the order of `Run.at_joints`
    most: float = np.inf  # force above which the wall is not pushed farther

    @property
    def answer(self) -> str:
        """Name of the answer of a traverse."""
        share, reaction = "share of the dead load on the support", "largest reaction of the drive along its path"
        return share if self.settles else reaction

    @property
    def read_at(self) -> str:
        """Note on where displacements are read; may be empty."""
        return ""

    @property
    def settles(self) -> bool:
        """Whether supports settle; otherwise the beam is driven."""
        return self.scene.settlement is not None

    @property
    def least(self) -> float:
        """Answer below which brackets need not be relatively narrow: a share of the dead load, or zero for a force."""
        return LITTLE if self.settles else 0.0

    @property
    def least_work(self) -> float:
        """Least work [J] relative to which the residual of the energy ledger is judged."""
        return LITTLE * self.run.system.carried.work

    @property
    def goals(self) -> Array:
        """Displacements along the first move [m], or fractions of the settlement, one after the other."""
        drive = self.scene.drive
        if self.scene.settlement is not None:
            return np.array(self.scene.settlement.path)
        return np.ones(1) if drive is None else drive.force[0] * np.array(drive.path)

    @property
    def beam(self) -> int:
        """Number of the block that is the beam."""
        if self.scene.beam is None or self.scene.beam.block is None:
            raise TypeError("only a beam is driven")
        return self.scene.beam.block

    @property
    def longest(self) -> float:
        """Length of the longest leg."""
        return float(np.abs(np.diff(self.goals, prepend=0.0)).max())

    def share(self, state: State, speed: float, steps: int, given: float) -> float:
        """Move supports, in place; return the mean share of the dead load that they carry."""
        return self.run.carry(state, speed, steps, given=given) / self.run.system.carried.work

    def note(self, traverse: Traverse, state: State, moved: float, force: float) -> None:
        """Append a row for a state to a traverse."""
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
        """Depth to which a toe has been crushed, or opening of cracks within blocks there [m], whichever is larger.

        The toe is the lower half of the outer quarter of the wall, on the side towards which the wall is pushed.
        """
        opening, *_, damage, crushed = self.run.at_joints(state)
        split = np.where(self._is_inner & (damage >= 1), np.maximum(opening, 0.0), 0.0)
        drive = self.scene.drive
        right = drive is None or moved * drive.force[0] >= 0
        return float(np.maximum(crushed, split)[self._toes[int(right)]].max(initial=0.0))

    @cached_property
    def _is_inner(self) -> Mask:
        inner, joint = self.scene.joints.inner, self.points.joint
        return np.append(inner, True)[np.minimum(joint, len(inner))]  # higher numbers are joints between triangles

    @cached_property
    def _toes(self) -> tuple[Mask, Mask]:
        """The points of the left and of the right toe."""
        (left, bottom), (right, top) = self.scene.blocks.extent(self.scene.masonry)
        x, y = self.points.position.T
        # Joints at half the height and points at the quarters belong to the toe in spite of rounding in a sum of sizes.
        reach = self.scene.blocks.tolerance
        low, width = y <= (bottom + top) / 2 + reach, (right - left) / 4 + reach
        return low & (x <= left + width), low & (x >= right - width)

    def go(self, traverse: Traverse, speed: float) -> State:
        """Traverse the path at a largest speed [m/s, or settlements/s]; return the state at its end."""
        state = self.start.copy()
        if self.settles:
            return self._settle(traverse, state, speed)
        self._drive(traverse, state, speed)
        return state

    def after(self, traverse: Traverse) -> "Lead":
        """The parameters of the next traverse, after this one."""
        return self

    def kept(self, traverses: list[Traverse]) -> Traverse:
        """The traverse to keep if the last one was interrupted."""
        return traverses[-1]

    def apart(self, fast: Traverse, slow: Traverse) -> float:
        """Distance of the curves at two speeds, relative to the answer, if it is reported; otherwise 0."""
        return 0.0

    def failing(self, curve: Array) -> int:
        """Row of a curve ``(n, 2)`` in which the wall fails."""
        return failing(curve)

    def onward(self, curve: Array) -> Array:
        """A curve ``(n, 2)`` with displacements positive towards the side on which walls are to fail."""
        return curve

    def unbraked(self, curve: Array) -> Array:
        """A curve ``(n, 2)`` without the rows in which the drive brakes before it turns or ends: blocks push it on."""
        senses = np.sign(np.diff(curve[:, 0]))
        turns = np.append(np.flatnonzero(senses[1:] * senses[:-1] < 0) + 1, len(curve) - 1)
        braking = turns[:, None] - np.arange(RAMP + 1)
        return np.delete(curve, braking[braking > 0], axis=0)

    def before(self, curve: Array) -> str:
        """Note on the part of a curve ``(n, 2)`` before the answer; may be empty."""
        return ""

    def remedy(self, curve: Array) -> str:
        """Advice if the answers of a curve ``(n, 2)`` at two speeds differ; may be empty."""
        return ""

    def fall(self, traverse: Traverse) -> str:
        """Note on how a wall has fallen at the end of a traverse."""
        if traverse.fall is not None:
            rest, fall = (abs(self.run.system.carried.displacement) * place.settled for place in traverse.fall)
            return f"the wall falls between {rest:.4g} and {fall:.4g} m"
        return f"the wall falls beyond {np.abs(traverse.curve[:, 0]).max():.4g} m"

    def crushed(self, state: State) -> Array:
        """Permanent closure of joints at their ends [m], ``(nj, 2)``; empty if no joint can crush."""
        return np.asarray(self.run.at_joints(state)[5, self._ends]) if self._has_caps else np.zeros((0, 2))

    @cached_property
    def _has_caps(self) -> bool:
        """Whether any joint of the scene can crush."""
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
        # At finite displacements blocks collide all the time, which means over rows average out.
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
                    inertia = 0.0 if knock and k >= RAMP else (self._gathered(state) - gathered) / (length * run.dt)
                    peaks.see(force, inertia, length, state, len(traverse.rows) + (window > peaks.windows // 2))
                    if window == peaks.windows // 2:
                        middle = state.copy()
                # The mean force of a row belongs to the middle of the row.
                self.note(traverse, middle, self.moved(middle), peaks.mean(peaks.windows))
                seen.append((middle.motion, self.crushed(middle)))
                if (k + 1) % STRIDE == 0:
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
        traverse.motion = seen[row][0] - seen[max(0, row - STRIDE)][0]
        # The maximum so far: joints that have opened since have also been crushed.
        traverse.crushed = np.max([crushed for _, crushed in seen[: row + 1]], axis=0)

    def falls(self, state: State) -> bool:
        """Whether the dead load has come down far and most of its work is kinetic; prescribed motions do little work.

        Without this a beam that nothing carries any more would be followed through the wall and the ground.
        """
        run, system = self.run, self.run.system
        given = run.dead_work(state) - run.dead_work(self.start)
        if given <= max(FALL_DESCENT * self.work_of_a_block, run.dt * float(system.dead @ state.velocity) / STEP_WORK):
            return False
        return system.kinetic_energy(state.velocity) > FALL_KINETIC * (1 - run.local) * given

    @cached_property
    def work_of_a_block(self) -> float:
        """Work of the dead load [J] if everything that moves comes down by the size of a block."""
        system = self.run.system
        load = np.where(np.isfinite(system.mass), system.dead, 0.0)[system.rigid[:, :2]]
        return float(np.hypot(*load.T).sum() * self.scene.block_size)

    def _gathered(self, state: State) -> float:
        """Momentum along the drive of all bodies except the beam, including what damping dissipates meanwhile [N s]."""
        system = self.run.system
        along = system.rigid[system.owner != self.beam, 0]
        along = along[np.isfinite(system.mass[along])]
        return float(system.mass[along] @ state.velocity[along]) / (1 - self.run.local)

    def moved(self, state: State) -> float:
        """Displacement of the driven point since the rest under the dead load [m]."""
        return self.run.driven(state) - self.run.driven(self.start)

    def _settle(self, traverse: Traverse, state: State, speed: float) -> State:
        run, given = self.run, self.run.given(state)
        far = run.system.carried.displacement
        self.note(traverse, state, 0.0, self.share(state, 0.0, self.criteria.interval, given))
        self.observe(run, state, traverse.rows[-1].force)
        traverse.best = state.copy()
        ahead = self._stages()[::-1]
        end, before, doubtful = ahead[0], Place(0.0, 0.0), list[Place]()
        while ahead:
            place = ahead[-1]
            # At finite displacements a wall that slowly tips over is nearly at rest.
            exactly = run.system.contacts is not None or bool(doubtful) or place == end
            moving = self._stage(traverse, state, speed, place.settled - before.settled, given, exactly=exactly)
            stands, small = traverse.verdict == "stable", run.system.contacts is None
            if stands and place in doubtful[:1]:
                doubtful.clear()
            # Of a fall at small displacements the motion is shown; at finite ones blocks may have turned by any angle.
            if (not doubtful or not small) if stands else small:
                traverse.motion, traverse.crushed = state.motion - self.start.motion, self.crushed(state)
            if stands:
                bears = self.share(state, 0.0, self.criteria.interval, given)
                # Close to the end supports barely move. What changes as they stop is friction that motion has loosened.
                # Up to a fall the share may go on changing in the same sense.
                loosened, since = abs(bears - moving), bears - traverse.rows[-1].force if doubtful else 0.0
                traverse.unseen, traverse.inertia = max(loosened, since), max(loosened, -since)
                self.note(traverse, state, far * place.settled, bears)
                traverse.best, before = state.copy(), ahead.pop()
                self.observe(run, state, bears)
                continue
            # The energy in the rubble of a fall is not judged. A long stage shakes the wall: only a fall in a short one
            # counts, and the others are tried again from a nearer rest.
            state = replace(traverse.best.copy(), steps=state.steps)
            if traverse.verdict == "undecided":
                break
            if place.way - before.way <= FALL_PART * max(abs(place.settled), FALL_PART * self.longest):
                traverse.fall = before, place
                break
            doubtful.append(place)
            ahead.append(Place((before.way + place.way) / 2, (before.settled + place.settled) / 2))
        return state

    def _stages(self) -> list[Place]:
        """Ends of the stages of a settlement, small ones at the start of each leg, where reactions change most."""
        shares, way, stages = np.linspace(0.0, 1.0, STAGES + 1)[1:] ** 2, 0.0, list[Place]()
        for at, goal in pairwise([0.0, *self.goals.tolist()]):
            if goal != at:
                stages += [Place(way + abs(goal - at) * share, at + (goal - at) * share) for share in shares.tolist()]
                way += abs(goal - at)
        return stages

    def _stage(
        self, traverse: Traverse, state: State, speed: float, by: float, given: float, *, exactly: bool
    ) -> float:
        """Move supports by a fraction of the settlement and hold them until the wall rests or falls, in place.

        Return the mean share that supports carry towards the end of their motion.
        """
        run, motion, rows = self.run, self.run.system.carried.motion, 2 * RAMP
        stage = rows / (STAGES * speed * run.dt * _pace(rows).sum())
        windows = windows_of_stage(stage)
        pace = _pace(rows, windows)
        steps = max(1, round(stage / pace.size))
        top, moving, seen = by / (run.dt * steps * pace.sum()), list[float](), state.steps
        for part in pace.ravel().tolist():
            moving.append(self.share(state, top * part, steps, given))
            if state.steps - seen >= self.criteria.interval:
                seen = state.steps
                if self.falls(state):
                    traverse.verdict = "collapse"
                    break
        else:
            state.velocity[motion != 0] = 0.0
            rest = self.criteria.rest if exactly else NEARLY_AT_REST
            traverse.verdict, _ = hold_load(run, state, 0.0, replace(self.criteria, rest=rest))
        return float(np.mean(moving[-max(1, windows // 4) :]))


def windows_of_stage(steps: float) -> int:
    """Number of windows of constant speed in each row of a stage of `steps` steps, a whole number up to rounding."""
    # Rounded first: the last bit of a time step may make 1999.999 steps of 2000, and still there are four windows.
    return max(1, round(steps) // (2 * RAMP * SUPPORT_WINDOW_STEPS))


def goes_both_ways(goals: Array) -> bool:
    """Whether a path from zero through goals ``(n,)``, one after the other, goes to both sides.

    A path that returns to its start, possibly a little beyond it, does not.
    """
    most = float(np.abs(goals).max(initial=0.0))
    return bool(goals.max(initial=0.0) > OVERSHOOT * most and goals.min(initial=0.0) < -OVERSHOOT * most)


def last_leg(curve: Array) -> Array:
    """The rows of a path's curve ``(n, 2)`` since it last reversed, with displacements from there."""
    senses = np.sign(np.diff(curve[:, 0]))
    start = int(np.flatnonzero(senses != senses[-1])[-1]) + 1 if (senses != senses[-1:]).any() else 0
    return np.column_stack([np.abs(curve[start:, 0] - curve[start, 0]), curve[start:, 1]])


def growth_left(curve: Array) -> float:
    """Force [N] by which the largest force of a drive's curve ``(n, 2)`` may grow if the wall is moved twice as far.

    It grows from its last value at no more than its slope over `FINAL_PART`, because joints that have slid or opened
    stay soft; a slope within its scatter is none. Only displacements beyond all earlier ones count.
    """
    value, force = curve.T
    farthest = np.maximum.accumulate(value)
    onward = np.append(True, value[1:] > farthest[:-1] + PATH_ROUNDING * farthest[-1])
    places, force = value[onward], force[onward]
    share = np.linspace(0.0, 1.0, FINAL_ROWS)
    last = np.interp((1 - FINAL_PART * (1 - share)) * places[-1], places, force)
    slope, start = np.polyfit(share, last, 1)
    scatter = np.std(last - start - slope * share) * np.sqrt(12 / FINAL_ROWS)
    before, end = last[FINAL_ROWS // 2 :].reshape(2, -1).mean(axis=1)
    if end < before or slope <= SCATTERS * scatter:
        return 0.0
    return max(0.0, float(start + slope + slope / FINAL_PART - force.max()))


def late_growth(curve: Array) -> float:
    """Growth of the largest force [N] of a curve ``(n, 2)`` over the last part of its path."""
    value, force = curve.T
    late = value >= (1 - FINAL_PART) * value.max()
    return max(0.0, float(force[late].max() - force[~late].max(initial=0.0)))


def formed(curve: Array, tolerance: float, *, still: float = 0.0) -> bool:
    """Whether a mechanism has formed under a settling support: its share no longer changes at the end of a path.

    Parameters
    ----------
    curve : (n, 2) float
        Displacement, and share of the dead load.
    tolerance
        Fraction of its total change by which a share may still change. An elastic wall sheds load too: almost none on a
        short path, and evenly along it.
    still
        Change of a share that motion may have caused, which counts as none: it may be all the change there was.
    """
    value, share = last_leg(curve).T
    late = value >= (1 - FINAL_PART) * value.max()
    least = max(still, UNCHANGED)
    return bool(np.ptp(share[late]) <= min(tolerance, FINAL_PART / 2) * np.ptp(share) + least)


def shedding(curve: Array) -> tuple[bool, str]:
    """Whether the share on a support falls at the end of a path, and the name of the change: the share may be negative.

    If the share no longer changes over the last part, the whole leg counts.
    """
    value, share = last_leg(curve).T
    late = share[value >= (1 - FINAL_PART) * value.max()]
    first, last = late[0] if abs(late[-1] - late[0]) > UNCHANGED else share[0], share[-1]
    return bool(last <= first), "sheds load" if abs(last) <= abs(first) else "takes up load"


def failing(curve: Array) -> int:
    """Row of a drive's curve ``(n, 2)`` in which a wall fails.

    The first row beyond earlier displacements at which the force is at most `LOSS` of its peak; else the farthest row.
    """
    moved, force = curve.T
    same = PATH_ROUNDING * np.abs(moved).max()  # a repeated amplitude is not farther than before, except by rounding
    onward = np.append(True, moved[1:] > np.maximum.accumulate(moved)[:-1] + same)
    top = int(force.argmax())
    fallen = top + np.flatnonzero(onward[top:] & (force[top:] <= LOSS * force[top]))
    return int(fallen[0]) if len(fallen) else int(np.argmax(moved >= moved.max() - same))


def _pace(rows: int, windows: int = 1) -> Array:
    """Fraction of the top speed in each window of each row ``(rows, windows)`` of a leg, with a soft start and end."""
    k = (np.arange(rows * windows) + 0.5) / windows
    return np.asarray(np.minimum(1.0, np.minimum(k, rows - k) / RAMP)).reshape(rows, windows)
