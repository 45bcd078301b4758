"""One process at a time in a folder, without leaving anything in it where the system locks folders."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

fcntl: Any
try:
    import fcntl
except ImportError:  # Windows, where a folder cannot be opened, and a file in it is locked instead
    fcntl = None

LOCK = ".runningbond.lock"


@contextmanager
def locked(folder: Path, *, reading: bool = False) -> Iterator[None]:
    """Wait until no other process holds a folder, and hold it.

    The lock lies on the folder itself, or else on a file in it, and ends with its holder, however that comes about. A
    file system that knows no locks gives none; what is written atomically is so without one. `reading` lets other
    readers in where folders are locked.
    """
    if fcntl is None:
        with _file_locked(folder / LOCK):
            yield
        return
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_SH if reading else fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


@contextmanager
def _file_locked(path: Path) -> Iterator[None]:
    from filelock import FileLock

    if not path.parent.is_dir():
        raise FileNotFoundError(2, "No such file or directory", str(path.parent))
    lock = FileLock(path, is_singleton=False)
    with suppress(OSError, NotImplementedError):
        lock.acquire()
    try:
        yield
    finally:
        lock.release()
