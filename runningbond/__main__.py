"""The console command, from its first moment: while the suite is loading, Ctrl-C ends it without a traceback."""

import _thread
import atexit
import os
import signal
import sys
import threading
import warnings
from contextlib import suppress

from runningbond.own_packages import prefer_to_files

MOMENT = 0.02
"""Seconds in which a callback is over."""


def main() -> None:
    """Load the command line and run it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _open_streams()
    sys.unraisablehook = _interrupted_again
    # joblib says at its import where processes cannot share a lock; a campaign says so when it matters.
    warnings.filterwarnings("ignore", ".*joblib will operate in serial mode", UserWarning)
    prefer_to_files()
    from runningbond.commands.command_line import main as run
    from runningbond.commands.terminal import STOPPED

    try:
        run()
    except SystemExit as end:
        if end.code == STOPPED:
            _leave_at_once(STOPPED)
        raise


def _open_streams() -> None:
    """Let streams lead nowhere that were closed when the program was started.

    What is for standard error would come on standard output without, and files be opened under the numbers of both.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:  # whose number is the lowest that is free
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode))


def _interrupted_again(lost: "sys.UnraisableHookArgs") -> None:
    """Interrupt once more where an interruption fell into a callback, as numba has, out of which no error comes."""
    if lost.exc_type is not KeyboardInterrupt:
        sys.__unraisablehook__(lost)
        return

    from runningbond.commands.terminal import interruptions

    def again() -> None:
        if sys.platform == "win32":
            _thread.interrupt_main()
        else:  # which wakes it as well
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    interruptions()
    threading.Timer(MOMENT, again).start()


def _leave_at_once(code: int) -> None:
    """Leave past the ends of libraries, where threads that HiGHS was interrupted in abort the process."""
    if "multiprocessing.process" in sys.modules:
        from multiprocessing import active_children

        for worker in active_children():  # without work, they would be waited for until they leave of themselves
            worker.terminate()
    atexit._run_exitfuncs()  # joblib's workers and folders go
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
