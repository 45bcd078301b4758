"""Imports of VTK that no signal interrupts: an exception in the midst of them crashes the process."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def uninterrupted_imports() -> Iterator[None]:
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


def import_pyvista(*names: str) -> Any:
    """Import PyVista with what is needed of it, such as its ``Plotter``, and return it."""
    with uninterrupted_imports():
        import pyvista
        import vtkmodules.vtkIOXML  # noqa: F401

        for name in names:  # imported by PyVista when they are first asked for
            getattr(pyvista, name)
    return pyvista
