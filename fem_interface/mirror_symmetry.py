"""Blocks that mirror themselves: their modes do too, so that few of them move the sum or the difference of two nodes.

A rectangle's modes are even or odd about each of its axes. In sums and differences of the displacements of nodes that
face each other across an axis, three quarters and more of a table Φ of nodal displacements by modes are nothing:

    Φ = P_n … P_1 F,        P: (a, b) → (a + b, a − b),

which the kernels make use of where there are enough blocks to outweigh its longer way through small arrays.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runningbond.scene import Array, Indices

FEWEST = 64
"""Blocks of one template below which a plain matrix product is as fast."""

ROUNDING = 1e-12
"""Share of the largest entry of a mode below which another one is none."""

COINCIDENT = 1e-9
"""Distance of a node from the mirror image of another, in sizes of the block, below which it is that image."""

TERMS = 2
"""Entries of a row that `block_kernels` takes at once; short rows are filled up with entries of nothing."""


@dataclass(frozen=True, eq=False)
class Folded:
    """A table of nodal displacements by modes, ``(2 nn, m)``, as few entries and some sums and differences.

    Parameters
    ----------
    pairs : (n, 2) int
        Rows that give way to their sum and their difference, one pair after the other.
    table : (2 nn, m) float
        What is left of the table, most of it zeros.
    """

    pairs: Indices
    table: Array

    @property
    def worth_it(self) -> bool:
        """Whether at most half of the entries are left."""
        return bool(2 * np.count_nonzero(self.table) <= self.table.size)


def folded(points: Array, table: Array) -> Folded:
    """Fold a table along the axes of symmetry of its nodes.

    Parameters
    ----------
    points : (nn, 2) float
        The nodes [m].
    table : (2 nn, m) float
        Their displacements along x and y per mode, node by node.
    """
    largest = np.abs(table).max(axis=0, initial=0.0)
    table, pairs = table.copy(), [np.zeros((0, 2), dtype=np.int64)]
    for axis in (0, 1):
        near, far = 2 * facing(points, axis)
        for direction in (0, 1):
            a, b = near + direction, far + direction
            table[a], table[b] = (table[a] + table[b]) / 2, (table[a] - table[b]) / 2
            pairs.append(np.column_stack([a, b]))
    table[np.abs(table) <= ROUNDING * largest] = 0.0
    # Unfolding undoes the last fold first.
    return Folded(np.concatenate(pairs)[::-1], table)


def facing(points: Array, axis: int) -> Indices:
    """Nodes on the lower side of an axis of symmetry and those that face them, ``(2, n)``; none if there is no axis.

    Parameters
    ----------
    points : (nn, 2) float
        The nodes [m].
    axis
        Coordinate that changes its sign from node to node: 0 across the upright axis, 1 across the level one.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    image = points.copy()
    image[:, axis] = low[axis] + high[axis] - points[:, axis]
    distance, near = np.abs(image[:, None] - points).max(axis=2), COINCIDENT * (high - low).max()
    other = distance.argmin(axis=1)
    if distance.min(axis=1).max() > near or (other[other] != np.arange(len(points))).any():
        return np.zeros((2, 0), dtype=np.int64)
    lower = np.flatnonzero(points[:, axis] < points[other, axis] - near)
    return np.array([lower, other[lower]])


class TableRows(NamedTuple):
    """Entries of tables, row by row, `TERMS` at once.

    Parameters
    ----------
    start : (n_rows + 1,) uint64
        First term of each row, then the number of terms.
    column, value : (n_terms, TERMS)
        Columns and values of each term.
    """

    start: NDArray[np.uint64]
    column: NDArray[np.uint64]
    value: Array


class FoldedTables(NamedTuple):
    """Folded tables of many templates, as the kernels take them.

    Parameters
    ----------
    shapes : (n_templates, 9) uint64
        Number of blocks, modes and displacements a block; where the blocks' coordinates and displacements start; the
        first rows of the table forward and backward, its first pair and the one after its last.
    pairs : (n_pairs, 2) uint64
        Rows that give way to their sum and their difference, in the order in which that unfolds.
    forward, backward
        Entries of the tables and of their negative transposes.
    """

    shapes: NDArray[np.uint64]
    pairs: NDArray[np.uint64]
    forward: TableRows
    backward: TableRows


class TableFolder:
    """Folds the tables of many templates."""

    def __init__(self) -> None:
        self._shapes: list[tuple[int, ...]] = []
        self._pairs = [np.zeros((0, 2), dtype=np.int64)]
        self._forward, self._backward = _Rows(), _Rows()

    def take(self, shape: tuple[int, int, int, int, int], points: Array, table: Array) -> bool:
        """Take a table over if that is worth it.

        Parameters
        ----------
        shape
            Number of blocks, modes and displacements, and where the blocks' coordinates and displacements start.
        points, table
            As `folded` has them.
        """
        if shape[0] < FEWEST:
            return False
        fold = folded(points, table)
        if not fold.worth_it:
            return False
        pair = sum(map(len, self._pairs))
        rows = self._forward.add(fold.table), self._backward.add(-fold.table.T)
        self._shapes.append((*shape, *rows, pair, pair + len(fold.pairs)))
        self._pairs.append(fold.pairs)
        return True

    def tables(self) -> FoldedTables:
        """What was taken over."""
        shapes = np.array(self._shapes, dtype=np.uint64).reshape(-1, 9)
        pairs = np.concatenate(self._pairs).astype(np.uint64)
        return FoldedTables(shapes, pairs, self._forward.rows(), self._backward.rows())


class _Rows:
    """Collects `TableRows`."""

    def __init__(self) -> None:
        self._start = [0]
        self._column = [np.zeros((0, TERMS), dtype=np.int64)]
        self._value = [np.zeros((0, TERMS))]

    def add(self, table: Array) -> int:
        """Add a table; returns its first row."""
        first = len(self._start) - 1
        for row in table:
            column = np.flatnonzero(row)
            filled = np.resize(column, -(-len(column) // TERMS) * TERMS)
            value = np.where(np.arange(len(filled)) < len(column), row[filled], 0.0)
            self._column.append(filled.reshape(-1, TERMS))
            self._value.append(value.reshape(-1, TERMS))
            self._start.append(self._start[-1] + len(filled) // TERMS)
        return first

    def rows(self) -> TableRows:
        start = np.array(self._start, dtype=np.uint64)
        return TableRows(start, np.concatenate(self._column).astype(np.uint64), np.concatenate(self._value))
