"""Areas of contacts in joints of deformable blocks: on the undeformed wall, and as blocks slide over each other."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from runningbond.contacts.search import Contacts, bearing_length, position_of
from runningbond.scene import Array, Indices, Mask

from .node_outline import NodeOutline

LOST = 1.5
"""Distance of a point from the end of an overlap at which the end takes over its force, in halves of its space: the
kernel lets it go at 1. The rest is how far blocks may slide until the next search."""

WIDEST = 1.8
"""Largest distance of a contact from the next one that carries, relative to the usual one, if the points between them
are lost: 1 + `LOST` / 2, and some more for rounding."""

LEAST_MARGIN = 0.25
"""Least margin, relative to `Outline.margin`, so that contacts are not searched for too often: a point that is lost
before the next search is missing until then."""


@dataclass(frozen=True, eq=False)
class Spaces:
    """Where contacts are in their joints, each ``(n,)``."""

    along: Array  # position along side f [m]
    before: Array  # distance of a point from its neighbours on its side, the one towards the start of f [m],
    after: Array  # and the other one; at ends of overlaps as in `_to_points`
    inside: Array  # distance of a point inside the ends of the other block's side [m]; infinite at ends of overlaps
    half: Array  # half the smaller distance of a point from its neighbours [m]
    carries: Mask  # in a joint, and either an end of the overlap or farther inside than a part of `half`

    @classmethod
    def of(cls, blocks: NodeOutline, contacts: Contacts, at: Array, part: float = 1.0) -> "Spaces":
        """Spaces of contacts at positions ``(n, 2)`` [m]; points carry farther inside than `part` of `half`."""
        e, f = contacts.ends[:, 4:].astype(np.int64).T
        inner, of_a = contacts.inwards == 0, contacts.ends[:, 2] == 1
        point = np.where(inner, contacts.ends[:, 0].astype(np.int64) - len(blocks.outline.radius), 0)
        following, previous = np.where(inner, blocks.gap[[point, point - 1]], 0.0)
        along = blocks.outline.along(f, at, contacts.motion)
        on = np.where(of_a, e, f)
        near_end, far_end = blocks.sides.inset[blocks.sides.ends[on]].T
        place = np.where(of_a, blocks.outline.along(e, at, contacts.motion), along)
        inside = np.minimum(place - near_end, blocks.outline.length[on] - far_end - place)
        half = blocks.points.half[point]
        carries = (contacts.joint >= 0) & (~inner | (inside > part * half))
        # Points of side f are numbered along it, those of side e against it.
        before, after = np.where(of_a, previous, following), np.where(of_a, following, previous)
        towards, low = _to_points(blocks, contacts, at, part), contacts.inwards > 0
        before, after = np.where(inner | low, before, towards), np.where(inner | ~low, after, towards)
        return cls(along, before, after, np.where(inner, inside, np.inf), half, carries)

    def widths(self, joint: Indices) -> Array:
        """Width ``(n,)`` [m] of contacts in joints ``(n,)`` by trapezoids between those that carry; 0 for others.

        On a side where the neighbour of a contact is missing, because the blocks lean and it is too far from the other
        side, its width is as if the neighbour were there. That also holds if all points between the two ends of an
        overlap are missing: half of the overlap for each would make a corner many times as stiff as before.
        """
        order = np.flatnonzero(self.carries)
        order = order[np.lexsort((self.along[order], joint[order]))]
        first, second = order[:-1], order[1:]
        gap, usual = self.along[second] - self.along[first], np.maximum(self.after[first], self.before[second])
        near = (joint[first] == joint[second]) & ((gap < WIDEST * usual) | (usual == 0))
        wide = np.zeros(len(joint))
        np.add.at(wide, first, np.where(near, gap, self.after[first]) / 2)
        np.add.at(wide, second, np.where(near, gap, self.before[second]) / 2)
        wide[order[:1]] += self.before[order[:1]] / 2
        wide[order[-1:]] += self.after[order[-1:]] / 2
        return wide


@dataclass(frozen=True, eq=False)
class BearingAreas:
    """Areas of the contacts of joints.

    Parameters
    ----------
    blocks
        The blocks.
    contacts
        The contacts of the undeformed wall.
    at : (n, 2) float
        Their positions [m].
    """

    blocks: NodeOutline
    contacts: Contacts
    at: Array

    @cached_property
    def undeformed(self) -> Array:
        """Areas ``(n,)`` [m²] of the contacts of the undeformed wall, which add up to the area of their joint.

        They are the weights of the rule on the joint's elements if contacts lie on its points. If arcs of corners move
        its ends inwards, they are trapezoids, and the area under the arcs is distributed over its contacts.
        """
        contacts, outline, points = self.contacts, self.blocks.outline, self.blocks.wall.elements.points
        joint, carries, wide = contacts.joint, self._wide > 0, self._wide
        if not carries.any():
            return contacts.area
        whole = np.bincount(joint[carries], wide[carries], len(outline.joints))
        stretch = np.divide(outline.joints.length, whole, out=np.ones(len(whole)), where=whole > 0)
        nearest, apart = self.nearest
        off, of_points = np.zeros(len(outline.joints)), np.bincount(nearest, points.area, len(contacts))
        np.maximum.at(off, points.joint, apart)
        area = np.where(carries, wide * stretch[joint] * _thickness(self.blocks, contacts), contacts.area)
        return np.where(carries & (off < outline.blocks.tolerance)[joint], of_points, area)

    @cached_property
    def nearest(self) -> tuple[Indices, Array]:
        """The nearest contact of each joint element's point in its joint, and how far it is [m], two ``(np,)``."""
        points = self.blocks.wall.elements.points
        nearest, off = np.zeros(len(points), dtype=np.int64), np.zeros(len(points))
        for joint in np.unique(points.joint):
            here, own = np.flatnonzero(points.joint == joint), np.flatnonzero(self.contacts.joint == joint)
            apart = points.position[here, None] - self.at[own]
            distance = np.hypot(apart[..., 0], apart[..., 1])
            nearest[here], off[here] = own[distance.argmin(axis=1)], distance.min(axis=1)
        return nearest, off

    def initial(self, contacts: Contacts) -> Contacts:
        """Contacts of which those of joints have the area of the undeformed wall."""
        return replace(contacts, area=self._of_undeformed(contacts, self.undeformed, contacts.area))

    def _of_undeformed(self, contacts: Contacts, values: Array, other: Array | float) -> Array:
        """Values ``(n,)`` at contacts from those of the undeformed wall; `other` at contacts that it did not have."""
        at = position_of(self.contacts.key, contacts.key)
        known = (at >= 0) & (np.append(self.contacts.joint, -1)[at] == contacts.joint) & (contacts.joint >= 0)
        return np.where(known, np.append(values, 0.0)[at], other)

    def present(self, contacts: Contacts, at: Array) -> Contacts:
        """Contacts at positions ``(n, 2)`` [m] with areas that add up to the overlap, as in `ContactSearch.bearing`.

        A point hands its force over to the end of the overlap just before it is lost. The contacts' margin is so small
        that none is lost before the next search.
        """
        spaces = Spaces.of(self.blocks, contacts, at, LOST)
        wide = spaces.widths(contacts.joint)
        trapezoid = wide * _thickness(self.blocks, contacts)
        whole = np.append(self.blocks.outline.joints.length, np.inf)[contacts.joint]
        overlap = np.clip(bearing_length(self.blocks.outline, contacts) / whole, 0.0, 1.0)
        excess = overlap * self._of_undeformed(contacts, self._excess, 0.0)
        area = np.maximum(trapezoid + excess, trapezoid / 2)
        left = spaces.carries | (contacts.joint < 0)
        spare = (spaces.inside - spaces.half)[spaces.carries].min(initial=np.inf)
        contacts = replace(contacts, area=np.where(wide > 0, area, contacts.area))
        return replace(
            contacts.chosen(left), margin=min(contacts.margin, max(spare, LEAST_MARGIN * self.blocks.outline.margin))
        )

    @cached_property
    def _wide(self) -> Array:
        return Spaces.of(self.blocks, self.contacts, self.at).widths(self.contacts.joint)

    @cached_property
    def _excess(self) -> Array:
        """Area ``(n,)`` [m²] of the contacts of the undeformed wall beyond that of their trapezoids."""
        return self.undeformed - self._wide * _thickness(self.blocks, self.contacts)


def _to_points(blocks: NodeOutline, contacts: Contacts, at: Array, part: float) -> Array:
    """Distance ``(n,)`` [m] of ends of overlaps at ``(n, 2)`` from the next point inwards that carries on flat sides.

    Zero if their side has none, and for contacts that are no ends. `part` is that of `Spaces.of`.
    """
    outline, (side, along), half = blocks.outline, blocks.places, blocks.points.half
    e, f = contacts.ends[:, 4:].astype(np.int64).T
    own_is_f = outline.held[outline.blocks.owner[e]]  # as in `DeformableContacts`, whose points these are
    own = np.where(own_is_f, f, e)
    place = np.where(own_is_f, outline.along(f, at, contacts.motion), outline.along(e, at, contacts.motion))
    # Side e runs against f, and with it the way inwards.
    way = np.where((contacts.inwards > 0) == own_is_f, 1, -1)
    points = np.flatnonzero(blocks.bearing)
    reach = 2 * float(outline.length.max())  # sides one after the other on one line, farther apart than they are long
    line = side[points] * reach + along[points]
    # Points are sorted along their sides. One that is too near the end is followed by one that is far enough.
    sought = own * reach + np.clip(place, 0.0, outline.length[own])
    first = np.where(way > 0, np.searchsorted(line, sought, "right"), np.searchsorted(line, sought) - 1)
    found = np.zeros(len(contacts))
    for step in (1, 0):
        number = first + step * way
        there = (number >= 0) & (number < len(points))
        point = points[np.where(there, number, 0)] if len(points) else np.zeros(len(first), dtype=np.int64)
        far = way * (along[point] - place)
        there &= (side[point] == own) & (far > part * half[point])
        found = np.where(there, far, found)
    return np.where(contacts.inwards == 0, 0.0, found)


def _thickness(blocks: NodeOutline, contacts: Contacts) -> Array:
    """Out-of-plane thickness of contacts ``(n,)`` [m]."""
    e, f = contacts.ends[:, 4:].astype(np.int64).T
    return blocks.outline.thickness_between(e, f)
