"""Compiled kernels of contact detection: facing sides that are near, sides that corners rest on, overlap of blocks."""

import numpy as np
from numpy.typing import NDArray

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Indices, Mask, Unsigned


@kernel
def near_sides(
    order: Indices, first: Indices, box: Array, boxes: Array, normal: Array, held: Mask, found: Array
) -> int:
    """Count pairs of facing sides of two blocks whose boxes overlap, and write the first n to ``found`` ``(n, 2)``.

    The side of the block with the higher number comes first; pairs of fixed blocks are left out.

    Parameters
    ----------
    order : (nb,) int
        Blocks sorted by the left end of their boxes.
    first : (nb + 1,) int
        First side of each block.
    box : (nb, 4) float
        Left, lower, right and upper end of each block's box.
    boxes, normal : (nv, 4), (nv, 2) float
        The same for each side, and its outward normal.
    held : (nb,) bool
        Fixed blocks.
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
def overlaps(pairs: Indices, first: Indices, corners: Array, normals: Array, overlap: NDArray[np.float64]) -> None:
    """Write the least overlap ``(n,)`` [m] of pairs ``(n, 2)`` of convex parts along the normals of all their sides.

    Part i has the rows ``first[i]`` to ``first[i + 1] - 1`` of the corners, and of the normals of the sides from them.
    """
    for pair in range(overlap.size):
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
        overlap[pair] = least


@kernel
def resting_ends(arcs: Array, ends: Unsigned, inwards: Array, corner: Indices, side: Indices) -> None:
    """Write which of the two corners of each end ``(n, 6)`` is farther in, and the side that it rests on, ``(n,)``."""
    for row in range(inwards.size):
        k = np.uint64(row)
        v, w, e, f = ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
        along = (arcs[v, 1] - arcs[w, 1]) * arcs[f, 2] - (arcs[v, 0] - arcs[w, 0]) * arcs[f, 3]
        on_f = inwards[k] * along >= 0.0
        corner[k], side[k] = (v if on_f else w), (f if on_f else e)
