"""Joints: the segments along which two blocks touch, found from their geometry alone."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely

from .arrays import Array, Indices, Mask, frozen
from .blocks import CONTACT_TOLERANCE, Blocks, touching_boxes
from .errors import SceneError
from .polygons import smaller_sides

SMALL_OVERLAP = 0.1
"""Depth of an overlap, in sizes (root area) of the smallest block, below which it may be a survey inaccuracy."""

ROUNDING = 1e-9
"""Distance of a joint's contact points, relative to its length, up to which they coincide: no lever arm is left."""


@dataclass(frozen=True, eq=False)
class Joints:
    """Segments shared by two blocks, and contacts of single corners.

    A contact of a corner is a joint of the length of the contact tolerance, without strength, along the side that the
    corner touches (`corner_contacts`). Such joints come last.

    Parameters
    ----------
    block : (nj, 2) int
        The blocks a and b on either side; the joint's normal points from a to b.
    ends : (nj, 2, 2) float
        End points [m], in the direction of a's counter-clockwise boundary.
    inner : (nj,) bool
        Whether a joint is a potential crack inside a block of the wall; by default no joint is.
    corner_length : (nj,) float
        Length [m] on which the stiffness of a corner's contact is based; 0 for other joints, by default for all.
    """

    block: Indices
    ends: Array
    inner: Mask = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    corner_length: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        object.__setattr__(self, "block", frozen(self.block, np.int64))
        object.__setattr__(self, "ends", frozen(self.ends))
        inner = self.inner if len(self.inner) else np.zeros(len(self.block), dtype=np.bool_)
        object.__setattr__(self, "inner", frozen(inner, np.bool_))
        corner_length = self.corner_length if len(self.corner_length) else np.zeros(len(self.block))
        object.__setattr__(self, "corner_length", frozen(corner_length))

    def __len__(self) -> int:
        return len(self.block)

    @cached_property
    def length(self) -> Array:
        """Length of each joint, ``(nj,)`` [m]."""
        run = self.ends[:, 1] - self.ends[:, 0]
        return frozen(np.hypot(run[:, 0], run[:, 1]))

    @cached_property
    def at_corner(self) -> Mask:
        """Whether each joint is the contact of a single corner, ``(nj,)``."""
        return frozen(self.corner_length > 0, np.bool_)

    @cached_property
    def between_sides(self) -> "Joints":
        """The joints without contacts of corners; their numbers are the same."""
        chosen = ~self.at_corner
        return Joints(self.block[chosen], self.ends[chosen], self.inner[chosen])

    @cached_property
    def is_bed(self) -> Mask:
        """Whether each joint lies flatter than 45°, ``(nj,)``."""
        run = np.abs(self.ends[:, 1] - self.ends[:, 0])
        return frozen(run[:, 0] > run[:, 1], np.bool_)

    def too_short_for(self, inset: float | Array) -> Mask:
        """Whether contact points would meet if moved inwards by an inset [m], one or one per joint, ``(nj,)``."""
        return np.asarray(2 * np.asarray(inset) >= (1 - ROUNDING) * self.length)


def find_joints(blocks: Blocks) -> Joints:
    """Find every segment along which two blocks touch.

    Two edges form a joint if they run in opposite directions, lie on one line to within the contact
    tolerance, and overlap by more than this tolerance. Courses play no part in this, so T-junctions, half
    blocks, openings and inclined edges are all handled. Overlapping blocks raise a `SceneError`.
    """
    tolerance = blocks.tolerance
    start = blocks.vertices
    stop = start[blocks.successor]
    a, b = touching_boxes(np.minimum(start, stop) - tolerance, np.maximum(start, stop) + tolerance)
    a, b = a[blocks.owner[a] < blocks.owner[b]], b[blocks.owner[a] < blocks.owner[b]]
    along = stop[a] - start[a]
    length = np.hypot(*along.T)
    along = along / length[:, None]
    outward = np.column_stack([along[:, 1], -along[:, 0]])

    # b runs backwards along a: its stop comes first.
    s_low = np.einsum("ij,ij->i", stop[b] - start[a], along)
    s_high = np.einsum("ij,ij->i", start[b] - start[a], along)
    d_low = np.einsum("ij,ij->i", stop[b] - start[a], outward)
    d_high = np.einsum("ij,ij->i", start[b] - start[a], outward)
    low, high = np.maximum(s_low, 0.0), np.minimum(s_high, length)
    overlap = high - low > tolerance
    a, b, along, low, high = a[overlap], b[overlap], along[overlap], low[overlap], high[overlap]
    # Distance between the two lines at both ends of the overlap.
    slope = (d_high - d_low)[overlap] / (s_high - s_low)[overlap]
    gap_low = d_low[overlap] + slope * (low - s_low[overlap])
    gap_high = d_low[overlap] + slope * (high - s_low[overlap])
    on_line = np.maximum(np.abs(gap_low), np.abs(gap_high)) <= tolerance
    a, b, along, low, high = a[on_line], b[on_line], along[on_line], low[on_line], high[on_line]

    pair = np.column_stack([blocks.owner[a], blocks.owner[b]])
    ends = start[a][:, None, :] + np.stack([low, high], axis=1)[:, :, None] * along[:, None, :]
    _refuse_overlaps(blocks, pair)
    return Joints(pair, ends)


def _refuse_overlaps(blocks: Blocks, joined: Indices) -> None:
    """Refuse blocks that overlap by more than the contact tolerance.

    Convex blocks that share a joint lie on opposite sides of its line, so the intersection is computed
    for all other neighbours only.
    """
    a, b = blocks.neighbours()
    shared = np.isin(a * len(blocks) + b, joined[:, 0] * len(blocks) + joined[:, 1])
    apart = ~(shared & blocks.convex[a] & blocks.convex[b])
    a, b = a[apart], b[apart]
    involved, local = np.unique(np.concatenate([a, b]), return_inverse=True)
    polygons = blocks.shapes(involved)
    common = shapely.intersection(polygons[local[: len(a)]], polygons[local[len(a) :]])
    # A common strip as wide as the tolerance counts as contact; what is left after eroding it is overlap.
    deep = ~shapely.is_empty(shapely.buffer(common, -blocks.tolerance / 2))
    if deep.any():
        first = int(np.argmax(deep))
        raise SceneError(blocks.name(int(a[first])), _overlap(blocks, int(a[first]), int(b[first]), common[first]))


def _overlap(blocks: Blocks, a: int, b: int, common: shapely.Geometry) -> str:
    """Error message for block a, which overlaps block b, with its remedy."""
    other = f"overlaps {blocks.name(b)}"
    inside = common.area > (1 - CONTACT_TOLERANCE) * blocks.area[[a, b]]
    if inside.all():
        return f"{other}, which lies in the same place; draw it once"
    if inside.any():
        which = "it lies in that one" if inside[0] else "that one lies in it"
        return f"{other}: {which}; draw what is left of the larger"
    part = max(shapely.get_parts(common), key=lambda shape: shape.area)
    depth = float(smaller_sides([part])[0])
    where = f"by {depth:.2g} m at {blocks.place(np.array(part.representative_point().coords[0]))}"
    is_small = depth < SMALL_OVERLAP * np.sqrt(blocks.area.min())
    heal = "; wall.heal closes small overlaps of drawings and outlines" if is_small else ""
    return f"{other} {where}; blocks may touch, not share an area{heal}"
