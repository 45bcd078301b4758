"""Blocks that mirror themselves: their modes do too, so that few of them move the sum or the difference of two nodes.

A rectangle's modes are even or odd about each of its axes. In sums and differences of the displacements of nodes that
face each other across an axis, three quarters and more of a table Φ of nodal displacements by modes are nothing:

    Φ = P_n … P_1 F,        P: (a, b) → (a + b, a − b),

which the kernels make use of where there are enough blocks to outweigh its longer way through small arrays.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from runningbond.scene import Array, Indices, Unsigned

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

    start: Unsigned
    column: Unsigned
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

    shapes: Unsigned
    pairs: Unsigned
    forward: TableRows
    backward: TableRows


def fold_of_many(blocks: int, points: Array, table: Array) -> Folded | None:
    """Fold the table of so many blocks, given as `folded` has it, if that is worth it."""
    if blocks < FEWEST:
        return None
    fold = folded(points, table)
    return fold if fold.worth_it else None


def folded_tables(templates: Sequence[tuple[tuple[int, int, int, int, int], Folded]]) -> FoldedTables:
    """Join folded tables, each with the first five entries of its row of `FoldedTables.shapes`."""
    tables = [fold.table for _, fold in templates]
    counts = [(*fold.table.shape, len(fold.pairs)) for _, fold in templates]
    first = np.cumsum([(0, 0, 0), *counts], axis=0)
    last_pair = first[1:, 2]
    shapes = [(*shape, *at, end) for (shape, _), at, end in zip(templates, first, last_pair, strict=False)]
    pairs = np.concatenate([np.zeros((0, 2)), *(fold.pairs for _, fold in templates)])
    return FoldedTables(
        np.array(shapes, dtype=np.uint64).reshape(-1, 9),
        pairs.astype(np.uint64),
        _rows_of(tables),
        _rows_of([-table.T for table in tables]),
    )


def _rows_of(tables: list[Array]) -> TableRows:
    start, column, value = [0], [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    for row in (row for table in tables for row in table):
        entries = np.flatnonzero(row)
        filled = np.resize(entries, -(-len(entries) // TERMS) * TERMS)
        column.append(filled)
        value.append(np.where(np.arange(len(filled)) < len(entries), row[filled], 0.0))
        start.append(start[-1] + len(filled) // TERMS)
    columns = np.concatenate(column).reshape(-1, TERMS).astype(np.uint64)
    return TableRows(np.array(start, dtype=np.uint64), columns, np.concatenate(value).reshape(-1, TERMS))
