"""Kinematics of blocks with modes as compiled kernels: from modes to joint nodes, from nodes to jumps, and back.

Modal coordinates are stored template by template, each as a matrix Q of modes by blocks. The displacements of all
nodes on joints are then one product U = Φ Q, and the modal forces another, F −= Φᵀ S. If Φ can be folded
(`mirror_symmetry`), few nonzero entries remain. Joint elements are ordered in runs (`modal_wall`) along which the
blocks are consecutive too, which lets the compiler vectorise the loops. Indices are unsigned, because signed ones
need a check for negative values that count from the end.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from runningbond.dynamics.system import Kernel
from runningbond.joints import compiled
from runningbond.scene import Array, Indices, Unsigned

from .mirror_symmetry import FoldedTables, TableRows

kernel, inlined = compiled.kernel, compiled.inlined


class NodalTables(NamedTuple):
    """Displacements of nodes per modal coordinate, template by template.

    Parameters
    ----------
    shapes : (n_templates, 6) int
        Number of blocks, number of modes and number of displacements per block; index of the template's first
        coordinate, of its nodes' first displacement and of its table's first entry.
    forward, backward : (n_entries,) float
        The tables, ``(displacements, modes)`` each, and their transposes, concatenated over the templates.
    still : (1,) int
        Index of the first displacement that is always zero.
    nodal : (n,) float
        Buffer of the displacements.
    """

    shapes: Indices
    forward: Array
    backward: Array
    still: Indices
    nodal: Array


class ModalJoints(NamedTuple):
    """Joint elements in runs, between blocks with modes.

    Parameters
    ----------
    tables
        Displacements of the nodes on joints, for templates whose tables are not folded.
    folded
        The folded tables.
    start : (nr + 1,) uint
        First element of each run, then the number of elements.
    places : (nr, 8) uint
        Indices of the nodal displacements of each run's first element, the two ends of side a before those of side b,
        minus the number of that element. Negative values wrap round; the sum with an element's number is still right.
    shares, weighted : (nr, n, 2, 4) float
        Coefficients of a side's displacements in the opening and the slip of each point; the same times the area [m²].
    """

    tables: NodalTables
    folded: FoldedTables
    start: Unsigned
    places: Unsigned
    shares: Array
    weighted: Array


def nodal_tables(
    templates: Sequence[tuple[tuple[int, int, int, int, int], Array]], still: int, spare: int
) -> NodalTables:
    """Join the tables of templates.

    Parameters
    ----------
    templates
        For each template the first five entries of its row of `NodalTables.shapes`, and its table.
    still
        Number of displacements of blocks that move.
    spare
        Number of always-zero displacements after them.
    """
    first = np.cumsum([0, *(table.size for _, table in templates)])
    shapes = [(*shape, int(entry)) for (shape, _), entry in zip(templates, first, strict=False)]
    return NodalTables(
        np.array(shapes, dtype=np.int64).reshape(-1, 6),
        np.concatenate([np.zeros(0), *(table.ravel() for _, table in templates)]),
        np.concatenate([np.zeros(0), *(table.T.ravel() for _, table in templates)]),
        np.array([still]),
        np.zeros(still + spare),
    )


@inlined
def _product(
    table: Array, entry: Any, rows: Any, n: Any, factor: Array, first: Any, out: Array, at: Any, subtract: bool
) -> None:
    """Write the sum of a table's rows of length n, each times a factor, or subtract it; faster than a library call."""
    rows, first, at, step = np.uint64(rows), np.uint64(first), np.uint64(at), np.uint64(n)
    one, two, three, four = np.uint64(1), np.uint64(2), np.uint64(3), np.uint64(4)
    sense, i, end = -1.0 if subtract else 1.0, np.uint64(entry), np.uint64(entry) + step
    while i < end:
        j = i
        if i + four <= end:  # four sums in registers, because rows are too short for a vectorised loop
            a = b = c = d = 0.0
            if subtract:
                a, b, c, d = out[at], out[at + one], out[at + two], out[at + three]
            for k in range(rows):
                value = sense * factor[first + k]
                a += value * table[j]
                b += value * table[j + one]
                c += value * table[j + two]
                d += value * table[j + three]
                j += step
            out[at], out[at + one], out[at + two], out[at + three] = a, b, c, d
            i, at = i + four, at + four
        else:
            a = out[at] if subtract else 0.0
            for k in range(rows):
                a += sense * factor[first + k] * table[j]
                j += step
            out[at] = a
            i, at = i + one, at + one


@kernel
def _products(
    table: Array,
    rows: Any,
    terms: Any,
    n: Any,
    source: Array,
    source_at: Any,
    into: Array,
    at: Any,
    subtract: bool,
) -> None:
    """Write a table ``(rows, terms)`` times rows of `source` to rows of `into`, n long, or subtract it from them.

    Not a library's product, because its order of summation depends on the machine.
    """
    n, two, three = np.uint64(n), np.uint64(2), np.uint64(3)
    sense = -1.0 if subtract else 1.0
    for r in range(rows):
        out = np.uint64(at) + np.uint64(r) * n
        if not subtract:
            for e in range(n):
                into[out + e] = 0.0
        k, i = 0, np.uint64(source_at)
        while k < terms:  # four terms at once, because each pass reads and writes the whole row
            a, b, c, d = sense * table[r, k], 0.0, 0.0, 0.0
            i1 = i2 = i3 = i
            if k + 1 < terms:
                b, i1 = sense * table[r, k + 1], i + n
            if k + 2 < terms:
                c, i2 = sense * table[r, k + 2], i + two * n
            if k + 3 < terms:
                d, i3 = sense * table[r, k + 3], i + three * n
            for e in range(n):
                into[out + e] += a * source[i + e] + b * source[i1 + e] + c * source[i2 + e] + d * source[i3 + e]
            k += 4
            i += np.uint64(4) * n


@kernel
def _repeated_to_nodes(tables: NodalTables, motion: Array) -> None:
    """Nodal displacements of templates that have several blocks; see `to_nodes`."""
    shapes, table, nodal = tables.shapes, tables.forward, tables.nodal
    for k in range(shapes.shape[0]):
        blocks, modes, width, first, at, entry = shapes[k]
        if blocks > 1:
            phi = table[entry : entry + width * modes].reshape(width, modes)
            _products(phi, width, modes, blocks, motion, first, nodal, at, False)


@kernel
def _repeated_to_modes(tables: NodalTables, force: Array) -> None:
    """Modal forces of templates that have several blocks; see `to_modes`."""
    shapes, table, nodal = tables.shapes, tables.backward, tables.nodal
    for k in range(shapes.shape[0]):
        blocks, modes, width, first, at, entry = shapes[k]
        if blocks > 1:
            phi = table[entry : entry + width * modes].reshape(modes, width)
            _products(phi, modes, width, blocks, nodal, at, force, first, True)


@kernel
def to_nodes(tables: NodalTables, motion: Array) -> None:
    """Write the displacements of the nodes, from modal coordinates ``(nd,)``."""
    _repeated_to_nodes(tables, motion)
    for k in range(tables.shapes.shape[0]):
        blocks, modes, width, first, at, entry = tables.shapes[k]
        if blocks == 1:
            _product(tables.backward, entry, modes, width, motion, first, tables.nodal, at, False)


@kernel
def to_modes(tables: NodalTables, force: Array) -> None:
    """Subtract the nodal forces, projected on the modes, from modal forces ``(nd,)``."""
    _repeated_to_modes(tables, force)
    for k in range(tables.shapes.shape[0]):
        blocks, modes, width, first, at, entry = tables.shapes[k]
        if blocks == 1:
            _product(tables.forward, entry, width, modes, tables.nodal, at, force, first, True)


@kernel
def _combine(
    entries: TableRows,
    first_row: Any,
    rows: Any,
    n: Any,
    source: Array,
    source_at: Any,
    into: Array,
    into_at: Any,
    add: bool,
) -> None:
    """Write a sparse table times rows of `source`, which are n long, to rows of `into`, or add it to them."""
    start, column, value = entries
    for r in range(rows):
        begin, end = start[first_row + r], start[first_row + r + np.uint64(1)]
        out = into_at + r * n
        if begin == end and not add:
            for e in range(n):
                into[out + e] = 0.0
        for term in range(begin, end):
            a, b = value[term, 0], value[term, 1]
            i, j = source_at + column[term, 0] * n, source_at + column[term, 1] * n
            if term == begin and not add:
                for e in range(n):
                    into[out + e] = a * source[i + e] + b * source[j + e]
            else:
                for e in range(n):
                    into[out + e] += a * source[i + e] + b * source[j + e]


@kernel
def _sum_and_difference(i: Any, j: Any, n: Any, nodal: Array) -> None:
    """Replace the first of two rows of length n by their sum and the second by their difference."""
    for e in range(n):
        a, b = nodal[i + e], nodal[j + e]
        nodal[i + e] = a + b
        nodal[j + e] = a - b


@kernel
def unfold(tables: FoldedTables, motion: Array, nodal: Array) -> None:
    """Write nodal displacements on joints for blocks with folded tables, from modal coordinates ``(nd,)``."""
    shapes, pairs, forward, _ = tables
    for k in range(shapes.shape[0]):
        n, _, width, first, at, row, _, pair, last = shapes[k]
        _combine(forward, row, width, n, motion, first, nodal, at, False)
        for p in range(pair, last):
            _sum_and_difference(at + pairs[p, 0] * n, at + pairs[p, 1] * n, n, nodal)


@kernel
def fold(tables: FoldedTables, nodal: Array, force: Array) -> None:
    """Subtract nodal forces of blocks with folded tables from modal forces ``(nd,)``; overwrites the nodal forces."""
    shapes, pairs, _, backward = tables
    for k in range(shapes.shape[0]):
        n, modes, _, first, at, _, row, pair, last = shapes[k]
        for p in range(last - pair):
            there = last - np.uint64(1) - p
            _sum_and_difference(at + pairs[there, 0] * n, at + pairs[there, 1] * n, n, nodal)
        _combine(backward, row, modes, n, nodal, at, force, first, True)


@cache
def modal_kernels(alone: bool) -> tuple[Kernel, Kernel]:
    """Compile gather and scatter of `ModalJoints`; `alone` says whether some templates have only one block.

    A test for this in every step would slow small walls down. ``gather(motion, geometry, opening, slip)`` writes
    opening and slip at all points, ``(np,)`` [m], from modal coordinates ``(nd,)``, and ``scatter(normal, tangential,
    geometry, force)`` subtracts the forces of the points' tractions [Pa] from modal forces ``(nd,)``.
    """
    nodes_of, modes_of = (to_nodes, to_modes) if alone else (_repeated_to_nodes, _repeated_to_modes)

    @kernel
    def gather_modes(motion: Array, geometry: ModalJoints, opening: Array, slip: Array) -> None:
        tables, folded, start, places, shares, _ = geometry
        nodal = tables.nodal
        nodes_of(tables, motion)
        if folded.shapes.size:  # small walls have no folded tables and are spared the call
            unfold(folded, motion, nodal)
        # All fixed nodes share the last entries, which scatter has written to.
        nodal[tables.still[0] :] = 0.0
        points = np.uint64(shares.shape[1])
        ne = np.uint64(opening.size) // points
        for run in range(places.shape[0]):
            low, high = start[run], start[np.uint64(run + 1)]
            if high - low == 1:  # true for all runs if no two joints are alike
                for p in range(points):
                    u = v = 0.0
                    for k in range(4):
                        along = nodal[places[run, k + 4] + low] - nodal[places[run, k] + low]
                        u += shares[run, p, 0, k] * along
                        v += shares[run, p, 1, k] * along
                    opening[p * ne + low], slip[p * ne + low] = u, v
                continue
            for p in range(points):
                for axis in range(2):
                    out = opening[p * ne : (p + 1) * ne] if axis == 0 else slip[p * ne : (p + 1) * ne]
                    begun = False
                    for k in range(4):
                        share = shares[run, p, axis, k]
                        a, b = places[run, k], places[run, k + 4]
                        if share != 0.0 and begun:
                            for e in range(low, high):
                                out[e] += share * (nodal[b + e] - nodal[a + e])
                        elif share != 0.0:
                            begun = True
                            for e in range(low, high):
                                out[e] = share * (nodal[b + e] - nodal[a + e])

    @kernel
    def scatter_modes(normal: Array, tangential: Array, geometry: ModalJoints, force: Array) -> None:
        tables, folded, start, places, _, shares = geometry
        nodal = tables.nodal
        points = np.uint64(shares.shape[1])
        ne = np.uint64(normal.size) // points
        nodal[:] = 0.0
        for run in range(places.shape[0]):
            low, high = start[run], start[np.uint64(run + 1)]
            if high - low == 1:
                for p in range(points):
                    n, t = normal[p * ne + low], tangential[p * ne + low]
                    for k in range(4):
                        force_there = shares[run, p, 0, k] * n + shares[run, p, 1, k] * t
                        nodal[places[run, k] + low] -= force_there
                        nodal[places[run, k + 4] + low] += force_there
                continue
            for p in range(points):
                for axis in range(2):
                    traction = normal[p * ne : (p + 1) * ne] if axis == 0 else tangential[p * ne : (p + 1) * ne]
                    for k in range(4):
                        share = shares[run, p, axis, k]
                        a, b = places[run, k], places[run, k + 4]
                        if share != 0.0:
                            # One loop per side: the ranges overlap if one side's blocks are a step behind the other's.
                            for e in range(low, high):
                                nodal[a + e] -= share * traction[e]
                            for e in range(low, high):
                                nodal[b + e] += share * traction[e]
        modes_of(tables, force)
        if folded.shapes.size:
            fold(folded, nodal, force)

    return gather_modes, scatter_modes
