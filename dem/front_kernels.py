"""Fronts of a nested dissection as compiled kernels: factors anew where something changed, and solutions with them.

Of each front the store keeps, one after the other and row by row, with s unknowns that it eliminates and u that it
leaves to the fronts above it: A₁₁⁻¹ (s, s), A₁₁⁻¹ A₁₂ (s, u), A₂₁ (u, s), and what it adds above,
−A₂₁ A₁₁⁻¹ A₁₂ (u, u) with what it was given.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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
    store: Indices  # (nf + 1,) first entry of each front in the store
    term: Indices  # (nf + 1,) first of the terms of each front
    order: Indices  # (n_terms,) terms, those of a front together
    address: Indices  # (n_terms,) where in the store each of these is added


@kernel
def factorise(fronts: Fronts, changed: Mask, terms: Array, store: Array) -> None:
    """Eliminate the unknowns of changed fronts ``(nf,)`` and, which are marked then, of those above them."""
    own, begin, _, place, above, at, term, order, address = fronts
    nf = above.size
    for f in range(nf):
        if changed[f] and above[f] >= 0:
            changed[above[f]] = True
    for f in range(nf):
        if changed[f]:
            store[at[f] : at[f + 1]] = 0.0
            for k in range(term[f], term[f + 1]):
                store[address[k]] += terms[order[k]]
    for f in range(nf):
        s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
        middle = at[f] + s * s
        low, last = middle + s * u, middle + 2 * s * u
        if changed[f]:
            inverse = np.linalg.inv(store[at[f] : middle].reshape((s, s)))
            for i in range(s):
                for j in range(s):
                    store[at[f] + i * s + j] = inverse[i, j]
            if u > 0:
                right = np.dot(store[at[f] : middle].reshape((s, s)), store[middle:low].reshape((s, u)))
                store[middle:low] = right.ravel()
                less = np.dot(store[low:last].reshape((u, s)), right).ravel()
                for k in range(u * u):
                    store[last + k] -= less[k]
        g = above[f]
        if g >= 0 and changed[g]:
            _add(store[last : last + u * u].reshape((u, u)), place[begin[f] : begin[f + 1]], own, begin, at, g, store)


@kernel
def _add(update: Array, place: Indices, own: Indices, begin: Indices, at: Indices, g: int, store: Array) -> None:
    """Add what a front leaves to the front g above it."""
    s, u = own[g + 1] - own[g], begin[g + 1] - begin[g]
    middle = at[g] + s * s
    low, last = middle + s * u, middle + 2 * s * u
    n = place.size
    inner = 0
    while inner < n and place[inner] < s:
        inner += 1
    for i in range(n):
        p = place[i]
        if i < inner:
            first, second = at[g] + p * s, middle + p * u - s
        else:
            first, second = low + (p - s) * s, last + (p - s) * u - s
        for j in range(inner):
            store[first + place[j]] += update[i, j]
        for j in range(inner, n):
            store[second + place[j]] += update[i, j]


@kernel
def substitute(fronts: Fronts, store: Array, x: Array) -> None:
    """Replace right-hand sides ``(k, n)``, in the order of elimination, by the solutions."""
    own, begin, left, _, above, at, _, _, _ = fronts
    for c in range(len(x)):
        v = x[c]
        for f in range(above.size):
            s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
            middle = at[f] + s * s
            low, last = middle + s * u, middle + 2 * s * u
            solved = np.dot(store[at[f] : middle].reshape((s, s)), v[own[f] : own[f + 1]])
            v[own[f] : own[f + 1]] = solved
            if u > 0:
                less = np.dot(store[low:last].reshape((u, s)), solved)
                for i in range(u):
                    v[left[begin[f] + i]] -= less[i]
        for f in range(above.size - 1, -1, -1):
            s, u = own[f + 1] - own[f], begin[f + 1] - begin[f]
            if u > 0:
                middle = at[f] + s * s
                there = v[left[begin[f] : begin[f + 1]]]
                v[own[f] : own[f + 1]] -= np.dot(store[middle : middle + s * u].reshape((s, u)), there)
