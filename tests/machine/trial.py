"""What a fault did to a command: trials of it, each in a folder of its own."""

import io
import re
import shutil
import signal
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from runningbond.commands.command_line import command
from runningbond.commands.terminal import DONE

from .commands import Command, pictures

WHOLE, REDONE, REFUSED, LOST, NOT_TRIED = "whole", "redone", "refused", "lost", "not tried"
"""What may come of a fault: the command does its work all the same; what it had finished is whole, and called again it
does the rest; it says in one line why not, and nothing is half written; none of these; or it needs a disk of its own
here, and may mount none."""

PROGRESS = re.compile(r", \d+ of \d+, \d+ s$")


@dataclass(frozen=True)
class Trial:
    """What a fault did to a command.

    Parameters
    ----------
    command, fault
        Which.
    kept
        Pieces of work that were whole afterwards, of those that an undisturbed command leaves.
    pieces
        Number of the latter.
    message
        What the command said.
    code
        What it left with; minus the signal that killed it.
    verdict
        One of `WHOLE`, `REDONE`, `REFUSED`, `LOST` and `NOT_TRIED`.
    """

    command: str
    fault: str
    kept: int
    pieces: int
    message: str
    code: int
    verdict: str


@dataclass(frozen=True)
class Scratch:
    """A command in a folder of this experiment.

    Parameters
    ----------
    command
        The command.
    home
        Where its folders are: one with what it needs, one in which it has been called undisturbed.
    """

    command: Command
    home: Path

    @property
    def prepared(self) -> Path:
        """The folder with what it needs."""
        return self.home / f"{self.command.name}-prepared"

    @property
    def done(self) -> Path:
        """The folder in which it has been called undisturbed."""
        return self.home / f"{self.command.name}-done"

    @cached_property
    def expected(self) -> dict[str, object]:
        """What it leaves undisturbed."""
        return self.command.found(self.done)

    def prepare(self, needed: Path | None = None) -> None:
        """Call it undisturbed, in a folder with what it needs."""
        self.prepared.mkdir()
        if needed is not None:
            shutil.copytree(needed, self.prepared, dirs_exist_ok=True)
            for picture in pictures(self.prepared):
                (self.prepared / picture).unlink()
        call(self.command.arguments(self.fresh(self.done)))

    def fresh(self, folder: Path) -> Path:
        """Make a folder in which the command can be called."""
        return Path(shutil.copytree(self.prepared, folder))

    def trial(self, fault: str, folder: Path, code: int, message: str, verdict: str) -> Trial:
        """Judge what is in a folder after a fault; it is lost if it is not what an undisturbed command leaves."""
        found = self.command.found(folder)
        whole = found.items() <= self.expected.items()
        message = message.replace(str(folder), "OUT")
        said = len(message.splitlines()) <= 1 and "Traceback" not in message
        return Trial(
            self.command.name, fault, len(found), len(self.expected), message, code, verdict if whole and said else LOST
        )

    def does_it_again(self, folder: Path) -> bool:
        """Call the command once more, and see whether everything is there."""
        code, _ = call(self.command.arguments(folder))
        return code == DONE and self.command.found(folder) == self.expected


def call(arguments: Sequence[str]) -> tuple[int, str]:
    """Call a command in this process.

    Returns
    -------
    code, message
        What it leaves with, and what it says last on standard error.
    """
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    said = io.StringIO()
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(said):
            code = command(arguments)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return code, message_of(said.getvalue())


def message_of(said: str, printed: str = "") -> str:
    """What a command says on standard error; where that is nothing, the last line but one that it prints.

    Lines of progress are left out, and that there are no pictures from this machine.
    """
    lines = [line for line in said.splitlines() if line.strip() and not PROGRESS.search(line)]
    lines = [line for line in lines if "no pictures" not in line]
    return "\n".join(lines or [line.strip() for line in printed.splitlines()[-2:-1]])


def judged(trial: Trial, right: bool) -> Trial:
    """The trial, as lost if what was asked for is not right."""
    return trial if right else replace(trial, verdict=LOST)
