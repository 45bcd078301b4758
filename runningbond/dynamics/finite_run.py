"""Blocks at finite displacements, whose contacts are sought anew as they move, and what they have been through kept."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.contacts.contacts import Contacts, Outline, find_contacts
from runningbond.joints.law import DAMPED_WORK, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE
from runningbond.scene import Array, Indices, Scene

from .controls import push
from .run import Criteria, Ledger, Run, settle
from .system import BlockSystem, State
from .time_step import stable_step
from .verdict import COLLAPSE

HASTE = 2
"""Times the speed that blocks have, and that loads alone would give them, with which they are reckoned to move on."""

STEPS_AHEAD = 16
"""Steps of the fastest block within which sides count as near at least."""

LONGEST = 1000
"""Steps between two looks at how far the blocks have moved."""

PIECES, SOFT = 4000, 20
"""Rows of a pushover curve if all blocks move as far as the control point, and those in which they gather speed."""


@dataclass(eq=False, kw_only=True)
class FiniteState(State):
    """A state with the contacts that its history is of, a column each.

    Parameters
    ----------
    contacts
        The contacts.
    time : float
        Time since the start [s].
    friction, absorbed : float
        Work spent on contacts and on their viscosity [J] up to when these ones were found.
    """

    contacts: Contacts
    time: float = 0.0
    friction: float = 0.0
    absorbed: float = 0.0

    def copy(self) -> "FiniteState":
        """A state that goes its own way from here."""
        return FiniteState(
            **vars(super().copy()),
            contacts=self.contacts,
            time=self.time,
            friction=self.friction,
            absorbed=self.absorbed,
        )


class FiniteRun(Run, ABC):
    """Blocks in motion at finite displacements; its states are `FiniteState`.

    A model says what a system is made of on given contacts and which corner rests on which side; the rest is here.

    Parameters
    ----------
    system
        The blocks on the contacts of the undeformed wall.
    outline
        Their outlines.
    contacts
        Those contacts.
    local, viscous
        Damping, as in `Run`.
    part
        Part of the stable time step, which follows the contacts, that is taken.
    """

    def __init__(
        self, system: BlockSystem, outline: Outline, contacts: Contacts, *, local: float, viscous: float, part: float
    ) -> None:
        self.outline, self.viscous, self.part = outline, viscous, part
        self._plastic_slip = system.law.law.row("plastic slip")  # at which a contact would be free of shear
        self._start(system, local)
        self._undeformed = self._contacts = contacts
        self._undeformed_bound = system.block_frequency_squared
        self._loading = self._farthest((np.abs(system.dead) + np.abs(system.live)) / system.mass)

    @abstractmethod
    def _system_on(self, contacts: Contacts) -> BlockSystem:
        """The system with the law, the areas, the geometry and the frequency of other contacts."""

    @abstractmethod
    def _geometry(self, contacts: Contacts) -> tuple[Any, ...]:
        """What the kernels need to know of contacts."""

    @abstractmethod
    def _resting(self, contacts: Contacts, motion: Array) -> Indices:
        """A number, for each contact, of the corner that rests and the side it rests on after a motion ``(nd,)``."""

    def _find(self, motion: Array, margin: float) -> Contacts:
        """Contacts nearer than a margin [m] after a motion ``(nd,)``."""
        return find_contacts(self.outline, self.rigid(motion), margin)

    def _deformation(self, motion: Array) -> float:
        """At most how far a point of a block is from where a rigid block would have it [m]."""
        return 0.0

    def rigid(self, motion: Array) -> Array:
        """Translations and rotation of each block in a motion ``(nd,)``, ``(3 nb,)``."""
        return np.ascontiguousarray(motion[self.system.rigid]).ravel()

    def at_rest(self) -> FiniteState:
        """The undeformed wall without velocity."""
        return self._without_velocity(np.zeros(len(self.system.mass)), self._undeformed)

    def moved_to(self, motion: Array) -> FiniteState:
        """The wall without velocity after a motion ``(nd,)``, its contacts free of shear."""
        return self._without_velocity(motion.copy(), self._find(motion, self.outline.margin))

    def _without_velocity(self, motion: Array, contacts: Contacts) -> FiniteState:
        nd = len(motion)
        self._take_up(contacts)
        fresh = self._fresh_history(contacts, motion)
        return FiniteState(motion, np.zeros(nd), fresh, np.zeros(nd), np.zeros(nd), contacts=contacts)

    def hold(self, state: State, multiplier: float, steps: int, dead: float = 1.0, *, given: float = math.inf) -> None:
        """Take steps under constant loads, as in `Run`."""
        finite = _finite(state)
        while steps > 0:
            piece = min(steps, self._look(finite))
            super().hold(finite, multiplier, piece, dead, given=given)
            finite.time += piece * self.dt
            steps -= piece

    def drive(self, state: State, speed: float, steps: int, *, given: float = math.inf) -> float:
        """Take steps with the live load's power kept at `speed` [W]; returns the mean multiplier."""
        finite = _finite(state)
        total, left = 0.0, steps
        while left > 0:
            piece = min(left, self._look(finite))
            total += piece * super().drive(finite, speed, piece, given=given)
            finite.time += piece * self.dt
            left -= piece
        return total / steps

    def forces(self, state: State) -> tuple[Array, Array]:
        """Normal and tangential force at each contact ``(np,)`` [N], without a change of state."""
        self._take_up(_finite(state).contacts)
        return super().forces(state)

    def ledger(self, state: State) -> Ledger:
        """Account for the work of the loads so far."""
        finite = _finite(state)
        self._take_up(finite.contacts)
        found = super().ledger(finite)
        return replace(found, friction=found.friction + finite.friction, damped=found.damped + finite.absorbed)

    def _look(self, state: FiniteState) -> int:
        """Pair anew what has moved; returns the steps until the blocks may have moved so far again."""
        room = state.contacts.margin / 2 - self._deformation(state.motion)
        left = room - self._outline_travel(self.rigid(state.motion) - state.contacts.motion)
        if left < room / 4:
            self._pair(state)
            left = max(0.0, state.contacts.margin / 2 - self._deformation(state.motion))
        self._take_up(state.contacts)
        speed, gain = HASTE * self._farthest(state.velocity), HASTE * self._loading
        root = np.sqrt(speed**2 + 2 * gain * left)
        time = 2 * left / (speed + root) if root > 0 else np.inf
        return int(np.clip(time / self.dt, 1, LONGEST))

    def _pair(self, state: FiniteState) -> None:
        """Find the contacts of a state anew, in place, and hand their history on."""
        before, history = state.contacts, state.history
        rested = self._resting(before, state.motion)
        opening, slip = self._jumps(before, state.motion)
        shear = slip - history[self._plastic_slip]
        state.friction += float(before.area @ history[FRICTION_WORK])
        state.absorbed += float(before.area @ history[DAMPED_WORK])

        # What flies moves by many a step's way before the next look, and may be as deep in a block by then; what has
        # struck one may be deeper, and is not to be lost sight of before it is thrown back.
        fast = STEPS_AHEAD * self._farthest(state.velocity) * self.dt
        deep = -2 * opening.min(initial=0.0)
        found = self._find(state.motion, max(self.outline.margin, fast, deep))
        # The same end of the same two sides; or, for a corner that has turned on, the same corner on the same side,
        # which goes on with the area that it had: another stiffness would jolt it.
        turned = _where(rested, self._resting(found, state.motion))
        same = _where(before.key, found.key)
        on, still = turned >= 0, same >= 0
        area, glued = found.area.copy(), np.zeros(len(found), dtype=bool)
        area[on] = before.area[turned[on]]
        area[still] = before.area[same[still]]
        glued[still] = before.glued[same[still]]

        state.contacts = replace(found, area=area, glued=glued)
        self._take_up(state.contacts)
        state.history = self._fresh_history(state.contacts, state.motion)
        state.history[self._plastic_slip, on] -= shear[turned[on]]
        state.history[:, still] = history[:, same[still]]
        state.history[[FRICTION_WORK, DAMPED_WORK]] = 0.0

    def _jumps(self, contacts: Contacts, motion: Array) -> Array:
        """Opening and slip of contacts after a motion ``(nd,)``, ``(2, n)`` [m]."""
        found = np.zeros((2, len(contacts)))
        self.system.gather(motion, self._geometry(contacts), *found)
        return found

    def _fresh_history(self, contacts: Contacts, motion: Array) -> Array:
        """History of contacts that are free of shear after a motion ``(nd,)``; `contacts` have been taken up."""
        opening, slip = self._jumps(contacts, motion)
        history = np.zeros((self.system.law.rows, len(opening)))
        history[OPENING_BEFORE], history[SLIP_BEFORE], history[self._plastic_slip] = opening, slip, slip
        return history

    def _farthest(self, motion: Array) -> float:
        """At most how far any point of a block goes in a motion ``(nd,)`` [m], but for its deformation."""
        return self._outline_travel(self.rigid(motion))

    def _outline_travel(self, rigid: Array) -> float:
        u, v, spin = rigid.reshape(-1, 3).T
        return float((np.hypot(u, v) + np.abs(spin) * self.outline.reach).max())

    def _take_up(self, contacts: Contacts) -> None:
        """Go on with other contacts."""
        if contacts is self._contacts:
            return
        self._contacts = contacts
        system = self._system_on(contacts)
        # Blocks that have flown apart have no frequency, and may meet again.
        bound = max(system.block_frequency_squared, self._undeformed_bound)
        self._start(replace(system, block_frequency_squared=bound), self.local)

    def _start(self, system: BlockSystem, local: float) -> None:
        dt = self.part * stable_step(system.block_frequency_squared, self.viscous, local)
        super().__init__(system, local=local, viscous=self.viscous, dt=dt)


def finite_curve(
    run: FiniteRun, scene: Scene, distance: float, speed: float, measure: Callable[[Array], tuple[float, float]]
) -> Array:
    """Pushover curve at a constant power of the live load.

    Parameters
    ----------
    run
        The blocks.
    scene
        Their wall.
    distance
        Displacement of the control point at which to stop [m].
    speed
        Mean speed of the blocks along the live load [m/s].
    measure
        Displacement of the control point, and of the corner that has moved farthest, in a motion ``(nd,)`` [m].

    Returns
    -------
    (n, 3) float
        What `measure` says, and the mean multiplier since the last row.
    """
    state = run.at_rest()
    settle(run, state, 0.0, Criteria(collapse=COLLAPSE * scene.block_size))
    steps = max(1, round(distance / (speed * PIECES * run.dt)))
    power = speed * float(np.abs(run.system.live).sum())
    with threadpool_limits(limits=1, user_api="blas"):  # as in `verdict`
        return push(run, state, distance, power, (PIECES, SOFT, steps), measure)


def _finite(state: State) -> FiniteState:
    if not isinstance(state, FiniteState):
        raise TypeError("finite displacements need a state that knows its contacts: begin with `at_rest()` of the run")
    return state


def _where(keys: Indices, sought: Indices) -> Indices:
    """Position in `keys` of each key sought, −1 where it is not among them."""
    if not len(keys):
        return np.full(len(sought), -1)
    order = np.argsort(keys)
    at = order[np.minimum(np.searchsorted(keys, sought, sorter=order), len(keys) - 1)]
    return np.where(keys[at] == sought, at, -1)
