"""The tasks of a campaign side by side: in processes of this machine, or wherever joblib has been set to send them."""

import multiprocessing
import multiprocessing.resource_tracker
import os
import signal
import threading
import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky.backend import resource_tracker as loky_tracker
from joblib.externals.loky.process_executor import TerminatedWorkerError

from .tasks import Answer, Task

PATIENCE = 1.0
"""Seconds after which a process looks whether its parent is still there."""


def side_by_side(tasks: Sequence[Task]) -> Iterator[Answer]:
    """Answers as they come, from wherever joblib has been set to send its tasks."""
    # All of them at once, for the sake of workers that join a cluster later.
    run = Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="all")
    with _interruptions_held():
        answers = run(delayed(Task.run)(task) for task in tasks)
    yield from answers


@contextmanager
def _interruptions_held() -> Iterator[None]:
    """Hold Ctrl-C back from processes that start, which inherit the mask, where the system knows masks.

    It reaches all of a terminal's processes, and the parent ends the others.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def in_processes(tasks: Sequence[Task], jobs: int) -> Iterator[Answer]:
    """Answers as they come, from `jobs` processes; −1 is one a core, and 1 this process itself."""
    left = {task.cell: task for task in tasks}
    try:
        with _processes(jobs, len(tasks)):
            for answer in side_by_side(tasks):
                del left[answer.cell]
                yield answer
    except TerminatedWorkerError:
        # A process was killed, over which task is not said: what is left goes one by one, the cheapest first.
        for task in reversed(left.values()):
            try:
                with _processes(2, 1):
                    yield from side_by_side([task])
            except TerminatedWorkerError:
                yield task.lost()


@contextmanager
def _processes(jobs: int, tasks: int) -> Iterator[None]:
    """Have joblib run some tasks in processes of their own, or in this one where there is to be only one."""
    if jobs != 1:
        try:
            multiprocessing.Lock()
        except OSError as error:  # some containers have no usable /dev/shm
            warnings.warn(f"cases run one after another, for processes cannot share a lock: {error}", stacklevel=2)
            jobs = 1
    if jobs == 1:
        with parallel_config(backend="sequential"):
            yield
        return
    if hasattr(signal, "pthread_sigmask"):
        for tracker in (multiprocessing.resource_tracker, loky_tracker):
            tracker.ensure_running()  # its start unblocks what `side_by_side` blocks (loky's until joblib 1.6)
    # More processes than cores or tasks take memory and gain nothing; joblib takes one for none.
    n_jobs = min(cpu_count() if jobs < 0 else min(jobs, max(2, cpu_count())), max(2, tasks))
    with parallel_config(backend="loky", n_jobs=n_jobs, initializer=partial(begin, os.getpid())), _quiet_kill():
        yield


def begin(parent: int) -> None:
    """Leave what ends a process that has just started to its parent, of that number; end with it, however it ends.

    Ctrl-C reaches every process of the terminal; only the parent, which ends the others, has something to say. One
    that is killed says nothing, and its processes would go on to the end of their tasks.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: int) -> None:
    """End this process once it has another parent; on Windows it keeps the number of the one it had."""
    while os.getppid() == parent:
        time.sleep(PATIENCE)
    os._exit(1)


@contextmanager
def _quiet_kill() -> Iterator[None]:
    """Do not print the error with which loky's manager thread ends when it is to kill its workers.

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
