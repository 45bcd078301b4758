"""Non-convex blocks: extensions of their sides behind re-entrant corners, and their convex parts.

A corner that is pressed into a notch, as deep as the joints deform, lies beyond the ends of both sides of the notch,
and yet rests on both. Therefore each side is extended into the block, behind the re-entrant corner where it ends.
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
"""Extension of a side behind a re-entrant corner, as a share of the distance through the block in its direction."""


@dataclass(frozen=True, eq=False)
class ConvexParts:
    """Convex polygons that make up the blocks, with corners at the blocks' corners; a convex block is one part."""

    first: Indices  # (n + 1,) part i owns `corner[first[i]:first[i + 1]]`,
    corner: Indices  # (nc,) corners of the blocks, counter-clockwise
    normal: Array  # (nc, 2) outward normal of the side of a part that starts there, cuts through the block included
    of_side: Indices  # (nv,) part that each side of a block belongs to

    @classmethod
    def of(cls, blocks: Blocks, normal: Array) -> Self:
        """Cut blocks along diagonals; `normal` ``(nv, 2)`` are the outward normals of the blocks' sides."""
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
    """Extensions of sides: each array has one row per end of a side that is a re-entrant corner."""

    side: Indices  # (n,) the side
    end: Indices  # (n,) 0 for its start, 1 for its end
    far: Array  # (n,) length of the extension [m],
    point: Array  # (n, 2) and its end point on the undeformed wall [m]

    @classmethod
    def of(cls, blocks: Blocks, run: Array) -> Self:
        """Extend the sides of blocks, whose directions are ``(nv, 2)``, behind re-entrant corners."""
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
    """Distance [m] from a re-entrant corner of a polygon ``(n, 2)``, along a unit vector, to the outline again.

    Another corner within the tolerance [m] of this line counts as met. Otherwise rounding would extend sides in line
    with each other, as on both sides of a step, beneath one another.
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
    """Cut a polygon ``(n, 2)`` in two, from its first re-entrant corner ``(n,)`` to another corner.

    The cut goes to the corner that leaves the fewest re-entrant corners, among equal ones to the nearest.
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
    # The whole cut must lie inside: if it touched another corner, a part would touch itself.
    seen = (shapely.relate_pattern(whole, shapely.LineString(ring[[corner, other]]), "1**F**FF*") for other in best)
    low, high = sorted((corner, next(compress(best, seen))))
    return np.arange(low, high + 1), np.concatenate([np.arange(high, n), np.arange(low + 1)])
