"""One process at a time in a folder, without leaving anything in it."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def alone(folder: Path, *, reading: bool = False) -> Iterator[None]:
    """Wait until nobody else is at work in a folder, and keep others waiting.

    The lock lies on the folder itself and ends with its holder, however that comes about. A file system that knows
    no locks gives none, and what is written whole is still written whole.

    Parameters
    ----------
    folder
        The folder.
    reading
        Only writers are kept waiting, and not other readers.
    """
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_SH if reading else fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)
