"""Blocks that are not convex: how far their sides run on behind re-entrant corners, and the convex parts they are of.

A corner that is pressed into a notch as far as its joints give way has passed the end of both sides of the notch, and
rests on both: each goes on, inside the block, behind the re-entrant corner where it ends.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import compress
from typing import NamedTuple, Self

import numpy as np
import shapely

from runningbond.scene import Array, Blocks, Indices, Mask
from runningbond.scene.blocks import turns_right

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
        corner, outwards = corners[side, end], np.where(end == 1, 1.0, -1.0)[:, None] * run[side]
        first = blocks.first
        ways = zip(corner, outwards, blocks.owner[corner], strict=True)
        way = [
            _way_through(blocks.polygon(block), at - first[block], along, blocks.tolerance) for at, along, block in ways
        ]
        far = RUN_ON * np.array(way)
        return cls(side, end, far, blocks.vertices[corner] + far[:, None] * outwards)


def _way_through(polygon: Array, corner: int, along: Array, tolerance: float) -> float:
    """How far it is from a re-entrant corner of a polygon ``(n, 2)``, along a unit vector, to the outline again [m].

    A corner that is no farther off than the tolerance [m] is on the way, or sides in line with each other, as those on
    both sides of a step are, would run on beneath one another by rounding.
    """
    n, reach = len(polygon), polygon - polygon[corner]
    ahead, off = reach @ along, reach @ [-along[1], along[0]]
    after, off_after = np.array([ahead, off])[:, np.arange(1 - n, 1)]
    others, sides = np.full((2, n), True)
    others[corner] = sides[corner] = sides[corner - 1] = False
    passed = ahead[others & (np.abs(off) <= tolerance) & (ahead > 0)]
    crossed = np.flatnonzero(sides & (off * off_after < 0))
    met = (ahead * off_after - after * off)[crossed] / (off_after - off)[crossed]
    return float(np.concatenate([passed, met[met > 0]]).min())


def _parts(polygon: Array) -> Iterator[Indices]:
    """Convex parts of a polygon ``(n, 2)``, each as its corners counter-clockwise."""
    rings = [np.arange(len(polygon))]
    while rings:
        ring = rings.pop()
        n, at = len(ring), polygon[ring]
        reentrant = turns_right(at - at[np.arange(-1, n - 1)], at[np.arange(1 - n, 1)] - at)
        if not reentrant.any():
            yield ring
            continue
        rings += [ring[part] for part in _halves(at, reentrant)]


def _halves(ring: Array, reentrant: Mask) -> tuple[Indices, Indices]:
    """Two parts of a polygon ``(n, 2)``, cut from its first re-entrant corner ``(n,)`` to another corner.

    To that which leaves the fewest re-entrant corners, and the nearest of those.
    """
    n, whole, corner = len(ring), shapely.Polygon(ring), int(np.argmax(reentrant))
    others = np.mod(corner + np.arange(2, n - 1), n)
    here, there = ring[[corner]], ring[others]
    left = -reentrant[others].astype(int)
    for before, at, after in (
        (there, here, ring[[corner + 1 - n]]),
        (ring[[corner - 1]], here, there),
        (here, there, ring[others + 1 - n]),
        (ring[others - 1], there, here),
    ):
        left += turns_right(at - before, after - at)
    best = others[np.lexsort([np.hypot(*(there - here).T), left])].tolist()
    # Inside all along: one that touches another corner on its way would leave a part that touches itself.
    seen = (shapely.relate_pattern(whole, shapely.LineString(ring[[corner, other]]), "1**F**FF*") for other in best)
    low, high = sorted((corner, next(compress(best, seen))))
    return np.arange(low, high + 1), np.concatenate([np.arange(high, n), np.arange(low + 1)])
