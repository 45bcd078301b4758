"""The search for contacts: which sides of which blocks are near enough to touch before the next search."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from runningbond.scene import Array, Indices, Mask, Unsigned

from .near import near_sides, reaches, resting_ends
from .outline import FLAT, Outline, side_pair
from .rigid_sides import Placed, RigidSides, gather_sides, in_space

FASTEST_OPENING = math.sqrt(5)
"""Most by which an opening changes, in ways of the corner (`sharp_opening`)."""

DEEP = 0.1
"""Depth of an end, in margins of the outline, from which on it is asked whether its blocks reach as deep."""

SAME_ANGLE = 1e-9
"""Difference of two angles that is rounding [rad]."""

LEAST_OVERLAP = 1e-6
"""Least overlap of two sides for which their contact has a stiffness, in lengths of the shorter one."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """Ends of facing sides, each array a row an end."""

    motion: Array  # (3 nb,) motion of the blocks when these contacts were found
    margin: float  # distance up to which they were sought [m]
    # (n, 6) corner of block b and of block a, far corners of their sides, and the sides (their first corners); b > a
    ends: Unsigned
    inwards: Array  # (n,) 1 where inwards is along the tangent of a's side, −1 where it is against it
    tilt: Array  # (n,) tilt of side against side, less the turns of the blocks [rad]
    area: Array  # (n,) area [m²] the end stands for
    joint: Indices  # (n,) joint that the two sides made on the undeformed wall; −1 for sides that met later
    # (n,) whether the end is of such a joint and has not been lost since; none is when first found
    glued: Mask

    def __len__(self) -> int:
        return len(self.inwards)

    def chosen(self, rows: Mask | Indices) -> "Contacts":
        """Some of these."""
        return replace(
            self, **{name: getattr(self, name)[rows] for name in ("ends", "inwards", "tilt", "area", "joint", "glued")}
        )

    @cached_property
    def pairs(self) -> Indices:
        """The two ends of each pair of facing sides, the low one first; twice the same where there is but one."""
        sides = side_pair(*self.ends[:, 4:].astype(np.int64).T)
        _, first, pair = np.unique(sides, return_index=True, return_inverse=True)
        ends, row = np.full((len(first), 2), -1), np.arange(len(self))
        ends[pair, np.where(self.inwards > 0, 0, 1)] = row
        return np.where(ends < 0, ends[:, ::-1], ends)[np.argsort(first)]

    @property
    def key(self) -> Indices:
        """Number by which an end is recognised from one search to the next, ``(n,)``."""
        return np.asarray(self.ends[:, :2].astype(np.int64) @ [2**32, 1] * 2 + (self.inwards > 0))

    def points(self, number: int = 0) -> tuple[Indices, Indices]:
        """A key of each end, or of a number of points along each pair (`along`), and the end that it is or −1.

        All points of an end that is alone are that end, and none of those between two.
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
        """The arrays that `gather_sides` and `scatter_sides` share, with buffers of their own."""
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
        gather_sides(motion, tuple(sides), *np.zeros((2, len(self))))  # plain, as in the steps: compiled once
        return sides

    def resultants(self, outline: Outline, contact: Array, force: Array) -> Array:
        """Resultants on each block, moments about the origin, ``(nb, 3)`` [N, N, N m].

        Parameters
        ----------
        contact : (n, 4) float
            Point [m] and normal of each end in space.
        force : (2, n) float
            Its normal and tangential force [N].
        """
        (x, y), (fx, fy) = contact[:, :2].T, in_space(force[0], force[1], contact[:, 2:])
        b, a = outline.blocks.owner[self.ends[:, 4:].astype(np.int64)].T
        total = np.zeros((len(outline.blocks), 3))
        for block, sense in ((a, 1.0), (b, -1.0)):
            np.add.at(total, block, sense * np.column_stack([fx, fy, x * fy - y * fx]))
        return total


def find_contacts(outline: Outline, motion: Array, margin: float) -> Contacts:
    """Find every end of facing sides one of whose two is nearer than a margin [m] after a motion ``(3 nb,)``.

    None of those left out touches before some block has moved by half the margin.
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
    # One that is there for the sake of another, which it is not now, might be anywhere: as sides turn across each
    # other it would go from far away to far inside at once.
    there = near & close
    return both.chosen(near & np.tile(there[:n] | there[n:], 2))


def _with_the_side_that_faces(outline: Outline, contacts: Contacts, angle: Array, lean: Array, motion: Array) -> Mask:
    """Whether corners rest on a side with that of their own two which faces it; sides lean by ``(n,)`` [rad] on it.

    Normals of sides are at angles ``(nv,)`` [rad]. The arc of a corner belongs half to each. A flat corner rests with
    both, each of which stands for its own area. So does one on which another is about to come to rest, with that of its
    sides which is to bear it.
    """
    corner, side = resting(outline, contacts, motion)
    v, w, _, _, e, f = contacts.ends.astype(np.int64).T
    arcs = outline.placed(motion).arcs

    def faces(corner: Indices, side: Indices) -> Mask:
        exterior, own = outline.exterior[corner], outline.side[corner]
        # From the bisector of the corner to the side, in the same numbers for both sides, or at 45° neither might face.
        off = np.mod(angle[own] - exterior / 2 - angle[side], 2 * np.pi) - np.pi
        at_start = (contacts.inwards < 0) == (side != e)
        return np.asarray(np.where(at_start, off <= 0, off > 0) & (lean <= exterior / 2 + SAME_ANGLE))

    soon = np.hypot(*(arcs[v, :2] - arcs[w, :2]).T) < contacts.margin
    soon &= faces(np.where(corner == v, w, v), np.where(side == f, e, f))
    faced: Mask = faces(corner, side) | soon | (lean <= FLAT)
    return faced


def _past_each_other(outline: Outline, contacts: Contacts, opening: Array, motion: Array) -> Mask:
    """Ends that lie deeper than parts of their blocks reach into each other along the normal of any side, ``(n,)``.

    Such a block has come by the end of the other one's side, and is below it without having gone through it. A sharp
    corner there would take that end for the one that it is coming out at (`sharp_opening`).
    """
    parts, found, placed = outline.parts, np.zeros(len(contacts), dtype=bool), outline.placed(motion)
    arcs, normals = placed.arcs, placed.arcs[:, 2:]
    v, w, _, _, e, f = contacts.ends.astype(np.int64).T
    apart, side = arcs[v, :2] - arcs[w, :2], resting(outline, contacts, motion)[1]
    normal = np.where((side == f)[:, None], normals[f], -normals[e])
    depth = outline.radius[v] + outline.radius[w] - (apart * normal).sum(axis=1)
    along = np.abs(apart[:, 1] * normal[:, 0] - apart[:, 0] * normal[:, 1])
    # Of corners that are not in yet, those at the end of a side may come in, but for those that are past it by far.
    beside = (opening >= 0) & (along >= outline.straight[side])
    far = contacts.margin * np.where(outline.radius[v] + outline.radius[w] > 0, 1.0, FASTEST_OPENING)
    deep = np.where(beside, far, DEEP * outline.margin)
    asked = np.flatnonzero(depth > deep)
    reach = np.empty(len(asked))
    cosine, sine = placed.blocks[:2, outline.blocks.owner[parts.corner]]
    x, y = parts.normal.T
    turned = np.column_stack([cosine * x - sine * y, sine * x + cosine * y])
    pairs = parts.of_side[np.column_stack([e, f])[asked]]
    reaches(pairs, parts.first, outline.corners(motion)[parts.corner], turned, reach)
    # Nor may those come in that are beneath a side, and deeper than blocks go before contacts are sought again.
    inside = (opening < 0) | (~beside & (depth > contacts.margin))
    found[asked] = reach < np.where(inside, depth / 2, 0.0)[asked]
    return found


def jumps(outline: Outline, contacts: Contacts, motion: Array) -> Array:
    """Opening and slip of contacts after a motion ``(3 nb,)``, ``(2, n)`` [m]."""
    opening_and_slip = np.zeros((2, len(contacts)))
    gather_sides(motion, tuple(contacts.geometry(outline)), *opening_and_slip)
    return opening_and_slip


def resting(outline: Outline, contacts: Contacts, motion: Array) -> tuple[Indices, Indices]:
    """Of each end, the corner that is farther in and the side it rests on after a motion ``(3 nb,)``, two ``(n,)``."""
    corner, side = np.empty((2, len(contacts)), dtype=np.int64)
    resting_ends(outline.placed(motion).arcs, contacts.ends, contacts.inwards, corner, side)
    return corner, side


def facing_sides(outline: Outline, motion: Array, margin: float) -> tuple[Indices, Indices]:
    """Sides e of one block and f of another, of lower number, that face each other and whose boxes are near."""
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
    """Area of each end of facing sides, leaning by ``(n,)`` [rad], after a motion ``(3 nb,)``, ``(n,)`` [m²].

    Half the joint's that they made on the undeformed wall. Sides that meet later have half of what they overlap now,
    at least `LEAST_OVERLAP`, at most half the shorter one, which is what running bond gives them from the start: as a
    block slides from one onto another, the share of that one grows. What sides run on by counts as theirs where they
    lean, or a corner in a notch would have nothing to lean on; one that lies flat has the side beside it. A corner that
    comes round the end of a side onto it, leaning, goes in before contacts are sought again, the farther the more it
    leans: it has what it overlaps by then.
    """
    length, joints = outline.length, outline.joints.length
    corners, after = outline.corners(motion), outline.blocks.successor
    along = (corners[after[f]] - corners[f]) / length[f, None]
    first, last = (((corners[end] - corners[f]) * along).sum(axis=1) for end in (after[e], e))
    behind = np.where((lean > FLAT)[:, None], [outline.run_on[e] * np.cos(lean)[:, None], outline.run_on[f]], 0.0)
    (behind_last, behind_first), (before, beyond) = behind.transpose(0, 2, 1)
    overlap = np.minimum(last + behind_last, length[f] + beyond) - np.maximum(first - behind_first, -before)
    shorter = np.minimum(length[e], length[f])
    by_then = outline.margin * np.minimum(lean / FLAT, 1.0)
    later = np.clip(overlap, np.clip(by_then, LEAST_OVERLAP * shorter, shorter / 2), shorter / 2)
    shared: Array = np.where(joint >= 0, joints[joint], later) if len(joints) else later
    return shared * outline.thickness_between(e, f) / 2


def position_of(keys: Indices, sought: Indices) -> Indices:
    """Position in `keys` of each key sought, −1 where it is not among them."""
    if not len(keys):
        return np.full(len(sought), -1)
    order = np.argsort(keys)
    at = order[np.minimum(np.searchsorted(keys, sought, sorter=order), len(keys) - 1)]
    return np.where(keys[at] == sought, at, -1)
