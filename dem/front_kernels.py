"""Fronts of a nested dissection as compiled kernels: factors anew where something changed, and solutions with them.

With s unknowns that a front eliminates and u that it leaves to the fronts above it, the store keeps of it, one after
the other and row by row, A₁₁⁻¹ (s, s), −A₁₁⁻¹ A₁₂ (s, u), A₂₁ (u, s), and what it adds above, A₂₂ − A₂₁ A₁₁⁻¹ A₁₂
(u, u), with A₂₂ the sum of what the fronts below add there.
"""

from typing import NamedTuple

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array, Indices, Mask

kernel = compiled.kernel


class Fronts(NamedTuple):
    """Fronts, those below a front before it."""

    own: Indices  # (nf + 1,) first unknown that each front eliminates, unknowns in the order of their elimination
    begin: Indices  # (nf + 1,) first entry of `left` of each front
    left: Indices  # unknowns that each front leaves to those above it, in order
    place: Indices  # and what place they have in the front above, its own unknowns first
    above: Indices  # (nf,) the front above each, −1 for the last ones
    first: Indices  # (nf + 1,) first entry of `below` of each front
    below: Indices  # fronts right below each
    at: Indices  # (nf + 1,) first entry of each front in the store
    term: Indices  # (nf + 1,) first of the terms of each front
    order: Indices  # (n_terms,) terms, those of a front together
    address: Indices  # (n_terms,) where in the store each of these is added


@kernel
def renew(tangent: Array, last: Array, jump: Array, front: Indices, changed: Mask, terms: Array) -> None:
    """Terms ``(36 np,)`` of joint points whose tangents ``(np, 2, 2)`` are not the last ones; their fronts changed."""
    # Entry by entry: views of so few numbers cost more than what is done with them.
    for p in range(len(tangent)):
        nn, ns, sn, ss = tangent[p, 0, 0], tangent[p, 0, 1], tangent[p, 1, 0], tangent[p, 1, 1]
        if nn == last[p, 0, 0] and ns == last[p, 0, 1] and sn == last[p, 1, 0] and ss == last[p, 1, 1]:
            continue
        changed[front[p, 0]] = changed[front[p, 1]] = True
        for i in range(6):
            normal = jump[p, 0, i] * nn + jump[p, 1, i] * sn
            shear = jump[p, 0, i] * ns + jump[p, 1, i] * ss
            for j in range(6):
                terms[36 * p + 6 * i + j] = normal * jump[p, 0, j] + shear * jump[p, 1, j]


@kernel
def factorise(fronts: Fronts, changed: Mask, terms: Array, store: Array) -> None:
    """Eliminate the unknowns of changed fronts ``(nf,)`` and, which are marked then, of those above them."""
    own, begin, _, place, above, first, below, at, term, order, address = fronts
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
            store[address[k]] += terms[order[k]]
        for b in below[first[f] : first[f + 1]]:
            theirs = place[begin[b] : begin[b + 1]]
            _add_own(store[at[b + 1] - theirs.size**2 : at[b + 1]], theirs, s, u, store[at[f] : last])
        inverse = np.ascontiguousarray(np.linalg.inv(store[at[f] : middle].reshape((s, s))))
        store[at[f] : middle] = inverse.ravel()
        if u > 0:
            right = np.dot(inverse, -store[middle:low].reshape((s, u)))
            store[middle:low] = right.ravel()
            np.dot(store[low:last].reshape((u, s)), right, store[last : at[f + 1]].reshape((u, u)))
            for b in below[first[f] : first[f + 1]]:
                theirs = place[begin[b] : begin[b + 1]]
                _add_left(store[at[b + 1] - theirs.size**2 : at[b + 1]], theirs, s, u, store[last : at[f + 1]])


@kernel
def _add_own(update: Array, place: Indices, s: int, u: int, front: Array) -> None:
    """Add what a front leaves to the own unknowns of the front above it, in rows, then to others in columns."""
    n = place.size
    inner = np.searchsorted(place, s)
    for i in range(inner):
        row, right = place[i] * s, s * s + place[i] * u - s
        for j in range(inner):
            front[row + place[j]] += update[i * n + j]
        for j in range(inner, n):
            front[right + place[j]] += update[i * n + j]
    for i in range(inner, n):
        row = s * s + s * u + (place[i] - s) * s
        for j in range(inner):
            front[row + place[j]] += update[i * n + j]


@kernel
def _add_left(update: Array, place: Indices, s: int, u: int, left: Array) -> None:
    """Add what a front leaves to what the front above it leaves as well."""
    n = place.size
    inner = np.searchsorted(place, s)
    for i in range(inner, n):
        row = (place[i] - s) * u - s
        for j in range(inner, n):
            left[row + place[j]] += update[i * n + j]


@kernel
def substitute(fronts: Fronts, store: Array, x: Array) -> None:
    """Replace right-hand sides ``(k, n)``, in the order of elimination, by the solutions."""
    own, begin, left, at = fronts.own, fronts.begin, fronts.left, fronts.at
    for k in range(len(x)):
        v = x[k]
        for f in range(own.size - 1):
            s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
            low = at[f] + s * s + s * u
            solved = np.dot(store[at[f] : at[f] + s * s].reshape((s, s)), v[own[f] : own[f + 1]])
            v[own[f] : own[f + 1]] = solved
            if u > 0:
                less = np.dot(store[low : low + u * s].reshape((u, s)), solved)
                for i in range(u):
                    v[left[begin[f] + i]] -= less[i]
        for f in range(own.size - 2, -1, -1):
            s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
            if u > 0:
                middle = at[f] + s * s
                there = v[left[begin[f] : begin[f + 1]]]
                v[own[f] : own[f + 1]] += np.dot(store[middle : middle + s * u].reshape((s, u)), there)
