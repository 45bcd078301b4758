"""What commands share of a terminal: whole numbers as options, a progress bar, and Ctrl-C."""

import signal
from collections.abc import Sequence

from cyclopts import Token
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from runningbond.compare.model import Model


def whole(_: type, tokens: Sequence[Token]) -> int:
    """Read a whole number; cyclopts would round any other."""
    if not tokens[0].value.lstrip("+-").isdecimal():
        raise ValueError(f"{tokens[0].value!r} is no whole number")
    return int(tokens[0].value)


def progress_bar(console: Console) -> Progress:
    """A bar with what is being done, how much of it is, and for how long."""
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=console)


def interruptions(model: Model) -> list[int]:
    """Interruptions by Ctrl-C from here on: a model that can be interrupted ends with what it has found so far.

    A linear program does not look up from its work, and the program ends at once.
    """
    signals: list[int] = []
    if not model.interruptible:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        return signals

    def stop(number: int, frame: object) -> None:
        signals.append(number)
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, stop)
    return signals
