"""Campaigns: every model on every scene, one process a case, each result kept as soon as it is there.

Processes and the workers of a cluster compute and hand over; the campaign alone reads and writes its folder.
"""

import multiprocessing
import signal
import threading
import warnings
from collections.abc import Callable, Container, Generator, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from runningbond.results import Outcome, StoreError, load_outcome, save_outcome
from runningbond.scene import Scene, SceneError

from .fingerprint import fingerprint
from .models import MODELS, TOLERANCE, check_model, check_tolerance, run_model

Cell: TypeAlias = tuple[str, str]
"""Name of a scene and of a model."""


@dataclass(frozen=True)
class Answer:
    """What one model said of one scene: an outcome, or why it says nothing.

    Parameters
    ----------
    cell
        Of what.
    outcome
        The outcome; None where the model does not apply.
    reason
        Why it does not apply.
    key
        Fingerprint of what the outcome was computed from, taken where that was done.
    reused
        Whether it was found and not computed.
    """

    cell: Cell
    outcome: Outcome | None
    reason: str = ""
    key: str = ""
    reused: bool = False


@dataclass
class Campaign:
    """What a campaign has so far.

    Parameters
    ----------
    outcomes
        Outcome of each cell.
    inapplicable
        Why a model says nothing about a scene.
    reused
        Cells whose outcome was found in the folder.
    """

    outcomes: dict[Cell, Outcome] = field(default_factory=dict)
    inapplicable: dict[Cell, str] = field(default_factory=dict)
    reused: set[Cell] = field(default_factory=set)

    def __len__(self) -> int:
        return len(self.outcomes) + len(self.inapplicable)

    @property
    def kept(self) -> int:
        """Number of outcomes that are in the folder."""
        return sum(outcome.status != "failed" for outcome in self.outcomes.values())

    def add(self, answer: Answer) -> None:
        """Take in an answer."""
        if answer.outcome is None:
            self.inapplicable[answer.cell] = answer.reason
        else:
            self.outcomes[answer.cell] = answer.outcome
        if answer.reused:
            self.reused.add(answer.cell)

    def only(self, names: Container[str]) -> "Campaign":
        """The part of it that is about some scenes."""
        return Campaign({cell: outcome for cell, outcome in self.outcomes.items() if cell[0] in names})


class ClusterError(Exception):
    """A cluster that does not do what it is asked; the message says why."""


class Interrupted(Exception):
    """A campaign that stopped before its end; what it has is in the folder.

    Parameters
    ----------
    campaign
        What there is.
    reason
        Why it stopped, if not by Ctrl-C.
    """

    def __init__(self, campaign: Campaign, reason: str = "") -> None:
        super().__init__(reason or "interrupted")
        self.campaign = campaign
        self.reason = reason


def run_campaign(
    scenes: Mapping[str, Scene],
    models: Sequence[str] = tuple(MODELS),
    *,
    folder: Path,
    tolerance: float = TOLERANCE,
    jobs: int = -1,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Cell], None] = lambda cell: None,
) -> Campaign:
    """Run models on scenes.

    Parameters
    ----------
    scenes
        Scenes by name.
    models
        Names of models.
    folder
        Where outcomes are kept, as ``folder/scene/model/``. A whole outcome computed from the same scene,
        tolerance and code is reused.
    tolerance
        Relative width of the bracket asked for.
    jobs
        Number of processes; −1 is one a core.
    cluster
        Address of a Dask scheduler, or its file: cases go to its workers, which share no folder with this process.
    fresh
        Compute everything again.
    progress
        Called with each cell that is done.

    Raises
    ------
    Interrupted
        On Ctrl-C, where the folder takes no more or the cluster is lost, with what there is. Running the same
        campaign again goes on from there.
    """
    for model in models:
        check_model(model, "--models")
    check_tolerance(tolerance)
    largest_first = sorted(scenes, key=lambda name: -len(scenes[name].blocks))
    # Dear models stand last in the registry; started first, they do not leave one process working alone.
    cells = [(name, model) for model in reversed(models) for name in largest_first]
    campaign = Campaign()
    try:
        with warnings.catch_warnings():
            # What is left undone is told by `Interrupted`.
            warnings.filterwarnings("ignore", ".*tasks (have been|which were)", UserWarning, "joblib")
            with closing(_answers(cells, scenes, folder, tolerance, jobs, cluster, fresh)) as answers:
                for answer in answers:
                    _keep(answer, scenes[answer.cell[0]], folder)
                    campaign.add(answer)
                    progress(answer.cell)
    except KeyboardInterrupt:
        raise Interrupted(campaign) from None
    except ClusterError as error:
        raise Interrupted(campaign, f"the cluster failed: {error}") from error
    except OSError as error:
        raise Interrupted(campaign, f"{error.filename or folder}: {error.strerror or error}") from error
    return campaign


def _keep(answer: Answer, scene: Scene, folder: Path) -> None:
    """Write a new outcome; a failure is tried again, perhaps by better code."""
    if answer.outcome is not None and answer.outcome.status != "failed" and not answer.reused:
        save_outcome(answer.outcome, folder.joinpath(*answer.cell), answer.key, scene)


def _find(cell: Cell, scene: Scene, folder: Path, tolerance: float) -> Answer | None:
    """The answer that a folder holds, if it is of this very scene, tolerance and code."""
    key = fingerprint(scene, cell[1], tolerance)
    try:
        outcome, stored_key = load_outcome(folder.joinpath(*cell))
    except StoreError:
        return None
    return Answer(cell, outcome, key=key, reused=True) if stored_key == key else None


def _answers(
    cells: Sequence[Cell],
    scenes: Mapping[str, Scene],
    folder: Path,
    tolerance: float,
    jobs: int,
    cluster: str | None,
    fresh: bool,
) -> Generator[Answer]:
    """Answers that are there, then those that are found, as they come."""
    missing = []
    for cell in cells:
        found = None if fresh else _find(cell, scenes[cell[0]], folder, tolerance)
        if found is None:
            missing.append(cell)
        else:
            yield found
    if missing and cluster is not None:
        yield from _on_cluster(missing, scenes, tolerance, cluster)
    elif missing:
        yield from _in_processes(missing, scenes, tolerance, jobs)


def _on_cluster(cells: Sequence[Cell], scenes: Mapping[str, Scene], tolerance: float, cluster: str) -> Iterator[Answer]:
    from .cluster import on_cluster

    with on_cluster(cluster, given_up=_lost):
        for answer in _side_by_side(cells, scenes, tolerance):
            name, model = answer.cell
            if answer.key not in ("", fingerprint(scenes[name], model, tolerance)):
                raise ClusterError("a worker has other sources or libraries than this process; install the same")
            yield answer


def _in_processes(cells: Sequence[Cell], scenes: Mapping[str, Scene], tolerance: float, jobs: int) -> Iterator[Answer]:
    """Answers as they come, whatever becomes of the processes that find them."""
    left = dict.fromkeys(cells)
    try:
        with _processes(jobs):
            for answer in _side_by_side(cells, scenes, tolerance):
                del left[answer.cell]
                yield answer
    except TerminatedWorkerError:
        # A process was killed, and nobody says over which case: what is left goes one by one, the cheapest first.
        for cell in reversed(list(left)):
            try:
                with _processes(2):
                    yield from _side_by_side([cell], scenes, tolerance)
            except TerminatedWorkerError:
                yield _lost(cell, scenes[cell[0]])


def _processes(jobs: int) -> parallel_config:
    """Where tasks run: in processes of their own, or in this one where there is to be only one."""
    if jobs == 1 or not _can_have_processes():
        return parallel_config(backend="sequential")
    # More processes than cores gain nothing but memory.
    n_jobs = cpu_count() if jobs < 0 else min(jobs, max(2, cpu_count()))
    return parallel_config(backend="loky", n_jobs=n_jobs, initializer=_leave_interrupts_to_the_parent)


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


def _side_by_side(cells: Sequence[Cell], scenes: Mapping[str, Scene], tolerance: float) -> Iterator[Answer]:
    """Answers as they come, from wherever joblib has been told to send its tasks."""
    tasks = (delayed(_run_cell)(cell, scenes[cell[0]], tolerance) for cell in cells)
    # All of them at once, for the sake of workers that join a cluster later.
    yield from Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="all")(tasks)


_ONE_AT_A_TIME = threading.Lock()


def _run_cell(cell: Cell, scene: Scene, tolerance: float) -> Answer:
    """Run one model on one scene; called in a process of its own.

    A worker with several threads runs one case after the other: gmsh and the threads of linear algebra are there
    once a process.
    """
    key = fingerprint(scene, cell[1], tolerance)
    try:
        with _ONE_AT_A_TIME:
            return Answer(cell, run_model(cell[1], scene, tolerance), key=key)
    except SceneError as reason:
        return Answer(cell, None, str(reason), key)


def _lost(cell: Cell, scene: Scene, *_: object) -> Answer:
    """What is said of a case over which processes were killed."""
    return Answer(cell, Outcome(scene.title, cell[1], "failed", message="its process was killed (memory?)"))
