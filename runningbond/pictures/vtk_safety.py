"""Safe use of VTK: signals cannot interrupt its imports, which would crash the process, and its errors are raised."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def uninterrupted_imports() -> Iterator[None]:
    """Defer Ctrl-C and SIGTERM, whose handlers may raise exceptions, until the imports inside are complete."""
    if threading.current_thread() is not threading.main_thread():  # signals arrive only in that thread
        yield
        return
    received: list[int] = []
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    held = {number: handler for number, handler in before.items() if callable(handler)}
    for number in held:
        signal.signal(number, lambda number, _: received.append(number))
    try:
        yield
    finally:
        for number, handler in held.items():
            signal.signal(number, handler)
        if received:
            signal.raise_signal(received[0])


def import_pyvista(*names: str) -> Any:
    """Import PyVista and the given names in it, such as ``Plotter``, and return PyVista."""
    with uninterrupted_imports():
        import pyvista
        import vtkmodules.vtkIOXML  # noqa: F401

        for name in names:  # PyVista imports these at first access
            getattr(pyvista, name)
    return pyvista


class VtkError(Exception):
    """VTK reported an error; the message is VTK's own."""


@contextmanager
def vtk_errors_raised() -> Iterator[None]:
    """Raise the first error that VTK reports inside the context at its end; warnings are ignored."""
    with uninterrupted_imports():
        from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    before, window = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    errors: list[str] = []

    def on_error(caller: object, event: str, message: str = "") -> None:
        errors.append(message)

    on_error.CallDataType = "string0"  # type: ignore[attr-defined]
    observed: Any = window
    observed.AddObserver("ErrorEvent", on_error)
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(before)
    if errors:
        raise VtkError(" ".join(errors[0].split()) or "VTK reported an error")
