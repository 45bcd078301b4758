"""Rigid blocks at finite displacements, with contact detection as they move."""

from dataclasses import replace
from functools import cached_property

import numpy as np

from runningbond.contacts.materials import ContactMaterials
from runningbond.contacts.outline import Outline
from runningbond.contacts.rigid_sides import (
    RigidSides,
    gather_sharp,
    gather_sides,
    in_space,
    reframe_sharp,
    scatter_sides,
    turn_out,
    turned_sharp,
)
from runningbond.contacts.search import ContactForces, Contacts, find_contacts, position_of, present_area, resting
from runningbond.dynamics import BlockSystem, Interface, moving_far
from runningbond.dynamics.displacements import check_finite
from runningbond.joints import wall_rule
from runningbond.joints.along import along, gather_along, scatter_along
from runningbond.joints.frames import keep_frames, reframe_along
from runningbond.scene import Array, Indices, Mask, Scene

from .finite_frequency import frequencies_squared
from .rigid_system import contact_points, held_masses, system_on


def finite_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene, three freedoms a block, for finite displacements.

    Raises
    ------
    SceneError
        As raised by `check_finite`, `ContactMaterials` and `Outline.of`.
    """
    check_finite(scene)
    contacts = RigidContacts(scene)
    rigid = np.arange(3 * len(scene.blocks)).reshape(-1, 3)
    system = system_on(scene, contacts.interface_on(contacts.undeformed), rigid)
    return moving_far(system, scene, contacts, (scene.dead_forces, scene.live_forces))


class RigidContacts:
    """Contacts of a scene's rigid blocks; see `runningbond.dynamics.ContactSearch`."""

    def __init__(self, scene: Scene) -> None:
        self.outline, self._materials = Outline.of(scene), ContactMaterials(scene)
        self._rule = wall_rule(scene, finite=True)
        self._gather = gather_sides if self.outline.radius.any() else gather_sharp
        self._points = len(self._rule.nodes) if len(self._rule.nodes) > 2 else 0
        self._scene, self._mass = scene, held_masses(scene)
        self._reframes = self._gather is gather_sharp
        undeformed = self.find(np.zeros(3 * len(scene.blocks)), self.outline.margin)
        self.undeformed = replace(undeformed, glued=undeformed.joint >= 0)

    def find(self, motion: Array, margin: float) -> Contacts:
        """Contacts closer than a margin [m] after a motion ``(3 nb,)``, grouped by material."""
        contacts = find_contacts(self.outline, motion, margin)
        return self._materials.side_by_side(contacts)

    def bearing(self, contacts: Contacts) -> Contacts:
        """The contacts with the areas over which blocks bear now, as in `ContactSearch`."""
        return replace(contacts, area=present_area(self.outline, contacts))

    def interface_on(self, contacts: Contacts, system: BlockSystem | None = None) -> Interface:
        """Interface of the blocks on given contacts."""
        ends = contacts.gathered(self.outline, contacts.motion)
        if not self._points:
            law = self._materials.law(contacts)
            frequencies = self._frequencies(ends, law.stiffest, law.shear_stiffness)
            reframe = reframe_sharp if self._reframes else keep_frames
            return Interface(law, contacts.area, self._gather, scatter_sides, ends, *frequencies, reframe)
        pairs = contacts.pairs
        law = self._materials.law(contacts, pairs, self._points)
        normal, shear = np.zeros((2, len(contacts)))
        # The consistent stiffness of the points does not exceed that of their ends alone.
        for of_ends, of_points in ((normal, law.stiffest), (shear, law.shear_stiffness)):
            of_ends[pairs] = of_points[: len(pairs), None]
        geometry, area = along(ends, pairs, contacts.area, self._rule)
        kernels = gather_along(self._gather), scatter_along(scatter_sides)
        reframe = reframe_along(turned_sharp) if self._reframes else keep_frames
        return Interface(law, area, *kernels, geometry, *self._frequencies(ends, normal, shear), reframe)

    def _frequencies(self, ends: RigidSides, normal: Array, shear: Array) -> tuple[float, float | None]:
        """Bound of the largest ω², and a closer value if the ground moves."""
        bound, closer = frequencies_squared(ends, normal, shear, self._mass)
        return bound, closer if self._scene.history else None

    def points(self, contacts: Contacts) -> tuple[Indices, Indices]:
        """Key of each point of the interface on contacts, and the contact end at it or −1; two ``(np,)``."""
        return contacts.points(self._points)

    def at_joints(self, contacts: Contacts, values: Array) -> Array:
        """Values at `contact_points` from those at the contacts' points, as in `ContactSearch`."""
        at = position_of(self.points(contacts)[0], self._key_of_point)
        lost = np.array([contacts.margin, 0.0, 0.0, 0.0, 0.0, 0.0])  # a lost point is open by at least the margin
        values = self._summed_at_single_ends(contacts, values)
        return np.column_stack([values, lost])[:, at]  # index -1, for points that are lost, is the last column

    def _summed_at_single_ends(self, contacts: Contacts, values: Array) -> Array:
        """Values ``(6, np)`` in which the first point of each single end has the force of all points there.

        It alone is a point of the joint: the others have keys of their own.
        """
        if not self._points:
            return values
        low, high = contacts.pairs.T
        alone, summed = low == high, values.reshape(6, self._points, len(low)).copy()
        summed[2:4, 0, alone] = summed[2:4, :, alone].sum(axis=1)
        return summed.reshape(values.shape)

    def pulls(self, contacts: Contacts, motion: Array, force: Array) -> Array:
        """Forces in space as in `ContactSearch`; a point between two ends pulls as its shares at these ends would."""
        ends = contacts.gathered(self.outline, motion)
        if not self._points:
            pull, shear = turn_out.py_func(*force, ends.out)
            return in_space(pull, shear, ends.contact[:, 2:])
        pairs, share, along = contacts.pairs, (self._rule.nodes[:, None] + 1) / 2, np.zeros_like(force)
        for end, part in enumerate((1 - share, share)):
            at = np.tile(pairs[:, end], self._points)
            pull, shear = turn_out.py_func(*force, ends.out[at])
            along += np.repeat(part, len(pairs)) * in_space(pull, shear, ends.contact[at, 2:])
        return along

    def forces(self, contacts: Contacts, motion: Array, force: Array) -> ContactForces:
        """Forces at the ends of overlaps, as in `ContactSearch`."""
        ends = contacts.gathered(self.outline, motion)
        if self._points:
            pairs, share = contacts.pairs, (self._rule.nodes[:, None] + 1) / 2
            along, force = force.reshape(2, self._points, -1), np.zeros((2, len(contacts)))
            for end, part in enumerate((1 - share, share)):
                np.add.at(force.T, pairs[:, end], (part * along).sum(axis=1).T)
        return contacts.forces(self.outline, ends.contact, np.array(turn_out.py_func(*force, ends.out)))

    def left_out(self, contacts: Contacts) -> Mask:
        """Contacts of sides that met later."""
        return contacts.joint < 0

    @cached_property
    def _key_of_point(self) -> Indices:
        """Key of the contact point at each of `contact_points` on the undeformed wall."""
        contacts, points = self.undeformed, contact_points(self._scene)
        key, _ = self.points(contacts)
        ends = contacts.gathered(self.outline, contacts.motion)
        at, joint = ends.contact[:, :2], contacts.joint
        if self._points:
            pairs, share = contacts.pairs, (self._rule.nodes[:, None, None] + 1) / 2
            at = ((1 - share) * at[pairs[:, 0]] + share * at[pairs[:, 1]]).reshape(-1, 2)
            joint = np.tile(joint[pairs[:, 0]], self._points)
        tangent = self.outline.joints.ends[:, 1] - self.outline.joints.ends[:, 0]
        here, own = np.flatnonzero(joint >= 0), np.flatnonzero(points.joint < len(tangent))
        along = (at[here] * tangent[joint[here]]).sum(axis=1), (points.position * points.tangent).sum(axis=1)[own]
        found = np.full(len(points), -1)  # contacts of single corners are found like those of sides that meet later
        found[own[np.lexsort((along[1], points.joint[own]))]] = key[here][np.lexsort((along[0], joint[here]))]
        return found

    def resting(self, contacts: Contacts, motion: Array) -> Indices:
        """Number that identifies the resting corner and the side under it, for each contact."""
        corner, side = resting(self.outline, contacts, motion)
        return corner * 2**32 + side

    def deformation(self, motion: Array) -> float:
        """Zero, because the blocks are rigid."""
        return 0.0
