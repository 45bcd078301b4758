"""Sparse matrix by rows, whose products with vectors avoid the overhead of a library's argument checks."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array, csr_array

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Unsigned


class Rows(NamedTuple):
    """A sparse matrix by rows."""

    start: Unsigned  # (n + 1,) first entry of each row, then their number
    column: Unsigned  # unsigned, as kernels check every signed index for negative values
    value: Array

    @classmethod
    def of(cls, matrix: csr_array | csc_array) -> "Rows":
        """Convert a sparse matrix ``(n, m)``."""
        rows = csr_array(matrix)
        return cls(rows.indptr.astype(np.uint64), rows.indices.astype(np.uint64), rows.data)

    def times(self, vector: Array) -> Array:
        """Product with a vector ``(m,)``, each sum in the order of the row's entries."""
        product = np.empty(len(self.start) - 1)
        _multiply(self.start, self.column, self.value, vector, product)
        return product


@kernel
def _multiply(start: Unsigned, column: Unsigned, value: Array, vector: Array, product: Array) -> None:
    for i in range(product.size):
        total = 0.0
        for k in range(start[i], start[i + 1]):
            total += value[k] * vector[column[k]]
        product[i] = total
