"""Campaigns: every model on every scene, with parallel tasks; each outcome is saved as soon as it is available.

Processes and the workers of a cluster compute and return outcomes; only the campaign reads and writes its folder.
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
    """Results of a campaign so far."""

    outcomes: dict[Cell, Outcome] = field(default_factory=dict)
    inapplicable: dict[Cell, str] = field(default_factory=dict)  # why a model does not apply to a scene
    reused: set[Cell] = field(default_factory=set)  # cells whose outcome was read from the folder

    def __len__(self) -> int:
        return len(self.outcomes) + len(self.inapplicable)

    @property
    def kept(self) -> int:
        """Number of outcomes that are saved in the folder: all that have not failed."""
        return sum(outcome.status != "failed" for outcome in self.outcomes.values())


class Interrupted(Exception):
    """A campaign stopped before its end, by Ctrl-C or for the given reason; its results so far are in the folder."""

    def __init__(self, campaign: Campaign, reason: str = "") -> None:
        super().__init__(reason or "interrupted")
        self.campaign, self.reason = campaign, reason


@contextmanager
def ctrl_c_passed_on() -> Iterator[None]:
    """Convert `Interrupted` into KeyboardInterrupt, as scripts expect it, if Ctrl-C has stopped a campaign."""
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
    """Run models (by default all of `MODELS`) on named scenes; parameters and errors as in `run_tasks`."""
    chosen = [find_model(model, "models") for model in models or MODELS]
    check_tolerance(tolerance)
    largest_first = sorted(scenes, key=lambda name: -len(scenes[name].blocks))
    # Expensive models are last in the registry. They start first, so that no single process works on alone in the end.
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
    """Run tasks in their order, one per cell.

    Parameters
    ----------
    folder
        Folder for outcomes, as ``folder/scene/model/``. A complete outcome of the same scene, tolerance and code is
        reused, unless `fresh` is set. None saves nothing.
    jobs
        Number of processes; −1 for one per core.
    cluster
        Address of a Dask scheduler, or its file: tasks go to its workers, which share no folder with this process.
    progress
        Called with each cell that is done.

    Raises
    ------
    SceneError
        For an invalid number of processes, or a cluster that is not there or has no worker.
    Interrupted
        On Ctrl-C, or if the folder cannot be written or the cluster is lost, with the results so far. Running the same
        tasks again resumes from there.
    """
    if isinstance(jobs, bool) or not isinstance(jobs, Integral) or jobs == 0:
        raise SceneError("jobs", "must be a number of processes, or -1 for one per core", jobs)
    campaign = Campaign()
    scenes = {task.cell: task.scene for task in tasks}
    try:
        with warnings.catch_warnings(), closing(_answers(tasks, None if fresh else folder, jobs, cluster)) as answers:
            # `Interrupted` reports unfinished tasks already, and replacing a worker that uses much memory is harmless.
            warnings.filterwarnings("ignore", ".*(tasks (have been|which were)|worker stopped)", UserWarning, "joblib")
            for answer in answers:
                cell, outcome = answer.cell, answer.outcome
                if outcome is None:
                    campaign.inapplicable[cell] = answer.reason
                elif answer.reused:
                    campaign.reused.add(cell)
                elif folder is not None and outcome.status != "failed":  # failed tasks are run again
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
    """Yield answers from the folder, if there is one, then computed ones as they become available."""
    missing = []
    for task in tasks:
        try:
            outcome, key = (None, "") if folder is None else load_outcome(folder.joinpath(*task.cell))
        except StoreError:
            outcome, key = None, ""
        if outcome is not None and key == task.key():  # same scene, model, tolerance and code
            yield Answer(task.cell, outcome, key=key, reused=True)
        else:
            missing.append(task)
    if missing and cluster is not None:
        from .cluster import on_cluster  # Dask may not be installed

        yield from on_cluster(missing, cluster)
    elif missing:
        from .processes import in_processes  # joblib is slow to load, and nothing else needs it

        yield from in_processes(missing, jobs)
