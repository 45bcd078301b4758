"""Campaigns: every model on every scene, one process a task, each outcome kept as soon as it is there.

Processes and the workers of a cluster compute and hand over; the campaign alone reads and writes its folder.
"""

import warnings
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from numbers import Integral
from pathlib import Path

from runningbond.models import MODELS, TOLERANCE, Model, check_tolerance, find_model
from runningbond.results import Outcome, StoreError, load_outcome, save_outcome
from runningbond.scene import Scene, SceneError

from .tasks import Answer, Cell, ClusterError, Task


@dataclass
class Campaign:
    """What a campaign has so far."""

    outcomes: dict[Cell, Outcome] = field(default_factory=dict)
    inapplicable: dict[Cell, str] = field(default_factory=dict)  # why a model does not apply to a scene
    reused: set[Cell] = field(default_factory=set)  # whose outcome was in the folder

    def __len__(self) -> int:
        return len(self.outcomes) + len(self.inapplicable)

    @property
    def kept(self) -> int:
        """Number of outcomes that are in the folder."""
        return sum(outcome.status != "failed" for outcome in self.outcomes.values())


class Interrupted(Exception):
    """A campaign that stopped before its end, for a reason if not by Ctrl-C; what it has is in the folder."""

    def __init__(self, campaign: Campaign, reason: str = "") -> None:
        super().__init__(reason or "interrupted")
        self.campaign, self.reason = campaign, reason


@contextmanager
def ctrl_c_passed_on() -> Iterator[None]:
    """Raise KeyboardInterrupt, as scripts expect it, for a campaign that Ctrl-C has `Interrupted`."""
    try:
        yield
    except Interrupted as stopped:
        if stopped.reason:
            raise
        raise KeyboardInterrupt from None


def run_campaign(
    scenes: Mapping[str, Scene],
    models: Sequence[str | Model] | None = None,
    *,
    folder: Path | None,
    tolerance: float = TOLERANCE,
    jobs: int = -1,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Cell], None] = lambda cell: None,
) -> Campaign:
    """Run models, all of `MODELS` where none is named, on scenes by name; parameters and errors as of `run_tasks`."""
    chosen = [find_model(model, "models") for model in models or MODELS]
    check_tolerance(tolerance)
    largest_first = sorted(scenes, key=lambda name: -len(scenes[name].blocks))
    # Dear models stand last in the registry; started first, they do not leave one process working alone.
    tasks = [Task(name, scenes[name], model, tolerance) for model in reversed(chosen) for name in largest_first]
    return run_tasks(tasks, folder=folder, jobs=jobs, cluster=cluster, fresh=fresh, progress=progress)


def run_tasks(
    tasks: Sequence[Task],
    *,
    folder: Path | None,
    jobs: int = -1,
    cluster: str | None = None,
    fresh: bool = False,
    progress: Callable[[Cell], None] = lambda cell: None,
) -> Campaign:
    """Run tasks, each cell one, in their order.

    Parameters
    ----------
    folder
        Where outcomes are kept, as ``folder/scene/model/``. A whole one of the same scene, tolerance and code is
        reused, unless all are asked for `fresh`. None keeps nothing.
    jobs
        Number of processes; −1 is one a core.
    cluster
        Address of a Dask scheduler, or its file: tasks go to its workers, which share no folder with this process.
    progress
        Called with each cell that is done.

    Raises
    ------
    SceneError
        For a number of processes that is none.
    Interrupted
        On Ctrl-C, where the folder takes no more or the cluster is lost, with what there is; the same tasks go on
        from there.
    """
    if isinstance(jobs, bool) or not isinstance(jobs, Integral) or jobs == 0:
        raise SceneError("jobs", "must be a number of processes, or -1 for one a core", jobs)
    campaign = Campaign()
    scenes = {task.cell: task.scene for task in tasks}
    try:
        with warnings.catch_warnings(), closing(_answers(tasks, None if fresh else folder, jobs, cluster)) as answers:
            # `Interrupted` says what is left undone, and a worker that has grown large is replaced without a word.
            warnings.filterwarnings("ignore", ".*(tasks (have been|which were)|worker stopped)", UserWarning, "joblib")
            for answer in answers:
                cell, outcome = answer.cell, answer.outcome
                if outcome is None:
                    campaign.inapplicable[cell] = answer.reason
                elif answer.reused:
                    campaign.reused.add(cell)
                elif folder is not None and outcome.status != "failed":  # which is tried again, perhaps by better code
                    save_outcome(outcome, folder.joinpath(*cell), answer.key, scenes[cell])
                if outcome is not None:
                    campaign.outcomes[cell] = outcome
                progress(cell)
    except KeyboardInterrupt:
        raise Interrupted(campaign) from None
    except ClusterError as error:
        raise Interrupted(campaign, f"the cluster failed: {error}") from error
    except OSError as error:
        raise Interrupted(campaign, f"{error.filename or folder or 'campaign'}: {error.strerror or error}") from error
    return campaign


def _answers(tasks: Sequence[Task], folder: Path | None, jobs: int, cluster: str | None) -> Generator[Answer]:
    """Answers that a folder holds, if one is given, then those that are computed, as they come."""
    missing = []
    for task in tasks:
        try:
            outcome, key = (None, "") if folder is None else load_outcome(folder.joinpath(*task.cell))
        except StoreError:
            outcome, key = None, ""
        if outcome is not None and key == task.key():  # of this very scene, tolerance and code
            yield Answer(task.cell, outcome, key=key, reused=True)
        else:
            missing.append(task)
    if missing and cluster is not None:
        from .cluster import on_cluster  # Dask is not always installed

        yield from on_cluster(missing, cluster)
    elif missing:
        from .processes import in_processes  # joblib is slow to load, and nothing else needs it

        yield from in_processes(missing, jobs)
