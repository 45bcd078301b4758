"""The console command, from its first moment: while the suite is loading, Ctrl-C ends it without a traceback."""

import signal
import warnings


def main() -> None:
    """Load the command line and run it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # joblib says at its import where processes cannot share a lock; a campaign says so when it matters.
    warnings.filterwarnings("ignore", ".*joblib will operate in serial mode", UserWarning)
    from runningbond.commands.command_line import main as run

    run()


if __name__ == "__main__":
    main()
