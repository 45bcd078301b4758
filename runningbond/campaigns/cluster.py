"""The tasks of a campaign on a Dask cluster, through joblib's backend for it."""

import json
import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from pathlib import Path
from typing import Any

from distributed import Client, KilledWorker
from joblib import parallel_config
from joblib._dask import DaskDistributedBackend

from runningbond.scene import SceneError

from .processes import side_by_side
from .tasks import Answer, ClusterError, Task

NEITHER = "is neither the address of a Dask scheduler nor its file"
PATIENCE = 30  # seconds within which a scheduler must answer, and have a worker


class TaskBackend(DaskDistributedBackend):  # type: ignore[misc]
    """joblib's Dask backend, extended to report tasks that the cluster gives up, and to use clusters with one core.

    joblib's own would wait forever for such tasks. A task whose workers were killed in turn is answered as lost.
    """

    def effective_n_jobs(self, n_jobs: int) -> int:
        """Number of tasks that run at once, at least 2: for 1, joblib would compute in the calling process."""
        return max(2, int(super().effective_n_jobs(n_jobs)))

    def submit(self, func: Any, callback: Callable[[Any], None]) -> Any:
        """Send tasks to the cluster."""

        def give_up(done: Any) -> None:
            error = done.exception()
            if isinstance(error, KilledWorker):
                callback([task.lost() for _, (task,), _ in func.items])
            elif error is not None:
                callback(error)

        sent = super().submit(func, callback)
        sent.add_done_callback(give_up)
        return sent

    def retrieve_result_callback(self, out: Any) -> Any:
        """Return the results that came back, or raise the error that came instead."""
        if isinstance(out, CancelledError):
            raise ClusterError("the connection to its scheduler is lost")
        if isinstance(out, BaseException):
            raise ClusterError(" ".join(f"{type(out).__name__}: {out}".split()))
        return super().retrieve_result_callback(out)


def scheduler_address(where: str) -> str:
    """Address of a scheduler, given as an address or as the scheduler's file; a `SceneError` if it is neither."""
    try:
        address = json.loads(Path(where).read_bytes())["address"] if Path(where).is_file() else where
        if ":" not in address:  # no port: a client would try to connect for a minute, and need another to give up
            raise ValueError(address)
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise SceneError("--cluster", NEITHER, where) from error
    return str(address)


def on_cluster(tasks: Sequence[Task], where: str) -> Iterator[Answer]:
    """Yield answers from the cluster whose scheduler's address or file is `where`; a `SceneError` without a worker."""
    keys = {task.cell: task.key() for task in tasks}
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # errors are reported here, in one line
    address = scheduler_address(where)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise SceneError("--cluster", NEITHER, where) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            message = f"has no worker after {PATIENCE} s; start some, one thread each"
            raise SceneError("--cluster", message, where) from error
        with parallel_config(backend=TaskBackend(client=client)):
            for answer in side_by_side(tasks):
                if answer.key not in ("", keys[answer.cell]):
                    raise ClusterError("a worker has other sources or libraries than this process; install the same")
                yield answer
