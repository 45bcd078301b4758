"""VTK's modules import one another, and crash the process where an exception breaks that off."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def whole_imports() -> Iterator[None]:
    """Hold back Ctrl-C, and what else raises an exception at a signal, until what is imported inside is there."""
    if threading.current_thread() is not threading.main_thread():  # where no signal is heard
        yield
        return
    heard: list[int] = []
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    held = {number: handler for number, handler in before.items() if callable(handler)}
    for number in held:
        signal.signal(number, lambda number, _: heard.append(number))
    try:
        yield
    finally:
        for number, handler in held.items():
            signal.signal(number, handler)
        if heard:
            signal.raise_signal(heard[0])


def import_pyvista() -> None:
    """Import all that pictures are drawn with."""
    with whole_imports():
        import pyvista
        import vtkmodules.vtkIOXML  # noqa: F401

        _ = pyvista.Plotter  # which imports most of it
