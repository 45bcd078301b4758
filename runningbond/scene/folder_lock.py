"""One process at a time in a folder, without leaving anything in it where the system locks folders."""

import atexit
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import gettempdir
from typing import Any

from .errors import SceneError

fcntl: Any
try:
    import fcntl
except ImportError:  # Windows, where a folder cannot be opened, and a file in it is locked instead
    fcntl = None

LOCK = ".runningbond.lock"


_claims: dict[Path, int] = {}


def claim(folder: Path, key: str) -> None:
    """Have a folder for this process alone until it ends, in which it writes again and again.

    The lock is a file among the temporary ones, so that who reads the folder need not wait, and where there can be none
    nobody is kept out.

    Raises
    ------
    SceneError
        Where another process of this machine has it; under a key, the name of an option.
    """
    at = folder.stat()
    path = Path(gettempdir()) / f"runningbond-{at.st_dev:x}-{at.st_ino:x}.lock"
    if fcntl is None or path in _claims:
        return
    with suppress(OSError):
        handle = _locked_now(path, key, folder)
        while os.fstat(handle).st_nlink == 0:  # who had it before has just taken the file away
            os.close(handle)
            handle = _locked_now(path, key, folder)
        _claims[path] = handle
        atexit.register(_give_back, path, os.getpid())


def _locked_now(path: Path, key: str, folder: Path) -> int:
    """A file, locked by this process; refused where another one has it."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        what = "is written by another process; wait for it, or name another folder"
        raise SceneError(key, what, str(folder)) from None
    return handle


def _give_back(path: Path, owner: int) -> None:
    """Take a lock's file away, if this is the process that made it and no child of it."""
    if os.getpid() == owner:
        path.unlink(missing_ok=True)


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
