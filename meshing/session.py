"""A session of gmsh, opened quietly and closed whatever happens."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from runningbond.scene import SceneError


@contextmanager
def gmsh_session() -> Iterator[Any]:
    """Give the gmsh module, started with an empty model; nothing of it is left afterwards.

    Raises
    ------
    SceneError
        Where the libraries that gmsh needs are missing, or the caller has a session of its own open,
        which would end with this one.
    """
    try:
        import gmsh
    except OSError as error:
        remedy = f"cannot be loaded ({error}); tools/system-libraries installs what it needs"
        raise SceneError("gmsh", remedy) from error
    if gmsh.isInitialized():
        raise SceneError("gmsh", "has a session open; call gmsh.finalize() before meshing")
    # Not interruptible: gmsh would otherwise take Ctrl-C from Python for good. It takes SIGTERM all the same.
    listener = signal.getsignal(signal.SIGTERM)
    gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False, interruptible=False)
    if threading.current_thread() is threading.main_thread() and listener is not None:
        signal.signal(signal.SIGTERM, listener)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("wall")
        yield gmsh
    finally:
        gmsh.finalize()
