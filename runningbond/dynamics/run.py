"""A run: time integration of a system at small or at finite displacements, with its energy ledger."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from runningbond.contacts.search import ContactForces, Contacts
from runningbond.joints.law import DAMPED_WORK, FRICTION_WORK
from runningbond.results.reactions import resultants
from runningbond.scene import ANCHOR, Array

from .central_differences import CONTROLS, Control, Watch, step
from .contact_update import ContactUpdate, contacts_of
from .kernel_calls import Addresses, addresses
from .rig import NO_RIG, turn_rig
from .state import PLASTIC_SLIP, State
from .system import BlockSystem, Interface
from .ties import YIELD
from .time_step import stable_step
from .turning_loads import NO_TURNING_LOADS, turn_live, turn_loads
from .turning_supports import NO_TURNING_SUPPORTS
from .update import Damping, update_of

LOCAL, VISCOUS = 0.5, 0.1
"""Local damping α, and the joints' viscous damping ratio at the highest frequency."""

MOVING, CALMING = 0.2, 0.8
"""Damping α of walls that move far, small as it slows down drift; and large, until they rest or if it is combined."""

Observer: TypeAlias = Callable[["Run", State, float], None]
"""Called now and then with a run, its state and the multiplier; changes none of them."""


def no_observer(run: "Run", state: State, multiplier: float) -> None:
    """Observe nothing."""


@dataclass(frozen=True)
class Ledger:
    """Energy balance of a run [J]: the work of the loads and where it went; the rest is the residual."""

    external: float
    kinetic: float
    elastic: float
    joint: float
    friction: float
    damped: float
    ties: float = 0.0

    @property
    def residual(self) -> float:
        """Work that the integration lost or created."""
        spent = self.kinetic + self.elastic + self.joint + self.friction + self.damped + self.ties
        return self.external - spent


class Unstable(ArithmeticError):
    """Raised if a run spends more energy than it was supplied with, as it does with too long a time step.

    The message contains the number of steps, the time step taken and, if it is longer, one that is safe [s]. A run
    whose motion is no longer a number (`is_lost`) ends as well: its joints' law may give none.
    """

    def __init__(self, steps: int, step: float, safe: float, *, is_lost: bool = False) -> None:
        what = "the motion is no longer finite" if is_lost else "more energy was spent than supplied"
        message = f"unstable: {what} after {steps} time steps of {step:.4g} s"
        why = "the step is safe for vibrations, not for any impact"
        if step > safe:
            why = f"a step of {safe:.4g} s is safe"
        elif is_lost:
            why = "the law of the joints may give tractions that are no numbers"
        super().__init__(f"{message}; {why}")
        self.steps = steps


class Run:
    """A system in motion.

    If the system searches for contacts, they are searched for again whenever its bodies may have moved so far that one
    is missed; the interface, and with it the stable time step, is updated too.

    Parameters
    ----------
    system
        The bodies and their interface.
    local
        Local damping α: each freedom is resisted by α times its unbalanced force.
    viscous
        Damping ratio of the stiffness-proportional viscosity of the joints, at the bound of the highest frequency.
    dt
        Time step [s]; by default a fraction of the stable one.
    part
        That fraction.
    damping
        How `local` resists: at all times, or such that drift is not slowed down (`update`).
    """

    def __init__(
        self,
        system: BlockSystem,
        *,
        local: float = LOCAL,
        viscous: float = VISCOUS,
        dt: float | None = None,
        part: float = 1.0,
        damping: Damping = "local",
    ) -> None:
        self.system, self.local, self.viscous, self._part = system, local, viscous, part
        self._damping = damping
        self._advance_modes, self._memory = update_of(system, damping)
        self._given_step = dt
        self._rig = tuple(system.rig or NO_RIG)
        self._turning_dead, self._turning_live = (
            (loads.points.arrays, *loads[1:])
            for loads in (system.turning_dead or NO_TURNING_LOADS, system.turning_live or NO_TURNING_LOADS)
        )
        self._turning_supports = tuple(system.turning_supports or NO_TURNING_SUPPORTS)
        self._ties = *system.ties[:4], system.ties.ends.arrays, system.ties.length
        self.is_driven = False  # whether displacements are prescribed, so that observers find no rest under a load
        self._modes = (system.stiffness, system.viscosity, 1 / system.mass)
        search = system.contacts
        self._update = None if search is None else ContactUpdate(system, search)
        self._take_up(system.interface, None if search is None else search.undeformed)

    def __getstate__(self) -> dict[str, Any]:
        """Everything except the kernels' addresses, which are valid only in this process."""
        return self.__dict__ | {"_addresses": None}

    def _take_up(self, interface: Interface, contacts: Contacts | None) -> None:
        """Continue with an interface, on contacts."""
        self.interface, self._contacts = interface, contacts
        bound, closer = (
            self.system.ties.frequency_squared(square, self.system.mass)
            for square in (interface.frequency_squared, interface.closer or interface.frequency_squared)
        )
        self.safe_step = stable_step(closer, self.viscous * math.sqrt(closer / bound), self.local)
        self.dt = self._given_step or self._part * self.safe_step
        self._viscosity = 2 * self.viscous / math.sqrt(bound) / self.dt
        self._addresses: Addresses | None = None
        # Plain tuples: unpacking a named one costs each kernel call half a step of a small wall.
        restraint = tuple(self.system.restraint)
        self._arrays = (tuple(interface.geometry), interface.law.parameters, self._modes, restraint)
        rows = interface.law.law.history
        self._plastic = rows.index(PLASTIC_SLIP) if PLASTIC_SLIP in rows else -1
        self._work = (*np.zeros((2, len(self.system.mass))), *(np.zeros(interface.law.points) for _ in range(4)))

    def interface_of(self, state: State) -> Interface:
        """The interface on the contacts of a state, which may be another state than that of the last steps."""
        if self._update is None or self._contacts is (contacts := contacts_of(state)):
            return self.interface
        return self._update.interface_on(contacts)

    def return_to(self, state: State) -> None:
        """Continue with the interface on the contacts of a state, which may be another state than before."""
        if (interface := self.interface_of(state)) is not self.interface:
            self._take_up(interface, contacts_of(state))

    def steps_until(self, time: float, state: State) -> int:
        """Number of steps that bring a state to a time [s], on its present contacts; at least one."""
        self.return_to(state)
        return max(1, round((time - state.time) / self.dt))

    def _pieces(self, state: State, steps: int, load: Array, more: float | None) -> Iterator[int]:
        """Numbers of steps to take one after the other; the contacts stay valid during each of them.

        A load ``(nd,)`` [N] acts on the bodies, and the live load up to the multiple `more`; if that is None, the
        multiple that drove the bodies in the last steps.
        """
        if self._update is None:
            yield steps
            return
        update, acceleration = self._update, self._update.acceleration(load)
        while steps > 0:
            self.return_to(state)
            loads = acceleration, state.multiplier if more is None else more
            piece = update.steps_until_next_look(state, self.dt, *loads)
            if not piece:
                self._take_up(update.renew(state, self.interface, self.dt), contacts_of(state))
                piece = max(1, update.steps_until_next_look(state, self.dt, *loads))
            piece = min(steps, piece)
            yield piece
            steps -= piece

    def hold(
        self,
        state: State,
        multiplier: float,
        steps: int,
        dead: float = 1.0,
        *,
        rise: float = 0.0,
        given: float = math.inf,
    ) -> None:
        """Take steps under `multiplier` times the live load, which may rise, and `dead` times the dead load.

        Parameters
        ----------
        state
            Integrated in place.
        multiplier, dead
            Factors on the live and the dead load.
        steps
            Number of steps.
        rise
            Increase of the multiplier per step.
        given
            Energy [J] of the state apart from the work of its loads, as `given` returns it; inf disables the checks
            that energy is finite and not created.

        Raises
        ------
        Unstable
            As soon as an energy check fails; the state is left as it is then.
        """
        if self.system.turning_live is not None and (multiplier or rise):
            raise ValueError("live loads at points of bodies that turn do not stay as they are; they may drive")
        load = dead * self.system.dead + multiplier * self.system.live
        self._advance("held", state, load, rise, steps, given)

    def bear(self, state: State, load: Array, steps: int) -> None:
        """Take steps under a constant load ``(nd,)`` [N]; like `hold` without energy checks."""
        self._advance("held", state, load, 0.0, steps, math.inf)

    def drive(self, state: State, speed: float, steps: int, *, given: float = math.inf) -> float:
        """Take steps with the live load's power ``f_live · v`` kept at `speed` [W]; return the mean multiplier.

        `given` is used for energy checks as in `hold`.
        """
        return self._advance("driven", state, self.system.dead, speed, steps, given) / steps

    def carry(self, state: State, speed: float, steps: int, *, given: float = math.inf) -> float:
        """Take steps with supports moved at a speed [1/s], in their motion at λ = 1.

        Return the mean force of the wall on them, per unit of that motion [J]; `given` as in `hold`.
        """
        return self._advance("carried", state, self.system.dead, speed, steps, given) / steps

    def _advance(self, control: Control, state: State, load: Array, speed: float, steps: int, given: float) -> float:
        """Take steps under a constant load and a control; return the sum of the multipliers of `step`."""
        total, system, number = 0.0, self.system, CONTROLS.index(control)
        if control != "held" and len(system.coupling.freedom):
            raise ValueError("modes that have inertia in common bear a load alone")
        live = system.carried.motion if control == "carried" else system.live
        if control == "carried":
            live = live.copy() if system.turning_supports else live
        elif system.rig is not None or system.turning_live is not None:
            live = self._live()  # the live load rotates with the beam or with blocks
        more = None if control == "driven" else speed * steps if control == "held" else 0.0
        for piece in self._pieces(state, steps, load, more):
            before = float(load.dot(state.motion))  # the @ operator takes twice as long, for each piece
            watch = (state.steps, given + state.external - before, state.supplied)
            taken, stable, multipliers, work = self._take(number, state, load, live, speed, piece, watch)
            total += multipliers
            if control == "driven":
                state.multiplier = multipliers / taken
            state.external += float(load.dot(state.motion)) - before + work
            if control == "held" and speed:
                load = load + taken * speed * live
            state.steps += taken
            state.time += taken * self.dt
            is_lost = given < math.inf and not math.isfinite(state.external)
            if is_lost or not stable:
                raise Unstable(state.steps, self.dt, self.safe_step, is_lost=is_lost)
        return total

    def _live(self) -> Array:
        """A copy of the live load of the undeformed wall at λ = 1, to be rotated."""
        if self.system.turning_live is not None:
            self.system.turning_live.more[:] = 0.0
        return self.system.live.copy()

    def _take(
        self, number: int, state: State, load: Array, live: Array, speed: float, steps: int, watch: Watch
    ) -> tuple[int, bool, float, float]:
        """Take steps on the present contacts; return the results of `step`."""
        if self._addresses is None:
            self._addresses = addresses(self.interface, self._advance_modes, self._memory)
        arrays = (state.motion, state.velocity, state.history, state.damped, state.unbalanced)
        scales = (self.dt, self.local, self._viscosity)
        ties = (*self._ties, state.stretch)
        frames = (state.bears, self._plastic)
        far = (self._rig, self._turning_dead, self._turning_live, self._turning_supports)
        every = (self._addresses, *self._arrays, ties, far, self._memory, arrays, self._work, frames)
        found: tuple[int, bool, float, float] = step(number, steps, scales, load, live, speed, every, watch)
        for moments in (self.system.rig, self.system.turning_dead):
            if moments is not None:
                state.turned += float(moments.work[0])
                moments.work[0] = 0.0
        return found

    def _ahead(self, state: State, load: Array) -> State:
        """A copy of a state, one step ahead under a load ``(nd,)`` [N], except for its count of steps and its works."""
        if self.local:
            raise ValueError("local damping would remember a step that is not taken")
        interface, contacts, ahead = self.interface, self._contacts, state.copy()
        self.return_to(state)
        self._take(CONTROLS.index("held"), ahead, load, self.system.live, 0.0, 1, (0, math.inf, ahead.supplied))
        if self._contacts is not contacts:
            self._take_up(interface, contacts)
        return ahead

    def held_late(self, state: State) -> "Run":
        """The run of the system with its dead load on (`BlockSystem.held_late`); stops the late modes of a state."""
        system = self.system.held_late
        if system is self.system:
            return self
        late = self.system.late
        state.velocity[late] = 0.0
        # The work of damping on modes held from now on is kept: the ledger counts `damped` of moving modes only.
        state.absorbed += float(state.damped[late].sum())
        state.damped[late] = 0.0
        return self.of_system(system)

    @cached_property
    def drifting(self) -> "Run":
        """The same run with combined damping, which does not slow down drift, and an α no larger than `MOVING`.

        It does slow down drift with superposed vibration, the less the smaller α.
        """
        return self._of(self.system, min(self.local, MOVING), "combined")

    def of_system(self, system: BlockSystem) -> "Run":
        """The same run for another system of the same bodies."""
        return self._of(system, self.local, self._damping)

    def _of(self, system: BlockSystem, local: float, damping: Damping) -> "Run":
        step, part = self._given_step, self._part
        return Run(system, local=local, viscous=self.viscous, dt=step, part=part, damping=damping)

    def unaccounted(self, state: State, least: float = 0.0, since: State | None = None) -> float:
        """Missing energy relative to the work of the loads, or to `least` [J] if that is more; in all or since a state.

        The works of the dead and the live load count separately, because they nearly cancel while a slender wall
        topples, and so does the energy that ties have released from their preloads.
        """
        residual, *works = self._works(state)
        if since is not None:
            residual, *works = np.subtract((residual, *works), self._works(since))
        work = max(float(np.abs(works).sum()), least)
        return float(abs(residual) / work) if work else 0.0

    def _works(self, state: State) -> tuple[float, float, float, float]:
        """Residual of the ledger, and works of the dead load, of the live load and of the preloads [J]."""
        ledger, dead = self.ledger(state), self.dead_work(state)
        return ledger.residual, dead, ledger.external - dead, min(0.0, ledger.ties)

    def dead_work(self, state: State) -> float:
        """Work of the dead load [J]."""
        return float(self.system.dead @ state.motion) + state.turned

    def driven(self, state: State) -> float:
        """Displacement of the driven point along the live load at λ = 1, times that load [J]."""
        rig, live = self.system.rig, self.system.live
        return float(live @ state.motion) if rig is None else live[rig.freedom[0]] * rig.displacement(state.motion)

    def driven_speed(self, state: State) -> float:
        """Rate of `driven` [W]."""
        live = self.system.live
        if self.system.rig is not None:
            turn_rig(tuple(self.system.rig), state.motion, live := live.copy())
        return float(live @ state.velocity)

    def given(self, state: State) -> float:
        """Energy [J] of a state that loads did not supply: preloads of ties, or an initial motion set by hand."""
        return max(0.0, -self.ledger(state).residual) - self.system.ties.stored(np.zeros(len(self.system.ties)))

    def damped(self, state: State) -> float:
        """Work that damping has taken so far, of bodies and in joints [J]."""
        of_bodies = state.damped[np.isfinite(self.system.mass)].sum()
        return float(of_bodies + self.interface_of(state).area @ state.history[DAMPED_WORK]) + state.absorbed

    def unbalanced(self, state: State) -> float:
        """Largest unbalanced force of the last step, each in its unit (`force_unit`), as a rule its block's weight."""
        return self.system.measure(state.unbalanced)

    def forces(self, state: State) -> tuple[Array, Array]:
        """Normal and tangential force at each point ``(np,)`` [N]; the state is not changed."""
        _, _, normal, tangential = self.tractions(state)
        area = self.interface_of(state).area
        return normal * area, tangential * area

    def tractions(self, state: State) -> tuple[Array, Array, Array, Array]:
        """Opening and slip [m] and tractions [Pa] of the points; neither the state nor the time step is changed."""
        interface = self.interface_of(state)
        law = interface.law
        opening, slip = interface.jumps(self.system.unrestrained(state.motion))
        normal, tangential = np.zeros((2, law.points))
        # Without viscosity, which is negligible at rest: it would need the rate of a step that is not taken.
        law.kernel(opening, slip, law.parameters, state.history.copy(), 0.0, normal, tangential)
        return opening, slip, normal, tangential

    def at_joints(self, state: State) -> Array:
        """Opening, slip [m], normal, tangential force [N], damage, plastic closure [m] of joints' points, ``(6, n)``.

        At finite displacements these are points of the undeformed wall's joints, without `new_contacts`.
        """
        jumps, tractions = np.split(np.array(self.tractions(state)), 2)
        interface, search = self.interface_of(state), self.system.contacts
        broken = interface.law.damage(state.history), interface.law.crushed(state.history)
        values = np.vstack([jumps, interface.area * tractions, *broken])
        return values if search is None else search.at_joints(contacts_of(state), values)

    def pulls_at_joints(self, state: State) -> Array:
        """Force of block b on a at joints' points at finite displacements, ``(2, np)`` [N], along x and y in space."""
        search = self.system.contacts
        if search is None:
            raise TypeError("at small displacements forces have the directions of the undeformed joints")
        pulls = search.pulls(contacts_of(state), state.motion, np.array(self.forces(state)))
        none = np.zeros_like(pulls)
        return search.at_joints(contacts_of(state), np.vstack([none, pulls, none]))[2:4]

    def new_contacts(self, state: State) -> ContactForces:
        """Contacts that bear forces and are not in `at_joints`; none at small displacements."""
        search = self.system.contacts
        if search is None:
            return ContactForces()
        found = search.forces(contacts_of(state), state.motion, np.array(self.forces(state)))
        return found.chosen(search.left_out(contacts_of(state)) & found.force.any(axis=1))

    def resultants(self, state: State, multiplier: float) -> Array:
        """Resultants of contacts, ties and loads on bodies, moments about the origin, ``(n, 3)`` [N, N m]."""
        system, live, search = self.system, self._live(), self.system.contacts
        if search is None:
            raise TypeError("resultants are those at finite displacements")
        moment = turn_rig(self._rig, state.motion, live) if system.rig else 0.0
        turn_live(self._turning_live, state.motion, live)
        loads = system.dead + multiplier * live
        turn_loads(self._turning_dead, state.motion, loads)
        total = loads[system.rigid]
        if system.rig:
            total[system.rigid[:, 0] == system.rig.freedom[0], 2] += moment
        at = search.outline.blocks.centroid + state.motion[system.rigid][:, :2]
        total[:, 2] += at[:, 0] * total[:, 1] - at[:, 1] * total[:, 0]
        ends = system.ties.ends
        if len(ends.arm):
            tied, origin = ends.body != ANCHOR, np.zeros((len(total), 2))
            places, pulls = ends.places(state.motion), system.ties.pulls(state.motion, state.stretch)
            total += resultants(ends.body[tied], places[tied], pulls[tied], origin)
        contacts = search.forces(contacts_of(state), state.motion, np.array(self.forces(state)))
        return np.asarray(total + contacts.resultants(len(total)))

    def ledger(self, state: State, load: Array | None = None) -> Ledger:
        """Energy balance of a run so far.

        Velocities are half a step behind motions, and works of joints one step. If the `load` ``(nd,)`` [N] that acts
        is given, both are evaluated at the time of the motion, with the kinetic energy ½ m v⁻ v⁺; central differences
        of an elastic system under a constant load then have no residual.
        """
        opening, _, normal, tangential = self.tractions(state)
        interface = self.interface_of(state)
        ahead = state if load is None else self._ahead(state, load)
        mean, change = (ahead.velocity + state.velocity) / 2, (ahead.velocity - state.velocity) / 2
        damped = ((state.damped + ahead.damped) / 2)[np.isfinite(self.system.mass)]
        system, law, area, ties = self.system, interface.law, interface.area, self.system.ties
        return Ledger(
            external=state.external,
            kinetic=system.kinetic_energy(mean) - system.kinetic_energy(change),
            elastic=float(0.5 * (system.stiffness * state.motion**2).sum()),
            joint=float(area @ law.energy(opening, normal, tangential, ahead.history)),
            friction=float(area @ ahead.history[FRICTION_WORK]) + state.friction,
            damped=float(damped.sum() + area @ ahead.history[DAMPED_WORK]) + state.absorbed,
            ties=ties.stored(ties.force(state.motion, ahead.stretch)) + float(ties.constants[:, YIELD] @ ahead.stretch),
        )
