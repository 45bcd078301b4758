"""Which sides face each other and are near, where corners rest, and how far blocks overlap, as compiled kernels."""

import numpy as np
from numpy.typing import NDArray

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Indices, Mask, Unsigned


@kernel
def near_sides(
    order: Indices, first: Indices, box: Array, boxes: Array, normal: Array, held: Mask, found: Array
) -> int:
    """Count pairs of near sides of two blocks that face each other, and write the first ones to ``found`` ``(n, 2)``.

    The side of the block of higher number comes first; pairs of held blocks are left out.

    Parameters
    ----------
    order : (nb,) int
        Blocks by the left end of their box.
    first : (nb + 1,) int
        First side of each block.
    box : (nb, 4) float
        Left, lower, right and upper end of each block's box.
    boxes, normal : (nv, 4), (nv, 2) float
        The same of each side, and its outward normal.
    held : (nb,) bool
        Blocks between which nothing can happen.
    """
    count = 0
    for i in range(order.size):
        for j in range(i + 1, order.size):
            one, other = order[i], order[j]
            if box[other, 0] > box[one, 2]:
                break
            if box[other, 1] > box[one, 3] or box[one, 1] > box[other, 3] or (held[one] and held[other]):
                continue
            b, a = max(one, other), min(one, other)
            for e in range(first[b], first[b + 1]):
                for f in range(first[a], first[a + 1]):
                    apart = boxes[e, 0] > boxes[f, 2] or boxes[f, 0] > boxes[e, 2]
                    apart = apart or boxes[e, 1] > boxes[f, 3] or boxes[f, 1] > boxes[e, 3]
                    if apart or normal[e, 0] * normal[f, 0] + normal[e, 1] * normal[f, 1] >= 0.0:
                        continue
                    if count < found.shape[0]:
                        found[count, 0], found[count, 1] = e, f
                    count += 1
    return count


@kernel
def reaches(pairs: Indices, first: Indices, corners: Array, normals: Array, reach: NDArray[np.float64]) -> None:
    """Write how far pairs ``(n, 2)`` of convex parts overlap along any of their sides' normals, at least ``(n,)`` [m].

    Part i has the rows ``first[i]`` up to ``first[i + 1]`` of the corners and of the normals of the sides from them.
    """
    for pair in range(reach.size):
        least = np.inf
        for part in pairs[pair]:
            for side in range(first[part], first[part + 1]):
                low, high = -np.inf, np.inf
                for of in pairs[pair]:
                    nearest, farthest = np.inf, -np.inf
                    for corner in range(first[of], first[of + 1]):
                        at = corners[corner, 0] * normals[side, 0] + corners[corner, 1] * normals[side, 1]
                        nearest, farthest = min(nearest, at), max(farthest, at)
                    low, high = max(low, nearest), min(high, farthest)
                least = min(least, high - low)
        reach[pair] = least


@kernel
def resting_ends(arcs: Array, ends: Unsigned, inwards: Array, corner: Indices, side: Indices) -> None:
    """Write the corner of each end ``(n, 6)`` that is farther in, and the side that it rests on, two ``(n,)``."""
    for row in range(inwards.size):
        k = np.uint64(row)
        v, w, e, f = ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
        along = (arcs[v, 1] - arcs[w, 1]) * arcs[f, 2] - (arcs[v, 0] - arcs[w, 0]) * arcs[f, 3]
        on_f = inwards[k] * along >= 0.0
        corner[k], side[k] = (v if on_f else w), (f if on_f else e)
