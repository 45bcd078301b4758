"""What is orthogonal to some vectors, to the last bit the same on all machines.

A linear algebra library's singular vectors of one singular value are any mixture of each other, another one with
every kernel of the library's; and what a wall of many blocks bears may turn on the last bit of a number.
"""

import numpy as np

from .arrays import Array

DEPENDENT = 1e-9
"""Length, of the longest row's, below which a vector counts as a sum of others."""


def complement(rows: Array) -> Array:
    """Orthonormal vectors ``(m, d)`` on which rows ``(k, m)`` are zero.

    Gram and Schmidt's projections, twice each, of the rows and then of the coordinates; the longest that is left is
    next each time, so that a coordinate that no row touches is one of the vectors.
    """
    longest = np.sqrt((rows**2).sum(axis=1)).max(initial=1e-300)
    k, m = rows.shape
    left, found = np.vstack([rows / longest, np.eye(m)]), [np.zeros((m, 0))]
    for part in (slice(k), slice(k, None)):
        while True:
            length = np.sqrt(np.einsum("ij,ij->i", left[part], left[part]))
            if length.max(initial=0.0) <= DEPENDENT:
                break
            one = left[part][length.argmax()] / length.max()
            for _ in range(2):
                left = left - np.einsum("i,j->ij", np.einsum("ij,j->i", left, one), one)
            if part.start == k:
                found.append(one[:, None])
    return np.hstack(found)
