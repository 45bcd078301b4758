"""VTK's modules import one another, and crash the process where Ctrl-C breaks that off."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def whole_imports() -> Iterator[None]:
    """Hold Ctrl-C back until what is imported inside is there."""
    if threading.current_thread() is not threading.main_thread():  # where Ctrl-C is not heard
        yield
        return
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if heard:
            signal.raise_signal(signal.SIGINT)


def import_pyvista() -> None:
    """Import all that pictures are drawn with."""
    with whole_imports():
        import pyvista
        import vtkmodules.vtkIOXML  # noqa: F401

        _ = pyvista.Plotter  # which imports most of it
