"""Compiled kernels for the fronts of a nested dissection: partial refactorisation and substitution.

A front eliminates s unknowns and passes u unknowns on to the fronts above it. For each front the store keeps, one after
the other and row by row, A₁₁⁻¹ (s, s), −A₁₁⁻¹ A₁₂ (s, u), A₂₁ (u, s), and its update of the front above,
A₂₂ − A₂₁ A₁₁⁻¹ A₁₂ (u, u), where A₂₂ is the sum of the updates from the fronts below.
"""

from typing import NamedTuple

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array, Indices, Mask, Unsigned

kernel, copy_into = compiled.kernel, compiled.copy_into


class Fronts(NamedTuple):
    """Fronts in the order of elimination: those below a front come before it."""

    own: Indices  # (nf + 1,) first unknown that each front eliminates, with unknowns in the order of elimination
    begin: Indices  # (nf + 1,) first entry of `left` of each front
    left: Unsigned  # unknowns that each front passes on to the fronts above it, in order
    place: Unsigned  # their positions in the front above, whose own unknowns come first
    above: Indices  # (nf,) the front above each, −1 for the top ones
    first: Indices  # (nf + 1,) first entry of `below` of each front
    below: Indices  # fronts directly below each
    at: Indices  # (nf + 1,) first entry of each front in the store
    term: Indices  # (nf + 1,) first term of each front
    address: Unsigned  # (n_terms,) index in the store to which each term is added


@kernel
def renew(
    tangent: Array, last: Array, jump: Array, front: Indices, slot: Unsigned, changed: Mask, terms: Array
) -> None:
    """Update the terms of joint points whose tangents ``(np, 2, 2)`` have changed, and mark their fronts as changed.

    ``slot`` ``(np, 36)`` is the index of each of a point's terms among `terms`.
    """
    # Entry by entry: views of so few numbers cost more than the arithmetic on them.
    for p in range(len(tangent)):
        nn, ns, sn, ss = tangent[p, 0, 0], tangent[p, 0, 1], tangent[p, 1, 0], tangent[p, 1, 1]
        if nn == last[p, 0, 0] and ns == last[p, 0, 1] and sn == last[p, 1, 0] and ss == last[p, 1, 1]:
            continue
        changed[front[p, 0]] = changed[front[p, 1]] = True
        for i in range(6):
            normal = jump[p, 0, i] * nn + jump[p, 1, i] * sn
            shear = jump[p, 0, i] * ns + jump[p, 1, i] * ss
            for j in range(6):
                terms[slot[p, 6 * i + j]] = normal * jump[p, 0, j] + shear * jump[p, 1, j]


@kernel
def factorise(fronts: Fronts, changed: Mask, terms: Array, store: Array) -> bool:
    """Factorise again the changed fronts ``(nf + 1,)`` and the fronts above them, which are marked as changed too.

    Return False if a front is singular.
    """
    own, begin, _, place, above, first, below, at, term, address = fronts
    for f in range(above.size):
        if not changed[f]:
            continue
        if above[f] >= 0:
            changed[above[f]] = True
        s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
        middle = at[f] + s * s
        low, last = middle + s * u, middle + 2 * s * u
        store[at[f] : last] = 0.0
        for k in range(term[f], term[f + 1]):
            store[address[k]] += terms[k]
        for b in below[first[f] : first[f + 1]]:
            theirs = place[begin[b] : begin[b + 1]]
            _add_own(_left_by(store, at[b + 1], theirs.size), theirs, np.uint64(s), np.uint64(u), store[at[f] : last])
        if not _invert(store[at[f] : middle].reshape((s, s))):
            return False
        if u > 0:
            right = np.zeros((s, u))
            _add_product(store[at[f] : middle].reshape((s, s)), -store[middle:low].reshape((s, u)), right)
            copy_into(store[middle:low], right.ravel())
            store[last : at[f + 1]] = 0.0
            _add_product(store[low:last].reshape((u, s)), right, store[last : at[f + 1]].reshape((u, u)))
            for b in below[first[f] : first[f + 1]]:
                theirs = place[begin[b] : begin[b + 1]]
                out = store[last : at[f + 1]]
                _add_left(_left_by(store, at[b + 1], theirs.size), theirs, np.uint64(s), np.uint64(u), out)
    return True


@kernel
def _left_by(store: Array, end: int, n: int) -> Array:
    """Update ``(n, n)`` that a front passes on: the last of its entries in the store."""
    return store[end - n * n : end].reshape((n, n))


@kernel
def _invert(matrix: Array) -> bool:
    """Invert a matrix ``(s, s)`` in place by Gauss–Jordan elimination with partial (row) pivoting.

    Return False if it is singular. Four columns are eliminated at once, because the others are read and written once
    per pass. Each entry is changed by the same operations, in the same order, as if it were one column after the other.
    """
    s = len(matrix)
    order, pivots, factor = np.arange(s), np.zeros((4, s)), np.zeros((s, 4))
    for first in range(0, s, 4):
        last = min(first + 4, s)
        pivots[:] = 0.0  # rows of the four pivots as they were when these were eliminated, except in the four columns
        factor[:] = 0.0  # multiples of these rows that are still to be subtracted from each row
        for k in range(first, last):
            best = k
            for i in range(k + 1, s):
                if abs(matrix[i, k]) > abs(matrix[best, k]):
                    best = i
            if not abs(matrix[best, k]) > 0.0:
                return False
            if best != k:
                for j in range(s):
                    matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
                for p in range(k - first):
                    factor[k, p], factor[best, p] = factor[best, p], factor[k, p]
                order[k], order[best] = order[best], order[k]
            for p in range(k - first):
                for j in range(s):
                    matrix[k, j] -= factor[k, p] * pivots[p, j]
                factor[k, p] = 0.0
            inverse = 1 / matrix[k, k]
            matrix[k, k] = 1.0
            for j in range(s):
                matrix[k, j] *= inverse
                pivots[k - first, j] = matrix[k, j]
            for j in range(first, last):
                pivots[k - first, j] = 0.0
            for i in range(s):
                if i != k:
                    multiple = matrix[i, k]
                    factor[i, k - first] = multiple
                    matrix[i, k] = 0.0
                    for j in range(first, last):
                        matrix[i, j] -= multiple * matrix[k, j]
        for i in range(s):
            a, b, c, d = factor[i, 0], factor[i, 1], factor[i, 2], factor[i, 3]
            for j in range(s):
                matrix[i, j] = matrix[i, j] - a * pivots[0, j] - b * pivots[1, j] - c * pivots[2, j] - d * pivots[3, j]
    row = np.empty(s)
    for i in range(s):
        for k in range(s):
            row[order[k]] = matrix[i, k]
        copy_into(matrix[i], row)
    return True


@kernel
def _add_product(left: Array, right: Array, out: Array) -> None:
    """Add the product of matrices ``(r, k)`` and ``(k, n)`` to a matrix ``(r, n)``, in a fixed order of sums."""
    rows, terms = left.shape
    n = right.shape[1]
    quads, paired, fours = rows - rows % 4, rows - rows % 2, terms - terms % 4
    for r in range(0, quads, 4):  # four rows and four terms at once, to reuse the values that are read
        for k in range(0, fours, 4):
            a, b, c, d = left[r, k], left[r, k + 1], left[r, k + 2], left[r, k + 3]
            e, f, g, h = left[r + 1, k], left[r + 1, k + 1], left[r + 1, k + 2], left[r + 1, k + 3]
            p, q, s, t = left[r + 2, k], left[r + 2, k + 1], left[r + 2, k + 2], left[r + 2, k + 3]
            w, x, y, z = left[r + 3, k], left[r + 3, k + 1], left[r + 3, k + 2], left[r + 3, k + 3]
            for j in range(n):
                one, two, three, four = right[k, j], right[k + 1, j], right[k + 2, j], right[k + 3, j]
                out[r, j] += a * one + b * two + c * three + d * four
                out[r + 1, j] += e * one + f * two + g * three + h * four
                out[r + 2, j] += p * one + q * two + s * three + t * four
                out[r + 3, j] += w * one + x * two + y * three + z * four
    for r in range(quads, paired):
        for k in range(0, fours, 4):
            a, b, c, d = left[r, k], left[r, k + 1], left[r, k + 2], left[r, k + 3]
            for j in range(n):
                out[r, j] += a * right[k, j] + b * right[k + 1, j] + c * right[k + 2, j] + d * right[k + 3, j]
    for r in range(rows):
        for k in range(fours if r < paired else 0, terms):
            a = left[r, k]
            for j in range(n):
                out[r, j] += a * right[k, j]


@kernel
def _add_times(matrix: Array, vector: Array, out: Array) -> None:
    """Add a matrix ``(r, k)`` times a vector ``(k,)``, as eight partial sums: a fixed order, whatever the registers."""
    rows, terms = matrix.shape
    eights = terms - terms % 8
    for r in range(rows):
        a = b = c = d = e = f = g = h = rest = 0.0
        for k in range(0, eights, 8):
            a += matrix[r, k] * vector[k]
            b += matrix[r, k + 1] * vector[k + 1]
            c += matrix[r, k + 2] * vector[k + 2]
            d += matrix[r, k + 3] * vector[k + 3]
            e += matrix[r, k + 4] * vector[k + 4]
            f += matrix[r, k + 5] * vector[k + 5]
            g += matrix[r, k + 6] * vector[k + 6]
            h += matrix[r, k + 7] * vector[k + 7]
        for k in range(eights, terms):
            rest += matrix[r, k] * vector[k]
        out[r] += ((a + b) + (c + d)) + ((e + f) + (g + h)) + rest


@kernel
def _add_own(update: Array, place: Unsigned, s: np.uint64, u: np.uint64, front: Array) -> None:
    """Add a front's update to A₁₁, A₁₂ and A₂₁ of the front above it."""
    n = place.size
    inner = np.searchsorted(place, s)
    for i in range(inner):
        row, right = place[i] * s, s * s + place[i] * u - s
        for j in range(inner):
            front[row + place[j]] += update[i, j]
        for j in range(inner, n):
            front[right + place[j]] += update[i, j]
    for i in range(inner, n):
        row = s * s + s * u + (place[i] - s) * s
        for j in range(inner):
            front[row + place[j]] += update[i, j]


@kernel
def _add_left(update: Array, place: Unsigned, s: np.uint64, u: np.uint64, left: Array) -> None:
    """Add a front's update to A₂₂ of the front above it."""
    n = place.size
    inner = np.searchsorted(place, s)
    for i in range(inner, n):
        row = (place[i] - s) * u - s
        for j in range(inner, n):
            left[row + place[j]] += update[i, j]


@kernel
def substitute(fronts: Fronts, store: Array, x: Array) -> None:
    """Replace right-hand sides ``(k, n)``, in the order of elimination, by the solutions."""
    own, begin, left, at = fronts.own, fronts.begin, fronts.left, fronts.at
    for k in range(len(x)):
        v = x[k]
        for f in range(own.size - 1):
            s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
            low = at[f] + s * s + s * u
            solved = np.zeros(s)
            _add_times(store[at[f] : at[f] + s * s].reshape((s, s)), v[own[f] : own[f + 1]], solved)
            copy_into(v[own[f] : own[f + 1]], solved)
            if u > 0:
                less = np.zeros(u)
                _add_times(store[low : low + u * s].reshape((u, s)), solved, less)
                for i in range(u):
                    v[left[begin[f] + i]] -= less[i]
        for f in range(own.size - 2, -1, -1):
            s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
            if u > 0:
                middle = at[f] + s * s
                there = v[left[begin[f] : begin[f + 1]]]
                _add_times(store[middle : middle + s * u].reshape((s, u)), there, v[own[f] : own[f + 1]])
