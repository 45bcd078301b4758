"""Trials of the effect of a fault on a command, each in its own folder."""

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
"""Effects of a fault: the command still completes; finished work is intact and a second call completes the rest; one
line says why the command refuses, and no file is half written; none of these; or the trial needs a separate disk and
cannot mount one."""

PROGRESS = re.compile(r", \d+ of \d+, \d+ s$")


@dataclass(frozen=True)
class Trial:
    """The effect of a fault on a command.

    Parameters
    ----------
    command, fault
        Their names.
    kept
        Number of results that were complete afterwards.
    pieces
        Number of results of an undisturbed command.
    message
        Message of the command.
    code
        Its exit code; minus the signal that killed it.
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
        Place of its folders: one with its inputs, one with the results of an undisturbed call.
    """

    command: Command
    home: Path

    @property
    def prepared(self) -> Path:
        """The folder with the inputs."""
        return self.home / f"{self.command.name}-prepared"

    @property
    def done(self) -> Path:
        """The folder with the results of an undisturbed call."""
        return self.home / f"{self.command.name}-done"

    @cached_property
    def expected(self) -> dict[str, object]:
        """Results of an undisturbed call."""
        return self.command.found(self.done)

    def prepare(self, needed: Path | None = None) -> None:
        """Call the command undisturbed, in a folder with its inputs."""
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
        """Judge a folder after a fault: the work is lost if results differ from those of an undisturbed call."""
        found = self.command.found(folder)
        whole = found.items() <= self.expected.items()
        message = message.replace(str(folder), "OUT")
        said = len(message.splitlines()) <= 1 and "Traceback" not in message
        return Trial(
            self.command.name, fault, len(found), len(self.expected), message, code, verdict if whole and said else LOST
        )

    def does_it_again(self, folder: Path) -> bool:
        """Call the command once more, and return whether all results are there."""
        code, _ = call(self.command.arguments(folder))
        return code == DONE and self.command.found(folder) == self.expected


def call(arguments: Sequence[str]) -> tuple[int, str]:
    """Call a command in this process.

    Returns
    -------
    code, message
        Its exit code, and its message on standard error.
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
    """Message of a command on standard error; if there is none, the last line but one of its output.

    Lines of progress are left out, and the note that this machine draws no pictures.
    """
    lines = [line for line in said.splitlines() if line.strip() and not PROGRESS.search(line)]
    lines = [line for line in lines if "no pictures" not in line]
    return "\n".join(lines or [line.strip() for line in printed.splitlines()[-2:-1]])


def judged(trial: Trial, right: bool) -> Trial:
    """The trial, marked as lost if the requirement does not hold."""
    return trial if right else replace(trial, verdict=LOST)
