"""The tasks of a campaign in processes of this machine, whatever becomes of those."""

import multiprocessing
import multiprocessing.resource_tracker
import signal
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from joblib import cpu_count, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from .tasks import Answer, Task, side_by_side


def in_processes(tasks: Sequence[Task], jobs: int) -> Iterator[Answer]:
    """Answers as they come, from `jobs` processes; −1 is one a core, and 1 this process itself."""
    left = {task.cell: task for task in tasks}
    try:
        with _processes(jobs):
            for answer in side_by_side(tasks):
                del left[answer.cell]
                yield answer
    except TerminatedWorkerError:
        # A process was killed, and nobody says over which task: what is left goes one by one, the cheapest first.
        for task in reversed(left.values()):
            try:
                with _processes(2):
                    yield from side_by_side([task])
            except TerminatedWorkerError:
                yield task.lost()


@contextmanager
def _processes(jobs: int) -> Iterator[None]:
    """Have joblib run tasks in processes of their own, or in this one where there is to be only one."""
    if jobs == 1 or not _can_have_processes():
        with parallel_config(backend="sequential"):
            yield
        return
    multiprocessing.resource_tracker.ensure_running()  # its start unblocks what `side_by_side` blocks
    # More processes than cores gain nothing but memory.
    n_jobs = cpu_count() if jobs < 0 else min(jobs, max(2, cpu_count()))
    with parallel_config(backend="loky", n_jobs=n_jobs, initializer=_leave_interrupts_to_the_parent), _quiet_kill():
        yield


def _can_have_processes() -> bool:
    """Whether this machine lets processes share a lock; some containers have no usable /dev/shm."""
    try:
        multiprocessing.Lock()
    except OSError as error:
        warnings.warn(f"cases run one after another, for processes cannot share a lock: {error}", stacklevel=2)
        return False
    return True


def _leave_interrupts_to_the_parent() -> None:
    """Ctrl-C reaches every process of the terminal; only the parent, which ends the others, has something to say."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def _quiet_kill() -> Iterator[None]:
    """Do not print the error with which loky's manager thread ends when it is told to kill its workers.

    It drops the tasks that wait, kills the workers, and then fills their queue once more, with the numbers of the
    tasks that it has just dropped (`add_call_item_to_queue`): a KeyError that says nothing.
    """
    report = threading.excepthook

    def hook(error: threading.ExceptHookArgs) -> None:
        flags = getattr(error.thread, "executor_flags", None)
        if error.exc_type is not KeyError or not getattr(flags, "kill_workers", False):
            report(error)

    threading.excepthook = hook
    try:
        yield
    finally:
        threading.excepthook = report
