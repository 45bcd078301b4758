"""Compiled kernels: numba, kept on disk for as long as the code they came from.

Numba knows a kernel by the file it stands in and would go on using it after a kernel that it calls, in another
file, has changed. So the cache lies in a folder named after the digest of every file that kernels stand in.
"""

import hashlib
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numba

_HOME = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "runningbond"
_ROOMS = ("joints", "dynamics", "dem", "fem_interface")


def _digest() -> str:
    root = Path(__file__).parent.parent
    digest = hashlib.sha256(numba.__version__.encode())
    for room in _ROOMS:
        for source in sorted((root / room).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


if "NUMBA_CACHE_DIR" not in os.environ:
    numba.config.CACHE_DIR = str(_HOME / _digest())  # type: ignore[attr-defined]

kernel: Callable[[Callable[..., Any]], Any] = partial(numba.njit, cache=True, error_model="numpy", nogil=True)
"""Decorator of every kernel: compiled on first use, serial, exact arithmetic (no fastmath)."""
