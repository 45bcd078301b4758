"""The tasks of a campaign: one model on one scene each, and the answers to them."""

import signal
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

_ONE_AT_A_TIME = threading.Lock()


class ClusterError(Exception):
    """A cluster that does not do what it is asked; the message says why."""


@dataclass(frozen=True)
class Answer:
    """What one model said of one scene: an outcome, or why it does not apply."""

    cell: Cell
    outcome: Outcome | None  # None where the model does not apply
    reason: str = ""  # why it does not
    key: str = ""  # fingerprint of what it was computed from, taken where that was done
    reused: bool = False  # whether it was read from the folder and not computed


@dataclass(frozen=True, eq=False)
class Task:
    """One model to be run on one scene, which is called by a name."""

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

    def run(self) -> Answer:
        """Run the model.

        A worker with several threads runs one task after the other: gmsh and the threads of linear algebra are there
        once a process.
        """
        key = self.key()
        try:
            with _ONE_AT_A_TIME:
                return Answer(self.cell, run_model(self.model, self.scene, self.tolerance), key=key)
        except SceneError as reason:
            return Answer(self.cell, None, str(reason), key)

    def lost(self) -> Answer:
        """The answer where processes were killed over it."""
        outcome = Outcome(self.scene.title, self.model.name, "failed", message="its process was killed (memory?)")
        return Answer(self.cell, outcome)


def side_by_side(tasks: Sequence[Task]) -> Iterator[Answer]:
    """Answers as they come, from wherever joblib has been told to send its tasks."""
    # All of them at once, for the sake of workers that join a cluster later.
    run = Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="all")
    # A process that starts inherits the mask: Ctrl-C reaches all of a terminal's processes, and the parent ends them.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        answers = run(delayed(Task.run)(task) for task in tasks)
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    yield from answers
