"""What VTK has to say: its errors are raised instead of printed."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .vtk_imports import uninterrupted_imports


class VtkError(Exception):
    """VTK reported an error; the message is its own."""


@contextmanager
def vtk_errors_raised() -> Iterator[None]:
    """Raise the first error that VTK reports inside, once it has been left; warnings pass unheard."""
    with uninterrupted_imports():
        from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    before, window = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    errors: list[str] = []

    def heard(caller: object, event: str, message: str = "") -> None:
        errors.append(message)

    heard.CallDataType = "string0"  # type: ignore[attr-defined]
    listening: Any = window
    listening.AddObserver("ErrorEvent", heard)
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(before)
    if errors:
        raise VtkError(" ".join(errors[0].split()) or "VTK reported an error")
