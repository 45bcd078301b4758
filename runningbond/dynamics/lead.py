"""How prescribed displacements are applied along a path, and how what happens there is judged and told."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from runningbond.joints import JointPoints, wall_caps
from runningbond.scene import Array, Indices, Scene

from .collapse import Criteria
from .path_curve import LITTLE, LOSS, failing, friction_note, late_growth
from .peaks import Peaks
from .run import Observer, Run
from .state import State
from .traverse import Traverse, TraverseRow

ROWS = 200
"""Rows of the curve in the longest leg of a drive."""

RAMP = 10
"""Rows in which a leg accelerates to its speed, and in which it slows down before it turns."""

STRIDE = 10
"""Rows between two calls of an observer, and over which the motion of a mechanism is taken."""

MOST_TURN = 0.03
"""Rotation of a block [rad] up to which the latest motion of a wall is its mechanism in the shape as built.

Beyond that its joints would overlap visibly, and the wall's deformed shape shows where they open.
"""

FALL_DESCENT = 0.5
"""Descent of the whole dead load, in block sizes, whose work must at least be done before a wall counts as falling."""

FALL_KINETIC = 0.5
"""Fraction of that work, less what local damping dissipates, that must be kinetic energy in a fall."""

STEP_WORK = 5e-3
"""Largest fraction of that work in one time step: velocities lag by half a step, and the ledger misses half of it."""


@dataclass(frozen=True, eq=False)
class Lead(ABC):
    """How prescribed displacements are applied, from the rest under the dead load on."""

    scene: Scene
    run: Run
    start: State
    criteria: Criteria
    observe: Observer
    points: JointPoints  # joint points, in the order of `Run.at_joints`

    moves: ClassVar[bool] = True  # whether forces are means during motion, not values at rest

    @property
    @abstractmethod
    def answer(self) -> str:
        """Name of the answer of a traverse."""

    @property
    @abstractmethod
    def goals(self) -> Array:
        """Ends of the legs of the path, one after the other."""

    @abstractmethod
    def go(self, traverse: Traverse, speed: float) -> State:
        """Traverse the path at a largest speed [unit of the goals per second]; return the state at its end."""

    @property
    def least(self) -> float:
        """Answer below which brackets need not be relatively narrow."""
        return 0.0

    @property
    def most(self) -> float:
        """Answer above which the wall is not pushed farther."""
        return np.inf

    @property
    def least_work(self) -> float:
        """Least work [J] relative to which the residual of the energy ledger is judged."""
        return LITTLE * self.run.system.carried.work

    @property
    def least_friction(self) -> float:
        """Least work [J] relative to which friction is judged to matter."""
        return self.least_work

    @property
    def rate(self) -> float | None:
        """Speed that is asked for [m/s]; None if it is chosen, and halved until the answer converges."""
        return None if self.scene.drive is None else self.scene.drive.rate

    @cached_property
    def is_small(self) -> bool:
        """Whether displacements are small."""
        return self.run.system.contacts is None

    @property
    def displacements(self) -> str:
        """Note on the kind of displacements."""
        return f"{'small' if self.is_small else 'finite'} displacements"

    @property
    def read_at(self) -> str:
        """Note on where displacements are read; may be empty."""
        return ""

    @property
    def longest(self) -> float:
        """Length of the longest leg."""
        return float(np.abs(np.diff(self.goals, prepend=0.0)).max())

    def moved(self, state: State) -> float:
        """Displacement of the driven point since the rest under the dead load [m]."""
        return self.run.driven(state) - self.run.driven(self.start)

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

    def reached(self, curve: Array) -> float:
        """Displacement [m] to which the answer of a curve ``(n, 2)`` belongs."""
        return float(np.abs(curve[:, 0]).max())

    def growth_left(self, traverse: Traverse) -> float:
        """Force [N] by which the answer may grow beyond the end of the path, as far as that can be told."""
        return 0.0

    def has_formed(self, traverse: Traverse, tolerance: float, *, still: float) -> bool:
        """Whether the answer changes by less than a relative tolerance at the end of a path.

        `still` is the change that the speed may have caused.
        """
        grown = late_growth(self.onward(traverse.curve))
        return grown <= tolerance * max(traverse.answer, self.least)

    def unfinished(self, curve: Array) -> tuple[str, bool]:
        """Note on a wall whose mechanism has not formed, and whether its answer can only become smaller."""
        force = self.onward(curve)[:, 1]
        has_failed = force[self.failing(curve)] <= LOSS * force.max()
        return "the wall has only just failed" if has_failed else "the wall still hardens", False

    def has_come_free(self, row: TraverseRow) -> bool:
        """Whether supports that move carry nothing at a place of the path."""
        return False

    def doubt(self, traverse: Traverse, tolerance: float) -> str:
        """Note on an answer that may still change by more than a tolerance although a mechanism counts as formed."""
        return ""

    def moving(self, traverse: Traverse, tolerance: float) -> str:
        """Note on the part of an answer that motion takes, if it is more than a tolerance; may be empty."""
        return ""

    def friction_note(self, traverse: Traverse, tolerance: float, differs: str, *, until: int | None = None) -> str:
        """The note of `friction_note` for a traverse, from the works of its rows up to number `until` (excluded)."""
        friction = self.run.ledger(traverse.best).friction - self.run.ledger(self.start).friction
        works = np.array([row.works[1] for row in traverse.rows[:until]])
        return friction_note(self.scene, friction, works, self.least_friction, tolerance, differs=differs)

    def too_fast(self) -> str:
        """Note on a rate that is too fast for time steps to follow; may be empty."""
        return ""

    def before(self, curve: Array) -> str:
        """Note on the part of a curve ``(n, 2)`` before the answer; may be empty."""
        return ""

    def other_way(self, curve: Array) -> str:
        """Note on the other side of a curve ``(n, 2)``; may be empty."""
        return ""

    def remedy(self, fast: Traverse, slow: Traverse, tolerance: float) -> str:
        """Advice if the answers at two speeds differ by more than a relative tolerance; may be empty."""
        return ""

    def nearer(self, fast: Traverse, slow: Traverse, tolerance: float) -> float | None:
        """End of a shorter path [m] whose answers at two speeds may differ by less; None if none is in sight."""
        return None

    def shorter(self, traverse: Traverse) -> str:
        """Advice if a traverse failed; may be empty."""
        return ""

    def fall(self, traverse: Traverse) -> str:
        """Note on how a wall has fallen at the end of a traverse."""
        return f"the wall falls beyond {np.abs(traverse.curve[:, 0]).max():.4g} m"

    def note(self, traverse: Traverse, state: State, moved: float, force: float) -> None:
        """Append a row for a state to a traverse."""
        run = self.run
        carried = np.column_stack(run.forces(state)) if self.is_small else run.resultants(state, force)
        dead, tie = run.dead_work(state), run.system.ties.force(state.motion, state.stretch)
        works = (dead, state.external - dead)
        traverse.rows.append(TraverseRow(moved, force, carried, tie, works, self.of_beam(state, moved)))

    def of_beam(self, state: State, moved: float) -> tuple[float, ...]:
        """`BEAM` in a state; empty if no beam is driven."""
        return ()

    def crushed(self, state: State) -> Array:
        """Permanent closure of joints at their ends [m], ``(nj, 2)``; empty if no joint can crush."""
        if not self._has_caps:
            return np.zeros((0, 2))
        return np.asarray(np.append(self.run.at_joints(state)[5], 0.0)[self._ends])

    @cached_property
    def _has_caps(self) -> bool:
        """Whether any joint of the scene can crush."""
        return bool(np.isfinite(wall_caps(self.scene, np.arange(len(self.scene.joints)))[0]).any())

    @cached_property
    def _ends(self) -> Indices:
        """The first and the last point of each joint of the scene ``(nj, 2)``; −1 for joints without points."""
        own = np.flatnonzero(self.points.joint < len(self.scene.joints))
        joint, (start, end) = self.points.joint[own], self.scene.joints.ends.swapaxes(0, 1)
        along = ((self.points.position[own] - start[joint]) * (end - start)[joint]).sum(axis=1)
        order = np.lexsort((along, joint))
        count = np.bincount(joint, minlength=len(start))
        last = np.cumsum(count)
        ends = np.full((len(start), 2), -1)
        ends[count > 0] = own[order[np.column_stack([last - count, last - 1])[count > 0]]]
        return ends

    def conclude(self, traverse: Traverse, peaks: Peaks, seen: list[tuple[Array, Array]]) -> None:
        """Take the answer of a traverse from its peaks, its mechanism from motions and crushing `seen` at its rows."""
        traverse.calm()
        peak, between, traverse.unseen, traverse.resolved = peaks.resolved()
        traverse.best, traverse.inertia, traverse.lasting = peak.state, peak.inertia, peaks.longest.force
        traverse.spent = peak.spent
        if between:
            self.note(traverse, peak.state, self.moved(peak.state), peak.force)
            traverse.rows.insert(peak.row, traverse.rows.pop())
            seen.insert(peak.row, (peak.state.motion, self.crushed(peak.state)))
        row = self.failing(traverse.curve)
        whole = seen[row][0] - self.start.motion
        turns = self.run.system.motion_of_blocks(whole)[:, 2]
        traverse.is_shape = not self.is_small and float(np.abs(turns).max()) > MOST_TURN
        traverse.motion = whole if traverse.is_shape else seen[row][0] - seen[max(0, row - STRIDE)][0]
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
    def dead_load(self) -> float:
        """Sum of the dead load's forces [N] on everything that moves."""
        system = self.run.system
        load = np.where(np.isfinite(system.mass), system.dead, 0.0)[system.rigid[:, :2]]
        return float(np.hypot(*load.T).sum())

    @cached_property
    def work_of_a_block(self) -> float:
        """Work of the dead load [J] if everything that moves comes down by the size across which blocks overturn."""
        return self.dead_load * self.scene.overturning_size


def pace(rows: int, windows: int = 1) -> Array:
    """Fraction of the top speed in each window of each row ``(rows, windows)`` of a leg, with a soft start and end."""
    k = (np.arange(rows * windows) + 0.5) / windows
    return np.asarray(np.minimum(1.0, np.minimum(k, rows - k) / RAMP)).reshape(rows, windows)
