"""Locks that let one process at a time use a folder; no file is left in it if the system can lock folders."""

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
except ImportError:  # Windows cannot open a folder, so a file in it is locked instead
    fcntl = None

LOCK = ".runningbond.lock"


_claims: dict[Path, int] = {}


def claim(folder: Path, key: str) -> None:
    """Reserve a folder until this process ends, so that no other process writes into it.

    The lock is on a file in the system's temporary folder, so that processes that only read the folder need not wait.
    On Windows, and if this file cannot be made or locked, other processes are not kept out.

    Raises
    ------
    SceneError
        If another process on this machine has claimed the folder; `key` is the name of the option to be reported.
    """
    at = folder.stat()
    path = Path(gettempdir()) / f"runningbond-{at.st_dev:x}-{at.st_ino:x}.lock"
    if fcntl is None or path in _claims:
        return
    with suppress(OSError):
        handle = _locked_now(path, key, folder)
        while os.fstat(handle).st_nlink == 0:  # its previous owner has just deleted the file
            os.close(handle)
            handle = _locked_now(path, key, folder)
        _claims[path] = handle
        atexit.register(_give_back, path, os.getpid())


def _locked_now(path: Path, key: str, folder: Path) -> int:
    """Open and lock a file without waiting; raises a `SceneError` if another process has locked it."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        what = "is written by another process; wait for it, or name another folder"
        raise SceneError(key, what, str(folder)) from None
    return handle


def _give_back(path: Path, owner: int) -> None:
    """Delete a lock's file if this is the process that made it, not a child of that process."""
    if os.getpid() == owner:
        path.unlink(missing_ok=True)


@contextmanager
def locked(folder: Path, *, reading: bool = False) -> Iterator[None]:
    """Wait until no other process has locked a folder, and lock it.

    The lock is on the folder itself or, on Windows, on a file in it; it ends with the `with` block, or when the process
    crashes. On a file system without locks nothing is locked; atomic writes are safe without a lock. With `reading`,
    other readers are let in, except on Windows.
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
