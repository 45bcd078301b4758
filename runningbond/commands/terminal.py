"""Common parts of the commands: exit codes, arguments, tables, a progress bar, and Ctrl-C."""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import get_terminal_size
from typing import Annotated, TypeAlias

from cyclopts import Parameter, Token
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from runningbond.campaigns import INTERRUPTIONS, Interrupted
from runningbond.models import Model
from runningbond.models.costs import estimate
from runningbond.pictures.offscreen import why_not_drawn
from runningbond.pictures.sheet import Sheet
from runningbond.scene import Scene, SceneError
from runningbond.scene.plausibility import warnings

from .narrow import tables_of

DONE, BAD_INPUT, NO_ANSWER, STOPPED = 0, 2, 3, 130
"""Exit codes of every command."""

LONG_RUN = 30.0
"""Expected time of a run [s] from which on it is printed before the run."""

PATIENCE, REFRESH = 2.0, 0.25
"""Seconds until the progress line of a computation first appears, and between two updates."""

INTERVAL = 30.0
"""Least seconds between two lines of progress if standard error is no terminal."""

UNDECIDED = ("undecided", "failed")
"""Statuses of outcomes without an answer."""


def _whole(_: type, tokens: Sequence[Token]) -> int:
    """Read a whole number; cyclopts would round any other."""
    if not tokens[0].value.lstrip("+-").isdecimal():
        raise ValueError(f"{tokens[0].value!r} is not a whole number")
    return int(tokens[0].value)


SceneName: TypeAlias = Annotated[str, Parameter(help="Scene file, or the name of a published scene such as panel-01.")]
Tolerance: TypeAlias = Annotated[float, Parameter(help="Requested relative width of the bracket.")]
Flag: TypeAlias = Annotated[bool, Parameter(negative="")]
Json: TypeAlias = Annotated[bool, Parameter(negative="", help="Print one JSON object and nothing else.")]
Whole: TypeAlias = Annotated[int, Parameter(converter=_whole)]


def check_jobs(jobs: int) -> None:
    """Refuse an invalid number of processes."""
    if jobs == 0 or jobs < -1:
        raise SceneError("--jobs", "must be a number of processes, or -1 for one per core", jobs)


def say(message: str) -> None:
    """Print a line on standard error, unless it is closed."""
    with suppress(OSError):
        print(f"runningbond: {' '.join(message.split())}", file=sys.stderr, flush=True)


def report_interrupt(stopped: Interrupted, total: int, what: str, folder: Path | None, *, fresh: bool = False) -> int:
    """Print why a campaign stopped and how many results are stored, on standard error; returns the exit code."""
    kept = "nothing is kept without --out"
    if folder is not None:
        again = "the same command without --fresh" if fresh else "the same command"
        kept = f"{stopped.campaign.kept} of {total} {what} are kept in {folder}; {again} goes on."
    print(f"{f'runningbond: {stopped.reason}' if stopped.reason else 'Interrupted'}: {kept}", file=sys.stderr)
    if isinstance(stopped.__cause__, OSError):
        return BAD_INPUT
    return NO_ANSWER if stopped.reason else STOPPED


def tell(text: str, *, error: bool = False) -> None:
    """Print to standard output, or to standard error, before results are written.

    If the reader has closed the pipe, as ``head`` does, nothing more is printed, and the command goes on.
    """
    try:
        print(text, file=sys.stderr if error else sys.stdout, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2 if error else 1)


def print_table(sheet: Sheet) -> None:
    """`tell` a table as wide as the terminal, or 180 characters wide if there is none; in parts if it is wider."""
    console = Console(width=None if sys.stdout.isatty() else 180, markup=False, highlight=False)
    with console.capture() as captured:
        for table in tables_of(sheet, console.width):
            console.print(table)
    tell(captured.get().removesuffix("\n"))


def can_draw() -> bool:
    """Whether this machine can draw with VTK; if not, the reason is printed."""
    why_not = why_not_drawn()
    if why_not:
        print(f"runningbond: {why_not}", file=sys.stderr)
    return not why_not


def remarks(scene: Scene) -> tuple[str, ...]:
    """Notes on a scene, such as parts of its drawing that were left out, and warnings about implausible values."""
    return (*(f"note: {line}" for line in scene.notes), *(f"warning: {line}" for line in warnings(scene)))


def print_cost(model: Model, scene: Scene, tolerance: float) -> None:
    """Print the expected time of a long run, on a terminal only."""
    if model.cost is None or not sys.stderr.isatty():
        return
    expected = estimate(model, scene, tolerance)
    if expected.seconds >= LONG_RUN:
        keeps = "what is proved by then" if model.kind in ("bound", "certificate") else "what it has reached by then"
        hint = f"; Ctrl-C leaves {keeps}" if model.interruptible else ""
        print(f"{model.name}: {expected}{hint}", file=sys.stderr, flush=True)


@contextmanager
def progress_bar(description: str, total: int) -> Iterator[Callable[[str], None]]:
    """Show a progress bar with the last case, the number of cases and the time; yields the function to call after each.

    If standard error is no terminal, lines are printed at intervals instead.
    """
    if not sys.stderr.isatty():
        yield _progress_lines(description, total)
        return
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(description, total=total)
        yield lambda done: bar.update(task, advance=1, description=done)


def _progress_lines(description: str, total: int) -> Callable[[str], None]:
    """Print the content of the bar as lines: one at once, at most one per `INTERVAL`, and one at the end."""
    start = told = time.perf_counter()
    count = 0

    def write(done: str, now: float) -> None:
        tell(f"{done}, {count} of {total}, {now - start:.0f} s", error=True)

    def advance(done: str) -> None:
        nonlocal count, told
        count += 1
        now = time.perf_counter()
        if count == total or now - told >= INTERVAL:
            told = now
            write(done, now)

    write(description, start)
    return advance


class Together:
    """Several observers of a run as one."""

    def __init__(self, observers: Sequence[Callable[..., None]]) -> None:
        self.observers = observers

    def __call__(self, *seen: object) -> None:
        """Call all observers."""
        for observer in self.observers:
            observer(*seen)

    def turn_to(self, other: str) -> "Together":
        """Observers for another model that is run for the same answer: those that have ``turn_to``."""
        return Together([observer.turn_to(other) for observer in self.observers if hasattr(observer, "turn_to")])


@contextmanager
def progress_line(name: str, told: Callable[[], str] | None) -> Iterator[None]:
    """Show the time of a computation, and the text of `told`, in a line on the terminal until it is done.

    A thread of its own updates the line; nothing is written if standard error is no terminal.
    """
    if not sys.stderr.isatty():
        yield
        return
    start, done = time.perf_counter(), threading.Event()

    def rewrite() -> None:
        pause = PATIENCE
        while not done.wait(pause):
            line = f"{name} {time.perf_counter() - start:.0f} s{f': {told()}' if told else ''}"
            print(f"\r\x1b[K{line[: get_terminal_size().columns - 1]}", end="", file=sys.stderr, flush=True)
            pause = REFRESH
        if pause == REFRESH:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    # A daemon thread, because it must not delay the exit if Ctrl-C ends a linear program.
    thread = threading.Thread(target=rewrite, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def interruptions(model: Model | None = None) -> list[int]:
    """Handle interruptions from here on; returns a list that collects the signals received.

    A signal is Ctrl-C, or SIGTERM at the end of a scheduler's time limit. After the first, an interruptible model ends
    with what it has found so far. The second ends the program at once, as does the first if the model cannot be
    interrupted. While HiGHS runs, signals take effect only when its linear program is done.
    """
    signals: list[int] = []

    def stop(number: int, frame: object) -> None:
        signals.append(number)
        listen(signal.SIG_DFL)
        if model is not None and sys.stderr.isatty():  # the model may take minutes to end
            told = f"\r\x1b[K{model.name}: ends with what it has by now; Ctrl-C again ends it at once\n"
            with suppress(OSError):
                os.write(2, told.encode())  # print is not reentrant, and a signal may arrive during a print
        raise KeyboardInterrupt

    listen(stop if model is None or model.interruptible else signal.SIG_DFL)
    return signals


def listen(handler: Callable[[int, object], None] | signal.Handlers) -> None:
    """Set the handler of interruptions."""
    for number in INTERRUPTIONS:
        signal.signal(number, handler)
