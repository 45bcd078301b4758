"""The search for contacts: which sides of which blocks are near enough to touch before the next search."""

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from runningbond.scene import Array, Indices, Mask

from .outline import FLAT, Outline
from .rigid_sides import Placed, RigidSides, gather_sides

FASTEST_OPENING = math.sqrt(5)
"""Most by which an opening changes, in ways of the corner (`sharp_opening`)."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """Ends of facing sides, each array a row an end."""

    motion: Array  # (3 nb,) motion of the blocks when these contacts were found
    margin: float  # distance up to which they were sought [m]
    # (n, 6) corner of block b and of block a, far corners of their sides, and the sides (their first corners); b > a
    ends: NDArray[np.uint64]
    inwards: Array  # (n,) 1 where inwards is along the tangent of a's side, −1 where it is against it
    tilt: Array  # (n,) tilt of side against side, less the turns of the blocks [rad]
    area: Array  # (n,) area [m²] the end stands for
    # (n,) whether the end is of a joint of the undeformed wall and has not been lost since; none is when first found
    glued: Mask

    def __len__(self) -> int:
        return len(self.inwards)

    def chosen(self, rows: Mask | Indices) -> "Contacts":
        """Some of these."""
        return replace(
            self, **{name: getattr(self, name)[rows] for name in ("ends", "inwards", "tilt", "area", "glued")}
        )

    @property
    def key(self) -> Indices:
        """Number by which an end is recognised from one search to the next, ``(n,)``."""
        return np.asarray(self.ends[:, :2].astype(np.int64) @ [2**32, 1] * 2 + (self.inwards > 0))

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
            Placed(np.zeros((len(outline.blocks), 4)), np.zeros((len(outline.radius), 4))),
            np.zeros((len(self), 4)),
        )


def find_contacts(outline: Outline, motion: Array, margin: float) -> Contacts:
    """Find every end of facing sides that is nearer than a margin [m] after a motion ``(3 nb,)``.

    None of those left out touches before some block has moved by half the margin.
    """
    e, f = facing_sides(outline, motion, FASTEST_OPENING * margin)
    blocks, after = outline.blocks, outline.blocks.successor
    owner = blocks.owner
    spin = motion[2::3]
    swing = np.arctan2(*outline.normal.T[::-1])
    tilt = swing[e] + np.pi - swing[f]
    turned = spin[owner[e]] - spin[owner[f]]
    tilt = np.mod(tilt + turned + np.pi, 2 * np.pi) - np.pi - turned
    area = _area(outline, e, f)
    low = np.column_stack([after[e], f, e, after[f], e, f])
    high = np.column_stack([e, after[f], after[e], f, e, f])
    n = len(e)
    both = Contacts(
        motion.copy(),
        margin,
        np.concatenate([low, high]).astype(np.uint64),
        np.repeat([1.0, -1.0], n),
        np.tile(tilt, 2),
        np.tile(area, 2),
        np.zeros(2 * n, dtype=bool),
    )
    near = np.abs(jumps(outline, both, motion)[0]) < FASTEST_OPENING * margin
    # A corner rests on a side with that of its own two sides which faces it; its arc belongs half to each. A flat one
    # rests with both, each of which stands for its own area.
    corner, _ = resting(outline, both, motion)
    lean = -both.inwards * np.tile(tilt + turned, 2)
    return both.chosen(near & (np.abs(lean) <= np.maximum(outline.exterior[corner] / 2, FLAT)))


def jumps(outline: Outline, contacts: Contacts, motion: Array) -> Array:
    """Opening and slip of contacts after a motion ``(3 nb,)``, ``(2, n)`` [m]."""
    opening_and_slip = np.zeros((2, len(contacts)))
    gather_sides(motion, contacts.geometry(outline), *opening_and_slip)
    return opening_and_slip


def resting(outline: Outline, contacts: Contacts, motion: Array) -> tuple[Indices, Indices]:
    """Of each end, the corner that is farther in and the side it rests on after a motion ``(3 nb,)``, two ``(n,)``."""
    arcs = outline.placed(motion).arcs
    v, w, _, _, e, f = contacts.ends.astype(np.int64).T
    apart = arcs[v, :2] - arcs[w, :2]
    inwards = contacts.inwards * (apart[:, 1] * arcs[f, 2] - apart[:, 0] * arcs[f, 3])
    on_f = inwards >= 0
    return np.where(on_f, v, w), np.where(on_f, f, e)


def facing_sides(outline: Outline, motion: Array, margin: float) -> tuple[Indices, Indices]:
    """Sides e of one block and f of another, of lower number, that face each other and whose boxes are near."""
    blocks = outline.blocks
    corners, arcs = outline.corners(motion), outline.placed(motion).arcs
    following = corners[blocks.successor]
    low, high = np.minimum(corners, following) - margin / 2, np.maximum(corners, following) + margin / 2
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    e, f = shapely.STRtree(boxes).query(boxes)
    a, b = blocks.owner[f], blocks.owner[e]
    possible = (a < b) & ~(outline.held[a] & outline.held[b])
    e, f = e[possible], f[possible]
    facing = (arcs[e, 2:] * arcs[f, 2:]).sum(axis=1) < 0
    return e[facing], f[facing]


def _area(outline: Outline, e: Indices, f: Indices) -> Array:
    """Area of each end of facing sides, ``(n,)`` [m²]: half the joint's that they made on the undeformed wall.

    Sides that meet later are given half the shorter one as a joint, which is what running bond gives them from the
    start. The area sets a penalty stiffness, on which a dry wall's resistance hardly depends.
    """
    length, overlap = outline.length, overlaps(outline, e, f)
    shared: Array = np.where(overlap > 0, overlap, np.minimum(length[e], length[f]) / 2)
    return shared * outline.thickness / 2


def overlaps(outline: Outline, e: Indices, f: Indices) -> Array:
    """Length of the joint that facing sides made on the undeformed wall, ``(n,)`` [m]; zero where they made none."""
    blocks = outline.blocks
    start, stop = blocks.vertices, blocks.vertices[blocks.successor]
    length = outline.length
    along = (stop - start)[f] / length[f, None]
    first, last = (np.einsum("ij,ij->i", point[e] - start[f], along) for point in (stop, start))
    gap = np.abs([np.einsum("ij,ij->i", point[e] - start[f], outline.normal[f]) for point in (start, stop)])
    overlap = np.minimum(last, length[f]) - np.maximum(first, 0.0)
    joined = (gap.max(axis=0) <= blocks.tolerance) & (overlap > blocks.tolerance)
    return np.where(joined, overlap, 0.0)
