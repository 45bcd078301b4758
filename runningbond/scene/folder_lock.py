"""One process at a time in a folder, without leaving anything in it."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def locked(folder: Path, *, reading: bool = False) -> Iterator[None]:
    """Wait until no other process holds a folder, and hold it.

    The lock lies on the folder itself and ends with its holder, however that comes about. A file system that knows
    no locks gives none; what is written atomically is so without one. `reading` lets other readers in.
    """
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_SH if reading else fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)
