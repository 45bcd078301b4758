"""Which sides of which blocks face each other, near enough to touch before anyone looks again."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from runningbond.scene import Array, Blocks, Indices, Mask, Scene, SceneError

from .side_kernels import gather_finite, place_outline

MARGIN = 0.02
"""Least distance up to which sides count as near, in sizes of the smallest block (root of its area).

It costs time, not accuracy: the wider, the more pairs are looked at every step, and the fewer times they are sought.
"""

SWIFT = math.sqrt(5)
"""Most by which an opening changes, in ways of the corner (`sharp_opening`)."""

FLAT = 0.1
"""Turn [rad] of the outline below which a corner is hardly one: it is not rounded, and rests with both its sides."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Blocks with rounded corners: arcs that touch their two sides an inset away from the corner.

    Parameters
    ----------
    blocks
        The blocks, undeformed.
    radius : (nv,) float
        Radius of each corner's arc [m].
    centre : (nv, 2) float
        Its centre, from the centroid of its block [m].
    normal : (nv, 2) float
        Outward normal of the side that starts at the corner.
    straight : (nv,) float
        Length of that side between its arcs [m].
    exterior : (nv,) float
        Angle by which the outline turns at the corner [rad].
    thickness : float
        Out-of-plane thickness [m].
    held : (nb,) bool
        Blocks between which nothing can happen.
    """

    blocks: Blocks
    radius: Array
    centre: Array
    normal: Array
    straight: Array
    exterior: Array
    thickness: float
    held: Mask

    @classmethod
    def of(cls, scene: Scene) -> "Outline":
        """Round the corners of a scene's blocks by the inset of its joints.

        Raises
        ------
        SceneError
            If the inset takes up a whole side.
        """
        blocks = scene.blocks
        start, after = blocks.vertices, blocks.successor
        side = start[after] - start
        length = np.hypot(*side.T)
        run = side / length[:, None]
        normal = np.column_stack([run[:, 1], -run[:, 0]])
        before = np.empty_like(after)
        before[after] = np.arange(len(after))
        turn = run[before]
        exterior = np.arctan2(turn[:, 0] * run[:, 1] - turn[:, 1] * run[:, 0], (turn * run).sum(axis=1))
        inset = np.where(exterior > FLAT, scene.joint.inset, 0.0)
        radius = inset / np.tan(np.maximum(exterior, FLAT) / 2)
        straight = length - inset - inset[after]
        if (straight < 0).any():
            raise SceneError("joint.inset", "must be less than half the shortest side of a block", scene.joint.inset)
        centre = start + inset[:, None] * run - radius[:, None] * normal - blocks.centroid[blocks.owner]
        return cls(blocks, radius, centre, normal, straight, exterior, scene.thickness, scene.fixed)

    @property
    def margin(self) -> float:
        """Distance up to which sides of blocks that hardly move count as near [m]."""
        return float(MARGIN * np.sqrt(self.blocks.area.min()))

    @cached_property
    def reach(self) -> Array:
        """Distance of the farthest corner of each block from its centroid, ``(nb,)`` [m]."""
        blocks = self.blocks
        return np.maximum.reduceat(np.hypot(*(blocks.vertices - blocks.centroid[blocks.owner]).T), blocks.first[:-1])

    @property
    def for_kernels(self) -> tuple[NDArray[Any], ...]:
        """What the kernels need to place the outline."""
        blocks = self.blocks
        freedom = (3 * blocks.owner).astype(np.uint64)
        return blocks.centroid.copy(), freedom, self.centre.copy(), self.normal.copy()

    def placed(self, motion: Array) -> tuple[Array, Array]:
        """Blocks ``(nb, 4)`` and arcs ``(nv, 4)`` in space after a motion ``(3 nb,)``; see `place_outline`."""
        blocks = self.blocks
        placed = (np.zeros((len(blocks), 4)), np.zeros((len(self.radius), 4)))
        place_outline(motion, self.for_kernels, placed)
        return placed

    def corners(self, motion: Array) -> Array:
        """Corners after a motion ``(3 nb,)``, ``(nv, 2)`` [m]."""
        return self.points(self.blocks.owner, self.blocks.vertices, motion)

    def points(self, block: Indices, at: Array, motion: Array) -> Array:
        """Points of blocks, given on the undeformed wall, after a motion ``(3 nb,)``, ``(n, 2)`` [m]."""
        cosine, sine, x, y = self.placed(motion)[0][block].T
        arm = at - self.blocks.centroid[block]
        return np.column_stack([x + cosine * arm[:, 0] - sine * arm[:, 1], y + sine * arm[:, 0] + cosine * arm[:, 1]])


@dataclass(frozen=True, eq=False)
class Contacts:
    """Ends of facing sides, each array a row an end.

    Parameters
    ----------
    motion : (3 nb,) float
        Motion of the blocks when these contacts were found.
    margin : float
        Distance up to which they were sought [m].
    ends : (n, 6) uint
        Corner of block b and of block a, far corners of their sides, and the sides (their first corners); b > a.
    inwards : (n,) float
        1 where inwards is along the tangent of a's side, −1 where it is against it.
    tilt : (n,) float
        Tilt of side against side, less the turns of the blocks [rad].
    area : (n,) float
        Area [m²] the end stands for.
    glued : (n,) bool
        Whether the end is of a joint of the undeformed wall and has not been lost since; none is when first found.
    """

    motion: Array
    margin: float
    ends: NDArray[np.uint64]
    inwards: Array
    tilt: Array
    area: Array
    glued: Mask

    def __len__(self) -> int:
        return len(self.inwards)

    def chosen(self, rows: Mask | Indices) -> "Contacts":
        """Some of these."""
        return replace(
            self,
            ends=self.ends[rows],
            inwards=self.inwards[rows],
            tilt=self.tilt[rows],
            area=self.area[rows],
            glued=self.glued[rows],
        )

    @property
    def key(self) -> Indices:
        """What an end is known by from one search to the next, ``(n,)``."""
        return np.asarray(self.ends[:, :2].astype(np.int64) @ [2**32, 1] * 2 + (self.inwards > 0))

    def geometry(self, outline: Outline) -> tuple[Any, ...]:
        """What `gather_finite` and `scatter_finite` share, with buffers of its own."""
        blocks = outline.blocks
        buffers = (np.zeros((len(blocks), 4)), np.zeros((len(outline.radius), 4)))
        fixed = (outline.for_kernels, outline.radius.copy(), outline.straight.copy())
        ends = (self.ends.copy(), self.inwards.copy(), self.tilt.copy(), self.area.copy())
        return (*fixed, *ends, buffers, np.zeros((len(self), 4)))


def find_contacts(outline: Outline, motion: Array, margin: float) -> Contacts:
    """Find every end of facing sides that is nearer than a margin [m] after a motion ``(3 nb,)``.

    None of those left out touches before some block has moved by half the margin.
    """
    e, f = facing_sides(outline, motion, SWIFT * margin)
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
    near = np.abs(jumps(outline, both, motion)[0]) < SWIFT * margin
    # A corner rests on a side with that of its own two sides which faces it; its arc belongs half to each. A flat one
    # rests with both, each of which stands for its own area.
    corner, _ = resting(outline, both, motion)
    lean = -both.inwards * np.tile(tilt + turned, 2)
    return both.chosen(near & (np.abs(lean) <= np.maximum(outline.exterior[corner] / 2, FLAT)))


def jumps(outline: Outline, contacts: Contacts, motion: Array) -> Array:
    """Opening and slip of contacts after a motion ``(3 nb,)``, ``(2, n)`` [m]."""
    found = np.zeros((2, len(contacts)))
    gather_finite(motion, contacts.geometry(outline), *found)
    return found


def resting(outline: Outline, contacts: Contacts, motion: Array) -> tuple[Indices, Indices]:
    """Of each end, the corner that is farther in and the side it rests on after a motion ``(3 nb,)``, two ``(n,)``."""
    arcs = outline.placed(motion)[1]
    v, w, _, _, e, f = contacts.ends.astype(np.int64).T
    apart = arcs[v, :2] - arcs[w, :2]
    inwards = contacts.inwards * (apart[:, 1] * arcs[f, 2] - apart[:, 0] * arcs[f, 3])
    on_f = inwards >= 0
    return np.where(on_f, v, w), np.where(on_f, f, e)


def facing_sides(outline: Outline, motion: Array, margin: float) -> tuple[Indices, Indices]:
    """Sides e of one block and f of another, of lower number, that face each other and whose boxes are near."""
    blocks = outline.blocks
    corners, arcs = outline.corners(motion), outline.placed(motion)[1]
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
    start, stop = outline.blocks.vertices, outline.blocks.vertices[outline.blocks.successor]
    length = np.hypot(*(stop - start).T)
    overlap = overlaps(outline, e, f)
    shared: Array = np.where(overlap > 0, overlap, np.minimum(length[e], length[f]) / 2)
    return shared * outline.thickness / 2


def overlaps(outline: Outline, e: Indices, f: Indices) -> Array:
    """Length of the joint that facing sides made on the undeformed wall, ``(n,)`` [m]; zero where they made none."""
    blocks = outline.blocks
    start, stop = blocks.vertices, blocks.vertices[blocks.successor]
    run = stop - start
    length = np.hypot(*run.T)
    along = run[f] / length[f, None]
    first, last = (np.einsum("ij,ij->i", point[e] - start[f], along) for point in (stop, start))
    gap = np.abs([np.einsum("ij,ij->i", point[e] - start[f], outline.normal[f]) for point in (start, stop)])
    overlap = np.minimum(last, length[f]) - np.maximum(first, 0.0)
    joined = (gap.max(axis=0) <= blocks.tolerance) & (overlap > blocks.tolerance)
    return np.where(joined, overlap, 0.0)
