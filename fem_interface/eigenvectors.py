"""Eigenvectors of small matrices, to the last bit the same on all machines.

What a wall of many blocks bears may turn on the last bit of a number, and a linear algebra library's products and
eigenvectors differ in it with the width of vector registers and the number of threads. Here every sum has one order:
Jacobi's rotations (Golub & Van Loan 2013, Sec. 8.5), Gram and Schmidt's projections, `numpy.einsum` and products of
sparse matrices, which call no such library.
"""

import math

import numpy as np
from scipy.sparse import csr_array

from runningbond.joints import compiled
from runningbond.scene import Array, complement

kernel = compiled.kernel

SWEEPS = 30
"""Most sweeps of rotations, which converge quadratically."""


def symmetric_eigenvectors(matrix: Array) -> tuple[Array, Array]:
    """Eigenvalues ``(n,)`` of a symmetric matrix ``(n, n)``, ascending, and eigenvectors ``(n, n)``, a column each."""
    rest, vectors = matrix.copy(), np.eye(len(matrix))
    _rotate(rest, vectors)
    own = np.diag(rest)
    order = np.argsort(own, kind="stable")
    return own[order], vectors.T[:, order]


def eigenvectors(K: Array, M: Array, within: Array, zero: Array) -> tuple[Array, Array]:
    """Solutions of K x = ω² M x in the span of some columns, on which some rows are zero.

    Parameters
    ----------
    K, M : (n, n) float
        Symmetric matrices; M has an inverse.
    within : (n, m) float
        The columns, which are independent.
    zero : (k, n) float
        The rows.

    Returns
    -------
    (d,) and (n, d) float
        ω², ascending, and as many x as there are, of xᵀ M x = 1.
    """
    rows = np.einsum("kn,nm->km", zero, within)
    basis = np.ascontiguousarray(np.einsum("nm,md->dn", within, complement(rows)))
    mass, stiffness = csr_array(M), csr_array(K)
    for _ in range(2):  # once leaves them as orthogonal as the basis was well-conditioned
        _orthonormalise(basis, mass.indptr, mass.indices, mass.data)
    own, turn = symmetric_eigenvectors(np.einsum("in,nj->ij", basis, stiffness @ basis.T))
    return own, np.einsum("in,ij->nj", basis, turn)


@kernel
def _orthonormalise(vectors: Array, start: Array, column: Array, value: Array) -> None:
    """Make rows ``(d, n)`` orthonormal, in place, with a sparse matrix ``(n, n)``."""
    d, n = vectors.shape
    image = np.empty(n)
    for i in range(d):
        for row in range(n):
            total = 0.0
            for entry in range(start[row], start[row + 1]):
                total += value[entry] * vectors[i, column[entry]]
            image[row] = total
        square = 0.0
        for k in range(n):
            square += image[k] * vectors[i, k]
        length = math.sqrt(square)
        for k in range(n):
            vectors[i, k] /= length
            image[k] /= length
        for j in range(i + 1, d):
            part = 0.0
            for k in range(n):
                part += image[k] * vectors[j, k]
            for k in range(n):
                vectors[j, k] -= part * vectors[i, k]


@kernel
def _rotate(matrix: Array, vectors: Array) -> None:
    """Make a symmetric matrix diagonal, in place, by rotations, which rows of `vectors` are turned by as well."""
    n = len(matrix)
    for _ in range(SWEEPS):
        turned = False
        for p in range(n - 1):
            for q in range(p + 1, n):
                off = matrix[p, q]
                if abs(off) <= 1e-17 * math.sqrt(abs(matrix[p, p] * matrix[q, q])) or abs(off) < 1e-300:
                    continue
                turned = True
                slope = (matrix[q, q] - matrix[p, p]) / (2 * off)
                tangent = (1.0 if slope >= 0 else -1.0) / (abs(slope) + math.sqrt(1 + slope * slope))
                cosine = 1 / math.sqrt(1 + tangent * tangent)
                sine = tangent * cosine
                for k in range(n):
                    one, other = matrix[k, p], matrix[k, q]
                    matrix[k, p], matrix[k, q] = cosine * one - sine * other, sine * one + cosine * other
                for k in range(n):
                    one, other = matrix[p, k], matrix[q, k]
                    matrix[p, k], matrix[q, k] = cosine * one - sine * other, sine * one + cosine * other
                matrix[p, q] = matrix[q, p] = 0.0
                for k in range(n):
                    one, other = vectors[p, k], vectors[q, k]
                    vectors[p, k], vectors[q, k] = cosine * one - sine * other, sine * one + cosine * other
        if not turned:
            return
