"""Campaigns: every model on every scene, one process a case, each result kept as soon as it is there."""

import multiprocessing
import signal
import warnings
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from results import Outcome, StoreError, load_outcome, save_outcome
from scene import Scene, SceneError

from .fingerprint import fingerprint
from .models import MODELS, TOLERANCE, check_model, check_tolerance, run_model

Cell: TypeAlias = tuple[str, str]
"""Name of a scene and of a model."""


@dataclass(frozen=True)
class Answer:
    """What one model said of one scene: an outcome, or why it says nothing."""

    cell: Cell
    outcome: Outcome | None
    reason: str = ""
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


class Interrupted(Exception):
    """A campaign stopped by Ctrl-C; what it has is in the folder."""

    def __init__(self, campaign: Campaign) -> None:
        super().__init__("interrupted")
        self.campaign = campaign


def run_campaign(
    scenes: Mapping[str, Scene],
    models: Sequence[str] = tuple(MODELS),
    *,
    folder: Path,
    tolerance: float = TOLERANCE,
    jobs: int = -1,
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
    fresh
        Compute everything again.
    progress
        Called with each cell that is done.

    Raises
    ------
    Interrupted
        On Ctrl-C, with what there is. Running the same campaign again goes on from there.
    """
    for model in models:
        check_model(model, "--models")
    check_tolerance(tolerance)
    largest_first = sorted(scenes, key=lambda name: -len(scenes[name].blocks))
    # Dear models stand last in the registry; started first, they do not leave one process working alone.
    cells = [(name, model) for model in reversed(models) for name in largest_first]
    campaign = Campaign()
    try:
        # Absolute, for a worker that has served before may stand elsewhere.
        for answer in _answers(cells, scenes, folder.resolve(), tolerance, jobs, fresh):
            campaign.add(answer)
            progress(answer.cell)
    except KeyboardInterrupt:
        raise Interrupted(campaign) from None
    return campaign


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


def _answers(
    cells: Sequence[Cell], scenes: Mapping[str, Scene], folder: Path, tolerance: float, jobs: int, fresh: bool
) -> Iterator[Answer]:
    """Answers as they come, whatever becomes of the processes that find them."""
    left = dict.fromkeys(cells)
    try:
        for answer in _side_by_side(cells, scenes, folder, tolerance, jobs, fresh):
            del left[answer.cell]
            yield answer
    except TerminatedWorkerError:
        # A process was killed, and nobody says over which case: what is left goes one by one, the cheapest first.
        for cell in reversed(list(left)):
            try:
                yield from _side_by_side([cell], scenes, folder, tolerance, 2, fresh)
            except TerminatedWorkerError:
                lost = Outcome(scenes[cell[0]].title, cell[1], "failed", message="its process was killed (memory?)")
                yield Answer(cell, lost)


def _side_by_side(
    cells: Sequence[Cell], scenes: Mapping[str, Scene], folder: Path, tolerance: float, jobs: int, fresh: bool
) -> Iterator[Answer]:
    tasks = (delayed(_run_cell)(cell, scenes[cell[0]], folder, tolerance, fresh) for cell in cells)
    with _processes(jobs):
        yield from Parallel(return_as="generator_unordered", batch_size=1)(tasks)


def _leave_interrupts_to_the_parent() -> None:
    """Ctrl-C reaches every process of the terminal; only the parent, which ends the others, has something to say."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _run_cell(cell: Cell, scene: Scene, folder: Path, tolerance: float, fresh: bool) -> Answer:
    """Run one model on one scene, or find its outcome; called in a process of its own."""
    name, model = cell
    place = folder / name / model
    key = fingerprint(scene, model, tolerance)
    if not fresh:
        found = _find(place, key)
        if found is not None:
            return Answer(cell, found, reused=True)
    try:
        outcome = run_model(model, scene, tolerance)
    except SceneError as reason:
        return Answer(cell, None, str(reason))
    if outcome.status != "failed":  # a failure is tried again, perhaps by better code
        save_outcome(outcome, place, key, scene)
    return Answer(cell, outcome)


def _find(place: Path, key: str) -> Outcome | None:
    try:
        outcome, stored_key = load_outcome(place)
    except StoreError:
        return None
    return outcome if stored_key == key else None
