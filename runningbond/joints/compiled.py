"""Compiled kernels: numba, with a cache on disk that is valid as long as the source code is unchanged.

Numba identifies a kernel by its source file, and would keep using it after a change of a kernel that it calls in
another file. The cache therefore lies in a folder named after the digest of every file with kernels, and a package that
is installed twice, or again in another place, compiles only once.
"""

import hashlib
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator, _SourceFileBackedLocatorMixin
from numba.core.dispatcher import Dispatcher
from numba.core.event import Event, Listener, install_listener
from numba.core.serialize import dumps
from numpy.typing import NDArray

from runningbond.scene.folder_lock import locked

KEPT_FOLDERS = 4
"""Number of kernel folders kept beside a new one: those of other versions, and of the code before a change."""

_KERNEL_FOLDERS = ("runningbond/joints", "runningbond/contacts", "runningbond/dynamics", "dem", "fem_interface")


@cache
def _digest() -> str:
    """Digest of all source files with the package's own kernels."""
    root = Path(__file__).parents[2]
    digest = hashlib.sha256(numba.__version__.encode())
    for room in _KERNEL_FOLDERS:
        for source in sorted((root / room).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> str:
    """Folder of the kernels; empty for a user without a home folder, whose kernels are not kept."""
    if "NUMBA_CACHE_DIR" in os.environ:
        return os.environ["NUMBA_CACHE_DIR"]
    with suppress(RuntimeError):
        cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        folder = Path(cache) / "runningbond" / _digest()
        if not folder.exists():
            _forget_old(folder)
        return str(folder)
    return ""


def _forget_old(folder: Path) -> None:
    """Delete all but the latest of the folders beside a new one; a process that still uses another compiles again."""
    with suppress(OSError):
        others = folder.parent.glob("[0-9a-f]" * len(folder.name))
        for old in sorted(others, key=lambda other: other.stat().st_mtime)[:-KEPT_FOLDERS]:
            shutil.rmtree(old, ignore_errors=True)


FOLDER = _cache_folder()
"""Folder of the kernels; a user's kernels that were not compiled by `kernel` are kept where Numba keeps them."""


def _is_own(module: str) -> bool:
    """Whether a module is one of the package's own modules with kernels."""
    return f"{module}.".startswith(tuple(room.replace("/", ".") + "." for room in _KERNEL_FOLDERS))


class PackageLocator(_CacheLocator):  # type: ignore[misc]
    """Cache location of the package's own kernels, which does not depend on where the package is installed."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._folder = Path(FOLDER) / function.__module__.rpartition(".")[0]
        self._line = function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        """Folder of the kernels of a subpackage."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Stamp that shows whether the source is the one that was compiled."""
        return _digest()

    def get_disambiguator(self) -> str:
        """Text that distinguishes kernels of one name in one file."""
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], _: str) -> "PackageLocator | None":
        """Location of a kernel; None for a user's own kernel, or without a cache folder."""
        if not FOLDER or not _is_own(py_func.__module__):
            return None
        locator = cls(py_func)
        with suppress(OSError):
            locator.ensure_cache_path()
            return locator
        return None


class UserLocator(_SourceFileBackedLocatorMixin, _CacheLocator):  # type: ignore[misc]
    """Cache location of a user's kernel, a law or a closure over one, by its source file."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file, self._lineno = file, function.__code__.co_firstlineno
        self._folder = Path(FOLDER) / self.get_suitable_cache_subpath(file)

    def get_cache_path(self) -> str:
        """Folder of the kernels of a folder of source files."""
        return str(self._folder)


class _Kept(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (PackageLocator, UserLocator, *CompileResultCacheImpl._locator_classes)


class SharedCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of one kernel, made safe to share between the processes of a campaign.

    - Numba takes the number of a new file from an index that another process may be about to change, so that one
      signature may find the code of another. Here only one process saves at a time.
    - Numba identifies a kernel with other kernels in its closure, such as the interpolation along joints, by names
      that hold in one process only, and never finds it again. Here it is identified by their names in the source; for
      kernels of a user, which the name of the folder does not distinguish, also by their code.
    - Numba numbers functions process by process. Two functions of one source, with different values in their closures
      and compiled in different processes, may get the same number and so the same symbol: a third process that loads
      both would run the first one in place of the other. Here the kernel's identity is part of its symbols.
    - A cache that is damaged, or on a full disk, costs a compilation and not the answer. If one entry cannot be read,
      Numba would discard all entries of a kernel, for all laws.
    """

    _impl_class = _Kept

    def _index_key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
        return sig, codegen.magic_tuple(), identity(self._py_func), _digest()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled kernel for a signature, or None; sets the symbols of a compilation that follows."""
        self._py_func.__qualname__ = symbol(self._py_func)
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # e.g. unpickling half a file, or a law whose module no longer exists
            self._forget_a_damaged_index()
            return None

    def _forget_a_damaged_index(self) -> None:
        with suppress(OSError), locked(Path(self.cache_path)):
            try:
                self._cache_file._load_index()
            except Exception:
                self.flush()

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save a compiled kernel."""
        with suppress(OSError):
            self._impl.locator.ensure_cache_path()
            with locked(Path(self.cache_path)):
                super().save_overload(sig, data)


def identity(function: Any, callers: tuple[Any, ...] = ()) -> tuple[Any, ...]:
    """Identity of a function: its name in the source and its closure; for a user's function, also its code.

    It is the same in every process, as long as the function does the same. `callers` are functions being identified.
    """
    code = function.__code__
    used = [cell.cell_contents for cell in function.__closure__ or ()]
    own: tuple[Any, ...] = ()
    if not _is_own(function.__module__):
        own = code.co_code, code.co_names, [dumps(value) for value in code.co_consts if not hasattr(value, "co_code")]
        named = (function.__globals__.get(name) for name in code.co_names)
        used += [value for value in named if isinstance(value, (Dispatcher, bool, int, float, tuple, np.ndarray))]
    callers = (*callers, function)
    known_by = (
        identity(value.py_func, callers) if isinstance(value, Dispatcher) else dumps(value)
        for value in used
        if not isinstance(value, Dispatcher) or value.py_func not in callers
    )
    return function.__module__, code.co_qualname, repr(own), *known_by


def identity_of(given: Any) -> tuple[Any, ...]:
    """Identity of a callable, or of None: functions, classes, their instances, partial calls."""
    if given is None:
        return ()
    if isinstance(given, partial):
        return identity_of(given.func), dumps((given.args, sorted(given.keywords.items())))
    if hasattr(given, "__code__"):
        return identity(given)
    return _of_class(given if isinstance(given, type) else type(given))


def _of_class(given: type) -> tuple[Any, ...]:
    """Identity of a class: its name in the source, and the functions defined in it and in its base classes."""
    known_by: list[Any] = [given.__module__, given.__qualname__]
    for kind in given.__mro__:
        for _, value in sorted(vars(kind).items()):
            function = getattr(value, "fget", getattr(value, "__func__", value))
            if hasattr(function, "__code__") and function.__code__.co_qualname.startswith(f"{kind.__qualname__}."):
                known_by.append(identity(function))
    return tuple(known_by)


def symbol(function: Any) -> str:
    """Name of a function in its symbols: that in its source, and a digest of the rest of its identity, if any."""
    module, name, *known_by = identity(function)
    if known_by == [repr(())]:
        return str(name)
    return f"{name}_{hashlib.sha256(repr((module, known_by)).encode()).hexdigest()[:16]}"


def kernel(function: Callable[..., Any]) -> Any:
    """Decorator of every kernel: compiled on first use, serial, exact arithmetic (no fastmath)."""
    dispatcher: Any = numba.njit(error_model="numpy", nogil=True)(function)
    with suppress(RuntimeError):  # raised if there is no folder to keep it in
        if not FOLDER:
            return dispatcher
        dispatcher._cache = SharedCache(function)
    return dispatcher


def inlined(function: Callable[..., Any]) -> Any:
    """Decorator of a long kernel with a single caller: it is inlined there, and not compiled on its own as well."""
    return numba.njit(error_model="numpy", nogil=True, inline="always")(function)


@kernel
def copy_into(target: NDArray[Any], source: NDArray[Any]) -> None:
    """Copy like ``target[:] = source``, which takes seconds to compile because it also handles overlapping arrays."""
    for i in range(target.size):
        target[i] = source[i]


class Compilation(Listener):  # type: ignore[misc]
    """Processor seconds spent on compiling kernels, including the kernels that they call."""

    def __init__(self) -> None:
        self.seconds, self._depth, self._start = 0.0, 0, 0.0

    def on_start(self, event: Event) -> None:
        """Start the clock, unless the kernel is compiled as part of another one."""
        if not self._depth:
            self._start = time.process_time()
        self._depth += 1

    def on_end(self, event: Event) -> None:
        """Stop the clock after the outermost kernel."""
        self._depth -= 1
        if not self._depth:
            self.seconds += time.process_time() - self._start


@contextmanager
def compilation() -> Iterator[Compilation]:
    """Measure the compilation time within the context: it is spent once per machine, no cost of a model."""
    with install_listener("numba:compile", listener := Compilation()):
        yield listener
