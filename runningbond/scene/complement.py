"""Orthogonal complement of some vectors, bitwise the same on all machines.

Singular vectors of a repeated singular value are an arbitrary basis of their space, which differs between the kernels
of a linear algebra library; and the load that a wall of many blocks carries may depend on the last bit of a number.
"""

import numpy as np

from .arrays import Array

DEPENDENT = 1e-9
"""Remaining length of a row (relative to the longest row) or axis up to which it counts as linearly dependent."""


def complement(rows: Array) -> Array:
    """Orthonormal basis ``(m, d)`` of the vectors orthogonal to rows ``(k, m)``.

    Gram-Schmidt with reorthogonalisation, applied to the rows and then to the coordinate axes. The longest remaining
    vector is always taken next, which makes every coordinate axis that no row involves one of the basis vectors.
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
