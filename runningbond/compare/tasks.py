"""The tasks of a campaign: one model on one scene each, and the answers to them."""

import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from joblib import Parallel, delayed

from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError

from .fingerprint import fingerprint
from .model import Model
from .models import run_model

Cell: TypeAlias = tuple[str, str]
"""Name of a scene and of a model."""


@dataclass(frozen=True)
class Answer:
    """What one model said of one scene: an outcome, or why it does not apply.

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
        Whether it was read from the folder and not computed.
    """

    cell: Cell
    outcome: Outcome | None
    reason: str = ""
    key: str = ""
    reused: bool = False


@dataclass(frozen=True, eq=False)
class Task:
    """One model to be run on one scene.

    Parameters
    ----------
    name
        Name of the scene.
    scene, model, tolerance
        What is run.
    """

    name: str
    scene: Scene
    model: Model
    tolerance: float

    @property
    def cell(self) -> Cell:
        """Names of the scene and of the model."""
        return self.name, self.model.name

    def key(self) -> str:
        """Fingerprint under which its outcome is kept, by the sources and libraries of this process."""
        return fingerprint(self.scene, self.model, self.tolerance)

    def lost(self) -> Answer:
        """The answer where processes were killed over it."""
        outcome = Outcome(self.scene.title, self.model.name, "failed", message="its process was killed (memory?)")
        return Answer(self.cell, outcome)


class ClusterError(Exception):
    """A cluster that does not do what it is asked; the message says why."""


_ONE_AT_A_TIME = threading.Lock()


def run_task(task: Task) -> Answer:
    """Run a task; called in a process of its own.

    A worker with several threads runs one after the other: gmsh and the threads of linear algebra are there once a
    process.
    """
    key = task.key()
    try:
        with _ONE_AT_A_TIME:
            return Answer(task.cell, run_model(task.model, task.scene, task.tolerance), key=key)
    except SceneError as reason:
        return Answer(task.cell, None, str(reason), key)


def side_by_side(tasks: Sequence[Task]) -> Iterator[Answer]:
    """Answers as they come, from wherever joblib has been told to send its tasks."""
    # All of them at once, for the sake of workers that join a cluster later.
    run = Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="all")
    yield from run(delayed(run_task)(task) for task in tasks)
