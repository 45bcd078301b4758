"""Rigid blocks at finite displacements, whose contacts are sought anew as they move."""

from dataclasses import dataclass, replace

import numpy as np

from dynamics import BlockSystem, Ledger, Run, State, block_frequency_squared
from joints import wall_points
from joints.laws import kernel_law
from joints.point_kernel import DAMPED_WORK, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE, KernelLaw
from scene import Array, Indices, Scene, SceneError

from .contacts import Contacts, Outline, find_contacts, jumps, resting
from .finite_kernels import gather_finite, scatter_finite
from .rigid_system import force_unit, loads_and_masses

PLASTIC_SLIP = 4
"""Row of the law's history: slip [m] at which a contact would be free of shear."""

HASTE = 2
"""Times the speed that blocks have, and that loads alone would give them, with which they are reckoned to move on."""

STEPS_AHEAD = 16
"""Steps of the fastest block within which sides count as near at least."""

LONGEST = 1000
"""Steps between two looks at how far the blocks have moved."""


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


def finite_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene on the contacts of the undeformed wall, three freedoms a block.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness, or pins corners, or glues its joints: a joint that has slid
        away from where it was glued has a cohesion that only a law with damage can speak of.
    """
    if len(scene.pins):
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
    if scene.joint.cohesion > 0:
        raise SceneError("joint.cohesion", "finite displacements need dry joints", scene.joint.cohesion)
    if scene.inner_joint is not None:
        raise SceneError("inner_joint", "finite displacements need blocks that do not crack")
    restraint, mass, dead, live, control = loads_and_masses(scene)
    outline = Outline.of(scene)
    contacts = find_contacts(outline, np.zeros_like(mass), outline.margin)
    law = _law(scene, contacts)
    still = np.zeros_like(mass)
    return BlockSystem(
        mass=mass,
        stiffness=still,
        viscosity=still,
        dead=dead,
        live=live,
        law=law,
        area=contacts.area,
        gather=gather_finite,
        scatter=scatter_finite,
        geometry=contacts.geometry(outline),
        rigid=np.arange(len(mass)).reshape(-1, 3),
        restraint=restraint,
        block_frequency_squared=_frequency_squared(outline, contacts, law, mass),
        control=control,
        force_unit=force_unit(scene, dead, live, wall_points(scene)),
    )


class FiniteRun(Run):
    """Rigid blocks of a scene in motion at finite displacements; its states are `FiniteState`.

    Parameters
    ----------
    scene
        The scene: dry joints with a stiffness, on a base or a fixed first course.
    system
        Its `finite_system`, with other masses or loads if need be.
    local, viscous
        Damping, as in `Run`. The time step follows the contacts.
    """

    def __init__(
        self, scene: Scene, system: BlockSystem | None = None, *, local: float = 0.5, viscous: float = 0.1
    ) -> None:
        system = system or finite_system(scene)
        super().__init__(system, local=local, viscous=viscous)
        self.scene, self.viscous = scene, viscous
        self.outline = Outline.of(scene)
        self._undeformed = find_contacts(self.outline, np.zeros_like(system.mass), self.outline.margin)
        self._undeformed_bound = system.block_frequency_squared
        self._loading = self._farthest((np.abs(system.dead) + np.abs(system.live)) / system.mass)
        self._contacts = self._undeformed

    def at_rest(self) -> FiniteState:
        """The undeformed wall without velocity."""
        nd = len(self.system.mass)
        self._take_up(self._undeformed)
        fresh = self._fresh_history(np.zeros(nd))
        return FiniteState(np.zeros(nd), np.zeros(nd), fresh, np.zeros(nd), np.zeros(nd), contacts=self._undeformed)

    def moved_to(self, motion: Array) -> FiniteState:
        """The wall without velocity after a motion ``(3 nb,)``, its contacts free of shear."""
        nd = len(motion)
        self._take_up(find_contacts(self.outline, motion, self.outline.margin))
        fresh = self._fresh_history(motion)
        return FiniteState(motion.copy(), np.zeros(nd), fresh, np.zeros(nd), np.zeros(nd), contacts=self._contacts)

    def hold(self, state: State, multiplier: float, steps: int, dead: float = 1.0) -> None:
        """Take steps under constant loads, as in `Run`."""
        finite = _finite(state)
        while steps > 0:
            piece = min(steps, self._look(finite))
            super().hold(finite, multiplier, piece, dead)
            finite.time += piece * self.dt
            steps -= piece

    def drive(self, state: State, speed: float, steps: int) -> float:
        """Take steps with the live load's power kept at `speed` [W]; returns the mean multiplier."""
        finite = _finite(state)
        total, left = 0.0, steps
        while left > 0:
            piece = min(left, self._look(finite))
            total += piece * super().drive(finite, speed, piece)
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
        room = state.contacts.margin / 2
        left = room - self._farthest(state.motion - state.contacts.motion)
        if left < room / 4:
            self._pair(state)
            left = state.contacts.margin / 2
        self._take_up(state.contacts)
        speed, gain = HASTE * self._farthest(state.velocity), HASTE * self._loading
        root = np.sqrt(speed**2 + 2 * gain * left)
        time = 2 * left / (speed + root) if root > 0 else np.inf
        return int(np.clip(time / self.dt, 1, LONGEST))

    def _pair(self, state: FiniteState) -> None:
        """Find the contacts of a state anew, in place, and hand their history on."""
        before, history = state.contacts, state.history
        corner_before, side_before = resting(self.outline, before, state.motion)
        shear = jumps(self.outline, before, state.motion)[1] - history[PLASTIC_SLIP]
        state.friction += float(before.area @ history[FRICTION_WORK])
        state.absorbed += float(before.area @ history[DAMPED_WORK])

        # What flies moves by many a step's way before the next look, and may be as deep in a block by then.
        fast = STEPS_AHEAD * self._farthest(state.velocity) * self.dt
        found = find_contacts(self.outline, state.motion, max(self.outline.margin, fast))
        # The same end of the same two sides; or, for a corner that has turned on, the same corner on the same side,
        # which goes on with the area that it had: another stiffness would jolt it.
        corner, side = resting(self.outline, found, state.motion)
        turned = _where(corner_before * 2**32 + side_before, corner * 2**32 + side)
        same = _where(before.key, found.key)
        on, still = turned >= 0, same >= 0
        area = found.area.copy()
        area[on] = before.area[turned[on]]
        area[still] = before.area[same[still]]

        state.contacts = replace(found, area=area)
        self._take_up(state.contacts)
        state.history = self._fresh_history(state.motion)
        state.history[PLASTIC_SLIP, on] -= shear[turned[on]]
        state.history[:, still] = history[:, same[still]]
        state.history[[FRICTION_WORK, DAMPED_WORK]] = 0.0

    def _fresh_history(self, motion: Array) -> Array:
        """History of contacts that are free of shear after a motion ``(3 nb,)``."""
        opening, slip = jumps(self.outline, self._contacts, motion)
        history = np.zeros((self.system.law.rows, len(opening)))
        history[OPENING_BEFORE], history[SLIP_BEFORE], history[PLASTIC_SLIP] = opening, slip, slip
        return history

    def _farthest(self, motion: Array) -> float:
        """At most how far any point of a block goes in a motion ``(3 nb,)`` [m]."""
        u, v, spin = motion.reshape(-1, 3).T
        return float((np.hypot(u, v) + np.abs(spin) * self.outline.reach).max())

    def _take_up(self, contacts: Contacts) -> None:
        """Go on with other contacts."""
        if contacts is self._contacts:
            return
        self._contacts = contacts
        law = _law(self.scene, contacts)
        bound = _frequency_squared(self.outline, contacts, law, self.system.mass)
        system = replace(
            self.system,
            law=law,
            area=contacts.area,
            geometry=contacts.geometry(self.outline),
            # Blocks that have flown apart have no frequency, and may meet again.
            block_frequency_squared=max(bound, self._undeformed_bound),
        )
        super().__init__(system, local=self.local, viscous=self.viscous)


def _law(scene: Scene, contacts: Contacts) -> KernelLaw:
    """Law of dry contacts; what a joint spends on its fracture does not matter to them."""
    dry = replace(scene.joint, fracture_energy_1=None, fracture_energy_2=None)
    return kernel_law((dry,), np.zeros(len(contacts), dtype=np.int64))


def _finite(state: State) -> FiniteState:
    if not isinstance(state, FiniteState):
        raise TypeError("finite displacements need a state that knows its contacts: begin with `FiniteRun.at_rest()`")
    return state


def _where(keys: Indices, sought: Indices) -> Indices:
    """Position in `keys` of each key sought, −1 where it is not among them."""
    if not len(keys):
        return np.full(len(sought), -1)
    order = np.argsort(keys)
    at = order[np.minimum(np.searchsorted(keys, sought, sorter=order), len(keys) - 1)]
    return np.where(keys[at] == sought, at, -1)


def _frequency_squared(outline: Outline, contacts: Contacts, law: KernelLaw, mass: Array) -> float:
    """Bound of the largest ω² [1/s²] with every contact closed, each block against its share of their stiffness.

    For any c > 0, (u_b − u_a)² ≤ (1 + c) u_b² + (1 + 1/c) u_a²; c = √(m_b / m_a) shares a contact between two blocks
    of different mass, and a held one takes no share.
    """
    geometry = contacts.geometry(outline)
    gather_finite(contacts.motion, geometry, *np.zeros((2, len(contacts))))
    centroid, contact = geometry[7][0][:, 2:], geometry[8]
    n = contact[:, 2:]
    t = np.column_stack([-n[:, 1], n[:, 0]])
    own = np.zeros((len(centroid), 3, 3))
    b, a = outline.blocks.owner[contacts.ends[:, :2].astype(np.int64)].T
    for block, other in ((a, b), (b, a)):
        arm = contact[:, :2] - centroid[block]
        with np.errstate(invalid="ignore"):
            part = 1 + np.nan_to_num(np.sqrt(mass[3 * block] / mass[3 * other]), nan=0.0, posinf=0.0)
        for direction, stiffness in ((n, law.normal_stiffness), (t, law.shear_stiffness)):
            row = np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])
            np.add.at(own, block, (part * stiffness * contacts.area)[:, None, None] * row[:, :, None] * row[:, None, :])
    movable = np.isfinite(mass[::3])
    return float(block_frequency_squared(own[movable], mass.reshape(-1, 3)[movable]).max())
