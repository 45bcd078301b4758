"""Kinematics of blocks with modes as compiled kernels: modes to joint nodes, those to jumps, and back.

Motions are kept template by template, each a matrix Q of modes by blocks, so that the displacements of all nodes that
lie on joints are one product U = Φ Q, and the forces on the modes another, F −= Φᵀ S. Where Φ can be folded
(`folding`) few of its entries are left. Joint elements come in runs (`runs.find_runs`), in which blocks follow one
another as elements do, so that the loops run in vector registers. Indices are unsigned, which need no check for
counting from the end.
"""

from typing import Any

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array

kernel = compiled.kernel


@kernel
def to_nodes(shapes: Any, motion: Array, table: Array, nodal: Array) -> None:
    """Displacements of the nodes on joints, from modal coordinates ``(nd,)``."""
    for k in range(shapes.shape[0]):
        blocks, modes, width, first, at, entry = shapes[k]
        phi = table[entry : entry + width * modes].reshape(width, modes)
        Q = motion[first : first + modes * blocks].reshape(modes, blocks)
        np.dot(phi, Q, nodal[at : at + width * blocks].reshape(width, blocks))


@kernel
def to_modes(shapes: Any, nodal: Array, table: Array, product: Array, force: Array) -> None:
    """Subtract from modal forces ``(nd,)`` those of the nodes on joints."""
    for k in range(shapes.shape[0]):
        blocks, modes, width, first, at, entry = shapes[k]
        phi = table[entry : entry + width * modes].reshape(modes, width)
        S = nodal[at : at + width * blocks].reshape(width, blocks)
        out = product[: modes * blocks]
        np.dot(phi, S, out.reshape(modes, blocks))
        into = force[first : first + modes * blocks]
        for i in range(into.size):
            into[i] -= out[i]


@kernel
def _combine(
    entries: Any, first_row: Any, rows: Any, n: Any, source: Array, source_at: Any, into: Array, into_at: Any, add: bool
) -> None:
    """Make rows of `into` what a table's entries make of rows of `source`, or add it to them; rows are n long."""
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
    """Put the sum of two rows, n long, in place of the first and their difference in place of the second."""
    for e in range(n):
        a, b = nodal[i + e], nodal[j + e]
        nodal[i + e] = a + b
        nodal[j + e] = a - b


@kernel
def unfold(folds: Any, motion: Array, nodal: Array) -> None:
    """Displacements of the nodes on joints of blocks whose tables are folded, from modal coordinates ``(nd,)``.

    `folds` are the arrays of `folding.Folds`.
    """
    shapes, pairs, forward, _ = folds
    for k in range(shapes.shape[0]):
        n, _, width, first, at, row, _, pair, last = shapes[k]
        _combine(forward, row, width, n, motion, first, nodal, at, False)
        for p in range(pair, last):
            _sum_and_difference(at + pairs[p, 0] * n, at + pairs[p, 1] * n, n, nodal)


@kernel
def fold(folds: Any, nodal: Array, force: Array) -> None:
    """Subtract from modal forces ``(nd,)`` those of the nodes on joints of such blocks; writes over the latter."""
    shapes, pairs, _, backward = folds
    for k in range(shapes.shape[0]):
        n, modes, _, first, at, _, row, pair, last = shapes[k]
        for p in range(last - pair):
            there = last - np.uint64(1) - p
            _sum_and_difference(at + pairs[there, 0] * n, at + pairs[there, 1] * n, n, nodal)
        _combine(backward, row, modes, n, nodal, at, force, first, True)


@kernel
def gather_modes(motion: Array, geometry: Any, opening: Array, slip: Array) -> None:
    """Opening and slip at all points, ``(np,)`` [m], from modal coordinates ``(nd,)``."""
    shapes, table, _, folds, start, places, shares, _, still, nodal, _ = geometry
    to_nodes(shapes, motion, table, nodal)
    if folds[0].size:  # a small wall has none, and would pay for the call
        unfold(folds, motion, nodal)
    # What does not move shares the last entries, which scatter has written to.
    nodal[still[0] :] = 0.0
    points = shares.shape[1]
    ne = opening.size // points
    for run in range(places.shape[0]):
        low, high = start[run], start[np.uint64(run + 1)]
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
def scatter_modes(normal: Array, tangential: Array, geometry: Any, force: Array) -> None:
    """Subtract from modal forces ``(nd,)`` what the tractions at the points ``(np,)`` [Pa] do on the modes."""
    shapes, _, table, folds, start, places, _, shares, _, nodal, product = geometry
    points = shares.shape[1]
    ne = normal.size // points
    nodal[:] = 0.0
    for run in range(places.shape[0]):
        low, high = start[run], start[np.uint64(run + 1)]
        for p in range(points):
            for axis in range(2):
                traction = normal[p * ne : (p + 1) * ne] if axis == 0 else tangential[p * ne : (p + 1) * ne]
                for k in range(4):
                    share = shares[run, p, axis, k]
                    a, b = places[run, k], places[run, k + 4]
                    if share != 0.0:
                        # The two sides apart, for a run may have one side's blocks a step behind the other's.
                        for e in range(low, high):
                            nodal[a + e] -= share * traction[e]
                        for e in range(low, high):
                            nodal[b + e] += share * traction[e]
    to_modes(shapes, nodal, table, product, force)
    if folds[0].size:
        fold(folds, nodal, force)
