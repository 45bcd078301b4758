"""Faults: signals, a second command in the same folder, damaged files."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from runningbond.commands.terminal import BAD_INPUT, DONE, STOPPED

from .commands import RENDER, Command
from .trial import REDONE, REFUSED, WHOLE, Scratch, Trial, call, judged, message_of

PATIENCE = 120.0
"""Time within which a command must have started to write, or end [s]."""


@contextmanager
def started(command: Command, folder: Path) -> Iterator["subprocess.Popen[str]"]:
    """Start a command in its own process group, and wait until it is in the middle of its work."""
    line = [sys.executable, "-m", "runningbond", *command.arguments(folder)]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    try:
        deadline = time.monotonic() + PATIENCE
        while not command.begun(folder) and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        yield process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)


def interrupt(scratch: Scratch, folder: Path, how: signal.Signals, fault: str) -> Trial:
    """Send a signal to a running command, and call the command again."""
    with started(scratch.command, scratch.fresh(folder)) as process:
        os.killpg(process.pid, how)
        printed, said = process.communicate(timeout=PATIENCE)
    code = process.returncode
    right = code == (STOPPED if how == signal.SIGINT else -how)
    trial = scratch.trial(fault, folder, code, message_of(said, printed), REDONE)
    return judged(trial, right and scratch.does_it_again(folder))


def at_once(scratch: Scratch, folder: Path) -> Trial:
    """Call a command in a folder where another one is running."""
    with started(scratch.command, scratch.fresh(folder)) as process:
        code, message = call(scratch.command.arguments(folder))
        _, said = process.communicate(timeout=PATIENCE)
    is_whole = process.returncode == DONE and scratch.command.found(folder) == scratch.expected
    if scratch.command.is_alone:
        return judged(scratch.trial("two at once", folder, code, message, REFUSED), is_whole and code == BAD_INPUT)
    code, message = max((code, message), (process.returncode, message_of(said)))
    return judged(scratch.trial("two at once", folder, code, message, WHOLE), is_whole and code == DONE)


def damage(scratch: Scratch, folder: Path) -> Trial:
    """Damage the results or inputs of a command, and call it again."""
    scratch.fresh(folder)
    call(scratch.command.arguments(folder))
    scratch.command.damage(folder)
    code, message = call(scratch.command.arguments(folder))
    if scratch.command is RENDER:  # it renders results of other commands
        return judged(scratch.trial("damaged result", folder, code, message, REFUSED), code == BAD_INPUT)
    trial = scratch.trial("damaged result", folder, code, message, REDONE)
    return judged(trial, code == DONE and scratch.command.found(folder) == scratch.expected)
