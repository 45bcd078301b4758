"""Parallel execution of a campaign's tasks: in processes on this machine, or by the joblib backend that is set.

Pictures of a comparison are drawn in processes of this machine, while the process that asked for them goes on.
"""

import multiprocessing
import multiprocessing.resource_tracker
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TypeVar

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky.backend import resource_tracker as loky_tracker
from joblib.externals.loky.process_executor import TerminatedWorkerError

from .tasks import Answer, Task

Result = TypeVar("Result")

POLL_INTERVAL = 1.0
"""Interval at which a process checks that its parent still exists [s]."""


def side_by_side(tasks: Sequence[Task]) -> Iterator[Answer]:
    """Yield answers as they become available, from the joblib backend that is set."""
    # All tasks are dispatched at once, so that workers that join a cluster later get some.
    run = Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="all")
    with _interruptions_held():
        answers = run(delayed(Task.run)(task) for task in tasks)
    yield from answers


@contextmanager
def _interruptions_held() -> Iterator[None]:
    """Block Ctrl-C in processes started in this context: they inherit the signal mask, if the system has one.

    Ctrl-C reaches all processes of a terminal, but the parent is to end the others.
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
    """Yield answers as they become available, from `jobs` processes; −1 for one per core, 1 for this process itself."""
    left = {task.cell: task for task in tasks}
    try:
        with _processes(jobs, len(tasks)):
            for answer in side_by_side(tasks):
                del left[answer.cell]
                yield answer
    except TerminatedWorkerError:
        # A process was killed, it is unknown in which task: the remaining tasks run one by one, the cheapest first.
        for task in reversed(left.values()):
            try:
                with _processes(2, 1):
                    yield from side_by_side([task])
            except TerminatedWorkerError:
                yield task.lost()


@contextmanager
def in_background(calls: Sequence[Callable[[], Result]], jobs: int) -> Iterator[Iterator[Result]]:
    """Start calls in `jobs` processes, as in `in_processes`, and yield an iterator over their results in their order.

    A single call is made in this process, when its result is asked for, as are all calls if `jobs` is 1. Calls whose
    results are not asked for in the context are ended with it.
    """
    with _processes(jobs if len(calls) > 1 else 1, len(calls)):
        run = Parallel(return_as="generator", batch_size=1, pre_dispatch="all")
        with _interruptions_held():
            results = run(delayed(call)() for call in calls)
        try:
            yield _all_results(calls, results)
        finally:
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", ".*tasks (have been|which were)", UserWarning, "joblib")
                results.close()


def _all_results(calls: Sequence[Callable[[], Result]], results: Iterator[Result]) -> Iterator[Result]:
    """Yield results of calls; if a process is killed, the calls left are made in this process."""
    done = 0
    try:
        for result in results:
            done += 1
            yield result
    except TerminatedWorkerError:
        yield from (call() for call in calls[done:])


@contextmanager
def _processes(jobs: int, tasks: int) -> Iterator[None]:
    """Set joblib to run a number of tasks in `jobs` separate processes, or in this process if `jobs` is 1."""
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
            tracker.ensure_running()  # its start unblocks signals that `side_by_side` blocks (loky's until joblib 1.6)
    # More processes than cores or tasks only cost memory. At least 2: with 1, joblib starts no process.
    n_jobs = min(cpu_count() if jobs < 0 else min(jobs, max(2, cpu_count())), max(2, tasks))
    with parallel_config(backend="loky", n_jobs=n_jobs, initializer=partial(begin, os.getpid())), _quiet_kill():
        yield


def begin(parent: int) -> None:
    """Make a new process ignore Ctrl-C, and end when the process with the number `parent` has ended.

    Ctrl-C reaches every process of the terminal, but only the parent should react: it ends the others. If the parent is
    killed it cannot do so, and its processes would continue to the end of their tasks.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: int) -> None:
    """End this process once its parent has changed; on Windows this never happens, as it keeps the parent's number."""
    while os.getppid() == parent:
        time.sleep(POLL_INTERVAL)
    os._exit(1)


@contextmanager
def _quiet_kill() -> Iterator[None]:
    """Suppress the error with which loky's manager thread ends when it has to kill its workers.

    The thread drops the waiting tasks, kills the workers, and then refills their queue with the numbers of the tasks
    that it has just dropped (`add_call_item_to_queue`), which raises a meaningless KeyError.
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
