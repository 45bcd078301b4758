"""Folding of mode tables of blocks with mirror symmetry, in which most entries become zero.

A rectangle's modes are even or odd about each of its axes. If the displacements of two nodes that face each other
across an axis are replaced by their sum and difference, three quarters or more of the entries of a table Φ of nodal
displacements by modes vanish:

    Φ = P_n … P_1 F,        P: (a, b) → (a + b, a − b).

The kernels use this factorisation if there are enough blocks to outweigh its additional passes over small arrays.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from runningbond.scene import Array, Indices, Unsigned

FEWEST_BLOCKS = 64
"""Number of blocks of one template below which a plain matrix product is as fast."""

ROUNDING = 1e-12
"""Size of an entry, relative to the largest entry of its mode, up to which it is set to zero."""

COINCIDENT = 1e-9
"""Distance of a node from the mirror image of another, relative to the block's size, up to which they coincide."""

TERMS = 2
"""Number of a row's entries that `block_kernels` processes at once; rows are padded with zeros to a multiple of it."""


@dataclass(frozen=True, eq=False)
class Folded:
    """A table of nodal displacements by modes, ``(2 nn, m)``, as a sparse table and sums and differences of its rows.

    Parameters
    ----------
    pairs : (n, 2) int
        Pairs of rows to replace by their sum and their difference, in this order, to unfold the table.
    table : (2 nn, m) float
        The folded table F, most of it zeros.
    """

    pairs: Indices
    table: Array

    @property
    def worth_it(self) -> bool:
        """Whether at most half of the entries are nonzero."""
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
    # Unfolding starts with the last fold.
    return Folded(np.concatenate(pairs)[::-1], table)


def facing(points: Array, axis: int) -> Indices:
    """Nodes on the lower side of an axis of symmetry and their mirror images, ``(2, n)``; empty without symmetry.

    Parameters
    ----------
    points : (nn, 2) float
        The nodes [m].
    axis
        Coordinate whose sign the reflection changes: 0 for the vertical axis of symmetry, 1 for the horizontal one.
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
    """Nonzero entries of tables, row by row, in groups ("terms") of `TERMS` entries.

    Parameters
    ----------
    start : (n_rows + 1,) uint64
        First term of each row, then the number of terms.
    column, value : (n_terms, TERMS)
        Columns and values of each term's entries.
    """

    start: Unsigned
    column: Unsigned
    value: Array


class FoldedTables(NamedTuple):
    """Folded tables of many templates, in the form that the kernels use.

    Parameters
    ----------
    shapes : (n_templates, 9) uint64
        Number of blocks, modes and displacements per block; index of the blocks' first coordinate and displacement;
        first row of the table in `forward` and in `backward`; its first pair, and the one after its last.
    pairs : (n_pairs, 2) uint64
        Pairs of rows to replace by their sum and their difference, in the order of unfolding.
    forward, backward
        Entries of the tables and of their negative transposes.
    """

    shapes: Unsigned
    pairs: Unsigned
    forward: TableRows
    backward: TableRows


def fold_of_many(blocks: int, points: Array, table: Array) -> Folded | None:
    """Fold a template's table as in `folded`, or return None if its blocks are too few or too many entries remain."""
    if blocks < FEWEST_BLOCKS:
        return None
    fold = folded(points, table)
    return fold if fold.worth_it else None


def folded_tables(templates: Sequence[tuple[tuple[int, int, int, int, int], Folded]]) -> FoldedTables:
    """Join folded tables, each given with the first five entries of its row of `FoldedTables.shapes`."""
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
