"""Linear systems of one pattern by nested dissection (George 1973), on walls of so many blocks that bands lose.

Blocks are parted by a line of blocks across them, and the parts again, down to a few blocks. Parts are eliminated
first, then the lines between them, each as a dense front. From one system to the next few joint points open, close,
slip or stick: only fronts that hold one of these, and those above, are factorised anew.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from runningbond.scene import Array, Indices

from .front_kernels import Fronts, factorise, substitute

FEW = 6
"""Blocks that are not parted any further."""


@dataclass(eq=False)
class Dissection:
    """A matrix that is the sum of joint points' tangents and of constant terms, and its factors."""

    fronts: Fronts
    place: Indices  # (n,) place of each unknown in the order of elimination
    front: Indices  # (n_terms,) front that each term is added in, the number of fronts for terms that are none
    jump: Array  # (np, 2, 6) jumps of the points per freedom, whose tangents are the first 36 np terms
    terms: Array  # (n_terms,) of which the store has the factors
    tangent: Array  # (np, 2, 2) likewise; not a number where the store has none
    store: Array

    def solve(self, tangent: Array, right: Array) -> Array:
        """Solve with tangents ``(np, 2, 2)`` of the joint points for some right-hand sides ``(n, k)``.

        Raises
        ------
        numpy.linalg.LinAlgError
            For a matrix of which a front is singular to the last bit.
        """
        other = np.flatnonzero((tangent != self.tangent).any(axis=(1, 2)))
        changed = np.zeros(len(self.fronts.above) + 1, dtype=np.bool_)
        if np.isnan(self.tangent).any():
            changed[:] = True
        n, jump = 36 * len(tangent), self.jump[other]
        changed[self.front[:n].reshape(-1, 36)[other]] = True
        own = np.matmul(np.matmul(jump.transpose(0, 2, 1), tangent[other]), jump)
        self.terms[:n].reshape(-1, 36)[other] = own.reshape(-1, 36)
        self.tangent = np.full_like(tangent, np.nan)  # should a front be singular
        factorise(self.fronts, changed, self.terms, self.store)
        self.tangent = tangent
        x = np.empty(right.shape[::-1])
        x[:, self.place] = right.T
        substitute(self.fronts, self.store, x)
        return np.asarray(x[:, self.place].T)


def dissection(
    row: Indices, column: Indices, home: Indices, position: Array, jump: Array, constant: Array
) -> Dissection:
    """Dissect a pattern.

    Parameters
    ----------
    row, column : (n_terms,) int
        Unknowns that each term couples; negative for terms that are left out.
    home : (n,) int
        Block of each unknown, which is eliminated with it.
    position : (nb, 2) float
        Centroids of the blocks [m].
    jump : (np, 2, 6) float
        Jumps of the joint points, whose 6 × 6 tangents are the first terms.
    constant : (n_constant,) float
        The other terms.
    """
    there = (row >= 0) & (column >= 0)
    pairs = home[row[there]], home[column[there]]
    graph = csr_array((np.ones(len(pairs[0])), pairs), shape=(len(position), len(position)))
    parts, above = _parts(graph, position)
    rank = np.empty(len(position), dtype=np.int64)
    rank[np.concatenate(parts)] = np.arange(len(position))
    place = np.argsort(np.lexsort((np.arange(len(home)), rank[home])))
    size = np.bincount(rank[home], minlength=len(position))
    first = np.append(0, np.cumsum(size))  # of each block, in its rank
    own = first[np.append(0, np.cumsum([len(part) for part in parts]))]

    left = [np.concatenate([np.arange(first[b], first[b + 1]) for b in blocks] or [[]]) for blocks in _left(graph, parts, above, rank)]
    begin = np.append(0, np.cumsum([len(one) for one in left]))
    joined = np.concatenate(left).astype(np.int64)
    number = np.repeat(np.arange(len(parts)), np.diff(begin))
    s, u, n = np.diff(own), np.diff(begin), len(home)

    def local(front: Indices, unknown: Indices) -> Indices:
        """Place of unknowns in fronts."""
        after = np.searchsorted(number * n + joined, front * n + unknown) - begin[front] + s[front]
        return np.where(unknown < own[front + 1], unknown - own[front], after)

    store = np.append(0, np.cumsum(s * s + 2 * s * u + u * u))
    front = np.full(len(row), len(parts))
    r, c = place[row[there]], place[column[there]]
    f = np.searchsorted(own, np.minimum(r, c), side="right") - 1
    front[there] = f
    i, j = local(f, r), local(f, c)
    across = s[f] ** 2 + i * u[f] + j - s[f]
    down = s[f] ** 2 + s[f] * u[f] + (i - s[f]) * s[f] + j
    address = np.zeros(len(row), dtype=np.int64)
    address[there] = store[f] + np.where(i >= s[f], down, np.where(j >= s[f], across, i * s[f] + j))
    order = np.argsort(front, kind="stable")[: np.count_nonzero(there)]
    term = np.searchsorted(front[order], np.arange(len(parts) + 1))
    fronts = Fronts(own, begin, joined, local(above[number], joined), above, store, term, order, address[order])
    terms = np.append(np.zeros(36 * len(jump)), constant)
    return Dissection(fronts, place, front, jump, terms, np.full((len(jump), 2, 2), np.nan), np.empty(store[-1]))


def _parts(graph: csr_array, position: Array) -> tuple[list[Indices], Indices]:
    """Blocks of each front, those below a front before it, and the front above each, −1 for the last ones."""
    parts: list[Indices] = []
    above: list[int] = []

    def front(blocks: Indices, below: list[int]) -> list[int]:
        parts.append(blocks)
        above.append(-1)
        for one in below:
            above[one] = len(parts) - 1
        return [len(parts) - 1]

    def divide(blocks: Indices) -> list[int]:
        if len(blocks) <= FEW:
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
    """Ranks of the blocks that each front leaves to those above it, in order."""
    end = np.cumsum([len(part) for part in parts])
    below: list[list[Indices]] = [[np.zeros(0, dtype=np.int64)] for _ in parts]
    left = []
    for k, part in enumerate(parts):
        met = np.unique(np.concatenate([rank[graph[part].indices], *below[k]]))
        left.append(met[met >= end[k]])
        if above[k] >= 0:
            below[above[k]].append(left[k])
    return left
