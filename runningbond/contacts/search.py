"""Contact search: the sides of blocks that are near enough to touch before the next search."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from runningbond.scene import Array, Indices, Mask, Unsigned

from .near import near_sides, overlaps, resting_ends
from .outline import FLAT, Outline, side_pair
from .rigid_sides import Placed, RigidSides, gather_sides, in_space

FASTEST_OPENING = math.sqrt(5)
"""Largest change of an opening per distance that the corner moves (`sharp_opening`)."""

CHECKED_DEPTH = 0.1
"""Depth of an end, relative to `Outline.margin`, above which it is checked that its blocks overlap half as deep."""

SAME_ANGLE = 1e-9
"""Difference of two angles that is rounding [rad]."""

LEAST_OVERLAP = 1e-6
"""Least overlap for the area of a contact between two sides, relative to the length of the shorter side."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """Contacts at the two ends of the overlap of facing sides; each array has one row per end."""

    motion: Array  # (3 nb,) motion of the blocks when these contacts were found
    margin: float  # distance up to which contacts were searched for [m]
    # (n, 6) corner of block b and of block a, far corners of their sides, and the sides (their first corners); b > a
    ends: Unsigned
    inwards: Array  # (n,) 1 if the overlap lies along the tangent of a's side from the end, −1 if against it
    tilt: Array  # (n,) tilt of side against side, minus the rotations of the blocks [rad]
    area: Array  # (n,) area [m²] that the end represents
    joint: Indices  # (n,) joint that the two sides formed on the undeformed wall; −1 for sides that met later
    # (n,) whether the end belongs to such a joint and every search since has found it; `find_contacts` sets none
    glued: Mask

    def __len__(self) -> int:
        return len(self.inwards)

    def chosen(self, rows: Mask | Indices) -> "Contacts":
        """The contacts of some rows."""
        return replace(
            self, **{name: getattr(self, name)[rows] for name in ("ends", "inwards", "tilt", "area", "joint", "glued")}
        )

    @cached_property
    def pairs(self) -> Indices:
        """The two ends of each pair of facing sides ``(n, 2)``, the low one first; a single end twice."""
        sides = side_pair(*self.ends[:, 4:].astype(np.int64).T)
        _, first, pair = np.unique(sides, return_index=True, return_inverse=True)
        ends, row = np.full((len(first), 2), -1), np.arange(len(self))
        ends[pair, np.where(self.inwards > 0, 0, 1)] = row
        return np.where(ends < 0, ends[:, ::-1], ends)[np.argsort(first)]

    @property
    def key(self) -> Indices:
        """Number that identifies each end from one search to the next, ``(n,)``."""
        return np.asarray(self.ends[:, :2].astype(np.int64) @ [2**32, 1] * 2 + (self.inwards > 0))

    def points(self, number: int = 0) -> tuple[Indices, Indices]:
        """Keys of all ends, or of `number` points along each pair (`along`), and the end at each point or −1.

        All points of a single end are at that end; points between two ends are at neither.
        """
        if not number:
            return self.key, np.arange(len(self))
        low, high = self.pairs.T
        alone, inner = low == high, np.arange(number)[:, None]
        key = 64 * self.key[low] + inner + np.where(alone & (inner > 0), 32, 0)
        key[-1] = np.where(alone, key[-1], 64 * self.key[high])
        end = np.where(alone, low, np.full((number, len(low)), -1))
        end[0], end[-1] = low, high
        return key.ravel(), end.ravel()

    def geometry(self, outline: Outline) -> RigidSides:
        """The arrays that `gather_sides` and `scatter_sides` share, with new buffers."""
        return RigidSides(
            outline.corner_arrays,
            outline.radius.copy(),
            outline.straight.copy(),
            self.ends.copy(),
            self.inwards.copy(),
            self.tilt.copy(),
            self.area.copy(),
            Placed(np.zeros((4, len(outline.blocks))), np.zeros((len(outline.radius), 4))),
            np.zeros((len(self), 4)),
            np.zeros(len(self)),
            np.zeros(len(self), dtype=bool),
        )

    def gathered(self, outline: Outline, motion: Array) -> RigidSides:
        """The arrays of `geometry` as `gather_sides` leaves them after a motion ``(3 nb,)``."""
        sides = self.geometry(outline)
        gather_sides(motion, tuple(sides), *np.zeros((2, len(self))))  # a plain tuple, as in steps: compiled once
        return sides

    def forces(self, outline: Outline, contact: Array, force: Array) -> "ContactForces":
        """Forces at the ends.

        Parameters
        ----------
        contact : (n, 4) float
            Point [m] and normal of each end in space.
        force : (2, n) float
            Normal and tangential force of each end [N].
        """
        sides = self.ends[:, :3:-1].astype(np.int64)  # of block a, and of block b
        return ContactForces(
            outline.blocks.owner[sides], contact[:, :2], in_space(force[0], force[1], contact[:, 2:]).T
        )


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Forces at contacts of moved blocks.

    Parameters
    ----------
    block : (n, 2) int
        Blocks a and b that touch each other.
    place : (n, 2) float
        Where they touch, after their motion [m].
    force : (n, 2) float
        Force of block b on block a, along x and y [N].
    """

    block: Indices = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    place: Array = field(default_factory=lambda: np.zeros((0, 2)))
    force: Array = field(default_factory=lambda: np.zeros((0, 2)))

    def __len__(self) -> int:
        return len(self.block)

    def chosen(self, rows: Mask) -> "ContactForces":
        """The forces of some contacts."""
        return ContactForces(self.block[rows], self.place[rows], self.force[rows])

    def resultants(self, count: int) -> Array:
        """Resultants on a number of blocks, moments about the origin, ``(nb, 3)`` [N, N, N m]."""
        (x, y), (fx, fy), (a, b) = self.place.T, self.force.T, self.block.T
        total = np.zeros((count, 3))
        for block, sense in ((a, 1.0), (b, -1.0)):
            np.add.at(total, block, sense * np.column_stack([fx, fy, x * fy - y * fx]))
        return total


def find_contacts(outline: Outline, motion: Array, margin: float) -> Contacts:
    """Find the ends of facing sides that are near at one end at least after a motion ``(3 nb,)``.

    An end is near if its opening is within √5 times the margin [m]. Sides that are left out cannot touch before some
    block has moved by half the margin.
    """
    e, f = facing_sides(outline, motion, FASTEST_OPENING * margin)
    owner = outline.blocks.owner
    spin = motion[2::3]
    swing = np.arctan2(*outline.normal.T[::-1])
    tilt = swing[e] + np.pi - swing[f]
    turned = spin[owner[e]] - spin[owner[f]]
    tilt = np.mod(tilt + turned + np.pi, 2 * np.pi) - np.pi - turned
    joint = outline.joint_of(e, f)
    area = _area(outline, e, f, joint, np.abs(tilt + turned), motion)
    (first_e, last_e), (first_f, last_f) = outline.ends[e].T, outline.ends[f].T
    low = np.column_stack([last_e, first_f, first_e, last_f, e, f])
    high = np.column_stack([first_e, last_f, last_e, first_f, e, f])
    n = len(e)
    both = Contacts(
        motion.copy(),
        margin,
        np.concatenate([low, high]).astype(np.uint64),
        np.repeat([1.0, -1.0], n),
        np.tile(tilt, 2),
        np.tile(area, 2),
        np.tile(joint, 2),
        np.zeros(2 * n, dtype=bool),
    )
    opening, _ = jumps(outline, both, motion)
    close = np.abs(opening) < FASTEST_OPENING * margin
    near = np.tile(close[:n] | close[n:], 2)
    near[near] = ~_past_each_other(outline, both.chosen(near), opening[near], motion)
    angle, lean = swing + spin[owner], np.abs(np.tile(tilt + turned, 2))
    near &= _with_the_side_that_faces(outline, both, angle, lean, motion)
    # A distant end is kept only with the close end of its pair. If that is dropped, so is the distant one: while
    # sides turn across each other, it would jump from far away to deep inside.
    there = near & close
    return both.chosen(near & np.tile(there[:n] | there[n:], 2))


def _with_the_side_that_faces(outline: Outline, contacts: Contacts, angle: Array, lean: Array, motion: Array) -> Mask:
    """Mask of ends where the side of the corner is the one of its two sides that faces the other block's side.

    Normals of sides are at angles ``(nv,)`` [rad], and the sides of each end lean by ``(n,)`` [rad] on each other. Half
    of a corner's arc belongs to each of its sides. A flat corner rests with both sides, each of which represents its
    own area. An end is also kept if its other corner is about to come to rest on the side of the first.
    """
    corner, side = resting(outline, contacts, motion)
    v, w, _, _, e, f = contacts.ends.astype(np.int64).T
    arcs = outline.placed(motion).arcs

    def faces(corner: Indices, side: Indices) -> Mask:
        exterior, own = outline.exterior[corner], outline.side[corner]
        # Angle from the corner's bisector to the side, computed alike for both sides: otherwise rounding might find
        # at 45° that neither faces it.
        off = np.mod(angle[own] - exterior / 2 - angle[side], 2 * np.pi) - np.pi
        at_start = (contacts.inwards < 0) == (side != e)
        return np.asarray(np.where(at_start, off <= 0, off > 0) & (lean <= exterior / 2 + SAME_ANGLE))

    soon = np.hypot(*(arcs[v, :2] - arcs[w, :2]).T) < contacts.margin
    soon &= faces(np.where(corner == v, w, v), np.where(side == f, e, f))
    faced: Mask = faces(corner, side) | soon | (lean <= FLAT)
    return faced


def _past_each_other(outline: Outline, contacts: Contacts, opening: Array, motion: Array) -> Mask:
    """Mask ``(n,)`` of ends more than twice as deep as convex parts of their blocks overlap along some side's normal.

    There a block has passed the end of the other block's side, and lies below this side without having penetrated it.
    A sharp corner would be treated as emerging at this end, from up to twice the overlap (`sharp_opening`).
    """
    parts, found, placed = outline.parts, np.zeros(len(contacts), dtype=bool), outline.placed(motion)
    arcs, normals = placed.arcs, placed.arcs[:, 2:]
    v, w, _, _, e, f = contacts.ends.astype(np.int64).T
    apart, side = arcs[v, :2] - arcs[w, :2], resting(outline, contacts, motion)[1]
    normal = np.where((side == f)[:, None], normals[f], -normals[e])
    depth = outline.radius[v] + outline.radius[w] - (apart * normal).sum(axis=1)
    along = np.abs(apart[:, 1] * normal[:, 0] - apart[:, 0] * normal[:, 1])
    # Corners beyond the end of the side that have not penetrated may still do so, except those far below the side:
    # until the next search blocks move by a margin against each other, and 2 · overlap − depth grows by √5 margins at
    # most, if the axis of the least overlap lies within a right angle of the side's normal. The overlap of blocks that
    # are apart is negative: their gap along that axis.
    beside = (opening >= 0) & (along >= outline.straight[side])
    deeper = depth - FASTEST_OPENING * contacts.margin
    asked = np.flatnonzero(depth > CHECKED_DEPTH * outline.margin)
    reach = np.empty(len(asked))
    cosine, sine = placed.blocks[:2, outline.blocks.owner[parts.corner]]
    x, y = parts.normal.T
    turned = np.column_stack([cosine * x - sine * y, sine * x + cosine * y])
    pairs = parts.of_side[np.column_stack([e, f])[asked]]
    overlaps(pairs, parts.first, outline.corners(motion)[parts.corner], turned, reach)
    least = np.where(opening < 0, depth, np.where(beside, deeper, deeper.clip(0)))
    found[asked] = reach < least[asked] / 2
    return found


def jumps(outline: Outline, contacts: Contacts, motion: Array) -> Array:
    """Jumps of contacts after a motion ``(3 nb,)``: opening and slip, ``(2, n)`` [m]."""
    opening_and_slip = np.zeros((2, len(contacts)))
    gather_sides(motion, tuple(contacts.geometry(outline)), *opening_and_slip)
    return opening_and_slip


def resting(outline: Outline, contacts: Contacts, motion: Array) -> tuple[Indices, Indices]:
    """Corner of each end that is farther in, and side that it rests on, after a motion ``(3 nb,)``, two ``(n,)``."""
    corner, side = np.empty((2, len(contacts)), dtype=np.int64)
    resting_ends(outline.placed(motion).arcs, contacts.ends, contacts.inwards, corner, side)
    return corner, side


def facing_sides(outline: Outline, motion: Array, margin: float) -> tuple[Indices, Indices]:
    """Pairs of facing sides whose boxes are within a margin [m]: sides e of one block, f of a lower-numbered block."""
    blocks = outline.blocks
    corners, arcs = outline.corners(motion), outline.placed(motion).arcs
    following = corners[blocks.successor]
    low, high = np.minimum(corners, following) - margin / 2, np.maximum(corners, following) + margin / 2
    of_sides, first = np.column_stack([low, high]), blocks.first
    of_blocks = np.column_stack(
        [np.minimum.reduceat(low, first[:-1], axis=0), np.maximum.reduceat(high, first[:-1], axis=0)]
    )
    arrays = (np.argsort(of_blocks[:, 0]), first, of_blocks, of_sides, np.ascontiguousarray(arcs[:, 2:]), outline.held)
    found = np.empty((8 * len(corners), 2), dtype=np.int64)
    if (count := near_sides(*arrays, found)) > len(found):
        near_sides(*arrays, found := np.empty((count, 2), dtype=np.int64))
    e, f = found[:count].T
    order = np.argsort(e * len(corners) + f)
    return e[order], f[order]


def _area(outline: Outline, e: Indices, f: Indices, joint: Indices, lean: Array, motion: Array) -> Array:
    """Area of each end of facing sides that lean by ``(n,)`` [rad], after a motion ``(3 nb,)``, ``(n,)`` [m²].

    Sides that formed a joint on the undeformed wall have half its area. Sides that meet later have half the area of
    their present overlap, at least `LEAST_OVERLAP` and at most half the shorter side, as in running bond: while a block
    slides from one block onto another, the share of the latter grows. Extensions behind re-entrant corners count if the
    sides lean, or a corner in a notch would have no area; for sides that lie flat, the adjacent side carries there. A
    leaning corner that comes round the end of a side moves in before the next search, the farther the more it leans:
    its overlap is at least the one that it reaches by then.
    """
    joints, shorter = outline.joints.length, np.minimum(outline.length[e], outline.length[f])
    by_then = outline.margin * np.minimum(lean / FLAT, 1.0)
    least = np.clip(by_then, LEAST_OVERLAP * shorter, shorter / 2)
    later = np.clip(_overlap(outline, e, f, lean, motion), least, shorter / 2)
    shared: Array = np.where(joint >= 0, joints[joint], later) if len(joints) else later
    return shared * outline.thickness_between(e, f) / 2


def _along(outline: Outline, e: Indices, f: Indices, motion: Array) -> tuple[Array, Array]:
    """Positions ``(n,)`` [m], along sides f, of the ends of sides e near the start and the end of f, in a motion."""
    corners = outline.corners(motion)
    return outline.along(f, corners[outline.blocks.successor[e]], motion), outline.along(f, corners[e], motion)


def _overlap(outline: Outline, e: Indices, f: Indices, lean: Array, motion: Array) -> Array:
    """Overlap ``(n,)`` [m] of facing sides that lean by ``(n,)`` [rad], along f; negative if they are apart."""
    (first, last), length = _along(outline, e, f, motion), outline.length
    behind = np.where((lean > FLAT)[:, None], [outline.run_on[e] * np.cos(lean)[:, None], outline.run_on[f]], 0.0)
    (behind_last, behind_first), (before, beyond) = behind.transpose(0, 2, 1)
    overlap: Array = np.minimum(last + behind_last, length[f] + beyond) - np.maximum(first - behind_first, -before)
    return overlap


def bearing_length(outline: Outline, contacts: Contacts) -> Array:
    """Length ``(n,)`` [m] over which the sides of each end would lie on each other if they turned flat about that end.

    It does not change as a block rocks on its corner, only as it slides; negative for sides that are apart.
    """
    e, f = contacts.ends[:, 4:].astype(np.int64).T
    (first, last), length = _along(outline, e, f, contacts.motion), outline.length
    low = contacts.inwards > 0
    start, end = np.where(low, first, last - length[e]), np.where(low, first + length[e], last)
    return np.asarray(np.minimum(end, length[f]) - np.maximum(start, 0.0))


def present_area(outline: Outline, contacts: Contacts) -> Array:
    """Area ``(n,)`` [m²] of each end, where ends of joints have half the area over which the blocks bear there now."""
    e, f = contacts.ends[:, 4:].astype(np.int64).T
    shorter = np.minimum(outline.length[e], outline.length[f])
    half = np.clip(bearing_length(outline, contacts), LEAST_OVERLAP * shorter, shorter) / 2
    return np.where(contacts.joint >= 0, half * outline.thickness_between(e, f), contacts.area)


def position_of(keys: Indices, sought: Indices) -> Indices:
    """Position in `keys` of each key in `sought`, −1 for keys that are missing."""
    if not len(keys):
        return np.full(len(sought), -1)
    order = np.argsort(keys)
    at = order[np.minimum(np.searchsorted(keys, sought, sorter=order), len(keys) - 1)]
    return np.where(keys[at] == sought, at, -1)
