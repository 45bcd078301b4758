"""The console command, from its first moment: while the suite is loading, Ctrl-C ends it without a traceback."""

import signal


def main() -> None:
    """Load the command line and run it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    from runningbond.commands.command_line import main as run

    run()


if __name__ == "__main__":
    main()
