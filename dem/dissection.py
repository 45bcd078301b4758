"""Sparse linear systems of one pattern, solved by nested dissection (George 1973).

A line of blocks splits the wall into two parts, which are split again, down to a few blocks. The unknowns of the parts
are eliminated first, then those of the lines between them, each as a dense front. From one system to the next, only few
joint points open, close, slip or stick: only the fronts that hold such a point, and the fronts above them, are
factorised again. Sums have a fixed order, whatever the vector registers: the factors of a library differ in their last
bits from machine to machine, and with them the load path of a wall of many blocks.
"""

from dataclasses import dataclass
from itertools import chain

import numpy as np
from scipy.sparse import csr_array

from runningbond.scene import Array, Indices, Unsigned

from .front_kernels import Fronts, factorise, renew, substitute

LEAF_BLOCKS = 6
"""Largest number of blocks that is not split any further."""


@dataclass(eq=False)
class Dissection:
    """A matrix, as the sum of the joint points' tangents and of constant terms, and its factors."""

    fronts: Fronts
    place: Indices  # (n,) position of each unknown in the order of elimination
    front: Indices  # (np, 2) fronts that eliminate the two blocks at each point; the number of fronts for a held block
    jump: Array  # (np, 2, 6) jumps of the points per freedom of their two blocks
    # (np, 36) index of the points' tangent entries among the terms; the last term is a dummy, for held blocks
    slot: Unsigned
    terms: Array  # (n_terms + 1,) terms of the matrix whose factors are in the store
    tangent: Array  # (np, 2, 2) tangents of the points in that matrix
    store: Array
    is_new: bool = True  # whether the store holds no factors yet

    def solve(self, tangent: Array, right: Array) -> Array:
        """Solve with tangents ``(np, 2, 2)`` of the joint points for right-hand sides ``(n, k)``.

        Raises
        ------
        numpy.linalg.LinAlgError
            If a front of the matrix is exactly singular.
        """
        changed = np.full(len(self.fronts.above) + 1, self.is_new)
        renew(tangent, self.tangent, self.jump, self.front, self.slot, changed, self.terms)
        self.tangent, self.is_new = tangent, True  # stays so if a front is singular
        if not factorise(self.fronts, changed, self.terms, self.store):
            raise np.linalg.LinAlgError("singular tangent")
        self.is_new = False
        x = np.empty(right.shape[::-1])
        x[:, self.place] = right.T
        substitute(self.fronts, self.store, x)
        return np.asarray(x[:, self.place].T)


def dissection(
    row: Indices, column: Indices, home: Indices, position: Array, jump: Array, constant: Array
) -> Dissection:
    """Set up the fronts of a sparsity pattern.

    Parameters
    ----------
    row, column : (n_terms,) int
        Unknowns that each term couples; negative for terms to be left out.
    home : (n,) int
        Block of each unknown; all unknowns of a block are eliminated together.
    position : (nb, 2) float
        Centroids of the blocks [m].
    jump : (np, 2, 6) float
        Jumps of the joint points per freedom; their 6 × 6 tangents are the first terms.
    constant : (n_constant,) float
        The other terms.
    """
    there = np.flatnonzero((row >= 0) & (column >= 0))
    pairs = home[row[there]], home[column[there]]
    graph = csr_array((np.ones(len(there)), pairs), shape=(len(position), len(position)))
    parts, above = _parts(graph, position)
    rank = np.empty(len(position), dtype=np.int64)
    rank[np.concatenate(parts)] = np.arange(len(position))
    place = np.argsort(np.argsort(rank[home], kind="stable"))
    first = np.append(0, np.cumsum(np.bincount(rank[home])))  # unknown of each block, by its rank
    own = first[np.append(0, np.cumsum([len(part) for part in parts]))]
    left = [[k for b in blocks for k in range(first[b], first[b + 1])] for blocks in _left(graph, parts, above, rank)]
    begin = np.append(0, np.cumsum([len(unknowns) for unknowns in left]))
    joined = np.fromiter(chain.from_iterable(left), np.int64)
    number = np.repeat(np.arange(len(parts)), np.diff(begin))
    s, u, n = np.diff(own), np.diff(begin), len(home)

    def local(front: Indices, unknown: Indices) -> Indices:
        """Position of unknowns within fronts."""
        after = np.searchsorted(number * n + joined, front * n + unknown) - begin[front] + s[front]
        return np.asarray(np.where(unknown < own[front + 1], unknown - own[front], after))

    at = np.append(0, np.cumsum((s + u) ** 2))
    front = np.full(len(row), len(parts))
    r, c = place[row[there]], place[column[there]]
    front[there] = f = np.searchsorted(own, np.minimum(r, c), side="right") - 1
    i, j = local(f, r), local(f, c)
    across, down = s[f] ** 2 + i * u[f] + j - s[f], s[f] * (u[f] + i) + j
    address = at[f] + np.where(i >= s[f], down, np.where(j >= s[f], across, i * s[f] + j))
    order = np.argsort(f, kind="stable")
    term = np.searchsorted(f[order], np.arange(len(parts) + 1))
    below = np.argsort(above, kind="stable")
    first_below = np.searchsorted(above[below], np.arange(len(parts) + 1))
    place_above = local(above[number], joined)
    left_at, placed_at, added_at = (each.astype(np.uint64) for each in (joined, place_above, address[order]))
    fronts = Fronts(own, begin, left_at, placed_at, above, first_below, below, at, term, added_at)
    slot, of_points = np.full(len(row), len(order), dtype=np.uint64), 36 * len(jump)
    slot[there[order]] = np.arange(len(order))
    terms, tangent = np.zeros(len(order) + 1), np.full((len(jump), 2, 2), np.nan)
    terms[slot[of_points:]] = constant
    sides = front[:of_points].reshape(-1, 36)[:, [0, 21]]
    return Dissection(fronts, place, sides, jump, slot[:of_points].reshape(-1, 36), terms, tangent, np.empty(at[-1]))


def _parts(graph: csr_array, position: Array) -> tuple[list[Indices], Indices]:
    """Blocks of each front, children before their parent, and the front above each, −1 for the top ones."""
    parts: list[Indices] = []
    above: list[int] = []

    def front(blocks: Indices, below: list[int]) -> list[int]:
        parts.append(blocks)
        above.append(-1)
        for one in below:
            above[one] = len(parts) - 1
        return [len(parts) - 1]

    def divide(blocks: Indices) -> list[int]:
        if len(blocks) <= LEAF_BLOCKS:
            return front(blocks, []) if len(blocks) else []
        halves = []
        for along in (0, 1):
            order = blocks[np.lexsort((position[blocks, 1 - along], position[blocks, along]))]
            first, second = np.split(order, [len(order) // 2])
            touched = np.isin(second, graph[first].indices)
            halves.append((first, second[touched], second[~touched]))
        first, line, second = min(halves, key=lambda parted: len(parted[1]))
        below = divide(first) + divide(second)
        return front(line, below) if len(line) else below

    divide(np.arange(len(position)))
    return parts, np.array(above)


def _left(graph: csr_array, parts: list[Indices], above: Indices, rank: Indices) -> list[Indices]:
    """Sorted ranks of the blocks that each front passes on to the fronts above it."""
    end = np.cumsum([len(part) for part in parts])
    below: list[list[Indices]] = [[np.zeros(0, dtype=np.int64)] for _ in parts]
    left = []
    for k, part in enumerate(parts):
        met = np.unique(np.concatenate([rank[graph[part].indices], *below[k]]))
        left.append(met[met >= end[k]])
        if above[k] >= 0:
            below[above[k]].append(left[k])
    return left
