"""Blocks: simple polygons in one ragged array, with their exact areas, centroids and moments of inertia."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from .arrays import Array, Indices, Mask, frozen
from .errors import SceneError, coordinate, place

CONTACT_TOLERANCE = 1e-4
"""Largest gap that counts as contact, relative to the size of the smallest block (square root of its area).

For a brick of 240 × 60 mm this is 12 µm: more than the rounding error of a drawing, less than the width of any joint.
"""


@dataclass(frozen=True, eq=False)
class Blocks:
    """Simple polygons, convex or not, counter-clockwise, stored one after another.

    Parameters
    ----------
    vertices : (nv, 2) float
        Corners of all blocks [m].
    first : (nb + 1,) int
        Block ``i`` owns ``vertices[first[i]:first[i + 1]]``.
    """

    vertices: Array
    first: Indices

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices))
        object.__setattr__(self, "first", frozen(self.first, np.int64))

    @classmethod
    def from_polygons(cls, polygons: Sequence[Array]) -> "Blocks":
        """Build the blocks from a list of ``(n, 2)`` polygons [m], each given counter-clockwise."""
        counts = [len(polygon) for polygon in polygons]
        return cls(np.concatenate(polygons), np.concatenate([[0], np.cumsum(counts)]))

    def __len__(self) -> int:
        return len(self.first) - 1

    def polygon(self, block: int) -> Array:
        """Corners of one block, ``(n, 2)`` [m]."""
        return self.vertices[self.first[block] : self.first[block + 1]]

    @cached_property
    def owner(self) -> Indices:
        """Block that each vertex, and the edge starting there, belongs to, ``(nv,)``."""
        return frozen(np.repeat(np.arange(len(self)), np.diff(self.first)), np.int64)

    @cached_property
    def successor(self) -> Indices:
        """Vertex at the far end of the edge that starts at each vertex, ``(nv,)``."""
        following = np.arange(1, len(self.vertices) + 1)
        following[self.first[1:] - 1] = self.first[:-1]
        return frozen(following, np.int64)

    @cached_property
    def predecessor(self) -> Indices:
        """Vertex at the start of the edge that ends at each vertex, ``(nv,)``."""
        return frozen(np.argsort(self.successor), np.int64)

    @cached_property
    def _local(self) -> tuple[Array, Array, Array]:
        """Vertices, their successors and the cross products of both, relative to each block's first vertex.

        With local origins the moments of area stay exact to rounding for a wall far from the origin.
        """
        origin = self.vertices[self.first[:-1]][self.owner]
        here, there = self.vertices - origin, self.vertices[self.successor] - origin
        return here, there, here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]

    @cached_property
    def area(self) -> Array:
        """Area of each block, ``(nb,)`` [m²]."""
        return frozen(np.add.reduceat(self._local[2], self.first[:-1]) / 2)

    @cached_property
    def centroid(self) -> Array:
        """Centroid of each block, ``(nb, 2)`` [m]."""
        here, there, cross = self._local
        moment = np.add.reduceat((here + there) * cross[:, None], self.first[:-1], axis=0)
        return frozen(self.vertices[self.first[:-1]] + moment / (6 * self.area[:, None]))

    @cached_property
    def polar_moment(self) -> Array:
        """Polar second moment of area about each centroid, ``(nb,)`` [m⁴]."""
        here, there, cross = self._local
        square = (here**2 + here * there + there**2).sum(axis=1) * cross
        about_origin = np.add.reduceat(square, self.first[:-1]) / 12
        arm = self.centroid - self.vertices[self.first[:-1]]
        return frozen(about_origin - self.area * (arm**2).sum(axis=1))

    @cached_property
    def tolerance(self) -> float:
        """Largest gap that counts as contact [m]."""
        return float(CONTACT_TOLERANCE * np.sqrt(self.area.min()))

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Lower and upper corner of the bounding box of each block, two ``(nb, 2)`` [m]."""
        low, high = (extreme.reduceat(self.vertices, self.first[:-1]) for extreme in (np.minimum, np.maximum))
        return frozen(low), frozen(high)

    def extent(self, block: int | Mask | slice = slice(None)) -> tuple[Array, Array]:
        """Lower and upper corner of the bounding box of all or some blocks, two ``(2,)`` [m]."""
        low, high = (np.atleast_2d(corner[block]) for corner in self.boxes)
        return low.min(axis=0), high.max(axis=0)

    @cached_property
    def convex(self) -> Mask:
        """Whether blocks have no re-entrant corner and an outline that winds round once, ``(nb,)``."""
        edge, after = self._edges
        turn, along = cross(edge, after), (edge * after).sum(axis=1)
        reflex = np.logical_or.reduceat(self.reentrant, self.first[:-1])
        # A polygon that winds round twice can have left turns only, but it crosses itself.
        twice = np.add.reduceat(np.arctan2(turn, along), self.first[:-1]) > 3 * np.pi
        return frozen(~(reflex | twice), np.bool_)

    @cached_property
    def reentrant(self) -> Mask:
        """Whether the outline turns right at each corner, as in `turns_right`, ``(nv,)``."""
        reentrant = np.empty(len(self.vertices), dtype=np.bool_)
        reentrant[self.successor] = turns_right(*self._edges)
        return frozen(reentrant, np.bool_)

    @property
    def _edges(self) -> tuple[Array, Array]:
        """Each edge and the next, two ``(nv, 2)`` [m]."""
        here, there, _ = self._local
        edge = there - here
        return edge, edge[self.successor]

    def shapes(self, block: Indices) -> NDArray[np.object_]:
        """Shapely polygons of some blocks, ``(n,)``."""
        count = np.diff(self.first)[block]
        start = np.cumsum(count) - count
        vertex = np.repeat(self.first[block] - start, count) + np.arange(count.sum())
        rings = shapely.linearrings(self.vertices[vertex], indices=np.repeat(np.arange(len(block)), count))
        return np.asarray(shapely.polygons(rings))

    @cached_property
    def _bent(self) -> tuple[Indices, NDArray[np.object_]]:
        """Numbers and Shapely polygons of the blocks that are not convex."""
        bent = np.flatnonzero(~self.convex)
        shapes = self.shapes(bent)
        shapely.prepare(shapes)
        return bent, shapes

    def containing(self, point: Array) -> Indices:
        """Blocks that contain or touch a point ``(2,)`` [m], to within the contact tolerance."""
        start, edge = self.vertices, self.vertices[self.successor] - self.vertices
        reach = point - start
        depth = (edge[:, 0] * reach[:, 1] - edge[:, 1] * reach[:, 0]) / np.hypot(*edge.T)
        holds = np.minimum.reduceat(depth, self.first[:-1]) >= -self.tolerance
        bent, shapes = self._bent
        holds[bent] = shapely.dwithin(shapes, shapely.Point(point), self.tolerance)
        return np.flatnonzero(holds)

    def check(self) -> None:
        """Raise a `SceneError` that names the first polygon without area, with a repeated corner or crossing itself."""
        edge = self._local[1] - self._local[0]
        length = np.hypot(*edge.T)
        with np.errstate(invalid="ignore"):
            thin = ~(self.area > 1e-9 * np.maximum.reduceat(length, self.first[:-1]) ** 2)
        self._refuse(thin, "encloses no area; its corners must run round it counter-clockwise")
        self._refuse(np.logical_or.reduceat(length == 0, self.first[:-1]), "has the same corner twice in a row")
        bent, shapes = self._bent
        crossing = np.zeros(len(self), dtype=np.bool_)
        crossing[bent] = ~shapely.is_valid(shapes)
        self._refuse(crossing, "crosses or touches itself; its sides may meet at its corners only")

    def _refuse(self, faulty: Mask, fault: str) -> None:
        if faulty.any():
            raise SceneError(self.name(int(np.argmax(faulty))), fault)

    def name(self, block: int) -> str:
        """Name of a block in messages: its number, and the centre of its bounding box in metres."""
        return f"block {block} at {self.place(np.mean(self.extent(block), axis=0))}"

    def place(self, at: Array, digits: int = 4) -> str:
        """Text for a point ``(2,)`` [m] in messages, with coordinates written as by `coordinate`."""
        return place(at, self._span, digits)

    def coordinate(self, value: float, digits: int = 4) -> str:
        """Text for a coordinate [m] in messages."""
        return coordinate(value, self._span, digits)

    @cached_property
    def _span(self) -> float:
        """Larger side of the bounding box of all blocks [m]."""
        low, high = self.extent()
        return float((high - low).max())

    def neighbours(self) -> tuple[Indices, Indices]:
        """Pairs ``a < b`` of blocks whose bounding boxes touch."""
        low, high = self.boxes
        a, b = touching_boxes(low - self.tolerance, high + self.tolerance)
        return a[a < b], b[a < b]


def cross(here: Array, there: Array) -> Array:
    """Cross products of edges ``(n, 2)`` and the edges that follow them, ``(n,)`` [m²]."""
    return np.asarray(here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0])


def turns_right(here: Array, there: Array) -> Mask:
    """Whether an outline turns right from edges ``(n, 2)`` to the next, at a sine above `CONTACT_TOLERANCE`."""
    return np.asarray(cross(here, there) < -CONTACT_TOLERANCE * (np.hypot(*here.T) * np.hypot(*there.T)))


def touching_boxes(low: Array, high: Array) -> tuple[Indices, Indices]:
    """Pairs of boxes that intersect: each pair in both orders, and each box with itself; corners are ``(n, 2)`` [m]."""
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    a, b = shapely.STRtree(boxes).query(boxes)
    return a, b
