"""A silent gmsh session that is closed even after an error."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from runningbond.scene import SceneError


@contextmanager
def gmsh_session() -> Iterator[Any]:
    """Yield the gmsh module, initialised with an empty model; the session is closed afterwards.

    Raises
    ------
    SceneError
        If the libraries that gmsh needs are missing, or if the caller has a gmsh session open, which would be closed
        together with this one.
    """
    try:
        import gmsh
    except OSError as error:
        remedy = f"cannot be loaded ({error}); tools/system-libraries installs what it needs"
        raise SceneError("gmsh", remedy) from error
    if gmsh.isInitialized():
        raise SceneError("gmsh", "has a session open; call gmsh.finalize() before meshing")
    # Not interruptible, or gmsh would take Ctrl-C from Python for good. The replaced SIGTERM handler is restored.
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
