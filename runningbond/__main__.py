"""Entry point of the console command; Ctrl-C ends it without a traceback even while the suite is loading."""

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
"""Time after which a callback has returned [s]."""


def main() -> None:
    """Load the command line and run it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _open_streams()
    sys.unraisablehook = _interrupted_again
    # joblib warns on import if processes cannot share a lock; a campaign reports it when it matters.
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
    """Connect streams that were closed when the program was started to the null device.

    Otherwise standard error would go to standard output, and files would be opened under the descriptors of both.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:  # its descriptor is the lowest free one
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode))


def _interrupted_again(lost: "sys.UnraisableHookArgs") -> None:
    """Interrupt again if an interruption was raised in a callback, such as numba's, that swallows exceptions."""
    if lost.exc_type is not KeyboardInterrupt:
        sys.__unraisablehook__(lost)
        return

    from runningbond.commands.terminal import interruptions

    def again() -> None:
        if sys.platform == "win32":
            _thread.interrupt_main()
        else:  # a signal also wakes the main thread
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    interruptions()
    threading.Timer(MOMENT, again).start()


def _leave_at_once(code: int) -> None:
    """Exit without the static destructors of libraries, in which interrupted threads of HiGHS abort the process."""
    if "multiprocessing.process" in sys.modules:
        from multiprocessing import active_children

        for worker in active_children():  # idle workers would be waited for until they time out
            worker.terminate()
    atexit._run_exitfuncs()  # removes joblib's workers and folders
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
