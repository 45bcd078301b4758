"""A run: a block system brought forward in time, with its energy ledger and its verdict."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from runningbond.joints.law import DAMPED_WORK, FRICTION_WORK
from runningbond.scene import Array, Scene

from .stepping import stepper, work_arrays
from .system import BlockSystem, State
from .time_step import stable_step

LOCAL, VISCOUS = 0.5, 0.1
"""Local damping α, and the joints' viscous damping ratio at the highest frequency."""

CALM = 3
"""Looks in a row at which a wall must be balanced to be at rest: one in full motion may pass through balance."""

Verdict: TypeAlias = Literal["stable", "collapse", "undecided"]

Observer: TypeAlias = Callable[["Run", State, float], None]
"""Looks at a run, its state and the multiplier, now and then, and changes none of them."""


def nobody(run: "Run", state: State, multiplier: float) -> None:
    """Observe nothing."""


@dataclass(frozen=True)
class Ledger:
    """Where the work of the loads went [J]; what is not accounted for is the residual."""

    external: float
    kinetic: float
    elastic: float
    joint: float
    friction: float
    damped: float

    @property
    def residual(self) -> float:
        """Work that the integration lost or made up."""
        return self.external - self.kinetic - self.elastic - self.joint - self.friction - self.damped


class Unstable(ArithmeticError):
    """A run that spent more energy than it was supplied with, which a long time step makes of nothing.

    Parameters
    ----------
    steps
        Steps after which that was found.
    step, safe
        Time step that was taken, and one that is safe [s].
    """

    def __init__(self, steps: int, step: float, safe: float) -> None:
        found = f"unstable: more energy was spent than supplied after {steps} time steps of {step:.4g} s"
        super().__init__(f"{found}; a step of {safe:.4g} s is safe")
        self.steps = steps


class Run:
    """A system in motion.

    Parameters
    ----------
    system
        The blocks.
    local
        Local damping α: each freedom is resisted by α times its unbalanced force.
    viscous
        Damping ratio of the stiffness-proportional viscosity of the joints, at the highest frequency.
    dt
        Time step [s]; the stable one where none is given.
    """

    def __init__(
        self,
        system: BlockSystem,
        *,
        local: float = LOCAL,
        viscous: float = VISCOUS,
        dt: float | None = None,
    ) -> None:
        self.system = system
        self.local = local
        self.safe_step = stable_step(system.block_frequency_squared, viscous, local)
        self.dt = dt or self.safe_step
        self._viscosity = 2 * viscous / math.sqrt(system.block_frequency_squared) / self.dt
        self._hold, self._drive = stepper(system.gather, system.law.kernel, system.scatter)
        modes = (system.stiffness, system.viscosity, 1 / system.mass)
        restraint = (system.restraint.freedom, system.restraint.basis)
        self._arrays = (system.geometry, system.law.parameters, modes, restraint)
        self._work = work_arrays(len(system.mass), system.law.points)

    def hold(self, state: State, multiplier: float, steps: int, dead: float = 1.0, *, given: float = math.inf) -> None:
        """Take steps under constant loads: `multiplier` times the live one and `dead` times the dead one.

        Parameters
        ----------
        state
            Brought forward in place.
        multiplier, dead
            Factors on the live and the dead load.
        steps
            How many steps.
        given
            Energy [J] of the state besides the work of its loads, of `given`; inf does not watch the energy.

        Raises
        ------
        Unstable
            As soon as the energy that is watched does not add up; the state is left as it is then.
        """
        system = self.system
        load = dead * system.dead + multiplier * system.live
        before = float(load @ state.motion)
        watch = (state.steps, given + state.external - before, state.supplied)
        coefficients = (steps, self.dt, self.local, self._viscosity)
        taken, sound = self._hold(*coefficients, load, *self._arrays, _histories(state), self._work, watch)
        state.external += float(load @ state.motion) - before
        self._account(state, taken, sound)

    def drive(self, state: State, speed: float, steps: int, *, given: float = math.inf) -> float:
        """Take steps with the live load's power ``f_live · v`` kept at `speed` [W]; returns the mean multiplier.

        `given` watches the energy as in `hold`.
        """
        system = self.system
        before = float(system.dead @ state.motion)
        watch = (state.steps, given + state.external - before, state.supplied)
        coefficients = (steps, self.dt, self.local, self._viscosity)
        loads = (system.dead, system.live, speed)
        taken, sound, mean, worked = self._drive(
            *coefficients, *loads, *self._arrays, _histories(state), self._work, watch
        )
        state.external += float(system.dead @ state.motion) - before + worked
        self._account(state, taken, sound)
        return float(mean)

    def given(self, state: State) -> float:
        """Energy [J] of a state that its loads did not supply: none but for one that was set in motion by hand."""
        return max(0.0, -self.ledger(state).residual)

    def _account(self, state: State, taken: int, sound: bool) -> None:
        state.steps += taken
        if not sound:
            raise Unstable(state.steps, self.dt, self.safe_step)

    def unbalanced(self, state: State) -> float:
        """Largest unbalanced force of the last step, relative to its block's weight."""
        return self.system.measure(state.unbalanced)

    def forces(self, state: State) -> tuple[Array, Array]:
        """Normal and tangential force at each point ``(np,)`` [N], without a change of state."""
        _, _, normal, tangential = self.tractions(state)
        return normal * self.system.area, tangential * self.system.area

    def tractions(self, state: State) -> tuple[Array, Array, Array, Array]:
        """Opening and slip [m] and tractions [Pa] of the points, without a change of state."""
        system = self.system
        opening, slip, normal, tangential = (np.zeros(system.law.points) for _ in range(4))
        system.gather(self._unrestrained(state.motion), system.geometry, opening, slip)
        # At rest: the viscosity, of no account then, would need the rate of a step that is not taken.
        system.law.kernel(opening, slip, system.law.parameters, state.history.copy(), 0.0, normal, tangential)
        return opening, slip, normal, tangential

    def sizes(self, scene: Scene) -> Array:
        """Size of each of its blocks ``(nb,)`` [m], by which motions are measured."""
        return scene.block_sizes

    def motion_of_blocks(self, state: State) -> Array:
        """Translation and rotation of each block, ``(nb, 3)`` [m, m, rad]."""
        return self._unrestrained(state.motion)[self.system.rigid]

    def velocity_of_blocks(self, state: State) -> Array:
        """Velocity and spin of each block half a step ago, ``(nb, 3)`` [m/s, m/s, rad/s]."""
        return self._unrestrained(state.velocity)[self.system.rigid]

    def _unrestrained(self, motion: Array) -> Array:
        """Motion with restrained coordinates turned back into those of their blocks, ``(nd,)``."""
        moved = motion.copy()
        for i, basis in zip(self.system.restraint.freedom, self.system.restraint.basis, strict=True):
            moved[i] = basis @ motion[i]
        return moved

    def ledger(self, state: State) -> Ledger:
        """Account for the work of the loads so far."""
        system, law = self.system, self.system.law
        opening, _, normal, tangential = self.tractions(state)
        moving = np.isfinite(system.mass)
        return Ledger(
            external=state.external,
            kinetic=float(0.5 * (system.mass[moving] * state.velocity[moving] ** 2).sum()),
            elastic=float(0.5 * (system.stiffness * state.motion**2).sum()),
            joint=float(system.area @ law.stored(law, opening, normal, tangential)),
            friction=float(system.area @ state.history[FRICTION_WORK]),
            damped=float(state.damped.sum() + system.area @ state.history[DAMPED_WORK]),
        )


def _histories(state: State) -> tuple[Array, ...]:
    return (
        state.motion,
        state.velocity,
        state.history,
        state.damped,
        state.unbalanced,
    )


@dataclass(frozen=True)
class Criteria:
    """When a held load has been borne, and when it has brought the wall down.

    Parameters
    ----------
    rest
        Unbalanced force, in the system's units, below which the wall is at rest.
    collapse : float or (nb,) float
        Displacement [m] of any block, or of each, since the load was raised: the unit in which `Fall` measures whether
        a wall that does not slow down is in collapse.
    budget
        Steps after which the question is left undecided.
    interval
        Steps between two looks.
    """

    collapse: float | Array
    rest: float = 1e-5
    budget: int = 2_000_000
    interval: int = 200


def settle(
    run: Run,
    state: State,
    multiplier: float,
    criteria: Criteria,
    observe: Observer = nobody,
    *,
    sudden: bool = False,
) -> Verdict:
    """Hold a load until the wall rests or falls.

    It rests when the unbalanced force is below the threshold at `CALM` looks in a row. It falls when it has moved far
    and does not slow down (`Fall`), so that a wall that slips and is caught is not mistaken for one in collapse; one
    on which a `sudden` load was put may give way elastically first.

    Raises
    ------
    Unstable
        If it spends more energy than the load and the state at the start can have supplied.
    """
    start, given = state.motion.copy(), run.given(state)
    fall = Fall(springy=sudden or run.system.weightless)
    calm = 0
    for _ in range(criteria.budget // criteria.interval):
        run.hold(state, multiplier, criteria.interval, given=given)
        observe(run, state, multiplier)
        calm = calm + 1 if run.unbalanced(state) < criteria.rest else 0
        if calm == CALM:
            return "stable"
        if fall.goes_on(moved_by(run.system, state, start, criteria.collapse), state.steps):
            return "collapse"
    return "undecided"


class Fall:
    """Whether a motion is a collapse: it has come a unit, and no slower over the last half of its way than before.

    `SOON` is enough where the same held when it had come half as far. A motion that does slow down is a collapse once
    it has come `FARTHEST` doublings of the unit.

    Parameters
    ----------
    springy
        Whether springs may take up a good part of the unit, so that it has to come the whole: under a load put on at
        once, or in a wall without weight, whose joints hold by nothing but what the load presses them together.
    """

    FARTHEST = 4
    """Doublings after which a motion that does slow down counts as collapse all the same."""

    SLACK = 1.1
    """How much slower than before is not yet slower: sliding contacts chatter, and their speed with them."""

    SOON = 0.5
    """Part of the unit, a power of two, after which a motion that never slowed is a collapse.

    Dry walls that were caught had slowed by then, and a fall at constant speed takes twice the steps for the whole.
    """

    def __init__(self, *, springy: bool = False) -> None:
        # Steady at SOON for the second time, or at the unit for the first, is at the fourth mark, or the third.
        first = -2 if springy else int(math.log2(self.SOON)) - 3
        self._marks = [2.0**k for k in range(first, self.FARTHEST + 1)]
        self._passed: list[int] = []
        self._steady = 0

    def goes_on(self, moved: float, steps: int) -> bool:
        """Whether a wall that has moved so far after so many steps is in collapse."""
        while len(self._passed) < len(self._marks) and moved > (mark := self._marks[len(self._passed)]):
            self._passed.append(steps)
            if len(self._passed) >= 3:
                first, second, third = self._passed[-3:]
                # The way from the second mark to the third is twice as long as that from the first to the second.
                # Marks passed in one look say nothing of the speed.
                steady = 0 < third - second <= 2 * self.SLACK * (second - first)
                self._steady = self._steady + 1 if steady else 0
            if self._steady >= (1 if mark >= 1 else 2) or len(self._passed) == len(self._marks):
                return True
        return False


def moved_by(system: BlockSystem, state: State, start: Array, unit: float | Array = 1.0) -> float:
    """Largest translation of any block since a motion ``(nd,)``, in a unit [m] or in each block's own ``(nb,)``."""
    return float((np.abs((state.motion - start)[system.rigid[:, :2]]).max(axis=1) / unit).max())
