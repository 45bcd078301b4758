"""When contacts are searched for again at finite displacements, and how their history is passed on."""

import math
from dataclasses import replace

import numpy as np

from runningbond.contacts.search import Contacts, bearing_length, position_of
from runningbond.joints.compiled import kernel
from runningbond.joints.law import COMMON_ROWS, DAMPED_WORK, FRICTION_WORK, PLASTIC_CLOSURE
from runningbond.joints.wall_law import bears_by_area
from runningbond.scene import Array, Indices

from .state import PLASTIC_SLIP, State, frames_of, history_free_of_shear
from .system import BlockSystem, ContactSearch, Interface

SPEED_FACTOR = 2
"""Safety factor on the speed of bodies and on their accelerations by loads and ties, to predict how far they move."""

STEPS_AHEAD = 128
"""Least time steps of the fastest body that the search distance covers: a search takes as long as hundreds of them."""

OPENING_MARGIN = 1.1
"""Factor on the opening of unbroken joints in the search distance."""

MOST_STEPS = 1000
"""Most steps between two checks of how far the bodies have moved."""

INTERFACES_KEPT = 2
"""Number of interfaces kept: an observed state may still have the contacts before those of the state that goes on."""

SAME_LENGTH = 1e-9
"""Relative difference of two bearing lengths that is rounding."""


class ContactUpdate:
    """Update of the contacts of states as the bodies of a system move."""

    def __init__(self, system: BlockSystem, search: ContactSearch) -> None:
        self._system, self._search = system, search
        self._bodies = system.rigid, search.outline.reach
        self._still = np.zeros(system.rigid.size)
        self._live = self.acceleration(system.live)
        self._drawn = system.ties.accelerations(system.mass, search.outline.reach)
        self._made: list[tuple[Contacts, Interface]] = []

    def interface_on(self, contacts: Contacts) -> Interface:
        """The interface on contacts, with a frequency no lower than that of the undeformed wall."""
        undeformed = self._system.interface
        if contacts is self._search.undeformed:
            return undeformed
        for made, interface in self._made:
            if made is contacts:
                return interface
        interface = self._search.interface_on(contacts, self._system)
        # Bodies that have flown apart have no frequency, but may meet again.
        closer = interface.closer and max(interface.closer, undeformed.closer or 0.0)
        bound = max(interface.frequency_squared, undeformed.frequency_squared)
        interface = replace(interface, frequency_squared=bound, closer=closer)
        self._made = [(contacts, interface), *self._made[: INTERFACES_KEPT - 1]]
        return interface

    def acceleration(self, load: Array) -> float:
        """Largest acceleration of any point of a body under a load ``(nd,)`` [N] alone [m/s²]."""
        far: float = farthest(np.abs(load) / self._system.mass, self._still, *self._bodies, 0.0, 0.0)
        return far

    def steps_until_next_look(self, state: State, dt: float, acceleration: float, multiplier: float = 0.0) -> int:
        """Number of time steps `dt` [s] after which bodies may have moved so far that a contact could be missed.

        Zero if they have used up three quarters of that distance. `acceleration` [m/s²] is that by constant loads
        alone; the `multiplier` of the live load adds to it.
        """
        contacts = contacts_of(state)
        way = contacts.margin / 2 - self._search.deformation(state.motion)
        left = way - apart(state.motion, contacts.motion, *self._bodies)
        if left < way / 4:
            return 0
        drawn = float(self._drawn @ self._system.ties.force(state.motion, state.stretch)) if len(self._drawn) else 0.0
        speed = SPEED_FACTOR * self._travel(state.velocity)
        gain = SPEED_FACTOR * (acceleration + abs(multiplier) * self._live + drawn)
        root = math.sqrt(speed**2 + 2 * gain * left)
        time = 2 * left / (speed + root) if root > 0 else math.inf
        return int(min(max(time / dt, 1.0), MOST_STEPS))

    def renew(self, state: State, interface: Interface, dt: float) -> Interface:
        """Search for the contacts of a state again, in place, pass on their history and return the interface on them.

        The contacts so far are those of `interface`; `dt` is the time step [s].
        """
        search, before, history = self._search, contacts_of(state), state.history
        rested = search.resting(before, state.motion)
        opening, slip = interface.jumps(state.motion)
        plastic_slip = interface.law.law.row(PLASTIC_SLIP)
        interface.reframe(tuple(interface.geometry), (state.bears, plastic_slip), history)
        state.friction += float(interface.area @ history[FRICTION_WORK])
        state.absorbed += float(interface.area @ history[DAMPED_WORK])

        # A body in flight may move on by many steps before the next check, and penetrate a block by as much; one that
        # has hit a block may be deeper, and must be kept until it is thrown back.
        fast = STEPS_AHEAD * self._travel(state.velocity) * dt
        deep = -2 * opening.min(initial=0.0)
        # A joint that is not broken yet must be kept too, however far it has opened.
        whole = (interface.law.tension > 0) & (interface.law.damage(history) < 1)
        drawn = OPENING_MARGIN * opening[whole].max(initial=0.0)
        contacts = search.find(state.motion, max(search.outline.margin, fast, deep, drawn))
        crushes = bears_by_area(interface.law.law)
        contacts = search.bearing(contacts) if crushes else contacts
        # Match ends of the same two sides; or, for a corner that has rolled over, the same corner on the same side,
        # which keeps its area: another stiffness would jolt it.
        turned = position_of(rested, search.resting(contacts, state.motion))
        same = position_of(before.key, contacts.key)
        on, still = turned >= 0, same >= 0
        area, glued = contacts.area.copy(), np.zeros(len(contacts), dtype=bool)
        area[on & ~still] = before.area[turned[on & ~still]]
        # Sides that met later carry more as their overlap grows, and keep the larger area.
        kept_area = before.area[same[still]]
        of_joint = area[still] if crushes else kept_area
        area[still] = np.where(contacts.joint[still] >= 0, of_joint, np.maximum(area[still], kept_area))
        glued[still] = before.glued[same[still]]

        state.contacts = replace(contacts, area=area, glued=glued)
        renewed = self.interface_on(state.contacts)
        state.history, bore = history_free_of_shear(renewed, state.motion), state.bears
        state.bears = frames_of(renewed, state.contacts)
        state.bears[still] = bore[same[still]]
        # Points keep their whole history; those of a corner that has rolled over keep it relative to the present slip.
        (keys, ends), (new_keys, new_ends) = search.points(before), search.points(state.contacts)
        kept, new = position_of(keys, new_keys), state.history[plastic_slip].copy()
        origin = np.where((new_ends >= 0) & (kept < 0), np.append(turned, -1)[new_ends], -1)
        corner = position_of(ends, origin)
        moved = np.flatnonzero((origin >= 0) & (corner >= 0))
        state.history[len(COMMON_ROWS) :, moved] = history[len(COMMON_ROWS) :, corner[moved]]
        state.history[plastic_slip, moved] += new[moved] - slip[corner[moved]]
        state.history[:, kept >= 0] = history[:, kept[kept >= 0]]
        state.history[[FRICTION_WORK, DAMPED_WORK]] = 0.0
        share = np.zeros(len(kept))  # area that a point had before, relative to its area
        share[moved] = 1.0
        share[kept >= 0] = interface.area[kept[kept >= 0]] / renewed.area[kept >= 0]
        if crushes:
            # Where a block slides off its neighbour, contacts grow by what their neighbours lose, pressed as they are.
            length, less = bearing_length(search.outline, contacts), np.zeros(len(contacts) + 1, dtype=bool)
            less[:-1][still] = length[still] <= bearing_length(search.outline, before)[same[still]] * (1 + SAME_LENGTH)
            energy = _borne(interface, opening, slip, history)[1]
            left = np.append(renewed.area, 0.0)[position_of(new_keys, keys)] / interface.area
            left[corner[moved]] = 1.0
            at_end = ends >= 0
            lost = (interface.area * energy * np.maximum(0.0, 1 - left))[at_end]
            of_joints = np.zeros(before.joint.max(initial=-1) + 2)
            np.add.at(of_joints, before.joint[ends[at_end]] + 1, lost)
            grows = np.flatnonzero(less[new_ends] & (share < 1) & (kept >= 0))
            wanted, joint = renewed.area[grows] * energy[kept[grows]], contacts.joint[new_ends[grows]]
            share[grows] = _pressed_as_before(share[grows], wanted, joint, of_joints)
        state.friction += _spread(renewed, state, share)
        return renewed

    def _travel(self, velocity: Array) -> float:
        """Upper bound of half the speed at which any two points of bodies separate at a velocity ``(nd,)`` [m/s]."""
        far: float = apart(velocity, self._still, *self._bodies)
        return far


@kernel
def apart(motion: Array, origin: Array, rigid: Indices, reach: Array) -> float:
    """Upper bound of half the distance by which two points of bodies separate in a motion, as bodies are rigid [m].

    Parameters
    ----------
    motion : (nd,)
        Motion, of which ``rigid`` ``(n, 3)`` are the translations and the rotation of each body.
    origin : (3 n,)
        Rigid motion of the bodies before.
    reach : (n,)
        Distance of the farthest point of each body from its centroid [m].
    """
    x, y = midway(motion, origin, rigid, 0), midway(motion, origin, rigid, 1)
    far: float = farthest(motion, origin, rigid, reach, x, y)
    return far


@kernel
def midway(motion: Array, origin: Array, rigid: Indices, axis: int) -> float:
    """Middle between the smallest and the largest translation of a body along an axis; arguments as in `apart`."""
    low, high = math.inf, -math.inf
    for body in range(len(rigid)):
        moved = motion[rigid[body, axis]] - origin[3 * body + axis]
        low, high = min(low, moved), max(high, moved)
    return 0.5 * (low + high)


@kernel
def farthest(motion: Array, origin: Array, rigid: Indices, reach: Array, x: float, y: float) -> float:
    """Upper bound of how far points of bodies move relative to a translation ``(x, y)``; arguments as in `apart`."""
    most = 0.0
    for body in range(reach.size):
        across = motion[rigid[body, 0]] - origin[3 * body] - x
        upwards = motion[rigid[body, 1]] - origin[3 * body + 1] - y
        turned = motion[rigid[body, 2]] - origin[3 * body + 2]
        most = max(most, math.hypot(across, upwards) + abs(turned) * reach[body])
    return most


def _spread(interface: Interface, state: State, share: Array) -> float:
    """Pass on the forces of points whose area has changed by 1 / `share`, in place; return the energy lost [J].

    New contact area starts without pressure or shear: the force of a point is kept and not its traction, otherwise
    springs would be compressed without a cause. Area that is lost takes its force and its energy along. Points of a law
    without a plastic closure keep their traction.
    """
    law, history, closed = interface.law, state.history, interface.law.law.closed
    if closed is None:
        return 0.0
    opening, slip = interface.jumps(state.motion)
    seat, rest = history[law.law.row(PLASTIC_CLOSURE)], history[law.law.row(PLASTIC_SLIP)]
    grown = (share < 1) & (-opening > seat)
    (normal, _), before = _borne(interface, opening, slip, history)
    part = share[grown]
    seat[grown] = -opening[grown] - closed(law, np.maximum(0.0, -share * normal))[0][grown]
    rest[grown] = part * rest[grown] + (1 - part) * slip[grown]
    _, after = _borne(interface, opening, slip, history)
    return float(interface.area @ (share * before - after))


def _pressed_as_before(share: Array, energy: Array, joint: Indices, lost: Array) -> Array:
    """Shares ``(n,)`` of points' areas that are pressed as before, if they grow by what others of their joint lose.

    The new area that is pressed stores no more than the others did: if blocks lean on a corner, they have borne little.

    Parameters
    ----------
    share, energy : (n,) float
        Areas that points had before, relative to their areas, and the energy that these would store [J].
    joint : (n,) int
        Joints of the points, -1 for those of none.
    lost : (nj + 1,) float
        Energy of the area that points of each joint have lost [J], first of those of none.
    """
    wanted = np.bincount(joint + 1, (1 - share) * energy, len(lost))
    part = np.divide(lost, wanted, out=np.ones(len(lost)), where=wanted > lost)
    return np.asarray(share + (1 - share) * np.minimum(1.0, part)[joint + 1])


def _borne(interface: Interface, opening: Array, slip: Array, history: Array) -> tuple[Array, Array]:
    """Tractions ``(2, np)`` [Pa] of points, and their recoverable energy ``(np,)`` [J/m²]."""
    law, tractions = interface.law, np.zeros((2, interface.law.points))
    law.kernel(opening, slip, law.parameters, history.copy(), 0.0, *tractions)
    return tractions, law.energy(opening, tractions[0], tractions[1], history)


def contacts_of(state: State) -> Contacts:
    """The contacts of a state at finite displacements.

    Raises
    ------
    TypeError
        If the state is one at small displacements.
    """
    if state.contacts is None:
        raise TypeError("finite displacements need a state with contacts: begin with State.at_rest of their system")
    return state.contacts
