"""Compiled kernels: numba, kept on disk for as long as the code they came from.

Numba knows a kernel by the file it stands in and would go on using it after a kernel that it calls, in another
file, has changed. So the cache lies in a folder named after the digest of every file that kernels stand in, and one
suite installed twice, or anew in another place, compiles once.
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

KEPT = 4
"""Folders of kernels that are kept beside a new one: those of other versions, and of the code before a change."""

_ROOMS = ("runningbond/joints", "runningbond/contacts", "runningbond/dynamics", "dem", "fem_interface")


@cache
def _digest() -> str:
    """Digest of all of the package's own kernels."""
    root = Path(__file__).parents[2]
    digest = hashlib.sha256(numba.__version__.encode())
    for room in _ROOMS:
        for source in sorted((root / room).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> str:
    """Folder of the kernels; empty for a user who has no home, and whose kernels are not kept."""
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
    """Delete all but the latest of the folders beside one that is new; whoever still uses another compiles again."""
    with suppress(OSError):
        others = folder.parent.glob("[0-9a-f]" * len(folder.name))
        for old in sorted(others, key=lambda other: other.stat().st_mtime)[:-KEPT]:
            shutil.rmtree(old, ignore_errors=True)


FOLDER = _cache_folder()
"""Folder of the kernels; a user's own, which `kernel` has not compiled, are kept where Numba keeps them."""


def _is_own(module: str) -> bool:
    """Whether a module is one of the package's own that kernels stand in."""
    return f"{module}.".startswith(tuple(room.replace("/", ".") + "." for room in _ROOMS))


class PackageLocator(_CacheLocator):  # type: ignore[misc]
    """Where one of the package's own kernels is kept: a place that does not tell where the package is installed."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._folder = Path(FOLDER) / function.__module__.rpartition(".")[0]
        self._line = function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        """Folder of the kernels of a room."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """What tells whether the source is the one that was compiled."""
        return _digest()

    def get_disambiguator(self) -> str:
        """What tells kernels of one name in one file from each other."""
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], _: str) -> "PackageLocator | None":
        """The place of a kernel; None for one of a user's own, or where none is."""
        if not FOLDER or not _is_own(py_func.__module__):
            return None
        locator = cls(py_func)
        with suppress(OSError):
            locator.ensure_cache_path()
            return locator
        return None


class UserLocator(_SourceFileBackedLocatorMixin, _CacheLocator):  # type: ignore[misc]
    """Where a kernel of a user's own is kept, a law or what is closed over one: by the file that it stands in."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file, self._lineno = file, function.__code__.co_firstlineno
        self._folder = Path(FOLDER) / self.get_suitable_cache_subpath(file)

    def get_cache_path(self) -> str:
        """Folder of the kernels of a folder of files."""
        return str(self._folder)


class _Kept(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (PackageLocator, UserLocator, *CompileResultCacheImpl._locator_classes)


class SharedCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of one kernel, fit to be shared by the processes of a campaign.

    - Numba takes the number of a new file from an index that another process may be about to change, so that one
      signature may find the code of another there. Here one process saves at a time.
    - Numba knows a kernel that is closed over other kernels, as what interpolates along joints is, by names that
      these have in one process only, and never finds it again. Here it is known by what they are called in their
      source; those of a user's own, which the name of the folder does not tell apart, by what they are made of too.
    - Numba numbers functions process by process, and two of one source, closed over different values in different
      processes, may come by one number, and so one symbol: a third process that loads both would go by the first it
      met in place of the other. Here what a kernel is known by is part of its symbols.
    - A cache that is damaged, or on a disk that takes no more, costs a compilation and not the answer. Numba would
      forget all that is kept of a kernel, for all laws, where one of them can not be read any more.
    """

    _impl_class = _Kept

    def _index_key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
        return sig, codegen.magic_tuple(), identity(self._py_func), _digest()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Give the compiled kernel for a signature, or None; what is compiled next has symbols of its own."""
        self._py_func.__qualname__ = symbol(self._py_func)
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever unpickling half a file raises, or a law whose module is there no more
            self._forget_a_damaged_index()
            return None

    def _forget_a_damaged_index(self) -> None:
        with suppress(OSError), locked(Path(self.cache_path)):
            try:
                self._cache_file._load_index()
            except Exception:
                self.flush()

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel."""
        with suppress(OSError):
            self._impl.locator.ensure_cache_path()
            with locked(Path(self.cache_path)):
                super().save_overload(sig, data)


def identity(function: Any, callers: tuple[Any, ...] = ()) -> tuple[Any, ...]:
    """What a function is called in its source, and what it is closed over; of a foreign one, its code as well.

    The same in every process, as long as the function does the same. `callers` are functions that are being named.
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
    """What something that can be called, or None, is known by: functions, classes, their objects, partial calls."""
    if given is None:
        return ()
    if isinstance(given, partial):
        return identity_of(given.func), dumps((given.args, sorted(given.keywords.items())))
    if hasattr(given, "__code__"):
        return identity(given)
    return _of_class(given if isinstance(given, type) else type(given))


def _of_class(given: type) -> tuple[Any, ...]:
    """What a class is called in its source, and the functions written in it and in what it is derived from."""
    known_by: list[Any] = [given.__module__, given.__qualname__]
    for kind in given.__mro__:
        for _, value in sorted(vars(kind).items()):
            function = getattr(value, "fget", getattr(value, "__func__", value))
            if hasattr(function, "__code__") and function.__code__.co_qualname.startswith(f"{kind.__qualname__}."):
                known_by.append(identity(function))
    return tuple(known_by)


def symbol(function: Any) -> str:
    """Name that a function's symbols go by: that in its source, and a digest of what else it is known by, if any."""
    module, name, *known_by = identity(function)
    if known_by == [repr(())]:
        return str(name)
    return f"{name}_{hashlib.sha256(repr((module, known_by)).encode()).hexdigest()[:16]}"


def kernel(function: Callable[..., Any]) -> Any:
    """Decorator of every kernel: compiled on first use, serial, exact arithmetic (no fastmath)."""
    dispatcher: Any = numba.njit(error_model="numpy", nogil=True)(function)
    with suppress(RuntimeError):  # where there is no folder to keep it in
        if not FOLDER:
            return dispatcher
        dispatcher._cache = SharedCache(function)
    return dispatcher


def inlined(function: Callable[..., Any]) -> Any:
    """Decorator of a long kernel that one other calls: part of that, and not compiled by itself as well."""
    return numba.njit(error_model="numpy", nogil=True, inline="always")(function)


@kernel
def copy_into(target: NDArray[Any], source: NDArray[Any]) -> None:
    """As ``target[:] = source``, which takes seconds to compile: it asks for memory where the two may overlap."""
    for i in range(target.size):
        target[i] = source[i]


class Compilation(Listener):  # type: ignore[misc]
    """Processor seconds spent on compiling kernels, also those that a kernel calls."""

    def __init__(self) -> None:
        self.seconds, self._depth, self._start = 0.0, 0, 0.0

    def on_start(self, event: Event) -> None:
        """A kernel is compiled, perhaps for the sake of another."""
        if not self._depth:
            self._start = time.process_time()
        self._depth += 1

    def on_end(self, event: Event) -> None:
        """It is done."""
        self._depth -= 1
        if not self._depth:
            self.seconds += time.process_time() - self._start


@contextmanager
def compilation() -> Iterator[Compilation]:
    """Take the time of what is compiled meanwhile: once on a machine, and none of what a model costs."""
    with install_listener("numba:compile", listener := Compilation()):
        yield listener
