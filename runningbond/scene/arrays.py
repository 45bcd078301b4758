"""Array types shared by all packages, a function that freezes arrays, and connected components."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

Array: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.int64]
Unsigned: TypeAlias = NDArray[np.uint64]
"""Indices in compiled kernels: with signed ones, the kernel would check each index for being negative."""
Mask: TypeAlias = NDArray[np.bool_]


def frozen(values: ArrayLike, dtype: type[Any] = np.float64) -> NDArray[Any]:
    """Return a read-only copy of `values`, so that a frozen dataclass is frozen all the way down."""
    array = np.array(values, dtype=dtype)
    array.setflags(write=False)
    return array


def components(pairs: Indices, count: int) -> Indices:
    """Connected component ``(count,)`` of each of `count` items, of which `pairs` ``(n, 2)`` are connected."""
    a, b = pairs.T
    graph = coo_array((np.ones(len(pairs)), (a, b)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)
