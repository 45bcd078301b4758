"""Blocks that are not convex: how far their sides run on behind re-entrant corners, and the convex parts they are of.

A corner that is pressed into a notch as far as its joints give way has passed the end of both sides of the notch, and
rests on both: each goes on, inside the block, behind the re-entrant corner where it ends.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
import shapely

from runningbond.scene import Array, Blocks, Indices

RUN_ON = 0.5
"""How far a side runs on behind a re-entrant corner, in parts of its way through the block."""


@dataclass(frozen=True, eq=False)
class ConvexParts:
    """Convex polygons of which blocks are made, their corners those of the blocks; a convex block is one of them."""

    first: Indices  # (n + 1,) part i owns `corner[first[i]:first[i + 1]]`,
    corner: Indices  # (nc,) corners of the blocks, counter-clockwise
    normal: Array  # (nc, 2) outward normal of the side of a part that starts there, cuts through a block among them
    of_side: Indices  # (nv,) part of each side of a block

    @classmethod
    def of(cls, blocks: Blocks, normal: Array) -> Self:
        """Cut blocks along diagonals; the outward normals ``(nv, 2)`` of their own sides are taken as they are."""
        rings: list[Indices] = []
        for block, (start, stop) in enumerate(zip(blocks.first[:-1], blocks.first[1:], strict=True)):
            own = np.arange(start, stop)
            rings += [own] if blocks.convex[block] else [own[part] for part in _parts(blocks.polygon(block))]
        first, corner = np.cumsum([0, *map(len, rings)]), np.concatenate(rings)
        following = np.concatenate([np.roll(ring, -1) for ring in rings])
        run = blocks.vertices[following] - blocks.vertices[corner]
        own_side = blocks.successor[corner] == following
        cut = np.column_stack([run[:, 1], -run[:, 0]]) / np.hypot(*run.T)[:, None]
        of_side = np.empty(len(blocks.vertices), dtype=np.int64)
        of_side[corner[own_side]] = np.repeat(np.arange(len(rings)), np.diff(first))[own_side]
        return cls(first, corner, np.where(own_side[:, None], normal[corner], cut), of_side)


class RunOn(NamedTuple):
    """Where sides run on to, each array a row an end of a side that is a re-entrant corner."""

    side: Indices  # (n,) the side
    end: Indices  # (n,) 0 for its start, 1 for its end
    far: Array  # (n,) how far it runs on [m],
    point: Array  # (n, 2) and up to where, on the undeformed wall [m]

    @classmethod
    def of(cls, blocks: Blocks, run: Array) -> Self:
        """Let the sides of blocks, of directions ``(nv, 2)``, run on."""
        corners = np.column_stack([np.arange(len(run)), blocks.successor])
        side, end = np.nonzero(blocks.reentrant[corners])
        outwards, corner = np.where(end == 1, 1.0, -1.0)[:, None] * run[side], blocks.vertices[corners[side, end]]
        far = np.empty(len(side))
        for row, number in enumerate(side):
            polygon = blocks.polygon(blocks.owner[number])
            ray = shapely.LineString([corner[row], corner[row] + np.ptp(polygon, axis=0).sum() * outwards[row]])
            met = shapely.get_coordinates(ray.intersection(shapely.LinearRing(polygon)))
            away = (met - corner[row]) @ outwards[row]
            far[row] = RUN_ON * away[away > blocks.tolerance].min()
        return cls(side, end, far, corner + far[:, None] * outwards)


def _parts(polygon: Array) -> Iterator[Indices]:
    """Convex parts of a polygon ``(n, 2)``, each as its corners counter-clockwise."""
    rings = [np.arange(len(polygon))]
    while rings:
        ring = rings.pop()
        reentrant = np.flatnonzero(Blocks.from_polygons([polygon[ring]]).reentrant)
        if not len(reentrant):
            yield ring
            continue
        rings += [ring[part] for part in _halves(polygon[ring], int(reentrant[0]))]


def _halves(ring: Array, corner: int) -> tuple[Indices, Indices]:
    """Two parts of a polygon ``(n, 2)``, cut from a re-entrant corner to another one.

    To that which leaves the fewest re-entrant corners, and the nearest of those.
    """
    n, whole = len(ring), shapely.Polygon(ring)
    others = np.mod(corner + np.arange(2, n - 1), n)
    # Inside all along: one that touches another corner on its way would leave a part that touches itself.
    seen = shapely.relate_pattern(whole, shapely.linestrings([ring[[corner, other]] for other in others]), "1**F**FF*")

    def halves(other: int) -> tuple[Indices, Indices]:
        low, high = min(corner, other), max(corner, other)
        return np.arange(low, high + 1), np.concatenate([np.arange(high, n), np.arange(low + 1)])

    def cost(other: int) -> tuple[int, float]:
        parts = Blocks.from_polygons([ring[half] for half in halves(other)])
        return int(parts.reentrant.sum()), float(np.hypot(*(ring[other] - ring[corner])))

    return halves(min(others[seen].tolist(), key=cost))
