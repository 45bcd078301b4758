"""What Ctrl-C does to a run."""

import signal

from runningbond.compare.models import IN_MOTION


def interruptions(model: str) -> list[int]:
    """Interruptions by Ctrl-C from here on: a run of blocks in motion ends with what it has found so far.

    A linear program does not look up from its work, and the program ends at once.
    """
    found: list[int] = []
    if model not in IN_MOTION:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        return found

    def stop(number: int, frame: object) -> None:
        found.append(number)
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, stop)
    return found
