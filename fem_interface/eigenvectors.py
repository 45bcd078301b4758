"""Eigenvectors of small matrices, identical to the last bit on all machines.

The collapse load of a wall of many blocks may depend on the last bit of a number, and in linear algebra libraries that
bit of products and eigenvectors depends on the width of vector registers and the number of threads. Here every sum has
a fixed order: Jacobi rotations (Golub & Van Loan 2013, Sec. 8.5), Gram-Schmidt projections, `numpy.einsum` and
products of sparse matrices, none of which calls such a library.
"""

import math

import numpy as np
from scipy.sparse import csr_array

from runningbond.joints import compiled
from runningbond.scene import Array, complement

kernel = compiled.kernel

SWEEPS = 30
"""Maximum number of Jacobi sweeps; they converge quadratically."""


def symmetric_eigenvectors(matrix: Array) -> tuple[Array, Array]:
    """Eigenvalues ``(n,)`` of a symmetric matrix ``(n, n)``, ascending, and eigenvectors as columns ``(n, n)``."""
    rest, vectors = matrix.copy(), np.eye(len(matrix))
    _rotate(rest, vectors)
    own = np.diag(rest)
    order = np.argsort(own, kind="stable")
    return own[order], vectors.T[:, order]


def eigenvectors(K: Array, M: Array, within: Array, zero: Array) -> tuple[Array, Array]:
    """Solutions of K x = ω² M x in the span of given columns, subject to homogeneous linear constraints.

    Parameters
    ----------
    K, M : (n, n) float
        Symmetric matrices; M is invertible.
    within : (n, m) float
        The columns, linearly independent.
    zero : (k, n) float
        The constraints: ``zero @ x`` is zero for every solution x.

    Returns
    -------
    (d,) and (n, d) float
        ω², ascending, and all solutions x as columns, normalised to xᵀ M x = 1.
    """
    rows = np.einsum("kn,nm->km", zero, within)
    basis = np.ascontiguousarray(np.einsum("nm,md->dn", within, complement(rows)))
    mass, stiffness = csr_array(M), csr_array(K)
    for _ in range(2):  # after one pass orthogonality is only as good as the basis was conditioned
        _orthonormalise(basis, mass.indptr, mass.indices, mass.data)
    own, turn = symmetric_eigenvectors(np.einsum("in,nj->ij", basis, stiffness @ basis.T))
    return own, np.einsum("in,ij->nj", basis, turn)


@kernel
def _orthonormalise(vectors: Array, start: Array, column: Array, value: Array) -> None:
    """Make rows ``(d, n)`` orthonormal in place, with the inner product of a sparse matrix ``(n, n)``."""
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
    """Diagonalise a symmetric matrix in place by rotations, and apply them to the rows of `vectors` as well."""
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
