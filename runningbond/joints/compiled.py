"""Compiled kernels: numba, kept on disk for as long as the code they came from.

Numba knows a kernel by the file it stands in and would go on using it after a kernel that it calls, in another
file, has changed. So the cache lies in a folder named after the digest of every file that kernels stand in.
"""

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps

from runningbond.scene.folder_lock import alone

_HOME = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "runningbond"
_ROOMS = ("runningbond/joints", "runningbond/contacts", "runningbond/dynamics", "dem", "fem_interface")


def _digest() -> str:
    root = Path(__file__).parents[2]
    digest = hashlib.sha256(numba.__version__.encode())
    for room in _ROOMS:
        for source in sorted((root / room).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


if "NUMBA_CACHE_DIR" not in os.environ:
    numba.config.CACHE_DIR = str(_HOME / _digest())


class SharedCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of one kernel, fit to be shared by the processes of a campaign.

    - Numba takes the number of a new file from an index that another process may be about to change, so that one
      signature may find the code of another there. Here one process saves at a time.
    - Numba knows a kernel that is closed over other kernels, as the loop over a law is, by names that these have in
      one process only, and never finds it again. Here it is known by what they are called in their source.
    - A cache that is damaged, or on a disk that takes no more, costs a compilation and not the answer.
    """

    def _index_key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
        return sig, codegen.magic_tuple(), _identity(self._py_func)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Give the compiled kernel for a signature, or None."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever unpickling half a file raises
            with suppress(OSError), alone(Path(self.cache_path)):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel."""
        with suppress(OSError):
            self._impl.locator.ensure_cache_path()
            with alone(Path(self.cache_path)):
                super().save_overload(sig, data)


def _identity(function: Any) -> tuple[Any, ...]:
    """What a function is called in its source, and what it is closed over."""
    closed_over = [cell.cell_contents for cell in function.__closure__ or ()]
    known_by = (_identity(value.py_func) if isinstance(value, Dispatcher) else dumps(value) for value in closed_over)
    return function.__module__, function.__qualname__, *known_by


def kernel(function: Callable[..., Any]) -> Any:
    """Decorator of every kernel: compiled on first use, serial, exact arithmetic (no fastmath)."""
    dispatcher: Any = numba.njit(error_model="numpy", nogil=True)(function)
    with suppress(RuntimeError):  # where there is no folder to keep it in
        dispatcher._cache = SharedCache(function)
    return dispatcher
