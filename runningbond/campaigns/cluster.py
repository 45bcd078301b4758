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
PATIENCE = 30  # seconds in which a scheduler must answer and have a worker


class TaskBackend(DaskDistributedBackend):  # type: ignore[misc]
    """joblib's backend, which would wait for ever for what a cluster gives up, and not send to one that has one core.

    A task over which one worker after the other was killed is answered as lost.
    """

    def effective_n_jobs(self, n_jobs: int) -> int:
        """Say how many tasks run at once; where that is one, joblib computes in the process that asks."""
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
        """Take in what came back: results, or why there are none."""
        if isinstance(out, CancelledError):
            raise ClusterError("the connection to its scheduler is lost")
        if isinstance(out, BaseException):
            raise ClusterError(" ".join(f"{type(out).__name__}: {out}".split()))
        return super().retrieve_result_callback(out)


def scheduler_address(where: str) -> str:
    """The address of a scheduler, by itself or by the file that it has written; a `SceneError` for what is neither."""
    try:
        address = json.loads(Path(where).read_bytes())["address"] if Path(where).is_file() else where
        if ":" not in address:  # no port: a client would try for a minute to go there, and another to give that up
            raise ValueError(address)
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise SceneError("--cluster", NEITHER, where) from error
    return str(address)


def on_cluster(tasks: Sequence[Task], where: str) -> Iterator[Answer]:
    """Answers as they come, from a cluster by its scheduler's address or file; a `SceneError` if it has no worker."""
    keys = {task.cell: task.key() for task in tasks}
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # its messages are reported here, in a line
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
