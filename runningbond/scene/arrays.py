"""Array types shared by every room, and the one way to freeze an array."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.int64]
Unsigned: TypeAlias = NDArray[np.uint64]
"""Indices of kernels, which ask of every index that may be negative whether it is."""
Mask: TypeAlias = NDArray[np.bool_]


def frozen(values: ArrayLike, dtype: type[Any] = np.float64) -> NDArray[Any]:
    """Return a read-only copy of `values`, so that a frozen dataclass is frozen all the way down."""
    array = np.array(values, dtype=dtype)
    array.setflags(write=False)
    return array
